// Definitions of rbdyn/model/assembly.hpp.
#pragma once

#include "rbdyn/model/assembly.hpp"

#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE JointMotion::JointMotion(const Scene::Body& b) {
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

RBDYN_INLINE std::pair<Vector3, Vector3> JointMotion::point(const Vector3& p) const {
    const Vector3 arm = axes * p;
    return {position + arm, Vector3(velocity.tail(3)) + omega().cross(arm)};
}

RBDYN_INLINE Matrix3 JointMotion::cross_matrix(const Vector3& v) {
    Matrix3 m;
    m << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
    return m;
}

RBDYN_INLINE Assembly::Assembly(const Scene& scene, double t) : scene_(scene) {
    for (const Scene::Body& b : scene.bodies()) {
        motions_.emplace_back(b);
        wrenches_.push_back(JointMotion::Six::Zero());
        weigh(static_cast<int>(motions_.size()) - 1);
    }
    for (const Scene::AppliedLoad& load : scene.loads()) apply(load, t);
    for (const Scene::Connection& c : scene.connections()) connect(c, t);
}

RBDYN_INLINE Vector3 Assembly::moment(int body, const Vector3& pole) const {
    const JointMotion::Six& w = wrenches_[at(body)];
    return Vector3(w.head(3)) + (motions_[at(body)].position - pole).cross(Vector3(w.tail(3)));
}

RBDYN_INLINE AssembledBody Assembly::body(int index) const {
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

RBDYN_INLINE Vector3 Assembly::center_of(const Scene::Body& b) {
    return b.rigid() != nullptr ? b.rigid()->com() : Vector3::Zero().eval();
}

RBDYN_INLINE Matrix3 Assembly::central_inertia(const Scene::Body& b, const JointMotion& j) {
    if (b.rigid() == nullptr) return Matrix3::Identity();
    return j.axes * b.rigid()->inertia() * j.axes.transpose();
}

RBDYN_INLINE void Assembly::act(int body, const Vector3& force, const Vector3& place) {
    wrenches_[at(body)].head(3) += (place - motions_[at(body)].position).cross(force);
    wrenches_[at(body)].tail(3) += force;
}

RBDYN_INLINE void Assembly::weigh(int body) {
    const Scene::Body& b = scene_.bodies()[at(body)];
    act(body, b.mass() * scene_.gravity(), motions_[at(body)].point(center_of(b)).first);
}

RBDYN_INLINE void Assembly::apply(const Scene::AppliedLoad& load, double t) {
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

RBDYN_INLINE void Assembly::connect(const Scene::Connection& c, double t) {
    const auto end = [&](const End& e) -> std::pair<Vector3, Vector3> {
        if (const Vector3* point = std::get_if<Vector3>(&e)) return {*point, Vector3::Zero()};
        const BodyPoint* point = std::get_if<BodyPoint>(&e);
        const int body = body_of(e);
        return motion(body).point(point != nullptr ? point->point : center_of(scene_.bodies()[at(body)]));
    };
    const auto a = end(c.a), b = end(c.b);
    if (!is_present(c.coupling)) return;
    const auto mass = [&](const End& e) { return body_of(e) >= 0 ? scene_.bodies()[at(body_of(e))].mass() : 0.0; };
    const Vector3 force =
        force_of<double>(c.coupling, {t, a.first, b.first, a.second, b.second, mass(c.a) * mass(c.b)});
    if (body_of(c.a) >= 0) act(body_of(c.a), force, a.first);
    if (body_of(c.b) >= 0) act(body_of(c.b), -force, b.first);
}

}  // namespace rbdyn::inline RBDYN_FORM
