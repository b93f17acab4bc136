// Definitions of rbdyn/statics/path_equilibria.hpp.
#pragma once

#include "rbdyn/statics/path_equilibria.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "rbdyn/curve/point.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/path_pieces.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PathEquilibria::PathEquilibria(const Scene& scene, double place, bool asked)
    : forces_(scene), pieces_(forces_), place_(place) {
    const Domain d = forces_.domain();
    round_ = forces_.period();
    low_ = d.begin;
    high_ = d.end;
    if (forces_.is_on_hinge() && !repeats()) {
        round_ = 0.0;
    } else if (round_ > 0.0) {
        if (!std::isfinite(low_)) low_ = 0.0;
        high_ = low_ + round_;
    } else if (forces_.is_on_hinge()) {
        const auto [spring, reach] = wound();
        low_ = spring - reach;
        high_ = spring + reach;
    }
    walk(asked);
    std::vector<Piece> path;
    for (const Piece& p : path_) refine(p, 0, path);
    path_ = std::move(path);
}

RBDYN_INLINE std::vector<Equilibrium> PathEquilibria::find() {
    find_points();
    std::vector<Equilibrium> result;
    if (forces_.rough()) {
        find_held();
        for (const Interval& i : held_) result.push_back(resting(i, true));
    } else {
        for (const Interval& i : flat_) {
            result.push_back(resting(i, false));
            result.back().decided =
                std::none_of(felt_.begin(), felt_.end(), [&](double u) { return u >= i.first && u <= i.second; });
        }
        for (const Interval& i : hidden_) {
            result.push_back({{i.first + 0.5 * (i.second - i.first)}, false, i});
            result.back().decided = false;
        }
    }
    for (const Point& p : points_) {
        if (inside(forces_.rough() ? held_ : flat_, p.u)) continue;
        if (forces_.one_sided() && !p.pushed) continue;
        Equilibrium e{{p.u}, p.stable};
        e.decided = p.order > 0;
        if (forces_.rough()) e.interval = {p.u, p.u};
        if (p.stable && p.slope < 0.0)
            e.periods = {2.0 * std::numbers::pi * std::sqrt(-forces_.inertia(p.u) / p.slope)};
        result.push_back(std::move(e));
    }
    for (Equilibrium& e : result)
        if (e.stable && may_leave(e.coordinates[0])) e.stable = e.decided = false;
    if (forces_.is_on_hinge() && round_ > 0.0)
        for (Equilibrium& e : result) turn_back(e);
    std::sort(result.begin(), result.end(),
              [](const Equilibrium& a, const Equilibrium& b) { return a.coordinates[0] < b.coordinates[0]; });
    return result;
}

RBDYN_INLINE void PathEquilibria::find_held() {
    for (const Piece& p : path_) {
        const double noise = p.noise();
        std::vector<std::pair<double, int>> roots{{-1.0, -1}};
        for (const int k : {PathForces::hold, PathForces::push}) {
            if (k == PathForces::push && !forces_.one_sided()) continue;
            for (const double x :
                 statics::roots_about_middle(p.output[static_cast<std::size_t>(k)].data(), statics::order))
                roots.emplace_back(x, k);
        }
        roots.emplace_back(1.0, -1);
        std::sort(roots.begin(), roots.end());
        for (std::size_t j = 0; j + 1 < roots.size(); ++j) {
            const double x = 0.5 * (roots[j].first + roots[j + 1].first);
            if (p.value(PathForces::hold, x) < -hold_noise(p, x)) continue;
            if (forces_.one_sided() && p.value(PathForces::push, x) < -noise) continue;
            const auto [from, from_root] = roots[j];
            const auto [to, to_root] = roots[j + 1];
            const double begin = p.place(from), end = p.place(to);
            const bool joins =
                !held_.empty() && std::abs(begin - ends_.back().first) <= 1e-14 * (std::abs(begin) + p.half);
            if (!joins) {
                held_.emplace_back(from_root >= 0 ? polished(begin, p, from_root) : begin, end);
                ends_.emplace_back(end, to_root);
            }
            held_.back().second = to_root >= 0 ? polished(end, p, to_root) : end;
            ends_.back() = {end, to_root};
        }
    }
    finish(held_);
}

RBDYN_INLINE double PathEquilibria::polished(double u, const Piece& piece, int output) {
    const auto k = static_cast<std::size_t>(output);
    double last = 0.01, place = u;
    for (int iteration = 0; iteration < 6; ++iteration) {
        const Piece& p = pieces_.about(place, piece.half);
        const double x = -p.output[k][0] / p.output[k][1];
        if (!(std::abs(x) < last)) break;
        u = place;
        last = 0.5 * std::abs(x);
        place += piece.half * x;
        u = place;
    }
    return std::clamp(u, low_, high_);
}

RBDYN_INLINE void PathEquilibria::extend(std::vector<Interval>& intervals, std::size_t i) {
    const Piece& p = path_[i];
    if (!intervals.empty() && i > 0 && adjoin(intervals.back().second, p))
        intervals.back().second = p.end();
    else
        intervals.emplace_back(p.begin(), p.end());
}

RBDYN_INLINE void PathEquilibria::reach_changes() {
    const auto is_zero = [&](double u) {
        return std::abs(forces_.along_path(u)) <= 16.0 * epsilon * forces_.effort(u);
    };
    for (const Gap& gap : gaps_)
        for (const double change : gap.changes)
            for (Interval& i : flat_)
                for (double* end : {&i.first, &i.second})
                    if (*end >= gap.from && *end <= gap.to && is_zero(*end + 0.5 * (change - *end))) *end = change;
}

RBDYN_INLINE void PathEquilibria::finish(std::vector<Interval>& intervals) {
    if (intervals.empty() || path_.empty()) return;
    const auto near = [&](double a, double b, double half) { return std::abs(a - b) <= 1e-12 * half; };
    const Piece &first = path_.front(), &last = path_.back();
    bool is_constant = true;
    for (const Piece& p : path_) is_constant = is_constant && is_same_all_along(p);
    Interval &lowest = intervals.front(), &highest = intervals.back();
    const bool from_begin = near(lowest.first, first.begin(), first.half),
               to_end = near(highest.second, last.end(), last.half);
    if (from_begin && (std::isfinite(low_) || first.polynomial || is_constant)) lowest.first = low_;
    if (to_end && (std::isfinite(high_) || last.polynomial || is_constant)) highest.second = high_;
    if (round_ > 0.0 && from_begin && to_end && intervals.size() > 1) {
        lowest.first = highest.first - round_;
        intervals.pop_back();
    }
}

RBDYN_INLINE double PathEquilibria::in_window(double u) const {
    if (round_ == 0.0) return u;
    if (std::abs(u - high_) <= 8.0 * epsilon * high_) return low_;
    return u >= high_ ? u - round_ : u < low_ - 8.0 * epsilon * round_ ? u + round_ : std::max(u, low_);
}

RBDYN_INLINE double PathEquilibria::shifted(const Interval& i, double u) const {
    return round_ > 0.0 && u > i.second && u - round_ >= i.first ? u - round_ : u;
}

RBDYN_INLINE bool PathEquilibria::inside(const std::vector<Interval>& intervals, double u) const {
    for (const Interval& i : intervals) {
        const double x = shifted(i, u);
        const double slack = std::isfinite(i.second - i.first) ? 1e-12 * (i.second - i.first) : 0.0;
        if (x >= i.first - slack && x <= i.second + slack) return true;
    }
    return false;
}

RBDYN_INLINE Equilibrium PathEquilibria::resting(const Interval& i, bool stable) const {
    const bool is_bounded = std::isfinite(i.first) && std::isfinite(i.second);
    double middle = place_;
    if (is_bounded)
        middle = i.first + 0.5 * (i.second - i.first);
    else if (!(place_ >= i.first && place_ <= i.second))
        middle = std::isfinite(i.first) ? i.first : i.second;
    double best = std::numeric_limits<double>::infinity(), at = middle;
    for (const Point& p : forces_.rough() ? points_ : std::vector<Point>{}) {
        const double u = shifted(i, p.u);
        if (u < i.first || u > i.second || !(std::abs(u - middle) < best)) continue;
        best = std::abs(u - middle);
        at = u;
    }
    return {{at}, stable, i};
}

}  // namespace rbdyn::inline RBDYN_FORM
