// Definitions of rbdyn/curve/parabola.hpp.
#pragma once

#include "rbdyn/curve/parabola.hpp"

#include <cmath>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/checks.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Parabola::validate() const {
    curves::require_finite("parabola", "a", a);
    require(a != 0.0, "parabola", "a", a, "it must not be zero: use Line for a curve that does not bend");
    curves::require_plane("parabola", x, y, "x", "y");
    curves::require_finite("parabola", "vertex", vertex);
}

RBDYN_INLINE double Parabola::length(double u0, double u1) const {
    if ((u0 < 0.0 && u1 > 0.0) || (u0 > 0.0 && u1 < 0.0)) return length(u0, 0.0) + length(0.0, u1);
    const long double w0 = 2.0L * a * u0, w1 = 2.0L * a * u1;
    const long double q0 = std::hypot(1.0L, w0), q1 = std::hypot(1.0L, w1);
    if (w0 == 0.0L && w1 == 0.0L) return u1 - u0;
    const long double ratio = (w1 + w0) / (w1 * q1 + w0 * q0);
    const long double difference = 2.0L * a * (static_cast<long double>(u1) - u0);
    const long double turn = difference * (w1 + w0) / (w1 * q0 + w0 * q1);
    return static_cast<double>((difference * ratio * (1.0L + w1 * w1 + w0 * w0) + std::asinh(turn)) / (4.0L * a));
}

}  // namespace rbdyn::inline RBDYN_FORM
