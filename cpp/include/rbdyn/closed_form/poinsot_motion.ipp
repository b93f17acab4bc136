// Definitions of rbdyn/closed_form/poinsot_motion.hpp.
#pragma once

#include "rbdyn/closed_form/poinsot_motion.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/closed_form/free_rotation.hpp"
#include "rbdyn/closed_form/poinsot.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PoinsotMotion::PoinsotMotion(const RigidBody& body, const Vector3& angular_velocity,
                                          const std::optional<Vector3>& point)
    : body_(body),
      point_(point),
      inertia_(point ? body.inertia(*point) : body.inertia()),
      principal_(point ? body.principal(*point) : body.principal()),
      omega_(angular_velocity),
      rotation_(point ? body.principal_exact(*point) : body.principal_exact(), {}, angular_velocity) {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(omega_[i]), "PoinsotMotion", "component " + std::to_string(i) + " of angular_velocity",
                omega_[i], "it is finite; give it in rad/s");
    require(principal_.moments.minCoeff() > 0.0, "PoinsotMotion", "least principal moment",
            principal_.moments.minCoeff(), "a body that turns freely has three moments of inertia");
}

RBDYN_INLINE std::string_view PoinsotMotion::kind() const {
    if (is_permanent() && rotation_.regime() != FreeRotation::Regime::rest) return "permanent";
    switch (rotation_.regime()) {
        case FreeRotation::Regime::rest: return "rest";
        case FreeRotation::Regime::permanent: return "permanent";
        case FreeRotation::Regime::symmetric: return "symmetric";
        case FreeRotation::Regime::separatrix: return "separatrix";
        default: return "generic";
    }
}

RBDYN_INLINE double PoinsotMotion::growth_rate() const {
    if (!is_permanent()) return std::numeric_limits<double>::quiet_NaN();
    const Vector3 along = principal_.axes.transpose() * omega_;
    Eigen::Index axis = 0;
    along.cwiseAbs().maxCoeff(&axis);
    return rbdyn::growth_rate(principal_.moments, static_cast<int>(axis), omega_.norm());
}

RBDYN_INLINE std::vector<Vector3> PoinsotMotion::polhode(int count, std::optional<double> until) const {
    return way(count, until, false);
}

RBDYN_INLINE std::vector<Vector3> PoinsotMotion::herpolhode(int count, std::optional<double> until) const {
    return way(count, until, true);
}

RBDYN_INLINE std::vector<Vector3> PoinsotMotion::way(int count, const std::optional<double>& until,
                                                     bool in_world) const {
    require(count >= 2, "PoinsotMotion", "count", count, "a way has at least two points");
    const double end = until.value_or(period());
    require(std::isfinite(end), "PoinsotMotion", "until", end,
            "this omega has no period; give the time up to which its way is wanted, in s");
    // a phase of so many radians has 1e-12 of one left in the digits that it is computed in
    constexpr double longest = 0x1p64;
    require(
        omega_.norm() * std::abs(end) <= longest, "PoinsotMotion", "until", end,
        "beyond " + text(longest) + " rad of |omega| until nobody knows where on its way omega is; give less, in s");
    std::vector<Vector3> points;
    points.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        Interruption::point();
        const FreeRotation::State s = rotation_.at(end * i / (count - 1));
        points.push_back(in_world ? to_world<double>(s.attitude, s.angular_velocity) : s.angular_velocity);
        require(is_finite(points.back()), "PoinsotMotion", "|omega|", omega_.norm(),
                "its motion is beyond doubles; give body and angular velocity in units in which it is not");
    }
    return points;
}

}  // namespace rbdyn::inline RBDYN_FORM
