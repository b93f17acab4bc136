// Elementary functions of numbers of 32 digits, for the constants of equations and of closed forms, and for starts: one
// to three microseconds each.
//
// Power series after reduction of the argument; inverses by one step of Newton's from the double. Relative error of
// exp, log (of its argument's, near 1), sinh, cosh, tanh about 2e-32, absolute error of sin, cos and angles too, plus
// the argument's own rounding.
#pragma once

#include <cmath>
#include <numbers>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class S>
struct SineCosine {
    S sine, cosine;
};

inline SineCosine<double> sine_cosine(double x) { return {std::sin(x), std::cos(x)}; }

inline DoubleDouble exp(const DoubleDouble& x) {
    constexpr DoubleDouble log_2{std::numbers::ln2, 2.3190468138462996e-17};
    if (x.hi < -745.0) return 0.0;
    if (!(x.hi <= 709.0)) return std::exp(x.hi);
    const double k = std::round(x.hi / log_2.hi);
    const DoubleDouble r = x - log_2 * k;
    // |r| < 0.35: 26 terms reach 2^-110
    DoubleDouble sum = 1.0;
    for (int n = 26; n > 0; --n) sum = 1.0 + r * sum / static_cast<double>(n);
    const int power = static_cast<int>(k);
    return {std::ldexp(sum.hi, power), std::ldexp(sum.lo, power)};
}

inline SineCosine<DoubleDouble> sine_cosine(const DoubleDouble& x) {
    if (!std::isfinite(x.hi)) return {std::sin(x.hi), std::cos(x.hi)};
    // beyond 2^100 the last of 32 digits is longer than a turn
    if (!(std::abs(x.hi) < 0x1p100)) return {std::sin(x.hi), std::cos(x.hi)};
    double quarters = std::round(x.hi / double_double::half_pi.hi);
    DoubleDouble r = x - double_double::half_pi * quarters;
    // of more than 2^50 turns their number is rounded, too
    while (std::abs(r.hi) > 0.8) {
        const double more = std::round(r.hi / double_double::half_pi.hi);
        r -= double_double::half_pi * more;
        quarters = std::fmod(quarters, 4.0) + std::fmod(more, 4.0);
    }
    const DoubleDouble r2 = r * r;
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
inline DoubleDouble sin(const DoubleDouble& x) { return sine_cosine(x).sine; }
inline DoubleDouble cos(const DoubleDouble& x) { return sine_cosine(x).cosine; }

inline DoubleDouble cosh(const DoubleDouble& x) {
    const DoubleDouble e = exp(abs(x));
    return 0.5 * (e + 1.0 / e);
}
inline DoubleDouble sinh(const DoubleDouble& x) {
    if (std::abs(x.hi) > 0.5) {
        const DoubleDouble e = exp(abs(x)), s = 0.5 * (e - 1.0 / e);
        return x.hi < 0.0 ? -s : s;
    }
    // powers up to the 24th reach 2^-110
    const DoubleDouble x2 = x * x;
    DoubleDouble sum = 1.0;
    for (int n = 24; n > 0; n -= 2) sum = 1.0 + x2 * sum / static_cast<double>(n * (n + 1));
    return x * sum;
}
inline DoubleDouble tanh(const DoubleDouble& x) {
    if (!(std::abs(x.hi) < 40.0)) return std::tanh(x.hi);
    return sinh(x) / cosh(x);
}

inline DoubleDouble log(const DoubleDouble& x) {
    const double once = std::log(x.hi);
    if (!std::isfinite(once) || !std::isfinite(x.hi)) return once;
    // what x over its exponential is more than 1; the rest of its logarithm is beyond all digits
    const DoubleDouble rest = x * exp(-DoubleDouble(once)) - 1.0;
    return once + rest * (1.0 - 0.5 * rest);
}
inline DoubleDouble pow(const DoubleDouble& x, double n) {
    const double once = std::pow(x.hi, n);
    if (!std::isfinite(once) || once == 0.0 || x.hi == 0.0) return once;
    if (n == std::floor(n) && std::abs(n) <= 64.0) {
        DoubleDouble result = 1.0, base = x;
        for (int k = static_cast<int>(std::abs(n)); k > 0; k /= 2) {
            if (k % 2 == 1) result *= base;
            base *= base;
        }
        return n < 0.0 ? 1.0 / result : result;
    }
    return exp(n * log(x));
}

inline DoubleDouble pow(const DoubleDouble& x, const DoubleDouble& n) {
    return n.lo == 0.0 ? pow(x, n.hi) : exp(n * log(x));
}

inline DoubleDouble expm1(const DoubleDouble& x) {
    if (std::abs(x.hi) > 1.0) return exp(x) - 1.0;
    return 2.0 * exp(0.5 * x) * sinh(0.5 * x);
}
inline DoubleDouble log1p(const DoubleDouble& x) {
    const double once = std::log1p(x.hi);
    if (!std::isfinite(once) || once == 0.0) return once == 0.0 ? x : DoubleDouble(once);
    if (!(x.hi > -0.5 && x.hi < 1.0)) return log(1.0 + x);
    const DoubleDouble rest = (x - expm1(DoubleDouble(once))) * exp(-DoubleDouble(once));
    return once + rest * (1.0 - 0.5 * rest);
}
inline DoubleDouble asinh(const DoubleDouble& x) {
    const double once = std::asinh(x.hi);
    if (!std::isfinite(once) || once == 0.0) return once == 0.0 ? x : DoubleDouble(once);
    const DoubleDouble size = abs(x);
    // what its root is more than x, beyond all digits
    constexpr double large = 1e17;
    if (size.hi > large) {
        const DoubleDouble result = log(size) + log(DoubleDouble(2.0));
        return x.hi < 0.0 ? -result : result;
    }
    const DoubleDouble s = sinh(DoubleDouble(once)), c = cosh(DoubleDouble(once)), rest = (x - s) / c;
    return once + rest * (1.0 - 0.5 * (s / c) * rest);
}
inline DoubleDouble atanh(const DoubleDouble& x) {
    if (x.hi < 0.0) return -atanh(-x);
    if (!(x.hi < 1.0)) return std::atanh(x.hi);
    return 0.5 * log1p(2.0 * x / (1.0 - x));
}

/// The angle of the point (x, y).
inline DoubleDouble atan2(const DoubleDouble& y, const DoubleDouble& x) {
    const double once = std::atan2(y.hi, x.hi);
    if (!std::isfinite(once) || !std::isfinite(x.hi) || !std::isfinite(y.hi) || once == 0.0) return once;
    // the angle that is left when it is turned back
    const auto [s, c] = sine_cosine(DoubleDouble(once));
    return once + (y * c - x * s) / (x * c + y * s);
}
inline DoubleDouble asin(const DoubleDouble& x) { return atan2(x, sqrt((1.0 - x) * (1.0 + x))); }
inline DoubleDouble acos(const DoubleDouble& x) { return atan2(sqrt((1.0 - x) * (1.0 + x)), x); }

}  // namespace rbdyn::inline RBDYN_FORM
