// Exponential, sine and cosine of numbers of about 32 digits, by their Taylor series at a reduced argument.
#pragma once

#include <cmath>

#include "rbdyn/basics/double_double.hpp"

namespace rbdyn {

/// a 2^n.
inline DoubleDouble ldexp(const DoubleDouble& a, int n) { return {std::ldexp(a.hi, n), std::ldexp(a.lo, n)}; }

/// e^a.
inline DoubleDouble exp(const DoubleDouble& a) {
    constexpr DoubleDouble ln2{0.6931471805599453, 2.3190468138462996e-17};
    if (!(std::abs(a.hi) < 745.0)) return std::exp(a.hi);
    // e^a - 1 of a 512th of the rest, whose tenth term is below 1e-34; squared nine times
    const double n = std::nearbyint(a.hi / ln2.hi);
    const DoubleDouble r = ldexp(a - ln2 * n, -9);
    DoubleDouble sum = 1.0;
    for (int k = 9; k > 1; --k) sum = 1.0 + r * sum / static_cast<double>(k);
    sum *= r;
    for (int k = 0; k < 9; ++k) sum = ldexp(sum, 1) + sum * sum;
    return ldexp(sum + 1.0, static_cast<int>(n));
}

struct SineCosine {
    DoubleDouble sine, cosine;
};

/// Sine and cosine of an angle of moderate size: the error grows as 1e-33 of it.
inline SineCosine sine_cosine(const DoubleDouble& angle) {
    const double quarters = std::nearbyint(angle.hi / double_double::half_pi.hi);
    const DoubleDouble x = angle - double_double::half_pi * quarters, square = x * x;
    // at pi/4 the terms of order 29 and 30 are below 1e-33
    DoubleDouble sine = 1.0, cosine = 1.0;
    for (int k = 28; k > 0; k -= 2) {
        cosine = 1.0 - square * cosine / static_cast<double>(k * (k - 1));
        sine = 1.0 - square * sine / static_cast<double>(k * (k + 1));
    }
    sine *= x;
    switch (static_cast<int>(quarters - 4.0 * std::floor(quarters / 4.0))) {
        case 0: return {sine, cosine};
        case 1: return {cosine, -sine};
        case 2: return {-sine, -cosine};
        default: return {-cosine, sine};
    }
}

}  // namespace rbdyn
