// Definitions of rbdyn/statics/point_forces.hpp.
#pragma once

#include "rbdyn/statics/point_forces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/point_laws.hpp"
#include "rbdyn/model/point_state.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/model/points_now.hpp"
#include "rbdyn/model/rigid_law.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/plan/planning.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/path_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE PointForces::PointForces(const Scene& scene) : model_(scene, planning::view_of(scene)) {
    for (const PointLaws::Body& b : laws().bodies()) {
        first_.push_back(freedoms_);
        freedoms_ += freedoms_of(b);
    }
}

RBDYN_INLINE int PointForces::displacements(int body) const {
    const PointLaws::Body& b = laws().body(body);
    return turns(b) ? freedoms_of(b) - 3 : freedoms_of(b);
}

RBDYN_INLINE std::vector<double> PointForces::start() const {
    std::vector<double> q = laws().start();
    q.resize(at(laws().positions()));
    return q;
}

RBDYN_INLINE std::vector<double> PointForces::place(const std::vector<double>& coordinates) const {
    std::vector<double> q = start();
    const double* c = coordinates.data();
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws().body(i);
        double* own = &q[at(b.first)];
        if (!turns(b)) {
            std::copy_n(c, freedoms_of(b), own);
            c += freedoms_of(b);
            continue;
        }
        const bool is_free = displacements(i) > 0;
        const double* p = is_free ? c + 3 : c;
        const Quaternion attitude = Attitude(Quaternion{p[0], p[1], p[2], p[3]}).quaternion();
        if (is_free) {
            const Vector3 g = Vector3(c[0], c[1], c[2]) + to_world<double>(attitude, b.rigid->origin);
            own = std::copy_n(g.data(), 3, own);
        }
        write(own, attitude * b.rigid->frame_attitude);
        c = p + 4;
    }
    return q;
}

RBDYN_INLINE std::vector<double> PointForces::coordinates(const std::vector<double>& q) const {
    std::vector<double> c;
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws().body(i);
        const double* own = &q[at(b.first)];
        if (!turns(b)) {
            // not -0
            for (int k = 0; k < freedoms_of(b); ++k) c.push_back(own[k] + 0.0);
            continue;
        }
        const Quaternion p = attitude(q, i) * conjugate(b.rigid->frame_attitude);
        if (displacements(i) > 0) {
            const Vector3 o = Vector3(own[0], own[1], own[2]) - to_world<double>(p, b.rigid->origin);
            for (int k = 0; k < 3; ++k) c.push_back(o[k] + 0.0);
        }
        tell(p, c);
    }
    return c;
}

RBDYN_INLINE Quaternion PointForces::attitude(const std::vector<double>& q, int body) const {
    const double* p = &q[at(laws().body(body).first + displacements(body))];
    return {p[0], p[1], p[2], p[3]};
}

RBDYN_INLINE Vector3 PointForces::center(const std::vector<double>& q, int body) const {
    const double* g = &q[at(laws().body(body).first)];
    return {g[0], g[1], g[2]};
}

RBDYN_INLINE Vector3 PointForces::turn_in_world(const std::vector<double>& q, int body, const Vector3& turn) const {
    return to_world<double>(attitude(q, body), turn);
}

RBDYN_INLINE std::vector<double> PointForces::turned(std::vector<double> q, int body, const Vector3& axis,
                                                     const Vector3& point, double angle) const {
    const Quaternion by = turn(axis, angle);
    double* own = &q[at(laws().body(body).first)];
    write(own + displacements(body), normalized(by * attitude(q, body)));
    if (displacements(body) > 0) {
        const Vector3 g = point + to_world<double>(by, Vector3(Vector3(own[0], own[1], own[2]) - point));
        std::copy_n(g.data(), 3, own);
    }
    return q;
}

RBDYN_INLINE std::vector<double> PointForces::moved(std::vector<double> q, const std::vector<double>& step) const {
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws().body(i);
        double* own = &q[at(b.first)];
        const double* d = &step[at(first(i))];
        for (int k = 0; k < displacements(i); ++k) own[k] += d[k];
        if (b.curve) *own = std::clamp(*own, b.curve->domain().begin, b.curve->domain().end);
        if (!turns(b)) continue;
        const Vector3 by{d[displacements(i)], d[displacements(i) + 1], d[displacements(i) + 2]};
        const double angle = by.norm();
        if (angle > 0.0) write(own + displacements(i), normalized(attitude(q, i) * turn(Vector3(by / angle), angle)));
    }
    return q;
}

RBDYN_INLINE double PointForces::largest_turn(const std::vector<double>& step) const {
    double most = 0.0;
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws().body(i);
        const double* d = &step[at(first(i))];
        if (turns(b))
            most = std::max(most, std::hypot(d[freedoms_of(b) - 3], d[freedoms_of(b) - 2], d[freedoms_of(b) - 1]));
        if (b.rigid && b.rigid->kind == RigidLaw::Kind::revolute) most = std::max(most, std::abs(*d));
    }
    return most;
}

RBDYN_INLINE std::vector<double> PointForces::difference(const std::vector<double>& to,
                                                         const std::vector<double>& from) const {
    std::vector<double> d;
    for (int i = 0; i < bodies(); ++i) {
        const std::size_t own = at(laws().body(i).first);
        for (std::size_t k = 0; k < at(displacements(i)); ++k) d.push_back(to[own + k] - from[own + k]);
        if (!turns(i)) continue;
        const Quaternion p = conjugate(attitude(from, i)) * attitude(to, i);
        for (const double x : {p.x, p.y, p.z}) d.push_back(2.0 * x);
    }
    return d;
}

RBDYN_INLINE Forces::State PointForces::at_rest(const std::vector<double>& q) {
    Interruption::point();
    choose(q);
    State s;
    s.jacobian = SquareMatrix(freedoms_);
    values_->differentiate(0.0, q);
    for (int i = 0; i < freedoms_; ++i) s.force.push_back(values_->output(i));
    std::vector<PointState<double>> states;
    const double zero[6] = {};
    for (const PointLaws::Body& b : laws().bodies())
        states.push_back(laws().moving<double>(b, 0.0, &q[at(b.first)], zero, false));
    const CouplingForces<double> couplings(laws(), 0.0, states);
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws().body(i);
        add_columns(i, q, s.jacobian);
        const Effort size = effort(laws(), i, couplings);
        const bool is_hinge = b.rigid && b.rigid->kind == RigidLaw::Kind::revolute;
        const double speed_squared = b.curve ? states[at(i)].curve.speed_squared : 1.0;
        for (int k = 0; k < displacements(i); ++k) {
            s.metric.push_back(is_hinge ? b.rigid->moments[2] : b.mass * speed_squared);
            s.effort.push_back(is_hinge ? size.moment : std::sqrt(speed_squared) * size.force);
            s.size.push_back(std::abs(q[at(b.first + k)]));
        }
        for (int k = 0; k < 3 && turns(b); ++k) {
            s.metric.push_back(b.rigid->moments[k]);
            s.effort.push_back(size.moment);
            s.size.push_back(1.0);
        }
        if (b.side == RailSide::both) continue;
        const auto f = laws().resultant<double>(i, couplings, false, [](double w) { return w; });
        s.pushed = s.pushed && -b.binormal.dot(states[at(i)].curve.first.cross(f.force)) >=
                                   -16.0 * std::numeric_limits<double>::epsilon() * s.effort.back();
    }
    return s;
}

RBDYN_INLINE std::string PointForces::not_finite(const std::vector<double>& q) const {
    Mode mode;
    mode.slip.assign(at(bodies()), 1);
    std::vector<double> x = model_.start();
    std::fill(std::copy(q.begin(), q.end(), x.begin()), x.end(), 0.0);
    const std::string what = model_.not_finite(mode, 0.0, x);
    return what.empty() ? "a derivative of the forces" : what;
}

RBDYN_INLINE std::array<std::array<double, 4>, 3> PointForces::turning(const Quaternion& p) {
    return {{{-p.x, p.w, p.z, -p.y}, {-p.y, -p.z, p.w, p.x}, {-p.z, p.y, -p.x, p.w}}};
}

RBDYN_INLINE void PointForces::add_columns(int body, const std::vector<double>& q, SquareMatrix& jacobian) const {
    const int own = laws().body(body).first, moves = displacements(body);
    for (int i = 0; i < freedoms_; ++i) {
        for (int k = 0; k < moves; ++k) jacobian(i, first(body) + k) = values_->derivative(i, own + k);
        if (!turns(body)) continue;
        const auto by = turning(attitude(q, body));
        for (int k = 0; k < 3; ++k) {
            double sum = 0.0;
            for (int j = 0; j < 4; ++j) sum += 0.5 * by[at(k)][at(j)] * values_->derivative(i, own + moves + j);
            jacobian(i, first(body) + moves + k) = sum;
        }
    }
}

RBDYN_INLINE void PointForces::choose(const std::vector<double>& q) {
    if (!values_ || distinguishes_) record(q);
    set_signs(program_, parameters_, q);
    values_->set_parameters(parameters_);
}

RBDYN_INLINE std::vector<Expression> PointForces::recorded(const std::vector<Expression>& q) const {
    using S = Expression;
    const std::vector<S> zero(6, S(0.0));
    std::vector<PointState<S>> states;
    for (const PointLaws::Body& b : laws().bodies())
        states.push_back(laws().moving<S>(b, S(0.0), &q[at(b.first)], zero.data(), false));
    const CouplingForces<S> couplings(laws(), S(0.0), states);
    std::vector<S> outputs;
    const auto add = [&](const Vector3Of<S>& v) {
        for (int k = 0; k < 3; ++k) outputs.push_back(v[k]);
    };
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws().body(i);
        if (b.rigid) {
            const Wrench<S> w = laws().wrench<S>(i, couplings);
            if (displacements(i) == 3) add(w.force);
            if (turns(b))
                add(w.moment);
            else
                outputs.push_back(b.rigid->kind == RigidLaw::Kind::revolute
                                      ? w.moment[2]
                                      : dot<S>(states[at(i)].rigid->axes.e3, w.force));
            continue;
        }
        const auto f = laws().resultant<S>(i, couplings, false, [](const S& w) { return w; });
        if (b.curve)
            outputs.push_back(dot<S>(states[at(i)].curve.first, f.force));
        else
            add(f.force);
    }
    return outputs;
}

RBDYN_INLINE void PointForces::record(const std::vector<double>& q) {
    Recorder r;
    r.follow(0.0, q, {});
    std::vector<Expression> inputs;
    for (int i = 0; i < laws().positions(); ++i) inputs.push_back(r.input(i));
    program_ = Program(r, recorded(inputs), laws().positions());
    distinguishes_ = !r.branches().empty();
    parameters_.clear();
    values_ = std::make_unique<JacobianEvaluator>(program_);
}

RBDYN_INLINE PointForces::WideJacobian PointForces::wide_jacobian(const std::vector<double>& q) const {
    const recording::WideFolding all_digits;
    const Function forces = Function::record_growing([&](Recorder& r) {
        r.follow(0.0, q, {});
        std::vector<Expression> inputs;
        for (int i = 0; i < laws().positions(); ++i) inputs.push_back(r.input(i));
        return std::pair{recorded(inputs), laws().positions()};
    });
    const std::vector<DoubleDouble> place(q.begin(), q.end());
    WideJacobian result{WideMatrix(freedoms_)};
    const auto add_column = [&](int column, int variable, const DoubleDouble& factor) {
        if (factor.hi == 0.0 || !forces.depends_on(variable)) return;
        const Function derivative = forces.derivative(variable);
        result.is_constant = result.is_constant && derivative.constants().has_value();
        const std::vector<DoubleDouble> slope = derivative(std::span<const DoubleDouble>(place));
        for (int i = 0; i < freedoms_; ++i) result.entries(i, column) += factor * slope[at(i)];
    };
    for (int body = 0; body < bodies(); ++body) {
        const int own = laws().body(body).first, moves = displacements(body);
        for (int k = 0; k < moves; ++k) add_column(first(body) + k, own + k, 1.0);
        if (!turns(body)) continue;
        const auto by = turning(attitude(q, body));
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 4; ++j) add_column(first(body) + moves + k, own + moves + j, 0.5 * by[at(k)][at(j)]);
    }
    return result;
}

RBDYN_INLINE std::vector<DoubleDouble> PointForces::wide_metric(const std::vector<double>& q) const {
    std::vector<DoubleDouble> result;
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws().body(i);
        const bool is_hinge = b.rigid && b.rigid->kind == RigidLaw::Kind::revolute;
        const DoubleDouble speed_squared =
            b.curve ? b.curve->at<DoubleDouble>(DoubleDouble(q[at(b.first)]), laws().view()).speed_squared
                    : DoubleDouble(1.0);
        for (int k = 0; k < displacements(i); ++k)
            result.push_back(is_hinge  ? b.rigid->exact.moments[2]
                             : b.rigid ? b.rigid->exact.mass
                                       : speed_squared * b.mass);
        for (int k = 0; k < 3 && turns(b); ++k) result.push_back(b.rigid->exact.moments[k]);
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
