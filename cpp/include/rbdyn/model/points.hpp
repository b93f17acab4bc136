// The hybrid model of particles: modes of friction, and what follows an event.
//
// A mode: the sign of the slip of every rough bead, or that it sticks; the numbers its equations take follow from it.
// A bead without slip sticks if the tangential reaction it needs is at most mu_static times the perpendicular one; on
// the edge of that cone it holds unless the next moment asks for more; else it starts the way it is pulled.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/point_equations.hpp"
#include "rbdyn/model/point_laws.hpp"

namespace rbdyn {

class PointsModel : public HybridModel {
public:
    PointsModel(const Scene& scene, const Placement& view) : laws_(scene, view) {}

    int variables() const override { return 2 * laws_.freedoms(); }
    int bodies() const { return static_cast<int>(laws_.bodies().size()); }
    bool on_rail(int body) const { return laws_.body(body).curve.has_value(); }
    const PointLaws& laws() const { return laws_; }

    /// The equations for given slips: 0 sticks, +1 or -1 slides.
    const Equations& equations(const std::vector<signed char>& slip) const { return structure(slip).equations; }

    /// The state the scene starts in.
    std::vector<double> start() const { return laws_.start(); }

    /// Motion and reaction of a body in a mode.
    PointReport report(const Mode& mode, int body, double t, std::span<const double> x) const {
        return laws_.report(body, mode.slip[at(body)], t, x);
    }

    Mode begin(double t, std::span<double> x) const override {
        Mode mode;
        mode.slip.assign(laws_.bodies().size(), 1);
        for (int i = 0; i < bodies(); ++i) {
            const PointLaws::Body& b = laws_.body(i);
            if (!b.rough) continue;
            // the slip as the user gave it, so that a bead carried by its rail starts stuck
            const double slip = b.start_speed - b.drive(t);
            const double size = std::max(std::abs(b.start_speed), std::abs(b.drive(t)));
            if (std::abs(slip) > 4.0 * epsilon * size)
                mode.slip[at(i)] = slip > 0.0 ? 1 : -1;
            else
                mode.slip[at(i)] = settle(mode, i, t, x);
        }
        choose(mode, t, x, {});
        return mode;
    }

    Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
              std::vector<Happening>& happenings) const override {
        Mode after = mode;
        std::vector<int> flipped;
        for (int index : fired) {
            const Guard& guard = mode.equations->guards[at(index)];
            const int i = guard.subject;
            const double sign = guard.sign_parameter >= 0 ? mode.parameters[at(guard.sign_parameter)] : 1.0;
            const Direction direction = sign > 0.0 ? Direction::falling : Direction::rising;
            switch (guard.kind) {
                case EventKind::reverse: {
                    const signed char before = mode.slip[at(i)];
                    after.slip[at(i)] = settle(after, i, t, x);
                    if (after.slip[at(i)] == 0)
                        happenings.push_back({EventKind::stick, i, direction, {}});
                    else if (after.slip[at(i)] != before)
                        happenings.push_back({EventKind::reverse, i, direction, {}});
                    break;
                }
                case EventKind::slip: {
                    const signed char s = static_cast<signed char>(laws_.holding(i, t, x).tangential < 0.0 ? 1 : -1);
                    after.slip[at(i)] = s;
                    happenings.push_back({EventKind::slip, i, s > 0 ? Direction::rising : Direction::falling, {}});
                    break;
                }
                default:
                    flipped.push_back(index);
                    // a variable that switches is zero, exactly
                    if (mode.equations->is_variable(guard)) x[at(mode.equations->program.output(guard.output))] = 0.0;
                    happenings.push_back(
                        {guard.kind, i, direction, guard.kind == EventKind::switching ? guard.name : std::string()});
                    break;
            }
        }
        choose(after, t, x, flipped);
        return after;
    }

    bool slope(const Mode& mode, double t, std::span<const double> x, std::span<double> slope) const override {
        const int n = laws_.freedoms();
        for (int i = 0; i < bodies(); ++i) {
            const PointLaws::Body& b = laws_.body(i);
            laws_.slope(i, mode.slip[at(i)], t, x, slope.subspan(at(b.first)), slope.subspan(at(n + b.first)));
        }
        for (double s : slope)
            if (!std::isfinite(s)) return false;
        return true;
    }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// What a bead without slip does: sticks (0), or starts to slip with the sign returned. Sets w exactly.
    signed char settle(const Mode& mode, int i, double t, std::span<double> x) const {
        const PointLaws::Body& b = laws_.body(i);
        const CurvePoint<double> c = laws_.curve_point(b, x[at(b.first)]);
        x[at(b.first + laws_.freedoms())] = b.drive(t) / std::sqrt(c.speed_squared);
        const Holding h = laws_.holding(i, t, x);
        const double limit = b.mu_static * h.across, needed = std::abs(h.tangential);
        const signed char escape = static_cast<signed char>(h.tangential < 0.0 ? 1 : -1);
        if (needed > limit * (1.0 + 8.0 * epsilon)) return escape;
        if (needed < limit * (1.0 - 8.0 * epsilon) || needed == 0.0) return 0;
        // on the edge of the cone: it holds unless the next moment asks for more
        Mode stuck = mode;
        stuck.slip[at(i)] = 0;
        choose(stuck, t, x, {});
        for (const Guard& guard : stuck.equations->guards)
            if (guard.kind == EventKind::slip && guard.subject == i)
                return leading_sign(stuck, t, x, guard.output) < 0 ? escape : static_cast<signed char>(0);
        return 0;
    }
    const PointStructure& structure(const std::vector<signed char>& slip) const {
        std::vector<bool> held;
        for (int i = 0; i < bodies(); ++i) held.push_back(laws_.body(i).rough && slip[at(i)] == 0);
        const std::lock_guard lock(mutex_);
        auto& found = structures_[held];
        if (!found) found = record_points(laws_, held);
        return *found;
    }

    /// Completes a mode: its equations and their parameters. `flipped`: guards of switches that changed sign.
    void choose(Mode& mode, double t, std::span<const double> x, std::span<const int> flipped) const {
        const PointStructure& s = structure(mode.slip);
        const Equations* before = mode.equations;
        const std::vector<double> old = mode.parameters;
        mode.equations = &s.equations;
        mode.still = s.still;
        const Program& program = s.equations.program;
        mode.parameters.assign(at(program.parameters()), 0.0);
        for (int i = 0; i < bodies(); ++i) {
            mode.parameters[at(i)] = mode.slip[at(i)];
            if (laws_.body(i).curve) mode.parameters[at(bodies() + i)] = x[at(laws_.body(i).first)];
        }
        if (program.switches().empty()) return;
        const int first = static_cast<int>(s.equations.guards.size() - program.switches().size());
        if (before == mode.equations) {
            // what did not switch goes on as it was, but for a variable that the event set anew
            for (std::size_t k = 0; k < program.switches().size(); ++k) {
                const Switch& w = program.switches()[k];
                const int slot = program.switch_output(static_cast<int>(k));
                double& parameter = mode.parameters[at(w.parameter)];
                parameter = w.is_norm ? 0.0 : old[at(w.parameter)];
                if (!w.is_norm && slot < program.inputs() && x[at(slot)] != 0.0)
                    parameter = x[at(slot)] > 0.0 ? 1.0 : -1.0;
            }
            for (int index : flipped) {
                const Switch& w = program.switches()[at(index - first)];
                mode.parameters[at(w.parameter)] = w.is_norm ? 1.0 : -old[at(w.parameter)];
            }
            return;
        }
        for (const Switch& w : program.switches()) mode.parameters[at(w.parameter)] = w.is_norm ? 0.0 : 1.0;
        Evaluator<double> values(program);
        values.set_parameters(mode.parameters);
        values(t, x);
        for (std::size_t k = 0; k < program.switches().size(); ++k) {
            const Switch& w = program.switches()[k];
            if (!w.is_norm && values.switch_value(static_cast<int>(k)) < 0.0) mode.parameters[at(w.parameter)] = -1.0;
        }
        // what starts at zero takes the sign of its first change, which may depend on the signs of the others
        for (std::size_t k = 0; k < program.switches().size(); ++k) {
            const Switch& w = program.switches()[k];
            if (w.is_norm || values.switch_value(static_cast<int>(k)) != 0.0) continue;
            if (leading_sign(mode, t, x, program.outputs() + static_cast<int>(k)) < 0)
                mode.parameters[at(w.parameter)] = -1.0;
        }
    }

    /// The sign an output takes just after t: that of its first coefficient that is not zero. 0: it stays zero.
    static int leading_sign(const Mode& mode, double t, std::span<const double> x, int output) {
        constexpr int order = 8;
        const Program& program = mode.equations->program;
        SeriesEvaluator series(program, order);
        series.set_parameters(mode.parameters);
        series.begin(t, 1.0);
        for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
        for (int k = 0; k <= order; ++k) {
            series.advance(k);
            if (k < order)
                for (int i = 0; i < program.inputs(); ++i) series.set_input(i, k + 1, series.output(i)[k] / (k + 1));
        }
        // the time in which the state changes by as much as its first derivative says, so that no unit matters
        double log_time = std::numeric_limits<double>::infinity();
        for (int i = 0; i < program.inputs(); ++i) {
            const double* c = series.coefficients(i);
            for (int k = 2; k <= order && c[1] != 0.0; ++k)
                if (c[k] != 0.0) log_time = std::min(log_time, std::log2(std::abs(c[1] / c[k])) / (k - 1));
        }
        const double time = std::isfinite(log_time) ? std::exp2(log_time) : 1.0;
        const double* g = series.output(output);
        double size = 0.0;
        for (int k = 0; k <= order; ++k) size = std::max(size, std::abs(g[k]) * std::pow(time, k));
        for (int k = 0; k <= order; ++k)
            if (std::abs(g[k]) * std::pow(time, k) > 1e-13 * size) return g[k] > 0.0 ? 1 : -1;
        return 0;
    }
    PointLaws laws_;
    mutable std::mutex mutex_;
    mutable std::map<std::vector<bool>, std::unique_ptr<PointStructure>> structures_;
};

}  // namespace rbdyn
