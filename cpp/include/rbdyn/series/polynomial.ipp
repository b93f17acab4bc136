// Definitions of rbdyn/series/polynomial.hpp.
#pragma once

#include "rbdyn/series/polynomial.hpp"

#include <cmath>

namespace rbdyn::inline RBDYN_FORM::series {

RBDYN_INLINE double value(const double* c, int degree, double x) {
    double sum = c[degree];
    for (int k = degree - 1; k >= 0; --k) sum = sum * x + c[k];
    return sum;
}

RBDYN_INLINE double value_of_sizes(const double* c, int degree, double x) {
    double sum = std::abs(c[degree]);
    for (int k = degree - 1; k >= 0; --k) sum = sum * x + std::abs(c[k]);
    return sum;
}

RBDYN_INLINE void shift(double* c, int degree, double by) {
    for (int j = 0; j < degree; ++j)
        for (int k = degree - 1; k >= j; --k) c[k] += by * c[k + 1];
}

}  // namespace rbdyn::inline RBDYN_FORM::series
