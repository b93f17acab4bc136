// Definitions of rbdyn/simulate.hpp.
#pragma once

#include "rbdyn/simulate.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"
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

/// See check_sizes().
RBDYN_INLINE void check_size(const Solved& solved, double start) {
    const RunData& run = solved.data;
    if (start != 0.0 || solved.outcome != Outcome::good || run.record.status == Status::stopped_by_user ||
        !run.plan.callbacks.empty())
        return;
    std::ostringstream sizes;
    const Size planned = make_plan(run.scene).size();
    sizes << "simulate: " << run.statistics.size << "; the plan says " << planned;
    if (run.statistics.size != planned) throw std::logic_error(sizes.str());
}

inline std::atomic<bool> sizes_are_checked = false;

RBDYN_INLINE void check_sizes(bool wanted) { sizes_are_checked = wanted; }

/// What attempt() does.
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
    if (sizes_are_checked) check_size(result, options.start);
    return {result.outcome, std::move(result.message), result.thrown, Trajectory(std::move(result.data))};
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Attempt attempt(const Scene& scene, const SimulateOptions& options) {
    return simulating::attempted(scene, options);
}

RBDYN_INLINE void require_good(const Attempt& attempt) {
    using simulating::Outcome;
    switch (attempt.outcome) {
        case Outcome::inaccurate: throw AccuracyError(attempt.message, attempt.run);
        case Outcome::broken: throw IntegrationError(attempt.message, attempt.run);
        case Outcome::thrown: std::rethrow_exception(attempt.thrown);
        case Outcome::good: break;
    }
}

RBDYN_INLINE Trajectory simulate(const Scene& scene, const SimulateOptions& options) {
    Attempt result = attempt(scene, options);
    require_good(result);
    return std::move(result.run);
}

}  // namespace rbdyn::inline RBDYN_FORM
