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

}  // namespace rbdyn
