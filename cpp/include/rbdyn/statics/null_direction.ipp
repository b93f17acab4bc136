// Definitions of rbdyn/statics/null_direction.hpp.
#pragma once

#include "rbdyn/statics/null_direction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/statics/natural_length.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE AlongNull along_null(TreeForces& forces, const PinnedRest& rest, const std::vector<double>& direction) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    const SquareMatrix& shapes = rest.modes.shapes;
    std::vector<double> unit(at(n));
    for (int k = 0; k < n; ++k)
        for (int i = 0; i < n; ++i) unit[at(i)] += direction[at(k)] * shapes(i, k);
    struct Residual {
        double force = 0.0, rounding = 0.0;
        bool is_clear() const { return std::abs(force) > 4.0 * rounding; }
        // beside what 32 digits leave
        bool is_nothing() const { return std::abs(force) <= 0x1p-34 * rounding; }
    };
    // the force along it that a step leaves, and its rounding
    const auto left = [&](double s) -> std::optional<Residual> {
        std::vector<double> step;
        for (const double x : unit) step.push_back(s * x);
        TreeForces::Wide place = forces.stepped(rest.place, step);
        constexpr int most = 40;
        for (int iteration = 0; iteration < most && !place.empty(); ++iteration) {
            Interruption::point();
            const TreeForces::Wide f = forces.force_at(place);
            const std::vector<double> sizes = forces.force_sizes(place);
            Residual r;
            DoubleDouble sum = 0.0;
            for (int i = 0; i < n; ++i) {
                sum += DoubleDouble(unit[at(i)]) * f[at(i)];
                r.rounding += 4.0 * epsilon * std::abs(unit[at(i)]) * sizes[at(i)];
            }
            r.force = sum.hi;
            if (!std::isfinite(r.force)) return std::nullopt;
            bool is_relaxed = true;
            std::fill(step.begin(), step.end(), 0.0);
            for (int k = 0; k < n; ++k) {
                if (rest.flat[at(k)]) continue;
                DoubleDouble across = 0.0;
                double rounding = 0.0;
                for (int i = 0; i < n; ++i) {
                    across += DoubleDouble(shapes(i, k)) * f[at(i)];
                    rounding += std::abs(shapes(i, k)) * sizes[at(i)];
                }
                is_relaxed =
                    is_relaxed && std::abs(across.hi) <= std::max(1e-4 * std::abs(r.force), 0x1p-70 * rounding);
                for (int i = 0; i < n; ++i) step[at(i)] += across.hi / rest.modes.squares[at(k)] * shapes(i, k);
            }
            if (is_relaxed) return r;
            place = forces.stepped(place, step);
        }
        return std::nullopt;
    };
    const double longest = reach_along(forces, rest.place, unit), turning = forces.largest_turn(unit);
    if (!std::isfinite(longest)) return AlongNull::not_decided;
    bool is_felt = false;
    constexpr int seen = 4;  // steps in a row that have to agree
    std::vector<std::array<Residual, 2>> row;
    for (double s = 0x1p-40 * longest; s <= longest; s *= 2.0) {
        const auto ahead = left(s), back = left(-s);
        if (!ahead || !back) return AlongNull::not_decided;
        is_felt = is_felt || !ahead->is_nothing() || !back->is_nothing();
        row.push_back({*ahead, *back});
        if (!ahead->is_clear() || !back->is_clear()) row.clear();
        if (row.size() < seen) continue;
        // within what rounding and the next order make of it
        bool agree = true;
        const auto last = row.end() - seen;
        const double power = std::round(std::log2(std::abs(last[1][0].force / last[0][0].force)));
        for (int j = 1; j < seen; ++j)
            for (const std::size_t side : {std::size_t(0), std::size_t(1)})
                agree = agree && (last[j][side].force > 0.0) == (last[0][side].force > 0.0) &&
                        std::abs(std::log2(std::abs(last[j][side].force / last[j - 1][side].force)) - power) < 0.2;
        if (agree && power >= 1.0)
            return last[0][0].force < 0.0 && last[0][1].force > 0.0 ? AlongNull::stable : AlongNull::unstable;
    }
    // what is moved, and not turned, goes on; what is nothing so far may come forth as far as there is a way
    for (double s = 2.0 * longest; turning == 0.0 && !is_felt && s <= 0x1p40 * longest; s *= 2.0) {
        const auto ahead = left(s), back = left(-s);
        if (!ahead && !back) break;
        is_felt = (ahead && !ahead->is_nothing()) || (back && !back->is_nothing());
    }
    return is_felt ? AlongNull::not_decided : AlongNull::indifferent;
}

RBDYN_INLINE AlongNull along_flat(TreeForces& forces, const PinnedRest& rest, const std::vector<bool>& open) {
    const std::size_t n = open.size();
    std::vector<std::size_t> flat;
    for (std::size_t k = 0; k < n; ++k)
        if (open[k]) flat.push_back(k);
    std::vector<double> direction(n);
    // between every two, of the first few
    constexpr std::size_t most = 6;
    const std::size_t count = std::min(flat.size(), most);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i; j < count; ++j)
            for (const double other : {1.0, -1.0}) {
                if (i == j && other < 0.0) continue;
                std::fill(direction.begin(), direction.end(), 0.0);
                direction[flat[i]] = 1.0;
                if (i != j) direction[flat[j]] = other;
                const AlongNull along = along_null(forces, rest, direction);
                if (flat.size() == 1 || along == AlongNull::unstable || along == AlongNull::indifferent) return along;
            }
    return AlongNull::not_decided;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
