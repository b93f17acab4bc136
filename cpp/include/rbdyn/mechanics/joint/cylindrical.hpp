// A hinge that slides along its axis: psi, then d.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct CylindricalLaw : Held {
    static constexpr int positions = 2, velocities = 2;
    Vector3Of<DoubleDouble> axis{};

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S* q, const S* v) const {
        Moving<S> child = carry(parent);
        const Vector3Of<S> e = parent.to_world(exactly<S>(axis));
        add_slide<S>(child, parent, e, q[1], v[1], S(0.0));
        turn_axes<S>(child, parent, axis, q[0]);
        add_turn<S>(child, e, v[0], S(0.0));
        child.joint = {{e, none<S>()}, {none<S>(), e}};
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
