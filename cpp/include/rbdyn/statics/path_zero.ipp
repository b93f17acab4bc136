// Definitions of rbdyn/statics/path_zero.hpp.
#pragma once

#include "rbdyn/statics/path_zero.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/path_pieces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE std::optional<PathZero> PathZeros::near(double u, double half) {
    const PathPiece& first = pieces_.about(u, half);
    double bound = 0.0;
    for (const double c : first.output[PathForces::along]) bound += std::abs(c);
    // several in one show as a slope that is small beside the rest
    const bool is_simple = std::abs(first.output[PathForces::along][1]) > 1e-2 * bound;
    for (int m = is_simple ? 1 : order; m >= 1; --m)
        if (const auto zero = of_order(m, u, half)) return zero;
    look(u, half);
    if (std::abs(c_[0]) > rounding_[0]) return std::nullopt;
    // as far as the slope tells, and the piece
    const double radius = half * std::min(rounding_[0] / std::abs(c_[1]), 0.25);
    return PathZero{u, 0, 0.0, std::isfinite(radius) ? radius : 0.0};
}

RBDYN_INLINE void PathZeros::look(double u, double half) {
    c_ = pieces_.about(u, half).output[PathForces::along];
    const std::array<double, order + 1> sizes = pieces_.sizes();
    const double aside = 2.0 * epsilon * std::abs(u) / half;
    for (int k = 0; k <= order; ++k) {
        const auto i = static_cast<std::size_t>(k);
        // a coefficient of order k is summed k times over
        rounding_[i] = 2.0 * (k + 4) * epsilon * sizes[i];
        if (k < order) rounding_[i] += (k + 1) * std::abs(c_[i + 1]) * aside;
    }
}

RBDYN_INLINE std::optional<PathZero> PathZeros::of_order(int m, double u, double half) {
    const auto k = static_cast<std::size_t>(m);
    double place = u, last = 1.0;
    // by Newton's method on the derivative of order m - 1
    for (int iteration = 0; iteration < 10; ++iteration) {
        const auto& c = pieces_.about(place, half).output[PathForces::along];
        const double x = -c[k - 1] / (m * c[k]);
        if (!(std::abs(x) < 0.5 * last)) break;
        last = std::abs(x);
        const double before = std::exchange(place, place + half * x);
        if (place == before) break;
        if (std::abs(place) > 1e-6 * std::abs(before)) continue;
        // at zero, where all terms vanish, Newton's steps are never small: their error leaves zero itself
        look(before, half);
        if (std::abs(place) <= half * rounding_[k - 1] / std::abs(m * c_[k])) place = 0.0;
    }
    if (!(std::abs(place - u) <= 0.25 * half)) return std::nullopt;
    look(place, half);
    if (!(std::abs(c_[k]) > 4.0 * rounding_[k])) return std::nullopt;
    PathZero zero{place, m, c_[k], 0.0};
    for (std::size_t j = 0; j < k; ++j) {
        if (!(std::abs(c_[j]) <= rounding_[j])) return std::nullopt;
        zero.radius =
            std::max(zero.radius, half * std::pow(rounding_[j] / std::abs(c_[k]), 1.0 / static_cast<double>(k - j)));
    }
    return zero;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
