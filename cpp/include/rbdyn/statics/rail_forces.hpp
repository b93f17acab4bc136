// The active forces on one bead at rest on a rail at rest, as functions of the rail's parameter.
//
// Notation: r(u) the rail's curve, r' = dr/du, F the active force at r(u) with velocity zero:
//     Q = F.r' = |r'| F_t                                                     (eq. 7.15, in the curve's own parameter)
//     hold = mu_s^2 |r' x F|^2 - Q^2, not negative where friction holds the bead   (eqs. 7.16, 7.25 at rest)
//     push = -b.(r' x F), not negative where a rail that only pushes does so
// Invariant: one bead in the scene; no force of it depends on time.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/plan/plan.hpp"

namespace rbdyn {

namespace statics {

/// Throws InvalidInput unless what acts on a body is the same at all times; `user` is who asks.
inline void require_timeless(const Scene& scene, int body, const std::string& user) {
    const std::string& name = scene.bodies()[static_cast<std::size_t>(body)].name;
    for (const Scene::AppliedLoad& load : scene.loads()) {
        const Force* force = std::get_if<Force>(&load.load);
        if (force == nullptr || load.body != body || force->is_constant()) continue;
        const std::string subject = user + ": force \"" + force->name() + "\" on " + name;
        if (force->callback())
            throw InvalidInput(subject + " is called back (" + force->callback()->reason +
                               "), so that nobody knows what it depends on; write it so that it can be recorded");
        if (force->depends_on_time())
            throw InvalidInput(subject + " depends on time; leave it out, or replace t by the time that is meant");
    }
    const Rail* rail = scene.bodies()[static_cast<std::size_t>(body)].rail();
    if (rail == nullptr) return;
    if (rail->motion().present())
        throw InvalidInput(user + ": the rail of " + name + " moves (motion); it must be at rest");
    if (rail->friction() && !rail->drive().is_zero())
        throw InvalidInput(user + ": the surface of the rail of " + name +
                           " moves (drive), and friction carries the bead along; it must be at rest");
}

/// A bead of a scene by itself, with the loads on it and the springs that hold it to the world. Throws InvalidInput if
/// it is no bead, or if a spring joins it with another body.
inline Scene alone(const Scene& scene, BodyHandle bead, const std::string& user) {
    require(
        bead.index >= 0 && bead.index < static_cast<int>(scene.bodies().size()), user, "body", bead.index,
        "a handle comes from add() of the same scene, which has " + std::to_string(scene.bodies().size()) + " bodies");
    const Scene::Body& body = scene.bodies()[static_cast<std::size_t>(bead.index)];
    if (body.rail() == nullptr)
        throw InvalidInput(user + ": " + body.name + " is free; this is about a bead on a rail");
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
            throw InvalidInput(user + ": a spring joins " + body.name + " with " +
                               scene.bodies()[static_cast<std::size_t>(other)].name +
                               "; the force on it does not depend on its own place alone");
        }
        result.connect(c.coupling, a >= 0 ? End(one) : c.a, b >= 0 ? End(one) : c.b);
    }
    return result;
}

/// Chooses the signs of a program's switches by the state x.
inline void set_signs(const Program& program, std::vector<double>& parameters, std::span<const double> x) {
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

/// The sum of the sizes of the forces on a body at rest: a force of its rounding is none [N].
inline double effort(const PointLaws& laws, int body, const std::vector<PointState<double>>& states) {
    const PointLaws::Body& b = laws.body(body);
    const PointState<double>& p = states[static_cast<std::size_t>(body)];
    const Vector3 r = laws.in_world<double>(p.r), zero = Vector3::Zero();
    double sum = b.force.norm();
    for (const auto& function : b.functions) sum += force_of<double>(function, 0.0, r, zero).norm();
    for (const auto& c : laws.springs()) {
        if (c.a.body != body && c.b.body != body) continue;
        const PointLaws::SpringEnd& other = c.a.body == body ? c.b : c.a;
        const Vector3 end = other.body >= 0 ? states[static_cast<std::size_t>(other.body)].r : other.point;
        sum += c.spring.stiffness * (p.r.norm() + end.norm() + c.spring.rest_length);
    }
    return sum;
}

}  // namespace statics

/// The forces on the only bead of a scene, along and across its rail.
class RailForces {
public:
    /// The outputs of its programs, in this order; hold on a rough rail, push on one that only pushes.
    enum Output { along = 0, hold = 1, push = 2 };

    /// One smooth formula of the forces: a program of u, and the case distinctions made for it.
    struct Formula {
        Program program;
        std::vector<double> parameters;  // signs of its switches
        int outputs = 0;                 // hold and push included where there are any
        int guards = 0;                  // outputs after those: not negative where its choices are right
        bool is_smooth = false;          // everywhere: it distinguishes nothing
    };

    explicit RailForces(const Scene& scene)
        : model_(std::make_shared<const PointsModel>(scene, planning::view_of(scene))), smooth_(formula(start())) {}

    const Curve& curve() const { return *body().curve; }
    double mass() const { return body().mass; }
    double start() const { return body().start_u; }
    bool rough() const { return body().rough; }
    bool one_sided() const { return body().side != RailSide::both; }
    const std::string& name() const { return body().name; }

    /// The formula that is right about u.
    Formula formula(double u) const {
        using S = Expression;
        Recorder r;
        r.follow(0.0, std::span<const double>(&u, 1), {});
        const S q = r.input(0), zero(0.0);
        const std::vector<PointState<S>> states{laws().moving<S>(body(), zero, &q, &zero, false)};
        const Resultant<S> f = laws().resultant<S>(0, zero, states, false, [](const S& w) { return w; });
        const CurvePoint<S>& c = states[0].curve;
        Formula result;
        std::vector<S> outputs{dot<S>(c.first, f.force)};
        const Vector3Of<S> across = cross<S>(c.first, f.force);
        if (rough() || one_sided())
            outputs.push_back(S(body().mu_static * body().mu_static) * dot<S>(across, across) -
                              outputs[0] * outputs[0]);
        if (one_sided()) outputs.push_back(-dot<S>(body().binormal, across));
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
    /// The formula at the bead's start.
    const Formula& first_formula() const { return smooth_; }

    /// Q at places, in doubles; an evaluation of its own, not to be shared by threads.
    class Values {
    public:
        explicit Values(const RailForces& forces) : forces_(&forces) {
            if (forces.smooth_.is_smooth) {
                quick_.emplace(forces.smooth_.program);
                quick_->set_parameters(forces.smooth_.parameters);
            }
        }
        double operator()(double u) {
            if (!quick_) return forces_->along_rail(u);
            (*quick_)(0.0, std::span<const double>(&u, 1));
            return quick_->output(along);
        }

    private:
        const RailForces* forces_;
        std::optional<Evaluator<double>> quick_;
    };

    /// Q, with every case distinction made at u.
    double along_rail(double u) const {
        const std::vector<PointState<double>> states{at_rest(u)};
        const auto f = laws().resultant<double>(0, 0.0, states, false, [](double w) { return w; });
        return dot<double>(states[0].curve.first, f.force);
    }
    /// |r'| times the sum of the sizes of the forces: Q of its rounding is none.
    double effort(double u) const {
        const std::vector<PointState<double>> states{at_rest(u)};
        return std::sqrt(states[0].curve.speed_squared) * statics::effort(laws(), 0, states);
    }
    /// What is not finite at u, in words.
    std::string not_finite(double u) const {
        Mode mode;
        mode.slip.assign(1, 1);
        std::vector<double> x = model_->start();
        for (double& value : x) value = 0.0;
        x[0] = u;
        const std::string what = model_->not_finite(mode, 0.0, x);
        return what.empty() ? "a derivative of the forces" : what;
    }

    const PointLaws& laws() const { return model_->laws(); }
    const PointLaws::Body& body() const { return laws().body(0); }

private:
    PointState<double> at_rest(double u) const {
        const double zero = 0.0;
        return laws().moving<double>(body(), 0.0, &u, &zero, false);
    }

    std::shared_ptr<const PointsModel> model_;
    Formula smooth_;
};

}  // namespace rbdyn
