// Definitions of rbdyn/special/projection.hpp.
#pragma once

#include "rbdyn/special/projection.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/compensated.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/special/hinge_law.hpp"
#include "rbdyn/special/turning_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RigidProjection::RigidProjection(const TurningLaw& law, int q, int v, std::span<const double> x,
                                              std::span<const double> low)
    : follows_axis_(law.follows_axis) {
    attitude_ = q + law.first_turn();
    omega_ = v + law.first_turn();
    for (int i = 0; i < 3; ++i) {
        moment_[at(i)] = exactly<Real>(law.exact.moments[i]);
        rest_[at(i)] = law.coupling[i].lo;
        arm_[at(i)] = exactly<Real>(law.exact.center[i]);
        force_[at(i)] = exactly<Real>(law.exact.weight[i]);
    }
    is_heavy_ = law.holds_point() && norm(force_) > 0.0L && norm(arm_) > 0.0L;
    const Now now = look(x, low);
    if (is_heavy_) {
        force_size_ = norm(force_);
        side_ = now.force[2] < 0.0L ? -1.0L : 1.0L;
    }
    energy_ = energy(now);
    if (is_heavy_) {
        vertical_ = vertical(now);
        speed_ = std::sqrt(std::abs(dot(now.omega, now.omega)) + force_size_ * norm(arm_) / least());
    } else {
        for (int i = 0; i < 3; ++i) defect_[at(i)] = defect(now, i);
        momentum_ = to_world(now, momentum(now));
        square_ = dot(momentum_, momentum_);
    }
}

RBDYN_INLINE void RigidProjection::apply(std::span<double> x, std::span<double> low, double step, double /*t*/) const {
    if (!is_heavy_) catch_up(x, low, step);
    const Now now = look(x, low);
    const auto shrink = static_cast<double>(-0.5L * (now.norm - 1.0L));
    Correction turn{}, change{};
    if (is_heavy_)
        hold_heavy(now, change, turn);
    else if (square_ > 0.0L)
        hold_free(now, change, turn);
    const double w = x[at(attitude_)], a = x[at(attitude_ + 1)], b = x[at(attitude_ + 2)], c = x[at(attitude_ + 3)];
    // q (1, turn/2), turn in the frame
    const double h[3] = {0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2]};
    const double dq[4] = {w * shrink - a * h[0] - b * h[1] - c * h[2], a * shrink + w * h[0] + b * h[2] - c * h[1],
                          b * shrink + w * h[1] + c * h[0] - a * h[2], c * shrink + w * h[2] + a * h[1] - b * h[0]};
    for (int i = 0; i < 4; ++i) projecting::add(x, low, attitude_ + i, dq[i]);
    for (int i = 0; i < (follows_axis_ ? 2 : 3); ++i) projecting::add(x, low, omega_ + i, change[at(i)]);
    // a spin within two turns keeps its digits
    if (follows_axis_ && std::abs(x[at(attitude_ + 4)]) > 8.0)
        projecting::add(
            x, low, attitude_ + 4,
            -std::copysign(4.0L * std::numbers::pi_v<long double>, static_cast<Real>(x[at(attitude_ + 4)])));
}

RBDYN_INLINE bool RigidProjection::makes_up_for_rounding() const { return !is_heavy_; }

RBDYN_INLINE RigidProjection::Correction RigidProjection::rounded(const Vector& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

RBDYN_INLINE void RigidProjection::catch_up(std::span<double> x, std::span<double> low, double step) const {
    const double o[3] = {x[at(omega_)], x[at(omega_ + 1)], x[at(omega_ + 2)]};
    if (follows_axis_) {
        projecting::add(x, low, omega_, -step * rest_[0] * o[2] * o[1]);
        projecting::add(x, low, omega_ + 1, step * rest_[0] * o[2] * o[0]);
        return;
    }
    for (int i = 0; i < 3; ++i)
        projecting::add(x, low, omega_ + i, step * rest_[at(i)] * o[(i + 1) % 3] * o[(i + 2) % 3]);
}

RBDYN_INLINE RigidProjection::Now RigidProjection::look(std::span<const double> x, std::span<const double> low) const {
    Now now;
    const auto value = [&](int i) { return static_cast<Real>(x[at(i)]) + static_cast<Real>(low[at(i)]); };
    now.norm = 0.0L;
    for (int i = 0; i < 4; ++i) {
        now.q[at(i)] = value(attitude_ + i);
        now.norm += now.q[at(i)] * now.q[at(i)];
    }
    for (int i = 0; i < 3; ++i) now.omega[at(i)] = value(omega_ + i);
    if (is_heavy_) now.force = to_frame(now, force_);
    return now;
}

RBDYN_INLINE RigidProjection::Vector RigidProjection::turned(const Now& now, const Vector& v, Real sign) {
    // v + 2 r x (r x v + w v), r the vector part, over |q|^2
    const Vector r{sign * now.q[1], sign * now.q[2], sign * now.q[3]};
    Vector t = cross(r, v);
    for (int i = 0; i < 3; ++i) t[at(i)] += now.q[0] * v[at(i)];
    t = cross(r, t);
    Vector result;
    for (int i = 0; i < 3; ++i) result[at(i)] = v[at(i)] + 2.0L / now.norm * t[at(i)];
    return result;
}

RBDYN_INLINE RigidProjection::Vector RigidProjection::momentum(const Now& now) const {
    return {moment_[0] * now.omega[0], moment_[1] * now.omega[1], moment_[2] * now.omega[2]};
}

RBDYN_INLINE RigidProjection::Real RigidProjection::energy(const Now& now) const {
    const Real kinetic = 0.5L * dot(momentum(now), now.omega);
    if (!is_heavy_) return kinetic;
    const Vector& f = now.force;
    if (!follows_axis_) return kinetic - dot(f, arm_);
    // short of constants: nothing is left of them for a top that all but sleeps
    const Real across = 0.5L * moment_[0] * (now.omega[0] * now.omega[0] + now.omega[1] * now.omega[1]);
    return across + arm_[2] * side_ * away(f);
}

RBDYN_INLINE RigidProjection::Real RigidProjection::away(const Vector& f) const {
    const Real along = side_ * f[2];
    return along > 0.0L ? (f[0] * f[0] + f[1] * f[1]) / (force_size_ + along) : force_size_ - along;
}

RBDYN_INLINE RigidProjection::Real RigidProjection::defect(const Now& now, int i) const {
    Real sum = 0.0L;
    for (int k = 0; k < 3; ++k)
        sum += moment_[at(k)] * (moment_[at(k)] - moment_[at(i)]) * now.omega[at(k)] * now.omega[at(k)];
    return sum;
}

RBDYN_INLINE RigidProjection::Real RigidProjection::vertical(const Now& now) const {
    const Vector &f = now.force, k = momentum(now);
    return follows_axis_ ? k[0] * f[0] + k[1] * f[1] - k[2] * side_ * away(f) : dot(k, f);
}

RBDYN_INLINE void RigidProjection::hold_free(const Now& now, Correction& change, Correction& turn) const {
    int axis = 0;
    for (int i = 1; i < 3; ++i)
        if (moment_[at(i)] * now.omega[at(i)] * now.omega[at(i)] >
            moment_[at(axis)] * now.omega[at(axis)] * now.omega[at(axis)])
            axis = i;
    const Correction k = rounded(momentum(now));
    Correction slope;  // of D
    for (int i = 0; i < 3; ++i)
        slope[at(i)] = static_cast<double>(2.0L * (moment_[at(i)] - moment_[at(axis)])) * k[at(i)];
    const auto e = static_cast<double>(energy_ - energy(now)),
               d = static_cast<double>(defect_[at(axis)] - defect(now, axis)),
               moment = static_cast<double>(moment_[at(axis)]);
    // the smallest change of omega with k.change = e and slope.change = d
    const double kk = dot(k, k), ks = dot(k, slope), ss = dot(slope, slope), det = kk * ss - ks * ks;
    double a = e / kk, b = 0.0;
    if (det > 1e-30 * kk * kk * moment * moment) {
        a = (ss * e - ks * d) / det;
        b = (kk * d - ks * e) / det;
    }
    for (int i = 0; i < 3; ++i) change[at(i)] = a * k[at(i)] + b * slope[at(i)];
    // the turn that brings K back to where it was
    Now then = now;
    for (int i = 0; i < 3; ++i) then.omega[at(i)] += static_cast<Real>(change[at(i)]);
    const Vector off = cross(momentum(then), to_frame(now, momentum_));
    for (int i = 0; i < 3; ++i) turn[at(i)] = static_cast<double>(off[at(i)] / square_);
}

RBDYN_INLINE void RigidProjection::hold_heavy(const Now& now, Correction& change, Correction& turn) const {
    const Correction f = rounded(now.force), k = rounded(momentum(now)), moment = rounded(moment_);
    const auto speed = static_cast<double>(speed_);
    // in (omega / speed, turn): a turn t changes f by f x t
    const Correction e_turn = cross(f, rounded(arm_)), v_turn = cross(k, f);
    const int free = follows_axis_ ? 2 : 3;
    Correction e_omega{}, v_omega{};
    for (int i = 0; i < free; ++i) {
        e_omega[at(i)] = k[at(i)] * speed;
        v_omega[at(i)] = moment[at(i)] * f[at(i)] * speed;
    }
    const auto e = static_cast<double>(energy_ - energy(now)), v = static_cast<double>(vertical_ - vertical(now));
    const double ee = dot(e_omega, e_omega) + dot(e_turn, e_turn), vv = dot(v_omega, v_omega) + dot(v_turn, v_turn),
                 ev = dot(e_omega, v_omega) + dot(e_turn, v_turn), det = ee * vv - ev * ev;
    double a = ee > 0.0 ? e / ee : 0.0, b = 0.0;
    if (det > 1e-12 * ee * vv) {
        a = (vv * e - ev * v) / det;
        b = (ee * v - ev * e) / det;
    }
    for (int i = 0; i < 3; ++i) {
        change[at(i)] = (a * e_omega[at(i)] + b * v_omega[at(i)]) * speed;
        turn[at(i)] = a * e_turn[at(i)] + b * v_turn[at(i)];
    }
}

RBDYN_INLINE HingeProjection::HingeProjection(const HingeLaw& law, int q, int v, std::span<const double> x,
                                              std::span<const double> low)
    : angle_(q), rate_(v), moment_(exactly<Real>(law.exact.moments[2])) {
    const RigidLaw::Exact& exact = law.exact;
    const auto along = exactly<Real>(exact.weight.dot(exact.frame.col(0))),
               across = exactly<Real>(exact.weight.dot(exact.frame.col(1)));
    depth_ = exactly<Real>(exact.center[0]) * std::hypot(along, across);
    lowest_ = std::atan2(across, along);
    if (depth_ < 0.0L) {
        depth_ = -depth_;
        lowest_ += std::numbers::pi_v<long double>;
    }
    for (const bool from_lowest : {false, true}) energy_[from_lowest] = energy(x, low, from_lowest);
}

RBDYN_INLINE void HingeProjection::apply(std::span<double> x, std::span<double> low, double /*step*/,
                                         double /*t*/) const {
    const Real turn = value(x, low, angle_) - lowest_, rate = value(x, low, rate_);
    const bool from_lowest = std::cos(turn) > 0.0L;
    const Real off = energy_[from_lowest] - energy(x, low, from_lowest);
    // the smallest change of angle and rate over the rate of small oscillations
    const Real square = depth_ > 0.0L ? depth_ / moment_ : rate * rate;
    const Real by_angle = depth_ * std::sin(turn), by_rate = moment_ * rate,
               slope = by_angle * by_angle + by_rate * by_rate * square;
    if (!(slope > 0.0L)) return;
    projecting::add(x, low, angle_, off * by_angle / slope);
    projecting::add(x, low, rate_, off * by_rate * square / slope);
}

RBDYN_INLINE HingeProjection::Real HingeProjection::value(std::span<const double> x, std::span<const double> low,
                                                          int i) {
    return static_cast<Real>(x[static_cast<std::size_t>(i)]) + static_cast<Real>(low[static_cast<std::size_t>(i)]);
}

RBDYN_INLINE HingeProjection::Real HingeProjection::energy(std::span<const double> x, std::span<const double> low,
                                                           bool from_lowest) const {
    const Real half = 0.5L * (value(x, low, angle_) - lowest_), rate = value(x, low, rate_);
    const Real part = from_lowest ? std::sin(half) : std::cos(half);
    return 0.5L * moment_ * rate * rate + (from_lowest ? 2.0L : -2.0L) * depth_ * part * part;
}

RBDYN_INLINE Projections::Projections(const StateMap& map, std::vector<std::unique_ptr<const Projection>> parts)
    : map_(map), parts_(std::move(parts)), x_(static_cast<std::size_t>(map.variables())), low_(x_.size(), 0.0) {}

RBDYN_INLINE void Projections::apply(std::span<double> x, std::span<double> low, double step, double t) const {
    if (map_.has_all()) {
        for (const auto& p : parts_) p->apply(x, low, step, t);
        return;
    }
    map_.spread(x, x_);
    map_.spread_zero(low, low_);
    for (const auto& p : parts_) p->apply(x_, low_, step, t);
    map_.gather(x_, x);
    map_.gather(low_, low);
}

RBDYN_INLINE bool Projections::makes_up_for_rounding() const {
    return std::all_of(parts_.begin(), parts_.end(), [](const auto& p) { return p->makes_up_for_rounding(); });
}

}  // namespace rbdyn::inline RBDYN_FORM
