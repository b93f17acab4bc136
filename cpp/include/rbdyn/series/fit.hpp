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

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace rbdyn::series {

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
    static void coefficients(const double* values, double negligible, double* c) {
        const Tables& t = tables();
        std::array<double, points> terms;
        for (int k = 0; k <= degree; ++k) {
            double sum = 0.5 * (values[0] * t.chebyshev[at(k)][0] + values[degree] * t.chebyshev[at(k)][degree]);
            for (int j = 1; j < degree; ++j) sum += values[j] * t.chebyshev[at(k)][at(j)];
            terms[at(k)] = sum * (k == 0 || k == degree ? 1.0 : 2.0) / degree;
        }
        int last = degree;
        for (double rest = std::abs(terms[degree]); last > 0 && rest <= negligible; rest += std::abs(terms[at(last)]))
            --last;
        std::fill_n(c, points, 0.0);
        for (int k = 0; k <= last; ++k)
            for (int i = 0; i <= k; ++i) c[i] += terms[at(k)] * t.powers[at(k)][at(i)];
        c[0] = values[0];
    }

private:
    static std::size_t at(int index) { return static_cast<std::size_t>(index); }

    struct Tables {
        std::array<double, points> place;
        std::array<double, checks> check;
        std::array<std::array<double, points>, points> chebyshev;  // T_k at point j
        std::array<std::array<double, points>, points> powers{};   // T_k(2 x - 1) in powers of x

        Tables() {
            for (int j = 0; j <= degree; ++j) {
                const double s = std::sin(0.5 * std::numbers::pi * j / degree);
                place[at(j)] = s * s;
                for (int k = 0; k <= degree; ++k) {
                    // x = (1 - cos(pi j / n)) / 2, so 2 x - 1 = cos(pi - pi j / n)
                    const int turns = k * (degree - j) % (2 * degree);
                    chebyshev[at(k)][at(j)] = std::cos(std::numbers::pi * turns / degree);
                }
            }
            constexpr std::array<int, checks> between{0, 3, 7, 11};
            for (int j = 0; j < checks; ++j) {
                const double s = std::sin(0.5 * std::numbers::pi * (between[at(j)] + 0.5) / degree);
                check[at(j)] = s * s;
            }
            // T_{k+1} = 2 (2 x - 1) T_k - T_{k-1}; whole numbers below 2^53
            powers[0][0] = 1.0;
            powers[1][0] = -1.0;
            powers[1][1] = 2.0;
            for (int k = 1; k < degree; ++k)
                for (int i = 0; i <= k + 1; ++i)
                    powers[at(k + 1)][at(i)] = (i > 0 ? 4.0 * powers[at(k)][at(i - 1)] : 0.0) -
                                               2.0 * powers[at(k)][at(i)] - powers[at(k - 1)][at(i)];
        }
    };
    static const Tables& tables() {
        static const Tables t;
        return t;
    }
};

}  // namespace rbdyn::series
