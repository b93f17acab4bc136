// Definitions of rbdyn/basics/instant.hpp.
#pragma once

#include "rbdyn/basics/instant.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Instant exact_sum(double a, double b) {
    const double s = a + b, v = s - a;
    return {s, (a - (s - v)) + (b - v)};
}

RBDYN_INLINE Instant operator+(Instant t, double h) {
    const Instant s = exact_sum(t.hi, h);
    const Instant r = exact_sum(s.hi, s.lo + t.lo);
    return r;
}

RBDYN_INLINE Instant exact_difference(Instant a, Instant b) {
    const Instant s = exact_sum(a.hi, -b.hi);
    return exact_sum(s.hi, s.lo + (a.lo - b.lo));
}

}  // namespace rbdyn::inline RBDYN_FORM
