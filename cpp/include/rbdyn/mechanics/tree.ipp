// Definitions of rbdyn/mechanics/tree.hpp.
#pragma once

#include "rbdyn/mechanics/tree.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/phases.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/constraints.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace laws {

using Wide = Vector3Of<DoubleDouble>;

/// The law of a joint; `body`: the one it holds.
inline JointLaw of(const Free&, const Scene::Body& body) {
    if (body.rigid() == nullptr) return FreePointLaw{};
    FreeBodyLaw law;
    law.point = body.rigid()->exact().com;
    return law;
}
inline JointLaw of(const Rail& rail, const Scene::Body&) {
    const auto put = [&]<class Law>(Law law) {
        law.curve = rail.curve();
        const SmallPhases motion = small_phases(rail.motion().function());
        law.motion = motion.ahead > 0.0 ? RigidMotion(motion.function) : rail.motion();
        law.ahead = motion.ahead;
        return law;
    };
    if (!rail.may_release()) return put(RailLaw{});
    LooseRailLaw law = put(LooseRailLaw{});
    law.releases = rail.ends() == RailEnds::release;
    return law;
}
inline JointLaw of(const Spherical& joint, const Scene::Body&) {
    SphericalLaw law;
    law.offset = widened(joint.at);
    law.point = widened(joint.point);
    return law;
}
template <class Law, class J>
JointLaw along_axis(const J& joint) {
    Law law;
    law.offset = widened(joint.at);
    law.point = widened(joint.point);
    law.axis = unit(joint.axis);
    return law;
}
template <class J>
JointLaw driven(const J& joint, bool turns) {
    DrivenLaw law;
    law.offset = widened(joint.at);
    law.point = widened(joint.point);
    law.axis = unit(joint.axis);
    law.turns = turns;
    const SmallPhases motion = small_phases(joint.motion->function());
    law.way = motion.ahead > 0.0 ? TimeFunction(motion.function) : *joint.motion;
    law.rate = law.way.is_constant() ? TimeFunction() : TimeFunction(law.way.function().derivative(0));
    law.ahead = motion.ahead;
    return law;
}
inline JointLaw of(const Revolute& joint, const Scene::Body&) {
    return joint.motion ? driven(joint, true) : along_axis<RevoluteLaw>(joint);
}
inline JointLaw of(const Prismatic& joint, const Scene::Body&) {
    return joint.motion ? driven(joint, false) : along_axis<PrismaticLaw>(joint);
}
inline JointLaw of(const Cylindrical& joint, const Scene::Body&) { return along_axis<CylindricalLaw>(joint); }
inline JointLaw of(const Universal& joint, const Scene::Body&) {
    UniversalLaw law;
    law.offset = widened(joint.at);
    law.point = widened(joint.point);
    law.first = unit(joint.first);
    law.second = unit_across(joint.second, law.first);
    return law;
}
inline JointLaw of(const Planar& joint, const Scene::Body&) {
    PlanarLaw law;
    law.offset = widened(joint.at);
    law.x = unit(joint.x);
    law.y = unit_across(joint.y, law.x);
    law.normal = cross<DoubleDouble>(law.x, law.y);
    return law;
}
inline JointLaw of(const Fixed& joint, const Scene::Body&) {
    FixedLaw law;
    law.offset = widened(joint.at);
    law.point = widened(joint.point);
    law.attitude = rotation_matrix(joint.attitude.exact());
    return law;
}

}  // namespace laws

RBDYN_INLINE Tree::Tree(const Scene& scene, const std::vector<int>& flying, Beads beads) : starts_(scene.bodies()) {
    for (const Scene::Body& b : starts_) {
        Node n;
        n.name = b.name;
        const bool is_free = std::holds_alternative<Free>(b.joint);
        // nothing joins a free body to a parent: it is one without
        n.parent = is_free ? -1 : b.parent;
        n.joint = std::visit([&](const auto& joint) { return laws::of(joint, b); }, b.joint);
        if (const LooseRailLaw* loose = n.joint.as<LooseRailLaw>(); loose != nullptr && beads == Beads::stay)
            n.joint = static_cast<const RailLaw&>(*loose);
        if (std::find(flying.begin(), flying.end(), size()) != flying.end()) {
            n.joint.set_flying();
            n.parent = -1;
        }
        if (n.parent >= 0) n.joint.shift(node(n.parent).joint.held().point);
        n.q = positions_;
        n.v = velocities_;
        positions_ += n.joint.positions();
        velocities_ += n.joint.velocities();
        n.mass = b.mass();
        if (const RigidBody* rigid = b.rigid()) {
            n.is_point = false;
            n.body = rigid->exact();
            n.mass = n.body.mass;
            n.center = n.body.com - n.joint.held().point;
        }
        nodes_.push_back(std::move(n));
    }
    for (const Scene::Held& held : scene.constraints()) {
        const PointOnCurve* on = std::get_if<PointOnCurve>(&held.constraint);
        if (on == nullptr) continue;
        const int body = body_of(held.b);
        const auto origin =
            body < 0 ? Vector3Of<DoubleDouble>{} : Vector3Of<DoubleDouble>(-node(body).joint.held().point);
        feet_.push_back({held.name, anchor(held.a), body, origin, on->curve, widened(Foot::direction_aside(on->curve)),
                         positions_++});
    }
}

RBDYN_INLINE Anchor Tree::anchor(const End& end) const {
    if (const Vector3* place = std::get_if<Vector3>(&end)) return {-1, widened(*place)};
    const int body = body_of(end);
    if (body < 0) return {};
    const Node& n = node(body);
    if (const BodyPoint* point = std::get_if<BodyPoint>(&end)) return {body, n.from_held(point->point)};
    return {body, n.center};
}

RBDYN_INLINE std::vector<DoubleDouble> Tree::start(double t, const std::vector<Scene::Body>& starts) const {
    std::vector<DoubleDouble> x(at(variables()), 0.0);
    DoubleDouble *q = x.data(), *v = q + positions_;
    std::vector<Moving<DoubleDouble>> all;
    const Moving<DoubleDouble> ground;
    for (int i = 0; i < size(); ++i) {
        const Node& n = node(i);
        const Scene::Body& b = starts[at(i)];
        DoubleDouble *own_q = q + n.q, *own_v = v + n.v;
        const Moving<DoubleDouble>& parent = b.parent < 0 ? ground : all[at(b.parent)];
        // relative to the parent: where the origin of the body's axes is, and how the body turns
        const int first = n.joint.attitude();
        if (first >= 0) {
            Matrix3Of<DoubleDouble> turned;
            turned.col(0) = parent.axes.e1;
            turned.col(1) = parent.axes.e2;
            turned.col(2) = parent.axes.e3;
            const QuaternionOf<DoubleDouble> attitude = quaternion(turned) * b.attitude.exact();
            const DoubleDouble parts[4] = {attitude.w, attitude.x, attitude.y, attitude.z};
            for (int k = 0; k < 4; ++k) own_q[first + k] = parts[k];
            const Vector3Of<DoubleDouble> omega = parent.omega + to_world<DoubleDouble>(attitude, b.angular_velocity);
            for (int k = 0; k < 3; ++k) own_v[first + k] = omega[k];
        }
        if (std::holds_alternative<Free>(b.joint)) {
            const auto held = b.parent < 0 ? Vector3Of<DoubleDouble>{} : node(b.parent).joint.held().point;
            const Vector3Of<DoubleDouble> arm = parent.to_world(widened(b.position) - held);
            Vector3Of<DoubleDouble> place = parent.place + arm,
                                    velocity = parent.velocity_at(arm) + parent.to_world(widened(b.velocity));
            if (b.rigid() != nullptr) {
                const QuaternionOf<DoubleDouble> attitude{own_q[3], own_q[4], own_q[5], own_q[6]};
                const auto c = to_world<DoubleDouble>(attitude, n.joint.held().point);
                place += c;
                velocity += cross<DoubleDouble>(Vector3Of<DoubleDouble>(own_v[3], own_v[4], own_v[5]), c);
            }
            for (int k = 0; k < 3; ++k) {
                own_q[k] = place[k];
                own_v[k] = velocity[k];
            }
        } else if (const RailLaw* rail = n.joint.rail()) {
            own_q[0] = {b.parameter, b.parameter_rest};
            own_v[0] = DoubleDouble(b.speed) / sqrt(rail->curve->at<DoubleDouble>(own_q[0], Placement{}).speed_squared);
        } else if (first < 0 && n.joint.positions() == 1) {
            own_q[0] = b.parameter;
            own_v[0] = b.speed;
        } else if (first < 0) {
            for (int k = 0; k < n.joint.positions(); ++k) {
                own_q[k] = b.coordinates[at(k)];
                own_v[k] = b.rates[at(k)];
            }
        }
        all.push_back(n.joint.move<DoubleDouble>(parent, DoubleDouble(t), own_q, own_v));
    }
    for (const Foot& f : feet_) {
        const Moving<DoubleDouble>& on = f.on < 0 ? ground : all[at(f.on)];
        const auto held = point<DoubleDouble>(f.held, all);
        const Vector3 place = rounded(on.to_body(held.place - on.place) - f.origin),
                      velocity = rounded(on.to_body(held.velocity - on.velocity_at(held.place - on.place)));
        // where a curve meets itself, along the branch that the point moves along
        double most = -1.0;
        for (const double u : Foot::nearest(f.curve, place)) {
            const Vector3 along = f.curve.first(u);
            const double fits = std::abs(along.dot(velocity)) / along.norm();
            if (!(fits > most)) continue;
            most = fits;
            q[f.q] = u;
        }
    }
    follow(t, q);
    return x;
}

RBDYN_INLINE std::vector<VariableGroup> Tree::groups(bool is_constrained) const {
    std::vector<VariableGroup> groups;
    for (const bool is_position : {true, false})
        for (const Node& n : nodes_) {
            const int first = is_position ? n.q : positions_ + n.v,
                      count = is_position ? n.joint.positions() : n.joint.velocities(), turns = n.joint.attitude();
            const Alike moves = is_position ? Alike::place : Alike::velocity;
            if (n.joint.as<FreePointLaw>() != nullptr || n.joint.as<FreeBodyLaw>() != nullptr)
                groups.push_back({first, 3, is_position, 0.0, moves});
            if (turns >= 0) {
                // an attitude's scale is 1
                groups.push_back({first + turns, count - turns, false, is_position ? 1.0 : 0.0,
                                  is_position ? Alike::nothing : Alike::turning});
                continue;
            }
            if (n.joint.as<FreePointLaw>() != nullptr) continue;
            if (n.joint.as<LooseRailLaw>() != nullptr) {
                groups.push_back({first, 1, is_position});
                groups.push_back({first + LooseRailLaw::space, 3, is_position, 0.0, moves});
                continue;
            }
            using Tied = VariableGroup::Tied;
            const bool turns_only = n.joint.as<RevoluteLaw>() != nullptr || n.joint.as<UniversalLaw>() != nullptr;
            const Tied tied = turns_only                              ? Tied::turns
                              : n.joint.as<PrismaticLaw>() != nullptr ? Tied::slides
                                                                      : Tied::none;
            for (int k = 0; k < count; ++k) {
                groups.push_back({first + k, 1, is_position});
                if (is_constrained) groups.back().tied = tied;
            }
        }
    for (const Foot& f : feet_) groups.push_back({f.q, 1, true});
    return groups;
}

RBDYN_INLINE std::string Tree::coordinates(int body) const {
    const JointLaw& joint = node(body).joint;
    const std::string on = node(body).parent < 0 ? "" : " on " + nodes_[at(node(body).parent)].name;
    if (joint.as<FreePointLaw>() != nullptr) return "x, y, z in the world";
    if (joint.as<FreeBodyLaw>() != nullptr) return "centre of mass x, y, z and attitude (quaternion) in the world";
    if (const RailLaw* rail = joint.rail())
        return "parameter u of its " + rail->curve->name() + on +
               (joint.as<LooseRailLaw>() != nullptr ? ", x, y, z in the world where it flies" : "");
    if (joint.as<SphericalLaw>() != nullptr) return "attitude (quaternion) in the world, held" + on;
    if (joint.as<RevoluteLaw>() != nullptr) return "angle of its hinge" + on;
    if (joint.as<PrismaticLaw>() != nullptr) return "displacement of its slide" + on;
    if (joint.as<UniversalLaw>() != nullptr) return "two angles of its universal joint" + on;
    if (joint.as<CylindricalLaw>() != nullptr) return "angle and displacement of its cylindrical joint" + on;
    if (joint.as<PlanarLaw>() != nullptr) return "place and angle in its plane" + on;
    if (joint.as<FixedLaw>() != nullptr)
        return "none, it is welded" + (on.empty() ? std::string(" to the ground") : on);
    return "none, its joint is driven" + on;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
