// Definitions of rbdyn/curve/regular_stretch.hpp.
#pragma once

#include "rbdyn/curve/regular_stretch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE void RegularStretch::include(double u) {
    if ((u >= low_ && u <= high_) || is_round()) return;
    low_ = high_ = u;
    below_ = above_ = std::nullopt;
}

RBDYN_INLINE std::optional<double> RegularStretch::end_above(double high) {
    high = std::min(high, domain_.end);
    // a little farther, so that it is not asked for little by little
    if (!above_ && high > high_ && !is_round())
        extend(std::min(high + 0.25 * (high - low_), domain_.end), high_, above_);
    return above_ && high >= *above_ ? above_ : std::nullopt;
}

RBDYN_INLINE std::optional<double> RegularStretch::end_below(double low) {
    low = std::max(low, domain_.begin);
    if (!below_ && low < low_ && !is_round()) extend(std::max(low - 0.25 * (high_ - low), domain_.begin), low_, below_);
    return below_ && low <= *below_ ? below_ : std::nullopt;
}

RBDYN_INLINE void RegularStretch::extend(double to, double& known, std::optional<double>& end) {
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

RBDYN_INLINE bool RegularStretch::is_regular(double a, double b) {
    const Rates middle = rates(a + 0.5 * (b - a)), first = rates(a), last = rates(b);
    const bool is_defined =
        first.speed > 0.0 && last.speed > 0.0 && std::isfinite(first.speed + last.speed + middle.speed);
    const double change = std::abs(b - a) * std::max({middle.bend, first.bend, last.bend});
    constexpr double unseen = 1e-9;
    return is_defined && middle.speed > change &&
           norm(last.first - first.first) <= 4.0 * change + unseen * middle.speed;
}

RBDYN_INLINE RegularStretch::Rates RegularStretch::rates(double u) {
    const CurvePoint<double> p = curve_.own(u);
    const Rates r{p.first, norm(p.first), norm(p.second)};
    if (r.bend > sharpness_ * r.speed) sharpness_ = r.bend / r.speed;
    return r;
}

RBDYN_INLINE std::vector<double> singular_points(const Curve& curve, double u) {
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

}  // namespace rbdyn::inline RBDYN_FORM::curves
