// The general assembly: accelerations and reactions of any scene from its joints alone, in doubles. The special laws
// (rigid_law.hpp, point_laws.hpp) are optimisations of it, and the tests compare them with it.
//
// A joint is a pose of the body's axes, a motion subspace S and a bias b: with velocities v of the joint's own,
//     (omega, v_O) = S v,   (omega', a_O) = S v' + b,      world axes, O the origin of the body's axes.
// With c = G - O the body's law at O (7.38, 7.39, 7.47) is M (omega', a_O) + h = W + Phi,
//     M = | I_G - m [c][c]   m [c] |    h = | omega x I_G omega + m c x (omega x (omega x c)) |
//         |    -m [c]         m 1  |        |            m omega x (omega x c)              |
// W the wrench (moment about O, force) of what acts, Phi that of the joint. Ideal: S^T Phi = 0 (7.57, 7.60, 7.16), so
//     S^T M S v' = S^T (W - h - M b).
// Every parent is the ground, so one block a body. Friction, drives and moving rails are not in it.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn {

/// How a body may move where it is.
struct JointMotion {
    using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;
    using Six = Eigen::Matrix<double, 6, 1>;

    Vector3 position = Vector3::Zero(), held = Vector3::Zero();  // of O, and of the point the joint holds
    Matrix3 axes = Matrix3::Identity();                          // of the body
    Columns subspace;                                            // S
    Six bias = Six::Zero();                                      // b
    Six velocity = Six::Zero();                                  // S v

    /// Of a body of a scene at the state it starts in.
    explicit JointMotion(const Scene::Body& b) {
        Eigen::VectorXd rates;
        const auto turns_about = [&](const Vector3& at, const Vector3& point, const Eigen::MatrixXd& turning) {
            held = at;
            position = at - axes * point;
            subspace.resize(6, turning.cols());
            subspace.topRows(3) = turning;
            subspace.bottomRows(3) = -cross_matrix(position - at) * turning;
            const Vector3 omega = turning * rates;
            bias.tail(3) = omega.cross(omega.cross(Vector3(position - at)));
        };
        if (const Spherical* ball = std::get_if<Spherical>(&b.joint)) {
            axes = b.attitude.matrix();
            rates = rounded(b.angular_velocity);
            turns_about(ball->at, ball->point, axes);
        } else if (const Revolute* hinge = std::get_if<Revolute>(&b.joint)) {
            const Vector3 e = hinge->axis.normalized();
            axes = Eigen::AngleAxisd(b.parameter, e).toRotationMatrix();
            rates = Eigen::VectorXd::Constant(1, b.speed);
            turns_about(hinge->at, hinge->point, e);
        } else if (const Prismatic* slide = std::get_if<Prismatic>(&b.joint)) {
            const Vector3 e = slide->axis.normalized();
            rates = Eigen::VectorXd::Constant(1, b.speed);
            held = slide->at + b.parameter * e;
            position = held - slide->point;
            subspace = Columns::Zero(6, 1);
            subspace.bottomRows(3) = e;
        } else if (const Rail* rail = b.rail()) {
            const Curve& curve = rail->curve();
            const Vector3 along = curve.first(b.parameter);
            const double w = b.speed / along.norm();
            rates = Eigen::VectorXd::Constant(1, w);
            position = held = curve.position(b.parameter);
            subspace = Columns::Zero(6, 1);
            subspace.bottomRows(3) = along;
            bias.tail(3) = curve.second(b.parameter) * w * w;
        } else {
            position = held = b.position;
            if (b.rigid() != nullptr) axes = b.attitude.matrix();
            rates.resize(6);
            rates << rounded(b.angular_velocity), b.velocity;
            subspace = Columns::Identity(6, 6);
            subspace.topLeftCorner(3, 3) = axes;
        }
        velocity = subspace * rates;
    }

    Vector3 omega() const { return velocity.head(3); }
    /// Place and velocity of a point given in body axes.
    std::pair<Vector3, Vector3> point(const Vector3& p) const {
        const Vector3 arm = axes * p;
        return {position + arm, Vector3(velocity.tail(3)) + omega().cross(arm)};
    }
    /// [v] with [v] a = v x a.
    static Matrix3 cross_matrix(const Vector3& v) {
        Matrix3 m;
        m << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
        return m;
    }
};

/// One body of a scene, world axes; about the point its joint holds.
struct AssembledBody {
    Vector3 angular_acceleration, acceleration;  // the latter of the origin of the body's axes
    Vector3 force;                               // of all that acts
    Vector3 reaction, reaction_torque;
    std::vector<double> virtual_power;  // of the reactions on every virtual motion of the joint: zero but for rounding
    double effort;                      // the size of what these are differences of, forces and moments together
};

class Assembly {
public:
    /// Of a scene at the state it starts in, at a time.
    explicit Assembly(const Scene& scene, double t = 0.0) : scene_(scene) {
        for (const Scene::Body& b : scene.bodies()) {
            motions_.emplace_back(b);
            wrenches_.push_back(JointMotion::Six::Zero());
            weigh(static_cast<int>(motions_.size()) - 1);
        }
        for (const Scene::AppliedLoad& load : scene.loads()) apply(load, t);
        for (const Scene::Connection& c : scene.connections()) connect(c);
    }

    const JointMotion& motion(int body) const { return motions_[at(body)]; }
    /// Moment of all that acts, about a point of the world.
    Vector3 moment(int body, const Vector3& pole) const {
        const JointMotion::Six& w = wrenches_[at(body)];
        return Vector3(w.head(3)) + (motions_[at(body)].position - pole).cross(Vector3(w.tail(3)));
    }

    AssembledBody body(int index) const {
        using Six = JointMotion::Six;
        const Scene::Body& b = scene_.bodies()[at(index)];
        const JointMotion& j = motions_[at(index)];
        const Matrix3 central = central_inertia(b, j), arm = JointMotion::cross_matrix(center_arm(b, j));
        const Vector3 omega = j.omega(), pull = omega.cross(omega.cross(center_arm(b, j)));
        Eigen::Matrix<double, 6, 6> mass;
        mass << central - b.mass() * arm * arm, b.mass() * arm, -b.mass() * arm, b.mass() * Matrix3::Identity();
        Six rest;
        rest << omega.cross(central * omega) + b.mass() * (arm * pull), b.mass() * pull;
        const Six known = wrenches_[at(index)] - rest - mass * j.bias;
        const auto n = static_cast<int>(j.subspace.cols());
        const Eigen::MatrixXd left = j.subspace.transpose() * mass * j.subspace;
        const Eigen::VectorXd right = j.subspace.transpose() * known;
        SquareMatrix matrix(n);
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < n; ++k) matrix(i, k) = left(i, k);
        const std::vector<double> rates = solve(matrix, {right.data(), right.data() + n}).x;
        const Six moving = j.subspace * Eigen::Map<const Eigen::VectorXd>(rates.data(), n);
        const Six reaction = mass * moving - known;
        const Eigen::VectorXd power = j.subspace.transpose() * reaction;
        AssembledBody result;
        result.angular_acceleration = (moving + j.bias).head(3);
        result.acceleration = (moving + j.bias).tail(3);
        result.force = wrenches_[at(index)].tail(3);
        result.reaction = reaction.tail(3);
        result.reaction_torque = Vector3(reaction.head(3)) + (j.position - j.held).cross(result.reaction);
        result.virtual_power.assign(power.data(), power.data() + n);
        result.effort = (mass * moving).norm() + wrenches_[at(index)].norm() + rest.norm();
        return result;
    }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    static Vector3 center_of(const Scene::Body& b) {
        return b.rigid() != nullptr ? b.rigid()->com() : Vector3::Zero().eval();
    }
    static Vector3 center_arm(const Scene::Body& b, const JointMotion& j) { return j.axes * center_of(b); }
    /// I_G in world axes. A particle has none, and turns with nothing: any will do that can be solved for.
    static Matrix3 central_inertia(const Scene::Body& b, const JointMotion& j) {
        if (b.rigid() == nullptr) return Matrix3::Identity();
        return j.axes * b.rigid()->inertia() * j.axes.transpose();
    }

    void act(int body, const Vector3& force, const Vector3& place) {
        wrenches_[at(body)].head(3) += (place - motions_[at(body)].position).cross(force);
        wrenches_[at(body)].tail(3) += force;
    }
    void weigh(int body) {
        const Scene::Body& b = scene_.bodies()[at(body)];
        act(body, b.mass() * scene_.gravity(), motions_[at(body)].point(center_of(b)).first);
    }
    void apply(const Scene::AppliedLoad& load, double t) {
        const Scene::Body& b = scene_.bodies()[at(load.body)];
        const JointMotion& j = motions_[at(load.body)];
        if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load)) {
            const double torque = spring->stiffness * (b.parameter - spring->rest_angle) + spring->damping * b.speed;
            wrenches_[at(load.body)].head(3) -= torque * std::get<Revolute>(b.joint).axis.normalized();
            return;
        }
        if (const Torque* torque = std::get_if<Torque>(&load.load)) {
            const bool in_body = torque->frame() == Frame::body;
            RotationOf<double> r;
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k) r[at(i)][at(k)] = j.axes(i, k);
            const Vector3 omega = in_body ? Vector3(j.axes.transpose() * j.omega()) : j.omega();
            const Vector3 moment = (*torque)(t, r, omega);
            wrenches_[at(load.body)].head(3) += in_body ? Vector3(j.axes * moment) : moment;
            return;
        }
        const auto [place, velocity] = j.point(load.at.value_or(center_of(b)));
        Vector3 force = force_of<double>(load.load, t, place, velocity);
        if (const Drag* drag = std::get_if<Drag>(&load.load))
            force = -(drag->linear + drag->quadratic * velocity.norm()) * velocity;
        if (const Force* given = std::get_if<Force>(&load.load); given != nullptr && given->frame() == Frame::body)
            force = j.axes * force;
        act(load.body, force, place);
    }
    void connect(const Scene::Connection& c) {
        const auto end = [&](const End& e) -> std::pair<Vector3, Vector3> {
            if (const Vector3* point = std::get_if<Vector3>(&e)) return {*point, Vector3::Zero()};
            const BodyPoint* point = std::get_if<BodyPoint>(&e);
            const int body = body_of(e);
            return motion(body).point(point != nullptr ? point->point : center_of(scene_.bodies()[at(body)]));
        };
        const auto a = end(c.a), b = end(c.b);
        const Vector3 d = a.first - b.first, v = a.second - b.second;
        const Vector3 force = std::get<Spring>(c.coupling)(d, v, a.first.norm() + b.first.norm());
        if (body_of(c.a) >= 0) act(body_of(c.a), force, a.first);
        if (body_of(c.b) >= 0) act(body_of(c.b), -force, b.first);
    }

    Scene scene_;
    std::vector<JointMotion> motions_;
    std::vector<JointMotion::Six> wrenches_;
};

}  // namespace rbdyn
