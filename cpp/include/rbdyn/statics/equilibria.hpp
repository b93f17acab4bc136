// The equilibria of a scene of particles: all of them for one bead, for more freedoms the one that is near.
//
// Several freedoms: the zero of the generalized forces Q_i (F.r' of a bead, F of a free particle) at rest, by Newton's
// method with their exact Jacobian, damped after Levenberg and Marquardt (Nocedal and Wright, "Numerical Optimization",
// 2nd ed., sec. 10.3) in the metric of the kinetic energy, M = m |r'|^2 or m. Stable if the symmetric part of the
// stiffness -dQ/dq is positive definite; periods 2 pi/omega from its eigenvalues omega^2 against M, where it is
// symmetric. On rough rails that is one of the states of rest, and the others about it are not given.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/rail_equilibria.hpp"

namespace rbdyn {

namespace statics {

/// The generalized forces of a scene at rest.
class Forces {
public:
    explicit Forces(const Scene& scene) : model_(scene, planning::view_of(scene)) {
        for (const PointLaws::Body& b : laws().bodies()) {
            first_.push_back(freedoms_);
            freedoms_ += b.curve ? 1 : 3;
        }
    }
    const PointLaws& laws() const { return model_.laws(); }
    int freedoms() const { return freedoms_; }
    int bodies() const { return static_cast<int>(first_.size()); }
    int first(int body) const { return first_[at(body)]; }

    /// The coordinates the scene starts in.
    std::vector<double> start() const {
        std::vector<double> q(at(freedoms_));
        for (int i = 0; i < bodies(); ++i) {
            const PointLaws::Body& b = laws().body(i);
            for (int k = 0; k < (b.curve ? 1 : 3); ++k) q[at(first(i) + k)] = b.curve ? b.start_u : b.start_position[k];
        }
        return q;
    }

    /// What a state says: Q, its Jacobian, the metric, and the sizes of the terms of Q.
    struct State {
        std::vector<double> force, metric, effort;
        SquareMatrix jacobian;
        bool pushed = true;  // rails that only push do so
        bool is_finite() const {
            const auto all_finite = [](const std::vector<double>& v) {
                return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
            };
            return all_finite(force) && all_finite(jacobian.entries());
        }
        /// Q^T M^-1 Q
        double misfit() const {
            double sum = 0.0;
            for (std::size_t i = 0; i < force.size(); ++i) sum += force[i] * force[i] / metric[i];
            return sum;
        }
    };
    State at_rest(const std::vector<double>& q) {
        choose(q);
        State s;
        s.force.resize(at(freedoms_));
        s.metric.resize(at(freedoms_));
        s.effort.resize(at(freedoms_));
        s.jacobian = SquareMatrix(freedoms_);
        values_->differentiate(0.0, q);
        for (int i = 0; i < freedoms_; ++i) {
            s.force[at(i)] = values_->output(i);
            for (int j = 0; j < freedoms_; ++j) s.jacobian(i, j) = values_->derivative(i, j);
        }
        std::vector<PointState<double>> states;
        const double zero[3] = {0.0, 0.0, 0.0};
        for (int i = 0; i < bodies(); ++i)
            states.push_back(laws().moving<double>(laws().body(i), 0.0, &q[at(first(i))], zero, false));
        for (int i = 0; i < bodies(); ++i) {
            const PointLaws::Body& b = laws().body(i);
            const double size = effort(laws(), i, states);
            const CurvePoint<double>& c = states[at(i)].curve;
            for (int k = first(i); k < first(i) + (b.curve ? 1 : 3); ++k) {
                s.metric[at(k)] = b.curve ? b.mass * c.speed_squared : b.mass;
                s.effort[at(k)] = b.curve ? std::sqrt(c.speed_squared) * size : size;
            }
            if (b.side == RailSide::both) continue;
            const auto f = laws().resultant<double>(i, 0.0, states, false, [](double w) { return w; });
            s.pushed = s.pushed && -b.binormal.dot(c.first.cross(f.force)) >=
                                       -16.0 * std::numeric_limits<double>::epsilon() * s.effort[at(first(i))];
        }
        return s;
    }
    /// What is not finite in a state, in words.
    std::string not_finite(const std::vector<double>& q) const {
        Mode mode;
        mode.slip.assign(at(bodies()), 1);
        std::vector<double> x = model_.start();
        std::fill(x.begin() + laws().freedoms(), x.end(), 0.0);
        for (int i = 0; i < bodies(); ++i)
            for (int k = 0; k < (laws().body(i).curve ? 1 : 3); ++k)
                x[at(laws().body(i).first + k)] = q[at(first(i) + k)];
        const std::string what = model_.not_finite(mode, 0.0, x);
        return what.empty() ? "a derivative of the forces" : what;
    }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// The formula that is right in a state.
    void choose(const std::vector<double>& q) {
        if (!values_ || distinguishes_) record(q);
        set_signs(program_, parameters_, q);
        values_->set_parameters(parameters_);
    }
    void record(const std::vector<double>& q) {
        using S = Expression;
        Recorder r;
        r.follow(0.0, q, {});
        const S zero[3] = {0.0, 0.0, 0.0};
        std::vector<PointState<S>> states;
        for (int i = 0; i < bodies(); ++i) {
            const PointLaws::Body& b = laws().body(i);
            std::vector<S> own;
            for (int k = 0; k < (b.curve ? 1 : 3); ++k) own.push_back(r.input(first(i) + k));
            states.push_back(laws().moving<S>(b, S(0.0), own.data(), zero, false));
        }
        std::vector<S> outputs;
        for (int i = 0; i < bodies(); ++i) {
            const auto f = laws().resultant<S>(i, S(0.0), states, false, [](const S& w) { return w; });
            if (laws().body(i).curve)
                outputs.push_back(dot<S>(states[at(i)].curve.first, f.force));
            else
                for (int k = 0; k < 3; ++k) outputs.push_back(f.force[k]);
        }
        program_ = Program(r, outputs, freedoms_);
        distinguishes_ = !r.branches().empty();
        parameters_.clear();
        values_ = std::make_unique<JacobianEvaluator>(program_);
    }

    PointsModel model_;
    std::vector<int> first_;
    int freedoms_ = 0;
    Program program_;
    std::vector<double> parameters_;
    std::unique_ptr<JacobianEvaluator> values_;
    bool distinguishes_ = false;
};

/// The zero of the forces near q, in place; whether there is one.
inline bool relax(Forces& forces, std::vector<double>& q) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const int n = forces.freedoms();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    // q - step, on the rails
    const auto moved = [&](const std::vector<double>& from, const std::vector<double>& step) {
        std::vector<double> to = from;
        for (int i = 0; i < n; ++i) to[at(i)] -= step[at(i)];
        for (int i = 0; i < forces.bodies(); ++i)
            if (const auto& curve = forces.laws().body(i).curve) {
                double& u = to[at(forces.first(i))];
                u = std::clamp(u, curve->domain().begin, curve->domain().end);
            }
        return to;
    };
    const std::vector<double> start = q;
    Forces::State now = forces.at_rest(q);
    if (!now.is_finite())
        throw InvalidInput("equilibria: where the search begins, " + forces.not_finite(q) +
                           " is not finite; begin elsewhere (near)");
    std::vector<double> most = now.effort;
    const auto is_zero = [&](const Forces::State& s, const std::vector<double>& x, double slack) {
        for (int i = 0; i < n; ++i) {
            double rounding = 16.0 * s.effort[at(i)];
            for (int j = 0; j < n; ++j) rounding += 4.0 * std::abs(s.jacobian(i, j) * x[at(j)]);
            if (std::abs(s.force[at(i)]) > slack * epsilon * rounding) return false;
        }
        return true;
    };
    // far away damping finds the way, near the zero Newton's steps are taken whole
    double damping = 0.0;
    bool found = false;
    for (int iteration = 0; iteration < 300 && !found; ++iteration) {
        if (is_zero(now, q, 64.0)) {
            found = true;
            break;
        }
        // (J^T M^-1 J + damping M) step = J^T M^-1 Q
        SquareMatrix normal(n);
        std::vector<double> downhill(at(n));
        double scale = 0.0;
        for (int i = 0; i < n; ++i) {
            for (int k = 0; k < n; ++k) {
                const double weighted = now.jacobian(k, i) / now.metric[at(k)];
                downhill[at(i)] += weighted * now.force[at(k)];
                for (int j = 0; j < n; ++j) normal(i, j) += weighted * now.jacobian(k, j);
            }
            scale = std::max(scale, normal(i, i) / now.metric[at(i)]);
        }
        for (int i = 0; i < n; ++i) normal(i, i) += damping * scale * now.metric[at(i)];
        const std::vector<double> next = moved(q, solve(normal, downhill).x);
        Forces::State there;
        bool is_better = false;
        if (std::all_of(next.begin(), next.end(), [](double x) { return std::isfinite(x); })) {
            there = forces.at_rest(next);
            is_better = there.is_finite() && there.misfit() < now.misfit();
        }
        if (!is_better) {
            // no step is too small to help only where there is no way down
            if (damping > 1e12) break;
            damping = std::max(8.0 * damping, 1e-3);
            continue;
        }
        double gone = 0.0, taken = 0.0;
        bool faded = true;
        for (int i = 0; i < n; ++i) {
            gone = std::max(gone, now.metric[at(i)] * std::pow(next[at(i)] - start[at(i)], 2));
            taken = std::max(taken, now.metric[at(i)] * std::pow(next[at(i)] - q[at(i)], 2));
            most[at(i)] = std::max(most[at(i)], there.effort[at(i)]);
            faded = faded && std::abs(there.force[at(i)]) <= 1e-13 * most[at(i)];
        }
        q = next;
        now = there;
        damping = damping > 1e-9 ? 0.125 * damping : 0.0;
        // the forces die away to a zero of higher order, the steps with them
        found = damping == 0.0 && taken < 1e-20 * gone && faded;
    }
    if (!found) return false;
    for (int iteration = 0; iteration < 4; ++iteration) {
        const LinearSolution step = solve(now.jacobian, now.force);
        if (!(step.pivots > n * epsilon)) break;
        const std::vector<double> next = moved(q, step.x);
        const Forces::State there = forces.at_rest(next);
        if (!there.is_finite() || !(there.misfit() < now.misfit())) break;
        q = next;
        now = there;
    }
    return now.pushed;
}

/// What a scene does about a zero of its forces.
inline Equilibrium judged(Forces& forces, const std::vector<double>& q) {
    const Forces::State s = forces.at_rest(q);
    const int n = forces.freedoms();
    const auto root = [&](int i) { return std::sqrt(s.metric[static_cast<std::size_t>(i)]); };
    SquareMatrix stiffness(n), symmetric(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) stiffness(i, j) = -s.jacobian(i, j) / (root(i) * root(j));
    double twist = 0.0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            symmetric(i, j) = 0.5 * (stiffness(i, j) + stiffness(j, i));
            twist = std::max(twist, std::abs(stiffness(i, j) - stiffness(j, i)));
        }
    const std::vector<double> squares = symmetric_eigenvalues(symmetric);
    const double rounding = 64.0 * std::numeric_limits<double>::epsilon() * n * stiffness.largest();
    Equilibrium e{q, squares.front() > rounding};
    // without a potential the modes are not those of the symmetric part
    if (twist <= rounding)
        for (const double square : squares)
            if (square > rounding) e.periods.push_back(2.0 * std::numbers::pi / std::sqrt(square));
    return e;
}

}  // namespace statics

/// The states of rest of a scene, velocities zero (eq. 7.16).
///
/// One bead on a rail: all there are, in order of the parameter (rail_equilibria.hpp); `near`, its parameter, says
/// where a rail without ends is searched, the bead's start otherwise. More freedoms: at most one, looked for from
/// `near`, all coordinates in order of addition, or from where the scene starts. An empty list: none was found.
/// Throws InvalidInput for a scene without bodies, with forces that depend on time or are called back, or with rails
/// that move.
inline std::vector<Equilibrium> equilibria(const Scene& scene, const std::vector<double>& near = {}) {
    const std::string user = "equilibria";
    if (scene.bodies().empty()) throw InvalidInput("Scene: it has 0 bodies; add() at least one before it is asked");
    const Scene now = scene.frozen();
    int freedoms = 0;
    for (int i = 0; i < static_cast<int>(now.bodies().size()); ++i) {
        const Scene::Body& body = now.bodies()[static_cast<std::size_t>(i)];
        statics::require_timeless(now, i, user);
        if (const Rail* rail = body.rail();
            rail != nullptr && !near.empty() && freedoms < static_cast<int>(near.size())) {
            const double u = near[static_cast<std::size_t>(freedoms)];
            const Domain d = rail->curve().domain();
            require(u >= d.begin && u <= d.end, user, "near, parameter of " + body.name, u,
                    "it lies in the domain of the curve, " + text(d.begin) + " to " + text(d.end));
        }
        freedoms += body.rail() != nullptr ? 1 : 3;
    }
    require(near.empty() || static_cast<int>(near.size()) == freedoms, user, "number of coordinates in near",
            static_cast<double>(near.size()), "this scene has " + std::to_string(freedoms));
    for (const double x : near) require(std::isfinite(x), user, "a coordinate of near", x, "it is finite");
    if (now.bodies().size() == 1 && now.bodies()[0].rail() != nullptr) {
        RailEquilibria rail(statics::alone(now, BodyHandle{0}, user),
                            near.empty() ? now.bodies()[0].parameter : near[0]);
        return rail.find();
    }
    statics::Forces forces(now);
    std::vector<double> q = near.empty() ? forces.start() : near;
    if (!statics::relax(forces, q)) return {};
    return {statics::judged(forces, q)};
}

}  // namespace rbdyn
