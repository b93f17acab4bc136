// Definitions of rbdyn/mechanics/tree_model.hpp: which rows of constraints are used, where others could be.
//
// As many rows as are independent hold the motion, and where some depend on others there is a choice of them. One that
// is good where a scene starts may lose rank elsewhere though all rows together do not: what depends on what turns and
// changes with the linkage. A guard tells where the rows that are used have lost most of their independence,
// det(J M^-1 J^T) over the product of its diagonal; there they are chosen anew, which is a change of the mode and no
// event, for the motion is the same. Where no choice is better all rows lose rank, and the motion passes as elsewhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/equations_writer.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace tree_rows {

/// In powers of ten: what others are at least better by, and how much rows lose between two looks at them.
inline constexpr double better = 1.0, loss = 1.0;
/// The powers of ten that are guarded.
inline constexpr int least = 100;

/// log10 of det(J M^-1 J^T) over the product of its diagonal.
inline double independence(const mechanics::Tree& tree, const mechanics::Conditions& conditions,
                           const std::vector<int>& rows, const std::vector<mechanics::Moving<double>>& all) {
    const auto matrix = mechanics::closing::Responses(tree, conditions, rows, all).matrix();
    std::vector<double> pivots;
    mechanics::solve_definite<double>(matrix, std::vector<double>(rows.size(), 0.0), &pivots);
    double sum = 0.0;
    for (std::size_t j = 0; j < pivots.size(); ++j) {
        if (!(pivots[j] > 0.0)) return -std::numeric_limits<double>::infinity();
        sum += std::log10(pivots[j] / matrix[j][j]);
    }
    return sum;
}

}  // namespace tree_rows

RBDYN_INLINE std::vector<int> TreeModel::used_rows(const Mode& mode) const {
    if (!has_choice_) return rows_;
    std::vector<int> rows;
    for (int r = 0; r < conditions_->constraint_rows(); ++r)
        if (mode.slip[place_of_rows() + at(r)] != 0) rows.push_back(r);
    return rows;
}

RBDYN_INLINE std::vector<int> TreeModel::rows_at(const std::vector<mechanics::Moving<double>>& all) const {
    std::vector<int> every(at(conditions_->constraint_rows()));
    for (std::size_t r = 0; r < every.size(); ++r) every[r] = static_cast<int>(r);
    return mechanics::independent_rows(*tree_, *conditions_, every, all);
}

RBDYN_INLINE void TreeModel::renew_rows(Mode& mode, double t, std::span<const double> x) const {
    const auto all = moving(t, x);
    const auto flags = mode.slip.begin() + static_cast<std::ptrdiff_t>(place_of_rows());
    signed char& level = flags[conditions_->constraint_rows()];
    double now = tree_rows::independence(*tree_, *conditions_, used_rows(mode), all);
    const std::vector<int> others = rows_at(all);
    bool is_renewed = false;
    if (others.size() == rows_.size())
        if (const double then = tree_rows::independence(*tree_, *conditions_, others, all);
            then > now + tree_rows::better) {
            std::fill(flags, flags + conditions_->constraint_rows(), 0);
            for (const int r : others) flags[r] = 1;
            now = then;
            is_renewed = true;
        }
    if (!is_renewed && level > 0 && now < 0.5 - level) {
        // all of them lose rank: they are looked at again where they have it back
        level = static_cast<signed char>(-level);
        return;
    }
    const double power = std::ceil(tree_rows::loss - now - 0.01);
    level = power <= tree_rows::least ? static_cast<signed char>(power) : 0;
}

RBDYN_INLINE std::vector<double> TreeModel::pivots_of(const Mode& mode, double t, std::span<const double> x) const {
    const std::vector<int> used = used_rows(mode);
    const mechanics::closing::Responses responses(*tree_, *conditions_, used, moving(t, x));
    std::vector<double> pivots;
    mechanics::solve_definite<double>(responses.matrix(), std::vector<double>(used.size(), 0.0), &pivots);
    return pivots;
}

RBDYN_INLINE std::vector<VariableGroup> TreeModel::groups_in(const mechanics::Tree& tree) const {
    std::vector<VariableGroup> groups = tree.groups();
    if (std::find(held_.begin(), held_.end(), true) == held_.end() || !(size_ > 0.0)) return groups;
    // what has no motion is as large as the rest, by that by which MotionScales lets others be smaller
    constexpr double smaller = 0x1p-20;
    const auto start = moving(0.0, TreeModel::start(0.0));
    for (VariableGroup& g : groups)
        for (const mechanics::Node& n : tree.nodes()) {
            const bool is_position = g.first < tree.positions();
            const int first = is_position ? n.q : tree.positions() + n.v, k = g.first - first,
                      count = is_position ? n.joint.positions() : n.joint.velocities();
            if (k < 0 || k >= count || n.joint.rail() != nullptr) continue;
            if (n.joint.attitude() >= 0) {
                if (is_position && k == n.joint.attitude()) g.alike = Alike::place, g.measure = size_;
                continue;
            }
            const auto& twist = start[at(static_cast<int>(&n - tree.nodes().data()))].joint[at(k)];
            const bool turns = !twist.turn.isZero(0.0);
            g.alike = is_position ? Alike::place : Alike::turning;
            g.measure = is_position ? (turns ? size_ : 1.0) : (turns ? 1.0 : 1.0 / size_);
            if (held_[at(n.v + k)]) g.measure *= smaller;
        }
    return groups;
}

RBDYN_INLINE void TreeModel::guard_rows(EquationsWriter& write, const mechanics::TreeWriter& tree,
                                        const Mode& mode) const {
    const int level = mode.slip[place_of_rows() + at(conditions_->constraint_rows())];
    if (level == 0) return;
    const Expression left = tree.independence();
    Guard guard{.kind = EventKind::singular};
    if (level > 0)
        write.guard(std::move(guard), left * std::pow(10.0, level) - 1.0);
    else
        write.guard(std::move(guard), 1.0 - left * std::pow(10.0, -level - 1));
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE Expression TreeWriter::independence() const {
    const recording::WideFolding all_digits;
    S part(1.0);
    for (std::size_t j = 0; j < pivots_.size(); ++j) part *= pivots_[j] / diagonal_[j];
    return part;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
