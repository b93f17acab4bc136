// The heavy symmetric top with a fixed point on its axis, Lagrange's case (equations 7.58 and 7.59).
//
// With u = cos(theta) of the axis e3 against the upward vertical, u'^2 is a cubic whose roots u1 <= u2 <= 1 <= u3 bound
// the nutation: u = u1 + (u2 - u1) sn^2. The attitude is q = (w, x, y, z) with the Cayley-Klein parameters
//
//   w + i z = cos(theta/2) e^{i (psi + phi)/2},   x + i y = sin(theta/2) e^{i (psi - phi)/2},
//
// and these and omega_1 + i omega_2 are each one quotient of theta functions times an exponential (Klein and
// Sommerfeld, "Ueber die Theorie des Kreisels", ch. VI): regular for every motion, through theta = 0 and pi, at cusps
// and loops.
//
// Conventions: moments A = A and C about the fixed point; body axes with e3 the top's; angular velocity in body axes;
// potential energy `weight_moment` u with weight_moment = m g l, l the signed distance of the mass centre along e3.
// Roots are only known by what keeps their distances from each other and from -1 and 1: no digits are lost near regular
// precession (u1 = u2), near the vertical, or near the separatrix (u2 = u3), where the motion takes for ever.
#pragma once

#include <array>
#include <complex>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/phase.hpp"
#include "rbdyn/closed_form/theta.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

class LagrangeTop {
public:
    struct State {
        Quaternion attitude;
        Vector3 angular_velocity;  // body axes [rad/s]
    };
    using Digits = std::array<DoubleDouble, 3>;
    using DigitsQuaternion = QuaternionOf<DoubleDouble>;

    /// Moments of inertia [kg m^2] about the fixed point across and along the axis, m g l [N m], the upward vertical in
    /// the world, attitude and angular velocity in body axes [rad/s] at t = 0. Vertical and attitude count by
    /// direction.
    LagrangeTop(DoubleDouble across, DoubleDouble along, DoubleDouble weight_moment, const Vector3& up,
                const DigitsQuaternion& attitude, const Digits& angular_velocity);
    LagrangeTop(DoubleDouble across, DoubleDouble along, DoubleDouble weight_moment, const Vector3& up,
                const Quaternion& attitude, const Vector3& angular_velocity);

    /// The motion at a time [s] of either sign; at 0 the start itself.
    State at(Instant t) const;

    /// Estimated error at a time [s]: of the attitude as an angle, of the angular velocity relative to its largest
    /// size.
    double error(double t) const;

    /// Time from the lowest to the lowest place of the axis [s]; infinite on the separatrix, 0 without nutation.
    double nutation_period() const { return nutation_rate_ > 0.0 ? 1.0 / nutation_rate_ : free_ ? 0.0 : INFINITY; }

private:
    // sums of up to some ten rounded terms in three quotients
    static constexpr double rounding = 4e-16;

    /// The constants of the motion over the moment across, from the start; angles against the vertical.
    struct Start {
        Start(DoubleDouble across, DoubleDouble along, DoubleDouble weight_moment, const DigitsQuaternion& q,
              const Digits& omega);
        DigitsQuaternion attitude;
        Digits angular_velocity;
        DoubleDouble spin;                       // omega_3
        DoubleDouble weight;                     // 2 m g l / A
        DoubleDouble axial, body_rate;           // C omega_3 / A, (1 - C/A) omega_3
        DoubleDouble vertical_1, vertical_2;     // the vertical's components on e1, e2
        DoubleDouble above, below;               // 1 + u, 1 - u
        DoubleDouble across_square, horizontal;  // omega_1^2 + omega_2^2; (K_vertical - C omega_3 u)/A
        DoubleDouble nutation;                   // u'
    };

    /// What is known of the cubic's roots u1 <= u2 <= u3: distances from u at the start, from -1, from 1, between them.
    struct Roots {
        DoubleDouble x1, x2, x3, above_1, above_2, above_3, below_1, below_2, beyond_3, d21, d32, d31;
        double noise;  // relative error of d32
    };

    /// One Cayley-Klein parameter, or omega_1 + i omega_2.
    struct Factor {
        Theta::Quotient quotient;
        std::complex<double> size;
        Phase phase;

        std::complex<double> times(std::complex<double> value, double z, Instant t) const;
    };

    static Phase turning(const DoubleDouble& rate);
    static Quaternion rounded(const DigitsQuaternion& q) { return {q.w.hi, q.x.hi, q.y.hi, q.z.hi}; }

    /// The shortest turn from the z axis to a direction; from -z when that is nearer, after half a turn about x.
    static DigitsQuaternion upright(const Vector3& direction);

    void set_free(const Start& s);

    /// q0, a turn at a constant rate about the angular momentum, and one about the axis.
    State free_at(Instant t) const;

    [[gnu::cold]] void set_heavy(const Start& s);

    /// w of the zero v = K + i w of a second quotient: sn^2(w, k') = e2 d31/(e1 d32), e1, e2, e3 the root's distances.
    static DoubleDouble shift(const Roots& r, const DoubleDouble& e1, const DoubleDouble& e2, const DoubleDouble& e3,
                              const DoubleDouble& sign);

    /// The constant factor, from value x + i y and derivative at t = 0: either may vanish. The even growth of the phase
    /// is taken off the derivative, in all digits, since it says nothing new.
    [[gnu::cold]] void fit(Factor& f, bool first, const DoubleDouble& x, const DoubleDouble& y,
                           const DoubleDouble& x_rise, const DoubleDouble& y_rise) const;

    /// Of the quotients, which an odd number of periods turns over.
    static double sign(const Phase::Reduced& at);

    State heavy_at(Instant t) const;

    static Roots roots(const Start& s, const DoubleDouble& difference, const DoubleDouble& sum);

    State start_;
    DigitsQuaternion world_;  // turns the vertical of the formulas into the world's
    Quaternion world_in_doubles_;
    bool free_ = false, lost_ = false;
    double spin_ = 0.0;
    Digits turn_axis_;
    double turn_rate_ = 0.0;
    Phase half_turn_, half_spin_;
    Theta theta_;
    Phase place_;
    Factor wz_, xy_, omega_;
    double fastest_ = 0.0, nutation_rate_ = 0.0, sensitivity_ = 0.0;
};

}  // namespace rbdyn::inline RBDYN_FORM
