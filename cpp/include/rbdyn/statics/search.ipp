// Definitions of rbdyn/statics/search.hpp.
#pragma once

#include "rbdyn/statics/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/evident_rest.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/multiple_rest.hpp"
#include "rbdyn/statics/normal_modes.hpp"
#include "rbdyn/statics/null_direction.hpp"
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

namespace searching {

// freedoms of a scene whose modes are taken in 32 digits: of more, those in doubles have to do
inline constexpr int most_wide = 120;

/// The small motions near q, the zero pinned down, if the forces have a potential.
inline std::optional<PinnedRest> pinned_if_even(TreeForces& forces, const std::vector<double>& q,
                                                const Stiffness& stiffness) {
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

/// What the one mode does that is open; the place is that of the zero along it.
inline AlongNull along_open(TreeForces& forces, PinnedRest& rest, std::vector<bool>& open) {
    const auto mode = static_cast<std::size_t>(std::ranges::find(open, true) - open.begin());
    auto zero = multiple_rest(forces, rest, static_cast<int>(mode));
    if (!zero) {
        if (!rest.is_found || !rest.flat[mode]) return AlongNull::not_decided;
        std::vector<double> direction(open.size());
        direction[mode] = 1.0;
        const AlongNull along = along_null(forces, rest, direction);
        return along == AlongNull::indifferent ? along : AlongNull::not_decided;
    }
    rest.place = without_dust(forces, rest.modes, std::move(zero->place));
    rest.is_found = true;
    forces.look_at(rest.place);
    rest.modes = small_modes(small_motion(forces));
    std::vector<double>& squares = rest.modes.squares;
    // the softest comes where it was
    const auto softest = std::ranges::min_element(squares, {}, [](double x) { return std::abs(x); });
    const auto now = static_cast<std::size_t>(softest - squares.begin());
    rest.flat.assign(open.size(), false);
    open.assign(open.size(), false);
    open[now] = true;
    rest.flat[now] = zero->order > 1 || std::abs(squares[now]) <= rest.modes.rounding[now];
    AlongNull along = zero->along;
    for (std::size_t k = 0; k < squares.size(); ++k) {
        if (k == now || std::abs(squares[k]) > rest.modes.rounding[k]) continue;
        open[k] = rest.flat[k] = true;
        along = AlongNull::not_decided;
    }
    return along;
}

}  // namespace searching

/// Whether Newton's method from q comes to a zero at once: one at which the forces do not vanish to higher order.
inline bool contracts(TreeForces& forces, const std::vector<double>& q) {
    const Forces::State s = forces.at_rest(q);
    const std::size_t n = s.force.size();
    const std::vector<double> sizes = forces.force_sizes(forces.wide(q));
    TreeForces::Wide place = forces.wide(q);
    const auto misfit = [&](const TreeForces::Wide& f) {
        double most = 0.0;
        for (std::size_t i = 0; i < n; ++i) most = std::max(most, std::abs(f[i].hi) / std::sqrt(s.metric[i]));
        return most;
    };
    double noise = 0.0;
    for (std::size_t i = 0; i < n; ++i) noise = std::max(noise, 0x1p-70 * sizes[i] / std::sqrt(s.metric[i]));
    constexpr int most_steps = 4;
    for (int iteration = 0; iteration < most_steps && !place.empty(); ++iteration) {
        const TreeForces::Wide f = forces.force_at(place);
        if (misfit(f) <= noise) return true;
        std::vector<double> left;
        for (const DoubleDouble& x : f) left.push_back(-x.hi);
        place = forces.stepped(place, solve(s.jacobian, left).x);
    }
    return false;
}

/// The zero of the forces near q by the modes in 32 digits, in place; whether there is one.
inline bool approach(TreeForces& forces, std::vector<double>& q, const Beginning& start) {
    const Forces::State s = forces.at_rest(q);
    if (!s.is_finite()) return false;
    const auto rest = searching::pinned_if_even(forces, q, Stiffness(s));
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

RBDYN_INLINE std::optional<FreeTurn> free_turn(Forces& forces, const std::vector<double>& q, const Forces::State& s,
                                               const Stiffness& stiffness, int body) {
    const int first = forces.first(body), moves = forces.displacements(body), n = moves + 3;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    SquareMatrix own(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) own(i, j) = stiffness.symmetric(first + i, first + j);
    const SymmetricEigen e = symmetric_eigen(own);
    int null = -1;
    for (int k = 0; k < n; ++k) {
        if (std::abs(e.values[at(k)]) > stiffness.rounding) continue;
        if (null >= 0) return std::nullopt;
        null = k;
    }
    if (null < 0) return std::nullopt;
    const auto component = [&](int i) { return e.vectors(i, null) / std::sqrt(s.metric[at(first + i)]); };
    const Vector3 turning =
        forces.turn_in_world(q, body, Vector3(component(moves), component(moves + 1), component(moves + 2)));
    if (turning.isZero(0.0)) return std::nullopt;
    FreeTurn result{direction(turning)};
    Vector3& axis = result.axis;
    if (axis[greatest(sizes(axis))] < 0.0) axis = -axis;
    for (double& x : axis)
        if (std::abs(x) < std::numeric_limits<double>::epsilon()) x = 0.0;
    if (moves > 0) {
        const Vector3 velocity(component(0), component(1), component(2));
        result.point = forces.center(q, body) + turning.cross(velocity) / turning.squaredNorm();
    }
    // three turns that no symmetry but a full one has
    for (const double angle : {1.0, 2.25, 4.0}) {
        const Forces::State there = forces.at_rest(forces.turned(q, body, axis, result.point, angle));
        for (std::size_t i = 0; i < there.force.size(); ++i)
            if (!(std::abs(there.force[i]) <= 1e-11 * there.effort[i])) return std::nullopt;
    }
    return result;
}

RBDYN_INLINE Judgement judged(TreeForces& forces, std::vector<double> q, const std::vector<double>& start) {
    Forces::State s = forces.at_rest(q);
    const Stiffness stiffness(s);
    Equilibrium e;
    for (int i = 0; i < forces.bodies(); ++i) {
        if (!forces.turns(i)) continue;
        const auto free = free_turn(forces, q, s, stiffness, i);
        if (!free) continue;
        e.axes.push_back(free->axis);
        // what of the way from the start is a turn about the axis is taken back
        const Quaternion way = forces.attitude(q, i) * conjugate(forces.attitude(start, i));
        const double half = std::atan2(free->axis.dot(Vector3(way.x, way.y, way.z)), way.w);
        q = forces.turned(std::move(q), i, free->axis, free->point, -2.0 * half);
    }
    bool is_decided = false;
    if (auto rest = searching::pinned_if_even(forces, q, stiffness)) {
        const bool is_placed = !rest->place.empty() && rest->modes.squares.size() == s.force.size();
        std::vector<bool> open = is_placed ? open_modes(forces, *rest) : std::vector<bool>(s.force.size(), true);
        const auto untold = static_cast<std::size_t>(std::ranges::count(open, true));
        // what the second derivatives do not say the forces nearby may, where no turn is to be left aside
        AlongNull along = AlongNull::not_decided;
        if (untold == 1 && is_placed && e.axes.empty()) {
            along = searching::along_open(forces, *rest, open);
        } else if (untold > 0 && rest->is_found && e.axes.empty()) {
            along = along_flat(forces, *rest, open);
        }
        if (rest->is_found) q = forces.nearest(rest->place);
        const std::vector<double>& squares = rest->modes.squares;
        bool falls = false;
        for (std::size_t k = 0; k < squares.size(); ++k) {
            falls = falls || (rest->is_found && !open[k] && squares[k] < 0.0);
            if (!rest->flat[k] && squares[k] > 0.0) e.periods.push_back(2.0 * std::numbers::pi / std::sqrt(squares[k]));
        }
        std::sort(e.periods.rbegin(), e.periods.rend());
        const bool is_told = falls || untold == e.axes.size();
        e.stable = rest->is_found && !falls && (is_told ? untold < squares.size() : along == AlongNull::stable);
        e.decided = rest->is_found && (is_told || along != AlongNull::not_decided);
        is_decided = e.decided && untold < squares.size() && along != AlongNull::indifferent;
    } else {
        // the symmetric part, in doubles
        const std::vector<double> squares = symmetric_eigenvalues(stiffness.symmetric);
        const auto hidden = static_cast<std::size_t>(
            std::ranges::count_if(squares, [&](double x) { return std::abs(x) <= stiffness.rounding; }));
        const bool is_simple = contracts(forces, q);
        e.decided = is_decided = is_simple && (squares.front() < -stiffness.rounding || hidden == e.axes.size());
        e.stable = e.decided && squares.front() >= -stiffness.rounding && hidden < squares.size();
        // without a potential the modes are not those of the symmetric part
        if (stiffness.twist <= stiffness.rounding)
            for (const double square : squares)
                if (square > stiffness.rounding) e.periods.push_back(2.0 * std::numbers::pi / std::sqrt(square));
    }
    if (e.stable && s.idle) e.stable = e.decided = is_decided = false;
    e.coordinates = forces.coordinates(q);
    return {std::move(e), std::move(q), is_decided};
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
