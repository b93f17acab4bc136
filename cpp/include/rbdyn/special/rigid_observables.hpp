// What a watched function may ask of a rigid body, in numbers of any type.
#pragma once

#include <cmath>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/rigid_loads.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A quantity of a rigid body. `q`: its coordinates, `v_rate`: the derivatives of its velocities.
template <class S>
S observed(const RigidLaw& law, const RigidState<S>& s, const Wrench<S>& w, const S* v_rate, const Observable& o) {
    using std::atan2, std::sqrt;
    const auto c = static_cast<Eigen::Index>(o.component);
    const Vector3Of<S> center = RigidLaw::constant<S>(law.exact.center);
    const auto element = [&](int row, int column) {
        const AxesOf<S> e = law.body_axes(s);
        return (column == 0 ? e.e1 : column == 1 ? e.e2 : e.e3)[row];
    };
    const auto reaction = [&] {
        return Vector3Of<S>(RigidLaw::acceleration<S>(s, law.accelerations<S>(s, v_rate), center) * S(law.mass) -
                            w.force);
    };
    const auto inertia = [&](const Vector3Of<S>& a) { return curves::turned<S>(law.inertia, a); };
    switch (o.quantity) {
        case Quantity::position: return s.position(law.origin_in_frame(s))[c];
        case Quantity::velocity: return s.velocity(law.origin_in_frame(s))[c];
        case Quantity::acceleration:
            return RigidLaw::acceleration<S>(s, law.accelerations<S>(s, v_rate), law.origin_in_frame(s))[c];
        case Quantity::center_of_mass: return s.position(center)[c];
        case Quantity::center_of_mass_velocity: return s.velocity(center)[c];
        case Quantity::center_of_mass_acceleration:
            return RigidLaw::acceleration<S>(s, law.accelerations<S>(s, v_rate), center)[c];
        case Quantity::force: return w.force[c];
        case Quantity::reaction: return law.kind == RigidLaw::Kind::free ? S(0.0) : reaction()[c];
        case Quantity::reaction_torque: {
            if (law.turns_freely()) return S(0.0);
            return s.to_world(torque_of_joint<S>(law, s, w, law.accelerations<S>(s, v_rate)))[c];
        }
        case Quantity::kinetic_energy: {
            const Vector3Of<S> v = s.velocity(center);
            return S(0.5) * (S(law.mass) * dot<S>(v, v) + dot<S>(s.omega, inertia(s.omega)));
        }
        case Quantity::speed: {
            const Vector3Of<S> v = s.velocity(center);
            return sqrt(dot<S>(v, v));
        }
        case Quantity::quaternion: {
            const QuaternionOf<S> q = law.attitude(s);
            return c == 0 ? q.w : c == 1 ? q.x : c == 2 ? q.y : q.z;
        }
        case Quantity::rotation_matrix: return element(o.component / 3, o.component % 3);
        case Quantity::poisson_vector: return element(2, o.component);
        case Quantity::euler_angles: {
            const S x = element(0, 2), y = element(1, 2);
            // upright, or upside down: psi is the whole turn, as in euler_angles()
            if (RigidLaw::is_exactly_zero(x) && RigidLaw::is_exactly_zero(y))
                return c == 0 ? atan2(S(0.0), element(2, 2)) : c == 1 ? atan2(element(1, 0), element(0, 0)) : S(0.0);
            if (c == 0) return atan2(sqrt(x * x + y * y), element(2, 2));
            return c == 1 ? atan2(x, -y) : atan2(element(2, 0), element(2, 1));
        }
        case Quantity::angular_velocity: return law.to_body(s, s.omega)[c];
        case Quantity::angular_velocity_world: return s.to_world(s.omega)[c];
        case Quantity::angular_acceleration: return law.to_body(s, law.accelerations<S>(s, v_rate).first)[c];
        case Quantity::angle:
        case Quantity::displacement: return s.coordinate;
        default: return s.rate;
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
