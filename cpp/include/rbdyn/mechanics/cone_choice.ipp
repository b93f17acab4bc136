// Definitions of rbdyn/mechanics/cone_choice.hpp.
//
// While each contact goes on with what it does, its conditions are differentiated where they hold (R. W. Cottle,
// J.-S. Pang and R. E. Stone, The Linear Complementarity Problem, 1992, section 3.6): dw = 0 of what is held; of what
// slides along d = w_t / |w_t|
//     dw_n = 0,   |w_t| (dT + mu dN d) + mu N (1 - d d^T) dw_t = 0.
// Four corners of what lies flat push with one force more than there are ways to move out of the plane.
#pragma once

#include "rbdyn/mechanics/cone_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE bool OtherForces::changes_normals(const std::vector<Cone>& cones) const {
    double most = 0.0, normal = 0.0;
    for (const double one : change) most = std::max(most, std::abs(one));
    for (const Cone& cone : cones) normal = std::max(normal, std::abs(change[static_cast<std::size_t>(cone.first)]));
    return normal > 1e-9 * most;
}

RBDYN_INLINE bool OtherForces::makes_difference(const Square& a, double fastest) const {
    for (const std::vector<double>& row : a) {
        double rate = 0.0;
        for (std::size_t j = 0; j < change.size(); ++j) rate += row[j] * change[j];
        if (std::abs(rate) > std::max(1e-12 * fastest, 1e2 * rounding)) return true;
    }
    return false;
}

RBDYN_INLINE std::vector<OtherForces> other_forces(const Square& a, const std::vector<double>& noise,
                                                   const std::vector<Cone>& all, const ConeForces& found) {
    const std::size_t n = noise.size();
    const auto unknowns = [](const Cone& cone) { return cone.is_line ? std::size_t{1} : std::size_t{3}; };
    std::vector<double> unit(n, 1.0);  // of forces, such that all numbers of the problem are near 1
    double most = 0.0;
    for (const Cone& cone : all) {
        const auto f = static_cast<std::size_t>(cone.first);
        double largest = 0.0;
        for (std::size_t i = f; i < f + unknowns(cone); ++i) largest = std::max(largest, a[i][i]);
        for (std::size_t i = f; i < f + unknowns(cone); ++i) {
            if (largest > 0.0) unit[i] = 1.0 / std::sqrt(largest);
            most = std::max(most, std::abs(found.force[i]) / unit[i]);
        }
    }
    if (!(most > 0.0)) return {};
    // what neither pushes nor opens may begin to push
    std::vector<std::size_t> touching;
    std::vector<bool> is_closed(n, false);
    SquareMatrix m(static_cast<int>(n));
    const auto put = [&](std::size_t i, std::size_t j, double v) { m(static_cast<int>(i), static_cast<int>(j)) += v; };
    const auto condition = [&](std::size_t k, bool is_open) {
        const auto f = static_cast<std::size_t>(all[k].first);
        for (std::size_t i = f; i < f + unknowns(all[k]); ++i) {
            is_closed[i] = !is_open;
            for (std::size_t j = 0; j < n; ++j) m(static_cast<int>(i), static_cast<int>(j)) = 0.0;
            if (is_open) put(i, i, 1.0);
        }
        if (is_open) return;
        const double speed = all[k].is_line ? 0.0 : std::hypot(found.rate[f + 1], found.rate[f + 2]);
        const bool slides =
            !all[k].is_line && std::isfinite(all[k].mu) && speed > 1e2 * noise[f] && found.states[k] != ConeState::held;
        for (std::size_t i = f; i < f + (slides ? 1 : unknowns(all[k])); ++i)
            for (std::size_t j = 0; j < n; ++j) put(i, j, unit[i] * a[i][j] * unit[j]);
        if (!slides) return;
        const double d[2] = {found.rate[f + 1] / speed, found.rate[f + 2] / speed},
                     turning = all[k].mu * std::max(found.force[f], 0.0), own = speed * unit[f + 1] * unit[f + 1],
                     whole = own * std::max(all[k].mu, 1.0) + turning;
        for (std::size_t i = 0; i < 2; ++i) {
            put(f + 1 + i, f + 1 + i, own / whole);
            put(f + 1 + i, f, own / whole * all[k].mu * d[i]);
            for (std::size_t j = 0; j < n; ++j)
                put(f + 1 + i, j,
                    turning / whole * unit[f + 1] * unit[j] *
                        (a[f + 1 + i][j] - d[i] * (d[0] * a[f + 1][j] + d[1] * a[f + 2][j])));
        }
    };
    for (std::size_t k = 0; k < all.size(); ++k) {
        const auto f = static_cast<std::size_t>(all[k].first);
        double size = noise[f];
        for (std::size_t j = 0; j < n; ++j) size += 1e-14 * std::abs(a[f][j] * found.force[j]);
        const bool pushes = found.states[k] != ConeState::open && found.force[f] > 1e-12 * most * unit[f];
        if (!pushes && std::abs(found.rate[f]) <= 8.0 * size) touching.push_back(k);
        condition(k, !pushes);
    }
    std::vector<OtherForces> result;
    const auto add = [&](std::size_t column) {
        // a unit of it, and what the others do against that
        std::vector<double> by(n);
        for (std::size_t i = 0; i < n; ++i) by[i] = -m(static_cast<int>(i), static_cast<int>(column));
        std::vector<double> way = rbdyn::solve(m, by, 1e-11).x;
        if (std::abs(way[column] + 1.0) < 0.5) return;
        way[column] += 1.0;
        double largest = 0.0;
        for (const double one : way) largest = std::max(largest, std::abs(one));
        OtherForces other{std::vector<double>(n), 0.0};
        const double times = most / largest;
        for (std::size_t i = 0; i < n; ++i) {
            other.change[i] = times * way[i] * unit[i];
            double left = 0.0, size = 0.0;
            for (std::size_t j = 0; j < n; ++j) {
                const double part = m(static_cast<int>(i), static_cast<int>(j)) * way[j];
                left += part;
                size += std::abs(part);
            }
            other.rounding = std::max(other.rounding, times * (std::abs(left) + 1e-15 * size) / unit[i]);
        }
        result.push_back(std::move(other));
    };
    const auto add_all = [&] {
        for (std::size_t column = 0; column < n; ++column)
            if (is_closed[column]) add(column);
    };
    add_all();
    // with those that push any one that touches may: at a corner of the choices each other one begins so
    for (const std::size_t k : touching) {
        condition(k, false);
        add_all();
        condition(k, true);
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
