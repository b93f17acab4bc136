// A bead that may leave its rail: u and its place in the world, w and its velocity, of which those not in use rest.
//
// A tree is one of its modes: where the bead flies it hangs on nothing. A velocity that is not in use moves nothing, so
// it meets no inertia and has no acceleration (accelerate.hpp).
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/rail.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct LooseRailLaw : RailLaw {
    static constexpr int positions = 4, velocities = 4;
    static constexpr int space = 1;  // the first of the variables of its place, and of its velocity
    bool releases = false;           // where its curve ends
    bool flies = false;

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S& t, const S* q, const S* v) const {
        if (!flies) {
            Moving<S> child = RailLaw::move<S>(parent, t, q, v);
            for (int k = 0; k < 3; ++k) child.joint.push_back({});
            return child;
        }
        Moving<S> child;
        child.place = {q[space], q[space + 1], q[space + 2]};
        child.velocity = {v[space], v[space + 1], v[space + 2]};
        child.joint.push_back({});
        for (int k = 0; k < 3; ++k) {
            Twist<S> one;
            one.move[k] = S(1.0);
            child.joint.push_back(one);
        }
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
