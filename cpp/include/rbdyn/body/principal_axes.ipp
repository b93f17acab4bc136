// Definitions of rbdyn/body/principal_axes.hpp.
#pragma once

#include "rbdyn/body/principal_axes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM::bodies {

RBDYN_INLINE void jacobi_turn(Matrix3Of<DoubleDouble>& a, Matrix3Of<DoubleDouble>& e, int p, int q) {
    const DoubleDouble cotangent = (a(q, q) - a(p, p)) / (2.0 * a(p, q));  // of twice the angle
    const DoubleDouble size = abs(cotangent);
    const DoubleDouble t = (cotangent.hi < 0.0 ? -1.0 : 1.0) / (size + sqrt(size * size + 1.0));
    const DoubleDouble c = 1.0 / sqrt(t * t + 1.0), s = t * c;
    const int r = 3 - p - q;
    const DoubleDouble taken = t * a(p, q), arp = a(r, p), arq = a(r, q);
    a(p, p) -= taken;
    a(q, q) += taken;
    a(p, q) = a(q, p) = 0.0;
    a(r, p) = a(p, r) = c * arp - s * arq;
    a(r, q) = a(q, r) = s * arp + c * arq;
    for (int i = 0; i < 3; ++i) {
        const DoubleDouble eip = e(i, p), eiq = e(i, q);
        e(i, p) = c * eip - s * eiq;
        e(i, q) = s * eip + c * eiq;
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::bodies

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PrincipalAxesOf<DoubleDouble> principal_axes(Matrix3Of<DoubleDouble> a) {
    Matrix3Of<DoubleDouble> e;
    for (int i = 0; i < 3; ++i) e(i, i) = 1.0;
    double size = 0.0;
    for (int j = 0; j < 3; ++j)
        for (const DoubleDouble& x : a.col(j)) size = std::max(size, std::abs(double(x)));
    // an element that no longer shows in 106 bits of the largest
    const double negligible = 0x1p-110 * size;
    // each sweep squares what is left beside the diagonal: five or six suffice
    for (int sweep = 0; sweep < 20; ++sweep) {
        bool diagonal = true;
        for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
            if (std::abs(a(p, q).hi) <= negligible) continue;
            diagonal = false;
            bodies::jacobi_turn(a, e, p, q);
        }
        if (diagonal) break;
    }

    // each axis to the given one it is nearest to: the first of the orders with the largest sum
    constexpr std::array<std::array<int, 3>, 6> orders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    const auto nearness = [&](const std::array<int, 3>& order) {
        double sum = 0.0;
        for (int i = 0; i < 3; ++i) sum += std::abs(e(i, order[static_cast<std::size_t>(i)]).hi);
        return sum;
    };
    const auto order = *std::max_element(orders.begin(), orders.end(),
                                         [&](const auto& x, const auto& y) { return nearness(x) < nearness(y); });
    PrincipalAxesOf<DoubleDouble> result;
    for (int i = 0; i < 3; ++i) {
        const int k = order[static_cast<std::size_t>(i)];
        result.moments[i] = a(k, k);
        result.axes.col(i) = e.col(k);
        if (i < 2 && result.axes(i, i).hi < 0.0) result.axes.col(i) = -result.axes.col(i);
    }
    const auto& x = result.axes;
    if (x.col(0).cross(x.col(1)).dot(x.col(2)).hi < 0.0) result.axes.col(2) = -x.col(2);

    // what the turns' rounding may have set apart: some twenty of them, each good to 2^-104
    const double rounding = 0x1p-98 * size;
    auto& m = result.moments;
    for (int i = 0; i < 3; ++i)
        if (std::abs(m[i].hi) <= rounding) m[i] = 0.0;
    for (const auto& [i, j] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)})
        if (std::abs((m[i] - m[j]).hi) <= rounding) m[j] = m[i];
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
