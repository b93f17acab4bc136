// A hinge: R = R_parent R(axis, psi), omega = omega_parent + e psi'.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct RevoluteLaw : Held {
    static constexpr int positions = 1, velocities = 1;
    Vector3Of<DoubleDouble> axis{};

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S* q, const S* v) const {
        Moving<S> child = carry(parent);
        const Vector3Of<S> e = parent.to_world(exactly<S>(axis));
        turn_axes<S>(child, parent, axis, q[0]);
        add_turn<S>(child, e, v[0], S(0.0));
        child.joint = {{e, none<S>()}};
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
