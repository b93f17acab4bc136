// Definitions of rbdyn/series/fit.hpp.
#pragma once

#include "rbdyn/series/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rbdyn::inline RBDYN_FORM::series {

RBDYN_INLINE void Fit::coefficients(const double* values, double negligible, double* c) {
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

RBDYN_INLINE Fit::Tables::Tables() {
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
            powers[at(k + 1)][at(i)] =
                (i > 0 ? 4.0 * powers[at(k)][at(i - 1)] : 0.0) - 2.0 * powers[at(k)][at(i)] - powers[at(k - 1)][at(i)];
}

RBDYN_INLINE const Fit::Tables& Fit::tables() {
    static const Tables t;
    return t;
}

}  // namespace rbdyn::inline RBDYN_FORM::series
