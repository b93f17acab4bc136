// Definitions of rbdyn/mechanics/tree_model.hpp: which rows of constraints are used, where others could be.
//
// As many rows as are independent hold the motion, and where some depend on others there is a choice of them. One that
// is good where a scene starts may lose rank elsewhere though all rows together do not: what depends on what turns and
// changes with the linkage. A guard tells where the rows that are used have lost most of their independence,
// det(J M^-1 J^T) over the product of what its diagonal could be where the scene starts; there they are chosen anew,
// which is a change of the mode and no event, for the motion is the same. Where no choice is better, a few powers of
// ten on, all rows lose rank, and the motion passes as elsewhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/critical.hpp"
#include "rbdyn/mechanics/redundant.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/equations_writer.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace tree_rows {

/// In powers of ten: what others are at least better by, and how much rows lose between two looks at them.
inline constexpr double better = 0.3, much_better = 1.0, loss = 1.0;
/// Looks in vain, after which all rows lose rank; and the powers of ten that are guarded.
inline constexpr signed char most_looks = 3;
inline constexpr int least = 30;
/// Of the numbers that a place is made of: by how much two branches miss each other that are no longer one.
inline constexpr double misses = 1e-10;

/// What touches rolls: how far its centre goes is measured by how far it turns, too, over its radius of gyration. And
/// what moves in a plane is as what moves freely.
inline void measure_by_turns(const mechanics::Tree& tree, std::vector<VariableGroup>& groups) {
    for (const mechanics::Node& n : tree.nodes()) {
        const bool is_planar = n.joint.as<mechanics::PlanarLaw>() != nullptr;
        if (n.joint.as<mechanics::FreeBodyLaw>() == nullptr && !is_planar) continue;
        const int turns = is_planar ? mechanics::PlanarLaw::angle : n.joint.attitude();
        const auto& inertia = n.body.inertia;
        const double gyration =
            std::sqrt(static_cast<double>((inertia(0, 0) + inertia(1, 1) + inertia(2, 2)) / n.mass));
        for (VariableGroup& g : groups) {
            const bool is_position = g.first < tree.positions();
            const int k = g.first - (is_position ? n.q : tree.positions() + n.v);
            if (k != turns && !(is_planar && k >= 0 && k < turns)) continue;
            if (k == turns && !(gyration > 0.0)) continue;
            g.alike = is_position ? Alike::place : Alike::velocity;
            if (k == turns) g.measure = gyration;
        }
    }
}

}  // namespace tree_rows

RBDYN_INLINE double TreeModel::independence_of(const std::vector<int>& rows,
                                               const std::vector<mechanics::Moving<double>>& all) const {
    const auto matrix = mechanics::closing::Responses(*tree_, *conditions_, rows, all).matrix();
    std::vector<double> pivots;
    mechanics::solve_definite<double>(matrix, std::vector<double>(rows.size(), 0.0), &pivots);
    double sum = 0.0;
    for (std::size_t j = 0; j < pivots.size(); ++j) {
        if (!(pivots[j] > 0.0)) return -std::numeric_limits<double>::infinity();
        sum += std::log10(pivots[j] / units_[at(rows[j])]);
    }
    return sum;
}

RBDYN_INLINE std::vector<int> TreeModel::used_rows(const Mode& mode) const {
    if (!has_choice_) return rows_;
    std::vector<int> rows;
    for (int r = 0; r < conditions_->constraint_rows(); ++r)
        if (mode.slip[place_of_rows() + at(r)] != 0) rows.push_back(r);
    return rows;
}

RBDYN_INLINE std::vector<int> TreeModel::rows_at(const std::vector<mechanics::Moving<double>>& all) const {
    std::vector<int> every(at(conditions_->constraint_rows())), chosen;
    for (std::size_t r = 0; r < every.size(); ++r) every[r] = static_cast<int>(r);
    auto a = mechanics::closing::Responses(*tree_, *conditions_, every, all).matrix();
    constexpr double rounding = 1e-11;
    std::vector<bool> is_used(every.size(), false);
    while (chosen.size() < rows_.size()) {
        std::size_t best = every.size();
        double most = rounding;
        for (std::size_t r = 0; r < every.size(); ++r)
            if (!is_used[r] && units_[r] > 0.0 && a[r][r] / units_[r] > most) {
                // of equals the first
                most = a[r][r] / units_[r] * (1.0 + 1e-6);
                best = r;
            }
        if (best == every.size()) return rows_;
        is_used[best] = true;
        chosen.push_back(static_cast<int>(best));
        for (std::size_t i = 0; i < every.size(); ++i) {
            if (is_used[i]) continue;
            const double factor = a[i][best] / a[best][best];
            for (std::size_t j = 0; j < every.size(); ++j)
                if (!is_used[j]) a[i][j] -= factor * a[best][j];
        }
    }
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

RBDYN_INLINE void TreeModel::renew_rows(Mode& mode, double t, std::span<const double> x) const {
    const auto all = moving(t, x);
    const auto flags = mode.slip.begin() + static_cast<std::ptrdiff_t>(place_of_rows());
    signed char &level = flags[conditions_->constraint_rows()], &looks = flags[conditions_->constraint_rows() + 1];
    double now = independence_of(used_rows(mode), all);
    const std::vector<int> others = rows_at(all);
    const double then = independence_of(others, all);
    // those of the start are kept where they begin, unless they are poor
    const double better = level == 0 ? tree_rows::much_better : tree_rows::better;
    const bool is_better = then > now + better, has_lost = level > 0 && now < 0.5 - level;
    if (is_better) {
        std::fill(flags, flags + conditions_->constraint_rows(), static_cast<signed char>(0));
        for (const int r : others) flags[r] = 1;
        now = then;
    }
    // where all have lost rank and have it back, as a linkage that goes round has each turn, one look in vain is enough
    // for the next time: deeper ones would come as near to that place as a change of the mode must not
    looks = is_better ? 0 : level < 0 ? tree_rows::most_looks : has_lost ? looks + 1 : 0;
    // a linkage that comes near to such a place keeps its rank, which other rows then have though those that are used
    // lose it
    const auto lose_rank = [&] {
        const auto place = mechanics::critical_near(*tree_, *conditions_, rows_.size(), t, {x.begin(), x.end()});
        return place && place->most <= tree_rows::misses;
    };
    if (looks > tree_rows::most_looks && lose_rank()) {
        // all of them lose rank: they are looked at again where they have it back
        level = static_cast<signed char>(-level);
        looks = 0;
        return;
    }
    const double power = std::max(1.0, std::ceil(tree_rows::loss - now - 0.01));
    level = power <= tree_rows::least ? static_cast<signed char>(power) : static_cast<signed char>(0);
}

RBDYN_INLINE void TreeModel::close_rows(const Mode& mode, double t, std::span<double> x) const {
    constexpr double closed = 1e-12;  // of the size of the scene
    const auto all = moving(t, x);
    const double open = mechanics::closing::largest(mechanics::open_by(*tree_, *conditions_, all)),
                 rate = mechanics::closing::largest(mechanics::opening_rates(*tree_, *conditions_, all));
    if (open <= closed * size_ && rate <= closed * mechanics::fastest(all, size_)) return;
    std::vector<DoubleDouble> wide(x.begin(), x.end());
    mechanics::closing::normalize<DoubleDouble>(*tree_, wide);
    // from afar there may be none that is near: the gap is told as it is
    const double left = mechanics::close(*tree_, *conditions_, used_rows(mode), t, wide);
    if (!(left <= std::max(open, closed * size_))) return;
    const std::vector<double> on = mechanics::closing::nearest(wide);
    std::copy(on.begin(), on.end(), x.begin());
}

RBDYN_INLINE std::vector<double> TreeModel::pivots_of(const Mode& mode, double t, std::span<const double> x) const {
    const std::vector<int> used = used_rows(mode);
    const mechanics::closing::Responses responses(*tree_, *conditions_, used, moving(t, x));
    std::vector<double> pivots;
    mechanics::solve_definite<double>(responses.matrix(), std::vector<double>(used.size(), 0.0), &pivots);
    return pivots;
}

RBDYN_INLINE std::vector<VariableGroup> TreeModel::groups_in(const mechanics::Tree& tree, bool is_constrained) const {
    std::vector<VariableGroup> groups = tree.groups(is_constrained);
    if (contacts() > 0) tree_rows::measure_by_turns(tree, groups);
    const auto none = std::find(held_.begin(), held_.end(), true) - held_.begin();
    if (none >= tree.velocities() || !(size_ > 0.0)) return groups;
    // what has no motion is as large as the rest, by that by which MotionScales lets others be smaller
    constexpr double smaller = 0x1p-20;
    const auto start = moving(origin(), TreeModel::start(origin()));
    for (VariableGroup& g : groups)
        for (const mechanics::Node& n : tree.nodes()) {
            const bool is_position = g.first < tree.positions();
            const int first = is_position ? n.q : tree.positions() + n.v, k = g.first - first,
                      count = is_position ? n.joint.positions() : n.joint.velocities();
            if (k < 0 || k >= count || n.joint.rail() != nullptr) continue;
            // an attitude has four numbers
            const auto one = held_.begin() + n.v + k;
            const bool is_held = std::all_of(one, one + std::min(g.count, 3), [](bool is) { return is; });
            if (const int turn = n.joint.attitude(); turn >= 0) {
                if (k != turn && (k != 0 || g.count != 3)) continue;
                g.alike = is_position ? Alike::place : Alike::turning;
                g.measure = is_position ? (k == turn ? size_ : 1.0) : (k == turn ? 1.0 : 1.0 / size_);
                if (is_held && (k != turn || !is_position)) g.measure *= smaller;
                continue;
            }
            const auto& twist = start[at(static_cast<int>(&n - tree.nodes().data()))].joint[at(k)];
            const bool turns = !twist.turn.isZero(0.0);
            g.alike = is_position ? Alike::place : Alike::turning;
            g.measure = is_position ? (turns ? size_ : 1.0) : (turns ? 1.0 : 1.0 / size_);
            if (is_held) g.measure *= smaller;
        }
    return groups;
}

RBDYN_INLINE void TreeModel::guard_rows(EquationsWriter& write, const mechanics::TreeWriter& tree,
                                        const Mode& mode) const {
    const int level = mode.slip[place_of_rows() + at(conditions_->constraint_rows())];
    if (level == 0) return;
    const Expression left = tree.independence(units_);
    Guard guard{.kind = EventKind::singular};
    if (level > 0)
        write.guard(std::move(guard), left * std::pow(10.0, level) - 1.0);
    else
        write.guard(std::move(guard), 1.0 - left * std::pow(10.0, -level - 1));
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE Expression TreeWriter::independence(const std::vector<double>& units) const {
    const recording::WideFolding all_digits;
    S part(1.0);
    for (std::size_t j = 0; j < pivots_.size(); ++j) part *= pivots_[j] * (1.0 / units[at(rows_[j])]);
    return part;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
