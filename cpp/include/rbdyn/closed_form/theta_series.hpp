// Jacobi's functions sn, cn, dn at a real argument u of parameter m, and the phase of the theta function
//   f(u) = theta_4(pi (u + i b) / 2K; q^2),  0 < b < K',
// whose argument turns the attitude of a free body (see free_rotation.hpp). Two forms, so that the nome in use is never
// above exp(-pi) = 0.043 and a handful of terms gives every digit:
//   circular, m <= 1/2: in z = pi u / 2K with the nome q = exp(-pi K'/K);
//   hyperbolic, m > 1/2: in y = pi u / 2K' with the complementary nome q' = exp(-pi K/K'), by Jacobi's imaginary
//   transformation. At m = 1 it is the hyperbolic functions of the separatrix.
//
// Source: DLMF 20.2, 20.7.30-33, 22.2. Conventions: phase = (re f, im f) up to a positive factor.
#pragma once

#include <array>
#include <cmath>

#include "rbdyn/basics/double_double_functions.hpp"

namespace rbdyn::elliptic {

template <class S>
struct JacobiValues {
    S sn, cn, dn;
    S re, im;  // of f, up to a common positive factor
};

/// What no longer shows beside one in a number type.
template <class S>
inline constexpr double negligible = 0x1p-57;
template <>
inline constexpr double negligible<DoubleDouble> = 0x1p-110;

/// base^exponent for whole exponents from 0.
inline DoubleDouble power(const DoubleDouble& base, int exponent) {
    DoubleDouble result = 1.0;
    for (int i = 0; i < exponent; ++i) result *= base;
    return result;
}

/// The largest n with base^(n^2) not negligible.
template <class S>
int terms_of(const DoubleDouble& base, int most) {
    int n = 0;
    while (n < most && power(base, (n + 1) * (n + 1)).hi > negligible<S>) ++n;
    return n;
}

/// Cosine and sine of the sum of two angles.
template <class S>
SineCosine<S> turned(const SineCosine<S>& a, const SineCosine<S>& by) {
    return {a.sine * by.cosine + a.cosine * by.sine, a.cosine * by.cosine - a.sine * by.sine};
}

template <class S>
class CircularSeries {
public:
    CircularSeries() = default;
    /// From the nome q and p = exp(-pi (K' - b)/K), q <= p <= 1.
    CircularSeries(const DoubleDouble& q, const DoubleDouble& p) {
        const DoubleDouble r = q / p;
        terms_ = terms_of<S>(q, most);
        DoubleDouble two = 1.0, three = 1.0, four = 1.0;  // theta_2/2 q^(1/4), theta_3, theta_4 at z = 0
        for (int n = 1; n <= most; ++n) {
            const auto i = static_cast<std::size_t>(n - 1);
            const double sign = n % 2 == 0 ? 1.0 : -1.0;
            const DoubleDouble odd = power(q, n * (n + 1)), even = 2.0 * power(q, n * n);
            const DoubleDouble outer = power(q, 2 * n * n - n) * power(p, n), inner = power(q, 2 * n * n) * power(r, n);
            two += odd;
            three += even;
            four += sign * even;
            odd_[i] = static_cast<S>(odd);
            even_[i] = static_cast<S>(even);
            re_[i] = static_cast<S>(sign * (outer + inner));
            im_[i] = static_cast<S>(sign * (inner - outer));
        }
        sn_ = static_cast<S>(three / two);
        cn_ = static_cast<S>(four / two);
        dn_ = static_cast<S>(four / three);
    }

    /// At z, given by its sine and cosine.
    JacobiValues<S> at(const SineCosine<S>& z) const {
        const SineCosine<S> twice = turned(z, z);
        SineCosine<S> odd = z, even{0.0, 1.0};
        S one = z.sine, two = z.cosine, three = 1.0, four = 1.0, re = 1.0, im = 0.0;
        for (int n = 1; n <= terms_; ++n) {
            const auto i = static_cast<std::size_t>(n - 1);
            odd = turned(odd, twice);
            even = turned(even, twice);
            const S a = odd_[i] * odd.sine, b = even_[i] * even.cosine;
            one = n % 2 == 0 ? one + a : one - a;
            two += odd_[i] * odd.cosine;
            three += b;
            four = n % 2 == 0 ? four + b : four - b;
            re += re_[i] * even.cosine;
            im += im_[i] * even.sine;
        }
        return {sn_ * one / four, cn_ * two / four, dn_ * three / four, re, im};
    }

    /// d arg f / dz at z = 0.
    S phase_slope() const {
        S slope = 0.0, re = 1.0;
        for (int n = 1; n <= terms_; ++n) {
            const auto i = static_cast<std::size_t>(n - 1);
            slope += im_[i] * static_cast<double>(2 * n);
            re += re_[i];
        }
        return slope / re;
    }

private:
    static constexpr int most = 5;  // exp(-pi)^36 = 7e-50
    int terms_ = 0;
    // sums of odd_ sin or cos((2n+1) z), even_ and re_ cos(2nz), im_ sin(2nz)
    std::array<S, most> odd_{}, even_{}, re_{}, im_{};
    S sn_ = 0.0, cn_ = 0.0, dn_ = 0.0;
};

template <class S>
class HyperbolicSeries {
public:
    HyperbolicSeries() = default;
    /// From the root of the complementary nome, sqrt(q') = exp(-pi K/2K'), and eta = pi b / 2K', 0 < eta < pi/2.
    HyperbolicSeries(const DoubleDouble& root_nome, const DoubleDouble& eta) : root_nome_(static_cast<S>(root_nome)) {
        const SineCosine<DoubleDouble> half = sine_cosine(0.5 * eta), whole = turned(half, half);
        SineCosine<DoubleDouble> angle = half;
        const DoubleDouble nome = root_nome * root_nome;
        terms_ = terms_of<S>(root_nome, most);
        for (int n = 0; n <= most + 1; ++n) {
            const auto i = static_cast<std::size_t>(n);
            square_[i] = static_cast<S>(power(nome, n * n));
            oblong_[i] = static_cast<S>(power(nome, n * (n + 1)));
            const DoubleDouble outer = power(root_nome, n * n), inner = power(root_nome, n * (n + 1));
            re_outer_[i] = static_cast<S>(outer * angle.cosine);
            re_inner_[i] = static_cast<S>(inner * angle.cosine);
            im_outer_[i] = static_cast<S>(outer * angle.sine);
            im_inner_[i] = static_cast<S>(inner * angle.sine);
            angle = turned(angle, whole);
        }
        // theta_2/q'^(1/4), theta_3, theta_4 at zero
        DoubleDouble two = 2.0, three = 1.0, four = 1.0;
        for (int n = 1; n <= most; ++n) {
            const DoubleDouble even = 2.0 * power(nome, n * n);
            two += 2.0 * power(nome, n * (n + 1));
            three += even;
            four += n % 2 == 0 ? even : -even;
        }
        sn_ = static_cast<S>(three / four);
        cn_ = static_cast<S>(two / four);
        dn_ = static_cast<S>(two / three);
    }

    /// At y >= 0, given by e = exp(-y), y <= pi K / 2K'.
    JacobiValues<S> at(const S& e) const {
        // near one end e is small, near the other g; their powers go with the nome's
        const S g = root_nome_ == S(0.0) ? S(0.0) : root_nome_ / e;
        const S ee = e * e, gg = g * g;
        S en = e, gn = 1.0, een = ee, ggn = 1.0;  // e^(n+1), g^n, and their squares
        S one = 0.0, two = 0.0, three = 1.0, four = 1.0, re = 0.0, im = 0.0;
        for (int n = 0; n <= terms_; ++n) {
            const auto i = static_cast<std::size_t>(n);
            const S outer = square_[i] * ggn, inner = oblong_[i] * een;
            const S difference = outer - inner;
            one = n % 2 == 0 ? one + difference : one - difference;
            two += outer + inner;
            re += re_outer_[i] * gn + re_inner_[i] * en;
            im += im_outer_[i] * gn - im_inner_[i] * en;
            // the next term of the even functions
            const S even = oblong_[i] * (ggn * gg) + square_[i + 1] * een;
            three += even;
            four = n % 2 == 0 ? four - even : four + even;
            en *= e;
            gn *= g;
            een *= ee;
            ggn *= gg;
        }
        const S scale = e / two;
        return {sn_ * one / two, cn_ * four * scale, dn_ * three * scale, re, im};
    }

    /// d arg f~ / dy at y = 0, f~ the part of f whose argument does not grow with u.
    S phase_slope() const {
        S slope = 0.0, re = 0.0;
        for (int n = 0; n <= terms_; ++n) {
            const auto i = static_cast<std::size_t>(n);
            slope += im_inner_[i] * (n + 0.5);
            re += re_inner_[i];
        }
        return slope / re;
    }

private:
    static constexpr int most = 7;  // exp(-pi/2)^64 = 2e-44
    int terms_ = 0;
    S root_nome_ = 0.0;
    std::array<S, most + 2> square_{}, oblong_{}, re_outer_{}, re_inner_{}, im_outer_{}, im_inner_{};
    S sn_ = 0.0, cn_ = 0.0, dn_ = 0.0;
};

}  // namespace rbdyn::elliptic
