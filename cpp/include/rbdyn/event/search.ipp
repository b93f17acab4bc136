// Definitions of rbdyn/event/search.hpp.
#pragma once

#include "rbdyn/event/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/sort_few.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/refined_taylor.hpp"
#include "rbdyn/event/passages.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/event/rough_passages.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/at_zero.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/leading_sign.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE EventSearch::EventSearch(const HybridModel& model, Engine& engine, double slack, bool is_alone)
    : model_(model), engine_(engine), slack_(slack), is_alone_(is_alone) {}

RBDYN_INLINE void EventSearch::enter(const Mode& mode, std::vector<bool> handled, bool begins) {
    handled_ = std::move(handled);
    begins_ = begins;
    begins_on_edge_.reset();
    zeros_.reset();
    sides_.assign(mode.equations->guards.size(), 0);
    ends_.assign(mode.equations->guards.size(), 0.0);
    passed_at_end_.clear();
    passed_before_.clear();
}

RBDYN_INLINE void EventSearch::leave(Halt& halt) const {
    halt.watched = watched_;
    halt.sides = sides_;
    halt.ends = ends_;
    halt.handled = handled_;
    halt.passed = passed_at_end_;
}

RBDYN_INLINE void EventSearch::recall(const Halt& halt) {
    watched_ = halt.watched;
    const std::size_t guards = sides_.size();
    if (halt.sides.size() == guards) sides_ = halt.sides;
    if (halt.ends.size() == guards) ends_ = halt.ends;
    if (halt.passed.size() == guards) passed_before_ = halt.passed;
}

RBDYN_INLINE void EventSearch::forget_side(const Guard& guard) {
    Watched& w = watched(guard);
    w.side = 0;
    w.reached = 0;
    w.product = 0;
    w.within = 0.0;
}

RBDYN_INLINE void EventSearch::set_crowded(int crowded) {
    const double looseness = std::ldexp(1.0, 2 * std::min(crowded, 10));
    passages_.set_looseness(looseness);
    closer_.set_looseness(looseness);
}

RBDYN_INLINE double EventSearch::examine(Record& record, const Mode& mode, bool fresh, bool is_last) {
    const std::vector<Guard>& guards = mode.equations->guards;
    fired_.clear();
    is_fresh_ = fresh;
    stops_ = false;
    broken_ = nullptr;
    touch_ = std::numeric_limits<double>::infinity();
    for (Watched& w : watched_) w.known_from = 0.0;
    passed_at_end_.clear();
    leaving_.clear();
    if (guards.empty()) return -1.0;
    const Piece& piece = engine_.piece();
    found_.clear();
    current_ = &guards;
    degree_ = std::min(engine_.guard_order(), series::max_degree);
    double power = 1.0;
    for (int k = 0; k <= degree_; ++k, power *= piece.length) powers_[static_cast<std::size_t>(k)] = power;
    stays_.assign(guards.size(), false);
    for (std::size_t g = 0; g < guards.size(); ++g)
        guards[g].least < 0.0 ? seek_least(record, mode, g) : seek(mode, guards, g, fresh, is_last);
    passed_before_.clear();
    const auto leave_zero = [&] {
        for (const int part : leaving_) watched_[at(part)].within = 0.0;
    };
    const auto note_doubt = [&](double end) {
        if (touch_ * piece.length < end && !record.doubt) record.doubt = piece.at(touch_ * piece.length);
    };
    sort_few<Found>(found_, [](const Found& a, const Found& b) { return a.place < b.place; });
    multiply_sides(guards);
    if (found_.empty()) {
        ended_.clear();
        leave_zero();
        note_doubt(piece.length);
        return -1.0;
    }
    auto first = std::find_if(found_.begin(), found_.end(),
                              [&](const Found& f) { return f.breaks || interrupts(guards[f.guard], f); });
    // a watched function with a corner reaches zero where the distinction in it switches, rounding aside
    if (first != found_.end() && !first->breaks && guards[first->guard].watch >= 0) {
        const auto corner = std::find_if(first, found_.end(), [&](const Found& f) {
            return is_distinction(guards[f.guard]) && !f.breaks && are_near(*first, f);
        });
        if (corner != found_.end()) first = corner;
    }
    double together = std::numeric_limits<double>::infinity(), noted = together;
    if (first != found_.end()) {
        at_start_ = first->place <= first->doubt;
        together = first->place + first->doubt + 4.0 * epsilon * std::abs(piece.start.hi) / piece.duration();
        // what is known to come later than the end of the mode is not noted, however little is known of that
        noted = together - first->doubt + std::min(first->doubt, 0x1p-40);
        fire(guards, *first, together, noted);
    }
    const double cut =
        first != found_.end() ? otherwise(mode, first->guard, polished(mode, first->place * piece.length)) : -1.0;
    // the side to which a function would go beyond the end of the mode is not the one it was on
    for (Watched& w : watched_)
        if (w.known_from > 0.0 && cut >= 0.0 && w.known_from * piece.length >= cut) w.side = 0;
    // a mode that ends where it begins leaves nothing
    if (cut < 0.0 || !(fresh && at_start_)) leave_zero();
    note_doubt(cut >= 0.0 ? cut : piece.length);
    for (const Found& f : found_) {
        // what comes after the end of the mode is found again in the next one, by its side
        const Guard& guard = guards[f.guard];
        if (f.place - f.doubt > noted || !guard.is_watched()) continue;
        if (f.waits) {
            watched(guard).reached = f.rising ? 1 : -1;
            continue;
        }
        if (f.breaks) continue;
        side_of(guard) = f.rising ? 1 : -1;
        if (guard.watch >= 0 && guard.output >= 0 && !f.is_pole && cut >= 0.0 &&
            (f.place + std::max({f.near, f.doubt, 16.0 * finest()})) * piece.length >= cut)
            watched(guard).within = rounding_at_zero(mode, guard, cut);
        if (f.product != 0) product_of(guards, factors_of(guards, f.guard)) = f.product;
        if (is_last && !f.is_pole && f.place + std::max(f.near, 16.0 * finest()) >= 1.0) {
            passed_at_end_.resize(guards.size());
            passed_at_end_[f.guard] = true;
        }
        if (f.is_pole || f.is_silent || guard.role != GuardRole::record || !matches(guard, f.product_rises)) continue;
        const double place = f.place * piece.length;
        note(record, guard, direction_of(f.product_rises), piece.at(cut >= 0.0 ? std::min(place, cut) : place));
    }
    const bool all_end = std::all_of(fired_.begin(), fired_.end(), [&](int g) {
        return guards[at(g)].kind == EventKind::detach && guards[at(g)].contact >= 0;
    });
    // those that end one after the other at one instant end together
    const bool is_same = cut >= 0.0 && piece.at(cut) - piece.start <= 8.0 * epsilon * std::abs(piece.start.hi);
    if (!(all_end && is_same)) ended_.clear();
    for (const int g : fired_)
        if (all_end) ended_.push_back(guards[at(g)].contact);
    // what a guard that fired is where it did, so that it is known again
    for (const int g : fired_)
        if (const Guard& guard = guards[static_cast<std::size_t>(g)]; guard.watch >= 0)
            watched(guard).zero = value_at(mode, guard, cut);
    return cut;
}

RBDYN_INLINE bool EventSearch::examine_still(Record& record, const Mode& mode, Instant t, std::span<const double> x) {
    const auto& guards = mode.equations->guards;
    bool stops = false;
    if (guards.empty()) return stops;
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t.hi, x);
    for (std::size_t g = 0; g < guards.size(); ++g) {
        if (guards[g].watch < 0 || guards[g].output < 0) continue;
        const Factors factors = factors_of(guards, g);
        const int before = watched(guards[g]).side;
        std::vector<int> sides;
        for (g = factors.first; g < factors.first + factors.count; ++g) {
            const Guard& guard = guards[g];
            const double value = values.output(guard.output);
            if (!std::isfinite(value)) broken_ = &guard;
            const int reached = std::exchange(watched(guard).reached, 0);
            const int stays = reached != 0 && !is_level_at(mode, t.hi, x, guard.output) ? reached : 0;
            const double within = watched(guard).within;
            const bool is_passed = within > 0.0 && std::abs(value) <= within;
            sides.push_back(is_passed ? watched(guard).side : value > 0.0 ? 1 : value < 0.0 ? -1 : stays);
            if (sides.back() != 0) watched(guard).side = sides.back();
        }
        --g;
        const int side = factors.count > 1                        ? passes(guards, factors, sides)
                         : before != 0 && sides.front() != before ? sides.front()
                                                                  : 0;
        if (side == 0 || !matches(guards[g], side > 0)) continue;
        note(record, guards[g], direction_of(side > 0), t);
        stops = stops || guards[g].role == GuardRole::stop;
    }
    return stops;
}

RBDYN_INLINE bool EventSearch::settle(Record& record, const Mode& mode, Instant t, std::span<const double> x,
                                      bool fresh) {
    bool stops = false;
    const std::vector<Guard>& guards = mode.equations->guards;
    // the side a factor has gone over to; 0: it has not
    const auto passes_to = [&](const Guard& guard) {
        const int reached = watched(guard).reached, side = watched(guard).side;
        if (reached == 0) {
            // one that has jumped with the mode, or turns in it from zero to the other side
            const int after = fresh && side != 0 ? side_after(mode, guard, t, x, 16.0 * epsilon) : 0;
            return after == -side ? after : 0;
        }
        if (const int after = side_after(mode, guard, t, x, 1e-6); after != 0 && after != reached) return 0;
        return guard.output >= 0 && is_level_at(mode, t.hi, x, guard.output) ? 0 : reached;
    };
    for (std::size_t g = 0; g < guards.size(); ++g) {
        if (guards[g].watch < 0) continue;
        const Factors factors = factors_of(guards, g);
        int side = 0;
        std::vector<int> sides;
        for (g = factors.first; g < factors.first + factors.count; ++g) {
            const Guard& guard = guards[g];
            const int after = passes_to(guard);
            const bool is_level = after == 0 && factors.count > 1 && guard.output >= 0 && !mode.still &&
                                  is_level_at(mode, t.hi, x, guard.output);
            sides.push_back(after != 0 ? after : is_level ? 0 : watched(guard).side);
            if (after == 0) continue;
            side = after;
            watched(guard).reached = 0;
            watched(guard).side = after;
            passed_at_end_.resize(guards.size());
            passed_at_end_[g] = true;
        }
        --g;
        if (factors.count > 1) side = passes(guards, factors, sides);
        if (side == 0 || !matches(guards[g], side > 0)) continue;
        note(record, guards[g], direction_of(side > 0), t);
        stops = stops || guards[g].role == GuardRole::stop;
    }
    return stops;
}

RBDYN_INLINE int EventSearch::side_after(const Mode& mode, const Guard& guard, Instant t, std::span<const double> x,
                                         double few) {
    if (guard.output < 0 || mode.still) return 0;
    // its value there is the error of the state, unless it has jumped
    bool is_zero = is_zero_at(mode, t.hi, x, guard.output, few);
    if (const double within = watched(guard).within; !is_zero && within > 0.0) {
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t.hi, x);
        is_zero = std::abs(values.output(guard.output)) <= within;
    }
    return leading_sign(mode, t.hi, x, guard.output, is_zero ? 1 : 0);
}

RBDYN_INLINE void EventSearch::note(Record& record, const Guard& guard, Direction direction, Instant at) {
    record.note({at.hi, guard.kind, guard.subject, guard.name, direction, 0.0, guard.contact, Vector3::Zero(), at});
}

RBDYN_INLINE void EventSearch::fire(const std::vector<Guard>& guards, const Found& first, double together,
                                    double at_once) {
    if (first.breaks) {
        broken_ = &guards[first.guard];
        return;
    }
    const auto is_together = [&](const Found& f) {
        // the side of a distinction that is known to change later is what it is until then
        const bool is_seen = guards[f.guard].is_watched() || is_distinction(guards[f.guard]);
        return f.place - f.doubt <= (is_seen ? at_once : together) && !f.is_pole && !f.breaks;
    };
    // a watched function of what switches there (an absolute value) may have a corner and turn back
    const bool switches = std::any_of(found_.begin(), found_.end(), [&](const Found& f) {
        return is_together(f) && is_distinction(guards[f.guard]);
    });
    for (Found& f : found_) {
        const Guard& guard = guards[f.guard];
        if (!is_together(f)) continue;
        if (guard.watch >= 0 && switches && (f.place + f.doubt >= first.place || are_near(f, first))) {
            f.waits = true;
            continue;
        }
        if (!interrupts(guard, f)) continue;
        if (std::find(fired_.begin(), fired_.end(), static_cast<int>(f.guard)) != fired_.end()) continue;
        fired_.push_back(static_cast<int>(f.guard));
        directions_.resize(guards.size());
        directions_[f.guard] = direction_of(f.product_rises);
        stops_ = stops_ || guard.role == GuardRole::stop;
    }
}

RBDYN_INLINE bool EventSearch::begins_on_edge(const Mode& mode) {
    const auto& guards = mode.equations->guards;
    if (!begins_on_edge_)
        begins_on_edge_ = std::any_of(guards.begin(), guards.end(), [&](const Guard& g) {
            return is_distinction(g) && g.output >= 0 && begins_at_zero(mode, g, 8.0 * epsilon);
        });
    return *begins_on_edge_;
}

RBDYN_INLINE bool EventSearch::begins_at_zero(const Mode& mode, const Guard& guard, double few) {
    if (!zeros_) zeros_.emplace(mode, engine_.piece().start.hi, state_of_piece(0.0));
    return (*zeros_)(guard.output, few);
}

RBDYN_INLINE std::span<const double> EventSearch::state_of_piece(double tau) {
    const Piece& piece = engine_.piece();
    state_.resize(static_cast<std::size_t>(piece.variables));
    piece.state(tau, state_);
    return state_;
}

RBDYN_INLINE bool EventSearch::matches(const Guard& guard, bool rising) {
    return guard.direction == Direction::either || guard.direction == direction_of(rising);
}

RBDYN_INLINE bool EventSearch::interrupts(const Guard& guard, const Found& f) {
    if (f.is_pole || f.is_silent || guard.role == GuardRole::record) return false;
    return !guard.is_watched() || matches(guard, f.product_rises);
}

RBDYN_INLINE int& EventSearch::side_of(const Guard& guard) {
    if (guard.watch < 0) {
        const auto* first = current_->data();
        return sides_[static_cast<std::size_t>(&guard - first)];
    }
    return watched(guard).side;
}

RBDYN_INLINE EventSearch::Watched& EventSearch::watched(const Guard& guard) {
    const std::size_t index = guard.part >= 0 ? static_cast<std::size_t>(guard.part) : 0;
    if (watched_.size() <= index) watched_.resize(index + 1);
    return watched_[index];
}

RBDYN_INLINE double EventSearch::polished(const Mode& mode, double cut) {
    if (cut <= 0.0 || fired_.empty()) return cut;
    const Guard& guard = mode.equations->guards[static_cast<std::size_t>(fired_.front())];
    if (guard.output < 0) return cut;
    const double* c = engine_.guard(fired_.front());
    double slope = 0.0;
    for (int k = degree_; k >= 1; --k) slope = slope * cut + k * c[k];
    // what the polynomial leaves out of a slip of rounding may be all of it where it ends
    if (guard.kind == EventKind::stick && guard.contact >= 0 && !mode.equations->program.has_calls() &&
        dynamic_cast<const RefinedTaylorEngine*>(&engine_) != nullptr)
        return polished_low(mode, guard, cut, slope);
    if (mode.equations->is_variable(guard) && !engine_.refines()) return cut;
    const Piece& piece = engine_.piece();
    if (is_gap(mode, guard, at(fired_.front())) && (cut < 0.5 * piece.length || !is_fresh_) &&
        std::abs(slope) * cut <= low_gaps * size_of_terms(mode, piece.start.hi, state_of_piece(0.0), guard.output))
        return polished_low(mode, guard, cut, slope);
    if (guard.kind == EventKind::slip && is_passed_barely(mode, guard, cut, slope))
        return polished_low(mode, guard, cut, slope);
    double best = std::numeric_limits<double>::infinity(), place = cut;
    for (int iteration = 0; iteration < 4; ++iteration) {
        const double g = evaluated(mode, place).output(guard.output);
        if (!(std::abs(g) < best)) break;
        best = std::abs(g);
        cut = place;
        // rounding of its terms knows the place no better than its series
        if (best <= value_rounding(mode, guard, place / piece.length)) break;
        place = std::clamp(cut - g / slope, 0.0, piece.length);
        if (!(std::abs(place - cut) < 1e-3 * piece.length) || place == cut || place == 0.0) break;
    }
    return cut;
}

RBDYN_INLINE const Evaluator<double>& EventSearch::evaluated(const Mode& mode, double place, bool by_piece) {
    if (evaluated_ != mode.equations) {
        evaluator_ = std::make_unique<Evaluator<double>>(mode.equations->program);
        evaluated_ = mode.equations;
    }
    const Piece& piece = engine_.piece();
    state_.resize(static_cast<std::size_t>(piece.variables));
    by_piece ? piece.state(place, state_) : engine_.state(place, state_);
    evaluator_->set_parameters(mode.parameters);
    (*evaluator_)(piece.at(place).hi, state_);
    return *evaluator_;
}

RBDYN_INLINE void EventSearch::seek(const Mode& mode, const std::vector<Guard>& guards, std::size_t g, bool fresh,
                                    bool is_last) {
    const Guard& guard = guards[g];
    current_ = &guards;
    stays_[g] = true;
    if (guard.output < 0) {
        if (guard.locator)
            locate(guard, g, fresh);
        else
            seek_by_values(mode, guard, g, 1.0, fresh, is_last);
        return;
    }
    const double sign =
        guard.sign_parameter >= 0 ? mode.parameters[static_cast<std::size_t>(guard.sign_parameter)] : 1.0;
    // a length, which is positive
    if (sign > 0.0 && !guard.is_watched() && engine_.is_far(static_cast<int>(g))) {
        if (fresh) side_of(guard) = 1;
        stays_[g] = false;
        return;
    }
    const double* c = engine_.guard(static_cast<int>(g));
    // the guard on the unit interval
    series::Coefficients q;
    double check = 0.0;
    for (int k = 0; k <= degree_; ++k) {
        q[static_cast<std::size_t>(k)] = c[k] * powers_[static_cast<std::size_t>(k)] * sign;
        check += 0.0 * c[k];
    }
    if (check != 0.0 || engine_.is_rough(static_cast<int>(g))) {
        if (fresh && !guard.is_watched()) side_of(guard) = 1;
        ends_[g] = std::numeric_limits<double>::quiet_NaN();
        return seek_by_values(mode, guard, g, sign, fresh, is_last);
    }
    const bool is_watch = guard.is_watched();
    int& side = side_of(guard);
    const double end = ends_[g];
    if (is_watch) ends_[g] = series::value(q.data(), degree_, 1.0);
    if (fresh && !is_watch) side = 1;
    const int starts = q[0] > 0.0 ? 1 : q[0] < 0.0 ? -1 : 0;
    const double within = guard.watch >= 0 ? watched(guard).within : 0.0;
    if (!fresh && !is_last && starts == side && within == 0.0 && series::keeps_sign(q.data(), degree_)) {
        stays_[g] = false;
        return;
    }
    Passages::Arrival arrival{.is_series = !engine_.fits_guards()};
    know_zero(guard, g, fresh, starts, arrival);
    // what has passed zero just where a mode ended has passed it, whatever rounding makes of it while it stays there
    if (within > 0.0 && std::abs(q[0]) <= within) {
        arrival.at_zero = true;
        arrival.within = within;
    }
    if (!fresh && is_watch && !arrival.at_zero && starts == -side && passed_pole(mode, guard, q[0])) {
        side = starts;
        product_of(guards, factors_of(guards, g)) *= -1;
    }
    arrival.side = side;
    // a force that touches zero, but for what rounding has made of the motion so far, pushes on
    if (guard.kind == EventKind::detach && guard.contact >= 0) arrival.dips = deepest_dip;
    std::optional<double> fine;
    if (!arrival.at_zero && is_gap(mode, guard, g)) fine = low_gap(mode, guard, g, q);
    if (fine) {
        q[0] = sign * *fine;
        arrival.at_zero = q[0] == 0.0;
    }
    int zeros = 0;
    if (begins_touching(mode, guard, fresh) && (arrival.at_zero || begins_level(mode, guard, q))) {
        arrival.at_zero = true;
        zeros = zeros_of_gap(mode, guard);
        std::fill_n(q.begin(), std::min(zeros, degree_ + 1), 0.0);
    }
    // what tells on which side a distinction begins tells it of its guard, and of functions with a corner there
    if (fresh && begins_ && (is_distinction(guard) || (is_watch && begins_on_edge(mode))))
        if (begins_at_zero(mode, guard, (is_watch ? 32.0 : 8.0) * epsilon)) {
            arrival.by_rounding = !arrival.at_zero;
            arrival.at_zero = true;
        }
    // what has reached zero with the distinction is there, as far as the state is known, unless it has jumped; on a
    // level it has passed nothing until it leaves that
    if (fresh && guard.watch >= 0 && watched(guard).reached != 0) {
        // what is on its old side yet passes later, if it does
        arrival.at_zero = begins_at_zero(mode, guard, starts == side ? 32.0 * epsilon : 1e-6);
        if (arrival.at_zero && is_level_at(mode, engine_.piece().start.hi, state_of_piece(0.0), guard.output))
            watched(guard).reached = 0;
    }
    if (fresh && within > 0.0 && starts == -side && !arrival.at_zero)
        arrival.at_zero = begins_at_zero(mode, guard, 32.0 * epsilon);
    // two pieces meet within the error of the first
    if (!fresh && is_watch && starts != side && std::isfinite(end)) arrival.gap = 2.0 * std::abs(end - q[0]);
    if (is_last) {
        const Piece& piece = engine_.piece();
        arrival.late = (slack_ + epsilon * std::abs(piece.at(piece.length).hi)) / piece.duration();
        arrival.reach = std::clamp(engine_.natural_length() / piece.length - 1.0, arrival.reach, 1.0);
    }
    const auto sizes_of_terms = [&](double* sizes) {
        engine_.guard_sizes(static_cast<int>(g), sizes);
        for (int k = 0; k <= degree_; ++k) sizes[k] *= powers_[static_cast<std::size_t>(k)];
        // a force that is none is what is left of all that acts
        if (guard.kind == EventKind::detach && guard.contact >= 0)
            sizes[0] =
                std::max(sizes[0], size_of_terms(mode, engine_.piece().start.hi, state_of_piece(0.0), guard.output));
        if (fine) sizes[0] = std::abs(q[0]);
        // what has just left its surface, and comes back from no higher than gaps are followed beyond doubles, began
        // there to as many digits
        if (fresh && arrival.at_zero && guard.contact >= 0 && guard.kind == EventKind::land && degree_ > 1 &&
            q[1] * q[1] <= low_gaps * sizes[0] * std::abs(q[2]) && model_.follows_bounces(mode) &&
            model_.bounces_among_bouncing(guard.contact))
            sizes[0] = 0.0;
        if (!fresh || degree_ < 1 || !mode.equations->is_variable(guard)) return;
        // a variable that begins with zero is told by its rate, which may be zero there but for the rounding of all it
        // is made of, that of the time included
        const Piece& piece = engine_.piece();
        const int rate = mode.equations->program.output(guard.output);
        const std::span<const double> x = state_of_piece(0.0);
        // that of a place is a variable itself
        const auto slot = static_cast<std::size_t>(mode.equations->program.output(rate));
        const double size = slot < x.size() ? 2.0 * std::abs(x[slot]) : size_of_terms(mode, piece.start.hi, x, rate);
        sizes[1] = std::max(sizes[1], size * piece.duration());
    };
    const auto sizes_of_rest = [&](double* sizes) {
        sizes_of_terms(sizes);
        std::fill_n(sizes, std::min(zeros, degree_ + 1), 0.0);
    };
    passages_.find(q.data(), degree_, arrival, sizes_of_rest, [&] {
        return mode.equations->is_variable(guard) ? series::value(q.data(), degree_, 1.0)
                                                  : sign * evaluated(mode, engine_.piece().length).output(guard.output);
    });
    // a watched function and the distinction that it has a corner by are seen alike
    if (is_watch || is_distinction(guard)) look_closer(mode, guard, sign, 0.0, 1.0, arrival, engine_.fits_guards());
    const std::size_t before = found_.size();
    if (within > 0.0 && passages_.leaves() != 0) leaving_.push_back(guard.part);
    take(guard, g, fresh, 0.0, 1.0, side);
    if (is_watch || is_distinction(guard)) sharpen(mode, guard, sign, before);
    if (guard.kind != EventKind::reverse || !model_.holds_what_touches(guard.subject)) return;
    const double passes = passages_.places().empty() ? 1.0 : passages_.places().front().x;
    if (const auto x = passages_.touch(arrival, sizes_of_rest, passes)) touch_ = std::min(touch_, *x);
}

RBDYN_INLINE double EventSearch::value_rounding(const Mode& mode, const Guard& guard, double place) {
    if (guard.output < 0) return 0.0;
    const Piece& piece = engine_.piece();
    const double tau = place * piece.length;
    return 4.0 * epsilon * size_of_terms(mode, piece.at(tau).hi, state_of_piece(tau), guard.output);
}

RBDYN_INLINE double EventSearch::rounding_at_zero(const Mode& mode, const Guard& guard, double place) {
    const double t = engine_.piece().at(place).hi;
    return 32.0 * epsilon * AtZero(mode, t, state_of_piece(place)).size(guard.output);
}

RBDYN_INLINE void EventSearch::take(const Guard& guard, std::size_t g, bool fresh, double lo, double hi, int known) {
    int leaves = passages_.leaves();
    if (leaves != 0) stays_[g] = false;
    if (fresh && guard.watch >= 0) {
        // one that stays at zero where the last mode ended has reached it
        const int reached = std::exchange(watched(guard).reached, 0);
        if (leaves == 0) leaves = reached;
    }
    if (guard.watch >= 0) watched(guard).known_from = 0.0;
    if (leaves == 0) return;
    if (guard.is_watched() && known == 0) {
        known = side_of(guard) = leaves;
        if (guard.watch >= 0) watched(guard).known_from = lo + passages_.leaves_from() * (hi - lo);
    }
    if (leaves != known) {
        // a force that begins with less than its rounding ends where it does, if that is told from now
        constexpr double soon = 0x1p-10;
        const double from = passages_.leaves_from() * (hi - lo);
        const bool is_force = guard.kind == EventKind::detach && guard.contact >= 0;
        found_.push_back({is_force && from <= soon ? lo + from : lo, 0.0, 0.0, g, leaves > 0});
        if (!guard.is_watched()) return;
    }
    for (const Passages::Place& p : passages_.places()) {
        leaves = -leaves;
        found_.push_back({lo + p.x * (hi - lo), p.doubt * (hi - lo), p.near * (hi - lo), g, leaves > 0});
        if (!guard.is_watched()) return;
    }
}

RBDYN_INLINE void EventSearch::locate(const Guard& guard, std::size_t g, bool fresh) {
    const auto tau = guard.locator->first(engine_.piece(), fresh);
    if (tau) found_.push_back({*tau / engine_.piece().length, 0.0, 0.0, g, false});
}

RBDYN_INLINE void EventSearch::know_zero(const Guard& guard, std::size_t g, bool fresh, int starts,
                                         Passages::Arrival& arrival) {
    // what has jumped is on its new side
    if (g < passed_before_.size() && passed_before_[g] && starts != side_of(guard)) arrival.at_zero = true;
    if (!fresh || !handled(g)) return;
    if (!guard.is_watched()) arrival.at_zero = true;
    if (guard.watch >= 0) arrival.zero = watched(guard).zero;
}

}  // namespace rbdyn::inline RBDYN_FORM
