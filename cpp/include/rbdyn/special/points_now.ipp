// Definitions of rbdyn/special/points_now.hpp.
#pragma once

#include "rbdyn/special/points_now.hpp"

#include <cstddef>
#include <span>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/point_state.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/rigid_loads.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PointsNow::PointsNow(const PointLaws& given, std::span<const signed char> does, double time,
                                  std::span<const double> state, const Acting* acts)
    : laws(given),
      slip(does),
      t(time),
      x(state),
      acting(acts),
      states(given.states(time, state, does)),
      couplings(given, time, states) {}

RBDYN_INLINE Vector3 PointsNow::force_on(int body, int coupling) const {
    const bool is_first = laws.couplings()[static_cast<std::size_t>(coupling)].a.body == body;
    return is_first ? coupling_force(coupling) : Vector3(-coupling_force(coupling));
}

RBDYN_INLINE Vector3 PointsNow::coupling_force(int coupling) const {
    const bool is_present = laws.couplings()[static_cast<std::size_t>(coupling)].present();
    if (!is_present) return Vector3::Zero();
    return acting != nullptr ? acting->coupling_force(coupling) : couplings[coupling];
}

RBDYN_INLINE BodyReport PointsNow::body(int index, Asked asked) const {
    const PointLaws::Body& b = laws.body(index);
    const PointState<double>& p = states[static_cast<std::size_t>(index)];
    BodyReport result;
    result.mass = b.mass;
    result.position = result.origin = laws.view().origin + laws.view().axes * p.r;
    result.velocity = laws.view().axes * p.v;
    if (!b.rigid) {
        if (b.curve) result.coordinate = laws.map().value(b.first, x);
        if (asked == Asked::motion) return result;
        const PointReport r = laws.report(index, *this);
        result.acceleration = r.acceleration;
        result.force = r.force;
        result.applied = r.applied;
        result.reaction = r.reaction;
        return result;
    }
    // scenes with rigid bodies are seen from the world
    const RigidLaw& law = *b.rigid;
    const RigidState<double>& s = *p.rigid;
    result.origin = s.position(law.origin_in_frame(s));
    result.attitude = law.attitude(s);
    result.angular_velocity = s.to_world(s.omega);
    const Vector3 spin = law.inertia * s.omega;
    result.spin_momentum = s.to_world(spin);
    result.spin_energy = 0.5 * s.omega.dot(spin);
    result.coordinate = s.coordinate;
    if (asked == Asked::motion) return result;
    const RigidReport r = laws.rigid_report(index, *this);
    result.acceleration = r.center_acceleration;
    result.spin_rate = r.spin_rate;
    result.spin_power = r.spin_power;
    result.force = r.force;
    result.reaction = r.reaction;
    // from the point of the law to the centre of mass
    const Vector3 arm = s.to_world(law.center);
    result.reaction_moment = r.reaction_torque - arm.cross(r.reaction);
    Wrench<double> own;
    if (acting == nullptr) {
        own = laws.applied_wrench<double>(index, t, s);
    } else {
        own = {acting->force(index), acting->moment(index)};
        for (const int k : b.couplings) {
            const PointLaws::Connected& c = laws.couplings()[static_cast<std::size_t>(k)];
            const Vector3 f = coupling_force(k);
            if (c.a.body == index) own.add(s, Vector3(-f), rounded(c.a.point_on_rigid));
            if (c.b.body == index) own.add(s, f, rounded(c.b.point_on_rigid));
        }
    }
    result.applied = own.force;
    result.applied_moment = s.to_world(own.moment) - arm.cross(own.force);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
