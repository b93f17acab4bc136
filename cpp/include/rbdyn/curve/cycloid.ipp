// Definitions of rbdyn/curve/cycloid.hpp.
#pragma once

#include "rbdyn/curve/cycloid.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "rbdyn/curve/checks.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Cycloid::validate() const {
    curves::require_positive("cycloid", "radius", radius, "m");
    curves::require_plane("cycloid", x, y, "x", "y");
    curves::require_finite("cycloid", "vertex", vertex);
}

RBDYN_INLINE double Cycloid::length(double u0, double u1) const {
    if (u1 < u0) return -length(u1, u0);
    constexpr long double turn = 2.0L * std::numbers::pi_v<long double>;
    const auto arch = [&](double u) { return std::floor(static_cast<long double>(u) / turn + 0.5L); };
    const long double first = arch(u0), last = arch(u1), R = radius;
    const long double half0 = 0.5L * u0, half1 = 0.5L * u1;
    if (first == last)
        return static_cast<double>(8.0L * R * std::abs(std::cos(0.5L * (half0 + half1))) *
                                   std::sin(0.5L * (half1 - half0)));
    // 1 - sin is twice the square of a sine: from u0 to the cusp after it, from the cusp before u1
    const long double to_cusp = std::sin(0.25L * ((first + 0.5L) * turn - u0));
    const long double from_cusp = std::sin(0.25L * (u1 - (last - 0.5L) * turn));
    return static_cast<double>(8.0L * R * (to_cusp * to_cusp + from_cusp * from_cusp + (last - first - 1.0L)));
}

RBDYN_INLINE bool Cycloid::regular_at(double u) const {
    return std::abs(std::cos(0.5 * u)) > 0.5 * std::numeric_limits<double>::epsilon() * std::abs(u);
}

}  // namespace rbdyn::inline RBDYN_FORM
