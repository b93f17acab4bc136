// Definitions of rbdyn/special/lone_body.hpp.
#pragma once

#include "rbdyn/special/lone_body.hpp"

#include <cmath>
#include <complex>
#include <optional>
#include <span>

#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

/// The laws of a scene of which there is one body alone.
inline const SingleLaws& laws_of(const SceneModel& model) { return dynamic_cast<const SpecialModel&>(model).laws(); }

inline RigidState<double> state_of(const SingleLaws& laws, std::span<const double> x) {
    const SingleLaws::Variables own = laws.variables_of(laws.body(0), x);
    return laws.rigid(0).placed(own.q, own.v);
}

RBDYN_INLINE std::optional<LoneBody> lone_body(const SceneModel& model) {
    const SpecialModel* special = dynamic_cast<const SpecialModel*>(&model);
    if (special == nullptr || special->bodies() != 1) return std::nullopt;
    return special->laws().body(0).alone();
}

RBDYN_INLINE double spin(const SceneModel& model, std::span<const double> x) {
    return state_of(laws_of(model), x).omega[2];
}

RBDYN_INLINE double kovalevskaya(const SceneModel& model, std::span<const double> x, double gravity,
                                 const Vector3& up_in_world) {
    using C = std::complex<double>;
    const SingleLaws& laws = laws_of(model);
    const RigidLaw& law = laws.rigid(0);
    const RigidState<double> s = state_of(laws, x);
    const Vector3 &omega = s.omega, up = s.to_frame(up_in_world);
    const C z(omega[0], omega[1]), zeta(up[0], up[1]), c(law.center[0], law.center[1]);
    return std::norm(z * z - law.mass * gravity / law.moments[2] * c * zeta);
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
