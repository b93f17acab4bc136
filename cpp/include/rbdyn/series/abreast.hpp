// Coefficients of several motions abreast, one motion in each lane of a vector, order by order.
//
// Each kernel does for every lane what its namesake in coefficients.hpp or product_sums.hpp does for one motion, the
// same operations in the same order, without fused multiply-add: the bits of a motion are those it has alone, whatever
// the width of the vectors and whatever is in the other lanes.
//
// A series is a row of vectors, coefficient 0 first.
#pragma once

#if defined(__GNUC__) || defined(__clang__)
#define RBDYN_HAS_LANES 1

#include <cstddef>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::series::abreast {

// they alias the doubles they are made of
using Two = double __attribute__((vector_size(16), aligned(16), may_alias));
using Four = double __attribute__((vector_size(32), aligned(32), may_alias));
using Eight = double __attribute__((vector_size(64), aligned(64), may_alias));

// compiled for several processors: each copy has to have all of it
#define RBDYN_ABREAST [[gnu::always_inline]] inline

/// sum_{j < n} a[j] b[-j], in the order of series::dot().
template <class Lanes>
RBDYN_ABREAST void dot(const Lanes* a, const Lanes* b, int n, Lanes& sum) {
    Lanes all{};
    int j = 0;
    if (n >= 4) {
        Lanes p = a[0] * b[0], q = a[1] * b[-1], r = a[2] * b[-2], s = a[3] * b[-3];
        for (j = 4; j + 4 <= n; j += 4) {
            p += a[j] * b[-j];
            q += a[j + 1] * b[-j - 1];
            r += a[j + 2] * b[-j - 2];
            s += a[j + 3] * b[-j - 3];
        }
        all = (p + r) + (q + s);
    }
    for (; j < n; ++j) all += a[j] * b[-j];
    sum = all;
}

/// x, x^2, .. x^n, as series::powers().
template <class Lanes>
RBDYN_ABREAST void powers(const Lanes& x, int n, Lanes* out) {
    Lanes power = x;
    for (int k = 0; k < n; ++k) {
        out[k] = power;
        power = power * x;
    }
}

/// sum_{j < n} a[j] b[j], in the order of series::dot().
template <class Lanes>
RBDYN_ABREAST void forward_dot(const Lanes* a, const Lanes* b, int n, Lanes& sum) {
    Lanes all{};
    int j = 0;
    if (n >= 4) {
        Lanes p = a[0] * b[0], q = a[1] * b[1], r = a[2] * b[2], s = a[3] * b[3];
        for (j = 4; j + 4 <= n; j += 4) {
            p += a[j] * b[j];
            q += a[j + 1] * b[j + 1];
            r += a[j + 2] * b[j + 2];
            s += a[j + 3] * b[j + 3];
        }
        all = (p + r) + (q + s);
    }
    for (; j < n; ++j) all += a[j] * b[j];
    sum = all;
}

/// A product of two series at an even order above 0: what it adds to a sum there, and to the same sum at the next one.
template <class Lanes>
RBDYN_ABREAST void even_order(const Lanes* x, const Lanes* y, int k, Lanes& sum, Lanes& next) {
    const Lanes* right = y + k - 1;
    Lanes above = *right, a{}, b = x[1] * above, c{}, d{};
    for (const Lanes *left = x + 2, *end = x + k; left != end; left += 2) {
        const Lanes first = right[-1], second = right[-2], even = left[0], odd = left[1];
        a += even * first;
        c += even * above;
        b += odd * second;
        d += odd * first;
        above = second;
        right -= 2;
    }
    c += x[1] * y[k];
    d += x[k] * y[1];
    a += x[0] * y[k];
    b += x[k] * y[0];
    sum = a + b;
    next = c + d;
}

/// Two of them with a factor in common, whose coefficients are loaded once.
template <class Lanes>
RBDYN_ABREAST void even_order(const Lanes* x, const Lanes* z, const Lanes* y, int k, Lanes* sum, Lanes* next) {
    const Lanes* right = y + k - 1;
    Lanes above = *right, a{}, b = x[1] * above, c{}, d{}, e{}, f = z[1] * above, g{}, h{};
    const std::ptrdiff_t other = z - x;
    for (const Lanes *left = x + 2, *end = x + k; left != end; left += 2) {
        const Lanes first = right[-1], second = right[-2];
        Lanes even = left[0], odd = left[1];
        a += even * first;
        c += even * above;
        b += odd * second;
        d += odd * first;
        even = left[other];
        odd = left[other + 1];
        e += even * first;
        g += even * above;
        f += odd * second;
        h += odd * first;
        above = second;
        right -= 2;
    }
    const Lanes last = y[k], start = y[0], slow = y[1];
    c += x[1] * last;
    d += x[k] * slow;
    a += x[0] * last;
    b += x[k] * start;
    g += z[1] * last;
    h += z[k] * slow;
    e += z[0] * last;
    f += z[k] * start;
    sum[0] = a + b;
    next[0] = c + d;
    sum[1] = e + f;
    next[1] = g + h;
}

/// The rest of it at an odd order.
template <class Lanes>
RBDYN_ABREAST void odd_order(const Lanes* x, const Lanes* y, int k, Lanes& sum) {
    sum += x[0] * y[k] + x[k] * y[0];
}

template <class Lanes>
RBDYN_ABREAST void square(const Lanes* a, int k, Lanes& out) {
    if (k == 0) {
        out = a[0] * a[0];
        return;
    }
    Lanes pairs;
    dot(a + 1, a + k - 1, (k - 1) / 2, pairs);
    out = 2.0 * (a[0] * a[k] + pairs);
    if (k % 2 == 0) out += a[k / 2] * a[k / 2];
}

template <class Lanes>
RBDYN_ABREAST void quotient(const Lanes* a, const Lanes* b, const Lanes* q, int k, Lanes& out) {
    if (k == 0) {
        out = a[0] / b[0];
        return;
    }
    Lanes sum;
    dot(b + 1, q + k - 1, k - 1, sum);
    out = (a[k] - b[k] * q[0] - sum) / b[0];
}

/// For k > 0.
template <class Lanes>
RBDYN_ABREAST void square_root(const Lanes& a_k, const Lanes* s, int k, Lanes& out) {
    Lanes sum;
    dot(s + 1, s + k - 1, (k - 1) / 2, sum);
    sum = 2.0 * sum;
    if (k % 2 == 0) sum += s[k / 2] * s[k / 2];
    out = (a_k - sum) / (2.0 * s[0]);
}

template <class Lanes>
RBDYN_ABREAST void integral_of_slope(const Lanes* slope, const Lanes* b, int k, Lanes& out) {
    if (k == 1) {
        out = slope[1] * b[0];
        return;
    }
    Lanes sum;
    dot(slope + 2, b + k - 2, k - 2, sum);
    out = (slope[k] * b[0] + slope[1] * b[k - 1] + sum) / static_cast<double>(k);
}

/// As series::sizes().
template <class Lanes>
RBDYN_ABREAST void sizes(const Lanes* c, std::ptrdiff_t stride, int count, int order, Lanes* out) {
    for (int k = 0; k <= order; ++k) {
        // there the last one of an odd number stands alone
        const bool is_alone = k == order && order % 2 == 0;
        Lanes all{};
        for (int i = 0; i < count; ++i) {
            const Lanes x = c[i * stride + k], negative = -x, magnitude = x > negative ? x : negative;
            if (is_alone)
                all = all < magnitude ? magnitude : all;
            else
                all = all > magnitude ? all : magnitude;
        }
        out[k] = all;
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::series::abreast

#endif
