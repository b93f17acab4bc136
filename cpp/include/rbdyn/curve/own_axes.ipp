// Definitions of rbdyn/curve/own_axes.hpp.
#pragma once

#include "rbdyn/curve/own_axes.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE WideVector OwnAxes::of(const WideVector& v) const {
    WideVector own = turned<DoubleDouble>(axes.transpose(), v);
    const double size = norm(rounded(v));
    for (int i = 0; i < 3; ++i)
        if (i >= dimension || (dimension < 3 && std::abs(own[i].hi) <= snap * size)) own[i] = 0.0;
    return own;
}

RBDYN_INLINE WideMatrix axes_without(int missing) {
    if (missing == 2) return widened(Matrix3(Matrix3::Identity()));
    return axes_of_plane(missing == 1 ? Vector3(1, 0, 0) : Vector3(0, 1, 0), {0, 0, 1});
}

RBDYN_INLINE OwnAxes own_axes(const std::vector<Vector3>& vectors, double slack) {
    // relative to the vector itself
    constexpr double flat = 1e-14;
    const auto tolerated = [&](const Vector3& v) { return flat * norm(v) + slack; };
    const LongVector along = unit_long(vectors.front());

    // the vector farthest from the line of the first makes the plane best known
    const Vector3* farthest = nullptr;
    long double distance = 0.0L;
    for (const Vector3& v : vectors) {
        if ((&v - vectors.data()) % 64 == 0) Interruption::point();
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

RBDYN_INLINE Vector3 binormal_of_line(const Matrix3& axes, const Vector3& tangent) {
    return axes.transpose() * rounded(axes_of_line(turned<double>(axes, tangent)).col(2));
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
