// Definitions of rbdyn/statics/rail_work.hpp.
#pragma once

#include "rbdyn/statics/rail_work.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>

#include "rbdyn/body/particle.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/quadrature.hpp"
#include "rbdyn/plan/integrals.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/path_forces.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RailWork::RailWork(const Scene& scene, BodyHandle bead) {
    const Scene::Body& body = scene.bodies()[static_cast<std::size_t>(bead.index)];
    Scene functions;
    const BodyHandle one =
        functions.add(std::get<Particle>(body.body), *body.rail(), {.parameter = body.parameter}, body.name);
    for (const Scene::AppliedLoad& load : scene.loads())
        if (load.body == bead.index && planning::has_potential_along_rail(scene, load)) functions.apply(load.load, one);
    if (functions.loads().empty()) return;
    forces_.emplace(functions);
    origin_ = arc_length_origin(forces_->curve());
}

RBDYN_INLINE double RailWork::operator()(double u) const {
    if (!forces_) return 0.0;
    PathForces::Values q(*forces_);
    const double floor = 2.0 * std::numeric_limits<double>::epsilon() * std::abs(u - origin_) *
                         std::max(forces_->effort(u), forces_->effort(origin_));
    return curves::integral([&](double place) { return q(place); }, origin_, u, floor);
}

}  // namespace rbdyn::inline RBDYN_FORM
