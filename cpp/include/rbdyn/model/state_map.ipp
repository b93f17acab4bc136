// Definitions of rbdyn/model/state_map.hpp.
#pragma once

#include "rbdyn/model/state_map.hpp"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE StateMap::StateMap(std::vector<double> start, const std::vector<bool>& stays, std::vector<double> rest)
    : all_(std::move(start)), rest_(std::move(rest)) {
    for (std::size_t i = 0; i < all_.size(); ++i) place_.push_back(stays[i] ? -1 : size_++);
}

RBDYN_INLINE DoubleDouble StateMap::exact_start(int variable) const {
    return {start(variable), rest_.empty() ? 0.0 : rest_[static_cast<std::size_t>(variable)]};
}

RBDYN_INLINE double StateMap::value(int variable, std::span<const double> x) const {
    const int i = place(variable);
    return i < 0 ? start(variable) : x[static_cast<std::size_t>(i)];
}

RBDYN_INLINE void StateMap::spread(std::span<const double> x, std::span<double> all) const {
    for (int i = 0; i < variables(); ++i) all[static_cast<std::size_t>(i)] = value(i, x);
}

RBDYN_INLINE void StateMap::spread_zero(std::span<const double> x, std::span<double> all) const {
    for (int i = 0; i < variables(); ++i)
        all[static_cast<std::size_t>(i)] = is_simulated(i) ? x[static_cast<std::size_t>(place(i))] : 0.0;
}

RBDYN_INLINE void StateMap::gather(std::span<const double> all, std::span<double> x) const {
    for (int i = 0; i < variables(); ++i)
        if (is_simulated(i)) x[static_cast<std::size_t>(place(i))] = all[static_cast<std::size_t>(i)];
}

}  // namespace rbdyn::inline RBDYN_FORM
