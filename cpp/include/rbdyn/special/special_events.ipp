// Definitions of rbdyn/special/special_model.hpp: where a motion begins, and what follows an event.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/bead_law.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Mode SpecialModel::begin(double t, std::span<double> x) const {
    Mode mode = undecided();
    // what starts on the edge of a case is looked at from the side it leaves to
    choose(mode, t, x, {});
    for (const int i : laws_->beads()) {
        const BeadLaw& b = laws_->bead(i);
        // the slip as the user gave it, so that a bead carried by its rail starts stuck
        if (b.rough()) mode.slip[at(i)] = slip_of(mode, i, b.start_speed(), t, x);
    }
    mode.equations = nullptr;
    choose(mode, t, x, {});
    // what its rail would have to pull flies from the start, and what moves off its end
    for (const int i : laws_->beads()) {
        let_go(mode, i, t, x);
        leave_end(mode, i, t, x);
    }
    return mode;
}

RBDYN_INLINE Mode SpecialModel::next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                                     std::vector<Happening>& happenings) const {
    if (const int i = at_corner(mode, fired, x); i >= 0) {
        happenings.push_back({EventKind::singular, i, Direction::either, {}});
        return mode;
    }
    Mode after = mode;
    std::vector<int> flipped;
    bool is_new = false;
    // changes of the user's own come first
    for (int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        if (guard.kind != EventKind::watch) continue;
        happenings.push_back({EventKind::watch, -1, guard.direction, guard.name});
        change(after, watches_[at(guard.watch)], t, x);
        is_new = true;
        ++after.jumps;
    }
    for (int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        const int i = guard.subject;
        const double sign = guard.sign_parameter >= 0 ? mode.parameters[at(guard.sign_parameter)] : 1.0;
        const Direction direction = sign > 0.0 ? Direction::falling : Direction::rising;
        switch (guard.kind) {
            case EventKind::watch: break;
            case EventKind::reverse: {
                const signed char before = mode.slip[at(i)];
                after.slip[at(i)] = settle(after, i, t, x);
                if (after.slip[at(i)] == sticks)
                    happenings.push_back({EventKind::stick, i, direction, {}});
                else if (after.slip[at(i)] != before)
                    happenings.push_back({EventKind::reverse, i, direction, {}});
                break;
            }
            case EventKind::slip: {
                carry(mode, i, t, x);
                const signed char s = escape(mode, i, t, x, holding(mode, i, t, x));
                after.slip[at(i)] = s;
                happenings.push_back({EventKind::slip, i, s > 0 ? Direction::rising : Direction::falling, {}});
                break;
            }
            case EventKind::detach:
            case EventKind::rail_end:
                release(after, i, t, x);
                happenings.push_back({guard.kind, i, direction, {}});
                break;
            case EventKind::land: {
                const double impulse = land(after, i, t, x);
                ++after.jumps;
                happenings.push_back({EventKind::land, i, Direction::falling, {}, impulse});
                break;
            }
            default: {
                flipped.push_back(index);
                // a variable that switches is zero, exactly
                if (mode.equations->is_variable(guard)) x[at(mode.equations->program.output(guard.output))] = 0.0;
                if (guard.kind == EventKind::switching && guard.name.empty()) break;
                // where the reaction of a rail that only pushes vanishes the bead detaches, and that is said
                if (guard.kind == EventKind::normal_zero && laws_->bead(i).only_pushes()) break;
                Happening h{guard.kind, i, guard.step > 0 ? Direction::rising : direction,
                            guard.kind == EventKind::switching ? guard.name : std::string()};
                // several distinctions of one function at one place are one event
                if (std::none_of(happenings.begin(), happenings.end(), [&](const Happening& other) {
                        return other.kind == h.kind && other.subject == h.subject && other.name == h.name;
                    }))
                    happenings.push_back(std::move(h));
                break;
            }
        }
    }
    choose(after, t, x, flipped, is_new);
    if (!flipped.empty() && follow_drives(mode, after, t, x, happenings)) {
        after.equations = mode.equations;
        after.parameters = mode.parameters;
        choose(after, t, x, flipped, is_new);
    }
    if (same_motion(mode, after, flipped))
        std::erase_if(happenings, [](const Happening& h) { return h.kind == EventKind::switching; });
    for (int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        if (guard.kind == EventKind::land && let_go(after, guard.subject, t, x))
            happenings.push_back({EventKind::detach, guard.subject, Direction::falling, {}});
    }
    return after;
}

RBDYN_INLINE void SpecialModel::change(Mode& mode, const Scene::Watch& watch, double t, std::span<double> x) const {
    const std::string user = "watch " + watch.name;
    for (const StateChange& c :
         watch.options.action.change(asked_->checked(observing(mode, t, x), user + ", its action"))) {
        const int i = c.body.index;
        require(i >= 0 && i < bodies(), user, "body", i, "its action changes bodies of this scene");
        const std::vector<double> before(x.begin(), x.end());
        if (const auto speed = laws_->body(i).change(c, LawsNow(*laws_, mode.slip, t, before), user, x))
            mode.slip[at(i)] = slip_of(mode, i, *speed, t, x);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
