// Definitions of rbdyn/closed_form/pendulum.hpp.
#pragma once

#include "rbdyn/closed_form/pendulum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/carlson.hpp"
#include "rbdyn/closed_form/lagrange_top.hpp"
#include "rbdyn/closed_form/phase.hpp"
#include "rbdyn/closed_form/theta.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Pendulum::Pendulum(const DoubleDouble& w2, const DoubleDouble& angle, const DoubleDouble& rate)
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

RBDYN_INLINE Pendulum::State Pendulum::at(Instant t) const {
    if (kind_ == Kind::rest || (t.hi == 0.0 && t.lo == 0.0)) return start_;
    const Phase::Reduced place = phase_.at(t);
    auto [sn, cn] = jacobi_.at(place.rest.hi);
    const double dn = std::sqrt(cn * cn + complement_ * sn * sn), side = backward_ ? -1.0 : 1.0;
    if (kind_ == Kind::libration) {
        const double half = std::atan2(modulus_ * sn, dn), sign = place.is_odd() ? -side : side;
        return {(before_ + 2.0 * sign * half).hi, 2.0 * sign * speed_ * modulus_ * cn};
    }
    const DoubleDouble turned = whole_turn * place.steps + 2.0 * std::atan2(sn, cn);
    return {(before_ + turned * side).hi, 2.0 * side * speed_ * dn};
}

RBDYN_INLINE double Pendulum::period() const {
    if (kind_ == Kind::rest) return inverted_ ? INFINITY : whole_turn.hi / small_rate_;
    return kind_ == Kind::libration ? 4.0 * quarter_ : 2.0 * quarter_;
}

RBDYN_INLINE double Pendulum::error(double t) const {
    if (kind_ == Kind::rest) return 0.0;
    const double time = std::abs(t), growth = kind_ == Kind::separatrix ? std::min(200.0, speed_ * time) : 0.0;
    return std::min(2.0, rounding + noise * speed_ * time + sensitivity_ * (1.0 + time / quarter_) * std::exp(growth));
}

RBDYN_INLINE Pendulum::Jacobi::Jacobi(const Theta& of)
    : theta(of), sine(of.quotient_first(0.0)), cosine(of.quotient_second(0.0)) {
    if (isfinite(of.period())) sn = 1.0 / Theta::first(sine, of.waves(0.5 * of.period().hi)).real();
    cn = 1.0 / Theta::second(cosine, of.waves(0.0)).real();
}

RBDYN_INLINE std::pair<double, double> Pendulum::Jacobi::at(double z) const {
    const Theta::Waves waves = theta.waves(z);
    return {sn * Theta::first(sine, waves).real(), cn * Theta::second(cosine, waves).real()};
}

}  // namespace rbdyn::inline RBDYN_FORM
