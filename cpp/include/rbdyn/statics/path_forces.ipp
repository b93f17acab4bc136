// Definitions of rbdyn/statics/path_forces.hpp.
#pragma once

#include "rbdyn/statics/path_forces.hpp"

#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/particle.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/rounded.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/point_laws.hpp"
#include "rbdyn/model/point_state.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/model/points_now.hpp"
#include "rbdyn/model/rigid_law.hpp"
#include "rbdyn/model/rigid_loads.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/plan/planning.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE void require_timeless(const Scene& scene, int body, const std::string& user) {
    if (!scene.contacts().empty())
        throw InvalidInput(user + ": this scene has contacts (" + scene.contacts().front().name +
                           "), whose states of rest are not found; simulate it with damping until it rests");
    const std::string& name = scene.bodies()[static_cast<std::size_t>(body)].name;
    for (const Scene::AppliedLoad& load : scene.loads()) {
        if (load.body != body) continue;
        const auto check = [&](const auto* given, const char* kind) {
            if (given == nullptr || given->is_constant()) return;
            const std::string subject = user + ": " + kind + " \"" + given->name() + "\" on " + name;
            if (given->callback())
                throw InvalidInput(subject + " is called back (" + given->callback()->reason +
                                   "), so that nobody knows what it depends on; write it so that it can be recorded");
            if (given->function().depends_on(0))
                throw InvalidInput(subject + " depends on time; leave it out, or replace t by the time that is meant");
        };
        check(std::get_if<Force>(&load.load), "force");
        check(std::get_if<Torque>(&load.load), "torque");
        check(std::get_if<JointTorque>(&load.load), "joint torque");
        check(std::get_if<JointForce>(&load.load), "joint force");
    }
    for (const Scene::Connection& c : scene.connections()) {
        const OwnFunction* own = own_function(c.coupling);
        if (own == nullptr || !is_present(c.coupling) || (body_of(c.a) != body && body_of(c.b) != body)) continue;
        const std::string subject =
            user + ": " + std::string(kind_of(c.coupling)) + " \"" + own->name() + "\" on " + name;
        if (own->callback())
            throw InvalidInput(subject + " is called back (" + own->callback()->reason +
                               "), so that nobody knows how it changes; write it so that it can be recorded");
        if (const PairForce* pair = std::get_if<PairForce>(&c.coupling); pair != nullptr && pair->depends_on_time())
            throw InvalidInput(subject + " depends on time; leave it out, or replace t by the time that is meant");
    }
    const auto stands_still = [](const auto* of) { return of == nullptr || !of->motion || of->motion->is_constant(); };
    const Joint& joint = scene.bodies()[static_cast<std::size_t>(body)].joint;
    if (!stands_still(std::get_if<Revolute>(&joint)) || !stands_still(std::get_if<Prismatic>(&joint)))
        throw InvalidInput(user + ": the joint of " + name + " is driven (motion); it must be at rest");
    const auto is_rough = [](const auto* of) { return of != nullptr && of->friction && of->friction->present(); };
    if (is_rough(std::get_if<Revolute>(&joint)) || is_rough(std::get_if<Prismatic>(&joint)))
        throw InvalidInput(
            user + ": friction in the joint of " + name +
            " holds it in many places, which are not found; take it away with without(\"static friction\", "
            "\"dynamic friction\")");
    const Rail* rail = scene.bodies()[static_cast<std::size_t>(body)].rail();
    if (rail == nullptr) return;
    if (rail->friction() && needs_tree(scene))
        throw InvalidInput(user + ": friction on the rail of " + name +
                           " holds it in many places, which are not found beside bodies that are joined; take it away "
                           "with without(\"static friction\", \"dynamic friction\")");
    if (rail->motion().present())
        throw InvalidInput(user + ": the rail of " + name + " moves (motion); it must be at rest");
    if (rail->friction() && !rail->drive().is_zero())
        throw InvalidInput(user + ": the surface of the rail of " + name +
                           " moves (drive), and friction carries the bead along; it must be at rest");
}

RBDYN_INLINE Scene alone(const Scene& scene, BodyHandle bead, const std::string& user) {
    require(
        bead.index >= 0 && bead.index < static_cast<int>(scene.bodies().size()), user, "body", bead.index,
        "a handle comes from add() of the same scene, which has " + std::to_string(scene.bodies().size()) + " bodies");
    const Scene::Body& body = scene.bodies()[static_cast<std::size_t>(bead.index)];
    if (body.rail() == nullptr)
        throw InvalidInput(user + ": " + body.name + " is free; this is about a bead on a rail");
    if (body.parent >= 0)
        throw InvalidInput(user + ": the rail of " + body.name + " is fixed in " +
                           scene.bodies()[static_cast<std::size_t>(body.parent)].name +
                           ", which moves; it must be fixed in the world");
    for (const Scene::Held& held : scene.constraints())
        if (body_of(held.a) == bead.index || body_of(held.b) == bead.index)
            throw InvalidInput(user + ": the constraint " + held.name + " holds " + body.name +
                               "; this is about a bead that moves along its rail alone");
    Scene result(scene.gravity());
    const BodyHandle one =
        result.add(std::get<Particle>(body.body), *body.rail(), {.parameter = body.parameter}, body.name);
    for (const Scene::AppliedLoad& load : scene.loads())
        if (load.body == bead.index) result.apply(load.load, one);
    for (const Scene::Connection& c : scene.connections()) {
        const int a = body_of(c.a), b = body_of(c.b);
        if ((a != bead.index && b != bead.index) || !is_present(c.coupling)) continue;
        if (a >= 0 && b >= 0) {
            const int other = a == bead.index ? b : a;
            throw InvalidInput(user + ": a " + std::string(kind_of(c.coupling)) + " joins " + body.name + " with " +
                               scene.bodies()[static_cast<std::size_t>(other)].name +
                               "; the force on it does not depend on its own place alone");
        }
        result.connect(c.coupling, a >= 0 ? End(one) : c.a, b >= 0 ? End(one) : c.b);
    }
    return result;
}

RBDYN_INLINE void set_signs(const Program& program, std::vector<double>& parameters, std::span<const double> x) {
    if (parameters.empty()) {
        parameters.assign(static_cast<std::size_t>(program.parameters()), 0.0);
        for (const Switch& s : program.switches())
            if (!s.is_norm) parameters[static_cast<std::size_t>(s.parameter)] = 1.0;
    }
    if (program.switches().empty()) return;
    Evaluator<double> values(program);
    // the argument of a switch may contain others: no deeper than there are switches
    for (std::size_t depth = 0; depth < program.switches().size(); ++depth) {
        values.set_parameters(parameters);
        values(0.0, x);
        bool changed = false;
        for (std::size_t k = 0; k < program.switches().size(); ++k) {
            const Switch& s = program.switches()[k];
            if (s.is_norm) continue;
            double& sign = parameters[static_cast<std::size_t>(s.parameter)];
            const double now = values.switch_value(static_cast<int>(k)) < 0.0 ? -1.0 : 1.0;
            changed = changed || now != sign;
            sign = now;
        }
        if (!changed) break;
    }
}

RBDYN_INLINE void Effort::add(double size, const Vector3& point) {
    force += size;
    moment += size * point.norm();
}

RBDYN_INLINE Effort effort(const PointLaws& laws, int body, const CouplingForces<double>& couplings) {
    const std::vector<PointState<double>>& states = couplings.states();
    const PointLaws::Body& b = laws.body(body);
    const PointState<double>& p = states[static_cast<std::size_t>(body)];
    const Vector3 r = laws.in_world<double>(p.r), zero = Vector3::Zero();
    Effort sum;
    sum.add(rounded(b.force).norm(), b.rigid ? b.rigid->center : zero);
    // high powers far away, whose squares overflow
    for (const auto& function : b.functions) sum.force += force_of<double>(function, 0.0, r, zero).stableNorm();
    for (const RigidLoad& load : b.loads) {
        if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load)) {
            sum.moment += spring->stiffness * (std::abs(p.rigid->coordinate) + std::abs(spring->rest_angle));
            continue;
        }
        Wrench<double> w;
        add_load(w, *b.rigid, *p.rigid, load, 0.0, b.name);
        sum.add(w.force.norm(), rounded(load.point));
        if (std::holds_alternative<Torque>(load.load)) sum.moment += w.moment.norm();
    }
    for (const int k : b.couplings) {
        const PointLaws::Connected& c = laws.couplings()[static_cast<std::size_t>(k)];
        const bool is_spring = std::holds_alternative<Spring>(c.coupling);
        const double force = is_spring ? 0.0 : couplings[k].norm();
        const double size = force + effort_of(c.coupling, laws.ends<double>(c, 0.0, states), force);
        for (const PointLaws::CouplingEnd* end : {&c.a, &c.b})
            if (end->body == body) sum.add(size, end->is_on_rigid ? rounded(end->point_on_rigid) : zero);
    }
    return sum;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PathForces::PathForces(const Scene& scene)
    : model_(std::make_shared<const PointsModel>(scene, planning::view_of(scene))), smooth_(formula(start())) {}

RBDYN_INLINE double PathForces::period() const {
    if (body().curve) return curve().period();
    return is_on_hinge() && torsion().stiffness == 0.0 ? 2.0 * std::numbers::pi : 0.0;
}

RBDYN_INLINE TorsionSpring PathForces::torsion() const {
    TorsionSpring sum;
    for (const RigidLoad& load : body().loads)
        if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load); spring && spring->stiffness > 0) {
            const double k = sum.stiffness + spring->stiffness;
            sum.rest_angle = sum.rest_angle + (spring->rest_angle - sum.rest_angle) * spring->stiffness / k;
            sum.stiffness = k;
        }
    return sum;
}

RBDYN_INLINE PathForces::Formula PathForces::formula(double u) const {
    using S = Expression;
    Recorder r;
    r.follow(0.0, std::span<const double>(&u, 1), {});
    const S q = r.input(0), zero(0.0);
    const std::vector<PointState<S>> states{laws().moving<S>(body(), zero, &q, &zero, false)};
    Formula result;
    std::vector<S> outputs;
    if (body().rigid) {
        outputs.push_back(along_joint<S>(states));
    } else {
        const CouplingForces<S> couplings(laws(), zero, states);
        const Resultant<S> f = laws().resultant<S>(0, couplings, false, [](const S& w) { return w; });
        const CurvePoint<S>& c = states[0].curve;
        outputs.push_back(dot<S>(c.first, f.force));
        const Vector3Of<S> across = cross<S>(c.first, f.force);
        if (rough() || one_sided())
            outputs.push_back(S(body().mu_static * body().mu_static) * dot<S>(across, across) -
                              outputs[0] * outputs[0]);
        if (one_sided()) outputs.push_back(-dot<S>(body().binormal, across));
    }
    result.outputs = static_cast<int>(outputs.size());
    for (const Branch& b : r.branches()) {
        const S argument(&r, b.argument);
        if (b.has_lower()) outputs.push_back(argument - S(b.lower()));
        if (b.has_upper()) outputs.push_back(S(b.upper()) - argument);
    }
    result.guards = static_cast<int>(outputs.size()) - result.outputs;
    result.program = Program(r, outputs, 1);
    result.is_smooth = result.guards == 0 && result.program.switches().empty();
    statics::set_signs(result.program, result.parameters, std::span<const double>(&u, 1));
    return result;
}

RBDYN_INLINE PathForces::Values::Values(const PathForces& forces) : forces_(&forces) {
    if (forces.smooth_.is_smooth) {
        quick_.emplace(forces.smooth_.program);
        quick_->set_parameters(forces.smooth_.parameters);
    }
}

RBDYN_INLINE double PathForces::Values::operator()(double u) {
    if (!quick_) return forces_->along_path(u);
    (*quick_)(0.0, std::span<const double>(&u, 1));
    return quick_->output(along);
}

RBDYN_INLINE double PathForces::along_path(double u) const {
    const std::vector<PointState<double>> states{at_rest(u)};
    if (body().rigid) return along_joint<double>(states);
    const CouplingForces<double> couplings(laws(), 0.0, states);
    const auto f = laws().resultant<double>(0, couplings, false, [](double w) { return w; });
    return dot<double>(states[0].curve.first, f.force);
}

RBDYN_INLINE double PathForces::effort(double u) const {
    const std::vector<PointState<double>> states{at_rest(u)};
    const statics::Effort sum = statics::effort(laws(), 0, CouplingForces<double>(laws(), 0.0, states));
    if (body().rigid) return is_on_hinge() ? sum.moment : sum.force;
    return std::sqrt(states[0].curve.speed_squared) * sum.force;
}

RBDYN_INLINE std::string PathForces::not_finite(double u) const {
    Mode mode;
    mode.slip.assign(1, 1);
    std::vector<double> x = model_->start();
    for (double& value : x) value = 0.0;
    x[0] = u;
    const std::string what = model_->not_finite(mode, 0.0, x);
    return what.empty() ? "a derivative of the forces" : what;
}

RBDYN_INLINE PointState<double> PathForces::at_rest(double u) const {
    const double zero = 0.0;
    return laws().moving<double>(body(), 0.0, &u, &zero, false);
}

}  // namespace rbdyn::inline RBDYN_FORM
