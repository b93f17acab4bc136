// Definitions of rbdyn/mechanics/tree_model.hpp: bodies that come to rest on what they touch.
//
// A body is at rest on the surfaces it touches, the second sides of its contacts, if none of these slides, and neither
// it nor they turn or move against each other, with no acceleration either. It comes to rest where that begins: where
// its last contact sticks or lands, or stops rolling. At the limit of bounces that end `accumulation` says so.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/mechanics/acceleration_at.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/resting.hpp"
#include "rbdyn/mechanics/speed_rounding.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool TreeModel::is_at_rest(const Mode& mode, int body, double t, const mechanics::TreeState& state) const {
    // of accelerations, and of the speeds that forces make: what is held has those of velocities alone
    constexpr double rounding = 1e-11, slow = 1e-14;
    const double mass = static_cast<double>(tree_->node(body).mass);
    const auto moments = tree_->inertia_of<double>(body, state.moving[at(body)]);
    const auto inertia = [&](const Vector3& v) {
        Vector3 sum = Vector3::Zero();
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k) sum[j] += moments[at(j)][at(k)] * v[k];
        return sum;
    };
    bool touches = false;
    for (int k = 0; k < contacts(); ++k) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        if (mode.slip[at(k)] == flies || c.a.body != body) continue;
        touches = true;
        if (is_rough(k) && !mechanics::contact_state::is_held(mode.slip[at(k)])) return false;
        const auto touching = c.touching<double>(*tree_, state.moving);
        Vector3 turns = touching.turning, turn_rate = Vector3::Zero(), acceleration = Vector3::Zero();
        double quickest = 0.0, whirl = 0.0;  // of the accelerations that this is a difference of, and of what turns
        const auto take = [&](int i, const Vector3& arm, double sign) {
            if (i < 0) return;
            const Vector3 own = mechanics::acceleration_at(state, i, arm);
            turn_rate += sign * state.bodies[at(i)].angular_acceleration;
            acceleration += sign * own;
            quickest = std::max(quickest, own.norm());
            whirl = std::max(whirl, state.moving[at(i)].omega.norm());
        };
        take(touching.a, touching.arm_a, 1.0);
        take(touching.b, touching.arm_b, -1.0);
        // a particle does not turn, nor does a point of it
        if (tree_->node(body).is_point) turns = turn_rate = Vector3::Zero();
        const double size = size_of(k, state.moving),
                     force = state.bodies[at(body)].effort.force.norm() +
                             mass * mechanics::speed_rounding(speed_of(k, state.moving), size);
        // a difference of speeds is known, where surfaces are driven, as far as the time is, and what turns turns it
        const double drift = is_driven() ? 64.0 * epsilon * std::abs(t) * quickest : 0.0,
                     carried = 64.0 * epsilon * speed_of(k, state.moving) + drift,
                     kinetic = mass * touching.velocity.squaredNorm() + turns.dot(inertia(turns));
        if (mass * acceleration.norm() * size + inertia(turn_rate).norm() >
            (rounding * force + mass * whirl * drift) * size)
            return false;
        if (kinetic > slow * slow * force * size + mass * carried * carried) return false;
    }
    return touches;
}

RBDYN_INLINE bool TreeModel::is_driven() const {
    const auto moves = [](const mechanics::Node& n) {
        const mechanics::RailLaw* rail = n.joint.rail();
        return n.joint.as<mechanics::DrivenLaw>() != nullptr || (rail != nullptr && rail->motion.present());
    };
    const auto carries = [](const mechanics::RoughJoint& joint) { return !joint.drive.is_zero(); };
    return std::any_of(joints_.begin(), joints_.end(), carries) ||
           std::any_of(tree_->nodes().begin(), tree_->nodes().end(), moves);
}

RBDYN_INLINE void TreeModel::leave_standing(Mode& mode) const {
    if (contacts() > 0) mode.slip[place_of_standing()] = 0;
}

RBDYN_INLINE bool TreeModel::same_states(const Mode& a, const Mode& b) const {
    return std::equal(a.slip.begin(), a.slip.begin() + first_loose(), b.slip.begin(), b.slip.begin() + first_loose());
}

RBDYN_INLINE void TreeModel::come_to_stand(Mode& mode, double t, std::span<const double> x) const {
    if (mode.still || !is_balanced(mode, t, x)) return;
    const bool is_still = is_timeless(mode, t, x), has_none = holds_all(rows_in(mode));
    if (has_none) mode.still = is_still;
    if (has_none || !(is_still || is_held_in_time(mode, t, x))) return;
    Mode standing = mode;
    standing.slip[place_of_standing()] = 1;
    choose(standing, t, x, {}, true);
    if (standing.equations == nullptr) return;
    mode = std::move(standing);
    mode.still = mode.still || is_still;
}

RBDYN_INLINE void TreeModel::quiet(const Mode& mode, double t, std::span<double> x, std::span<double> rest) const {
    const std::vector<int> rows = rows_in(mode);
    if (rows.size() > rows_.size() && !is_driven()) set_to_rest(rows, t, x, rest);
}

RBDYN_INLINE void TreeModel::set_to_rest(const std::vector<int>& rows, double t, std::span<double> x,
                                         std::span<double> rest) const {
    const mechanics::resting::Reactions reactions(*tree_, *conditions_, rows, moving(t, x));
    for (int i = 0; i < bodies(); ++i)
        for (int k = 0; k < tree_->node(i).joint.velocities(); ++k) {
            const std::size_t place = at(tree_->positions() + tree_->node(i).v + k);
            const bool is_none = x[place] == 0.0 && (rest.empty() || rest[place] == 0.0);
            if (is_none || !reactions.determine(i, k)) continue;
            x[place] = 0.0;
            if (!rest.empty()) rest[place] = 0.0;
        }
}

RBDYN_INLINE bool TreeModel::is_balanced(const Mode& mode, double t, std::span<const double> x) const {
    if (contacts() == 0 || is_standing(mode) || mode.equations == nullptr || !mode.impossible.empty()) return false;
    if (std::any_of(x.begin() + tree_->positions(), x.end(), [](double rate) { return rate != 0.0; })) return false;
    std::vector<bool> touches(at(bodies()), false);
    for (int k = 0; k < contacts(); ++k)
        if (mode.slip[at(k)] != flies)
            for (const int i : {conditions_->contacts()[at(k)].a.body, conditions_->contacts()[at(k)].b.body})
                if (i >= 0) touches[at(i)] = true;
    // what nothing touches is none of this: how near it is to standing still is for its equations to say
    if (!std::all_of(touches.begin(), touches.end(), [](bool one) { return one; })) return false;
    // surfaces of bodies are as level as the places of what they stand on are rounded, also where an angle is near zero
    std::vector<double> known(x.size(), 0.0);
    const auto all = moving(t, x);
    for (int i = 0; i < bodies(); ++i) {
        const mechanics::Node& n = tree_->node(i);
        const int turns = n.joint.attitude();
        for (int k = 0; k < n.joint.positions(); ++k)
            if (turns >= 0 ? k >= turns
                           : at(k) < all[at(i)].joint.size() && all[at(i)].joint[at(k)].turn != Vector3::Zero())
                known[at(n.q + k)] = 1.0;
    }
    return has_no_rates(mode, t, x, known);
}

RBDYN_INLINE bool TreeModel::is_held_in_time(const Mode& mode, double t, std::span<const double> x) const {
    using mechanics::contact_state::slides;
    if (is_driven() || mode.equations->program.has_calls()) return false;
    // what friction pushes goes with what presses, and is told by its rates alone
    if (std::any_of(mode.slip.begin(), mode.slip.begin() + first_joint(), slides)) return false;
    for (std::size_t i = 0; i < joints_.size(); ++i)
        if (mechanics::joint_state::resists(mode.slip[at(first_joint()) + i])) return false;
    // what acts where everything is: sums of what changes in time, each along a constant direction
    const auto numbers = given().cells.empty() ? nullptr : std::make_shared<Numbers>(given());
    const Numbers::Active active(numbers.get());
    Recorder r;
    std::map<std::uint64_t, long> forced;
    for (const Branch& b : mode.equations->branches) forced[b.id] = b.choice;
    r.follow(t, x, {}, std::move(forced));
    const std::vector<Expression> here(x.begin(), x.end());
    const Expression* const rates = here.data() + tree_->positions();
    const mechanics::Acts acts =
        exerted_->all(*tree_, r.time(), tree_->moving<Expression>(r.time(), here.data(), rates), here.data(), rates);
    std::vector<Expression> all;
    for (const auto& w : acts.wrenches)
        for (const auto* v : {&w.force, &w.moment}) all.insert(all.end(), {(*v)[0], (*v)[1], (*v)[2]});
    all.insert(all.end(), acts.joints.begin(), acts.joints.end());
    std::map<std::int32_t, std::vector<double>> parts;
    for (std::size_t i = 0; i < all.size(); ++i)
        for (const auto& [node, factor] : mechanics::resting::linear_parts(r, all[i])) {
            auto& part = parts[node];
            part.resize(all.size(), 0.0);
            part[i] = factor;
        }
    const mechanics::resting::Reactions reactions(*tree_, *conditions_, rows_in(mode), moving(t, x));
    return std::all_of(parts.begin(), parts.end(), [&](const auto& one) { return reactions.hold(one.second); });
}

RBDYN_INLINE void TreeModel::tell_rest(const Mode& mode, std::span<const double> was, const Mode& after, double t,
                                       std::span<const double> x, std::vector<Happening>& happenings) const {
    namespace state = mechanics::contact_state;
    if (std::any_of(happenings.begin(), happenings.end(),
                    [](const Happening& h) { return h.kind == EventKind::accumulation; }))
        return;
    std::vector<int> candidates;
    const auto take = [&](int contact) {
        const int i = conditions_->contacts()[at(contact)].a.body;
        if (std::find(candidates.begin(), candidates.end(), i) == candidates.end()) candidates.push_back(i);
    };
    for (int k = 0; k < contacts(); ++k) {
        const signed char before = mode.slip[at(k)], now = after.slip[at(k)];
        if ((before == flies && now != flies) || (!state::is_held(before) && state::is_held(now))) take(k);
    }
    for (int e = 0; e < resistances(); ++e)
        if (state::slides(resisting(mode, e)) && state::is_held(resisting(after, e)))
            take(conditions_->resistances()[at(e)].contact);
    if (candidates.empty()) return;
    const mechanics::TreeState there = look(mode, t, was), here = look(after, t, x);
    for (const int i : candidates)
        if (is_at_rest(after, i, t, here) && !is_at_rest(mode, i, t, there))
            happenings.push_back({EventKind::rest, i, Direction::either, {}});
}

}  // namespace rbdyn::inline RBDYN_FORM
