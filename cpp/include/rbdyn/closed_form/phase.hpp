// Angles that grow evenly with time, reduced in numbers of 32 digits: after a million turns a phase still has the
// digits of a double.
#pragma once

#include <cmath>
#include <limits>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// start + rate t, to be reduced by whole multiples of a step; an infinite step leaves it as it is.
class Phase {
public:
    struct Reduced {
        DoubleDouble rest;   // |rest| <= step/2
        DoubleDouble steps;  // taken off, a whole number

        bool is_odd() const {
            const DoubleDouble half = 0.5 * steps;
            return floor(half) != half;
        }
    };

    Phase() = default;
    Phase(const DoubleDouble& rate, const DoubleDouble& start, const DoubleDouble& step);

    const DoubleDouble& rate() const { return rate_; }

    Reduced at(Instant t, const DoubleDouble& more = 0.0) const;

private:
    DoubleDouble rate_, start_, step_ = std::numeric_limits<double>::infinity();
    double per_step_ = 0.0;  // 1/step
};

/// Sine and cosine in a number type, the low part of the angle included.
template <class S>
SineCosine<S> sine_cosine_in(const DoubleDouble& x) {
    return sine_cosine(x);
}
template <>
inline SineCosine<double> sine_cosine_in<double>(const DoubleDouble& x) {
    const SineCosine<double> a = sine_cosine(x.hi);
    return {a.sine + a.cosine * x.lo, a.cosine - a.sine * x.lo};
}

/// exp x in a number type, the low part of x included.
template <class S>
S exp_in(const DoubleDouble& x) {
    return exp(x);
}
template <>
inline double exp_in<double>(const DoubleDouble& x) {
    const double e = std::exp(x.hi);
    return e + e * x.lo;
}

}  // namespace rbdyn::inline RBDYN_FORM
