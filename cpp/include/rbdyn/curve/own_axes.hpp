// The axes in which as much as possible of a curve vanishes: those of the line or plane it lies in.
//
//   on a line     axes of Line along the first vector
//   in a plane    world axes if the plane is parallel to x y, x z or y z; else first axis along the first vector
//   in space      world axes
// A recorded model has nothing to do for a component that is exactly zero. Invariant: own axes and world give the same
// vectors to rounding error.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "rbdyn/curve/axes.hpp"

namespace rbdyn::curves {

struct OwnAxes {
    WideMatrix axes;
    int dimension;  // 1 on a line, 2 in a plane, 3 in space

    /// A vector that lies in the line or plane, in own axes: what is outside, or rounding, is zero.
    WideVector of(const WideVector& v) const {
        WideVector own = turned<DoubleDouble>(axes.transpose(), v);
        const double size = norm(rounded(v));
        for (int i = 0; i < 3; ++i)
            if (i >= dimension || (dimension < 3 && std::abs(own[i].hi) <= snap * size)) own[i] = 0.0;
        return own;
    }
};

/// The plane of two axes of the world: x y (missing = 2), x z (1) or y z (0).
inline WideMatrix axes_without(int missing) {
    if (missing == 2) return widened(Matrix3(Matrix3::Identity()));
    return axes_of_plane(missing == 1 ? Vector3(1, 0, 0) : Vector3(0, 1, 0), {0, 0, 1});
}

/// Axes of the line or plane that all vectors lie in, the first of which is not zero; what is nearer to it than `slack`
/// lies in it.
inline OwnAxes own_axes(const std::vector<Vector3>& vectors, double slack) {
    // relative to the vector itself
    constexpr double flat = 1e-14;
    const auto tolerated = [&](const Vector3& v) { return flat * norm(v) + slack; };
    const LongVector along = unit_long(vectors.front());

    // the vector farthest from the line of the first makes the plane best known
    const Vector3* farthest = nullptr;
    long double distance = 0.0L;
    for (const Vector3& v : vectors) {
        const long double away = norm(across(along, LongVector(v)));
        if (away <= distance || away <= static_cast<long double>(tolerated(v))) continue;
        distance = away;
        farthest = &v;
    }
    if (farthest == nullptr) return {axes_of_line(vectors.front()), 1};
    for (int i : {2, 1, 0})
        if (std::all_of(vectors.begin(), vectors.end(), [&](const Vector3& v) { return v[i] == 0.0; }))
            return {axes_without(i), 2};
    const WideMatrix axes = axes_of_plane(vectors.front(), *farthest);
    const Vector3 across = rounded(axes.col(2));
    const bool plane = std::all_of(vectors.begin(), vectors.end(),
                                   [&](const Vector3& v) { return std::abs(across.dot(v)) <= tolerated(v); });
    if (plane) return {axes, 2};
    return {widened(Matrix3(Matrix3::Identity())), 3};
}

/// The binormal of a straight line, for a curve that bends nowhere near: tangent and result in the curve's own axes.
inline Vector3 binormal_of_line(const Matrix3& axes, const Vector3& tangent) {
    return axes.transpose() * rounded(axes_of_line(turned<double>(axes, tangent)).col(2));
}

}  // namespace rbdyn::curves
