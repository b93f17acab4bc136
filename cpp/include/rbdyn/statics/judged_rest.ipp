// Definitions of rbdyn/statics/judged_rest.hpp.
#pragma once

#include "rbdyn/statics/judged_rest.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/multiple_rest.hpp"
#include "rbdyn/statics/normal_modes.hpp"
#include "rbdyn/statics/null_direction.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
#include "rbdyn/statics/search.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

namespace judging {

/// What the one mode does that is open; the place is that of the zero along it.
inline AlongNull along_open(TreeForces& forces, PinnedRest& rest, std::vector<bool>& open) {
    const auto mode = static_cast<std::size_t>(std::ranges::find(open, true) - open.begin());
    auto zero = multiple_rest(forces, rest, static_cast<int>(mode));
    if (!zero) {
        if (!rest.is_found || !rest.flat[mode]) return AlongNull::not_decided;
        std::vector<double> direction(open.size());
        direction[mode] = 1.0;
        const AlongNull along = along_null(forces, rest, direction);
        return along == AlongNull::indifferent ? along : AlongNull::not_decided;
    }
    rest.place = without_dust(forces, rest.modes, std::move(zero->place));
    rest.is_found = true;
    forces.look_at(rest.place);
    rest.modes = small_modes(small_motion(forces));
    std::vector<double>& squares = rest.modes.squares;
    // the softest comes where it was
    const auto softest = std::ranges::min_element(squares, {}, [](double x) { return std::abs(x); });
    const auto now = static_cast<std::size_t>(softest - squares.begin());
    rest.flat.assign(open.size(), false);
    open.assign(open.size(), false);
    open[now] = true;
    rest.flat[now] = zero->order > 1 || std::abs(squares[now]) <= rest.modes.rounding[now];
    AlongNull along = zero->along;
    for (std::size_t k = 0; k < squares.size(); ++k) {
        if (k == now || std::abs(squares[k]) > rest.modes.rounding[k]) continue;
        open[k] = rest.flat[k] = true;
        along = AlongNull::not_decided;
    }
    return along;
}

/// Whether Newton's method from q comes to a zero at once: one at which the forces do not vanish to higher order.
inline bool contracts(TreeForces& forces, const std::vector<double>& q) {
    const Forces::State s = forces.at_rest(q);
    const std::size_t n = s.force.size();
    const std::vector<double> sizes = forces.force_sizes(forces.wide(q));
    TreeForces::Wide place = forces.wide(q);
    const auto misfit = [&](const TreeForces::Wide& f) {
        double most = 0.0;
        for (std::size_t i = 0; i < n; ++i) most = std::max(most, std::abs(f[i].hi) / std::sqrt(s.metric[i]));
        return most;
    };
    double noise = 0.0;
    for (std::size_t i = 0; i < n; ++i) noise = std::max(noise, 0x1p-70 * sizes[i] / std::sqrt(s.metric[i]));
    constexpr int most_steps = 4;
    for (int iteration = 0; iteration < most_steps && !place.empty(); ++iteration) {
        const TreeForces::Wide f = forces.force_at(place);
        if (misfit(f) <= noise) return true;
        std::vector<double> left;
        for (const DoubleDouble& x : f) left.push_back(-x.hi);
        place = forces.stepped(place, solve(s.jacobian, left).x);
    }
    return false;
}

}  // namespace judging

RBDYN_INLINE std::optional<FreeTurn> free_turn(Forces& forces, const std::vector<double>& q, const Forces::State& s,
                                               const Stiffness& stiffness, int body) {
    const int first = forces.first(body), moves = forces.displacements(body), n = moves + 3;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    SquareMatrix own(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) own(i, j) = stiffness.symmetric(first + i, first + j);
    const SymmetricEigen e = symmetric_eigen(own);
    int null = -1;
    for (int k = 0; k < n; ++k) {
        if (std::abs(e.values[at(k)]) > stiffness.rounding) continue;
        if (null >= 0) return std::nullopt;
        null = k;
    }
    if (null < 0) return std::nullopt;
    const auto component = [&](int i) { return e.vectors(i, null) / std::sqrt(s.metric[at(first + i)]); };
    const Vector3 turning =
        forces.turn_in_world(q, body, Vector3(component(moves), component(moves + 1), component(moves + 2)));
    if (turning.isZero(0.0)) return std::nullopt;
    FreeTurn result{direction(turning)};
    Vector3& axis = result.axis;
    if (axis[greatest(sizes(axis))] < 0.0) axis = -axis;
    for (double& x : axis)
        if (std::abs(x) < std::numeric_limits<double>::epsilon()) x = 0.0;
    if (moves > 0) {
        const Vector3 velocity(component(0), component(1), component(2));
        result.point = forces.center(q, body) + turning.cross(velocity) / turning.squaredNorm();
    }
    // three turns that no symmetry but a full one has
    for (const double angle : {1.0, 2.25, 4.0}) {
        const Forces::State there = forces.at_rest(forces.turned(q, body, axis, result.point, angle));
        for (std::size_t i = 0; i < there.force.size(); ++i)
            if (!(std::abs(there.force[i]) <= 1e-11 * there.effort[i])) return std::nullopt;
    }
    return result;
}

RBDYN_INLINE Judgement judged(TreeForces& forces, std::vector<double> q, const std::vector<double>& start) {
    Forces::State s = forces.at_rest(q);
    const Stiffness stiffness(s);
    Equilibrium e;
    for (int i = 0; i < forces.bodies(); ++i) {
        if (!forces.turns(i)) continue;
        const auto free = free_turn(forces, q, s, stiffness, i);
        if (!free) continue;
        e.axes.push_back(free->axis);
        // what of the way from the start is a turn about the axis is taken back
        const Quaternion way = forces.attitude(q, i) * conjugate(forces.attitude(start, i));
        const double half = std::atan2(free->axis.dot(Vector3(way.x, way.y, way.z)), way.w);
        q = forces.turned(std::move(q), i, free->axis, free->point, -2.0 * half);
    }
    bool is_decided = false;
    if (auto rest = pinned_if_even(forces, q, stiffness)) {
        const bool is_placed = !rest->place.empty() && rest->modes.squares.size() == s.force.size();
        std::vector<bool> open = is_placed ? open_modes(forces, *rest) : std::vector<bool>(s.force.size(), true);
        const auto untold = static_cast<std::size_t>(std::ranges::count(open, true));
        // what the second derivatives do not say the forces nearby may, where no turn is to be left aside
        AlongNull along = AlongNull::not_decided;
        if (untold == 1 && is_placed && e.axes.empty()) {
            along = judging::along_open(forces, *rest, open);
        } else if (untold > 0 && rest->is_found && e.axes.empty()) {
            along = along_flat(forces, *rest, open);
        }
        if (rest->is_found) q = forces.nearest(rest->place);
        const std::vector<double>& squares = rest->modes.squares;
        bool falls = false;
        for (std::size_t k = 0; k < squares.size(); ++k) {
            falls = falls || (rest->is_found && !open[k] && squares[k] < 0.0);
            if (!rest->flat[k] && squares[k] > 0.0) e.periods.push_back(2.0 * std::numbers::pi / std::sqrt(squares[k]));
        }
        std::sort(e.periods.rbegin(), e.periods.rend());
        const bool is_told = falls || untold == e.axes.size();
        e.stable = rest->is_found && !falls && (is_told ? untold < squares.size() : along == AlongNull::stable);
        e.decided = rest->is_found && (is_told || along != AlongNull::not_decided);
        is_decided = e.decided && untold < squares.size() && along != AlongNull::indifferent;
    } else {
        // the symmetric part, in doubles
        const std::vector<double> squares = symmetric_eigenvalues(stiffness.symmetric);
        const auto hidden = static_cast<std::size_t>(
            std::ranges::count_if(squares, [&](double x) { return std::abs(x) <= stiffness.rounding; }));
        const bool is_simple = judging::contracts(forces, q);
        e.decided = is_decided = is_simple && (squares.front() < -stiffness.rounding || hidden == e.axes.size());
        e.stable = e.decided && squares.front() >= -stiffness.rounding && hidden < squares.size();
        // without a potential the modes are not those of the symmetric part
        if (stiffness.twist <= stiffness.rounding)
            for (const double square : squares)
                if (square > stiffness.rounding) e.periods.push_back(2.0 * std::numbers::pi / std::sqrt(square));
    }
    if (e.stable && s.idle) e.stable = e.decided = is_decided = false;
    e.coordinates = forces.coordinates(q);
    return {std::move(e), std::move(q), is_decided};
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
