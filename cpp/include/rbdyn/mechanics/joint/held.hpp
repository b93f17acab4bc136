// What joints share: where in the parent they are, and the points and axes they hold.
//
// Conventions: constants derive from the user's doubles in 32 digits.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// Where a joint is in its parent.
struct Held {
    Vector3Of<DoubleDouble> offset{};  // from P of the parent to the joint, in the parent's axes [m]
    Vector3Of<DoubleDouble> point{};   // P of the child, from the origin of its axes [m]

    template <class S>
    Moving<S> carry(const Moving<S>& parent) const {
        return carried<S>(parent, exactly<S>(offset));
    }
};

/// A direction in 32 digits.
inline Vector3Of<DoubleDouble> unit(const Vector3& v) {
    const Vector3Of<DoubleDouble> wide = widened(v);
    const DoubleDouble length = sqrt(dot<DoubleDouble>(wide, wide));
    return {wide[0] / length, wide[1] / length, wide[2] / length};
}
/// The direction of what is left of v across a unit vector.
inline Vector3Of<DoubleDouble> unit_across(const Vector3& v, const Vector3Of<DoubleDouble>& axis) {
    const Vector3Of<DoubleDouble> wide = widened(v), left = wide - axis * dot<DoubleDouble>(wide, axis);
    const DoubleDouble length = sqrt(dot<DoubleDouble>(left, left));
    return {left[0] / length, left[1] / length, left[2] / length};
}

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
