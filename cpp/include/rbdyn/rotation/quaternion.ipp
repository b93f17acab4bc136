// Definitions of rbdyn/rotation/quaternion.hpp.
#pragma once

#include "rbdyn/rotation/quaternion.hpp"

#include <cmath>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Quaternion rounded(const QuaternionOf<DoubleDouble>& q) {
    return {static_cast<double>(q.w), static_cast<double>(q.x), static_cast<double>(q.y), static_cast<double>(q.z)};
}

RBDYN_INLINE Matrix3 rotation_matrix(const Quaternion& q) {
    const AxesOf<double> e = axes(q);
    return columns(e.e1, e.e2, e.e3);
}

RBDYN_INLINE Matrix3Of<DoubleDouble> rotation_matrix(const QuaternionOf<DoubleDouble>& q) {
    const AxesOf<DoubleDouble> e = axes(q);
    Matrix3Of<DoubleDouble> result;
    result.col(0) = e.e1;
    result.col(1) = e.e2;
    result.col(2) = e.e3;
    return result;
}

RBDYN_INLINE QuaternionOf<DoubleDouble> quaternion(const Matrix3Of<DoubleDouble>& r) {
    // four times the product of the largest with each
    const DoubleDouble trace = r(0, 0) + r(1, 1) + r(2, 2);
    int largest = 0;
    for (int i = 1; i < 3; ++i)
        if (r(i, i) > r(largest, largest)) largest = i;
    if (trace > r(largest, largest))
        return normalized(
            QuaternionOf<DoubleDouble>{1.0 + trace, r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1)});
    const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
    DoubleDouble v[3];
    v[i] = 1.0 + r(i, i) - r(j, j) - r(k, k);
    v[j] = r(i, j) + r(j, i);
    v[k] = r(i, k) + r(k, i);
    return normalized(QuaternionOf<DoubleDouble>{r(k, j) - r(j, k), v[0], v[1], v[2]});
}

RBDYN_INLINE Quaternion turn(const Vector3& axis, double angle) {
    const double s = std::sin(0.5 * angle);
    return {std::cos(0.5 * angle), s * axis[0], s * axis[1], s * axis[2]};
}

}  // namespace rbdyn::inline RBDYN_FORM
