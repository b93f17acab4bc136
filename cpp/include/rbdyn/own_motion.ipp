// Definitions of rbdyn/own_motion.hpp.
#pragma once

#include "rbdyn/own_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/until_stopped.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE StateRun::StateRun(simulating::Solution solution, std::string engine)
    : AnyRun(solution.record.status, solution.record.start, solution.record.end.hi, solution.certain_until,
             std::move(engine), solution.error),
      solution_(std::make_shared<const simulating::Solution>(std::move(solution))) {}

RBDYN_INLINE const std::vector<Event>& StateRun::events() const { return solution_->record.events; }

RBDYN_INLINE const Work& StateRun::work() const { return solution_->record.work; }

RBDYN_INLINE int StateRun::variables() const { return static_cast<int>(solution_->record.first_state.size()); }

RBDYN_INLINE const simulating::Solution& StateRun::solution() const { return *solution_; }

RBDYN_INLINE std::vector<double> StateRun::state(double t, Side side) const {
    return state_at(solution_->record, t, side);
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const StateRun& run) {
    out << "Run: " << name_of(run.status()) << " at t = " << text(run.end()) << " s";
    if (run.status() == Status::stopped_by_event && !run.events().empty()) out << ", " << run.events().back().name;
    out << ". " << advice(run.status()) << "\n  engine " << run.engine() << ", " << run.work().steps << " steps, "
        << run.events().size() << " events, ";
    return out << error_in_words(run) << '\n';
}

RBDYN_INLINE ModelError::ModelError(const std::string& message, StateRun partial)
    : Error(message), run(std::move(partial)) {}

namespace simulating {

/// A run of a model of the user's own, and what became of it.
struct OwnAttempt {
    Outcome outcome;
    std::string message;
    std::exception_ptr thrown;  // by a function of the user's
    StateRun run;
};

RBDYN_INLINE OwnAttempt attempt_own(const HybridModel& model, const std::vector<double>& state,
                                    const SimulateOptions& options) {
    validate(options);
    const std::string engine = options.engine == "auto" ? "taylor" : options.engine;
    (void)make_engine(engine, 1e-6);
    Solution solution = solve(model, state, options, {.origin = options.start}, engine, "taylor");
    // those of the model, which the run outlives
    for (Mode& mode : solution.record.modes) mode.equations = nullptr;
    settle_events(solution, options);
    solution.record.halt = nullptr;
    solution.course.reset();
    solution.judge.reset();
    const Outcome outcome = solution.outcome;
    const std::exception_ptr thrown = solution.thrown;
    std::string message = solution.message;
    return {outcome, std::move(message), thrown, StateRun(std::move(solution), engine)};
}

RBDYN_INLINE StateRun simulate_own(const HybridModel& model, const std::vector<double>& state,
                                   const SimulateOptions& options) {
    require(static_cast<int>(state.size()) == model.variables(), "simulate", "number of variables of the state",
            static_cast<double>(state.size()), "the model has " + std::to_string(model.variables()));
    for (std::size_t i = 0; i < state.size(); ++i)
        require(std::isfinite(state[i]), "simulate", "x[" + std::to_string(i) + "] of the state", state[i],
                "a state is finite");
    const auto run = [&]() -> OwnAttempt {
        if (options.until != std::numeric_limits<double>::infinity()) return attempt_own(model, state, options);
        std::vector<double> x = state;
        const Mode mode = model.begin(options.start, x);
        const auto& guards = mode.equations->guards;
        require_stop(
            std::any_of(guards.begin(), guards.end(), [](const Guard& g) { return g.role == GuardRole::stop; }));
        return until_stopped(options, [&](const SimulateOptions& o) { return attempt_own(model, state, o); });
    };
    OwnAttempt result = run();
    if (result.outcome == Outcome::thrown) std::rethrow_exception(result.thrown);
    if (result.outcome != Outcome::good) throw ModelError(result.message, std::move(result.run));
    return std::move(result.run);
}

}  // namespace simulating

}  // namespace rbdyn::inline RBDYN_FORM
