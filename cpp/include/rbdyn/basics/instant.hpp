// Time as an unevaluated sum of two doubles, so that the step lengths and the times of events keep their digits in
// runs of any length (Dekker, "A floating-point technique for extending the available precision", 1971).
#pragma once

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// hi + lo, |lo| at most half a unit in the last place of hi.
struct Instant {
    double hi = 0.0, lo = 0.0;

    double value() const { return hi; }
};

/// a + b exactly, as a sum of two doubles (Knuth's two-sum).
inline Instant exact_sum(double a, double b) {
    const double s = a + b, v = s - a;
    return {s, (a - (s - v)) + (b - v)};
}

inline Instant operator+(Instant t, double h) {
    const Instant s = exact_sum(t.hi, h);
    return exact_sum(s.hi, s.lo + t.lo);
}

/// The time from b to a, with all its digits.
inline Instant exact_difference(Instant a, Instant b) {
    const Instant s = exact_sum(a.hi, -b.hi);
    return exact_sum(s.hi, s.lo + (a.lo - b.lo));
}

/// The time from b to a.
inline double operator-(Instant a, Instant b) { return (a.hi - b.hi) + (a.lo - b.lo); }
inline double operator-(double a, Instant b) { return (a - b.hi) - b.lo; }

}  // namespace rbdyn::inline RBDYN_FORM
