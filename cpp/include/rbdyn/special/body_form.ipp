// Definitions of rbdyn/special/body_form.hpp.
#pragma once

#include "rbdyn/special/body_form.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/closed_form/free_rotation.hpp"
#include "rbdyn/closed_form/lagrange_top.hpp"
#include "rbdyn/closed_form/linear_oscillator.hpp"
#include "rbdyn/closed_form/pendulum.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/euler_turns.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::optional<Recurrence> BodyForm::recurrence() const { return std::nullopt; }

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::closed_forms {

RBDYN_INLINE Accelerated::Accelerated(const Vector3Of<DoubleDouble>& x, const Vector3Of<DoubleDouble>& v,
                                      const Vector3Of<DoubleDouble>& a)
    : x_(x), v_(v), a_(a) {}

RBDYN_INLINE void Accelerated::state(Instant since, double* x, double* v, int count) const {
    const DoubleDouble t(since);
    for (int i = 0; i < count; ++i) {
        x[i] = double(x_[i] + t * (v_[i] + t * a_[i] * DoubleDouble(0.5)));
        v[i] = double(v_[i] + t * a_[i]);
    }
}

RBDYN_INLINE void TurningFrame::set(const Quaternion& of_body, const Vector3& omega, Instant since, double* q,
                                    double* v) const {
    Quaternion p = of_body * attitude;
    Vector3 w = axes.transpose() * omega;
    if (follows_axis) {
        // spin = w3 t, within two turns, where it keeps its digits
        const DoubleDouble spin = DoubleDouble(w[2]) * DoubleDouble(since);
        const double turns = std::round(spin.hi / (4.0 * std::numbers::pi));
        const double half = 0.5 * double(spin - DoubleDouble(4.0 * turns) * double_double::pi);
        const double c = std::cos(half), s = std::sin(half);
        p = p * Quaternion{c, 0.0, 0.0, -s};
        w = Vector3((2.0 * c * c - 1.0) * w[0] - 2.0 * s * c * w[1], 2.0 * s * c * w[0] + (2.0 * c * c - 1.0) * w[1],
                    w[2]);
        q[4] = 2.0 * half;
    }
    q[0] = p.w;
    q[1] = p.x;
    q[2] = p.y;
    q[3] = p.z;
    for (int i = 0; i < 3; ++i) v[i] = w[i];
}

RBDYN_INLINE FreeForm::FreeForm(const Scene::Body& b, const TurningFrame& frame,
                                const PrincipalAxesOf<DoubleDouble>& principal,
                                const std::optional<Accelerated>& center)
    : frame_(frame), center_(center), rotation_(principal, b.attitude.exact(), b.angular_velocity) {
    Vector3Of<DoubleDouble> k = product(principal.axes.transpose(), b.angular_velocity);
    for (int i = 0; i < 3; ++i) k[i] = principal.moments[i] * k[i];
    momentum_ = rounded(product(rotation_matrix(b.attitude.exact()), product(principal.axes, k)));
}

RBDYN_INLINE void FreeForm::state(Instant since, double* q, double* v) const {
    if (center_) {
        center_->state(since, q, v);
        q += 3;
        v += 3;
    }
    const FreeRotation::State s = rotation_.at(since);
    frame_.set(s.attitude, s.angular_velocity, since, q, v);
}

RBDYN_INLINE double FreeForm::error(double since) const { return rotation_.error(since); }

RBDYN_INLINE std::optional<Recurrence> FreeForm::recurrence() const {
    if (rotation_.regime() == FreeRotation::Regime::permanent)
        return Recurrence{momentum_, 1.0 / rotation_.precession_rate()};
    // a body of revolution keeps its axis at one angle from K: any time is a period
    if (frame_.follows_axis && frame_.is_on_axis())
        return Recurrence{momentum_, 1.0 / rotation_.at(0.0).angular_velocity.norm()};
    return Recurrence{momentum_, rotation_.period()};
}

RBDYN_INLINE std::string FreeForm::name() const { return "free rotation"; }

RBDYN_INLINE void TopForm::state(Instant since, double* q, double* v) const {
    const LagrangeTop::State s = top_.at(since);
    // the top's axes are those of the law at the start, and turn with the body
    frame_.set(s.attitude * conjugate(frame_.attitude), frame_.axes * s.angular_velocity, since, q, v);
}

RBDYN_INLINE double TopForm::error(double since) const { return top_.error(since); }

RBDYN_INLINE std::optional<Recurrence> TopForm::recurrence() const {
    if (!frame_.is_on_axis()) return std::nullopt;
    if (top_.nutation_period() > 0.0) return Recurrence{up_, top_.nutation_period()};
    const LagrangeTop::State s = top_.at({});
    Vector3 momentum = s.angular_velocity;
    for (int i = 0; i < 3; ++i) momentum[i] *= moments_[i];
    return Recurrence{to_world<double>(s.attitude, momentum), 1.0 / s.angular_velocity.norm()};
}

RBDYN_INLINE std::string TopForm::name() const { return "Lagrange's top"; }

RBDYN_INLINE PendulumForm::PendulumForm(const DoubleDouble& square, const DoubleDouble& lowest, double angle,
                                        double rate)
    : lowest_(lowest), pendulum_(square, DoubleDouble(angle) - lowest, rate), start_{angle, rate} {}

RBDYN_INLINE void PendulumForm::state(Instant since, double* q, double* v) const {
    if (since.hi == 0.0 && since.lo == 0.0) {
        *q = start_.angle;
        *v = start_.rate;
        return;
    }
    const Pendulum::State s = pendulum_.at(since);
    *q = double(DoubleDouble(s.angle) + lowest_);
    *v = s.rate;
}

RBDYN_INLINE double PendulumForm::error(double since) const {
    // an angle of many turns is rounded as a whole
    const double angle = pendulum_.at({since, 0.0}).angle;
    return pendulum_.error(since) + 0.5 * std::numeric_limits<double>::epsilon() * std::abs(angle);
}

RBDYN_INLINE std::string PendulumForm::name() const { return "compound pendulum"; }

RBDYN_INLINE OscillatorForm::OscillatorForm(const LinearOscillator::Coefficients& c, double rest, double angle,
                                            double rate)
    : rest_(rest), oscillator_(c, DoubleDouble(angle) - rest, rate), start_{angle, rate} {}

RBDYN_INLINE void OscillatorForm::state(Instant since, double* q, double* v) const {
    const bool at_start = since.hi == 0.0 && since.lo == 0.0;
    const LinearOscillator::State s = at_start ? start_ : oscillator_.at(since);
    *q = at_start ? s.position : s.position + rest_;
    *v = s.velocity;
}

RBDYN_INLINE double OscillatorForm::error(double since) const {
    const double angle = oscillator_.at({since, 0.0}).position + rest_;
    return oscillator_.error(since) + 0.5 * std::numeric_limits<double>::epsilon() * std::abs(angle);
}

RBDYN_INLINE std::string OscillatorForm::name() const { return "torsion pendulum"; }

RBDYN_INLINE void SlidingForm::state(Instant since, double* q, double* v) const { motion_.state(since, q, v, count_); }

RBDYN_INLINE double SlidingForm::error(double) const { return 2.0 * std::numeric_limits<double>::epsilon(); }

RBDYN_INLINE std::string SlidingForm::name() const { return "uniform acceleration"; }

}  // namespace rbdyn::inline RBDYN_FORM::closed_forms
