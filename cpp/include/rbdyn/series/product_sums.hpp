// Sums of products of series, order by order, four lanes at a time.
//
// A lane adds up products that belong to one sum, so that nothing has to be moved between lanes: the operands of all
// lanes stand side by side, coefficient by coefficient (LaneSeries). Two orders are done in one pass through them: what
// coefficients below k contribute to order k + 1 is known at order k, and each is loaded once for both.
//
// There is code for processors with four lanes (AVX2) and for all others; both do the same operations in the same
// order, without fused multiply-add: the same bits on every processor.
#pragma once

#if (defined(__GNUC__) || defined(__clang__)) && defined(__x86_64__)
#define RBDYN_WIDE_LANES 1
#define RBDYN_INLINE_LANES [[gnu::always_inline]] inline
#else
#define RBDYN_INLINE_LANES inline
#endif

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

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

namespace lanes {

RBDYN_INLINE_LANES void even_order(LaneSum& s, int k) {
    s.sum = s.next = Quad{};
    for (const LaneProduct* p = s.first; p != s.last; ++p) {
        const LaneValues *x = p->x, *y = p->y;
        if (k == 0) {
            s.sum += x[0].value * y[0].value;
            continue;
        }
        // of order k in a and b, of order k + 1 in c and d; the newest come last, for they come late
        const LaneValues* right = y + k - 1;
        Quad above = right->value, a{}, b = x[1].value * above, c{}, d{};
        for (const LaneValues *left = x + 2, *end = x + k; left != end; left += 2) {
            const Quad first = right[-1].value, second = right[-2].value;
            a += left[0].value * first;
            c += left[0].value * above;
            b += left[1].value * second;
            d += left[1].value * first;
            above = second;
            right -= 2;
        }
        c += x[1].value * y[k].value;
        d += x[k].value * y[1].value;
        a += x[0].value * y[k].value;
        b += x[k].value * y[0].value;
        s.sum += a + b;
        s.next += c + d;
    }
}

RBDYN_INLINE_LANES void odd_order(LaneSum& s, int k) {
    s.sum = s.next;
    for (const LaneProduct* p = s.first; p != s.last; ++p)
        s.sum += p->x[0].value * p->y[k].value + p->x[k].value * p->y[0].value;
}

RBDYN_INLINE_LANES void advance(const LaneSeries* series, const LaneSeries* series_end, LaneSum* sum, LaneSum* sum_end,
                                int k) {
    for (const LaneSeries* s = series; s != series_end; ++s)
        s->to[k].value = s->weight * Quad{s->from[0][k], s->from[1][k], s->from[2][k], s->from[3][k]};
    for (LaneSum* s = sum; s != sum_end; ++s) k % 2 == 0 ? even_order(*s, k) : odd_order(*s, k);
}

inline void plain(const LaneSeries* series, const LaneSeries* series_end, LaneSum* sum, LaneSum* sum_end, int k) {
    advance(series, series_end, sum, sum_end, k);
}
#ifdef RBDYN_WIDE_LANES
__attribute__((target("avx2"))) inline void wide(const LaneSeries* series, const LaneSeries* series_end, LaneSum* sum,
                                                 LaneSum* sum_end, int k) {
    advance(series, series_end, sum, sum_end, k);
}
#endif

}  // namespace lanes

/// What takes coefficient k of series and computes that of sums, order after order from 0.
using LaneOrder = void (*)(const LaneSeries*, const LaneSeries*, LaneSum*, LaneSum*, int k);

/// The one for this processor.
inline LaneOrder lane_order() {
#ifdef RBDYN_WIDE_LANES
    if (__builtin_cpu_supports("avx2")) return lanes::wide;
#endif
    return lanes::plain;
}

}  // namespace rbdyn::inline RBDYN_FORM::series

#undef RBDYN_INLINE_LANES
#undef RBDYN_WIDE_LANES
