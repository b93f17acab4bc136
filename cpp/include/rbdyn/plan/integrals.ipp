// Definitions of rbdyn/plan/integrals.hpp.
#pragma once

#include "rbdyn/plan/integrals.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <variant>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/circle.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/scene/constraints.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/surfaces.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE bool has_potential_along_rail(const Scene& scene, const Scene::AppliedLoad& load) {
    const Force* force = std::get_if<Force>(&load.load);
    const Rail* rail = scene.bodies()[static_cast<std::size_t>(load.body)].rail();
    return force != nullptr && !force->is_constant() && !force->depends_on_time() && !force->depends_on_velocity() &&
           rail != nullptr && !rail->friction() && !rail->motion().present() && !rail->may_release();
}

RBDYN_INLINE void Remaining::push(const Vector3& force) {
    for (int i = 0; i < 3; ++i) {
        momentum[i] = momentum[i] && force[i] == 0.0;
        angular[i] = angular[i] && force[(i + 1) % 3] == 0.0 && force[(i + 2) % 3] == 0.0;
    }
    if (!force.isZero(0.0)) lines.push_back(direction(force));
}

RBDYN_INLINE void Remaining::hold(const Vector3& point) {
    for (bool& kept : momentum) kept = false;
    points.push_back(point);
}

RBDYN_INLINE void Remaining::turn_about(const Vector3& point, const Vector3& axis, bool slides) {
    if (slides)
        keep_along(momentum, axis);
    else
        for (bool& kept : momentum) kept = false;
    keep_along(angular, axis);
    points.push_back(point);
    lines.push_back(direction(axis));
}

RBDYN_INLINE void Remaining::twist() {
    for (bool& kept : angular) kept = false;
    any_line = false;
}

RBDYN_INLINE void Remaining::keep_along(bool (&kept)[3], const Vector3& axis) {
    for (int i = 0; i < 3; ++i) kept[i] = kept[i] && axis[(i + 1) % 3] == 0.0 && axis[(i + 2) % 3] == 0.0;
}

RBDYN_INLINE Vector3 Remaining::settle() {
    const Vector3 pole = points.empty() ? Vector3(Vector3::Zero()) : points.front();
    for (const Vector3& p : points)
        for (int i = 0; i < 3; ++i)
            for (const int k : {(i + 1) % 3, (i + 2) % 3}) angular[i] = angular[i] && p[k] == pole[k];
    return pole;
}

RBDYN_INLINE std::optional<Vector3> Remaining::line(const Vector3& pole) const {
    constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
    if (!any_line) return std::nullopt;
    Vector3 along = lines.empty() ? Vector3(Vector3::Zero()) : lines.front();
    if (lines.empty())
        for (const Vector3& p : points)
            if (Vector3(p - pole).norm() > along.norm()) along = p - pole;
    if (along.isZero(0.0)) return std::nullopt;
    along = direction(along);
    for (const Vector3& other : lines)
        if (!(along.cross(other).norm() <= rounding)) return std::nullopt;
    for (const Vector3& p : points)
        if (!(Vector3(p - pole).cross(along).norm() <= rounding * (p.norm() + pole.norm()))) return std::nullopt;
    if (along[greatest(sizes(along))] < 0.0) along = -along;
    return along;
}

RBDYN_INLINE void take_load(const Scene& scene, const Scene::AppliedLoad& load, Remaining& left) {
    left.only_weight = false;
    if (const Force* force = std::get_if<Force>(&load.load)) {
        const bool is_constant = force->is_constant() && force->frame() == Frame::world;
        left.energy =
            left.energy && (is_constant || (force->frame() == Frame::world && has_potential_along_rail(scene, load)));
        if (is_constant) return left.push(force->constant());
        if (force->frame() != Frame::world || !force->function()) return left.push_anyhow();
        const auto may_be = [&](int i) {
            const Node& node = force->function().node(force->function().output_nodes()[static_cast<std::size_t>(i)]);
            return node.operation != Operation::constant || node.value != 0.0;
        };
        return left.push(may_be(0), may_be(1), may_be(2));
    }
    if (const Potential* potential = std::get_if<Potential>(&load.load)) {
        const Function& u = potential->function();
        return left.push(u.depends_on(0), u.depends_on(1), u.depends_on(2));
    }
    if (const Lorentz* lorentz = std::get_if<Lorentz>(&load.load)) {
        left.twist();
        return Remaining::keep_along(left.momentum, lorentz->field);
    }
    const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load);
    const bool is_force = std::holds_alternative<JointForce>(load.load);
    left.energy = left.energy && spring != nullptr && spring->damping.is_zero();
    // between two bodies, along or about what joins them
    const bool in_joint = spring != nullptr || is_force || std::holds_alternative<JointTorque>(load.load);
    if (in_joint && scene.bodies()[static_cast<std::size_t>(load.body)].parent >= 0) return;
    left.twist();
    if (is_force || std::holds_alternative<Drag>(load.load)) left.push_anyhow();
}

RBDYN_INLINE void take_joint(const Scene::Body& b, Remaining& left) {
    const Revolute* driven_hinge = std::get_if<Revolute>(&b.joint);
    const Prismatic* driven_slide = std::get_if<Prismatic>(&b.joint);
    if ((driven_hinge != nullptr && driven_hinge->motion) || (driven_slide != nullptr && driven_slide->motion)) {
        left.energy = left.only_weight = false;
        if (b.parent < 0) left.push_anyhow();
    }
    const bool has_friction = friction_in(b.joint).has_value();
    if (has_friction) left.energy = left.only_weight = false;
    // a bead that lands on its rail loses its speed across it
    if (const Rail* rail = b.rail();
        rail != nullptr && (rail->friction() || rail->motion().present() || rail->side() != RailSide::both))
        left.energy = left.only_weight = false;
    // what joins bodies to each other is no force from outside
    if (b.parent >= 0) return;
    if (std::holds_alternative<Universal>(b.joint) || std::holds_alternative<Fixed>(b.joint)) {
        left.only_weight = false;
        return left.push_anyhow();
    }
    if (const Planar* plane = std::get_if<Planar>(&b.joint)) {
        left.only_weight = false;
        return has_friction ? left.push_anyhow() : left.push(plane->x.cross(plane->y));
    }
    if (const Cylindrical* pipe = std::get_if<Cylindrical>(&b.joint)) {
        left.only_weight = false;
        return has_friction ? left.push_anyhow() : left.turn_about(pipe->at, pipe->axis, true);
    }
    const auto slides_along = [&](const Vector3& axis) {
        left.twist();
        Remaining::keep_along(left.momentum, axis);
    };
    if (const Rail* rail = b.rail()) {
        const bool is_ideal = !rail->friction() && !rail->motion().present();
        left.only_weight = false;
        if (!is_ideal || rail->may_release()) return left.push_anyhow();
        if (const Circle* circle = std::get_if<Circle>(&rail->curve().kind()))
            return left.turn_about(circle->center, circle->placement().axes.col(2), false);
        if (!rail->curve().straight()) return left.push_anyhow();
        slides_along(rail->curve().first(b.parameter));
    } else if (has_friction && std::holds_alternative<Prismatic>(b.joint)) {
        left.push_anyhow();
    } else if (const Prismatic* slide = std::get_if<Prismatic>(&b.joint)) {
        slides_along(slide->axis);
    } else if (const Revolute* hinge = std::get_if<Revolute>(&b.joint)) {
        left.turn_about(hinge->at, hinge->axis, false);
        if (has_friction) left.twist();
    } else if (const Spherical* ball = std::get_if<Spherical>(&b.joint)) {
        left.hold(ball->at);
    }
}

RBDYN_INLINE void take_coupling(const Scene::Connection& c, Remaining& left) {
    left.only_weight = false;
    left.energy = left.energy && keeps_energy(c.coupling);
    if (!is_along_its_line(c.coupling)) left.twist();
    for (const End* end : {&c.a, &c.b})
        if (const Vector3* anchor = std::get_if<Vector3>(end)) left.hold(*anchor);
}

RBDYN_INLINE Remaining remaining_of(const Scene& scene) {
    Remaining left;
    left.push(scene.gravity());
    for (const auto& load : scene.loads())
        if (is_present(load.load)) take_load(scene, load, left);
    for (const Scene::Body& b : scene.bodies()) take_joint(b, left);
    for (const Scene::Held& c : scene.constraints()) {
        left.only_weight = false;
        if (body_of(c.b) >= 0) continue;
        if (const PointOnPlane* on = std::get_if<PointOnPlane>(&c.constraint))
            left.push(on->plane.normal);
        else
            left.push_anyhow();
    }
    for (const Scene::Touch& c : scene.contacts()) {
        if (c.is_gone) continue;
        left.only_weight = false;
        const bool is_rough = c.options.friction && c.options.friction->present();
        left.energy = left.energy && c.options.restitution == 1.0 && !is_rough;
        if (body_of(c.b) >= 0) continue;
        if (const Plane* floor = std::get_if<Plane>(&c.b); floor != nullptr && !is_rough)
            left.push(floor->normal);
        else
            left.push_anyhow();
    }
    for (const auto& c : scene.connections())
        if (is_present(c.coupling)) take_coupling(c, left);
    return left;
}

RBDYN_INLINE FirstIntegrals first_integrals(const Scene& scene, const std::optional<LoneBody>& body) {
    FirstIntegrals result;
    const Vector3& g = scene.gravity();
    const bool has_gravity = !g.isZero(0.0);
    if (has_gravity) result.up = -direction(g);
    // an action may change any velocity
    const auto changes = [](const Scene::Watch& w) { return w.options.action.kind == WatchAction::Kind::change; };
    if (std::any_of(scene.watches().begin(), scene.watches().end(), changes)) return result;
    Remaining left = remaining_of(scene);
    if (left.energy) result.names.push_back("energy");
    const std::string components[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i)
        if (left.momentum[i]) result.names.push_back("momentum " + components[i]);
    result.pole = left.settle();
    // on a ball joint weight has a moment if it does not act at the joint
    const bool is_top = body && body->on_ball_joint && left.only_weight && has_gravity;
    if (is_top && body->is_balanced) {
        result.names.push_back("angular momentum");
    } else if (is_top) {
        result.names.push_back("vertical angular momentum");
        if (body->is_kovalevskaya) result.names.push_back("Kovalevskaya");
    } else if (left.angular[0] && left.angular[1] && left.angular[2]) {
        result.names.push_back("angular momentum");
    } else {
        for (int i = 0; i < 3; ++i)
            if (left.angular[i]) result.names.push_back("angular momentum " + components[i]);
        const bool has_component = left.angular[0] || left.angular[1] || left.angular[2];
        if (const auto axis = left.line(result.pole); axis && !has_component) {
            result.names.push_back("axial angular momentum");
            result.axis = *axis;
        }
    }
    if (body && body->keeps_spin) result.names.push_back("spin");
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
