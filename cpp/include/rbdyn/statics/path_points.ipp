// Definitions of rbdyn/statics/path_equilibria.hpp: zeros of Q.
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
#include "rbdyn/statics/path_zero.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void PathEquilibria::find_points() {
    for (std::size_t i = 0; i < path_.size(); ++i) {
        const Piece& p = path_[i];
        if (p.bound() <= p.noise()) {
            if (!is_pushed(p.middle)) continue;
            extend(flat_, i);
            if (is_felt(p)) felt_.push_back(p.middle);
            continue;
        }
        for (const double x : zeros_of(p)) add(p, x);
        if (i == 0) continue;
        add_jump(path_[i - 1], p);
        // a zero where two pieces meet lies beyond the end of both, as rounding may have it
        const double before = path_[i - 1].value(PathForces::along, 1.0), after = p.value(PathForces::along, -1.0);
        const bool meets = !p.cut_below && !path_[i - 1].cut_above && adjoin(path_[i - 1].end(), p);
        const bool has_sign = (before < 0.0 && after < 0.0) || (before > 0.0 && after > 0.0);
        if (meets && (!has_sign || path_[i - 1].may_vanish(1.0) || p.may_vanish(-1.0)))
            add_near(p.begin(), std::min(p.half, path_[i - 1].half));
    }
    if (round_ > 0.0 && !path_.empty()) {
        Piece first = path_.front();
        first.middle += round_;
        add_jump(path_.back(), first);
    }
    find_in_gaps();
    // pieces that grow ever shorter towards a zero do not reach it
    if (!path_.empty() && !std::isfinite(low_)) add_near(path_.front().begin(), 32.0 * path_.front().half);
    if (!path_.empty() && !std::isfinite(high_)) add_near(path_.back().end(), 32.0 * path_.back().half);
    const std::vector<Stretch> stretches = find_stretches();
    for (const Stretch& s : stretches) add_near(s.from + 0.5 * (s.to - s.from), 2.0 * (s.to - s.from));
    for (Point& p : points_) p.u = in_window(p.u);
    std::sort(points_.begin(), points_.end(), [](const Point& a, const Point& b) { return a.u < b.u; });
    // those that rounding does not tell apart are one: that of the highest order
    std::vector<Point> apart;
    const auto is_one = [](const Point& p, const Point& q, double way) {
        return way <= std::max(p.radius + q.radius, 1e-9 * q.half);
    };
    for (const Point& p : points_) {
        if (apart.empty() || !is_one(apart.back(), p, p.u - apart.back().u))
            apart.push_back(p);
        else if (p.order > apart.back().order)
            apart.back() = p;
    }
    if (round_ > 0.0 && apart.size() > 1 &&
        is_one(apart.front(), apart.back(), apart.front().u + round_ - apart.back().u))
        apart.pop_back();
    points_ = std::move(apart);
    for (const Stretch& s : stretches) judge(s);
    reach_changes();
    finish(flat_);
}

RBDYN_INLINE bool PathEquilibria::is_felt(const Piece& p) {
    const auto& c = pieces_.about(p.middle, p.half).output[along];
    const std::array<double, statics::order + 1> sizes = pieces_.sizes();
    for (std::size_t k = 0; k < c.size(); ++k)
        if (std::abs(c[k]) > 64.0 * epsilon * sizes[k]) return true;
    return false;
}

RBDYN_INLINE std::vector<PathEquilibria::Stretch> PathEquilibria::find_stretches() const {
    std::vector<Stretch> all;
    bool is_open = false;
    int last = 0;
    constexpr int steps = 32;
    for (std::size_t i = 0; i < path_.size(); ++i) {
        const Piece& p = path_[i];
        // across a gap without a zero or a change of formula it goes on
        const double from = i > 0 ? path_[i - 1].end() : p.begin(), to = p.begin();
        const auto is_between = [&](const Point& q) { return q.u >= from && q.u <= to; };
        const auto changes = [&](const Gap& gap) { return !gap.changes.empty() && gap.to >= from && gap.from <= to; };
        const bool is_cut = i > 0 && (p.cut_below || path_[i - 1].cut_above);
        if (is_cut || (i > 0 && !adjoin(from, p) &&
                       (std::ranges::any_of(points_, is_between) || std::ranges::any_of(gaps_, changes)))) {
            is_open = false;
            last = 0;
        }
        for (int k = -steps; k <= steps; ++k) {
            const double x = static_cast<double>(k) / steps, q = p.value(PathForces::along, x);
            if (std::abs(q) > p.noise()) {
                last = q < 0.0 ? -1 : 1;
                if (is_open) all.back().after = last;
                is_open = false;
            } else if (is_open) {
                all.back().to = p.place(x);
                ++all.back().places;
            } else {
                all.push_back({p.place(x), p.place(x), 1, last});
                is_open = true;
            }
        }
    }
    std::erase_if(all, [](const Stretch& s) { return !s.goes_on(); });
    return all;
}

RBDYN_INLINE void PathEquilibria::judge(const Stretch& stretch) {
    std::erase_if(flat_, [&](const Interval& i) { return i.first >= stretch.from && i.second <= stretch.to; });
    std::erase_if(points_, [&](const Point& p) { return p.order == 0 && stretch.has(p.u); });
    int sign = stretch.before, count = 0;
    bool agree = true;
    const auto meet = [&](int other) { agree = agree && (sign == 0 || other == 0 || sign == other); };
    for (const Point& p : points_) {
        if (!stretch.has(p.u)) continue;
        ++count;
        meet(p.before);
        sign = p.after;
    }
    meet(stretch.after);
    if (count > 0 && agree) return;
    if (count == 0 && underflows(stretch))
        return add_in_gap(stretch.place(), stretch.before, stretch.after, stretch.to - stretch.from);
    std::erase_if(points_, [&](const Point& p) { return stretch.has(p.u); });
    if (is_pushed(stretch.from + 0.5 * (stretch.to - stretch.from))) hidden_.emplace_back(stretch.from, stretch.to);
}

RBDYN_INLINE bool PathEquilibria::underflows(const Stretch& stretch) {
    if (stretch.before == 0 || stretch.after == 0) return false;
    const double half = 0.5 * (stretch.to - stretch.from), middle = stretch.from + half;
    const Piece& p = pieces_.about(middle, half);
    // terms that cancel have a size
    return p.bound() == 0.0 && pieces_.sizes()[0] < statics::least_force;
}

RBDYN_INLINE std::optional<double> PathEquilibria::cut_end(const Piece& piece, double x, double near) {
    // which rounding of places moves on a short piece
    near = std::max(near, 8.0 * epsilon * std::abs(piece.middle) / piece.half);
    if (piece.cut_below && std::abs(x + 1.0) <= near) return piece.begin();
    if (piece.cut_above && std::abs(x - 1.0) <= near) return piece.end();
    return std::nullopt;
}

RBDYN_INLINE void PathEquilibria::add(const Piece& piece, double x) {
    if (const auto end = cut_end(piece, x, at_end)) return add_corner(*end, piece.half);
    const auto zero = statics::PathZeros(pieces_).near(piece.place(x), piece.half);
    if (!zero) return;
    // of a zero of higher order beside a corner rounding leaves several
    const double near = std::max(at_end, zero->radius / piece.half);
    if (const auto end = cut_end(piece, (zero->place - piece.middle) / piece.half, near))
        return add_corner(*end, piece.half);
    add_zero(*zero, piece.place(x), piece.half);
}

RBDYN_INLINE void PathEquilibria::add_near(double u, double half) {
    if (const auto zero = statics::PathZeros(pieces_).near(u, half)) add_zero(*zero, u, half);
}

RBDYN_INLINE void PathEquilibria::add_zero(const statics::PathZero& zero, double u, double half) {
    Point point{u, half};
    point.u = zero.place;
    point.order = zero.order;
    point.radius = zero.radius;
    if (zero.order > 0) {
        point.after = zero.lead < 0.0 ? -1 : 1;
        point.before = zero.order % 2 == 0 ? point.after : -point.after;
    }
    if (zero.order == 1) point.slope = zero.lead / half;
    // an end of the rail, within rounding
    for (const double end : {low_, high_})
        if (std::isfinite(end) && std::abs(point.u - end) <= 8.0 * epsilon * std::max(std::abs(end), half))
            point.u = end;
    if (round_ == 0.0 && (point.u < low_ || point.u > high_)) return;
    // at a cusp r' vanishes, and Q with it
    const auto speed = [&](double place) { return forces_.speed(place); };
    const double aside = 0x1p-6 * half;
    if (speed(point.u) <= 0.1 * std::min(speed(point.u - aside), speed(point.u + aside))) return;
    point.stable = zero.is_stable();
    point.pushed = is_pushed(point.u);
    points_.push_back(point);
}

RBDYN_INLINE void PathEquilibria::add_jump(const Piece& before, const Piece& after) {
    const double gap = after.begin() - before.end(), noise = std::max(before.noise(), after.noise());
    if (!after.cut_below || !adjoin(before.end(), after)) return;
    const double from = before.value(PathForces::along, 1.0), to = after.value(PathForces::along, -1.0);
    if (std::abs(from) <= noise || std::abs(to) <= noise || (from > 0.0) == (to > 0.0)) return;
    const double u = before.end() + 0.5 * gap;
    Point point{u, after.half, from > 0.0, is_pushed(u)};
    point.order = corner;
    points_.push_back(point);
}

RBDYN_INLINE void PathEquilibria::add_corner(double u, double half) {
    const double step = std::max(1e-6 * half, 64.0 * epsilon * std::abs(u));
    const double before = forces_.along_path(u - step), after = forces_.along_path(u + step);
    Point point{u, half, before > 0.0 && after < 0.0, is_pushed(u)};
    point.order = corner;
    point.radius = 8.0 * epsilon * std::abs(u);
    // no corner after all: the same slope on both sides
    const double left = -before / step, right = after / step;
    if (std::abs(left - right) <= 1e-4 * (std::abs(left) + std::abs(right))) {
        const Piece& about = pieces_.about(u + step, half);
        point.slope = about.output[along][1] / half;
    }
    points_.push_back(point);
}

RBDYN_INLINE bool PathEquilibria::is_pushed(double u) {
    if (!forces_.one_sided()) return true;
    const Piece& p = pieces_.about(u, 1.0);
    return p.output[PathForces::push][0] >= -p.noise();
}

RBDYN_INLINE bool PathEquilibria::may_leave(double u) {
    if (!forces_.one_sided()) return false;
    const Piece& p = pieces_.about(u, 1.0);
    const auto& push = p.output[PathForces::push];
    return push[0] <= p.noise() + 8.0 * epsilon * std::abs(u * push[1]);
}

}  // namespace rbdyn::inline RBDYN_FORM
