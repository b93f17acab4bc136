// The axes that the equations of particles and beads are written in: one placement for a scene, chosen so that what
// vanishes vanishes exactly. A bead on a plane curve under forces in its plane then has r' x F = (0, 0, c_z), and its
// length is c_z with its sign locked. Scenes with rigid bodies are seen from the world.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// m v, with all its products: where v is recorded, as the equations have them.
template <class S>
Vector3Of<S> times(const Matrix3Of<DoubleDouble>& m, const Vector3Of<S>& v) {
    Vector3Of<S> result;
    for (int i = 0; i < 3; ++i)
        result[i] = exactly<S>(m(i, 0)) * v[0] + exactly<S>(m(i, 1)) * v[1] + exactly<S>(m(i, 2)) * v[2];
    return result;
}
template <class S>
Vector3Of<S> times(const Matrix3& m, const Vector3Of<S>& v) {
    Vector3Of<S> result;
    for (int i = 0; i < 3; ++i) result[i] = S(m(i, 0)) * v[0] + S(m(i, 1)) * v[1] + S(m(i, 2)) * v[2];
    return result;
}

struct SceneView : Placement {
    /// A place of the view in the world.
    template <class S>
    Vector3Of<S> in_world(const Vector3Of<S>& r) const {
        return to_world<S>(r) + Vector3Of<S>(origin);
    }
    /// A vector of the view in the world, and back.
    template <class S>
    Vector3Of<S> to_world(const Vector3Of<S>& v) const {
        if constexpr (std::is_same_v<S, double>)
            return times<S>(axes, v);
        else
            return times<S>(exact_axes(), v);
    }
    template <class S>
    Vector3Of<S> to_view(const Vector3Of<S>& v) const {
        if constexpr (std::is_same_v<S, double>)
            return {dot(column(axes, 0), v), dot(column(axes, 1), v), dot(column(axes, 2), v)};
        else
            return times<S>(exact_axes().transpose(), v);
    }

    /// A vector of the world, or a place, as given in doubles, in the view: without what is rounding in its components.
    Vector3 seen(const Vector3& v) const { return snapped<Vector3>(axes.transpose() * v, v.norm()); }
    Vector3Of<DoubleDouble> seen_exactly(const Vector3& v) const {
        return snapped(curves::turned<DoubleDouble>(exact_axes().transpose(), widened(v)), v.norm());
    }
    Vector3Of<DoubleDouble> seen_point(const Vector3& p) const {
        const Vector3Of<DoubleDouble> offset = widened(p) - widened(origin);
        return snapped(curves::turned<DoubleDouble>(exact_axes().transpose(), offset), p.norm() + origin.norm());
    }

    /// Zero for components that are rounding of a vector of that size.
    template <class Vector>
    static Vector snapped(Vector v, double size) {
        for (int i = 0; i < 3; ++i)
            if (std::abs(static_cast<double>(v[i])) <= 4.0 * std::numeric_limits<double>::epsilon() * size) v[i] = 0.0;
        return v;
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
