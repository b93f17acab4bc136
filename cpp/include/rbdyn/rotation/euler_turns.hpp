// Euler angles with their turns at any time of a motion that repeats itself, without walking through it.
//
// A free body, and a heavy top about its vertical, repeat their attitude after a period but for a turn about an axis
// fixed in the world (K, the vertical). In axes whose third is that one, with A the turn from these to the world's,
//     u = w + i z = c e^{i s},  f = x + i y = d e^{i r},
// c and d have the period T, and the lifted arguments s and r grow by the same from period to period. In the world
//     w + i z = A1 u - A2 conj(f),   x + i y = A1 f + A2 conj(u),   A = (A1, A2) in the same form,
// each a sum of two terms p + q. While |p| > |q| its lifted argument is that of p and at most a quarter turn, while
// |q| > |p| that of q; where they change places it gains as many turns as arg p - arg q has, rounded. These are the
// same places D_j in every period but for a turn that grows evenly, D_j + n Delta, so the turns gained in n periods are
// sums of floor(alpha n + beta), which are known without adding them up (as a greatest common divisor is found).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A motion's attitude comes back after a period, turned about an axis [s; world axes].
struct Recurrence {
    Vector3 axis;
    double period;
};

/// sum of floor(alpha i + beta), i = 0 .. n-1, in about log n steps.
long double floor_sum(std::int64_t n, long double alpha, long double beta);

class EulerTurns {
public:
    /// From the attitude as a function of time, over one period from time `start` on, where the angles are known. None
    /// if the motion does not come back as it should, or passes along its own axis.
    template <class Motion>
    static std::optional<EulerTurns> of(const Recurrence& r, const EulerStep& start, Motion&& motion) {
        if (!(r.period > 0.0) || !std::isfinite(r.period) || !(r.axis.norm() > 0.0)) return std::nullopt;
        EulerTurns result(r, start);
        if (!result.walk(motion)) return std::nullopt;
        result.begin_ = result.lifted(start.time, motion(start.time).attitude);
        result.choose_sheet();
        return result;
    }

    /// The turns of a period as exactly as times up to t need them, where a component is so small that its argument
    /// has few digits: by periods doubled, each known well enough from those before.
    template <class Motion>
    void reach(double t, Motion&& motion) {
        const Lift first = samples_.front().lift;
        for (; first_ + 2.0 * counted_ * period_ <= t; counted_ *= 2.0) {
            const double n = 2.0 * counted_;
            const Quaternion q = to_axis_ * motion(first_ + n * period_).attitude;
            const Lift there = next_to({first.s + n * growth_.s, first.r + n * growth_.r}, q);
            growth_ = {(there.s - first.s) / n, (there.r - first.r) / n};
        }
    }

    /// The angles at a time at or after that start, where the attitude is `now`; none if they do not give it.
    std::optional<EulerAngles> at(double t, const Quaternion& now) const;

private:
    using Complex = std::complex<double>;

    /// Arguments of u and f without jumps.
    struct Lift {
        double s, r;
    };
    struct Sample {
        double time;
        Lift lift;
    };
    /// Where the terms of a sum change places, by arg p - arg q; +1: from then on q is the larger.
    struct Swap {
        double time, difference;
        int sign;
    };
    struct Lifted {
        double theta, psi, phi;
    };
    struct Terms {
        double p, q, arg_p, arg_q;  // sizes and lifted arguments
        bool differ() const { return std::abs(p - q) > std::max(tie * (p + q), rounding); }
    };

    EulerTurns(const Recurrence& r, const EulerStep& start);

    /// (-theta, psi + pi, phi + pi) are the same attitude: which of the two the angles began with.
    void choose_sheet();

    static Complex upright(const Quaternion& q) { return {q.w, q.z}; }
    static Complex fallen(const Quaternion& q) { return {q.x, q.y}; }

    Terms terms_of(int which, const Quaternion& q, const Lift& lift) const;

    /// The argument next to a known one.
    static double next_to(double known, double argument) { return rotations::nearest(argument, known); }
    static Lift next_to(const Lift& known, const Quaternion& q);

    static double smaller(const Quaternion& q) { return std::min(std::abs(upright(q)), std::abs(fallen(q))); }
    /// How long the arguments take to turn by a tenth or so; the spin alone moves none but evenly [s].
    static double longest(const Quaternion& q, const Vector3& omega);

    /// Through one period: lifts, and where terms change places.
    template <class Motion>
    bool walk(Motion&& motion) {
        const auto seen = [&](double t) {
            Turning now = motion(t);
            now.attitude = to_axis_ * now.attitude;
            return now;
        };
        Turning now = seen(first_);
        const Quaternion at_start = now.attitude;
        Quaternion q = at_start;
        double t = first_;
        Lift lift{std::arg(upright(q)), std::arg(fallen(q))};
        samples_.push_back({t, lift});
        std::array<Terms, 2> before{terms_of(0, q, lift), terms_of(1, q, lift)};
        bool ever[2] = {false, false}, any[2] = {false, false};  // whether the terms of a sum ever differ, ever are
        const double end = first_ + period_;
        double widest = 0.0;
        for (int steps = 0; t < end; ++steps) {
            if (steps > most_steps) return false;
            const double far = longest(q, now.angular_velocity);
            double step = std::min(far, end - t);
            Turning then = seen(t + step);
            while (step > 2.0 * longest(then.attitude, then.angular_velocity) && step > 1e-12 * period_) {
                step *= 0.5;
                then = seen(t + step);
            }
            // along the axis one of the two is nothing all the time, or this is no way to go
            const double least = smaller(q), less = smaller(then.attitude);
            widest = std::max(widest, least);
            if (less <= none && least > none && widest > 100.0 * none) return false;
            const double later = end - (t + step) <= 1e-12 * period_ ? end : t + step;
            const Lift there = next_to(lift, then.attitude);
            for (int which : {0, 1}) {
                const Terms after = terms_of(which, then.attitude, there);
                const Terms& was = before[static_cast<std::size_t>(which)];
                any[which] = any[which] || after.p > none || after.q > none;
                ever[which] = ever[which] || after.differ() || was.differ();
                if ((was.p > was.q) != (after.p > after.q))
                    swaps_[which].push_back(swap(which, seen, t, later, lift, was.p > was.q));
                before[static_cast<std::size_t>(which)] = after;
            }
            t = later;
            q = then.attitude;
            now = then;
            lift = there;
            samples_.push_back({t, lift});
        }
        growth_ = {lift.s - samples_.front().lift.s, lift.r - samples_.front().lift.r};
        for (int which : {0, 1}) {
            ties_[which] = !ever[which];
            gone_[which] = !any[which];
            if (ties_[which]) swaps_[which].clear();
            if (swaps_[which].size() % 2 != 0) return false;
        }
        return std::abs(std::abs(upright(q)) - std::abs(upright(at_start))) < 1e-9;
    }

    template <class Seen>
    Swap swap(int which, Seen&& seen, double lo, double hi, const Lift& known, bool p_first) const {
        for (int i = 0; i < 60 && hi - lo > 1e-15 * std::abs(hi); ++i) {
            const double middle = 0.5 * (lo + hi);
            const Quaternion q = seen(middle).attitude;
            const Terms x = terms_of(which, q, next_to(known, q));
            ((x.p > x.q) == p_first ? lo : hi) = middle;
        }
        const Quaternion q = seen(hi).attitude;
        const Terms x = terms_of(which, q, next_to(known, q));
        return {hi, x.arg_p - x.arg_q, p_first ? 1 : -1};
    }

    Lifted lifted(double t, const Quaternion& attitude) const;

    /// Turns gained up to a time in the period after n.
    double turns(int which, double n, double within) const;

    // a component of nothing; two terms that are one size, of their own and of all; of a period near a separatrix
    static constexpr double none = 1e-13, tie = 1e-12, rounding = 4e-15;
    static constexpr int most_steps = 100000;

    double period_, first_;
    double counted_ = 1.0;  // periods of which the turns are known
    EulerAngles start_;
    Lifted begin_{0.0, 0.0, 0.0};
    Quaternion to_axis_;
    Complex a1_, a2_;
    std::vector<Sample> samples_;
    Lift growth_{0.0, 0.0};
    std::vector<Swap> swaps_[2];
    bool ties_[2] = {false, false}, gone_[2] = {false, false};  // through zero, and zero for ever
    double sheet_ = 1.0;
};

}  // namespace rbdyn::inline RBDYN_FORM
