// Definitions of rbdyn/statics/reduced_force.hpp.
#pragma once

#include "rbdyn/statics/reduced_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE double ReducedPowers::noise_of(int k) const {
    // the coefficients of Chebyshev's polynomials of that degree are about as large
    double factor = 1.0;
    for (int i = 1; i <= k; ++i) factor *= std::max(1.0, static_cast<double>(degree) / i);
    return factor * noise;
}

RBDYN_INLINE double ReducedPowers::largest() const {
    double most = 0.0;
    for (const DoubleDouble& x : c) most = std::max(most, std::abs(x.hi));
    return most;
}

RBDYN_INLINE ReducedPowers ReducedPowers::shifted(const DoubleDouble& to) const {
    ReducedPowers result = *this;
    for (std::size_t from = 0; from < c.size(); ++from)
        for (std::size_t k = c.size() - 1; k-- > from;) result.c[k] += to * result.c[k + 1];
    return result;
}

RBDYN_INLINE ReducedForce::ReducedForce(TreeForces& forces, TreeForces::Wide place, int held)
    : forces_(forces), place_(std::move(place)), held_(held), inverse_(forces.freedoms()) {
    const int n = forces_.freedoms();
    forces_.look_at(place_);
    const WideMatrix slope = forces_.wide_jacobian().entries;
    SquareMatrix others(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) others(i, j) = i == held || j == held ? 0.0 : slope(i, j).hi;
    // the one that is held stays
    double largest = 0.0;
    for (const double x : others.entries()) largest = std::max(largest, std::abs(x));
    others(held, held) = largest > 0.0 ? largest : 1.0;
    for (int j = 0; j < n; ++j) {
        std::vector<double> unit(static_cast<std::size_t>(n));
        unit[static_cast<std::size_t>(j)] = 1.0;
        const LinearSolution column = solve(others, std::move(unit));
        is_regular_ = is_regular_ && column.pivots > 0.0;
        for (int i = 0; i < n; ++i) inverse_(i, j) = column.x[static_cast<std::size_t>(i)];
    }
}

RBDYN_INLINE std::optional<ReducedForce::Sample> ReducedForce::at(const DoubleDouble& way) const {
    if (!is_regular_) return std::nullopt;
    const auto index = [](int i) { return static_cast<std::size_t>(i); };
    const int n = forces_.freedoms();
    TreeForces::Wide place = place_;
    std::vector<double> step(index(n));
    for (const double part : {way.hi, way.lo}) {
        if (part == 0.0) continue;
        step[index(held_)] = part;
        place = forces_.stepped(place, step);
        if (place.empty()) return std::nullopt;
    }
    const std::vector<double> sizes = forces_.force_sizes(place);
    // what 32 digits leave, where constraints are closed to fewer
    const double enough = 0x1p-103, most_left = forces_.has_constraints() ? 0x1p-70 : 0x1p-92;
    double last = std::numeric_limits<double>::infinity();
    constexpr int most = 100, settled = 8;
    for (int iteration = 0; iteration < most; ++iteration) {
        Interruption::point();
        const TreeForces::Wide f = forces_.force_at(place);
        double left = 0.0;
        for (int i = 0; i < n; ++i) {
            if (!std::isfinite(f[index(i)].hi)) return std::nullopt;
            if (i != held_ && f[index(i)].hi != 0.0) left = std::max(left, std::abs(f[index(i)].hi) / sizes[index(i)]);
        }
        if (left <= enough || (left <= most_left && left > 0.5 * last))
            return Sample{f[index(held_)].hi, sizes[index(held_)], f[index(held_)], std::move(place)};
        if (iteration > settled && left > 0.9 * last) return std::nullopt;
        last = left;
        for (int i = 0; i < n; ++i) {
            double sum = 0.0;
            for (int j = 0; j < n; ++j)
                if (j != held_) sum -= inverse_(i, j) * f[index(j)].hi;
            step[index(i)] = i == held_ ? 0.0 : sum;
        }
        place = forces_.stepped(place, step);
        if (place.empty()) return std::nullopt;
    }
    return std::nullopt;
}

RBDYN_INLINE std::optional<ReducedPowers> ReducedForce::powers(double half) const {
    constexpr int degree = ReducedPowers::degree;
    std::array<double, degree + 1> x{};
    std::array<DoubleDouble, degree + 1> d{};
    ReducedPowers result;
    for (int i = 0; i <= degree; ++i) {
        const auto k = static_cast<std::size_t>(i);
        // the outermost of both sides first
        const int place = i % 2 == 0 ? i / 2 : degree - i / 2;
        x[k] = std::cos(std::numbers::pi * (place + 0.5) / (degree + 1));
        const auto sample = at(DoubleDouble(half * x[k]));
        if (!sample) return std::nullopt;
        d[k] = sample->exact;
        result.size = std::max(result.size, sample->size);
    }
    // Newton's divided differences, and powers of them
    for (std::size_t k = 1; k < d.size(); ++k)
        for (std::size_t i = d.size() - 1; i >= k; --i) d[i] = (d[i] - d[i - 1]) / (DoubleDouble(x[i]) - x[i - k]);
    for (std::size_t k = d.size(); k-- > 0;) {
        for (std::size_t i = d.size() - 1; i > 0; --i) result.c[i] = result.c[i - 1] - x[k] * result.c[i];
        result.c[0] = d[k] - x[k] * result.c[0];
    }
    constexpr std::size_t tail = 3;
    for (std::size_t k = d.size() - tail; k < d.size(); ++k)
        result.noise = std::max(result.noise, std::abs(result.c[k].hi) * std::exp2(1.0 - static_cast<double>(k)));
    // of the tail, what lies beyond it is like it
    constexpr double like = 16.0;
    result.noise = std::max(like * result.noise, 0x1p-97 * result.size);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
