// Definitions of rbdyn/mechanics/tree_model.hpp: what follows where guards of contacts fire.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// One instant at which contacts do something, from the mode before it to the one after: which of them it concerns,
/// what impulses and forces make of them, and what is told.
struct TreeModel::Encounter {
    Encounter(const TreeModel& m, const Mode& before, Mode& next, double time, std::span<double> state,
              std::span<double> low, std::vector<Happening>& told)
        : model(m),
          mode(before),
          after(next),
          t(time),
          x(state),
          rest(low),
          happenings(told),
          was(state.begin(), state.end()),
          known(was),
          all(m.moving(time, state)),
          touching(at(m.contacts())),
          flight(time - before.memory[0]),
          impulses(at(m.contacts()), 0.0) {}

    const TreeModel& model;
    const Mode& mode;
    Mode& after;
    const double t;
    std::span<double> x, rest;
    std::vector<Happening>& happenings;
    const std::vector<double> was;                     // the state it comes with
    std::vector<double> known;                         // what `rest` belongs to
    const std::vector<mechanics::Moving<double>> all;  // how all moves as it comes
    // positions stay what they are: so does how contacts lie
    std::vector<std::optional<mechanics::Touching<double>>> touching;
    const double flight;           // since the bounces before [s]
    Fired events;                  // what has fired, and what comes to its surface with it
    std::vector<int> closed;       // contacts that touch
    std::vector<int> hit;          // of these, what impulses reach
    std::vector<int> at_rest;      // of these, what is not thrown back
    std::vector<int> group;        // those whose bounces end here
    std::vector<double> impulses;  // of each contact [N s]
    std::vector<double> fine;      // gaps beyond doubles
    Strokes strokes;
    LeftOut left;

    const mechanics::ContactLaw& law(int k) const { return model.conditions_->contacts()[at(k)]; }
    const mechanics::Touching<double>& touching_of(int k) {
        if (!touching[at(k)]) touching[at(k)] = law(k).touching<double>(*model.tree_, all);
        return *touching[at(k)];
    }
    mechanics::Row<double> row_of(int k) {
        return touching_of(k).row(touching_of(k).normal, touching_of(k).normal_rate);
    }
    double rate(const std::vector<mechanics::Moving<double>>& motion, int k) {
        return mechanics::Conditions::rate(row_of(k), motion);
    }
    bool is_open(int k) const { return mode.slip[at(k)] == flies && !law(k).is_gone; }
    /// What is at a place has no size of its own where that is the surface's: it is known as its time is.
    bool is_close(int k) {
        const double late = 4.0 * epsilon * std::abs(t) * model.speed_of(k, all);
        return std::abs(touching_of(k).gap) <= std::max(1e-13 * model.size_of(k, all), late);
    }
    bool is_slow(int k) { return rate(all, k) <= 1e-13 * model.speed_of(k, all); }
    static bool is_in(const std::vector<int>& list, int k) {
        return std::find(list.begin(), list.end(), k) != list.end();
    }
    /// Digits beyond doubles of what is no longer what it was.
    void forget() {
        for (std::size_t i = 0; i < x.size(); ++i)
            if (x[i] != known[i]) rest[i] = 0.0;
    }

    bool is_low(int k);
    bool comes_now(int k);
    void list(std::span<const int> fired);
    void reach();
    void strike();
    bool comes_back_at_once();
    bool stays_at_last();
    void let_fly(bool is_alone, double made_alone);
    void end_bounces();
    void come_to_rest(const Mode& struck, const std::vector<double>& bounced, const std::vector<int>& stuck,
                      const friction::JointLaw* joints);
    void tell();
};

/// Bounces of several contacts, or with friction, so low that doubles do not tell how high each of them is.
RBDYN_INLINE bool TreeModel::Encounter::is_low(int k) {
    // where friction rubs between them the digits beyond doubles tell as well what comes now and what later
    const bool is_free = model.joints_.empty() && model.resistances() == 0;
    const bool is_known = model.follows_together(mode) || (model.conditions_->is_rough() && is_free);
    return (model.contacts() > 1 || model.conditions_->is_rough()) && is_known &&
           flight > 4.0 * epsilon * std::abs(t) &&
           std::abs(rate(all, k)) * flight <= low_bounce * model.size_of(k, all);
}

/// Whether what is open comes to its surface at this very instant.
RBDYN_INLINE bool TreeModel::Encounter::comes_now(int k) {
    const double speed = -rate(all, k);
    if (!(is_close(k) && speed > 0.0)) return false;
    if (!is_low(k)) return true;
    if (fine.empty()) fine = model.fine_gaps(t, x, rest);
    return fine[at(k)] <= speed * std::max(4.0 * epsilon * std::abs(t), 1e-7 * flight);
}

/// What has fired of each contact, and what touches.
RBDYN_INLINE void TreeModel::Encounter::list(std::span<const int> fired) {
    for (int k = 0; k < model.contacts(); ++k) {
        for (const int index : fired) {
            const Guard& guard = mode.equations->guards[at(index)];
            if (guard.contact != k) continue;
            if (guard.joint >= 0) {
                const bool ends = guard.kind == EventKind::stick &&
                                  model.resisting(mode, guard.joint) == mechanics::contact_state::turning;
                if (ends) events.resisted_ending.push_back(guard.joint);
                std::vector<int>& list = guard.kind == EventKind::slip             ? events.resisted_breaking
                                         : guard.kind == EventKind::stick && !ends ? events.resisted_stopping
                                                                                   : events.resisted_turning;
                if (!is_in(list, guard.joint)) list.push_back(guard.joint);
                continue;
            }
            (guard.kind == EventKind::land       ? events.landing
             : guard.kind == EventKind::detach   ? events.doubtful
             : guard.kind == EventKind::slip     ? events.breaking
             : guard.kind == EventKind::stick    ? events.stopping
             : guard.kind == EventKind::singular ? events.singular
                                                 : events.turning)
                .push_back(k);
        }
        const bool is_closed = mode.slip[at(k)] != flies, has_fired = events.has(k);
        // what comes to its surface at this very instant strikes with the others;
        // what a joint has held over it touches as well, and strikes nothing with the rounding of a speed
        const bool is_near = !model.joints_.empty() && is_open(k) && is_close(k) && is_slow(k),
                   is_still = is_near && std::abs(rate(all, k)) <= 1e-14 * model.speed_of(k, all),
                   is_there = !has_fired && is_open(k) && !is_still && comes_now(k);
        if (is_there) events.landing.push_back(k);
        if (is_closed || has_fired || is_there || is_near) closed.push_back(k);
    }
    // what was thrown back at this very instant has not come again, where something else happens
    if (flight > 0.0 || (events.breaking.empty() && events.doubtful.empty())) return;
    const auto parts = [&](int k) { return is_open(k) && rate(all, k) > 0.0; };
    std::erase_if(closed, [&](int k) { return is_in(events.landing, k) && parts(k); });
    std::erase_if(events.landing, parts);
}

/// What impulses do not reach goes on as it did, whatever rounding makes of it; what flies along with what it touches,
/// pressed by nothing, is struck with it.
RBDYN_INLINE void TreeModel::Encounter::reach() {
    if (events.landing.empty()) return;
    std::vector<int> all_that_touch = closed;
    for (int k = 0; k < model.contacts(); ++k)
        if (!is_in(closed, k) && !law(k).is_gone && is_close(k) &&
            std::abs(rate(all, k)) <= 1e-13 * model.speed_of(k, all))
            all_that_touch.push_back(k);
    hit = model.reached(all_that_touch, events.landing);
    for (const int k : hit)
        if (!is_in(closed, k)) closed.push_back(k);
}

/// Impulses, and what goes on after them.
RBDYN_INLINE void TreeModel::Encounter::strike() {
    const std::vector<int>& landing = events.landing;
    const bool is_alone = closed.size() == 1 && landing.size() == 1 && model.rows_.empty() &&
                          model.resistances() == 0 && model.joints_.empty() && !model.conditions_->is_rough() &&
                          rate(all, closed.front()) < -1e-14 * model.speed_of(closed.front(), all);
    const bool are_low = std::any_of(landing.begin(), landing.end(), [&](int k) { return is_low(k); });
    double made_alone = 0.0;
    if (is_alone) {
        std::tie(impulses[at(closed.front())], made_alone) =
            model.strike_alone(t, x, rest, closed.front(), all, row_of(closed.front()));
        known.assign(x.begin(), x.end());
    } else {
        impulses = model.strike(mode, t, x, hit, strokes);
    }
    if (!strokes.impossible.empty()) {
        after.impossible = strokes.impossible;
        return;
    }
    // what comes to its surface without a speed has its guard behind it, and strikes nothing
    const bool strikes = std::any_of(impulses.begin(), impulses.end(), [](double one) { return one > 0.0; });
    if (strikes || !model.conditions_->is_rough()) ++after.jumps;
    events.stuck = strokes.stuck;
    // what impulses bring to rest is held, or breaks away, by the forces after them
    if (strikes) std::erase_if(events.breaking, [&](int k) { return is_in(strokes.stuck, k); });
    let_fly(is_alone, made_alone);
    model.settle(mode, after, t, x, at_rest, events);
    if (after.impossible.empty() && !at_rest.empty()) model.part(after, t, x, at_rest);
    // what comes with less than doubles know of a speed, and has nothing to press it, flies along
    if (after.impossible.empty() && !strikes && model.conditions_->is_rough()) model.part(after, t, x, landing, true);
    forget();
    if (are_low && after.impossible.empty()) model.meet(t, x, rest, closed);
    // what bounces alone, its flights long yet, goes on
    const bool goes_on = is_alone && model.goes_on_bouncing(closed.front(), t, flight, -rate(all, closed.front()), all);
    if (!goes_on) {
        double came = 0.0;
        for (const int k : landing) came = std::max(came, -rate(all, k));
        left.slid = model.conditions_->is_rough() && !model.follows_together(mode);
        group = model.accumulating(after, t, x, rest, closed, came, left);
        if (group.empty() && after.impossible.empty()) group = model.ending_by_turns(after, t, x, rest, closed, left);
        if (group.empty() && after.impossible.empty() && (comes_back_at_once() || stays_at_last())) group = closed;
    }
    if (group.empty() && after.impossible.empty() && flight <= 8.0 * epsilon * std::abs(t))
        group = model.collapsing(mode, after, t, x, rest, closed, strokes);
    after.memory[0] = t;
    if (!group.empty()) end_bounces();
}

/// Whether what was thrown back at this very instant is at its surface once more, not coming to it but pressed on it:
/// what is left of its bounces is less than the rounding of the speeds it differs by.
RBDYN_INLINE bool TreeModel::Encounter::comes_back_at_once() {
    if (closed.size() != 1 || flight > 8.0 * epsilon * std::abs(t) || mode.jumps == 0) return false;
    const double parts = rate(all, closed.front());
    if (parts < 0.0) return false;
    const auto [w, noise] = model.opening(after, t, x, closed);
    // of speeds, and of the phase of what drives surfaces
    const double rounding = 64.0 * epsilon * (model.speed_of(closed.front(), all) + std::abs(w.front() * t));
    return parts <= rounding && after.slip[at(closed.front())] == flies && w.front() < -noise.front();
}

/// Whether what bounces alone is thrown back no more after a flight of rounding: where the surface turns back it is too
/// slow for its speed to tell which bounce is the last.
RBDYN_INLINE bool TreeModel::Encounter::stays_at_last() {
    if (closed.size() != 1 || flight > 64.0 * epsilon * std::abs(t) || mode.jumps == 0) return false;
    return law(closed.front()).restitution > 0.0 && after.slip[at(closed.front())] != flies;
}

/// Opens what is thrown back.
RBDYN_INLINE void TreeModel::Encounter::let_fly(bool is_alone, double made_alone) {
    const auto motion = is_alone ? std::vector<mechanics::Moving<double>>() : model.moving(t, x);
    // what impulses make of velocities, and take again, leaves its rounding
    const auto made = is_alone ? std::vector<std::vector<double>>() : model.coupling(all, closed);
    const auto struck_size = [&](int k) {
        if (is_alone) return model.speed_of(k, all) + 2.0 * made_alone;
        const auto i = static_cast<std::size_t>(std::find(closed.begin(), closed.end(), k) - closed.begin());
        double size = std::max(model.speed_of(k, motion), model.speed_of(k, all));
        for (std::size_t j = 0; j < closed.size(); ++j) size += std::abs(made[i][j] * impulses[at(closed[j])]);
        return size;
    };
    std::erase_if(at_rest, [&](int k) {
        if (!is_in(hit, k)) return false;
        const double e = law(k).restitution, size = struck_size(k);
        const double u = is_alone ? -e * rate(all, k) : rate(motion, k);
        const bool bounces = impulses[at(k)] <= 0.0 || e > 0.0;
        // what comes back as fast as its own restitution says is no rounding of others; what was closed has not come
        const double back = mode.slip[at(k)] == flies ? -e * rate(all, k) : 0.0;
        const bool opens = bounces && (u > 1e-13 * size || (back > 8.0 * epsilon * size && u > 0.5 * back));
        if (opens) after.slip[at(k)] = flies;
        return opens;
    });
}

/// What is left of the bounces of a group is less than rounding: none of them moves any more.
RBDYN_INLINE void TreeModel::Encounter::end_bounces() {
    for (const int k : group)
        if (!is_in(at_rest, k)) at_rest.push_back(k);
    if (after.jumps == mode.jumps) ++after.jumps;
    const std::vector<double> bounced(x.begin(), x.end());
    const Mode struck = after;
    // friction without bound stops what it is not pushed along by
    std::vector<int> stuck = strokes.stuck;
    for (const int k : at_rest)
        if (law(k).never_slips() && (strokes.pushed.empty() || strokes.pushed[at(k)].isZero(0.0))) stuck.push_back(k);
    // a slip that ends within the rounding of the time is none
    const auto motion = model.moving(t, x);
    const double late = (left.slid ? model.mixed_bounce : 64.0) * epsilon * std::abs(t);
    for (const int k : at_rest)
        if (law(k).is_rough() && !law(k).mu_dynamic.is_zero() && !is_in(stuck, k) &&
            law(k).touching<double>(*model.tree_, motion).slip().norm() <= late * left.pull)
            stuck.push_back(k);
    come_to_rest(struck, bounced, stuck, nullptr);
    // joints that slide resist what is left out, pressed as they are then
    if (!model.joints_.empty() && after.impossible.empty())
        if (const auto joints = model.joint_law(after, t)) come_to_rest(struck, bounced, stuck, &*joints);
    std::fill(rest.begin() + model.tree_->positions(), rest.end(), 0.0);
}

/// The same while joints do what they do by a law, from the state and the mode that the last impulses have made.
RBDYN_INLINE void TreeModel::Encounter::come_to_rest(const Mode& struck, const std::vector<double>& bounced,
                                                     const std::vector<int>& stuck, const friction::JointLaw* joints) {
    std::copy(bounced.begin(), bounced.end(), x.begin());
    after = struck;
    Fired rested;
    rested.stuck = model.stop(t, x, at_rest, stuck, joints);
    // what is left of rates is rounding
    const auto place_of = [&](const mechanics::RoughJoint& joint) { return at(model.tree_->positions() + joint.v); };
    double fastest = 0.0;
    for (const mechanics::RoughJoint& joint : model.joints_)
        fastest = std::max(fastest, std::abs(bounced[place_of(joint)]));
    for (const mechanics::RoughJoint& joint : model.joints_) {
        double& v = x[place_of(joint)];
        if (joint.drive.is_zero() &&
            std::abs(v) <= std::max(1e-10 * std::abs(bounced[place_of(joint)]), 1e-13 * fastest))
            v = 0.0;
    }
    model.settle(mode, after, t, x, at_rest, rested);
}

/// What has become of contacts that touch.
RBDYN_INLINE void TreeModel::Encounter::tell() {
    for (const int k : closed) {
        const bool is = after.slip[at(k)] != flies;
        // what is closed and struck from elsewhere tells of itself only if it opens; a group comes to rest once
        const bool comes = is_in(events.landing, k), last = !group.empty() && k == group.front();
        const bool is_anew = is && mode.slip[at(k)] == flies;
        if (!comes && !last && is && !is_anew) continue;
        if (!group.empty() && !last && is) continue;
        // what a joint has held over it, and does on
        if (!comes && !last && !is && mode.slip[at(k)] == flies) continue;
        // what comes and goes without an impulse has not struck
        if (comes && !last && !is && impulses[at(k)] <= 0.0) continue;
        Happening h{last                 ? EventKind::accumulation
                    : !comes && !is_anew ? EventKind::detach
                    : is                 ? EventKind::land
                                         : EventKind::impact,
                    -1,
                    Direction::falling,
                    {}};
        h.contact = k;
        h.impulse = impulses[at(k)];
        h.push = strokes.pushed.empty() ? Vector3(touching_of(k).normal * h.impulse) : strokes.pushed[at(k)];
        if (comes && strokes.lowered < 1.0)
            h.note = "restitution lowered to " + text(strokes.lowered * law(k).restitution) +
                     ": more would gain energy, or ask what no impulses do";
        if (last) h.later = left.time;
        // torques against rolling act while what is left of the bounces goes on, and impacts know none; what bounces
        // alone is followed to its end
        if (last && model.conditions_->is_rough() &&
            (left.is_summed || (closed.size() > 1 && !model.follows_together(mode))))
            h.unsure = std::max(model.resistances() > 0 ? 1e-6 : 2e-11, left.unsure / std::abs(t));
        if (last && left.is_by_turns) h.unsure = left.unsure / std::abs(t);
        happenings.push_back(std::move(h));
    }
}

RBDYN_INLINE void TreeModel::touch(const Mode& mode, Mode& after, std::span<const int> fired, double t,
                                   std::span<double> x, std::span<double> rest, std::span<const double> largest,
                                   std::vector<Happening>& happenings) const {
    set_exactly(mode, fired, t, x, rest);
    Encounter now(*this, mode, after, t, x, rest, happenings);
    now.events.largest = largest;
    const bool joints_change = heed_joints(mode, after, fired, t, x, now.events, happenings);
    if (!after.impossible.empty()) return;
    now.forget();
    now.list(fired);
    stop_with_joints(mode, t, x, now.events);
    now.reach();
    if (!fired.empty() && !joints_change && now.events.none()) return choose(after, t, x, {});
    after.impossible = lies_flat(now.closed, now.all, no_tilt);
    if (after.impossible.empty()) after.impossible = lies_flat(now.events.singular, now.all);
    if (!after.impossible.empty()) return;
    now.at_rest = now.closed;
    if (now.events.landing.empty())
        settle(mode, after, t, x, now.at_rest, now.events);
    else
        now.strike();
    if (!now.strokes.impossible.empty()) return;
    if (!after.impossible.empty()) {
        if (const std::string why = lies_flat(now.closed, now.all); !why.empty()) after.impossible = why;
        return;
    }
    hold(after, t, x, rest);
    const auto closes = [&](int k) { return after.slip[at(k)] != flies && mode.slip[at(k)] == flies; };
    if (!now.events.landing.empty() || !now.group.empty() || std::any_of(now.closed.begin(), now.closed.end(), closes))
        quiet(after, t, x, rest);
    now.tell();
    if (conditions_->is_rough()) tell_friction(mode, after, now.events, now.all, moving(t, x), happenings);
    tell_joints(mode, after, happenings);
    tell_rest(mode, now.was, after, t, x, happenings);
    put_in_order(happenings);
    come_to_stand(after, t, x);
}

RBDYN_INLINE void TreeModel::put_in_order(std::vector<Happening>& happenings) const {
    if (happenings.size() < 2) return;
    const auto name = [&](const Happening& h) {
        return h.contact >= 0   ? conditions_->contacts()[at(h.contact)].name
               : h.subject >= 0 ? tree_->node(h.subject).name
                                : h.name;
    };
    std::stable_sort(happenings.begin(), happenings.end(), [&](const Happening& a, const Happening& b) {
        return a.kind != b.kind ? a.kind < b.kind : name(a) < name(b);
    });
}

}  // namespace rbdyn::inline RBDYN_FORM
