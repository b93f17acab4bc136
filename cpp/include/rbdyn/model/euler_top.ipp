// Definitions of rbdyn/model/euler_top.hpp.
#pragma once

#include "rbdyn/model/euler_top.hpp"

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/rotation/euler_angles.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE EulerTop::EulerTop(const RigidBody& body, double gravity, const Vector3& point, double least)
    : weight_(body.mass() * gravity), arm_(body.com() - point), least_(least) {
    const Matrix3 about = body.inertia(point);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j)
            require(std::abs(about(i, j)) <= 1e-12 * about.diagonal().maxCoeff(), "EulerTop",
                    "product of inertia " + std::to_string(j + 1) + std::to_string(i + 1), about(i, j),
                    "its equations are those of the principal axes at the fixed point; turn the body's axes there");
    moments_ = about.diagonal();
    require(std::isfinite(gravity), "EulerTop", "gravity", gravity, "it is finite; give it in m/s^2");
    require(least > 0.0 && least < 1.0, "EulerTop", "least", least, "it lies between 0 and 1, a sine");
}

RBDYN_INLINE void EulerTop::require_start(std::span<const double> x) const {
    const double s = std::abs(std::sin(x[0]));
    require(s > least_, "EulerTop", "|sin theta| at the start", s,
            "Euler angles fail where theta is 0 or pi, and a run starts where it is above " + text(least_) +
                "; start elsewhere, or give the body to a Scene, which is computed in quaternions");
}

RBDYN_INLINE std::vector<double> EulerTop::state(const EulerAngles& angles, const Vector3& omega) {
    const Vector3 rates = euler_rates(angles, omega);
    return {angles.theta, angles.psi, angles.phi, rates[0], rates[1], rates[2]};
}

}  // namespace rbdyn::inline RBDYN_FORM
