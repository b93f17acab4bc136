// Definitions of rbdyn/statics/tree_forces.hpp: forces, and what follows from them.
#pragma once

#include "rbdyn/statics/tree_forces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/assemble.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/statics/path_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE TreeForces::TreeForces(const Scene& scene)
    : scene_bodies_(scene.bodies()), tree_(scene), exerted_(scene, tree_) {
    require_simple_rails(scene);
    const Wide given = tree_.start(0.0);
    const auto all = moving(given);
    conditions_ = mechanics::Conditions(scene, tree_, all);
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    const auto take = [&](const Vector3& p) {
        low = lesser(low, p);
        high = greater(high, p);
    };
    for (int i = 0; i < bodies(); ++i) {
        take(rounded(all[at(i)].place));
        take(rounded(all[at(i)].place + all[at(i)].to_world(tree_.node(i).center)));
    }
    reach_.assign(at(bodies()), 0.0);
    const auto reach = [&](const mechanics::Anchor& anchor) {
        if (anchor.body < 0) return;
        double& own = reach_[at(anchor.body)];
        own = std::max(own, rounded(anchor.point).norm());
    };
    for (int i = 0; i < bodies(); ++i) reach({i, tree_.node(i).center});
    for (const Scene::AppliedLoad& l : scene.loads())
        if (l.at) reach(tree_.anchor(End(BodyPoint{l.body, *l.at})));
    for (const Scene::Connection& c : scene.connections())
        for (const End* end : {&c.a, &c.b}) {
            const mechanics::Anchor anchor = tree_.anchor(*end);
            take(rounded(tree_.point<DoubleDouble>(anchor, all).place));
            reach(anchor);
        }
    if (const double size = (high - low).norm(); size > 0.0) size_ = size;

    std::vector<int> every(at(conditions_.constraint_rows()));
    for (std::size_t r = 0; r < every.size(); ++r) every[r] = static_cast<int>(r);
    const auto doubles = mechanics::closing::moving<double>(tree_, 0.0, mechanics::closing::nearest(given));
    rows_ = mechanics::independent_rows(tree_, conditions_, every, doubles);
    const Wide x = closed(Wide(given.begin(), given.begin() + tree_.positions()));
    if (x.empty())
        throw InvalidInput(
            "equilibria: the constraints of this scene cannot be closed from where it starts; scene.assemble() finds a "
            "start that satisfies them");
    start_ = mechanics::closing::nearest(x);
    start_.resize(at(tree_.positions()));
    choose(moving(x));
}

RBDYN_INLINE Forces::State TreeForces::at_rest(const std::vector<double>& q) {
    const int n = freedoms();
    State s;
    s.jacobian = SquareMatrix(n);
    place_ = std::all_of(q.begin(), q.end(), [](double c) { return std::isfinite(c); }) ? wide(q) : Wide{};
    const Wide& x = place_;
    if (x.empty()) {
        // a place that is none
        const double none = std::numeric_limits<double>::quiet_NaN();
        s.force.assign(at(n), none);
        s.metric.assign(at(n), 1.0);
        s.effort = s.size = s.metric;
        return s;
    }
    if (!function_ || distinguishes_) record(q);
    const auto all = moving(x);
    choose(all);
    const std::vector<Wide> held = rows(all);
    basis_.clear();
    for (int i = 0; i < n; ++i) {
        Wide one(at(n), 0.0);
        one[at(i)] = 1.0;
        basis_.push_back(velocities(held, one));
    }
    for (const DoubleDouble& f : forces(x)) s.force.push_back(static_cast<double>(f));
    set_signs(program_, parameters_, q);
    sizes_->set_parameters(parameters_);
    (*sizes_)(0.0, q);
    const WideMatrix slope = wide_jacobian(), mass = wide_mass();
    for (int i = 0; i < n; ++i) {
        s.effort.push_back(effort(x, basis_[at(i)]));
        s.metric.push_back(static_cast<double>(mass(i, i)));
        for (int j = 0; j < n; ++j) s.jacobian(i, j) = static_cast<double>(slope(i, j));
    }
    for (const int k : leading_)
        for (const mechanics::Node& node : tree_.nodes()) {
            if (k < node.v || k >= node.v + node.joint.velocities()) continue;
            const int turns = node.joint.attitude();
            s.size.push_back(turns >= 0 && k - node.v >= turns ? 1.0 : std::abs(q[at(node.q + k - node.v)]));
        }
    return s;
}

RBDYN_INLINE double TreeForces::effort(const Wide& x, const Wide& motion) const {
    double sum = 0.0;
    for (int k = 0; k < tree_.velocities(); ++k)
        sum += std::abs(static_cast<double>(motion[at(k)])) * sizes_->size(joints() + k);
    const auto all = tree_.moving<DoubleDouble>(0.0, x.data(), motion.data());
    for (int i = 0; i < bodies(); ++i) {
        const auto size = [&](int first) {
            double largest = 0.0;
            for (int k = 0; k < 3; ++k) largest = std::max(largest, sizes_->size(first + 6 * i + k));
            return largest;
        };
        const double force = size(wrenches()), moment = size(wrenches() + 3);
        sum += force * rounded(all[at(i)].velocity).norm() +
               (moment + force * reach_[at(i)]) * rounded(all[at(i)].omega).norm();
    }
    return sum;
}

RBDYN_INLINE std::string TreeForces::not_finite(const std::vector<double>& q) const {
    const Wide x = wide(q);
    if (x.empty()) return "the place itself, where the constraints cannot be closed,";
    if (function_) {
        const Wide f = (*function_)(std::span<const DoubleDouble>(x.data(), at(tree_.positions())));
        for (const mechanics::Node& n : tree_.nodes())
            for (int k = 0; k < n.joint.velocities(); ++k)
                if (!std::isfinite(f[at(n.v + k)].hi)) return "a force or torque on " + n.name;
    }
    return "a derivative of the forces";
}

RBDYN_INLINE WideMatrix TreeForces::wide_jacobian() const {
    constexpr double part = 0x1p-33;
    const int n = freedoms();
    WideMatrix result(n);
    const Wide& x = place_;
    for (int j = 0; j < n; ++j) {
        // as far as the body that moves most moves by a part of the scene's size
        double most = 0.0;
        for (const mechanics::Moving<DoubleDouble>& m : tree_.moving<DoubleDouble>(0.0, x.data(), basis_[at(j)].data()))
            most = std::max({most, rounded(m.velocity).norm() / size_, rounded(m.omega).norm()});
        const double step = most > 0.0 ? std::exp2(std::floor(std::log2(part / most))) : part;
        std::vector<double> way;
        for (const DoubleDouble& v : basis_[at(j)]) way.push_back(step * static_cast<double>(v));
        const auto shifted = [&](double sign) {
            Wide there(x.begin(), x.begin() + tree_.positions());
            std::vector<double> changes = way;
            for (double& c : changes) c *= sign;
            mechanics::closing::move<DoubleDouble>(tree_, 0.0, changes, there);
            mechanics::closing::normalize<DoubleDouble>(tree_, there);
            const Wide on = closed(std::move(there));
            return on.empty() ? Wide(at(n), std::numeric_limits<double>::quiet_NaN()) : forces(on);
        };
        const Wide ahead = shifted(1.0), back = shifted(-1.0);
        for (int i = 0; i < n; ++i) result(i, j) = (ahead[at(i)] - back[at(i)]) * DoubleDouble(0.5 / step);
    }
    return result;
}

RBDYN_INLINE WideMatrix TreeForces::wide_mass() const {
    using Moves = std::vector<mechanics::Moving<DoubleDouble>>;
    const int n = freedoms();
    std::vector<Moves> motions;
    for (int j = 0; j < n; ++j) motions.push_back(tree_.moving<DoubleDouble>(0.0, place_.data(), basis_[at(j)].data()));
    WideMatrix result(n);
    for (int b = 0; b < bodies(); ++b) {
        const mechanics::Node& node = tree_.node(b);
        std::vector<Vector3Of<DoubleDouble>> speeds, momenta;
        for (int j = 0; j < n; ++j) {
            const mechanics::Moving<DoubleDouble>& m = motions[at(j)][at(b)];
            const Vector3Of<DoubleDouble> turning = m.to_body(m.omega);
            Vector3Of<DoubleDouble> spin{};
            if (!node.is_point)
                for (int r = 0; r < 3; ++r)
                    for (int c = 0; c < 3; ++c) spin[r] += node.body.inertia(r, c) * turning[c];
            momenta.push_back(m.to_world(spin));
            speeds.push_back(m.velocity_at(m.to_world(node.center)));
        }
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                result(i, j) += node.mass * dot<DoubleDouble>(speeds[at(i)], speeds[at(j)]) +
                                dot<DoubleDouble>(motions[at(i)][at(b)].omega, momenta[at(j)]);
    }
    return result;
}

RBDYN_INLINE std::vector<double> TreeForces::in_all(const std::vector<double>& motion) const {
    std::vector<double> v(at(tree_.velocities()), 0.0);
    for (std::size_t i = 0; i < basis_.size(); ++i)
        for (std::size_t k = 0; k < v.size(); ++k) v[k] += static_cast<double>(basis_[i][k]) * motion[i];
    return v;
}

RBDYN_INLINE std::vector<double> TreeForces::in_bodies(const std::vector<double>& q,
                                                       const std::vector<double>& motion) const {
    std::vector<double> v = in_all(motion);
    for (int i = 0; i < bodies(); ++i) {
        const int turns = tree_.node(i).joint.attitude();
        if (turns < 0) continue;
        double* own = &v[at(tree_.node(i).v + turns)];
        const Vector3 turn = to_body<double>(attitude(q, i), Vector3(own[0], own[1], own[2]));
        std::copy_n(turn.data(), 3, own);
    }
    return v;
}

RBDYN_INLINE TreeForces::Wide TreeForces::closed(Wide positions) const {
    positions.resize(at(tree_.variables()), 0.0);
    mechanics::closing::normalize<DoubleDouble>(tree_, positions);
    if (rows_.empty()) return positions;
    const double left = mechanics::close(tree_, conditions_, rows_, 0.0, positions, 60);
    return left <= 1e-12 * size_ ? positions : Wide{};
}

RBDYN_INLINE std::vector<mechanics::Moving<DoubleDouble>> TreeForces::moving(const Wide& x) const {
    return mechanics::closing::moving<DoubleDouble>(tree_, 0.0, x);
}

RBDYN_INLINE std::vector<TreeForces::Wide> TreeForces::rows(
    const std::vector<mechanics::Moving<DoubleDouble>>& all) const {
    if (rows_.empty()) return {};
    const auto every = conditions_.rows<DoubleDouble>(tree_, all);
    std::vector<mechanics::Row<DoubleDouble>> used;
    for (const int r : rows_) used.push_back(every[at(r)]);
    return mechanics::jacobian<DoubleDouble>(tree_, used, all);
}

RBDYN_INLINE void TreeForces::choose(const std::vector<mechanics::Moving<DoubleDouble>>& all) {
    const int count = tree_.velocities(), used = static_cast<int>(rows_.size());
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
    Wide v(at(tree_.velocities()), 0.0);
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

RBDYN_INLINE TreeForces::Wide TreeForces::reduced(const std::vector<Wide>& rows, const Wide& q) const {
    Wide result;
    for (const int k : leading_) result.push_back(q[at(k)]);
    if (rows.empty()) return result;
    std::vector<Wide> a;
    Wide b, pivots, driven;
    for (const int k : following_) {
        a.emplace_back();
        for (const Wide& row : rows) a.back().push_back(row[at(k)]);
        b.push_back(q[at(k)]);
    }
    const Wide multipliers = mechanics::solve_in_order<DoubleDouble>(std::move(a), std::move(b), pivots, driven);
    for (std::size_t i = 0; i < result.size(); ++i)
        for (std::size_t r = 0; r < rows.size(); ++r) result[i] -= rows[r][at(leading_[i])] * multipliers[r];
    return result;
}

RBDYN_INLINE TreeForces::Wide TreeForces::forces(const Wide& x) const {
    Interruption::point();
    const Wide q = (*function_)(std::span<const DoubleDouble>(x.data(), at(tree_.positions())));
    return reduced(rows_.empty() ? std::vector<Wide>{} : rows(moving(x)), q);
}

RBDYN_INLINE std::vector<Expression> TreeForces::recorded(const std::vector<Expression>& q) const {
    using S = Expression;
    const std::vector<S> still(at(tree_.velocities()), S(0.0));
    const auto all = tree_.moving<S>(S(0.0), q.data(), still.data());
    mechanics::Acts acts = exerted_.all(tree_, S(0.0), all, q.data(), still.data());
    std::vector<S> outputs = acts.joints, parts = acts.joints;
    for (const Wrench<S>& w : acts.wrenches)
        for (const Vector3Of<S>* v : {&w.force, &w.moment})
            for (int k = 0; k < 3; ++k) parts.push_back((*v)[k]);
    for (int i = bodies() - 1; i >= 0; --i) {
        const mechanics::Node& n = tree_.node(i);
        const mechanics::Moving<S>& m = all[at(i)];
        Wrench<S> w = acts.wrenches[at(i)];
        for (int k = 0; k < n.joint.velocities(); ++k) outputs[at(n.v + k)] += mechanics::power(m.joint[at(k)], w);
        if (n.parent < 0) continue;
        // what turns freely does not turn with its parent
        if (n.joint.attitude() >= 0) w.moment = mechanics::none<S>();
        mechanics::add<S>(acts.wrenches[at(n.parent)],
                          mechanics::about<S>(w, Vector3Of<S>(m.place - all[at(n.parent)].place)), S(1.0));
    }
    outputs.insert(outputs.end(), parts.begin(), parts.end());
    return outputs;
}

RBDYN_INLINE void TreeForces::record(const std::vector<double>& q) {
    Recorder r;
    r.follow(0.0, q, {});
    std::vector<Expression> inputs;
    for (int i = 0; i < tree_.positions(); ++i) inputs.push_back(r.input(i));
    program_ = Program(r, recorded(inputs), tree_.positions());
    distinguishes_ = !r.branches().empty();
    parameters_.clear();
    sizes_ = std::make_unique<RoundingSizes>(program_);
    const recording::WideFolding all_digits;
    function_ = Function::record_growing([&](Recorder& growing) {
        growing.follow(0.0, q, {});
        std::vector<Expression> places;
        for (int i = 0; i < tree_.positions(); ++i) places.push_back(growing.input(i));
        return std::pair{recorded(places), tree_.positions()};
    });
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
