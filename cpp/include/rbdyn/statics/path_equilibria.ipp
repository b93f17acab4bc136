// Definitions of rbdyn/statics/path_equilibria.hpp.
#pragma once

#include "rbdyn/statics/path_equilibria.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/path_pieces.hpp"
#include "rbdyn/statics/path_zero.hpp"

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

RBDYN_INLINE bool PathEquilibria::repeats() {
    if (!forces_.may_count_turns()) return true;
    const double turn = 2.0 * std::numbers::pi;
    const TorsionSpring spring = forces_.torsion();
    PathForces::Values values(forces_);
    const auto rest = [&](double u) { return values(u) + spring.stiffness * (u - spring.rest_angle); };
    // where its formulas agree on stretches they are the same
    bool is_same = true;
    const auto look = [&](const Piece& p) {
        // beside what the angle's own rounding makes of them, which is more the farther on
        double steepest = 0.0;
        for (int k = 1; k <= statics::order; ++k)
            steepest += k * std::abs(p.output[along][static_cast<std::size_t>(k)]) / p.half;
        for (const double x : {-0.9375, -0.3125, 0.1875, 0.8125}) {
            const double u = p.place(x), here = rest(u);
            for (const double turns : {-2.0, -1.0, 1.0, 3.0}) {
                const double other = u + turns * turn, way = std::abs(u) + std::abs(other);
                const double noise = 1e-11 * std::max(forces_.effort(u), forces_.effort(other)) +
                                     64.0 * epsilon * (p.bound() + (steepest + spring.stiffness) * way);
                is_same = is_same && std::abs(rest(other) - here) <= noise;
            }
        }
        return is_same;
    };
    try {
        pieces_.march(place_, place_ + turn, most_pieces, look);
    } catch (const InvalidInput&) {
        return false;
    }
    return is_same;
}

RBDYN_INLINE std::pair<double, double> PathEquilibria::wound() {
    const TorsionSpring spring = forces_.torsion();
    const double turn = 2.0 * std::numbers::pi;
    double most = 0.0;
    const bool is_all = pieces_.march(spring.rest_angle, spring.rest_angle + turn, most_pieces, [&](Piece p) {
        p.output[along][0] += spring.stiffness * (p.middle - spring.rest_angle);
        p.output[along][1] += spring.stiffness * p.half;
        most = std::max(most, p.bound());
        return true;
    });
    const double reach = 1.0 + most / spring.stiffness;
    // more than are kept
    return {spring.rest_angle, is_all ? reach : std::max(reach, turn)};
}

RBDYN_INLINE void PathEquilibria::turn_back(Equilibrium& e) const {
    double& angle = e.coordinates[0];
    if (e.interval && e.interval->second - e.interval->first == round_) {
        angle = place_;
        e.interval = {place_ - 0.5 * round_, place_ + 0.5 * round_};
    }
    if (e.interval || !(angle > 0.5 * round_ * (1.0 + 4.0 * epsilon))) return;
    angle -= round_;
}

RBDYN_INLINE void PathEquilibria::walk(bool asked) {
    // what begins where one formula goes over to another one is cut there as elsewhere
    const auto cut_at_place = [&](std::size_t before) {
        if (before == 0 || before == path_.size()) return;
        if (!pieces_.changes_at(place_, std::min(path_[before - 1].half, path_[before].half))) return;
        path_[before - 1].cut_above = path_[before].cut_below = true;
    };
    const auto keep = [&](const Piece& p) {
        path_.push_back(p);
        // the same force all along
        return !(p.endless && is_same_all_along(p));
    };
    if (std::isfinite(low_) && std::isfinite(high_)) {
        if (pieces_.march(low_, high_, most_pieces, keep)) {
            // the seam of one round is a place as others
            if (round_ > 0.0 && pieces_.changes_at(low_, std::min(path_.front().half, path_.back().half)))
                path_.front().cut_below = path_.back().cut_above = true;
            return;
        }
        if (!asked)
            throw InvalidInput(
                "equilibria: from " + forces_.coordinate() + " " + text(low_) + " to " + text(high_) +
                " the forces on " + forces_.name() + " change so often that more than " + std::to_string(most_pieces) +
                " Taylor series are needed, and not every state of rest would be found; give near=, "
                "about which " +
                std::to_string(most_about) + " are searched on each side, or take away what changes so quickly");
        // on both sides of the place
        path_.clear();
        place_ = std::clamp(place_, low_, high_);
        pieces_.march(place_, low_, most_about, keep);
        std::reverse(path_.begin(), path_.end());
        const std::size_t below = path_.size();
        pieces_.march(place_, high_, most_about, keep);
        cut_at_place(below);
        round_ = 0.0;
        if (path_.empty()) return;
        low_ = path_.front().begin();
        high_ = path_.back().end();
        return;
    }
    const int most = most_stretches + pieces_.doublings(place_);
    pieces_.march(place_, low_, most, keep);
    std::reverse(path_.begin(), path_.end());
    if (path_.size() == 1 && path_[0].endless && is_same_all_along(path_[0])) return;
    const std::size_t below = path_.size();
    pieces_.march(place_, high_, most, [&](const Piece& p) {
        path_.push_back(p);
        return true;
    });
    cut_at_place(below);
}

RBDYN_INLINE std::vector<double> PathEquilibria::flat_places(const Piece& p) {
    std::vector<double> places;
    constexpr int steps = 32;
    for (int k = -steps; k <= steps; ++k) {
        const double x = static_cast<double>(k) / steps;
        if (std::abs(p.value(PathForces::along, x)) <= p.noise()) places.push_back(x);
    }
    return places;
}

RBDYN_INLINE std::vector<double> PathEquilibria::zeros_of(const Piece& p) {
    std::array<double, statics::order + 1> q = p.output[along];
    std::vector<double> places = statics::roots_about_middle(q.data(), statics::order);
    // zeros without a change of sign, or too flat to show one: those of derivatives
    for (int degree = statics::order - 1; degree >= statics::order - 3; --degree) {
        for (int k = 0; k <= degree; ++k) q[static_cast<std::size_t>(k)] = (k + 1) * q[static_cast<std::size_t>(k) + 1];
        for (const double x : statics::roots_about_middle(q.data(), degree))
            if (p.may_vanish(x)) places.push_back(x);
    }
    for (const double x : flat_places(p)) places.push_back(x);
    return places;
}

RBDYN_INLINE void PathEquilibria::refine(const Piece& p, int depth, std::vector<Piece>& path) {
    const auto is_small = [&](double x) {
        return !cut_end(p, x, at_end) && forces_.effort(p.place(x)) < 0x1p-6 * p.effort;
    };
    const bool is_flat = p.bound() <= p.noise();
    if (depth >= most_halvings || is_flat || !std::ranges::any_of(zeros_of(p), is_small)) {
        path.push_back(p);
        return;
    }
    for (const double way : {-1.0, 1.0}) {
        Piece half = pieces_.about(p.middle + 0.5 * way * p.half, 0.5 * p.half);
        (way < 0.0 ? half.cut_below : half.cut_above) = way < 0.0 ? p.cut_below : p.cut_above;
        half.polynomial = p.polynomial;
        refine(half, depth + 1, path);
    }
}

RBDYN_INLINE bool PathEquilibria::is_same_all_along(const Piece& p) const {
    for (std::size_t j = 0; j < p.output.size(); ++j) {
        double sum = 0.0;
        for (std::size_t k = 1; k < p.output[j].size(); ++k) sum += std::abs(p.output[j][k]);
        if (sum > (j == PathForces::hold ? hold_noise(p) : p.noise())) return false;
    }
    return true;
}

RBDYN_INLINE double PathEquilibria::hold_noise(const Piece& p) const {
    const double mu = forces_.static_friction();
    return 2.0 * (1.0 + mu * mu) * p.effort * p.noise();
}

RBDYN_INLINE double PathEquilibria::hold_noise(const Piece& p, double x) const {
    const double q = p.value(PathForces::along, x), noise = p.noise();
    return 32.0 * epsilon * q * q + noise * noise;
}

RBDYN_INLINE bool PathEquilibria::adjoin(double end, const Piece& p) {
    return std::abs(p.begin() - end) <= 1e-14 * (std::abs(end) + p.half);
}

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
        if (meets && !(before < 0.0 && after < 0.0) && !(before > 0.0 && after > 0.0))
            add_near(p.begin(), std::min(p.half, path_[i - 1].half));
    }
    if (round_ > 0.0 && !path_.empty()) {
        Piece first = path_.front();
        first.middle += round_;
        add_jump(path_.back(), first);
    }
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
        return way <= std::max({p.radius, q.radius, 1e-9 * q.half});
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
        if (i > 0 && (p.cut_below || path_[i - 1].cut_above || !adjoin(path_[i - 1].end(), p))) {
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
    std::erase_if(points_, [&](const Point& p) { return stretch.has(p.u); });
    if (is_pushed(stretch.from + 0.5 * (stretch.to - stretch.from))) hidden_.emplace_back(stretch.from, stretch.to);
}

RBDYN_INLINE std::optional<double> PathEquilibria::cut_end(const Piece& piece, double x, double near) {
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
    if (!after.cut_below || gap > 1e-11 * std::max(std::abs(after.begin()), after.half)) return;
    const double from = before.value(PathForces::along, 1.0), to = after.value(PathForces::along, -1.0);
    if (std::abs(from) <= noise || std::abs(to) <= noise || (from > 0.0) == (to > 0.0)) return;
    const double u = before.end() + 0.5 * gap;
    // at a pole it grows beyond all bounds, at a jump it is the same beside the gap and a little farther away
    const double aside = 0x1p10 * gap;
    const auto grows_to = [&](double value, double place) {
        return place >= low_ && place <= high_ && std::abs(value) > 1.1 * std::abs(forces_.along_path(place));
    };
    if (gap > 0.0 && !adjoin(before.end(), after) && (grows_to(from, u - aside) || grows_to(to, u + aside))) return;
    Point point{u, after.half, from > 0.0, is_pushed(u)};
    point.order = corner;
    points_.push_back(point);
}

RBDYN_INLINE void PathEquilibria::add_corner(double u, double half) {
    const double step = 1e-6 * half;
    const double before = forces_.along_path(u - step), after = forces_.along_path(u + step);
    Point point{u, half, before > 0.0 && after < 0.0, is_pushed(u)};
    point.order = corner;
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
