// Definitions of rbdyn/special/slide_law.hpp.
#pragma once

#include "rbdyn/special/slide_law.hpp"

#include <cstddef>
#include <memory>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/body_form.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<VariableGroup> SlideLaw::groups(bool of_positions) const {
    return {{0, 1, of_positions, 0.0, of_positions ? Alike::place : Alike::velocity}};
}

RBDYN_INLINE void SlideLaw::observe(const LawsNow& now, std::vector<Observed>& out) const {
    const RigidReport r = rigid_report(now);
    observe_center(r, now, out);
    observe_force(r, out);
    observe_torque(r, out);
}

RBDYN_INLINE std::unique_ptr<const BodyForm> SlideLaw::closed_form(const Scene& scene,
                                                                   const Vector3Of<DoubleDouble>& a) const {
    const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
    const Vector3Of<DoubleDouble> e = widened(std::get<Prismatic>(b.joint).axis);
    Vector3Of<DoubleDouble> x, v, along;
    x[0] = b.parameter;
    v[0] = b.speed;
    along[0] = dot<DoubleDouble>(e, a) / sqrt(dot<DoubleDouble>(e, e));
    return closed_forms::made<closed_forms::SlidingForm>(closed_forms::Accelerated(x, v, along), 1);
}

}  // namespace rbdyn::inline RBDYN_FORM
