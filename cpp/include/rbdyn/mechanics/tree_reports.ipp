// Definitions of rbdyn/mechanics/tree_model.hpp: what is known of bodies, joints, constraints and contacts at a state,
// and how bodies have turned.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_observables.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PointReport TreeModel::report(const Mode& mode, int body, double t, std::span<const double> x) const {
    PointReport r = look(mode, t, x).point(body);
    const mechanics::Node& n = tree_->node(body);
    if (is_flying(mode, body)) {
        // where it left its rail
        r.u = x[at(n.q)];
        r.speed = 0.0;
        r.reaction = Vector3::Zero();
    } else if (const mechanics::RailLaw* rail = n.joint.rail()) {
        const auto all = moving(mode, t, x);
        const CurvePoint<double> c = rail->curve->at<double>(x[at(n.q)], Placement{});
        const Vector3 along = all[at(body)].joint.front().move;
        r.u = x[at(n.q)];
        r.w = x[at(tree_->positions() + n.v)];
        r.speed = std::sqrt(c.speed_squared) * r.w;
        r.tangential_force = r.force.dot(along) / along.norm();
    }
    return r;
}

RBDYN_INLINE SystemReport TreeModel::system_report(const Mode& mode, double t, std::span<const double> x,
                                                   Asked asked) const {
    const mechanics::TreeState state =
        asked == Asked::forces ? look(mode, t, x) : mechanics::TreeState(*tree_in(mode), moving(mode, t, x));
    SystemReport all;
    for (int i = 0; i < bodies(); ++i) all.bodies.push_back(state.body_report(i, x));
    for (std::size_t k = 0; k < exerted_->couplings().size(); ++k) {
        const mechanics::Exerted::Coupled& c = exerted_->couplings()[k];
        CouplingReport report{c.a.body, c.b.body, tree_->point<double>(c.a, state.moving).place,
                              tree_->point<double>(c.b, state.moving).place};
        if (asked == Asked::forces) {
            report.force = state.couplings[k];
            // of what is applied a body report has the rest
            const auto take = [&](int body, const Vector3& place, const Vector3& force) {
                if (body < 0) return;
                BodyReport& b = all.bodies[at(body)];
                b.applied -= force;
                b.applied_moment -= (place - b.position).cross(force);
            };
            take(report.a, report.place_a, report.force);
            take(report.b, report.place_b, -report.force);
        }
        all.couplings.push_back(report);
    }
    return all;
}

RBDYN_INLINE RigidReport TreeModel::rigid_report(const Mode& mode, int body, double t,
                                                 std::span<const double> x) const {
    return look(mode, t, x).rigid(body, x);
}

RBDYN_INLINE JointReport TreeModel::joint(const Mode&, int body, double t, std::span<const double> x) const {
    const mechanics::Node& n = tree_->node(body);
    JointReport r;
    if (const mechanics::DrivenLaw* law = n.joint.as<mechanics::DrivenLaw>()) {
        r.coordinates = {law->way(t)};
        r.rates = {law->rate(t)};
        return r;
    }
    for (int k = 0; k < n.joint.positions(); ++k) r.coordinates.push_back(x[at(n.q + k)]);
    for (int k = 0; k < n.joint.velocities(); ++k) r.rates.push_back(x[at(tree_->positions() + n.v + k)]);
    return r;
}

RBDYN_INLINE ConstraintReport TreeModel::constraint(const Mode& mode, int index, double t,
                                                    std::span<const double> x) const {
    const mechanics::TreeState state = look(mode, t, x);
    if (!state.constraints.empty()) return state.constraints[at(index)];
    // of what has not begun
    ConstraintReport report;
    report.gap = conditions_->gap(*tree_, index, state.moving);
    return report;
}

RBDYN_INLINE ContactReport TreeModel::contact(const Mode& mode, int index, double t, std::span<const double> x) const {
    const mechanics::TreeState state = look(mode, t, x);
    ContactReport report;
    if (state.contacts.empty()) {
        const auto touching = conditions_->contacts()[at(index)].touching<double>(*tree_, state.moving);
        report.gap = touching.gap;
        report.slip = touching.slip();
        report.place = touching.place;
        report.normal = touching.normal;
        report.state = mechanics::contact_state::word(flies);
        return report;
    }
    report = state.contacts[at(index)];
    report.state = mechanics::contact_state::word(mode.slip[at(index)]);
    return report;
}

RBDYN_INLINE Vector3 TreeModel::coupling_force(const Mode& mode, int coupling, double t,
                                               std::span<const double> x) const {
    const mechanics::TreeState state = look(mode, t, x);
    return state.couplings.empty() ? Vector3::Zero().eval() : state.couplings[at(coupling)];
}

RBDYN_INLINE double TreeModel::power(const Mode& mode, const Scene::AppliedLoad&, int index, double t,
                                     std::span<const double> x) const {
    return look(mode, t, x).powers[at(index)];
}

RBDYN_INLINE double TreeModel::watched(const Mode& mode, int watch, double t, std::span<const double> x) const {
    if (mode.equations != nullptr)
        for (const Guard& guard : mode.equations->guards) {
            if (guard.watch != watch || guard.output < 0 || !guard.is_itself) continue;
            Evaluator<double> values(mode.equations->program);
            values.set_parameters(mode.parameters);
            values(t, x);
            return values.output(guard.output);
        }
    return called(scene_.watches()[at(watch)], mode, t, x);
}

RBDYN_INLINE double TreeModel::called(const Scene::Watch& watch, const Mode& mode, double t,
                                      std::span<const double> x) const {
    return watch.function(scene_.checked(observing(mode, t, x), "watch " + watch.name));
}

RBDYN_INLINE Observe TreeModel::observing(const Mode& mode, double t, std::span<const double> x) const {
    struct Present {
        std::vector<double> x;
        mechanics::TreeState state;
    };
    const auto now = std::make_shared<const Present>(Present{{x.begin(), x.end()}, look(mode, t, x)});
    return [this, now, t](const Observable& o) { return mechanics::observed(now->state, *exerted_, o, t, now->x); };
}

RBDYN_INLINE Turning TreeModel::turning(int body, double t, std::span<const double> x) const {
    const RigidReport r = mechanics::TreeState(*tree_, moving(t, x)).rigid(body, x);
    return {r.attitude, r.angular_velocity};
}

RBDYN_INLINE int TreeModel::place_of_angles(int body) const {
    int place = 0;
    for (int i = 0; i < body; ++i) place += has_angles(i);
    return has_angles(body) ? place : -1;
}

RBDYN_INLINE std::vector<double> TreeModel::winding(double t, std::span<const double> x) const {
    std::vector<double> all;
    for (int i = 0; i < bodies(); ++i) {
        if (!has_angles(i)) continue;
        const EulerAngles a = euler_path::begin(turning(i, t, x), scene_.bodies()[at(i)].attitude.given_angles());
        all.insert(all.end(), {a.theta, a.psi, a.phi});
    }
    return all;
}

RBDYN_INLINE void TreeModel::wind(const Piece& piece, double length, std::vector<double>& all) const {
    auto next = all.begin();
    for (int i = 0; i < bodies(); ++i) {
        if (!has_angles(i)) continue;
        const EulerAngles a = wound(i, piece, {next[0], next[1], next[2]}, length);
        for (const double angle : {a.theta, a.psi, a.phi}) *next++ = angle;
    }
}

RBDYN_INLINE EulerAngles TreeModel::wound(int body, const Piece& piece, const EulerAngles& before, double tau) const {
    std::vector<double> x(at(variables()));
    const double from = static_cast<double>(piece.start.hi);
    const auto motion = [&](double time) {
        piece.state(std::clamp(time / piece.unit, 0.0, tau), x);
        return turning(body, from + time, x);
    };
    const Turning first = motion(0.0);
    const double time = tau * piece.unit;
    const EulerStep last =
        euler_path::follow({0.0, first, continue_from(before, first.attitude)}, time, motion, [](const EulerStep&) {});
    return continue_from(last.angles, motion(time).attitude);
}

RBDYN_INLINE Vector3 TreeModel::center(const Mode& mode, int body, double t, std::span<const double> x) const {
    const auto all = moving(mode, t, x);
    return all[at(body)].place + all[at(body)].to_world(exactly<double>(tree_->node(body).center));
}

RBDYN_INLINE Vector3 TreeModel::position(const Mode& mode, int body, double t, std::span<const double> x) const {
    const auto all = moving(mode, t, x);
    const mechanics::Node& n = tree_->node(body);
    if (n.is_point) return all[at(body)].place;
    return all[at(body)].place - all[at(body)].to_world(exactly<double>(n.joint.held().point));
}

RBDYN_INLINE bool TreeModel::touches() const {
    const auto& all = conditions_->contacts();
    return std::any_of(all.begin(), all.end(), [](const mechanics::ContactLaw& c) { return !c.is_gone; });
}

RBDYN_INLINE Matrix3 TreeModel::rail_turn(int body, double t, std::span<const double> x) const {
    const mechanics::Node& n = tree_->node(body);
    Matrix3 turn = Matrix3::Identity();
    if (n.parent >= 0) {
        const auto all = moving(t, x);
        turn = columns(all[at(n.parent)].axes.e1, all[at(n.parent)].axes.e2, all[at(n.parent)].axes.e3);
    }
    const mechanics::RailLaw* rail = n.joint.rail();
    if (rail == nullptr || !rail->motion.present()) return turn;
    const auto column = [&](int i) { return rail->turned<double>(t, Vector3(Vector3::Unit(i))); };
    return turn * columns(column(0), column(1), column(2));
}

}  // namespace rbdyn::inline RBDYN_FORM
