// A heavy rigid body with a fixed point in Euler angles, as the chapter writes it (7.50-7.52, 7.58, corrected): for
// teaching, beside the quaternions that everything else is computed with.
//
//     A (theta'', psi'', phi'') = b,  M = (G - Q) x m g,  x = (theta, psi, phi, theta', psi', phi')
//
// A is singular at theta = 0 and pi, where the angles fail and the motion does not: a run ends where |sin theta| falls
// to `least`, stopped by the event "sin theta too small for Euler angles".
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/rotation/euler_angles.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A model for simulate(model, state, options).
class EulerTop {
public:
    /// Of |sin theta| where a run ends: the rates grow as its inverse, and three digits are lost there.
    static constexpr double default_least = 1e-3;

    /// A body in principal axes at the point that is held, `point` in body axes [m], under gravity along -z [m/s^2].
    /// Throws InvalidInput for other axes, in which the chapter does not write its equations.
    EulerTop(const RigidBody& body, double gravity, const Vector3& point = Vector3::Zero(),
             double least = default_least);

    int variables() const { return 6; }
    int positions() const { return 0; }

    template <class S>
    void operator()(const S& /*t*/, std::span<const S> x, std::span<S> rate) const {
        using std::sin, std::cos;
        const EulerAnglesOf<S> angles{x[0], x[1], x[2]};
        const Vector3Of<S> rates{x[3], x[4], x[5]};
        // the upward vertical in body axes (7.59), and (G - Q) x m g = m g u x (G - Q)
        const S s = sin(angles.theta);
        const Vector3Of<S> up{sin(angles.phi) * s, cos(angles.phi) * s, cos(angles.theta)};
        const Vector3Of<S> torque =
            cross<S>(up, Vector3Of<S>(S(weight_ * arm_[0]), S(weight_ * arm_[1]), S(weight_ * arm_[2])));
        const Vector3Of<S> second = euler_inverse(angles, euler_right_side(angles, rates, moments_, torque));
        for (int i = 0; i < 3; ++i) {
            rate[static_cast<std::size_t>(i)] = rates[i];
            rate[static_cast<std::size_t>(3 + i)] = second[i];
        }
    }

    template <class S>
    std::vector<std::pair<std::string, S>> limits(const S& /*t*/, std::span<const S> x) const {
        using std::sin;
        const S s = sin(x[0]);
        return {{"sin theta too small for Euler angles", s * s - S(least_ * least_)}};
    }

    /// Throws InvalidInput for a start where the angles fail.
    void require_start(std::span<const double> x) const;

    /// The state of an attitude and an angular velocity in body axes [rad/s].
    static std::vector<double> state(const EulerAngles& angles, const Vector3& omega);

private:
    double weight_;
    Vector3 arm_, moments_;
    double least_;
};

}  // namespace rbdyn::inline RBDYN_FORM
