// Motion of one body and of one coupling of a run, computed when asked for.
//
// Conventions: times in s, world axes. At a jump a value is the one after it, unless side = before is asked for.
// Accelerations and reactions come from the model at the state, never from differentiating a piece.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct ContactReport;  // model/scene_model.hpp
struct JointReport;    // model/scene_model.hpp
struct PointReport;    // model/body_report.hpp
struct RigidReport;    // model/body_report.hpp
struct RunData;        // trajectory/run_data.hpp

/// Motion of one body of a run.
class BodyMotion {
public:
    BodyMotion(const std::shared_ptr<const RunData>& data, int body);

    /// Of a particle; of the origin of a rigid body's axes [m, m/s, m/s^2].
    Vector3 position(double t, Side side = Side::after) const;
    Vector3 velocity(double t, Side side = Side::after) const;
    Vector3 acceleration(double t, Side side = Side::after) const;
    /// Of the centre of mass.
    Vector3 center_of_mass(double t, Side side = Side::after) const;
    Vector3 center_of_mass_velocity(double t, Side side = Side::after) const;
    Vector3 center_of_mass_acceleration(double t, Side side = Side::after) const;
    /// Resultant of the active forces [N].
    Vector3 force(double t, Side side = Side::after) const;

    // After a release the rail has no more to do with the body: parameter and arc length stay where it left (or where
    // it lands again), and what is along the rail is zero.

    /// The curve's parameter. On a rail.
    double parameter(double t, Side side = Side::after) const;
    /// From the beginning of the curve, or from u = 0 where it has none [m]. On a rail.
    double arc_length(double t, Side side = Side::after) const;
    /// ds/dt along the curve as placed [m/s]. On a rail.
    double speed(double t, Side side = Side::after) const;
    /// Q_s = F.t, the active force along the curve (eq. 7.15) [N]. On a rail.
    double tangential_force(double t, Side side = Side::after) const;
    /// Reaction of the rail or the joint on the body [N], world axes. Not on a free body.
    Vector3 reaction(double t, Side side = Side::after) const;
    /// The same along tangent, normal, binormal (eqs. 7.12-7.14) [N]. On a rail.
    Vector3 reaction_frenet(double t, Side side = Side::after) const;

    // --- of a rigid body ---

    /// (w, x, y, z), body axes to the world's.
    Quaternion quaternion(double t, Side side = Side::after) const;
    Matrix3 rotation_matrix(double t, Side side = Side::after) const;
    /// [rad/s], in body axes.
    Vector3 angular_velocity(double t, Side side = Side::after) const;
    /// [rad/s^2], in body axes.
    Vector3 angular_acceleration(double t, Side side = Side::after) const;
    /// [rad/s], in world axes.
    Vector3 angular_velocity_world(double t, Side side = Side::after) const;
    /// The world's third axis in body axes (7.59).
    Vector3 poisson_vector(double t, Side side = Side::after) const;
    /// The instantaneous axis of rotation: its point nearest to the centre of mass [m] and its direction, world axes
    /// (zero while the body does not turn).
    std::pair<Vector3, Vector3> instantaneous_axis(double t, Side side = Side::after) const;
    /// Moment that its joint exerts about the point it holds [N m], world axes. Not on a free body.
    Vector3 reaction_torque(double t, Side side = Side::after) const;
    /// Of a joint that turns its body about one axis: a hinge, also one that slides, or in a plane [rad].
    double angle(double t, Side side = Side::after) const;
    /// Of a slide, also of a hinge that slides [m].
    double displacement(double t, Side side = Side::after) const;
    /// Of the angle [rad/s], or of the displacement of a slide [m/s].
    double rate(double t, Side side = Side::after) const;
    /// Of a hinge that slides [m/s].
    double displacement_rate(double t, Side side = Side::after) const;
    /// Of a universal joint, about its first axis and its second [rad], and their rates [rad/s].
    std::array<double, 2> angles(double t, Side side = Side::after) const;
    std::array<double, 2> rates(double t, Side side = Side::after) const;
    /// Theta, psi, phi [rad], continuous in time from the start of the run (rotation/euler_angles.hpp), and there those
    /// that its attitude was given by.
    EulerAngles euler_angles(double t, Side side = Side::after) const;
    /// Their rates [rad/s]; not finite where sin theta = 0 (eq. 7.49).
    Vector3 euler_rates(double t, Side side = Side::after) const;

    /// Position and velocity of a point given in body axes [m, m/s], world axes.
    std::pair<Vector3, Vector3> point(const Vector3& place, double t, Side side = Side::after) const;

    PointReport report(double t, Side side = Side::after) const;
    RigidReport rigid(double t, Side side = Side::after) const;

private:
    const Scene::Body& body() const;
    bool is_rigid() const;
    RigidReport jointed(double t, Side side) const;
    /// Of a joint with coordinates of its own.
    JointReport joint(double t, Side side) const;
    [[noreturn]] void refuse(const char* what) const;
    PointReport railed(double t, Side side) const;
    const Curve& curve() const;

    std::shared_ptr<const RunData> data_;
    int body_;
};

/// A point that is fixed in a rigid body of a run. Vectors are in world axes.
class BodyPointMotion {
public:
    /// `place`: in body axes [m].
    BodyPointMotion(BodyMotion body, const Vector3& place);

    Vector3 position(double t, Side side = Side::after) const;      // m
    Vector3 velocity(double t, Side side = Side::after) const;      // m/s
    Vector3 acceleration(double t, Side side = Side::after) const;  // m/s^2

private:
    BodyMotion body_;
    Vector3 place_;
};

/// What a constraint of a run does.
class ConstraintMotion {
public:
    ConstraintMotion(const std::shared_ptr<const RunData>& data, int index);

    /// Force and torque on its first end, world axes [N, N m]; the torque about the point that is held.
    Vector3 force(double t, Side side = Side::after) const;
    Vector3 torque(double t, Side side = Side::after) const;
    /// How far its points are from where they should be [m], with the angles of its axes [rad] taken for metres.
    double gap(double t, Side side = Side::after) const;

private:
    std::shared_ptr<const RunData> data_;
    int index_;
};

/// What a contact of a run does. Vectors are in world axes.
class ContactMotion {
public:
    ContactMotion(const std::shared_ptr<const RunData>& data, int index);

    /// The distance between the part and the surface [m]; negative inside.
    double gap(double t, Side side = Side::after) const;
    /// On the first side, from the second: normal force and friction together [N], at the point of contact.
    Vector3 force(double t, Side side = Side::after) const;
    /// The velocity of the first side's point of contact relative to the second's, along the surface [m/s].
    Vector3 slip(double t, Side side = Side::after) const;
    /// "open", "sticks" or "slides".
    std::string state(double t, Side side = Side::after) const;

private:
    ContactReport report(double t, Side side) const;

    std::shared_ptr<const RunData> data_;
    int index_;
};

/// Length and force of a coupling of a run.
class CouplingMotion {
public:
    CouplingMotion(const std::shared_ptr<const RunData>& data, int index);

    double length(double t, Side side = Side::after) const;  // m
    /// Force on the first end [N], world axes.
    Vector3 force(double t, Side side = Side::after) const;

    /// Position and velocity of the first end relative to the second [m, m/s].
    std::pair<Vector3, Vector3> relative(double t, Side side) const;

private:
    const Scene::Connection& connection() const;

    std::shared_ptr<const RunData> data_;
    int index_;
};

}  // namespace rbdyn::inline RBDYN_FORM
