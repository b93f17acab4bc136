// Weighted sums of products of series, one order at a time, in two lanes.
//
// A product's coefficient is a sum over half the orders, (a b)_k = sum_{2j < k} (a_j b_{k-j} + b_j a_{k-j}), and half
// of the same term at 2j = k. So the lanes of one product are (w a, w b) and (b, a), those of two squares side by side
// (2 w a, 2 w' a') and (a, a'): whole sums of products in one pair of accumulators, with no rest to the side.
//
// Each order has its own straight code. The order of all sums is fixed: the same bits on every processor.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace rbdyn::series {

#if defined(__GNUC__) || defined(__clang__)
using Pair = double __attribute__((vector_size(16)));
#else
struct alignas(16) Pair {
    double lanes[2];
    double operator[](int i) const { return lanes[i]; }
    Pair operator*(const Pair& b) const { return {lanes[0] * b[0], lanes[1] * b[1]}; }
    Pair& operator+=(const Pair& b) { return *this = {lanes[0] + b[0], lanes[1] + b[1]}; }
};
#endif

/// sum_j weight x_j y_{k-j} over half the orders, in each lane.
struct PackedProduct {
    const double *x[2], *y[2];
    Pair weight;
    Pair *low, *high;  // weight x to half the highest order, y to the highest
    int half;

    void take(int k) {
        high[k] = Pair{y[0][k], y[1][k]};
        if (k <= half) low[k] = weight * Pair{x[0][k], x[1][k]};
    }
};

/// The highest order that there is code for: that of Taylor series at the least tolerance.
inline constexpr int most_packed = 24;

/// `sum` and coefficient k > 0 of the products from first to last, which have taken all orders below it and take it.
template <int k>
double packed_sum(double sum, const PackedProduct* first, const PackedProduct* last) {
    Pair even{}, odd{};
    for (const PackedProduct* p = first; p != last; ++p) {
        // what was stored a moment ago is slow to load again in lanes
        const Pair newest{p->y[0][k], p->y[1][k]};
        const Pair *low = p->low, *high = p->high + k;
        p->high[k] = newest;
        if (k <= p->half) p->low[k] = p->weight * Pair{p->x[0][k], p->x[1][k]};
        even += low[0] * newest;
        [&]<int... j>(std::integer_sequence<int, j...>) {
            (((j % 2 == 0 ? odd : even) += low[j + 1] * high[-(j + 1)]), ...);
        }
        (std::make_integer_sequence<int, (k - 1) / 2>{});
        if constexpr (k % 2 == 0) odd += Pair{0.5, 0.5} * low[k / 2] * high[-k / 2];
    }
    even += odd;
    return sum + (even[0] + even[1]);
}

using PackedSum = double (*)(double, const PackedProduct*, const PackedProduct*);

/// packed_sum() of every order from 1.
inline constexpr auto packed_sums = []<int... k>(std::integer_sequence<int, k...>) {
    return std::array<PackedSum, most_packed + 1>{nullptr, packed_sum<k + 1>...};
}
(std::make_integer_sequence<int, most_packed>{});

}  // namespace rbdyn::series
