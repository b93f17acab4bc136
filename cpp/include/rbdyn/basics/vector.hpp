// Vectors and matrices: Eigen's, under the names used throughout.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#if defined(__FAST_MATH__)
#error "rbdyn: -ffast-math breaks compensated sums, event location and the accuracy estimate; compile without it"
#endif

namespace rbdyn {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// A vector whose components are of any number type a model may be evaluated with.
template <class S>
using Vector3Of = Eigen::Matrix<S, 3, 1>;

/// Scalar and vector product, term by term, so that zero components leave nothing behind.
template <class S>
S dot(const Vector3Of<S>& a, const Vector3Of<S>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class S>
Vector3Of<S> cross(const Vector3Of<S>& a, const Vector3Of<S>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace rbdyn
