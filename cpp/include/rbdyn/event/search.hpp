// Where the guards of a mode pass zero on an engine's piece.
//
// A guard of a mode is valid while it is not negative; one that is watched may have either sign, and its side is kept
// from mode to mode, so that what passes zero together with a change of mode is not lost. A guard at zero where a mode
// begins (just handled, or starting there) is disarmed: its known root is divided out with its multiplicity, and the
// side it leaves to is the sign of its first coefficient that is not zero.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/sort_few.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn {

class EventSearch {
public:
    /// `slack` [s]: an event that the engine's accuracy cannot tell from the end of the run is met there.
    EventSearch(const HybridModel& model, Engine& engine, double slack)
        : model_(model), engine_(engine), slack_(slack) {}

    /// A mode begins. Guards in `handled`, by index, began it with their zero.
    void enter(const Mode& mode, std::vector<bool> handled) {
        handled_ = std::move(handled);
        sides_.assign(mode.equations->guards.size(), 0);
        ends_.assign(mode.equations->guards.size(), 0.0);
    }
    /// A watched function whose zero changed the state may be on any side from here.
    void forget_side(const Guard& guard) { watch_sides_[static_cast<std::size_t>(guard.watch)] = 0; }
    /// Events that follow each other at one instant are made by rounding: look less closely.
    void set_crowded(int crowded) {
        significant_ = std::ldexp(4e-12, 2 * std::min(crowded, 10));
        rounding_ = std::ldexp(64.0 * epsilon, 2 * std::min(crowded, 10));
    }

    /// Looks for events on the engine's piece. Records watched ones; returns tau of the first change of mode or stop,
    /// or a negative number.
    double examine(Record& record, const Mode& mode, bool fresh, bool is_last) {
        const std::vector<Guard>& guards = mode.equations->guards;
        fired_.clear();
        stops_ = false;
        if (guards.empty()) return -1.0;
        const Piece& piece = engine_.piece();
        found_.clear();
        degree_ = std::min(engine_.guard_order(), series::max_degree);
        double power = 1.0;
        for (int k = 0; k <= degree_; ++k, power *= piece.length) powers_[static_cast<std::size_t>(k)] = power;
        for (std::size_t g = 0; g < guards.size(); ++g) seek(mode, guards, g, fresh, is_last);
        double first = 2.0;
        for (const Found& f : found_)
            if (interrupts(guards[f.guard], f)) first = std::min(first, f.place);
        const double together = first + 1e-13 + 4.0 * epsilon * std::abs(piece.start.hi) / piece.duration();
        sort_few<Found>(found_, [](const Found& a, const Found& b) { return a.place < b.place; });
        for (const Found& f : found_) {
            const Guard& guard = guards[f.guard];
            if (guard.is_watched()) {
                // what comes after the end of the mode is found again in the next one, by its side
                if (f.place > together) continue;
                side_of(guard) = f.rising ? 1 : -1;
                if (!matches(guard, f)) continue;
                if (guard.role == GuardRole::record) {
                    const Instant at = piece.at(std::min(f.place, first) * piece.length);
                    note_watched(record, {at.hi, guard.kind, guard.subject, guard.name, f.direction(), 0.0, at});
                    continue;
                }
            } else if (f.place > together) {
                continue;
            }
            if (std::find(fired_.begin(), fired_.end(), static_cast<int>(f.guard)) != fired_.end()) continue;
            fired_.push_back(static_cast<int>(f.guard));
            directions_.resize(guards.size());
            directions_[f.guard] = f.direction();
            stops_ = stops_ || guard.role == GuardRole::stop;
        }
        return first <= 1.0 ? polished(mode, first * piece.length) : -1.0;
    }

    /// The guards that end the mode, and whether they end the run.
    const std::vector<int>& fired() const { return fired_; }
    bool stops() const { return stops_; }
    /// In which a guard that fired passed zero.
    Direction direction(int guard) const { return directions_[static_cast<std::size_t>(guard)]; }

    /// Watched functions in a mode in which nothing moves: those that jumped where it began.
    void examine_still(Record& record, const Mode& mode, Instant t, std::span<const double> x) {
        const auto& guards = mode.equations->guards;
        if (guards.empty()) return;
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t.hi, x);
        for (const Guard& guard : guards) {
            if (guard.watch < 0 || guard.output < 0) continue;
            const double value = values.output(guard.output);
            const int side = value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
            int& before = side_of(guard);
            if (side == 0 || side == before) continue;
            const Found f{0.0, 0, side > 0};
            if (before != 0 && matches(guard, f))
                note_watched(record, {t.hi, guard.kind, guard.subject, guard.name, f.direction(), 0.0, t});
            before = side;
        }
    }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    struct Found {
        double place;
        std::size_t guard;
        bool rising;
        Direction direction() const { return rising ? Direction::rising : Direction::falling; }
    };

    /// Watched functions come before the other events of an instant, also where they are found after them.
    static void note_watched(Record& record, Event event) {
        auto place = record.events.end();
        while (place != record.events.begin()) {
            const Event& before = *std::prev(place);
            if (before.kind == EventKind::watch ||
                event.instant - before.instant > 8.0 * epsilon * std::abs(event.time))
                break;
            --place;
        }
        record.events.insert(place, std::move(event));
    }

    static bool matches(const Guard& guard, const Found& f) {
        return guard.direction == Direction::either || guard.direction == f.direction();
    }
    static bool interrupts(const Guard& guard, const Found& f) {
        return guard.role != GuardRole::record && (!guard.is_watched() || matches(guard, f));
    }

    /// The side a watched function is on, kept through the modes; else that of the guard in this mode.
    int& side_of(const Guard& guard) {
        if (guard.watch < 0) {
            const auto* first = current_->data();
            return sides_[static_cast<std::size_t>(&guard - first)];
        }
        const auto index = static_cast<std::size_t>(guard.watch);
        if (watch_sides_.size() <= index) watch_sides_.resize(index + 1, 0);
        return watch_sides_[index];
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

    /// The equations themselves, evaluated on the engine's piece.
    const Evaluator<double>& evaluated(const Mode& mode, double place) {
        if (evaluated_ != mode.equations) {
            evaluator_ = std::make_unique<Evaluator<double>>(mode.equations->program);
            evaluated_ = mode.equations;
        }
        const Piece& piece = engine_.piece();
        state_.resize(static_cast<std::size_t>(piece.variables));
        engine_.state(place, state_);
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
                seek_by_values(mode, guard, g, 0.0, 1.0, fresh, is_last, 0);
            return;
        }
        const double* c = engine_.guard(static_cast<int>(g));
        const double sign =
            guard.sign_parameter >= 0 ? mode.parameters[static_cast<std::size_t>(guard.sign_parameter)] : 1.0;
        int degree = degree_;
        // the guard on the unit interval
        series::Coefficients q;
        for (int k = 0; k <= degree; ++k)
            q[static_cast<std::size_t>(k)] = c[k] * powers_[static_cast<std::size_t>(k)] * sign;
        const bool is_watch = guard.is_watched();
        int& side = side_of(guard);
        const double* p = q.data();
        const double q0 = q[0];
        const int starts = q0 > 0.0 ? 1 : q0 < 0.0 ? -1 : 0;
        if (!fresh && !is_last && starts == side && !is_watch && series::keeps_sign(q.data(), degree)) return;
        double size = 0.0;
        for (int k = 1; k <= degree; ++k) size = std::max(size, std::abs(q[static_cast<std::size_t>(k)]));
        // at zero where a mode begins, just handled or within rounding; or where two pieces meet, within their gap
        bool at_zero = false;
        if (fresh)
            at_zero = (handled(g) && !is_watch) || starts == 0 || std::abs(q0) <= (handled(g) ? 1e-9 : 1e-12) * size;
        else if (starts != side)
            at_zero = std::abs(q0) <= 2.0 * std::abs(ends_[g] - q0) + 1e-13 * size;
        int leaves = starts;
        if (at_zero) {
            const int m = leading(q.data(), degree, is_watch && handled(g));
            if (m > degree || size == 0.0) return;  // stays at zero
            p += m;
            degree -= m;
            leaves = p[0] > 0.0 ? 1 : -1;
        }
        if (is_watch) ends_[g] = series::value(q.data(), static_cast<int>(engine_.guard_order()), 1.0);
        if (is_watch && side == 0) side = leaves;
        if (fresh && !is_watch) side = 1;
        if (leaves != side) {
            if (is_rounding(mode, guard, std::max(std::abs(q0), size))) return;
            found_.push_back({0.0, g, leaves > 0});
            if (!is_watch) return;
        }
        roots_.clear();
        finder_.find(p, degree, roots_);
        if (is_last && roots_.empty()) at_the_end(mode, guard, sign, p, degree);
        if (!roots_.empty() && is_rounding(mode, guard, std::max(std::abs(q0), size))) return;
        for (double place : roots_) {
            leaves = -leaves;
            found_.push_back({place, g, leaves > 0});
            if (!is_watch) break;
        }
    }

    void locate(const Guard& guard, std::size_t g, bool fresh) {
        const auto tau = guard.locator->first(engine_.piece(), fresh);
        if (tau) found_.push_back({*tau / engine_.piece().length, g, false});
    }

    /// A guard that has values only: on [lo, hi] of the piece as a polynomial through them, on halves where it does not
    /// hold.
    void seek_by_values(const Mode& mode, const Guard& guard, std::size_t g, double lo, double hi, bool fresh,
                        bool is_last, int depth) {
        using series::Fit;
        const Piece& piece = engine_.piece();
        state_.resize(static_cast<std::size_t>(piece.variables));
        const auto value = [&](double x) {
            const double tau = (lo + x * (hi - lo)) * piece.length;
            engine_.state(tau, state_);
            return model_.guard_value(guard, mode, piece.at(tau).hi, state_);
        };
        std::array<double, Fit::points> values;
        double size = 0.0;
        bool is_finite = true;
        for (int j = 0; j < Fit::points; ++j) {
            values[static_cast<std::size_t>(j)] = value(Fit::place(j));
            is_finite = is_finite && std::isfinite(values[static_cast<std::size_t>(j)]);
            size = std::max(size, std::abs(values[static_cast<std::size_t>(j)]));
        }
        if (!is_finite || size == 0.0) return;
        series::Coefficients q{};
        Fit::coefficients(values.data(), 1e-15 * size, q.data());
        bool holds = true;
        for (int j = 0; j < Fit::checks && holds; ++j)
            holds =
                std::abs(value(Fit::check(j)) - series::value(q.data(), Fit::degree, Fit::check(j))) <= 1e-10 * size;
        if (!holds && depth < max_halvings) {
            const double middle = 0.5 * (lo + hi);
            seek_by_values(mode, guard, g, lo, middle, fresh, false, depth + 1);
            seek_by_values(mode, guard, g, middle, hi, false, is_last, depth + 1);
            return;
        }
        int& side = side_of(guard);
        // the side so far, with what was already found on this piece
        int now = side;
        for (const Found& f : found_)
            if (f.guard == g) now = f.rising ? 1 : -1;
        const double* p = q.data();
        int degree = Fit::degree, leaves = q[0] > 0.0 ? 1 : q[0] < 0.0 ? -1 : 0;
        if (leaves == 0 || (fresh && std::abs(q[0]) <= (handled(g) ? 1e-9 : 1e-12) * size)) {
            const int m = leading(q.data(), degree, handled(g));
            if (m > degree) return;
            p += m;
            degree -= m;
            leaves = p[0] > 0.0 ? 1 : -1;
        }
        if (now == 0) side = now = leaves;
        if (leaves != now) found_.push_back({lo, g, leaves > 0});
        roots_.clear();
        finder_.find(p, degree, roots_);
        if (is_last && roots_.empty()) {
            // at the very end of the run, within rounding and the engine's error
            double sum = 0.0, slope = 0.0;
            for (int k = degree; k >= 0; --k) {
                sum += std::abs(p[k]);
                slope += k * p[k];
            }
            const double late =
                (slack_ + epsilon * std::abs(piece.at(piece.length).hi)) / ((hi - lo) * piece.duration());
            const double end = series::value(p, degree, 1.0);
            if (std::abs(end) <= 1e-15 * size + late * std::abs(slope) && end * slope <= 0.0 && end * leaves >= 0.0)
                roots_.push_back(1.0);
        }
        for (const double place : roots_) {
            leaves = -leaves;
            found_.push_back({lo + place * (hi - lo), g, leaves > 0});
        }
    }

    /// Whether a guard is nothing but the rounding of its terms on the piece: a reaction that dies away, say.
    bool is_rounding(const Mode& mode, const Guard& guard, double size) {
        if (mode.equations->is_variable(guard)) return size == 0.0;
        return size <= rounding_ * evaluated(mode, 0.0).magnitude(guard.output);
    }

    /// The order of the first term that is not rounding. A piece cut short by the end of a run tells too little, so the
    /// terms are weighed over the length that the engine would have gone. Where the user has set the state anew, every
    /// term is meant (the last small bounces of a ball).
    int leading(const double* q, int degree, bool is_set) const {
        const double stretch = std::max(1.0, engine_.natural_length() / engine_.piece().length);
        series::Coefficients sizes;
        double size = 0.0, power = 1.0;
        for (int k = 1; k <= degree; ++k) {
            sizes[static_cast<std::size_t>(k)] = std::abs(q[k]) * (power *= stretch);
            size = std::max(size, sizes[static_cast<std::size_t>(k)]);
        }
        int m = 1;
        const double rounding = is_set ? 0.0 : significant_ * size;
        while (m <= degree && !(sizes[static_cast<std::size_t>(m)] > rounding)) ++m;
        return m;
    }

    /// A root at the very end of the run that rounding or the engine's error put just beyond it.
    void at_the_end(const Mode& mode, const Guard& guard, double sign, const double* p, int degree) {
        double sum = 0.0, slope = 0.0;
        for (int k = degree; k >= 0; --k) {
            sum += std::abs(p[k]);
            slope += k * p[k];
        }
        const Piece& piece = engine_.piece();
        const double late = (slack_ + epsilon * std::abs(piece.at(piece.length).hi)) / piece.duration();
        const double value = series::value(p, degree, 1.0), bound = 4.0 * epsilon * sum + late * std::abs(slope);
        if (std::abs(value) > 1e-3 * sum || value * slope > 0.0) return;
        if (std::abs(value) <= bound) return roots_.push_back(1.0);
        // the series of the guard is cut off sooner than the state's: the guard itself decides
        if (mode.equations->is_variable(guard)) return;
        const double g = sign * evaluated(mode, piece.length).output(guard.output);
        if (std::abs(g) <= bound && g * slope <= 0.0) roots_.push_back(1.0);
    }

    bool handled(std::size_t g) const { return g < handled_.size() && handled_[g]; }

    // a function with values only is looked at in 2^10 parts of a step where it is not smooth, and no closer
    static constexpr int max_halvings = 10;

    const HybridModel& model_;
    Engine& engine_;
    double slack_;
    const std::vector<Guard>* current_ = nullptr;
    std::vector<int> sides_;
    std::vector<int> watch_sides_;  // by watched function; 0: not known yet
    std::vector<double> ends_;      // values of watched guards at the end of the last piece
    std::vector<bool> handled_;     // guards whose zero began the mode
    std::vector<int> fired_;
    std::vector<Direction> directions_;
    std::vector<Found> found_;
    std::vector<double> roots_, state_;
    series::RootFinder finder_;
    const Equations* evaluated_ = nullptr;
    std::unique_ptr<Evaluator<double>> evaluator_;
    series::Coefficients powers_{};  // of the piece's length
    int degree_ = 0;
    bool stops_ = false;
    double rounding_ = 64.0 * epsilon;  // of the terms of a guard: one of this size is zero
    double significant_ = 4e-12;        // of the largest term of a guard: less is rounding
};

}  // namespace rbdyn
