// Coefficients of truncated Taylor series, one order at a time.
//
// Notation: a series a(t) = sum_k a_k t^k. Each kernel returns the coefficient of order k of its result from the
// coefficients 0..k of its operands (and 0..k-1 of its result), so that an ODE can be advanced order by order
// (Jorba and Zou, "A software package for the numerical integration of ODEs by means of high-order Taylor methods",
// Experimental Mathematics 14, 2005, eqs. 6-12; Griewank and Walther, "Evaluating Derivatives", ch. 13).
//
// Storage: a series is kept forwards (a_0 first) and backwards (a_0 last), so that the convolution
// sum_j a_j b_{k-j} runs forwards through both arrays. Sums are taken in four fixed lanes: the same bits on every
// processor, whatever the width of its registers.
#pragma once

#include <utility>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/series/lanes.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

/// sum_{j < n} a[j] b[j], in four lanes.
template <class Lanes = FourByTwo>
RBDYN_INLINE_LANES double dot(const double* a, const double* b, int n) {
    double sum = 0.0;
    int j = 0;
    if (n >= 4) {
        Lanes lanes(a, b);
        for (j = 4; j + 4 <= n; j += 4) lanes.add(a + j, b + j);
        sum = lanes.sum();
    }
    for (; j < n; ++j) sum += a[j] * b[j];
    return sum;
}

/// The same for two b in one pass, each with the bits it has alone.
template <class Lanes = FourByTwo>
RBDYN_INLINE_LANES std::pair<double, double> dots(const double* a, const double* b, const double* c, int n) {
    double first = 0.0, second = 0.0;
    int j = 0;
    if (n >= 4) {
        Lanes by_b(a, b), by_c(a, c);
        for (j = 4; j + 4 <= n; j += 4) {
            by_b.add(a + j, b + j);
            by_c.add(a + j, c + j);
        }
        first = by_b.sum();
        second = by_c.sum();
    }
    for (; j < n; ++j) {
        first += a[j] * b[j];
        second += a[j] * c[j];
    }
    return {first, second};
}

/// A view of one series: coefficient k is forward[k] and last[-k].
struct View {
    double* forward;
    double* last;

    double operator[](int k) const { return forward[k]; }
    void set(int k, double value) const {
        forward[k] = value;
        last[-k] = value;
    }
    /// Pointer to a_k, a_{k-1}, ..., a_0.
    const double* from(int k) const { return last - k; }
};

// In each sum the newest coefficients stand alone: what was stored a moment ago one by one is slow to load in lanes.

/// (a a)_k
template <class Lanes = FourByTwo>
RBDYN_INLINE_LANES double square(const View& a, int k) {
    if (k == 0) return a[0] * a[0];
    const int pairs = (k - 1) / 2;
    const double twice = 2.0 * (a[0] * a[k] + dot<Lanes>(a.forward + 1, a.from(k - 1), pairs));
    return k % 2 == 0 ? twice + a[k / 2] * a[k / 2] : twice;
}

/// (a / b)_k, q the quotient so far.
template <class Lanes = FourByTwo>
RBDYN_INLINE_LANES double quotient(const View& a, const View& b, const View& q, int k) {
    if (k == 0) return a[0] / b[0];
    return (a[k] - b[k] * q[0] - dot<Lanes>(b.forward + 1, q.from(k - 1), k - 1)) / b[0];
}

/// sqrt(a)_k for k > 0, s the root so far.
template <class Lanes = FourByTwo>
RBDYN_INLINE_LANES double square_root(double a_k, const View& s, int k) {
    const int pairs = (k - 1) / 2;
    double sum = 2.0 * dot<Lanes>(s.forward + 1, s.from(k - 1), pairs);
    if (k % 2 == 0) sum += s[k / 2] * s[k / 2];
    return (a_k - sum) / (2.0 * s[0]);
}

/// (1/k) sum_{j=1..k} (j a_j) b_{k-j}, the coefficient of the integral of a' b; `slope` holds j a_j.
template <class Lanes = FourByTwo>
RBDYN_INLINE_LANES double integral_of_slope(const double* slope, const View& b, int k) {
    if (k == 1) return slope[1] * b[0];
    return (slope[k] * b[0] + slope[1] * b[k - 1] + dot<Lanes>(slope + 2, b.from(k - 2), k - 2)) / k;
}

/// The same for two b.
template <class Lanes = FourByTwo>
RBDYN_INLINE_LANES std::pair<double, double> integrals_of_slope(const double* slope, const View& b, const View& c,
                                                                int k) {
    if (k == 1) return {slope[1] * b[0], slope[1] * c[0]};
    const auto [by_b, by_c] = dots<Lanes>(slope + 2, b.from(k - 2), c.from(k - 2), k - 2);
    return {(slope[k] * b[0] + slope[1] * b[k - 1] + by_b) / k, (slope[k] * c[0] + slope[1] * c[k - 1] + by_c) / k};
}

}  // namespace rbdyn::inline RBDYN_FORM::series
