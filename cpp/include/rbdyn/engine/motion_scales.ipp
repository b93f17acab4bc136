// Definitions of rbdyn/engine/motion_scales.hpp.
#pragma once

#include "rbdyn/engine/motion_scales.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void MotionScales::follow(std::span<const VariableGroup> groups) {
    groups_ = groups;
    has_floor_ = false;
    whole_ = {};
    std::array<int, AlikeSizes::kinds> count{};
    for (const VariableGroup& g : groups)
        if (g.alike != Alike::nothing) has_floor_ = ++count[static_cast<std::size_t>(g.alike)] > 1 || has_floor_;
}

RBDYN_INLINE std::vector<double> MotionScales::largest() const {
    std::vector<double> all;
    for (const Variable& v : variables_) all.push_back(v.magnitude);
    return all;
}

RBDYN_INLINE std::vector<double> MotionScales::numbers() const {
    std::vector<double> all;
    for (const Variable& v : variables_) all.insert(all.end(), {v.low, v.high, v.magnitude});
    all.insert(all.end(), whole_.all().begin(), whole_.all().end());
    return all;
}

RBDYN_INLINE void MotionScales::set_numbers(std::span<const double> numbers) {
    for (std::size_t i = 0; i < variables_.size(); ++i)
        variables_[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(3 * variables_.size()), AlikeSizes::kinds,
                whole_.all().begin());
}

}  // namespace rbdyn::inline RBDYN_FORM
