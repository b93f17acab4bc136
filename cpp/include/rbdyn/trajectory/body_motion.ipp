// Definitions of rbdyn/trajectory/body_motion.hpp.
#pragma once

#include "rbdyn/trajectory/body_motion.hpp"

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/body_report.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/trajectory/euler_track.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE JointReport BodyMotion::joint(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->joint(m.mode, body_, t, m.x);
}

RBDYN_INLINE void BodyMotion::refuse(const char* what) const {
    throw InvalidInput(body().name + ": " + what + " is asked for, and its joint has none");
}

RBDYN_INLINE BodyMotion::BodyMotion(const std::shared_ptr<const RunData>& data, int body) {
    std::tie(data_, body_) = part_of(data, &SceneParts::bodies, body);
}

RBDYN_INLINE Vector3 BodyMotion::position(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->position(m.mode, body_, t, m.x);
}

RBDYN_INLINE Vector3 BodyMotion::velocity(double t, Side side) const {
    return is_rigid() ? rigid(t, side).velocity : report(t, side).velocity;
}

RBDYN_INLINE Vector3 BodyMotion::acceleration(double t, Side side) const {
    return is_rigid() ? rigid(t, side).acceleration : report(t, side).acceleration;
}

RBDYN_INLINE Vector3 BodyMotion::center_of_mass(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->center(m.mode, body_, t, m.x);
}

RBDYN_INLINE Vector3 BodyMotion::center_of_mass_velocity(double t, Side side) const { return report(t, side).velocity; }

RBDYN_INLINE Vector3 BodyMotion::center_of_mass_acceleration(double t, Side side) const {
    return report(t, side).acceleration;
}

RBDYN_INLINE Vector3 BodyMotion::force(double t, Side side) const { return report(t, side).force; }

RBDYN_INLINE double BodyMotion::parameter(double t, Side side) const { return railed(t, side).u; }

RBDYN_INLINE double BodyMotion::arc_length(double t, Side side) const {
    const double u = railed(t, side).u;
    return curve().length(arc_length_origin(curve()), u);
}

RBDYN_INLINE double BodyMotion::speed(double t, Side side) const { return railed(t, side).speed; }

RBDYN_INLINE double BodyMotion::tangential_force(double t, Side side) const { return railed(t, side).tangential_force; }

RBDYN_INLINE Vector3 BodyMotion::reaction(double t, Side side) const {
    return is_rigid() ? jointed(t, side).reaction : railed(t, side).reaction;
}

RBDYN_INLINE Vector3 BodyMotion::reaction_frenet(double t, Side side) const {
    const PointReport r = railed(t, side);
    const Frenet f = curve().frenet(r.u);
    // the axes turn with the rail
    const Moment m(*data_, t, side);
    const Vector3 reaction = data_->model->rail_turn(body_, t, m.x).transpose() * r.reaction;
    return {reaction.dot(f.tangent), reaction.dot(f.normal), reaction.dot(f.binormal)};
}

RBDYN_INLINE Quaternion BodyMotion::quaternion(double t, Side side) const { return rigid(t, side).attitude; }

RBDYN_INLINE Matrix3 BodyMotion::rotation_matrix(double t, Side side) const {
    return rbdyn::rotation_matrix(rigid(t, side).attitude);
}

RBDYN_INLINE Vector3 BodyMotion::angular_velocity(double t, Side side) const { return rigid(t, side).angular_velocity; }

RBDYN_INLINE Vector3 BodyMotion::angular_acceleration(double t, Side side) const {
    return rigid(t, side).angular_acceleration;
}

RBDYN_INLINE Vector3 BodyMotion::angular_velocity_world(double t, Side side) const {
    const RigidReport r = rigid(t, side);
    return to_world<double>(r.attitude, r.angular_velocity);
}

RBDYN_INLINE Vector3 BodyMotion::poisson_vector(double t, Side side) const {
    const Matrix3 r = rotation_matrix(t, side);
    return {r(2, 0), r(2, 1), r(2, 2)};
}

RBDYN_INLINE std::pair<Vector3, Vector3> BodyMotion::instantaneous_axis(double t, Side side) const {
    const PointReport g = report(t, side);
    const Vector3 omega = angular_velocity_world(t, side);
    const double square = omega.squaredNorm();
    if (square == 0.0) return {g.position, omega};
    return {g.position + omega.cross(g.velocity) / square, omega / std::sqrt(square)};
}

RBDYN_INLINE Vector3 BodyMotion::reaction_torque(double t, Side side) const { return jointed(t, side).reaction_torque; }

RBDYN_INLINE double BodyMotion::angle(double t, Side side) const {
    const Joint& j = body().joint;
    if (std::holds_alternative<Planar>(j)) return joint(t, side).coordinates[2];
    if (!std::holds_alternative<Revolute>(j) && !std::holds_alternative<Cylindrical>(j)) refuse("angle");
    return joint(t, side).coordinates[0];
}

RBDYN_INLINE double BodyMotion::displacement(double t, Side side) const {
    const Joint& j = body().joint;
    if (std::holds_alternative<Cylindrical>(j)) return joint(t, side).coordinates[1];
    if (!std::holds_alternative<Prismatic>(j)) refuse("displacement");
    return joint(t, side).coordinates[0];
}

RBDYN_INLINE double BodyMotion::displacement_rate(double t, Side side) const {
    if (!std::holds_alternative<Cylindrical>(body().joint)) refuse("displacement_rate");
    return joint(t, side).rates[1];
}

RBDYN_INLINE std::array<double, 2> BodyMotion::angles(double t, Side side) const {
    if (!std::holds_alternative<Universal>(body().joint)) refuse("angles");
    const JointReport r = joint(t, side);
    return {r.coordinates[0], r.coordinates[1]};
}

RBDYN_INLINE std::array<double, 2> BodyMotion::rates(double t, Side side) const {
    if (!std::holds_alternative<Universal>(body().joint)) refuse("rates");
    const JointReport r = joint(t, side);
    return {r.rates[0], r.rates[1]};
}

RBDYN_INLINE double BodyMotion::rate(double t, Side side) const {
    const Joint& j = body().joint;
    if (std::holds_alternative<Planar>(j)) return joint(t, side).rates[2];
    if (!std::holds_alternative<Revolute>(j) && !std::holds_alternative<Prismatic>(j) &&
        !std::holds_alternative<Cylindrical>(j)) {
        (void)rigid(t, side);
        throw InvalidInput(body().name +
                           ": rate is asked for, and its joint has not one coordinate; Revolute and "
                           "Prismatic have");
    }
    return joint(t, side).rates[0];
}

RBDYN_INLINE Vector3 BodyMotion::euler_rates(double t, Side side) const {
    return rbdyn::euler_rates(euler_angles(t, side), angular_velocity(t, side));
}

RBDYN_INLINE std::pair<Vector3, Vector3> BodyMotion::point(const Vector3& place, double t, Side side) const {
    const RigidReport r = rigid(t, side);
    return {r.position + to_world<double>(r.attitude, place),
            r.velocity + to_world<double>(r.attitude, Vector3(r.angular_velocity.cross(place)))};
}

RBDYN_INLINE PointReport BodyMotion::report(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->report(m.mode, body_, t, m.x);
}

RBDYN_INLINE RigidReport BodyMotion::rigid(double t, Side side) const {
    if (!is_rigid()) throw InvalidInput(body().name + ": it is a particle, and only a rigid body has an attitude");
    const Moment m(*data_, t, side);
    return data_->model->rigid_report(m.mode, body_, t, m.x);
}

RBDYN_INLINE const Scene::Body& BodyMotion::body() const {
    return data_->scene.bodies()[static_cast<std::size_t>(body_)];
}

RBDYN_INLINE bool BodyMotion::is_rigid() const { return body().rigid() != nullptr; }

RBDYN_INLINE RigidReport BodyMotion::jointed(double t, Side side) const {
    RigidReport r = rigid(t, side);
    if (std::holds_alternative<Free>(body().joint))
        throw InvalidInput(body().name + ": it is free, and only a joint exerts a reaction");
    return r;
}

RBDYN_INLINE PointReport BodyMotion::railed(double t, Side side) const {
    if (!data_->model->on_rail(body_))
        throw InvalidInput(body().name +
                           ": it is free, and only a body on a rail has a parameter, a speed along it and a reaction");
    return report(t, side);
}

RBDYN_INLINE const Curve& BodyMotion::curve() const { return body().rail()->curve(); }

RBDYN_INLINE EulerAngles BodyMotion::euler_angles(double t, Side side) const {
    if (!is_rigid()) throw InvalidInput(body().name + ": it is a particle, and only a rigid body has an attitude");
    const SceneModel& model = *data_->model;
    const Record& record = data_->record;
    const auto turning = [&](double time, Side at) { return model.turning(body_, time, state_at(record, time, at)); };
    const Turning now = turning(t, side);
    // a hinge counts its turns itself
    const Revolute* hinge = std::get_if<Revolute>(&body().joint);
    if (hinge != nullptr && body().parent < 0 && !hinge->motion)
        return continue_from(euler_path::of_turn(hinge->axis / hinge->axis.norm(), angle(t, side), body().parameter),
                             now.attitude);
    // so do runs that keep some times only
    if (const int place = model.place_of_angles(body_); place >= 0 && !record.windings.empty() && !record.closed)
        if (const auto index = entry_at(record, t, side)) {
            const Piece piece = record.piece(*index);
            const double* before = record.windings[*index].data() + 3 * place;
            return model.wound(body_, piece, {before[0], before[1], before[2]}, Record::tau(piece, t));
        }
    const auto index = static_cast<std::size_t>(body_);
    const std::optional<EulerAngles>& given =
        index < data_->first_angles.size() ? data_->first_angles[index] : body().attitude.given_angles();
    return data_->angles->at(
        body_, t, now.attitude, record.start, given, [&](double time) { return turning(time, Side::after); },
        record.closed ? record.closed->recurrence(body_) : std::nullopt);
}

RBDYN_INLINE BodyPointMotion::BodyPointMotion(BodyMotion body, const Vector3& place)
    : body_(std::move(body)), place_(place) {}

RBDYN_INLINE Vector3 BodyPointMotion::position(double t, Side side) const { return body_.point(place_, t, side).first; }

RBDYN_INLINE Vector3 BodyPointMotion::velocity(double t, Side side) const {
    return body_.point(place_, t, side).second;
}

// a_O + alpha x p + omega x (omega x p), of a point at rest in the body
RBDYN_INLINE Vector3 BodyPointMotion::acceleration(double t, Side side) const {
    const Vector3 omega = body_.angular_velocity(t, side);
    const Vector3 own = body_.angular_acceleration(t, side).cross(place_) + omega.cross(omega.cross(place_));
    return body_.acceleration(t, side) + to_world<double>(body_.quaternion(t, side), own);
}

RBDYN_INLINE ConstraintMotion::ConstraintMotion(const std::shared_ptr<const RunData>& data, int index) {
    std::tie(data_, index_) = part_of(data, &SceneParts::constraints, index);
}

RBDYN_INLINE Vector3 ConstraintMotion::force(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->constraint(m.mode, index_, t, m.x).force;
}

RBDYN_INLINE Vector3 ConstraintMotion::torque(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->constraint(m.mode, index_, t, m.x).torque;
}

RBDYN_INLINE double ConstraintMotion::gap(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->constraint(m.mode, index_, t, m.x).gap;
}

RBDYN_INLINE ContactMotion::ContactMotion(const std::shared_ptr<const RunData>& data, int index) {
    std::tie(data_, index_) = part_of(data, &SceneParts::contacts, index);
}

RBDYN_INLINE ContactReport ContactMotion::report(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->contact(m.mode, index_, t, m.x);
}

RBDYN_INLINE double ContactMotion::gap(double t, Side side) const { return report(t, side).gap; }

RBDYN_INLINE Vector3 ContactMotion::force(double t, Side side) const { return report(t, side).force; }

RBDYN_INLINE Vector3 ContactMotion::slip(double t, Side side) const { return report(t, side).slip; }

RBDYN_INLINE std::string ContactMotion::state(double t, Side side) const { return report(t, side).state; }

RBDYN_INLINE CouplingMotion::CouplingMotion(const std::shared_ptr<const RunData>& data, int index) {
    std::tie(data_, index_) = part_of(data, &SceneParts::couplings, index);
}

RBDYN_INLINE double CouplingMotion::length(double t, Side side) const { return relative(t, side).first.norm(); }

RBDYN_INLINE Vector3 CouplingMotion::force(double t, Side side) const {
    // what is in no part does nothing
    if (!data_->model || !is_present(connection().coupling)) return Vector3::Zero();
    const Moment m(*data_, t, side);
    return data_->model->coupling_force(m.mode, index_, t, m.x);
}

RBDYN_INLINE std::pair<Vector3, Vector3> CouplingMotion::relative(double t, Side side) const {
    const auto end = [&](const End& e) -> std::pair<Vector3, Vector3> {
        if (const Vector3* point = std::get_if<Vector3>(&e)) return {*point, Vector3::Zero()};
        const BodyMotion motion(data_, body_of(e));
        const BodyPoint* point = std::get_if<BodyPoint>(&e);
        if (point != nullptr) return motion.point(point->point, t, side);
        const PointReport r = motion.report(t, side);
        return {r.position, r.velocity};
    };
    const auto a = end(connection().a), b = end(connection().b);
    return {a.first - b.first, a.second - b.second};
}

RBDYN_INLINE const Scene::Connection& CouplingMotion::connection() const {
    return data_->scene.connections()[static_cast<std::size_t>(index_)];
}

}  // namespace rbdyn::inline RBDYN_FORM
