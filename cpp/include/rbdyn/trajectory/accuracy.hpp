// The estimate of the global error: a run held against a more accurate one, event by event.
//
// Measured against the motion's own scales (error_scales.hpp), times of events to the time since the start. What is
// told is twice the largest difference found and twice the rounding that no difference shows: the more accurate run is
// wrong too, and between the places compared a difference may be more. Between events both runs are compared at the
// same times, where both are in the same mode; at events their times are. Where the sequences of events differ, the
// result is certain up to the first difference.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/observed.hpp"
#include "rbdyn/trajectory/error_scales.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// How far a run is from a more accurate one.
struct Comparison {
    double error = 0.0;        // twice the largest relative difference
    double certain_until = 0;  // s, up to where it is at most what was asked
    bool same_events = true;
    bool by_rounding = false;        // nothing but rounding decides which events there are
    bool amplifies = false;          // differences grow from rounding to many times that: both runs may be as wrong
    double quickens = 1.0;           // how much more quickly variables change, beside their sizes, than early on
    std::vector<Event> grazes = {};  // of the run alone: holds of no length, which are none
    bool stopped = false;            // by whoever was asked whether to proceed
    ErrorScales scales = {};         // of the motion
    std::string worst = {};          // what is farthest off, in words; empty if nothing has a name
    // what was found, and nothing added to it: of the motion up to the first event that differs, and of the times of
    // events up to there; and how many events each of the two has
    double motion_difference = 0.0, event_difference = 0.0;
    int events = 0, better_events = 0;
};

/// What there was of a motion before what is compared.
struct MotionBefore {
    double origin = 0.0;  // s: where it began
    ErrorScales scales;
};

class AccuracyCheck {
public:
    /// `proceed`: asked now and then whether to go on; if not, the result says that nothing is certain.
    /// `widening`: how much more than what is found is told. `before`: of the motion, if what is compared is not all
    /// of it; it outlives this.
    AccuracyCheck(const HybridModel& model, double wanted, std::function<bool(double)> proceed = {},
                  double widening = 2.0, const MotionBefore* before = nullptr);

    /// `times`: where both runs have what they have kept, in ascending order; empty: the places of the first.
    Comparison operator()(const Record& run, const Record& better, std::span<const double> times = {});

    /// Where a run of which all is kept is compared with another: at the end of every piece, of long motions of some
    /// spread over them, of the quickest and of the last in each mode, and at more places of few.
    static std::vector<double> places(const Record& run);

    /// Of a motion, after which Comparison::quickens tells how it goes on.
    static constexpr double first_part = 0.25;

private:
    struct Difference {
        double since, value;     // since: the time up to which it was less [s]
        int what;                // index of what is observed; -1: the time of an event, relative already
        bool is_shared = false;  // no difference of the two, but what rounding of their states does
    };
    /// The pieces in which variables change most quickly.
    static std::vector<std::size_t> quickest(const Record& run);

    /// Comparison::quickens: what delays a motion early on, if only by rounding, is so much more of it later.
    static double quickens(const Record& run);

    void compare_motion(const Record& run, const Record& better, std::span<const double> times, double until);

    /// Where both runs are compared.
    struct Place {
        Instant at;
        std::size_t piece = 0, fine_piece = 0;
        double here = 0.0, there = 0.0;  // on the pieces, in their units
        bool is_chosen = true;
    };
    /// None where the two are in different modes, or before and after an impact: just before an event one of them may
    /// be past it already, and then its time tells. `j`: the piece of the better run, or one before it.
    static std::optional<Place> place_of(Instant at, const Record& run, std::size_t i, const Record& better,
                                         std::size_t& j);

    /// Of many places some spread over the motion, the last in each mode and those where states are farthest apart:
    /// what is seen of a state costs far more than the state.
    void choose(std::span<Place> places, const Record& run, const Record& better);

    /// Those of both runs, into x_ and y_.
    void states(const Place& place, const Record& run, const Record& better);

    /// What is seen of both.
    void compare_at(const Place& place, const Record& run, const Record& better);

    /// x_ by a time [s] along the motion of a piece, at a place where it is y_.
    void move_on(const Piece& piece, double place, double time);

    /// A closed form that has no pieces.
    static bool is_formula(const Record& r) { return r.empty() && r.closed != nullptr; }

    /// The differences of what is seen from the better; of motion alone, or of forces, too.
    void note(double weight, bool is_shared, bool has_forces);
    static bool is_of_time(const Mode& mode);
    /// What rounding of the time does to what is seen, where it follows functions of time.
    void note_late(const Mode& mode, double t, std::span<const double> x);
    /// Of what has no variables, all of which are functions of time.
    void see_given(const Record& run, double until);

    /// Whether a mode of a run ends within the error wanted of a time: forces that turn with a slip that comes to rest
    /// there do so ever faster, and are known as well as the time of that is.
    bool ends_at_once(const Record& run, std::size_t piece, Instant at) const;

    /// Where constraints all but lose rank forces, which may be infinite where they do, are known to rounding over the
    /// distance. Whether that is less than is wanted from any state in doubles. `nearer`: how much nearer it is than
    /// where that is noticed, at least 1.
    bool weigh_forces(const Mode& mode, double t, std::span<const double> x, double& nearer);
    /// Forces that are none but for what rounding has become so much nearer to there are zero, in both motions.
    void leave_out_rounding(double nearer);
    /// Whether that is to be asked: one of the motions passes such a place, or forces of the two differ.
    bool is_doubtful() const;
    static bool is_force(const Observed& o) { return o.alike == Alike::force || o.alike == Alike::torque; }

    /// The events of a run but for its last bounces; which of several comes first that the accuracy cannot tell apart
    /// is settled by what they are. `limits`: of its bounces; `start`: of the motion.
    std::vector<Event> in_order(const Record& r, const std::vector<double>& limits, double start) const;

    static bool differ(const std::vector<Event>& a, std::size_t i, const std::vector<Event>& b, std::size_t j);

    /// A hold, from stick to slip, that lasts less than the accuracy can tell from none, with equal coefficients: slip
    /// touches zero with its rate, and a depth of the error is a time of its square root.
    bool is_graze(const std::vector<Event>& events, std::size_t i, double start) const;

    static void skip_graze(const std::vector<Event>& ours, std::size_t& i, Comparison& result);

    /// The times at which bounces of contacts end, in order.
    static std::vector<double> limits_of(const Record& r);
    /// Whether an event belongs to the last bounces, so near to their limit that rounding decides how many there are of
    /// each contact, and in which order: `near` of the time since the start.
    static bool is_last_bounce(const Event& event, const std::vector<double>& limits, double start, double near);
    // of bounces that lose little there are hundreds in a thousand roundings of the time
    static constexpr double last_bounces = 1e-11;

    static bool same_mode(const Mode& a, const Mode& b);

    // a motion of one or two pieces has its extent and its errors within them; errors of many pieces grow from one to
    // the next, so that some of them tell of all
    static constexpr std::size_t least_places = 16, most_places = 64, quick_parts = 16;
    // of those at which states are compared as many show what is seen of them
    static constexpr std::size_t enough_places = 32;
    // up to this order pieces are interpolations between steps, not series
    static constexpr int interpolated = 7;
    // an interpolation is known less well between steps, and its error changes sign there, that of the method of order
    // 8 near thirds of a step: few steps are looked at in so many places in all, and in so many parts of each at most
    static constexpr std::size_t least_interpolated = 64, most_parts = 8;

    const HybridModel& model_;
    double wanted_, widening_;
    const MotionBefore* before_;
    std::vector<double> x_, y_;
    std::function<bool(double)> proceed_;
    bool stopped_ = false;
    bool loses_rank_ = false;  // one of the two motions passes where constraints do
    int samples_ = 0;
    double start_ = 0.0;                   // of the motion
    double last_ = 0.0;                    // time compared
    std::vector<Difference> differences_;  // of events, and of what is observed each that is larger than all before
    std::vector<double> largest_[2];       // of either kind
    ErrorScales scales_;
    std::vector<Observed> seen_, fine_, named_;  // the last: of each as it was when it was farthest off
};

}  // namespace rbdyn::inline RBDYN_FORM
