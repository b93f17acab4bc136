// Mass, centre of mass and inertia of a body, in body axes, in numbers of 32 digits.
//
//   I_Q = Int rho (|x|^2 1 - x x^T) dtau, x = P - Q          off the diagonal -Int rho x_i x_j       (proof of 7.33)
//   I_Q = I_G + m (|d|^2 1 - d d^T), d = Q - G               Huygens-Steiner
//   I of two bodies about their common G = I_a + I_b + (m_a m_b / m) (|d|^2 1 - d d^T), d = G_b - G_a
//
// From the user's doubles as they are, so that what derives from them keeps all its digits.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct MassProperties {
    DoubleDouble mass;                // [kg]
    Vector3Of<DoubleDouble> com;      // from the body's origin [m]
    Matrix3Of<DoubleDouble> inertia;  // about the centre of mass [kg m^2]

    bool operator==(const MassProperties&) const = default;
};

/// The inertia of a point mass at d from the pole: m (|d|^2 1 - d d^T).
Matrix3Of<DoubleDouble> point_inertia(const DoubleDouble& mass, const Vector3Of<DoubleDouble>& d);

/// About any point [m], body axes.
Matrix3Of<DoubleDouble> inertia_about(const MassProperties& body, const Vector3Of<DoubleDouble>& point);

/// Of two bodies in the same axes, welded.
MassProperties welded(const MassProperties& a, const MassProperties& b);

/// Turned about the body's origin by R(q), q a unit quaternion.
MassProperties turned(const MassProperties& body, const QuaternionOf<DoubleDouble>& q);

}  // namespace rbdyn::inline RBDYN_FORM
