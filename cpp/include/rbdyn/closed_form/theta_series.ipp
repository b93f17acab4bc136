// Definitions of rbdyn/closed_form/theta_series.hpp.
#pragma once

#include "rbdyn/closed_form/theta_series.hpp"

#include <cstddef>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/closed_form/phase.hpp"

namespace rbdyn::inline RBDYN_FORM::theta_series {

RBDYN_INLINE DoubleDouble power(const DoubleDouble& base, int exponent) {
    DoubleDouble result = 1.0;
    for (int i = 0; i < exponent; ++i) result *= base;
    return result;
}

RBDYN_INLINE int terms(const DoubleDouble& base, double least) {
    int n = 0;
    while (power(base, (n + 1) * (n + 1)).hi > least) ++n;
    return n;
}

}  // namespace rbdyn::inline RBDYN_FORM::theta_series

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE CircularSeries<DoubleDouble> circular_series(const DoubleDouble& q, const DoubleDouble& p) {
    using theta_series::power;
    CircularSeries<DoubleDouble> s;
    s.nome = q;
    const int terms = theta_series::terms(q, theta_series::negligible_of_32_digits);
    s.terms = static_cast<std::size_t>(terms);
    DoubleDouble two = 1.0, three = 1.0, four = 1.0;  // theta_2/2 q^(1/4), theta_3, theta_4 at z = 0
    for (int n = 1; n <= terms; ++n) {
        const auto i = static_cast<std::size_t>(n);
        const double sign = n % 2 == 0 ? 1.0 : -1.0;
        s.odd[i] = power(q, n * (n + 1));
        s.even[i] = 2.0 * power(q, n * n);
        two += s.odd[i];
        three += s.even[i];
        four += sign * s.even[i];
        // q^(2 n^2) exp(+-2n beta), exp(2 beta) = p/q
        const DoubleDouble outer = power(q, 2 * n * n - n) * power(p, n);
        const DoubleDouble inner = power(q, 2 * n * n) * power(q / p, n);
        s.re[i] = sign * (inner + outer);
        s.im[i] = sign * (inner - outer);
    }
    s.sn = three / two;
    s.cn = four / two;
    s.dn = four / three;
    return s;
}

RBDYN_INLINE CircularSeries<double> rounded(const CircularSeries<DoubleDouble>& s) {
    using theta_series::rounded;
    return {s.nome.hi,      static_cast<std::size_t>(theta_series::terms(s.nome, theta_series::negligible)),
            rounded(s.odd), rounded(s.even),
            rounded(s.re),  rounded(s.im),
            s.sn.hi,        s.cn.hi,
            s.dn.hi};
}

RBDYN_INLINE HyperbolicSeries<DoubleDouble> hyperbolic_series(const DoubleDouble& root_nome, const DoubleDouble& eta) {
    using theta_series::power;
    HyperbolicSeries<DoubleDouble> s;
    s.root_nome = root_nome;
    const int terms = theta_series::terms(root_nome, theta_series::negligible_of_32_digits);
    s.terms = static_cast<std::size_t>(terms);
    const DoubleDouble nome = root_nome * root_nome;
    const auto half = sine_cosine_in<DoubleDouble>(0.5 * eta), whole = theta_series::turned(half, half);
    SineCosine<DoubleDouble> angle = half;
    DoubleDouble two = 0.0, three = 1.0, four = 1.0;  // theta_2/q'^(1/4), theta_3, theta_4 at y = 0
    for (int n = 0; n <= terms + 1; ++n) {
        const auto i = static_cast<std::size_t>(n);
        s.square[i] = power(nome, n * n);
        s.oblong[i] = power(nome, n * (n + 1));
        two += 2.0 * s.oblong[i];
        if (n > 0) {
            three += 2.0 * s.square[i];
            four += (n % 2 == 0 ? 2.0 : -2.0) * s.square[i];
        }
        const DoubleDouble outer = power(root_nome, n * n), inner = power(root_nome, n * (n + 1));
        s.re_outer[i] = outer * angle.cosine;
        s.im_outer[i] = outer * angle.sine;
        s.re_inner[i] = inner * angle.cosine;
        s.im_inner[i] = inner * angle.sine;
        angle = theta_series::turned(angle, whole);
    }
    s.sn = three / four;
    s.cn = two / four;
    s.dn = two / three;
    return s;
}

RBDYN_INLINE HyperbolicSeries<double> rounded(const HyperbolicSeries<DoubleDouble>& s) {
    using theta_series::rounded;
    return {s.root_nome.hi,
            static_cast<std::size_t>(theta_series::terms(s.root_nome, theta_series::negligible)),
            rounded(s.square),
            rounded(s.oblong),
            rounded(s.re_outer),
            rounded(s.re_inner),
            rounded(s.im_outer),
            rounded(s.im_inner),
            s.sn.hi,
            s.cn.hi,
            s.dn.hi};
}

}  // namespace rbdyn::inline RBDYN_FORM
