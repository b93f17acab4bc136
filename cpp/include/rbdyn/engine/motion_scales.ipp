// Definitions of rbdyn/engine/motion_scales.hpp.
#pragma once

#include "rbdyn/engine/motion_scales.hpp"

#include <array>
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

}  // namespace rbdyn::inline RBDYN_FORM
