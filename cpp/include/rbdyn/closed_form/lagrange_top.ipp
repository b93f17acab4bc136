// Definitions of rbdyn/closed_form/lagrange_top.hpp.
#pragma once

#include "rbdyn/closed_form/lagrange_top.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <tuple>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/carlson.hpp"
#include "rbdyn/closed_form/phase.hpp"
#include "rbdyn/closed_form/theta.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE LagrangeTop::LagrangeTop(DoubleDouble across, DoubleDouble along, DoubleDouble weight_moment,
                                      const Vector3& up, const DigitsQuaternion& attitude,
                                      const Digits& angular_velocity)
    : start_{{attitude.w.hi, attitude.x.hi, attitude.y.hi, attitude.z.hi},
             {angular_velocity[0].hi, angular_velocity[1].hi, angular_velocity[2].hi}} {
    const double side = weight_moment.hi < 0.0 ? -1.0 : 1.0;
    world_ = upright(up * side);
    DigitsQuaternion to_start = conjugate(world_) * attitude;
    // a vertical off the z axis is known to 1e-31; along it, squares below 1e-250 would lose their digits
    const double none = up[0] != 0.0 || up[1] != 0.0 ? 1e-61 : 1e-250;
    const double on = (to_start.w * to_start.w + to_start.z * to_start.z).hi;
    const double off = (to_start.x * to_start.x + to_start.y * to_start.y).hi;
    if (off < none * on) to_start.x = to_start.y = 0.0;
    if (on < none * off) to_start.w = to_start.z = 0.0;
    const DoubleDouble size = sqrt(squared_norm(to_start));
    const Start s(across, along, weight_moment * side,
                  {to_start.w / size, to_start.x / size, to_start.y / size, to_start.z / size}, angular_velocity);
    world_in_doubles_ = rounded(world_);
    spin_ = s.spin.hi;
    // a weight that turns nothing in 1e30 revolutions, or an axis at rest in the vertical
    const DoubleDouble rates = s.across_square + s.axial * s.axial;
    free_ = s.weight.hi <= 1e-40 * rates.hi || (s.across_square.hi == 0.0 && (s.below.hi == 0.0 || s.above.hi == 0.0));
    if (free_)
        set_free(s);
    else
        set_heavy(s);
}

RBDYN_INLINE LagrangeTop::LagrangeTop(DoubleDouble across, DoubleDouble along, DoubleDouble weight_moment,
                                      const Vector3& up, const Quaternion& attitude, const Vector3& angular_velocity)
    : LagrangeTop(across, along, weight_moment, up, DigitsQuaternion{attitude.w, attitude.x, attitude.y, attitude.z},
                  {angular_velocity[0], angular_velocity[1], angular_velocity[2]}) {}

RBDYN_INLINE LagrangeTop::State LagrangeTop::at(Instant t) const {
    if (t.hi == 0.0 && t.lo == 0.0) return start_;
    return free_ ? free_at(t) : heavy_at(t);
}

RBDYN_INLINE double LagrangeTop::error(double t) const {
    const double time = std::abs(t);
    return std::min(4.0, rounding + 1e-31 * fastest_ * time +
                             sensitivity_ * (1.0 + time * nutation_rate_) *
                                 (lost_ ? std::exp(std::min(200.0, 2.0 * place_.rate().hi * time)) : 1.0));
}

RBDYN_INLINE LagrangeTop::Start::Start(DoubleDouble across, DoubleDouble along, DoubleDouble weight_moment,
                                       const DigitsQuaternion& q, const Digits& omega)
    : attitude(q), angular_velocity(omega), spin(omega[2]) {
    weight = weight_moment * 2.0 / across;
    axial = along / across * spin;
    body_rate = (across - along) / across * spin;
    vertical_1 = (q.x * q.z - q.w * q.y) * 2.0;
    vertical_2 = (q.y * q.z + q.w * q.x) * 2.0;
    above = (q.w * q.w + q.z * q.z) * 2.0;
    below = (q.x * q.x + q.y * q.y) * 2.0;
    across_square = omega[0] * omega[0] + omega[1] * omega[1];
    horizontal = omega[0] * vertical_1 + omega[1] * vertical_2;
    nutation = vertical_1 * omega[1] - vertical_2 * omega[0];
}

RBDYN_INLINE std::complex<double> LagrangeTop::Factor::times(std::complex<double> value, double z, Instant t) const {
    return size * value * std::polar(1.0, phase.at(t).rest.hi + quotient.twist * z);
}

RBDYN_INLINE Phase LagrangeTop::turning(const DoubleDouble& rate) {
    return {rate, 0.0, {2.0 * double_double::pi.hi, 2.0 * double_double::pi.lo}};
}

RBDYN_INLINE LagrangeTop::DigitsQuaternion LagrangeTop::upright(const Vector3& direction) {
    const DoubleDouble x = direction[0], y = direction[1], z = direction[2];
    const DoubleDouble length = sqrt(x * x + y * y + z * z), height = length + abs(z);
    const DoubleDouble size = sqrt(x * x + y * y + height * height);
    const DoubleDouble a = height / size, b = x / size, c = y / size;
    if (z.hi >= 0.0) return {a, -c, b, 0.0};
    return {-c, a, 0.0, b};
}

RBDYN_INLINE void LagrangeTop::set_free(const Start& s) {
    turn_axis_ = s.angular_velocity;
    turn_axis_[2] = s.axial;
    turn_rate_ = sqrt(s.across_square + s.axial * s.axial).hi;
    half_turn_ = turning(sqrt(s.across_square + s.axial * s.axial) * 0.5);
    half_spin_ = turning(s.body_rate * 0.5);
    fastest_ = turn_rate_ + std::abs(s.body_rate.hi);
}

RBDYN_INLINE LagrangeTop::State LagrangeTop::free_at(Instant t) const {
    const double half = half_turn_.at(t).rest.hi, spun = half_spin_.at(t).rest.hi;
    const double s = turn_rate_ == 0.0 ? 0.0 : std::sin(half) / turn_rate_;
    const double c2 = std::cos(2.0 * spun), s2 = std::sin(2.0 * spun);
    const Vector3& omega = start_.angular_velocity;
    const Quaternion turned{std::cos(half), s * turn_axis_[0].hi, s * turn_axis_[1].hi, s * turn_axis_[2].hi};
    return {normalized(start_.attitude) * turned * Quaternion{std::cos(spun), 0.0, 0.0, std::sin(spun)},
            Vector3(omega[0] * c2 + omega[1] * s2, omega[1] * c2 - omega[0] * s2, omega[2])};
}

RBDYN_INLINE void LagrangeTop::set_heavy(const Start& s) {
    const DoubleDouble difference = s.horizontal - s.axial * s.below, sum = s.horizontal + s.axial * s.above;
    const Roots r = roots(s, difference, sum);
    const bool separatrix = r.d32.hi == 0.0;
    theta_ = Theta(r.d21 / r.d31, r.d32 / r.d31);
    const DoubleDouble speed = sqrt(s.weight * r.d31) * 0.5;  // of v
    DoubleDouble v = 0.0;                                     // at the start
    if (r.x1.hi < 0.0) v = sqrt(-r.x1) * elliptic::carlson_f(r.x2, r.x3 * r.d21 / r.d31, r.d21);
    place_ = Phase(speed * theta_.scale(), (s.nutation.hi < 0.0 ? -v : v) * theta_.scale(), theta_.period());

    // omega_1^2 + omega_2^2 is 2 m g l/A times the distance of u from a root of its own between u2 and u3
    const DoubleDouble from_1 = s.across_square / s.weight - r.x1;
    const DoubleDouble beyond = (s.across_square - s.weight * s.below) / s.weight;
    const DoubleDouble across = separatrix ? DoubleDouble(0.0) : s.axial * s.across_square / s.weight - s.horizontal;
    const DoubleDouble product = across * across / (s.weight * from_1);
    DoubleDouble from_2 = r.below_2 + beyond, from_3 = r.beyond_3 - beyond;
    if (beyond.hi >= 0.0)
        from_3 = from_2.hi > 0.0 ? product / from_2 : r.d32;
    else
        from_2 = product / from_3;

    const double sign = sum.hi < 0.0 ? -1.0 : 1.0;
    DoubleDouble w = 0.0;
    if (r.above_1.hi > 0.0)
        w = r.d21.hi == 0.0 ? DoubleDouble(INFINITY)
                            : sqrt(r.above_1) * elliptic::carlson_f(r.d21, r.d21 * r.above_3 / r.d31, r.above_2);
    wz_.quotient = theta_.quotient_first(w * sign);
    wz_.phase =
        turning((s.body_rate + (r.above_2.hi > 0.0 ? sum / r.above_2 : 0.0)) * 0.5 + speed * wz_.quotient.drift);
    xy_.quotient = theta_.quotient_second(shift(r, r.below_1, r.below_2, r.beyond_3, difference));
    xy_.phase = turning((difference / r.below_1 - s.body_rate) * 0.5 + speed * xy_.quotient.drift);
    omega_.quotient = theta_.quotient_second(shift(r, from_1, from_2, from_3, across));
    omega_.phase = turning((across / from_1 - s.axial) * 0.5 - s.body_rate + speed * omega_.quotient.drift);

    const auto& q = s.attitude;
    const auto& o = s.angular_velocity;
    fit(wz_, true, q.w, q.z, (q.x * o[0] + q.y * o[1] + q.z * o[2]) * -0.5,
        (q.w * o[2] + q.x * o[1] - q.y * o[0]) * 0.5);
    fit(xy_, false, q.x, q.y, (q.w * o[0] + q.y * o[2] - q.z * o[1]) * 0.5,
        (q.w * o[1] + q.z * o[0] - q.x * o[2]) * 0.5);
    fit(omega_, false, o[0], o[1], s.body_rate * o[1] + s.weight * s.vertical_2 * 0.5,
        -(s.body_rate * o[0] + s.weight * s.vertical_1 * 0.5));

    nutation_rate_ = isfinite(theta_.period()) ? (place_.rate() / theta_.period()).hi : 0.0;
    fastest_ = place_.rate().hi;
    for (const Factor* f : {&wz_, &xy_, &omega_}) fastest_ += std::abs(f->phase.rate().hi);
    sensitivity_ = r.noise;
    lost_ = separatrix;
}

RBDYN_INLINE DoubleDouble LagrangeTop::shift(const Roots& r, const DoubleDouble& e1, const DoubleDouble& e2,
                                             const DoubleDouble& e3, const DoubleDouble& sign) {
    if (e2.hi == 0.0 || r.d32.hi == 0.0) return 0.0;
    if (r.d21.hi == 0.0 && r.d32.hi > 0.0) return sign.hi < 0.0 ? -INFINITY : INFINITY;
    const DoubleDouble w = sqrt(e2 * r.d31) * elliptic::carlson_f(r.d21 * e3, r.d21 * r.d32, e1 * r.d32);
    return sign.hi < 0.0 ? -w : w;
}

RBDYN_INLINE void LagrangeTop::fit(Factor& f, bool first, const DoubleDouble& x, const DoubleDouble& y,
                                   const DoubleDouble& x_rise, const DoubleDouble& y_rise) const {
    const Phase::Reduced at = place_.at({});
    const double z = at.rest.hi;
    const Theta::Waves waves = theta_.waves(z);
    const DoubleDouble &rate = f.phase.rate(), &speed = place_.rate();
    const std::complex<double> value(x.hi, y.hi);
    const std::complex<double> rise(((x_rise + rate * y) / speed).hi, ((y_rise - rate * x) / speed).hi);
    const std::complex<double> g = first ? theta_.first(f.quotient, waves) : theta_.second(f.quotient, waves);
    const std::complex<double> slope = first ? theta_.slope_first(f.quotient, z) : theta_.slope_second(f.quotient, z);
    f.size = sign(at) * std::polar(1.0, -f.quotient.twist * z) * (std::conj(g) * value + std::conj(slope) * rise) /
             (std::norm(g) + std::norm(slope));
}

RBDYN_INLINE double LagrangeTop::sign(const Phase::Reduced& at) { return at.is_odd() ? -1.0 : 1.0; }

RBDYN_INLINE LagrangeTop::State LagrangeTop::heavy_at(Instant t) const {
    const Phase::Reduced at = place_.at(t);
    const double z = at.rest.hi;
    const Theta::Waves waves = theta_.waves(z);
    const std::complex<double> wz = wz_.times(theta_.first(wz_.quotient, waves), z, t) * sign(at);
    const std::complex<double> xy = xy_.times(theta_.second(xy_.quotient, waves), z, t) * sign(at);
    const std::complex<double> o = omega_.times(theta_.second(omega_.quotient, waves), z, t) * sign(at);
    return {world_in_doubles_ * Quaternion{wz.real(), xy.real(), xy.imag(), wz.imag()},
            Vector3(o.real(), o.imag(), spin_)};
}

/// u'^2/weight = (u - u1)(u2 - u)(u3 - u), written about u at the start, where u1 <= u <= u2, and about u = 1, where
/// u2 <= 1 <= u3: each time one pair has roots of opposite signs, which come out of its quadratic with all their digits
/// once the third root is known. The root apart from the other two is known from Newton's method.
RBDYN_INLINE LagrangeTop::Roots LagrangeTop::roots(const Start& s, const DoubleDouble& difference,
                                                   const DoubleDouble& sum) {
    Roots r;
    // a negative and a positive root of z^2 - sum z + product
    const auto opposite_pair = [](const DoubleDouble& total, const DoubleDouble& product) {
        const DoubleDouble half = total * 0.5, far = sqrt(half * half - product);
        if (far.hi == 0.0) return std::pair(DoubleDouble(0.0), DoubleDouble(0.0));
        if (half.hi > 0.0) return std::pair(product / (half + far), half + far);
        return std::pair(half - far, product / (half - far));
    };
    const DoubleDouble& weight = s.weight;
    const DoubleDouble height = s.across_square - weight * s.below;  // kinetic energy across the axis when upright
    const DoubleDouble mixed = (height - difference * s.axial) * 2.0;
    const DoubleDouble e2 = (height + s.axial * s.axial) / weight - 2.0, e1 = -mixed / weight,
                       e0 = difference * difference / weight;
    const auto newton = [&](DoubleDouble w) {
        // monotone from outside all roots; from there seven steps give 32 digits of a root that is apart
        for (int i = 0; i < 30; ++i) {
            const DoubleDouble value = ((w + e2) * w + e1) * w + e0, slope = (w * 3.0 + e2 * 2.0) * w + e1;
            if (slope.hi == 0.0) break;
            const DoubleDouble step = value / slope;
            w -= step;
            if (!(std::abs(step.hi) > 1e-31 * std::abs(w.hi))) break;
        }
        return w;
    };
    const auto pair_about_start = [&](const DoubleDouble& x3) {
        r.x3 = x3;
        const DoubleDouble c0 = s.nutation * s.nutation;
        const DoubleDouble c1 =
            (s.axial * s.horizontal - (1.0 - s.below) * s.across_square) * 2.0 - weight * s.above * s.below;
        std::tie(r.x1, r.x2) = opposite_pair((c1 + c0 / x3) / (weight * x3), -c0 / (weight * x3));
        r.below_1 = s.below - r.x1;
    };
    const auto pair_about_one = [&] {
        const DoubleDouble product = difference * difference / (weight * r.below_1);
        const DoubleDouble total = (mixed - difference * difference / r.below_1) / (weight * r.below_1);
        const auto [negative, positive] = opposite_pair(total, -product);
        r.below_2 = -negative;
        r.beyond_3 = positive;
    };
    // all roots lie within 2 h of their centre
    const DoubleDouble centre = e2 / -3.0, square = e2 * e2 - e1 * 3.0;
    const DoubleDouble h = square.hi > 0.0 ? sqrt(square) / 3.0 : DoubleDouble(0.0);
    const bool third_apart = (((centre + e2) * centre + e1) * centre + e0).hi > 0.0;
    if (third_apart) {
        const DoubleDouble third = newton(centre - h * 2.0);
        pair_about_start(s.below + (third.hi < 0.0 ? -third : DoubleDouble(0.0)));
        pair_about_one();
    } else {
        r.below_1 = newton(centre + h * 2.0);
        pair_about_one();
        pair_about_start(s.below + r.beyond_3);
    }
    // digits lost in the distance of the upper roots; below them it is taken as none
    const double terms = (s.across_square + weight * s.below + abs(difference * s.axial)).hi;
    const double lost = 4e-31 * terms / (weight * r.below_1).hi;
    if ((r.below_2 + r.beyond_3).hi <= lost) r.below_2 = r.beyond_3 = 0.0;
    r.noise = r.beyond_3.hi == 0.0 && r.below_2.hi == 0.0 ? 1e-31 : 0.1 * lost / (r.below_2 + r.beyond_3).hi;
    r.above_2 = s.above + r.x2;
    r.above_3 = r.beyond_3 + 2.0;
    r.above_1 = r.above_2.hi > 0.0 ? sum * sum / (weight * r.above_2 * r.above_3) : DoubleDouble(0.0);
    r.d21 = r.x2 - r.x1;
    r.d32 = r.below_2 + r.beyond_3;
    r.d31 = r.d21 + r.d32;
    return r;
}

}  // namespace rbdyn::inline RBDYN_FORM
