// Definitions of rbdyn/trajectory/accuracy.hpp.
#pragma once

#include "rbdyn/trajectory/accuracy.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/trajectory/error_scales.hpp"
#include "rbdyn/trajectory/strike_order.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE AccuracyCheck::AccuracyCheck(const HybridModel& model, double wanted, std::function<bool(double)> proceed,
                                          double widening, const MotionBefore* before)
    : model_(model), wanted_(wanted), widening_(widening), before_(before), proceed_(std::move(proceed)) {}

RBDYN_INLINE Comparison AccuracyCheck::operator()(const Record& run, const Record& better,
                                                  std::span<const double> times) {
    Comparison result;
    result.certain_until = run.end.hi;
    differences_.clear();
    for (auto& kind : largest_) kind.clear();
    last_ = run.start;
    samples_ = 0;
    scales_.clear();
    named_.clear();
    if (before_ != nullptr) scales_ = before_->scales;
    const double start = before_ != nullptr ? before_->origin : run.start;
    start_ = start;
    const double span = std::max(run.end.hi - start, std::numeric_limits<double>::min());
    const auto loses_rank = [](const Event& e) { return e.kind == EventKind::singular; };
    loses_rank_ = std::ranges::any_of(run.events, loses_rank) || std::ranges::any_of(better.events, loses_rank);

    // times of events
    double uncertain = std::numeric_limits<double>::infinity();
    const std::vector<double> our_limits = limits_of(run), their_limits = limits_of(better);
    const std::vector<Event> ours = in_order(run, our_limits, start), theirs = in_order(better, their_limits, start);
    // which of the last bounces still belong to those left out rounding decides, too
    const auto is_last = [&](const std::vector<Event>& events, std::size_t k, const std::vector<double>& limits) {
        return k < events.size() && is_last_bounce(events[k], limits, start, 2.0 * last_bounces);
    };
    std::size_t i = 0, j = 0;
    int alike = 0;
    std::vector<StrikeOfTwo> strikes;
    for (; i < ours.size() && j < theirs.size(); ++i, ++j) {
        // a graze that one of them sees as a hold of no length changes nothing
        while (differ(ours, i, theirs, j) && is_graze(ours, i, start)) skip_graze(ours, i, result);
        while (differ(ours, i, theirs, j) && is_graze(theirs, j, start)) j += 2;
        while (differ(ours, i, theirs, j) && is_last(ours, i, our_limits)) ++i;
        while (differ(ours, i, theirs, j) && is_last(theirs, j, their_limits)) ++j;
        if (differ(ours, i, theirs, j)) break;
        const Event &a = ours[i], &b = theirs[j];
        // a time is told to the nearest double, however late the motion begins
        const double rounding = 0.5 * (std::nextafter(std::abs(b.time), std::numeric_limits<double>::infinity()) -
                                       std::abs(b.time)),
                     error = std::max(std::abs(a.instant - b.instant), rounding / widening_) /
                             std::max({b.instant - Instant{start, 0.0}, rounding, std::numeric_limits<double>::min()});
        differences_.push_back({a.time, std::max(error, a.unsure), -1});
        if (StrikeOfTwo::is_one(a)) strikes.push_back({&a, &b});
        ++alike;
    }
    while (is_graze(ours, i, start)) skip_graze(ours, i, result);
    while (is_graze(theirs, j, start)) j += 2;
    // one event more or less within the error of the end is no difference
    const double near_end = run.end.hi - wanted_ * span;
    const auto counted = [&](const std::vector<Event>& events, std::size_t next) {
        int count = alike;
        for (; next < events.size(); ++next)
            if (events[next].time < near_end) ++count;
        return count;
    };
    result.events = counted(ours, i);
    result.better_events = counted(theirs, j);
    const double odd =
        std::min(i < ours.size() ? ours[i].time : uncertain, j < theirs.size() ? theirs[j].time : uncertain);
    // what rounding decided both may have decided alike
    for (const Record* r : {&run, &better})
        if (r->doubt && r->doubt->hi < run.end.hi) {
            result.same_events = false;
            result.by_rounding = true;
            uncertain = std::min(uncertain, r->doubt->hi);
        }
    if (!run.empty())
        if (const auto order = unknown_order(model_, run, strikes, start, wanted_)) {
            result.same_events = false;
            uncertain = std::min(uncertain, *order);
        }
    if (odd < near_end) {
        result.same_events = false;
        uncertain = std::min(uncertain, odd);
    }
    // beyond the end of the better run nothing is known, and of a run without a piece nothing at all
    if (!run.empty() && better.empty() && !is_formula(better)) uncertain = run.start;
    if (better.end.hi < near_end) uncertain = std::min(uncertain, better.end.hi);
    if (times.empty())
        compare_motion(run, better, places(run), uncertain);
    else
        compare_motion(run, better, times, uncertain);
    scales_.settle(wanted_, span);
    // what begins as rounding and ends as many times that has grown with the motion, and has in the better run, too:
    // after a quarter of the time, or where it grows quicker, after as little as makes it more than what any power up
    // to the second of the time does
    constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
    struct Early {
        double part, growth, found = std::numeric_limits<double>::epsilon();
    };
    std::array<Early, 2> earlies{{{first_part, 100.0}, {1.0 / 32.0, 2000.0}}};
    const Difference* worst = nullptr;
    for (const Difference& d : differences_) {
        const double found = d.what < 0 ? d.value : scales_.relative(static_cast<std::size_t>(d.what), d.value);
        double& difference = d.what < 0 ? result.event_difference : result.motion_difference;
        if (!d.is_shared) {
            difference = std::max(difference, found);
            for (Early& early : earlies)
                if (d.since - start < early.part * span) early.found = std::max(early.found, found);
        }
        const double error = widening_ * found;
        if (error > result.error) worst = &d;
        result.error = std::max(result.error, error);
        if (error > wanted_) uncertain = std::min(uncertain, d.since);
    }
    const double most = std::max(result.motion_difference, result.event_difference);
    result.amplifies = std::ranges::any_of(
        earlies, [&](const Early& early) { return early.found <= rounding && most > early.growth * early.found; });
    result.quickens = quickens(run);
    // rounding: what two runs share is not seen by comparing them
    const double steps = static_cast<double>(std::max<std::size_t>(run.entries().size(), 1));
    const double floor = std::numeric_limits<double>::epsilon() * std::sqrt(steps);
    const double shared = widening_ * (floor + scales_.rounding());
    const auto words_of = [&](int what) {
        const auto k = static_cast<std::size_t>(what);
        return what >= 0 && k < named_.size() ? named_[k].words() : std::string();
    };
    if (const int rounded = scales_.most_rounded(); rounded >= 0 && shared >= result.error) {
        if (const std::string words = words_of(rounded); !words.empty()) result.worst = "the rounding of " + words;
    } else if (worst != nullptr) {
        result.worst = worst->what < 0 ? "the time of an event, " + text(worst->since) + " s" : words_of(worst->what);
    }
    result.error += shared;
    if (uncertain < near_end && better.end.hi < run.end.hi) result.same_events = false;
    if (!result.same_events) result.error = std::numeric_limits<double>::infinity();
    result.certain_until = std::min(result.certain_until, uncertain);
    result.stopped = stopped_;
    result.scales = scales_;
    return result;
}

RBDYN_INLINE void AccuracyCheck::compare_motion(const Record& run, const Record& better, std::span<const double> times,
                                                double until) {
    if (run.variables == 0 && !run.modes.empty()) see_given(run, until);
    if (run.empty() || (better.empty() && !is_formula(better))) return;
    x_.resize(static_cast<std::size_t>(run.variables));
    y_.resize(x_.size());
    std::vector<Place> places;
    places.reserve(times.size());
    std::size_t j = 0;  // piece of the better run
    for (const double t : times) {
        if (t >= until || t > run.end.hi) break;
        if (const auto place = place_of({t, 0.0}, run, run.find(t, Side::before), better, j)) places.push_back(*place);
    }
    choose(places, run, better);
    int asked = 0;
    for (const Place& place : places) {
        if (!place.is_chosen) continue;
        compare_at(place, run, better);
        if (proceed_ && ++asked % 128 == 0 && !proceed_(place.at.hi)) {
            stopped_ = true;
            return;
        }
    }
}

RBDYN_INLINE void AccuracyCheck::choose(std::span<Place> places, const Record& run, const Record& better) {
    const std::size_t n = x_.size(), every = (places.size() + enough_places - 1) / enough_places;
    if (every <= 1 || n == 0 || n > most_places) return;
    const auto& entries = run.entries();
    for (std::size_t p = 0; p < places.size(); ++p) {
        const std::size_t i = places[p].piece;
        // spread by the golden section, so that no period of the motion hides from them
        const double part = std::fmod(0.6180339887498949 * static_cast<double>(p / every), 1.0);
        const bool is_last = i + 1 == entries.size() || entries[i + 1].mode != entries[i].mode;
        places[p].is_chosen = is_last || p % every == static_cast<std::size_t>(part * static_cast<double>(every));
    }
    // and where states are farthest apart, each variable in parts of the motion
    const std::size_t parts = std::clamp<std::size_t>(most_places / (2 * n), 1, 4);
    std::vector<double> most(n);
    std::vector<std::size_t> where(n);
    for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t end = (part + 1) * places.size() / parts;
        std::ranges::fill(most, -1.0);
        for (std::size_t p = part * places.size() / parts; p < end; ++p) {
            states(places[p], run, better);
            for (std::size_t k = 0; k < n; ++k) {
                const double apart = std::abs(x_[k] - y_[k]);
                if (!(apart > most[k])) continue;
                most[k] = apart;
                where[k] = p;
            }
        }
        for (std::size_t k = 0; k < n; ++k)
            if (most[k] > 0.0) places[where[k]].is_chosen = true;
    }
}

RBDYN_INLINE std::vector<std::size_t> AccuracyCheck::quickest(const Record& run) {
    const std::size_t pieces = run.entries().size(), n = static_cast<std::size_t>(std::max(run.variables, 0));
    // in parts of the motion, for what is late in one phase is later in the next: of each variable, if they are few,
    // and of that which is nearest to its quickest
    const std::size_t parts = std::clamp<std::size_t>(most_places / std::max<std::size_t>(n, 1), 1, quick_parts);
    struct Quick {
        double rate = 0.0;
        std::size_t where = 0;
    };
    std::vector<Quick> most(parts * n);
    for (std::size_t part = 0; part < parts; ++part) {
        Quick* const own = most.data() + part * n;
        for (std::size_t i = part * pieces / parts; i < (part + 1) * pieces / parts; ++i) {
            const Piece piece = run.piece(i);
            if (piece.order == 0) continue;
            const double by_unit = 1.0 / piece.unit;
            for (std::size_t k = 0; k < n; ++k)
                if (const double rate = std::abs(piece.variable(static_cast<int>(k))[1]) * by_unit; rate > own[k].rate)
                    own[k] = {rate, i};
        }
    }
    std::vector<double> largest(n, 0.0);
    for (std::size_t part = 0; part < parts; ++part)
        for (std::size_t k = 0; k < n; ++k) largest[k] = std::max(largest[k], most[part * n + k].rate);
    std::vector<std::size_t> found;
    for (std::size_t part = 0; part < parts; ++part) {
        const std::span<const Quick> own(most.data() + part * n, n);
        double nearest = 0.0;
        std::size_t best = pieces;
        for (std::size_t k = 0; k < n; ++k) {
            if (own[k].rate > 0.0 && n <= most_places) found.push_back(own[k].where);
            if (own[k].rate <= nearest * largest[k]) continue;
            nearest = own[k].rate / largest[k];
            best = own[k].where;
        }
        if (best < pieces && n > most_places) found.push_back(best);
    }
    return found;
}

RBDYN_INLINE double AccuracyCheck::quickens(const Record& run) {
    constexpr std::size_t looked_at = 64;
    const std::size_t pieces = run.entries().size(), n = static_cast<std::size_t>(std::max(run.variables, 0));
    if (pieces == 0) return 1.0;
    const std::size_t every = (pieces + looked_at - 1) / looked_at;
    struct Way {
        double size = 0.0, rate = 0.0;
    };
    std::vector<Way> first(n), all(n);
    for (std::size_t i = (pieces - 1) % every; i < pieces; i += every) {
        const Piece piece = run.piece(i);
        if (piece.order == 0) continue;
        const bool is_early = piece.at(0.0).hi - run.start <= first_part * (run.end.hi - run.start);
        for (std::size_t k = 0; k < n; ++k) {
            const auto variable = piece.variable(static_cast<int>(k));
            const double rate = std::abs(variable[1]) / piece.unit;
            // a size that it has within the piece, for it may begin at zero
            const Way now{std::abs(variable[0]) + rate * piece.unit * piece.length, rate};
            for (Way* way : {&all[k], is_early ? &first[k] : &all[k]})
                *way = {std::max(way->size, now.size), std::max(way->rate, now.rate)};
        }
    }
    // of what moves quickest beside its size: what hardly moves at first does not say how rounding grows
    const auto pace = [](const std::vector<Way>& ways) {
        double most = 0.0;
        for (const Way& way : ways)
            if (way.size > 0.0) most = std::max(most, way.rate / way.size);
        return most;
    };
    const double before = pace(first);
    return before > 0.0 ? std::max(1.0, pace(all) / before) : 1.0;
}

RBDYN_INLINE std::vector<double> AccuracyCheck::places(const Record& run) {
    std::vector<double> times;
    const std::size_t pieces = run.entries().size(), every = std::max<std::size_t>(pieces / most_places, 1);
    const auto shared_by = [&](std::size_t in_all) { return in_all / std::max<std::size_t>(pieces, 1); };
    const int few = static_cast<int>(shared_by(least_places)),
              halved = static_cast<int>(std::bit_floor(std::min(shared_by(least_interpolated), most_parts)));
    const auto add = [&](std::size_t i, int parts) {
        for (int part = 1; part <= parts; ++part) {
            const double fraction = static_cast<double>(part) / parts;
            times.push_back(run.piece(i).at(fraction * run.entries()[i].length).hi);
        }
    };
    for (std::size_t i = 0; i < pieces; ++i) {
        // where a mode ends the other run may be in the next one already
        const bool is_last = i + 1 == pieces || run.entries()[i + 1].mode != run.entries()[i].mode;
        if (!is_last && (i + 1) % every != 0) continue;
        // what is interpolated is known less well within a step than at its end
        const bool is_interpolated = run.piece(i).order <= interpolated;
        const int least = is_interpolated ? std::max(halved, 2) : few;
        add(i, std::max(least, is_last ? 2 : 1));
    }
    if (every == 1) return times;
    // short and quick phases of a long motion, where being late shows most
    for (const std::size_t i : quickest(run)) add(i, 2);
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

RBDYN_INLINE std::optional<AccuracyCheck::Place> AccuracyCheck::place_of(Instant at, const Record& run, std::size_t i,
                                                                         const Record& better, std::size_t& j) {
    Place place{.at = at, .piece = i};
    const Piece piece = run.piece(i);
    place.here = (at - piece.start) / piece.unit;
    if (place.here > piece.length * (1.0 + 1e-9)) return std::nullopt;
    place.here = std::clamp(place.here, 0.0, piece.length);
    if (is_formula(better)) {
        if (!same_mode(run.mode(i), better.modes.front())) return std::nullopt;
        return place;
    }
    while (j + 1 < better.entries().size() && at - better.entries()[j + 1].start > 0.0) ++j;
    if (!same_mode(run.mode(i), better.mode(j))) return std::nullopt;
    const Piece fine = better.piece(j);
    place.fine_piece = j;
    place.there = (at - fine.start) / fine.unit;
    if (place.there > fine.length * (1.0 + 1e-9)) return std::nullopt;
    // an event that leaves the mode as it was, an impact, is past in one of them: the nearest of the better run is its
    // own
    const auto& entries = run.entries();
    const bool ends_at_event =
        i + 1 < entries.size() && entries[i + 1].after_event && at.hi == piece.at(piece.length).hi;
    if (ends_at_event && better.entries()[j].after_event && place.there < 0.5 * fine.length) return std::nullopt;
    place.there = std::clamp(place.there, 0.0, fine.length);
    return place;
}

RBDYN_INLINE void AccuracyCheck::states(const Place& place, const Record& run, const Record& better) {
    run.piece(place.piece).state(place.here, x_);
    if (is_formula(better))
        better.closed->state(exact_difference(place.at, {better.closed_from, 0.0}), y_);
    else
        better.piece(place.fine_piece).state(place.there, y_);
}

RBDYN_INLINE void AccuracyCheck::compare_at(const Place& place, const Record& run, const Record& better) {
    states(place, run, better);
    const Instant at = place.at;
    const Mode &mode = run.mode(place.piece),
               &fine_mode = is_formula(better) ? better.modes.front() : better.mode(place.fine_piece);
    model_.observe(mode, at.hi, x_, seen_);
    model_.observe(fine_mode, at.hi, y_, fine_);
    double nearer = 1.0;
    const bool is_lost = is_doubtful() && weigh_forces(fine_mode, at.hi, y_, nearer);
    leave_out_rounding(nearer);
    scales_.widen(fine_);
    const bool has_forces = !is_lost && !ends_at_once(run, place.piece, at);
    note(1.0, false, has_forces);
    // what half a unit in the last place of the state does, which two runs may share; a sample of long runs will do
    const int sample = samples_++;
    if (sample % (sample < 8 ? 2 : 8) == 0) {
        x_ = y_;
        for (double& x : x_) x = std::nextafter(x, 2.0 * x);
        model_.observe(fine_mode, at.hi, x_, seen_);
        leave_out_rounding(nearer);
        note(0.5, true, has_forces);
        if (is_of_time(fine_mode)) note_late(fine_mode, at.hi, y_);
        // and where forces depend on time, and it begins late, the rounding of the time at which they are taken
        if (start_ != 0.0 && !is_formula(better) && is_of_time(fine_mode)) {
            x_ = y_;
            move_on(better.piece(place.fine_piece), place.there, std::numeric_limits<double>::epsilon() * start_);
            model_.observe(fine_mode, at.hi, x_, seen_);
            note(1.0, true, false);
        }
    }
    last_ = at.hi;
}

RBDYN_INLINE bool AccuracyCheck::is_of_time(const Mode& mode) {
    return mode.equations != nullptr && mode.equations->program.uses_time();
}

RBDYN_INLINE void AccuracyCheck::note_late(const Mode& mode, double t, std::span<const double> x) {
    const double rounding = 0.5 * std::numeric_limits<double>::epsilon() * std::abs(t), later = t + 2.0 * rounding,
                 earlier = t - 2.0 * rounding;
    if (!(later > t && earlier < t)) return;
    // a function that jumps does so on one side
    std::vector<Observed> other;
    model_.observe(mode, earlier, x, other);
    model_.observe(mode, later, x, seen_);
    for (std::size_t k = 0; k < seen_.size(); ++k)
        if (safe_norm(other[k].value - fine_[k].value) < safe_norm(seen_[k].value - fine_[k].value))
            seen_[k].value = other[k].value;
    note(0.5 * rounding / (later - t), true, false);
}

RBDYN_INLINE void AccuracyCheck::see_given(const Record& run, double until) {
    constexpr int parts = 32;
    const Mode& mode = run.modes.front();
    if (!is_of_time(mode)) return;
    for (int part = 0; part <= parts; ++part) {
        const double t = run.start + (run.end.hi - run.start) * part / parts;
        if (t > until) break;
        model_.observe(mode, t, {}, fine_);
        scales_.widen(fine_);
        last_ = t;
        note_late(mode, t, {});
    }
}

RBDYN_INLINE void AccuracyCheck::move_on(const Piece& piece, double place, double time) {
    const double part = 1e-6 * piece.length, there = place < 0.5 * piece.length ? place + part : place - part;
    if (!(part > 0.0)) return;
    std::vector<double> then(y_.size());
    piece.state(there, then);
    for (std::size_t i = 0; i < then.size(); ++i) x_[i] += time / piece.unit * (then[i] - y_[i]) / (there - place);
}

RBDYN_INLINE bool AccuracyCheck::ends_at_once(const Record& run, std::size_t piece, Instant at) const {
    const auto& entries = run.entries();
    const double near = wanted_ * (at.hi - start_);
    for (std::size_t k = piece; k + 1 < entries.size(); ++k) {
        if (entries[k + 1].start - at > near) return false;
        if (entries[k + 1].mode != entries[k].mode) return true;
    }
    return false;
}

RBDYN_INLINE bool AccuracyCheck::weigh_forces(const Mode& mode, double t, std::span<const double> x, double& nearer) {
    // not farther away than forces are to be known from anywhere, nor nearer than the distance itself is known
    constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon(), least = 0x1p-20, widest = 0x1p-6;
    const double near = model_.independence(mode, t, x);
    const bool is_lost = near < std::clamp(rounding / wanted_, least, widest);
    nearer = std::max(1.0, widest / near);
    for (Observed& o : fine_) {
        // nothing is measured against forces that are as large as a place there is near
        if (is_lost) {
            o.drive = 0.0;
            if (o.alike == Alike::turning) o.whole = safe_norm(o.value);
            if (is_force(o)) o = {.alike = o.alike};
        } else if (is_force(o)) {
            // their rounding is over the distance, also of those that are none
            o.whole *= nearer;
        }
    }
    return is_lost;
}

RBDYN_INLINE void AccuracyCheck::leave_out_rounding(double nearer) {
    if (!(nearer > 1.0)) return;
    // multipliers are known to rounding over the square of the distance; once it is in `whole`
    constexpr double nothing = 1e3 * std::numeric_limits<double>::epsilon();
    for (std::size_t k = 0; k < fine_.size(); ++k) {
        const double rounding = nothing * nearer * fine_[k].whole;
        if (!is_force(fine_[k]) || !(safe_norm(fine_[k].value) <= rounding)) continue;
        fine_[k].value = Vector3::Zero();
        if (safe_norm(seen_[k].value) <= 2.0 * rounding) seen_[k].value = Vector3::Zero();
    }
}

RBDYN_INLINE bool AccuracyCheck::is_doubtful() const {
    if (loses_rank_) return true;
    for (std::size_t k = 0; k < fine_.size(); ++k)
        if (is_force(fine_[k]) &&
            fine_[k].part * safe_norm(seen_[k].value - fine_[k].value) > wanted_ * safe_norm(fine_[k].value))
            return true;
    return false;
}

RBDYN_INLINE void AccuracyCheck::note(double weight, bool is_shared, bool has_forces) {
    std::vector<double>& largest = largest_[is_shared ? 1 : 0];
    largest.resize(fine_.size(), -1.0);
    if (named_.size() < fine_.size()) named_.resize(fine_.size());
    for (std::size_t k = 0; k < fine_.size(); ++k) {
        if (!has_forces && is_force(fine_[k])) continue;
        const double off = safe_norm(seen_[k].value - fine_[k].value) - fine_[k].none,
                     value = off < 0.0 ? 0.0 : weight * fine_[k].part * off;
        if (!(value > largest[k])) continue;
        largest[k] = value;
        named_[k] = fine_[k];
        differences_.push_back({last_, value, static_cast<int>(k), is_shared});
    }
}

RBDYN_INLINE bool AccuracyCheck::same_mode(const Mode& a, const Mode& b) {
    if (a.slip != b.slip || a.equations != b.equations || a.jumps != b.jumps) return false;
    // sides of corners are parameters of the same equations
    const auto is_same = [&](const Switch& s) {
        const auto sign = static_cast<std::size_t>(s.parameter);
        return s.is_norm || a.parameters[sign] == b.parameters[sign];
    };
    return a.equations == nullptr || std::ranges::all_of(a.equations->program.switches(), is_same);
}

}  // namespace rbdyn::inline RBDYN_FORM
