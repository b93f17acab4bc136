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
#include <span>
#include <string>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/joint/rail.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/leading_sign.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace tree_joints {

using mechanics::RoughJoint, mechanics::JointMemory;
namespace joint_state = mechanics::joint_state;

/// Friction in all rough joints of a tree at an instant, from what they do.
struct Rubbing {
    std::vector<double> acceleration;         // of each joint without friction
    std::vector<std::array<double, 2>> load;  // what presses it then
    std::vector<double> noise, load_size;     // sizes of rounding of friction, sizes of what loads are made of
    mechanics::Square matrix;                 // accelerations by units of friction
    std::vector<double> alone;                // of each by its own, if nothing closed the tree
    std::vector<std::vector<std::array<double, 2>>> by;

    static constexpr int gone = 2;  // in place of a sign: its bead flies

    struct Answer {
        std::vector<double> friction, acceleration;
        std::vector<std::array<double, 2>> load;
        bool is_solved = false;
        double pressing(std::size_t i) const { return std::hypot(load[i][0], load[i][1]); }
    };
    /// `sign`: of the rate of each, zero where it is held.
    Answer solve(const std::vector<RoughJoint>& joints, const std::vector<int>& sign) const {
        const std::size_t n = joints.size();
        Answer answer{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0), load, false};
        std::vector<std::array<double, 2>> along(n);
        // friction in units in which rows of what is held and of what slides are of one size, whatever those of a scene
        std::vector<double> unit;
        for (std::size_t i = 0; i < n; ++i)
            unit.push_back(alone[i] > 0.0 ? std::ldexp(1.0, -(std::ilogb(alone[i]) / 2)) : 1.0);
        for (int pass = 0; pass < 60 && !answer.is_solved; ++pass) {
            double turned = 0.0;
            for (std::size_t i = 0; i < n; ++i) {
                const double size = answer.pressing(i);
                const std::array<double, 2> now =
                    size > 0.0 ? std::array<double, 2>{answer.load[i][0] / size, answer.load[i][1] / size}
                               : std::array<double, 2>{0.0, 0.0};
                turned = std::max(turned, std::hypot(now[0] - along[i][0], now[1] - along[i][1]));
                along[i] = now;
            }
            answer.is_solved = pass > 0 && turned < 1e-13;
            mechanics::Square m(n, std::vector<double>(n, 0.0));
            std::vector<double> b(n);
            for (std::size_t i = 0; i < n; ++i) {
                // what has no joint has no friction
                const double k =
                    sign[i] == gone ? 0.0 : static_cast<double>(sign[i]) * joints[i].mu_dynamic * joints[i].radius;
                const double row = sign[i] == 0 ? unit[i] : 1.0 / unit[i];
                b[i] = sign[i] == 0 ? -row * acceleration[i]
                                    : -row * k * (along[i][0] * load[i][0] + along[i][1] * load[i][1]);
                for (std::size_t j = 0; j < n; ++j) {
                    m[i][j] = sign[i] == 0
                                  ? matrix[i][j]
                                  : (i == j ? 1.0 : 0.0) + k * (along[i][0] * by[i][j][0] + along[i][1] * by[i][j][1]);
                    m[i][j] *= row * unit[j];
                }
            }
            answer.friction = mechanics::solve_any(m, b);
            for (std::size_t i = 0; i < n; ++i) answer.friction[i] *= unit[i];
            for (std::size_t i = 0; i < n; ++i) {
                answer.load[i] = load[i];
                answer.acceleration[i] = acceleration[i];
                for (std::size_t j = 0; j < n; ++j) {
                    answer.acceleration[i] += matrix[i][j] * answer.friction[j];
                    for (std::size_t k = 0; k < 2; ++k) answer.load[i][k] += by[i][j][k] * answer.friction[j];
                }
            }
        }
        // what moves is not pushed on by its friction
        for (std::size_t i = 0; i < n; ++i)
            if (sign[i] != 0 && static_cast<double>(sign[i]) * answer.friction[i] > noise[i]) answer.is_solved = false;
        return answer;
    }
};

}  // namespace tree_joints

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
    tree_joints::Rubbing rubbing;
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
            sign[i] = tree_joints::Rubbing::gone;
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
    using Answer = tree_joints::Rubbing::Answer;
    const auto limit = [&](const Answer& a, std::size_t i) {
        return joints_[i].mu_static * joints_[i].radius * a.pressing(i);
    };
    // how far what rests is from the laws: beyond its limit, or sliding against its friction
    const auto amiss = [&](const Answer& a, const std::vector<int>& s, std::size_t i) {
        if (s[i] == 0) return std::abs(a.friction[i]) - limit(a, i) - rubbing.noise[i];
        return -static_cast<double>(s[i]) * a.acceleration[i] - rubbing.noise[i] * rubbing.matrix[i][i];
    };
    Answer answer = rubbing.solve(joints_, sign);
    bool is_found = false;
    for (const std::size_t i : resting)
        if (is_breaking(i)) sign[i] = answer.friction[i] > 0.0 ? -1 : 1;
    for (std::size_t turn = 0; turn <= 3 * n && !is_found; ++turn) {
        answer = rubbing.solve(joints_, sign);
        std::size_t worst = n;
        double most = 0.0;
        for (const std::size_t i : resting) {
            const double off = amiss(answer, sign, i);
            const double part = sign[i] == 0 ? off / (limit(answer, i) + rubbing.noise[i]) : off > 0.0 ? 1e300 : 0.0;
            if (!(part > most)) continue;
            most = part;
            worst = i;
        }
        is_found = worst == n;
        if (worst == n) break;
        sign[worst] = sign[worst] != 0 ? 0 : answer.friction[worst] > 0.0 ? -1 : 1;
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
    // in a loop what is held by more joints than it needs has friction that is not unique
    mechanics::Square held_by;
    std::vector<std::size_t> holding;
    for (std::size_t i = 0; i < n; ++i)
        if (sign[i] == 0) holding.push_back(i);
    for (const std::size_t i : holding) {
        held_by.emplace_back();
        for (const std::size_t j : holding) held_by.back().push_back(rubbing.matrix[i][j]);
    }
    for (std::size_t k = 0; k < holding.size(); ++k) {
        if (held_by[k][k] > 1e-10 * rubbing.matrix[holding[k]][holding[k]]) {
            for (std::size_t i = k + 1; i < holding.size(); ++i)
                for (std::size_t j = k + 1; j < holding.size(); ++j)
                    held_by[i][j] -= held_by[i][k] * held_by[k][j] / held_by[k][k];
            continue;
        }
        mode.impossible = "the joint of " + joints_[holding[k]].name +
                          " comes to rest in a loop that others hold already, and friction that is not unique is "
                          "not found in this version";
        return;
    }
    const double length = size_of(state.moving);
    for (std::size_t i = 0; i < n; ++i) {
        const double rate = slip[i];
        if (sign[i] == tree_joints::Rubbing::gone) continue;
        if (sign[i] == 0) {
            first[static_cast<std::ptrdiff_t>(i)] = held;
            carry(mode, static_cast<int>(i), t, x);
            continue;
        }
        const bool begins = rate == 0.0 || std::find(resting.begin(), resting.end(), i) != resting.end() ||
                            has(before.slip[at(first_joint()) + i], from_rest);
        const double size = std::max(std::abs(rubbing.acceleration[i]), std::abs(answer.acceleration[i]));
        const signed char now = sliding_state(mode, static_cast<int>(i), t, x, sign[i], begins, rate, late_rate[i],
                                              size, length, answer.load[i], rubbing.load_size[i]);
        first[static_cast<std::ptrdiff_t>(i)] = now;
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

RBDYN_INLINE bool TreeModel::heed_joints(const Mode& mode, Mode& after, std::span<const int> fired, double t,
                                         std::span<double> x, std::vector<int>& breaking,
                                         std::vector<Happening>& happenings) const {
    using namespace mechanics::joint_state;
    bool changes = fired.empty();
    for (const int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        if (guard.joint < 0 || guard.contact >= 0) continue;
        signed char& state = after.slip[at(first_joint() + guard.joint)];
        mechanics::JointMemory memory = joint_memory(after, guard.joint);
        switch (guard.kind) {
            case EventKind::slip:
                breaking.push_back(guard.joint);
                changes = true;
                break;
            case EventKind::stick:
                carry(mode, guard.joint, t, x);
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
                } else if (!has(state, veering)) {
                    memory.turns = true;
                    state = static_cast<signed char>(state | veering);
                } else {
                    state = static_cast<signed char>((state & ~veering) | unloaded);
                }
        }
        memory.put(after.memory.data() + place_of_joint(guard.joint));
    }
    return changes;
}

RBDYN_INLINE void TreeModel::rub(const Mode& mode, Mode& after, std::span<const int> fired, double t,
                                 std::span<double> x, std::vector<Happening>& happenings) const {
    std::vector<int> breaking;
    const bool changes = heed_joints(mode, after, fired, t, x, breaking, happenings);
    if (!after.impossible.empty()) return;
    changes ? settle_joints(mode, after, t, x, breaking) : choose(after, t, x, {});
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
