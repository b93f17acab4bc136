// Definitions of rbdyn/statics/evident_rest.hpp.
#pragma once

#include "rbdyn/statics/evident_rest.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/statics/normal_modes.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
#include "rbdyn/statics/search.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

namespace evidence {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

struct Ways {
    SquareMatrix shapes;          // a column each
    std::vector<double> squares;  // what the force loses along each
};

/// The modes, to 32 digits where there are any: of flat ones that are alike doubles would tell any mixture.
inline Ways ways(TreeForces& forces, const Forces::State& s) {
    const int n = forces.freedoms();
    constexpr int most_wide = 120;
    if (n <= most_wide) {
        try {
            SmallModes modes = small_modes(small_motion(forces));
            return {std::move(modes.shapes), std::move(modes.squares)};
        } catch (const InvalidInput&) {
            // forces without a potential
        }
    }
    const SymmetricEigen e = symmetric_eigen(Stiffness(s).symmetric);
    Ways result{e.vectors, e.values};
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) result.shapes(i, k) /= std::sqrt(s.metric[static_cast<std::size_t>(i)]);
    return result;
}

/// The force along one way, as far from a place as asked.
struct Along {
    TreeForces& forces;
    const TreeForces::Wide& place;
    std::vector<double> way;

    struct Force {
        double value = 0.0, noise = 0.0;  // what doubles make of its terms
    };
    /// None where there is no such place.
    std::optional<Force> at(double distance) const {
        std::vector<double> step = way;
        for (double& x : step) x *= distance;
        const TreeForces::Wide there = distance == 0.0 ? place : forces.stepped(place, step);
        if (there.empty() || (distance != 0.0 && there == place)) return std::nullopt;
        const TreeForces::Wide f = forces.force_at(there);
        const std::vector<double> sizes = forces.force_sizes(there);
        constexpr double some = 64.0 * epsilon;
        DoubleDouble sum = 0.0;
        Force result;
        for (std::size_t i = 0; i < way.size(); ++i) {
            sum += way[i] * f[i];
            result.noise += some * std::abs(way[i]) * sizes[i];
        }
        result.value = sum.hi;
        if (!std::isfinite(result.value) || !std::isfinite(result.noise)) return std::nullopt;
        return result;
    }
};

/// Whether a force that is rounding becomes clear on both sides, or on none; then `is_small`, beside what else acts.
inline bool is_even(const Along& along, double here, double nearest, double farthest, bool is_small) {
    constexpr double stride = 4.0, more = 16.0;
    const auto becomes_clear = [&](double side) {
        for (double distance = nearest; distance <= farthest; distance *= stride) {
            Interruption::point();
            const auto f = along.at(side * distance);
            if (!f || std::abs(f->value) > std::max(more * std::abs(here), f->noise)) return true;
        }
        return false;
    };
    const bool ahead = becomes_clear(1.0);
    return ahead == becomes_clear(-1.0) && (ahead || is_small);
}

/// Whether a force that is more than rounding changes its sign, or grows, to both sides.
inline bool is_about_zero(const Along& along, double here, double same) {
    constexpr double far_more = 1e6;
    const auto ahead = along.at(same), back = along.at(-same);
    if (!ahead || !back) return false;
    const double least = std::min(std::abs(ahead->value), std::abs(back->value));
    return (ahead->value > 0.0) != (back->value > 0.0) || least >= far_more * std::abs(here);
}

/// Whether secants, from a first step on, come to a zero that is a few such steps away, as they do to one of any order.
/// Of a force that fades they go on, and lose less.
inline bool is_beside_zero(const Along& along, double here, double step) {
    constexpr int most = 40;
    constexpr double most_steps = 8.0, less = 1e-6;
    double last = 0.0, last_value = here, now = step;
    for (int k = 0; k < most; ++k) {
        Interruption::point();
        const auto f = along.at(now);
        if (!f || f->value == last_value) return false;
        if (std::abs(f->value) <= less * std::abs(here)) return true;
        const double next = now - f->value * (now - last) / (f->value - last_value);
        if (!(std::abs(next) <= most_steps * std::abs(step))) return false;
        last = std::exchange(now, next);
        last_value = f->value;
    }
    return false;
}

}  // namespace evidence

RBDYN_INLINE bool is_evident(TreeForces& forces, const std::vector<double>& q, const Forces::State& s,
                             const Beginning& beginning) {
    using evidence::epsilon;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    const TreeForces::Wide place = forces.wide(q);
    if (place.empty()) return false;
    forces.look_at(place);
    const TreeForces::Wide f = forces.force_at(place);
    if (std::all_of(f.begin(), f.end(), [](const DoubleDouble& x) { return x == 0.0; })) return true;
    const evidence::Ways ways = evidence::ways(forces, s);
    const std::vector<double> units = forces.units(), gone = forces.difference(q, beginning.place);
    // in the metric of the masses
    double size = 0.0, away = 0.0;
    for (int i = 0; i < n; ++i) {
        const double root = std::sqrt(s.metric[at(i)]);
        size = std::max(size, root * s.size[at(i)]);
        away = std::max(away, root * std::abs(gone[at(i)]));
    }
    for (int k = 0; k < n; ++k) {
        evidence::Along along{forces, place, {}};
        double share = 0.0, effort = 0.0, first_effort = 0.0;
        for (int i = 0; i < n; ++i) {
            const double part = ways.shapes(i, k);
            along.way.push_back(part);
            share = std::max(share, std::abs(part) / units[at(i)]);
            effort += std::abs(part) * s.effort[at(i)];
            first_effort += std::abs(part) * beginning.effort[at(i)];
        }
        const auto here = along.at(0.0);
        if (!here || !(share > 0.0)) return false;
        if (here->value == 0.0) continue;
        // as far as places are the same one
        constexpr double scarcely = 0x1p-58, large = 1e3;
        const double unit = std::min(1.0 / share, large * std::max(size, away));
        const double same = std::max(64.0 * epsilon * size, scarcely * unit);
        const double step = here->value / ways.squares[at(k)];
        if (std::abs(step) <= same) {
            constexpr double less = 0.25, nothing = 0x1p-30;
            const auto there = along.at(step);
            if (there && std::abs(there->value) <= std::max(less * std::abs(here->value), nothing * there->noise))
                continue;
        }
        if (std::abs(here->value) > std::max(64.0 * here->noise, 4096.0 * epsilon * effort)) {
            // doubles know a zero of higher order by a part of the unit that is a root of their rounding
            constexpr double near = 0x1p-10;
            const bool is_near = std::abs(step) <= near * unit && evidence::is_beside_zero(along, here->value, step);
            if (!is_near && !evidence::is_about_zero(along, here->value, same)) return false;
            continue;
        }
        constexpr double round = 3.0, wide = 16.0, part = 1e-3;
        double farthest = wide * std::max(unit, size);
        if (const double turning = forces.largest_turn(along.way); turning > 0.0)
            farthest = std::min(farthest, round / turning);
        const bool is_small = first_effort == 0.0 || here->noise <= part * first_effort;
        if (!evidence::is_even(along, here->value, same, farthest, is_small)) return false;
    }
    return true;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
