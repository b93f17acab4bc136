// Definitions of rbdyn/statics/null_direction.hpp.
#pragma once

#include "rbdyn/statics/null_direction.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/statics/forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE AlongNull along_null(Forces& forces, const std::vector<double>& q, const SymmetricEigen& e, int null,
                                  const std::vector<bool>& stiff) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces.freedoms();
    const Forces::State zero = forces.at_rest(q);
    const auto root = [&](int i) { return std::sqrt(zero.metric[at(i)]); };
    struct Residual {
        double force = 0.0, rounding = 0.0;
    };
    // the force along it that a step leaves, and its rounding
    const auto left = [&](double s) -> std::optional<Residual> {
        std::vector<double> way(at(n));
        for (int i = 0; i < n; ++i) way[at(i)] = s * e.vectors(i, null);
        for (int iteration = 0;; ++iteration) {
            std::vector<double> step(at(n));
            for (int i = 0; i < n; ++i) step[at(i)] = way[at(i)] / root(i);
            const Forces::State there = forces.at_rest(forces.moved(q, step));
            if (!there.is_finite()) return std::nullopt;
            const auto along = [&](int k) {
                double sum = 0.0;
                for (int i = 0; i < n; ++i) sum += e.vectors(i, k) * there.force[at(i)] / root(i);
                return sum;
            };
            if (iteration == 12) {
                Residual r{along(null), 0.0};
                for (int i = 0; i < n; ++i)
                    r.rounding += 16.0 * epsilon * std::abs(e.vectors(i, null)) * there.effort[at(i)] / root(i);
                return r;
            }
            for (int k = 0; k < n; ++k) {
                if (!stiff[at(k)]) continue;
                const double by = along(k) / e.values[at(k)];
                for (int i = 0; i < n; ++i) way[at(i)] += by * e.vectors(i, k);
            }
        }
    };
    // a step that turns a body by half a radian, or takes it half as far as it is from where its coordinates count
    std::vector<double> unit(at(n));
    for (int i = 0; i < n; ++i) unit[at(i)] = e.vectors(i, null) / root(i);
    double longest = std::numeric_limits<double>::infinity();
    if (const double turning = forces.largest_turn(unit); turning > 0.0) longest = 0.5 / turning;
    for (int i = 0; i < n; ++i)
        if (zero.size[at(i)] > 0.0 && unit[at(i)] != 0.0)
            longest = std::min(longest, 0.5 * zero.size[at(i)] / std::abs(unit[at(i)]));
    if (!std::isfinite(longest)) return AlongNull::not_decided;
    bool is_felt = false;
    for (double s = 0x1p-26 * longest; s <= 0.5 * longest; s *= 2.0) {
        const auto ahead = left(s), back = left(-s), further = left(2.0 * s), further_back = left(-2.0 * s);
        if (!ahead || !back || !further || !further_back) return AlongNull::not_decided;
        const auto clear = [](const Residual& r) { return std::abs(r.force) > 4.0 * r.rounding; };
        is_felt = is_felt || clear(*further) || clear(*further_back);
        if (!clear(*ahead) || !clear(*back)) continue;
        const double exponent = std::log2(std::abs(further->force / ahead->force)),
                     exponent_back = std::log2(std::abs(further_back->force / back->force));
        // within what rounding and the next order make of it
        if (std::abs(exponent - exponent_back) > 0.5 || std::abs(exponent - std::round(exponent)) > 0.25) continue;
        return ahead->force < 0.0 && back->force > 0.0 ? AlongNull::stable : AlongNull::unstable;
    }
    return is_felt ? AlongNull::not_decided : AlongNull::indifferent;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
