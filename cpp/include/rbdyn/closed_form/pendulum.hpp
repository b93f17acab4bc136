// The compound pendulum in closed form (equation 7.60): psi'' = -w2 sin psi, psi from the lowest place, w2 = m g l / I.
//
// With sn, cn, dn of modulus k at w t + u0, w = sqrt(w2) (Whittaker, "Analytical Dynamics", 44; DLMF 22.19):
// * libration, k < 1:  tan(psi/2) = k sn / dn, psi' = 2 k w cn, k^2 = sin^2(psi0/2) + psi0'^2/(4 w2);
// * rotation, of modulus 1/k at k w t + u0:  psi/2 = am, psi' = 2 k w dn;
// * the separatrix is a rotation of modulus 1 and infinite period.
// 1 - k^2 = cos^2(psi0/2) - psi0'^2/(4 w2) comes from its own formula in 32 digits. Below 1e-31 of its terms it is
// taken as none: the start is on the separatrix.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/closed_form/carlson.hpp"
#include "rbdyn/closed_form/phase.hpp"
#include "rbdyn/closed_form/theta.hpp"

namespace rbdyn {

class Pendulum {
public:
    struct State {
        double angle, rate;  // [rad], not reduced; [rad/s]
    };
    enum class Kind { rest, libration, separatrix, rotation };

    /// w2 [1/s^2] not negative, the angle from the lowest place [rad] and its rate [rad/s] at t = 0.
    [[gnu::cold]] Pendulum(const DoubleDouble& w2, const DoubleDouble& angle, const DoubleDouble& rate)
        : start_{angle.hi, rate.hi}, backward_(rate.hi < 0.0) {
        require(w2.hi >= 0.0 && std::isfinite(w2.hi), "Pendulum", "m g l / I", w2.hi,
                "it must not be negative; measure the angle from the lowest place");
        const double turns = std::nearbyint(angle.hi / whole_turn.hi);
        before_ = whole_turn * turns;
        auto [sine, cosine] = sine_cosine((angle - before_) * 0.5);
        // pi in 32 digits is the highest place itself
        if (std::abs(cosine.hi) < noise) cosine = 0.0;
        if (backward_) sine = -sine;
        const DoubleDouble small_rate = sqrt(w2), speed_0 = abs(rate) * 0.5, width = small_rate * sine;
        const DoubleDouble kinetic = speed_0 * speed_0, fall = w2 * cosine * cosine;
        DoubleDouble lack = fall - kinetic;  // of energy to reach the highest place
        sensitivity_ = noise * (fall + kinetic).hi;
        if (std::abs(lack.hi) <= sensitivity_) lack = 0.0;
        small_rate_ = small_rate.hi;
        const double larger = std::max(std::abs(width.hi), speed_0.hi);
        if (larger == 0.0 || (fall.hi == 0.0 && speed_0.hi == 0.0)) {
            inverted_ = sine.hi != 0.0;
            return;
        }
        // k w, in units that keep the squares of tiny numbers
        const DoubleDouble a = width / larger, b = speed_0 / larger, square = a * a + b * b;
        const DoubleDouble total = sqrt(square) * larger;
        kind_ = lack.hi > 0.0 ? Kind::libration : lack.hi < 0.0 ? Kind::rotation : Kind::separatrix;
        sensitivity_ = lack.hi == 0.0 ? noise : sensitivity_ / std::abs(lack.hi);
        const bool swings = kind_ == Kind::libration;
        const DoubleDouble &speed = swings ? small_rate : total, modulus = (swings ? total : small_rate) / speed;
        const DoubleDouble complement = abs(lack) / (speed * speed);
        const Theta theta(modulus * modulus, complement);
        DoubleDouble u0 = 0.0;  // sn R_F(cn^2, dn^2, 1) at the start
        if (sine.hi != 0.0) {
            const DoubleDouble stands = b * b / square, above = cosine * cosine;
            u0 = swings ? width / total * elliptic::carlson_f(stands, above, 1.0)
                        : sine * elliptic::carlson_f(above, stands, 1.0);
        }
        phase_ = Phase(speed * theta.scale(), u0 * theta.scale(), theta.period());
        jacobi_ = Jacobi(theta);
        complement_ = complement.hi;
        modulus_ = modulus.hi;
        speed_ = speed.hi;
        quarter_ = (theta.quarter() / speed).hi;
    }

    Kind kind() const { return kind_; }

    /// Angle and rate at a time [s] of either sign; at 0 the start itself.
    State at(Instant t) const {
        if (kind_ == Kind::rest || (t.hi == 0.0 && t.lo == 0.0)) return start_;
        const Phase::Reduced place = phase_.at(t);
        auto [sn, cn] = jacobi_.at(place.rest.hi);
        const double dn = std::sqrt(cn * cn + complement_ * sn * sn), side = backward_ ? -1.0 : 1.0;
        if (kind_ == Kind::libration) {
            const bool odd = place.steps != 2.0 * std::nearbyint(0.5 * place.steps);
            const double half = std::atan2(modulus_ * sn, dn), sign = odd ? -side : side;
            return {(before_ + 2.0 * sign * half).hi, 2.0 * sign * speed_ * modulus_ * cn};
        }
        const DoubleDouble turned = whole_turn * place.steps + 2.0 * std::atan2(sn, cn);
        return {(before_ + turned * side).hi, 2.0 * side * speed_ * dn};
    }

    /// Time of a swing to and fro, or of a turn [s]; infinite on the separatrix and at rest in the highest place.
    double period() const {
        if (kind_ == Kind::rest) return inverted_ ? INFINITY : whole_turn.hi / small_rate_;
        return kind_ == Kind::libration ? 4.0 * quarter_ : 2.0 * quarter_;
    }

    /// Estimated error at a time [s]: of the angle relative to its largest size, of the rate likewise.
    double error(double t) const {
        if (kind_ == Kind::rest) return 0.0;
        const double time = std::abs(t), growth = kind_ == Kind::separatrix ? std::min(200.0, speed_ * time) : 0.0;
        return std::min(2.0,
                        rounding + noise * speed_ * time + sensitivity_ * (1.0 + time / quarter_) * std::exp(growth));
    }

private:
    static constexpr DoubleDouble whole_turn{2.0 * double_double::pi.hi, 2.0 * double_double::pi.lo};
    static constexpr double noise = 1e-31;     // what set-up loses of 32 digits
    static constexpr double rounding = 2e-16;  // of some five operations in doubles

    /// sn and cn as the quotients whose zeros lie on the real axis.
    struct Jacobi {
        Jacobi() = default;
        explicit Jacobi(const Theta& of) : theta(of), sine(of.quotient_first(0.0)), cosine(of.quotient_second(0.0)) {
            if (isfinite(of.period())) sn = 1.0 / Theta::first(sine, of.waves(0.5 * of.period().hi)).real();
            cn = 1.0 / Theta::second(cosine, of.waves(0.0)).real();
        }
        std::pair<double, double> at(double z) const {
            const Theta::Waves waves = theta.waves(z);
            return {sn * Theta::first(sine, waves).real(), cn * Theta::second(cosine, waves).real()};
        }
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

}  // namespace rbdyn
