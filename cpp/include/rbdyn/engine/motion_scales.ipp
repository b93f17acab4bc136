// Definitions of rbdyn/engine/motion_scales.hpp.
#pragma once

#include "rbdyn/engine/motion_scales.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void MotionScales::follow(std::span<const VariableGroup> groups) {
    groups_ = groups;
    has_floor_ = false;
    whole_.fill(0.0);
    std::array<int, kinds> count{};
    for (const VariableGroup& g : groups)
        if (g.alike != Alike::nothing) has_floor_ = ++count[index(g)] > 1 || has_floor_;
}

RBDYN_INLINE void MotionScales::widen(std::span<const double> x) {
    for (std::size_t i = 0; i < x.size(); ++i) {
        Variable& v = variables_[i];
        v.low = std::min(v.low, x[i]);
        v.high = std::max(v.high, x[i]);
        v.magnitude = std::max(v.magnitude, std::abs(x[i]));
    }
    if (!has_floor_) return;
    for (const VariableGroup& g : groups_)
        if (g.alike != Alike::nothing) whole_[index(g)] = std::max(whole_[index(g)], g.measure * own(g));
}

RBDYN_INLINE double MotionScales::scale(const VariableGroup& group) const {
    if (!has_floor_ || group.alike == Alike::nothing) return own(group);
    return std::max(own(group), floor * whole_[index(group)] / group.measure);
}

RBDYN_INLINE double MotionScales::magnitude(const VariableGroup& group) const {
    double magnitude = group.steady;
    for (int i = group.first; i < group.first + group.count; ++i)
        magnitude = std::max(magnitude, variables_[static_cast<std::size_t>(i)].magnitude);
    return magnitude;
}

RBDYN_INLINE double MotionScales::own(const VariableGroup& group) const {
    double scale = group.is_position ? 0.0 : group.steady;
    for (int i = group.first; i < group.first + group.count; ++i) {
        const Variable& v = variables_[static_cast<std::size_t>(i)];
        scale = std::max(scale, group.is_position ? v.high - v.low : v.magnitude);
    }
    return scale;
}

}  // namespace rbdyn::inline RBDYN_FORM
