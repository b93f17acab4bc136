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

#include <cmath>
#include <limits>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/closed_form/phase.hpp"
#include "rbdyn/closed_form/polhode.hpp"
#include "rbdyn/closed_form/theta_series.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

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
                               const Vector3Of<DoubleDouble>& angular_velocity);
    FreeRotation(const Matrix3Of<DoubleDouble>& inertia, const Quaternion& attitude, const Vector3& angular_velocity);

    /// At t seconds from the start, before it too; at 0 the start itself.
    State at(Instant t) const;
    State at(double t) const { return at(Instant{t, 0.0}); }

    /// Estimate of the error at t: of omega over its size, and of the attitude [rad].
    double error(double t) const;

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
        Quaternion times(const Quaternion& q) const;
    };

    static Frame frame(const QuaternionOf<DoubleDouble>& q);

    [[gnu::cold]] void set_constant(const Vector3Of<DoubleDouble>& omega, const Matrix3Of<DoubleDouble>& axes,
                                    const QuaternionOf<DoubleDouble>& start);

    [[gnu::cold]] void set_varying(const Polhode& p, const Matrix3Of<DoubleDouble>& principal,
                                   const QuaternionOf<DoubleDouble>& start);

    /// Near the separatrix 1 - m, a difference known to 32 digits of its terms, sets the time of each flip. Turning to
    /// principal axes leaves roundings of the largest moment in all of them, which shift small components of omega.
    [[gnu::cold]] void set_doubt(const Polhode& p, const Vector3Of<DoubleDouble>& omega, bool along_axes);

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
            if (u.is_odd()) {
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

}  // namespace rbdyn::inline RBDYN_FORM
