// Definitions of rbdyn/closed_form/kepler_motion.hpp.
#pragma once

#include "rbdyn/closed_form/kepler_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool KeplerMotion::is_radial(const Vector3Of<DoubleDouble>& place,
                                          const Vector3Of<DoubleDouble>& velocity) {
    const double momentum = rounded(cross<DoubleDouble>(place, velocity)).norm();
    return !(momentum > 1e-30 * rounded(place).norm() * rounded(velocity).norm());
}

RBDYN_INLINE KeplerMotion::KeplerMotion(const DoubleDouble& mu, const Vector3Of<DoubleDouble>& place,
                                        const Vector3Of<DoubleDouble>& velocity)
    : start_{place, velocity},
      mu_(mu),
      r0_(sqrt(dot<DoubleDouble>(place, place))),
      e0_(dot<DoubleDouble>(place, velocity)),
      period_(std::numeric_limits<double>::infinity()) {
    const DoubleDouble kinetic = dot<DoubleDouble>(velocity, velocity), potential = 2.0 * mu / r0_;
    b_ = potential - kinetic;
    root_ = sqrt(abs(b_));
    const bool is_closed = b_.hi > 0.0 && mu.hi > 0.0;
    if (is_closed) period_ = 4.0 * double_double::half_pi * mu / (b_ * root_);
    const Vector3Of<DoubleDouble> h = cross<DoubleDouble>(place, velocity);
    const double momentum = rounded(h).norm(), under = mu.hi * mu.hi - b_.hi * momentum * momentum;
    pericentre_ = momentum * momentum / (mu.hi + std::sqrt(std::max(under, 0.0)));
    largest_speed_ = momentum / pericentre_;
    // a relative error of b is one and a half times that of the period
    sensitivity_ = is_closed ? 1.5 * (std::abs(potential.hi) + kinetic.hi) / b_.hi : 0.0;
}

RBDYN_INLINE KeplerMotion::G KeplerMotion::functions(const DoubleDouble& s) const {
    const DoubleDouble p = b_ * s * s;
    if (std::abs(p.hi) < 1.0) {
        // 1/2! - p/4! + ..., 1/3! - p/5! + ...: fifteen terms reach 1e-33
        DoubleDouble c2 = 1.0, c3 = 1.0;
        for (int n = 28; n > 0; n -= 2) {
            c2 = 1.0 - p * c2 / static_cast<double>((n + 1) * (n + 2));
            c3 = 1.0 - p * c3 / static_cast<double>((n + 2) * (n + 3));
        }
        const DoubleDouble s2 = s * s, g2 = 0.5 * s2 * c2, g3 = s2 * s * c3 / 6.0;
        return {1.0 - b_ * g2, s - b_ * g3, g2, g3};
    }
    const DoubleDouble angle = root_ * s;
    G g;
    if (b_.hi > 0.0) {
        const auto [sine, cosine] = sine_cosine(angle);
        g.g0 = cosine;
        g.g1 = sine / root_;
    } else {
        g.g0 = cosh(angle);
        g.g1 = sinh(angle) / root_;
    }
    g.g2 = (1.0 - g.g0) / b_;
    g.g3 = (s - g.g1) / b_;
    return g;
}

RBDYN_INLINE DoubleDouble KeplerMotion::anomaly(const DoubleDouble& t) const {
    // t grows with s, by r at least the pericentre: the root lies between 0 and t over that, or within a turn. What the
    // pericentre of a circle is known to is allowed for
    DoubleDouble low = 0.0, high = 2.0 * t / pericentre_;
    if (t.hi < 0.0) std::swap(low, high);
    if (std::isfinite(period_.hi)) {
        const DoubleDouble turn = 4.0 * double_double::half_pi / root_;
        high = std::min(high.hi, turn.hi);
        low = std::max(low.hi, -turn.hi);
    }
    // Newton's steps where they halve the last one and stay between; else the middle: what grows exponentially is
    // climbed down too slowly
    DoubleDouble s = std::clamp(t.hi / r0_.hi, low.hi, high.hi);
    double last = high.hi - low.hi;
    for (int i = 0; i < 2000; ++i) {
        const G g = functions(s);
        const DoubleDouble off = r0_ * g.g1 + e0_ * g.g2 + mu_ * g.g3 - t, r = r0_ * g.g0 + e0_ * g.g1 + mu_ * g.g2;
        if (off.hi == 0.0) return s;
        // what overflows is beyond, on the side of t
        const bool is_beyond = std::isfinite(off.hi) ? off.hi > 0.0 : t.hi > 0.0;
        (is_beyond ? high : low) = s;
        DoubleDouble next = s - off / r;
        double change = std::abs((next - s).hi);
        const bool is_last = change <= 0x1p-54 * std::abs(s.hi);
        if (!is_last && !(next.hi >= low.hi && next.hi <= high.hi && change <= 0.5 * last)) {
            next = 0.5 * (low + high);
            change = std::abs((next - s).hi);
            // what is left is the rounding of Kepler's equation itself
            if (change <= 0x1p-90 * std::abs(s.hi)) return next;
        }
        last = change;
        s = next;
        if (is_last) return s;  // the next one would be beyond 32 digits
    }
    return std::numeric_limits<double>::quiet_NaN();
}

RBDYN_INLINE KeplerMotion::State KeplerMotion::at(Instant when) const {
    if (when.hi == 0.0 && when.lo == 0.0) return start_;
    DoubleDouble t(when);
    if (std::isfinite(period_.hi)) t -= period_ * std::nearbyint((t / period_).hi);
    const G g = functions(anomaly(t));
    const DoubleDouble r = r0_ * g.g0 + e0_ * g.g1 + mu_ * g.g2;
    const DoubleDouble f = 1.0 - mu_ * g.g2 / r0_, h = t - mu_ * g.g3;
    const DoubleDouble f1 = -mu_ * g.g1 / (r * r0_), h1 = 1.0 - mu_ * g.g2 / r;
    return {start_.place * f + start_.velocity * h, start_.place * f1 + start_.velocity * h1};
}

RBDYN_INLINE double KeplerMotion::error(double t) const {
    const double time = std::abs(t), fastest = largest_speed_ / pericentre_;
    const double turns = time > 0.5 * period_.hi ? sensitivity_ : 0.0;
    return std::min(2.0, noise * (1.0 + fastest * time * (1.0 + turns)));
}

}  // namespace rbdyn::inline RBDYN_FORM
