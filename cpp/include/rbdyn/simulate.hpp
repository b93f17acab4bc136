// simulate(): from a scene to its motion, as accurate as asked for.
#pragma once

#include <chrono>
#include <exception>
#include <iomanip>
#include <memory>
#include <optional>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/own_model.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/solve.hpp"
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
    simulating::Solution::Outcome outcome;
    std::string message;
    std::exception_ptr thrown;  // by a function of the user's
    Trajectory run;
};

namespace simulating {

#ifdef RBDYN_CHECK_SIZES
/// Of our own tests: what a plan made anew says of the size of a motion is what its statistics count. What begins later
/// than the plan speaks of, what broke off and what calls back, which tests count, is left alone.
inline void check_size(const Solved& solved, double start) {
    const RunData& run = solved.data;
    if (start != 0.0 || solved.outcome != Solution::Outcome::good || run.record.status == Status::stopped_by_user ||
        !run.plan.callbacks.empty())
        return;
    std::ostringstream sizes;
    const Size planned = make_plan(run.scene).size();
    sizes << "simulate: " << run.statistics.size << "; the plan says " << planned;
    if (run.statistics.size != planned) throw std::logic_error(sizes.str());
}
#endif

/// What attempt() does.
Attempt attempted(const Scene& scene, const SimulateOptions& options);

}  // namespace simulating

/// Runs a scene and returns what there is, failures with it. Throws InvalidInput for options that break a rule.
#ifdef RBDYN_COMPILED
Attempt attempt(const Scene& scene, const SimulateOptions& options);
#else
Attempt attempt(const Scene& scene, const SimulateOptions& options);
#endif

/// Runs a scene. Throws InvalidInput for options that break a rule, AccuracyError if the error asked for is out of
/// reach, IntegrationError if the motion cannot be continued; both carry the partial run. What a function of the user's
/// throws passes unchanged.
Trajectory simulate(const Scene& scene, const SimulateOptions& options);

/// The motion of a model of the user's own.
class StateRun {
public:
    explicit StateRun(simulating::Solution solution, std::string engine);

    Status status() const;
    double start() const;
    double end() const;
    double certain_until() const;
    const std::string& engine() const;
    /// Estimated global error, each variable relative to its own scale in this motion; none with rtol.
    std::optional<double> error() const;
    const std::vector<Event>& events() const;
    const Work& work() const;

    int variables() const;
    /// All that was computed.
    const simulating::Solution& solution() const;
    /// The state at a time. Throws InvalidInput for a time the run does not hold.
    std::vector<double> state(double t, Side side = Side::after) const;

private:
    std::shared_ptr<const simulating::Solution> solution_;
    std::string engine_;
};

std::ostream& operator<<(std::ostream& out, const StateRun& run);

/// A run of a model of the user's own came to less than was asked for; `run` is what is there.
struct ModelError : Error {
    ModelError(const std::string& message, StateRun partial);
    StateRun run;
};

/// Runs a model of the user's own from a state. Throws as simulate(scene) does; what a failed run had is in the error.
template <OwnModel M>
StateRun simulate(const M& model, const std::vector<double>& state, const SimulateOptions& options) {
    using Outcome = simulating::Solution::Outcome;
    simulating::validate(options);
    const FunctorModel<M> hybrid(model);
    require(static_cast<int>(state.size()) == hybrid.variables(), "simulate", "number of variables of the state",
            static_cast<double>(state.size()), "the model has " + std::to_string(hybrid.variables()));
    const std::string engine = options.engine == "auto" ? "taylor" : options.engine;
    (void)simulating::make_engine(engine, 1e-6);
    simulating::Solution solution = simulating::solve(hybrid, state, options, engine, "taylor");
    if (solution.outcome == Outcome::thrown) std::rethrow_exception(solution.thrown);
    const bool good = solution.outcome == Outcome::good;
    const std::string message = solution.message;
    StateRun run(std::move(solution), engine);
    if (!good) throw ModelError(message, std::move(run));
    return run;
}

}  // namespace rbdyn::inline RBDYN_FORM
