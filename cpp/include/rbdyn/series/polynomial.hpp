// The value of a polynomial, and the same polynomial from elsewhere.
#pragma once

#include <cmath>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

/// sum_k c[k] x^k, k = 0 .. degree, by Horner's scheme.
inline double value(const double* c, int degree, double x) {
    double sum = c[degree];
    for (int k = degree - 1; k >= 0; --k) sum = sum * x + c[k];
    return sum;
}

/// sum_k |c[k]| x^k, the size of the terms at x >= 0.
inline double value_of_sizes(const double* c, int degree, double x) {
    double sum = std::abs(c[degree]);
    for (int k = degree - 1; k >= 0; --k) sum = sum * x + std::abs(c[k]);
    return sum;
}

/// The coefficients of p(x + by) in place of those of p (Horner's scheme, repeated).
inline void shift(double* c, int degree, double by) {
    for (int j = 0; j < degree; ++j)
        for (int k = degree - 1; k >= j; --k) c[k] += by * c[k + 1];
}

}  // namespace rbdyn::inline RBDYN_FORM::series
