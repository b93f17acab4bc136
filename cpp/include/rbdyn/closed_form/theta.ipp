// Definitions of rbdyn/closed_form/theta.hpp.
#pragma once

#include "rbdyn/closed_form/theta.hpp"

#include <cmath>
#include <complex>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/closed_form/carlson.hpp"
#include "rbdyn/closed_form/lagrange_top.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Theta::Theta(const DoubleDouble& m, const DoubleDouble& complement) {
    using elliptic::arithmetic_geometric_mean;
    const DoubleDouble k_mean = arithmetic_geometric_mean(1.0, sqrt(complement));
    const DoubleDouble co_mean = arithmetic_geometric_mean(1.0, sqrt(m));
    quarter_ = infinite_if_zero(k_mean);
    co_quarter_ = infinite_if_zero(co_mean);
    hyperbolic_ = m.hi > 0.5;
    scale_ = hyperbolic_ ? co_mean : k_mean;
    const DoubleDouble& other = hyperbolic_ ? k_mean : co_mean;
    period_ = double_double::pi;
    if (hyperbolic_) period_ = other.hi == 0.0 ? DoubleDouble(INFINITY) : double_double::pi * scale_ / other;
    nome_ = other.hi == 0.0 ? DoubleDouble(0.0) : exp(-double_double::pi * scale_ / other);
    for (int n = 0; n < terms; ++n) {
        square_[n] = std::pow(nome_.hi, n * n);
        below_square_[n] = std::pow(nome_.hi, n * (n - 1));
    }
}

RBDYN_INLINE std::complex<double> Theta::first(const Quotient& f, const Waves& at) {
    return sums(f, at.first_real, at.first_imaginary) / at.denominator;
}

RBDYN_INLINE std::complex<double> Theta::second(const Quotient& f, const Waves& at) {
    return sums(f, at.second_real, at.second_imaginary) / at.denominator;
}

RBDYN_INLINE Theta::Quotient Theta::quotient_first(const DoubleDouble& w) const {
    return hyperbolic_ ? hyperbolic(w, true) : circular(w, -1.0);
}

RBDYN_INLINE Theta::Quotient Theta::quotient_second(const DoubleDouble& w) const {
    return hyperbolic_ ? hyperbolic(w, false) : circular(w, 1.0);
}

RBDYN_INLINE std::complex<double> Theta::slope_first(const Quotient& f, double z) const {
    const Waves at = waves(z), d = slopes(z, at);
    return slope(f, first(f, at), sums(f, d.first_real, d.first_imaginary), at.denominator, d.denominator);
}

RBDYN_INLINE std::complex<double> Theta::slope_second(const Quotient& f, double z) const {
    const Waves at = waves(z), d = slopes(z, at);
    return slope(f, second(f, at), sums(f, d.second_real, d.second_imaginary), at.denominator, d.denominator);
}

RBDYN_INLINE DoubleDouble Theta::infinite_if_zero(const DoubleDouble& mean) {
    return mean.hi == 0.0 ? DoubleDouble(INFINITY) : double_double::half_pi / mean;
}

RBDYN_INLINE std::complex<double> Theta::sums(const Quotient& f, const double* a, const double* b) {
    return {f.real[0] * a[0] + f.real[1] * a[1] + f.real[2] * a[2] + f.real[3] * a[3],
            f.imaginary[0] * b[0] + f.imaginary[1] * b[1] + f.imaginary[2] * b[2] + f.imaginary[3] * b[3]};
}

RBDYN_INLINE std::complex<double> Theta::slope(const Quotient& f, std::complex<double> value, std::complex<double> rise,
                                               double denominator, double denominator_rise) {
    return (rise - value * denominator_rise) / denominator + std::complex<double>(0.0, f.twist) * value;
}

RBDYN_INLINE Theta::Waves Theta::circular_waves(double x) const {
    const double s = std::sin(x), c = std::cos(x);
    const double s2 = 2.0 * s * c, c2 = 1.0 - 2.0 * s * s;
    const double s3 = s * c2 + c * s2, c3 = c * c2 - s * s2, s5 = s3 * c2 + c3 * s2, c5 = c3 * c2 - s3 * s2;
    const double s7 = s5 * c2 + c5 * s2, c7 = c5 * c2 - s5 * s2;
    const double c4 = 2.0 * c2 * c2 - 1.0, c6 = c2 * (2.0 * c4 - 1.0);
    return {{s, s3, s5, s7},
            {c, c3, c5, c7},
            {c, c3, c5, c7},
            {s, s3, s5, s7},
            1.0 - 2.0 * (square_[1] * c2 - square_[2] * c4 + square_[3] * c6)};
}

RBDYN_INLINE Theta::Waves Theta::hyperbolic_waves(double y) const {
    const double e = std::exp(-std::abs(y)), f = e * e, r = square_[1] == 0.0 ? 0.0 : square_[1] / f,
                 sign = y < 0.0 ? -1.0 : 1.0;
    Waves at;
    at.denominator = 0.0;
    double rise = 1.0, fall = f, even_fall = e;  // r^n <= 1, q^n f^(n+1), e f^n
    for (int n = 0; n < terms; ++n) {
        const double a = square_[n] * rise, b = square_[n] * fall;
        at.first_real[n] = sign * (a - b);
        at.first_imaginary[n] = a + b;
        at.denominator += a + b;
        const double c = below_square_[n] * rise * e, d = square_[n] * even_fall;
        at.second_real[n] = n == 0 ? e : c + d;
        at.second_imaginary[n] = n == 0 ? 0.0 : sign * (c - d);
        rise *= r;
        fall *= square_[1] * f;
        even_fall *= f;
    }
    return at;
}

RBDYN_INLINE Theta::Waves Theta::slopes(double z, const Waves& at) const {
    const double turn = hyperbolic_ ? 1.0 : -1.0;
    Waves d{};
    for (int n = 0; n < terms; ++n) {
        const double odd = 2.0 * n + 1.0, second = hyperbolic_ ? 2.0 * n : odd;
        d.first_real[n] = odd * at.first_imaginary[n];
        d.first_imaginary[n] = turn * odd * at.first_real[n];
        d.second_real[n] = turn * second * at.second_imaginary[n];
        d.second_imaginary[n] = second * at.second_real[n];
        d.denominator +=
            hyperbolic_ ? odd * at.first_real[n] : (n % 2 == 0 ? -4.0 : 4.0) * n * square_[n] * std::sin(2.0 * n * z);
    }
    return d;
}

RBDYN_INLINE Theta::Quotient Theta::circular(const DoubleDouble& w, double alternation) const {
    Quotient f;
    const DoubleDouble s = abs(w) * scale_;
    const DoubleDouble fall = exp(-2.0 * s);
    // q e^{2s} <= 1; without a nome it is not needed, and K' is infinite
    const DoubleDouble rise = nome_.hi == 0.0 ? DoubleDouble(0.0) : exp(2.0 * (s - scale_ * co_quarter_));
    const double side = w.hi < 0.0 ? -1.0 : 1.0;
    DoubleDouble even = 0.0, odd = 0.0, power = 1.0, rises = 1.0, falls = fall;
    double sign = 1.0;
    for (int n = 0; n <= set_up_terms; ++n) {
        const DoubleDouble a = power * rises, b = power * falls;  // q^{n^2} times r^n, q^n e^{-2(n+1)s}
        even += a + b;
        odd += (a - b) * (2.0 * n + 1.0);
        if (n < terms) {
            f.real[n] = sign * ((a + b) / (1.0 + fall)).hi;
            f.imaginary[n] = alternation * side * sign * ((a - b) / (1.0 + fall)).hi;
        }
        rises *= rise;
        falls *= nome_ * fall;
        for (int i = 0; i < 2 * n + 1; ++i) power *= nome_;
        sign *= alternation;
    }
    f.drift = -scale_ * odd / even * side;
    return f;
}

RBDYN_INLINE Theta::Quotient Theta::hyperbolic(const DoubleDouble& w, bool odd) const {
    Quotient f;
    const DoubleDouble left = isfinite(quarter_) ? w / quarter_ : DoubleDouble(0.0);
    f.twist = left.hi;
    const auto turned = [](const SineCosine<DoubleDouble>& a, const SineCosine<DoubleDouble>& b) {
        return SineCosine<DoubleDouble>{a.sine * b.cosine + a.cosine * b.sine, a.cosine * b.cosine - a.sine * b.sine};
    };
    const SineCosine<DoubleDouble> once = sine_cosine(w * scale_), twice = turned(once, once);
    SineCosine<DoubleDouble> even{0.0, 1.0};
    DoubleDouble value = 0.0, rise = 0.0, power = 1.0;
    double sign = 1.0;
    for (int n = 0; n <= set_up_terms; ++n, sign = -sign) {
        if (n < terms) {
            const SineCosine<DoubleDouble> at = odd ? turned(even, once) : even;
            f.real[n] = sign * at.cosine.hi;
            f.imaginary[n] = -sign * at.sine.hi;
        }
        const DoubleDouble weight = power * (n == 0 ? 1.0 : 2.0 * sign);
        value += weight * even.cosine;
        rise -= weight * even.sine * (2.0 * n);
        even = turned(even, twice);
        for (int i = 0; i < 2 * n + 1; ++i) power *= nome_;
    }
    f.drift = -scale_ * (rise / value + left);
    return f;
}

}  // namespace rbdyn::inline RBDYN_FORM
