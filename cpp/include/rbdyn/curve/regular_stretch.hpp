// The stretch of a curve around a parameter on which its tangent is known to be defined, found as it is asked for.
//
// Where r' = 0 (a cusp, or a parameter that stands still), jumps (a corner) or has no end (a slope that becomes
// vertical), the motion along a curve has no law by its parameter, though series in time may well go on through such a
// point: at a cusp that is reached without speed u grows evenly with time. So where a bead is about to go is looked at
// beforehand.
//
// On [a, b] with the middle m and the half h, r' does not vanish and keeps its size if |r'(m)| > 2 h max |r''|, r'' at
// a, m and b; it does not jump if it changes from a to b by no more than these allow, or by less than 1e-9 of itself.
// Else the interval is halved. A singular point is where halving ends at the spacing of numbers.
// A corner that a case distinction makes is met as the event that it is, too: between places that are looked at there
// may be two that make up for each other.
// Invariant: what has been looked at once is not looked at again.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/curve/curve.hpp"

namespace rbdyn::curves {

class RegularStretch {
public:
    RegularStretch(Curve curve, double u) : curve_(std::move(curve)), domain_(curve_.domain()), low_(u), high_(u) {}

    const Curve& curve() const { return curve_; }

    /// Begins anew around a parameter that motion along the curve has not led to.
    void include(double u) {
        if ((u >= low_ && u <= high_) || is_round()) return;
        low_ = high_ = u;
        below_ = above_ = std::nullopt;
    }

    /// The nearest parameter, if any, in [low, high] beyond which the curve is singular, going from where it is regular
    /// already: of its next singular point above, or below.
    std::optional<double> end_above(double high) {
        high = std::min(high, domain_.end);
        // a little farther, so that it is not asked for little by little
        if (!above_ && high > high_ && !is_round())
            extend(std::min(high + 0.25 * (high - low_), domain_.end), high_, above_);
        return above_ && high >= *above_ ? above_ : std::nullopt;
    }
    std::optional<double> end_below(double low) {
        low = std::max(low, domain_.begin);
        if (!below_ && low < low_ && !is_round())
            extend(std::max(low - 0.25 * (high_ - low), domain_.begin), low_, below_);
        return below_ && low <= *below_ ? below_ : std::nullopt;
    }

    /// The largest |r''| / |r'| that has been seen.
    double sharpness() const { return sharpness_; }

private:
    /// All of a closed curve.
    bool is_round() const { return curve_.closed() && high_ - low_ >= curve_.period(); }

    /// Goes from `known` to a parameter, as far as the curve is regular.
    void extend(double to, double& known, std::optional<double>& end) {
        // the next places to reach, the nearest last; each is halfway to the one before
        std::vector<double> ahead{to};
        const double least = 0x1p-80 * std::abs(to - known);
        while (!ahead.empty()) {
            const double next = ahead.back();
            if (is_regular(known, next)) {
                known = next;
                ahead.pop_back();
                continue;
            }
            const double middle = known + 0.5 * (next - known);
            if (middle == known || middle == next || std::abs(next - known) <= least) {
                end = known;
                return;
            }
            ahead.push_back(middle);
        }
    }

    bool is_regular(double a, double b) {
        const Rates middle = rates(a + 0.5 * (b - a)), first = rates(a), last = rates(b);
        const bool is_defined =
            first.speed > 0.0 && last.speed > 0.0 && std::isfinite(first.speed + last.speed + middle.speed);
        const double change = std::abs(b - a) * std::max({middle.bend, first.bend, last.bend});
        constexpr double unseen = 1e-9;
        return is_defined && middle.speed > change &&
               norm(last.first - first.first) <= 4.0 * change + unseen * middle.speed;
    }
    /// r', |r'| and |r''|.
    struct Rates {
        Vector3 first;
        double speed, bend;
    };
    Rates rates(double u) {
        const CurvePoint<double> p = curve_.own(u);
        const Rates r{p.first, norm(p.first), norm(p.second)};
        if (r.bend > sharpness_ * r.speed) sharpness_ = r.bend / r.speed;
        return r;
    }

    Curve curve_;
    Domain domain_;
    double low_, high_, sharpness_ = 0.0;
    std::optional<double> below_, above_;
};

/// Parameters of a curve next to its singular points, those around u: all over it, or within 32 units of its parameter
/// where it has no end; the first few hundred.
inline std::vector<double> singular_points(const Curve& curve, double u) {
    constexpr double reach = 32.0, past = 0x1p-20;
    constexpr int most = 256;
    const Domain d = curve.domain();
    const double once = curve.period() > 0.0 ? 0.5 * curve.period() : reach;
    const double low = std::isfinite(d.begin) ? d.begin : u - once, high = std::isfinite(d.end) ? d.end : u + once;
    std::vector<double> points;
    for (const double sign : {1.0, -1.0}) {
        const double last = sign > 0.0 ? high : low;
        for (double from = u; sign * (last - from) > 0.0 && points.size() < most;) {
            RegularStretch stretch(curve, from);
            const auto end = sign > 0.0 ? stretch.end_above(last) : stretch.end_below(last);
            if (!end) break;
            points.push_back(*end);
            from = *end + sign * past * std::max(1.0, std::abs(*end));
        }
    }
    return points;
}

}  // namespace rbdyn::curves
