// Definitions of rbdyn/plan/kept_plan.hpp.
#pragma once

#include "rbdyn/plan/kept_plan.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/body/particle.hpp"
#include "rbdyn/engine/closed_form.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/plan/planning.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/plan_slot.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/door.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE GivenNumbers numbers_of(const Scene& scene) {
    GivenNumbers numbers;
    for (const Scene::Body& b : scene.bodies()) {
        if (const Particle* particle = std::get_if<Particle>(&b.body)) particle->mass.give(numbers);
        if (const Rail* rail = b.rail()) rail->give(numbers);
        if (const Revolute* hinge = std::get_if<Revolute>(&b.joint)) {
            if (hinge->friction) hinge->friction->give(numbers);
            hinge->pin_radius.give(numbers);
        }
        if (const Prismatic* slide = std::get_if<Prismatic>(&b.joint); slide != nullptr && slide->friction)
            slide->friction->give(numbers);
    }
    for (const Scene::AppliedLoad& load : scene.loads()) give(load.load, numbers);
    for (const Scene::Connection& c : scene.connections())
        std::visit([&](const auto& coupling) { coupling.give(numbers); }, c.coupling);
    for (const Scene::Touch& c : scene.contacts())
        if (c.options.friction) c.options.friction->give(numbers);
    for (const Scene::Watch& w : scene.watches()) w.function.function().give(numbers);
    return numbers;
}

RBDYN_INLINE void require_own_names(const Scene& scene, const Plan& plan) {
    for (const Scene::Integral& i : scene.integrals())
        if (std::count(plan.integrals.begin(), plan.integrals.end(), i.name) > 1)
            throw InvalidInput(
                "integral: \"" + i.name +
                "\" is one that this scene has by itself, and drifts are found by name; give it another");
}

RBDYN_INLINE std::optional<Plan> renewed(const Plan& kept, const Scene& scene, const GivenNumbers& numbers,
                                         bool elsewhere) {
    if (kept.model) {
        std::shared_ptr<const SceneModel> model =
            elsewhere ? kept.model->started_elsewhere(scene, numbers) : kept.model->with_numbers(scene, numbers);
        if (!model) return std::nullopt;
        Plan plan = kept;
        plan.model = std::move(model);
        if (elsewhere) plan.not_unique = plan.model->not_unique();
        // on which side of a case motion begins depends on both
        if (plan.model->distinguishes() || (elsewhere && plan.model->guards_depend_on_start()))
            plan.guards = plan.model->guards();
        // what a plan says where there are none
        if (plan.guards.empty() != kept.guards.empty()) return std::nullopt;
        if (!kept.closed) return plan;
        plan.closed = closed_form(scene, *plan.model, true).form;
        if (!plan.closed) return std::nullopt;
        // whether it has one form or more may depend on where it starts
        const bool is_one = is_one_form(plan.closed);
        if (is_one != (kept.engine == "closed form")) return std::nullopt;
        if (is_one) plan.reason = reason_of(*plan.closed);
        return plan;
    }
    Plan plan = kept;
    auto apart = std::make_shared<const SceneParts>(scene);
    for (std::size_t i = 0; i < plan.parts.size(); ++i) {
        const auto &before = kept.apart->parts[i].scene.bodies(), &now = apart->parts[i].scene.bodies();
        const bool is_moved = elsewhere && !std::equal(now.begin(), now.end(), before.begin(), before.end(),
                                                       [](const Started& a, const Started& b) { return a == b; });
        if (!is_moved && numbers.cells.empty()) continue;
        auto part = renewed(kept.parts[i], apart->parts[i].scene, numbers, is_moved);
        if (!part) return std::nullopt;
        plan.parts[i] = *std::move(part);
    }
    plan.guards.clear();
    plan.not_unique.clear();
    for (const Plan& part : plan.parts) {
        plan.guards.insert(plan.guards.end(), part.guards.begin(), part.guards.end());
        plan.not_unique.insert(plan.not_unique.end(), part.not_unique.begin(), part.not_unique.end());
    }
    plan.apart = std::move(apart);
    return plan;
}

}  // namespace rbdyn::inline RBDYN_FORM::planning

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PlannedScene planned(const Scene& scene, double start) {
    if (scene.bodies().empty()) throw InvalidInput("Scene: it has 0 bodies; add() at least one before it is run");
    const GivenNumbers given = planning::numbers_of(scene);
    auto numbers = given.cells.empty() ? nullptr : std::make_unique<Numbers>(given);
    const Numbers::Active active(numbers.get());
    Scene now = scene.frozen().begun_at(start);
    const auto held = [&](const KeptPlan& kept, bool elsewhere) -> std::optional<Plan> {
        if (kept.origin != now.origin()) return std::nullopt;
        if (!elsewhere && !kept.decided) return kept.plan;
        if (kept.decided && !kept.decided->holds(given.values)) return std::nullopt;
        return planning::renewed(kept.plan, now, given, elsewhere);
    };
    if (const auto kept = scene.kept_plan().get())
        if (auto plan = held(*kept, false)) return {std::move(now), *std::move(plan), false};
    for (const auto& [kept, is_of_another_start] : scene.kept_plan().others())
        if (auto plan = held(*kept, is_of_another_start)) return {std::move(now), *std::move(plan), false};
    Plan plan = planning::plan_of(now, false, given);
    planning::require_own_names(now, plan);
    scene.kept_plan().set(std::make_shared<const KeptPlan>(KeptPlan{plan, now.origin(), std::move(numbers)}));
    return {std::move(now), std::move(plan)};
}

}  // namespace rbdyn::inline RBDYN_FORM
