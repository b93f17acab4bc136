// Definitions of rbdyn/statics/tree_forces.hpp: forces, and what follows from them.
#pragma once

#include "rbdyn/statics/tree_forces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/mechanics/assemble.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/joint/spherical.hpp"
#include "rbdyn/mechanics/redundant.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/statics/natural_length.hpp"
#include "rbdyn/statics/path_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE TreeForces::TreeForces(const Scene& scene) : acting_(scene) {
    for (const Scene::Body& b : scene.bodies())
        if (!scene.constraints().empty() && b.rail() != nullptr && b.rail()->may_release())
            throw InvalidInput(b.name +
                               ": a rail that it may leave, beside constraints, of which states of rest are not found "
                               "in this version; use side \"both\" and ends \"stop\"");
    if (acting_.size() > 0.0) extent_ = acting_.size();
    const Wide given = tree().start(0.0);
    conditions_ = mechanics::Conditions(scene, tree(), moving(given));
    carries_.assign(at(bodies()), false);
    for (const mechanics::Node& n : tree().nodes())
        if (n.parent >= 0) carries_[at(n.parent)] = true;
    std::vector<int> every(at(conditions_.constraint_rows()));
    for (std::size_t r = 0; r < every.size(); ++r) every[r] = static_cast<int>(r);
    const auto doubles = mechanics::closing::moving<double>(tree(), 0.0, mechanics::closing::nearest(given));
    rows_ = mechanics::independent_rows(tree(), conditions_, every, doubles);
    const Wide x = closed(Wide(given.begin(), given.begin() + tree().positions()));
    if (x.empty())
        throw InvalidInput(
            "equilibria: the constraints of this scene cannot be closed from where it starts; scene.assemble() finds a "
            "start that satisfies them");
    if (rows_.size() < every.size()) {
        constexpr double tolerance = 1e-9;  // of gaps, in sizes of the scene
        conditions_ = mechanics::steadiest(tree(), conditions_, rows_, 0.0, x, extent_, tolerance * extent_);
        rows_ = mechanics::independent_rows(
            tree(), conditions_, every,
            mechanics::closing::moving<double>(tree(), 0.0, mechanics::closing::nearest(x)));
    }
    start_ = mechanics::closing::nearest(x);
    start_.resize(at(tree().positions()));
    choose(moving(x));
    if (acting_.size() > 0.0 || freedoms() == 0) return;
    const double own = natural_length(*this, x);
    if (!std::isfinite(own)) return;
    // forces that are small beside others bend as these do only far away, and at a border of two formulas at once
    constexpr double far = 1e8, near = 0x1p-30;
    double off = 0.0;
    for (const mechanics::Moving<DoubleDouble>& body : moving(x)) off = std::max(off, rounded(body.place).norm());
    extent_ = off > 0.0 ? std::clamp(own, near * off, far * off) : own;
}

RBDYN_INLINE Forces::State TreeForces::at_rest(const std::vector<double>& q) {
    const int n = freedoms();
    State s;
    s.jacobian = SquareMatrix(n);
    place_ = std::all_of(q.begin(), q.end(), [](double c) { return std::isfinite(c); }) ? wide(q) : Wide{};
    if (place_.empty()) {
        // a place that is none
        const double none = std::numeric_limits<double>::quiet_NaN();
        s.force.assign(at(n), none);
        s.metric.assign(at(n), 1.0);
        s.effort = s.size = s.metric;
        return s;
    }
    look_at(Wide(place_));
    for (const DoubleDouble& f : forces(place_)) s.force.push_back(static_cast<double>(f));
    const RestForces::Efforts efforts = acting_.efforts(q);
    if (rows_.empty()) {
        set_signs(program_, parameters_, q);
        values_->set_parameters(parameters_);
        values_->differentiate(0.0, q);
        for (const Change<double>& c : changes<double>(q))
            for (int i = 0; i < n; ++i) s.jacobian(i, c.velocity) += c.rate * values_->derivative(i, c.position);
    } else {
        const WideMatrix slope = constrained_jacobian();
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) s.jacobian(i, j) = static_cast<double>(slope(i, j));
    }
    for (int i = 0; i < n; ++i) {
        double effort = rows_.empty() ? efforts.joints[at(i)] : 0.0;
        for (int k = 0; k < tree().velocities() && !rows_.empty(); ++k)
            effort += std::abs(static_cast<double>(basis_[at(i)][at(k)])) * efforts.joints[at(k)];
        DoubleDouble own = 0.0;
        for (const Carried& c : carried(i)) {
            effort += efforts.of(c.body, {rounded(c.twist.turn), rounded(c.twist.move)});
            const Momentum m = momentum(c);
            own += tree().node(c.body).mass * dot<DoubleDouble>(m.speed, m.speed) +
                   dot<DoubleDouble>(c.twist.turn, m.spin);
        }
        s.effort.push_back(effort);
        s.metric.push_back(static_cast<double>(own));
    }
    const std::vector<double> sizes = known();
    for (const int k : leading_) s.size.push_back(sizes[at(k)]);
    for (const mechanics::LooseRail& rail : acting_.one_sided()) {
        constexpr double epsilon = std::numeric_limits<double>::epsilon();
        const auto push = [&](const RestForces::Efforts& e) {
            return acting_.push<double>(rail, e.all, e.bodies[at(rail.body)].force);
        };
        const double pushes = push(efforts);
        double rounding =
            16.0 * epsilon * efforts.of(rail.body, {Vector3::Zero(), efforts.all[at(rail.body)].joint.front().move});
        s.pushed = s.pushed && pushes >= -rounding;
        // of the place, too
        for (std::size_t k = 0; k < q.size(); ++k) {
            if (q[k] == 0.0) continue;
            std::vector<double> beside = q;
            beside[k] *= 1.0 + 8.0 * epsilon;
            rounding += std::abs(push(acting_.efforts(beside)) - pushes);
        }
        s.idle = s.idle || pushes <= rounding;
    }
    return s;
}

RBDYN_INLINE void TreeForces::look_at(const Wide& place) {
    const int n = freedoms();
    place_ = place;
    if (!function_ || distinguishes_) record(nearest(place));
    bodies_ = moving(place_);
    choose(bodies_);
    basis_.clear();
    known_.clear();
    if (rows_.empty()) return;
    const std::vector<Wide> held = rows(bodies_);
    for (int i = 0; i < n; ++i) {
        Wide one(at(n), 0.0);
        one[at(i)] = 1.0;
        basis_.push_back(velocities(held, one));
    }
}

RBDYN_INLINE TreeForces::Wide TreeForces::force_at(const Wide& place) {
    if (distinguishes_) record(nearest(place));
    return forces(place);
}

RBDYN_INLINE std::string TreeForces::not_finite(const std::vector<double>& q) const {
    const Wide x = wide(q);
    if (x.empty()) return "the place itself, where the constraints cannot be closed,";
    if (const std::string what = acting_.not_finite(q); !what.empty()) return what;
    if (function_) {
        const Wide f = (*function_)(std::span<const DoubleDouble>(x.data(), at(tree().positions())));
        for (const mechanics::Node& n : tree().nodes())
            for (int k = 0; k < n.joint.velocities(); ++k)
                if (!std::isfinite(f[at(n.v + k)].hi)) return "a force or torque on " + n.name;
    }
    return "a derivative of the forces";
}

RBDYN_INLINE TreeForces::WideJacobian TreeForces::wide_jacobian() const {
    return rows_.empty() ? exact_jacobian() : WideJacobian{constrained_jacobian()};
}

template <class N>
std::vector<TreeForces::Change<N>> TreeForces::changes(const std::vector<N>& q) const {
    std::vector<Change<N>> result;
    for (const mechanics::Node& n : tree().nodes()) {
        const int first = n.joint.attitude(), moves = first < 0 ? n.joint.velocities() : first;
        for (int k = 0; k < moves; ++k) result.push_back({n.v + k, n.q + k, N(1.0)});
        if (first < 0) continue;
        for (int k = 0; k < 3; ++k) {
            Vector3Of<N> axis(N(0.0), N(0.0), N(0.0));
            axis[k] = N(1.0);
            N rate[4];
            mechanics::quaternion_rate<N>(&q[at(n.q + first)], axis, rate);
            for (int j = 0; j < 4; ++j) result.push_back({n.v + first + k, n.q + first + j, rate[j]});
        }
    }
    return result;
}

RBDYN_INLINE TreeForces::WideJacobian TreeForces::exact_jacobian() const {
    const int n = tree().velocities();
    WideJacobian result{WideMatrix(n), true};
    const std::span<const DoubleDouble> place(place_.data(), at(tree().positions()));
    std::map<int, std::vector<DoubleDouble>> slopes;
    for (const Change<DoubleDouble>& c : changes<DoubleDouble>(place_)) {
        if (c.rate.hi == 0.0 || !function_->depends_on(c.position)) continue;
        auto found = slopes.find(c.position);
        if (found == slopes.end()) {
            Interruption::point();
            const Function& derivative = slope(c.position);
            result.is_constant = result.is_constant && derivative.constants().has_value();
            found = slopes.emplace(c.position, derivative(place)).first;
        }
        for (int i = 0; i < n; ++i) result.entries(i, c.velocity) += c.rate * found->second[at(i)];
    }
    return result;
}

RBDYN_INLINE WideMatrix TreeForces::constrained_jacobian() const {
    // r = Q_l - G_l^T lambda with G_f^T lambda = Q_f, l the freedoms, f what follows: along a motion that the
    // constraints allow r' is to Q' - G'^T lambda, lambda as it is, what r is to Q; so nothing is closed again beside
    // the place. Q may change in lengths that the scene does not show, G does in those of its joints and curves.
    constexpr double part = 0x1p-33;
    const int n = freedoms();
    const std::vector<Wide> held = rows(bodies_);
    const WideMatrix slope = exact_jacobian().entries;
    const Wide multipliers = holding(held, (*function_)(std::span(place_.data(), at(tree().positions()))));
    const auto forced = [&](const Wide& x) {
        Wide q(at(tree().velocities()), 0.0);
        const std::vector<Wide> there = rows(moving(x));
        for (std::size_t r = 0; r < there.size(); ++r)
            for (std::size_t k = 0; k < q.size(); ++k) q[k] += there[r][k] * multipliers[r];
        return q;
    };
    WideMatrix result(n);
    for (int j = 0; j < n; ++j) {
        Interruption::point();
        // as far as the body that moves most moves by a part of the scene's size
        double most = 0.0;
        for (const Carried& c : carried(j))
            most = std::max({most, rounded(c.twist.move).norm() / extent_, rounded(c.twist.turn).norm()});
        const double step = most > 0.0 ? std::exp2(std::floor(std::log2(part / most))) : part;
        const auto shifted = [&](double sign) {
            Wide there = place_;
            std::vector<double> way;
            for (const DoubleDouble& v : basis_[at(j)]) way.push_back(sign * step * static_cast<double>(v));
            mechanics::closing::move<DoubleDouble>(tree(), 0.0, way, there);
            mechanics::closing::normalize<DoubleDouble>(tree(), there);
            return forced(there);
        };
        const Wide ahead = shifted(1.0), back = shifted(-1.0);
        Wide change(ahead.size(), 0.0);
        for (std::size_t k = 0; k < change.size(); ++k) {
            change[k] = (back[k] - ahead[k]) * DoubleDouble(0.5 / step);
            for (std::size_t i = 0; i < change.size(); ++i)
                change[k] += slope(static_cast<int>(k), static_cast<int>(i)) * basis_[at(j)][i];
        }
        const Wide along = reduced(held, change);
        for (int i = 0; i < n; ++i) result(i, j) = along[at(i)];
    }
    return result;
}

RBDYN_INLINE std::vector<TreeForces::Carried> TreeForces::carried(int freedom) const {
    std::vector<Carried> result;
    if (!rows_.empty()) {
        const Wide& v = basis_[at(freedom)];
        for (int i = 0; i < bodies(); ++i) {
            const mechanics::Node& n = tree().node(i);
            Carried c{i, {}};
            if (n.parent >= 0) {
                const Vector3Of<DoubleDouble> arm = bodies_[at(i)].place - bodies_[at(n.parent)].place;
                c.twist = result[at(n.parent)].twist;
                c.twist.move += cross<DoubleDouble>(c.twist.turn, arm);
                // what turns freely does not turn with its parent
                if (n.joint.attitude() >= 0) c.twist.turn = mechanics::none<DoubleDouble>();
            }
            for (int k = 0; k < n.joint.velocities(); ++k) {
                const mechanics::Twist<DoubleDouble>& own = bodies_[at(i)].joint[at(k)];
                c.twist.turn += own.turn * v[at(n.v + k)];
                c.twist.move += own.move * v[at(n.v + k)];
            }
            result.push_back(c);
        }
        return result;
    }
    const auto& nodes = tree().nodes();
    const auto own =
        std::upper_bound(nodes.begin(), nodes.end(), freedom, [](int v, const mechanics::Node& n) { return v < n.v; });
    const int body = static_cast<int>(own - nodes.begin()) - 1;
    result.push_back({body, bodies_[at(body)].joint[at(freedom - tree().node(body).v)]});
    if (!carries_[at(body)]) return result;
    std::vector<int> place(at(bodies()), -1);
    place[at(body)] = 0;
    for (int i = body + 1; i < bodies(); ++i) {
        const mechanics::Node& n = tree().node(i);
        if (n.parent < 0 || place[at(n.parent)] < 0) continue;
        place[at(i)] = static_cast<int>(result.size());
        const mechanics::Twist<DoubleDouble> on = result[at(place[at(n.parent)])].twist;
        const Vector3Of<DoubleDouble> arm = bodies_[at(i)].place - bodies_[at(n.parent)].place;
        Carried c{i, {on.turn, Vector3Of<DoubleDouble>(on.move + cross<DoubleDouble>(on.turn, arm))}};
        // what turns freely does not turn with its parent
        if (n.joint.attitude() >= 0) c.twist.turn = mechanics::none<DoubleDouble>();
        result.push_back(c);
    }
    return result;
}

RBDYN_INLINE TreeForces::Momentum TreeForces::momentum(const Carried& c) const {
    const mechanics::Node& node = tree().node(c.body);
    const mechanics::Moving<DoubleDouble>& m = bodies_[at(c.body)];
    Vector3Of<DoubleDouble> spin{};
    if (!node.is_point) {
        const Vector3Of<DoubleDouble> turning = m.to_body(c.twist.turn);
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 3; ++k) spin[r] += node.body.inertia(r, k) * turning[k];
    }
    const Vector3Of<DoubleDouble> arm = m.to_world(node.center);
    return {Vector3Of<DoubleDouble>(c.twist.move + cross<DoubleDouble>(c.twist.turn, arm)), m.to_world(spin)};
}

RBDYN_INLINE WideMatrix TreeForces::wide_mass() const {
    struct Share {
        int freedom;
        Carried moved;
        Momentum momentum;
    };
    std::vector<std::vector<Share>> shares(at(bodies()));
    for (int j = 0; j < freedoms(); ++j)
        for (const Carried& c : carried(j)) shares[at(c.body)].push_back({j, c, momentum(c)});
    WideMatrix result(freedoms());
    for (int b = 0; b < bodies(); ++b)
        for (const Share& i : shares[at(b)])
            for (const Share& j : shares[at(b)])
                result(i.freedom, j.freedom) +=
                    tree().node(b).mass * dot<DoubleDouble>(i.momentum.speed, j.momentum.speed) +
                    dot<DoubleDouble>(i.moved.twist.turn, j.momentum.spin);
    return result;
}

RBDYN_INLINE std::vector<double> TreeForces::in_all(const std::vector<double>& motion) const {
    if (rows_.empty()) return motion;
    std::vector<double> v(at(tree().velocities()), 0.0);
    for (std::size_t i = 0; i < basis_.size(); ++i)
        for (std::size_t k = 0; k < v.size(); ++k) v[k] += static_cast<double>(basis_[i][k]) * motion[i];
    return v;
}

RBDYN_INLINE std::vector<double> TreeForces::in_bodies(const std::vector<double>& q,
                                                       const std::vector<double>& motion) const {
    std::vector<double> v = in_all(motion);
    for (int i = 0; i < bodies(); ++i) {
        const int turns = tree().node(i).joint.attitude();
        if (turns < 0) continue;
        double* own = &v[at(tree().node(i).v + turns)];
        const Vector3 turn = to_body<double>(attitude(q, i), Vector3(own[0], own[1], own[2]));
        std::copy_n(turn.data(), 3, own);
    }
    return v;
}

RBDYN_INLINE TreeForces::Wide TreeForces::closed(Wide positions) const {
    positions.resize(at(tree().variables()), 0.0);
    mechanics::closing::normalize<DoubleDouble>(tree(), positions);
    if (rows_.empty()) return positions;
    const double left = mechanics::close(tree(), conditions_, rows_, 0.0, positions, 60);
    return left <= 1e-12 * extent_ ? positions : Wide{};
}

RBDYN_INLINE TreeForces::Bodies TreeForces::moving(const Wide& x) const {
    return mechanics::closing::moving<DoubleDouble>(tree(), 0.0, x);
}

RBDYN_INLINE std::vector<TreeForces::Wide> TreeForces::rows(const Bodies& all) const {
    if (rows_.empty()) return {};
    const auto every = conditions_.rows<DoubleDouble>(tree(), all);
    std::vector<mechanics::Row<DoubleDouble>> used;
    for (const int r : rows_) used.push_back(every[at(r)]);
    return mechanics::jacobian<DoubleDouble>(tree(), used, all);
}

RBDYN_INLINE void TreeForces::choose(const Bodies& all) {
    const int count = tree().velocities(), used = static_cast<int>(rows_.size());
    // those that followed stay so until others are far better
    constexpr double habit = 4.0;
    std::vector<double> weight(at(count), 1.0);
    for (const int k : following_) weight[at(k)] = habit;
    std::vector<std::vector<double>> a;
    for (const Wide& row : rows(all)) a.push_back(mechanics::closing::nearest(row));
    std::vector<int> in_order, follow;
    std::vector<bool> row_done(at(used), false), done(at(count), false);
    for (int step = 0; step < used; ++step) {
        int row = -1, column = -1;
        double most = 0.0;
        for (int r = 0; r < used; ++r)
            for (int k = 0; k < count && !row_done[at(r)]; ++k)
                if (const double size = std::abs(a[at(r)][at(k)]) * weight[at(k)]; !done[at(k)] && size > most) {
                    most = size;
                    row = r;
                    column = k;
                }
        if (row < 0) break;
        row_done[at(row)] = done[at(column)] = true;
        in_order.push_back(rows_[at(row)]);
        follow.push_back(column);
        for (int r = 0; r < used; ++r) {
            if (row_done[at(r)]) continue;
            const double factor = a[at(r)][at(column)] / a[at(row)][at(column)];
            for (int k = 0; k < count; ++k) a[at(r)][at(k)] -= factor * a[at(row)][at(k)];
        }
    }
    // where rows depend on each other nothing better is known
    if (static_cast<int>(follow.size()) < used) return;
    rows_ = std::move(in_order);
    following_ = std::move(follow);
    leading_.clear();
    for (int k = 0; k < count; ++k)
        if (!done[at(k)]) leading_.push_back(k);
}

RBDYN_INLINE TreeForces::Wide TreeForces::velocities(const std::vector<Wide>& rows, const Wide& motion) const {
    Interruption::point();
    Wide v(at(tree().velocities()), 0.0);
    for (std::size_t i = 0; i < leading_.size(); ++i) v[at(leading_[i])] = motion[i];
    if (rows.empty()) return v;
    std::vector<Wide> a;
    Wide b, pivots, driven;
    for (const Wide& row : rows) {
        a.emplace_back();
        for (const int k : following_) a.back().push_back(row[at(k)]);
        DoubleDouble sum = 0.0;
        for (std::size_t i = 0; i < leading_.size(); ++i) sum -= row[at(leading_[i])] * motion[i];
        b.push_back(sum);
    }
    const Wide follow = mechanics::solve_in_order<DoubleDouble>(std::move(a), std::move(b), pivots, driven);
    for (std::size_t k = 0; k < follow.size(); ++k) v[at(following_[k])] = follow[k];
    return v;
}

RBDYN_INLINE TreeForces::Wide TreeForces::holding(const std::vector<Wide>& rows, const Wide& q) const {
    std::vector<Wide> a;
    Wide b, pivots, driven;
    if (rows.empty()) return b;
    for (const int k : following_) {
        a.emplace_back();
        for (const Wide& row : rows) a.back().push_back(row[at(k)]);
        b.push_back(q[at(k)]);
    }
    return mechanics::solve_in_order<DoubleDouble>(std::move(a), std::move(b), pivots, driven);
}

RBDYN_INLINE TreeForces::Wide TreeForces::reduced(const std::vector<Wide>& rows, const Wide& q) const {
    Wide result;
    for (const int k : leading_) result.push_back(q[at(k)]);
    const Wide multipliers = holding(rows, q);
    for (std::size_t i = 0; i < result.size(); ++i)
        for (std::size_t r = 0; r < rows.size(); ++r) result[i] -= rows[r][at(leading_[i])] * multipliers[r];
    return result;
}

RBDYN_INLINE TreeForces::Wide TreeForces::forces(const Wide& x) const {
    Interruption::point();
    const Wide q = (*function_)(std::span<const DoubleDouble>(x.data(), at(tree().positions())));
    return reduced(rows_.empty() ? std::vector<Wide>{} : rows(moving(x)), q);
}

RBDYN_INLINE const Function& TreeForces::slope(int position) const {
    auto found = slopes_.find(position);
    if (found == slopes_.end()) found = slopes_.emplace(position, function_->derivative(position)).first;
    return found->second;
}

RBDYN_INLINE void TreeForces::record(const std::vector<double>& q) {
    const int positions = tree().positions();
    const auto follow = [&](Recorder& into) {
        into.follow(0.0, q, {});
        std::vector<Expression> places;
        for (int i = 0; i < positions; ++i) places.push_back(into.input(i));
        return acting_.recorded(places);
    };
    Recorder r;
    program_ = Program(r, follow(r).along, positions);
    distinguishes_ = !r.branches().empty();
    parameters_.clear();
    if (rows_.empty()) values_ = std::make_unique<JacobianEvaluator>(program_);
    const recording::WideFolding all_digits;
    slopes_.clear();
    function_ = Function::record_growing([&](Recorder& growing) {
        return std::pair{follow(growing).along, positions};
    });
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
