// Definitions of rbdyn/basics/vector.hpp.
#pragma once

#include "rbdyn/basics/vector.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Matrix3 columns(const Vector3& x, const Vector3& y, const Vector3& z) {
    Matrix3 m;
    for (int i = 0; i < 3; ++i) {
        m(i, 0) = x[i];
        m(i, 1) = y[i];
        m(i, 2) = z[i];
    }
    return m;
}

RBDYN_INLINE Vector3 lesser(const Vector3& a, const Vector3& b) {
    return {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])};
}

RBDYN_INLINE Vector3 greater(const Vector3& a, const Vector3& b) {
    return {std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])};
}

RBDYN_INLINE double largest(const Matrix3& m) {
    double size = 0.0;
    for (int i = 0; i < 9; ++i) size = std::max(size, std::abs(m.data()[i]));
    return size;
}

}  // namespace rbdyn::inline RBDYN_FORM
