// What can be said of a rigid body's motion without torque before it is computed (Def. 7.2, 7.53-7.56, Prop. 7.1-7.3):
// its kind, rates and angles, polhode and herpolhode.
#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/closed_form/free_rotation.hpp"
#include "rbdyn/closed_form/poinsot.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The Poinsot motion of a body that starts with an angular velocity, about its centre of mass or about a fixed point
/// of it. Body axes; axes of the world as the body's at the start.
class PoinsotMotion {
public:
    PoinsotMotion(const RigidBody& body, const Vector3& angular_velocity,
                  const std::optional<Vector3>& point = std::nullopt);

    /// What it was made from.
    const RigidBody& body() const { return body_; }
    const Vector3& angular_velocity() const { return omega_; }
    const std::optional<Vector3>& point() const { return point_; }

    /// rest, permanent, symmetric (a regular precession), separatrix, generic.
    std::string_view kind() const;
    /// Whether omega stays as it is (Thm 7.12), within the rounding of axes that were computed: by
    /// is_permanent_rotation(). For longer than about 1/(rtol |omega|) such a rotation need not stay the same.
    bool is_permanent(double rtol = 1e-12) const { return is_permanent_rotation(inertia_, omega_, rtol); }
    /// The rate at which a small disturbance of a permanent rotation grows [1/s]; zero about a stable axis. Not a
    /// number for a rotation that is not permanent.
    double growth_rate() const;
    /// Of omega in body axes [s]; infinite where it is constant, and on the separatrix.
    double period() const { return rotation_.period(); }
    /// Mean rates [rad/s] at which the axis that K circles goes round K, and at which the body turns about that axis;
    /// for a gyroscope those of its regular precession (Prop. 7.3).
    double precession_rate() const { return rotation_.precession_rate(); }
    double proper_rotation_rate() const { return rotation_.proper_rotation_rate(); }
    /// Least and largest angle between that axis and K [rad].
    std::pair<double, double> tilt() const { return rotation_.tilt(); }
    /// K = I omega [kg m^2/s] and T = K.omega/2 [J]: constant (7.54, 7.55).
    Vector3 angular_momentum() const { return inertia_ * omega_; }
    double kinetic_energy() const { return 0.5 * omega_.dot(angular_momentum()); }
    /// omega.K/|K|, the distance of the plane on which the ellipsoid of inertia rolls [rad/s].
    double plane_distance() const { return poinsot_plane_distance(inertia_, omega_); }

    /// The way of omega in the body, and in the world, at times from 0 to a time, by default one period [rad/s]. Throws
    /// InvalidInput for a time in which |omega| makes more than 2^64 rad.
    std::vector<Vector3> polhode(int count, std::optional<double> until = std::nullopt) const;
    std::vector<Vector3> herpolhode(int count, std::optional<double> until = std::nullopt) const;

private:
    std::vector<Vector3> way(int count, const std::optional<double>& until, bool in_world) const;

    RigidBody body_;
    std::optional<Vector3> point_;
    Matrix3 inertia_;
    PrincipalAxes principal_;
    Vector3 omega_;
    FreeRotation rotation_;
};

}  // namespace rbdyn::inline RBDYN_FORM
