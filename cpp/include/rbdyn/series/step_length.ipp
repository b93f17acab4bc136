// Definitions of rbdyn/series/step_length.hpp.
#pragma once

#include "rbdyn/series/step_length.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "rbdyn/series/coefficients.hpp"

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

RBDYN_INLINE double log_step(const double* size, int p, double scale, double log_tolerance) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    // counts as zero: close to where doubles end they lose their digits
    constexpr double tiny = 0x1p-960;
    // the last coefficients against the first one give the radius of convergence
    int first = 1;
    while (first < p - 3 && !(size[first] > tiny)) ++first;
    double log_radius = infinity;
    for (int k = p; k > p - 4; --k)
        if (k > first && size[k] > tiny)
            log_radius = std::min(log_radius, rough_log2_ratio(size[first], size[k]) / (k - first));
    const int middle = p / 2;
    if (log_radius == infinity) {
        // a polynomial of low degree; what stands alone in the upper half may be the rounding of one computed as more,
        // or a series so small that its last terms are beyond where doubles end
        double log_length = infinity;
        for (int k = middle + 1; k <= p - 4 && size[first] > std::sqrt(tiny); ++k)
            if (k > first && size[k] > tiny)
                log_length =
                    std::min(log_length, (log_tolerance + rough_log2_ratio(size[first], size[k])) / (k - first));
        return log_length;
    }
    // how far the motion goes within a fraction of the radius that is typical of a step
    const double reach = 0.3 * rough_exp2(log_radius);
    double within = reach * (size[1] + reach * (size[2] + reach * size[3]));
    if (first > 3) {
        within = size[first];
        for (int k = 0; k < first; ++k) within *= reach;
    }
    scale = std::max(scale, within);
    if (!(scale > tiny)) return infinity;
    // the last two terms meet the tolerance, earlier ones are on the way there from one
    double log_length = infinity;
    for (int k = p; k > p - 4; --k) {
        if (!(size[k] > tiny)) continue;
        const double target = k >= p - 1 ? log_tolerance : log_tolerance * k / p;
        log_length = std::min(log_length, (target + rough_log2_ratio(scale, size[k])) / k);
    }
    // what is far below the way there is rounding, of a polynomial that was computed as more: it need not fall from one
    // term to the next, and each term is an error
    double largest = -infinity;
    for (int k = middle - 1; k <= middle + 1; ++k)
        if (size[k] > tiny) largest = std::max(largest, k * log_length - rough_log2_ratio(scale, size[k]));
    if (largest < 0.75 * log_tolerance)
        for (int k = middle - 1; k < p - 1; ++k)
            if (size[k] > tiny)
                log_length = std::min(log_length, (log_tolerance + rough_log2_ratio(scale, size[k])) / k);
    return log_length;
}

}  // namespace rbdyn::inline RBDYN_FORM::series
