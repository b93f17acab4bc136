// simulate(): from a scene to its motion, as accurate as asked for.
//
// Accuracy: the scene is run, run again more accurately, and the two are compared (trajectory/accuracy.hpp). If the
// difference is more than asked for, the better run takes the place of the first and an even better one is made.
#pragma once

#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/trajectory/accuracy.hpp"
#include "rbdyn/trajectory/trajectory.hpp"
#ifdef RBDYN_WITH_SUNDIALS
#include "rbdyn/engine/cvode.hpp"
#endif

namespace rbdyn {

/// What a run is asked to be.
struct SimulateOptions {
    double until = 0.0;                         // s
    double start = 0.0;                         // s
    double error = 1e-9;                        // global, relative to the motion's own scales
    std::optional<double> rtol = std::nullopt;  // local tolerance only, no estimate: the cheap way
    std::string engine = "auto";                // "taylor", "cvode-adams", "cvode-bdf"
    Keep keep = {};
    std::int64_t max_steps = 100'000'000;
    Driver::Monitor monitor = {};  // called now and then with the time reached; false stops the run
};

/// The error asked for was not reached; `run` is what is there, certain up to run.certain_until().
struct AccuracyError : Error {
    AccuracyError(const std::string& message, Trajectory partial) : Error(message), run(std::move(partial)) {}
    Trajectory run;
};

/// The motion could not be continued; `run` is what is there.
struct IntegrationError : Error {
    IntegrationError(const std::string& message, Trajectory partial) : Error(message), run(std::move(partial)) {}
    Trajectory run;
};

namespace simulating {

/// Below this double precision cannot promise anything (about 20 units in the last place).
inline constexpr double least_error = 4e-15;

/// Where a run that is not kept whole is compared with its better: enough to meet every phase of its motion.
inline constexpr int compared_times = 2000;

/// The names of the engines of this build.
inline std::vector<std::string> engines() {
#ifdef RBDYN_WITH_SUNDIALS
    return {"taylor", "cvode-adams", "cvode-bdf"};
#else
    return {"taylor"};
#endif
}

inline std::unique_ptr<Engine> make_engine(const std::string& name, double tolerance, int order = 0) {
    if (name == "taylor") return std::make_unique<TaylorEngine>(tolerance, order);
#ifdef RBDYN_WITH_SUNDIALS
    if (name == "cvode-adams") return std::make_unique<CvodeEngine>(CvodeEngine::Method::adams, tolerance);
    if (name == "cvode-bdf") return std::make_unique<CvodeEngine>(CvodeEngine::Method::bdf, tolerance);
#endif
    std::string known;
    for (const std::string& e : engines()) known += (known.empty() ? "" : ", ") + e;
    throw InvalidInput("simulate: engine is \"" + name + "\"; this build has auto, " + known);
}

/// The smallest tolerance that still makes an engine more accurate: below it, more steps mean more rounding.
inline double least_tolerance(const std::string& engine) { return engine == "taylor" ? 1e-17 : 2e-15; }

/// The order of a run that is held against one at the least tolerance: other steps, so other rounding.
inline constexpr int other_order = 19;

inline void validate(const SimulateOptions& o) {
    require(std::isfinite(o.start), "simulate", "start", o.start, "a time is finite, in s");
    require(std::isfinite(o.until), "simulate", "until", o.until, "a time is finite, in s");
    require(o.until > o.start, "simulate", "until", o.until,
            "a run ends after its start, which is " + text(o.start) +
                " s; motion backwards is motion with reversed velocities");
    if (o.rtol) {
        require(*o.rtol >= 1e-16 && *o.rtol <= 0.1, "simulate", "rtol", *o.rtol,
                "a local tolerance lies between 1e-16 and 0.1");
    } else {
        require(o.error >= least_error && o.error <= 0.1, "simulate", "error", o.error,
                "it lies between " + text(least_error) + ", the least that double precision can give, and 0.1");
    }
    require(o.max_steps > 0, "simulate", "max_steps", static_cast<double>(o.max_steps), "it is positive");
    for (double t : o.keep.times)
        require(t >= o.start && t <= o.until, "simulate", "a time of keep", t, "it lies between start and until");
}

struct Timed {
    Record record;
    double seconds = 0.0;
};

inline Timed integrate(const PointsModel& model, const SimulateOptions& o, const std::string& name, double tolerance,
                       const Keep& keep, int order = 0) {
    const auto before = std::chrono::steady_clock::now();
    const std::unique_ptr<Engine> engine = make_engine(name, tolerance, order);
    Driver driver(model, *engine, o.max_steps, keep, o.monitor, tolerance * (o.until - o.start));
    Timed result{driver.run(o.start, model.start(), o.until)};
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    return result;
}

}  // namespace simulating

/// Runs a scene. Throws InvalidInput for options that break a rule, AccuracyError if the error asked for is out of
/// reach, IntegrationError if the motion cannot be continued; both carry the partial run.
inline Trajectory simulate(const Scene& scene, const SimulateOptions& options) {
    using namespace simulating;
    const auto began = std::chrono::steady_clock::now();
    validate(options);
    RunData data;
    data.scene = scene;
    data.plan = make_plan(scene);
    const std::string engine = options.engine == "auto" ? data.plan.engine : options.engine;
    (void)make_engine(engine, 1e-6);
    data.engine = engine;
    const std::shared_ptr<const PointsModel> model = data.plan.model;
    data.model = model;

    int runs = 0;
    const auto complete = [&](Timed&& timed) {
        const Work& w = timed.record.work;
        Statistics& s = data.statistics;
        s.integration_seconds = timed.seconds;
        s.steps = w.steps;
        s.rejected = w.rejected;
        s.right_hand_sides = w.right_hand_sides;
        s.jacobians = w.jacobians;
        s.guard_evaluations = w.guard_evaluations;
        s.events = static_cast<std::int64_t>(timed.record.events.size());
        s.runs = runs;
        data.record = std::move(timed.record);
        for (Event& e : data.record.events)
            if (e.name.empty() && e.subject >= 0) e.name = scene.bodies()[static_cast<std::size_t>(e.subject)].name;
        data.events = Events(data.record.events);
        s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
        return Trajectory(std::move(data));
    };
    const auto failed = [](const Record& r) {
        return r.status == Status::not_finite || r.status == Status::inconsistent;
    };
    const auto raise = [&](Timed&& timed) {
        const Status status = timed.record.status;
        const std::string where = text(timed.record.end.hi);
        data.certain_until = timed.record.end.hi;
        throw IntegrationError(
            "simulate: " + std::string(name_of(status)) + " at t = " + where + " s. " + std::string(advice(status)),
            complete(std::move(timed)));
    };

    if (options.rtol) {
        Timed only = integrate(*model, options, engine, *options.rtol, options.keep);
        runs = 1;
        if (failed(only.record)) raise(std::move(only));
        data.certain_until = only.record.end.hi;
        return complete(std::move(only));
    }

    // the run at a tolerance a little below the error asked for, held against a better one
    double tolerance = std::max(options.error * 0.02, least_tolerance(engine));
    const bool is_taylor = engine == "taylor";
    // without all pieces kept, the two are compared at the times wanted and at many in between
    const bool keeps_all = options.keep.what == Keep::What::all;
    Keep compared;
    if (!keeps_all) {
        compared.what = Keep::What::times;
        compared.times = options.keep.times;
        // spread by the golden section, so that no period of the motion hides from them
        for (int i = 0; i < compared_times; ++i) {
            const double place = (i + std::fmod(0.6180339887498949 * i, 1.0)) / compared_times;
            compared.times.push_back(options.start + (options.until - options.start) * place);
        }
        compared.times.push_back(options.until);
        std::sort(compared.times.begin(), compared.times.end());
    }
    Timed run = integrate(*model, options, engine, tolerance, compared);
    ++runs;
    AccuracyCheck check(*model, options.error, compared.times, options.monitor);
    for (;;) {
        if (run.record.status == Status::stopped_by_user || run.record.status == Status::step_limit ||
            failed(run.record)) {
            if (failed(run.record)) raise(std::move(run));
            data.certain_until = run.record.start;
            return complete(std::move(run));
        }
        // the better run is made by Taylor series, whatever made the first
        const bool at_floor = tolerance <= least_tolerance(engine);
        const double finer = is_taylor ? std::max(tolerance * 1e-3, 0.1 * least_tolerance(engine))
                                       : std::clamp(options.error * 1e-3, 1e-17, 1e-13);
        Timed better = integrate(*model, options, "taylor", finer, compared, is_taylor && at_floor ? other_order : 0);
        ++runs;
        if (better.record.status == Status::stopped_by_user || better.record.status == Status::step_limit) {
            run.record.status = better.record.status;
            data.certain_until = run.record.start;
            return complete(std::move(run));
        }
        const Comparison comparison = check(run.record, better.record);
        if (comparison.stopped) {
            run.record.status = Status::stopped_by_user;
            data.certain_until = run.record.start;
            return complete(std::move(run));
        }
        data.error = comparison.error;
        data.certain_until = comparison.certain_until;
        if (comparison.same_events && comparison.error <= options.error) break;
        if (at_floor) {
            run.record.status = Status::accuracy_not_reached;
            const std::string reached = text(comparison.error), until = text(comparison.certain_until);
            throw AccuracyError("simulate: error " + text(options.error) + " was asked for and engine " + engine +
                                    " reached " + reached + " in this motion; it is certain up to t = " + until +
                                    " s. " + std::string(advice(Status::accuracy_not_reached)),
                                complete(std::move(run)));
        }
        if (is_taylor) {
            run = std::move(better);
            tolerance = finer;
        } else {
            tolerance = std::max(tolerance * std::clamp(0.2 * options.error / comparison.error, 1e-4, 0.1),
                                 least_tolerance(engine));
            run = integrate(*model, options, engine, tolerance, compared);
            ++runs;
        }
    }
    if (!keeps_all) run = integrate(*model, options, engine, tolerance, options.keep);
    return complete(std::move(run));
}

}  // namespace rbdyn
