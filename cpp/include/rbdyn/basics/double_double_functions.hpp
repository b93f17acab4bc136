// Exponential, sine and cosine of numbers of 32 digits, for the constants of closed forms: about a microsecond each.
//
// Power series after reduction of the argument, relative error of exp and absolute error of sin and cos about 2e-32,
// plus the argument's own rounding.
#pragma once

#include <cmath>

#include "rbdyn/basics/double_double.hpp"

namespace rbdyn {

template <class S>
struct SineCosine {
    S sine, cosine;
};

inline SineCosine<double> sine_cosine(double x) { return {std::sin(x), std::cos(x)}; }

inline DoubleDouble exp(const DoubleDouble& x) {
    constexpr DoubleDouble log_2{std::numbers::ln2, 2.3190468138462996e-17};
    if (x.hi < -745.0) return 0.0;
    if (x.hi > 709.0) return std::exp(x.hi);
    const double k = std::round(x.hi / log_2.hi);
    const DoubleDouble r = x - log_2 * k;
    // |r| < 0.35: 26 terms reach 2^-110
    DoubleDouble sum = 1.0;
    for (int n = 26; n > 0; --n) sum = 1.0 + r * sum / static_cast<double>(n);
    const int power = static_cast<int>(k);
    return {std::ldexp(sum.hi, power), std::ldexp(sum.lo, power)};
}

inline SineCosine<DoubleDouble> sine_cosine(const DoubleDouble& x) {
    const double quarters = std::round(x.hi / double_double::half_pi.hi);
    const DoubleDouble r = x - double_double::half_pi * quarters, r2 = r * r;
    // |r| < 0.79: powers up to the 28th reach 2^-106
    DoubleDouble sine = 1.0, cosine = 1.0;
    for (int n = 28; n > 0; n -= 2) {
        sine = 1.0 - r2 * sine / static_cast<double>(n * (n + 1));
        cosine = 1.0 - r2 * cosine / static_cast<double>(n * (n - 1));
    }
    sine *= r;
    switch (static_cast<int>(quarters - 4.0 * std::floor(quarters / 4.0))) {
        case 0: return {sine, cosine};
        case 1: return {cosine, -sine};
        case 2: return {-sine, -cosine};
        default: return {-cosine, sine};
    }
}

}  // namespace rbdyn
