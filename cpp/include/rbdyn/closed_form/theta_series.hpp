// Jacobi's functions sn, cn, dn at a real argument u of parameter m, and the phase of the theta function
//   f(u) = theta_4(pi (u + i b) / 2K; q^2),  0 < b < K',
// which turns the attitude of a free body (free_rotation.hpp). Two forms, so that the nome in use is never above
// exp(-pi) = 0.043 and a handful of terms gives every digit:
//   circular, m <= 1/2: in z = pi u / 2K with the nome q = exp(-pi K'/K);
//   hyperbolic, m > 1/2: in y = pi u / 2K' with the complementary nome q' = exp(-pi K/K'), by Jacobi's imaginary
//   transformation, which splits f = exp(-i eta u / 2K) f~, eta = pi b / 2K', up to a positive factor. At m = 1 these
//   are the hyperbolic functions of the separatrix.
// Both are made of numbers of 32 digits, and rounded for use.
//
// Source: DLMF 20.2, 20.7.30-33, 22.2.
#pragma once

#include <array>
#include <cstddef>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class S>
struct JacobiValues {
    S sn, cn, dn;
    S re, im;  // of f or f~, up to a common positive factor
};

namespace theta_series {

/// base^exponent for whole exponents from 0.
DoubleDouble power(const DoubleDouble& base, int exponent);

/// The largest n with base^(n^2) > least.
int terms(const DoubleDouble& base, double least);

/// What no longer shows beside one.
inline constexpr double negligible = 0x1p-57, negligible_of_32_digits = 0x1p-110;

/// Sine and cosine of the sum of two angles.
template <class S>
SineCosine<S> turned(const SineCosine<S>& a, const SineCosine<S>& by) {
    return {a.sine * by.cosine + a.cosine * by.sine, a.cosine * by.cosine - a.sine * by.sine};
}

template <std::size_t size>
std::array<double, size> rounded(const std::array<DoubleDouble, size>& a) {
    std::array<double, size> result;
    for (std::size_t i = 0; i < size; ++i) result[i] = static_cast<double>(a[i]);
    return result;
}

}  // namespace theta_series

template <class S>
struct CircularSeries {
    static constexpr std::size_t size = 6;  // exp(-pi)^36 = 7e-50

    S nome = 0.0;
    std::size_t terms = 0;
    // n-th term: odd sin or cos((2n+1) z), even and re cos(2nz), im sin(2nz)
    std::array<S, size> odd{}, even{}, re{}, im{};
    S sn = 0.0, cn = 0.0, dn = 0.0;

    /// At z, given by its sine and cosine.
    JacobiValues<S> at(const SineCosine<S>& z) const {
        const SineCosine<S> twice = theta_series::turned(z, z);
        SineCosine<S> odd_angle = z, even_angle{0.0, 1.0};
        S one = z.sine, two = z.cosine, three = 1.0, four = 1.0, real = 1.0, imaginary = 0.0;
        for (std::size_t n = 1; n <= terms; ++n) {
            odd_angle = theta_series::turned(odd_angle, twice);
            even_angle = theta_series::turned(even_angle, twice);
            const S a = odd[n] * odd_angle.sine, b = even[n] * even_angle.cosine;
            one = n % 2 == 0 ? one + a : one - a;
            two += odd[n] * odd_angle.cosine;
            three += b;
            four = n % 2 == 0 ? four + b : four - b;
            real += re[n] * even_angle.cosine;
            imaginary += im[n] * even_angle.sine;
        }
        return {sn * one / four, cn * two / four, dn * three / four, real, imaginary};
    }

    /// d arg f / dz at z = 0.
    S phase_slope() const {
        S slope = 0.0, real = 1.0;
        for (std::size_t n = 1; n <= terms; ++n) {
            slope += im[n] * (2.0 * static_cast<double>(n));
            real += re[n];
        }
        return slope / real;
    }
};

/// From the nome q and p = exp(-pi (K' - b)/K), q <= p <= 1.
[[gnu::cold]] CircularSeries<DoubleDouble> circular_series(const DoubleDouble& q, const DoubleDouble& p);

CircularSeries<double> rounded(const CircularSeries<DoubleDouble>& s);

template <class S>
struct HyperbolicSeries {
    static constexpr std::size_t size = 9;  // exp(-pi/2)^64 = 2e-44

    S root_nome = 0.0;
    std::size_t terms = 0;
    // nome^(n^2) and nome^(n (n+1)); the same of its root times cos and sin((n + 1/2) eta)
    std::array<S, size> square{}, oblong{}, re_outer{}, re_inner{}, im_outer{}, im_inner{};
    S sn = 0.0, cn = 0.0, dn = 0.0;

    /// At y >= 0, given by e = exp(-y), y <= pi K / 2K'; odd functions change sign with y.
    JacobiValues<S> at(const S& e) const {
        // at one end e is small, at the other g; their powers go with the nome's
        const S g = root_nome == S(0.0) ? S(0.0) : root_nome / e;
        const S ee = e * e, gg = g * g;
        S e_power = e, g_power = 1.0, ee_power = ee, gg_power = 1.0;  // e^(n+1), g^n, and their squares
        S one = 0.0, two = 0.0, three = 1.0, four = 1.0, real = 0.0, imaginary = 0.0;
        for (std::size_t n = 0; n <= terms; ++n) {
            const S outer = square[n] * gg_power, inner = oblong[n] * ee_power;
            // the functions even in y are one term ahead
            gg_power *= gg;
            const S difference = outer - inner, ahead = oblong[n] * gg_power + square[n + 1] * ee_power;
            one = n % 2 == 0 ? one + difference : one - difference;
            two += outer + inner;
            three += ahead;
            four = n % 2 == 0 ? four - ahead : four + ahead;
            real += re_outer[n] * g_power + re_inner[n] * e_power;
            imaginary += im_outer[n] * g_power - im_inner[n] * e_power;
            ee_power *= ee;
            e_power *= e;
            g_power *= g;
        }
        const S scale = e / two;
        return {sn * one / two, cn * four * scale, dn * three * scale, real, imaginary};
    }

    /// d arg f~ / dy at y = 0.
    S phase_slope() const {
        S slope = 0.0, real = 0.0;
        for (std::size_t n = 0; n <= terms; ++n) {
            slope += im_inner[n] * (static_cast<double>(n) + 0.5);
            real += re_inner[n];
        }
        return slope / real;
    }
};

/// From sqrt(q') = exp(-pi K / 2K'), and eta = pi b / 2K', 0 < eta < pi/2.
[[gnu::cold]] HyperbolicSeries<DoubleDouble> hyperbolic_series(const DoubleDouble& root_nome, const DoubleDouble& eta);

HyperbolicSeries<double> rounded(const HyperbolicSeries<DoubleDouble>& s);

}  // namespace rbdyn::inline RBDYN_FORM
