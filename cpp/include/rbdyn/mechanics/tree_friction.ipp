// Definitions of rbdyn/mechanics/tree_model.hpp: friction at contacts.
//
// What some contacts do at an instant solves one problem (friction_cones.hpp), in impulses where they strike and in
// forces otherwise. The static coefficient decides whether what is at rest is held, the dynamic one what it does when
// it slides; of several that could be held all are, if any forces inside their cones hold them, and what breaks is what
// slides where all others keep their static cones.
//
// A direction of slip is a function of the state where there is a speed. It stays what it is across the normal while
// the motion is straight; where it turns it is u/|u|, which ends, or begins, at a speed of rounding: below 2^-43 of the
// speeds that make it up the last direction is kept, and the speed along it passes zero like any other number. What
// that leaves out is of second order in it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/cone_choice.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_strikes.ipp"
#include "rbdyn/model/at_zero.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool TreeModel::Fired::has(int contact) const {
    for (const auto* list : {&landing, &doubtful, &breaking, &stopping, &turning, &singular})
        if (std::find(list->begin(), list->end(), contact) != list->end()) return true;
    return false;
}

RBDYN_INLINE bool TreeModel::Fired::none() const {
    for (const auto* list : {&landing, &doubtful, &breaking, &stopping, &turning, &singular, &resisted_breaking,
                             &resisted_stopping, &resisted_turning, &stuck, &rubbed_breaking, &rubbed_stopping})
        if (!list->empty()) return false;
    return true;
}

RBDYN_INLINE bool TreeModel::holds_all(const std::vector<int>& rows) const {
    if (contacts() == 0 || static_cast<int>(rows.size()) != tree_->velocities() || tree_->velocities() == 0)
        return false;
    return !is_driven();
}

RBDYN_INLINE void TreeModel::own_parameters(Mode& mode, std::span<const double> x) const {
    for (int k = 0; k < contacts(); ++k) {
        if (!mechanics::contact_state::has_numbers(conditions_->contacts()[at(k)], mode.slip[at(k)])) continue;
        mechanics::ContactMemory memory = mechanics::ContactMemory::of(mode.memory, k);
        memory.keeps = keeps_straight(mode, conditions_->contacts()[at(k)].a.body, x);
        memory.put(mode.memory, k);
    }
    std::size_t next = 0;
    for (int k = 0; k < contacts(); ++k) {
        if (!mechanics::contact_state::has_numbers(conditions_->contacts()[at(k)], mode.slip[at(k)])) continue;
        const std::size_t from = mechanics::ContactMemory::place(k);
        for (int i = 0; i < mechanics::ContactMemory::known(mode.slip[at(k)]); ++i)
            mode.parameters[next++] = mode.memory[from + at(i)];
    }
    for (int e = 0; e < resistances(); ++e) {
        if (!mechanics::ResistanceMemory::has_numbers(conditions_->resistances()[at(e)], resisting(mode, e))) continue;
        for (int i = 0; i < mechanics::ResistanceMemory::numbers; ++i)
            mode.parameters[next++] = mode.memory[place_of_resistance(e) + at(i)];
    }
    for (std::size_t k = 0; k < joints_.size(); ++k) {
        if (!mechanics::joint_state::resists(mode.slip[at(first_joint()) + k])) continue;
        const std::size_t from = place_of_joint(static_cast<int>(k));
        for (int i = 0; i < mechanics::JointMemory::parameters; ++i)
            mode.parameters[next++] = mode.memory[from + at(i)];
    }
}

RBDYN_INLINE TreeModel::Touched TreeModel::touched(const Mode& before, double t,
                                                   const std::vector<mechanics::Moving<double>>& all,
                                                   const std::vector<int>& contacts, const std::vector<int>& stopped,
                                                   bool strikes, const Mode* mode) const {
    Touched result;
    result.moving = all;
    result.t = t;
    for (const int k : contacts) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        Touched::One one{k, c.touching<double>(*tree_, all), {}, {}, false, {}};
        one.sliding = c.sliding([&](int other) { return std::ranges::find(contacts, other) != contacts.end(); });
        const auto& here = one.at;
        one.slip = here.slip();
        one.axes[0] = here.normal;
        std::tie(one.axes[1], one.axes[2]) = friction::along(here);
        const int first = static_cast<int>(result.rows.size());
        // in an impact the dynamic coefficient counts alone
        const bool resists = c.is_rough() && !(strikes && c.mu_dynamic.is_zero());
        if (c.is_rough() && !strikes) {
            const bool slid = mechanics::contact_state::slides(before.slip[at(k)]) ||
                              mechanics::contact_state::is_given(before.slip[at(k)]);
            const double speed = one.slip.norm(),
                         last = slid ? mechanics::ContactMemory::of(before.memory, k).least : 0.0;
            // what never slips has rounding of a speed, but where it had to
            one.slides = speed > std::max((c.never_slips() && !slid ? 1e-9 : 0x1p-43) * speed_of(k, all), last) &&
                         std::find(stopped.begin(), stopped.end(), k) == stopped.end();
            if (one.slides) one.along = one.slip / speed;
        }
        result.rows.push_back(here.row(here.normal, here.normal_rate));
        result.pushes.push_back(result.rows.back());
        if (one.slides) {
            result.pushes.back() = here.row(Vector3(here.normal - one.along * one.sliding), Vector3(Vector3::Zero()));
        } else if (resists) {
            for (int i = 1; i < 3; ++i) {
                result.rows.push_back(i == 2 && here.is_in_plane ? here.no_row()
                                                                 : here.row(one.axes[i], Vector3(Vector3::Zero())));
                result.pushes.push_back(result.rows.back());
            }
        }
        if (mode != nullptr) here.add_torque(result.pushes[at(first)], twisting(*mode, k, all));
        result.cones.push_back({first, !resists || one.slides, static_cast<double>(c.mu_static), one.sliding});
        if (strikes) result.cones.back().mu = c.mu_dynamic;
        result.all.push_back(std::move(one));
    }
    const auto every = conditions_->rows<double>(*tree_, all);
    auto constraints = constraints_of(every);
    if (mode != nullptr) {
        constraints.clear();
        for (const int r : rows_without_contacts(*mode)) constraints.push_back(every[at(r)]);
    }
    const std::optional<friction::JointLaw> law = mode != nullptr ? joint_law(*mode, t) : std::nullopt;
    result.coupled.emplace(*tree_, all, constraints, result.rows, result.pushes, law ? &*law : nullptr);
    result.matrix = result.coupled->matrix();
    return result;
}

RBDYN_INLINE void TreeModel::settle_rough(const Mode& before, Mode& mode, double t, std::span<double> x,
                                          const std::vector<int>& candidates, const Fired& fired) const {
    if (!fired.singular.empty()) {
        mode.impossible = no_sliding(fired.singular.front());
        return;
    }
    // what starts from the edge of a cone against the force that held it, and is thrown back at once, goes nowhere;
    // what has slid for a while, however slowly, has stopped
    for (const int k : fired.stopping)
        if (const auto memory = mechanics::ContactMemory::of(before.memory, k);
            mechanics::contact_state::is_start(before.slip[at(k)]) && memory.at_edge &&
            t - memory.since <= 64.0 * epsilon * std::abs(t)) {
            mode.impossible = conditions_->contacts()[at(k)].name +
                              " breaks away in space at a friction that does not fall, in a direction that turns as it "
                              "begins, and finds none; give it a dynamic coefficient below the static one";
            return;
        }
    const bool is_small = fired.landing.empty() && fired.doubtful.empty() && fired.breaking.empty() &&
                          !(fired.stopping.empty() && fired.turning.empty());
    const auto is_turning = [&](int k) {
        return mechanics::contact_state::follows_slip(mode.slip[at(k)]) &&
               std::find(fired.stopping.begin(), fired.stopping.end(), k) != fired.stopping.end();
    };
    // another form of the same motion: nothing happens
    if (is_small && std::all_of(fired.stopping.begin(), fired.stopping.end(), is_turning)) {
        turn(before, mode, t, x, fired);
        return;
    }
    if (settle_ending(before, mode, t, x, candidates, fired)) return;
    // what shares its load with others breaks only where no forces inside all cones are left
    std::vector<int> breaking;
    for (const int k : fired.breaking)
        if (!shares_load(before)) breaking.push_back(k);
    // what sticks without bound and would have to be pulled next, for let go it would move into its surface, slides
    for (const int k : fired.doubtful)
        if (sticks_without_bound(before, k) && !shares_load(before) && ends(before, k, t, x)) breaking.push_back(k);
    Fired now = fired;
    const auto is_let_go = [&](int k) { return std::ranges::find(now.doubtful, k) != now.doubtful.end(); };
    for (std::size_t turn = 0; turn <= 2 * candidates.size(); ++turn) {
        settle_breaking(before, mode, t, x, candidates, now, breaking);
        if (!mode.impossible.empty()) return;
        // on the edge of its cone it is held unless the next moment takes it out; on those of all that share a load
        // none is held then
        const bool shares = shares_load(mode);
        std::vector<int> on_edge;
        bool leaves = false;
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t, x);
        for (const Guard& guard : mode.equations->guards) {
            if (guard.contact < 0 || guard.joint >= 0 || guard.output < 0) continue;
            // what sticks without bound has one edge, where it presses no more
            const bool is_last = guard.kind == EventKind::detach && sticks_without_bound(mode, guard.contact) &&
                                 sticks_without_bound(before, guard.contact) && !is_let_go(guard.contact);
            if (guard.kind != EventKind::slip && !is_last) continue;
            const double left = values.output(guard.output) / values.magnitude(guard.output);
            if (left > (shares ? 1e-11 : 1e-13)) continue;
            const bool is_left = left <= (shares ? 1e-14 : 1e-13) && leading_sign(mode, t, x, guard.output, 1) < 0;
            leaves = leaves || is_left;
            if (is_last && is_left) now.doubtful.push_back(guard.contact);
            if (!is_last && (shares || is_left)) on_edge.push_back(guard.contact);
        }
        if (!leaves) break;
        if (!shares && !on_edge.empty()) on_edge = {on_edge.back()};
        breaking.insert(breaking.end(), on_edge.begin(), on_edge.end());
    }
    curve(before, mode, t, x);
}

RBDYN_INLINE std::array<double, 2> TreeModel::slip_acceleration(const mechanics::Touching<double>& touching,
                                                                const mechanics::TreeState& state) {
    const auto [first, second] = friction::along(touching);
    const auto along = [&](const Vector3& axis) {
        return acceleration_along(touching.row(axis, Vector3(Vector3::Zero())), state).first;
    };
    return {along(first), touching.is_in_plane ? 0.0 : along(second)};
}

RBDYN_INLINE void TreeModel::turn(const Mode& before, Mode& mode, double t, std::span<const double> x,
                                  const Fired& fired) const {
    namespace states = mechanics::contact_state;
    const mechanics::TreeState state = look(before, t, x);
    const auto lightest_at = [&](int k) {
        double mass = std::numeric_limits<double>::infinity();
        for (const int body : {conditions_->contacts()[at(k)].a.body, conditions_->contacts()[at(k)].b.body})
            if (body >= 0) mass = std::min(mass, static_cast<double>(tree_->node(body).mass));
        return mass > 0.0 ? mass : std::numeric_limits<double>::infinity();
    };
    std::vector<int> turning = fired.turning;
    for (const int k : fired.stopping)
        if (std::find(turning.begin(), turning.end(), k) == turning.end()) turning.push_back(k);
    for (const int k : turning) {
        const bool stops = std::find(fired.stopping.begin(), fired.stopping.end(), k) != fired.stopping.end();
        const auto touching = conditions_->contacts()[at(k)].touching<double>(*tree_, state.moving);
        mechanics::ContactMemory memory = mechanics::ContactMemory::of(mode.memory, k);
        const Vector3 slip = touching.slip();
        const double speed = slip.norm();
        const auto [first, second] = friction::along(touching);
        const auto [along_first, along_second] = slip_acceleration(touching, state);
        const Vector3 rate = first * along_first + second * along_second;
        // what it loses within the rounding of the time its end is located is none
        const double lost = epsilon * std::abs(t) * rate.norm(), bound = memory.least;
        memory.least = std::max(memory.least, 8.0 * lost);
        signed char& is = mode.slip[at(k)];
        const bool was_turning = states::follows_slip(is) || states::is_curved(is), starts = states::is_start(is),
                   was_straight = is == states::straight || is == states::rests;
        if (was_turning || was_straight)
            // nor is the rounding of the speeds that made it up
            memory.least = std::max(memory.least, 0x1p-43 * fastest_of(k, t, x, fired.largest, state.moving));
        // what has left its line by rounding goes on along it
        if (was_straight && std::abs(memory.axis.dot(slip)) <= 0.5 * memory.least) {
            // its bound is less than what rounding of the time hides: a larger one is told
            if (!stops && std::abs(memory.axis.dot(slip)) <= 0.5 * bound)
                memory.least = std::max({memory.least, 32.0 * lost, 16.0 * bound});
            memory.put(mode.memory, k);
            continue;
        }
        // and so does what is moved off it by no more than the rounding of what acts across it
        if (was_straight && !stops) {
            const auto [sum, size] = acceleration_along(touching.row(memory.axis, Vector3(Vector3::Zero())), state);
            if (std::abs(sum) <= 1e-14 * size + 64.0 * epsilon * forces_at(k, state) / lightest_at(k)) {
                memory.least = std::max(memory.least, 2.0 * std::abs(memory.axis.dot(slip)));
                memory.put(mode.memory, k);
                continue;
            }
        }
        // what an engine's accuracy cannot tell from rest stops along its last direction, but where it passes by in
        // steps that are longer than the rounding of the time
        const bool passes = speed > 64.0 * lost && slip.cross(rate).norm() > 0.125 * speed * rate.norm(),
                   is_least = was_turning && (!(speed > 1.5 * memory.least) || (stops && !passes));
        if (is_least) memory.least = std::max(memory.least, speed);
        // where nothing is left of it the last direction is all there is, and of what starts the slip so far is
        // rounding beside its first acceleration
        if (!starts && speed > 1e-3 * memory.least) memory.axis = touching.normal.cross(slip).normalized();
        memory.put(mode.memory, k);
        const signed char next = starts ? states::straight : is_least ? states::brief : states::turning;
        is = states::is_given(is) ? states::given(next) : next;
    }
    choose(mode, t, x, {});
}

RBDYN_INLINE std::string TreeModel::no_sliding(int contact) const {
    return "no force keeps " + conditions_->contacts()[at(contact)].name +
           " sliding: its friction turns the body into what it slides on as fast as its normal force turns it out "
           "(Painleve)";
}

RBDYN_INLINE std::string TreeModel::impulses_not_unique(const std::vector<double>& others,
                                                        const std::vector<int>& struck,
                                                        const std::vector<mechanics::Cone>& cones) const {
    const auto normal = [&](std::size_t i) { return std::abs(others[at(cones[i].first)]); };
    double most = 0.0;
    for (std::size_t i = 0; i < struck.size(); ++i) most = std::max(most, normal(i));
    std::vector<int> shared;
    for (std::size_t i = 0; i < struck.size(); ++i)
        if (normal(i) > 1e-9 * most) shared.push_back(struck[i]);
    return "the impulses of contacts that slide are not unique, and the motion depends on them, of " + names_of(shared);
}

RBDYN_INLINE std::string TreeModel::several_velocities(const std::vector<int>& struck) const {
    return "several velocities after the impact satisfy the laws of restitution and friction, of " + names_of(struck);
}

RBDYN_INLINE std::string TreeModel::names_of(const std::vector<int>& of) const {
    std::string names;
    for (const int k : of) names += (names.empty() ? "" : ", ") + conditions_->contacts()[at(k)].name;
    return names;
}

RBDYN_INLINE std::string TreeModel::no_forces(const std::string& what, const std::vector<int>& of) const {
    return "no " + what + " of contacts satisfy the laws of friction, of " + names_of(of);
}

RBDYN_INLINE std::string TreeModel::not_unique(const std::vector<int>& of) const {
    return "the forces of contacts that slide are not unique, and the motion depends on them, of " + names_of(of);
}

RBDYN_INLINE std::string TreeModel::impossible(const Mode& mode, double t, std::span<const double> x) const {
    if (mode.equations == nullptr) return {};
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    std::vector<int> near;
    const auto all = moving(t, x);
    for (int k = 0; k < contacts(); ++k) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        if (!c.is_gone && std::abs(c.touching<double>(*tree_, all).gap) <= 1e-9 * size_of(k, all)) near.push_back(k);
    }
    if (const std::string why = lies_flat(near, all); !why.empty()) return why;
    // what is left of it is the distance in which steps end before its zero
    for (const Guard& guard : mode.equations->guards)
        if (guard.kind == EventKind::singular && guard.contact >= 0 &&
            std::abs(values.output(guard.output)) <= 1e-3 * values.magnitude(guard.output))
            return no_sliding(guard.contact);
    return {};
}

RBDYN_INLINE void TreeModel::tell_friction(const Mode& mode, const Mode& after, const Fired& fired,
                                           const std::vector<mechanics::Moving<double>>& before,
                                           const std::vector<mechanics::Moving<double>>& now,
                                           std::vector<Happening>& happenings) const {
    using namespace mechanics::contact_state;
    // what stops with others within the rounding of its speed turns back with them, whichever of them is seen to
    const bool no_impact = mode.jumps == after.jumps;
    for (int k = 0; k < contacts(); ++k) {
        const signed char was = mode.slip[at(k)], is = after.slip[at(k)];
        const auto slides = [&](signed char s) {
            return mechanics::contact_state::slides(s) || (mechanics::contact_state::is_given(s) && is_rough(k));
        };
        const bool stops = std::find(fired.stopping.begin(), fired.stopping.end(), k) != fired.stopping.end();
        std::optional<EventKind> kind;
        if (slides(was) && is_held(is)) kind = EventKind::stick;
        if (is_held(was) && slides(is)) kind = EventKind::slip;
        if (slides(was) && slides(is) && (stops || no_impact) && !mechanics::contact_state::follows_slip(was)) {
            const auto direction = [&](const Mode& m, const auto& all) {
                const Vector3 normal = conditions_->contacts()[at(k)].touching<double>(*tree_, all).normal;
                return Vector3(mechanics::ContactMemory::of(m.memory, k).axis.cross(normal));
            };
            if (direction(mode, before).dot(direction(after, now)) < 0.5) kind = EventKind::reverse;
        }
        if (!kind) continue;
        Happening h{*kind, -1, Direction::falling, {}};
        h.contact = k;
        happenings.push_back(std::move(h));
    }
    tell_rolling(mode, after, happenings);
}

}  // namespace rbdyn::inline RBDYN_FORM
