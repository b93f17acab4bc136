// Definitions of rbdyn/statics/resolved_rest.hpp.
#pragma once

#include "rbdyn/statics/resolved_rest.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/statics/search.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

namespace resolving {

/// Whether forces go as their slopes say as far as `part` of every freedom's size from a place; along every one by
/// itself, of many along some ways between them.
inline bool goes_as_slopes_say(TreeForces& forces, const TreeForces::Wide& place, const SquareMatrix& slope,
                               const std::vector<double>& metric, const std::vector<double>& size, double part) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    constexpr int most_single = 24, most_mixed = 8;
    const TreeForces::Wide here = forces.force_at(place);
    constexpr double alike = 0.5;
    for (int k = 0; k < (n <= most_single ? n : most_mixed); ++k) {
        std::vector<double> step(at(n));
        for (int j = 0; j < n; ++j)
            if (n > most_single || j == k)
                step[at(j)] = ((j >> (k / 2)) + k) % 2 == 0 ? part * size[at(j)] : -part * size[at(j)];
        TreeForces::Wide there = forces.stepped(place, step);
        if (there == place) {
            // at the end of a rail
            for (double& x : step) x = -x;
            there = forces.stepped(place, step);
        }
        if (there.empty() || there == place) continue;
        const TreeForces::Wide f = forces.force_at(there);
        double predicted = 0.0, left = 0.0;
        for (int i = 0; i < n; ++i) {
            double change = 0.0;
            for (int j = 0; j < n; ++j) change += slope(i, j) * step[at(j)];
            const double unit = std::sqrt(metric[at(i)]);
            predicted = std::max(predicted, std::abs(change) / unit);
            const double over = std::abs((f[at(i)] - here[at(i)]).hi - change) / unit;
            if (!std::isfinite(over)) return false;
            left = std::max(left, over);
        }
        if (!(left <= alike * predicted)) return false;
    }
    return true;
}

}  // namespace resolving

RBDYN_INLINE bool is_resolved(TreeForces& forces, const std::vector<double>& q, const Forces::State& s) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    const auto is_rounding_of_terms = [&] {
        for (int i = 0; i < n; ++i)
            if (!(std::abs(s.force[at(i)]) <= 1024.0 * epsilon * s.effort[at(i)])) return false;
        return true;
    };
    // farther than that doubles do not tell places of the scene apart
    constexpr double far = 1e15, near = 1e-6, nothing = 0x1p-96;
    const std::vector<double> units = forces.units();
    // a place is known to its rounding, or to nothing beside the scene
    std::vector<double> size = s.size;
    for (int i = 0; i < n; ++i) size[at(i)] = std::max(size[at(i)], nothing * units[at(i)]);
    bool is_far = false;
    for (int i = 0; i < n; ++i) is_far = is_far || !(s.size[at(i)] <= far * units[at(i)]);
    if (!is_far && is_rounding_of_terms()) return true;
    if (is_far) {
        // what is linear is so at any distance, if it holds all freedoms
        const Stiffness stiffness(s);
        for (const double square : symmetric_eigenvalues(stiffness.symmetric))
            if (!(std::abs(square) > stiffness.rounding)) return false;
    }
    TreeForces::Wide place = forces.wide(q);
    if (place.empty()) return false;
    // in doubles slopes may vanish beside a zero of higher order that is not a double
    const auto slope_at = [&](const TreeForces::Wide& there) {
        forces.look_at(there);
        const WideMatrix wide = forces.wide_jacobian().entries;
        SquareMatrix slope(n);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) slope(i, j) = wide(i, j).hi;
        return slope;
    };
    const SquareMatrix here = slope_at(place);
    // what is more than rounding of terms and of the place is a force, however even
    constexpr double rounding = 4096.0 * epsilon;
    const std::vector<double> known = forces.force_sizes(place);
    for (int i = 0; i < n; ++i) {
        double most = s.effort[at(i)] + known[at(i)];
        for (int j = 0; j < n; ++j) most += std::abs(here(i, j)) * size[at(j)];
        if (!(std::abs(s.force[at(i)]) <= rounding * most) || !std::isfinite(most)) return false;
    }
    // farther than rounding of the place may have made a force pass for none
    if (resolving::goes_as_slopes_say(forces, place, here, s.metric, size, rounding)) return true;
    if (is_far) return false;
    constexpr int most_steps = 400;
    for (int iteration = 0; iteration < most_steps; ++iteration) {
        const SquareMatrix slope = slope_at(place);
        const TreeForces::Wide f = forces.force_at(place);
        const std::vector<double> sizes = forces.force_sizes(place);
        bool is_zero = true;
        std::vector<double> left;
        for (int i = 0; i < n; ++i) {
            left.push_back(-f[at(i)].hi);
            is_zero = is_zero && std::abs(f[at(i)].hi) <= nothing * sizes[at(i)];
        }
        if (is_zero) return true;
        const std::vector<double> step = solve(slope, left).x;
        is_zero = true;
        for (int i = 0; i < n; ++i) is_zero = is_zero && std::abs(step[at(i)]) <= nothing * size[at(i)];
        if (is_zero) return true;
        place = forces.stepped(place, step);
        if (place.empty()) return false;
        const std::vector<double> way = forces.difference(forces.nearest(place), q);
        for (int i = 0; i < n; ++i)
            if (!(std::abs(way[at(i)]) <= near * size[at(i)])) return false;
    }
    return false;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
