// Definitions of rbdyn/mechanics/tree_model.hpp: one way that rough joints may go on beside contacts, and how far it is
// from their laws.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace joint_contacts {

/// In place of the sign of a rate.
inline constexpr int idle = 3, gone = 2, stays = 8;  // +-: at its limit
inline bool slides(int sign) { return sign == 1 || sign == -1; }
inline bool resists(int sign) { return slides(sign) || sign == stays || sign == -stays; }

/// That of a load; zero of none.
inline std::array<double, 2> direction(const std::array<double, 2>& load) {
    const double size = std::hypot(load[0], load[1]);
    return size > 0.0 ? std::array<double, 2>{load[0] / size, load[1] / size} : std::array<double, 2>{};
}

/// The next of all ways that some joints may go on; false: there is none.
inline bool next_way(const std::vector<std::size_t>& of, std::span<const int> choices, std::vector<int>& sign) {
    for (const std::size_t i : of) {
        const auto now = std::find(choices.begin(), choices.end(), sign[i]);
        if (now + 1 != choices.end()) {
            sign[i] = *(now + 1);
            return true;
        }
        sign[i] = choices.front();
    }
    return false;
}

/// Whether contacts that are open and touch, at rest, part as the motion goes on; `may_stay`: or stay as they are.
inline bool part(const Mode& mode, double t, std::span<const double> x, const std::vector<int>& contacts,
                 bool may_stay = false) {
    return std::all_of(mode.equations->guards.begin(), mode.equations->guards.end(), [&](const Guard& guard) {
        const bool is_gap = guard.kind == EventKind::land && guard.output >= 0 &&
                            std::find(contacts.begin(), contacts.end(), guard.contact) != contacts.end();
        return !is_gap || leading_sign(mode, t, x, guard.output, 2) > (may_stay ? -1 : 0);
    });
}

}  // namespace joint_contacts

/// What came of one way that joints may go on.
struct TreeModel::Rubbed {
    Mode mode;
    std::vector<std::array<double, 2>> load;                       // what presses each joint
    std::vector<double> friction, acceleration, amiss, load_size;  // amiss: over what it may be; above 1 it is wrong
    std::vector<double> least;                                     // accelerations below it are rounding
    std::vector<double> late_rate;                                 // rates that the rounding of the time makes
    bool is_solved = false;
    bool is_right() const {
        return is_solved && std::all_of(amiss.begin(), amiss.end(), [](double one) { return one <= 1.0; });
    }
};

RBDYN_INLINE TreeModel::Rubbed TreeModel::pressed(const Mode& before, const Mode& mode, double t, std::span<double> x,
                                                  const std::vector<int>& candidates, const Fired& fired,
                                                  const std::vector<int>& sign,
                                                  std::vector<std::array<double, 2>> along) const {
    using namespace mechanics::joint_state;
    const std::size_t n = joints_.size();
    Rubbed result{mode, {}, {}, {}, std::vector<double>(n, 0.0), {}, {}, {}, false};
    double last = 2.0;
    for (int pass = 0; pass < 60 && !result.is_solved; ++pass) {
        result.mode = mode;
        for (std::size_t i = 0; i < n; ++i) {
            signed char now = sign[i] == joint_contacts::gone ? open : sign[i] == joint_contacts::idle ? idle : held;
            if (joint_contacts::resists(sign[i])) now = static_cast<signed char>(slides | (sign[i] < 0 ? backward : 0));
            if (std::abs(sign[i]) == joint_contacts::stays) now = static_cast<signed char>(now | idle);
            result.mode.slip[at(first_joint()) + i] = now;
            mechanics::JointMemory memory = joint_memory(mode, static_cast<int>(i));
            memory.along = along[i];
            memory.put(result.mode.memory.data() + place_of_joint(static_cast<int>(i)));
        }
        settle_contacts(before, result.mode, t, x, candidates, fired);
        if (!result.mode.impossible.empty()) return result;
        const std::vector<double> said = said_of_joints(result.mode, t, x);
        result.load.clear();
        result.friction.clear();
        double turned = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            const double* const one = said.data() + mechanics::JointMemory::said * i;
            result.friction.push_back(one[0]);
            result.load.push_back({one[1], one[2]});
            const std::array<double, 2> now = joint_contacts::direction({one[1], one[2]});
            if (joint_contacts::resists(sign[i]))
                turned = std::max(turned, std::hypot(now[0] - along[i][0], now[1] - along[i][1]));
            along[i] = now;
        }
        // loads that rounding makes have no direction
        result.is_solved = turned < 1e-13 || (turned < 1e-9 && turned >= last);
        last = turned;
    }
    return result;
}

RBDYN_INLINE TreeModel::Rubbed TreeModel::tried(const Mode& before, const Mode& mode, double t, std::span<double> x,
                                                const std::vector<int>& candidates, const Fired& fired,
                                                const std::vector<int>& sign) const {
    const std::size_t n = joints_.size();
    std::vector<std::array<double, 2>> along;
    for (std::size_t i = 0; i < n; ++i) along.push_back(joint_memory(mode, static_cast<int>(i)).along);
    Rubbed result = pressed(before, mode, t, x, candidates, fired, sign, along);
    // where there are no forces with the directions that loads begin with there may be some that press joints so hard
    // that these are the directions in which contacts do
    if (!result.is_solved && std::ranges::any_of(sign, joint_contacts::resists)) {
        Mode slid = result.mode;
        for (std::size_t i = 0; i < n; ++i) {
            mechanics::JointMemory memory = joint_memory(slid, static_cast<int>(i));
            memory.along = {};
            memory.put(slid.memory.data() + place_of_joint(static_cast<int>(i)));
        }
        const Touched touched = this->touched(before, t, moving(slid, t, x), candidates, fired.stopping, false, &slid);
        for (std::size_t c = 0; c < touched.cones.size() && !result.is_solved; ++c) {
            const auto& loads = touched.coupled->loads(at(touched.cones[c].first));
            for (std::size_t i = 0; i < n; ++i) along[i] = joint_contacts::direction(loads[i]);
            Rubbed other = pressed(before, mode, t, x, candidates, fired, sign, along);
            if (other.is_solved) result = std::move(other);
        }
    }
    using namespace mechanics::joint_state;
    if (!result.is_solved) return result;
    const mechanics::TreeState state = look(result.mode, t, x);
    const auto rows = rows_in(result.mode);
    // without friction, and without rest, of what does not need any
    Mode unheld = result.mode;
    for (std::size_t i = 0; i < n; ++i)
        if (sign[i] == joint_contacts::idle)
            unheld.slip[at(first_joint()) + i] = open;
        else if (std::abs(sign[i]) == joint_contacts::stays)
            unheld.slip[at(first_joint()) + i] &= static_cast<signed char>(~idle);
    if (unheld.slip != result.mode.slip) choose(unheld, t, x, {}, true);
    const auto rates = acting_in(unheld, 0, 0, t, x);
    // what all of it comes to within the rounding of the time is rounding, too
    const double late = 8.0 * epsilon * std::abs(t);
    const std::vector<double> there = moved_on(x, late, [&](std::size_t i) { return rates->values[i]; });
    const auto later = acting_in(unheld, 0, 0, t + late, there);
    const std::vector<double> said = said_of_joints(result.mode, t + late, there);
    for (std::size_t i = 0; i < n; ++i) {
        const mechanics::RoughJoint& joint = joints_[i];
        const mechanics::TreeState::Body& body = state.bodies[at(joint.body)];
        const double size = joint.turns ? body.effort.moment.norm() : body.effort.force.norm();
        const double* const one_later = said.data() + mechanics::JointMemory::said * i;
        const double turned =
            std::hypot(one_later[1] - result.load[i][0], one_later[2] - result.load[i][1]) * joint.radius;
        const double noise = 1e-13 * size + std::abs(one_later[0] - result.friction[i]) + joint.mu_static * turned;
        result.load_size.push_back(body.effort.force.norm());
        const mechanics::closing::Responses alone(*tree_, *conditions_, {conditions_->joint_row(static_cast<int>(i))},
                                                  state.moving);
        double one = rates->values[at(tree_->positions() + joint.v)];
        const double change = std::abs(later->values[at(tree_->positions() + joint.v)] - one);
        result.least.push_back(1e-13 * size * alone.matrix()[0][0] + change);
        result.late_rate.push_back(change * late);
        if (joint.rail)
            one = joint.pace(state.moving) * one -
                  joint.carried(t, x.data(), x[at(tree_->positions() + joint.v)], state.moving);
        result.acceleration.push_back(one);
        const double pressing = std::hypot(result.load[i][0], result.load[i][1]);
        if (sign[i] == 0) {
            const double limit = joint.mu_static * joint.radius * pressing;
            result.amiss[i] = std::abs(result.friction[i]) <= limit + noise
                                  ? 0.0
                                  : std::abs(result.friction[i]) / std::max(limit + noise, 1e-300) + 1.0;
        } else if (sign[i] != joint_contacts::gone) {
            // what contacts hold at rest is idle and does not slide, what they do not is not idle
            std::vector<int> with = rows;
            with.push_back(conditions_->joint_row(static_cast<int>(i)));
            bool is_held = std::abs(one) <= result.least.back() &&
                           mechanics::independent_rows(*tree_, *conditions_, with, state.moving, rows.size()).size() <=
                               rows.size();
            // nor is what they hold at this place alone, as from rest where its angle is extreme: it begins without an
            // acceleration, and goes the way that comes next
            if (is_held && !joint.rail)
                if (const int next = leading_sign(unheld, t, x, tree_->positions() + joint.v, 1); next != 0) {
                    is_held = false;
                    result.acceleration.back() = 2.0 * static_cast<double>(next) * result.least.back();
                }
            result.amiss[i] = is_held != joint_contacts::slides(sign[i]) ? 0.0 : 1e300;
        }
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
