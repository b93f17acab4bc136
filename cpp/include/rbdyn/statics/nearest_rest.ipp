// Definitions of rbdyn/statics/nearest_rest.hpp.
#pragma once

#include "rbdyn/statics/nearest_rest.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/search.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE std::optional<std::vector<double>> NearestRest::find() {
    consider(near_);
    if (std::vector<double> q = near_; settle(forces_, q)) consider(std::move(q));
    const bool is_small = forces_.freedoms() <= most_freedoms;
    // as far as a body is turned round, and about the scene
    const std::vector<double> units = forces_.units();
    for (const double reach : {0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0}) {
        if (best_) break;
        looks_about(reach, units);
    }
    constexpr int most_times = 6;
    const std::vector<double> ones(units.size(), 1.0);
    for (int time = 0; time < most_times && best_ && is_small && distance_ > 0.0; ++time)
        if (!looks_about(distance_, ones)) break;
    return best_;
}

RBDYN_INLINE bool NearestRest::looks_about(double reach, const std::vector<double>& units) {
    for (const double part : {0.9, 0.6, 0.3})
        for (const std::vector<double>& way : directions()) {
            std::vector<double> step = way;
            for (std::size_t i = 0; i < step.size(); ++i) step[i] *= part * reach * units[i];
            std::vector<double> q = forces_.moved(near_, step);
            if (consider(std::move(q))) return true;
        }
    return false;
}

RBDYN_INLINE bool NearestRest::consider(std::vector<double> q) {
    if (q != near_ && !forces_.at_rest(q).is_finite()) return false;
    if (!relax(forces_, q)) return false;
    q = turned_back(std::move(q));
    const double distance = forces_.distance(q, near_);
    // the same one, to rounding
    if (best_ && !(distance < (1.0 - 1e-9) * distance_)) return false;
    best_ = std::move(q);
    distance_ = distance;
    return true;
}

RBDYN_INLINE std::vector<double> NearestRest::turned_back(std::vector<double> q) {
    for (const TreeForces::Round& r : forces_.rounds()) {
        const auto i = static_cast<std::size_t>(r.position);
        const double turns = std::round((q[i] - near_[i]) / r.period);
        if (turns == 0.0) continue;
        std::vector<double> other = q;
        other[i] -= turns * r.period;
        const Forces::State there = forces_.at_rest(other);
        bool rests = there.is_finite() && there.pushed;
        for (std::size_t k = 0; rests && k < there.force.size(); ++k) {
            double size = there.effort[k];
            for (std::size_t j = 0; j < there.size.size(); ++j)
                size += std::abs(there.jacobian(static_cast<int>(k), static_cast<int>(j))) * there.size[j];
            rests = std::abs(there.force[k]) <= 1e-11 * size;
        }
        if (rests && relax(forces_, other)) q = std::move(other);
    }
    return q;
}

RBDYN_INLINE std::vector<std::vector<double>> NearestRest::directions() const {
    const auto n = static_cast<std::size_t>(forces_.freedoms());
    std::vector<std::vector<double>> result;
    const auto add = [&](const std::vector<double>& way) {
        result.push_back(way);
        result.push_back(way);
        for (double& x : result.back()) x = -x;
    };
    for (std::size_t i = 0; i < n && n <= most_freedoms; ++i) {
        std::vector<double> way(n);
        way[i] = 1.0;
        add(way);
    }
    if (n == 1) return result;
    // ways between them, always the same
    std::uint64_t state = 1;
    const std::size_t between = n <= most_freedoms ? 2 * n + 2 : 2;
    for (std::size_t k = 0; k < between; ++k) {
        std::vector<double> way(n);
        double square = 0.0;
        for (double& x : way) {
            // Knuth's multiplier for 64 bits
            state = state * 6364136223846793005u + 1442695040888963407u;
            x = static_cast<double>(state >> 11) * 0x1p-52 - 1.0;
            square += x * x;
        }
        for (double& x : way) x /= std::sqrt(square);
        add(way);
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
