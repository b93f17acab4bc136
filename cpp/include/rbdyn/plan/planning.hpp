// How a plan is made.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace planning {

/// What is said of all models of a scene.
struct Simulated {
    std::vector<std::string> coordinates;
    std::vector<Omission> omissions;
    bool any_turns = false;

    void take(const SceneModel& model);
    /// The same of one body.
    void take(const SceneModel& model, int body);
};

/// The first names of a list, and how many there are beside them.
std::string first_of(const std::vector<std::string>& names, std::size_t most, const std::string& between);

/// The names of the bodies of a part.
std::string names_of(const Scene& part);

/// Plans the parts of a scene, each by itself: guards, engines and the reason for them are theirs together.
[[gnu::cold]] void plan_parts(const Scene& scene, SceneParts&& apart, bool any_rigid, const GivenNumbers& numbers,
                              Plan& plan, Simulated& simulated);

std::string reason_of(const ClosedForm& form);

/// Plans a scene, or a part of one with rigid bodies, while numbers of the user's are what they are.
[[gnu::cold]] Plan plan_of(const Scene& scene, bool beside_rigid, const GivenNumbers& numbers);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
