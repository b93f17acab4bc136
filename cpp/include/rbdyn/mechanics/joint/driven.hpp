// A hinge or a slide whose coordinate is a function of time: its velocity is none of the tree's own.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct DrivenLaw : Held {
    static constexpr int positions = 0, velocities = 0;
    Vector3Of<DoubleDouble> axis{};
    bool turns = true;
    TimeFunction way, rate;  // of time: the coordinate, and its rate
    double ahead = 0.0;      // s: the time in its phases, as they were written, of the time (phases.hpp)

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S& t) const {
        Moving<S> child = carry(parent);
        const Vector3Of<S> e = parent.to_world(exactly<S>(axis));
        const S q = way(t), v = rate(t), a = rate.rate(t);
        if (turns) {
            turn_axes<S>(child, parent, axis, q);
            add_turn<S>(child, e, v, a);
        } else {
            add_slide<S>(child, parent, e, q, v, a);
        }
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
