// Definitions of rbdyn/statics/path_forces.hpp.
#pragma once

#include "rbdyn/statics/path_forces.hpp"

#include <algorithm>
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
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/statics/rest_forces.hpp"

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

}  // namespace rbdyn::inline RBDYN_FORM::statics

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PathForces::PathForces(const Scene& scene) : acting_(std::make_shared<const statics::RestForces>(scene)) {
    const mechanics::Tree& tree = acting_->tree();
    while (tree.node(mover_).joint.velocities() == 0) ++mover_;
    if (body().rail() != nullptr) rail_ = *body().rail();
    mass_ = body().mass();
    if (!rail_) {
        const auto all = mechanics::closing::moving<DoubleDouble>(tree, 0.0, tree.start(0.0));
        const auto moves = ways<DoubleDouble>(all);
        DoubleDouble sum = 0.0;
        for (int b = 0; b < tree.size(); ++b) {
            const mechanics::Node& n = tree.node(b);
            const auto& [turn, move] = moves[at(b)];
            const auto speed = Vector3Of<DoubleDouble>(move + cross<DoubleDouble>(turn, all[at(b)].to_world(n.center)));
            sum += n.mass * dot<DoubleDouble>(speed, speed);
            if (n.is_point) continue;
            const Vector3Of<DoubleDouble> turning = all[at(b)].to_body(turn);
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k) sum += turning[i] * n.body.inertia(i, k) * turning[k];
        }
        inertia_ = static_cast<double>(sum);
    }
    smooth_ = formula(start());
}

template <class N>
std::vector<mechanics::Twist<N>> PathForces::ways(const std::vector<mechanics::Moving<N>>& all) const {
    const mechanics::Tree& tree = acting_->tree();
    std::vector<mechanics::Twist<N>> result(at(tree.size()));
    result[at(mover_)] = all[at(mover_)].joint.front();
    for (int b = mover_ + 1; b < tree.size(); ++b) {
        const int parent = tree.node(b).parent;
        if (parent < 0) continue;
        const auto& [turn, move] = result[at(parent)];
        const auto arm = Vector3Of<N>(all[at(b)].place - all[at(parent)].place);
        result[at(b)] = {turn, Vector3Of<N>(move + cross<N>(turn, arm))};
    }
    return result;
}

RBDYN_INLINE double PathForces::period() const {
    if (rail_) return curve().period();
    return is_on_hinge() && torsion().stiffness == 0.0 ? 2.0 * std::numbers::pi : 0.0;
}

RBDYN_INLINE TorsionSpring PathForces::torsion() const {
    TorsionSpring sum;
    for (const Scene::AppliedLoad& load : scene().loads())
        if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load);
            spring && load.body == mover_ && spring->stiffness > 0) {
            const double k = sum.stiffness + spring->stiffness;
            sum.rest_angle = sum.rest_angle + (spring->rest_angle - sum.rest_angle) * spring->stiffness / k;
            sum.stiffness = k;
        }
    return sum;
}

RBDYN_INLINE bool PathForces::may_count_turns() const {
    return std::ranges::any_of(scene().loads(), [&](const Scene::AppliedLoad& load) {
        const JointTorque* torque = std::get_if<JointTorque>(&load.load);
        return torque != nullptr && load.body == mover_ && !torque->is_constant();
    });
}

RBDYN_INLINE PathForces::Formula PathForces::formula(double u) const {
    using S = Expression;
    Recorder r;
    r.follow(0.0, std::span<const double>(&u, 1), {});
    const statics::RestForces::Recorded at = acting_->recorded({r.input(0)});
    Formula result;
    std::vector<S> outputs = at.along;
    if (rough() || one_sided()) {
        const Vector3Of<S>& force = at.wrenches[0].force;
        const Vector3Of<S> across = cross<S>(at.all[0].joint.front().move, force);
        const double mu = static_friction();
        outputs.push_back(S(mu * mu) * dot<S>(across, across) - outputs[0] * outputs[0]);
        if (one_sided()) outputs.push_back(acting_->push<S>(acting_->one_sided()[0], at.all, force));
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
    if (!forces.smooth_.is_smooth) own_ = forces.smooth_;
    quick_.emplace(forces.smooth_.is_smooth ? forces.smooth_.program : own_.program);
    quick_->set_parameters(forces.smooth_.parameters);
}

RBDYN_INLINE void PathForces::Values::choose(double u) {
    const std::span<const double> place(&u, 1);
    // guards say what they do with the signs of the same place
    statics::set_signs(own_.program, own_.parameters, place);
    quick_->set_parameters(own_.parameters);
    bool is_right = true;
    if (own_.guards > 0) (*quick_)(0.0, place);
    for (int k = 0; k < own_.guards; ++k) is_right = is_right && quick_->output(own_.outputs + k) > 0.0;
    if (is_right) return;
    own_ = forces_->formula(u);
    quick_.emplace(own_.program);
    quick_->set_parameters(own_.parameters);
}

RBDYN_INLINE double PathForces::Values::operator()(double u) {
    if (!forces_->smooth_.is_smooth) choose(u);
    (*quick_)(0.0, std::span<const double>(&u, 1));
    return quick_->output(along);
}

RBDYN_INLINE double PathForces::along_path(double u) const { return Values(*this)(u); }

RBDYN_INLINE double PathForces::effort(double u) const {
    const statics::RestForces::Efforts efforts = acting_->efforts({u});
    const auto moves = ways<double>(efforts.all);
    double sum = efforts.joints[0];
    for (int b = mover_; b < acting_->tree().size(); ++b) sum += efforts.of(b, moves[at(b)]);
    return sum;
}

RBDYN_INLINE std::string PathForces::not_finite(double u) const {
    const std::string what = acting_->not_finite({u});
    return what.empty() ? "a derivative of the forces" : what;
}

}  // namespace rbdyn::inline RBDYN_FORM
