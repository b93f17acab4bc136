// Definitions of rbdyn/mechanics/tree_model.hpp: friction in joints beside contacts.
//
// What joints and contacts do at an instant is one problem: a joint is pressed by what contacts exert, and what it
// resists changes that. With the joints' states given, held, idle, or sliding with T = k e . R, e the direction of
// their load R, contacts solve the problem that they solve alone (friction_cones.hpp), held joints among the
// constraints and what sliding ones do among what pushes: A z + b once more, not symmetric where a joint slides. So
// their states are the outer search: all held, what is furthest beyond its law changes first, then each way that there
// is. Taking e anew from the solution is the search for |R|.
//
// A joint at rest whose acceleration the contacts hold already at zero is idle: no friction of it is needed, and any up
// to its limit would do. Where they hold it at another value, as that of a linkage that moves on while a joint of it
// turns back, no friction could hold the joint: its rate changes its sign.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace joint_contacts {

/// In place of the sign of a rate.
inline constexpr int idle = 3, gone = 2;
inline bool slides(int sign) { return sign == 1 || sign == -1; }

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

RBDYN_INLINE std::vector<mechanics::Row<double>> TreeModel::constraints_of(
    const Mode& mode, const std::vector<mechanics::Row<double>>& every) const {
    auto used = constraints_of(every);
    for (int i = 0; i < static_cast<int>(joints_.size()); ++i)
        if (mode.slip[at(first_joint() + i)] == mechanics::joint_state::held)
            used.push_back(every[at(conditions_->joint_row(i))]);
    return used;
}

RBDYN_INLINE std::optional<friction::JointLaw> TreeModel::joint_law(const Mode& mode, double t) const {
    using namespace mechanics::joint_state;
    friction::JointLaw law{&joints_, t, {}, {}, {}};
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        const signed char state = mode.slip[at(first_joint()) + i];
        if (!is_sliding(state) || has(state, unloaded)) continue;
        law.sliding.push_back(i);
        law.factor.push_back(-static_cast<double>(sign(state)) * joints_[i].mu_dynamic * joints_[i].radius);
        law.along.push_back(joint_memory(mode, static_cast<int>(i)).along);
    }
    return law.sliding.empty() ? std::nullopt : std::make_optional(std::move(law));
}

RBDYN_INLINE std::vector<double> TreeModel::said_of_joints(const Mode& mode, double t,
                                                           std::span<const double> x) const {
    const std::optional<Acting> acting = acting_in(mode, 0, 0, t, x);
    const auto numbers = static_cast<std::ptrdiff_t>(mechanics::JointMemory::said * joints_.size());
    return {acting->values.end() - numbers, acting->values.end()};
}

RBDYN_INLINE void TreeModel::settle_contacts(const Mode& before, Mode& mode, double t, std::span<double> x,
                                             const std::vector<int>& candidates, const Fired& fired) const {
    resistances() > 0 ? settle_resisted(before, mode, t, x, candidates, fired)
                      : settle_rough(before, mode, t, x, candidates, fired);
}

RBDYN_INLINE std::vector<int> TreeModel::still_pressed(const Mode& before, double t, std::span<const double> x,
                                                       const std::vector<int>& candidates, const Fired& fired) const {
    constexpr double rounding = 1e-9;
    const mechanics::TreeState state = look(before, t, x);
    std::vector<int> pressed;
    for (const int k : candidates) {
        const ContactReport& report = state.contacts[at(k)];
        const bool is_pressed =
            before.slip[at(k)] == flies ? fired.has(k) : report.force.norm() > rounding * forces_at(k, state);
        if (is_pressed) pressed.push_back(k);
    }
    return pressed;
}

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

RBDYN_INLINE TreeModel::Rubbed TreeModel::tried(const Mode& before, const Mode& mode, double t, std::span<double> x,
                                                const std::vector<int>& candidates, const Fired& fired,
                                                const std::vector<int>& sign) const {
    using namespace mechanics::joint_state;
    const std::size_t n = joints_.size();
    Rubbed result{mode, {}, {}, {}, std::vector<double>(n, 0.0), {}, {}, {}, false};
    std::vector<std::array<double, 2>> along;
    for (std::size_t i = 0; i < n; ++i) along.push_back(joint_memory(mode, static_cast<int>(i)).along);
    double last = 2.0;
    for (int pass = 0; pass < 60 && !result.is_solved; ++pass) {
        result.mode = mode;
        for (std::size_t i = 0; i < n; ++i) {
            signed char now = sign[i] == joint_contacts::gone ? open : sign[i] == joint_contacts::idle ? idle : held;
            if (joint_contacts::slides(sign[i])) now = static_cast<signed char>(slides | (sign[i] < 0 ? backward : 0));
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
            const double size = std::hypot(one[1], one[2]);
            const std::array<double, 2> now =
                size > 0.0 ? std::array<double, 2>{one[1] / size, one[2] / size} : std::array<double, 2>{0.0, 0.0};
            if (joint_contacts::slides(sign[i]))
                turned = std::max(turned, std::hypot(now[0] - along[i][0], now[1] - along[i][1]));
            along[i] = now;
        }
        // loads that rounding makes have no direction
        result.is_solved = turned < 1e-13 || (turned < 1e-9 && turned >= last);
        last = turned;
    }
    if (!result.is_solved) return result;
    const mechanics::TreeState state = look(result.mode, t, x);
    const auto rows = rows_in(result.mode);
    // without friction, and without rest, of what does not need any
    Mode unheld = result.mode;
    for (std::size_t i = 0; i < n; ++i)
        if (sign[i] == joint_contacts::idle) unheld.slip[at(first_joint()) + i] = open;
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
            result.amiss[i] = is_held == (sign[i] == joint_contacts::idle) ? 0.0 : 1e300;
        }
    }
    return result;
}

RBDYN_INLINE std::vector<TreeModel::Gap> TreeModel::gaps_beside_held(const Mode& mode, double t, std::span<double> x,
                                                                     const std::vector<int>& candidates) const {
    std::vector<Gap> gaps;
    const auto all = moving(t, x);
    std::vector<int> held;
    for (std::size_t i = 0; i < joints_.size(); ++i)
        if (mode.slip[at(first_joint()) + i] == mechanics::joint_state::held) held.push_back(static_cast<int>(i));
    // whether constraints and held joints, all but one, move no contact's gap
    const auto settles = [&](int contact, int but) {
        std::vector<int> rows = rows_;
        for (const int i : held)
            if (i != but) rows.push_back(conditions_->joint_row(i));
        const std::size_t first = rows.size();
        rows.push_back(conditions_->normal_row(contact));
        return mechanics::independent_rows(*tree_, *conditions_, rows, all, first).size() <= first;
    };
    for (const int k : candidates) {
        if (held.empty() || mode.slip[at(k)] == flies || !settles(k, -1)) continue;
        gaps.push_back({k, 0, {}});
        for (const int i : held)
            if (!settles(k, i)) gaps.back().joints.push_back(i);
    }
    if (gaps.empty()) return gaps;
    Mode without = mode;
    for (const Gap& gap : gaps) without.slip[at(gap.contact)] = flies;
    choose(without, t, x, {}, true);
    for (const Guard& guard : without.equations->guards)
        for (Gap& gap : gaps)
            if (guard.kind == EventKind::land && guard.output >= 0 && guard.contact == gap.contact)
                gap.sign = leading_sign(without, t, x, guard.output, 2);
    return gaps;
}

RBDYN_INLINE void TreeModel::settle_all(const Mode& before, Mode& mode, double t, std::span<double> x,
                                        const std::vector<int>& candidates, const Fired& fired) const {
    using namespace mechanics::joint_state;
    const std::size_t n = joints_.size();
    const auto was = [&](std::size_t i) { return before.slip[at(first_joint()) + i]; };
    // another form of what contacts do changes nothing of joints
    const bool is_form = fired.rubbed_breaking.empty() && fired.landing.empty() && fired.doubtful.empty() &&
                         fired.breaking.empty() && fired.stuck.empty() && fired.resisted_breaking.empty() &&
                         fired.resisted_stopping.empty() && fired.stopping.empty() && fired.singular.empty() &&
                         !(fired.turning.empty() && fired.resisted_turning.empty());
    if (is_form) return settle_contacts(before, mode, t, x, candidates, fired);
    // what a joint has held at its surface without a force, until it breaks, may close again, or part: at the limit
    // both begin with no acceleration, and what comes next decides
    if (!fired.rubbed_breaking.empty()) {
        std::vector<int> closed;
        for (const int k : candidates)
            if (before.slip[at(k)] != flies || fired.has(k)) closed.push_back(k);
        if (closed.size() < candidates.size()) {
            Mode parted = mode;
            settle_all(before, parted, t, x, closed, fired);
            if (parted.impossible.empty() && joint_contacts::part(parted, t, x, candidates)) {
                mode = std::move(parted);
                return;
            }
        }
    }
    const Mode undecided = mode;
    std::vector<int> sign(n, 0);
    std::vector<std::size_t> resting;
    std::vector<double> slip;
    for (std::size_t i = 0; i < n; ++i) {
        const int joint = static_cast<int>(i);
        // what rests on contacts is at rest
        slip.push_back(was(i) == idle && before.jumps == mode.jumps ? 0.0 : slip_of(before, mode, joint, t, x));
        sign[i] = slip[i] > 0.0 ? 1 : slip[i] < 0.0 ? -1 : 0;
        if (has(was(i), from_rest) && std::abs(slip[i]) <= 2.0 * joint_memory(before, joint).least_rate &&
            slip[i] != 0.0)
            sign[i] = mechanics::joint_state::sign(was(i));
        if (sign[i] != 0) continue;
        resting.push_back(i);
        carry(mode, joint, t, x);
    }
    // what shares its load with others breaks only where no forces inside all cones are left
    std::vector<int> breaking = shares_load(before) ? std::vector<int>{} : fired.rubbed_breaking;
    Rubbed found{undecided, {}, {}, {}, {}, {}, {}, {}, false};
    const auto breaks = [&](std::size_t i) {
        return std::find(breaking.begin(), breaking.end(), static_cast<int>(i)) != breaking.end();
    };
    const auto is_right_way = [&](const Rubbed& r, const std::vector<int>& s) {
        if (!r.is_right()) return false;
        // what slides from rest goes the way that it is said to
        return std::all_of(resting.begin(), resting.end(), [&](std::size_t i) {
            if (!joint_contacts::slides(s[i])) return true;
            // at its limit it begins with none
            return static_cast<double>(s[i]) * r.acceleration[i] > (breaks(i) ? -r.least[i] : r.least[i]);
        });
    };
    for (std::size_t turn = 0; turn <= n; ++turn) {
        bool is_found = false;
        const auto look_at = [&](const std::vector<int>& way) {
            found = tried(before, undecided, t, x, candidates, fired, way);
            is_found = is_right_way(found, way);
            for (const std::size_t i : resting) is_found = is_found && !(breaks(i) && way[i] == 0);
            if (is_found) sign = way;
            return is_found;
        };
        // contacts may hold what joints would: of these none is needed; then joints hold as contacts do
        const bool may_idle = !candidates.empty() && fired.doubtful.empty();
        for (const int first : {joint_contacts::idle, 0}) {
            if (is_found || (first != 0 && !may_idle)) continue;
            std::vector<int> way = sign;
            for (const std::size_t i : resting) way[i] = first;
            look_at(way);
            for (std::size_t k = 0; k <= 4 * n && !is_found && found.is_solved; ++k) {
                bool changes = false;
                for (const std::size_t i : resting)
                    if (way[i] == joint_contacts::idle && found.amiss[i] > 1.0) {
                        way[i] = 0;
                        changes = true;
                    }
                std::size_t worst = n;
                double most = 1.0;
                for (const std::size_t i : resting) {
                    if (changes) break;
                    const bool must = way[i] == 0 && breaks(i);
                    const bool against = joint_contacts::slides(way[i]) &&
                                         static_cast<double>(way[i]) * found.acceleration[i] < -found.least[i];
                    const double off = must || against ? 1e300 : found.amiss[i];
                    if (off > most) {
                        most = off;
                        worst = i;
                    }
                }
                if (worst == n && !changes) break;
                if (worst < n) way[worst] = way[worst] != 0 ? 0 : found.friction[worst] > 0.0 ? -1 : 1;
                look_at(way);
            }
        }
        // each way that what rests may go on
        if (!is_found && resting.size() <= 4) {
            constexpr std::array choices{0, joint_contacts::idle, 1, -1};
            std::vector<int> way = sign;
            for (const std::size_t i : resting) way[i] = 0;
            while (!look_at(way) && joint_contacts::next_way(resting, choices, way)) {
            }
        }
        // forces that end at the very instant at which a joint breaks away leave neither a force that would hold them
        // closed, nor an acceleration that would open them: without them, and what comes next decides
        if (!is_found && before.equations != nullptr) {
            const std::vector<int> closed = still_pressed(before, t, x, candidates, fired);
            if (closed.size() < candidates.size()) {
                Mode parted = undecided;
                for (const int k : candidates) parted.slip[at(k)] = flies;
                for (const int k : closed) parted.slip[at(k)] = undecided.slip[at(k)];
                settle_all(before, parted, t, x, closed, fired);
                if (parted.impossible.empty() && joint_contacts::part(parted, t, x, candidates, true)) {
                    mode = std::move(parted);
                    return;
                }
            }
        }
        if (!is_found) {
            std::string names;
            for (const mechanics::RoughJoint& joint : joints_) names += (names.empty() ? "" : ", ") + joint.name;
            mode.impossible =
                !found.mode.impossible.empty()
                    ? found.mode.impossible
                    : "no friction in the joints, and no forces of contacts, satisfy their laws, of " + names;
            return;
        }
        // where what joints hold would move a contact's gap, only later, one of both is not held
        const std::vector<Gap> gaps = gaps_beside_held(found.mode, t, x, candidates);
        if (std::ranges::any_of(gaps, [](const Gap& gap) { return gap.sign != 0; })) {
            std::vector<int> closed = candidates, opening;
            for (const Gap& gap : gaps)
                if (gap.sign > 0) opening.push_back(gap.contact);
            std::erase_if(closed, [&](int k) { return std::ranges::find(opening, k) != opening.end(); });
            Mode parted = undecided;
            for (const int k : opening) parted.slip[at(k)] = flies;
            if (!opening.empty()) settle_all(before, parted, t, x, closed, fired);
            if (!opening.empty() && parted.impossible.empty() && joint_contacts::part(parted, t, x, opening)) {
                mode = std::move(parted);
                return;
            }
            const std::size_t known = breaking.size();
            for (const Gap& gap : gaps)
                for (const int i : gap.joints)
                    if (gap.sign != 0 && !breaks(at(i))) breaking.push_back(i);
            if (breaking.size() > known) continue;
        }
        // at its limit it is held unless the next moment takes it beyond
        int leaves = -1;
        if (shares_load(found.mode)) break;
        Evaluator<double> values(found.mode.equations->program);
        values.set_parameters(found.mode.parameters);
        values(t, x);
        for (const Guard& guard : found.mode.equations->guards) {
            if (guard.kind != EventKind::slip || guard.joint < 0 || guard.contact >= 0 || guard.output < 0) continue;
            const double value = values.output(guard.output), size = values.magnitude(guard.output);
            if (!(value <= 1e-13 * size) || size == 0.0 || breaks(at(guard.joint))) continue;
            if (leading_sign(found.mode, t, x, guard.output, 1) < 0) leaves = guard.joint;
        }
        if (leaves < 0) break;
        breaking.push_back(leaves);
    }
    mode = found.mode;
    const double length = size_of(moving(t, x));
    for (std::size_t i = 0; i < n; ++i) {
        if (!joint_contacts::slides(sign[i])) continue;
        const int joint = static_cast<int>(i);
        // of what goes on to slide the least rate stays
        const bool begins = std::find(resting.begin(), resting.end(), i) != resting.end() || has(was(i), from_rest);
        double acceleration = std::abs(found.acceleration[i]);
        if (begins)
            acceleration =
                std::max(acceleration, found.load_size[i] / static_cast<double>(tree_->node(joints_[i].body).mass));
        mode.slip[at(first_joint()) + i] =
            sliding_state(mode, joint, t, x, sign[i], begins, slip[i], found.late_rate[i], acceleration, length,
                          found.load[i], found.load_size[i]);
    }
    choose(mode, t, x, {}, true);
}

}  // namespace rbdyn::inline RBDYN_FORM
