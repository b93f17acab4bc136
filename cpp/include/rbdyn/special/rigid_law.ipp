// Definitions of rbdyn/special/rigid_law.hpp.
#pragma once

#include "rbdyn/special/rigid_law.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RigidLaw::RigidLaw(const Scene& scene, int index) {
    const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
    const RigidBody& body = *b.rigid();
    if (const Spherical* joint = std::get_if<Spherical>(&b.joint)) {
        kind = Kind::spherical;
        at = joint->at;
        origin = joint->point;
    } else if (const Revolute* hinge = std::get_if<Revolute>(&b.joint)) {
        kind = Kind::revolute;
        at = hinge->at;
        origin = hinge->point;
    } else if (const Prismatic* slide = std::get_if<Prismatic>(&b.joint)) {
        kind = Kind::prismatic;
        at = slide->at;
        origin = slide->point;
    } else {
        origin = body.com();
    }
    const MassProperties& given = body.exact();
    exact.mass = given.mass;
    exact.origin = kind == Kind::free ? given.com : widened(origin);
    for (int i = 0; i < 3; ++i) exact.weight[i] = given.mass * scene.gravity()[i];
    const Matrix3Of<DoubleDouble> about_o = kind == Kind::free ? given.inertia : inertia_about(given, exact.origin);
    const Vector3Of<DoubleDouble> to_center = given.com - exact.origin;
    if (turns_freely()) {
        choose_principal_frame(scene, index, principal_axes(about_o), to_center);
    } else {
        const Vector3& axis =
            kind == Kind::revolute ? std::get<Revolute>(b.joint).axis : std::get<Prismatic>(b.joint).axis;
        exact.frame = hinge_frame(widened(axis), to_center);
        const Vector3Of<DoubleDouble>& e3 = exact.frame.col(2);
        exact.moments = {1.0, 1.0, dot<DoubleDouble>(e3, product(about_o, e3))};
        const double axial = exact.moments[2].hi, all = (about_o(0, 0) + about_o(1, 1) + about_o(2, 2)).hi;
        if (kind == Kind::revolute)
            require(axial > 1e-15 * all, b.name, "moment of inertia about its axis", axial,
                    "a body turns about a hinge by its moment about it and that of what it carries; this one has none: "
                    "give it some, or move the axis");
    }
    exact.frame_attitude = quaternion(exact.frame);
    exact.center = in_frame(to_center);
    mass = exact.mass.hi;
    frame = rounded(exact.frame);
    frame_attitude = rounded(exact.frame_attitude);
    center = rounded(exact.center);
    moments = rounded(exact.moments);
    inertia = rounded(product(exact.frame.transpose(), product(given.inertia, exact.frame)));
}

RBDYN_INLINE int RigidLaw::positions() const {
    const int attitude = follows_axis ? 5 : 4;
    return kind == Kind::free ? 3 + attitude : kind == Kind::spherical ? attitude : 1;
}

RBDYN_INLINE std::string RigidLaw::coordinates() const {
    switch (kind) {
        case Kind::revolute: return "angle of its hinge";
        case Kind::prismatic: return "displacement of its slide";
        default: break;
    }
    return std::string(kind == Kind::free ? "centre of mass x, y, z; " : "") +
           (follows_axis ? "quaternion of the frame that follows its axis, spin about it"
                         : "quaternion of its principal axes");
}

RBDYN_INLINE void RigidLaw::start(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const {
    if (!turns_freely()) {
        q[0] = b.parameter;
        v[0] = b.speed;
        return;
    }
    const QuaternionOf<DoubleDouble>& attitude = b.attitude.exact();
    if (kind == Kind::free) {
        const Matrix3Of<DoubleDouble> r = rotation_matrix(attitude);
        const Vector3Of<DoubleDouble> g = widened(b.position) + product(r, exact.origin),
                                      u = widened(b.velocity) + product(r, b.angular_velocity.cross(exact.origin));
        for (int i = 0; i < 3; ++i) {
            *q++ = g[i];
            *v++ = u[i];
        }
    }
    const QuaternionOf<DoubleDouble> p = attitude * exact.frame_attitude;
    const Vector3Of<DoubleDouble> omega = product(exact.frame.transpose(), b.angular_velocity);
    for (const DoubleDouble& c : {p.w, p.x, p.y, p.z}) *q++ = c;
    if (follows_axis) *q = 0.0;
    for (int i = 0; i < 3; ++i) v[i] = omega[i];
}

RBDYN_INLINE void RigidLaw::set_attitude(const Quaternion& attitude, const Vector3& omega, Instant since, double* q,
                                         double* v) const {
    Quaternion p = attitude * frame_attitude;
    Vector3 w = frame.transpose() * omega;
    if (follows_axis) {
        // spin = w3 t, within two turns, where it keeps its digits
        const DoubleDouble spin = DoubleDouble(w[2]) * DoubleDouble(since);
        const double turns = std::round(spin.hi / (4.0 * std::numbers::pi));
        const double half = 0.5 * double(spin - DoubleDouble(4.0 * turns) * double_double::pi);
        const double c = std::cos(half), s = std::sin(half);
        p = p * Quaternion{c, 0.0, 0.0, -s};
        w = Vector3((2.0 * c * c - 1.0) * w[0] - 2.0 * s * c * w[1], 2.0 * s * c * w[0] + (2.0 * c * c - 1.0) * w[1],
                    w[2]);
        q[4] = 2.0 * half;
    }
    q[0] = p.w;
    q[1] = p.x;
    q[2] = p.y;
    q[3] = p.z;
    for (int i = 0; i < 3; ++i) v[i] = w[i];
}

RBDYN_INLINE std::vector<VariableGroup> RigidLaw::groups(bool of_positions) const {
    if (kind == Kind::prismatic) return {{0, 1, of_positions, 0.0, of_positions ? Alike::place : Alike::velocity}};
    if (kind == Kind::revolute) return {{0, 1, false, 0.0, of_positions ? Alike::nothing : Alike::turning}};
    std::vector<VariableGroup> result;
    const int first = kind == Kind::free ? 3 : 0;
    if (first > 0) result.push_back({0, 3, of_positions, 0.0, of_positions ? Alike::place : Alike::velocity});
    result.push_back({first, of_positions ? 4 : 3, false, 0.0, of_positions ? Alike::nothing : Alike::turning});
    if (of_positions && follows_axis) result.push_back({first + 4, 1, false});
    return result;
}

RBDYN_INLINE Vector3Of<DoubleDouble> RigidLaw::in_frame(const Vector3Of<DoubleDouble>& v) const {
    Vector3Of<DoubleDouble> c = product(exact.frame.transpose(), v);
    const double size = rounded(v).norm();
    for (int i = 0; i < 3; ++i)
        if (std::abs(c[i].hi) <= (follows_axis ? off_axis : 0x1p-98) * size) c[i] = 0.0;
    return c;
}

RBDYN_INLINE Matrix3Of<DoubleDouble> RigidLaw::hinge_frame(const Vector3Of<DoubleDouble>& axis,
                                                           const Vector3Of<DoubleDouble>& to_center) {
    const Vector3Of<DoubleDouble> z = unit(axis);
    const auto across = [&](const Vector3Of<DoubleDouble>& v) { return v - scaled(z, z.dot(v)); };
    const bool has_arm = rounded(across(to_center)).norm() > 1e-15 * rounded(to_center).norm();
    Matrix3Of<DoubleDouble> result;
    result.col(0) = unit(across(has_arm ? to_center : widened(least_along(rounded(z)))));
    result.col(1) = z.cross(result.col(0));
    result.col(2) = z;
    return result;
}

RBDYN_INLINE Vector3Of<DoubleDouble> RigidLaw::unit(const Vector3Of<DoubleDouble>& v) {
    // a power of two, so that squares neither overflow nor vanish
    int exponent = 0;
    const Vector3 size = sizes(rounded(v));
    std::frexp(size[greatest(size)], &exponent);
    const Vector3Of<DoubleDouble> w = scaled(v, std::ldexp(1.0, -exponent));
    return scaled(w, 1.0 / sqrt(w.dot(w)));
}

RBDYN_INLINE Vector3 RigidLaw::least_along(const Vector3& direction) {
    Vector3 e(0, 0, 0);
    e[least(sizes(direction))] = 1.0;
    return e;
}

RBDYN_INLINE void RigidLaw::choose_principal_frame(const Scene& scene, int index,
                                                   const PrincipalAxesOf<DoubleDouble>& p,
                                                   const Vector3Of<DoubleDouble>& to_center) {
    int axis = -1;
    for (int i = 0; i < 3; ++i)
        if (p.moments[(i + 1) % 3] == p.moments[(i + 2) % 3]) axis = i;
    const bool is_ball = p.moments[0] == p.moments[1] && p.moments[1] == p.moments[2];
    const int first = axis < 0 ? 0 : (axis + 1) % 3;
    Vector3Of<DoubleDouble>& m = exact.moments;
    for (int i = 0; i < 3; ++i) {
        const int k = (first + i) % 3;
        exact.frame.col(i) = p.axes.col(k);
        m[i] = p.moments[k];
    }
    // a ball turns about any of its axes: that through G
    if (is_ball && !rounded(to_center).isZero(0.0)) exact.frame = hinge_frame(to_center, to_center);
    follows_axis = axis >= 0 && acts_on_axis(scene, index, exact.frame.col(2));
    for (int i = 0; i < 3; ++i)
        exact.coupling[i] = follows_axis ? m[2] / m[0] : (m[(i + 1) % 3] - m[(i + 2) % 3]) / m[i];
}

RBDYN_INLINE bool RigidLaw::acts_on_axis(const Scene& scene, int index, const Vector3Of<DoubleDouble>& e) const {
    const RigidBody& body = *scene.bodies()[static_cast<std::size_t>(index)].rigid();
    const auto arm_is_on_axis = [&](const Vector3Of<DoubleDouble>& d) {
        return rounded(d - scaled(e, e.dot(d))).norm() <= off_axis * rounded(d).norm();
    };
    const auto is_on_axis = [&](const Vector3& point) { return arm_is_on_axis(widened(point) - exact.origin); };
    if (!arm_is_on_axis(body.exact().com - exact.origin)) return false;
    for (const Scene::AppliedLoad& load : scene.loads()) {
        if (load.body != index || !is_present(load.load)) continue;
        const Force* force = std::get_if<Force>(&load.load);
        if (std::holds_alternative<Torque>(load.load) || (force != nullptr && force->frame() == Frame::body) ||
            (load.at && !is_on_axis(*load.at)))
            return false;
    }
    for (const Scene::Connection& c : scene.connections()) {
        if (!is_present(c.coupling)) continue;
        for (const End* end : {&c.a, &c.b})
            if (const BodyPoint* point = std::get_if<BodyPoint>(end);
                point != nullptr && point->body == index && !is_on_axis(point->point))
                return false;
    }
    return true;
}

}  // namespace rbdyn::inline RBDYN_FORM
