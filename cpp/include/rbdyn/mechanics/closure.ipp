// Definitions of rbdyn/mechanics/closure.hpp.
#pragma once

#include "rbdyn/mechanics/closure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/mechanics/critical.hpp"
#include "rbdyn/mechanics/recorded_rows.hpp"
#include "rbdyn/model/compensated.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace closing {

/// Changes to try where a state of doubles is moved onto constraints in 32 digits.
inline constexpr int passes = 6;

}  // namespace closing

RBDYN_INLINE std::vector<double> closing::ways(const Tree& tree, const std::vector<Moving<double>>& all,
                                               double length) {
    std::vector<double> result;
    for (int i = 0; i < tree.size(); ++i)
        for (int k = 0; k < tree.node(i).joint.velocities(); ++k) {
            const auto& twist = all[static_cast<std::size_t>(i)].joint[static_cast<std::size_t>(k)];
            const double size = std::hypot(twist.turn.norm(), length > 0.0 ? twist.move.norm() / length : 0.0);
            result.push_back(size > 0.0 ? 1.0 / size : 1.0);
        }
    return result;
}

RBDYN_INLINE double closing::least_arm(const Tree& tree, const Conditions& conditions) {
    double least = 0.0;
    const auto take = [&](double one) {
        if (one > 0.0 && !(least > 0.0 && least <= one)) least = one;
    };
    const auto take_end = [&](const Anchor& end) {
        if (end.body >= 0) take(safe_norm(rounded(end.point)));
    };
    for (const Node& n : tree.nodes()) take(safe_norm(rounded(n.center)));
    for (const Condition& c : conditions.all()) {
        take_end(c.a);
        take_end(c.b);
        take(c.length.hi);
    }
    for (const ContactLaw& c : conditions.contacts()) {
        take_end(c.a);
        take_end(c.b);
        take(c.radius.hi);
        take(c.surface_radius.hi);
    }
    return least;
}

RBDYN_INLINE std::vector<int> independent_rows(const Tree& tree, const Conditions& conditions,
                                               const std::vector<int>& candidates,
                                               const std::vector<Moving<double>>& all, std::size_t first,
                                               double rounding) {
    const closing::Responses responses(tree, conditions, candidates, all);
    auto a = responses.matrix();
    const std::size_t n = a.size();
    const std::vector<double> measures = closing::measures_of(conditions, candidates);
    std::vector<double> own(n);
    double nothing = 0.0;
    for (std::size_t i = 0; i < n; ++i) nothing = std::max(nothing, 1e-26 * a[i][i] / (measures[i] * measures[i]));
    // between bodies that cannot move against each other a row does nothing, but for the square of rounding
    for (std::size_t i = 0; i < n; ++i)
        own[i] = a[i][i] > std::max(nothing * measures[i] * measures[i], responses.nothing(i)) ? a[i][i] : 0.0;
    std::vector<int> chosen;
    std::vector<bool> is_used(n, false);
    // Cholesky's decomposition, the row next that keeps most of itself; what is left of dependent ones is rounding
    while (true) {
        std::size_t best = n;
        double most = rounding;
        for (std::size_t i = 0; i < n && (i < first || best == n || best >= first); ++i)
            if (!is_used[i] && own[i] > 0.0 && a[i][i] / own[i] > most) {
                // of equals the first
                most = a[i][i] / own[i] * (1.0 + 1e-6);
                best = i;
            }
        if (best == n) break;
        is_used[best] = true;
        chosen.push_back(candidates[best]);
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

RBDYN_INLINE std::vector<std::vector<double>> dependences(const Tree& tree, const Conditions& conditions,
                                                          const std::vector<int>& rows,
                                                          const std::vector<Moving<double>>& all) {
    std::vector<int> unused;
    for (int r = 0; r < conditions.constraint_rows(); ++r)
        if (!std::binary_search(rows.begin(), rows.end(), r)) unused.push_back(r);
    return dependences(tree, conditions, rows, unused, all);
}

RBDYN_INLINE std::vector<std::vector<double>> dependences(const Tree& tree, const Conditions& conditions,
                                                          const std::vector<int>& rows, const std::vector<int>& unused,
                                                          const std::vector<Moving<double>>& all) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<std::vector<double>> result;
    if (unused.empty()) return result;
    std::vector<int> every(at(conditions.rows()));
    for (int r = 0; r < conditions.rows(); ++r) every[at(r)] = r;
    const closing::Responses responses(tree, conditions, every, all);
    const auto a = responses.matrix();
    const std::vector<double> measures = conditions.measures();
    const auto square = [&](int r) { return measures[at(r)] * measures[at(r)]; };
    std::vector<std::vector<double>> used;
    double most = 0.0;
    for (const int r : rows) {
        used.emplace_back();
        for (const int other : rows) used.back().push_back(a[at(r)][at(other)]);
        most = std::max(most, a[at(r)][at(r)] / square(r));
    }
    for (const int r : unused) {
        if (a[at(r)][at(r)] <= std::max(1e-24 * most * square(r), responses.nothing(at(r)))) continue;
        std::vector<double> b;
        for (const int other : rows) b.push_back(a[at(other)][at(r)]);
        const std::vector<double> parts = solve_definite<double>(used, b);
        std::vector<double> combination(every.size(), 0.0);
        combination[at(r)] = 1.0;
        for (std::size_t k = 0; k < rows.size(); ++k)
            combination[at(rows[k])] = -parts[k] * (measures[at(rows[k])] / measures[at(r)]);
        result.push_back(std::move(combination));
    }
    return result;
}

RBDYN_INLINE double close(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows, double t,
                          std::vector<DoubleDouble>& x, int most, const std::vector<double>& open) {
    const auto doubles = [&] { return closing::moving<double>(tree, t, closing::nearest(x)); };
    const std::vector<double> measures = conditions.measures();
    double left = 0.0, before = std::numeric_limits<double>::infinity();
    tree.follow<DoubleDouble>(t, x.data());
    for (int pass = 0; pass < most; ++pass) {
        auto gaps = closing::of_constraints(
            conditions.gaps<DoubleDouble>(tree, closing::moving<DoubleDouble>(tree, t, x)), conditions);
        for (std::size_t r = 0; r < open.size(); ++r) gaps[r] -= open[r];
        left = closing::largest(closing::nearest(gaps), measures);
        if (left == 0.0 || (pass > 3 && left >= before)) break;
        before = left;
        const closing::Responses now(tree, conditions, rows, doubles());
        closing::move<DoubleDouble>(tree, t, now.changes(closing::chosen(gaps, rows)), x);
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

RBDYN_INLINE TreeProjection::TreeProjection(std::shared_ptr<const Tree> tree,
                                            std::shared_ptr<const Conditions> conditions, std::vector<int> rows,
                                            std::vector<int> closed, double size,
                                            std::shared_ptr<const LazyRows> recorded)
    : tree_(std::move(tree)),
      conditions_(std::move(conditions)),
      rows_(std::move(rows)),
      closed_(std::move(closed)),
      measures_(closing::measures_of(*conditions_, closed_)),
      recorded_(is_of_constraints() ? std::move(recorded) : nullptr),
      size_(size),
      near_(1e-9 * closing::least_arm(*tree_, *conditions_)) {}

RBDYN_INLINE TreeProjection::~TreeProjection() = default;

RBDYN_INLINE void TreeProjection::apply(std::span<double> x, std::span<double> low, double /*step*/, double t) const {
    std::vector<Real> wide(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) wide[i] = static_cast<Real>(x[i]) + static_cast<Real>(low[i]);
    const std::vector<Real> before = wide;
    closing::normalize<Real>(*tree_, wide);
    tree_->follow<Real>(t, wide.data());
    if (recorded_ != nullptr && values_ == nullptr)
        if (const RecordedRows* const rows = (*recorded_)(*tree_, *conditions_, rows_, t, x))
            values_ = std::make_unique<RowValues>(*rows, static_cast<int>(rows_.size()), tree_->velocities());
    if (values_ != nullptr)
        hold(*values_, x, wide, t);
    else if (!rows_.empty() || !closed_.empty())
        hold(x, wide, before, t);
    for (std::size_t i = 0; i < x.size(); ++i)
        if (wide[i] != before[i]) projecting::add(x, low, static_cast<int>(i), wide[i] - before[i]);
}

RBDYN_INLINE void TreeProjection::hold(RowValues& rows, std::span<const double> x, std::vector<Real>& wide,
                                       double t) const {
    rows.look(t, x);
    close_gaps([&] { return rows.against_gaps(t, wide); },
               [&](const std::vector<double>& asked) { return rows.changes(asked); }, 0.0, wide, t);
    add_to_velocities(rows.changes(rows.against_rates(t, wide)), wide);
}

template <class Asked, class Changes>
void TreeProjection::close_gaps(const Asked& asked, const Changes& changes, double rounding, std::vector<Real>& wide,
                                double t) const {
    double last = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < 3; ++pass) {
        const std::vector<double> now = asked();
        const double left = closing::largest(now, measures_);
        if (left <= rounding || left > 1e-3 * last) break;
        last = left;
        closing::move<Real>(*tree_, t, changes(now), wide);
        // once is enough after a step of full accuracy
        if (left < near_) break;
    }
}

RBDYN_INLINE void TreeProjection::add_to_velocities(const std::vector<double>& changes, std::vector<Real>& wide) const {
    for (int k = 0; k < tree_->velocities(); ++k)
        wide[static_cast<std::size_t>(tree_->positions() + k)] +=
            static_cast<Real>(changes[static_cast<std::size_t>(k)]);
}

RBDYN_INLINE void TreeProjection::hold(std::span<const double> x, std::vector<Real>& wide,
                                       const std::vector<Real>& before, double t) const {
    const auto at = closing::moving<double>(*tree_, t, {x.begin(), x.end()});
    const closing::Responses now(*tree_, *conditions_, rows_, at);
    const std::optional<closing::Responses> other =
        rows_ == closed_ ? std::nullopt : std::make_optional<closing::Responses>(*tree_, *conditions_, closed_, at);
    // of what touches the rounding of these digits is left: the state has more of them
    const bool is_smooth = !conditions_->contacts().empty() && !conditions_->is_rough();
    close_gaps(
        [&] {
            const auto gaps = conditions_->gaps<Real>(*tree_, closing::moving<Real>(*tree_, t, wide));
            return closing::chosen(gaps, closed_);
        },
        [&](const std::vector<double>& asked) { return (other ? *other : now).changes(asked); },
        is_smooth ? 16.0 * std::numeric_limits<Real>::epsilon() * closing::extent(at) : 0.0, wide, t);
    const auto moved = closing::moving<Real>(*tree_, t, wide);
    std::vector<Real> rates;
    for (const auto& row : conditions_->rows<Real>(*tree_, moved)) rates.push_back(Conditions::rate(row, moved));
    add_to_velocities(now.changes(closing::chosen(rates, rows_)), wide);
    // what friction in joints holds stays where it is, to the bit
    for (const int r : rows_)
        if (const int body = conditions_->joint_of(r); body >= 0) {
            const Node& n = tree_->node(body);
            for (const int i : {n.q, tree_->positions() + n.v})
                wide[static_cast<std::size_t>(i)] = before[static_cast<std::size_t>(i)];
        }
}

RBDYN_INLINE Projection::Off TreeProjection::off(std::span<const double> x, std::span<const double> low,
                                                 double t) const {
    if (!(size_ > 0.0)) return {};
    std::vector<Real> wide(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) wide[i] = static_cast<Real>(x[i]) + static_cast<Real>(low[i]);
    closing::normalize<Real>(*tree_, wide);
    tree_->follow<Real>(t, wide.data());
    const auto all = closing::moving<Real>(*tree_, t, wide);
    const double gap = closing::largest(closing::chosen(conditions_->gaps<Real>(*tree_, all), closed_), measures_);
    const double extent = closing::extent(closing::moving<double>(*tree_, t, {x.begin(), x.end()}));
    return {gap / (0x1p-43 * size_ + 8.0 * std::numeric_limits<double>::epsilon() * extent), gap / size_};
}

RBDYN_INLINE void TreeProjection::refine(std::vector<DoubleDouble>& x, double t) const {
    closing::normalize<DoubleDouble>(*tree_, x);
    // of contacts the rows of velocities are not those of gaps
    if (is_of_constraints()) close(*tree_, *conditions_, rows_, t, x, closing::passes);
}

RBDYN_INLINE bool TreeProjection::refine_beside(std::vector<DoubleDouble>& x, double t,
                                                const std::vector<DoubleDouble>& there, double then) const {
    if (!is_of_constraints()) return false;
    const auto near = critical_near(*tree_, *conditions_, rows_.size(), then, there);
    if (!near || near->most == 0.0 || near->most > critical::rounding) return false;
    close(*tree_, *conditions_, rows_, t, x, closing::passes, near->open);
    return true;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
