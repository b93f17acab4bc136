// Definitions of rbdyn/mechanics/tree_model.hpp: loops.
//
// Rows that are used hold; the others must hold with them, for good (redundant.hpp). What a run cannot know beforehand
// ends it by name: a constraint that opens, for driven joints ask for what it does not allow. Where used rows lose
// their independence for a moment the motion goes on, on its branch, and the event `singular` tells of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/critical.hpp"
#include "rbdyn/mechanics/driven.hpp"
#include "rbdyn/mechanics/loosening.hpp"
#include "rbdyn/mechanics/redundant.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/leading_sign.hpp"
#include "rbdyn/model/rail_singular.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace tree_loops {

/// Of the scene's size: how far a start may be off, and how far constraints may open whose rows are not all used.
inline constexpr double nearest_start = 1e-6, loosest = 1e-9;
/// Of the square of all a row could be: what counts as none of it where a scene starts.
inline constexpr double nothing = 1e-14;

}  // namespace tree_loops

RBDYN_INLINE double TreeModel::size_of(const std::vector<mechanics::Moving<double>>& all) const {
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    const auto take = [&](const Vector3& p) {
        low = lesser(low, p);
        high = greater(high, p);
    };
    for (int i = 0; i < bodies(); ++i) {
        const mechanics::Moving<double>& m = all[at(i)];
        take(m.place);
        take(m.place + m.to_world(exactly<double>(tree_->node(i).center)));
    }
    for (const mechanics::Condition& c : conditions_->all())
        for (const mechanics::Anchor* a : {&c.a, &c.b}) take(tree_->point<double>(*a, all).place);
    for (std::size_t k = 0; k < tree_->feet().size(); ++k) {
        const mechanics::Moving<double>& foot = all[at(tree_->size()) + k];
        for (const double side : {-1.0, 1.0})
            take(foot.place + foot.joint.front().move * (side * tree_->feet()[k].part()));
    }
    const double size = (high - low).norm();
    return size > 0.0 ? size : conditions_->arm();
}

RBDYN_INLINE std::vector<DoubleDouble> TreeModel::exact_start(double t) const {
    if (t == origin() && !start_.empty()) return start_;
    std::vector<DoubleDouble> x = tree_->start(t);
    return conditions_->all().empty() ? x : onto_constraints(t, std::move(x), "the start");
}

RBDYN_INLINE std::vector<DoubleDouble> TreeModel::onto_constraints(double t, std::vector<DoubleDouble> x,
                                                                   const std::string& what) const {
    const auto all = mechanics::closing::moving<double>(*tree_, t, mechanics::closing::nearest(x));
    const double size = size_of(all);
    const std::vector<double> gaps = mechanics::open_by(*tree_, *conditions_, all);
    const bool starts = what == "the start";
    for (std::size_t k = 0; k < gaps.size(); ++k)
        require(gaps[k] <= tree_loops::nearest_start * size, conditions_->all()[k].name, "gap", gaps[k],
                what + " satisfies a constraint to 1e-6 of the scene's size, " + text(size) +
                    (starts ? " m; scene.assemble() finds a start that does from a rough one"
                            : " m; change the other bodies of the loop, too"));
    const std::vector<DoubleDouble> given = x;
    mechanics::close(*tree_, *conditions_, has_choice_ ? rows_at(all) : rows_, t, x);
    // the velocities that were given, where it now is
    std::vector<double> before = mechanics::closing::nearest(x);
    for (int k = tree_->positions(); k < variables(); ++k) before[at(k)] = static_cast<double>(given[at(k)]);
    const auto moving = mechanics::closing::moving<double>(*tree_, t, before);
    const double speed = mechanics::fastest(moving, size);
    const std::vector<double> rates = mechanics::opening_rates(*tree_, *conditions_, moving);
    for (std::size_t k = 0; k < rates.size(); ++k)
        require(rates[k] <= tree_loops::nearest_start * speed, conditions_->all()[k].name, "rate of its gap", rates[k],
                (starts ? "the velocities that a scene starts with" : "the velocities after " + what) +
                    " satisfy a constraint to 1e-6 of the fastest, " + text(speed) +
                    " m/s, those of driven joints with them; " +
                    (starts ? "scene.assemble() finds some that do from rough ones"
                            : "change those of the other bodies of the loop, too"));
    return x;
}

RBDYN_INLINE void TreeModel::choose_rows() {
    std::vector<int> every(at(conditions_->constraint_rows()));
    for (std::size_t r = 0; r < every.size(); ++r) every[r] = static_cast<int>(r);
    const auto choose_at = [&](const std::vector<DoubleDouble>& x) {
        const auto all = mechanics::closing::moving<double>(*tree_, origin(), mechanics::closing::nearest(x));
        rows_ = mechanics::independent_rows(*tree_, *conditions_, every, all);
        // nor what is all but none by itself: a bar that is flat along an axis within 1e-7 rad
        const mechanics::closing::Responses responses(*tree_, *conditions_, rows_, all);
        const auto matrix = responses.matrix();
        std::vector<int> kept;
        for (std::size_t j = 0; j < rows_.size(); ++j)
            if (matrix[j][j] > tree_loops::nothing * responses.extent(j)) kept.push_back(rows_[j]);
        rows_ = std::move(kept);
    };
    choose_at(tree_->start(origin()));
    choose_at(exact_start(origin()));
    if (conditions_->all().empty()) return;
    const std::vector<DoubleDouble> x = exact_start(origin());
    const auto all = mechanics::closing::moving<double>(*tree_, origin(), mechanics::closing::nearest(x));
    const double size = size_of(all);
    double widest = 0.0;
    for (const double gap : mechanics::open_by(*tree_, *conditions_, all)) widest = std::max(widest, gap);
    loosest_ = std::max(tree_loops::loosest * size, 4.0 * widest);
    if (rows_.size() < every.size()) {
        auto told = mechanics::steadiest(*tree_, *conditions_, rows_, origin(), x, size, loosest_);
        if (told.all() != conditions_->all()) {
            conditions_ = std::make_shared<const mechanics::Conditions>(std::move(told));
            choose_at(x);
        }
    }
    if (rows_.size() < every.size())
        if (const auto o = mechanics::opening(*tree_, *conditions_, rows_, origin(), x, size, loosest_))
            throw InvalidInput(
                conditions_->all()[at(o->constraint)].name +
                ": where the scene starts the constraints lose rank, and what is left of them opens it by " +
                text(o->gap) + " m where the bodies move by " + text(o->moved) +
                " m; start beside such a place (bars in one line, a rod across a rail), or hold what "
                "cannot move with a Weld or a Fixed joint");
    const mechanics::closing::Responses responses(*tree_, *conditions_, rows_, all);
    const auto matrix = responses.matrix();
    mechanics::solve_definite<double>(matrix, std::vector<double>(rows_.size(), 0.0), &first_pivots_);
    // of a pivot: what of it is left has fewer than ten digits
    constexpr double uneven = 0x1p-20;
    for (std::size_t j = 0; j < rows_.size(); ++j)
        is_uneven_ = is_uneven_ || !(first_pivots_[j] > uneven * matrix[j][j]);
    held_ = mechanics::held_still(*tree_, *conditions_, rows_, origin(), x, size, loosest_);
    // what drives move later may stand now
    std::vector<int> still;
    for (int i = 0; i < bodies() && !is_driven(); ++i)
        if (const std::size_t turns = at(tree_->velocities() + i); held_[turns] && held_[turns + at(bodies())])
            still.push_back(i);
    if (!still.empty()) {
        auto exerted = std::make_shared<mechanics::Exerted>(*exerted_);
        for (const int i : still) exerted->keep_still(i);
        exerted_ = std::move(exerted);
    }
    size_ = size;
    units_ = mechanics::closing::Responses(*tree_, *conditions_, every, all).extents();
    has_choice_ =
        contacts() == 0 && joints_.empty() && !mechanics::dependences(*tree_, *conditions_, rows_, all).empty();
    start_ = exact_start(origin());
}

RBDYN_INLINE void TreeModel::require_no_end(const Mode& mode, double t, std::span<const double> x) const {
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    for (const Guard& guard : mode.equations->guards) {
        if (guard.kind != EventKind::rail_end) continue;
        const bool is_there = std::abs(values.output(guard.output)) <= 8.0 * epsilon * values.magnitude(guard.output);
        if (is_there && leading_sign(mode, t, x, guard.output) < 0)
            throw InvalidInput((guard.name.empty() ? name(guard.subject) : guard.name) +
                               ": it starts at an end of its curve, which it leaves at once; start it within the curve "
                               "or moving inward");
    }
}

RBDYN_INLINE void TreeModel::guard_loops(EquationsWriter& write, const mechanics::TreeWriter& tree, const Mode& mode,
                                         const RecordedFor& state) const {
    if (!first_pivots_.empty())
        tree.guard_pivots(write, used_rows(mode) == rows_ ? first_pivots_ : pivots_of(mode, state.t, state.x));
    if (has_choice_) guard_rows(write, tree, mode);
    const std::vector<int> loose = tree.loose();
    if (loose.empty()) return;
    const bool drives = std::any_of(tree_->nodes().begin(), tree_->nodes().end(), [](const mechanics::Node& n) {
        return mechanics::driven(n) != nullptr || mechanics::moved(n) != nullptr;
    });
    // where nothing but drives moves a piece may be as long as the motion
    const int samples = !drives ? 1 : variables() > 0 ? 16 : 1024;
    Guard guard{.kind = EventKind::singular, .name = "gaps of constraints"};
    guard.locator =
        std::make_shared<const mechanics::Loosening>(tree_, conditions_, used_rows(mode), loose, loosest_, samples);
    write.outside(std::move(guard), drives);
}

RBDYN_INLINE std::optional<Acting> TreeModel::acting_near_singular(const Mode& mode, double t,
                                                                   std::span<const double> x) const {
    if (first_pivots_.empty() || mode.equations == nullptr) return std::nullopt;
    const std::vector<int> rows = used_rows(mode);
    if (kept_rows(mode) != rows) return std::nullopt;
    // of a pivot, and of what it is left of: doubles have 13 digits of a force there, and 10
    constexpr double small = 1e-2, least = 1e-6;
    // of rows that are chosen on the way, of which no pivot is the first: of all that they could be
    constexpr double small_of_all = 1e-4;
    std::vector<double> pivots;
    const mechanics::closing::Responses responses(*tree_, *conditions_, rows, moving(t, x));
    const auto matrix = responses.matrix();
    mechanics::solve_definite<double>(matrix, std::vector<double>(rows.size(), 0.0), &pivots);
    bool is_near = false;
    for (std::size_t j = 0; j < pivots.size(); ++j) {
        const double whole = rows == rows_ ? small * first_pivots_[j] : small_of_all * units_[at(rows[j])];
        is_near = is_near || !(pivots[j] > std::max(whole, least * matrix[j][j]));
    }
    if (!is_near) return std::nullopt;
    std::vector<DoubleDouble> there(x.begin(), x.end());
    mechanics::closing::normalize<DoubleDouble>(*tree_, there);
    // the branch goes on through the place, whatever rounding of their numbers makes of it
    std::vector<double> stays;
    if (const auto place = mechanics::critical_near(*tree_, *conditions_, rows.size(), t, there);
        place && place->most <= mechanics::critical::rounding)
        stays = place->open;
    mechanics::close(*tree_, *conditions_, rows, t, there, 12, stays);
    // at the place itself nothing says which branch it is
    const auto closed = mechanics::closing::moving<DoubleDouble>(*tree_, t, there);
    auto gaps = conditions_->gaps<DoubleDouble>(*tree_, closed);
    for (std::size_t r = 0; r < stays.size(); ++r) gaps[r] -= stays[r];
    const double open = mechanics::closing::largest(mechanics::closing::chosen(gaps, rows),
                                                    mechanics::closing::measures_of(*conditions_, rows));
    if (!(open <= 1e-24 * size_of(moving(t, x)))) return std::nullopt;
    return acting_widely(mode, t, there);
}

RBDYN_INLINE double TreeModel::independence(const Mode& mode, double t, std::span<const double> x) const {
    double least = 1.0;
    const std::vector<int> used = used_rows(mode);
    if (first_pivots_.empty() || mode.equations == nullptr || rows_in(mode) != used) return least;
    std::vector<double> pivots;
    const mechanics::closing::Responses responses(*tree_, *conditions_, used, moving(t, x));
    mechanics::solve_definite<double>(responses.matrix(), std::vector<double>(used.size(), 0.0), &pivots);
    for (std::size_t j = 0; j < pivots.size(); ++j) least = std::min(least, pivots[j] / responses.extent(j));
    return least > 0.0 ? std::sqrt(least) : 0.0;
}

RBDYN_INLINE std::string TreeModel::opened(double t, std::span<const double> x) const {
    const auto all = moving(t, x);
    int widest = 0;
    const std::vector<double> gaps = mechanics::open_by(*tree_, *conditions_, all);
    for (std::size_t k = 0; k < gaps.size(); ++k)
        if (!(gaps[k] <= gaps[at(widest)])) widest = static_cast<int>(k);
    const double rate = mechanics::opening_rates(*tree_, *conditions_, all)[at(widest)];
    return conditions_->all()[at(widest)].name + " opens, its gap is " + text(gaps[at(widest)]) + " m and grows by " +
           text(rate) +
           " m/s: no motion satisfies it together with the other constraints and with driven joints, or an engine that "
           "leaves gaps as they grow has opened it (engine=\"taylor\" closes them after each step)";
}

RBDYN_INLINE std::string TreeModel::locked(double t, std::span<const double> x) const {
    if (rows_.empty()) return {};
    const auto all = moving(t, x);
    constexpr double small = 1e-5;  // of the square of a row
    const std::vector<int> clear = mechanics::independent_rows(*tree_, *conditions_, rows_, all, 0, small);
    std::string names;
    if (clear.size() == rows_.size()) {
        // a row that is none any more by itself: a rod across the one slide it drives
        std::vector<double> pivots;
        const mechanics::closing::Responses responses(*tree_, *conditions_, rows_, all);
        mechanics::solve_definite<double>(responses.matrix(), std::vector<double>(rows_.size(), 0.0), &pivots);
        for (const mechanics::Condition& c : conditions_->all())
            for (std::size_t j = 0; j < std::min(pivots.size(), first_pivots_.size()); ++j)
                if (rows_[j] >= c.first && rows_[j] < c.first + c.rows() && pivots[j] < small * first_pivots_[j]) {
                    names += (names.empty() ? "" : ", ") + c.name;
                    break;
                }
        return names;
    }
    const auto loose = mechanics::dependences(*tree_, *conditions_, clear, all);
    for (const mechanics::Condition& c : conditions_->all()) {
        const auto is_in = [&](const std::vector<double>& one) {
            // of those that are used now and were not redundant before
            const bool is_new = std::any_of(rows_.begin(), rows_.end(), [&](int r) {
                return !std::binary_search(clear.begin(), clear.end(), r) && one[at(r)] == 1.0;
            });
            return is_new && std::any_of(one.begin() + c.first, one.begin() + c.first + c.rows(),
                                         [](double part) { return std::abs(part) > 1e-3; });
        };
        if (std::any_of(loose.begin(), loose.end(), is_in)) names += (names.empty() ? "" : ", ") + c.name;
    }
    return names.empty() ? conditions_->all().front().name : names;
}

RBDYN_INLINE std::string TreeModel::not_finite(const Mode& mode, double t, std::span<const double> x) const {
    for (const double value : x)
        if (!std::isfinite(value)) return "the state itself";
    for (const mechanics::Node& n : tree_->nodes())
        if (const mechanics::DrivenLaw* law = mechanics::driven(n))
            for (const double value : {law->way(t), law->rate(t), law->rate.rate(t)})
                if (!std::isfinite(value))
                    return "the motion of the joint of " + n.name + ", or a rate of it, which is " + text(value);
    for (const mechanics::Node& n : tree_->nodes())
        if (const mechanics::RailLaw* rail = mechanics::moved(n))
            if (const auto value = mechanics::not_finite(*rail, t))
                return "the motion of the rail of " + n.name + ", or a rate of it, which is " + text(*value);
    for (const mechanics::RoughJoint& joint : joints_)
        if (!std::isfinite(joint.drive(t))) return "the drive of the rail of " + joint.name;
    for (const mechanics::Node& n : tree_->nodes())
        if (const mechanics::RailLaw* rail = n.joint.rail();
            rail != nullptr && !is_flying(mode, static_cast<int>(&n - tree_->nodes().data())))
            if (const std::string what = singular_at(*rail->curve, x[at(n.q)]); !what.empty())
                return "the rail of " + n.name + " at u = " + text(x[at(n.q)]) + ", where " + what;
    for (const mechanics::Foot& f : tree_->feet())
        if (const std::string what = singular_at(f.curve, x[at(f.q)]); !what.empty())
            return "the curve of " + f.name + " at u = " + text(x[at(f.q)]) + ", where " + what;
    if (mode.equations != nullptr) {
        const mechanics::TreeState state = look(mode, t, x);
        for (std::size_t k = 0; k < state.couplings.size(); ++k)
            if (!is_finite(state.couplings[k])) return "the force of coupling " + std::to_string(k + 1);
        for (const Scene::AppliedLoad& l : scene_.loads()) {
            const mechanics::Node& n = tree_->node(l.body);
            const JointLoad* load = std::get_if<JointTorque>(&l.load);
            if (load == nullptr) load = std::get_if<JointForce>(&l.load);
            if (load != nullptr && n.joint.velocities() > 0) {
                const double value = state.along[at(n.v)];
                if (!std::isfinite(value))
                    return "the joint load \"" + load->name() + "\" on " + n.name + ", which is " + text(value);
            }
        }
        for (int i = 0; i < bodies(); ++i)
            if (!is_finite(state.bodies[at(i)].acts.force) || !is_finite(state.bodies[at(i)].acts.moment))
                return "a force or torque on " + tree_->node(i).name;
    }
    const auto all = moving(t, x);
    for (const mechanics::Exerted::Coupled& c : exerted_->couplings()) {
        if (!is_present(c.coupling)) continue;
        const auto a = tree_->point<double>(c.a, all), b = tree_->point<double>(c.b, all);
        const std::string why = without_direction(c.coupling, {t, a.place, b.place, a.velocity, b.velocity, 0.0});
        const auto name = [&](int body) { return body >= 0 ? tree_->node(body).name : "a point of the world"; };
        if (!why.empty())
            return "the " + std::string(rbdyn::kind_of(c.coupling)) + " of " + name(c.a.body) + " and " +
                   name(c.b.body) + ", " + why;
    }
    if (const std::string names = locked(t, x); !names.empty())
        return "constraints lose rank there and lock what moves: " + names;
    return {};
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE void TreeWriter::guard_pivots(EquationsWriter& write, const std::vector<double>& first) const {
    const recording::WideFolding all_digits;
    // far below what digits are lost at, far above their rounding: squares of what passes zero
    constexpr double small = 1e-10;
    for (std::size_t j = 0; j < std::min(first.size(), pivots_.size()); ++j) {
        if (pivots_[j].is_constant()) continue;
        const auto owner = std::find_if(conditions_.all().begin(), conditions_.all().end(), [&](const Condition& c) {
            return rows_[j] >= c.first && rows_[j] < c.first + c.rows();
        });
        if (owner == conditions_.all().end()) continue;
        Guard guard{.kind = EventKind::singular, .role = GuardRole::record, .name = owner->name};
        guard.least = -1.0;
        write.guard(std::move(guard), pivots_[j] * (1.0 / (small * first[j])) - 1.0);
    }
}

RBDYN_INLINE std::vector<int> TreeWriter::loose() const {
    std::vector<int> result;
    const auto gaps = conditions_.gaps<S>(tree_, moving_);
    for (std::size_t k = 0; k < conditions_.all().size(); ++k) {
        const Condition& c = conditions_.all()[k];
        for (int r = c.first; r < c.first + c.rows(); ++r) {
            if (std::find(rows_.begin(), rows_.end(), r) != rows_.end()) continue;
            if (recording::is_constant(r_, gaps[at(r)])) continue;
            result.push_back(static_cast<int>(k));
            break;
        }
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
