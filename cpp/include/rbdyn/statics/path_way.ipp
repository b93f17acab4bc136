// Definitions of rbdyn/statics/path_equilibria.hpp: the way that is searched, and its pieces.
#pragma once

#include "rbdyn/statics/path_equilibria.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/path_pieces.hpp"

namespace rbdyn::inline RBDYN_FORM {

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
        if (!adjoin(path_[before - 1].end(), path_[before])) return;
        if (!pieces_.changes_at(place_, std::min(path_[before - 1].half, path_[before].half))) return;
        path_[before - 1].cut_above = path_[before].cut_below = true;
    };
    // whether it is not the same force all along a way without end
    const auto keep_towards = [&](double way) {
        return [this, way](const Piece& p) {
            path_.push_back(p);
            if (std::isfinite(way > 0.0 ? high_ : low_) || !p.endless || !is_same_all_along(p)) return true;
            if (is_same_beyond(p, way)) return false;
            path_.back().polynomial = path_.back().endless = false;
            return true;
        };
    };
    const auto down = keep_towards(-1.0), up = keep_towards(1.0);
    const auto keep_gap = [&](const Gap& gap) { gaps_.push_back(gap); };
    if (std::isfinite(low_) && std::isfinite(high_)) {
        if (pieces_.march(low_, high_, most_pieces, up, keep_gap)) {
            // the seam of one round is a place as others
            if (round_ > 0.0 && !path_.empty() &&
                pieces_.changes_at(low_, std::min(path_.front().half, path_.back().half)))
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
        gaps_.clear();
        place_ = std::clamp(place_, low_, high_);
        pieces_.march(place_, low_, most_about, down, keep_gap);
        std::reverse(path_.begin(), path_.end());
        const std::size_t below = path_.size();
        pieces_.march(place_, high_, most_about, up, keep_gap);
        cut_at_place(below);
        round_ = 0.0;
        if (path_.empty()) return;
        low_ = path_.front().begin();
        high_ = path_.back().end();
        return;
    }
    const int most = most_stretches + pieces_.doublings(place_);
    const auto walk_both_ways = [&](double scale) {
        path_.clear();
        gaps_.clear();
        pieces_.march(place_, low_, most, down, keep_gap, scale);
        std::reverse(path_.begin(), path_.end());
        if (path_.size() == 1 && path_[0].endless && is_same_all_along(path_[0])) return;
        const std::size_t below = path_.size();
        const auto keep_all = [&](const Piece& p) {
            up(p);
            return true;
        };
        pieces_.march(place_, high_, most, keep_all, keep_gap, scale);
        cut_at_place(below);
    };
    walk_both_ways(0.0);
    // from beside a branch point, or a kink, series may be short both ways, whatever the length the forces change over
    std::vector<double> places;
    for (const Gap& gap : gaps_)
        places.push_back(gap.from * gap.to <= 0.0 ? 0.0 : gap.from + 0.5 * (gap.to - gap.from));
    for (std::size_t i = 1; i < path_.size(); ++i)
        if (path_[i].cut_below &&
            (is_as_the_way(path_.front(), path_[i].begin()) || is_as_the_way(path_.back(), path_[i].begin())))
            places.push_back(path_[i].begin());
    double scale = 0.0;
    for (const double place : places)
        if (const double own = pieces_.scale_of_values(place); std::abs(place - place_) < 0.125 * own)
            scale = std::max(scale, own);
    if (scale > 0.0) walk_both_ways(0.125 * scale);
}

RBDYN_INLINE bool PathEquilibria::is_as_the_way(const Piece& p, double from) {
    return !p.polynomial && p.half > 0.05 * std::abs(p.middle - from);
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
    // or where rounding of its own terms is no longer small beside it
    const bool is_known = p.bound() > p.noise() && p.bound() > 0x1p20 * p.rounding;
    const bool is_resolved = p.half > 64.0 * epsilon * std::abs(p.middle);
    if (depth >= most_halvings || !is_known || !is_resolved || !std::ranges::any_of(zeros_of(p), is_small)) {
        path.push_back(p);
        return;
    }
    for (const double way : {-1.0, 1.0}) {
        Piece half = pieces_.about(p.middle + 0.5 * way * p.half, 0.5 * p.half);
        (way < 0.0 ? half.cut_below : half.cut_above) = way < 0.0 ? p.cut_below : p.cut_above;
        half.polynomial = p.polynomial;
        // for zeros that change no sign: where one power leads there are none
        const double most = 0.5 * half.bound();
        if (std::abs(half.output[along][0]) < most && std::abs(half.output[along][1]) < most)
            half.rounding = pieces_.rounding();
        refine(half, depth + 1, path);
    }
}

RBDYN_INLINE bool PathEquilibria::is_same_beyond(const Piece& p, double way) const {
    PathForces::Values q(forces_);
    const double here = p.value(PathForces::along, 0.0);
    const auto is_same = [&](double u) {
        const double there = q(u), off = std::abs(there - here);
        return !std::isfinite(there) || off <= p.noise() || off < statics::least_force;
    };
    for (double far = 2.0;; far *= 16.0) {
        const double u = p.middle + way * far * p.half;
        if (!std::isfinite(u)) return true;
        if (!is_same(u)) return false;
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

}  // namespace rbdyn::inline RBDYN_FORM
