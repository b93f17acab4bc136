// Where the guards of a mode pass zero on an engine's piece.
//
// A guard of a mode is valid while it is not negative; one that is watched may have either sign, and its side is kept
// from mode to mode, so that what passes zero together with a change of mode is not lost. A guard at zero where a mode
// begins (just handled, or starting there) is disarmed: the side it leaves to is the first on which it is more than
// rounding (passages.hpp). What reaches zero where a distinction switches waits for the next mode to say whether it
// passes or turns back.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/sort_few.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/passages.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/event/rough_passages.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/at_zero.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/leading_sign.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn {

class EventSearch {
public:
    /// `slack` [s]: an event that the engine's accuracy cannot tell from the end of the run is met there.
    EventSearch(const HybridModel& model, Engine& engine, double slack)
        : model_(model), engine_(engine), slack_(slack) {}

    /// A mode begins. Guards in `handled`, by index, began it with their zero. `begins`: with it the motion.
    void enter(const Mode& mode, std::vector<bool> handled, bool begins) {
        handled_ = std::move(handled);
        begins_ = begins;
        sides_.assign(mode.equations->guards.size(), 0);
        ends_.assign(mode.equations->guards.size(), 0.0);
    }
    /// A watched function whose zero changed the state may be on any side from here.
    void forget_side(const Guard& guard) {
        Watched& w = watched(guard);
        w.side = 0;
        w.reached = 0;
    }
    /// Events that follow each other at one instant are made by rounding: look less closely.
    void set_crowded(int crowded) {
        for (Passages* p : {&passages_, &closer_}) p->set_looseness(std::ldexp(1.0, 2 * std::min(crowded, 10)));
    }

    /// Looks for events on the engine's piece. Records watched ones; returns tau of the first change of mode or stop,
    /// or a negative number.
    double examine(Record& record, const Mode& mode, bool fresh, bool is_last) {
        const std::vector<Guard>& guards = mode.equations->guards;
        fired_.clear();
        stops_ = false;
        broken_ = nullptr;
        touch_ = std::numeric_limits<double>::infinity();
        for (Watched& w : watched_) w.known_from = 0.0;
        if (guards.empty()) return -1.0;
        const Piece& piece = engine_.piece();
        found_.clear();
        degree_ = std::min(engine_.guard_order(), series::max_degree);
        double power = 1.0;
        for (int k = 0; k <= degree_; ++k, power *= piece.length) powers_[static_cast<std::size_t>(k)] = power;
        for (std::size_t g = 0; g < guards.size(); ++g) seek(mode, guards, g, fresh, is_last);
        const auto note_doubt = [&](double end) {
            if (touch_ * piece.length < end && !record.doubt) record.doubt = piece.at(touch_ * piece.length);
        };
        if (found_.empty()) {
            note_doubt(piece.length);
            return -1.0;
        }
        sort_few<Found>(found_, [](const Found& a, const Found& b) { return a.place < b.place; });
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
            fire(guards, *first, together);
        }
        const double cut = first != found_.end() ? polished(mode, first->place * piece.length) : -1.0;
        // the side to which a function would go beyond the end of the mode is not the one it was on
        for (Watched& w : watched_)
            if (w.known_from > 0.0 && cut >= 0.0 && w.known_from * piece.length >= cut) w.side = 0;
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
            if (f.is_pole || guard.role != GuardRole::record || !matches(guard, f)) continue;
            const double place = f.place * piece.length;
            note(record, guard, f.direction(), piece.at(cut >= 0.0 ? std::min(place, cut) : place));
        }
        // what a guard that fired is where it did, so that it is known again
        for (const int g : fired_)
            if (const Guard& guard = guards[static_cast<std::size_t>(g)]; guard.watch >= 0)
                watched(guard).zero = value_at(mode, guard, cut);
        return cut;
    }

    /// The guard that is not finite from there on, which ends the run; none if there is none.
    const Guard* broken() const { return broken_; }
    /// The guards that end the mode, and whether they end the run.
    const std::vector<int>& fired() const { return fired_; }
    bool stops() const { return stops_; }
    /// Whether that is where the piece begins, as far as rounding of the first of them can tell.
    bool fires_at_start() const { return at_start_; }
    /// In which a guard that fired passed zero.
    Direction direction(int guard) const { return directions_[static_cast<std::size_t>(guard)]; }

    /// Watched functions in a mode in which nothing moves: those that jumped where it began, or stay at zero.
    /// Returns whether one of them stops the run.
    bool examine_still(Record& record, const Mode& mode, Instant t, std::span<const double> x) {
        const auto& guards = mode.equations->guards;
        bool stops = false;
        if (guards.empty()) return stops;
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t.hi, x);
        for (const Guard& guard : guards) {
            if (guard.watch < 0 || guard.output < 0) continue;
            const double value = values.output(guard.output);
            if (!std::isfinite(value)) broken_ = &guard;
            const int reached = std::exchange(watched(guard).reached, 0);
            const int stays = reached != 0 && !is_level_at(mode, t.hi, x, guard.output) ? reached : 0;
            const int side = value > 0.0 ? 1 : value < 0.0 ? -1 : stays;
            int& before = side_of(guard);
            if (side == 0 || side == before) continue;
            const Found f{0.0, 0.0, 0.0, 0, side > 0};
            if (before != 0 && matches(guard, f)) {
                note(record, guard, f.direction(), t);
                stops = stops || guard.role == GuardRole::stop;
            }
            before = side;
        }
        return stops;
    }

    /// The run ends where a mode begins: watched functions that reached zero there have passed it if they go on to the
    /// other side, or stay. Returns whether one of them stops the run.
    bool settle(Record& record, const Mode& mode, Instant t, std::span<const double> x) {
        bool stops = false;
        for (const Guard& guard : mode.equations->guards) {
            if (guard.watch < 0 || watched(guard).reached == 0) continue;
            const int reached = std::exchange(watched(guard).reached, 0);
            const Found f{0.0, 0.0, 0.0, 0, reached > 0};
            if (!matches(guard, f)) continue;
            if (const int after = side_after(mode, guard, t, x); after != 0 && after != reached) continue;
            if (guard.output >= 0 && is_level_at(mode, t.hi, x, guard.output)) continue;
            note(record, guard, f.direction(), t);
            stops = stops || guard.role == GuardRole::stop;
        }
        return stops;
    }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    /// The side a watched function that was at zero where a mode begins goes to in it; 0: it stays, or no one can tell.
    static int side_after(const Mode& mode, const Guard& guard, Instant t, std::span<const double> x) {
        if (guard.output < 0 || mode.still) return 0;
        // its value there is the error of the state, unless it has jumped
        const bool is_zero = is_zero_at(mode, t.hi, x, guard.output, 1e-6);
        return leading_sign(mode, t.hi, x, guard.output, is_zero ? 1 : 0);
    }

    struct Found {
        double place, doubt, near;  // on [0, 1] of the piece
        std::size_t guard;
        bool rising;
        bool is_pole = false, breaks = false;  // it changes its side and passes nothing; it ceases to be finite
        bool waits = false;                    // the mode ends there too, and what follows decides whether it passes
        Direction direction() const { return rising ? Direction::rising : Direction::falling; }
    };
    /// A watched function, kept through the modes.
    struct Watched {
        int side = 0;                               // it is on; 0: not known yet
        int reached = 0;                            // the side it would go to from the zero where the mode began
        double known_from = 0.0;                    // where on the piece its side becomes known; 0: it is
        std::optional<double> zero = std::nullopt;  // its value where it fired last
    };

    static void note(Record& record, const Guard& guard, Direction direction, Instant at) {
        record.note({at.hi, guard.kind, guard.subject, guard.name, direction, 0.0, at});
    }

    /// Takes what happens together with the first event that changes the mode or stops the run.
    void fire(const std::vector<Guard>& guards, const Found& first, double together) {
        if (first.breaks) {
            broken_ = &guards[first.guard];
            return;
        }
        const auto is_together = [&](const Found& f) {
            return f.place - f.doubt <= together && !f.is_pole && !f.breaks;
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
            directions_[f.guard] = f.direction();
            stops_ = stops_ || guard.role == GuardRole::stop;
        }
    }

    /// Whether a motion begins where a distinction in its mode changes.
    bool begins_on_edge(const Mode& mode) {
        const auto& guards = mode.equations->guards;
        return std::any_of(guards.begin(), guards.end(), [&](const Guard& g) {
            return is_distinction(g) && g.output >= 0 && begins_at_zero(mode, g, 8.0 * epsilon);
        });
    }
    /// Whether a guard is zero where the piece begins, all numbers known to `few` of themselves.
    bool begins_at_zero(const Mode& mode, const Guard& guard, double few) {
        state_.resize(static_cast<std::size_t>(engine_.piece().variables));
        engine_.piece().state(0.0, state_);
        return is_zero_at(mode, engine_.piece().start.hi, state_, guard.output, few);
    }

    /// Of a case distinction: a change of mode that may leave a corner in what is watched.
    static bool is_distinction(const Guard& guard) { return guard.kind == EventKind::switching && !guard.is_watched(); }
    /// Whether two places of one zero, computed apart, may be these.
    static bool are_near(const Found& a, const Found& b) { return std::abs(a.place - b.place) <= a.near + b.near; }

    static bool matches(const Guard& guard, const Found& f) {
        return guard.direction == Direction::either || guard.direction == f.direction();
    }
    static bool interrupts(const Guard& guard, const Found& f) {
        return !f.is_pole && guard.role != GuardRole::record && (!guard.is_watched() || matches(guard, f));
    }

    /// The side a watched function is on, kept through the modes; else that of the guard in this mode.
    int& side_of(const Guard& guard) {
        if (guard.watch < 0) {
            const auto* first = current_->data();
            return sides_[static_cast<std::size_t>(&guard - first)];
        }
        return watched(guard).side;
    }
    Watched& watched(const Guard& guard) {
        const std::size_t index = guard.watch >= 0 ? static_cast<std::size_t>(guard.watch) : 0;
        if (watched_.size() <= index) watched_.resize(index + 1);
        return watched_[index];
    }

    /// A root of the first guard in fired_, whose series was cut off, at a root of the guard itself: what is done at an
    /// event then sees it at zero within rounding. Newton's method, slope by the series, while it gets better. A guard
    /// that is a variable is cut off no sooner than the state, unless the engine knows that better than its piece.
    double polished(const Mode& mode, double cut) {
        if (cut <= 0.0 || fired_.empty()) return cut;
        const Guard& guard = mode.equations->guards[static_cast<std::size_t>(fired_.front())];
        if (guard.output < 0) return cut;
        if (mode.equations->is_variable(guard) && !engine_.refines()) return cut;
        const Piece& piece = engine_.piece();
        const double* c = engine_.guard(fired_.front());
        double slope = 0.0;
        for (int k = degree_; k >= 1; --k) slope = slope * cut + k * c[k];
        double best = std::numeric_limits<double>::infinity(), place = cut;
        for (int iteration = 0; iteration < 4; ++iteration) {
            const double g = evaluated(mode, place).output(guard.output);
            if (!(std::abs(g) < best)) break;
            best = std::abs(g);
            cut = place;
            place = std::clamp(cut - g / slope, 0.0, piece.length);
            if (!(std::abs(place - cut) < 1e-3 * piece.length) || place == cut || place == 0.0) break;
        }
        return cut;
    }

    /// The equations themselves, evaluated on the engine's piece; `by_piece`: at the state its polynomial gives.
    const Evaluator<double>& evaluated(const Mode& mode, double place, bool by_piece = false) {
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

    /// Where guard g changes its sign on the piece, as places in [0, 1].
    void seek(const Mode& mode, const std::vector<Guard>& guards, std::size_t g, bool fresh, bool is_last) {
        const Guard& guard = guards[g];
        current_ = &guards;
        if (guard.output < 0) {
            if (guard.locator)
                locate(guard, g, fresh);
            else
                seek_by_values(mode, guard, g, 1.0, fresh, is_last);
            return;
        }
        const double* c = engine_.guard(static_cast<int>(g));
        const double sign =
            guard.sign_parameter >= 0 ? mode.parameters[static_cast<std::size_t>(guard.sign_parameter)] : 1.0;
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
        if (!fresh && !is_last && starts == side && series::keeps_sign(q.data(), degree_)) return;
        if (!fresh && is_watch && starts == -side && passed_pole(mode, guard, q[0])) side = starts;
        Passages::Arrival arrival{.side = side, .is_series = !engine_.fits_guards()};
        if (fresh && handled(g)) {
            arrival.at_zero = !is_watch;
            if (is_watch && guard.watch >= 0) arrival.zero = watched(guard).zero;
        }
        // what tells on which side a distinction begins tells it of its guard, and of functions with a corner there
        if (fresh && begins_ && (is_distinction(guard) || (is_watch && begins_on_edge(mode))))
            arrival.at_zero = begins_at_zero(mode, guard, (is_watch ? 32.0 : 8.0) * epsilon);
        // what has reached zero with the distinction is there, as far as the state is known, unless it has jumped; on a
        // level it has passed nothing until it leaves that
        if (fresh && guard.watch >= 0 && watched(guard).reached != 0) {
            arrival.at_zero = begins_at_zero(mode, guard, 1e-6);
            if (arrival.at_zero && is_level_at(mode, engine_.piece().start.hi, state_, guard.output))
                watched(guard).reached = 0;
        }
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
        };
        passages_.find(q.data(), degree_, arrival, sizes_of_terms, [&] {
            return mode.equations->is_variable(guard)
                       ? series::value(q.data(), degree_, 1.0)
                       : sign * evaluated(mode, engine_.piece().length).output(guard.output);
        });
        // a watched function and the distinction that it has a corner by are seen alike
        if (is_watch || is_distinction(guard)) look_closer(mode, guard, sign, 0.0, 1.0, is_last);
        take(guard, g, fresh, 0.0, 1.0);
        if (guard.kind != EventKind::reverse || !model_.holds_what_touches(guard.subject)) return;
        const double passes = passages_.places().empty() ? 1.0 : passages_.places().front().x;
        if (const auto x = passages_.touch(arrival, sizes_of_terms, passes)) touch_ = std::min(touch_, *x);
    }

    /// Where rounding of a guard's polynomial on [lo, hi] of the piece, whose terms are those of all of it, hides
    /// whether it passes zero, its values tell as far as the rounding of its terms there lets them.
    void look_closer(const Mode& mode, const Guard& guard, double sign, double lo, double hi, bool is_last) {
        using series::Fit;
        if (passages_.leaves() == 0) return;
        for (const Passages::Stretch& s : passages_.hidden()) {
            // what is near the end of the run is judged with what comes after it
            if (is_last && s.hi >= 1.0) continue;
            const auto place = [&](double x) { return lo + (s.lo + x * (s.hi - s.lo)) * (hi - lo); };
            const auto value = [&](double x) {
                return sign * value_at(mode, guard, place(x) * engine_.piece().length, true);
            };
            double rounding = 0.0;
            for (const double x : {0.0, 0.5, 1.0}) rounding = std::max(rounding, value_rounding(mode, guard, place(x)));
            if (!(rounding < 0.25 * passages_.rounding(s.lo))) continue;
            std::array<double, Fit::points> values;
            double size = 0.0;
            for (int j = 0; j < Fit::points; ++j) {
                const double v = values[static_cast<std::size_t>(j)] = value(Fit::place(j));
                size = std::max(size, std::abs(v));
            }
            series::Coefficients q{};
            Fit::coefficients(values.data(), std::max(1e-15 * size, 0.25 * rounding), q.data());
            double miss = 0.0;
            for (int j = 0; j < Fit::checks; ++j) {
                const double x = Fit::check(j);
                miss = std::max(miss, std::abs(value(x) - series::value(q.data(), Fit::degree, x)));
            }
            // what values miss a polynomial by is rounding that is not known otherwise, of what is called back
            if (!(miss <= std::max(1e-6 * size, rounding))) continue;
            const Passages::Arrival arrival{.side = passages_.side(s.lo), .is_series = false};
            closer_.find(
                q.data(), Fit::degree, arrival, [&](double* sizes) { fit_sizes(q, miss, rounding, rounding, sizes); },
                [&] { return values.back(); });
            if (closer_.leaves() != arrival.side) continue;
            // beyond the stretch it is on the side it was known to be on, unless the piece ends first; a root of higher
            // multiplicity that is still one is known better by the terms of the piece
            if (s.hi < 1.0 && closer_.side(1.0) != passages_.side(s.hi)) continue;
            if (closer_.places().size() > passages_.count(s) || closer_.hidden().empty())
                passages_.replace(s, closer_.places());
        }
    }

    /// The rounding of a guard's value on the piece, at a place in [0, 1]: of its terms, the state and the time.
    double value_rounding(const Mode& mode, const Guard& guard, double place) {
        if (guard.output < 0) return 0.0;
        const Piece& piece = engine_.piece();
        state_.resize(static_cast<std::size_t>(piece.variables));
        piece.state(place * piece.length, state_);
        return 4.0 * epsilon * size_of_terms(mode, piece.at(place * piece.length).hi, state_, guard.output);
    }

    /// Sizes of the terms of a polynomial that misses a function by `miss` between its points, the first of which is
    /// where it begins. Its values are known to `begin` there and to `end` at 1.
    static void fit_sizes(const series::Coefficients& q, double miss, double begin, double end, double* sizes) {
        for (int k = 0; k <= series::Fit::degree; ++k) sizes[k] = std::abs(q[static_cast<std::size_t>(k)]);
        sizes[0] = std::max(sizes[0], begin / (4.0 * epsilon));
        // an error that is zero at 0 has a slope there; and it is seen at few places
        sizes[1] = std::max(sizes[1], std::max(64.0 * miss, end) / (4.0 * epsilon));
    }

    /// Takes the passages of a guard on [lo, hi] of the piece.
    void take(const Guard& guard, std::size_t g, bool fresh, double lo, double hi) {
        take(guard, g, fresh, lo, hi, side_of(guard));
    }
    /// `known`: the side it is on, with what was already found on the piece.
    void take(const Guard& guard, std::size_t g, bool fresh, double lo, double hi, int known) {
        int leaves = passages_.leaves();
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
            found_.push_back({lo, 0.0, 0.0, g, leaves > 0});
            if (!guard.is_watched()) return;
        }
        for (const Passages::Place& p : passages_.places()) {
            leaves = -leaves;
            found_.push_back({lo + p.x * (hi - lo), p.doubt * (hi - lo), p.near * (hi - lo), g, leaves > 0});
            if (!guard.is_watched()) return;
        }
    }

    void locate(const Guard& guard, std::size_t g, bool fresh) {
        const auto tau = guard.locator->first(engine_.piece(), fresh);
        if (tau) found_.push_back({*tau / engine_.piece().length, 0.0, 0.0, g, false});
    }

    /// Times closer than this on the piece, in its length, are one.
    double finest() const {
        const Piece& piece = engine_.piece();
        return 4.0 * epsilon * std::abs(piece.at(piece.length).hi) / piece.duration();
    }

    /// A guard, `sign` times it, that is no series all along the piece, or has values only.
    void seek_by_values(const Mode& mode, const Guard& guard, std::size_t g, double sign, bool fresh, bool is_last) {
        using series::Fit;
        const Piece& piece = engine_.piece();
        // its values tell whether what was reached where the mode began is passed
        if (fresh && guard.watch >= 0) watched(guard).reached = 0;
        const auto value = [&](double x) { return sign * value_at(mode, guard, x * piece.length, true); };
        // the side so far, with what was already found on this piece
        const auto side = [&] {
            for (std::size_t i = found_.size(); i-- > 0;)
                if (found_[i].guard == g) return found_[i].rising ? 1 : -1;
            return side_of(guard);
        };
        const auto fitted = [&](const series::Coefficients& q, double lo, double hi, double miss) {
            Passages::Arrival arrival{.side = side(), .reach = 0x1p-2, .is_series = false};
            if (fresh && lo == 0.0 && handled(g)) {
                arrival.at_zero = !guard.is_watched();
                if (guard.watch >= 0) arrival.zero = watched(guard).zero;
            }
            if (is_last && hi == 1.0)
                arrival.late =
                    (slack_ + epsilon * std::abs(piece.at(piece.length).hi)) / ((hi - lo) * piece.duration());
            double rounding = 0.0;
            passages_.find(
                q.data(), Fit::degree, arrival,
                [&](double* sizes) {
                    const double begin = value_rounding(mode, guard, lo), end = value_rounding(mode, guard, hi);
                    rounding = std::max(begin, end);
                    fit_sizes(q, miss, begin, end, sizes);
                },
                [&] { return value(hi); });
            if (guard.is_watched() || is_distinction(guard))
                look_closer(mode, guard, sign, lo, hi, is_last && hi == 1.0);
            const std::size_t before = found_.size();
            take(guard, g, fresh && lo == 0.0, lo, hi, arrival.side);
            for (std::size_t i = before; i < found_.size(); ++i) improve(found_[i], q, lo, hi, value, rounding);
        };
        const auto passed = [&](double x, double doubt, bool rising, bool is_pole) {
            if (side() == 0 && side_of(guard) == 0 && is_pole) {
                side_of(guard) = rising ? 1 : -1;
                return;
            }
            // a mode ends where its sign does, by a pole too
            found_.push_back({x, doubt, 16.0 * doubt, g, rising, is_pole && guard.is_watched()});
        };
        if (const auto end = rough_.find(finest(), value, side, fitted, passed)) {
            Found f{*end, 0.0, 0.0, g, false};
            f.breaks = true;
            found_.push_back(f);
        }
    }

    /// A root of the polynomial q on [lo, hi] at one of the values it was made through: Newton's method, slope by the
    /// polynomial, while it gets better. It is then known as far as the values are, to `rounding`.
    template <class Value>
    static void improve(Found& f, const series::Coefficients& q, double lo, double hi, const Value& value,
                        double rounding) {
        const double place = (f.place - lo) / (hi - lo);
        double slope = 0.0;
        for (int k = series::Fit::degree; k >= 1; --k) slope = slope * place + k * q[static_cast<std::size_t>(k)];
        double best = std::numeric_limits<double>::infinity(), x = f.place;
        for (int iteration = 0; iteration < 4 && f.place > lo; ++iteration) {
            const double g = value(x);
            if (!(std::abs(g) < best)) break;
            best = std::abs(g);
            f.place = x;
            x = std::clamp(x - g / slope * (hi - lo), lo, hi);
            if (!(std::abs(x - f.place) < 1e-3 * (hi - lo)) || x == f.place) break;
        }
        enclose(f, lo, hi, value);
        rounding = std::max(rounding, 4.0 * epsilon * series::value_of_sizes(q.data(), series::Fit::degree, place));
        const double known = 4.0 * epsilon * f.place + rounding / std::abs(slope) * (hi - lo);
        if (!(known < f.doubt)) return;
        f.doubt = known;
        f.near = std::min(f.near, 16.0 * known);
    }

    /// The same where the polynomial's slope is not that of the function, as on a step very long beside the place: its
    /// sign on both sides, then halves.
    template <class Value>
    static void enclose(Found& f, double lo, double hi, const Value& value) {
        const double at_place = f.rising ? value(f.place) : -value(f.place);
        if (!(std::abs(at_place) > 0.0) || f.place <= lo) return;
        // the other side is ahead of a place before the zero, behind one after it
        const double way = at_place < 0.0 ? 1.0 : -1.0;
        // as far as the interval goes: of a high power the polynomial tells little
        constexpr int most_steps = 54;
        double near = f.place, far = near, step = 2.0 * epsilon * f.place;
        for (int k = 0; k < most_steps; ++k, step *= 2.0) {
            far = std::clamp(f.place + way * step, lo, hi);
            const double g = f.rising ? value(far) : -value(far);
            if (!std::isfinite(g)) return;
            if (g * way >= 0.0) break;
            near = far;
            if (far == lo || far == hi || k == most_steps - 1) return;
        }
        while (std::abs(far - near) > 2.0 * epsilon * std::abs(far)) {
            const double middle = 0.5 * (near + far);
            const double g = f.rising ? value(middle) : -value(middle);
            (g * way >= 0.0 ? far : near) = middle;
        }
        f.place = far;
    }

    /// Whether a watched function whose side is another one where the piece begins, with a value, has passed a pole on
    /// the way. Its values just before are those of the motion that the piece goes on with.
    bool passed_pole(const Mode& mode, const Guard& guard, double begins) {
        const double length = engine_.piece().length;
        const auto value = [&](double x) { return value_at(mode, guard, x * length, true); };
        for (double back = std::max(finest(), 0x1p-50); back <= 4.0; back *= 4.0)
            if (const double before = value(-back); before * begins < 0.0)
                return RoughPassages::is_pole(value, -back, 0.0, before > 0.0 ? 1 : -1, finest());
        return false;
    }

    /// A guard at a place of the piece; `by_piece`: of one that is recorded, at the state the polynomial gives.
    double value_at(const Mode& mode, const Guard& guard, double place, bool by_piece = false) {
        if (guard.output >= 0) return evaluated(mode, place, by_piece).output(guard.output);
        const Piece& piece = engine_.piece();
        state_.resize(static_cast<std::size_t>(piece.variables));
        engine_.state(place, state_);
        return model_.guard_value(guard, mode, piece.at(place).hi, state_);
    }

    bool handled(std::size_t g) const { return g < handled_.size() && handled_[g]; }

    const HybridModel& model_;
    Engine& engine_;
    double slack_;
    const std::vector<Guard>* current_ = nullptr;
    std::vector<int> sides_;
    std::vector<Watched> watched_;  // by watched function
    std::vector<double> ends_;      // values of watched guards at the end of the last piece
    std::vector<bool> handled_;     // guards whose zero began the mode
    std::vector<int> fired_;
    std::vector<Direction> directions_;
    std::vector<Found> found_;
    std::vector<double> state_;
    Passages passages_, closer_;
    const Equations* evaluated_ = nullptr;
    std::unique_ptr<Evaluator<double>> evaluator_;
    series::Coefficients powers_{};  // of the piece's length
    int degree_ = 0;
    bool stops_ = false, at_start_ = false, begins_ = false;
    double touch_ = 0.0;  // where slip touches zero and rounding decides whether it passes, on [0, 1] of the piece
    const Guard* broken_ = nullptr;
    RoughPassages rough_;
};

}  // namespace rbdyn
