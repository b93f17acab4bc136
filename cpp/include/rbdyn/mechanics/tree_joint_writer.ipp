// Definitions of rbdyn/mechanics/joint_friction.hpp and tree_writer.hpp: friction in joints in a tree's equations.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/curve/axes.hpp"
#include "rbdyn/expression/phases.hpp"
#include "rbdyn/mechanics/foot.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/joint/rail.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace tree_joints {

/// Whether what a body is joined to moves by itself alone and it carries nothing: its own friction changes none of what
/// presses it, nor does that of others.
inline bool is_alone(const Scene& scene, const Tree& tree, int body) {
    if (!scene.constraints().empty() || !scene.contacts().empty()) return false;
    for (int i = tree.node(body).parent; i >= 0; i = tree.node(i).parent)
        if (tree.node(i).joint.velocities() > 0) return false;
    return std::none_of(tree.nodes().begin(), tree.nodes().end(), [&](const Node& n) { return n.parent == body; });
}

}  // namespace tree_joints

RBDYN_INLINE int RoughJoint::side(const std::array<double, 2>& along, double t,
                                  const std::vector<Moving<double>>& all) const {
    // the two directions across and the axis are right-handed
    if (turns) return 1;
    if (rail && !rail->curve->straight()) return along[0] < 0.0 ? -1 : 1;
    const auto [first, second] = across<double>(t, all);
    Vector3 b = second * along[0] - first * along[1];
    if (parent >= 0) b = all[static_cast<std::size_t>(parent)].to_body(b);
    constexpr double rounding = 1e-6;
    for (const int k : {2, 1, 0})
        if (std::abs(b[k]) > rounding) return b[k] < 0.0 ? -1 : 1;
    return 1;
}

RBDYN_INLINE std::vector<RoughJoint> rough_joints(const Scene& scene, const Tree& tree) {
    std::vector<RoughJoint> result;
    for (int i = 0; i < tree.size(); ++i) {
        const Joint& joint = scene.bodies()[static_cast<std::size_t>(i)].joint;
        const Rail* rail = std::get_if<Rail>(&joint);
        const auto friction = rail != nullptr ? friction_on(*rail) : friction_in(joint);
        if (!friction) continue;
        const Node& n = tree.node(i);
        RoughJoint one{n.name, i, n.parent, n.q, n.v};
        one.mu_static = friction->mu_static;
        one.mu_dynamic = friction->mu_dynamic.value_or(friction->mu_static);
        if (rail != nullptr) {
            one.rail = *n.joint.rail();
            one.drive = with_small_phases(rail->drive());
            const Curve& curve = *one.rail->curve;
            one.across_in[0] =
                curves::turned<DoubleDouble>(curve.placement().exact_axes(), widened(Foot::direction_aside(curve)));
            one.is_alone = tree_joints::is_alone(scene, tree, i);
            result.push_back(std::move(one));
            continue;
        }
        Vector3Of<DoubleDouble> axis{};
        if (const Revolute* hinge = std::get_if<Revolute>(&joint)) {
            one.turns = true;
            one.radius = hinge->pin_radius;
            axis = unit(hinge->axis);
        } else {
            axis = unit(std::get<Prismatic>(joint).axis);
        }
        Vector3 least = Vector3::Zero();
        least[rbdyn::least(sizes(rounded(axis)))] = 1.0;
        one.across_in[0] = unit_across(least, axis);
        one.across_in[1] = cross<DoubleDouble>(axis, one.across_in[0]);
        result.push_back(std::move(one));
    }
    return result;
}

RBDYN_INLINE std::vector<Expression> TreeWriter::add_friction(const Accelerate<S>& tree, const Acts& acts,
                                                              const Solved& solved, std::vector<S>& u,
                                                              std::vector<S>& multipliers) const {
    const std::size_t n = joints_.size();
    std::vector<S> said(per_joint * n, S(0.0));
    if (n == 0) return said;
    const FrictionResponse<S> response(tree_, joints_, tree, r_.time(), moving_, solved.rows,
                                       solved.is_symmetric ? nullptr : &solved.acting);
    using Load = FrictionResponse<S>::Load;
    std::vector<std::size_t> sliding;
    std::vector<int> held(n, -1);  // the row of each
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t r = 0; r < rows_.size(); ++r)
            if (rows_[r] == conditions_.joint_row(static_cast<int>(i))) held[i] = static_cast<int>(r);
        if (joint_state::resists(joint_states_[i]) && !joint_state::has(joint_states_[i], joint_state::unloaded))
            sliding.push_back(i);
    }
    std::vector<S> friction(n, S(0.0));
    // without the friction of what slides
    const auto spread = tree.spread(u).bodies;
    std::vector<S> forces;
    for (const std::size_t r : solved.order) forces.push_back(multipliers[r]);
    std::vector<Load> load;
    for (std::size_t i = 0; i < n; ++i) {
        Vector3Of<S> sum = none<S>();
        for (int body = joints_[i].body; body < tree_.size(); ++body) {
            if (!response.carries(joints_[i].body, body)) continue;
            const Node& node = tree_.node(body);
            const Moving<S>& m = moving_[at(body)];
            sum +=
                m.bias_at(m.to_world(exactly<S>(node.center))) * exactly<S>(node.mass) - acts.wrenches[at(body)].force;
        }
        for (std::size_t k = 0; k < states_.size(); ++k)
            if (contact_state::is_held(states_[k]) || contact_state::is_given(states_[k]))
                sum += response.less(i, touching_[k].row(shared(k), none<S>()), S(1.0));
        Load one = response.load(i, spread, forces);
        const Load rest = response.across(i, sum);
        for (std::size_t k = 0; k < 2; ++k) one[k] += rest[k];
        load.push_back(one);
    }
    std::vector<std::vector<Load>> by(n);
    for (const std::size_t j : sliding)
        for (std::size_t i = 0; i < n; ++i) by[i].push_back(response.load(i, j));
    // T = k e . R, the directions of those that turn taken anew
    const auto is_turning = [&](std::size_t i) { return joint_state::has(joint_states_[i], joint_state::veering); };
    const bool turns = std::any_of(sliding.begin(), sliding.end(),
                                   [&](std::size_t i) { return is_turning(i) && !joints_[i].is_alone; });
    const auto direction = [](const Load& r) {
        const S inverse = S(1.0) / sqrt(r[0] * r[0] + r[1] * r[1]);
        return Load{r[0] * inverse, r[1] * inverse};
    };
    std::vector<Load> pressed = load, along(n, Load{S(0.0), S(0.0)});
    for (int pass = 0; pass < (turns ? 5 : 1) && !sliding.empty(); ++pass) {
        std::vector<std::vector<S>> m;
        std::vector<S> b, pivots, driven;
        for (std::size_t s = 0; s < sliding.size(); ++s) {
            const std::size_t i = sliding[s];
            const bool is_given = pass == 0 && joint_state::has(joint_states_[i], joint_state::remembered);
            along[i] = is_turning(i) && !is_given ? direction(pressed[i]) : pressed_[i].along;
            const bool slides = joint_state::is_sliding(joint_states_[i]);
            const S k = joints_[i].coefficient(slides).in<S>() * joints_[i].radius.in<S>();
            m.emplace_back();
            for (std::size_t j = 0; j < sliding.size(); ++j) {
                const S part = k * (along[i][0] * by[i][j][0] + along[i][1] * by[i][j][1]);
                m.back().push_back(S(s == j ? 1.0 : 0.0) +
                                   part * S(static_cast<double>(joint_state::against(joint_states_[sliding[j]]))));
            }
            b.push_back(k * (along[i][0] * load[i][0] + along[i][1] * load[i][1]));
        }
        const std::vector<S> found = solve_in_order<S>(std::move(m), std::move(b), pivots, driven);
        pressed = load;
        for (std::size_t s = 0; s < sliding.size(); ++s) {
            const std::size_t j = sliding[s];
            friction[j] = found[s] * S(-static_cast<double>(joint_state::against(joint_states_[j])));
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t k = 0; k < 2; ++k) pressed[i][k] += by[i][s][k] * friction[j];
            said[per_joint * j + 4] = pivots[s];
        }
    }
    for (const std::size_t j : sliding) {
        for (std::size_t k = 0; k < u.size(); ++k) u[k] += response.driven(j)[k] * friction[j];
        for (std::size_t k = 0; k < solved.order.size(); ++k)
            multipliers[solved.order[k]] += response.multipliers(j)[k] * friction[j];
    }
    for (std::size_t i = 0; i < n; ++i) {
        said[per_joint * i] = held[i] >= 0 ? multipliers[at(held[i])] : friction[i];
        said[per_joint * i + 1] = pressed[i][0];
        said[per_joint * i + 2] = pressed[i][1];
        said[per_joint * i + 3] = along[i][0] * pressed[i][1] - along[i][1] * pressed[i][0];
    }
    return said;
}

RBDYN_INLINE void TreeWriter::rub(EquationsWriter& write) {
    using namespace joint_state;
    const recording::WideFolding all_digits;
    for (const RoughJoint& joint : joints_) {
        if (joint.drive.is_constant()) continue;
        const int place = write.output(joint.drive(r_.time()));
        if (surfaces_ < 0) surfaces_ = place;
    }
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        const RoughJoint& joint = joints_[i];
        const signed char state = joint_states_[i];
        const S* const said = values_.data() + first_of_joints() + per_joint * i;
        const auto guard = [&](EventKind kind, const std::string& what, const S& value, bool renews = true) {
            write.guard({.kind = kind,
                         .subject = joint.body,
                         .joint = static_cast<int>(i),
                         .name = what + (joint.rail ? " the rail of " : " the joint of ") + joint.name,
                         .renews = renews},
                        value);
        };
        const S square = said[1] * said[1] + said[2] * said[2];
        if (is_at_rest(state)) {
            if (joint.drive.is_zero()) {
                write.rate(joint.q) = S(0.0);
                write.rate(tree_.positions() + joint.v) = S(0.0);
            } else {
                write.rate(joint.q) = joint.drive(r_.time()) / joint.pace(moving_);
            }
            const S k = joint.mu_static.in<S>() * joint.radius.in<S>();
            if (state == held) guard(EventKind::slip, "friction in", k * k * square - said[0] * said[0]);
        }
        if (!resists(state)) continue;
        const Pressed& p = pressed_[i];
        if (is_sliding(state)) {
            const S speed = joint.slip(r_.time(), moving_, v_[at(joint.v)]) * S(static_cast<double>(sign(state)));
            // what starts from rest has no speed yet
            guard(EventKind::stick, "rate of", has(state, from_rest) ? speed + p.least_rate : speed, false);
            if (has(state, from_rest)) guard(EventKind::switching, "start of", S(2.0) * p.least_rate - speed);
        }
        if (has(state, unloaded)) {
            guard(EventKind::switching, "load of", S(4.0) * p.least_load * p.least_load - square);
        } else if (has(state, veering)) {
            guard(EventKind::switching, "load of", square - p.least_load * p.least_load);
            guard(EventKind::singular, "load of", S(1e-14) * square - said[3] * said[3]);
            if (has(state, remembered))
                guard(EventKind::switching, "direction of the load of",
                      p.along[0] * said[1] + p.along[1] * said[2] - S(0.97) * sqrt(square));
        } else {
            // friction goes on from zero there: of its new side the zero is known as of the old one
            guard(EventKind::normal_zero, "load of", p.along[0] * said[1] + p.along[1] * said[2], false);
            guard(EventKind::switching, "load of", p.least_load - said[3]);
            guard(EventKind::switching, "load of", p.least_load + said[3]);
        }
        if (!has(state, unloaded)) guard(EventKind::singular, "load of", grip().value_or(said[4]));
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
