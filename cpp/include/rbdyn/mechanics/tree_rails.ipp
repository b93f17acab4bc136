// Definitions of rbdyn/mechanics/tree_model.hpp and tree_writer.hpp: surfaces of rails that slide along themselves, and
// beads that leave their rails and come back.
//
// A tree is one of its modes: where a bead flies it hangs on nothing. Where it lands its velocity across the rail is
// lost, by an impulse between it and what its rail is on: the velocities after it are those of the bead on its rail
// that are nearest to the ones before, in the metric of the masses. Where joints or the rail are rough they resist it
// by impulses (tree_joint_strikes.ipp).
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/foot.hpp"
#include "rbdyn/mechanics/loose_rail.hpp"
#include "rbdyn/mechanics/rubbing.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/leading_sign.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE double TreeModel::surface_speed(const Mode& mode, int joint, double t, std::span<const double> x) const {
    const mechanics::RoughJoint& rough = joints_[at(joint)];
    if (rough.drive.is_constant() || mode.equations == nullptr || mode.equations->pulls < 0) return rough.drive(t);
    int place = mode.equations->pulls;
    for (int i = 0; i < joint; ++i) place += joints_[at(i)].drive.is_constant() ? 0 : 1;
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    return values.output(place);
}

RBDYN_INLINE double TreeModel::slip_of(const Mode& before, const Mode& mode, int joint, double t,
                                       std::span<const double> x) const {
    const mechanics::RoughJoint& rough = joints_[at(joint)];
    const double rate = x[at(tree_->positions() + rough.v)];
    if (!rough.rail) return rate;
    const double speed = rough.pace(moving(t, x)) * rate;
    if (rough.drive.is_zero()) return speed;
    const double now = surface_speed(mode, joint, t, x);
    // what is carried goes on as it did, but where its surface jumps
    if (before.slip[at(first_joint() + joint)] == mechanics::joint_state::held) {
        const double jump = now - surface_speed(before, joint, t, x);
        return std::abs(jump) <= 1e-10 * std::abs(now) ? 0.0 : -jump;
    }
    return std::abs(speed - now) <= 4.0 * epsilon * std::max(std::abs(speed), std::abs(now)) ? 0.0 : speed - now;
}

RBDYN_INLINE void TreeModel::carry(const Mode& mode, int joint, double t, std::span<double> x) const {
    const mechanics::RoughJoint& rough = joints_[at(joint)];
    double& rate = x[at(tree_->positions() + rough.v)];
    rate = rough.drive.is_zero() ? 0.0 : surface_speed(mode, joint, t, x) / rough.pace(moving(t, x));
}

RBDYN_INLINE bool TreeModel::surfaces_jump(const Mode& mode, const Mode& after, double t,
                                           std::span<const double> x) const {
    for (int i = 0; i < static_cast<int>(joints_.size()); ++i) {
        if (joints_[at(i)].drive.is_constant()) continue;
        const double was = surface_speed(mode, i, t, x), is = surface_speed(after, i, t, x);
        // what differs by the rounding of the time has a corner, no jump
        if (std::abs(is - was) > 1e-10 * std::max(std::abs(is), std::abs(was))) return true;
    }
    return false;
}

RBDYN_INLINE void TreeModel::take_loose_rails() {
    for (int i = 0; i < bodies(); ++i) {
        const mechanics::Node& n = tree_->node(i);
        const auto* law = n.joint.as<mechanics::LooseRailLaw>();
        if (law == nullptr) continue;
        const auto refuse = [&](const std::string& what) {
            throw InvalidInput(
                n.name + ": a rail that it may leave, beside " + what +
                ", is not there in this version; use side \"both\" and ends \"stop\", or leave them out");
        };
        if (contacts() > 0) refuse("contacts");
        if (!conditions_->all().empty()) refuse("constraints that close loops or hold points");
        mechanics::LooseRail rail{i, n.parent, *law->curve};
        for (int k = n.parent; k >= 0; k = tree_->node(k).parent)
            rail.is_still = rail.is_still && tree_->node(k).joint.as<mechanics::FixedLaw>() != nullptr;
        if (n.parent >= 0) rail.held = tree_->node(n.parent).joint.held().point;
        const Scene::Body& b = scene_.bodies()[at(i)];
        if (b.rail()->side() != RailSide::both) {
            rail.side = curves::one_side(*law->curve, b.parameter, b.rail()->up(), b.name);
            if (b.rail()->side() == RailSide::minus) rail.side->sign = -rail.side->sign;
            const int space = mechanics::LooseRailLaw::space;
            if (n.parent < 0)
                rail.landing = std::make_shared<const RailLanding>(*law->curve, *rail.side, Placement{}, n.q,
                                                                   n.q + space, tree_->positions() + n.v + space);
            else if (!rail.has_height())
                throw InvalidInput(n.name +
                                   ": where a bead comes back to a rail of a body that holds on one side is known of "
                                   "lines, circles and parabolas in this version; use one of them, or side \"both\"");
        }
        loose_.push_back(std::move(rail));
    }
    require(loose_.size() <= 6, "Scene", "number of rails that beads may leave", static_cast<double>(loose_.size()),
            "beside bodies that are joined there are at most 6 in this version");
    trees_.push_back(tree_);
    for (std::size_t which = 1; which < std::size_t{1} << loose_.size(); ++which) {
        std::vector<int> flying;
        for (std::size_t k = 0; k < loose_.size(); ++k)
            if ((which >> k & 1) != 0) flying.push_back(loose_[k].body);
        trees_.push_back(std::make_shared<const mechanics::Tree>(scene_, flying));
    }
}

RBDYN_INLINE const std::shared_ptr<const mechanics::Tree>& TreeModel::tree_in(const Mode& mode) const {
    if (loose_.empty() || mode.slip.empty()) return tree_;
    std::size_t which = 0;
    for (std::size_t k = 0; k < loose_.size(); ++k)
        if (mode.slip[at(first_loose()) + k] == flies) which |= std::size_t{1} << k;
    return trees_[which];
}

RBDYN_INLINE std::vector<mechanics::Moving<double>> TreeModel::moving(const Mode& mode, double t,
                                                                      std::span<const double> x) const {
    return tree_in(mode)->moving<double>(t, x.data(), x.data() + tree_->positions());
}

RBDYN_INLINE bool TreeModel::is_flying(const Mode& mode, int body) const {
    for (std::size_t k = 0; k < loose_.size(); ++k)
        if (loose_[k].body == body) return mode.slip[at(first_loose()) + k] == flies;
    return false;
}

RBDYN_INLINE void TreeModel::guard_loose(EquationsWriter& write, const mechanics::TreeWriter& tree,
                                         const Mode& mode) const {
    for (std::size_t k = 0; k < loose_.size(); ++k) {
        const mechanics::LooseRail& rail = loose_[k];
        if (!rail.side) continue;
        const std::string way = "height over its rail of " + name(rail.body);
        if (mode.slip[at(first_loose()) + k] != flies)
            write.decide(
                {.kind = EventKind::detach, .subject = rail.body, .name = "push of the rail of " + name(rail.body)},
                tree.pressing(rail));
        else if (rail.landing)
            write.outside({.kind = EventKind::land, .subject = rail.body, .name = way, .locator = rail.landing});
        else
            write.guard({.kind = EventKind::land, .subject = rail.body, .name = way}, tree.height(rail));
    }
}

RBDYN_INLINE void TreeModel::release(Mode& mode, std::size_t k, double t, std::span<double> x) const {
    const mechanics::Node& n = tree_->node(loose_[k].body);
    const auto all = moving(mode, t, x);
    const mechanics::Moving<double>& m = all[at(loose_[k].body)];
    constexpr int space = mechanics::LooseRailLaw::space;
    for (int i = 0; i < 3; ++i) {
        x[at(n.q + space + i)] = m.place[i];
        x[at(tree_->positions() + n.v + space + i)] = m.velocity[i];
    }
    x[at(tree_->positions() + n.v)] = 0.0;
    mode.slip[at(first_loose()) + k] = flies;
    for (std::size_t j = 0; j < joints_.size(); ++j)
        if (joints_[j].body == loose_[k].body) mode.slip[at(first_joint()) + j] = mechanics::joint_state::open;
}

RBDYN_INLINE double TreeModel::land(Mode& mode, std::size_t k, double t, std::span<double> x) const {
    const mechanics::LooseRail& rail = loose_[k];
    const mechanics::Node& n = tree_->node(rail.body);
    constexpr int space = mechanics::LooseRailLaw::space;
    const auto before = moving(mode, t, x);
    const mechanics::Moving<double>& bead = before[at(rail.body)];
    double& u = x[at(n.q)];
    if (rail.landing) {
        u = rail.landing->place(bead.place, u);
    } else {
        const mechanics::Moving<double>& on = before[at(rail.parent)];
        const Vector3 place = on.to_body(Vector3(bead.place - on.place)) + rounded(rail.held);
        const double period = rail.curve.closed() ? rail.curve.period() : 0.0, last = u;
        u = mechanics::Foot::nearest(rail.curve, place).front();
        if (period > 0.0) u += std::round((last - u) / period) * period;
    }
    double* const v = x.data() + tree_->positions();
    for (int i = 0; i < 3; ++i) v[n.v + space + i] = 0.0;
    mode.slip[at(first_loose()) + k] = 1;
    const mechanics::Tree& tree = *tree_in(mode);
    // as fast along the rail as it comes, and what that is short of its velocity goes to all that it hangs on
    v[n.v] = 0.0;
    const Vector3 along = moving(mode, t, x)[at(rail.body)].joint.front().move,
                  carried = moving(mode, t, x)[at(rail.body)].velocity;
    const double fast = along.dot(bead.velocity - carried),
                 rounding = 16.0 * epsilon * along.norm() * (bead.velocity.norm() + carried.norm());
    v[n.v] = std::abs(fast) > rounding ? fast / along.squaredNorm() : 0.0;
    if (rail.parent >= 0 && !rail.is_still) {
        const auto now = moving(mode, t, x);
        std::vector<Wrench<double>> left(at(bodies()));
        left[at(rail.body)].force = (now[at(rail.body)].velocity - bead.velocity) * static_cast<double>(n.mass);
        const auto accelerate = mechanics::accelerate<double>(tree, now);
        const std::vector<double> none(at(tree.velocities()), 0.0);
        const std::vector<double> changes =
            mechanics::velocity_changes<double>(tree, accelerate.spread(accelerate.driven(std::move(left), none)));
        for (int i = 0; i < tree.velocities(); ++i) v[i] += changes[at(i)];
    }
    if (!joints_.empty()) rub_landing(mode, t, x, before);
    return static_cast<double>(n.mass) * (bead.velocity - moving(mode, t, x)[at(rail.body)].velocity).norm();
}

RBDYN_INLINE bool TreeModel::misses(const Mode& mode, std::size_t k, double t, std::span<const double> x) const {
    const mechanics::LooseRail& rail = loose_[k];
    if (rail.landing) return false;
    const auto all = moving(mode, t, x);
    const Vector3 r = rail.own<double>(all[at(rail.body)].place, all[at(rail.parent)]);
    return std::abs(r[2]) > 1e-9 * (std::abs(r[0]) + std::abs(r[1]));
}

RBDYN_INLINE bool TreeModel::let_go(Mode& mode, double t, std::span<double> x,
                                    std::vector<Happening>* happenings) const {
    bool any = false;
    for (std::size_t k = 0; k < loose_.size(); ++k) {
        if (mode.slip[at(first_loose()) + k] == flies || mode.equations == nullptr) continue;
        for (const Guard& guard : mode.equations->guards) {
            const bool lets_go =
                guard.kind == EventKind::detach || (guard.kind == EventKind::rail_end && guard.role == GuardRole::mode);
            if (!lets_go || guard.contact >= 0 || guard.subject != loose_[k].body) continue;
            Evaluator<double> values(mode.equations->program);
            values.set_parameters(mode.parameters);
            values(t, x);
            const double g = values.output(guard.output);
            const bool is_zero = std::abs(g) <= 8.0 * epsilon * values.magnitude(guard.output);
            if (is_zero ? leading_sign(mode, t, x, guard.output) >= 0 : g > 0.0) continue;
            if (happenings != nullptr) happenings->push_back({guard.kind, guard.subject, Direction::falling, {}});
            release(mode, k, t, x);
            any = true;
            break;
        }
        if (any) break;
    }
    return any;
}

RBDYN_INLINE void TreeModel::settle_loose(const Mode& before, Mode& mode, double t, std::span<double> x,
                                          std::vector<Happening>* happenings) const {
    for (std::size_t turn = 0; turn <= loose_.size(); ++turn) {
        joints_.empty() ? choose(mode, t, x, {}, true) : settle_joints(before, mode, t, x, {});
        if (!mode.impossible.empty() || !let_go(mode, t, x, happenings)) return;
    }
}

RBDYN_INLINE void TreeModel::leave_or_land(const Mode& mode, Mode& after, std::span<const int> fired, double t,
                                           std::span<double> x, std::vector<Happening>& happenings) const {
    for (const int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        for (std::size_t k = 0; k < loose_.size(); ++k) {
            if (guard.subject != loose_[k].body || !loosens(guard)) continue;
            Happening h{guard.kind, guard.subject, Direction::falling, {}};
            if (guard.kind != EventKind::land) {
                release(after, k, t, x);
            } else if (misses(after, k, t, x)) {
                continue;
            } else {
                h.impulse = land(after, k, t, x);
                ++after.jumps;
            }
            happenings.push_back(std::move(h));
        }
    }
    settle_loose(mode, after, t, x, &happenings);
    if (after.impossible.empty()) tell_joints(mode, after, happenings);
}

RBDYN_INLINE void TreeModel::rub_landing(const Mode& mode, double t, std::span<double> x,
                                         const std::vector<mechanics::Moving<double>>& before) const {
    using tree_joints::Rubbing;
    const std::size_t n = joints_.size();
    const mechanics::Tree& tree = *tree_in(mode);
    const auto all = moving(mode, t, x);
    const auto accelerate = mechanics::accelerate<double>(tree, all);
    const std::vector<mechanics::Row<double>> none;
    const mechanics::FrictionResponse<double> response(tree, joints_, accelerate, t, all, none);
    Rubbing rubbing;
    std::vector<int> sign;
    for (std::size_t i = 0; i < n; ++i) {
        const mechanics::RoughJoint& joint = joints_[i];
        Vector3 pressed = Vector3::Zero();
        double size = 0.0;
        for (int body = joint.body; body < bodies(); ++body) {
            if (!response.carries(joint.body, body)) continue;
            const Vector3 arm = exactly<double>(tree.node(body).center);
            const auto velocity = [&](const mechanics::Moving<double>& m) {
                return Vector3(m.velocity_at(m.to_world(arm)));
            };
            const double mass = static_cast<double>(tree.node(body).mass);
            pressed += mass * (velocity(all[at(body)]) - velocity(before[at(body)]));
            size += mass * (velocity(all[at(body)]).norm() + velocity(before[at(body)]).norm());
        }
        const bool flies_on = is_flying(mode, joint.body);
        const double slip = flies_on ? 0.0 : joint.slip(t, all, x[at(tree_->positions() + joint.v)]);
        sign.push_back(flies_on ? Rubbing::gone : slip > 0.0 ? 1 : slip < 0.0 ? -1 : 0);
        rubbing.acceleration.push_back(slip);
        rubbing.load.push_back(response.across(i, pressed));
        rubbing.load_size.push_back(size);
        rubbing.noise.push_back(1e-14 * size * joint.radius);
        rubbing.alone.push_back(response.alone(i));
        rubbing.matrix.emplace_back();
        rubbing.by.emplace_back();
        for (std::size_t j = 0; j < n; ++j) {
            rubbing.matrix.back().push_back(response.acceleration(i, j));
            rubbing.by.back().push_back(response.load(i, j));
        }
    }
    Rubbing::Answer answer;
    const auto is_beyond = [&](std::size_t i) {
        return sign[i] == 0 && std::abs(answer.friction[i]) >
                                   joints_[i].mu_dynamic * joints_[i].radius * answer.pressing(i) + rubbing.noise[i];
    };
    const auto turns_back = [&](std::size_t i) {
        return (sign[i] == 1 || sign[i] == -1) && static_cast<double>(sign[i]) * answer.acceleration[i] < 0.0;
    };
    for (std::size_t turn = 0; turn <= 3 * n; ++turn) {
        answer = rubbing.solve(joints_, sign);
        std::size_t next = n;
        for (std::size_t i = 0; i < n && next == n; ++i)
            if (is_beyond(i) || turns_back(i)) next = i;
        if (next == n) break;
        sign[next] = sign[next] != 0 ? 0 : answer.friction[next] > 0.0 ? -1 : 1;
    }
    std::vector<double> u(at(tree.velocities()), 0.0);
    for (std::size_t i = 0; i < n; ++i)
        if (sign[i] != Rubbing::gone)
            for (std::size_t k = 0; k < u.size(); ++k) u[k] += response.driven(i)[k] * answer.friction[i];
    const std::vector<double> changes = mechanics::velocity_changes<double>(tree, accelerate.spread(u));
    for (int k = 0; k < tree.velocities(); ++k) x[at(tree_->positions() + k)] += changes[at(k)];
    for (std::size_t i = 0; i < n; ++i)
        if (sign[i] == 0) carry(mode, static_cast<int>(i), t, x);
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE Expression TreeWriter::pressing(const LooseRail& rail) const {
    const recording::WideFolding all_digits;
    const Moving<S> ground;
    const Vector3Of<S> n =
        rail.pushing<S>(moving_[at(rail.body)].joint.front().move, rail.parent < 0 ? ground : moving_[at(rail.parent)]);
    return dot<S>(n, reaction(rail.body).force);
}

RBDYN_INLINE Expression TreeWriter::height(const LooseRail& rail) const {
    const recording::WideFolding all_digits;
    return rail.height<S>(moving_[at(rail.body)].place, moving_[at(rail.parent)]);
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
