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

// products between one that is asked for and the one that is computed
constexpr std::ptrdiff_t ahead = 4;

/// Asks for the series of a product that is computed soon: where all of them together are larger than the caches, none
/// is at hand. To order k, and `first`: no more than the first coefficients.
RBDYN_INLINE_LANES void fetch([[maybe_unused]] const LaneProduct& p, [[maybe_unused]] std::ptrdiff_t k,
                              [[maybe_unused]] bool first) {
#if defined(__GNUC__) || defined(__clang__)
    constexpr std::ptrdiff_t line = 64 / sizeof(LaneValues);
    const std::ptrdiff_t last = first ? 0 : k;
    for (std::ptrdiff_t j = 0; j <= last; j += line) {
        __builtin_prefetch(p.x + j);
        __builtin_prefetch(p.y + j);
    }
#endif
}

/// The same for a coefficient that is laid out soon.
RBDYN_INLINE_LANES void fetch([[maybe_unused]] const LaneSeries& s, [[maybe_unused]] std::ptrdiff_t k) {
#if defined(__GNUC__) || defined(__clang__)
    for (const double* from : s.from) __builtin_prefetch(from + k);
    __builtin_prefetch(s.to + k, 1);
#endif
}

/// Order 0: products of the first coefficients.
RBDYN_INLINE_LANES void first_order(LaneSum& s) {
    Quad sum{};
    for (const LaneProduct *p = s.first, *end = s.last; p != end; ++p) sum += p->x[0].value * p->y[0].value;
    s.sum = sum;
    s.next = Quad{};
}

/// An even order above 0.
template <bool fetches>
RBDYN_INLINE_LANES void even_order(LaneSum& s, std::ptrdiff_t k, [[maybe_unused]] const LaneProduct* soon) {
    Quad sum{}, next{};
    for (const LaneProduct *p = s.first, *last = s.last; p != last; ++p) {
        if constexpr (fetches)
            if (p < soon) fetch(p[ahead], k, false);
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

template <bool fetches>
RBDYN_INLINE_LANES void odd_order(LaneSum& s, std::ptrdiff_t k, [[maybe_unused]] const LaneProduct* soon) {
    Quad sum = s.next;
    for (const LaneProduct *p = s.first, *end = s.last; p != end; ++p) {
        if constexpr (fetches)
            if (p < soon) fetch(p[ahead], k, true);
        sum += p->x[0].value * p->y[k].value + p->x[k].value * p->y[0].value;
    }
    s.sum = sum;
}

/// `laid_out_soon`, `soon`: up to there series and products are asked for ahead, if any are.
template <bool fetches>
RBDYN_INLINE_LANES void advance(const LaneSeries* series, const LaneSeries* series_end, const LaneSpread* spread,
                                const LaneSpread* spread_end, LaneSum* sum, LaneSum* sum_end,
                                [[maybe_unused]] const LaneSeries* laid_out_soon, const LaneProduct* soon,
                                std::ptrdiff_t k) {
    for (; series != series_end; ++series) {
        if constexpr (fetches)
            if (series < laid_out_soon) fetch(series[ahead], k);
        series->to[k].value =
            series->weight * Quad{series->from[0][k], series->from[1][k], series->from[2][k], series->from[3][k]};
    }
    for (; spread != spread_end; ++spread) {
        const double value = spread->from[k];
        spread->to[k].value = Quad{value, value, value, value};
    }
    if (k == 0)
        for (; sum != sum_end; ++sum) first_order(*sum);
    else if (k % 2 == 0)
        for (; sum != sum_end; ++sum) even_order<fetches>(*sum, k, soon);
    else
        for (; sum != sum_end; ++sum) odd_order<fetches>(*sum, k, soon);
}

}  // namespace lanes

}  // namespace rbdyn::inline RBDYN_FORM::series
