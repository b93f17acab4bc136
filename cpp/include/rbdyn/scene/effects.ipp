// Definitions of rbdyn/scene/effects.hpp.
#pragma once

#include "rbdyn/scene/effects.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/particle.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/plan_slot.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM::acting {

RBDYN_INLINE bool turns(const Load& load) {
    return std::holds_alternative<Torque>(load) || std::holds_alternative<JointTorque>(load);
}

RBDYN_INLINE Load nothing_of(const Load& load) {
    return std::visit(
        [](const auto& l) -> Load {
            using L = std::decay_t<decltype(l)>;
            if constexpr (std::is_same_v<L, Torque>) return Torque(Vector3::Zero());
            if constexpr (std::is_same_v<L, Force> || std::is_same_v<L, Potential>) return Force(Vector3::Zero());
            if constexpr (std::is_default_constructible_v<L>) return L{};
        },
        load);
}

}  // namespace rbdyn::inline RBDYN_FORM::acting

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<std::string> effects_of(const Scene& scene) {
    std::vector<std::string_view> found;
    const auto note = [&](bool is_there, std::string_view name) {
        if (is_there) found.push_back(name);
    };
    const auto note_spring = [&](const auto& s) {
        note(!s.stiffness.is_zero(), "spring");
        note(!s.damping.is_zero(), "damper");
    };
    note(!scene.gravity().isZero(0.0), "gravity");
    for (const Scene::Body& b : scene.bodies()) {
        note(acting::turns(b), "rotation");
        if (const auto friction = friction_in(b.joint)) {
            note(friction->dynamic() > 0.0, "dynamic friction");
            note(friction->mu_static > 0.0, "static friction");
        }
        if (b.rail() == nullptr) continue;
        note(b.rail()->motion().present(), "moving rail");
        const auto friction = b.rail()->friction();
        if (!friction) continue;
        note(!b.rail()->drive().is_zero(), "drive");
        note(friction->dynamic() > 0.0, "dynamic friction");
        note(friction->mu_static > 0.0, "static friction");
    }
    for (const Scene::AppliedLoad& l : scene.loads())
        if (const auto* torsion = std::get_if<TorsionSpring>(&l.load))
            note_spring(*torsion);
        else
            note(is_present(l.load), std::holds_alternative<Drag>(l.load) ? "drag"
                                     : acting::turns(l.load)              ? "user torque"
                                                                          : "user force");
    for (const Scene::Connection& c : scene.connections())
        for (const std::string_view effect : couplings::effects_of(c.coupling)) found.push_back(effect);
    for (const Scene::Touch& c : scene.contacts()) {
        if (c.is_gone) continue;
        note(true, "contact");
        note(c.options.restitution > 0.0, "impact");
        if (!c.options.friction) continue;
        note(c.options.friction->dynamic() > 0.0, "dynamic friction");
        note(c.options.friction->mu_static > 0.0, "static friction");
    }
    std::vector<std::string> result;
    for (const std::string_view name : acting::names)
        if (std::find(found.begin(), found.end(), name) != found.end()) result.emplace_back(name);
    return result;
}

namespace acting {

inline std::optional<Coulomb> without(const std::optional<Coulomb>& friction, const std::string& name,
                                      const std::vector<std::string>& gone) {
    if (!friction) return friction;
    const auto is_gone = [&](std::string_view effect) {
        return std::find(gone.begin(), gone.end(), effect) != gone.end();
    };
    const Given dynamic = is_gone("dynamic friction") ? Given(0.0) : friction->mu_dynamic.value_or(friction->mu_static);
    if (is_gone("static friction") && dynamic > 0.0)
        require(friction->mu_static > dynamic, name, "mu_static", friction->mu_static,
                "beside dynamic friction there is as much static friction, and here there is no more; take "
                "\"dynamic friction\" away too");
    Coulomb left{is_gone("static friction") ? dynamic : friction->mu_static, dynamic};
    // torques against rolling and pivoting go with what resists sliding
    if (is_gone("dynamic friction")) return left;
    left.rolling = friction->rolling;
    left.pivoting = friction->pivoting;
    return left;
}

}  // namespace acting

RBDYN_INLINE Scene Scene::without(const std::vector<Removable>& parts) const {
    const std::vector<std::string> present = effects_of(*this);
    std::vector<std::string> gone;
    Scene result = *this;
    result.plan_.forget();
    for (const Removable& part : parts) {
        if (const LoadHandle* load = std::get_if<LoadHandle>(&part)) {
            require(load->index >= 0 && load->index < static_cast<int>(loads_.size()), "without", "load", load->index,
                    "a handle comes from apply() of the same scene, which has " + std::to_string(loads_.size()));
            Load& taken = result.loads_[static_cast<std::size_t>(load->index)].load;
            taken = acting::nothing_of(taken);
        } else if (const CouplingHandle* coupling = std::get_if<CouplingHandle>(&part)) {
            require(
                coupling->index >= 0 && coupling->index < static_cast<int>(connections().size()), "without", "coupling",
                coupling->index,
                "a handle comes from connect() of the same scene, which has " + std::to_string(connections().size()));
            Coupling& taken = result.connections_.change()[static_cast<std::size_t>(coupling->index)].coupling;
            taken = couplings::nothing_of(taken);
        } else if (const ContactHandle* contact = std::get_if<ContactHandle>(&part)) {
            require(contact->index >= 0 && contact->index < static_cast<int>(contacts_.size()), "without", "contact",
                    contact->index,
                    "a handle comes from contact() of the same scene, which has " + std::to_string(contacts_.size()));
            result.contacts_[static_cast<std::size_t>(contact->index)].is_gone = true;
        } else {
            const std::string& name = std::get<std::string>(part);
            const auto among = [&](const auto& list) {
                return std::find(list.begin(), list.end(), name) != list.end();
            };
            if (!among(acting::names))
                throw InvalidInput("without: \"" + name + "\" is no effect; the effects are " +
                                   acting::listed(acting::names) + "; this scene has " + acting::listed(present));
            if (!among(present))
                throw InvalidInput("without: this scene has no " + name + "; it has " + acting::listed(present));
            gone.push_back(name);
        }
    }
    const auto is_gone = [&](std::string_view name) { return std::find(gone.begin(), gone.end(), name) != gone.end(); };
    if (is_gone("gravity")) result.gravity_ = Vector3::Zero();
    const auto take_spring = [&](auto& s) {
        if (is_gone("spring")) s.stiffness = 0.0;
        if (is_gone("damper")) s.damping = 0.0;
    };
    for (Connection& c : result.connections_.change())
        if (Spring* spring = std::get_if<Spring>(&c.coupling)) {
            take_spring(*spring);
        } else {
            for (const std::string_view effect : couplings::effects_of(c.coupling))
                if (is_gone(effect)) c.coupling = couplings::nothing_of(c.coupling);
        }
    for (AppliedLoad& l : result.loads_)
        if (auto* torsion = std::get_if<TorsionSpring>(&l.load))
            take_spring(*torsion);
        else if (is_gone(std::holds_alternative<Drag>(l.load) ? "drag"
                         : acting::turns(l.load)              ? "user torque"
                                                              : "user force"))
            l.load = acting::nothing_of(l.load);
    if (is_gone("drive") || is_gone("moving rail") || is_gone("dynamic friction") || is_gone("static friction"))
        for (Body& b : result.bodies_.change()) {
            if (b.rail() != nullptr)
                b.joint = without(*b.rail(), b.name, gone);
            else if (Revolute* hinge = std::get_if<Revolute>(&b.joint))
                hinge->friction = acting::without(hinge->friction, b.name, gone);
            else if (Prismatic* slide = std::get_if<Prismatic>(&b.joint))
                slide->friction = acting::without(slide->friction, b.name, gone);
        }
    for (Touch& c : result.contacts_) {
        c.is_gone = c.is_gone || is_gone("contact");
        if (c.is_gone) continue;
        if (is_gone("impact")) c.options.restitution = 0.0;
        c.options.friction = acting::without(c.options.friction, c.name, gone);
    }
    if (is_gone("rotation")) result.hold_attitudes();
    return result;
}

RBDYN_INLINE Rail Scene::without(const Rail& rail, const std::string& name, const std::vector<std::string>& gone) {
    const auto is_gone = [&](std::string_view effect) {
        return std::find(gone.begin(), gone.end(), effect) != gone.end();
    };
    return Rail(rail.curve(), acting::without(rail.friction(), name, gone),
                {.drive = is_gone("drive") ? TimeFunction() : rail.drive(),
                 .motion = is_gone("moving rail") ? RigidMotion() : rail.motion(),
                 .side = rail.side(),
                 .ends = rail.ends(),
                 .up = rail.up()});
}

/// Free bodies become particles at their centres of mass.
RBDYN_INLINE void Scene::hold_attitudes() {
    std::vector<bool> held;
    std::vector<Quaternion> attitudes;
    for (Body& b : bodies_.change()) {
        held.push_back(acting::turns(b));
        attitudes.push_back(b.attitude.quaternion());
        if (!held.back()) continue;
        if (!std::holds_alternative<Free>(b.joint))
            throw InvalidInput("without: rotation is all the motion that its joint leaves " + b.name +
                               "; only a free body moves without it");
        const Vector3 com = b.rigid()->com();
        b.position += to_world<double>(attitudes.back(), com);
        b.velocity += to_world<double>(attitudes.back(), Vector3(rounded(b.angular_velocity).cross(com)));
        b.body = Particle{b.mass()};
        b.attitude = {};
        b.angular_velocity = {};
        b.angular_velocity_world.reset();
    }
    for (AppliedLoad& l : loads_) {
        const auto body = static_cast<std::size_t>(l.body);
        if (!held[body]) continue;
        l.at.reset();
        if (std::holds_alternative<Torque>(l.load)) l.load = Force(Vector3::Zero());
        const Force* force = std::get_if<Force>(&l.load);
        if (force == nullptr || force->frame() == Frame::world) continue;
        if (!force->is_constant())
            throw InvalidInput("without: a force that varies in the axes of " + bodies()[body].name +
                               " is not known without its rotation; give it in world axes, or take it away too");
        l.load = Force(to_world<double>(attitudes[body], force->constant()));
    }
    for (Connection& c : connections_.change()) {
        for (End* end : {&c.a, &c.b})
            if (const int body = body_of(*end); body >= 0 && held[static_cast<std::size_t>(body)])
                *end = BodyHandle{body};
        if (c.a == c.b) c.coupling = couplings::nothing_of(c.coupling);
    }
    for (const Watch& w : watches_) require_observables(w.function, "without rotation, watch " + w.name);
    for (const Integral& i : integrals_) require_observables(i.function, "without rotation, integral " + i.name);
}

}  // namespace rbdyn::inline RBDYN_FORM
