// Definitions of rbdyn/plan/planning.hpp.
#pragma once

#include "rbdyn/plan/planning.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/engine/closed_form.hpp"
#include "rbdyn/engine/cvode_factory.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/plan/integrals.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/effects.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/door.hpp"
#include "rbdyn/special/lone_body.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE void Simulated::take(const SceneModel& model) {
    for (int i = 0; i < model.bodies(); ++i) any_turns = any_turns || model.turns(i);
    if (!model.why_all().empty()) omissions.push_back({"no variable", model.why_all()});
}

RBDYN_INLINE void Simulated::take(const SceneModel& model, int body) {
    coordinates.push_back(model.name(body) + ": " + model.coordinates(body));
    for (Omission& o : model.left_out(body)) omissions.push_back(std::move(o));
}

RBDYN_INLINE std::string first_of(const std::vector<std::string>& names, std::size_t most, const std::string& between) {
    std::string text;
    const std::size_t shown = names.size() > most + 1 ? most : names.size();
    for (std::size_t i = 0; i < shown; ++i) text += (i == 0 ? "" : between) + names[i];
    return shown == names.size() ? text : text + between + std::to_string(names.size() - shown) + " more";
}

RBDYN_INLINE std::string names_of(const Scene& part) {
    std::vector<std::string> names;
    for (const Scene::Body& b : part.bodies()) names.push_back(b.name);
    return first_of(names, 3, " + ");
}

RBDYN_INLINE void plan_parts(const Scene& scene, SceneParts&& apart, bool any_rigid, const GivenNumbers& numbers,
                             Plan& plan, Simulated& simulated) {
    std::vector<std::string> names, engines;
    for (const SceneParts::Part& part : apart.parts) {
        const Plan& own = plan.parts.emplace_back(plan_of(part.scene, any_rigid, numbers));
        plan.not_unique.insert(plan.not_unique.end(), own.not_unique.begin(), own.not_unique.end());
        plan.guards.insert(plan.guards.end(), own.guards.begin(), own.guards.end());
        if (std::find(engines.begin(), engines.end(), own.engine) == engines.end()) engines.push_back(own.engine);
        names.push_back(names_of(part.scene) + " (" + own.engine + ")");
        simulated.take(*own.model);
    }
    for (std::size_t i = 0; i < scene.bodies().size(); ++i) {
        const auto& [part, index] = apart.bodies[i];
        simulated.take(*plan.parts[static_cast<std::size_t>(part)].model, index);
    }
    plan.engine = first_of(engines, engines.size(), ", ");
    plan.reason = std::to_string(names.size()) + " parts, solved apart: " + first_of(names, 6, ", ") +
                  "; a coupling between two of them would join those";
    plan.apart = std::make_shared<const SceneParts>(std::move(apart));
}

/// Said where there is one form after the other: series need no set-up where it changes.
constexpr const char* by_pieces =
    "its equations change from one formula to the next; engine=\"closed form\" takes one after the other";

RBDYN_INLINE std::string reason_of(const ClosedForm& form) {
    if (dynamic_cast<const FormsByMode*>(&form) != nullptr)
        return form.name() +
               ": exact until a guard changes its formula; from there on \"auto\" takes the whole by series";
    return form.name() + ": exact at every time, whatever the time";
}

RBDYN_INLINE Plan plan_of(const Scene& scene, bool beside_rigid, const GivenNumbers& numbers) {
    Plan plan;
    plan.effects = effects_of(scene);
    bool any_rail = false, is_rough = false, free = false;
    const auto leave_out = [&](const std::string& what, const std::string& why) {
        plan.omissions.push_back({what, why});
    };
    for (const Scene::Body& b : scene.bodies()) {
        const Rail* rail = b.rail();
        if (b.rigid() != nullptr) continue;
        if (rail == nullptr) {
            free = true;
            continue;
        }
        any_rail = true;
        if (!rail->drive().is_constant()) plan.functions.push_back("drive of " + b.name + " traced, native");
        if (rail->motion().present()) plan.functions.push_back("motion of the rail of " + b.name + " traced, native");
        if (rail->friction()) {
            is_rough = true;
        } else if (!rail->drive().is_zero()) {
            leave_out("drive of " + b.name, "a smooth rail cannot pull; give it friction");
        }
    }
    const auto take_joint_load = [&](const JointLoad& l, const std::string& what, const std::string& on) {
        if (!l.present()) leave_out(what + on, "it is zero");
        if (l.callback()) {
            plan.calls_back = true;
            plan.callbacks.push_back(l.callback());
            plan.functions.push_back(what + " \"" + l.name() + "\"" + on + " called back: " + l.callback()->reason);
        } else if (l.function()) {
            plan.functions.push_back(what + " \"" + l.name() + "\" traced, native," + on);
        }
    };
    for (const auto& load : scene.loads()) {
        const std::string on = " on " + scene.bodies()[static_cast<std::size_t>(load.body)].name;
        if (const Force* force = std::get_if<Force>(&load.load)) {
            if (!force->present()) leave_out("force" + on, "it is zero");
            if (force->is_constant()) continue;
            if (force->callback()) {
                plan.calls_back = true;
                plan.callbacks.push_back(force->callback());
                plan.functions.push_back("force \"" + force->name() + "\"" + on +
                                         " called back: " + force->callback()->reason);
            } else {
                plan.functions.push_back("force \"" + force->name() + "\" traced, native," + on);
            }
        } else if (const Potential* potential = std::get_if<Potential>(&load.load)) {
            if (!potential->present()) leave_out("potential" + on, "it does not vary with the position");
            plan.functions.push_back("potential \"" + potential->name() + "\" traced, native," + on);
        } else if (const Lorentz* lorentz = std::get_if<Lorentz>(&load.load)) {
            if (!lorentz->present()) leave_out("Lorentz force" + on, "its strength or its field is zero");
        } else if (const Drag* d = std::get_if<Drag>(&load.load)) {
            if (!d->present()) leave_out("drag", "both its coefficients are zero");
        } else if (const TorsionSpring* torsion = std::get_if<TorsionSpring>(&load.load)) {
            if (!torsion->present()) leave_out("torsion spring" + on, "its stiffness and damping are zero");
        } else if (acting::turns(load.load) && !std::holds_alternative<Torque>(load.load)) {
            take_joint_load(std::get<JointTorque>(load.load), "joint torque", on);
        } else if (const JointForce* joint_force = std::get_if<JointForce>(&load.load)) {
            take_joint_load(*joint_force, "joint force", on);
        } else if (const Torque* twist = std::get_if<Torque>(&load.load)) {
            if (!twist->present()) leave_out("torque" + on, "it is zero");
            if (twist->is_constant()) continue;
            if (twist->callback()) {
                plan.calls_back = true;
                plan.callbacks.push_back(twist->callback());
                plan.functions.push_back("torque \"" + twist->name() + "\"" + on +
                                         " called back: " + twist->callback()->reason);
            } else {
                plan.functions.push_back("torque \"" + twist->name() + "\" traced, native," + on);
            }
        }
    }
    for (const auto& watch : scene.watches()) {
        const bool recorded = watch.function.is_recorded();
        if (!recorded) plan.callbacks.push_back(watch.function.counter());
        plan.functions.push_back("watch \"" + watch.name + "\" " +
                                 (recorded
                                      ? "traced, native"
                                      : "called back, located but not certain: " + watch.function.counter()->reason));
    }
    for (const auto& c : scene.connections()) {
        if (const OwnFunction* own = own_function(c.coupling); own != nullptr && *own) {
            const std::string what = std::string(kind_of(c.coupling)) + " \"" + own->name() + "\"";
            if (own->callback()) {
                plan.calls_back = true;
                plan.callbacks.push_back(own->callback());
                plan.functions.push_back(what + " called back: " + own->callback()->reason);
            } else {
                plan.functions.push_back(what + " traced, native");
            }
        }
        if (is_present(c.coupling)) continue;
        const bool is_spring = std::holds_alternative<Spring>(c.coupling);
        leave_out("a " + std::string(kind_of(c.coupling)),
                  is_spring ? "its stiffness and damping are zero" : "it is zero");
    }
    const bool any_rigid = beside_rigid || std::any_of(scene.bodies().begin(), scene.bodies().end(),
                                                       [](const Scene::Body& b) { return b.rigid() != nullptr; });
    SceneParts apart(scene);
    if (!apart.joined_by.empty())
        leave_out("parts", "\"" + apart.joined_by + "\" is called back or changes the state, nobody knows of which " +
                               "bodies; all are solved together");
    plan.engine = plan.integrator = plan.calls_back ? "dop853" : "taylor";
    std::optional<LoneBody> only;
    Simulated simulated;
    if (apart.parts.empty()) {
        plan.view = view_of(scene);
        if (needs_tree(scene)) {
            plan.view = {};
            const auto tree = std::make_shared<const TreeModel>(scene, numbers);
            plan.not_unique = tree->not_unique();
            plan.model = tree;
        } else {
            plan.model = special_model(scene, plan.view, numbers);
        }
        simulated.take(*plan.model);
        for (int i = 0; i < plan.model->bodies(); ++i) simulated.take(*plan.model, i);
        plan.guards = plan.model->guards();
        only = lone_body(*plan.model);
        plan.reason = plan.calls_back
                          ? "a force that is called back has no Taylor series; events are located but not certain"
                          : "the equations are known, so their Taylor series are";
    } else {
        plan_parts(scene, std::move(apart), any_rigid, numbers, plan, simulated);
    }
    plan.coordinates = std::move(simulated.coordinates);
    if (!plan.has("gravity")) leave_out("gravity", "the scene has none; Scene(gravity=...) brings it in");
    if (!plan.has("rotation"))
        leave_out("rotation", free && !any_rail ? "particles have no attitude; a RigidBody brings it in"
                                                : "a bead is a point; a RigidBody brings it in");
    if (!simulated.any_turns) std::erase(plan.effects, "rotation");
    if (any_rail && !is_rough)
        leave_out("friction", "the rails are smooth: no modes, no guards; Coulomb(...) brings it in");
    plan.omissions.insert(plan.omissions.end(), simulated.omissions.begin(), simulated.omissions.end());
    if (plan.guards.empty()) leave_out("events", "nothing to watch for; scene.watch(...) brings them in");
    if (cvode::names().empty()) leave_out("cvode-adams, cvode-bdf", "this build of rbdyn is without SUNDIALS");
    const FirstIntegrals conserved = first_integrals(scene, only);
    plan.integrals = conserved.names;
    plan.pole = conserved.pole;
    plan.up = conserved.up;
    plan.axis = conserved.axis;
    for (const auto& integral : scene.integrals()) plan.integrals.push_back(integral.name);
    for (const Plan& part : plan.parts)
        for (const Omission& o : part.omissions)
            if (o.what == "closed form") leave_out(o.what, o.why);
    if (!plan.model) return plan;
    const auto [closed, why_not] = closed_form(scene, *plan.model, any_rigid);
    plan.closed = closed;
    if (is_one_form(closed)) {
        plan.engine = "closed form";
        plan.reason = reason_of(*closed);
    } else {
        leave_out("closed form", closed ? by_pieces : why_not);
    }
    return plan;
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
