// The value of a polynomial.
#pragma once

namespace rbdyn::series {

/// sum_k c[k] x^k, k = 0 .. degree, by Horner's scheme.
inline double value(const double* c, int degree, double x) {
    double sum = c[degree];
    for (int k = degree - 1; k >= 0; --k) sum = sum * x + c[k];
    return sum;
}

}  // namespace rbdyn::series
