// Definitions of rbdyn/model/recorded_model.hpp.
#pragma once

#include "rbdyn/model/recorded_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/at_zero.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool RecordedModel::distinguishes() const {
    const std::lock_guard lock(recordings_->mutex);
    for (const auto& [key, known] : recordings_->structures)
        for (const auto& one : known)
            if (!one->equations.branches.empty()) return true;
    return false;
}

RBDYN_INLINE bool RecordedModel::restore(Mode& mode, double t, std::span<const double> x,
                                         const Decisions& decided) const {
    const Structure* const s = structure(mode, t, x, decided);
    if (s == nullptr) return false;
    // numbers of the user's that are no doubles take as many again (numbers.hpp)
    const std::size_t count = at(s->equations.program.parameters()), kept = mode.parameters.size();
    if (kept != count && (!s->equations.numbers || kept != 2 * count)) return false;
    mode.equations = &s->equations;
    return true;
}

RBDYN_INLINE RecordedModel::RecordedModel(const RecordedModel& other, GivenNumbers given, bool elsewhere)
    : given_(std::move(given)), recordings_(other.recordings_), is_elsewhere_(elsewhere || other.is_elsewhere_) {}

RBDYN_INLINE const Structure* RecordedModel::own(const Structure& recorded) const {
    if (!is_elsewhere_) return &recorded;
    const auto [place, is_new] = own_.try_emplace(&recorded);
    if (is_new) place->second = adapted(recorded);
    return place->second ? place->second.get() : &recorded;
}

RBDYN_INLINE void RecordedModel::own_parameters(Mode& /*mode*/, std::span<const double> /*x*/) const {}

RBDYN_INLINE void RecordedModel::flip(const Mode& mode, int fired, bool is_zero, std::span<double> x,
                                      std::vector<int>& flipped, std::vector<Happening>& happenings) {
    const Equations& e = *mode.equations;
    const Guard& guard = e.guards[at(fired)];
    const auto surface = e.surface_of(guard);
    const bool is_told = surface && std::any_of(flipped.begin(), flipped.end(), [&](int other) {
                             const Guard& g = e.guards[at(other)];
                             return g.subject == guard.subject && g.name == guard.name && e.surface_of(g) == surface;
                         });
    flipped.push_back(fired);
    if (is_zero && e.is_variable(guard)) x[at(e.program.output(guard.output))] = 0.0;
    if (guard.name.empty() || is_told) return;
    const double sign = guard.sign_parameter >= 0 ? mode.parameters[at(guard.sign_parameter)] : 1.0;
    const bool rises = guard.step != 0 ? guard.step > 0 : sign < 0.0;
    happenings.push_back({guard.kind, guard.subject, rises ? Direction::rising : Direction::falling, guard.name});
}

RBDYN_INLINE bool RecordedModel::same_motion(const Mode& a, const Mode& b, std::span<const int> flipped) {
    if (a.equations != b.equations || a.slip != b.slip) return false;
    for (const int index : flipped)
        if (const Switch* s = a.equations->switch_of(a.equations->guards[at(index)]); s != nullptr && s->is_norm)
            return false;
    // what holds for a first step alone says nothing of the motion
    std::vector<double> now = b.parameters;
    for (const int flag : a.equations->start_flags) now[at(flag)] = a.parameters[at(flag)];
    return now == a.parameters;
}

RBDYN_INLINE const Structure* RecordedModel::structure(const Mode& mode, double t, std::span<const double> x,
                                                       const Decisions& decided) const {
    const std::lock_guard lock(recordings_->mutex);
    auto& known = recordings_->structures[{kind_of(mode), decided.sliding}];
    const auto fits = [&](const Structure& s) {
        return !s.equations.numbers || s.equations.numbers->holds(given_.values);
    };
    for (const auto& one : known)
        if (one->equations.branches.empty() && fits(*one)) return own(*one);
    const auto numbers = given_.cells.empty() ? nullptr : std::make_shared<Numbers>(given_);
    Numbers* const outer = Numbers::active();
    const Numbers::Active active(numbers.get());
    auto recorded = record(mode, {t, x, decided});
    if (!recorded) return nullptr;
    recorded->equations.numbers = numbers;
    if (numbers && outer != nullptr) outer->keep(numbers);
    const auto& branches = recorded->equations.branches;
    for (const auto& one : known) {
        if (!fits(*one)) continue;
        const auto& others = one->equations.branches;
        const auto same = [](const Branch& a, const Branch& b) { return a.id == b.id && a.choice == b.choice; };
        if (std::equal(branches.begin(), branches.end(), others.begin(), others.end(), same)) return own(*one);
    }
    known.push_back(std::move(recorded));
    return known.back().get();
}

RBDYN_INLINE void RecordedModel::choose(Mode& mode, double t, std::span<const double> x, std::span<const int> flipped,
                                        bool is_new) const {
    const Equations* before = mode.equations;
    Decisions decided;
    if (before != nullptr && !is_new) {
        for (const Branch& b : before->branches) decided.forced[b.id] = b.choice;
        decided.sliding.insert(before->sliding.begin(), before->sliding.end());
    }
    std::map<std::uint64_t, int> passed;
    if (before != nullptr)
        for (const int index : flipped) {
            const Guard& guard = before->guards[at(index)];
            if (guard.branch >= 0) {
                const Branch& b = before->branches[at(guard.branch)];
                decided.forced[b.id] = b.choice + guard.step;
            }
            if (guard.sliding >= 0) {
                decided.sliding.erase(before->sliding[at(guard.sliding)]);
                decided.sides[before->sliding[at(guard.sliding)]] = guard.step;
            } else if (const auto surface = surface_of(*before, guard)) {
                passed[*surface] = side_after(*before, mode.parameters, guard);
            }
        }
    // one surface is passed by all that lies on it
    if (before != nullptr && !is_new)
        for (const Branch& b : before->branches)
            if (const auto side = passed.find(b.surface); b.is_select && side != passed.end())
                decided.forced[b.id] = side->second * b.orientation > 0 ? 1 : 0;
    const Change change{before, mode.parameters, flipped, is_new, passed};
    if (!complete(mode, t, x, change, decided)) {
        decided.sliding.clear();
        complete(mode, t, x, change, decided);
    }
    // what comes back to a surface from both sides slides along it, what is pulled off it leaves it
    std::set<std::uint64_t> refused;
    const bool everywhere = before == nullptr || is_new;
    for (int attempt = 0; attempt < 8; ++attempt) {
        Decisions next = decided;
        if (!revise(mode, t, x, everywhere ? nullptr : &passed, refused, next)) return;
        Mode after = mode;
        if (complete(after, t, x, change, next)) {
            mode = std::move(after);
            decided = std::move(next);
            continue;
        }
        for (const std::uint64_t s : next.sliding)
            if (!decided.sliding.contains(s)) refused.insert(s);
    }
}

RBDYN_INLINE bool RecordedModel::complete(Mode& mode, double t, std::span<const double> x, const Change& change,
                                          Decisions& decided) const {
    mode.equations = nullptr;
    // a choice that starts on its edge is made by the way it leaves it
    for (int attempt = 0; attempt < 8; ++attempt) {
        const Structure* s = structure(mode, t, x, decided);
        if (s == nullptr) return false;
        mode.equations = &s->equations;
        set_parameters(mode, t, x, change, decided);
        mode.still = s->still && holds(mode, t, x);
        if (s->equations.branches.empty() && s->equations.sliding.empty()) return true;
        bool changed = false;
        Evaluator<double> values(s->equations.program);
        values.set_parameters(mode.parameters);
        values(t, x);
        for (const Guard& guard : s->equations.guards) {
            if (guard.sliding >= 0 && !std::isfinite(values.output(guard.output))) return false;
            if (guard.branch < 0) continue;
            const Branch& b = s->equations.branches[at(guard.branch)];
            if (decided.forced.contains(b.id) || decided.sides.contains(b.surface)) continue;
            // what the mode before did not distinguish passes its surface too, unless it stays there
            const auto side = change.passed.find(b.surface);
            if (b.is_select && !change.is_new && side != change.passed.end()) {
                const bool is_above =
                    side->second * b.orientation > 0 && leading_sign(mode, t, x, guard.output, 1) != 0;
                decided.forced[b.id] = is_above ? 1 : 0;
                changed = changed || decided.forced[b.id] != b.choice;
                continue;
            }
            const bool is_zero =
                std::abs(values.output(guard.output)) <= 64.0 * epsilon * values.magnitude(guard.output) ||
                is_zero_at(mode, t, x, guard.output);
            if (!is_zero) continue;
            const bool leaves = leading_sign(mode, t, x, guard.output, 1) < 0;
            decided.forced[b.id] = b.choice + (leaves ? guard.step : 0);
            changed = changed || leaves;
        }
        if (!changed) return true;
    }
    return true;
}

RBDYN_INLINE bool RecordedModel::holds(const Mode& mode, double t, std::span<const double> x) {
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    for (const Guard& guard : mode.equations->guards)
        if (!guard.is_watched() && guard.output >= 0 && guard.sign_parameter < 0 &&
            values.output(guard.output) < -64.0 * epsilon * values.magnitude(guard.output))
            return false;
    return true;
}

RBDYN_INLINE std::optional<std::uint64_t> RecordedModel::surface_of(const Equations& e, const Guard& guard) {
    return guard.kind == EventKind::switching ? e.surface_of(guard) : std::nullopt;
}

RBDYN_INLINE int RecordedModel::side_after(const Equations& e, std::span<const double> parameters, const Guard& guard) {
    if (guard.branch >= 0) {
        const Branch& b = e.branches[at(guard.branch)];
        return b.choice + guard.step > 0 ? b.orientation : -b.orientation;
    }
    const Switch& s = *e.switch_of(guard);
    return parameters[at(s.parameter)] > 0.0 ? -s.orientation : s.orientation;
}

RBDYN_INLINE bool RecordedModel::revise(const Mode& mode, double t, std::span<const double> x,
                                        const std::map<std::uint64_t, int>* passed,
                                        const std::set<std::uint64_t>& refused, Decisions& decided) const {
    const Equations& e = *mode.equations;
    std::optional<Evaluator<double>> values;
    const auto evaluated = [&]() -> const Evaluator<double>& {
        if (!values) {
            values.emplace(e.program);
            values->set_parameters(mode.parameters);
            (*values)(t, x);
        }
        return *values;
    };
    const Decisions before = decided;
    for (const Guard& guard : e.guards) {
        if (guard.sliding >= 0) {
            // weights are numbers between 0 and 1
            const double weight = evaluated().output(guard.output);
            if (weight > 64.0 * epsilon) continue;
            if (weight >= -64.0 * epsilon && leading_sign(mode, t, x, guard.output, 1) >= 0) continue;
            decided.sliding.erase(e.sliding[at(guard.sliding)]);
            decided.sides[e.sliding[at(guard.sliding)]] = guard.step;
            continue;
        }
        const auto surface = surface_of(e, guard);
        if (!surface || refused.contains(*surface) || before.sides.contains(*surface)) continue;
        if (passed != nullptr ? !passed->contains(*surface) : !is_zero_at(mode, t, x, guard.output)) continue;
        const double sign = guard.sign_parameter >= 0 ? mode.parameters[at(guard.sign_parameter)] : 1.0;
        if (sign * leading_sign(mode, t, x, guard.output, 1) < 0.0) decided.sliding.insert(*surface);
    }
    return decided.sliding != before.sliding || decided.sides != before.sides;
}

RBDYN_INLINE void RecordedModel::set_parameters(Mode& mode, double t, std::span<const double> x, const Change& change,
                                                const Decisions& decided) const {
    const auto& [before, old, flipped, is_new, passed] = change;
    const Equations& e = *mode.equations;
    const Program& program = e.program;
    mode.parameters.assign(at(program.parameters()), 0.0);
    own_parameters(mode, x);
    if (e.numbers) e.numbers->set(e.number_parameters, given_.values, mode.parameters);
    if (program.switches().empty()) return;
    for (const Switch& w : program.switches()) mode.parameters[at(w.parameter)] = w.is_norm ? 0.0 : 1.0;
    // what did not switch goes on as it was, but for what an event set anew
    std::vector<bool> settled(program.switches().size(), false), goes_on = settled;
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
                goes_on[k] = !is_flipped;
                mode.parameters[at(now.parameter)] =
                    w.is_norm ? (is_flipped ? 1.0 : 0.0) : (is_flipped ? -1.0 : 1.0) * old[at(w.parameter)];
            }
        }
    }
    const auto put = [&](const auto& sides) {
        for (std::size_t k = 0; k < program.switches().size(); ++k) {
            const Switch& now = program.switches()[k];
            const auto side = sides.find(now.surface);
            if (now.is_norm || side == sides.end()) continue;
            settled[k] = true;
            goes_on[k] = false;
            mode.parameters[at(now.parameter)] = static_cast<double>(side->second * now.orientation);
        }
    };
    if (!is_new) put(passed);
    put(decided.sides);
    Evaluator<double> values(program);
    std::vector<bool> at_zero(program.switches().size(), false), leaves = at_zero;
    const auto settle = [&] {
        std::optional<AtZero> zeros;  // with the signs as they are so far
        bool is_current = false;
        for (std::size_t k = 0; k < program.switches().size(); ++k) {
            const Switch& w = program.switches()[k];
            if (w.is_norm) continue;
            if (!is_current) {
                // the argument of a switch may contain those before it
                values.set_parameters(mode.parameters);
                values(t, x);
                is_current = true;
            }
            const double value = values.switch_value(static_cast<int>(k));
            double& sign = mode.parameters[at(w.parameter)];
            // a variable may have been set by the event, and what contains another switch may have jumped with it
            const bool is_variable = program.switch_output(static_cast<int>(k)) < program.inputs();
            if (settled[k] && (!(is_variable || goes_on[k]) || value * sign >= 0.0)) continue;
            // an event's own state, taken up again, is at its zero but for rounding
            if (!zeros) zeros.emplace(mode, t, x);
            const bool is_zero = (*zeros)(program.outputs() + static_cast<int>(k));
            if (settled[k] && (!is_variable || leaves[k]) && is_zero) continue;
            at_zero[k] = is_zero;
            const double was = std::exchange(sign, value < 0.0 ? -1.0 : 1.0);
            if (sign != was) {
                zeros.reset();
                is_current = false;
            }
        }
    };
    settle();
    find_leading_powers(mode, t, x);
    // what starts at zero takes the sign of its first change, which may depend on the signs of the others
    bool is_changed = false;
    for (std::size_t k = 0; k < program.switches().size(); ++k) {
        if (!at_zero[k]) continue;
        settled[k] = true;
        goes_on[k] = false;
        const int sign = leading_sign(mode, t, x, program.outputs() + static_cast<int>(k), 1);
        double& now = mode.parameters[at(program.switches()[k].parameter)];
        leaves[k] = sign != 0;
        if (sign != 0 && std::exchange(now, sign) != sign) is_changed = true;
    }
    if (!is_changed) return;
    settle();
    find_leading_powers(mode, t, x);
}

}  // namespace rbdyn::inline RBDYN_FORM
