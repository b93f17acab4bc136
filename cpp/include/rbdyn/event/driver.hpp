// The one driver of hybrid motion: steps an engine through smooth modes, isolates events on its pieces, asks the
// model what comes next.
//
// Contract: an event fires at t* in (t0, t1]; nothing fires at the start (search.hpp). Events closer than rounding are
// simultaneous: all are handled together, watched functions first, then by kind and name. The number of events is
// bounded. What a function of the user's throws ends the run and is kept with it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/halt.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/event/memory_watch.hpp"
#include "rbdyn/event/progress.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/event/search.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Driver {
public:
    /// `slack` [s]: an event that the engine's accuracy cannot tell from the end of the run is met there. `is_alone`:
    /// no other run is held against it, so it ends where steps come too near to a loss of rank. `tolerance`: of the
    /// engine, by which steps that get on are told (progress.hpp).
    Driver(const HybridModel& model, Engine& engine, std::int64_t max_steps, Keep keep = {}, Monitor monitor = {},
           double slack = 0.0, bool is_alone = false, double tolerance = 0.0);

    Record run(double start, std::vector<double> x, double until);

    // The same in turns, for one who makes the steps of several runs side by side (abreast.hpp).

    /// Begins it. Returns whether it wants a step of its engine.
    bool set_out(Record& record, double start, std::vector<double> x, double until);
    /// Goes on after that. Returns whether it wants one more.
    bool go_on_after(Record& record, StepStatus step, double until);

    /// Goes on from where a run of the same model came to, as if it had not ended there.
    Record go_on(const Halt& halt, double until);
    /// What of the events is kept; by default all of them. They are handed on, or forgotten, while it runs.
    void keep_events(KeepEvents events) { keep_events_ = std::move(events); }
    /// Whether what is kept will fit into memory is watched.
    void watch_memory(MemoryWatch watch) { memory_ = std::move(watch); }
    /// Events up to then do not end the run.
    void pass_stops(double until) { stops_from_ = until; }
    /// It rounds the other way where events are, as one that another is held against (other_rounding.ipp).
    void round_otherwise(int chance) {
        rounds_otherwise_ = true;
        roundings_ = static_cast<std::int64_t>(chance) << 32;
        search_.round_otherwise(roundings_);
    }

private:
    /// What ends a step on its way, where the monitor wants no more.
    struct Stopped {};

    /// A part of a run, which returns whether it goes on. Of one that is over, or that throws, the end is kept.
    template <class Part>
    bool guarded(Record& record, const Part& part);
    /// The motion begins: its mode at the start.
    void begin(Record& record);
    /// The motion goes on from now_.
    void resume(Record& record);
    /// From now_ to the end.
    void proceed(Record& record, double until);
    /// Whether it may begin; else it is over.
    bool is_possible(Record& record);
    /// Less than this from the end is the end [s].
    static double least_before(const Record& record, double until) {
        return std::min(2.0 * epsilon * std::abs(until), 0x1p-20 * (until - record.start));
    }
    /// To the next step. Returns whether there is one; else it is the end.
    bool comes_to_step(Record& record, double until);
    /// Takes the piece of a step. Returns whether the run goes on.
    bool is_going_on(Record& record, StepStatus step, double until);
    /// What the guards `fired` change. `piece`, `cut`: where, if it is on one. Returns false where the run is over.
    bool change(Record& record, const std::vector<int>& fired, const Piece* piece, double cut);
    /// What an event has changed of the velocities goes over to its other neighbours.
    void round_otherwise(std::span<const double> before);
    /// Those of the guards that fired which do not stop the run.
    std::vector<int> without_stops(const std::vector<int>& fired) const;

    /// Whether a place on a piece is its beginning, and the state there the first one, as far as rounding can tell.
    static bool has_not_moved(const Record& record, const Piece& piece, double place, std::span<const double> x);
    /// Whether a guard is the gap of a contact that was closed in other equations, or whose gap has fired there.
    static bool opens(const Equations& before, const std::vector<int>& fired, const Guard& guard);

    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // a point that is passed is left behind: a row of them leads nowhere
    static constexpr int most_in_row = 16;
    // events of one instant: more than this and no smooth motion exists
    static constexpr int max_crowded = 100;

    void finish(Record& record, Instant t, Status status);

    /// Hands on, or forgets, those of the events that nothing looks at any more; at the end of a run all.
    void let_go(Record& record, bool is_over);

    /// A guard is not finite any more.
    void break_off(Record& record, Instant t);

    /// Ends the run if its steps, the last one stored up to `length` of its piece, get on no more. Returns whether.
    bool ends_in_small_steps(Record& record, const Piece& piece, double length, double until);

    /// No motion satisfies the laws.
    void give_up(Record& record, const Mode& mode);

    void enter(Record& record, const Mode& mode, Instant t, std::span<const double> x, std::vector<bool> handled,
               bool begins = false);

    void store(Record& record, const Piece& piece, double length, bool fresh) const;

    /// Past a point where derivatives of the equations are not finite but the motion is (a spring through its anchor, a
    /// power 3/2 from its zero): a parabola so short that its error is rounding, a line where no positions are known,
    /// from the model's own slopes at its start and at its middle, which is past the point also where rounding has put
    /// the start a little before it.
    bool pass(Record& record, double until);

    /// Whether one more such point may be passed: there are not too many in a row.
    bool may_pass();

    /// The guards of slips that follow their directions and end within the rounding of the time: u/|u| turns ever
    /// faster there, and steps are no longer than that.
    std::vector<int> slips_that_end() const;

    /// Nothing moves any more: one piece to the end.
    void rest(Record& record, Instant t, std::span<const double> x, double until) const;

    static void note(Record& record, const Happening& h, Instant t);

    const HybridModel& model_;
    Engine& engine_;
    std::int64_t max_steps_;
    Keep keep_;
    KeepEvents keep_events_;
    Instant looked_;        // where it was when events were let go last
    std::size_t few_ = 64;  // events that are not worth looking through
    Monitor monitor_;
    EventSearch search_;
    Progress progress_;
    MemoryWatch memory_{{}, 1.0};
    double began_ = 0.0;        // s: the run
    bool is_form_ = false;      // what changed last is no more than the form of the motion
    std::int64_t changes_ = 0;  // of modes, so far
    std::int64_t passed_ = 0;   // points where no step gets on, so far: they count as steps
    int in_row_ = 0;            // of these since the last step
    Instant chattered_;         // when there had been the last thousand
    Halt now_;  // where it has come to; the state where the mode began, as long as no step was made in it
    bool is_in_step_ = false, rounds_otherwise_ = false;
    std::int64_t roundings_ = 0;  // otherwise, so far
    double stops_from_;
    mutable std::size_t kept_ = 0;
    mutable std::vector<double> winding_;
};

}  // namespace rbdyn::inline RBDYN_FORM
