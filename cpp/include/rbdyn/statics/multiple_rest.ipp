// Definitions of rbdyn/statics/multiple_rest.hpp.
#pragma once

#include "rbdyn/statics/multiple_rest.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/statics/natural_length.hpp"
#include "rbdyn/statics/null_direction.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
#include "rbdyn/statics/reduced_force.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE std::vector<bool> open_modes(TreeForces& forces, const PinnedRest& rest) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    const SquareMatrix& shapes = rest.modes.shapes;
    const std::vector<double>& squares = rest.modes.squares;
    std::vector<bool> open = rest.flat;
    const auto open_softest = [&] {
        int softest = 0;
        for (int k = 1; k < n; ++k)
            if (std::abs(squares[at(k)]) < std::abs(squares[at(softest)])) softest = k;
        open[at(softest)] = true;
    };
    if (!rest.is_found) {
        open.assign(at(n), false);
        open_softest();
        return open;
    }
    forces.look_at(rest.place);
    const TreeForces::Wide f = forces.force_at(rest.place);
    const std::vector<double> sizes = forces.force_sizes(rest.place);
    // how far the place may be off
    std::vector<double> step(at(n));
    for (int k = 0; k < n; ++k) {
        if (open[at(k)]) continue;
        double force = 0.0, rounding = 0.0;
        for (int i = 0; i < n; ++i) {
            force += shapes(i, k) * f[at(i)].hi;
            rounding += 4.0 * epsilon * std::abs(shapes(i, k)) * sizes[at(i)];
        }
        const double off = (std::abs(force) + rounding) / std::abs(squares[at(k)]);
        for (int i = 0; i < n; ++i) step[at(i)] += off * shapes(i, k);
    }
    // as are those of the place itself, where it was moved last
    constexpr double alike = 0.25;
    for (const double part : {0.0, 1.0, -1.0}) {
        std::vector<double> way = step;
        for (double& x : way) x *= part;
        const TreeForces::Wide there = forces.stepped(rest.place, way);
        if (there.empty()) {
            open_softest();
            break;
        }
        forces.look_at(there);
        const WideMatrix slope = forces.wide_jacobian().entries;
        forces.look_at(rest.place);
        for (int k = 0; k < n; ++k) {
            DoubleDouble square = 0.0;
            for (int i = 0; i < n; ++i) {
                DoubleDouble row = 0.0;
                for (int j = 0; j < n; ++j) row -= slope(i, j) * shapes(j, k);
                square += shapes(i, k) * row;
            }
            if (!(std::abs((square - squares[at(k)]).hi) <= alike * std::abs(squares[at(k)]))) open[at(k)] = true;
        }
    }
    return open;
}

namespace multiple {

/// Times their noise: powers that are there.
inline constexpr double above_noise = 64.0;

struct Zero {
    int order = 0;
    DoubleDouble place;  // in halves
    double lead = 0.0;
};

/// The zero nearest to the middle that these powers have.
inline std::optional<Zero> nearest_zero(const ReducedPowers& powers) {
    constexpr int highest = ReducedPowers::degree - 5, most_steps = 40;
    constexpr double reach = 0.5;
    std::optional<Zero> result;
    for (int m = highest; m >= 1; --m) {
        const auto k = static_cast<std::size_t>(m);
        DoubleDouble x = 0.0;
        ReducedPowers about = powers;
        bool is_root = false;
        for (int i = 0; i < most_steps && !is_root; ++i) {
            if (about.c[k].hi == 0.0) break;
            const DoubleDouble step = about.c[k - 1] / (static_cast<double>(m) * about.c[k]);
            x -= step;
            if (!(std::abs(x.hi) <= reach)) break;
            about = powers.shifted(x);
            is_root = std::abs(about.c[k - 1].hi) <= powers.noise_of(m - 1) || std::abs(step.hi) <= 0x1p-100;
        }
        if (!is_root || !(std::abs(about.c[k].hi) > above_noise * powers.noise_of(m))) continue;
        bool is_nothing_before = true;
        for (int j = 0; j < m; ++j)
            is_nothing_before =
                is_nothing_before && std::abs(about.c[static_cast<std::size_t>(j)].hi) <= 4.0 * powers.noise_of(j);
        if (!is_nothing_before) continue;
        // beside a zero of higher order there seem to be others, as far off as noise leaves them
        const double apart = 100.0 * powers.noise_of(m - 1) / (m * std::abs(about.c[k].hi));
        if (!result || (std::abs(x.hi) < std::abs(result->place.hi) && std::abs((x - result->place).hi) > apart))
            result = Zero{m, x, about.c[k].hi};
    }
    return result;
}

/// Whether from the zero, in the middle, the force has the sign of its power to where it is more than rounding.
inline bool is_borne_out(const ReducedForce& reduced, int power, double sign, double begin, double longest) {
    constexpr double clear = 16.0 * std::numeric_limits<double>::epsilon();
    const double behind = power % 2 == 0 ? sign : -sign;
    for (double s = begin; s <= longest; s *= 2.0) {
        const auto ahead = reduced.at(s), back = reduced.at(-s);
        if (!ahead || !back) return false;
        if (!(sign * ahead->force > 0.0) || !(behind * back->force > 0.0)) return false;
        if (std::abs(ahead->force) > clear * ahead->size && std::abs(back->force) > clear * back->size) return true;
    }
    return false;
}

}  // namespace multiple

RBDYN_INLINE std::optional<MultipleRest> multiple_rest(TreeForces& forces, const PinnedRest& rest, int mode) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    forces.look_at(rest.place);
    const WideMatrix mass = forces.wide_mass();
    const auto weight = [&](int i) { return std::abs(rest.modes.shapes(i, mode)) * std::sqrt(mass(i, i).hi); };
    int held = 0;
    for (int i = 1; i < n; ++i)
        if (weight(i) > weight(held)) held = i;
    std::vector<double> along;
    for (int i = 0; i < n; ++i) along.push_back(rest.modes.shapes(i, mode) / rest.modes.shapes(held, mode));
    const double longest =
        reach_along(forces, rest.place, along, forces.at_rest(forces.nearest(rest.place)).size[at(held)]);
    if (!std::isfinite(longest)) return std::nullopt;
    TreeForces::Wide place = rest.place;
    std::optional<ReducedForce> reduced(std::in_place, forces, place, held);
    std::optional<MultipleRest> result;
    // the one that doubles leave
    std::optional<multiple::Zero> rough;
    double rough_begin = 0.0;
    int last = 0;
    double sign = 0.0, begin = 0.0, uncertainty = 0.0;
    constexpr int most_halves = 26, most_lost = 3;
    double half = std::exp2(std::floor(std::log2(longest)));
    // from far to near: first what shows the way, then powers may come forth that higher ones hide
    for (int i = 0, lost = 0; i < most_halves && lost < most_lost; ++i, half *= 0.25) {
        if (result) ++lost;
        const auto powers = reduced->powers(half);
        if (!powers) continue;
        const auto is_known_to = [&](double part) {
            return powers->noise <= std::max(part * powers->largest(), 0x1p-92 * powers->size);
        };
        if (!is_known_to(0x1p-20)) continue;
        const auto zero = multiple::nearest_zero(*powers);
        const bool is_sure = is_known_to(0x1p-60);
        if (!zero || (result && (!is_sure || zero->order > last))) continue;
        const double lead = std::abs(zero->lead);
        const double off = half * powers->noise_of(zero->order - 1) / (zero->order * lead);
        const bool is_there_here =
            std::abs(powers->c[at(zero->order)].hi) > multiple::above_noise * powers->noise_of(zero->order);
        // what is nearer than it is known is where the last one is; that its power is another one is told there
        const bool is_elsewhere = last == 0 || off < uncertainty || half * std::abs(zero->place.hi) > 4.0 * off;
        if (!is_elsewhere && zero->order != last && !is_there_here) continue;
        if (is_elsewhere) {
            auto there = reduced->at(DoubleDouble(half * zero->place.hi, half * zero->place.lo));
            if (!there) continue;
            place = std::move(there->place);
            reduced.emplace(forces, place, held);
            uncertainty = off;
        }
        last = zero->order;
        if (!is_sure) continue;
        if (!result) {
            ReducedPowers in_doubles = *powers;
            in_doubles.noise = std::max(powers->noise, 4.0 * std::numeric_limits<double>::epsilon() * powers->size);
            rough = multiple::nearest_zero(in_doubles);
            if (rough)
                rough_begin =
                    half * std::min(0.5, std::pow(64.0 * in_doubles.noise / std::abs(rough->lead), 1.0 / rough->order));
        }
        result = MultipleRest{place, last};
        sign = zero->lead > 0.0 ? 1.0 : -1.0;
        begin = half * std::min(0.5, std::pow(64.0 * powers->noise / lead, 1.0 / last));
        lost = 0;
    }
    const auto bears_out = [&](int power, double lead, double from) {
        if (!multiple::is_borne_out(*reduced, power, lead > 0.0 ? 1.0 : -1.0, from, longest)) return false;
        result->along = power % 2 == 1 && lead < 0.0 ? AlongNull::stable : AlongNull::unstable;
        return true;
    };
    // third and higher derivatives of U that are no more than the rounding of constants are nothing
    if (result && !bears_out(result->order, sign, begin) && result->order > 1 && rough && rough->order > result->order)
        bears_out(rough->order, rough->lead, rough_begin);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
