// A bead on a curve fixed in its parent: u, and w = u'.
#pragma once

#include <optional>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct RailLaw : Held {
    static constexpr int positions = 1, velocities = 1;
    std::optional<Curve> curve;

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S* q, const S* v) const {
        const CurvePoint<S> c = curve->at<S>(q[0], Placement{});
        Moving<S> child = carried<S>(parent, Vector3Of<S>(exactly<S>(offset) + c.position));
        const Vector3Of<S> along = parent.to_world(c.first), sliding = along * v[0];
        child.velocity += sliding;
        child.bias += Vector3Of<S>(cross<S>(parent.omega, sliding) * S(2.0)) +
                      Vector3Of<S>(parent.to_world(c.second) * (v[0] * v[0]));
        child.joint = {{none<S>(), along}};
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
