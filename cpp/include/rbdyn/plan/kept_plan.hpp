// Plans that are kept with their scenes: what was decided once holds for the runs to come.
//
// A plan holds as long as its scene stays what it is and, of the numbers of the user's (Parameter), the same vanish
// (expression/numbers.hpp). Then a run takes its decisions and the equations that are recorded; what depends on the
// numbers is its own.
//
// It holds for another start, too, if the same variables stay as they start, those with the same values: the equations
// are the same then. What stays is looked for anew, which is a small part of planning.
#pragma once

#include <memory>
#include <optional>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A plan, and what was decided by numbers of the user's; no numbers if there are none.
struct KeptPlan {
    Plan plan;
    double origin = 0.0;  // when the scene starts, if that matters to it
    std::unique_ptr<Numbers> decided;
};

/// A scene as a run takes it, and its plan.
struct PlannedScene {
    Scene scene;
    Plan plan;
    bool is_new = true;  // the plan was made for it
};

namespace planning {

/// The numbers of the user's in a scene, as they are now.
GivenNumbers numbers_of(const Scene& scene);

/// Throws InvalidInput if a first integral of the user's has the name of one that the scene has by itself.
void require_own_names(const Scene& scene, const Plan& plan);

/// A plan for the same scene with other numbers, and `elsewhere`: with another start; none if a new one may differ.
[[gnu::cold]] std::optional<Plan> renewed(const Plan& kept, const Scene& scene, const GivenNumbers& numbers,
                                          bool elsewhere);

}  // namespace planning

/// A scene with the numbers of the user's as they are now, and its plan: one that it keeps and that holds, else a
/// new one, which it keeps from now on. `start`: when it starts. Throws InvalidInput on a scene without bodies.
PlannedScene planned(const Scene& scene, double start);

}  // namespace rbdyn::inline RBDYN_FORM
