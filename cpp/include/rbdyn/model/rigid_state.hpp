// Where a rigid body is and how it moves, in numbers of any type.
//
// Notation: o the body's point the equations are about (the centre of mass G of a free body, else the point its joint
// holds), e1 e2 e3 the axes of the frame they are written in, omega the body's angular velocity, Omega the frame's.
// The frame is fixed in the body, Omega = omega; or, for a symmetric body, it follows the body's axis e3 and does not
// turn about it, Omega = omega - (omega.e3) e3, and the body's own axes are turned about e3 by `spin` from it.
// Conventions: r, v and the axes are seen from the world; omega, Omega and points are in components of the frame, a
// point from o.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class S>
struct RigidState {
    Vector3Of<S> r, v;         // of o
    QuaternionOf<S> attitude;  // of the frame of a body that turns freely
    AxesOf<S> axes;
    Vector3Of<S> omega, turning;
    S spin = 0.0;
    S coordinate = 0.0, rate = 0.0;  // of a joint with one coordinate

    Vector3Of<S> to_world(const Vector3Of<S>& a) const { return axes.e1 * a[0] + axes.e2 * a[1] + axes.e3 * a[2]; }
    Vector3Of<S> to_frame(const Vector3Of<S>& a) const {
        return Vector3Of<S>(dot<S>(axes.e1, a), dot<S>(axes.e2, a), dot<S>(axes.e3, a));
    }

    /// A point of the body, and its velocity v + omega x c.
    Vector3Of<S> position(const Vector3Of<S>& c) const { return r + to_world(c); }
    Vector3Of<S> velocity(const Vector3Of<S>& c) const { return v + to_world(cross<S>(omega, c)); }
};

/// Forces on a body, taken at o: the resultant, world axes, and the moment about o, in the frame.
template <class S>
struct Wrench {
    Vector3Of<S> force{S(0.0), S(0.0), S(0.0)};
    Vector3Of<S> moment{S(0.0), S(0.0), S(0.0)};

    /// A force, world axes, at a point of the body.
    void add(const RigidState<S>& state, const Vector3Of<S>& f, const Vector3Of<S>& point) {
        force += f;
        moment += cross<S>(point, state.to_frame(f));
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
