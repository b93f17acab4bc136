// The value of a polynomial, and the same polynomial from elsewhere.
#pragma once

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

/// sum_k c[k] x^k, k = 0 .. degree, by Horner's scheme.
double value(const double* c, int degree, double x);

/// sum_k |c[k]| x^k, the size of the terms at x >= 0.
double value_of_sizes(const double* c, int degree, double x);

/// The coefficients of p(x + by) in place of those of p (Horner's scheme, repeated).
void shift(double* c, int degree, double by);

}  // namespace rbdyn::inline RBDYN_FORM::series
