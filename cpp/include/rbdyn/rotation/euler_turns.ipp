// Definitions of rbdyn/rotation/euler_turns.hpp.
#pragma once

#include "rbdyn/rotation/euler_turns.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE long double floor_sum(std::int64_t n, long double alpha, long double beta) {
    if (n <= 0) return 0.0L;
    const long double a = std::floor(alpha), b = std::floor(beta), count = static_cast<long double>(n);
    const long double whole = a * count * (count - 1.0L) / 2.0L + b * count;
    alpha -= a;
    beta -= b;
    const long double last = std::floor(alpha * (count - 1.0L) + beta);
    if (last < 1.0L) return whole;
    // the same points counted by height: i reaches j from (j - beta)/alpha on
    return whole + count * last + floor_sum(static_cast<std::int64_t>(last), -1.0L / alpha, (beta - 1.0L) / alpha);
}

RBDYN_INLINE std::optional<EulerAngles> EulerTurns::at(double t, const Quaternion& now) const {
    const Lifted is = lifted(t, now);
    const EulerAngles guess{start_.theta + sheet_ * (is.theta - begin_.theta), start_.psi + (is.psi - begin_.psi),
                            start_.phi + (is.phi - begin_.phi)};
    const EulerAngles a = continue_from(guess, now);
    const double off =
        std::max({std::abs(a.theta - guess.theta), std::abs(a.psi - guess.psi), std::abs(a.phi - guess.phi)});
    // components are good to a few 1e-16, and their arguments to as much over their size
    const double nearest = std::min(std::abs(upright(now)), std::abs(fallen(now)));
    if (!(off < 1e-3 + 1e-14 / nearest)) return std::nullopt;
    return a;
}

RBDYN_INLINE EulerTurns::EulerTurns(const Recurrence& r, const EulerStep& start)
    : period_(r.period), first_(start.time), start_(start.angles) {
    // the shortest turn from the third axis to that of the motion; half a turn about the first if it is opposite
    const Vector3 e = r.axis / r.axis.norm();
    const double across = std::hypot(e[0], e[1]), up = e[2] > 0.0 ? 1.0 + e[2] : across * across / (1.0 - e[2]);
    Quaternion a{1.0, 0.0, 0.0, 0.0};
    if (across > 0.0 || e[2] < 0.0)
        a = across > 0.0 ? normalized(Quaternion{up, -e[1], e[0], 0.0}) : Quaternion{0.0, 1.0, 0.0, 0.0};
    to_axis_ = conjugate(a);
    a1_ = {a.w, a.z};
    a2_ = {a.x, a.y};
}

RBDYN_INLINE void EulerTurns::choose_sheet() {
    const auto off = [&](double sign, double half_turn) {
        return std::abs(rotations::nearest(start_.theta - sign * begin_.theta, 0.0)) +
               std::abs(rotations::nearest(start_.psi - begin_.psi - half_turn, 0.0)) +
               std::abs(rotations::nearest(start_.phi - begin_.phi - half_turn, 0.0));
    };
    sheet_ = off(1.0, 0.0) <= off(-1.0, std::numbers::pi) ? 1.0 : -1.0;
}

RBDYN_INLINE EulerTurns::Terms EulerTurns::terms_of(int which, const Quaternion& q, const Lift& lift) const {
    const double u = std::abs(upright(q)), f = std::abs(fallen(q));
    // w + i z = A1 u - A2 conj(f);  x + i y = A1 f + A2 conj(u)
    if (which == 0) return {std::abs(a1_) * u, std::abs(a2_) * f, std::arg(a1_) + lift.s, std::arg(-a2_) - lift.r};
    return {std::abs(a1_) * f, std::abs(a2_) * u, std::arg(a1_) + lift.r, std::arg(a2_) - lift.s};
}

RBDYN_INLINE EulerTurns::Lift EulerTurns::next_to(const Lift& known, const Quaternion& q) {
    return {std::abs(upright(q)) > none ? next_to(known.s, std::arg(upright(q))) : known.s,
            std::abs(fallen(q)) > none ? next_to(known.r, std::arg(fallen(q))) : known.r};
}

RBDYN_INLINE double EulerTurns::longest(const Quaternion& q, const Vector3& omega) {
    const double least = smaller(q), turn = 0.1 / omega.norm();
    return least > none ? std::min(turn, 0.25 * least / std::hypot(omega[0], omega[1])) : turn;
}

RBDYN_INLINE EulerTurns::Lifted EulerTurns::lifted(double t, const Quaternion& attitude) const {
    const Quaternion q = to_axis_ * attitude;
    const double periods = std::floor((t - first_) / period_), n = std::max(periods, 0.0);
    const double within = first_ + std::clamp((t - first_) - n * period_, 0.0, period_);
    auto later = std::upper_bound(samples_.begin(), samples_.end(), within,
                                  [](double time, const Sample& s) { return time < s.time; });
    const Lift& near = (later == samples_.begin() ? later : std::prev(later))->lift;
    const Lift lift = next_to({near.s + n * growth_.s, near.r + n * growth_.r}, q);
    double size[2], argument[2], difference[2];
    for (int which : {0, 1}) {
        const Terms x = terms_of(which, q, lift);
        difference[which] = x.arg_p - x.arg_q;
        if (ties_[which]) {
            // through zero and on: the size has a sign, the argument no turns of its own
            argument[which] = 0.5 * (x.arg_p + x.arg_q);
            size[which] = 2.0 * x.p * std::cos(0.5 * difference[which]);
            continue;
        }
        size[which] = std::abs(which == 0 ? upright(attitude) : fallen(attitude));
        const Complex turn = std::polar(1.0, difference[which]);
        const bool p_first = x.p > x.q;
        argument[which] = p_first ? x.arg_p + std::arg(1.0 + std::conj(turn) * (x.q / x.p))
                                  : x.arg_q + std::arg(1.0 + turn * (x.p / x.q));
        argument[which] += rotations::full_turn * turns(which, n, within);
    }
    // along the world's third axis for ever psi keeps its value
    for (int which : {0, 1})
        if (gone_[which]) argument[which] = -argument[1 - which];
    double theta = 2.0 * std::atan2(size[1], size[0]);
    if (ties_[0] && ties_[1] && !gone_[0] && !gone_[1]) {
        // end over end: theta grows as the turn about the axis
        const double sense = std::arg(-a2_) > std::arg(a2_) ? -1.0 : 1.0;
        theta +=
            2.0 * rotations::full_turn * std::round((sense * difference[0] - theta) / (2.0 * rotations::full_turn));
    }
    return {theta, argument[0] + argument[1], argument[0] - argument[1]};
}

RBDYN_INLINE double EulerTurns::turns(int which, double n, double within) const {
    const double per_turn = 1.0 / rotations::full_turn;
    const long double alpha =
        static_cast<long double>(growth_.s + growth_.r) / static_cast<long double>(rotations::full_turn);
    long double sum = 0.0L;
    for (const Swap& s : swaps_[which]) {
        const long double beta = static_cast<long double>(s.difference) * per_turn + 0.5L;
        const auto count = static_cast<std::int64_t>(n) + (s.time <= within ? 1 : 0);
        sum += s.sign * floor_sum(count, alpha, beta);
    }
    return static_cast<double>(sum);
}

}  // namespace rbdyn::inline RBDYN_FORM
