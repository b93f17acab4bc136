// Two hinges and a massless cross: R = R_parent R(first, a) R(second, b).
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct UniversalLaw : Held {
    static constexpr int positions = 2, velocities = 2;
    Vector3Of<DoubleDouble> first{}, second{};

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S* q, const S* v) const {
        Moving<S> child = carry(parent);
        const Vector3Of<S> e1 = parent.to_world(exactly<S>(first));
        turn_axes<S>(child, parent, first, q[0]);
        const Vector3Of<S> e2 = child.to_world(exactly<S>(second));
        turn_axes<S>(child, child, second, q[1]);
        add_turn<S>(child, e1, v[0], S(0.0));
        add_turn<S>(child, e2, v[1], S(0.0));
        child.joint = {{e1, none<S>()}, {e2, none<S>()}};
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
