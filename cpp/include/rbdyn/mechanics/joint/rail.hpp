// A bead on a curve of its parent: u, and w = u'.
//
// The curve is fixed there, or moves there as a function of time says, r = R(t) c(u) + d(t) in the parent's axes.
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
#include "rbdyn/scene/rigid_motion.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct RailLaw : Held {
    static constexpr int positions = 1, velocities = 1;
    std::optional<Curve> curve;
    RigidMotion motion;  // of the rail itself
    double ahead = 0.0;  // s: the time in its phases, as they were written, of the time (phases.hpp)

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S& t, const S* q, const S* v) const {
        const CurvePoint<S> c = curve->at<S>(q[0], Placement{});
        if (motion.present()) return moved<S>(parent, t, c, v[0]);
        Moving<S> child = carried<S>(parent, Vector3Of<S>(exactly<S>(offset) + c.position));
        const Vector3Of<S> along = parent.to_world(c.first), sliding = along * v[0];
        child.velocity += sliding;
        child.bias += Vector3Of<S>(cross<S>(parent.omega, sliding) * S(2.0)) +
                      Vector3Of<S>(parent.to_world(c.second) * (v[0] * v[0]));
        child.joint = {{none<S>(), along}};
        return child;
    }
    /// A direction of the curve's coordinates in the parent's axes.
    template <class S>
    Vector3Of<S> turned(const S& t, const Vector3Of<S>& direction) const {
        return motion.present() ? motion.at<S>(t).turned(direction) : direction;
    }

private:
    template <class S>
    Moving<S> moved(const Moving<S>& parent, const S& t, const CurvePoint<S>& c, const S& w) const {
        const RigidPlacement<S> at = motion.at<S>(t), rate = motion.rate<S>(t), second = motion.second<S>(t);
        Moving<S> child = carried<S>(parent, Vector3Of<S>(exactly<S>(offset) + at.moved(c.position)));
        const Vector3Of<S> first = at.turned(c.first), sliding = first * w;
        const Vector3Of<S> velocity = parent.to_world(Vector3Of<S>(rate.moved(c.position) + sliding));
        child.velocity += velocity;
        child.bias += Vector3Of<S>(cross<S>(parent.omega, velocity) * S(2.0)) +
                      parent.to_world(Vector3Of<S>(second.moved(c.position) + rate.turned(c.first) * (S(2.0) * w) +
                                                   at.turned(c.second) * (w * w)));
        child.joint = {{none<S>(), parent.to_world(first)}};
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
