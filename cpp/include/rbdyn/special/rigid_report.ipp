// Definitions of rbdyn/special/rigid_law.hpp: what is told of a body in motion, and what its joint must exert.
//
// Reactions of ideal joints (7.57, 7.60): Phi = m a_G - F, and about the point o that the joint holds
//     M = I_G omega' + omega x I_G omega + (G - o) x m a_G - M_o, M_o the moment of what acts on it about o.
#pragma once

#include <cmath>
#include <vector>

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class T>
T RigidLaw::asked(const RigidState<T>& s, const Wrench<T>& w, const T* v_rate, const Observable& o) const {
    using std::atan2, std::sqrt;
    const auto c = static_cast<Eigen::Index>(o.component);
    const Vector3Of<T> center_of_mass = exactly<T>(exact.center);
    const auto element = [&](int row, int column) {
        const AxesOf<T> e = body_axes(s);
        return (column == 0 ? e.e1 : column == 1 ? e.e2 : e.e3)[row];
    };
    const auto accelerated = [&](const Vector3Of<T>& of) { return acceleration<T>(s, accelerations(s, v_rate), of); };
    const auto turned = [&](const Vector3Of<T>& a) { return curves::turned<T>(inertia, a); };
    switch (o.quantity) {
        case Quantity::position: return s.position(origin_in_frame<T>(s))[c];
        case Quantity::velocity: return s.velocity(origin_in_frame<T>(s))[c];
        case Quantity::acceleration: return acceleration<T>(s, accelerations(s, v_rate), origin_in_frame<T>(s))[c];
        case Quantity::center_of_mass: return s.position(center_of_mass)[c];
        case Quantity::center_of_mass_velocity: return s.velocity(center_of_mass)[c];
        case Quantity::center_of_mass_acceleration: return accelerated(center_of_mass)[c];
        case Quantity::force: return w.force[c];
        case Quantity::reaction:
            if (!holds_point()) return T(0.0);
            return Vector3Of<T>(accelerated(center_of_mass) * T(mass) - w.force)[c];
        case Quantity::reaction_torque:
            if (!any_turn_held()) return T(0.0);
            return s.to_world(torque_of_joint<T>(s, w, accelerations(s, v_rate)))[c];
        case Quantity::kinetic_energy: {
            const Vector3Of<T> v = s.velocity(center_of_mass);
            return T(0.5) * (T(mass) * dot<T>(v, v) + dot<T>(s.omega, turned(s.omega)));
        }
        case Quantity::speed: {
            const Vector3Of<T> v = s.velocity(center_of_mass);
            return sqrt(dot<T>(v, v));
        }
        case Quantity::quaternion: {
            const QuaternionOf<T> q = attitude(s);
            return c == 0 ? q.w : c == 1 ? q.x : c == 2 ? q.y : q.z;
        }
        case Quantity::rotation_matrix: return element(o.component / 3, o.component % 3);
        case Quantity::poisson_vector: return element(2, o.component);
        case Quantity::euler_angles: {
            const T x = element(0, 2), y = element(1, 2);
            // upright, or upside down: psi is the whole turn, as in euler_angles()
            if (is_exactly_zero(x) && is_exactly_zero(y))
                return c == 0 ? atan2(T(0.0), element(2, 2)) : c == 1 ? atan2(element(1, 0), element(0, 0)) : T(0.0);
            if (c == 0) return atan2(sqrt(x * x + y * y), element(2, 2));
            return c == 1 ? atan2(x, -y) : atan2(element(2, 0), element(2, 1));
        }
        case Quantity::angular_velocity: return to_body<T>(s, s.omega)[c];
        case Quantity::angular_velocity_world: return s.to_world(s.omega)[c];
        case Quantity::angular_acceleration: return to_body<T>(s, accelerations(s, v_rate).first)[c];
        case Quantity::angle:
        case Quantity::displacement: return s.coordinate;
        default: return s.rate;
    }
}

RBDYN_INLINE RigidLaw::S RigidLaw::observed(const RecordedBody& present, const Observable& o) const {
    return asked<S>(own<BodyState<S>>(*present.state).at, {present.force, present.moment}, present.rates, o);
}

RBDYN_INLINE double RigidLaw::observed(const LawsNow& now, const Observable& o) const {
    const Acts a = acts(now);
    return asked<double>(own<BodyState<double>>(now.state(index)).at, a.wrench, a.v_rate, o);
}

RBDYN_INLINE RigidReport RigidLaw::rigid_report(const LawsNow& now) const {
    const RigidState<double>& s = own<BodyState<double>>(now.state(index)).at;
    const Acts a = acts(now);
    const Wrench<double>& w = a.wrench;
    const Accelerations<double> rates = accelerations(s, a.v_rate);
    const Vector3& turning = rates.first;
    RigidReport r;
    r.center_acceleration = acceleration<double>(s, rates, center);
    r.force = w.force;
    r.attitude = attitude(s);
    r.angular_velocity = to_body<double>(s, s.omega);
    r.angular_acceleration = to_body<double>(s, turning);
    const Vector3 o = origin_in_frame<double>(s);
    r.position = s.position(o);
    r.velocity = s.velocity(o);
    r.acceleration = acceleration<double>(s, rates, o);
    r.coordinate = s.coordinate;
    r.rate = s.rate;
    const Vector3 momentum = inertia * s.omega;
    r.spin_momentum = s.to_world(momentum);
    r.spin_rate = s.to_world(momentum_rates<double>(s, rates).second);
    r.spin_energy = 0.5 * s.omega.dot(momentum);
    r.spin_power = momentum.dot(turning);
    r.moment = s.to_world(w.moment);
    r.reaction = r.reaction_torque = Vector3::Zero();
    if (!holds_point()) return r;
    r.reaction = mass * r.center_acceleration - r.force;
    r.force_effort = mass * r.center_acceleration.norm() + r.force.norm();
    if (!any_turn_held()) return r;
    r.reaction_torque = s.to_world(torque_of_joint<double>(s, w, rates));
    r.torque_effort = effort_of_torque(s, w, rates);
    return r;
}

RBDYN_INLINE PointReport RigidLaw::report(const LawsNow& now) const {
    const SingleState<double>& p = now.state(index);
    const RigidReport r = rigid_report(now);
    PointReport result;
    result.position = p.r;
    result.velocity = p.v;
    result.acceleration = r.center_acceleration;
    result.force = r.force;
    result.reaction = r.reaction;
    result.speed = p.v.norm();
    result.effort = r.force_effort;
    result.spin_momentum = r.spin_momentum;
    result.spin_energy = r.spin_energy;
    result.spin_power = r.spin_power;
    return result;
}

RBDYN_INLINE void RigidLaw::report(const LawsNow& now, Asked asked, BodyReport& result) const {
    const RigidState<double>& s = own<BodyState<double>>(now.state(index)).at;
    result.origin = s.position(origin_in_frame<double>(s));
    result.attitude = attitude(s);
    result.angular_velocity = s.to_world(s.omega);
    const Vector3 spin = inertia * s.omega;
    result.spin_momentum = s.to_world(spin);
    result.spin_energy = 0.5 * s.omega.dot(spin);
    result.coordinate = s.coordinate;
    if (asked == Asked::motion) return;
    const RigidReport r = rigid_report(now);
    result.acceleration = r.center_acceleration;
    result.spin_rate = r.spin_rate;
    result.spin_power = r.spin_power;
    result.force = r.force;
    result.reaction = r.reaction;
    // from the point of the law to the centre of mass
    const Vector3 arm = s.to_world(center);
    result.reaction_moment = r.reaction_torque - arm.cross(r.reaction);
    Wrench<double> w;
    if (now.acting == nullptr) {
        w = applied<double>(now.t, s);
    } else {
        w = {now.acting->force(index), now.acting->moment(index)};
        for (const int k : couplings) {
            const SingleLaws::Connected& c = now.laws.coupling(k);
            const Vector3 f = now.coupling_force(k);
            if (c.a.body == index) w.add(s, Vector3(-f), rounded(c.a.point));
            if (c.b.body == index) w.add(s, f, rounded(c.b.point));
        }
    }
    result.applied = w.force;
    result.applied_moment = s.to_world(w.moment) - arm.cross(w.force);
}

RBDYN_INLINE void RigidLaw::observe_center(const RigidReport& r, const LawsNow& now, std::vector<Observed>& out) const {
    const SingleState<double>& p = now.state(index);
    out.push_back({p.r, true, 0.0, p.r.norm(), Alike::place});
    out.push_back({p.v, false, 0.0, p.v.norm(), Alike::velocity, 0.0F, r.force_effort / mass});
}

RBDYN_INLINE void RigidLaw::observe_axes(const RigidReport& r, std::vector<Observed>& out, double gyration) {
    // axes of unit length: together they show the angle between two attitudes
    const Matrix3 axes = rotation_matrix(r.attitude);
    for (int k = 0; k < 3; ++k) {
        out.push_back({column(axes, k), false, 1.0, 1.0});
        out.back().gyration = gyration;
    }
    out.push_back({r.angular_velocity, false, 0.0, r.angular_velocity.norm(), Alike::turning});
}

RBDYN_INLINE void RigidLaw::observe_force(const RigidReport& r, std::vector<Observed>& out) {
    out.push_back({r.reaction, false, 0.0, r.force_effort, Alike::force});
}

RBDYN_INLINE void RigidLaw::observe_torque(const RigidReport& r, std::vector<Observed>& out) {
    out.push_back({r.reaction_torque, false, 0.0, r.torque_effort, Alike::torque});
}

}  // namespace rbdyn::inline RBDYN_FORM
