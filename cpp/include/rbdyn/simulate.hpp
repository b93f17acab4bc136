// simulate(): from a scene to its motion, as accurate as asked for.
#pragma once

#include <exception>
#include <string>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The error asked for was not reached; `run` is what is there, certain up to run.certain_until().
struct AccuracyError : Error {
    AccuracyError(const std::string& message, Trajectory partial);
    Trajectory run;
};

/// The motion could not be continued; `run` is what is there.
struct IntegrationError : Error {
    IntegrationError(const std::string& message, Trajectory partial);
    Trajectory run;
};

/// What simulate() came to: a run, whole or partial, and what went wrong if anything did.
struct Attempt {
    simulating::Outcome outcome;
    std::string message;
    std::exception_ptr thrown;  // by a function of the user's
    Trajectory run;
};

/// Runs a scene and returns what there is, failures with it. Throws InvalidInput for options that break a rule.
Attempt attempt(const Scene& scene, const SimulateOptions& options);

/// Throws what simulate() throws of an attempt that is not good.
void require_good(const Attempt& attempt);

/// The same for what goes on with a run.
Attempt attempt(const Trajectory& run, const ContinueOptions& options);

/// Runs a scene. Throws InvalidInput for options that break a rule, AccuracyError if the error asked for is out of
/// reach, IntegrationError if the motion cannot be continued; both carry the partial run. What a function of the user's
/// throws passes unchanged.
Trajectory simulate(const Scene& scene, const SimulateOptions& options);

/// Goes on with a run: from its end, or from where it ceased to be certain if the error asked for was not reached. The
/// motion, its modes and the estimate of its error are those of a run that was never interrupted; events at that time
/// are of the run before. Its scene and its numbers are those of the run. Throws as above, and InvalidInput where there
/// is nothing to go on with: at the end of a rail.
Trajectory simulate(const Trajectory& run, const ContinueOptions& options);

struct PlannedScene;
struct RunData;

namespace simulating {

class Ahead;

/// What there is of a scene that is planned. `before`: the run that it goes on with, if any; `ahead`: what is made of
/// it already.
Attempt attempted(PlannedScene planned, const SimulateOptions& options, double planning_seconds, const RunData* before,
                  Ahead* ahead = nullptr);

/// Of our own tests: from now on every run whose plan speaks of it is held against the size that a plan made anew says
/// its motion has, and std::logic_error is thrown where they differ. What begins later than a plan speaks of, what
/// broke off and what calls back is left alone.
void check_sizes(bool wanted);

}  // namespace simulating

}  // namespace rbdyn::inline RBDYN_FORM
