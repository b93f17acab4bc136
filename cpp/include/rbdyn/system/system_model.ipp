// Definitions of rbdyn/system/system_model.hpp.
#pragma once

#include "rbdyn/system/system_model.hpp"

#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/recording.hpp"
#include "rbdyn/model/observed.hpp"
#include "rbdyn/model/sliding.hpp"
#include "rbdyn/model/watch_role.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A function of a system at a moment.
RBDYN_INLINE std::vector<double> value_of(const OwnFunction& f, double t, std::span<const double> x) {
    std::vector<double> moment{t};
    moment.insert(moment.end(), x.begin(), x.end());
    return f(std::span<const double>(moment));
}

RBDYN_INLINE SystemModel::SystemModel(System system) : VariablesModel(system.numbers()), system_(std::move(system)) {}

RBDYN_INLINE Mode SystemModel::begin(double t, std::span<double> x) const {
    Mode mode;
    choose(mode, t, x, {});
    return mode;
}

RBDYN_INLINE Mode SystemModel::next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                                    std::vector<Happening>& happenings) const {
    Mode after = mode;
    std::vector<int> flipped;
    bool is_new = false;
    // changes of the user's own come first
    for (const int index : fired) {
        const Guard& guard = mode.equations->guards[static_cast<std::size_t>(index)];
        if (guard.kind != EventKind::watch) continue;
        happenings.push_back({EventKind::watch, -1, guard.direction, guard.name});
        change(system_.watches()[static_cast<std::size_t>(guard.watch)], t, x);
        is_new = true;
        ++after.jumps;
    }
    for (const int index : fired) {
        // the user's change may have set what switches
        if (mode.equations->guards[static_cast<std::size_t>(index)].kind != EventKind::watch)
            flip(mode, index, !is_new, x, flipped, happenings);
    }
    choose(after, t, x, flipped, is_new);
    if (!is_new && same_motion(mode, after, flipped)) happenings.clear();
    return after;
}

RBDYN_INLINE void SystemModel::change(const System::Watch& watch, double t, std::span<double> x) const {
    const std::vector<double> changed = watch.options.action.change(t, x);
    const std::string user = "watch \"" + watch.name + "\"";
    require(changed.size() == x.size(), user, "count of numbers its action returns",
            static_cast<double>(changed.size()), "the state has " + std::to_string(x.size()) + " variables");
    for (std::size_t i = 0; i < x.size(); ++i) {
        require(std::isfinite(changed[i]), user, system_.name(static_cast<int>(i)) + " after its action", changed[i],
                "a state is finite");
        x[i] = changed[i];
    }
}

RBDYN_INLINE void SystemModel::observe(const Mode& mode, double t, std::span<const double> x,
                                       std::vector<Observed>& observed) const {
    HybridModel::observe(mode, t, x, observed);
    for (Observed& o : observed) o.alike = whole;
}

RBDYN_INLINE double SystemModel::guard_value(const Guard& guard, const Mode& /*mode*/, double t,
                                             std::span<const double> x) const {
    return value_of(system_.watches()[static_cast<std::size_t>(guard.watch)].function, t, x)[0];
}

RBDYN_INLINE std::vector<double> SystemModel::rate(const Mode& mode, double t, std::span<const double> x) const {
    return mode.equations == nullptr ? value_of(system_.function(), t, x) : VariablesModel::rate(mode, t, x);
}

RBDYN_INLINE std::string SystemModel::variable_name(int variable) const { return system_.name(variable); }

RBDYN_INLINE std::unique_ptr<Structure> SystemModel::record(const Mode&, const RecordedFor& state) const {
    const recording::WideFolding all_digits;
    Recorder r;
    r.follow(state.t, state.x, {}, state.decided.forced, state.decided.sides);
    const recording::Active active(r);
    const int n = variables();
    std::vector<Expression> inputs{r.time()};
    for (int i = 0; i < n; ++i) inputs.push_back(r.input(i));
    const std::span<const Expression> now(inputs);
    return written(
        r, n, state.decided.sliding, [&] { return system_.function()(now); },
        [&](EquationsWriter& write, std::span<const Expression> rates) {
            for (int i = 0; i < n; ++i) write.rate(i) = rates[static_cast<std::size_t>(i)];
            for (std::size_t k = 0; k < system_.watches().size(); ++k) {
                const System::Watch& w = system_.watches()[k];
                Guard g{.kind = EventKind::watch,
                        .role = role_of(w.options.action.kind),
                        .direction = w.options.direction,
                        .name = w.name,
                        .watch = static_cast<int>(k)};
                // nobody knows what a function that is called back depends on
                if (w.function.callback())
                    write.outside(std::move(g));
                else
                    write.watch(g, w.function.function(), now);
            }
            std::vector<VariableGroup> groups;
            for (int i = 0; i < n; ++i) groups.push_back({i, 1, false, 0.0, whole});
            return groups;
        });
}

}  // namespace rbdyn::inline RBDYN_FORM
