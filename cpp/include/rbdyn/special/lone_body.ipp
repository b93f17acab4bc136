// Definitions of rbdyn/special/lone_body.hpp.
#pragma once

#include "rbdyn/special/lone_body.hpp"

#include <cmath>
#include <complex>
#include <optional>
#include <span>

#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/points.hpp"
#include "rbdyn/special/rigid_law.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

/// The laws of a scene of which there is one body alone.
inline const PointLaws& laws_of(const SceneModel& model) { return dynamic_cast<const PointsModel&>(model).laws(); }

inline RigidState<double> state_of(const PointLaws& laws, std::span<const double> x) {
    const PointLaws::Variables own = laws.variables_of(laws.body(0), x);
    return laws.body(0).rigid->state(own.q, own.v);
}

/// Whether a body with its centre of mass off the axis of its equal moments A = B has C = A/2 and G in their plane.
inline bool is_kovalevskaya(const RigidLaw& law) {
    const double near = 1e-12;
    return law.holds_a_point() && std::abs(law.moments[0] - law.moments[1]) <= near * law.moments[0] &&
           std::abs(law.moments[0] - 2.0 * law.moments[2]) <= near * law.moments[0] &&
           std::abs(law.center[2]) <= near * law.center.norm() && !law.center.isZero(0.0);
}

RBDYN_INLINE std::optional<LoneBody> lone_body(const SceneModel& model) {
    const PointsModel* points = dynamic_cast<const PointsModel*>(&model);
    if (points == nullptr || points->bodies() != 1 || !points->laws().body(0).rigid) return std::nullopt;
    const RigidLaw& law = *points->laws().body(0).rigid;
    return LoneBody{law.holds_a_point(), law.center.isZero(0.0), is_kovalevskaya(law), law.follows_axis};
}

RBDYN_INLINE double spin(const SceneModel& model, std::span<const double> x) {
    return state_of(laws_of(model), x).omega[2];
}

RBDYN_INLINE double kovalevskaya(const SceneModel& model, std::span<const double> x, double gravity,
                                 const Vector3& up_in_world) {
    using C = std::complex<double>;
    const PointLaws& laws = laws_of(model);
    const RigidLaw& law = *laws.body(0).rigid;
    const RigidState<double> s = state_of(laws, x);
    const Vector3 &omega = s.omega, up = s.to_frame(up_in_world);
    const C z(omega[0], omega[1]), zeta(up[0], up[1]), c(law.center[0], law.center[1]);
    return std::norm(z * z - law.mass * gravity / law.moments[2] * c * zeta);
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
