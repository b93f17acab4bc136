// Definitions of rbdyn/statics/path_budget.hpp.
#pragma once

#include "rbdyn/statics/path_budget.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

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
    const bool is_behind = least * deep <= half && (!crests_.empty() || !is_past_first_);
    const int before = crests_.empty() ? 0 : crests_.back().count;
    count_ = is_behind ? before + 1 : count_ + 1;
    is_past_first_ = is_past_first_ || crests_.empty();
    crests_.push_back({half, count_, is_behind ? half : least});
    halves_.push_back(half);
    forces_.push_back(std::abs(force));
    largest_ = std::max(largest_, forces_.back());
}

RBDYN_INLINE bool PathBudget::is_left() const {
    return count_ < most_ || (taken_ < most_ + most_in_hollows && is_in_hollow());
}

RBDYN_INLINE bool PathBudget::is_in_hollow() const {
    const std::size_t count = std::min(halves_.size(), back);
    if (count < 2) return false;
    const auto [least, most] = std::minmax_element(halves_.end() - static_cast<std::ptrdiff_t>(count), halves_.end());
    if (!(*least * steep <= *most)) return false;
    // those that only grow are in none
    if (!(crests_.front().half > halves_.back())) return false;
    constexpr std::size_t octave = 8;
    if (least < most || count < 2 * octave + 1) return true;
    const auto force = [&](std::size_t pieces) { return forces_[forces_.size() - 1 - pieces]; };
    return !(force(0) >= largest_ && force(0) > 1.5 * force(octave) && force(octave) > 1.5 * force(2 * octave));
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
