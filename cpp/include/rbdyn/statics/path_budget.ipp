// Definitions of rbdyn/statics/path_budget.hpp.
#pragma once

#include "rbdyn/statics/path_budget.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE PathBudget::PathBudget(int most, double half) : most_(most), longest_(half) {
    crests_.push_back({half, 0, half});
}

RBDYN_INLINE void PathBudget::take(double half, double force) {
    ++taken_;
    longest_ = std::max(longest_, half);
    double least = half;
    while (!crests_.empty() && crests_.back().half < half) {
        least = std::min(least, crests_.back().least);
        crests_.pop_back();
    }
    const bool is_behind = !crests_.empty() && least * deep <= half;
    count_ = is_behind ? crests_.back().count + 1 : count_ + 1;
    crests_.push_back({half, count_, is_behind ? half : least});
    halves_.push_back(half);
    forces_.push_back(std::abs(force));
}

RBDYN_INLINE bool PathBudget::is_left() const {
    return count_ < most_ || (taken_ < most_ + most_in_hollows && is_in_hollow());
}

RBDYN_INLINE bool PathBudget::is_in_hollow() const {
    if (halves_.size() <= back) return false;
    const std::size_t last = halves_.size() - 1;
    const auto [least, most] = std::minmax_element(halves_.end() - back, halves_.end());
    if (!(*least * steep <= *most)) return false;
    if (least > most) {
        const double now = forces_[last], before = forces_[last - back / 2], first = forces_[last - back];
        return !(now > 1.5 * before && before > 1.5 * first);
    }
    // those that only grow are in none
    return crests_.front().half > halves_[last];
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
