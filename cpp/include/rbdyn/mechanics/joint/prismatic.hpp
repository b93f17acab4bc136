// A slide: P moves along an axis of the parent, R = R_parent.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct PrismaticLaw : Held {
    static constexpr int positions = 1, velocities = 1;
    Vector3Of<DoubleDouble> axis{};

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S* q, const S* v) const {
        Moving<S> child = carry(parent);
        const Vector3Of<S> e = parent.to_world(exactly<S>(axis));
        add_slide<S>(child, parent, e, q[0], v[0], S(0.0));
        child.joint = {{none<S>(), e}};
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
