// Definitions of rbdyn/special/special_writer.hpp.
#pragma once

#include "rbdyn/special/special_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/model/sliding.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/watch_role.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/bead_law.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/projection.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SpecialWriter::SpecialWriter(Recorder& r, const SingleLaws& laws, const StateMap& map,
                                          const std::vector<signed char>& slip)
    : r_(r), laws_(laws), map_(map), slip_(slip), count_(laws.size()) {
    const recording::WideFolding all_digits;
    const int n = laws.positions();
    if (laws.takes_numbers()) r.parameter(2 * count_ - 1);
    const auto constant_start = [&](int i) {
        const DoubleDouble x = map.exact_start(i);
        return x.lo == 0.0 ? S(x.hi) : S(x);
    };
    const auto variable = [&](int i) { return map.is_simulated(i) ? r.input(map.place(i)) : constant_start(i); };
    q_.resize(at(n));
    v_.resize(at(laws.variables() - n));
    for (const auto& law : laws.bodies()) {
        // a bead that sticks to a rail at rest does not move: its coordinate is a parameter
        const bool is_held = law->is_held(slip[at(law->index)]);
        for (int k = 0; k < law->positions(); ++k)
            q_[at(law->first + k)] = is_held && k == 0 ? r.parameter(count_ + law->index) : variable(law->first + k);
        for (int k = 0; k < law->velocities(); ++k)
            v_[at(law->first_rate - n + k)] = is_held && k == 0 ? S(0.0) : variable(law->first_rate + k);
        // the spin of a body whose frame follows its axis does not change
        if (law->fixed_velocity() >= 0 && map.is_simulated(law->fixed_variable()))
            v_[at(law->fixed_variable() - n)] = r.parameter(count_ + law->index);
    }
}

RBDYN_INLINE const std::vector<SpecialWriter::S>& SpecialWriter::lay_down() {
    const recording::WideFolding all_digits;
    const S t = r_.time();
    const int n = laws_.positions();
    rates_.assign(at(laws_.variables()), S(0.0));
    states_.clear();
    present_.clear();
    for (const auto& law : laws_.bodies()) {
        const int i = law->index;
        r_.set_subject(i);
        law->add_state(states_, t, &q_[at(law->first)], &v_[at(law->first_rate - n)], slip_[at(i)]);
        RecordedBody& present = present_.emplace_back();
        present.state = &states_[at(i)];
        present.q = &q_[at(law->first)];
        present.rates = &rates_[at(law->first_rate)];
        present.phase = slip_[at(i)];
        present.recorder = &r_;
    }
    const CouplingForces<S> couplings(laws_, t, states_);
    for (const auto& law : laws_.bodies()) {
        r_.set_subject(law->index);
        law->lay_down(present_[at(law->index)], couplings, &rates_[at(law->first)], &rates_[at(law->first_rate)]);
    }
    r_.set_subject(-1);
    return rates_;
}

RBDYN_INLINE std::vector<SpecialWriter::S> SpecialWriter::switched() {
    lay_down();
    std::vector<S> values(at(map_.size()));
    bool is_broken = false;
    for (int i = 0; i < map_.variables(); ++i) {
        const S& rate = rates_[at(i)];
        if (map_.is_simulated(i))
            values[at(map_.place(i))] = rate;
        else if (rate.is_constant() && !std::isfinite(rate.value()) && map_.size() > 0)
            is_broken = true;
        else if (!rate.is_zero())
            throw Error("a variable that was left out of the state does not stay as it starts");
    }
    // a force that is not a number moves what it does not belong to: there is no motion
    if (is_broken) std::fill(values.begin(), values.end(), S(std::numeric_limits<double>::quiet_NaN()));
    const auto put = [&](const Vector3Of<S>& v) { values.insert(values.end(), {v[0], v[1], v[2]}); };
    for (const RecordedBody& b : present_) {
        put(b.force);
        values.push_back(b.along);
        put(b.moment);
    }
    distinguishes_ = recording::distinguishes(r_);
    if (!distinguishes_) return values;
    const CouplingForces<S> couplings(laws_, r_.time(), states_);
    for (int k = 0; k < static_cast<int>(laws_.couplings().size()); ++k)
        put(laws_.coupling(k).present() ? couplings[k] : Vector3Of<S>(S(0.0), S(0.0), S(0.0)));
    const std::size_t first = values.size();
    values.resize(first + at(laws_.loads()), S(0.0));
    for (const auto& law : laws_.bodies())
        law->powers(present_[at(law->index)], r_.time(), std::span(values).subspan(first));
    return values;
}

RBDYN_INLINE void SpecialWriter::take(std::span<const S> values) {
    for (int i = 0; i < map_.variables(); ++i)
        if (map_.is_simulated(i)) rates_[at(i)] = values[at(map_.place(i))];
    std::size_t next = at(map_.size());
    const auto vector = [&] {
        next += 3;
        return Vector3Of<S>(values[next - 3], values[next - 2], values[next - 1]);
    };
    for (RecordedBody& b : present_) {
        b.force = vector();
        b.along = values[next++];
        b.moment = vector();
    }
}

RBDYN_INLINE void SpecialWriter::guard(EquationsWriter& write) const {
    for (const auto& law : laws_.bodies()) law->guard(write, present_[at(law->index)], r_.time());
}

RBDYN_INLINE SpecialWriter::S SpecialWriter::observed(const Observable& o) const {
    switch (o.quantity) {
        case Quantity::time: return r_.time();
        case Quantity::length: {
            const PairState<S> ends = laws_.ends<S>(laws_.coupling(o.subject), r_.time(), states_);
            return length(Vector3Of<S>(ends.ra - ends.rb), std::string());
        }
        case Quantity::coupling_force: {
            const SingleLaws::Connected& c = laws_.coupling(o.subject);
            if (!c.present()) return 0.0;
            return laws_.view().to_world<S>(laws_.coupling_force<S>(c, r_.time(), states_))[o.component];
        }
        default: return laws_.body(o.subject).observed(present_[at(o.subject)], o);
    }
}

RBDYN_INLINE void SpecialWriter::watch(EquationsWriter& write, const std::vector<Scene::Watch>& watches) const {
    for (std::size_t k = 0; k < watches.size(); ++k) {
        const Scene::Watch& w = watches[k];
        Guard g{.kind = EventKind::watch,
                .role = role_of(w.options.action.kind),
                .direction = w.options.direction,
                .name = w.name,
                .watch = static_cast<int>(k)};
        if (!w.function.is_recorded()) {
            // nobody knows what it depends on
            write.outside(std::move(g));
            continue;
        }
        std::vector<S> x;
        for (const Observable& o : w.function.arguments()) x.push_back(observed(o));
        write.watch(g, w.function.function(), x);
    }
}

RBDYN_INLINE std::vector<SpecialWriter::S> SpecialWriter::drives() const {
    std::vector<S> result;
    const auto changes = [&](int i) { return laws_.bead(i).rough() && !laws_.bead(i).drive().is_constant(); };
    if (std::none_of(laws_.beads().begin(), laws_.beads().end(), changes)) return result;
    result.resize(at(count_), S(0.0));
    for (const int i : laws_.beads())
        if (laws_.bead(i).rough()) result[at(i)] = laws_.bead(i).drive()(r_.time());
    return result;
}

RBDYN_INLINE std::vector<SpecialWriter::S> SpecialWriter::pulls() const {
    std::vector<S> result;
    for (const int i : laws_.beads()) {
        if (!laws_.bead(i).sticks_in(slip_[at(i)])) continue;
        result.resize(at(count_), S(0.0));
        result[at(i)] = laws_.bead(i).pull(present_[at(i)]);
    }
    return result;
}

RBDYN_INLINE std::vector<VariableGroup> groups_of(const SingleLaws& laws) {
    const StateMap& map = laws.map();
    std::vector<VariableGroup> groups;
    const auto add = [&](const VariableGroup& g) {
        VariableGroup simulated = g;
        simulated.count = 0;
        for (int i = g.first; i < g.first + g.count; ++i) {
            if (!map.is_simulated(i))
                simulated.steady = std::max(simulated.steady, std::abs(map.start(i)));
            else if (simulated.count++ == 0)
                simulated.first = map.place(i);
        }
        if (simulated.count > 0) groups.push_back(simulated);
    };
    for (const bool is_position : {true, false})
        for (const auto& law : laws.bodies()) {
            const int first = is_position ? law->first : law->first_rate;
            for (VariableGroup g : law->groups(is_position)) {
                g.first += first;
                add(g);
            }
        }
    return groups;
}

RBDYN_INLINE std::unique_ptr<Structure> record_special(const std::shared_ptr<const SingleLaws>& of,
                                                       const std::vector<Scene::Watch>& watches,
                                                       const std::vector<signed char>& slip,
                                                       const RecordedFor& at_state) {
    const recording::WideFolding all_digits;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    Recorder r;
    const SingleLaws& laws = *of;
    const int count = laws.size();
    const StateMap& map = laws.map();
    std::vector<double> parameters;
    if (laws.takes_numbers()) parameters.resize(at(2 * count));
    for (int i = 0; i < count && laws.takes_numbers(); ++i) {
        parameters[at(i)] = slip[at(i)];
        parameters[at(count + i)] = map.value(laws.body(i).fixed_variable(), at_state.x);
    }
    const Decisions& decided = at_state.decided;
    r.follow(at_state.t, at_state.x, parameters, decided.forced, decided.sides);
    int drives = -1, pulls = -1;
    SpecialWriter points(r, laws, map, slip);
    auto result = written(
        r, map.size(), decided.sliding, [&] { return points.switched(); },
        [&](EquationsWriter& write, std::span<const Expression> values) {
            points.take(values);
            for (int i = 0; i < map.size(); ++i) write.rate(i) = values[at(i)];
            points.guard(write);
            points.watch(write, watches);
            const auto put = [&](int& first, const std::vector<Expression>& all) {
                for (const Expression& value : all) {
                    const int output = write.output(value);
                    if (first < 0) first = output;
                }
            };
            put(drives, points.drives());
            put(pulls, points.pulls());
            if (points.distinguishes()) write.acting(values.subspan(at(map.size())));
            return groups_of(laws);
        });
    if (!result) return result;
    result->equations.drives = drives;
    result->equations.pulls = pulls;
    std::vector<int> held;
    for (int i = 0; i < count; ++i)
        if (laws.body(i).is_conservative() && laws.body(i).turns(map)) held.push_back(i);
    if (!held.empty())
        result->equations.projection = [of, held](std::span<const double> state, std::span<const double> rest) {
            std::vector<double> x(static_cast<std::size_t>(of->variables())), low(x.size());
            of->map().spread(state, x);
            of->map().spread_zero(rest, low);
            std::vector<std::unique_ptr<const Projection>> parts;
            for (const int i : held) parts.push_back(of->body(i).projection(x, low));
            return std::make_unique<const Projections>(of->map(), std::move(parts));
        };
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
