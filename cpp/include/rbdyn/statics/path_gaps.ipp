// Definitions of rbdyn/statics/path_equilibria.hpp: zeros of Q where it has no series, as beside a branch point.
#pragma once

#include "rbdyn/statics/path_equilibria.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/path_pieces.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Values of Q in a gap.
class PathEquilibria::Sampler {
public:
    Sampler(const PathForces& forces, PathPieces& pieces, double width)
        : pieces_(pieces), values_(forces), width_(width) {}

    double value(double u) { return values_(u); }
    Sample at(double u) {
        const double q = values_(u);
        const bool is_felt = !std::isfinite(q) || std::abs(q) > pieces_.noise_at(u, width_);
        return {u, q, !is_felt ? 0 : q < 0.0 ? -1 : 1};
    }

private:
    PathPieces& pieces_;
    PathForces::Values values_;
    double width_;
};

RBDYN_INLINE std::vector<statics::PathGap> PathEquilibria::joined_gaps() const {
    std::vector<Gap> all = gaps_;
    for (Gap& gap : all)
        if (gap.from > gap.to) std::swap(gap.from, gap.to);
    std::erase_if(all, [](const Gap& gap) { return gap.from == gap.to; });
    std::sort(all.begin(), all.end(), [](const Gap& a, const Gap& b) { return a.from < b.from; });
    const auto join = [](Gap& gap, const Gap& next, double shift) {
        gap.to = next.to + shift;
        for (const double u : next.changes) gap.changes.push_back(u + shift);
    };
    std::vector<Gap> joined;
    for (const Gap& gap : all) {
        if (!joined.empty() && joined.back().to >= gap.from)
            join(joined.back(), gap, 0.0);
        else
            joined.push_back(gap);
    }
    // across the seam of one round
    if (round_ > 0.0 && joined.size() > 1 && joined.front().from <= low_ && joined.back().to >= high_) {
        join(joined.back(), joined.front(), round_);
        joined.erase(joined.begin());
    }
    return joined;
}

RBDYN_INLINE std::vector<double> PathEquilibria::places_in(const Gap& gap) {
    // and a little beyond its ends, where the force goes on
    const double width = gap.to - gap.from, beside = 0.125 * width;
    constexpr int steps = 64;
    std::vector<double> centers = gap.changes, places;
    if (gap.from <= 0.0 && gap.to >= 0.0) centers.push_back(0.0);
    for (int k = -steps / 8; k <= steps + steps / 8; ++k) places.push_back(gap.from + width * k / steps);
    for (const double center : centers) {
        places.push_back(center);
        // as near as doubles tell, which at zero is far on
        int halvings = 0;
        for (double part = 0.5; center + width * part != center; part *= halvings++ < steps ? 0.5 : 0x1p-8)
            for (const double way : {-1.0, 1.0}) places.push_back(center + way * width * part);
    }
    std::erase_if(places, [&](double u) { return u < gap.from - beside || u > gap.to + beside; });
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
}

RBDYN_INLINE void PathEquilibria::find_in_gaps() {
    gaps_ = joined_gaps();
    for (Gap& gap : gaps_) {
        const double beside = 0.125 * (gap.to - gap.from);
        if (const auto u = pieces_.change_between(gap.from - beside, gap.to + beside)) gap.changes.push_back(*u);
        find_in(gap);
    }
}

RBDYN_INLINE void PathEquilibria::find_in(const Gap& gap) {
    Sampler values(forces_, pieces_, gap.to - gap.from);
    std::vector<Sample> all;
    for (const double u : places_in(gap))
        if (const Sample s = values.at(u); !std::isnan(s.q)) all.push_back(s);
    // where it comes nearest to zero between places, closed in on by thirds
    const auto away = [](const Sample& s, int sign) { return sign * s.q; };
    std::vector<Sample> nearest;
    for (std::size_t i = 1; i + 1 < all.size(); ++i) {
        const int sign = all[i].sign;
        if (sign == 0 || all[i - 1].sign != sign || all[i + 1].sign != sign) continue;
        const double here = away(all[i], sign), before = away(all[i - 1], sign), after = away(all[i + 1], sign);
        if (!(here < before && here <= after && here < 0.95 * std::max(before, after))) continue;
        double low = all[i - 1].u, high = all[i + 1].u;
        for (int k = 0; k < 128; ++k) {
            const double third = (high - low) / 3.0;
            const Sample a = values.at(low + third), b = values.at(high - third);
            if (!(a.u > low && b.u > a.u && high > b.u)) break;
            if (a.sign != sign || b.sign != sign) {
                nearest.push_back(a.sign != sign ? a : b);
                break;
            }
            if (away(a, sign) < away(b, sign))
                high = b.u;
            else
                low = a.u;
        }
    }
    all.insert(all.end(), nearest.begin(), nearest.end());
    std::sort(all.begin(), all.end(), [](const Sample& a, const Sample& b) { return a.u < b.u; });
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].sign == 0) continue;
        if (last && all[*last].sign != all[i].sign) {
            add_between(values, all[*last], all[i], gap);
        } else if (last && i - *last > 1) {
            // rounding in between
            const double from = all[*last + 1].u, to = all[i - 1].u, place = center_of(gap, from, to);
            const double aside = 32.0 * std::max(place - all[*last].u, all[i].u - place);
            if (!grows_from(values, place - aside, all[*last].q) && !grows_from(values, place + aside, all[i].q))
                add_in_gap(place, all[*last].sign, all[i].sign, gap.to - gap.from);
        }
        last = i;
    }
}

RBDYN_INLINE bool PathEquilibria::grows_from(Sampler& values, double beside, double q) const {
    if (!std::isfinite(q)) return true;
    return beside >= low_ && beside <= high_ && std::abs(q) > 1.1 * std::abs(values.value(beside));
}

RBDYN_INLINE double PathEquilibria::center_of(const Gap& gap, double from, double to) {
    for (const double u : gap.changes)
        if (u >= from && u <= to) return u;
    return from <= 0.0 && to >= 0.0 ? 0.0 : from + 0.5 * (to - from);
}

RBDYN_INLINE void PathEquilibria::add_between(Sampler& values, const Sample& before, const Sample& after,
                                              const Gap& gap) {
    double low = before.u, high = after.u, at_low = before.q, at_high = after.q;
    for (int k = 0; k < 1200; ++k) {
        const double middle = low + 0.5 * (high - low);
        if (!(middle > low && middle < high)) break;
        const double q = values.value(middle);
        if (std::isnan(q)) break;
        ((q < 0.0) == (at_low < 0.0) ? low : high) = middle;
        ((q < 0.0) == (at_low < 0.0) ? at_low : at_high) = q;
    }
    const double aside = 0x1p10 * (high - low);
    if (grows_from(values, low - aside, at_low) || grows_from(values, high + aside, at_high)) return;
    // where it is zero to rounding a place that is one in itself goes before others
    double place = std::abs(at_low) < std::abs(at_high) ? low : high;
    for (const double u : gap.changes)
        if (u >= before.u && u <= after.u && values.at(u).sign == 0) place = u;
    if (before.u < 0.0 && after.u > 0.0 && values.at(0.0).sign == 0) place = 0.0;
    add_in_gap(place, before.sign, after.sign, gap.to - gap.from);
}

RBDYN_INLINE void PathEquilibria::add_in_gap(double u, int before, int after, double width) {
    u = in_window(u);
    if (round_ == 0.0 && (u < low_ || u > high_)) return;
    Point point{u, width, before > 0 && after < 0, is_pushed(u)};
    point.order = corner;
    point.radius = 4.0 * epsilon * std::abs(u);
    point.before = before;
    point.after = after;
    // one that is a place as others to its series has a slope, which values on both sides bear out
    const double half = 0x1p-36 * std::abs(u);
    if (point.stable && half > 0.0) {
        const double slope = pieces_.about(u, half).output[along][1];
        const auto bears_out = [&](double way) {
            return std::abs(way * forces_.along_path(u + way * half) - slope) <= 0x1p-10 * std::abs(slope);
        };
        if (slope < 0.0 && bears_out(1.0) && bears_out(-1.0)) point.slope = slope / half;
    }
    points_.push_back(point);
}

}  // namespace rbdyn::inline RBDYN_FORM
