// Definitions of rbdyn/series/step_length.hpp.
#pragma once

#include "rbdyn/series/step_length.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "rbdyn/series/lanes.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

RBDYN_INLINE double rough_log2(double x) {
    if (!(x > 0.0)) return -std::numeric_limits<double>::infinity();
    return static_cast<double>(std::bit_cast<std::int64_t>(x)) * 0x1p-52 - 1023.0;
}

RBDYN_INLINE double rough_log2_ratio(double a, double b) {
    // a zero may have a sign, and then this wraps round
    const std::uint64_t difference = std::bit_cast<std::uint64_t>(a) - std::bit_cast<std::uint64_t>(b);
    return static_cast<double>(static_cast<std::int64_t>(difference)) * 0x1p-52;
}

RBDYN_INLINE double rough_exp2(double x) {
    return std::bit_cast<double>(static_cast<std::int64_t>((std::clamp(x, -1022.0, 1023.0) + 1023.0) * 0x1p52));
}

RBDYN_INLINE void widen(double* size, const double* c, int order) {
    int k = 0;
#if defined(__GNUC__) || defined(__clang__)
    for (; k < order; k += 2) {
        const Pair x = pair_at(c + k), negative = -x, old = pair_at(size + k);
        const Pair magnitude = x > negative ? x : negative;
        set_pair(size + k, old > magnitude ? old : magnitude);
    }
#endif
    for (; k <= order; ++k) size[k] = std::max(size[k], std::abs(c[k]));
}

RBDYN_INLINE void sizes(double* size, const double* c, std::ptrdiff_t stride, int count, int order) {
    int k = 0;
#if defined(__GNUC__) || defined(__clang__)
    for (; k < order; k += 2) {
        Pair all{};
        const double* row = c + k;
        for (int i = 0; i < count; ++i, row += stride) {
            const Pair x = pair_at(row), negative = -x;
            const Pair magnitude = x > negative ? x : negative;
            all = all > magnitude ? all : magnitude;
        }
        set_pair(size + k, all);
    }
#endif
    for (; k <= order; ++k) {
        size[k] = 0.0;
        for (int i = 0; i < count; ++i) size[k] = std::max(size[k], std::abs(c[i * stride + k]));
    }
}

/// min_k above(k) / (k - from) of the k in [first, last] whose size counts, two at a time.
template <class F>
double least_quotient(const double* size, int first, int last, int from, const F& above) {
    double least = std::numeric_limits<double>::infinity();
    int k = last;
#if defined(__GNUC__) || defined(__clang__)
    for (; k > first && size[k] > least_size && size[k - 1] > least_size; k -= 2) {
        const Pair quotient =
            Pair{above(k), above(k - 1)} / Pair{static_cast<double>(k - from), static_cast<double>(k - 1 - from)};
        least = std::min(least, std::min(quotient[0], quotient[1]));
    }
#endif
    for (; k >= first; --k)
        if (size[k] > least_size) least = std::min(least, above(k) / (k - from));
    return least;
}

RBDYN_INLINE double log_step(const double* size, int p, double scale, double log_tolerance) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    // the last coefficients against the first one give the radius of convergence
    int first = 1;
    while (first < p - 3 && !(size[first] > least_size)) ++first;
    const auto from_first = [&](int k) { return rough_log2_ratio(size[first], size[k]); };
    const double log_radius = least_quotient(size, std::max(p - 3, first + 1), p, first, from_first);
    const int middle = p / 2;
    if (log_radius == infinity) {
        // a polynomial of low degree; what stands alone in the upper half may be the rounding of one computed as more,
        // or a series so small that its last terms are beyond where doubles end
        if (!(size[first] > std::sqrt(least_size))) return infinity;
        const double of_first = least_quotient(size, std::max(middle, first) + 1, p - 4, first,
                                               [&](int k) { return log_tolerance + from_first(k); });
        if (!(scale > size[first])) return of_first;
        // what is far beyond a motion that has hardly begun may count for nothing beside the scale
        return std::max(of_first, least_quotient(size, std::max(middle, first) + 1, p - 4, 0, [&](int k) {
                            return log_tolerance + rough_log2_ratio(scale, size[k]);
                        }));
    }
    // how far the motion goes within a fraction of the radius that is typical of a step
    const double reach = 0.3 * rough_exp2(log_radius);
    double within = reach * (size[1] + reach * (size[2] + reach * size[3]));
    if (first > 3) {
        within = size[first];
        for (int k = 0; k < first; ++k) within *= reach;
    }
    scale = std::max(scale, within);
    if (!(scale > least_size)) return infinity;
    // the last two terms meet the tolerance, earlier ones are on the way there from one
    double log_length = least_quotient(size, p - 3, p, 0, [&](int k) {
        return (k >= p - 1 ? log_tolerance : log_tolerance * k / p) + rough_log2_ratio(scale, size[k]);
    });
    // what is far below the way there is rounding, of a polynomial that was computed as more: it need not fall from one
    // term to the next, and each term is an error
    double largest = -infinity;
    for (int k = middle - 1; k <= middle + 1; ++k)
        if (size[k] > least_size) largest = std::max(largest, k * log_length - rough_log2_ratio(scale, size[k]));
    if (largest < 0.75 * log_tolerance)
        log_length = std::min(log_length, least_quotient(size, middle - 1, p - 2, 0, [&](int k) {
                                  return log_tolerance + rough_log2_ratio(scale, size[k]);
                              }));
    return log_length;
}

}  // namespace rbdyn::inline RBDYN_FORM::series
