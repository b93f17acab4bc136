// Definitions of rbdyn/closed_form/linear_oscillator.hpp.
#pragma once

#include "rbdyn/closed_form/linear_oscillator.hpp"

#include <algorithm>
#include <cmath>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/phase.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE LinearOscillator::LinearOscillator(const Coefficients& c, const DoubleDouble& position,
                                                const DoubleDouble& velocity)
    : start_{position.hi, velocity.hi}, half_damping_(c.damping * 0.5) {
    const DoubleDouble square = half_damping_ * half_damping_ - c.stiffness;
    stiffness_ = c.stiffness.hi;
    force_ = c.force.hi;
    pull_ = (c.force - c.stiffness * position).hi;
    const double g = std::abs(half_damping_.hi);
    fastest_ = std::max(g, std::sqrt(std::abs(stiffness_)));
    oscillates_ = square.hi < 0.0;
    if (oscillates_) {
        turn_ = sqrt(-square).hi;
        phase_ = Phase(sqrt(-square), 0.0, {2.0 * double_double::pi.hi, 2.0 * double_double::pi.lo});
        return;
    }
    // the exponent of larger size, and the other from their product
    const DoubleDouble far = half_damping_.hi < 0.0 ? sqrt(square) - half_damping_ : -sqrt(square) - half_damping_;
    const DoubleDouble near = far.hi == 0.0 ? DoubleDouble(0.0) : c.stiffness / far;
    upper_ = half_damping_.hi < 0.0 ? far : near;
    lower_ = half_damping_.hi < 0.0 ? near : far;
    gap_ = sqrt(square) * 2.0;
    apart_ = gap_.hi > g;
    if (!apart_ || !(upper_.hi > 0.0) || lower_.hi == 0.0) return;
    grown_ = (velocity - lower_ * position + c.force / upper_) / gap_;
    shrunk_ = (velocity - upper_ * position + c.force / lower_) / gap_;
    level_ = c.force / c.stiffness;
}

RBDYN_INLINE LinearOscillator::State LinearOscillator::at(Instant t) const {
    if (t.hi == 0.0 && t.lo == 0.0) return start_;
    if (grows(t)) {
        const double high = exp_in<double>(upper_ * DoubleDouble(t)), low = exp_in<double>(lower_ * DoubleDouble(t));
        return {grown_.hi * high - shrunk_.hi * low + level_.hi,
                grown_.hi * upper_.hi * high - shrunk_.hi * lower_.hi * low};
    }
    const Kernels k = oscillates_ ? turning(t) : creeping(t);
    return {k.d * start_.position + k.s * start_.velocity + k.q * force_, k.rise * start_.velocity + k.s * pull_};
}

RBDYN_INLINE LinearOscillator::State LinearOscillator::errors(double t) const {
    const Instant time{t, 0.0};
    if (grows(time)) {
        const double high = std::abs(exp_in<double>(upper_ * DoubleDouble(t))),
                     low = std::abs(exp_in<double>(lower_ * DoubleDouble(t)));
        const double a = std::abs(grown_.hi) * high, b = std::abs(shrunk_.hi) * low;
        return {error(t) * (a + b + std::abs(level_.hi)),
                error(t) * (a * std::abs(upper_.hi) + b * std::abs(lower_.hi))};
    }
    const Kernels k = oscillates_ ? turning(time) : creeping(time);
    return {error(t) * (std::abs(k.d * start_.position) + std::abs(k.s * start_.velocity) + std::abs(k.q * force_)),
            error(t) * (std::abs(k.rise * start_.velocity) + std::abs(k.s * pull_))};
}

RBDYN_INLINE LinearOscillator::Kernels LinearOscillator::turning(Instant t) const {
    const double decay = exp_in<double>(-half_damping_ * DoubleDouble(t)), g = half_damping_.hi;
    const auto [sine, cosine] = sine_cosine_in<double>(phase_.at(t).rest);
    const double s = decay * sine / turn_, even = decay * cosine;
    const double d = even + g * s;
    return {s, even - g * s, d, small(t) ? series(t.hi) : (1.0 - d) / stiffness_};
}

RBDYN_INLINE LinearOscillator::Kernels LinearOscillator::creeping(Instant t) const {
    const DoubleDouble time(t);
    const double high = exp_in<double>(upper_ * time), low = exp_in<double>(lower_ * time), gap = gap_.hi;
    // (high - low)/gap from the larger of both
    const double ratio = gap == 0.0 ? t.hi : std::expm1(std::abs(gap * t.hi)) / gap * (t.hi < 0.0 ? -1.0 : 1.0);
    const double s = std::abs(gap * t.hi) < 1.0 ? (t.hi < 0.0 ? high : low) * ratio : (high - low) / gap;
    const double even = 0.5 * (high + low), g = half_damping_.hi;
    const double d = apart_ ? (upper_.hi * low - lower_.hi * high) / gap : even + g * s;
    const double rise = apart_ ? (upper_.hi * high - lower_.hi * low) / gap : even - g * s;
    double q = 0.0;
    if (small(t))
        q = series(t.hi);
    else
        q = apart_ ? (integral(upper_, t.hi) - integral(lower_, t.hi)) / gap : (1.0 - d) / stiffness_;
    return {s, rise, d, q};
}

RBDYN_INLINE bool LinearOscillator::grows(Instant t) const {
    return apart_ && upper_.hi * t.hi > 1.0 && std::abs(lower_.hi * t.hi) > 0.5 && lower_.hi != 0.0;
}

RBDYN_INLINE double LinearOscillator::integral(const DoubleDouble& rate, double t) {
    return rate.hi == 0.0 ? t : std::expm1(rate.hi * t) / rate.hi;
}

RBDYN_INLINE double LinearOscillator::series(double t) const {
    double before = 0.0, term = 0.5 * t * t, sum = term;
    for (int n = 3; n < 20; ++n) {
        const double next = -t * (2.0 * half_damping_.hi * (n - 1) * term + stiffness_ * t * before) / (n * (n - 1));
        before = term;
        term = next;
        sum += term;
    }
    return sum;
}

}  // namespace rbdyn::inline RBDYN_FORM
