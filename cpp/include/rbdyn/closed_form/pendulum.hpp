// The compound pendulum in closed form (equation 7.60): psi'' = -w2 sin psi, psi from the lowest place, w2 = m g l / I.
//
// With sn, cn, dn of modulus k at w t + u0, w = sqrt(w2) (Whittaker, "Analytical Dynamics", 44; DLMF 22.19):
// * libration, k < 1:  tan(psi/2) = k sn / dn, psi' = 2 k w cn, k^2 = sin^2(psi0/2) + psi0'^2/(4 w2);
// * rotation, of modulus 1/k at k w t + u0:  psi/2 = am, psi' = 2 k w dn;
// * the separatrix is a rotation of modulus 1 and infinite period.
// 1 - k^2 = cos^2(psi0/2) - psi0'^2/(4 w2) comes from its own formula in 32 digits. Below 1e-31 of its terms it is
// taken as none: the start is on the separatrix.
#pragma once

#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/phase.hpp"
#include "rbdyn/closed_form/theta.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Pendulum {
public:
    struct State {
        double angle, rate;  // [rad], not reduced; [rad/s]
    };
    enum class Kind { rest, libration, separatrix, rotation };

    /// w2 [1/s^2] not negative, the angle from the lowest place [rad] and its rate [rad/s] at t = 0.
    [[gnu::cold]] Pendulum(const DoubleDouble& w2, const DoubleDouble& angle, const DoubleDouble& rate);

    Kind kind() const { return kind_; }

    /// Angle and rate at a time [s] of either sign; at 0 the start itself.
    State at(Instant t) const;

    /// Time of a swing to and fro, or of a turn [s]; infinite on the separatrix and at rest in the highest place.
    double period() const;

    /// Estimated error at a time [s]: of the angle relative to its largest size, of the rate likewise.
    double error(double t) const;

private:
    static constexpr DoubleDouble whole_turn{2.0 * double_double::pi.hi, 2.0 * double_double::pi.lo};
    static constexpr double noise = 1e-31;     // what set-up loses of 32 digits
    static constexpr double rounding = 2e-16;  // of some five operations in doubles

    /// sn and cn as the quotients whose zeros lie on the real axis.
    struct Jacobi {
        Jacobi() = default;
        explicit Jacobi(const Theta& of);
        std::pair<double, double> at(double z) const;
        Theta theta;
        Theta::Quotient sine, cosine;
        double sn = 1.0, cn = 1.0;
    };

    State start_;
    bool backward_, inverted_ = false;
    Kind kind_ = Kind::rest;
    DoubleDouble before_;
    Phase phase_;
    Jacobi jacobi_;
    double small_rate_ = 0.0, speed_ = 0.0, modulus_ = 0.0, complement_ = 0.0, quarter_ = INFINITY, sensitivity_ = 0.0;
};

}  // namespace rbdyn::inline RBDYN_FORM
