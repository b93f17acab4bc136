// Definitions of rbdyn/mechanics/critical.hpp.
#pragma once

#include "rbdyn/mechanics/critical.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/redundant.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace critical {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Decomposition = Eigen::JacobiSVD<Matrix>;

/// A state, with lengths in units of its reach and the time in one of its own: what is near and what vanishes is the
/// same in any units.
class Search {
public:
    Search(const Tree& tree, const Conditions& conditions, double t, std::vector<DoubleDouble> x)
        : tree_(tree), conditions_(conditions), t_(t), x_(std::move(x)) {
        const auto all = closing::moving<double>(tree_, t_, closing::nearest(x_));
        reach_ = closing::extent(all);
        for (const Condition& c : conditions_.all())
            for (const Anchor* a : {&c.a, &c.b}) reach_ = std::max(reach_, tree_.point<double>(*a, all).place.norm());
        const double speed = fastest(all, reach_);
        unit_ = speed > 0.0 ? reach_ / speed : 1.0;
        measures_ = conditions_.measures();
        measures_.resize(static_cast<std::size_t>(conditions_.constraint_rows()));
        for (double& one : measures_) one *= reach_ > 0.0 ? reach_ : 1.0;
        ways_ = closing::ways(tree_, all, reach_);
    }

    std::size_t variables() const { return static_cast<std::size_t>(tree_.velocities()) + 1; }

    /// The rates of the rows, each over its measure, for each velocity alone, then for the time.
    Matrix jacobian() const { return jacobian(t_, x_); }
    Matrix jacobian_at(const Vector& change) const {
        double t = t_;
        std::vector<DoubleDouble> x = x_;
        move(change, t, x);
        return jacobian(t, x);
    }
    void move(const Vector& change) { move(change, t_, x_); }
    /// Of each row what a length in units of the reach is of its gap.
    const std::vector<double>& measures() const { return measures_; }

    std::vector<DoubleDouble> gaps() const {
        return closing::of_constraints(
            conditions_.gaps<DoubleDouble>(tree_, closing::moving<DoubleDouble>(tree_, t_, x_)), conditions_);
    }

    /// Of each row what its gap is a difference of.
    std::vector<double> sizes() const {
        std::vector<double> sizes;
        for (const Condition& c : conditions_.all()) {
            const std::size_t angles = c.angles.size(), rows = static_cast<std::size_t>(c.rows());
            const double size = c.points == Condition::Points::distance ? reach_ * reach_ : reach_;
            sizes.insert(sizes.end(), rows - angles, size);
            sizes.insert(sizes.end(), angles, 1.0);
        }
        return sizes;
    }

private:
    void move(const Vector& change, double& t, std::vector<DoubleDouble>& x) const {
        std::vector<double> of_joints(change.data(), change.data() + tree_.velocities());
        for (std::size_t k = 0; k < of_joints.size(); ++k) of_joints[k] *= ways_[k];
        t += unit_ * change[tree_.velocities()];
        closing::move<DoubleDouble>(tree_, t, of_joints, x);
        closing::normalize<DoubleDouble>(tree_, x);
    }

    Matrix jacobian(double t, const std::vector<DoubleDouble>& x) const {
        std::vector<double> state = closing::nearest(x);
        const auto velocities = state.begin() + tree_.positions();
        std::fill(velocities, state.end(), 0.0);
        const auto all = closing::moving<double>(tree_, t, state);
        const auto rows = conditions_.rows<double>(tree_, all);
        const int count = conditions_.constraint_rows(), n = tree_.velocities();
        Matrix result(count, n + 1);
        for (int r = 0; r < count; ++r) result(r, n) = Conditions::rate(rows[static_cast<std::size_t>(r)], all);
        for (int k = 0; k < n; ++k) {
            velocities[k] = ways_[static_cast<std::size_t>(k)];
            const auto moving = closing::moving<double>(tree_, t, state);
            velocities[k] = 0.0;
            for (int r = 0; r < count; ++r)
                result(r, k) = Conditions::rate(rows[static_cast<std::size_t>(r)], moving) - result(r, n);
        }
        result.col(n) *= unit_;
        for (int r = 0; r < count; ++r) result.row(r) /= measures_[static_cast<std::size_t>(r)];
        return result;
    }

    const Tree& tree_;
    const Conditions& conditions_;
    double t_;
    std::vector<DoubleDouble> x_;
    double reach_, unit_;
    std::vector<double> measures_, ways_;  // of rows; of velocities
};

/// How many singular values are not about to vanish, of those that are as many as the rank elsewhere: up to where they
/// drop most; one alone is held against 1.
inline int regular_of(const Vector& values, int rank) {
    int best = rank;
    double most = 10.0;
    if (rank == 1 && 1.0 > most * values[0]) return 0;
    for (int k = 1; k < rank; ++k)
        if (const double drop = values[k - 1] / values[k]; drop > most) {
            most = drop;
            best = k;
        }
    return best;
}

}  // namespace critical

RBDYN_INLINE std::optional<Critical> critical_near(const Tree& tree, const Conditions& conditions, std::size_t rank,
                                                   double t, std::vector<DoubleDouble> x) {
    using critical::Matrix, critical::Vector;
    constexpr int most_steps = 12;
    constexpr double far = 0.5, aside = 1e-5, found = 1e-7, vanishes = 1e-7;
    critical::Search search(tree, conditions, t, std::move(x));
    const int n = static_cast<int>(search.variables()), count = conditions.constraint_rows(),
              most = static_cast<int>(rank);
    if (most < 1 || most > std::min(n, count)) return std::nullopt;
    Vector moved = Vector::Zero(n);
    int regular = -1;
    for (int step = 0; step < most_steps; ++step) {
        const Matrix here = search.jacobian();
        if (!here.allFinite()) return std::nullopt;
        const critical::Decomposition parts(here, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const Vector& values = parts.singularValues();
        if (regular < 0) regular = critical::regular_of(values, most);
        if (regular == most) return std::nullopt;
        const Matrix left = parts.matrixU().rightCols(count - regular), right = parts.matrixV().rightCols(n - regular);
        const int tied = count - regular, free = n - regular;
        // l . F' = 0 along all that what is left allows
        Matrix bends(tied * free, free);
        for (int j = 0; j < free; ++j) {
            const Vector way = right.col(j) * aside;
            const Matrix bend = left.transpose() * (search.jacobian_at(way) - search.jacobian_at(-way)) * right;
            bends.col(j) = Eigen::Map<const Vector>(bend.data(), tied * free) / (2.0 * aside);
        }
        const Matrix off = left.transpose() * here * right;
        critical::Decomposition bent(bends, Eigen::ComputeThinU | Eigen::ComputeThinV);
        bent.setThreshold(1e-6);
        std::vector<double> rounded = closing::nearest(search.gaps());
        for (std::size_t r = 0; r < rounded.size(); ++r) rounded[r] /= search.measures()[r];
        const Vector open = Eigen::Map<const Vector>(rounded.data(), count);
        Vector change = right * bent.solve(-Eigen::Map<const Vector>(off.data(), tied * free));
        for (int k = 0; k < regular; ++k)
            change -= parts.matrixV().col(k) * (parts.matrixU().col(k).dot(open) / values[k]);
        moved += change;
        if (!(moved.norm() <= far)) return std::nullopt;
        search.move(change);
        // by twice as many digits with each change
        if (change.norm() > found) continue;
        if (!(values[regular] <= vanishes * std::max(values[0], regular == 0 ? 1.0 : 0.0))) return std::nullopt;
        const std::vector<DoubleDouble> gaps = search.gaps();
        Critical result{std::vector<double>(static_cast<std::size_t>(count), 0.0), 0.0};
        for (int a = 0; a < tied; ++a) {
            DoubleDouble sum(0.0);
            for (int r = 0; r < count; ++r)
                sum += gaps[static_cast<std::size_t>(r)] *
                       DoubleDouble(left(r, a) / search.measures()[static_cast<std::size_t>(r)]);
            for (int r = 0; r < count; ++r)
                result.open[static_cast<std::size_t>(r)] +=
                    left(r, a) * search.measures()[static_cast<std::size_t>(r)] * static_cast<double>(sum);
        }
        const std::vector<double> sizes = search.sizes();
        for (std::size_t r = 0; r < sizes.size(); ++r)
            result.most = std::max(result.most, std::abs(result.open[r]) / sizes[r]);
        return result;
    }
    return std::nullopt;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
