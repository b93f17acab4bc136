// Motion along a plane of the parent: the body's origin along x and y, and a turn about x cross y.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct PlanarLaw : Held {
    static constexpr int positions = 3, velocities = 3, angle = 2;
    Vector3Of<DoubleDouble> x{}, y{}, normal{};

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S* q, const S* v) const {
        Moving<S> child = carry(parent);
        const Vector3Of<S> ex = parent.to_world(exactly<S>(x)), ey = parent.to_world(exactly<S>(y)),
                           e = parent.to_world(exactly<S>(normal));
        add_slide<S>(child, parent, ex, q[0], v[0], S(0.0));
        add_slide<S>(child, parent, ey, q[1], v[1], S(0.0));
        turn_axes<S>(child, parent, normal, q[2]);
        add_turn<S>(child, e, v[2], S(0.0));
        child.joint = {{none<S>(), ex}, {none<S>(), ey}, {e, none<S>()}};
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
