// The one driver of hybrid motion: steps an engine through smooth modes, isolates events on its pieces, asks the
// model what comes next.
//
// Contract: an event fires at t* in (t0, t1]; nothing fires at the start. A guard at zero where a mode begins (just
// handled, or starting there) is disarmed: its known root is divided out with its multiplicity, and the side it
// leaves to is the sign of its first coefficient that is not zero. Guards of mode or stop role are valid while not
// negative. Events closer than rounding are simultaneous: all are handled together, watched functions first, then by
// kind and subject. The number of events is bounded.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn {

/// What of a run is kept.
struct Keep {
    enum class What { all, end, times } what = What::all;
    std::vector<double> times = {};  // increasing
};

class Driver {
public:
    /// Called now and then with the time reached; false stops the run.
    using Monitor = std::function<bool(double)>;

    /// `slack` [s]: an event that the engine's accuracy cannot tell from the end of the run is met there.
    Driver(const HybridModel& model, Engine& engine, std::int64_t max_steps, Keep keep = {}, Monitor monitor = {},
           double slack = 0.0)
        : model_(model),
          engine_(engine),
          max_steps_(max_steps),
          keep_(std::move(keep)),
          monitor_(std::move(monitor)),
          slack_(slack) {}

    Record run(double start, std::vector<double> x, double until) {
        Record record;
        advance(record, start, std::move(x), until);
        return record;
    }

private:
    void advance(Record& record, double start, std::vector<double> x, double until) {
        record.start = start;
        record.variables = model_.variables();
        Instant t{start, 0.0};
        record.end = t;
        Mode mode = model_.begin(start, x);
        enter(record, mode, t, x);
        bool fresh = true;
        int crowded = 0, passes = 0;
        // less than this from the end is the end
        const double least = 2.0 * epsilon * std::abs(until);
        while (until - t > least) {
            if (mode.still) {
                rest(record, t, x, until);
                t = {until, 0.0};
                break;
            }
            if (engine_.work().steps >= max_steps_) return finish(record, t, Status::step_limit);
            if (monitor_ && (engine_.work().steps & 63) == 63 && !monitor_(t.hi))
                return finish(record, t, Status::stopped_by_user);
            const StepStatus step = engine_.step(until);
            if (step != StepStatus::ok) {
                if (!fresh) record.last_state(x);
                if (++passes > max_crowded || !pass(record, mode, t, x, until))
                    return finish(record, t, Status::not_finite);
                fresh = true;
                continue;
            }
            const Piece& piece = engine_.piece();
            const bool is_last = !(until - piece.at(piece.length) > least);
            const double cut = polished(mode, examine(record, mode, fresh, is_last));
            if (cut < 0.0) {
                store(record, piece, piece.length, fresh);
                t = piece.at(piece.length);
                fresh = false;
                continue;
            }
            // a true end of this piece at the event, exact in the engine's own terms
            const Instant at = cut < piece.length ? piece.at(cut) : piece.at(piece.length);
            store(record, piece, cut, fresh);
            engine_.state(cut, x);
            crowded = at - t > 8.0 * epsilon * std::abs(at.hi) ? 0 : crowded + 1;
            // events that follow each other at one instant are made by rounding: look less closely
            significant_ = std::ldexp(4e-12, 2 * std::min(crowded, 10));
            rounding_ = std::ldexp(64.0 * epsilon, 2 * std::min(crowded, 10));
            t = at;
            if (stops_) {
                for (int index : fired_) note(record, mode.equations->guards[static_cast<std::size_t>(index)], t);
                return finish(record, t, Status::stopped_by_event);
            }
            std::vector<Happening> happenings;
            const Equations* before = mode.equations;
            mode = model_.next(mode, fired_, t.hi, x, happenings);
            // in the same equations, the guards just handled are at their zero, whatever rounding makes of them
            handled_.assign(mode.equations->guards.size(), false);
            if (mode.equations == before)
                for (int index : fired_) handled_[static_cast<std::size_t>(index)] = true;
            std::stable_sort(happenings.begin(), happenings.end(), [](const Happening& a, const Happening& b) {
                return std::pair(a.kind, a.subject) < std::pair(b.kind, b.subject);
            });
            for (const Happening& h : happenings)
                record.events.push_back({t.hi, h.kind, h.subject, h.name, h.direction, 0.0, t});
            if (crowded > max_crowded || static_cast<std::int64_t>(record.events.size()) > max_steps_)
                return finish(record, t, Status::inconsistent);
            enter(record, mode, t, x);
            fresh = true;
        }
        return finish(record, {until, 0.0}, Status::reached_end);
    }

    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // events of one instant: more than this and no smooth motion exists
    static constexpr int max_crowded = 100;

    void finish(Record& record, Instant t, Status status) const {
        record.end = t;
        record.status = status;
        record.work = engine_.work();
    }

    void enter(Record& record, const Mode& mode, Instant t, std::span<const double> x) {
        record.modes.push_back(mode);
        sides_.assign(mode.equations->guards.size(), 0);
        ends_.assign(mode.equations->guards.size(), 0.0);
        if (!mode.still) engine_.start(*mode.equations, mode.parameters, t, x);
    }

    void store(Record& record, const Piece& piece, double length, bool fresh) const {
        const int mode = static_cast<int>(record.modes.size()) - 1;
        if (keep_.what == Keep::What::times) {
            const double lo = piece.start.hi, hi = piece.at(length).hi;
            const auto wanted = std::lower_bound(keep_.times.begin(), keep_.times.end(), lo);
            // the piece that holds a wanted time, and the last one so far
            if (record.entries().size() > kept_) record.drop_last();
            record.append(piece, length, mode, fresh);
            if (wanted != keep_.times.end() && *wanted <= hi) kept_ = record.entries().size();
            return;
        }
        record.append(piece, length, mode, fresh);
        if (keep_.what == Keep::What::end) record.keep_last();
    }

    /// Past a point where the equations are not finite but the motion is (a spring through its anchor): a parabola so
    /// short that its error is rounding, from the model's own slope.
    bool pass(Record& record, Mode& mode, Instant& t, std::vector<double>& x, double until) {
        const std::size_t n = x.size() / 2;
        std::vector<double> slope(x.size());
        if (!model_.slope(mode, t.hi, x, slope)) return false;
        double time = until - t;
        for (std::size_t i = 0; i < n; ++i)
            if (slope[n + i] != 0.0 && slope[i] != 0.0) time = std::min(time, std::abs(slope[i] / slope[n + i]));
        const double h = 0x1p-27 * time;
        if (!(h > 8.0 * epsilon * std::abs(t.hi))) return false;
        std::vector<double> c(3 * x.size(), 0.0);
        for (std::size_t i = 0; i < x.size(); ++i) {
            c[3 * i] = x[i];
            c[3 * i + 1] = slope[i] * h;
            if (i < n) c[3 * i + 2] = 0.5 * slope[n + i] * h * h;
        }
        const Piece piece{t, h, 1.0, record.variables, 2, c.data(), 3};
        store(record, piece, 1.0, true);
        piece.state(1.0, x);
        t = piece.at(1.0);
        std::vector<Happening> none;
        mode = model_.next(mode, {}, t.hi, x, none);
        handled_.clear();
        enter(record, mode, t, x);
        return true;
    }

    /// Nothing moves any more: one piece to the end.
    void rest(Record& record, Instant t, std::span<const double> x, double until) const {
        const Piece piece{t, until - t, 1.0, record.variables, 0, x.data(), 1};
        store(record, piece, 1.0, true);
    }

    void note(Record& record, const Guard& guard, Instant t) const {
        record.events.push_back({t.hi, guard.kind, guard.subject, guard.name, guard.direction, 0.0, t});
    }

    /// Looks for events on the engine's piece. Records watched ones; returns tau of the first change of mode or stop,
    /// with its guards in fired_, or a negative number.
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
            if (guards[f.guard].role != GuardRole::record) first = std::min(first, f.place);
        const double together = first + 1e-13 + 4.0 * epsilon * std::abs(piece.start.hi) / piece.duration();
        std::stable_sort(found_.begin(), found_.end(),
                         [](const Found& a, const Found& b) { return a.place < b.place; });
        for (const Found& f : found_) {
            const Guard& guard = guards[f.guard];
            if (guard.role == GuardRole::record) {
                if (f.place > first) continue;
                sides_[f.guard] = -sides_[f.guard];
                const Direction direction = f.rising ? Direction::rising : Direction::falling;
                if (guard.direction != Direction::either && guard.direction != direction) continue;
                const Instant at = piece.at(f.place * piece.length);
                record.events.push_back({at.hi, guard.kind, guard.subject, guard.name, direction, 0.0, at});
            } else if (f.place <= together &&
                       std::find(fired_.begin(), fired_.end(), static_cast<int>(f.guard)) == fired_.end()) {
                fired_.push_back(static_cast<int>(f.guard));
                stops_ = stops_ || guard.role == GuardRole::stop;
            }
        }
        return first <= 1.0 ? first * piece.length : -1.0;
    }

    /// A root of the first guard in fired_, whose series was cut off, at a root of the guard itself: what is done at an
    /// event then sees it at zero within rounding. Newton's method, slope by the series, while it gets better.
    double polished(const Mode& mode, double cut) {
        if (cut <= 0.0 || fired_.empty()) return cut;
        const Guard& guard = mode.equations->guards[static_cast<std::size_t>(fired_.front())];
        if (mode.equations->is_variable(guard)) return cut;
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
        const double* c = engine_.guard(static_cast<int>(g));
        const double sign =
            guard.sign_parameter >= 0 ? mode.parameters[static_cast<std::size_t>(guard.sign_parameter)] : 1.0;
        int degree = degree_;
        // the guard on the unit interval
        series::Coefficients q;
        for (int k = 0; k <= degree; ++k)
            q[static_cast<std::size_t>(k)] = c[k] * powers_[static_cast<std::size_t>(k)] * sign;
        int& side = sides_[g];
        const double* p = q.data();
        const double q0 = q[0];
        const int starts = q0 > 0.0 ? 1 : q0 < 0.0 ? -1 : 0;
        const bool is_watch = guard.role == GuardRole::record;
        if (!fresh && !is_last && starts == side && !is_watch && series::keeps_sign(q.data(), degree)) return;
        double size = 0.0;
        for (int k = 1; k <= degree; ++k) size = std::max(size, std::abs(q[static_cast<std::size_t>(k)]));
        // at zero where a mode begins, just handled or within rounding; or where two pieces meet, within their gap
        bool at_zero = false;
        if (fresh)
            at_zero = handled(g) || starts == 0 || std::abs(q0) <= 1e-12 * size;
        else if (starts != side)
            at_zero = std::abs(q0) <= 2.0 * std::abs(ends_[g] - q0) + 1e-13 * size;
        int leaves = starts;
        if (at_zero) {
            const int m = leading(q.data(), degree);
            if (m > degree || size == 0.0) return;  // stays at zero
            p += m;
            degree -= m;
            leaves = p[0] > 0.0 ? 1 : -1;
        }
        if (is_watch) ends_[g] = series::value(q.data(), static_cast<int>(engine_.guard_order()), 1.0);
        if (fresh) side = is_watch ? leaves : 1;
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

    /// Whether a guard is nothing but the rounding of its terms on the piece: a reaction that dies away, say.
    bool is_rounding(const Mode& mode, const Guard& guard, double size) {
        if (mode.equations->is_variable(guard)) return size == 0.0;
        return size <= rounding_ * evaluated(mode, 0.0).magnitude(guard.output);
    }

    /// The order of the first term that is not rounding. A piece cut short by the end of a run tells too little, so the
    /// terms are weighed over the length that the engine would have gone.
    int leading(const double* q, int degree) const {
        const double stretch = std::max(1.0, engine_.natural_length() / engine_.piece().length);
        series::Coefficients sizes;
        double size = 0.0, power = 1.0;
        for (int k = 1; k <= degree; ++k) {
            sizes[static_cast<std::size_t>(k)] = std::abs(q[k]) * (power *= stretch);
            size = std::max(size, sizes[static_cast<std::size_t>(k)]);
        }
        int m = 1;
        while (m <= degree && !(sizes[static_cast<std::size_t>(m)] > significant_ * size)) ++m;
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

    struct Found {
        double place;
        std::size_t guard;
        bool rising;
    };

    const HybridModel& model_;
    Engine& engine_;
    std::int64_t max_steps_;
    Keep keep_;
    Monitor monitor_;
    double slack_;
    std::vector<int> sides_;
    std::vector<double> ends_;   // values of watched guards at the end of the last piece
    std::vector<bool> handled_;  // guards whose zero began the mode
    std::vector<int> fired_;
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
    mutable std::size_t kept_ = 0;
};

}  // namespace rbdyn
