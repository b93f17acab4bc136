// Definitions of rbdyn/special/closed_motion.hpp.
#pragma once

#include "rbdyn/special/closed_motion.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void ClosedMotion::state(Instant since, std::span<double> x) const {
    if (map_.has_all()) return whole(since, x);
    std::vector<double> all(static_cast<std::size_t>(map_.variables()));
    whole(since, all);
    map_.gather(all, x);
}

RBDYN_INLINE double ClosedMotion::error(double since, double /*wanted*/) const {
    double worst = 0.0;
    for (const Part& p : parts_) worst = std::max(worst, p.form->error(since));
    return worst;
}

RBDYN_INLINE std::optional<Recurrence> ClosedMotion::recurrence(int body) const {
    return parts_[static_cast<std::size_t>(body)].form->recurrence();
}

RBDYN_INLINE std::string ClosedMotion::name() const {
    std::string names;
    for (const Part& p : parts_)
        if (names.find(p.form->name()) == std::string::npos) names += (names.empty() ? "" : ", ") + p.form->name();
    return names;
}

RBDYN_INLINE void ClosedMotion::whole(Instant since, std::span<double> x) const {
    for (const Part& p : parts_) p.form->state(since, x.data() + p.first, x.data() + p.first_rate);
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE std::optional<Vector3> only_constant_force(const Scene& scene, int index) {
    Vector3 sum = Vector3::Zero();
    for (const Scene::AppliedLoad& load : scene.loads()) {
        if (load.body != index || !is_present(load.load)) continue;
        if (std::holds_alternative<TorsionSpring>(load.load)) continue;
        const Force* force = std::get_if<Force>(&load.load);
        const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
        const bool at_center = !load.at || b.rigid() == nullptr || *load.at == b.rigid()->com();
        if (force == nullptr || !force->is_constant() || force->frame() != Frame::world || !at_center)
            return std::nullopt;
        sum += force->constant();
    }
    return sum;
}

RBDYN_INLINE std::pair<std::shared_ptr<const ClosedMotion>, std::string> closed_motion(const Scene& scene,
                                                                                       const SingleLaws& laws) {
    for (const Scene::Connection& c : scene.connections())
        if (is_present(c.coupling)) return {nullptr, "bodies joined by springs have none here"};
    for (const Scene::Watch& w : scene.watches())
        if (w.options.action.kind == WatchAction::Kind::change)
            return {nullptr, "\"" + w.name + "\" changes the state on the way"};
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<ClosedMotion::Part> parts;
    for (int i = 0; i < static_cast<int>(scene.bodies().size()); ++i) {
        const SingleLaw& b = laws.body(i);
        std::unique_ptr<const BodyForm> form;
        if (const std::optional<Vector3> force = only_constant_force(scene, i)) {
            Vector3Of<DoubleDouble> a;
            for (int k = 0; k < 3; ++k)
                a[k] = DoubleDouble(scene.gravity()[k]) + DoubleDouble((*force)[k]) / scene.bodies()[at(i)].mass();
            form = b.closed_form(scene, a);
        }
        if (!form) return {nullptr, "the motion of " + b.name + " has none here"};
        parts.push_back({b.first, b.first_rate, std::move(form)});
    }
    return {std::make_shared<const ClosedMotion>(laws.map(), std::move(parts)), ""};
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
