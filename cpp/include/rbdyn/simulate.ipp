// Definitions of rbdyn/simulate.hpp.
#pragma once

#include "rbdyn/simulate.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <limits>
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
#include "rbdyn/until_stopped.hpp"

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

/// Hands on the events of a run that is judged, or leaves the last of each.
RBDYN_INLINE void settle_events(Solved& result, const SimulateOptions& options, bool goes_on) {
    if (options.events.keeps_all()) return;
    RunData& data = result.data;
    const bool is_done = streams_events(options) && data.parts.empty() && !goes_on;
    const bool ends = data.record.status == Status::stopped_by_event;
    try {
        if (!is_done)
            settle(data.record.events, options.events, ends ? std::optional(data.record.end.hi) : std::nullopt);
        for (RunData& part : data.parts) {
            keep_last_of_each(part.record.events);
            part.events = Events(part.record.events);
        }
    } catch (...) {
        result.outcome = Outcome::thrown;
        result.thrown = std::current_exception();
    }
    data.events = Events(data.record.events);
}

RBDYN_INLINE Attempt attempted(PlannedScene planned, const SimulateOptions& options, double planning_seconds,
                               const RunData* before, Ahead* ahead) {
    const auto began = std::chrono::steady_clock::now();
    auto& [frozen, plan, is_new] = planned;
    const std::int64_t calls = plan.python_calls();
    Solved result = plan.parts.empty() ? solve_together(std::move(frozen), std::move(plan), options, before, ahead)
                                       : solve_apart(std::move(frozen), std::move(plan), options, before);
    Statistics& s = result.data.statistics;
    s.planned = is_new;
    s.python_calls = result.data.plan.python_calls() - calls;
    const double here = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(),
                 solving = here + (ahead != nullptr ? ahead->seconds() : 0.0);
    s.seconds = planning_seconds + solving;
    s.planning_seconds = planning_seconds;
    // what is returned is little work beside
    if (!options.rtol) s.judging_seconds = std::max(solving - s.integration_seconds, 0.0);
    if (sizes_are_checked && before == nullptr) check_size(result, options.start);
    settle_events(result, options, before != nullptr);
    return {result.outcome, std::move(result.message), result.thrown, Trajectory(std::move(result.data))};
}

/// Throws InvalidInput where what stopped a run leaves nothing to go on with.
RBDYN_INLINE void require_way_on(const RunData& run, double start) {
    if (run.record.status != Status::stopped_by_event || run.record.end.hi != start) return;
    for (const Event& e : run.record.events)
        if (e.kind == EventKind::rail_end && e.time == start)
            throw InvalidInput(
                "simulate: " + e.name + " is at the end of its rail at t = " + text(start) +
                " s, where the run stopped; there is nothing to go on with: ends = \"release\" lets it go");
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Attempt attempt(const Scene& scene, const SimulateOptions& options) {
    if (options.until == std::numeric_limits<double>::infinity()) {
        simulating::require_stop(simulating::may_stop(scene));
        return simulating::until_stopped(options, [&](const SimulateOptions& o) { return attempt(scene, o); });
    }
    const auto began = std::chrono::steady_clock::now();
    simulating::validate(options);
    PlannedScene now = planned(scene, options.start);
    const double planning = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    SimulateOptions own = options;
    own.warn = simulating::once(options.warn);
    return simulating::attempted(std::move(now), own, planning, nullptr);
}

RBDYN_INLINE Attempt attempt(const Trajectory& run, const ContinueOptions& options) {
    const std::shared_ptr<const RunData> before = run.data();
    const double start = run.status() == Status::accuracy_not_reached ? run.certain_until() : run.end();
    SimulateOptions all = simulating::continued(before->asked, options, start);
    if (all.until == std::numeric_limits<double>::infinity()) {
        simulating::require_stop(simulating::may_stop(before->scene));
        return simulating::until_stopped(all, [&](const SimulateOptions& o) {
            ContinueOptions one = options;
            one.until = o.until;
            one.rtol = o.rtol;
            if (o.rtol) one.error.reset();
            one.keep = o.keep;
            one.events = o.events;
            one.warn = o.warn;
            return attempt(run, one);
        });
    }
    all.warn = simulating::once(options.warn);
    simulating::validate(all);
    simulating::require_way_on(*before, start);
    return simulating::attempted({before->scene, before->plan, false}, all, 0.0, before.get());
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

RBDYN_INLINE Trajectory simulate(const Trajectory& run, const ContinueOptions& options) {
    Attempt result = attempt(run, options);
    require_good(result);
    return std::move(result.run);
}

}  // namespace rbdyn::inline RBDYN_FORM
