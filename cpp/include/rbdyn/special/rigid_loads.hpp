// What acts on a rigid body, and what its joint must exert.
//
// Reactions of ideal joints (7.57, 7.60): Phi = m a_G - F, and about the point o that the joint holds
//     M = I_G omega' + omega x I_G omega + (G - o) x m a_G - M_o, M_o the moment of what acts on it about o.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <variant>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/model/body_report.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/special/rigid_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A load on a rigid body at a point of it, in the frame (rigid_state.hpp).
struct RigidLoad {
    Load load;
    Vector3Of<DoubleDouble> point;
    int index = -1;  // among the loads of the scene
};

/// Adds what a load exerts.
template <class S>
void add_load(Wrench<S>& w, const RigidLaw& law, const RigidState<S>& s, const RigidLoad& load, const S& t,
              const std::string& name) {
    const Vector3Of<S> point = RigidLaw::constant<S>(load.point);
    const Matrix3Of<DoubleDouble>& frame = law.exact.frame;
    const auto turned = [](const auto& m, const Vector3Of<S>& v) { return RigidLaw::turned<S>(m, v); };
    if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load)) {
        w.moment[2] -=
            spring->stiffness.in<S>() * (s.coordinate - spring->rest_angle.in<S>()) + spring->damping.in<S>() * s.rate;
        return;
    }
    if (const Torque* torque = std::get_if<Torque>(&load.load)) {
        const bool in_body = torque->frame() == Frame::body;
        RotationOf<S> r{};
        Vector3Of<S> omega = s.omega;
        if (!torque->is_constant()) {
            const Vector3Of<S>* e[3] = {&s.axes.e1, &s.axes.e2, &s.axes.e3};
            for (std::size_t i = 0; i < 3; ++i) {
                const auto k = static_cast<Eigen::Index>(i);
                const Vector3Of<S> row = turned(frame, Vector3Of<S>((*e[0])[k], (*e[1])[k], (*e[2])[k]));
                for (std::size_t j = 0; j < 3; ++j) r[i][j] = row[static_cast<Eigen::Index>(j)];
            }
            omega = in_body ? turned(frame, s.omega) : s.to_world(s.omega);
        }
        const Vector3Of<S> m = (*torque)(t, r, omega);
        w.moment += in_body ? turned(frame.transpose(), m) : s.to_frame(m);
        return;
    }
    const Vector3Of<S> place = s.position(point), velocity = s.velocity(point);
    if (const Drag* drag = std::get_if<Drag>(&load.load)) {
        S factor = drag->linear.in<S>();
        if (!drag->quadratic.is_zero()) factor += drag->quadratic.in<S>() * length(velocity, "speed of " + name);
        w.add(s, Vector3Of<S>(-(velocity * factor)), point);
        return;
    }
    Vector3Of<S> f = force_of<S>(load.load, t, place, velocity);
    if (const Force* force = std::get_if<Force>(&load.load); force != nullptr && force->frame() == Frame::body)
        f = s.to_world(turned(frame.transpose(), f));
    w.add(s, f, point);
}

/// How G moves, in the frame: (m a_G, I_G alpha + omega x I_G omega). `rates`: as RigidLaw::accelerations() gives them.
template <class S>
std::pair<Vector3Of<S>, Vector3Of<S>> momentum_rates(const RigidLaw& law, const RigidState<S>& s,
                                                     const std::pair<Vector3Of<S>, Vector3Of<S>>& rates) {
    const Vector3Of<S> c = RigidLaw::constant<S>(law.exact.center);
    const auto inertia = [&](const Vector3Of<S>& a) { return curves::turned<S>(law.inertia, a); };
    const Vector3Of<S> a =
        cross<S>(rates.first, c) + cross<S>(s.omega, cross<S>(s.omega, c)) + s.to_frame(rates.second);
    return {Vector3Of<S>(a * S(law.mass)), Vector3Of<S>(inertia(rates.first) + cross<S>(s.omega, inertia(s.omega)))};
}

/// The torque about o of a hinge or a slide on its body, in the frame: of 7.48 about o, what loads leave. About the
/// axis of a hinge it is none.
template <class S>
Vector3Of<S> torque_of_joint(const RigidLaw& law, const RigidState<S>& s, const Wrench<S>& w,
                             const std::pair<Vector3Of<S>, Vector3Of<S>>& rates) {
    const auto [moved, spun] = momentum_rates<S>(law, s, rates);
    Vector3Of<S> torque = spun + cross<S>(RigidLaw::constant<S>(law.exact.center), moved) - w.moment;
    if (law.kind == RigidLaw::Kind::revolute) torque[2] = S(0.0);
    return torque;
}

/// The sizes of what that is a difference of, component by component, for about the axis of a hinge terms may be large.
double effort_of_torque(const RigidLaw& law, const RigidState<double>& s, const Wrench<double>& w,
                        const std::pair<Vector3, Vector3>& rates);

/// The report of a body at coordinates q, and what the law makes of the wrench.
RigidReport rigid_report(const RigidLaw& law, const RigidState<double>& s, const Wrench<double>& w, const double* q);
/// The same from the rates of the velocities.
RigidReport rigid_report_of_rates(const RigidLaw& law, const RigidState<double>& s, const Wrench<double>& w,
                                  const double* v_rate);

}  // namespace rbdyn::inline RBDYN_FORM
