// Definitions of rbdyn/mechanics/closure.hpp.
#pragma once

#include "rbdyn/mechanics/closure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/model/projection.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace closing {

/// The rows of a tree where it is, and what they do to it.
class Responses {
public:
    using Sparse = Accelerate<double>::Sparse;

    Responses(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
              std::vector<Moving<double>> all)
        : tree_(tree), all_(std::move(all)), accelerate_(accelerate<double>(tree, all_)) {
        const auto every = conditions.rows<double>(tree, all_);
        for (const int r : rows) responses_.push_back(accelerate_.response(every[static_cast<std::size_t>(r)]));
    }
    std::vector<std::vector<double>> matrix() const {
        std::vector<std::vector<double>> a(responses_.size(), std::vector<double>(responses_.size()));
        for (std::size_t i = 0; i < a.size(); ++i)
            for (std::size_t j = 0; j <= i; ++j)
                a[i][j] = a[j][i] = accelerate_.between(responses_[i], responses_[j]);
        return a;
    }
    /// The change of the velocities that changes each row by what is asked.
    std::vector<double> changes(const std::vector<double>& asked) const {
        const std::vector<double> lambda = solve_definite<double>(matrix(), asked);
        std::vector<double> u(static_cast<std::size_t>(accelerate_.freedoms()), 0.0);
        for (std::size_t j = 0; j < responses_.size(); ++j)
            for (const auto& [n, one] : responses_[j]) u[static_cast<std::size_t>(n)] += one * lambda[j];
        return velocity_changes<double>(tree_, accelerate_.spread(u));
    }

private:
    const Tree& tree_;
    std::vector<Moving<double>> all_;  // what accelerate_ looks at
    Accelerate<double> accelerate_;
    std::vector<Sparse> responses_;
};

}  // namespace closing

RBDYN_INLINE std::vector<int> independent_rows(const Tree& tree, const Conditions& conditions,
                                               const std::vector<Moving<double>>& all) {
    std::vector<int> every(static_cast<std::size_t>(conditions.rows()));
    for (int r = 0; r < conditions.rows(); ++r) every[static_cast<std::size_t>(r)] = r;
    auto a = closing::Responses(tree, conditions, every, all).matrix();
    const std::size_t n = a.size();
    std::vector<double> own(n);
    double nothing = 0.0;
    for (std::size_t i = 0; i < n; ++i) nothing = std::max(nothing, 1e-26 * a[i][i]);
    // between bodies that cannot move against each other a row does nothing, but for the square of rounding
    for (std::size_t i = 0; i < n; ++i) own[i] = a[i][i] > nothing ? a[i][i] : 0.0;
    std::vector<int> chosen;
    std::vector<bool> is_used(n, false);
    // Cholesky's decomposition, the row next that keeps most of itself; what is left of dependent ones is rounding
    constexpr double rounding = 1e-11;
    while (true) {
        std::size_t best = n;
        double most = rounding;
        for (std::size_t i = 0; i < n; ++i)
            if (!is_used[i] && own[i] > 0.0 && a[i][i] / own[i] > most) {
                // of equals the first
                most = a[i][i] / own[i] * (1.0 + 1e-6);
                best = i;
            }
        if (best == n) break;
        is_used[best] = true;
        chosen.push_back(static_cast<int>(best));
        for (std::size_t i = 0; i < n; ++i) {
            if (is_used[i]) continue;
            const double factor = a[i][best] / a[best][best];
            for (std::size_t j = 0; j < n; ++j)
                if (!is_used[j]) a[i][j] -= factor * a[best][j];
        }
    }
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

RBDYN_INLINE double close(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows, double t,
                          std::vector<DoubleDouble>& x, int most) {
    const auto doubles = [&] { return closing::moving<double>(tree, t, closing::nearest(x)); };
    double left = 0.0, before = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < most; ++pass) {
        const auto gaps = conditions.gaps<DoubleDouble>(tree, closing::moving<DoubleDouble>(tree, t, x));
        left = closing::largest(closing::nearest(gaps));
        if (left == 0.0 || (pass > 3 && left >= before)) break;
        before = left;
        const closing::Responses now(tree, conditions, rows, doubles());
        closing::move<DoubleDouble>(tree, now.changes(closing::chosen(gaps, rows)), x);
        closing::normalize<DoubleDouble>(tree, x);
    }
    for (int pass = 0; pass < 3; ++pass) {
        const auto all = closing::moving<DoubleDouble>(tree, t, x);
        std::vector<DoubleDouble> rates;
        for (const auto& row : conditions.rows<DoubleDouble>(tree, all)) rates.push_back(Conditions::rate(row, all));
        const closing::Responses now(tree, conditions, rows, doubles());
        const std::vector<double> changes = now.changes(closing::chosen(rates, rows));
        for (int k = 0; k < tree.velocities(); ++k)
            x[static_cast<std::size_t>(tree.positions() + k)] += changes[static_cast<std::size_t>(k)];
    }
    return left;
}

RBDYN_INLINE void TreeProjection::apply(std::span<double> x, std::span<double> low, double /*step*/) const {
    using Real = long double;
    std::vector<Real> wide(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) wide[i] = static_cast<Real>(x[i]) + static_cast<Real>(low[i]);
    const std::vector<Real> before = wide;
    closing::normalize<Real>(*tree_, wide);
    if (!rows_.empty()) {
        const auto all = closing::moving<Real>(*tree_, 0.0, wide);
        const closing::Responses now(*tree_, *conditions_, rows_,
                                     closing::moving<double>(*tree_, 0.0, {x.begin(), x.end()}));
        const auto gaps = conditions_->gaps<Real>(*tree_, all);
        closing::move<Real>(*tree_, now.changes(closing::chosen(gaps, rows_)), wide);
        const auto moved = closing::moving<Real>(*tree_, 0.0, wide);
        std::vector<Real> rates;
        for (const auto& row : conditions_->rows<Real>(*tree_, moved)) rates.push_back(Conditions::rate(row, moved));
        const std::vector<double> changes = now.changes(closing::chosen(rates, rows_));
        for (int k = 0; k < tree_->velocities(); ++k)
            wide[static_cast<std::size_t>(tree_->positions() + k)] += static_cast<Real>(changes[static_cast<std::size_t>(k)]);
    }
    for (std::size_t i = 0; i < x.size(); ++i)
        if (wide[i] != before[i]) projecting::add(x, low, static_cast<int>(i), wide[i] - before[i]);
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
