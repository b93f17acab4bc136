// Elliptic integrals to about 31 digits: complete ones by the arithmetic-geometric mean, incomplete ones by Carlson's
// symmetric form (Carlson, "Numerical computation of real or complex elliptic integrals", 1995; DLMF 19.8, 19.36).
//
// Both work on differences of roots that the caller hands in with all their digits, so nothing is lost near the limits
// k = 0 and k = 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "rbdyn/basics/double_double.hpp"

namespace rbdyn {

/// The common limit of arithmetic and geometric means of a, b >= 0.
inline DoubleDouble arithmetic_geometric_mean(DoubleDouble a, DoubleDouble b) {
    if (b.hi == 0.0) return 0.0;
    // the difference squares at each step: from 1e-16 the next mean has all digits
    for (bool last = false; !last;) {
        last = std::abs(a.hi - b.hi) < 1e-15 * a.hi;
        const DoubleDouble mean = (a + b) * 0.5;
        b = sqrt(a * b);
        a = mean;
    }
    return a;
}

/// K(k) from k' = sqrt(1 - k^2); infinite at k' = 0.
inline DoubleDouble complete_elliptic_integral(const DoubleDouble& complementary_modulus) {
    return double_double::half_pi / arithmetic_geometric_mean(1.0, complementary_modulus);
}

/// Carlson's R_F(x, y, z) = 1/2 integral over s > 0 of ds / sqrt((s + x)(s + y)(s + z)) of arguments that are not
/// negative; infinite where two of them are zero.
inline DoubleDouble carlson_rf(DoubleDouble x, DoubleDouble y, DoubleDouble z) {
    if ((x.hi == 0.0) + (y.hi == 0.0) + (z.hi == 0.0) > 1) return std::numeric_limits<double>::infinity();
    // duplication until the series in the relative differences, cut after order 7, leaves 1e-33
    constexpr double close = 1e-4;
    DoubleDouble mean;
    for (;;) {
        mean = (x + y + z) / 3.0;
        const double spread = std::max({std::abs(mean.hi - x.hi), std::abs(mean.hi - y.hi), std::abs(mean.hi - z.hi)});
        if (!(spread > close * mean.hi)) break;
        const DoubleDouble a = sqrt(x), b = sqrt(y), c = sqrt(z), shift = a * b + c * (a + b);
        x = (x + shift) * 0.25;
        y = (y + shift) * 0.25;
        z = (z + shift) * 0.25;
    }
    const DoubleDouble u = (mean - x) / mean, v = (mean - y) / mean, w = -u - v;
    const DoubleDouble e2 = u * v - w * w, e3 = u * v * w, square = e2 * e2;
    const DoubleDouble series = 1.0 - e2 / 10.0 + e3 / 14.0 + square / 24.0 - e2 * e3 * 3.0 / 44.0 -
                                square * e2 * 5.0 / 208.0 + e3 * e3 * 3.0 / 104.0 + square * e3 / 16.0;
    return series / sqrt(mean);
}

}  // namespace rbdyn
