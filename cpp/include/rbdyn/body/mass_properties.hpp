// Mass, centre of mass and inertia of a body, in body axes, in numbers of 32 digits.
//
//   I_Q = Int rho (|x|^2 1 - x x^T) dtau, x = P - Q          off the diagonal -Int rho x_i x_j       (proof of 7.33)
//   I_Q = I_G + m (|d|^2 1 - d d^T), d = Q - G               Huygens-Steiner
//   I of two bodies about their common G = I_a + I_b + (m_a m_b / m) (|d|^2 1 - d d^T), d = G_b - G_a
//
// From the user's doubles as they are, so that what derives from them keeps all its digits.
#pragma once

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn {

struct MassProperties {
    DoubleDouble mass;                // [kg]
    Vector3Of<DoubleDouble> com;      // from the body's origin [m]
    Matrix3Of<DoubleDouble> inertia;  // about the centre of mass [kg m^2]

    bool operator==(const MassProperties&) const = default;
};

/// The inertia of a point mass at d from the pole: m (|d|^2 1 - d d^T).
inline Matrix3Of<DoubleDouble> point_inertia(const DoubleDouble& mass, const Vector3Of<DoubleDouble>& d) {
    Matrix3Of<DoubleDouble> result;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        // sums of squares, so that nothing cancels
        result(i, i) = mass * (d[j] * d[j] + d[k] * d[k]);
        result(i, j) = result(j, i) = -(mass * (d[i] * d[j]));
    }
    return result;
}

/// About any point [m], body axes.
inline Matrix3Of<DoubleDouble> inertia_about(const MassProperties& body, const Vector3Of<DoubleDouble>& point) {
    return body.inertia + point_inertia(body.mass, point - body.com);
}

/// Of two bodies in the same axes, welded.
inline MassProperties welded(const MassProperties& a, const MassProperties& b) {
    const DoubleDouble mass = a.mass + b.mass;
    const Vector3Of<DoubleDouble> d = b.com - a.com;
    return {mass, a.com + scaled(d, b.mass / mass), a.inertia + b.inertia + point_inertia(a.mass * b.mass / mass, d)};
}

/// Turned about the body's origin by R(q), q a unit quaternion.
inline MassProperties turned(const MassProperties& body, const QuaternionOf<DoubleDouble>& q) {
    const Matrix3Of<DoubleDouble> r = rotation_matrix(q);
    Matrix3Of<DoubleDouble> inertia = product(product(r, body.inertia), r.transpose());
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) inertia(i, j) = inertia(j, i);
    return {body.mass, product(r, body.com), inertia};
}

}  // namespace rbdyn
