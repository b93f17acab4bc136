// Principal axes: I = E diag(moments) E^T, the columns of E orthonormal and right-handed.
//
// By Jacobi's rotations in numbers of 32 digits; a tensor that is diagonal stays as it is. The axes come in the order
// in which they lie nearest to the given ones, so that a tensor nearly diagonal keeps the order of its moments.
// Moments equal to within the rounding of this are made equal, and one that is rounding is made zero: bodies of
// revolution and rods stay what they are in any attitude.
//
// Accuracy: moments to 1e-30 of the largest, axes to 1e-30 over the relative gap between their moments.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "rbdyn/basics/double_double_vector.hpp"

namespace rbdyn {

template <class S>
struct PrincipalAxesOf {
    Vector3Of<S> moments;  // [kg m^2]
    Matrix3Of<S> axes;     // columns: unit vectors, in the axes of the tensor
};

using PrincipalAxes = PrincipalAxesOf<double>;

inline PrincipalAxes rounded(const PrincipalAxesOf<DoubleDouble>& p) { return {rounded(p.moments), rounded(p.axes)}; }

namespace bodies {

/// Sets a(p, q) to zero by a turn in the plane of axes p and q, and turns the axes e with it.
inline void jacobi_turn(Matrix3Of<DoubleDouble>& a, Matrix3Of<DoubleDouble>& e, int p, int q) {
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

}  // namespace bodies

/// Of a symmetric tensor of finite elements.
inline PrincipalAxesOf<DoubleDouble> principal_axes(Matrix3Of<DoubleDouble> a) {
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

}  // namespace rbdyn
