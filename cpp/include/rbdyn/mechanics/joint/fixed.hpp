// A weld: no motion against the parent.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct FixedLaw : Held {
    static constexpr int positions = 0, velocities = 0;
    Matrix3Of<DoubleDouble> attitude{};  // of the child in the parent

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S*, const S*) const {
        Moving<S> child = carry(parent);
        child.axes = {parent.to_world(exactly<S>(attitude.col(0))), parent.to_world(exactly<S>(attitude.col(1))),
                      parent.to_world(exactly<S>(attitude.col(2)))};
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
