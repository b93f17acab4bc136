// Definitions of rbdyn/mechanics/tree_state.hpp.
#pragma once

#include "rbdyn/mechanics/tree_state.hpp"

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace tree_states {

inline Matrix3 matrix(const SixInertia<double>::Block& block) {
    Matrix3 m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m(i, j) = block[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    return m;
}
inline Matrix3 matrix(const AxesOf<double>& axes) { return columns(axes.e1, axes.e2, axes.e3); }

/// Sizes of a wrench about a point at r from its own.
inline void add_sizes(Wrench<double>& sum, const Wrench<double>& w, const Vector3& r = Vector3::Zero()) {
    const Vector3 f = sizes(w.force), a = sizes(r);
    sum.force += f;
    sum.moment +=
        sizes(w.moment) + Vector3(a[1] * f[2] + a[2] * f[1], a[2] * f[0] + a[0] * f[2], a[0] * f[1] + a[1] * f[0]);
}

/// The size of the moment of a force at r: what cancels in it is rounding of this.
inline Vector3 moment_size(const Vector3& force, const Vector3& r) {
    Wrench<double> w;
    add_sizes(w, {force, Vector3(Vector3::Zero())}, r);
    return w.moment;
}

}  // namespace tree_states

RBDYN_INLINE TreeState::TreeState(const Tree& given, std::vector<Moving<double>> motion)
    : tree(given), moving(std::move(motion)) {
    place();
}

RBDYN_INLINE void TreeState::place() {
    bodies.resize(moving.size());
    for (int i = 0; i < tree.size(); ++i) {
        Body& b = bodies[at(i)];
        const Moving<double>& m = moving[at(i)];
        b.arm = m.to_world(exactly<double>(tree.node(i).center));
        b.center = m.place + b.arm;
        b.velocity = m.velocity_at(b.arm);
        b.inertia = tree_states::matrix(tree.inertia_of<double>(i, m));
        b.spin_momentum = b.inertia * m.omega;
        b.acceleration = b.spin_rate = b.angular_acceleration = b.origin_acceleration = Vector3::Zero();
    }
}

RBDYN_INLINE TreeState::TreeState(const Tree& given, const Conditions& conditions, const Exerted& exerted,
                                  const std::vector<int>& rows, std::vector<Moving<double>> motion,
                                  std::span<const double> values)
    : tree(given), moving(std::move(motion)) {
    place();
    const double* next = values.data();
    const auto vector = [&] {
        next += 3;
        return Vector3(next[-3], next[-2], next[-1]);
    };
    for (int i = 0; i < tree.size(); ++i) {
        Body& b = bodies[at(i)];
        b.acts.force = vector();
        b.acts.moment = vector();
        b.angular_acceleration = vector();
        b.origin_acceleration = vector();
    }
    for (const Exerted::Coupled& c : exerted.couplings()) {
        couplings.push_back(vector());
        // each by itself: those that cancel leave their rounding
        for (const Anchor* end : {&c.a, &c.b})
            if (end->body >= 0)
                tree_states::add_sizes(bodies[at(end->body)].effort, {couplings.back(), Vector3(Vector3::Zero())},
                                       tree.point<double>(*end, moving).arm);
    }
    for (int i = 0; i < exerted.loads(); ++i) powers.push_back(*next++);
    along.assign(next, next + tree.velocities());
    next += tree.velocities();
    std::vector<double> multipliers(at(conditions.rows()), 0.0);
    for (const int r : rows) multipliers[at(r)] = *next++;
    if (const auto loose = dependences(tree, conditions, rows, moving); !loose.empty()) {
        // of all that give this motion those of least norm, all of them as forces: nothing along what changes nothing
        const std::vector<double> measures = conditions.measures();
        std::vector<std::vector<double>> a(loose.size(), std::vector<double>(loose.size(), 0.0));
        std::vector<double> b(loose.size(), 0.0);
        for (std::size_t i = 0; i < loose.size(); ++i)
            for (std::size_t r = 0; r < multipliers.size(); ++r) {
                b[i] += loose[i][r] * (multipliers[r] * measures[r]);
                for (std::size_t j = 0; j < loose.size(); ++j) a[i][j] += loose[i][r] * loose[j][r];
            }
        const std::vector<double> parts = solve_definite<double>(std::move(a), std::move(b));
        for (std::size_t i = 0; i < loose.size(); ++i)
            for (std::size_t r = 0; r < multipliers.size(); ++r)
                multipliers[r] -= parts[i] * (loose[i][r] / measures[r]);
    }
    // what constraints exert
    std::vector<Wrench<double>> held(moving.size());
    // each by itself, as above
    const auto hold = [&](int body, const Wrench<double>& w) {
        if (body < 0) return;
        add<double>(held[at(body)], w, 1.0);
        tree_states::add_sizes(bodies[at(body)].effort, w);
    };
    if (!conditions.empty()) {
        const auto all = conditions.rows<double>(tree, moving);
        for (const Condition& c : conditions.all()) {
            ConstraintReport report;
            Wrench<double> on_a;
            for (int r = c.first; r < c.first + c.rows(); ++r) {
                const Row<double>& row = all[at(r)];
                Wrench<double> a, b;
                add<double>(a, row.on_a, multipliers[at(r)]);
                add<double>(b, row.on_b, multipliers[at(r)]);
                add<double>(on_a, a, 1.0);
                hold(row.a, a);
                hold(row.b, b);
            }
            report.force = on_a.force;
            // about the constraint's own point
            for (const Anchor* end : {&c.a, &c.b})
                if (end->body >= 0)
                    bodies[at(end->body)].effort.moment +=
                        tree_states::moment_size(on_a.force, tree.point<double>(*end, moving).arm);
            // the other body is pushed where the point is, known to the rounding of both places
            const bool wanders = c.points == Condition::Points::plane || c.points == Condition::Points::curve;
            if (wanders && c.b.body >= 0)
                bodies[at(c.b.body)].effort.moment += tree_states::moment_size(
                    on_a.force, sizes(tree.point<double>(c.a, moving).place) + sizes(moving[at(c.b.body)].place));
            report.torque = about<double>(on_a, Vector3(-tree.point<double>(c.a, moving).arm)).moment;
            report.gap = conditions.gap(tree, static_cast<int>(constraints.size()), moving);
            constraints.push_back(report);
        }
        for (std::size_t k = 0; k < conditions.contacts().size(); ++k) {
            const int r = conditions.constraint_rows() + static_cast<int>(k);
            const Row<double>& row = all[at(r)];
            const auto touching = conditions.contacts()[k].touching<double>(tree, moving);
            ContactReport report;
            report.gap = touching.gap;
            report.force = vector();
            next += 2;
            const Vector3 torque = vector();
            report.slip = touching.slip();
            report.place = touching.place;
            report.normal = touching.normal;
            Wrench<double> on_a = touching.on_a(report.force), on_b = touching.on_b(report.force);
            on_a.moment += torque;
            on_b.moment -= torque;
            hold(row.a, on_a);
            hold(row.b, on_b);
            // arms are differences of places: where a force passes a body's own point its moment is their rounding
            const auto add_moment = [&](int body, const Vector3& of) {
                if (body >= 0) bodies[at(body)].effort.moment += tree_states::moment_size(report.force, of);
            };
            const auto center = tree.point<double>(conditions.contacts()[k].a, moving);
            const Vector3 reach = sizes(Vector3(center.place - touching.place));
            add_moment(row.a, sizes(center.arm) + reach);
            if (row.b >= 0) add_moment(row.b, sizes(center.place) + reach + sizes(moving[at(row.b)].place));
            contacts.push_back(report);
            torques.push_back(torque);
        }
    }
    for (int i = 0; i < tree.size(); ++i) {
        Body& b = bodies[at(i)];
        const Moving<double>& m = moving[at(i)];
        b.acceleration = b.origin_acceleration + cross<double>(b.angular_acceleration, b.arm) +
                         cross<double>(m.omega, cross<double>(m.omega, b.arm));
        b.spin_rate = b.inertia * b.angular_acceleration + cross<double>(m.omega, b.spin_momentum);
        Wrench<double> inertia;
        inertia.force = b.acceleration * static_cast<double>(tree.node(i).mass);
        inertia.moment = b.spin_rate + cross<double>(b.arm, inertia.force);
        add<double>(b.reaction, inertia, 1.0);
        add<double>(b.reaction, b.acts, -1.0);
        add<double>(b.reaction, held[at(i)], -1.0);
        tree_states::add_sizes(b.effort, b.acts);
        // where what is left of the acceleration of G is rounding it is that of what it is a sum of
        constexpr double rounding = 1e-9;
        const Vector3 terms = (sizes(b.origin_acceleration) + tree_states::moment_size(b.angular_acceleration, b.arm) +
                               sizes(b.arm) * m.omega.squaredNorm() + sizes(m.omega) * std::abs(m.omega.dot(b.arm))) *
                              static_cast<double>(tree.node(i).mass);
        const bool cancels = inertia.force.norm() <= rounding * terms.norm();
        const Vector3 force = cancels ? terms : sizes(inertia.force);
        b.effort.force += force;
        b.effort.moment += sizes(inertia.moment) + tree_states::moment_size(force, b.arm) +
                           tree_states::moment_size(b.spin_momentum, Vector3(m.omega));
    }
    for (int i = tree.size() - 1; i >= 0; --i)
        if (const int parent = tree.node(i).parent; parent >= 0) {
            const Vector3 r = moving[at(i)].place - moving[at(parent)].place;
            add<double>(bodies[at(parent)].reaction, about<double>(bodies[at(i)].reaction, r), 1.0);
            // r is a difference, too
            const Vector3 places = sizes(moving[at(i)].place) + sizes(moving[at(parent)].place);
            tree_states::add_sizes(bodies[at(parent)].effort, bodies[at(i)].effort, places);
        }
    for (int i = 0; i < tree.size(); ++i) {
        const Moving<double>& m = moving[at(i)];
        for (std::size_t k = 0; k < m.joint.size(); ++k)
            add<double>(bodies[at(i)].reaction, Wrench<double>{m.joint[k].move, m.joint[k].turn},
                        -along[at(tree.node(i).v) + k]);
    }
}

RBDYN_INLINE PointReport TreeState::point(int body) const {
    const Body& b = bodies[at(body)];
    const Moving<double>& m = moving[at(body)];
    PointReport r;
    r.position = b.center;
    r.velocity = b.velocity;
    r.acceleration = b.acceleration;
    r.force = b.acts.force;
    r.reaction = b.reaction.force;
    r.speed = b.velocity.norm();
    r.spin_momentum = b.spin_momentum;
    r.spin_energy = 0.5 * m.omega.dot(b.spin_momentum);
    r.spin_power = m.omega.dot(b.spin_rate);
    r.effort = b.effort.force.norm();
    return r;
}

RBDYN_INLINE BodyReport TreeState::body_report(int body, std::span<const double> x) const {
    const Body& b = bodies[at(body)];
    const Moving<double>& m = moving[at(body)];
    const Node& n = tree.node(body);
    BodyReport r;
    r.mass = static_cast<double>(n.mass);
    r.position = r.origin = b.center;
    r.velocity = b.velocity;
    if (!n.is_point) {
        r.origin = m.place - m.to_world(exactly<double>(n.joint.held().point));
        r.attitude = rounded(quaternion(widened(tree_states::matrix(m.axes))));
        r.angular_velocity = m.omega;
    }
    r.spin_momentum = b.spin_momentum;
    r.spin_energy = 0.5 * m.omega.dot(b.spin_momentum);
    if (const int k = turning_velocity(n.joint); k >= 0)
        r.coordinate = x[at(n.q + k)];
    else if (n.joint.positions() == 1)
        r.coordinate = x[at(n.q)];
    r.acceleration = b.acceleration;
    r.spin_rate = b.spin_rate;
    r.spin_power = m.omega.dot(b.spin_rate);
    r.force = r.applied = b.acts.force;
    r.applied_moment = b.acts.moment - cross<double>(b.arm, b.acts.force);
    // of all that joints, constraints and contacts do
    r.reaction = b.acceleration * r.mass - b.acts.force;
    r.reaction_moment = b.spin_rate - r.applied_moment;
    return r;
}

RBDYN_INLINE RigidReport TreeState::rigid(int body, std::span<const double> x) const {
    const Body& b = bodies[at(body)];
    const Moving<double>& m = moving[at(body)];
    const Node& n = tree.node(body);
    RigidReport r;
    r.attitude = rounded(quaternion(widened(tree_states::matrix(m.axes))));
    const Vector3 origin = -m.to_world(exactly<double>(n.joint.held().point));
    r.position = m.place + origin;
    r.velocity = m.velocity_at(origin);
    r.acceleration = b.origin_acceleration + cross<double>(b.angular_acceleration, origin) +
                     cross<double>(m.omega, cross<double>(m.omega, origin));
    r.center_acceleration = b.acceleration;
    r.force = b.acts.force;
    r.moment = b.acts.moment;
    r.reaction = b.reaction.force;
    r.reaction_torque = b.reaction.moment;
    r.angular_velocity = m.to_body(m.omega);
    r.angular_acceleration = m.to_body(b.angular_acceleration);
    r.spin_momentum = b.spin_momentum;
    r.spin_energy = 0.5 * m.omega.dot(b.spin_momentum);
    r.spin_power = m.omega.dot(b.spin_rate);
    if (n.joint.velocities() == 1) {
        r.coordinate = x[at(n.q)];
        r.rate = x[at(tree.positions() + n.v)];
    }
    r.force_effort = b.effort.force.norm();
    r.torque_effort = b.effort.moment.norm();
    return r;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
