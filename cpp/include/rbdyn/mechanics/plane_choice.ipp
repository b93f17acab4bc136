// Definitions of rbdyn/mechanics/cone_choice.hpp: what contacts may do whose friction is along lines.
//
// Each choice is a linear system (F. Pfeiffer and C. Glocker, Multibody Dynamics with Unilateral Contacts, 1996,
// section 5.3): of what is held w_n = 0 and w_t = 0, of what slides w_n = 0 and T = -mu N s, of what is open N = T = 0;
// it counts if 0 <= N, w_n, |T| <= mu N, s w_t. Several may: with Newton's law for one contact alone only if mu |A_nt|
// > A_nn.
#pragma once

#include "rbdyn/mechanics/cone_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace plane_choice {

/// A contact whose friction is along a line of its surface: across * (its two axes).
struct Line {
    std::size_t first = 0;
    bool is_rough = false;
    double mu = 0.0, across[2] = {1.0, 0.0};
};

/// That of a cone; none if its friction is along a surface.
inline std::optional<Line> line_of(const Square& a, const std::vector<double>& b, const Cone& cone) {
    Line line{static_cast<std::size_t>(cone.first), !cone.is_line, cone.mu};
    if (!line.is_rough) return line;
    const std::size_t f = line.first;
    // what of it is across all columns, the largest of which is along it
    double most = 0.0;
    for (std::size_t j = 0; j < b.size(); ++j) {
        const double size = std::hypot(a[f + 1][j], a[f + 2][j]);
        if (!(size > most)) continue;
        most = size;
        line.across[0] = a[f + 1][j] / size;
        line.across[1] = a[f + 2][j] / size;
    }
    if (!(most > 0.0)) return std::nullopt;
    const auto beside = [&](double first, double second) {
        return std::abs(second * line.across[0] - first * line.across[1]);
    };
    for (std::size_t j = 0; j < b.size(); ++j)
        if (beside(a[f + 1][j], a[f + 2][j]) > 1e-13 * most) return std::nullopt;
    if (beside(b[f + 1], b[f + 2]) > 1e-13 * std::hypot(b[f], b[f + 1], b[f + 2])) return std::nullopt;
    return line;
}

}  // namespace plane_choice

RBDYN_INLINE std::vector<ConeForces> every_choice(const Square& a, const std::vector<double>& b,
                                                  const std::vector<Cone>& cones) {
    constexpr std::size_t most_contacts = 4;
    constexpr double widest = 1e6, singular = 1e-10, rounding = 1e-12;
    enum : std::size_t { open, held, forward, backward, ways };
    std::vector<ConeForces> result;
    if (cones.size() > most_contacts) return result;
    std::vector<plane_choice::Line> lines;
    for (const Cone& cone : cones) {
        const auto line = plane_choice::line_of(a, b, cone);
        if (!line || (line->is_rough && !(line->mu <= widest))) return result;
        lines.push_back(*line);
    }
    // of each contact its normal and, if it is rough, its line; such that all numbers are near 1
    struct Unknown {
        std::size_t row;
        double weight[3];  // of the rows it is made of
    };
    std::vector<Unknown> unknowns;
    std::vector<std::size_t> first;
    for (const plane_choice::Line& line : lines) {
        first.push_back(unknowns.size());
        const double own = a[line.first][line.first];
        if (!(own > 0.0)) return result;
        double unit = 1.0 / std::sqrt(own);
        unknowns.push_back({line.first, {unit, 0.0, 0.0}});
        if (line.is_rough) unknowns.push_back({line.first, {0.0, unit * line.across[0], unit * line.across[1]}});
    }
    const std::size_t n = unknowns.size();
    const auto driving = [&](std::size_t i, const auto& of_row) {
        double sum = 0.0;
        for (std::size_t p = 0; p < 3; ++p)
            if (unknowns[i].weight[p] != 0.0) sum += unknowns[i].weight[p] * of_row(unknowns[i].row + p);
        return sum;
    };
    SquareMatrix w(static_cast<int>(n));
    std::vector<double> c(n);
    double most = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j)
            w(static_cast<int>(i), static_cast<int>(j)) = driving(
                i, [&](std::size_t row) { return driving(j, [&](std::size_t column) { return a[row][column]; }); });
        c[i] = driving(i, [&](std::size_t row) { return b[row]; });
        most = std::max(most, std::abs(c[i]));
    }
    if (lines.size() == 1 && (n == 1 || !(lines[0].mu * std::abs(w(0, 1)) > w(0, 0)))) return result;
    std::size_t count = 1;
    for (std::size_t k = 0; k < lines.size(); ++k) count *= ways;
    for (std::size_t choice = 0; choice < count; ++choice) {
        SquareMatrix m(static_cast<int>(n));
        std::vector<double> right(n, 0.0);
        const auto law = [&](std::size_t i) {
            for (int j = 0; j < m.size(); ++j) m(static_cast<int>(i), j) = w(static_cast<int>(i), j);
            right[i] = -c[i];
        };
        std::vector<std::size_t> does;
        bool is_one = true;
        for (std::size_t k = 0, rest = choice; k < lines.size(); ++k, rest /= ways) {
            does.push_back(rest % ways);
            const std::size_t i = first[k];
            const auto diagonal = static_cast<int>(i);
            // what is smooth has no more than two
            is_one = is_one && (lines[k].is_rough || does[k] <= held);
            if (does[k] == open)
                m(diagonal, diagonal) = 1.0;
            else
                law(i);
            if (!lines[k].is_rough) continue;
            if (does[k] == held) {
                law(i + 1);
                continue;
            }
            m(diagonal + 1, diagonal + 1) = 1.0;
            if (does[k] != open) m(diagonal + 1, diagonal) = does[k] == forward ? lines[k].mu : -lines[k].mu;
        }
        if (!is_one) continue;
        const LinearSolution solved = rbdyn::solve(m, right);
        if (!(solved.pivots > singular)) continue;
        const std::vector<double>& z = solved.x;
        double pressing = 0.0;
        for (const double one : z) pressing = std::max(pressing, std::abs(one));
        const double small = rounding * std::max(most, pressing);
        bool is_right = true;
        for (std::size_t k = 0; k < lines.size() && is_right; ++k) {
            const std::size_t i = first[k];
            const auto rate = [&](std::size_t row) {
                double sum = c[row];
                for (std::size_t j = 0; j < n; ++j) sum += w(static_cast<int>(row), static_cast<int>(j)) * z[j];
                return sum;
            };
            is_right = z[i] >= -small && (does[k] != open || rate(i) >= -small);
            if (!is_right || !lines[k].is_rough) continue;
            if (does[k] == held) is_right = std::abs(z[i + 1]) <= lines[k].mu * z[i] + small;
            if (does[k] == forward) is_right = rate(i + 1) >= -small;
            if (does[k] == backward) is_right = rate(i + 1) <= small;
        }
        if (!is_right) continue;
        ConeForces one{std::vector<double>(b.size(), 0.0), b, {}, true};
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t p = 0; p < 3; ++p)
                if (unknowns[i].weight[p] != 0.0) one.force[unknowns[i].row + p] += unknowns[i].weight[p] * z[i];
        for (std::size_t i = 0; i < b.size(); ++i)
            for (std::size_t j = 0; j < b.size(); ++j) one.rate[i] += a[i][j] * one.force[j];
        for (std::size_t k = 0; k < lines.size(); ++k)
            one.states.push_back(does[k] == open   ? ConeState::open
                                 : does[k] == held ? ConeState::held
                                                   : ConeState::slides);
        result.push_back(std::move(one));
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
