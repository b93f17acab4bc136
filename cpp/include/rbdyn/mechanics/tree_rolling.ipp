// Definitions of rbdyn/mechanics/tree_model.hpp and tree_writer.hpp: torques of contacts against rolling and pivoting.
//
// Where one side turns on the other the torque is its length times N, against the angular velocity along the surface,
// or about the normal; N depends on nothing else, so a contact's force brings the torque along. Where it does not turn
// it is held, by a row on angular velocities alone, until the torque would have to be more than that. Directions are
// those of contacts that slide (contact_state.hpp), along two directions of the plane that turn with it. What is held,
// and what breaks, is found with the forces of contacts: all that does not turn is held at first, and what is beyond
// its limit then begins to turn, against what held it. In an impact no torque of this kind acts: the length is that of
// a force that lasts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE void TreeWriter::guard_resistance(EquationsWriter& write, std::size_t e) const {
    using namespace contact_state;
    const signed char state = resistance_states_[e];
    if (state == flies) return;
    const Resistance& law = conditions_.resistances()[e];
    const ContactLaw& c = conditions_.contacts()[at(law.contact)];
    const Touching<S>& t = touching_[at(law.contact)];
    const std::string what = (law.pivots ? "pivoting of " : "rolling of ") + c.name;
    const auto guard = [&](EventKind kind, const S& value, bool renews = true) {
        write.guard(
            {.kind = kind, .contact = law.contact, .joint = static_cast<int>(e), .name = what, .renews = renews},
            value);
    };
    if (contact_state::is_held(state)) {
        const Vector3Of<S> torque = vector_at(place(law.contact) + 5);
        const S normal = dot<S>(t.normal, vector_at(place(law.contact)));
        const S limit = law.idle ? turning_[e].least : (law.pivots ? c.pivoting : c.rolling).in<S>() * normal;
        S square(0.0);
        for (int k = 0; k < law.rows(); ++k) {
            const S part = dot<S>(law.about(t, k), torque);
            square += part * part;
        }
        return guard(EventKind::slip, limit * limit - square);
    }
    const Turning& now = turning_[e];
    if (state == contact_state::turning) {
        guard(EventKind::stick, now.speed - now.least);
        return guard(EventKind::switching,
                     now.last[0] * now.rate[0] + now.last[1] * now.rate[1] - S(0.875) * now.speed);
    }
    guard(EventKind::stick, state == contact_state::starts ? now.speed + now.least : now.speed, false);
    if (state == brief || state == contact_state::starts)
        return guard(EventKind::switching, S(2.0) * now.least - now.speed);
    const S across = now.along[0] * now.rate[1] - now.along[1] * now.rate[0];
    guard(EventKind::switching, now.least - across);
    guard(EventKind::switching, now.least + across);
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::array<double, 2> TreeModel::rate_of(int resistance,
                                                      const std::vector<mechanics::Moving<double>>& all) const {
    const mechanics::Resistance& law = conditions_->resistances()[at(resistance)];
    const auto t = conditions_->contacts()[at(law.contact)].touching<double>(*tree_, all);
    std::array<double, 2> rate{};
    for (int k = 0; k < law.rows(); ++k) rate[at(k)] = law.about(t, k).dot(t.turning);
    return rate;
}

RBDYN_INLINE Vector3 TreeModel::twisting(const Mode& mode, int contact,
                                         const std::vector<mechanics::Moving<double>>& all) const {
    Vector3 torque = Vector3::Zero();
    for (int e = 0; e < resistances(); ++e) {
        const mechanics::Resistance& law = conditions_->resistances()[at(e)];
        if (law.contact != contact || !mechanics::contact_state::slides(resisting(mode, e))) continue;
        const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
        const auto t = c.touching<double>(*tree_, all);
        const mechanics::ResistanceMemory memory = resistance_memory(mode, e);
        std::array<double, 2> along{memory.along[0], memory.along[1]};
        if (resisting(mode, e) == mechanics::contact_state::turning) {
            along = rate_of(e, all);
            const double speed = std::hypot(along[0], along[1]);
            for (double& part : along) part /= speed;
        }
        const double length = law.pivots ? c.pivoting : c.rolling;
        for (int k = 0; k < law.rows(); ++k) torque -= law.about(t, k) * (along[at(k)] * length);
    }
    return torque;
}

RBDYN_INLINE std::vector<int> TreeModel::rows_without_contacts(const Mode& mode) const {
    std::vector<int> rows = rows_;
    for (int e = 0; e < resistances(); ++e)
        for (int k = 0; k < 2; ++k)
            if (mechanics::contact_state::is_row(resisting(mode, e), k))
                rows.push_back(conditions_->resistance_row(e, k));
    for (int i = 0; i < static_cast<int>(joints_.size()); ++i)
        if (mode.slip[at(first_joint() + i)] == mechanics::joint_state::held) rows.push_back(conditions_->joint_row(i));
    return rows;
}

RBDYN_INLINE void TreeModel::decide_resistances(
    const Mode& before, Mode& mode, double t, std::span<double> x, const std::vector<int>& closed, const Fired& fired,
    const std::vector<std::pair<int, std::array<double, 2>>>& breaking) const {
    using namespace mechanics::contact_state;
    const auto all = moving(t, x);
    const auto is_in = [](const std::vector<int>& list, int k) {
        return std::find(list.begin(), list.end(), k) != list.end();
    };
    // how quickly what a contact joins changes how it turns on it [rad/s^2]
    const auto pace_of = [&](int k) {
        double pace = 0.0;
        if (before.equations == nullptr) return pace;
        const mechanics::TreeState now = look(before, t, x);
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        const double size = size_of(k, now.moving);
        for (const int body : {c.a.body, c.b.body}) {
            if (body < 0) continue;
            const mechanics::TreeState::Body& b = now.bodies[at(body)];
            pace += b.angular_acceleration.norm() + (size > 0.0 ? b.acceleration.norm() / size : 0.0);
        }
        return pace;
    };
    std::vector<int> rows = rows_;
    for (int e = 0; e < resistances(); ++e) {
        const mechanics::Resistance& law = conditions_->resistances()[at(e)];
        signed char& state = mode.slip[at(contacts() + e)];
        const signed char was = resisting(before, e);
        state = flies;
        if (!is_in(closed, law.contact)) continue;
        mechanics::ResistanceMemory memory = resistance_memory(before, e);
        const std::array<double, 2> rate = rate_of(e, all);
        const double speed = std::hypot(rate[0], rate[1]);
        double fastest = 0.0;
        const mechanics::ContactLaw& c = conditions_->contacts()[at(law.contact)];
        for (const int body : {c.a.body, c.b.body})
            if (body >= 0) fastest = std::max(fastest, all[at(body)].omega.norm());
        const bool goes_on = before.jumps == mode.jumps && was != flies;
        // rates far below those of what acts are rounding
        const double size = size_of(law.contact, all), pull = scene_.gravity().norm();
        const double least =
            0x1p-43 * std::max({fastest, std::sqrt(pull / size), mechanics::contact_state::least_speed});
        const auto begins =
            std::find_if(breaking.begin(), breaking.end(), [&](const auto& one) { return one.first == e; });
        // what stops together does so within the rounding of its speeds
        const bool stops = is_in(fired.resisted_stopping, e) || (goes_on && mechanics::contact_state::is_held(was)) ||
                           speed <= 16.0 * (!goes_on || !slides(was)          ? least
                                            : fired.resisted_stopping.empty() ? 0.0
                                                                              : memory.least);
        if (law.idle) {
            // behind what resists rolling, of the same contact
            const bool stands_still = stops && begins == breaking.end() &&
                                      mechanics::contact_state::is_held(mode.slip[at(contacts() + e - 1)]);
            if (!stands_still) continue;
            double weight = 0.0;
            for (const int body : {c.a.body, c.b.body})
                if (body >= 0) weight += static_cast<double>(tree_->node(body).mass) * pull;
            memory.least = 1e-13 * weight * size;
        }
        if (begins != breaking.end()) {
            memory.along[0] = begins->second[0];
            memory.along[1] = begins->second[1];
            // no rate is known better than by what it changes, or would if nothing held it, within the rounding of the
            // time: what begins, or goes straight back, may have as much the other way
            memory.least = std::max({least, 2.0 * speed, 8.0 * epsilon * std::abs(t) * pace_of(law.contact)});
            state = mechanics::contact_state::starts;
        } else if (stops) {
            state = held;
            for (int k = 0; k < law.rows(); ++k) {
                std::vector<int> with = rows;
                with.push_back(conditions_->resistance_row(e, k));
                if (mechanics::independent_rows(*tree_, *conditions_, with, all, rows.size()).size() < with.size())
                    continue;
                rows = std::move(with);
                state = static_cast<signed char>(state + (1 << k));
            }
        } else if (goes_on && slides(was)) {
            state = was;
        } else {
            memory.along[0] = rate[0] / speed;
            memory.along[1] = rate[1] / speed;
            memory.least = least;
            state = straight;
        }
        memory.put(mode.memory.data() + place_of_resistance(e));
    }
}

RBDYN_INLINE void TreeModel::settle_resisted(const Mode& before, Mode& mode, double t, std::span<double> x,
                                             const std::vector<int>& candidates, const Fired& fired) const {
    using namespace mechanics::contact_state;
    const Mode undecided = mode;
    // the direction in which what is held is pulled
    const auto pulled = [&](const Mode& in, int e) {
        const mechanics::Resistance& law = conditions_->resistances()[at(e)];
        const mechanics::TreeState state = look(in, t, x);
        const auto touching = conditions_->contacts()[at(law.contact)].touching<double>(*tree_, state.moving);
        std::array<double, 2> along{};
        for (int k = 0; k < law.rows(); ++k) along[at(k)] = -law.about(touching, k).dot(state.torques[at(law.contact)]);
        const double size = std::hypot(along[0], along[1]);
        for (double& part : along) part = size > 0.0 ? part / size : 0.0;
        return along;
    };
    std::vector<std::pair<int, std::array<double, 2>>> breaking;
    for (const int e : fired.resisted_breaking) breaking.emplace_back(e, pulled(before, e));
    std::vector<int> closed = candidates;
    for (int turn = 0; turn <= 2 * (contacts() + resistances()); ++turn) {
        mode = undecided;
        decide_resistances(before, mode, t, x, closed, fired, breaking);
        // another form of the same motion
        const auto all = moving(t, x);
        for (const int e : fired.resisted_turning) {
            signed char& state = mode.slip[at(contacts() + e)];
            if (!slides(state)) continue;
            mechanics::ResistanceMemory memory = resistance_memory(mode, e);
            const std::array<double, 2> rate = rate_of(e, all);
            const double speed = std::hypot(rate[0], rate[1]);
            const bool is_ending =
                std::find(fired.resisted_ending.begin(), fired.resisted_ending.end(), e) != fired.resisted_ending.end();
            const bool is_least =
                state == mechanics::contact_state::turning && (is_ending || !(speed > 1.5 * memory.least));
            const bool has_started = state == mechanics::contact_state::starts;
            if (is_least) memory.least = std::max(memory.least, speed);
            if (!has_started && speed > 1e-3 * memory.least) {
                memory.along[0] = rate[0] / speed;
                memory.along[1] = rate[1] / speed;
            }
            memory.put(mode.memory.data() + place_of_resistance(e));
            state = has_started ? straight : is_least ? brief : mechanics::contact_state::turning;
        }
        settle_rough(before, mode, t, x, candidates, fired);
        if (!mode.impossible.empty()) return;
        bool changes = false;
        std::erase_if(closed, [&](int k) {
            const bool opens = mode.slip[at(k)] == flies;
            for (int e = 0; e < resistances(); ++e)
                changes = changes || (opens && conditions_->resistances()[at(e)].contact == k);
            return opens;
        });
        if (changes) continue;
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t, x);
        for (const Guard& guard : mode.equations->guards) {
            if (guard.kind != EventKind::slip || guard.contact < 0 || guard.joint < 0 || guard.output < 0) continue;
            const double value = values.output(guard.output), size = values.magnitude(guard.output);
            const bool leaves =
                value < -1e-13 * size || (value <= 1e-13 * size && leading_sign(mode, t, x, guard.output, 1) < 0);
            if (!leaves || changes) continue;
            breaking.emplace_back(guard.joint, pulled(mode, guard.joint));
            changes = true;
        }
        if (changes) continue;
        for (int e = 0; e < resistances(); ++e) {
            const int k = conditions_->resistances()[at(e)].contact;
            if (!slides(resisting(mode, e)) || !mechanics::contact_state::is_held(mode.slip[at(k)]) ||
                !mechanics::ContactMemory::of(mode.memory, k).shares)
                continue;
            mode.impossible = "the forces of contacts that stick are not unique, and the torque that " +
                              conditions_->contacts()[at(k)].name +
                              " turns against follows from them: no law says which motion it is";
            return;
        }
        return;
    }
    mode.impossible = "no torques satisfy the laws of friction against rolling, of " +
                      conditions_->contacts()[at(conditions_->resistances().front().contact)].name;
}

RBDYN_INLINE void TreeModel::tell_rolling(const Mode& mode, const Mode& after,
                                          std::vector<Happening>& happenings) const {
    for (int e = 0; e < resistances(); ++e) {
        const signed char was = resisting(mode, e), is = resisting(after, e);
        if (conditions_->resistances()[at(e)].idle) continue;
        std::optional<EventKind> kind;
        if (mechanics::contact_state::slides(was) && mechanics::contact_state::is_held(is)) kind = EventKind::stick;
        if (mechanics::contact_state::is_held(was) && mechanics::contact_state::slides(is)) kind = EventKind::slip;
        if (mechanics::contact_state::slides(was) && is == mechanics::contact_state::starts &&
            was != mechanics::contact_state::starts)
            kind = EventKind::reverse;
        if (!kind) continue;
        Happening h{*kind, -1, Direction::falling, {}};
        h.contact = conditions_->resistances()[at(e)].contact;
        happenings.push_back(std::move(h));
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
