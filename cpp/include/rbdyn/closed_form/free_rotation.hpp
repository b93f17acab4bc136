// The rotation of a rigid body free of torque, in closed form: exact at every time, whatever the time.
//
// Euler's equations I omega' = (I omega) x omega with the Poisson equation q' = 1/2 q (0, omega) (7.47, 7.48, 7.54):
// spheres, bodies of revolution (7.56), three different moments, on the separatrix and however near to it.
//
// Angular velocity in principal axes: polhode.hpp, whose notation holds here. Attitude from those to axes whose third
// is K: the smallest turn that takes K to the third axis, by less than 180 degrees since K circles axis 3, then the
// turn by psi,
//   psi' = (2E + |K| omega_3)/(|K| + I3 omega_3),  psi = Lambda t - 2 s arg f(u),
// f a theta function of complex argument (theta_series.hpp), Lambda from psi' at u = 0, where omega_3 = gamma.
// All constants and the phases are numbers of 32 digits; the series at a time are doubles.
//
// Source: Jacobi, "Sur la rotation d'un corps", 1849; Whittaker, Analytical Dynamics, 69; R. van Zon and J. Schofield,
// "Numerical implementation of the exact dynamics of free rigid bodies", J. Comput. Phys. 225 (2007).
// Accuracy: omega relative to its largest size, and the angle between attitudes, within 2e-15 of the motion of the
// exact doubles given, for 1e6 s and beyond; see error(). Components of omega below 1e-140 of the largest, whose
// squares leave the range of doubles, are lost.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/closed_form/phase.hpp"
#include "rbdyn/closed_form/polhode.hpp"
#include "rbdyn/closed_form/theta_series.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn {

class FreeRotation {
public:
    enum class Regime {
        rest,        // omega = 0
        permanent,   // omega along a principal axis, for ever (Def. 7.3); every motion of a sphere
        symmetric,   // two equal moments: regular precession (7.56)
        separatrix,  // towards the intermediate axis, and away from it, once
        generic      // periodic omega
    };

    struct State {
        Quaternion attitude;       // body to world
        Vector3 angular_velocity;  // body axes [rad/s]
    };

    /// From the moments and axes of inertia about G, the attitude (made a unit quaternion) and the angular velocity in
    /// body axes [rad/s] at t = 0. The moments are positive.
    [[gnu::cold]] FreeRotation(const PrincipalAxesOf<DoubleDouble>& principal,
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
    FreeRotation(const Matrix3Of<DoubleDouble>& inertia, const Quaternion& attitude, const Vector3& angular_velocity)
        : FreeRotation(principal_axes(inertia), widened(attitude), widened(angular_velocity)) {}

    /// At t seconds from the start, before it too; at 0 the start itself.
    State at(Instant t) const {
        if (t.hi == 0.0 && t.lo == 0.0) return start_;
        if (form_ == Form::constant) {
            const SineCosine<double> half = sine_cosine_in<double>(turn_.at(t).rest);
            const Vector3 v = half.sine * axis_;
            return {frame_.times({half.cosine, v[0], v[1], v[2]}), start_.angular_velocity};
        }
        const Core<double> now = core(now_, t);
        return {frame_.times(now.attitude) * from_body_, axes_ * now.omega};
    }
    State at(double t) const { return at(Instant{t, 0.0}); }

    /// Estimate of the error at t: of omega over its size, and of the attitude [rad].
    double error(double t) const {
        // what rounding leaves at any time, and a few roundings of each rate to 32 digits
        constexpr double floor = 5e-16, digits = 0x1p-103;
        const double rates = std::abs(turn_.rate().hi) + std::abs(argument_.rate().hi) + speed_;
        double error = floor + digits * (1.0 + conditioning_) * rates * std::abs(t);
        if (defect_ > 0.0) {
            // a flip too late or too early shows while it lasts, 2 exp(-|y|)
            const Phase::Reduced y = argument_.at({t, 0.0});
            const double late = defect_ * (1.0 + std::abs(y.steps));
            const double shown = 2.0 * late * std::exp(std::min(late - std::abs(y.rest.hi), 0.0));
            // early on no more than the first roundings have grown to
            error += std::min(shown, 0x1p-100 * std::exp(argument_.rate().hi * std::abs(t)));
        }
        return std::min(error, std::numbers::pi);
    }

    Regime regime() const { return regime_; }
    /// Of omega in body axes [s]; infinite where it is constant, and on the separatrix.
    double period() const { return period_; }
    /// Mean rate at which the axis that K circles goes round K in the world [rad/s]; |omega| where omega is constant,
    /// and the rate at late times on the separatrix.
    double precession_rate() const { return precession_; }
    /// Mean rate at which the body turns about that axis [rad/s], positive in the sense of K; zero where omega is
    /// constant, and on the separatrix.
    double proper_rotation_rate() const { return proper_; }
    /// Least and largest angle between that axis and K [rad].
    std::pair<double, double> tilt() const { return tilt_; }

private:
    enum class Form { constant, circular, hyperbolic };

    /// Angular velocity in principal axes, and the attitude from them to axes whose third is K.
    template <class S>
    struct Core {
        Vector3Of<S> omega;
        QuaternionOf<S> attitude;
    };

    /// What a time needs beside the phases.
    template <class S>
    struct Constants {
        CircularSeries<S> circular;
        HyperbolicSeries<S> hyperbolic;
        Vector3Of<S> omega, momentum;  // amplitudes, those of I omega over |K|
    };

    /// A quaternion of 32 digits times a double one.
    struct Frame {
        Quaternion hi, lo;
        Quaternion times(const Quaternion& q) const {
            const Quaternion a = hi * q, b = lo * q;
            return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
        }
    };

    static Frame frame(const QuaternionOf<DoubleDouble>& q) {
        return {{q.w.hi, q.x.hi, q.y.hi, q.z.hi}, {q.w.lo, q.x.lo, q.y.lo, q.z.lo}};
    }

    [[gnu::cold]] void set_constant(const Vector3Of<DoubleDouble>& omega, const Matrix3Of<DoubleDouble>& axes,
                                    const QuaternionOf<DoubleDouble>& start) {
        form_ = Form::constant;
        const DoubleDouble size = sqrt(dot<DoubleDouble>(omega, omega));
        regime_ = size.hi == 0.0 ? Regime::rest : Regime::permanent;
        turn_ = Phase(0.5 * size, 0.0, 2.0 * double_double::pi);
        if (size.hi > 0.0) axis_ = rounded(scaled(product(axes, omega), 1.0 / size));
        frame_ = frame(start);
        precession_ = size.hi;
    }

    [[gnu::cold]] void set_varying(const Polhode& p, const Matrix3Of<DoubleDouble>& principal,
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

    /// Near the separatrix 1 - m, a difference known to 32 digits of its terms, sets the time of each flip. Turning to
    /// principal axes leaves roundings of the largest moment in all of them, which shift small components of omega.
    [[gnu::cold]] void set_doubt(const Polhode& p, const Vector3Of<DoubleDouble>& omega, bool along_axes) {
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

    template <class S>
    Core<S> core(const Constants<S>& constants, Instant t) const {
        const Phase::Reduced u = argument_.at(t);
        JacobiValues<S> f;
        DoubleDouble psi;
        if (form_ == Form::circular) {
            f = constants.circular.at(sine_cosine_in<S>(u.rest));
            psi = turn_.at(t).rest;
        } else {
            const bool before = u.rest.hi < 0.0;
            f = constants.hyperbolic.at(exp_in<S>(before ? u.rest : -u.rest));
            if (before) {
                f.sn = -f.sn;
                f.im = -f.im;
            }
            if (const double half_steps = 0.5 * u.steps; half_steps != std::floor(half_steps)) {
                f.sn = -f.sn;
                f.cn = -f.cn;
            }
            psi = turn_.at(t, jump_ * u.steps).rest;
        }
        using std::sqrt;
        Core<S> result;
        result.omega = {constants.omega[0] * f.cn, constants.omega[1] * f.sn, constants.omega[2] * f.dn};
        // the smallest turn of K to the third axis, then that by psi
        const S x = constants.momentum[1] * f.sn, y = -(constants.momentum[0] * f.cn);
        const S w = constants.momentum[2] * f.dn + 1.0;
        const SineCosine<S> half = sine_cosine_in<S>(psi);
        const S im = -(f.im * sign_);
        const S size = 1.0 / sqrt((f.re * f.re + f.im * f.im) * (w * w + x * x + y * y));
        const S c = (half.cosine * f.re - half.sine * im) * size, s = (half.sine * f.re + half.cosine * im) * size;
        result.attitude = {c * w, c * x - s * y, c * y + s * x, s * w};
        return result;
    }

    Form form_ = Form::constant;
    Regime regime_ = Regime::generic;
    State start_;
    Phase argument_, turn_;  // z or y of theta_series.hpp, and half of psi but for its periodic part
    DoubleDouble jump_;      // of half of psi from one flip to the next
    double sign_ = 1.0;
    Constants<double> now_;
    Frame frame_;           // from K's axes, or the body's at the start, to the world
    Quaternion from_body_;  // from body to principal axes
    Matrix3 axes_ = Matrix3::Identity();
    Vector3 axis_ = Vector3::Zero();
    double speed_ = 0.0;
    double conditioning_ = 0.0, defect_ = 0.0;  // of the moments, and of u at each flip, for error()
    double period_ = std::numeric_limits<double>::infinity(), precession_ = 0.0, proper_ = 0.0;
    std::pair<double, double> tilt_{0.0, 0.0};
};

}  // namespace rbdyn
