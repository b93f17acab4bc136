// Holds a tree on its constraints: positions and velocities moved to the nearest that satisfy them.
//
// Nearest in the metric of the masses: the change of the coordinates is M^-1 J^T lambda with J M^-1 J^T lambda = -gap,
// and of the velocities the same with -gap' (E. Eich, SIAM J. Numer. Anal. 30, 1993, 1467-1482). Gaps are computed in
// more digits than doubles have, so that what is left of them is the rounding of the state. Of rows that depend on each
// other as many are used as are independent.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// The bodies of a tree where they are, to accelerate.
template <class S>
Accelerate<S> accelerate(const Tree& tree, const std::vector<Moving<S>>& all) {
    std::vector<typename Accelerate<S>::Body> bodies;
    bodies.reserve(all.size());
    for (int i = 0; i < tree.size(); ++i) {
        const Node& n = tree.node(i);
        const Moving<S>& m = all[static_cast<std::size_t>(i)];
        const S mass = exactly<S>(n.mass);
        const Vector3Of<S> c = m.to_world(exactly<S>(n.center));
        S square;
        if constexpr (std::is_same_v<S, Expression>)
            square = exactly<S>(n.mass * dot<DoubleDouble>(n.center, n.center));  // it turns and stays what it is
        else
            square = dot<S>(c, Vector3Of<S>(c * mass));
        bodies.push_back({n.parent, m, SixInertia<S>(mass, c, tree.inertia_of<S>(i, m), square)});
    }
    return Accelerate<S>(std::move(bodies));
}

/// Changes of velocity variables from what accelerations make of the joints: of what turns freely its own turn.
template <class S>
std::vector<S> velocity_changes(const Tree& tree, const typename Accelerate<S>::Result& a) {
    std::vector<S> changes = a.joints;
    for (int i = 0; i < tree.size(); ++i)
        if (const int first = tree.node(i).joint.attitude(); first >= 0)
            for (int k = 0; k < 3; ++k)
                changes[static_cast<std::size_t>(tree.node(i).v + first + k)] =
                    a.bodies[static_cast<std::size_t>(i)].turn[k];
    return changes;
}

namespace closing {

template <class W>
std::vector<double> nearest(const std::vector<W>& x) {
    std::vector<double> result;
    for (const W& value : x) result.push_back(static_cast<double>(value));
    return result;
}
template <class W>
std::vector<double> chosen(const std::vector<W>& all, const std::vector<int>& rows) {
    std::vector<double> result;
    // joints have no gaps
    for (const int r : rows)
        result.push_back(
            static_cast<std::size_t>(r) < all.size() ? -static_cast<double>(all[static_cast<std::size_t>(r)]) : 0.0);
    return result;
}
/// Of something for each row what belongs to constraints.
template <class T>
std::vector<T> of_constraints(std::vector<T> all, const Conditions& conditions) {
    all.erase(all.begin() + conditions.constraint_rows(), all.end());
    return all;
}
inline double largest(const std::vector<double>& values) {
    double most = 0.0;
    for (const double v : values) most = std::max(most, std::abs(v));
    return most;
}
/// The same of gaps or rates of rows with measures, as lengths.
inline double largest(const std::vector<double>& values, const std::vector<double>& measures) {
    double most = 0.0;
    for (std::size_t r = 0; r < values.size(); ++r) most = std::max(most, std::abs(values[r]) / measures[r]);
    return most;
}
/// The measures of some rows.
inline std::vector<double> measures_of(const Conditions& conditions, const std::vector<int>& rows) {
    const std::vector<double> every = conditions.measures();
    std::vector<double> result;
    for (const int r : rows) result.push_back(every[static_cast<std::size_t>(r)]);
    return result;
}

template <class W>
std::vector<Moving<W>> moving(const Tree& tree, double t, const std::vector<W>& x) {
    return tree.moving<W>(W(t), x.data(), x.data() + tree.positions());
}

/// Of each velocity of a joint how much of it is a turn of a radian or a way of a length, of the scene [m].
[[gnu::cold]] std::vector<double> ways(const Tree& tree, const std::vector<Moving<double>>& all, double length);

/// How far from the origin bodies are [m], and not less than 0: what gaps are differences of.
inline double extent(const std::vector<Moving<double>>& all) {
    double most = 0.0;
    for (const Moving<double>& m : all) most = std::max(most, m.place.norm());
    return most;
}

/// The least of the arms that turn with bodies, and of what is as long or as round as constraints and contacts say [m]:
/// by how much these bend. Zero if there is none.
[[gnu::cold]] double least_arm(const Tree& tree, const Conditions& conditions);

/// Moves positions by the changes of velocities, at a time.
template <class W>
void move(const Tree& tree, double t, const std::vector<double>& changes, std::vector<W>& x) {
    for (int i = 0; i < tree.size(); ++i) {
        const Node& n = tree.node(i);
        W v[6], rate[7];
        for (int k = 0; k < n.joint.velocities(); ++k) v[k] = W(changes[static_cast<std::size_t>(n.v + k)]);
        W* const q = x.data() + n.q;
        n.joint.rates<W>(q, v, rate);
        for (int k = 0; k < n.joint.positions(); ++k) q[k] += rate[k];
    }
    tree.follow<W>(t, x.data());
}

template <class W>
void normalize(const Tree& tree, std::vector<W>& x) {
    for (const Node& n : tree.nodes())
        if (const int first = n.joint.attitude(); first >= 0) {
            W* const q = x.data() + n.q + first;
            W square = W(0.0);
            for (int k = 0; k < 4; ++k) square += q[k] * q[k];
            // 1/sqrt(s) near s = 1; twice where it starts further off
            const W off = square - W(1.0), factor = W(1.0) - off * W(0.5) + off * off * W(0.375);
            for (int k = 0; k < 4; ++k) q[k] *= factor;
        }
}

/// The rows of a tree where it is, and what they do to it.
class Responses {
public:
    using Sparse = Accelerate<double>::Sparse;

    Responses(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
              const std::vector<Moving<double>>& all)
        : tree_(tree), accelerate_(accelerate<double>(tree, all)) {
        const auto every = conditions.rows<double>(tree, all);
        for (const int r : rows) {
            responses_.push_back(accelerate_.response(every[static_cast<std::size_t>(r)]));
            extents_.push_back(accelerate_.extent(every[static_cast<std::size_t>(r)]));
        }
    }
    /// Of each row what counts as nothing: the square of rounding, where bodies cannot move against each other.
    double nothing(std::size_t row) const { return 1e-26 * extents_[row]; }
    /// Of each row the square of all it could be, did its parts not cancel.
    double extent(std::size_t row) const { return extents_[row]; }
    const std::vector<double>& extents() const { return extents_; }
    std::vector<std::vector<double>> matrix() const {
        std::vector<std::vector<double>> a(responses_.size(), std::vector<double>(responses_.size()));
        for (std::size_t i = 0; i < a.size(); ++i)
            for (std::size_t j = 0; j <= i; ++j) a[i][j] = a[j][i] = accelerate_.between(responses_[i], responses_[j]);
        return a;
    }
    /// The change of the velocities that changes each row by what is asked.
    std::vector<double> changes(const std::vector<double>& asked) const { return changes(asked, 1); }
    /// The same to rounding of the velocities, not of the matrix, which has fewer digits of a heavy body on a light
    /// one: what they lack of what is asked is made up for.
    std::vector<double> exact_changes(const std::vector<double>& asked) const {
        constexpr int passes = 4;
        return changes(asked, passes);
    }

private:
    std::vector<double> changes(const std::vector<double>& asked, int passes) const {
        const auto a = matrix();
        std::vector<double> u(static_cast<std::size_t>(accelerate_.freedoms()), 0.0), left = asked;
        for (int pass = 0; pass < passes && (pass == 0 || lacks(u, asked, left)); ++pass) {
            const std::vector<double> lambda = solve_definite<double>(a, left);
            for (std::size_t j = 0; j < responses_.size(); ++j)
                for (const auto& [n, one] : responses_[j]) u[static_cast<std::size_t>(n)] += one * lambda[j];
        }
        return velocity_changes<double>(tree_, accelerate_.spread(u));
    }

    /// What is left to ask for when u drives the velocities; whether that is more than rounding.
    bool lacks(std::vector<double> u, const std::vector<double>& asked, std::vector<double>& left) const {
        for (std::size_t j = 0; j < responses_.size(); ++j) left[j] = asked[j] - accelerate_.along(responses_[j], u);
        for (double& one : u) one = std::abs(one);
        for (std::size_t j = 0; j < responses_.size(); ++j) {
            Sparse sizes = responses_[j];
            for (auto& [n, one] : sizes) one = std::abs(one);
            const double size = std::abs(asked[j]) + accelerate_.along(sizes, u);
            if (std::abs(left[j]) > 64.0 * std::numeric_limits<double>::epsilon() * size) return true;
        }
        return false;
    }

    const Tree& tree_;
    Accelerate<double> accelerate_;
    std::vector<Sparse> responses_;
    std::vector<double> extents_;
};

}  // namespace closing

/// Which of some rows are used: as many as are independent where the tree is, by pivots of J M^-1 J^T. `first`: of that
/// many of them, which come first, as many as there can be. `rounding`: the part of a row that counts as none.
[[gnu::cold]] std::vector<int> independent_rows(const Tree& tree, const Conditions& conditions,
                                                const std::vector<int>& candidates,
                                                const std::vector<Moving<double>>& all, std::size_t first = 0,
                                                double rounding = 1e-11);

/// How rows that are not used depend on those that are: for each a combination of all rows, each over its measure, that
/// is zero, its own part 1. Rows that do nothing are none of them.
std::vector<std::vector<double>> dependences(const Tree& tree, const Conditions& conditions,
                                             const std::vector<int>& rows, const std::vector<Moving<double>>& all);
/// The same of other rows than those of constraints that are not used.
std::vector<std::vector<double>> dependences(const Tree& tree, const Conditions& conditions,
                                             const std::vector<int>& rows, const std::vector<int>& unused,
                                             const std::vector<Moving<double>>& all);

/// All variables moved onto the constraints, from where they are, in 32 digits. Returns the largest gap that is left
/// [m].
/// `most`: changes to try. `open`: of each row of constraints how far it stays open; nothing if empty (critical.hpp).
[[gnu::cold]] double close(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows, double t,
                           std::vector<DoubleDouble>& x, int most = 12, const std::vector<double>& open = {});

class LazyRows;   // recorded_rows.hpp
class RowValues;  // the same

/// The same after every step, and |q| = 1 of attitudes. What is held by friction has rows of velocities and one of its
/// gap that are not the same.
class TreeProjection : public Projection {
public:
    /// `rows`: of velocities; `closed`: of gaps. `size`: of the least of what touches [m], zero if nothing does.
    /// `recorded`: of these rows, where they are those of constraints; none: the tree is walked.
    TreeProjection(std::shared_ptr<const Tree> tree, std::shared_ptr<const Conditions> conditions,
                   std::vector<int> rows, std::vector<int> closed, double size = 0.0,
                   std::shared_ptr<const LazyRows> recorded = nullptr);
    TreeProjection(const TreeProjection&) = delete;
    TreeProjection& operator=(const TreeProjection&) = delete;
    ~TreeProjection() override;

    void apply(std::span<double> x, std::span<double> low, double step, double t) const override;

    /// Of what touches: the largest gap.
    Off off(std::span<const double> x, std::span<const double> low, double t) const override;
    int positions() const override { return size_ > 0.0 ? tree_->positions() : 0; }

    void refine(std::vector<DoubleDouble>& x, double t) const override;
    bool refine_beside(std::vector<DoubleDouble>& x, double t, const std::vector<DoubleDouble>& there,
                       double then) const override;

private:
    using Real = long double;

    /// Moves a state, where x is its doubles, by programs or by the tree; `before`: as it was.
    void hold(RowValues& rows, std::span<const double> x, std::vector<Real>& wide, double t) const;
    void hold(std::span<const double> x, std::vector<Real>& wide, const std::vector<Real>& before, double t) const;
    /// Newton's steps by what is asked of the rows, until that is rounding.
    template <class Asked, class Changes>
    void close_gaps(const Asked& asked, const Changes& changes, double rounding, std::vector<Real>& wide,
                    double t) const;
    void add_to_velocities(const std::vector<double>& changes, std::vector<Real>& wide) const;

    std::shared_ptr<const Tree> tree_;
    std::shared_ptr<const Conditions> conditions_;
    std::vector<int> rows_, closed_;
    std::vector<double> measures_;  // of the second
    std::shared_ptr<const LazyRows> recorded_;
    mutable std::unique_ptr<RowValues> values_;
    double size_, near_;  // the second: a gap that one step of Newton's method closes to all digits [m]

    /// Whether rows of velocities are those of gaps, and of constraints.
    bool is_of_constraints() const {
        return !rows_.empty() && rows_ == closed_ && rows_.back() < conditions_->constraint_rows();
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
