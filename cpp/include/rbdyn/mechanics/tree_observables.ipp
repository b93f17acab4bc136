// Definitions of rbdyn/mechanics/tree_observables.hpp.
#pragma once

#include "rbdyn/mechanics/tree_observables.hpp"

#include <cstddef>
#include <span>

#include "rbdyn/mechanics/joint_number.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE double observed(const TreeState& now, const Exerted& exerted, const Observable& o, double t,
                             std::span<const double> x) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    if (o.quantity == Quantity::time) return t;
    if (o.quantity == Quantity::coupling_force) return now.couplings[at(o.subject)][o.component];
    if (o.quantity == Quantity::length) {
        const Exerted::Coupled& c = exerted.couplings()[at(o.subject)];
        return (now.tree.point<double>(c.a, now.moving).place - now.tree.point<double>(c.b, now.moving).place).norm();
    }
    const PointReport p = now.point(o.subject);
    const Node& n = now.tree.node(o.subject);
    const auto velocity = [&](int k) { return x[at(now.tree.positions() + n.v + k)]; };
    if (is_of_joint(o.quantity)) {
        if (const DrivenLaw* law = n.joint.as<DrivenLaw>())
            return joint_number(
                n.joint, o, [&](int) { return law->way(t); }, [&](int) { return law->rate(t); });
        return joint_number(
            n.joint, o, [&](int k) { return x[at(n.q + k)]; }, velocity);
    }
    switch (o.quantity) {
        case Quantity::center_of_mass: return p.position[o.component];
        case Quantity::center_of_mass_velocity: return p.velocity[o.component];
        case Quantity::center_of_mass_acceleration: return p.acceleration[o.component];
        case Quantity::force: return p.force[o.component];
        case Quantity::reaction: return p.reaction[o.component];
        case Quantity::kinetic_energy:
            return 0.5 * static_cast<double>(n.mass) * p.velocity.squaredNorm() + p.spin_energy;
        case Quantity::parameter: return x[at(n.q)];
        case Quantity::speed:
            if (n.joint.flies()) return 0.0;
            if (const RailLaw* rail = n.joint.rail()) return rail->curve->first(x[at(n.q)]).norm() * velocity(0);
            return p.velocity.norm();
        default: break;
    }
    if (n.is_point) {
        if (o.quantity == Quantity::position) return p.position[o.component];
        if (o.quantity == Quantity::velocity) return p.velocity[o.component];
        return p.acceleration[o.component];
    }
    const RigidReport r = now.rigid(o.subject, x);
    const Quaternion& q = r.attitude;
    switch (o.quantity) {
        case Quantity::position: return r.position[o.component];
        case Quantity::velocity: return r.velocity[o.component];
        case Quantity::acceleration: return r.acceleration[o.component];
        case Quantity::quaternion:
            return o.component == 0 ? q.w : o.component == 1 ? q.x : o.component == 2 ? q.y : q.z;
        case Quantity::rotation_matrix: return rotation_matrix(q)(o.component / 3, o.component % 3);
        case Quantity::euler_angles: {
            const EulerAngles a = euler_angles(q);
            return o.component == 0 ? a.theta : o.component == 1 ? a.psi : a.phi;
        }
        case Quantity::angular_velocity: return r.angular_velocity[o.component];
        case Quantity::angular_acceleration: return r.angular_acceleration[o.component];
        case Quantity::angular_velocity_world: return now.moving[at(o.subject)].omega[o.component];
        case Quantity::poisson_vector: return rotation_matrix(q)(2, o.component);
        case Quantity::reaction_torque: return r.reaction_torque[o.component];
        default: return 0.0;
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
