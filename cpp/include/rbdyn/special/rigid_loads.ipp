// Definitions of rbdyn/special/rigid_loads.hpp.
#pragma once

#include "rbdyn/special/rigid_loads.hpp"

#include <utility>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/special/rigid_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE double effort_of_torque(const RigidLaw& law, const RigidState<double>& s, const Wrench<double>& w,
                                     const std::pair<Vector3, Vector3>& rates) {
    const auto [moved, spun] = momentum_rates<double>(law, s, rates);
    const Vector3 loads = w.moment - law.center.cross(s.to_frame(w.force)), force = w.force.cwiseAbs();
    const Vector3 arm = law.center.cwiseAbs(),
                  f = moved.cwiseAbs() + Vector3(s.axes.e1.cwiseAbs().dot(force), s.axes.e2.cwiseAbs().dot(force),
                                                 s.axes.e3.cwiseAbs().dot(force));
    Vector3 effort =
        spun.cwiseAbs() + loads.cwiseAbs() +
        Vector3(arm[1] * f[2] + arm[2] * f[1], arm[2] * f[0] + arm[0] * f[2], arm[0] * f[1] + arm[1] * f[0]);
    if (law.kind == RigidLaw::Kind::revolute) effort[2] = 0.0;
    return effort.norm();
}

RBDYN_INLINE RigidReport rigid_report_of_rates(const RigidLaw& law, const RigidState<double>& s,
                                               const Wrench<double>& w, const double* v_rate) {
    RigidReport r;
    const auto rates = law.accelerations<double>(s, v_rate);
    const Vector3& turning = rates.first;
    r.center_acceleration = RigidLaw::acceleration<double>(s, rates, law.center);
    r.force = w.force;
    r.attitude = law.attitude(s);
    r.angular_velocity = law.to_body(s, s.omega);
    r.angular_acceleration = law.to_body(s, turning);
    const Vector3 o = law.origin_in_frame(s);
    r.position = s.position(o);
    r.velocity = s.velocity(o);
    r.acceleration = RigidLaw::acceleration<double>(s, rates, o);
    r.coordinate = s.coordinate;
    r.rate = s.rate;
    const Vector3 momentum = law.inertia * s.omega;
    r.spin_momentum = s.to_world(momentum);
    r.spin_rate = s.to_world(momentum_rates<double>(law, s, rates).second);
    r.spin_energy = 0.5 * s.omega.dot(momentum);
    r.spin_power = momentum.dot(turning);
    r.moment = s.to_world(w.moment);
    r.reaction = r.reaction_torque = Vector3::Zero();
    if (law.kind == RigidLaw::Kind::free) return r;
    r.reaction = law.mass * r.center_acceleration - r.force;
    r.force_effort = law.mass * r.center_acceleration.norm() + r.force.norm();
    if (law.kind == RigidLaw::Kind::spherical) return r;
    r.reaction_torque = s.to_world(torque_of_joint<double>(law, s, w, rates));
    r.torque_effort = effort_of_torque(law, s, w, rates);
    return r;
}

RBDYN_INLINE RigidReport rigid_report(const RigidLaw& law, const RigidState<double>& s, const Wrench<double>& w,
                                      const double* q) {
    double q_rate[8], v_rate[6];
    law.rates<double>(s, q, w, q_rate, v_rate);
    return rigid_report_of_rates(law, s, w, v_rate);
}

}  // namespace rbdyn::inline RBDYN_FORM
