// Sums of products of series, order by order, four lanes at a time.
//
// A lane adds up products that belong to one sum, so that nothing has to be moved between lanes: the operands of all
// lanes stand side by side, coefficient by coefficient (LaneSeries). Two orders are done in one pass through them: what
// coefficients below k contribute to order k + 1 is known at order k, and each is loaded once for both.
//
// All of it is inlined where the processor is chosen (lanes.hpp).
#pragma once

#include <cstddef>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/series/lanes.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

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

/// One series in all lanes.
struct LaneSpread {
    const double* from;
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

/// Order 0: products of the first coefficients.
RBDYN_INLINE_LANES void first_order(LaneSum& s) {
    Quad sum{};
    for (const LaneProduct *p = s.first, *end = s.last; p != end; ++p) sum += p->x[0].value * p->y[0].value;
    s.sum = sum;
    s.next = Quad{};
}

/// An even order above 0.
RBDYN_INLINE_LANES void even_order(LaneSum& s, std::ptrdiff_t k) {
    Quad sum{}, next{};
    for (const LaneProduct *p = s.first, *last = s.last; p != last; ++p) {
        const LaneValues *x = p->x, *y = p->y;
        // of order k in a and b, of order k + 1 in c and d; the newest come last, for they come late
        const LaneValues* right = y + k - 1;
        Quad above = right->value, a{}, b = x[1].value * above, c{}, d{};
        for (const LaneValues *left = x + 2, *end = x + k; left != end; left += 2) {
            const Quad first = right[-1].value, second = right[-2].value, even = left[0].value, odd = left[1].value;
            a += even * first;
            c += even * above;
            b += odd * second;
            d += odd * first;
            above = second;
            right -= 2;
        }
        c += x[1].value * y[k].value;
        d += x[k].value * y[1].value;
        a += x[0].value * y[k].value;
        b += x[k].value * y[0].value;
        sum += a + b;
        next += c + d;
    }
    s.sum = sum;
    s.next = next;
}

RBDYN_INLINE_LANES void odd_order(LaneSum& s, std::ptrdiff_t k) {
    Quad sum = s.next;
    for (const LaneProduct *p = s.first, *end = s.last; p != end; ++p)
        sum += p->x[0].value * p->y[k].value + p->x[k].value * p->y[0].value;
    s.sum = sum;
}

RBDYN_INLINE_LANES void advance(const LaneSeries* series, const LaneSeries* series_end, const LaneSpread* spread,
                                const LaneSpread* spread_end, LaneSum* sum, LaneSum* sum_end, std::ptrdiff_t k) {
    for (; series != series_end; ++series)
        series->to[k].value =
            series->weight * Quad{series->from[0][k], series->from[1][k], series->from[2][k], series->from[3][k]};
    for (; spread != spread_end; ++spread) {
        const double value = spread->from[k];
        spread->to[k].value = Quad{value, value, value, value};
    }
    if (k == 0)
        for (; sum != sum_end; ++sum) first_order(*sum);
    else if (k % 2 == 0)
        for (; sum != sum_end; ++sum) even_order(*sum, k);
    else
        for (; sum != sum_end; ++sum) odd_order(*sum, k);
}

}  // namespace lanes

}  // namespace rbdyn::inline RBDYN_FORM::series
