// Definitions of rbdyn/model/compensated.hpp.
#pragma once

#include "rbdyn/model/compensated.hpp"

#include <cstddef>
#include <span>

#include "rbdyn/basics/instant.hpp"

namespace rbdyn::inline RBDYN_FORM::projecting {

RBDYN_INLINE void add(std::span<double> x, std::span<double> low, int index, double change) {
    const auto i = static_cast<std::size_t>(index);
    const Instant sum = exact_sum(x[i], low[i] + change);
    x[i] = sum.hi;
    low[i] = sum.lo;
}

RBDYN_INLINE void add(std::span<double> x, std::span<double> low, int index, long double change) {
    const auto i = static_cast<std::size_t>(index);
    const long double value = static_cast<long double>(x[i]) + change;
    const auto high = static_cast<double>(value);
    const Instant sum = exact_sum(high, low[i] + static_cast<double>(value - static_cast<long double>(high)));
    x[i] = sum.hi;
    low[i] = sum.lo;
}

}  // namespace rbdyn::inline RBDYN_FORM::projecting
