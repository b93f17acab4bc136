// Definitions of rbdyn/special/axis_law.hpp.
#pragma once

#include "rbdyn/special/axis_law.hpp"

#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE AxisLaw::AxisLaw(const Scene& scene, int place, const Vector3& axis, const Vector3& at,
                              const Vector3& point)
    : RigidLaw(scene, place, at, point, widened(point)) {
    exact.frame = axis_frame(widened(axis), to_center(scene));
    exact.moments = {1.0, 1.0, 1.0};
    take_frame(scene);
}

RBDYN_INLINE void AxisLaw::start_in(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const {
    q[0] = b.parameter;
    v[0] = b.speed;
}

RBDYN_INLINE void AxisLaw::leave_out(const StateMap& map, std::vector<Omission>& omissions) const {
    if (!map.is_simulated(first_rate))
        omissions.push_back(
            {"rate of " + name, "stays at " + text(map.start(first_rate)) + "; a load along its joint brings it in"});
}

}  // namespace rbdyn::inline RBDYN_FORM
