// From a hybrid model to its motion, as accurate as asked for.
//
// Accuracy: the model is run, run again more accurately, and the two are compared (trajectory/accuracy.hpp). If the
// difference is more than asked for, the better run takes the place of the first and an even better one is made.
#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/course.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/passes.hpp"
#include "rbdyn/trajectory/error_scales.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Driver;

namespace simulating {

/// Where a run that is not kept whole is compared with its better: enough to meet every phase of its motion.
inline constexpr int compared_times = 256;

/// The names of the engines of this build that integrate.
std::vector<std::string> engines();

/// Throws InvalidInput for a name that is none of them.
std::unique_ptr<Engine> make_engine(const std::string& name, double tolerance, const Manner& manner = {});

/// The smallest tolerance that still makes an engine more accurate: below it, more steps mean more rounding.
inline double least_tolerance(const std::string& engine) { return engine == "taylor" ? 1e-17 : 2e-15; }

/// The tolerance of a first run, and of one that is held against one of a tolerance. What is lost on the way is a
/// factor of 10 to 1000 in most motions; of a Taylor series the thousandth part costs a fifth more, and a second run
/// costs more than that.
double first_tolerance(const std::string& engine, double error);
double judging_tolerance(const std::string& engine, double tolerance);

/// Whether Taylor series leave to BDF what is stiff: where the choice is the library's, and BDF reaches the tolerance.
bool gives_way(const HybridModel& model, const SimulateOptions& options, const std::string& engine, double tolerance);

/// The order of a run that is held against one at the least tolerance: other steps, so other rounding.
inline constexpr int other_order = 19;

/// The stride of a run of dop853 against the one it is held against: a motion that is a polynomial would else be one
/// step of both. No power of two, whose steps round alike.
inline constexpr double other_stride = 0.7;

/// Whether events are handed on while a run goes on: nothing is held against it.
inline bool streams_events(const SimulateOptions& options) { return options.rtol.has_value(); }

/// What drives an engine of a tolerance through it.
std::unique_ptr<Driver> make_driver(const HybridModel& model, Engine& engine, const SimulateOptions& options,
                                    const Beginning& beginning, double tolerance, const Keep& keep,
                                    const Manner& manner);

/// One integration, from the state x where the motion begins.
Timed integrate(const HybridModel& model, const std::vector<double>& x, const SimulateOptions& o,
                const Beginning& beginning, const std::string& name, double tolerance, const Keep& keep,
                const Manner& manner = {}, const std::shared_ptr<const ClosedForm>& form = nullptr);

inline Timed integrate(const HybridModel& model, const std::vector<double>& x, const SimulateOptions& o,
                       const std::string& name, double tolerance, const Keep& keep, const Manner& manner = {},
                       const std::shared_ptr<const ClosedForm>& form = nullptr) {
    return integrate(model, x, o, {.origin = o.start}, name, tolerance, keep, manner, form);
}

/// A motion as accurate as asked for, or what there is of it and why there is no more.
struct Solution {
    using Outcome = simulating::Outcome;
    Outcome outcome = Outcome::good;
    std::string message;        // of a failure
    std::exception_ptr thrown;  // what a function of the user's threw
    Record record;
    std::optional<double> error;
    double certain_until = 0.0;
    double integration_seconds = 0.0;
    int runs = 0;
    // what goes on from its end: it, and the better run it was held against; and the scales of the motion so far
    std::optional<Course> course, judge;
    ErrorScales scales;
};

/// Throws InvalidInput if all a motion goes through is smaller than that, but no zeros.
void require_size(const Record& record, const std::string& object, double least);

/// What is not finite where a run broke off, or just after.
std::string culprit(const HybridModel& model, const Record& record);

/// How a run broke off, in a sentence.
std::string broken_off(const HybridModel& model, const Record& record);

/// How a run broke off that another one is held against, as the end of a sentence; nothing if it did not.
std::string broken_off_beside(const Record& judge);

/// The record of a closed form that grows beyond the largest number of the machine ends before that, by name.
void end_where_finite(Record& record);

/// What of two runs that are compared is kept: all, or without all the times wanted and many in between, the same of
/// both.
Keep compared_pieces(const SimulateOptions& options);
/// What is kept of one that a run is held against: where it is compared.
Keep held_against(const Record& run);

/// A motion in closed form that nothing is watched for: no pieces, from the state `first`; `origin`: where it began.
Record formula_record(const Mode& mode, std::vector<double> first, double start, Instant end,
                      const std::shared_ptr<const ClosedForm>& form, double origin);
/// Whether no guard of a motion that has one closed form ever fires: those of modes do not.
bool never_fires(const Equations& equations);
/// The same beside a run of one mode; none if it has others, or more forms: series have to find what they do then.
std::optional<Record> formula_beside(const Record& run, const std::shared_ptr<const ClosedForm>& form, double origin);

/// Hands on the events of a motion of one part that is judged, or leaves the last of each; what a function of the
/// user's throws there is the outcome.
void settle_events(Solution& solution, const SimulateOptions& options);

/// What a run left behind is the result's.
void take(Solution& result, Timed&& timed);
/// Whether a run ended otherwise than by its end or an event; then the result is complete.
bool is_cut_short(const HybridModel& model, Solution& result, Timed& timed);
/// What goes on from the end of a record; none if nothing can.
std::optional<Course> course_of(const Record& record, const std::string& engine, double tolerance,
                                const Manner& manner);
/// Takes away events that are none: holds of no length.
void drop_grazes(Record& record, const std::vector<Event>& grazes);

/// Runs a model from the state x with an engine: once if only a local tolerance is asked for, else until it agrees with
/// the closed form, if there is one, or with a better run of the engine `judge`. `ahead`: what is made already of it.
Solution solve(const HybridModel& model, const std::vector<double>& x, const SimulateOptions& options,
               const Beginning& beginning, const std::string& engine, const std::string& judge,
               const std::shared_ptr<const ClosedForm>& form = nullptr, Ahead* ahead = nullptr);

/// A motion and its estimate, where they have come to.
struct Standing {
    double origin;  // s: where the motion began
    const Course& course;
    const Course* judge;  // none: no estimate is asked for
    const ErrorScales& scales;
    double error;  // so far
};

/// Goes on from there, the run and the better one it is held against each from its own end, so that the estimate is
/// that of the whole motion. None if the error asked for is not reached so.
std::optional<Solution> carry_on(const HybridModel& model, const Standing& standing, const SimulateOptions& options,
                                 const std::shared_ptr<const ClosedForm>& form);

}  // namespace simulating

}  // namespace rbdyn::inline RBDYN_FORM
