// Definitions of rbdyn/scene/scene.hpp.
#pragma once

#include "rbdyn/scene/scene.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/particle.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/constraints.hpp"
#include "rbdyn/scene/contacts.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/plan_slot.hpp"
#include "rbdyn/scene/recorded_action.hpp"
#include "rbdyn/scene/starts.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace watches {

/// Nobody knows what a function does that is not recorded.
RBDYN_INLINE bool same_change(const WatchAction& a, const WatchAction& b) {
    const RecordedAction *one = recorded(a), *other = recorded(b);
    if (one != nullptr && other != nullptr) return *one == *other;
    return !a.change && !b.change;
}

}  // namespace watches

RBDYN_INLINE bool Scene::Watch::operator==(const Watch& other) const {
    return name == other.name && function == other.function && options.direction == other.options.direction &&
           options.action.kind == other.options.action.kind &&
           watches::same_change(options.action, other.options.action);
}

RBDYN_INLINE void Scene::set_gravity(const Vector3& g) {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(g[i]), "Scene", "component " + std::to_string(i) + " of gravity", g[i],
                "the field is finite; give it in m/s^2");
    gravity_ = g;
    plan_.forget();
}

RBDYN_INLINE BodyHandle Scene::add(const Particle& particle, const Free& joint, const FreeStart& start,
                                   std::string name) {
    particle.validate();
    name = named(std::move(name), "particle");
    return add(starts::on(joint, start, name), particle, joint, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const Particle& particle, const FreeStart& start, std::string name) {
    return add(particle, Free{}, start, std::move(name));
}

RBDYN_INLINE BodyHandle Scene::add(const Particle& particle, const Rail& rail, const RailStart& start,
                                   std::string name) {
    particle.validate();
    name = named(std::move(name), "bead");
    return add(starts::on(rail, start, name), particle, rail, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const Free& joint, const BodyStart& start, std::string name) {
    name = named(std::move(name), "body");
    const Started started = starts::on(joint, start, name);
    require_turnable(body, body.com(), name);
    return add(started, body, joint, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const BodyStart& start, std::string name) {
    return add(body, Free{}, start, std::move(name));
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const Spherical& joint, const SphericalStart& start,
                                   std::string name) {
    joint.validate();
    name = named(std::move(name), "body");
    require_turnable(body, joint.point, name);
    return add(starts::on(joint, start, name), body, joint, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const Revolute& joint, const RevoluteStart& start,
                                   std::string name) {
    joint.validate();
    name = named(std::move(name), "body");
    return add(starts::on(joint, start, name), body, joint, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const Prismatic& joint, const PrismaticStart& start,
                                   std::string name) {
    joint.validate();
    name = named(std::move(name), "body");
    return add(starts::on(joint, start, name), body, joint, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const Universal& joint, const UniversalStart& start,
                                   std::string name) {
    joint.validate();
    name = named(std::move(name), "body");
    return add(starts::on(joint, start, name), body, joint, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const Cylindrical& joint, const CylindricalStart& start,
                                   std::string name) {
    joint.validate();
    name = named(std::move(name), "body");
    return add(starts::on(joint, start, name), body, joint, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const Planar& joint, const PlanarStart& start,
                                   std::string name) {
    joint.validate();
    name = named(std::move(name), "body");
    return add(starts::on(joint, start, name), body, joint, start.parent, name);
}

RBDYN_INLINE BodyHandle Scene::add(const RigidBody& body, const Fixed& joint, const FixedStart& start,
                                   std::string name) {
    joint.validate();
    name = named(std::move(name), "body");
    return add(starts::on(joint, start, name), body, joint, start.parent, name);
}

RBDYN_INLINE void Scene::replace(BodyHandle body, const Start& start) {
    require_body(body, "replace");
    Body& b = bodies_.change()[static_cast<std::size_t>(body.index)];
    const bool is_rigid = b.rigid() != nullptr;
    Started& kept = b;
    kept = std::visit(
        [&]<class J, class S>(const J& joint, const S& given) -> Started {
            if constexpr (std::is_same_v<S, Started>) {
                return given;
            } else if constexpr (requires { starts::on(joint, given, b.name); }) {
                const bool is_of_particle = std::is_same_v<S, FreeStart> || std::is_same_v<S, RailStart>;
                if (is_of_particle != is_rigid) {
                    if (given.parent.index != -1 && given.parent.index != b.parent)
                        throw InvalidInput(b.name + ": parent is body " + std::to_string(given.parent.index) +
                                           "; a new start leaves what a body is joined to as it is: leave it out");
                    return starts::on(joint, given, b.name);
                }
            }
            throw InvalidInput(b.name +
                               ": its start is given in the words of another joint; give those of its own, as add() "
                               "takes them");
        },
        b.joint, start);
    plan_.start_elsewhere();
}

RBDYN_INLINE Start Scene::start(BodyHandle body) const {
    require_body(body, "start");
    const Body& b = bodies()[static_cast<std::size_t>(body.index)];
    return starts::words(b.joint, b.rigid() != nullptr, b);
}

RBDYN_INLINE BodyHandle Scene::body(const std::string& name) const {
    std::string names;
    for (std::size_t i = 0; i < bodies().size(); ++i) {
        if (bodies()[i].name == name) return {static_cast<int>(i)};
        names += (i == 0 ? "" : ", ") + ("\"" + bodies()[i].name + "\"");
    }
    throw InvalidInput("Scene: there is no body named \"" + name + "\"; " +
                       (names.empty() ? "it has no bodies: add() some" : "there are " + names));
}

RBDYN_INLINE void Scene::start_turning(BodyHandle body, const Attitude& attitude,
                                       const Vector3Of<DoubleDouble>& angular_velocity,
                                       const std::optional<Vector3>& angular_velocity_world) {
    require_body(body, "start_turning");
    Body& b = bodies_.change()[static_cast<std::size_t>(body.index)];
    b.attitude = attitude;
    b.angular_velocity = angular_velocity;
    b.angular_velocity_world = angular_velocity_world;
    plan_.start_elsewhere();
}

RBDYN_INLINE void Scene::start_beyond(BodyHandle body, double rest) {
    require_body(body, "start_beyond");
    bodies_.change()[static_cast<std::size_t>(body.index)].parameter_rest = rest;
    plan_.start_elsewhere();
}

RBDYN_INLINE LoadHandle Scene::apply(Load load, BodyHandle body, std::optional<Vector3> at) {
    require_body(body, "apply");
    require_fitting(load, bodies()[static_cast<std::size_t>(body.index)], at);
    if (const Drag* drag = std::get_if<Drag>(&load)) drag->validate();
    if (const Lorentz* lorentz = std::get_if<Lorentz>(&load)) lorentz->validate();
    if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load)) spring->validate();
    if (const JointTorque* torque = std::get_if<JointTorque>(&load)) torque->validate("JointTorque", "N m");
    if (const JointForce* force = std::get_if<JointForce>(&load)) force->validate("JointForce", "N");
    loads_.push_back({std::move(load), body.index, at});
    plan_.forget();
    return {static_cast<int>(loads_.size()) - 1};
}

RBDYN_INLINE CouplingHandle Scene::connect(Coupling coupling, End a, End b) {
    for (const End* end : {&a, &b}) require_end(*end, "connect");
    if (std::holds_alternative<Vector3>(a) && std::holds_alternative<Vector3>(b))
        throw InvalidInput("connect: both ends are points of the world; at least one is a body");
    if (a == b) throw InvalidInput("connect: both ends are the same body; a coupling joins two points");
    std::visit([](const auto& c) { c.validate(); }, coupling);
    if (std::holds_alternative<Gravitation>(coupling))
        for (const End* end : {&a, &b})
            if (!std::holds_alternative<BodyHandle>(*end))
                throw InvalidInput(
                    std::string("connect: Gravitation acts between two bodies' centres of mass, and an end "
                                "is ") +
                    (std::holds_alternative<Vector3>(*end)
                         ? "a point of the world, which has no mass; connect a Central to it"
                         : "a point of a body; give the body's handle"));
    connections_.change().push_back({std::move(coupling), std::move(a), std::move(b)});
    plan_.forget();
    return {static_cast<int>(connections().size()) - 1};
}

RBDYN_INLINE ConstraintHandle Scene::constrain(Constraint constraint, End a, std::optional<End> b, std::string name) {
    require_end(a, "constrain");
    if (b) require_end(*b, "constrain");
    if (const Universal* joint = std::get_if<Universal>(&constraint)) {
        // each in axes of its own body: how they lie to each other is what is held
        joints::require_direction("constrain, Universal, first axis", joint->first);
        joints::require_direction("constrain, Universal, second axis", joint->second);
    } else {
        std::visit([](const auto& c) { c.validate(); }, constraint);
    }
    if (body_of(a) < 0)
        throw InvalidInput(
            "constrain: a is a point of the world; what is held is a point of a body, and the world is "
            "b");
    if (b && body_of(*b) == body_of(a))
        throw InvalidInput("constrain: both ends are on " + bodies()[static_cast<std::size_t>(body_of(a))].name +
                           "; a constraint joins two bodies, or one and the world");
    const auto turns = [&](const End& end) {
        return body_of(end) < 0 || bodies()[static_cast<std::size_t>(body_of(end))].rigid() != nullptr;
    };
    const bool needs_axes = std::holds_alternative<Weld>(constraint) || std::holds_alternative<Hinge>(constraint) ||
                            std::holds_alternative<Universal>(constraint);
    if (needs_axes && !(turns(a) && (!b || turns(*b))))
        throw InvalidInput("constrain: a particle has no axes to be held; Ball() holds two points together");
    require_new_name(name, "constrain");
    std::size_t number = constraints_.size();
    while (name.empty() || is_taken(name)) name = "constraint " + std::to_string(++number);
    constraints_.push_back({std::move(constraint), std::move(a), b.value_or(End(BodyHandle{})), std::move(name)});
    plan_.forget();
    return {static_cast<int>(constraints_.size()) - 1};
}

RBDYN_INLINE ContactHandle Scene::contact(ContactPart a, ContactSurface b, ContactOptions options, std::string name) {
    options.validate();
    const int first = body_of(a), second = body_of(b);
    require_body(BodyHandle{first}, "contact");
    const bool is_of_body = std::holds_alternative<BodyPlane>(b) || std::holds_alternative<BodySphere>(b);
    if (is_of_body) require_body(BodyHandle{second}, "contact");
    const Body& body = bodies()[static_cast<std::size_t>(first)];
    if (first == second)
        throw InvalidInput("contact: both sides are on " + body.name +
                           "; a contact is between two bodies, or one and "
                           "the world");
    const bool has_axes = std::holds_alternative<BodyPoint>(a) || std::holds_alternative<BodyDisc>(a) ||
                          std::holds_alternative<BodyEllipsoid>(a);
    if (body.rigid() == nullptr && has_axes)
        throw InvalidInput("contact: " + body.name +
                           " is a particle, which has no other points and no shape but a "
                           "sphere; give its handle, or .sphere(radius)");
    const auto positive = [](double x, const std::string& what) {
        require(std::isfinite(x) && x > 0.0, "contact", what, x, "it is positive and finite, in m");
    };
    if (const BodySphere* sphere = std::get_if<BodySphere>(&a)) {
        require(std::isfinite(sphere->radius) && sphere->radius >= 0.0, "contact", "radius", sphere->radius,
                "it is zero or positive and finite, in m");
        joints::require_finite("contact", "center", sphere->center);
        if (body.rigid() == nullptr && !sphere->center.isZero(0.0))
            throw InvalidInput("contact: center is given, and " + body.name + " is a particle, which is its centre");
    }
    if (const BodyDisc* disc = std::get_if<BodyDisc>(&a)) {
        positive(disc->radius, "radius");
        joints::require_direction("contact, normal of a disc", disc->normal);
        joints::require_finite("contact", "center", disc->center);
    }
    if (const BodyEllipsoid* solid = std::get_if<BodyEllipsoid>(&a)) {
        for (int i = 0; i < 3; ++i) positive(solid->semi_axes[i], "semi-axis " + std::to_string(i));
        joints::require_finite("contact", "center", solid->center);
    }
    if (const Plane* plane = std::get_if<Plane>(&b)) plane->validate();
    if (const BodyPlane* plane = std::get_if<BodyPlane>(&b)) plane->plane.validate();
    if (const Sphere* sphere = std::get_if<Sphere>(&b)) sphere->validate();
    if (const BodySphere* sphere = std::get_if<BodySphere>(&b)) {
        positive(sphere->radius, "radius");
        joints::require_finite("contact", "center", sphere->center);
    }
    if (const Sphere* bowl = std::get_if<Sphere>(&b); bowl != nullptr && bowl->inside) {
        // what does not fit its bend touches a bowl in two places at once
        const BodyEllipsoid* solid = std::get_if<BodyEllipsoid>(&a);
        const double bend = solid == nullptr ? 0.0
                                             : solid->semi_axes.maxCoeff() *
                                                   (solid->semi_axes.maxCoeff() / solid->semi_axes.minCoeff());
        if (!(bend < bowl->radius))
            throw InvalidInput("contact: the largest radius of curvature of the ellipsoid of " + body.name +
                               ", the square of its largest semi-axis over the least one, is " + text(bend) +
                               " m, and of the bowl " + text(bowl->radius) +
                               " m; one that does not fit the bowl touches it in two places: give it spheres or points "
                               "there, each a contact of its own");
    }
    if (std::holds_alternative<BodyPlane>(b) && bodies()[static_cast<std::size_t>(second)].rigid() == nullptr)
        throw InvalidInput("contact: " + bodies()[static_cast<std::size_t>(second)].name +
                           " is a particle, which has no plane");
    require_new_name(name, "contact");
    std::size_t number = contacts_.size();
    while (name.empty() || is_taken(name)) name = "contact " + std::to_string(++number);
    contacts_.push_back({std::move(a), std::move(b), std::move(options), std::move(name)});
    plan_.forget();
    return {static_cast<int>(contacts_.size()) - 1};
}

RBDYN_INLINE WatchHandle Scene::watch(std::string name, WatchFunction function, WatchOptions options) {
    if (name.empty()) throw InvalidInput("watch: name is empty; events are found by the name of their watch");
    require_new_name(name, "watch");
    require_observables(function, "watch " + name);
    require_action(options.action, "watch " + name);
    watches_.push_back({std::move(name), std::move(function), std::move(options)});
    plan_.forget();
    return {static_cast<int>(watches_.size()) - 1};
}

RBDYN_INLINE void Scene::act(WatchHandle watch, WatchAction action) {
    require(watch.index >= 0 && watch.index < static_cast<int>(watches_.size()), "Scene.act", "watch", watch.index,
            "it is one of this scene's");
    Watch& watched = watches_[static_cast<std::size_t>(watch.index)];
    require_action(action, "watch " + watched.name);
    watched.options.action = std::move(action);
    plan_.forget();
}

RBDYN_INLINE void Scene::integral(std::string name, WatchFunction function) {
    if (name.empty()) throw InvalidInput("integral: name is empty; its drift is found by its name");
    require_no_zero("integral", name);
    if (has(integrals_, name))
        throw InvalidInput("integral: there is one named \"" + name + "\" already; names differ");
    require_observables(function, "integral " + name);
    integrals_.push_back({std::move(name), std::move(function)});
    plan_.forget();
}

RBDYN_INLINE Scene Scene::frozen() const {
    Scene result = *this;
    result.plan_.forget();
    // what has none is shared with all copies
    const auto may_vary = [](const Body& b) {
        const Particle* particle = std::get_if<Particle>(&b.body);
        if (particle != nullptr && particle->mass.varies()) return true;
        if (const Revolute* hinge = std::get_if<Revolute>(&b.joint))
            return hinge->motion || hinge->friction || hinge->pin_radius.varies();
        if (const Prismatic* slide = std::get_if<Prismatic>(&b.joint)) return slide->motion || slide->friction;
        return b.rail() != nullptr;
    };
    const auto freeze = [](Body& b) {
        if (const Particle* particle = std::get_if<Particle>(&b.body)) b.body = particle->frozen();
        if (const Rail* rail = b.rail()) b.joint = rail->frozen();
        if (Revolute* hinge = std::get_if<Revolute>(&b.joint); hinge != nullptr && hinge->motion)
            hinge->motion = hinge->motion->frozen();
        if (Prismatic* slide = std::get_if<Prismatic>(&b.joint); slide != nullptr && slide->motion)
            slide->motion = slide->motion->frozen();
        if (Revolute* hinge = std::get_if<Revolute>(&b.joint)) {
            if (hinge->friction) hinge->friction = hinge->friction->frozen();
            hinge->pin_radius = hinge->pin_radius.frozen();
        }
        if (Prismatic* slide = std::get_if<Prismatic>(&b.joint); slide != nullptr && slide->friction)
            slide->friction = slide->friction->frozen();
    };
    if (std::ranges::any_of(bodies(), may_vary)) std::ranges::for_each(result.bodies_.change(), freeze);
    for (AppliedLoad& l : result.loads_) l.load = rbdyn::frozen(l.load);
    const auto may_couple_otherwise = [](const Connection& c) {
        const Spring* spring = std::get_if<Spring>(&c.coupling);
        return spring == nullptr || spring->stiffness.varies() || spring->damping.varies() ||
               spring->rest_length.varies();
    };
    if (std::ranges::any_of(connections(), may_couple_otherwise))
        for (Connection& c : result.connections_.change())
            c.coupling = std::visit([](const auto& coupling) -> Coupling { return coupling.frozen(); }, c.coupling);
    for (Touch& c : result.contacts_)
        if (c.options.friction) c.options.friction = c.options.friction->frozen();
    for (Watch& w : result.watches_) {
        w.function = w.function.frozen();
        if (const RecordedAction* action = recorded(w.options.action))
            w.options.action.change = RecordedAction(action->frozen());
    }
    for (Integral& i : result.integrals_) i.function = i.function.frozen();
    return result;
}

RBDYN_INLINE Scene Scene::begun_at(double time) && {
    const bool moves = std::ranges::any_of(bodies(), [](const Body& b) {
        return is_driven(b.joint) || (b.rail() != nullptr && b.rail()->motion().present());
    });
    origin_ = moves ? time : 0.0;
    return std::move(*this);
}

RBDYN_INLINE BodyHandle Scene::add(const Started& start, std::variant<Particle, RigidBody> body, Joint joint,
                                   BodyHandle parent, const std::string& name) {
    const int joined = parent_of(parent, name);
    body_names_.change().insert(name);
    bodies_.change().push_back({start, std::move(body), std::move(joint), joined, name});
    plan_.forget();
    return {static_cast<int>(bodies().size()) - 1};
}

RBDYN_INLINE int Scene::parent_of(BodyHandle parent, const std::string& name) const {
    if (parent.index == -1) return -1;
    require(parent.index >= 0 && parent.index < static_cast<int>(bodies().size()), name, "parent", parent.index,
            "a parent is a body that this scene has already, of " + std::to_string(bodies().size()) + "; or none");
    if (bodies()[static_cast<std::size_t>(parent.index)].rigid() == nullptr)
        throw InvalidInput(name + ": its parent " + bodies()[static_cast<std::size_t>(parent.index)].name +
                           " is a particle, which has no axes to hold a joint; a RigidBody can be a parent");
    return parent.index;
}

RBDYN_INLINE bool Scene::is_taken(const std::string& name) const {
    return body_names_->contains(name) || has(watches_, name) || has(constraints_, name) || has(contacts_, name);
}

RBDYN_INLINE std::string Scene::named(std::string name, const std::string& kind) const {
    require_new_name(name, "add");
    if (!name.empty()) return name;
    std::size_t number = bodies().size();
    do name = kind + " " + std::to_string(++number);
    while (is_taken(name));
    return name;
}

}  // namespace rbdyn::inline RBDYN_FORM
