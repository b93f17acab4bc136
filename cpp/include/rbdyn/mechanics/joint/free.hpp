// No joint: a particle, or a body by its centre of mass and its attitude in the world.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/joint/spherical.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

template <class S>
void move_freely(Moving<S>& child, const S* q, const S* v) {
    child.place = {q[0], q[1], q[2]};
    child.velocity = {v[0], v[1], v[2]};
    for (int k = 0; k < 3; ++k) {
        Twist<S> one;
        one.move[k] = S(1.0);
        child.joint.push_back(one);
    }
}

struct FreePointLaw : Held {
    static constexpr int positions = 3, velocities = 3;

    template <class S>
    Moving<S> move(const Moving<S>&, const S* q, const S* v) const {
        Moving<S> child;
        move_freely<S>(child, q, v);
        return child;
    }
};

struct FreeBodyLaw : Held {
    static constexpr int positions = 7, velocities = 6;

    template <class S>
    Moving<S> move(const Moving<S>&, const S* q, const S* v) const {
        Moving<S> child;
        move_freely<S>(child, q, v);
        turn_freely<S>(child, q + 3, v + 3);
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
