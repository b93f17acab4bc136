// The axes in which as much as possible of a curve vanishes: those of the line or plane it lies in.
//
//   on a line     axes of Line along the first vector
//   in a plane    world axes if the plane is parallel to x y, x z or y z; else first axis along the first vector
//   in space      world axes
// A recorded model has nothing to do for a component that is exactly zero. Invariant: own axes and world give the same
// vectors to rounding error.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

struct OwnAxes {
    WideMatrix axes;
    int dimension;  // 1 on a line, 2 in a plane, 3 in space

    /// A vector that lies in the line or plane, in own axes: what is outside, or rounding, is zero.
    WideVector of(const WideVector& v) const;
};

/// The plane of two axes of the world: x y (missing = 2), x z (1) or y z (0).
WideMatrix axes_without(int missing);

/// Axes of the line or plane that all vectors lie in, the first of which is not zero; what is nearer to it than `slack`
/// lies in it.
OwnAxes own_axes(const std::vector<Vector3>& vectors, double slack);

/// The binormal of a straight line, for a curve that bends nowhere near: tangent and result in the curve's own axes.
Vector3 binormal_of_line(const Matrix3& axes, const Vector3& tangent);

}  // namespace rbdyn::inline RBDYN_FORM::curves
