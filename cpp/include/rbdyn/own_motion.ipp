// Definitions of rbdyn/own_motion.hpp.
#pragma once

#include "rbdyn/own_motion.hpp"

#include <exception>
#include <iomanip>
#include <memory>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/hybrid.hpp"

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
    if (!run.error()) return out << "no estimate of the global error (rtol)\n";
    std::ostringstream error;
    error << std::setprecision(2) << *run.error();
    return out << "estimated global error " << error.str() << '\n';
}

RBDYN_INLINE ModelError::ModelError(const std::string& message, StateRun partial)
    : Error(message), run(std::move(partial)) {}

namespace simulating {

RBDYN_INLINE StateRun simulate_own(const HybridModel& model, const std::vector<double>& state,
                                   const SimulateOptions& options) {
    validate(options);
    require(static_cast<int>(state.size()) == model.variables(), "simulate", "number of variables of the state",
            static_cast<double>(state.size()), "the model has " + std::to_string(model.variables()));
    const std::string engine = options.engine == "auto" ? "taylor" : options.engine;
    (void)make_engine(engine, 1e-6);
    Solution solution = solve(model, state, options, {.origin = options.start}, engine, "taylor");
    // those of the model, which the run outlives
    for (Mode& mode : solution.record.modes) mode.equations = nullptr;
    settle_events(solution, options);
    solution.record.halt = nullptr;
    solution.course.reset();
    solution.judge.reset();
    if (solution.outcome == Outcome::thrown) std::rethrow_exception(solution.thrown);
    const bool good = solution.outcome == Outcome::good;
    const std::string message = solution.message;
    StateRun run(std::move(solution), engine);
    if (!good) throw ModelError(message, std::move(run));
    return run;
}

}  // namespace simulating

}  // namespace rbdyn::inline RBDYN_FORM
