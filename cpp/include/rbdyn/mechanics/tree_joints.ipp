// Definitions of rbdyn/mechanics/tree_model.hpp: friction in joints.
//
// Which joints at rest are held is one problem with the friction of those that move: all are held at first, what is
// beyond its static limit breaks, the one beyond it most first, and slides with its dynamic coefficient against what
// held it. Joints that hold are rows of their own here, none of the constraints: their rates are exactly zero.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/joint/rail.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/rubbing.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/leading_sign.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE mechanics::JointMemory TreeModel::joint_memory(const Mode& mode, int joint) const {
    return mechanics::JointMemory::of(mode.memory.data() + place_of_joint(joint));
}

RBDYN_INLINE void TreeModel::settle_joints(const Mode& before, Mode& mode, double t, std::span<double> x,
                                           std::vector<int> breaking) const {
    for (std::size_t turn = 0; turn <= joints_.size(); ++turn) {
        decide_joints(before, mode, t, x, breaking);
        if (!mode.impossible.empty()) return;
        // at its limit it is held unless the next moment takes it beyond
        int leaves = -1;
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t, x);
        for (const Guard& guard : mode.equations->guards) {
            if (guard.kind != EventKind::slip || guard.joint < 0 || guard.contact >= 0 || guard.output < 0) continue;
            const double value = values.output(guard.output), size = values.magnitude(guard.output);
            if (!(value <= 1e-13 * size) || size == 0.0) continue;
            if (leading_sign(mode, t, x, guard.output, 1) < 0) leaves = guard.joint;
        }
        if (leaves < 0) return;
        breaking.push_back(leaves);
    }
}

RBDYN_INLINE void TreeModel::decide_joints(const Mode& before, Mode& mode, double t, std::span<double> x,
                                           const std::vector<int>& breaking) const {
    using namespace mechanics::joint_state;
    const std::size_t n = joints_.size();
    const auto first = mode.slip.begin() + first_joint();
    for (std::size_t i = 0; i < n; ++i) first[static_cast<std::ptrdiff_t>(i)] = open;
    choose(mode, t, x, {}, true);
    const mechanics::TreeState state = look(mode, t, x);
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    const auto accelerate = mechanics::accelerate<double>(*tree_in(mode), state.moving);
    const auto constraints = constraints_of(conditions_->rows<double>(*tree_, state.moving));
    const mechanics::FrictionResponse<double> response(*tree_in(mode), joints_, accelerate, t, state.moving,
                                                       constraints);
    // of what the values are of
    const auto accelerates = [&](std::size_t i, const std::vector<mechanics::Moving<double>>& all, double time,
                                 std::span<const double> y) {
        const mechanics::RoughJoint& joint = joints_[i];
        const double one = values.output(tree_->positions() + joint.v);
        if (!joint.rail) return one;
        return joint.pace(all) * one - joint.carried(time, y.data(), y[at(tree_->positions() + joint.v)], all);
    };
    using tree_joints::Rubbing;
    using Answer = Rubbing::Answer;
    Rubbing rubbing;
    for (std::size_t i = 0; i < n; ++i) {
        const mechanics::RoughJoint& joint = joints_[i];
        const mechanics::TreeState::Body& body = state.bodies[at(joint.body)];
        rubbing.acceleration.push_back(accelerates(i, state.moving, t, x));
        rubbing.load.push_back(response.across(i, body.reaction.force));
        rubbing.load_size.push_back(body.effort.force.norm());
        rubbing.noise.push_back(1e-14 * (joint.turns ? body.effort.moment.norm() : body.effort.force.norm()));
        rubbing.alone.push_back(response.alone(i));
        rubbing.matrix.emplace_back();
        rubbing.by.emplace_back();
        for (std::size_t j = 0; j < n; ++j) {
            rubbing.matrix.back().push_back(response.acceleration(i, j));
            rubbing.by.back().push_back(response.load(i, j));
        }
    }
    // what they come to within the rounding of the time is rounding, too
    std::vector<double> late_rate(n, 0.0);
    if (const double late = 8.0 * epsilon * std::abs(t); late > 0.0) {
        const std::vector<double> there =
            moved_on(x, late, [&](std::size_t i) { return values.output(static_cast<int>(i)); });
        const mechanics::TreeState later = look(mode, t + late, there);
        values(t + late, there);
        for (std::size_t i = 0; i < n; ++i) {
            const double change = std::abs(accelerates(i, later.moving, t + late, there) - rubbing.acceleration[i]),
                         by = rubbing.matrix[i][i];
            const auto load = response.across(i, later.bodies[at(joints_[i].body)].reaction.force);
            const double turn = std::hypot(load[0] - rubbing.load[i][0], load[1] - rubbing.load[i][1]);
            late_rate[i] = change * late;
            rubbing.noise[i] += joints_[i].mu_static * joints_[i].radius * turn + (by > 0.0 ? change / by : 0.0);
        }
    }
    std::vector<int> sign(n, 0);
    std::vector<std::size_t> resting;
    std::vector<double> slip;
    for (std::size_t i = 0; i < n; ++i) slip.push_back(slip_of(before, mode, static_cast<int>(i), t, x));
    for (std::size_t i = 0; i < n; ++i) {
        const double rate = slip[i];
        if (is_flying(mode, joints_[i].body)) {
            sign[i] = Rubbing::gone;
            continue;
        }
        sign[i] = rate > 0.0 ? 1 : rate < 0.0 ? -1 : 0;
        // what starts from rest has its sign from what it started with
        const signed char was = before.slip[at(first_joint()) + i];
        if (has(was, from_rest) && std::abs(rate) <= 2.0 * joint_memory(before, static_cast<int>(i)).least_rate &&
            rate != 0.0)
            sign[i] = mechanics::joint_state::sign(was);
        // where a loop moves on while the joint turns back, no torque in it could hold it
        if (sign[i] == 0 && !(rubbing.matrix[i][i] > 1e-12 * response.alone(i)))
            sign[i] = rubbing.acceleration[i] < 0.0 ? -1 : 1;
        if (sign[i] == 0) resting.push_back(i);
    }
    const auto is_breaking = [&](std::size_t i) {
        return std::find(breaking.begin(), breaking.end(), static_cast<int>(i)) != breaking.end();
    };
    const bool depends = rubbing.independent(resting).size() < resting.size();
    const auto holders = [&](const std::vector<int>& s) {
        std::vector<std::size_t> found;
        std::ranges::copy_if(resting, std::back_inserter(found), [&](std::size_t i) { return s[i] == 0; });
        return found;
    };
    const auto is_held_by_others = [&](const std::vector<int>& s, std::size_t i) {
        std::vector<std::size_t> with = holders(s);
        const std::size_t held_alone = rubbing.independent(with).size();
        with.push_back(i);
        return rubbing.independent(with).size() == held_alone;
    };
    const auto limit = [&](const Answer& a, std::size_t i) {
        return joints_[i].mu_static * joints_[i].radius * a.pressing(i);
    };
    // how far what rests is from the laws: beyond its limit, or sliding against its friction
    const auto amiss = [&](const Answer& a, const std::vector<int>& s, std::size_t i) {
        const bool is_wrong = depends && (s[i] == 0 ? is_breaking(i) : is_held_by_others(s, i));
        if (is_wrong) return std::numeric_limits<double>::infinity();
        if (s[i] == 0) return std::abs(a.friction[i]) - limit(a, i) - rubbing.noise[i];
        return -static_cast<double>(s[i]) * a.acceleration[i] - rubbing.noise[i] * rubbing.matrix[i][i];
    };
    Answer answer;
    // in a loop more joints may come to rest than it needs to be held: friction within all limits is one choice of many
    const auto is_rest = [&](const std::vector<int>& way) {
        answer = rubbing.solve(joints_, way);
        return answer.is_solved && std::ranges::all_of(resting, [&](std::size_t i) {
                   if (std::abs(way[i]) == Rubbing::stays) return true;
                   return way[i] == Rubbing::idle ? !is_breaking(i) : amiss(answer, way, i) <= 0.0;
               });
    };
    bool is_found = depends && rubbing.share(resting, sign, is_rest);
    if (!is_found) {
        answer = rubbing.solve(joints_, sign);
        for (const std::size_t i : resting)
            if (is_breaking(i)) sign[i] = answer.friction[i] > 0.0 ? -1 : 1;
        for (std::size_t turn = 0; turn <= 3 * n && !is_found; ++turn) {
            answer = rubbing.solve(joints_, sign);
            std::size_t worst = n;
            double most = 0.0;
            for (const std::size_t i : resting) {
                const double off = amiss(answer, sign, i);
                const double part = sign[i] == 0 ? off / (limit(answer, i) + rubbing.noise[i])
                                    : off > 0.0  ? 1e300
                                                 : 0.0;
                if (!(part > most)) continue;
                most = part;
                worst = i;
            }
            is_found = worst == n;
            if (worst == n) break;
            sign[worst] = sign[worst] != 0 ? 0 : answer.friction[worst] > 0.0 ? -1 : 1;
        }
    }
    // each way that what rests may go on
    for (std::size_t way = 0, ways = 1; !(is_found && answer.is_solved) && resting.size() <= 7; ++way) {
        if (way == 0)
            for (std::size_t i = 0; i < resting.size(); ++i) ways *= 3;
        if (way == ways) break;
        std::size_t rest = way;
        for (const std::size_t i : resting) {
            sign[i] = rest % 3 == 2 ? -1 : static_cast<int>(rest % 3);
            rest /= 3;
        }
        answer = rubbing.solve(joints_, sign);
        is_found =
            std::all_of(resting.begin(), resting.end(), [&](std::size_t i) { return amiss(answer, sign, i) <= 0.0; });
    }
    if (!is_found || !answer.is_solved) {
        std::string names;
        for (const mechanics::RoughJoint& joint : joints_) names += (names.empty() ? "" : ", ") + joint.name;
        mode.impossible = "no friction in the joints satisfies its law, of " + names;
        return;
    }
    // the same of what rests while others begin to move
    if (const auto held_now = holders(sign); rubbing.independent(held_now).size() < held_now.size())
        if (!rubbing.share(held_now, sign, is_rest)) {
            mode.impossible = "the joint of " + joints_[held_now.back()].name +
                              " comes to rest in a loop that others hold already, and friction that is not unique is "
                              "not found in this version";
            return;
        }
    const double length = size_of(state.moving);
    for (std::size_t i = 0; i < n; ++i) {
        const double rate = slip[i];
        if (sign[i] == Rubbing::gone) continue;
        if (sign[i] == 0 || sign[i] == Rubbing::idle) {
            first[static_cast<std::ptrdiff_t>(i)] = sign[i] == 0 ? held : idle;
            carry(mode, static_cast<int>(i), t, x);
            continue;
        }
        const bool begins = rate == 0.0 || std::find(resting.begin(), resting.end(), i) != resting.end() ||
                            has(before.slip[at(first_joint()) + i], from_rest);
        const double size = std::max(std::abs(rubbing.acceleration[i]), std::abs(answer.acceleration[i]));
        const signed char now = sliding_state(mode, static_cast<int>(i), t, x, sign[i], begins, rate, late_rate[i],
                                              size, length, answer.load[i], rubbing.load_size[i]);
        first[static_cast<std::ptrdiff_t>(i)] = now;
        if (std::abs(sign[i]) != Rubbing::stays) continue;
        first[static_cast<std::ptrdiff_t>(i)] = static_cast<signed char>((now & ~from_rest) | idle);
        carry(mode, static_cast<int>(i), t, x);
    }
    choose(mode, t, x, {}, true);
}

RBDYN_INLINE signed char TreeModel::sliding_state(Mode& mode, int joint, double t, std::span<const double> x, int sign,
                                                  bool begins, double rate, double late_rate, double acceleration,
                                                  double length, const std::array<double, 2>& load,
                                                  double load_size) const {
    using namespace mechanics::joint_state;
    mechanics::JointMemory memory = joint_memory(mode, joint);
    memory.least_rate =
        0x1p-43 * std::max({std::abs(rate), std::sqrt(acceleration * (joints_[at(joint)].turns ? 1.0 : length)),
                            std::abs(surface_speed(mode, joint, t, x)), mechanics::contact_state::least_speed});
    memory.least_rate = std::max(memory.least_rate, late_rate);
    memory.least_load = std::max(0x1p-43 * load_size, 1e-280);
    const double pressing = std::hypot(load[0], load[1]);
    signed char now = slides;
    if (sign < 0) now = static_cast<signed char>(now | backward);
    if (begins) now = static_cast<signed char>(now | from_rest);
    if (!(pressing > 2.0 * memory.least_load))
        now = static_cast<signed char>(now | unloaded);
    else if (memory.turns)
        now = static_cast<signed char>(now | veering);
    if (pressing > 0.0) memory.along = {load[0] / pressing, load[1] / pressing};
    memory.put(mode.memory.data() + place_of_joint(joint));
    return now;
}

RBDYN_INLINE bool TreeModel::joints_slip(const Mode& mode, double t, std::span<const double> x) const {
    if (joints_.empty()) return false;
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    for (const Guard& guard : mode.equations->guards)
        if (guard.joint >= 0 && guard.output >= 0 && guard.kind == EventKind::slip &&
            values.output(guard.output) < -1e-13 * values.magnitude(guard.output))
            return true;
    return false;
}

RBDYN_INLINE bool TreeModel::heed_joints(const Mode& mode, Mode& after, std::span<const int> fired, double t,
                                         std::span<double> x, Fired& events, std::vector<Happening>& happenings) const {
    using namespace mechanics::joint_state;
    bool changes = fired.empty();
    for (const int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        if (guard.joint < 0 || guard.contact >= 0) continue;
        signed char& state = after.slip[at(first_joint() + guard.joint)];
        mechanics::JointMemory memory = joint_memory(after, guard.joint);
        switch (guard.kind) {
            case EventKind::slip:
                events.rubbed_breaking.push_back(guard.joint);
                changes = true;
                break;
            case EventKind::stick:
                carry(mode, guard.joint, t, x);
                events.rubbed_stopping.push_back(guard.joint);
                changes = true;
                break;
            case EventKind::singular:
                after.impossible = "the friction in the joint of " + joints_[at(guard.joint)].name +
                                   " grows with the load that it makes itself faster than that holds it back; a "
                                   "smaller coefficient or pin has a motion";
                if (joints_[at(guard.joint)].rail)
                    after.impossible = "the friction on the rail of " + joints_[at(guard.joint)].name +
                                       " grows with the load that it makes itself faster than that holds it back; a "
                                       "smaller coefficient has a motion";
                return true;
            case EventKind::normal_zero:
                // what presses until then is along n or against it
                happenings.push_back({EventKind::normal_zero,
                                      guard.subject,
                                      joints_[at(guard.joint)].side(memory.along, t, moving(mode, t, x)) < 0
                                          ? Direction::rising
                                          : Direction::falling,
                                      {}});
                for (double& part : memory.along) part = -part;
                break;
            default:
                if (guard.name.starts_with("start")) {
                    state = static_cast<signed char>(state & ~from_rest);
                } else if (has(state, unloaded)) {
                    changes = true;
                } else if (guard.name.starts_with("direction")) {
                    const std::vector<double> said = said_of_joints(mode, t, x);
                    const double* const one = said.data() + mechanics::JointMemory::said * at(guard.joint);
                    const double size = std::hypot(one[1], one[2]);
                    memory.along = {one[1] / size, one[2] / size};
                } else if (!has(state, veering)) {
                    memory.turns = true;
                    state = static_cast<signed char>(state | veering);
                } else {
                    state = static_cast<signed char>((state & ~veering) | unloaded);
                }
        }
        memory.put(after.memory.data() + place_of_joint(guard.joint));
    }
    // what stops together does so within the rounding of its rates, and of the time
    const bool stops = std::ranges::any_of(
        fired, [&](int index) { return mode.equations->guards[at(index)].kind == EventKind::stick; });
    if (!stops || joints_.empty()) return changes;
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    const auto all = moving(mode, t, x);
    std::vector<int> others;
    for (int i = 0; i < static_cast<int>(joints_.size()); ++i) {
        const signed char state = mode.slip[at(first_joint() + i)];
        if (!is_sliding(state) || has(state, from_rest)) continue;
        const double late =
            8.0 * epsilon *
            std::abs(t * joints_[at(i)].pace(all) * values.output(tree_->positions() + joints_[at(i)].v));
        const double slip = std::abs(slip_of(mode, mode, i, t, x));
        if (slip > 0.0 && slip <= std::max(16.0 * joint_memory(mode, i).least_rate, late)) others.push_back(i);
    }
    for (const int i : others) carry(mode, i, t, x);
    events.rubbed_stopping.insert(events.rubbed_stopping.end(), others.begin(), others.end());
    return changes || !others.empty();
}

RBDYN_INLINE void TreeModel::rub(const Mode& mode, Mode& after, std::span<const int> fired, double t,
                                 std::span<double> x, std::vector<Happening>& happenings) const {
    Fired events;
    const bool changes = heed_joints(mode, after, fired, t, x, events, happenings);
    if (!after.impossible.empty()) return;
    changes ? settle_joints(mode, after, t, x, events.rubbed_breaking) : choose(after, t, x, {});
    if (after.impossible.empty()) tell_joints(mode, after, happenings);
}

RBDYN_INLINE void TreeModel::tell_joints(const Mode& mode, const Mode& after,
                                         std::vector<Happening>& happenings) const {
    using namespace mechanics::joint_state;
    for (int i = 0; i < static_cast<int>(joints_.size()); ++i) {
        const signed char was = mode.slip[at(first_joint() + i)], is = after.slip[at(first_joint() + i)];
        // what leaves its rail, or comes back to it, tells of that
        if (was == open || is == open) continue;
        const int from = sign(was), to = sign(is);
        const Direction direction = (to != 0 ? to : -from) > 0 ? Direction::rising : Direction::falling;
        const int body = joints_[at(i)].body;
        if (from != 0 && to == 0) happenings.push_back({EventKind::stick, body, direction, {}});
        if (from == 0 && to != 0) happenings.push_back({EventKind::slip, body, direction, {}});
        if (from * to < 0) happenings.push_back({EventKind::reverse, body, direction, {}});
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
