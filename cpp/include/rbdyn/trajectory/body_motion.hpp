// Motion of one body and of one spring of a run, computed when asked for.
//
// Conventions: times in s, world axes. At a jump a value is the one after it, unless side = before is asked for.
// Accelerations and reactions come from the model at the state, never from differentiating a piece.
#pragma once

#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn {

/// Motion of one body of a run.
class BodyMotion {
public:
    BodyMotion(const std::shared_ptr<const RunData>& data, int body) {
        std::tie(data_, body_) = part_of(data, &SceneParts::bodies, body);
    }

    /// Of a particle; of the origin of a rigid body's axes [m, m/s, m/s^2].
    Vector3 position(double t, Side side = Side::after) const {
        const Moment m(*data_, t, side);
        return data_->model->position(m.mode, body_, t, m.x);
    }
    Vector3 velocity(double t, Side side = Side::after) const {
        return is_rigid() ? rigid(t, side).velocity : report(t, side).velocity;
    }
    Vector3 acceleration(double t, Side side = Side::after) const {
        return is_rigid() ? rigid(t, side).acceleration : report(t, side).acceleration;
    }
    /// Of the centre of mass.
    Vector3 center_of_mass(double t, Side side = Side::after) const {
        const Moment m(*data_, t, side);
        return data_->model->center(m.mode, body_, t, m.x);
    }
    Vector3 center_of_mass_velocity(double t, Side side = Side::after) const { return report(t, side).velocity; }
    Vector3 center_of_mass_acceleration(double t, Side side = Side::after) const {
        return report(t, side).acceleration;
    }
    /// Resultant of the active forces [N].
    Vector3 force(double t, Side side = Side::after) const { return report(t, side).force; }

    // After a release the rail has no more to do with the body: parameter and arc length stay where it left (or where
    // it lands again), and what is along the rail is zero.

    /// The curve's parameter. On a rail.
    double parameter(double t, Side side = Side::after) const { return railed(t, side).u; }
    /// From the beginning of the curve, or from u = 0 where it has none [m]. On a rail.
    double arc_length(double t, Side side = Side::after) const {
        const double u = railed(t, side).u;
        return curve().length(arc_length_origin(curve()), u);
    }
    /// ds/dt along the curve as placed [m/s]. On a rail.
    double speed(double t, Side side = Side::after) const { return railed(t, side).speed; }
    /// Q_s = F.t, the active force along the curve (eq. 7.15) [N]. On a rail.
    double tangential_force(double t, Side side = Side::after) const { return railed(t, side).tangential_force; }
    /// Reaction of the rail or the joint on the body [N], world axes. Not on a free body.
    Vector3 reaction(double t, Side side = Side::after) const {
        return is_rigid() ? jointed(t, side).reaction : railed(t, side).reaction;
    }
    /// The same along tangent, normal, binormal (eqs. 7.12-7.14) [N]. On a rail.
    Vector3 reaction_frenet(double t, Side side = Side::after) const {
        const PointReport r = railed(t, side);
        const Frenet f = curve().frenet(r.u);
        // the axes turn with the rail
        const Vector3 reaction = data_->model->laws().rail_turn(body_, t).transpose() * r.reaction;
        return {reaction.dot(f.tangent), reaction.dot(f.normal), reaction.dot(f.binormal)};
    }

    // --- of a rigid body ---

    /// (w, x, y, z), body axes to the world's.
    Quaternion quaternion(double t, Side side = Side::after) const { return rigid(t, side).attitude; }
    Matrix3 rotation_matrix(double t, Side side = Side::after) const {
        return rbdyn::rotation_matrix(rigid(t, side).attitude);
    }
    /// [rad/s], in body axes.
    Vector3 angular_velocity(double t, Side side = Side::after) const { return rigid(t, side).angular_velocity; }
    /// [rad/s^2], in body axes.
    Vector3 angular_acceleration(double t, Side side = Side::after) const {
        return rigid(t, side).angular_acceleration;
    }
    /// [rad/s], in world axes.
    Vector3 angular_velocity_world(double t, Side side = Side::after) const {
        const RigidReport r = rigid(t, side);
        return to_world<double>(r.attitude, r.angular_velocity);
    }
    /// The world's third axis in body axes (7.59).
    Vector3 poisson_vector(double t, Side side = Side::after) const {
        const Matrix3 r = rotation_matrix(t, side);
        return {r(2, 0), r(2, 1), r(2, 2)};
    }
    /// The instantaneous axis of rotation: its point nearest to the centre of mass [m] and its direction, world axes
    /// (zero while the body does not turn).
    std::pair<Vector3, Vector3> instantaneous_axis(double t, Side side = Side::after) const {
        const PointReport g = report(t, side);
        const Vector3 omega = angular_velocity_world(t, side);
        const double square = omega.squaredNorm();
        if (square == 0.0) return {g.position, omega};
        return {g.position + omega.cross(g.velocity) / square, omega / std::sqrt(square)};
    }
    /// Moment that its joint exerts about the point it holds [N m], world axes. Not on a free body.
    Vector3 reaction_torque(double t, Side side = Side::after) const { return jointed(t, side).reaction_torque; }
    /// Of a hinge [rad].
    double angle(double t, Side side = Side::after) const { return on<Revolute>(t, side, "angle").coordinate; }
    /// Of a slide [m].
    double displacement(double t, Side side = Side::after) const {
        return on<Prismatic>(t, side, "displacement").coordinate;
    }
    /// Of a hinge [rad/s] or a slide [m/s].
    double rate(double t, Side side = Side::after) const {
        const RigidReport r = rigid(t, side);
        if (data_->model->laws().body(body_).rigid->turns_freely())
            throw InvalidInput(body().name +
                               ": rate is asked for, and its joint has not one coordinate; Revolute and "
                               "Prismatic have");
        return r.rate;
    }
    /// Theta, psi, phi [rad], continuous in time from the start of the run (rotation/euler_angles.hpp), and there those
    /// that its attitude was given by.
    EulerAngles euler_angles(double t, Side side = Side::after) const;
    /// Their rates [rad/s]; not finite where sin theta = 0 (eq. 7.49).
    Vector3 euler_rates(double t, Side side = Side::after) const {
        return rbdyn::euler_rates(euler_angles(t, side), angular_velocity(t, side));
    }

    /// Position and velocity of a point given in body axes [m, m/s], world axes.
    std::pair<Vector3, Vector3> point(const Vector3& place, double t, Side side = Side::after) const {
        const RigidReport r = rigid(t, side);
        return {r.position + to_world<double>(r.attitude, place),
                r.velocity + to_world<double>(r.attitude, Vector3(r.angular_velocity.cross(place)))};
    }

    PointReport report(double t, Side side = Side::after) const {
        const Moment m(*data_, t, side);
        return data_->model->report(m.mode, body_, t, m.x);
    }
    RigidReport rigid(double t, Side side = Side::after) const {
        if (!is_rigid()) throw InvalidInput(body().name + ": it is a particle, and only a rigid body has an attitude");
        const Moment m(*data_, t, side);
        return data_->model->rigid_report(m.mode, body_, t, m.x);
    }

private:
    const Scene::Body& body() const { return data_->scene.bodies()[static_cast<std::size_t>(body_)]; }
    bool is_rigid() const { return body().rigid() != nullptr; }
    RigidReport jointed(double t, Side side) const {
        RigidReport r = rigid(t, side);
        if (data_->model->laws().body(body_).rigid->kind == RigidLaw::Kind::free)
            throw InvalidInput(body().name + ": it is free, and only a joint exerts a reaction");
        return r;
    }
    template <class J>
    RigidReport on(double t, Side side, const char* what) const {
        if (!std::holds_alternative<J>(body().joint))
            throw InvalidInput(body().name + ": " + what + " is asked for, and its joint has none");
        return rigid(t, side);
    }
    PointReport railed(double t, Side side) const {
        if (!data_->model->on_rail(body_))
            throw InvalidInput(
                body().name +
                ": it is free, and only a body on a rail has a parameter, a speed along it and a reaction");
        return report(t, side);
    }
    const Curve& curve() const { return body().rail()->curve(); }

    std::shared_ptr<const RunData> data_;
    int body_;
};

inline EulerAngles BodyMotion::euler_angles(double t, Side side) const {
    if (!is_rigid()) throw InvalidInput(body().name + ": it is a particle, and only a rigid body has an attitude");
    const PointsModel& model = *data_->model;
    const Record& record = data_->record;
    const auto turning = [&](double time, Side at) { return model.turning(body_, state_at(record, time, at)); };
    const Turning now = turning(t, side);
    // a hinge counts its turns itself
    if (const Revolute* hinge = std::get_if<Revolute>(&body().joint))
        return continue_from(euler_path::of_turn(hinge->axis / hinge->axis.norm(), angle(t, side), body().parameter),
                             now.attitude);
    // so do runs that keep some times only
    if (const int place = model.place_of_angles(body_); place >= 0 && !record.windings.empty() && !record.closed)
        if (const auto index = entry_at(record, t, side)) {
            const Piece piece = record.piece(*index);
            const double* before = record.windings[*index].data() + 3 * place;
            return model.wound(body_, piece, {before[0], before[1], before[2]}, Record::tau(piece, t));
        }
    return data_->angles->at(
        body_, t, now.attitude, record.start, body().attitude.given_angles(),
        [&](double time) { return turning(time, Side::after); },
        record.closed ? record.closed->recurrence(body_) : std::nullopt);
}

/// Length and force of a spring of a run.
class SpringMotion {
public:
    SpringMotion(const std::shared_ptr<const RunData>& data, int index) {
        std::tie(data_, index_) = part_of(data, &SceneParts::couplings, index);
    }

    double length(double t, Side side = Side::after) const { return relative(t, side).first.norm(); }  // m
    /// Force on the first end [N], world axes.
    Vector3 force(double t, Side side = Side::after) const {
        if (data_->model) {
            const Moment m(*data_, t, side);
            if (const auto force = data_->model->spring_force(m.mode, index_, t, m.x)) return *force;
        }
        const auto [d, v] = relative(t, side);
        return std::get<Spring>(connection().coupling)(d, v);
    }

    /// Position and velocity of the first end relative to the second [m, m/s].
    std::pair<Vector3, Vector3> relative(double t, Side side) const {
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

private:
    const Scene::Connection& connection() const { return data_->scene.connections()[static_cast<std::size_t>(index_)]; }

    std::shared_ptr<const RunData> data_;
    int index_;
};

}  // namespace rbdyn
