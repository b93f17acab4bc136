// Plans that are kept with their scenes: what was decided once holds for the runs to come.
//
// A plan holds as long as its scene stays what it is and, of the numbers of the user's (Parameter), the same vanish
// (expression/numbers.hpp). Then a run takes its decisions and the equations that are recorded; what depends on the
// numbers is its own.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "rbdyn/plan/plan.hpp"

namespace rbdyn {

/// A plan, and what was decided by numbers of the user's; no numbers if there are none.
struct KeptPlan {
    Plan plan;
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
inline GivenNumbers numbers_of(const Scene& scene) {
    GivenNumbers numbers;
    for (const Scene::Body& b : scene.bodies()) {
        if (const Particle* particle = std::get_if<Particle>(&b.body)) particle->mass.give(numbers);
        if (const Rail* rail = b.rail()) rail->give(numbers);
    }
    for (const Scene::AppliedLoad& load : scene.loads()) give(load.load, numbers);
    for (const Scene::Connection& c : scene.connections())
        std::visit([&](const auto& coupling) { coupling.give(numbers); }, c.coupling);
    for (const Scene::Watch& w : scene.watches()) w.function.function().give(numbers);
    return numbers;
}

/// Throws InvalidInput if a first integral of the user's has the name of one that the scene has by itself.
inline void require_own_names(const Scene& scene, const Plan& plan) {
    for (const Scene::Integral& i : scene.integrals())
        if (std::count(plan.integrals.begin(), plan.integrals.end(), i.name) > 1)
            throw InvalidInput(
                "integral: \"" + i.name +
                "\" is one that this scene has by itself, and drifts are found by name; give it another");
}

/// A plan for the same scene with other numbers; none if a closed form it had is none for these.
[[gnu::cold]] inline std::optional<Plan> renewed(const Plan& kept, const Scene& scene, const GivenNumbers& numbers) {
    Plan plan = kept;
    if (kept.model) {
        plan.model = std::make_shared<const PointsModel>(*kept.model, scene, numbers);
        // on which side of a case motion begins depends on them
        if (plan.model->distinguishes()) plan.guards = guards_of(*plan.model);
        if (!kept.closed) return plan;
        plan.closed = closed_form(scene, *plan.model, true).form;
        if (!plan.closed) return std::nullopt;
        plan.reason = reason_of(*plan.closed);
        return plan;
    }
    auto apart = std::make_shared<const SceneParts>(scene);
    for (std::size_t i = 0; i < plan.parts.size(); ++i) {
        auto part = renewed(kept.parts[i], apart->parts[i].scene, numbers);
        if (!part) return std::nullopt;
        plan.parts[i] = *std::move(part);
    }
    plan.guards.clear();
    for (const Plan& part : plan.parts) plan.guards.insert(plan.guards.end(), part.guards.begin(), part.guards.end());
    plan.apart = std::move(apart);
    return plan;
}

}  // namespace planning

/// A scene with the numbers of the user's as they are now, and its plan: the one it keeps if that holds, else a new
/// one, which it keeps from now on. Throws InvalidInput on a scene without bodies.
inline PlannedScene planned(const Scene& scene) {
    if (scene.bodies().empty()) throw InvalidInput("Scene: it has 0 bodies; add() at least one before it is run");
    const GivenNumbers given = planning::numbers_of(scene);
    auto numbers = given.cells.empty() ? nullptr : std::make_unique<Numbers>(given);
    const Numbers::Active active(numbers.get());
    Scene now = scene.frozen();
    if (const auto kept = scene.kept_plan().get()) {
        if (!kept->decided) return {std::move(now), kept->plan, false};
        if (kept->decided->holds(given.values))
            if (auto plan = planning::renewed(kept->plan, now, given)) return {std::move(now), *std::move(plan), false};
    }
    Plan plan = planning::plan_of(now, false, given);
    planning::require_own_names(now, plan);
    scene.kept_plan().set(std::make_shared<const KeptPlan>(KeptPlan{plan, std::move(numbers)}));
    return {std::move(now), std::move(plan)};
}

/// Reads a scene and decides. Throws InvalidInput on a scene without bodies.
inline Plan make_plan(const Scene& scene) { return planned(scene).plan; }

}  // namespace rbdyn
