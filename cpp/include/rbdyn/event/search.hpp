// Where the guards of a mode pass zero on an engine's piece.
//
// A guard of a mode is valid while it is not negative; one that is watched may have either sign, and its side is kept
// from mode to mode, so that what passes zero together with a change of mode is not lost. A guard at zero where a mode
// begins (just handled, or starting there) is disarmed: the side it leaves to is the first on which it is more than
// rounding (passages.hpp). What reaches zero where a distinction switches waits for the next mode to say whether it
// passes or turns back.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/closer_look.hpp"
#include "rbdyn/event/halt.hpp"
#include "rbdyn/event/passages.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/event/rough_passages.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/at_zero.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

class EventSearch {
public:
    /// `slack`, `is_alone`: as of a driver (driver.hpp).
    EventSearch(const HybridModel& model, Engine& engine, double slack, bool is_alone = false);

    /// A mode begins. Guards in `handled`, by index, began it with their zero. `begins`: with it the motion.
    void enter(const Mode& mode, std::vector<bool> handled, bool begins);
    /// What it knows where the run ends, and taken over after enter() by one that goes on.
    void leave(Halt& halt) const;
    void recall(const Halt& halt);
    /// A watched function whose zero changed the state may be on any side from here.
    void forget_side(const Guard& guard);
    /// Events that follow each other at one instant are made by rounding: look less closely.
    void set_crowded(int crowded);
    /// Events are as much later as rounding of what is watched leaves open (event/other_rounding.ipp).
    void round_otherwise(std::int64_t first) {
        rounds_otherwise_ = true;
        roundings_ = first;
    }
    /// Whether rounding number n goes up in it.
    static bool is_up(std::int64_t n);

    /// Looks for events on the engine's piece. Records watched ones; returns tau of the first change of mode or stop,
    /// or a negative number.
    double examine(Record& record, const Mode& mode, bool fresh, bool is_last);

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
    bool examine_still(Record& record, const Mode& mode, Instant t, std::span<const double> x);

    /// The run ends where a mode begins: watched functions that reached zero there have passed it if they go on to the
    /// other side, or stay. `fresh`: the mode begins just there, so that what jumps with it has passed, too. Returns
    /// whether one of them stops the run.
    bool settle(Record& record, const Mode& mode, Instant t, std::span<const double> x, bool fresh);

private:
    static std::size_t at(int k) { return static_cast<std::size_t>(k); }
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // of a piece: how far beyond its ends a guard that is least there is seen
    static constexpr double near_least = 1e-6;

    /// The side a watched function that was at zero where a mode begins goes to in it; 0: it stays, or no one can tell.
    /// `few`: to how much of themselves the numbers it is made of are known.
    int side_after(const Mode& mode, const Guard& guard, Instant t, std::span<const double> x, double few);

    struct Found {
        double place, doubt, near;  // on [0, 1] of the piece
        std::size_t guard;
        bool rising;
        bool is_pole = false, breaks = false;  // it changes its side and passes nothing; it ceases to be finite
        bool waits = false;                    // the mode ends there too, and what follows decides whether it passes
        // of a factor: whether what is watched passes zero there too, and which way
        bool is_silent = false, product_rises = false;
        int product = 0;  // its side from there on, if that is known
    };
    using Watched = WatchedSide;

    static Direction direction_of(bool rising) { return rising ? Direction::rising : Direction::falling; }
    static void note(Record& record, const Guard& guard, Direction direction, Instant at);

    /// The guards that are factors of the same watched function as one is: the first of them, and how many.
    struct Factors {
        std::size_t first, count;
    };
    static Factors factors_of(const std::vector<Guard>& guards, std::size_t g);
    /// The last side of a product that is known, whatever is zero since; 0: none is yet.
    int& product_of(const std::vector<Guard>& guards, const Factors& factors);
    /// Whether a watched function passes zero as its factors come to these sides, 0 for one that stays at zero: to
    /// which side; 0: it does not.
    int passes(const std::vector<Guard>& guards, const Factors& factors, std::span<const int> sides);
    /// Where factors pass zero, in order, what of it the product does. Two that pass at one place leave it as it is,
    /// and while one stays at zero it has no side: it passes where it leaves zero to another one than it came from.
    void multiply_sides(const std::vector<Guard>& guards);
    void multiply_sides(const std::vector<Guard>& guards, const Factors& factors);

    /// Takes what happens together with the first event that changes the mode or stops the run: what may come no later
    /// than `together`; of what is seen alone, than `at_once`.
    void fire(const std::vector<Guard>& guards, const Found& first, double together, double at_once);

    /// Whether a motion begins where a distinction in its mode changes.
    bool begins_on_edge(const Mode& mode);
    /// Whether a guard is zero where the piece begins, all numbers known to `few` of themselves.
    bool begins_at_zero(const Mode& mode, const Guard& guard, double few);

    /// Of a case distinction: a change of mode that may leave a corner in what is watched.
    static bool is_distinction(const Guard& guard) { return guard.kind == EventKind::switching && !guard.is_watched(); }
    /// Whether two places of one zero, computed apart, may be these.
    static bool are_near(const Found& a, const Found& b) { return std::abs(a.place - b.place) <= a.near + b.near; }

    static bool matches(const Guard& guard, bool rising);
    static bool interrupts(const Guard& guard, const Found& f);

    /// The side a watched function is on, kept through the modes; else that of the guard in this mode.
    int& side_of(const Guard& guard);
    Watched& watched(const Guard& guard);

    /// A root of the first guard in fired_, whose series was cut off, at a root of the guard itself: what is done at an
    /// event then sees it at zero within rounding. Newton's method, slope by the series, while it gets better. A guard
    /// that is a variable is cut off no sooner than the state, unless the engine knows that better than its piece.
    double polished(const Mode& mode, double cut);
    /// A root of a guard where a run that rounds otherwise takes it; of others the same (other_rounding.ipp).
    double otherwise(const Mode& mode, std::size_t g, double place);
    /// Whether a guard is the gap of a contact that has just opened without an impulse: it is zero, and so is its rate.
    bool begins_touching(const Mode& mode, const Guard& guard, bool fresh) const;
    /// How many of the first coefficients of such a gap are zero: it goes by the first one that is not.
    int zeros_of_gap(const Mode& mode, const Guard& guard);
    /// Whether a gap, q on the piece, begins at zero without a rate or an acceleration, by their terms.
    bool begins_level(const Mode& mode, const Guard& guard, const series::Coefficients& q);

    // --- gaps lower than their rounding in doubles (search_low.ipp) ---

    /// Whether a guard is the gap of a contact, followed so, that has not just left its surface.
    bool is_gap(const Mode& mode, const Guard& guard, std::size_t g) const;
    /// The value of a guard on the piece, by the digits that the state has beyond doubles.
    double fine_value(const Mode& mode, const Guard& guard, double tau);
    /// The first coefficient of a gap that is low where the piece begins; none: it is not.
    std::optional<double> low_gap(const Mode& mode, const Guard& guard, std::size_t g, const series::Coefficients& q);
    /// Where a low gap is zero near a place of the piece.
    double polished_low(const Mode& mode, const Guard& guard, double cut, double slope);
    /// Whether rounding of its terms moves the zero of a guard by more than the times of it are rounded.
    bool is_passed_barely(const Mode& mode, const Guard& guard, double cut, double slope);
    // of the sizes of its terms: from there to the rounding of doubles it is as far as the square root of that
    static constexpr double low_gaps = 0x1p-14;

    /// Finds where a guard sinks to its `least` on the piece, and rises again.
    void seek_least(const Record& record, const Mode& mode, std::size_t g);
    /// The same by the series c of the guard: where the root of what it is more than its `least` changes its sign.
    /// False: that has no series that holds on the piece.
    bool seek_roots(const Record& record, const Mode& mode, std::size_t g, const double* c);
    /// Takes such a place, in units of the piece, unless it is known. `doubt`: how well it is, on [0, 1] of the piece.
    void add_least(const Record& record, const Mode& mode, std::size_t g, double place, double doubt);
    /// Where near a place of the piece, in its units, a value is least, if that is 1 at most; c: its series, if known.
    template <class F>
    std::optional<double> least_near(const F& exact, const double* c, double place) const;
    /// The place near one that is found where a guard is least, by its values: what a series that is cut off makes of
    /// what is all but zero for a while is known to no better than that while. `apart`: how far the next such place is.
    template <class F>
    double sharpened(const F& exact, double place, double apart) const;

    /// The state that the polynomial of the engine's piece gives; until it is asked for the next time.
    std::span<const double> state_of_piece(double tau);

    /// The equations themselves, evaluated on the engine's piece; `by_piece`: at the state its polynomial gives.
    const Evaluator<double>& evaluated(const Mode& mode, double place, bool by_piece = false);

    /// Where guard g changes its sign on the piece, as places in [0, 1].
    void seek(const Mode& mode, const std::vector<Guard>& guards, std::size_t g, bool fresh, bool is_last);

    /// Where rounding of a guard's polynomial on [lo, hi] of the piece, whose terms are those of all of it, hides
    /// whether it passes zero, its values tell as far as the rounding of its terms there lets them. `fits`: it is no
    /// series there.
    void look_closer(const Mode& mode, const Guard& guard, double sign, double lo, double hi,
                     const Passages::Arrival& arrival, bool fits);
    /// A guard, `sign` times it, on a part of the piece.
    struct Stretch {
        const Mode& mode;
        const Guard& guard;
        double sign, from, width;
        double place(double x) const { return from + x * width; }
    };
    double value_on(const Stretch& s, double x);
    /// Looks for where it passes zero from lo to hi of a stretch, by its series from lo on, or by its values.
    CloserLook::Told find_by_series(const Stretch& s, double lo, double hi, int side, Passages& passages);
    CloserLook::Told find_by_values(const Stretch& s, double lo, double hi, int side, Passages& passages);
    /// The side beyond the end of the run of what is zero there but for rounding; 0: it is not, or cannot be told.
    int side_beyond(const Stretch& s, const Passages::Arrival& arrival);

    /// Places from the first on, known no better than rounding of the guard's polynomial lets them, as well as its
    /// values tell.
    void sharpen(const Mode& mode, const Guard& guard, double sign, std::size_t first);

    /// The rounding of a guard's value on the piece, at a place in [0, 1]: of its terms, the state and the time.
    double value_rounding(const Mode& mode, const Guard& guard, double place);

    /// Sizes of the terms of a polynomial that misses a function by `miss` between its points, the first of which is
    /// where it begins. Its values are known to `begin` there and to `end` at 1.
    static void fit_sizes(const series::Coefficients& q, double miss, double begin, double end, double* sizes);

    /// Takes the passages of a guard on [lo, hi] of the piece. `known`: the side it is on, with what was already found
    /// on the piece.
    void take(const Guard& guard, std::size_t g, bool fresh, double lo, double hi, int known);

    void locate(const Guard& guard, std::size_t g, bool fresh);

    /// Times closer than this on the piece, in its length, are one.
    double finest() const;

    /// A guard, `sign` times it, that is no series all along the piece, or has values only.
    void seek_by_values(const Mode& mode, const Guard& guard, std::size_t g, double sign, bool fresh, bool is_last);

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
    bool passed_pole(const Mode& mode, const Guard& guard, double begins);

    /// The same with the state off by rounding, to one side or the other: whichever is finite.
    double blurred_value(const Mode& mode, const Guard& guard, double place);
    /// A guard at a place of the piece; `by_piece`: of one that is recorded, at the state the polynomial gives.
    double value_at(const Mode& mode, const Guard& guard, double place, bool by_piece = false);

    /// How far from zero rounding of the motion may have a guard that is zero at a place of the piece.
    double rounding_at_zero(const Mode& mode, const Guard& guard, double place);

    /// Whether it is known of a guard that it begins the piece with its zero, and the value of that if it is to be
    /// compared.
    void know_zero(const Guard& guard, std::size_t g, bool fresh, int starts, Passages::Arrival& arrival);
    bool handled(std::size_t g) const { return g < handled_.size() && handled_[g]; }

    const HybridModel& model_;
    Engine& engine_;
    double slack_;
    bool is_alone_;
    const std::vector<Guard>* current_ = nullptr;
    std::vector<int> sides_;
    std::vector<Watched> watched_;  // by watched function
    std::vector<double> ends_;      // values of watched guards at the end of the last piece
    std::vector<bool> handled_;     // guards whose zero began the mode
    std::vector<int> ended_;        // contacts whose force came to zero as the last mode ended, where no more fired
    // guards that passed zero at the end of the run, and where the one ended that this goes on with: they begin at it
    std::vector<bool> passed_at_end_, passed_before_;
    std::vector<int> leaving_;  // watched functions, by part, that stayed where they passed zero until this piece
    std::vector<bool> stays_;   // guards that are zero all along the piece
    std::vector<int> fired_;
    std::vector<Direction> directions_;
    std::vector<Found> found_;
    std::vector<double> state_;
    Passages passages_;
    CloserLook closer_;
    std::unique_ptr<SeriesOnPiece> series_;
    const Equations *evaluated_ = nullptr, *fine_for_ = nullptr;
    std::unique_ptr<Evaluator<double>> evaluator_;
    std::unique_ptr<Evaluator<DoubleDouble>> fine_;
    series::Coefficients powers_{};  // of the piece's length
    series::RootFinder root_finder_;
    std::vector<double> roots_;
    int degree_ = 0;
    bool stops_ = false, at_start_ = false, begins_ = false, is_fresh_ = false, rounds_otherwise_ = false;
    std::int64_t roundings_ = 0;          // otherwise, so far
    std::optional<bool> begins_on_edge_;  // none: not asked yet
    std::optional<AtZero> zeros_;         // where the mode begins; none: not asked yet
    double touch_ = 0.0;  // where slip touches zero and rounding decides whether it passes, on [0, 1] of the piece
    const Guard* broken_ = nullptr;
    RoughPassages rough_;
};

}  // namespace rbdyn::inline RBDYN_FORM
