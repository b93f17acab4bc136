// Definitions of rbdyn/closed_form/free_rotation.hpp.
#pragma once

#include "rbdyn/closed_form/free_rotation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/closed_form/carlson.hpp"
#include "rbdyn/closed_form/phase.hpp"
#include "rbdyn/closed_form/polhode.hpp"
#include "rbdyn/closed_form/theta_series.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE FreeRotation::FreeRotation(const PrincipalAxesOf<DoubleDouble>& principal,
                                        const QuaternionOf<DoubleDouble>& attitude,
                                        const Vector3Of<DoubleDouble>& angular_velocity) {
    const QuaternionOf<DoubleDouble> start = normalized(attitude);
    start_ = {rounded(start), rounded(angular_velocity)};
    speed_ = start_.angular_velocity.norm();
    const Vector3Of<DoubleDouble>& moments = principal.moments;
    Vector3Of<DoubleDouble> omega = product(principal.axes.transpose(), angular_velocity);
    bool along_axes = true;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            along_axes = along_axes && principal.axes(i, j) == DoubleDouble(std::round(principal.axes(i, j).hi));
    // what turning to principal axes leaves of nothing is nothing: a permanent rotation stays one
    for (int i = 0; i < 3; ++i)
        if (!along_axes && std::abs(omega[i].hi) < 0x1p-98 * speed_) omega[i] = 0.0;
    if (Polhode::constant(moments, omega)) {
        set_constant(omega, principal.axes, start);
        return;
    }
    const Polhode polhode(moments, omega);
    set_varying(polhode, principal.axes, start);
    set_doubt(polhode, omega, along_axes);
}

RBDYN_INLINE FreeRotation::FreeRotation(const Matrix3Of<DoubleDouble>& inertia, const Quaternion& attitude,
                                        const Vector3& angular_velocity)
    : FreeRotation(principal_axes(inertia), widened(attitude), widened(angular_velocity)) {}

RBDYN_INLINE FreeRotation::State FreeRotation::at(Instant t) const {
    if (t.hi == 0.0 && t.lo == 0.0) return start_;
    if (form_ == Form::constant) {
        const SineCosine<double> half = sine_cosine_in<double>(turn_.at(t).rest);
        const Vector3 v = half.sine * axis_;
        return {frame_.times({half.cosine, v[0], v[1], v[2]}), start_.angular_velocity};
    }
    const Core<double> now = core(now_, t);
    return {frame_.times(now.attitude) * from_body_, axes_ * now.omega};
}

RBDYN_INLINE double FreeRotation::error(double t) const {
    // what rounding leaves at any time, and a few roundings of each rate to 32 digits
    constexpr double floor = 5e-16, digits = 0x1p-103;
    const double rates = std::abs(turn_.rate().hi) + std::abs(argument_.rate().hi) + speed_;
    double error = floor + digits * (1.0 + conditioning_) * rates * std::abs(t);
    if (defect_ > 0.0) {
        // a flip too late or too early shows while it lasts, 2 exp(-|y|)
        const Phase::Reduced y = argument_.at({t, 0.0});
        const double late = defect_ * (1.0 + std::abs(y.steps.hi));
        const double shown = 2.0 * late * std::exp(std::min(late - std::abs(y.rest.hi), 0.0));
        // early on no more than the first roundings have grown to
        error += std::min(shown, 0x1p-100 * std::exp(argument_.rate().hi * std::abs(t)));
    }
    return std::min(error, std::numbers::pi);
}

RBDYN_INLINE Quaternion FreeRotation::Frame::times(const Quaternion& q) const {
    const Quaternion a = hi * q, b = lo * q;
    return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
}

RBDYN_INLINE FreeRotation::Frame FreeRotation::frame(const QuaternionOf<DoubleDouble>& q) {
    return {{q.w.hi, q.x.hi, q.y.hi, q.z.hi}, {q.w.lo, q.x.lo, q.y.lo, q.z.lo}};
}

RBDYN_INLINE void FreeRotation::set_constant(const Vector3Of<DoubleDouble>& omega, const Matrix3Of<DoubleDouble>& axes,
                                             const QuaternionOf<DoubleDouble>& start) {
    form_ = Form::constant;
    const DoubleDouble size = sqrt(dot<DoubleDouble>(omega, omega));
    regime_ = size.hi == 0.0 ? Regime::rest : Regime::permanent;
    turn_ = Phase(0.5 * size, 0.0, 2.0 * double_double::pi);
    if (size.hi > 0.0) axis_ = rounded(scaled(product(axes, omega), 1.0 / size));
    frame_ = frame(start);
    precession_ = size.hi;
}

RBDYN_INLINE void FreeRotation::set_varying(const Polhode& p, const Matrix3Of<DoubleDouble>& principal,
                                            const QuaternionOf<DoubleDouble>& start) {
    sign_ = p.sign;
    const DoubleDouble sine = p.momentum1 / p.momentum, cosine = p.momentum3 / p.momentum;  // of the least tilt
    Constants<DoubleDouble> exact;
    exact.omega = {p.alpha, sign_ * p.beta, p.gamma};
    exact.momentum = {sine, sign_ * p.i2 * p.beta / p.momentum, cosine};
    now_.omega = rounded(exact.omega);
    now_.momentum = rounded(exact.momentum);

    // K' - b and b are inverses of Jacobi's functions: sn(K' - b, 1-m) = cosine, cn = sine
    const DoubleDouble pi = double_double::pi, sine2 = sine * sine, mixed = sine2 + cosine * cosine * p.m;
    const DoubleDouble half_rate = 0.5 * (p.energy2 + p.momentum * p.gamma) / (p.momentum + p.momentum3);
    DoubleDouble half_mean;  // of psi' over a period
    if (p.m.hi <= 0.5) {
        form_ = Form::circular;
        const DoubleDouble scale = 0.5 * pi / p.quarter;
        const DoubleDouble nome = p.m.hi > 0.0 ? exp(-2.0 * scale * p.quarter1) : DoubleDouble(0.0);
        const DoubleDouble outer_nome = exp(-2.0 * scale * cosine * elliptic::carlson_f(sine2, mixed, 1.0));
        exact.circular = circular_series(nome, outer_nome);
        now_.circular = rbdyn::rounded(exact.circular);
        argument_ = Phase(p.mu * scale, p.u0 * scale, 2.0 * pi);
        half_mean = half_rate + sign_ * exact.circular.phase_slope() * argument_.rate();
        turn_ = Phase(half_mean, 0.0, 2.0 * pi);
    } else {
        form_ = Form::hyperbolic;
        const DoubleDouble scale = 0.5 * pi / p.quarter1;
        const DoubleDouble eta = scale * sine * elliptic::carlson_f(cosine * cosine * p.m, p.m, mixed);
        const bool returns = p.m1.hi > 0.0;
        const DoubleDouble step = returns ? 2.0 * scale * p.quarter : std::numeric_limits<double>::infinity();
        exact.hyperbolic = hyperbolic_series(returns ? exp(-0.5 * step) : DoubleDouble(0.0), eta);
        now_.hyperbolic = rbdyn::rounded(exact.hyperbolic);
        argument_ = Phase(p.mu * scale, p.u0 * scale, step);
        const DoubleDouble rate = half_rate + sign_ * exact.hyperbolic.phase_slope() * argument_.rate();
        turn_ = Phase(rate, 0.0, 2.0 * pi);
        jump_ = -sign_ * eta;
        half_mean = rate + 0.5 * jump_ * p.mu / p.quarter;
    }

    Matrix3Of<DoubleDouble> axes;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vector3Of<DoubleDouble>& e = principal.col(p.axis[i]);
        axes.col(static_cast<int>(i)) = p.reversed[i] ? -e : e;
    }
    axes_ = rounded(axes);
    const QuaternionOf<DoubleDouble> from_body = conjugate(rbdyn::quaternion(axes));
    from_body_ = rounded(from_body);
    frame_ = frame(normalized(start * conjugate(core(exact, {}).attitude * from_body)));

    regime_ = p.m1.hi == 0.0 ? Regime::separatrix : p.m.hi == 0.0 ? Regime::symmetric : Regime::generic;
    const double quarters = p.mu.hi / p.quarter.hi;
    period_ = 4.0 / quarters;
    // K goes once round axis 3 in a period, backwards where that has the largest moment
    proper_ = -sign_ * 0.5 * std::numbers::pi * quarters;
    precession_ = 2.0 * half_mean.hi - proper_;
    tilt_ = {std::atan2(sine.hi, cosine.hi),
             std::atan2(std::abs(exact.momentum[1].hi), cosine.hi * std::sqrt(p.m1.hi))};
}

RBDYN_INLINE void FreeRotation::set_doubt(const Polhode& p, const Vector3Of<DoubleDouble>& omega, bool along_axes) {
    const double largest = std::max(p.i1.hi, p.i3.hi);
    if (!along_axes) conditioning_ = largest / std::min(p.i1.hi, p.i3.hi);
    if (form_ != Form::hyperbolic || p.difference == 0.0) return;
    double terms = 0.0;
    for (const auto& [moment, axis] : {std::pair(p.i1.hi, p.axis[0]), {p.i3.hi, p.axis[2]}}) {
        const double w = std::abs(omega[axis].hi);
        terms += moment * w * (along_axes ? std::abs(moment - p.i2.hi) * w : 3.0 * largest * speed_);
    }
    defect_ = 0x1p-105 * terms / p.difference;
}

}  // namespace rbdyn::inline RBDYN_FORM
