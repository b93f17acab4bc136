// Definitions of rbdyn/event/driver.hpp: how a run ends, and how it goes on where no step does.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/progress.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Driver::finish(Record& record, Instant t, Status status) {
    record.end = t;
    // bounces that are left out may end later than the run
    std::erase_if(record.events, [&](const Event& e) { return e.instant - t > 0x1p-40 * std::abs(t.hi); });
    // what was found at the end of the last piece is not later than the end by its rounding
    for (auto e = record.events.rbegin(); e != record.events.rend() && e->instant - t > 0.0; ++e) {
        e->instant = t;
        e->time = t.hi;
    }
    record.status = status;
    record.work = engine_.work();
    record.changes = engine_.changes();
    if (record.thrown || now_.mode.equations == nullptr) return;
    now_.at = t;
    now_.low.resize(now_.x.size());
    if (!now_.fresh) engine_.standing(now_.x, now_.low);
    search_.leave(now_);
    if (!now_.mode.still) now_.engine = engine_.memory();
    now_.winding = winding_;
    record.halt = std::make_shared<const Halt>(now_);
}

RBDYN_INLINE void Driver::let_go(Record& record, bool is_over) {
    if (keep_events_.keeps_all()) return;
    std::vector<Event>& events = record.events;
    if (keep_events_.what == KeepEvents::What::last && !keep_events_.each) {
        if (!is_over && events.size() < few_) return;
        keep_last_of_each(events);
        few_ = std::max<std::size_t>(64, 2 * events.size());
        return;
    }
    // those of one instant may still change places, and what is found once more is known by those just before
    const Instant seen = std::exchange(looked_, now_.at);
    std::size_t done = 0;
    while (done < events.size() && (is_over || seen - events[done].instant > 8.0 * epsilon * std::abs(seen.hi)))
        keep_events_.each(events[done++]);
    if (is_over && record.status == Status::stopped_by_event)
        while (done > 0 && events[done - 1].time == record.end.hi) --done;
    events.erase(events.begin(), events.begin() + static_cast<std::ptrdiff_t>(done));
    record.handed_on += static_cast<std::int64_t>(done);
}

RBDYN_INLINE void Driver::break_off(Record& record, Instant t) {
    const Guard& guard = *search_.broken();
    record.not_finite =
        guard.least < 0.0 ? "constraints lose rank there, and a step ends so near to it that the motion beyond is not "
                            "known: " +
                                guard.name
        : guard.kind == EventKind::watch ? "watched function \"" + guard.name + "\""
        : !guard.name.empty()            ? guard.name
                                         : "what tells of " + std::string(name_of(guard.kind));
    if (guard.kind != EventKind::watch && guard.subject >= 0)
        record.not_finite += " (body " + std::to_string(guard.subject + 1) + ")";
    finish(record, t, Status::not_finite);
}

RBDYN_INLINE bool Driver::ends_in_small_steps(Record& record, const Piece& piece, double length, double until) {
    switch (progress_.after(now_.mode, piece, length, until, max_steps_)) {
        case Progress::Verdict::gets_on: return false;
        case Progress::Verdict::leads_nowhere: finish(record, now_.at, Status::step_limit); return true;
        case Progress::Verdict::jumps: break;
    }
    const auto& [variable, before, after] = progress_.jump();
    record.not_finite = model_.rate_name(variable) + " jumps from " + text(before) + " to " + text(after) +
                        " there, and the motion goes to and fro across the jump in steps of " + text(progress_.pace()) +
                        " s. What is called back cannot slide along a jump; what is recorded does";
    finish(record, now_.at, Status::inconsistent);
    return true;
}

RBDYN_INLINE void Driver::give_up(Record& record, const Mode& mode) {
    record.not_finite = mode.impossible;
    if (record.modes.empty()) record.modes.push_back(model_.undecided());
    // there is nothing to go on with
    now_.mode.equations = nullptr;
    finish(record, now_.at, Status::inconsistent);
}

RBDYN_INLINE bool Driver::may_pass() {
    if (++in_row_ > most_in_row) return false;
    if (now_.passes == 0 || now_.at - now_.passed_at > 1e-6 * (now_.at.hi - began_)) {
        now_.passes = 0;
        now_.passed_at = now_.at;
    }
    return ++now_.passes <= max_crowded;
}

RBDYN_INLINE std::vector<int> Driver::slips_that_end() const {
    std::vector<int> result;
    const Mode& mode = now_.mode;
    const auto ends = [](const Guard& guard) { return guard.kind == EventKind::stick && guard.renews; };
    const auto& guards = mode.equations->guards;
    if (mode.equations->program.has_calls() || std::ranges::none_of(guards, ends)) return result;
    const BorrowedSeries borrowed(mode.equations->program, 1);
    SeriesEvaluator& series = *borrowed;
    series.set_parameters(mode.parameters);
    series.begin(now_.at.hi, 1.0);
    for (std::size_t i = 0; i < now_.x.size(); ++i) series.set_input(static_cast<int>(i), 0, now_.x[i]);
    series.advance(0);
    series.integrate(0);
    series.advance(1);
    // steps are a small part of what is left of it
    const double left = 64.0 * epsilon * std::abs(now_.at.hi);
    for (std::size_t g = 0; g < guards.size(); ++g) {
        if (!ends(guards[g])) continue;
        const double* const speed = series.output(guards[g].output);
        if (speed[0] <= -speed[1] * left) result.push_back(static_cast<int>(g));
    }
    return result;
}

RBDYN_INLINE bool Driver::pass(Record& record, double until) {
    std::vector<double>& x = now_.x;
    Mode& mode = now_.mode;
    Instant& t = now_.at;
    std::vector<double> slope(x.size()), bend(x.size());
    const Slope known = model_.slope(mode, t.hi, x, slope, bend);
    const auto n = static_cast<std::size_t>(known.positions);
    if (!known.is_known) return false;
    double pace = known.pace;
    if (n == 0) {
        // what happens to be near zero says nothing of it
        const double fastest = std::abs(*std::max_element(
            slope.begin(), slope.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
        if (fastest > 0.0) pace = std::max(pace, progress_.extent() / fastest);
    }
    double time = std::min(until - t, pace);
    for (std::size_t i = 0; i < n; ++i)
        if (bend[i] != 0.0 && slope[i] != 0.0) time = std::min(time, std::abs(slope[i] / bend[i]));
    const double least = 8.0 * epsilon * std::abs(t.hi);
    double h = n > 0 ? 0x1p-27 * time : std::max(0x1p-40 * time, 8.0 * least);
    const double longest = 0x1p-20 * time;
    if (!(h > least) || h > longest) return false;
    std::vector<double> middle(x.size()), later(x.size()), later_bend(x.size());
    // what is at rest goes where the first forces that there are take it, and others may follow that direction
    const bool rests = std::ranges::all_of(slope, [](double rate) { return rate == 0.0; });
    const auto look_ahead = [&] {
        for (int turn = 0; turn < (rests ? 2 : 1); ++turn) {
            for (std::size_t i = 0; i < x.size(); ++i) middle[i] = x[i] + 0.5 * h * slope[i];
            if (!model_.slope(mode, t.hi + 0.5 * h, middle, later, later_bend).is_known) break;
            std::copy(later.begin() + static_cast<std::ptrdiff_t>(n), later.end(),
                      slope.begin() + static_cast<std::ptrdiff_t>(n));
            bend = later_bend;
        }
    };
    look_ahead();
    // what moves by less than rounding of its place has not left the point
    const auto has_left = [&](double by) {
        for (std::size_t i = 0; i < (n > 0 ? n : x.size()); ++i) {
            const double move = std::abs(slope[i] * by) + (i < n ? 0.5 * std::abs(bend[i]) * by * by : 0.0);
            if (move > 0.0 && move < 4.0 * epsilon * std::abs(x[i])) return false;
        }
        return true;
    };
    double longer = h;
    while (longer < longest && !has_left(longer)) longer = std::min(2.0 * longer, longest);
    if (longer > h && has_left(longer)) {
        h = longer;
        look_ahead();
    }
    std::vector<double> c(3 * x.size(), 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
        c[3 * i] = x[i];
        c[3 * i + 1] = slope[i] * h;
        if (i < n) c[3 * i + 2] = 0.5 * bend[i] * h * h;
    }
    const Piece piece{t, h, 1.0, record.variables, 2, c.data(), 3};
    ++passed_;
    store(record, piece, 1.0, true);
    piece.state(1.0, x);
    t = piece.at(1.0);
    now_.low.assign(x.size(), 0.0);
    now_.handled.clear();
    std::vector<Happening> none;
    mode = model_.next(mode, {}, t.hi, x, none);
    enter(record, mode, t, x, {});
    return true;
}

RBDYN_INLINE void Driver::rest(Record& record, Instant t, std::span<const double> x, double until) const {
    const Piece piece{t, until - t, 1.0, record.variables, 0, x.data(), 1};
    store(record, piece, 1.0, true);
}

}  // namespace rbdyn::inline RBDYN_FORM
