// Sums of products of series, order by order, four lanes at a time.
//
// A lane adds up products that belong to one sum, so that nothing has to be moved between lanes: the operands of all
// lanes stand side by side, coefficient by coefficient (LaneSeries). Two orders are done in one pass through them: what
// coefficients below k contribute to order k + 1 is known at order k, and each is loaded once for both.
//
// Each even order has its own straight code, for processors with four lanes (AVX2) and for all others; both do the same
// operations in the same order, without fused multiply-add: the same bits on every processor.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#if (defined(__GNUC__) || defined(__clang__)) && defined(__x86_64__)
#define RBDYN_WIDE_LANES 1
#define RBDYN_INLINE_LANES [[gnu::always_inline]] inline
#else
#define RBDYN_INLINE_LANES inline
#endif

namespace rbdyn::series {

#if defined(__GNUC__) || defined(__clang__)
using Quad = double __attribute__((vector_size(32), aligned(32)));
#else
struct alignas(32) Quad {
    double lanes[4];
    double operator[](int i) const { return lanes[i]; }
    Quad operator*(const Quad& b) const { return {lanes[0] * b[0], lanes[1] * b[1], lanes[2] * b[2], lanes[3] * b[3]}; }
    Quad operator+(const Quad& b) const { return {lanes[0] + b[0], lanes[1] + b[1], lanes[2] + b[2], lanes[3] + b[3]}; }
    Quad& operator+=(const Quad& b) { return *this = *this + b; }
};
#endif

/// A coefficient in each lane. (In a list a type keeps its alignment only if it is a class.)
struct LaneValues {
    Quad value;
};

/// Four series side by side, each times a weight.
struct LaneSeries {
    const double* from[4];
    Quad weight;
    LaneValues* to;
};

/// A product in each lane.
struct LaneProduct {
    const LaneValues *x, *y;
};

/// LaneValues of sums of products: `sum` is their coefficient of the order computed last.
struct LaneSum {
    const LaneProduct *first, *last;
    Quad sum, next;  // next: what of the coming order is known
};

/// The highest order that there is code for: that of Taylor series at the least tolerance.
inline constexpr int most_lanes = 24;

namespace lanes {

RBDYN_INLINE_LANES void take(const LaneSeries* first, const LaneSeries* last, int k) {
    for (const LaneSeries* s = first; s != last; ++s)
        s->to[k].value = s->weight * Quad{s->from[0][k], s->from[1][k], s->from[2][k], s->from[3][k]};
}

template <int k>
RBDYN_INLINE_LANES void even_order(const LaneSeries* first_series, const LaneSeries* last_series, LaneSum* first,
                                   LaneSum* last) {
    take(first_series, last_series, k);
    for (LaneSum* s = first; s != last; ++s) {
        Quad sum{}, next{};
        for (const LaneProduct* p = s->first; p != s->last; ++p) {
            const LaneValues *x = p->x, *y = p->y;
            if constexpr (k == 0) {
                sum += x[0].value * y[0].value;
            } else {
                // of order k in a and b, of order k + 1 in c and d; the newest come last, for they come late
                Quad above = y[k - 1].value, a{}, b = x[1].value * above, c{}, d{};
#pragma GCC unroll 24
                for (int j = 2; j < k; ++j) {
                    const Quad left = x[j].value, right = y[k - j].value;
                    (j % 2 == 0 ? a : b) += left * right;
                    (j % 2 == 0 ? c : d) += left * above;
                    above = right;
                }
                c += x[1].value * y[k].value;
                d += x[k].value * y[1].value;
                a += x[0].value * y[k].value;
                b += x[k].value * y[0].value;
                sum += a + b;
                next += c + d;
            }
        }
        s->sum = sum;
        s->next = next;
    }
}

RBDYN_INLINE_LANES void odd_order(const LaneSeries* first_series, const LaneSeries* last_series, LaneSum* first,
                                  LaneSum* last, int k) {
    take(first_series, last_series, k);
    for (LaneSum* s = first; s != last; ++s) {
        Quad sum = s->next;
        for (const LaneProduct* p = s->first; p != s->last; ++p)
            sum += p->x[0].value * p->y[k].value + p->x[k].value * p->y[0].value;
        s->sum = sum;
    }
}

using Order = void (*)(const LaneSeries*, const LaneSeries*, LaneSum*, LaneSum*);

template <int k>
void plain(const LaneSeries* s, const LaneSeries* t, LaneSum* first, LaneSum* last) {
    if constexpr (k % 2 == 0)
        even_order<k>(s, t, first, last);
    else
        odd_order(s, t, first, last, k);
}
#ifdef RBDYN_WIDE_LANES
template <int k>
__attribute__((target("avx2"))) void wide(const LaneSeries* s, const LaneSeries* t, LaneSum* first, LaneSum* last) {
    if constexpr (k % 2 == 0)
        even_order<k>(s, t, first, last);
    else
        odd_order(s, t, first, last, k);
}
#endif

template <int... k>
const std::array<Order, most_lanes + 1>& all_orders(std::integer_sequence<int, k...>) {
    static constexpr std::array<Order, most_lanes + 1> everywhere{plain<k>...};
#ifdef RBDYN_WIDE_LANES
    static constexpr std::array<Order, most_lanes + 1> here{wide<k>...};
    if (__builtin_cpu_supports("avx2")) return here;
#endif
    return everywhere;
}

}  // namespace lanes

/// For each order, what takes the coefficients of series and computes those of sums.
inline const std::array<lanes::Order, most_lanes + 1>& lane_orders() {
    static const auto& orders = lanes::all_orders(std::make_integer_sequence<int, most_lanes + 1>{});
    return orders;
}

}  // namespace rbdyn::series

#undef RBDYN_INLINE_LANES
#undef RBDYN_WIDE_LANES
