// From a scene to its motion: as one, or part by part where nothing joins its bodies (scene/parts.hpp).
//
// Each part is solved as if it were a scene of its own. All end together: where an event ends one of them, the others
// are solved up to that time, anew if they had gone further. Where one breaks off, the whole does; the motion that the
// other parts have beyond that stays theirs. Those that an interruption kept from being begun have their start alone.
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "rbdyn/trajectory/statistics.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace simulating {

/// The engine for a scene. Throws InvalidInput if the one asked for cannot do it.
std::string engine_for(const Plan& plan, const std::string& wanted);

/// The engines of a run that began with one, each once.
std::string named(const std::string& engine, const std::vector<EngineChange>& changes);

/// What a motion cost, as far as its solution tells.
Statistics statistics_of(const Solution& solution);

/// What there is of the motion of a scene, and what went wrong if anything did.
struct Solved {
    Solution::Outcome outcome = Solution::Outcome::good;
    std::string message;
    std::exception_ptr thrown;
    RunData data;
};

Solved solved(Scene scene, Plan plan, std::string engine, Solution&& solution);

/// Solves a scene of one part. Throws InvalidInput if the engine asked for cannot do it. `before`: the run that it goes
/// on with at the start that is asked for, if it does with one. `ahead`: what is made already of it.
Solved solve_together(Scene scene, Plan plan, const SimulateOptions& options, const RunData* before = nullptr,
                      Ahead* ahead = nullptr);

/// Throws InvalidInput for a start whose squares are beyond the range of doubles, speeds and energies with them.
void require_squares(const Scene& scene);

/// From where a motion begins, in closed form if that is the engine and it has one all along; else `engine` becomes
/// that which integrates.
Solution solve_from(const SceneModel& model, const Plan& plan, const std::vector<double>& x, const std::string& engine,
                    const SimulateOptions& options, const Beginning& beginning, Ahead* ahead);

/// The motion of a scene of one part from where a run has come to. What a run has for that is taken if it leads to the
/// error asked for; else the motion is computed anew from where it began, and what was before is left out.
[[gnu::cold]] Solution solve_on(const SceneModel& model, const Plan& plan, const std::string& engine,
                                const SimulateOptions& options, const RunData& before);

/// The start alone of a part that was not begun.
[[gnu::cold]] Solved not_begun(const Scene& scene, const Plan& plan, const std::string& engine,
                               const SimulateOptions& options, const RunData* before);

/// Whether an event of its own may end the motion of a scene.
bool may_stop(const Scene& scene);

/// The events of all parts up to a time, in order; of several parts closer together than rounding in the order that
/// those of one part have: watched functions first, then by kind, then by name.
[[gnu::cold]] std::vector<Event> events_of(const std::vector<Solved>& parts, const SceneParts& apart, double end);

/// Solves a scene of several parts. Throws InvalidInput if the engine asked for cannot do one of them.
[[gnu::cold]] Solved solve_apart(Scene scene, Plan plan, const SimulateOptions& options,
                                 const RunData* before = nullptr);

}  // namespace simulating

}  // namespace rbdyn::inline RBDYN_FORM
