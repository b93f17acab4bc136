// A polynomial through values of a function at Chebyshev points, for functions that have values but no series.
//
// Source: Trefethen, "Approximation Theory and Approximation Practice", SIAM 2013, ch. 2 (points x_j = cos(pi j / n)),
// ch. 3 (coefficients a_k of the Chebyshev polynomials T_k from the values there), ch. 4 (what the last ones say).
//
// Conventions: the interval is [0, 1], x = 0 the first point and x = 1 the last; the result is in powers of x. Each T_k
// on [0, 1] has whole coefficients, of a sum of sizes (3 + sqrt 8)^k / 2, so terms that are rounding of the values are
// left out before they are multiplied by it.
// Invariant: the polynomial is the first value at x = 0, exactly.
#pragma once

#include <array>
#include <cstddef>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

class Fit {
public:
    static constexpr int degree = 12;
    static constexpr int points = degree + 1;
    static constexpr int checks = 4;

    /// Where the values are taken.
    static double place(int j) { return tables().place[at(j)]; }
    /// Where a fit is held against the function: between points, more closely towards the ends as these are.
    static double check(int j) { return tables().check[at(j)]; }

    /// Coefficients 0 .. degree in powers of x from the values at the points; of the last terms those that together
    /// are at most `negligible` are left out.
    static void coefficients(const double* values, double negligible, double* c);

private:
    static std::size_t at(int index) { return static_cast<std::size_t>(index); }

    struct Tables {
        std::array<double, points> place;
        std::array<double, checks> check;
        std::array<std::array<double, points>, points> chebyshev;  // T_k at point j
        std::array<std::array<double, points>, points> powers{};   // T_k(2 x - 1) in powers of x

        Tables();
    };
    static const Tables& tables();
};

}  // namespace rbdyn::inline RBDYN_FORM::series
