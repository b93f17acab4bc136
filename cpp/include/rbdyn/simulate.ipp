// Definitions of rbdyn/simulate.hpp.
#pragma once

#include "rbdyn/simulate.hpp"

#include <chrono>
#include <cstdint>
#include <exception>
#include <iomanip>
#include <memory>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/solve.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE AccuracyError::AccuracyError(const std::string& message, Trajectory partial)
    : Error(message), run(std::move(partial)) {}

RBDYN_INLINE IntegrationError::IntegrationError(const std::string& message, Trajectory partial)
    : Error(message), run(std::move(partial)) {}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::simulating {

RBDYN_INLINE Attempt attempted(const Scene& scene, const SimulateOptions& options) {
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

}  // namespace rbdyn::inline RBDYN_FORM::simulating

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Attempt attempt(const Scene& scene, const SimulateOptions& options) {
    return simulating::attempted(scene, options);
}

RBDYN_INLINE Trajectory simulate(const Scene& scene, const SimulateOptions& options) {
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

RBDYN_INLINE StateRun::StateRun(simulating::Solution solution, std::string engine)
    : solution_(std::make_shared<const simulating::Solution>(std::move(solution))), engine_(std::move(engine)) {}

RBDYN_INLINE Status StateRun::status() const { return solution_->record.status; }

RBDYN_INLINE double StateRun::start() const { return solution_->record.start; }

RBDYN_INLINE double StateRun::end() const { return solution_->record.end.hi; }

RBDYN_INLINE double StateRun::certain_until() const { return solution_->certain_until; }

RBDYN_INLINE const std::string& StateRun::engine() const { return engine_; }

RBDYN_INLINE std::optional<double> StateRun::error() const { return solution_->error; }

RBDYN_INLINE const std::vector<Event>& StateRun::events() const { return solution_->record.events; }

RBDYN_INLINE const Work& StateRun::work() const { return solution_->record.work; }

RBDYN_INLINE int StateRun::variables() const { return static_cast<int>(solution_->record.first_state.size()); }

RBDYN_INLINE const simulating::Solution& StateRun::solution() const { return *solution_; }

RBDYN_INLINE std::vector<double> StateRun::state(double t, Side side) const {
    return state_at(solution_->record, t, side);
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const StateRun& run) {
    out << "Run: " << name_of(run.status()) << " at t = " << text(run.end()) << " s";
    if (run.status() == Status::stopped_by_event) out << ", " << run.events().back().name;
    out << ". " << advice(run.status()) << "\n  engine " << run.engine() << ", " << run.work().steps << " steps, "
        << run.events().size() << " events, ";
    if (!run.error()) return out << "no estimate of the global error (rtol)\n";
    std::ostringstream error;
    error << std::setprecision(2) << *run.error();
    return out << "estimated global error " << error.str() << '\n';
}

RBDYN_INLINE ModelError::ModelError(const std::string& message, StateRun partial)
    : Error(message), run(std::move(partial)) {}

}  // namespace rbdyn::inline RBDYN_FORM
