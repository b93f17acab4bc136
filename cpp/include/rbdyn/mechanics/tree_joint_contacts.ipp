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
#include "rbdyn/mechanics/tree_joint_ways.ipp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

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
        if (!resists(state) || has(state, unloaded)) continue;
        law.sliding.push_back(i);
        law.factor.push_back(-static_cast<double>(against(state)) * joints_[i].coefficient(is_sliding(state)) *
                             joints_[i].radius);
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

RBDYN_INLINE void TreeModel::stop_with_joints(const Mode& mode, double t, std::span<const double> x,
                                              Fired& fired) const {
    using namespace mechanics::contact_state;
    if (fired.rubbed_stopping.empty()) return;
    for (int k = 0; k < contacts(); ++k)
        if (slides(mode.slip[at(k)]) && !follows_slip(mode.slip[at(k)]) && !is_start(mode.slip[at(k)]) &&
            !fired.has(k) && is_at_end(mode, k, t, x))
            fired.stopping.push_back(k);
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
    const bool is_form = fired.rubbed_breaking.empty() && fired.rubbed_stopping.empty() && fired.landing.empty() &&
                         fired.doubtful.empty() && fired.breaking.empty() && fired.stuck.empty() &&
                         fired.resisted_breaking.empty() && fired.resisted_stopping.empty() && fired.stopping.empty() &&
                         fired.singular.empty() && !(fired.turning.empty() && fired.resisted_turning.empty());
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
        slip.push_back((was(i) & idle) != 0 && before.jumps == mode.jumps ? 0.0 : slip_of(before, mode, joint, t, x));
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
    // nor does what stays at its limit, beside what holds the rest, longer than that
    for (std::size_t i = 0; i < n; ++i)
        if (!fired.breaking.empty() && resists(was(i)) && !is_sliding(was(i))) breaking.push_back(static_cast<int>(i));
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
    constexpr std::size_t most_at_limits = 4;
    for (std::size_t turn = 0; turn <= n; ++turn) {
        bool is_found = false;
        const auto look_among = [&](const std::vector<int>& way, const Fired& what) {
            found = tried(before, undecided, t, x, candidates, what, way);
            is_found = is_right_way(found, way);
            for (const std::size_t i : resting) is_found = is_found && !(breaks(i) && way[i] == 0);
            if (is_found) sign = way;
            return is_found;
        };
        const auto look_at = [&](const std::vector<int>& way) { return look_among(way, fired); };
        // contacts may hold what joints would: of these none is needed; then joints hold as contacts do
        const bool may_idle = !candidates.empty() && fired.doubtful.empty();
        // or they hold the rest of what joints that resist up to their limits do, whatever has come to its edge alone;
        // or all of them share it
        const bool presses =
            before.equations == nullptr || still_pressed(before, t, x, candidates, fired).size() == candidates.size();
        if (may_idle && presses && !resting.empty() && resting.size() <= most_at_limits) {
            std::vector<int> way = sign;
            for (const std::size_t i : resting) way[i] = joint_contacts::idle;
            constexpr std::array choices{joint_contacts::stays, -joint_contacts::stays};
            Fired shared = fired;
            shared.breaking.clear();
            const std::vector<int> undone = sign;
            if (!look_at(way)) {
                for (const std::size_t i : resting) way[i] = choices.front();
                // where contacts have forces of their own to choose all share the load
                while ((!look_among(way, shared) || shares_load(found.mode)) &&
                       joint_contacts::next_way(resting, choices, way)) {
                }
                if (is_found && shares_load(found.mode)) {
                    is_found = false;
                    sign = undone;
                }
                for (const std::size_t i : resting) way[i] = 0;
                if (!is_found && !fired.breaking.empty()) look_among(way, shared);
            }
        }
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
        if (!joint_contacts::resists(sign[i])) continue;
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
        if (joint_contacts::slides(sign[i])) continue;
        signed char& state = mode.slip[at(first_joint()) + i];
        state = static_cast<signed char>((state & ~from_rest) | idle);
    }
    choose(mode, t, x, {}, true);
    // where contacts beside joints without friction find no force, no direction of a load without it is one to begin
    // with
    const std::vector<double> said = said_of_joints(mode, t, x);
    bool remembers = false;
    for (std::size_t i = 0; i < n; ++i) remembers = remembers || said[mechanics::JointMemory::said * i + 4] < 0.0;
    if (!remembers) return;
    for (std::size_t i = 0; i < n; ++i)
        if (signed char& state = mode.slip[at(first_joint()) + i]; resists(state))
            state = static_cast<signed char>(state | remembered);
    choose(mode, t, x, {}, true);
}

}  // namespace rbdyn::inline RBDYN_FORM
