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

/// What each of some contacts does (it is open, is held, slides one way or the other), and the forces and rates along
/// normals and lines, such that all are near 1.
class Problem {
public:
    static constexpr std::size_t open = 0, held = 1, forward = 2, backward = 3;

    /// `lines`: one for each cone.
    Problem(const Square& a, const std::vector<double>& b, std::vector<Line> lines) : lines_(std::move(lines)) {
        for (const Line& line : lines_) {
            first_.push_back(unknowns_.size());
            const double unit = 1.0 / std::sqrt(a[line.first][line.first]);
            unknowns_.push_back({line.first, {unit, 0.0, 0.0}});
            if (line.is_rough) unknowns_.push_back({line.first, {0.0, unit * line.across[0], unit * line.across[1]}});
        }
        w_ = SquareMatrix(count());
        for (int i = 0; i < count(); ++i) {
            for (int j = 0; j < count(); ++j)
                w_(i, j) = part(
                    i, [&](std::size_t row) { return part(j, [&](std::size_t column) { return a[row][column]; }); });
            c_.push_back(part(i, [&](std::size_t row) { return b[row]; }));
        }
    }

    /// Whether there may be more than one answer.
    bool may_have_several() const {
        return lines_.size() > 1 || (lines_[0].is_rough && lines_[0].mu * std::abs(w_(0, 1)) > w_(0, 0));
    }
    /// The forces with which contacts do this; none if they are not unique, or break a law.
    std::optional<std::vector<double>> forces(const std::vector<std::size_t>& does) const {
        constexpr double singular = 1e-10, rounding = 1e-12;
        SquareMatrix m(count());
        std::vector<double> right(c_.size(), 0.0);
        const auto vanishes = [&](std::size_t i) {
            for (int j = 0; j < count(); ++j) m(static_cast<int>(i), j) = w_(static_cast<int>(i), j);
            right[i] = -c_[i];
        };
        for (std::size_t k = 0; k < lines_.size(); ++k) {
            const std::size_t i = first_[k];
            const int normal = static_cast<int>(i), along = normal + 1;
            if (does[k] == open)
                m(normal, normal) = 1.0;
            else
                vanishes(i);
            if (!lines_[k].is_rough) continue;
            if (does[k] == held) {
                vanishes(i + 1);
                continue;
            }
            m(along, along) = 1.0;
            if (does[k] != open) m(along, normal) = does[k] == forward ? lines_[k].mu : -lines_[k].mu;
        }
        const LinearSolution solved = rbdyn::solve(m, right);
        if (!(solved.pivots > singular)) return std::nullopt;
        double size = 0.0;
        for (const auto* numbers : {&c_, &solved.x})
            for (const double one : *numbers) size = std::max(size, std::abs(one));
        for (std::size_t k = 0; k < lines_.size(); ++k)
            if (!is_lawful(k, does[k], solved.x, rounding * size)) return std::nullopt;
        return solved.x;
    }
    /// The same in the unknowns of cones.
    std::vector<double> in_cones(const std::vector<double>& z, std::size_t size) const {
        std::vector<double> force(size, 0.0);
        for (std::size_t i = 0; i < z.size(); ++i)
            for (std::size_t p = 0; p < 3; ++p)
                if (unknowns_[i].weight[p] != 0.0) force[unknowns_[i].row + p] += unknowns_[i].weight[p] * z[i];
        return force;
    }

private:
    struct Unknown {
        std::size_t row;
        double weight[3];  // of the rows it is made of
    };

    int count() const { return static_cast<int>(unknowns_.size()); }
    template <class F>
    double part(int i, const F& of_row) const {
        const Unknown& u = unknowns_[static_cast<std::size_t>(i)];
        double sum = 0.0;
        for (std::size_t p = 0; p < 3; ++p)
            if (u.weight[p] != 0.0) sum += u.weight[p] * of_row(u.row + p);
        return sum;
    }
    bool is_lawful(std::size_t k, std::size_t does, const std::vector<double>& z, double small) const {
        const std::size_t i = first_[k];
        const auto rate = [&](std::size_t row) {
            double sum = c_[row];
            for (std::size_t j = 0; j < z.size(); ++j) sum += w_(static_cast<int>(row), static_cast<int>(j)) * z[j];
            return sum;
        };
        if (!(z[i] >= -small) || (does == open && !(rate(i) >= -small))) return false;
        if (!lines_[k].is_rough || does == open) return true;
        if (does == held) return std::abs(z[i + 1]) <= lines_[k].mu * z[i] + small;
        return (does == forward ? 1.0 : -1.0) * rate(i + 1) >= -small;
    }

    std::vector<Line> lines_;
    std::vector<Unknown> unknowns_;
    std::vector<std::size_t> first_;  // unknown of each contact: its normal, and behind it its line
    SquareMatrix w_;
    std::vector<double> c_;
};

}  // namespace plane_choice

RBDYN_INLINE std::vector<ConeForces> every_choice(const Square& a, const std::vector<double>& b,
                                                  const std::vector<Cone>& cones) {
    using plane_choice::Problem;
    constexpr std::size_t most_contacts = 4;
    constexpr double widest = 1e6;
    if (cones.size() > most_contacts) return {};
    // what is smooth is open or held
    const auto ways_of = [](const plane_choice::Line& line) -> std::size_t { return line.is_rough ? 4 : 2; };
    std::vector<plane_choice::Line> lines;
    std::size_t count = 1;
    for (const Cone& cone : cones) {
        const auto line = plane_choice::line_of(a, b, cone);
        if (!line || (line->is_rough && !(line->mu <= widest)) || !(a[line->first][line->first] > 0.0)) return {};
        lines.push_back(*line);
        count *= ways_of(*line);
    }
    const Problem problem(a, b, lines);
    if (!problem.may_have_several()) return {};
    std::vector<ConeForces> result;
    for (std::size_t choice = 0; choice < count; ++choice) {
        std::vector<std::size_t> does;
        std::size_t rest = choice;
        for (const plane_choice::Line& line : lines) {
            does.push_back(rest % ways_of(line));
            rest /= ways_of(line);
        }
        const auto z = problem.forces(does);
        if (!z) continue;
        ConeForces one{problem.in_cones(*z, b.size()), b, {}, true};
        for (std::size_t i = 0; i < b.size(); ++i)
            for (std::size_t j = 0; j < b.size(); ++j) one.rate[i] += a[i][j] * one.force[j];
        for (const std::size_t what : does)
            one.states.push_back(what == Problem::open   ? ConeState::open
                                 : what == Problem::held ? ConeState::held
                                                         : ConeState::slides);
        result.push_back(std::move(one));
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
