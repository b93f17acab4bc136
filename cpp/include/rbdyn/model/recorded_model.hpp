// Models whose equations are recorded: one structure for each kind of mode and each side of every case distinction.
//
// A mode's equations are recorded at the state it begins in, which says on which side of every choice they are; where
// it says nothing (a choice that starts on its edge) the way the motion leaves the edge does. What an event did not
// change stays as it was, whatever rounding makes of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn {

/// A state that equations are recorded for: it says which side of every choice they are on, but for those in `forced`.
struct RecordedFor {
    double t = 0.0;
    std::span<const double> x;
    std::map<std::uint64_t, long> forced = {};
};

class RecordedModel : public HybridModel {
protected:
    /// What the equations depend on beside the choices: modes of one kind share them.
    virtual std::vector<signed char> kind_of(const Mode& mode) const = 0;
    /// The equations for a mode of a kind, at a state.
    virtual std::unique_ptr<Structure> record(const Mode& mode, const RecordedFor& state) const = 0;
    /// Sets the parameters that are no signs of switches.
    virtual void own_parameters(Mode& /*mode*/, std::span<const double> /*x*/) const {}

    /// The structure for a state, recorded anew only if no earlier one makes the same choices.
    const Structure& structure(const Mode& mode, double t, std::span<const double> x,
                               std::map<std::uint64_t, long> forced) const {
        const std::lock_guard lock(mutex_);
        auto& known = structures_[kind_of(mode)];
        if (!known.empty() && known.front()->equations.branches.empty()) return *known.front();
        auto recorded = record(mode, {t, x, std::move(forced)});
        const auto& branches = recorded->equations.branches;
        for (const auto& one : known) {
            const auto& others = one->equations.branches;
            const auto same = [](const Branch& a, const Branch& b) { return a.id == b.id && a.choice == b.choice; };
            if (std::equal(branches.begin(), branches.end(), others.begin(), others.end(), same)) return *one;
        }
        known.push_back(std::move(recorded));
        return *known.back();
    }

    /// Completes a mode: its equations and their parameters. `flipped`: guards whose switch or choice changed; the
    /// others stay as they are, unless the state is a new one.
    void choose(Mode& mode, double t, std::span<const double> x, std::span<const int> flipped,
                bool is_new = false) const {
        const Equations* before = mode.equations;
        const std::vector<double> old = mode.parameters;
        mode.equations = nullptr;
        std::map<std::uint64_t, long> forced;
        if (before != nullptr && !is_new)
            for (const Branch& b : before->branches) forced[b.id] = b.choice;
        if (before != nullptr)
            for (const int index : flipped)
                if (const Guard& guard = before->guards[at(index)]; guard.branch >= 0)
                    forced[before->branches[at(guard.branch)].id] =
                        before->branches[at(guard.branch)].choice + guard.step;
        // a choice that starts on its edge is made by the way it leaves it
        for (int attempt = 0; attempt < 8; ++attempt) {
            const Structure& s = structure(mode, t, x, forced);
            mode.equations = &s.equations;
            set_parameters(mode, t, x, before, old, flipped, is_new);
            mode.still = s.still && holds(mode, t, x);
            if (s.equations.branches.empty()) return;
            bool changed = false;
            Evaluator<double> values(s.equations.program);
            values.set_parameters(mode.parameters);
            values(t, x);
            for (const Guard& guard : s.equations.guards) {
                if (guard.branch < 0) continue;
                const Branch& b = s.equations.branches[at(guard.branch)];
                const bool is_zero =
                    std::abs(values.output(guard.output)) <= 64.0 * epsilon * values.magnitude(guard.output);
                if (forced.contains(b.id) || !is_zero) continue;
                const bool leaves = leading_sign(mode, t, x, guard.output) < 0;
                forced[b.id] = b.choice + (leaves ? guard.step : 0);
                changed = changed || leaves;
            }
            if (!changed) return;
        }
    }

    /// Whether no guard of a mode asks for another one at once.
    static bool holds(const Mode& mode, double t, std::span<const double> x) {
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t, x);
        for (const Guard& guard : mode.equations->guards)
            if (!guard.is_watched() && guard.output >= 0 && guard.sign_parameter < 0 &&
                values.output(guard.output) < -64.0 * epsilon * values.magnitude(guard.output))
                return false;
        return true;
    }

    void set_parameters(Mode& mode, double t, std::span<const double> x, const Equations* before,
                        const std::vector<double>& old, std::span<const int> flipped, bool is_new) const {
        const Equations& e = *mode.equations;
        const Program& program = e.program;
        mode.parameters.assign(at(program.parameters()), 0.0);
        own_parameters(mode, x);
        if (program.switches().empty()) return;
        for (const Switch& w : program.switches()) mode.parameters[at(w.parameter)] = w.is_norm ? 0.0 : 1.0;
        // what did not switch goes on as it was, but for what an event set anew
        std::vector<bool> settled(program.switches().size(), false);
        if (before != nullptr) {
            const int first = static_cast<int>(before->guards.size() - before->program.switches().size());
            for (std::size_t j = 0; j < before->program.switches().size(); ++j) {
                const Switch& w = before->program.switches()[j];
                const bool is_flipped =
                    std::find(flipped.begin(), flipped.end(), first + static_cast<int>(j)) != flipped.end();
                for (std::size_t k = 0; k < program.switches().size(); ++k) {
                    const Switch& now = program.switches()[k];
                    if (now.id != w.id || now.is_norm != w.is_norm || (is_new && !is_flipped)) continue;
                    settled[k] = true;
                    mode.parameters[at(now.parameter)] =
                        w.is_norm ? (is_flipped ? 1.0 : 0.0) : (is_flipped ? -1.0 : 1.0) * old[at(w.parameter)];
                }
            }
        }
        Evaluator<double> values(program);
        values.set_parameters(mode.parameters);
        values(t, x);
        std::vector<bool> at_zero(program.switches().size(), false);
        for (std::size_t k = 0; k < program.switches().size(); ++k) {
            const Switch& w = program.switches()[k];
            if (w.is_norm) continue;
            const double value = values.switch_value(static_cast<int>(k));
            double& sign = mode.parameters[at(w.parameter)];
            // a variable may have been set by the event
            const bool is_variable = program.switch_output(static_cast<int>(k)) < program.inputs();
            if (settled[k] && (!is_variable || value * sign >= 0.0)) continue;
            at_zero[k] = value == 0.0;
            sign = value < 0.0 ? -1.0 : 1.0;
        }
        // what starts at zero takes the sign of its first change, which may depend on the signs of the others
        for (std::size_t k = 0; k < program.switches().size(); ++k)
            if (at_zero[k] && leading_sign(mode, t, x, program.outputs() + static_cast<int>(k)) < 0)
                mode.parameters[at(program.switches()[k].parameter)] = -1.0;
    }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    mutable std::mutex mutex_;
    mutable std::map<std::vector<signed char>, std::vector<std::unique_ptr<Structure>>> structures_;
};

}  // namespace rbdyn
