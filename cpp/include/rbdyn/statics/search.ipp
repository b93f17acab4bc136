// Definitions of rbdyn/statics/search.hpp.
#pragma once

#include "rbdyn/statics/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/statics/evident_rest.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/normal_modes.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
#include "rbdyn/statics/resolved_rest.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE std::vector<double> newton_step(const Forces::State& s, double damping) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = s.jacobian.size();
    // in units in which the metric is one
    SquareMatrix scaled(n), normal(n);
    std::vector<double> force(at(n)), step(at(n)), downhill(at(n));
    double force_squared = 0.0;
    for (int i = 0; i < n; ++i) {
        force[at(i)] = s.force[at(i)] / std::sqrt(s.metric[at(i)]);
        force_squared += force[at(i)] * force[at(i)];
        for (int j = 0; j < n; ++j) scaled(i, j) = s.jacobian(i, j) / std::sqrt(s.metric[at(i)] * s.metric[at(j)]);
    }
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
            downhill[at(i)] += scaled(k, i) * force[at(k)];
            for (int j = 0; j < n; ++j) normal(i, j) += scaled(k, i) * scaled(k, j);
        }
    const SymmetricEigen e = symmetric_eigen(normal);
    const double largest = e.values.back();
    for (int k = 0; k < n; ++k) {
        double along = 0.0;
        for (int i = 0; i < n; ++i) along += e.vectors(i, k) * downhill[at(i)];
        const double square = e.values[at(k)];
        // a null direction: the force along it is rounding, too
        if (!(square > 64.0 * epsilon * n * largest) &&
            std::abs(along) <= 1e-14 * n * std::sqrt(largest * force_squared))
            continue;
        for (int i = 0; i < n; ++i)
            step[at(i)] -= e.vectors(i, k) * along / (std::max(square, 0.0) + damping * largest);
    }
    for (int i = 0; i < n; ++i) step[at(i)] /= std::sqrt(s.metric[at(i)]);
    return step;
}

RBDYN_INLINE Stiffness::Stiffness(const Forces::State& s) : symmetric(s.jacobian.size()) {
    const int n = symmetric.size();
    const auto scaled = [&](int i, int j) {
        return -s.jacobian(i, j) /
               std::sqrt(s.metric[static_cast<std::size_t>(i)] * s.metric[static_cast<std::size_t>(j)]);
    };
    double largest = 0.0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            symmetric(i, j) = 0.5 * (scaled(i, j) + scaled(j, i));
            twist = std::max(twist, std::abs(scaled(i, j) - scaled(j, i)));
            largest = std::max(largest, std::abs(scaled(i, j)));
        }
    rounding = 64.0 * std::numeric_limits<double>::epsilon() * n * largest;
}

RBDYN_INLINE bool settle(TreeForces& forces, std::vector<double>& q) {
    const int n = forces.freedoms();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    // radians in which a step of this search may turn a body
    constexpr double most_turn = 0.5;
    Forces::State now = forces.at_rest(q);
    double damping = 0.01, largest_work = 0.0;
    for (int iteration = 0; iteration < 300; ++iteration) {
        const SymmetricEigen e = symmetric_eigen(Stiffness(now).symmetric);
        const double largest = std::max(std::abs(e.values.front()), std::abs(e.values.back()));
        std::vector<double> step(at(n));
        for (int k = 0; k < n; ++k) {
            double along = 0.0;
            for (int i = 0; i < n; ++i) along += e.vectors(i, k) * now.force[at(i)] / std::sqrt(now.metric[at(i)]);
            if (along == 0.0) continue;
            for (int i = 0; i < n; ++i)
                step[at(i)] += e.vectors(i, k) * along / (std::abs(e.values[at(k)]) + damping * largest) /
                               std::sqrt(now.metric[at(i)]);
        }
        const double turning = forces.largest_turn(step);
        for (double& x : step) x *= std::min(1.0, most_turn / turning);
        if (!std::all_of(step.begin(), step.end(), [](double x) { return std::isfinite(x); })) return false;
        const std::vector<double> next = forces.moved(q, step);
        const Forces::State there = forces.at_rest(next);
        const std::vector<double> moved = forces.difference(next, q);
        double work = 0.0;
        for (int i = 0; i < n; ++i) work += 0.5 * (now.force[at(i)] + there.force[at(i)]) * moved[at(i)];
        if (!there.is_finite() || !(work > 0.0)) {
            // no step is too small to go down but at the bottom
            if (damping > 1e12) return largest_work > 0.0;
            damping *= 8.0;
            continue;
        }
        q = next;
        now = there;
        damping *= 0.25;
        largest_work = std::max(largest_work, work);
        if (work <= 1e-12 * largest_work) return true;
    }
    return false;
}

RBDYN_INLINE std::optional<PinnedRest> pinned_if_even(TreeForces& forces, const std::vector<double>& q,
                                                      const Stiffness& stiffness) {
    // of more freedoms modes in doubles have to do
    constexpr int most_wide = 120;
    if (forces.freedoms() > most_wide || !(stiffness.twist <= stiffness.rounding)) return std::nullopt;
    try {
        PinnedRest rest = pinned(forces, q);
        // leaps that lead nowhere may end, too
        double size = forces.extent();
        for (const double x : q) size = std::max(size, std::abs(x));
        constexpr double near = 4.0;
        if (rest.is_found && forces.distance(forces.nearest(rest.place), q) <= near * size &&
            is_zero(forces, rest.place))
            return rest;
        rest.is_found = false;
        rest.place = forces.wide(q);
        rest.flat.assign(static_cast<std::size_t>(forces.freedoms()), false);
        if (rest.place.empty()) return rest;
        forces.look_at(rest.place);
        rest.modes = small_modes(small_motion(forces));
        return rest;
    } catch (const InvalidInput&) {
        // in 32 digits they have none, or the masses are singular
        return std::nullopt;
    }
}

/// The zero of the forces near q by the modes in 32 digits, in place; whether there is one.
inline bool approach(TreeForces& forces, std::vector<double>& q, const Beginning& start) {
    const Forces::State s = forces.at_rest(q);
    if (!s.is_finite()) return false;
    const auto rest = pinned_if_even(forces, q, Stiffness(s));
    if (!rest || !rest->is_found) return false;
    // far out in a valley forces vanish beside what they are sums of
    double size = forces.extent();
    for (const double x : start.place) size = std::max(size, std::abs(x));
    constexpr double far = 1e6;
    if (!(forces.distance(forces.nearest(rest->place), start.place) <= far * size)) return false;
    q = forces.nearest(rest->place);
    const Forces::State there = forces.at_rest(q);
    return there.pushed && is_resolved(forces, q, there) && is_evident(forces, q, there, start);
}

RBDYN_INLINE bool relax(TreeForces& forces, std::vector<double>& q) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const int n = forces.freedoms();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const std::vector<double> start = q;
    Forces::State now = forces.at_rest(q);
    if (!now.is_finite())
        throw InvalidInput("equilibria: where the search begins, " + forces.not_finite(q) +
                           " is not finite; begin elsewhere (near)");
    const Beginning beginning{start, now.effort};
    std::vector<double> most = now.effort;
    const auto vanishes = [&](const Forces::State& s) {
        for (int i = 0; i < n; ++i) {
            double rounding = 16.0 * s.effort[at(i)];
            for (int j = 0; j < n; ++j) rounding += 4.0 * std::abs(s.jacobian(i, j)) * s.size[at(j)];
            if (std::abs(s.force[at(i)]) > 64.0 * epsilon * rounding) return false;
        }
        return true;
    };
    // far away damping finds the way, near the zero Newton's steps are taken whole
    double damping = 0.0;
    bool found = false, is_looked_at = false;
    for (int iteration = 0; iteration < 300; ++iteration) {
        // at a zero of all coordinates steps go on until squares underflow
        found = vanishes(now) || now.misfit() == 0.0;
        if (found) break;
        const std::vector<double> step = newton_step(now, damping);
        std::vector<double> next;
        Forces::State there;
        bool is_better = false;
        if (std::all_of(step.begin(), step.end(), [](double x) { return std::isfinite(x); })) {
            next = forces.moved(q, step);
            there = forces.at_rest(next);
            is_better = there.is_finite() && there.misfit() < now.misfit();
        }
        if (!is_better) {
            // no step is too small to help only where there is no way down
            if (damping > 1e12) break;
            damping = std::max(8.0 * damping, 1e-3);
            continue;
        }
        const std::vector<double> away = forces.difference(next, start), moved = forces.difference(next, q);
        double gone = 0.0, taken = 0.0;
        bool faded = true;
        for (int i = 0; i < n; ++i) {
            gone = std::max(gone, now.metric[at(i)] * away[at(i)] * away[at(i)]);
            taken = std::max(taken, now.metric[at(i)] * moved[at(i)] * moved[at(i)]);
            most[at(i)] = std::max(most[at(i)], there.effort[at(i)]);
            faded = faded && std::abs(there.force[at(i)]) <= 1e-13 * most[at(i)];
        }
        q = next;
        now = there;
        damping = damping > 1e-9 ? 0.125 * damping : 0.0;
        if (is_looked_at || !(damping == 0.0 && taken < 1e-20 * gone && faded)) continue;
        // the forces die away to a zero of higher order, the steps with them; far off they are large all the same
        is_looked_at = true;
        if (std::vector<double> leapt = q; approach(forces, leapt, beginning)) {
            q = std::move(leapt);
            return true;
        }
    }
    // squares of slow modes are lost beside those of stiff ones, and of flat ones beside any
    if (!found) return approach(forces, q, beginning);
    for (int iteration = 0; iteration < 4; ++iteration) {
        LinearSolution step = solve(now.jacobian, now.force);
        for (double& x : step.x) x = -x;
        if (!(step.pivots > n * epsilon)) step.x = newton_step(now, 0.0);
        const std::vector<double> next = forces.moved(q, step.x);
        const Forces::State there = forces.at_rest(next);
        if (!there.is_finite() || !(there.misfit() < now.misfit())) break;
        q = next;
        now = there;
    }
    // a zero of higher order may be a part of rounding away, farther than doubles go
    return (now.pushed && is_resolved(forces, q, now) && is_evident(forces, q, now, beginning)) ||
           approach(forces, q, beginning);
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
