// Definitions of rbdyn/statics/pinned_rest.hpp.
#pragma once

#include "rbdyn/statics/pinned_rest.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/statics/normal_modes.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE SmallMotion small_motion(const TreeForces& forces) {
    TreeForces::WideJacobian slope = forces.wide_jacobian();
    SmallMotion result{forces.wide_mass(), std::move(slope.entries), slope.is_constant,
                       slope.is_constant ? std::nullopt : forces.jacobian_sizes()};
    for (int i = 0; i < forces.freedoms(); ++i)
        for (int j = 0; j < forces.freedoms(); ++j) result.stiffness(i, j) = -result.stiffness(i, j);
    return result;
}

namespace pinning {

/// A leap to a zero of higher order that is nothing, beside those before and beside the scene.
inline constexpr double last_leap = 0x1p-60;

/// p of (1 - 1/p)^p = what a step leaves of the force; none where it is no such power.
inline std::optional<double> order(double left) {
    // of 1.1 and of 50
    if (!(left > 0.072 && left < 0.364)) return std::nullopt;
    double low = 1.0, high = 60.0;
    for (int i = 0; i < 60; ++i) {
        const double p = 0.5 * (low + high);
        (std::pow(1.0 - 1.0 / p, p) < left ? low : high) = p;
    }
    // most are whole numbers, and the way to the zero is then told to rounding
    return std::abs(low - std::round(low)) < 1e-2 ? std::round(low) : low;
}

}  // namespace pinning

RBDYN_INLINE TreeForces::Wide without_dust(TreeForces& forces, const SmallModes& modes, TreeForces::Wide place) {
    const int n = forces.freedoms();
    const auto positions = forces.nearest(place).size();
    constexpr double beside = 1e-9;
    const std::vector<double> units = forces.units_of_positions();
    const auto misfit = [&](const TreeForces::Wide& at) {
        const TreeForces::Wide f = forces.force_at(at);
        double most = 0.0;
        for (int k = 0; k < n; ++k) {
            double force = 0.0;
            for (int i = 0; i < n; ++i) force += modes.shapes(i, k) * f[static_cast<std::size_t>(i)].hi;
            most = std::max(most, std::abs(force));
        }
        return most;
    };
    const auto is_beside = [&](std::size_t i) {
        return place[i].hi != 0.0 && std::abs(place[i].hi) <= beside * units[i];
    };
    // another rest is not far where forces change in lengths far below the scene's: on the way there is more than here
    const auto is_the_same = [&](const TreeForces::Wide& other) {
        constexpr double more = 4.0;
        const double here = misfit(place);
        if (!(misfit(other) <= here)) return false;
        for (const double part : {0.9, 0.62, 0.38, 0.17, 0.05}) {
            TreeForces::Wide between = place;
            for (std::size_t i = 0; i < positions; ++i)
                if (other[i] != place[i]) between[i] = part * place[i];
            double noise = 0.0;
            const std::vector<double> sizes = forces.force_sizes(between);
            for (int k = 0; k < n; ++k)
                for (int i = 0; i < n; ++i)
                    noise =
                        std::max(noise, 0x1p-90 * std::abs(modes.shapes(i, k)) * sizes[static_cast<std::size_t>(i)]);
            if (!(misfit(between) <= more * here + noise)) return false;
        }
        return true;
    };
    // all of them, then one after the other
    for (std::size_t from = 0; from <= positions; ++from) {
        TreeForces::Wide other = place;
        for (std::size_t i = 0; i < positions; ++i)
            if ((from == 0 || i == from - 1) && is_beside(i)) other[i] = 0.0;
        if (other != place && is_the_same(other)) place = std::move(other);
    }
    return place;
}

RBDYN_INLINE bool is_zero(TreeForces& forces, const TreeForces::Wide& place) {
    constexpr double some = 64.0 * std::numeric_limits<double>::epsilon();
    if (place.empty()) return false;
    const TreeForces::Wide f = forces.force_at(place);
    const std::vector<double> sizes = forces.force_sizes(place);
    // of one term that vanishes to higher order there is all left of it, which is nothing beside other forces
    constexpr double nothing = 0x1p-96;
    const Forces::State s = forces.at_rest(forces.nearest(place));
    const std::vector<double>&metric = s.metric, &known = s.size;
    double most = 0.0;
    for (std::size_t i = 0; i < f.size(); ++i) most = std::max(most, sizes[i] / std::sqrt(metric[i]));
    std::vector<bool> left(f.size());
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double rounding = std::max(some * sizes[i], nothing * most * std::sqrt(metric[i]));
        left[i] = !(std::abs(f[i].hi) <= rounding);
        if (!std::isfinite(f[i].hi) || !std::isfinite(rounding)) return false;
    }
    // sizes may vanish in doubles, beside a zero of higher order that is none of theirs: as far as leaps end before it
    for (std::size_t k = 0; k < known.size() && std::ranges::count(left, true) > 0; ++k)
        for (const double part : {pinning::last_leap, -pinning::last_leap}) {
            std::vector<double> step(known.size());
            step[k] = part * known[k];
            const TreeForces::Wide there = forces.stepped(place, step);
            if (there.empty()) continue;
            const TreeForces::Wide beside = forces.force_at(there);
            for (std::size_t i = 0; i < f.size(); ++i)
                if (std::abs(f[i].hi) <= std::abs(beside[i].hi - f[i].hi)) left[i] = false;
        }
    return std::ranges::count(left, true) == 0;
}

RBDYN_INLINE PinnedRest pinned(TreeForces& forces, const std::vector<double>& q) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    PinnedRest rest;
    rest.place = forces.wide(q);
    double softened = 0.0;      // the largest square met of a mode that is flat in the end
    double longest_leap = 0.0;  // of all steps to zeros of higher order
    const std::vector<double> units = forces.units_of_positions(), freedom_units = forces.units();
    const auto is_far = [&](const TreeForces::Wide& to, const TreeForces::Wide& from) {
        for (std::size_t i = 0; i < q.size(); ++i)
            if (std::abs((to[i] - from[i]).hi) > 1e-8 * std::abs(from[i].hi) + 1e-14 * units[i]) return true;
        return false;
    };
    constexpr int most_rounds = 30, most_steps = 40, most_whole = 6;
    for (int round = 0; round < most_rounds && !rest.place.empty(); ++round) {
        forces.look_at(rest.place);
        rest.modes = small_modes(small_motion(forces));
        rest.flat.assign(at(n), false);
        const std::vector<double> sizes = forces.force_sizes(rest.place);
        const auto is_stiff = [&](int k) { return std::abs(rest.modes.squares[at(k)]) > rest.modes.rounding[at(k)]; };
        const auto along = [&](const TreeForces::Wide& f, int k) {
            DoubleDouble sum = 0.0;
            for (int i = 0; i < n; ++i) sum += DoubleDouble(rest.modes.shapes(i, k)) * f[at(i)];
            return sum.hi;
        };
        const auto taken = [&](const std::vector<double>& ways) {
            std::vector<double> step(at(n));
            for (int k = 0; k < n; ++k)
                for (int i = 0; i < n; ++i) step[at(i)] += ways[at(k)] * rest.modes.shapes(i, k);
            return step;
        };
        // what 32 digits leave, where constraints are closed to fewer
        const double digits = forces.has_constraints() ? 0x1p-76 : 0x1p-94;
        double stiffest = 0.0;
        for (const double square : rest.modes.squares) stiffest = std::max(stiffest, std::abs(square));
        // soft modes are looked at where the others are relaxed: the way to a flat zero may be a bent valley
        constexpr double soft = 1e-3;
        const auto is_soft = [&](int k) { return std::abs(rest.modes.squares[at(k)]) <= soft * stiffest; };
        std::vector<double> first(at(n)), second(at(n));
        std::vector<bool> open(at(n));
        bool is_moved = false;
        TreeForces::Wide place = rest.place;
        for (int iteration = 0, whole = 0; iteration < most_steps && whole < most_whole && !place.empty();
             ++iteration) {
            Interruption::point();
            const TreeForces::Wide f = forces.force_at(place);
            std::vector<double> ways(at(n)), force(at(n));
            bool is_done = true, is_relaxed = true;
            double softly = 0.0;
            for (int k = 0; k < n; ++k) {
                force[at(k)] = along(f, k);
                if (!std::isfinite(force[at(k)])) return rest;
                double rounding = 0.0;
                for (int i = 0; i < n; ++i) rounding += std::abs(rest.modes.shapes(i, k)) * sizes[at(i)];
                open[at(k)] = is_stiff(k) && std::abs(force[at(k)]) > digits * rounding;
                if (!open[at(k)]) continue;
                is_done = false;
                ways[at(k)] = force[at(k)] / rest.modes.squares[at(k)];
                if (is_soft(k)) softly = std::max(softly, std::abs(force[at(k)]));
            }
            if (is_done) {
                // what the modes say is said of where they are taken
                is_moved = is_far(place, rest.place);
                rest.is_found = !is_moved;
                rest.place = place;
                break;
            }
            for (int k = 0; k < n; ++k)
                if (open[at(k)] && !is_soft(k) && std::abs(force[at(k)]) > 1e-6 * softly) is_relaxed = false;
            if (softly == 0.0) is_relaxed = true;
            if (is_relaxed) {
                // the modes are those of where the stiff ones are relaxed
                if (whole == 0 && iteration > 0 && softly > 0.0) {
                    rest.place = place;
                    is_moved = true;
                    break;
                }
                if (whole == 0) first = force;
                if (whole == 1) second = force;
                ++whole;
            } else {
                for (int k = 0; k < n; ++k)
                    if (is_soft(k)) ways[at(k)] = 0.0;
            }
            place = forces.stepped(place, taken(ways));
        }
        if (rest.is_found) break;
        if (is_moved) continue;
        if (place.empty()) return rest;
        std::vector<double> ways(at(n));
        double leap = 0.0;
        for (int k = 0; k < n; ++k) {
            const double square = rest.modes.squares[at(k)];
            if (!is_stiff(k)) continue;
            ways[at(k)] = first[at(k)] / square;
            if (!open[at(k)]) continue;
            const auto power = pinning::order(second[at(k)] / first[at(k)]);
            if (!power) continue;
            ways[at(k)] *= *power;
            leap = std::max(leap, std::abs(ways[at(k)]));
            softened = std::max(softened, std::abs(square));
        }
        if (leap == 0.0) return rest;
        const std::vector<double> step = taken(ways);
        rest.place = forces.stepped(rest.place, step);
        // at a zero of all coordinates leaps go on for ever; they end where they are nothing to those before, and to
        // the scene: from far away both are to be
        rest.is_found = leap <= pinning::last_leap * longest_leap;
        for (int i = 0; i < n; ++i)
            rest.is_found = rest.is_found && std::abs(step[at(i)]) <= pinning::last_leap * freedom_units[at(i)];
        longest_leap = std::max(longest_leap, leap);
        if (!rest.is_found) continue;
        forces.look_at(rest.place);
        rest.modes = small_modes(small_motion(forces));
        break;
    }
    for (int k = 0; k < n && !rest.flat.empty(); ++k)
        rest.flat[at(k)] = std::abs(rest.modes.squares[at(k)]) <= std::max(rest.modes.rounding[at(k)], 1e-3 * softened);
    if (rest.is_found) rest.place = without_dust(forces, rest.modes, std::move(rest.place));
    return rest;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
