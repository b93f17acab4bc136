// The rotation of a rigid body free of torque, in closed form: exact at every time, whatever the time.
//
// Euler's equations I omega' = (I omega) x omega with the Poisson equation q' = 1/2 q (0, omega) (7.47, 7.48, 7.54):
// spheres, bodies of revolution (7.56), three different moments, on the separatrix and however near to it.
//
// Notation, in principal axes so ordered that K circles axis 3, the intermediate moment is I2, and omega_3 > 0 > or =
// by the choice of directions; s = sign(I3 - I2); E and K the energy and the angular momentum:
//   omega = (alpha cn u, s beta sn u, gamma dn u),  u = mu t + u0,  parameter m,
//   m/(1-m) and the amplitudes from sums without cancellation; only D = I1 (I1-I2) w1^2 + I3 (I3-I2) w3^2 (up to its
//   sign I2 (2E) - K^2), whose zero is the separatrix, has one, and 1 - m follows from D, never from m.
// Attitude from principal axes to axes whose third is K:
//   the smallest turn that takes K to the third axis (never by more than 90 degrees), then the turn by psi,
//   psi' = (2E + |K| omega_3)/(|K| + I3 omega_3),  psi = Lambda t - 2 s arg f(u),
//   f a theta function of complex argument (theta_series.hpp), Lambda from psi' at u = 0.
// All constants and the phases are numbers of 32 digits, the series at a time are doubles.
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
#include "rbdyn/closed_form/carlson.hpp"
#include "rbdyn/closed_form/phase.hpp"
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
    FreeRotation(const PrincipalAxesOf<DoubleDouble>& principal, const Quaternion& attitude,
                 const Vector3& angular_velocity) {
        const auto& q = attitude;
        const QuaternionOf<DoubleDouble> given{q.w, q.x, q.y, q.z};
        const QuaternionOf<DoubleDouble> start = unit(given);
        start_ = {rounded(start), angular_velocity};
        speed_ = angular_velocity.norm();
        const Vector3Of<DoubleDouble> omega = product(transposed(principal.axes), widened(angular_velocity));
        const Vector3Of<DoubleDouble>& moments = principal.moments;
        conditioning_ = rounded(principal.axes).cwiseAbs().maxCoeff() == 1.0 &&
                                rounded(principal.axes).cwiseAbs().sum() == 3.0
                            ? 0.0
                            : rounded(moments).maxCoeff() / rounded(moments).minCoeff();
        bool constant = true;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            if (omega[j].hi != 0.0 && omega[k].hi != 0.0 && moments[j] != moments[k]) constant = false;
        }
        if (constant)
            set_constant(omega, principal.axes, start);
        else
            set_varying(moments, omega, principal.axes, start);
    }
    FreeRotation(const Matrix3Of<DoubleDouble>& inertia, const Quaternion& attitude, const Vector3& angular_velocity)
        : FreeRotation(principal_axes(inertia), attitude, angular_velocity) {}

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
        // what rounding leaves at any time; then numbers of 32 digits: a few roundings of each rate
        constexpr double floor = 5e-16, digits = 0x1p-101;
        const double turns = std::abs(t) * (std::abs(turn_.rate().hi) + std::abs(argument_.rate().hi));
        double error = floor + digits * (1.0 + conditioning_) * (turns + speed_ * std::abs(t));
        // near the separatrix, 1 - m is a difference of what is known to 32 digits, and sets the time of each flip
        if (form_ == Form::hyperbolic && defect_ > 0.0) error += defect_ * (1.0 + std::abs(argument_.at({t, 0.0}).steps));
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
        elliptic::CircularSeries<S> circular;
        elliptic::HyperbolicSeries<S> hyperbolic;
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

    static Quaternion rounded(const QuaternionOf<DoubleDouble>& q) {
        return {static_cast<double>(q.w), static_cast<double>(q.x), static_cast<double>(q.y), static_cast<double>(q.z)};
    }
    static Vector3 rounded(const Vector3Of<DoubleDouble>& v) { return rbdyn::rounded(v); }
    static Matrix3 rounded(const Matrix3Of<DoubleDouble>& m) { return rbdyn::rounded(m); }
    static Frame frame(const QuaternionOf<DoubleDouble>& q) {
        return {{q.w.hi, q.x.hi, q.y.hi, q.z.hi}, {q.w.lo, q.x.lo, q.y.lo, q.z.lo}};
    }
    static QuaternionOf<DoubleDouble> unit(const QuaternionOf<DoubleDouble>& q) {
        const DoubleDouble n = sqrt(squared_norm(q));
        return {q.w / n, q.x / n, q.y / n, q.z / n};
    }
    static Matrix3Of<DoubleDouble> transposed(const Matrix3Of<DoubleDouble>& m) {
        Matrix3Of<DoubleDouble> result;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) result(i, j) = m(j, i);
        return result;
    }

    /// The attitude whose axes are the columns of a rotation matrix.
    static QuaternionOf<DoubleDouble> attitude_of(const Matrix3Of<DoubleDouble>& m) {
        // four times the product of a component with each, the largest component's row taken (Shepperd)
        const DoubleDouble trace = m(0, 0) + m(1, 1) + m(2, 2);
        int largest = 0;
        for (int i = 1; i < 3; ++i)
            if (m(i, i) > m(largest, largest)) largest = i;
        if (trace > m(largest, largest))
            return unit({1.0 + trace, m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)});
        const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
        std::array<DoubleDouble, 3> v;
        v[static_cast<std::size_t>(i)] = 1.0 + m(i, i) - m(j, j) - m(k, k);
        v[static_cast<std::size_t>(j)] = m(i, j) + m(j, i);
        v[static_cast<std::size_t>(k)] = m(i, k) + m(k, i);
        return unit({m(k, j) - m(j, k), v[0], v[1], v[2]});
    }

    void set_constant(const Vector3Of<DoubleDouble>& omega, const Matrix3Of<DoubleDouble>& axes,
                      const QuaternionOf<DoubleDouble>& start) {
        form_ = Form::constant;
        const DoubleDouble size = sqrt(dot<DoubleDouble>(omega, omega));
        regime_ = size.hi == 0.0 ? Regime::rest : Regime::permanent;
        turn_ = Phase(0.5 * size, 0.0, 2.0 * double_double::pi);
        if (size.hi > 0.0) axis_ = rounded(scaled(product(axes, omega), 1.0 / size));
        frame_ = frame(start);
        precession_ = size.hi;
    }

    void set_varying(const Vector3Of<DoubleDouble>& moments, const Vector3Of<DoubleDouble>& omega,
                     const Matrix3Of<DoubleDouble>& principal, const QuaternionOf<DoubleDouble>& start) {
        // from the least moment to the largest
        std::array<int, 3> order{0, 1, 2};
        std::sort(order.begin(), order.end(), [&](int i, int j) { return moments[i] < moments[j]; });
        const auto [a, b, c] = order;
        const auto square = [](const DoubleDouble& x) { return x * x; };
        const DoubleDouble by_a = moments[a] * (moments[b] - moments[a]) * square(omega[a]);
        const DoubleDouble by_c = moments[c] * (moments[c] - moments[b]) * square(omega[c]);
        const DoubleDouble difference = by_a - by_c;
        const bool about_least = difference.hi > 0.0;
        const int other = about_least ? c : a, circled = about_least ? a : c;

        // axes 1, 2, 3, so directed that omega_1 >= 0 and omega_3 > 0
        Matrix3Of<DoubleDouble> axes;
        Vector3Of<DoubleDouble> w;
        const bool back = omega[other].hi < 0.0, down = omega[circled].hi < 0.0;
        const bool odd = (b - other + 3) % 3 != 1;  // whether (other, b, circled) is left-handed
        const bool flip = (back != down) != odd;
        for (const auto& [to, from, minus] : {std::tuple(0, other, back), {1, b, flip}, {2, circled, down}}) {
            axes.col(to) = principal.col(from);
            w[to] = omega[from];
            if (!minus) continue;
            axes.col(to) = -axes.col(to);
            w[to] = -w[to];
        }
        const DoubleDouble &i1 = moments[other], &i2 = moments[b], &i3 = moments[circled];
        const DoubleDouble d32 = i3 - i2, d31 = i3 - i1, d21 = i2 - i1;
        const double sign = d32.hi > 0.0 ? 1.0 : -1.0;

        // amplitudes, from K^2 - 2E I3 and K^2 - 2E I1
        const DoubleDouble alpha2 = square(w[0]) + i2 * d32 / (i1 * d31) * square(w[1]);
        const DoubleDouble gamma2 = square(w[2]) + i2 * d21 / (i3 * d31) * square(w[1]);
        const DoubleDouble beta2 = alpha2 * (i1 * d31) / (i2 * d32);
        const DoubleDouble alpha = sqrt(alpha2), beta = sqrt(beta2), gamma = sqrt(gamma2);
        const DoubleDouble whole = gamma2 * i3 * d32;
        const DoubleDouble m = alpha2 * i1 * d21 / whole, m1 = abs(difference) / abs(whole);
        const DoubleDouble mu = gamma * sqrt(d31 * d32 / (i1 * i2));
        const DoubleDouble quarter = elliptic::carlson_f(0.0, m1, 1.0), quarter1 = elliptic::carlson_f(0.0, m, 1.0);
        const DoubleDouble cn = w[0] / alpha, dn = w[2] / gamma;
        const DoubleDouble u0 = sign * w[1] / beta * elliptic::carlson_f(cn * cn, dn * dn, 1.0);

        const DoubleDouble k1 = i1 * alpha, k3 = i3 * gamma, k = sqrt(k1 * k1 + k3 * k3);
        const DoubleDouble sine = k1 / k, cosine = k3 / k;  // of the least angle between axis 3 and K
        const DoubleDouble energy2 = i1 * square(w[0]) + i2 * square(w[1]) + i3 * square(w[2]);
        const DoubleDouble half_rate = 0.5 * (energy2 + k * gamma) / (k + k3);  // of psi at u = 0

        Constants<DoubleDouble> exact;
        exact.omega = {alpha, sign * beta, gamma};
        exact.momentum = {sine, sign * i2 * beta / k, cosine};
        const DoubleDouble two_pi = 2.0 * double_double::pi;
        DoubleDouble half_mean;  // of psi over a period
        if (m.hi <= 0.5) {
            form_ = Form::circular;
            const DoubleDouble q = m.hi == 0.0 ? DoubleDouble(0.0) : exp(-double_double::pi * quarter1 / quarter);
            // K' - b = F at the sine cos(theta)
            const DoubleDouble rest = cosine * elliptic::carlson_f(sine * sine, sine * sine + cosine * cosine * m, 1.0);
            const DoubleDouble p = exp(-double_double::pi * rest / quarter);
            exact.circular = {q, p};
            now_.circular = {q, p};
            const DoubleDouble scale = double_double::half_pi / quarter;
            argument_ = Phase(mu * scale, u0 * scale, two_pi);
            half_mean = half_rate + sign * exact.circular.phase_slope() * argument_.rate();
            turn_ = Phase(half_mean, 0.0, two_pi);
        } else {
            form_ = Form::hyperbolic;
            const DoubleDouble scale = double_double::half_pi / quarter1;
            const DoubleDouble rest = sine * elliptic::carlson_f(cosine * cosine * m, m, sine * sine + cosine * cosine * m);
            const DoubleDouble eta = rest * scale, half_step = quarter * scale;
            const DoubleDouble root_nome = m1.hi == 0.0 ? DoubleDouble(0.0) : exp(-half_step);
            exact.hyperbolic = {root_nome, eta};
            now_.hyperbolic = {root_nome, eta};
            argument_ = Phase(mu * scale, u0 * scale, 2.0 * half_step);
            const DoubleDouble rate = half_rate + sign * exact.hyperbolic.phase_slope() * argument_.rate();
            turn_ = Phase(rate, 0.0, two_pi);
            jump_ = -sign * eta;
            half_mean = rate - 0.5 * sign * eta * mu / quarter;
            // roundings of D: of its products, and of what turning to principal axes left of each factor
            const double by_turning = conditioning_ == 0.0 ? 0.0 : 1.0, largest = moments[c].hi;
            const auto doubt = [&](const DoubleDouble& term, const DoubleDouble& gap, const DoubleDouble& component) {
                if (term.hi == 0.0) return 0.0;
                return term.hi * (1.0 + by_turning * (2.0 * speed_ / std::abs(component.hi) + largest / gap.hi));
            };
            if (m1.hi > 0.0)
                defect_ = 0x1p-102 / std::abs(difference.hi) *
                          (doubt(by_a, moments[b] - moments[a], omega[a]) +
                           doubt(by_c, moments[c] - moments[b], omega[c]));
        }
        sign_ = sign;
        set_queries(mu.hi / quarter.hi, half_mean.hi, std::atan2(k1.hi, k3.hi),
                    std::atan2(i2.hi * beta.hi, k3.hi * std::sqrt(m1.hi)));
        if (d21.hi == 0.0) regime_ = Regime::symmetric;
        if (m1.hi == 0.0) regime_ = Regime::separatrix;
        now_.omega = rounded(exact.omega);
        now_.momentum = rounded(exact.momentum);

        const QuaternionOf<DoubleDouble> to_principal = conjugate(attitude_of(axes));
        from_body_ = rounded(to_principal);
        axes_ = rounded(axes);
        const QuaternionOf<DoubleDouble> first = core(exact, {}).attitude;
        frame_ = frame(unit(start * conjugate(first * to_principal)));
    }

    /// From quarter periods a second, and half the mean rate of psi = precession + proper rotation.
    void set_queries(double quarters, double half_mean, double least_tilt, double largest_tilt) {
        period_ = 4.0 / quarters;
        // K goes once round the axis in a period, backwards where the axis has the largest moment
        proper_ = -sign_ * 0.5 * std::numbers::pi * quarters;
        precession_ = 2.0 * half_mean - proper_;
        tilt_ = {least_tilt, largest_tilt};
    }

    template <class S>
    Core<S> core(const Constants<S>& constants, Instant t) const {
        const Phase::Reduced u = argument_.at(t);
        elliptic::JacobiValues<S> f;
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
    double speed_ = 0.0, conditioning_ = 0.0, defect_ = 0.0;
    double period_ = std::numeric_limits<double>::infinity(), precession_ = 0.0, proper_ = 0.0;
    std::pair<double, double> tilt_{0.0, 0.0};
};

}  // namespace rbdyn
