// Definitions of rbdyn/mechanics/tree_model.hpp: forces with friction that come to zero, and what opens.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_settling.ipp"
#include "rbdyn/model/at_zero.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<int> TreeModel::ending(const Mode& before, double t, std::span<const double> x,
                                                const Fired& fired) const {
    std::vector<int> result;
    // where joints with friction change with it, what it did before tells nothing
    if (!joints_.empty() || before.equations == nullptr) return result;
    if (fired.doubtful.empty() && fired.breaking.empty()) return result;
    Evaluator<double> values(before.equations->program);
    values.set_parameters(before.parameters);
    values(t, x);
    const auto is_zero = [&](int k) {
        const int force = force_of(before, k);
        if (force < 0) return false;
        const double mu = is_rough(k) ? static_cast<double>(conditions_->contacts()[at(k)].mu_static) : 1.0;
        return values.output(force) <= 64.0 * epsilon * std::max(1.0, 1.0 / mu) * size_of_terms(before, t, x, force);
    };
    if (shares_load(before)) {
        // one force at zero may be so by choice: then all are
        for (int k = 0; k < contacts(); ++k) {
            if (before.slip[at(k)] == flies) continue;
            if (!is_zero(k)) return {};
            result.push_back(k);
        }
        return result;
    }
    for (const int k : fired.doubtful)
        if (force_of(before, k) >= 0) result.push_back(k);
    // where no force acts along a surface that of friction ends with the normal one, and rounding says which is first;
    // where one does, nothing holds it
    const auto has_none_along = [&](int k) {
        for (const Guard& guard : before.equations->guards) {
            if (guard.contact != k || guard.joint >= 0 || guard.kind != EventKind::slip || guard.output < 0) continue;
            const double limit = static_cast<double>(conditions_->contacts()[at(k)].mu_static) *
                                 values.output(force_of(before, k)),
                         along = std::sqrt(std::max(0.0, limit * limit - values.output(guard.output)));
            return along <= 0x1p14 * epsilon * size_of_terms(before, t, x, force_of(before, k));
        }
        return true;
    };
    for (const int k : fired.breaking)
        if (std::find(result.begin(), result.end(), k) == result.end() && is_zero(k) && has_none_along(k))
            result.push_back(k);
    return result;
}

RBDYN_INLINE std::vector<int> TreeModel::press_no_more(const Mode& before, const Mode& mode, double t,
                                                       std::span<const double> x, const std::vector<int>& of,
                                                       const std::vector<int>& doubtful) const {
    const auto forces_in = [&](const Mode& m) {
        Evaluator<double> values(m.equations->program);
        values.set_parameters(m.parameters);
        values(t, x);
        std::vector<double> forces(at(contacts()), 0.0);
        for (int k = 0; k < contacts(); ++k)
            if (const int force = force_of(m, k); force >= 0) forces[at(k)] = values.output(force);
        return forces;
    };
    std::vector<int> result;
    if (doubtful.empty() || before.equations == nullptr) return result;
    const std::vector<double> were = forces_in(before), are = forces_in(mode);
    // what is left of a force where it was found to end is what its series left out: shared anew it has more
    double left = 0.0;
    for (const int k : doubtful) left = std::max(left, std::abs(were[at(k)]));
    const mechanics::TreeState state = look(mode, t, x);
    bool is_any = false;
    for (const int k : of) {
        if (are[at(k)] > 4.0 * (left + 16.0 * epsilon * forces_at(k, state)) || !ends(mode, k, t, x)) continue;
        result.push_back(k);
        is_any = is_any || std::ranges::find(doubtful, k) != doubtful.end();
    }
    if (!is_any) result.clear();
    return result;
}

RBDYN_INLINE bool TreeModel::settle_ending(const Mode& before, Mode& mode, double t, std::span<double> x,
                                           const std::vector<int>& candidates, const Fired& fired) const {
    const std::vector<int> of = ending(before, t, x, fired);
    if (of.empty()) return false;
    const auto is_in = [](const std::vector<int>& list, int k) {
        return std::find(list.begin(), list.end(), k) != list.end();
    };
    std::vector<int> opening;
    Evaluator<double> values(before.equations->program);
    values.set_parameters(before.parameters);
    values(t, x);
    // what pulls already does not go on, however its force changes
    const auto pulls_by_now = [&](int k) {
        const int force = force_of(before, k);
        return force >= 0 && values.output(force) < -64.0 * epsilon * size_of_terms(before, t, x, force);
    };
    // where nothing presses, and nothing will, rounding has said that it breaks away, and would again: it flies along
    const auto presses_nothing = [&](int k) {
        const int force = force_of(before, k);
        if (force < 0) return false;
        const mechanics::TreeState state = look(before, t, x);
        const double size = forces_at(k, state);
        double time = 0.0;
        for (const int i : {conditions_->contacts()[at(k)].a.body, conditions_->contacts()[at(k)].b.body})
            if (i >= 0 && size > 0.0)
                time = std::max(time,
                                std::sqrt(size_of(k, state.moving) * static_cast<double>(tree_->node(i).mass) / size));
        return settling::zeros(before, t, x, force, size, time) > settling::most_zeros;
    };
    for (const int k : of)
        if (pulls_by_now(k) || ends(before, k, t, x) || presses_nothing(k)) opening.push_back(k);
    Fired others = fired;
    for (auto* list : {&others.doubtful, &others.breaking}) std::erase_if(*list, [&](int k) { return is_in(of, k); });
    const Mode undecided = mode;
    if (opening.empty() && others.none()) {
        for (const int k : candidates) mode.slip[at(k)] = before.slip[at(k)];
        choose(mode, t, x, {}, true);
        return true;
    }
    std::vector<int> closed = candidates;
    std::erase_if(closed, [&](int k) { return is_in(opening, k); });
    for (const int k : opening) mode.slip[at(k)] = flies;
    settle_rough(before, mode, t, x, closed, others);
    if (mode.impossible.empty()) {
        // what others do at this instant may press it on its surface
        const auto by = coupling(moving(t, x), opening);
        const std::vector<double> w = this->opening(mode, t, x, opening).first;
        bool is_right = true;
        for (std::size_t i = 0; i < w.size(); ++i) {
            // a numerator is an acceleration itself
            const bool is_force = !mechanics::contact_state::slides(before.slip[at(opening[i])]);
            const double size = size_of_terms(before, t, x, force_of(before, opening[i]));
            is_right = is_right && w[i] >= -1e-12 * size * (is_force ? by[i][i] : std::max(1.0, by[i][i]));
        }
        if (is_right) return true;
    }
    mode = undecided;
    return false;
}

}  // namespace rbdyn::inline RBDYN_FORM
