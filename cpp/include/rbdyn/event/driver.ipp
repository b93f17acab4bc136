// Definitions of rbdyn/event/driver.hpp.
#pragma once

#include "rbdyn/event/driver.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/event/search.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Driver::Driver(const HybridModel& model, Engine& engine, std::int64_t max_steps, Keep keep,
                            Monitor monitor, double slack, bool is_alone, double tolerance)
    : model_(model),
      engine_(engine),
      max_steps_(max_steps),
      keep_(std::move(keep)),
      monitor_(std::move(monitor)),
      search_(model, engine, slack, is_alone),
      progress_(tolerance),
      stops_from_(-std::numeric_limits<double>::infinity()) {
    std::sort(keep_.times.begin(), keep_.times.end());
}

template <class Part>
bool Driver::guarded(Record& record, const Part& part) {
    try {
        try {
            if (part()) return true;
        } catch (const Stopped&) {
            finish(record, now_.at, Status::stopped_by_user);
            // between the steps it was about to become another motion, and no run goes on from there
            if (!is_in_step_) record.halt = nullptr;
        }
        let_go(record, true);
    } catch (...) {
        record.thrown = std::current_exception();
        // also the start that could not be left has its state
        if (record.modes.empty()) record.modes.push_back(model_.undecided());
        finish(record, now_.at, Status::stopped_by_user);
    }
    return false;
}

RBDYN_INLINE Record Driver::run(double start, std::vector<double> x, double until) {
    Record record;
    now_ = {.at = {start, 0.0}, .x = std::move(x), .low = {}, .mode = {}, .begins = true};
    guarded(record, [&] {
        begin(record);
        proceed(record, until);
        return false;
    });
    return record;
}

RBDYN_INLINE Record Driver::go_on(const Halt& halt, double until) {
    Record record;
    now_ = halt;
    guarded(record, [&] {
        resume(record);
        proceed(record, until);
        return false;
    });
    return record;
}

RBDYN_INLINE bool Driver::set_out(Record& record, double start, std::vector<double> x, double until) {
    now_ = {.at = {start, 0.0}, .x = std::move(x), .low = {}, .mode = {}, .begins = true};
    return guarded(record, [&] {
        begin(record);
        return is_possible(record) && comes_to_step(record, until);
    });
}

RBDYN_INLINE bool Driver::go_on_after(Record& record, StepStatus step, double until) {
    return guarded(record, [&] { return is_going_on(record, step, until) && comes_to_step(record, until); });
}

RBDYN_INLINE void Driver::begin(Record& record) {
    std::vector<double>& x = now_.x;
    record.start = began_ = now_.at.hi;
    record.variables = model_.variables();
    record.end = now_.at;
    record.first_state = x;
    now_.mode = model_.begin(now_.at.hi, x);
    // what is set anew there is what it is
    std::vector<double>& low = now_.low = model_.start_rest();
    for (std::size_t i = 0; i < low.size(); ++i)
        if (x[i] != record.first_state[i]) low[i] = 0.0;
    record.first_state = x;
    if (keep_.what == Keep::What::times && keep_.winds) winding_ = model_.winding(now_.at.hi, x);
    if (!now_.mode.impossible.empty()) return;
    enter(record, now_.mode, now_.at, x, {}, true);
    if (!low.empty() && !now_.mode.still) engine_.carry(low);
    low.resize(x.size());
}

RBDYN_INLINE void Driver::resume(Record& record) {
    record.start = began_ = now_.at.hi;
    record.variables = model_.variables();
    record.end = now_.at;
    record.first_state = now_.x;
    if (keep_.what == Keep::What::times && keep_.winds) winding_ = now_.winding;
    const bool fresh = now_.fresh;
    const std::vector<int> fired = std::exchange(now_.fired, {});
    enter(record, now_.mode, now_.at, now_.x, now_.handled, now_.begins);
    search_.recall(now_);
    search_.set_crowded(now_.crowded);
    if (!now_.mode.still) {
        engine_.carry(now_.low);
        engine_.recall(now_.engine);
    }
    now_.fresh = fresh;
    if (fired.empty()) return;
    // what stopped the run has stopped it
    record.modes.clear();
    change(record, fired, nullptr, 0.0);
    record.first_state = now_.x;
}

RBDYN_INLINE void Driver::proceed(Record& record, double until) {
    if (!is_possible(record)) return;
    // a single step of much may be long, and long ones ask on their way
    std::optional<Interruption> asking;
    if (monitor_)
        asking.emplace([this] {
            if (!monitor_(now_.at.hi)) throw Stopped{};
        });
    while (comes_to_step(record, until)) {
        is_in_step_ = true;
        const StepStatus step = engine_.step(until);
        is_in_step_ = false;
        if (!is_going_on(record, step, until)) break;
    }
}

RBDYN_INLINE bool Driver::is_possible(Record& record) {
    if (now_.mode.impossible.empty()) return true;
    give_up(record, now_.mode);
    return false;
}

RBDYN_INLINE bool Driver::comes_to_step(Record& record, double until) {
    std::vector<double>& x = now_.x;
    Instant& t = now_.at;
    const auto over = [&](Status status) {
        finish(record, t, status);
        return false;
    };
    if (until - t > least_before(record, until)) {
        let_go(record, false);
        if (!now_.mode.still) {
            // bounces without loss get on, and may come a million times a second
            const std::int64_t events = record.handed_on + static_cast<std::int64_t>(record.events.size());
            if (engine_.work().steps + engine_.work().parts + passed_ >= max_steps_ || events > max_steps_)
                return over(Status::step_limit);
            if (monitor_ && (engine_.work().steps & 63) == 63 && !monitor_(t.hi)) return over(Status::stopped_by_user);
            memory_.after(engine_.work().steps, record, t.hi, until, max_steps_);
            return true;
        }
        if (search_.examine_still(record, now_.mode, t, x)) return over(Status::stopped_by_event);
        if (search_.broken() != nullptr) {
            break_off(record, t);
            return false;
        }
        rest(record, t, x, until);
        t = {until, 0.0};
    }
    const bool stops = search_.settle(record, now_.mode, t, x, now_.fresh);
    finish(record, {until, 0.0}, stops ? Status::stopped_by_event : Status::reached_end);
    return false;
}

RBDYN_INLINE bool Driver::is_going_on(Record& record, StepStatus step, double until) {
    std::vector<double>& x = now_.x;
    Instant& t = now_.at;
    const auto over = [&](Status status) {
        finish(record, t, status);
        return false;
    };
    if (step != StepStatus::ok) {
        if (!now_.fresh && !record.empty()) record.last_state(x);
        if (std::string why = model_.impossible(now_.mode, t.hi, x); !why.empty()) {
            Mode after = now_.mode;
            after.impossible = std::move(why);
            give_up(record, after);
            return false;
        }
        if (const std::vector<int> ends = slips_that_end(); in_row_ == 0 && !ends.empty()) {
            ++in_row_;
            now_.low.resize(x.size());
            if (!now_.fresh) engine_.standing(x, now_.low);
            return change(record, ends, nullptr, 0.0);
        }
        if (!may_pass() || !pass(record, until)) return over(Status::not_finite);
        now_.fresh = true;
        is_form_ = false;
        return true;
    }
    const Piece& piece = engine_.piece();
    // a first step hardly longer than the rounding of time begins at a point that is to be passed, or beside it, but
    // where the motion has only taken another form
    if (now_.fresh && !is_form_ && piece.length * piece.unit < 64.0 * epsilon * std::abs(t.hi) && may_pass() &&
        pass(record, until)) {
        now_.fresh = true;
        return true;
    }
    const bool is_last = !(until - piece.at(piece.length) > least_before(record, until));
    in_row_ = 0;
    const double cut = search_.examine(record, now_.mode, now_.fresh, is_last);
    if (cut < 0.0) {
        store(record, piece, piece.length, now_.fresh);
        t = piece.at(piece.length);
        now_.fresh = now_.begins = false;
        return !ends_in_small_steps(record, piece, piece.length, until);
    }
    // a true end of this piece at the event, exact in the engine's own terms
    const Instant at = cut < piece.length ? piece.at(cut) : piece.at(piece.length);
    store(record, piece, cut, now_.fresh);
    std::vector<double>& low = now_.low;
    engine_.state(cut, x);
    low.resize(x.size());
    engine_.rest(cut, x, low);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Instant sum = exact_sum(x[i], low[i]);
        x[i] = sum.hi;
        low[i] = sum.lo;
    }
    now_.fresh = true;
    if (search_.broken() != nullptr) {
        break_off(record, at);
        return false;
    }
    // bounces are followed until they are shorter than that
    const auto& guards_there = now_.mode.equations->guards;
    const bool all_land = std::all_of(search_.fired().begin(), search_.fired().end(), [&](int index) {
        const Guard& guard = guards_there[static_cast<std::size_t>(index)];
        return guard.contact >= 0 && guard.kind == EventKind::land;
    });
    now_.crowded = at - t > (all_land ? 1.0 : 8.0) * epsilon * std::abs(at.hi) ? 0 : now_.crowded + 1;
    search_.set_crowded(now_.crowded);
    t = at;
    if (search_.stops()) {
        const auto& guards = now_.mode.equations->guards;
        for (int index : search_.fired())
            // what the equations say beyond is none of the laws
            if (guards[static_cast<std::size_t>(index)].kind == EventKind::singular) return over(Status::not_finite);
        for (int index : search_.fired()) {
            const Guard& guard = guards[static_cast<std::size_t>(index)];
            note(record, {guard.kind, guard.subject, search_.direction(index), guard.name}, t);
        }
        if (t.hi > stops_from_) {
            now_.fired = search_.fired();
            return over(Status::stopped_by_event);
        }
    }
    return change(record, search_.fired(), &piece, cut);
}

RBDYN_INLINE std::vector<int> Driver::without_stops(const std::vector<int>& fired) const {
    std::vector<int> rest;
    for (const int index : fired)
        if (now_.mode.equations->guards[static_cast<std::size_t>(index)].role != GuardRole::stop) rest.push_back(index);
    return rest;
}

RBDYN_INLINE bool Driver::change(Record& record, const std::vector<int>& fired, const Piece* piece, double cut) {
    std::vector<double>& x = now_.x;
    const Instant t = now_.at;
    const std::vector<double> reached = x;
    now_.low.resize(x.size());
    std::vector<Happening> happenings;
    const Equations* before = now_.mode.equations;
    // what only stops the run changes nothing
    const std::vector<int> changing = without_stops(fired);
    const bool has_stops = changing.size() < fired.size();
    Mode after = changing.empty()
                     ? now_.mode
                     : model_.next_with_rest(now_.mode, changing, t.hi, x, now_.low, engine_.largest(), happenings);
    if (std::any_of(happenings.begin(), happenings.end(),
                    [](const Happening& h) { return h.kind == EventKind::singular; })) {
        finish(record, t, Status::not_finite);
        return false;
    }
    if (!after.impossible.empty()) {
        give_up(record, after);
        return false;
    }
    // the guards just handled are at their zero, whatever rounding makes of them: those of the same equations,
    // those of the same surface in others, and watched functions
    std::vector<bool> handled(after.equations->guards.size(), false);
    for (int index : fired) {
        const Guard& guard = before->guards[static_cast<std::size_t>(index)];
        if (guard.watch < 0) {
            // a force that has only touched zero is known to be there
            const bool touches =
                guard.contact >= 0 && guard.kind == EventKind::detach && after.parameters == now_.mode.parameters;
            // nor is a length at zero that begins with no power of time
            const Switch* length = before->switch_of(guard);
            const bool is_beside = length != nullptr && length->is_norm &&
                                   after.parameters[static_cast<std::size_t>(length->parameter)] == 0.0;
            if (after.equations == before && (!guard.renews || touches) && !is_beside)
                handled[static_cast<std::size_t>(index)] = true;
            if (const auto surface = before->surface_of(guard))
                for (std::size_t g = 0; g < handled.size(); ++g)
                    handled[g] = handled[g] || after.equations->surface_of(after.equations->guards[g]) == surface;
            continue;
        }
        for (std::size_t g = 0; g < handled.size(); ++g) {
            const Guard& now = after.equations->guards[g];
            if (guard.role != GuardRole::stop && now.watch == guard.watch) search_.forget_side(now);
            handled[g] = handled[g] || now.part == guard.part;
        }
        for (Happening& h : happenings)
            if (h.kind == EventKind::watch && h.name == guard.name) h.direction = search_.direction(index);
    }
    // forces that come to zero one after the other at one instant, and push on, are all known to be there
    if (now_.crowded > 0 && after.equations == before && after.parameters == now_.mode.parameters &&
        after.jumps == now_.mode.jumps && now_.handled.size() == handled.size())
        for (std::size_t g = 0; g < handled.size(); ++g) {
            const Guard& guard = before->guards[g];
            if (guard.contact >= 0 && guard.kind == EventKind::detach) handled[g] = handled[g] || now_.handled[g];
        }
    // what was closed, or strikes, and opens begins at its surface
    const bool all_touch = std::all_of(fired.begin(), fired.end(), [&](int index) {
        return before->guards[static_cast<std::size_t>(index)].contact >= 0;
    });
    if (all_touch && (model_.follows_bounces(after) || now_.mode.jumps == after.jumps))
        for (std::size_t g = 0; g < handled.size(); ++g)
            handled[g] = handled[g] || opens(*before, fired, after.equations->guards[g]);
    is_form_ =
        happenings.empty() && after.jumps == now_.mode.jumps && std::all_of(fired.begin(), fired.end(), [&](int index) {
            const EventKind kind = before->guards[static_cast<std::size_t>(index)].kind;
            return kind == EventKind::switching || kind == EventKind::stick;
        });
    now_.mode = std::move(after);
    if (rounds_otherwise_) round_otherwise(reached);
    // what is at zero where the motion begins, or rounding beside it, tells how it begins and is no event
    now_.begins =
        now_.begins && piece != nullptr && (search_.fires_at_start() || has_not_moved(record, *piece, cut, reached));
    // where the run was stopped all of it is noted
    for (const Happening& h : happenings)
        if (!has_stops && (!now_.begins || h.kind == EventKind::watch)) note(record, h, t);
    // what goes on switching without getting on has no smooth motion; bounces get on towards their limit
    const bool bounces =
        !happenings.empty() && std::all_of(happenings.begin(), happenings.end(), [](const Happening& h) {
            return h.kind == EventKind::impact && h.contact >= 0 && h.impulse > 0.0;
        });
    if (!(bounces && now_.crowded == 0) && ++changes_ % 1000 == 0) {
        if (changes_ > 1000 && t - chattered_ < 1e-9 * (t.hi - record.start)) {
            record.not_finite =
                "it goes on switching without getting on, a thousand times within " + text(t - chattered_) + " s";
            finish(record, t, Status::inconsistent);
            return false;
        }
        chattered_ = t;
    }
    // changes of the user's that come ever sooner, as the bounces of a ball do
    const auto again = std::find_if(fired.begin(), fired.end(), [&](int index) {
        const Guard& guard = before->guards[static_cast<std::size_t>(index)];
        return guard.watch >= 0 && guard.role == GuardRole::mode;
    });
    if (now_.crowded > max_crowded && again != fired.end()) {
        const std::string& name = before->guards[static_cast<std::size_t>(*again)].name;
        note(record, {EventKind::accumulation, -1, Direction::either, name}, t);
        record.not_finite = "watch \"" + name +
                            "\" changes the state ever sooner, without end: its events accumulate here. What follows "
                            "is for its action to say: one that sets what comes to rest (to zero, once it is small "
                            "enough), or \"stop\"";
        finish(record, t, Status::inconsistent);
        return false;
    }
    if (std::string why; now_.crowded > max_crowded && !(why = model_.impossible(now_.mode, t.hi, x)).empty()) {
        now_.mode.impossible = std::move(why);
        give_up(record, now_.mode);
        return false;
    }
    if (now_.crowded > max_crowded) {
        record.not_finite = "it goes on switching without getting on, a hundred times at one instant";
        finish(record, t, Status::inconsistent);
        return false;
    }
    now_.handled = handled;
    enter(record, now_.mode, t, x, std::move(handled), now_.begins);
    if (!now_.mode.still) engine_.carry(now_.low);
    now_.fresh = true;
    return true;
}

RBDYN_INLINE bool Driver::opens(const Equations& before, const std::vector<int>& fired, const Guard& guard) {
    if (guard.contact < 0 || guard.kind != EventKind::land) return false;
    for (std::size_t g = 0; g < before.guards.size(); ++g)
        if (before.guards[g].contact == guard.contact && before.guards[g].kind == EventKind::land)
            return std::find(fired.begin(), fired.end(), static_cast<int>(g)) != fired.end();
    return true;
}

RBDYN_INLINE bool Driver::has_not_moved(const Record& record, const Piece& piece, double place,
                                        std::span<const double> x) {
    if (place > 16.0 * epsilon * piece.length) return false;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (std::abs(x[i] - record.first_state[i]) > 64.0 * epsilon * std::abs(record.first_state[i])) return false;
    return true;
}

RBDYN_INLINE void Driver::enter(Record& record, const Mode& mode, Instant t, std::span<const double> x,
                                std::vector<bool> handled, bool begins) {
    record.modes.push_back(mode);
    search_.enter(mode, std::move(handled), begins);
    if (!mode.still) engine_.start(*mode.equations, mode.parameters, t, x);
}

RBDYN_INLINE void Driver::store(Record& record, const Piece& piece, double length, bool fresh) const {
    const int mode = static_cast<int>(record.modes.size()) - 1;
    if (keep_.what == Keep::What::times) {
        const double lo = piece.start.hi, hi = piece.at(length).hi;
        const auto wanted = std::lower_bound(keep_.times.begin(), keep_.times.end(), lo);
        // the piece that holds a wanted time, and the last one so far
        if (record.entries().size() > kept_) record.drop_last();
        record.append(piece, length, mode, fresh);
        if (!winding_.empty()) {
            record.windings.push_back(winding_);
            model_.wind(piece, length, winding_);
        }
        if (wanted != keep_.times.end() && *wanted <= hi) kept_ = record.entries().size();
        return;
    }
    if (keep_.what != Keep::What::end) return record.append(piece, length, mode, fresh);
    record.clear();
    // nor are modes kept, but for the first one and that of the piece
    if (mode > 1) record.modes.erase(record.modes.begin() + 1, record.modes.end() - 1);
    record.append(piece, length, std::min(mode, 1), fresh);
}

RBDYN_INLINE void Driver::note(Record& record, const Happening& h, Instant t) {
    const Instant at = h.later > 0.0 ? t + h.later : t;
    record.note({at.hi, h.kind, h.subject, h.name, h.direction, h.impulse, h.contact, h.push, at, h.note, 1, h.unsure});
}

}  // namespace rbdyn::inline RBDYN_FORM
