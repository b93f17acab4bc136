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
Instant exact_sum(double a, double b);

Instant operator+(Instant t, double h);

/// The time from b to a, with all its digits.
Instant exact_difference(Instant a, Instant b);
/// The time from b to a.
inline double operator-(Instant a, Instant b) { return (a.hi - b.hi) + (a.lo - b.lo); }
inline double operator-(double a, Instant b) { return (a - b.hi) - b.lo; }

}  // namespace rbdyn::inline RBDYN_FORM
