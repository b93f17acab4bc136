// Definitions of rbdyn/statics/natural_length.hpp.
#pragma once

#include "rbdyn/statics/natural_length.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE double bend(TreeForces& forces, const TreeForces::Wide& place, const std::vector<double>& direction) {
    constexpr double none = std::numeric_limits<double>::infinity();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    forces.look_at(place);
    const WideMatrix slope = forces.wide_jacobian().entries, mass = forces.wide_mass();
    const TreeForces::Wide here = forces.force_at(place);
    const std::vector<double> sizes = forces.force_sizes(place);
    std::vector<double> root, change;
    for (int i = 0; i < n; ++i) root.push_back(std::sqrt(mass(i, i).hi));
    double steepest = 0.0, length = 0.0, farthest = 0.0, noise = 0.0;
    // what 32 digits leave, where constraints are closed to fewer
    const double digits = forces.has_constraints() ? 0x1p-70 : 0x1p-90;
    for (int i = 0; i < n; ++i) {
        double sum = 0.0;
        for (int j = 0; j < n; ++j) {
            sum += slope(i, j).hi * direction[at(j)];
            steepest = std::max(steepest, std::abs(slope(i, j).hi) / (root[at(i)] * root[at(j)]));
        }
        change.push_back(sum);
        length = std::max(length, std::abs(direction[at(i)]) * root[at(i)]);
        farthest = std::max(farthest, std::abs(direction[at(i)]));
        noise = std::max(noise, digits * sizes[at(i)] / root[at(i)]);
    }
    const double rate = steepest * length;
    if (!(rate > 0.0) || !std::isfinite(rate)) return none;
    const auto is_bent = [&](double s) {
        std::vector<double> step;
        for (const double x : direction) step.push_back(s * x);
        const TreeForces::Wide there = forces.stepped(place, step);
        if (there.empty()) return true;
        const TreeForces::Wide f = forces.force_at(there);
        double most = 0.0;
        for (int i = 0; i < n; ++i) {
            const double left = ((f[at(i)] - here[at(i)]) - DoubleDouble(s * change[at(i)])).hi / root[at(i)];
            if (!std::isfinite(left)) return true;
            most = std::max(most, std::abs(left));
        }
        return most >= 0.5 * s * rate;
    };
    // large strides, powers of two, then halves between them, so that no unit shows; below the first 32 digits do not
    // tell the places apart
    constexpr double stride = 0x1p20, longest = 1e280;
    double low = std::max({noise / rate, 1e-280 / rate, 1e-280});
    for (const DoubleDouble& x : place) low = std::max(low, 0x1p-90 * std::abs(x.hi) / farthest);
    low = std::exp2(std::ceil(std::log2(low)));
    for (double s = low; s < longest && s * rate < longest; s *= stride) {
        if (!is_bent(s)) continue;
        double bent = s;
        for (double t = std::max(low, s / stride); t < bent; t *= 2.0)
            if (is_bent(t)) bent = t;
        double straight = 0.5 * bent;
        constexpr int halvings = 20;
        for (int i = 0; i < halvings && bent > low; ++i) {
            const double between = straight + 0.5 * (bent - straight);
            (is_bent(between) ? bent : straight) = between;
        }
        return bent;
    }
    return none;
}

RBDYN_INLINE double natural_length(TreeForces& forces, const TreeForces::Wide& place) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < forces.freedoms(); ++i) {
        std::vector<double> one(static_cast<std::size_t>(forces.freedoms()));
        one[static_cast<std::size_t>(i)] = 1.0;
        forces.look_at(place);
        const double moving = forces.largest_move(one);
        if (!(moving > 0.0) || forces.largest_turn(one) > 0.0) continue;
        least = std::min(least, moving * bend(forces, place, one));
    }
    return least;
}

RBDYN_INLINE double reach_along(TreeForces& forces, const TreeForces::Wide& place, const std::vector<double>& direction,
                                double least) {
    double longest = std::numeric_limits<double>::infinity();
    forces.look_at(place);
    if (const double turning = forces.largest_turn(direction); turning > 0.0) longest = 0.5 / turning;
    if (const double moving = forces.largest_move(direction); moving > 0.0) {
        const double bent = bend(forces, place, direction);
        longest =
            std::min(longest, std::isfinite(bent) ? 0.125 * bent : 0.5 * std::max(forces.extent() / moving, least));
    }
    return longest;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
