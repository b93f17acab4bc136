// How a plan is made.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/plan/linear_motion.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/plan/simulated.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace planning {

/// The axes in which most of a scene vanishes: those of the only curve, turned about a line so that the forces lie in
/// one plane with it; else the world's.
Placement view_of(const Scene& scene);

/// What the recorded equations watch for, with nothing that sticks and with all that can.
[[gnu::cold]] std::vector<std::string> guards_of(const SceneModel& model);

/// The first names of a list, and how many there are beside them.
std::string first_of(const std::vector<std::string>& names, std::size_t most, const std::string& between);

/// The names of the bodies of a part.
std::string names_of(const Scene& part);

/// Plans the parts of a scene, each by itself: guards, engines and the reason for them are theirs together.
[[gnu::cold]] void plan_parts(const Scene& scene, SceneParts&& apart, bool any_rigid, const GivenNumbers& numbers,
                              Plan& plan, Simulated& simulated);

/// The closed form of a scene, or why there is none: that of its bodies one by one, or that of linear equations.
[[gnu::cold]] FoundForm closed_form(const Scene& scene, const SceneModel& model, bool any_rigid);

std::string reason_of(const ClosedForm& form);

/// Plans a scene, or a part of one with rigid bodies, while numbers of the user's are what they are.
[[gnu::cold]] Plan plan_of(const Scene& scene, bool beside_rigid, const GivenNumbers& numbers);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
