// Definitions of rbdyn/body/mass_properties.hpp.
#pragma once

#include "rbdyn/body/mass_properties.hpp"

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Matrix3Of<DoubleDouble> point_inertia(const DoubleDouble& mass, const Vector3Of<DoubleDouble>& d) {
    Matrix3Of<DoubleDouble> result;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        // sums of squares, so that nothing cancels
        result(i, i) = mass * (d[j] * d[j] + d[k] * d[k]);
        result(i, j) = result(j, i) = -(mass * (d[i] * d[j]));
    }
    return result;
}

RBDYN_INLINE Matrix3Of<DoubleDouble> inertia_about(const MassProperties& body, const Vector3Of<DoubleDouble>& point) {
    return body.inertia + point_inertia(body.mass, point - body.com);
}

RBDYN_INLINE MassProperties welded(const MassProperties& a, const MassProperties& b) {
    const DoubleDouble mass = a.mass + b.mass;
    const Vector3Of<DoubleDouble> d = b.com - a.com;
    return {mass, a.com + scaled(d, b.mass / mass), a.inertia + b.inertia + point_inertia(a.mass * b.mass / mass, d)};
}

RBDYN_INLINE MassProperties turned(const MassProperties& body, const QuaternionOf<DoubleDouble>& q) {
    const Matrix3Of<DoubleDouble> r = rotation_matrix(q);
    Matrix3Of<DoubleDouble> inertia = product(product(r, body.inertia), r.transpose());
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) inertia(i, j) = inertia(j, i);
    return {body.mass, product(r, body.com), inertia};
}

}  // namespace rbdyn::inline RBDYN_FORM
