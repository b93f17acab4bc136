// Definitions of rbdyn/closed_form/carlson.hpp.
#pragma once

#include "rbdyn/closed_form/carlson.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rbdyn/basics/double_double.hpp"

namespace rbdyn::inline RBDYN_FORM::elliptic {

RBDYN_INLINE DoubleDouble carlson_f(DoubleDouble x, DoubleDouble y, DoubleDouble z) {
    if ((x.hi == 0.0) + (y.hi == 0.0) + (z.hi == 0.0) > 1) return std::numeric_limits<double>::infinity();
    for (;;) {
        const DoubleDouble mean = (x + y + z) / 3.0;
        const double spread = std::max({std::abs(mean.hi - x.hi), std::abs(mean.hi - y.hi), std::abs(mean.hi - z.hi)});
        // the first term left out is of the eighth order: 2^-112 here
        if (!(spread > 0x1p-14 * mean.hi)) {
            const DoubleDouble a = 1.0 - x / mean, b = 1.0 - y / mean, c = 1.0 - z / mean;
            const DoubleDouble s = a * b + b * c + c * a, p = a * b * c;
            const DoubleDouble sum = 1.0 - s / 10.0 + p / 14.0 + s * s / 24.0 - 3.0 * s * p / 44.0 -
                                     5.0 * s * s * s / 208.0 + 3.0 * p * p / 104.0 + s * s * p / 16.0;
            return sum / sqrt(mean);
        }
        const DoubleDouble rx = sqrt(x), ry = sqrt(y), rz = sqrt(z), shift = rx * ry + ry * rz + rz * rx;
        x = (x + shift) * 0.25;
        y = (y + shift) * 0.25;
        z = (z + shift) * 0.25;
    }
}

RBDYN_INLINE DoubleDouble arithmetic_geometric_mean(DoubleDouble a, DoubleDouble b) {
    if (b.hi == 0.0) return 0.0;
    // the difference squares at each step: from 1e-15 the next mean has all digits
    for (bool last = false; !last;) {
        last = !(std::abs(a.hi - b.hi) > 1e-15 * a.hi);
        const DoubleDouble mean = (a + b) * 0.5;
        b = sqrt(a * b);
        a = mean;
    }
    return a;
}

}  // namespace rbdyn::inline RBDYN_FORM::elliptic
