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

#include "rbdyn/model/own_model.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/solve.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn {

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
inline Attempt attempted(const Scene& scene, const SimulateOptions& options) {
    const auto began = std::chrono::steady_clock::now();
    validate(options);
    auto [frozen, plan, is_new] = planned(scene);
    const std::int64_t calls = plan.python_calls();
    Solved result = plan.parts.empty() ? solve_together(std::move(frozen), std::move(plan), options)
                                       : solve_apart(std::move(frozen), std::move(plan), options);
    Statistics& s = result.data.statistics;
    s.planned = is_new;
    s.python_calls = result.data.plan.python_calls() - calls;
    s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
#ifdef RBDYN_CHECK_SIZES
    check_size(result, options.start);
#endif
    return {result.outcome, std::move(result.message), result.thrown, Trajectory(std::move(result.data))};
}

}  // namespace simulating

/// Runs a scene and returns what there is, failures with it. Throws InvalidInput for options that break a rule.
#ifdef RBDYN_COMPILED
Attempt attempt(const Scene& scene, const SimulateOptions& options);
#else
inline Attempt attempt(const Scene& scene, const SimulateOptions& options) {
    return simulating::attempted(scene, options);
}
#endif

/// Runs a scene. Throws InvalidInput for options that break a rule, AccuracyError if the error asked for is out of
/// reach, IntegrationError if the motion cannot be continued; both carry the partial run. What a function of the user's
/// throws passes unchanged.
inline Trajectory simulate(const Scene& scene, const SimulateOptions& options) {
    using Outcome = simulating::Solution::Outcome;
    Attempt result = attempt(scene, options);
    switch (result.outcome) {
        case Outcome::inaccurate: throw AccuracyError(result.message, std::move(result.run));
        case Outcome::broken: throw IntegrationError(result.message, std::move(result.run));
        case Outcome::thrown: std::rethrow_exception(result.thrown);
        case Outcome::good: break;
    }
    return std::move(result.run);
}

/// The motion of a model of the user's own.
class StateRun {
public:
    explicit StateRun(simulating::Solution solution, std::string engine)
        : solution_(std::make_shared<const simulating::Solution>(std::move(solution))), engine_(std::move(engine)) {}

    Status status() const { return solution_->record.status; }
    double start() const { return solution_->record.start; }
    double end() const { return solution_->record.end.hi; }
    double certain_until() const { return solution_->certain_until; }
    const std::string& engine() const { return engine_; }
    /// Estimated global error, each variable relative to its own scale in this motion; none with rtol.
    std::optional<double> error() const { return solution_->error; }
    const std::vector<Event>& events() const { return solution_->record.events; }
    const Work& work() const { return solution_->record.work; }

    int variables() const { return static_cast<int>(solution_->record.first_state.size()); }
    /// All that was computed.
    const simulating::Solution& solution() const { return *solution_; }
    /// The state at a time. Throws InvalidInput for a time the run does not hold.
    std::vector<double> state(double t, Side side = Side::after) const { return state_at(solution_->record, t, side); }

private:
    std::shared_ptr<const simulating::Solution> solution_;
    std::string engine_;
};

inline std::ostream& operator<<(std::ostream& out, const StateRun& run) {
    out << "Run: " << name_of(run.status()) << " at t = " << text(run.end()) << " s";
    if (run.status() == Status::stopped_by_event) out << ", " << run.events().back().name;
    out << ". " << advice(run.status()) << "\n  engine " << run.engine() << ", " << run.work().steps << " steps, "
        << run.events().size() << " events, ";
    if (!run.error()) return out << "no estimate of the global error (rtol)\n";
    std::ostringstream error;
    error << std::setprecision(2) << *run.error();
    return out << "estimated global error " << error.str() << '\n';
}

/// A run of a model of the user's own came to less than was asked for; `run` is what is there.
struct ModelError : Error {
    ModelError(const std::string& message, StateRun partial) : Error(message), run(std::move(partial)) {}
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

}  // namespace rbdyn
