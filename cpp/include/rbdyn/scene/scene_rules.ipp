// Definitions of rbdyn/scene/scene.hpp: what it is given must be what it can take.
#pragma once

#include "rbdyn/scene/scene.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/recorded_action.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Scene::require_observable(const Observable& o, const std::string& user) const {
    if (o.quantity == Quantity::time) return;
    const auto quantity = static_cast<int>(o.quantity), last = static_cast<int>(Quantity::coupling_force);
    require(quantity > 0 && quantity <= last, user, "quantity", quantity, "it is one of those that have a name");
    const bool of_coupling = is_of_coupling(o.quantity);
    const auto count = static_cast<int>(of_coupling ? connections().size() : bodies().size());
    require(o.subject >= 0 && o.subject < count, user, "handle", o.subject,
            "it asks for what this scene has, by handles that add() or connect() returned");
    if (const int count_of = components_of(o.quantity); o.component < 0 || o.component >= count_of)
        refuse(user, "component", o.component,
               "what it asks for of " +
                   (of_coupling ? "coupling " + std::to_string(o.subject + 1)
                                : bodies()[static_cast<std::size_t>(o.subject)].name) +
                   (count_of == 1 ? " is one number, component 0"
                                  : " has components 0 to " + std::to_string(count_of - 1)));
    if (of_coupling) return;
    const Body& b = bodies()[static_cast<std::size_t>(o.subject)];
    const auto refuse = [&](const std::string& why) { throw InvalidInput(user + ": " + b.name + why); };
    const bool is_free = std::holds_alternative<Free>(b.joint);
    switch (o.quantity) {
        case Quantity::parameter:
        case Quantity::speed:
        case Quantity::tangential_force:
            if (b.rigid() != nullptr) refuse(" is a rigid body, and only a particle on a rail has what is asked");
            [[fallthrough]];
        case Quantity::reaction:
            if (!is_free) return;
            if (b.rigid() != nullptr) refuse(" is free, and only a joint exerts a reaction");
            refuse(" is free, and only a body on a rail has a parameter, a speed along it and a reaction");
            return;
        case Quantity::position:
        case Quantity::velocity:
        case Quantity::acceleration:
        case Quantity::force:
        case Quantity::kinetic_energy: return;
        default: break;
    }
    if (b.rigid() == nullptr) refuse(" is a particle, and what is asked is of rigid bodies");
    const bool is_cylindrical = std::holds_alternative<Cylindrical>(b.joint),
               is_universal = std::holds_alternative<Universal>(b.joint),
               has_angle = std::holds_alternative<Revolute>(b.joint) || std::holds_alternative<Planar>(b.joint) ||
                           is_cylindrical,
               has_displacement = std::holds_alternative<Prismatic>(b.joint) || is_cylindrical;
    if (o.quantity == Quantity::reaction_torque && is_free) refuse(" is free, and only a joint exerts a reaction");
    if (o.quantity == Quantity::angle && !has_angle)
        refuse(" has no angle; a body on a Revolute, Cylindrical or Planar joint has");
    if (o.quantity == Quantity::displacement && !has_displacement)
        refuse(" has no displacement; a body on a Prismatic or Cylindrical joint has");
    if (o.quantity == Quantity::rate && !has_angle && !has_displacement)
        refuse(" has no rate; a body on a Revolute, Prismatic, Cylindrical or Planar joint has");
    if (o.quantity == Quantity::displacement_rate && !is_cylindrical)
        refuse(" has no displacement_rate; a body on a Cylindrical joint has");
    if ((o.quantity == Quantity::angles || o.quantity == Quantity::rates) && !is_universal)
        refuse(" has no angles about two axes; a body on a Universal joint has");
}

RBDYN_INLINE void Scene::require_end(const End& end, const std::string& verb) const {
    if (body_of(end) >= 0 || !std::holds_alternative<Vector3>(end)) require_body(BodyHandle{body_of(end)}, verb);
    if (const BodyPoint* point = std::get_if<BodyPoint>(&end)) {
        joints::require_finite(verb, "a point of a body", point->point);
        const Body& body = bodies()[static_cast<std::size_t>(point->body)];
        if (body.rigid() == nullptr)
            throw InvalidInput(verb + ": a point of " + body.name +
                               " is given, which is a particle and has no other; give its handle");
    }
    if (const Vector3* point = std::get_if<Vector3>(&end))
        for (int i = 0; i < 3; ++i)
            require(std::isfinite((*point)[i]), verb, "component " + std::to_string(i) + " of a point", (*point)[i],
                    "a point of the world is finite, in m");
}

RBDYN_INLINE void Scene::require_turnable(const RigidBody& body, const Vector3& point, const std::string& name) {
    const Vector3 moments = body.principal(point).moments;
    const double lowest = moments[least(moments)], highest = moments[greatest(moments)];
    require(lowest > least_moment * highest, name, "least principal moment of inertia", lowest,
            "a rod-like body has no inertia against spin about its own line, which this joint leaves free: hold it "
            "by Revolute, Prismatic or off its line, or give it a thickness");
}

RBDYN_INLINE void Scene::require_fitting(const Load& load, const Body& body, const std::optional<Vector3>& at) {
    if (at) joints::require_finite("apply", "at", *at);
    const bool is_turning = std::holds_alternative<Torque>(load);
    if (body.rigid() == nullptr) {
        if (at) throw InvalidInput("apply: at is given, and " + body.name + " is a particle, which has one point");
        const Force* force = std::get_if<Force>(&load);
        if (is_turning || (force != nullptr && force->frame() == Frame::body))
            throw InvalidInput("apply: " + body.name + " is a particle, which has no axes and turns with nothing; " +
                               (is_turning ? "a Torque acts on a RigidBody" : "give the force in world axes"));
    }
    if (is_turning && at)
        throw InvalidInput("apply: at is given for a Torque, which is the same about every point; leave it out");
    const bool is_free = !is_driven(body.joint);
    const bool turns_about_axis =
                   is_free &&
                   (std::holds_alternative<Revolute>(body.joint) || std::holds_alternative<Cylindrical>(body.joint) ||
                    std::holds_alternative<Universal>(body.joint) || std::holds_alternative<Planar>(body.joint)),
               slides = is_free && (std::holds_alternative<Prismatic>(body.joint) ||
                                    std::holds_alternative<Cylindrical>(body.joint));
    if (std::holds_alternative<JointTorque>(load) && (!turns_about_axis || at))
        throw InvalidInput(
            "apply: a JointTorque acts about the axis of a Revolute, Cylindrical, Universal or Planar "
            "joint that is not driven, " +
            std::string(at ? "at no point" : "which " + body.name + " is not on"));
    if (std::holds_alternative<JointForce>(load) && (!slides || at))
        throw InvalidInput("apply: a JointForce acts along a Prismatic or Cylindrical joint that is not driven, " +
                           std::string(at ? "at no point" : "which " + body.name + " is not on"));
    if (std::holds_alternative<TorsionSpring>(load) && (!turns_about_axis || at))
        throw InvalidInput("apply: a TorsionSpring acts about the axis of a Revolute joint, " +
                           std::string(at ? "at no point" : "which " + body.name + " is not on"));
}

RBDYN_INLINE Observe Scene::checked(Observe observe, const std::string& user) const {
    return [this, observe = std::move(observe), user](const Observable& o) {
        require_observable(o, user);
        return observe(o);
    };
}

RBDYN_INLINE void Scene::require_action(const WatchAction& action, const std::string& user) const {
    action.require_change(user);
    if (const RecordedAction* change = recorded(action))
        for (const Observable& o : change->asked()) require_observable(o, user + ", its action");
}

RBDYN_INLINE void Scene::require_observables(const WatchFunction& function, const std::string& user) const {
    if (!function) throw InvalidInput(user + ": its function is empty; give one");
    for (const Observable& o : function.arguments()) require_observable(o, user);
}

RBDYN_INLINE void Scene::require_body(BodyHandle body, const std::string& verb) const {
    require(body.index >= 0 && body.index < static_cast<int>(bodies().size()), verb, "body", body.index,
            "a handle comes from add() of the same scene, which has " + std::to_string(bodies().size()) + " bodies");
}

RBDYN_INLINE void Scene::require_new_name(const std::string& name, const std::string& verb) const {
    require_no_zero(verb, name);
    if (name.empty() || !is_taken(name)) return;
    const std::string kind = body_names_->contains(name) ? "body"
                             : has(watches_, name)       ? "watch"
                             : has(constraints_, name)   ? "constraint"
                                                         : "contact";
    throw InvalidInput(verb + ": there is a " + kind + " named \"" + name + "\" already; names differ");
}

}  // namespace rbdyn::inline RBDYN_FORM
