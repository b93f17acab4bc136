// What stays as it starts: the variables of a scene that need not be simulated.
//
// The largest set of variables whose rates are zero, exactly and at every time, while they are what they start with:
// all are taken for constants, those whose rates are not zero are variables after all, and so on until none is left to
// leave. That is done by recording with constants, for this is what the equations are made of; where it takes long,
// most of the way is gone on one record of the rates, where a node is known if its operands are, or if one factor is
// known to be zero. A particle loses what is across the plane of its start and its loads, a body without moment and
// spin its rotation, one at rest in balance all it has.
//
// Recorded as a function, so that both sides of every case distinction count. Beads that may stick or leave their rails
// are simulated whole: in flight they may be anywhere, and that covers the rail.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/model/point_equations.hpp"

namespace rbdyn {

namespace staying {

// scenes of a few bodies are through with less, at half the cost of the other way
inline constexpr int most_passes = 3;

/// Takes from `stays` the variables whose recorded rates, all variables being inputs, are not known to be zero.
inline void follow(const Recorder& r, const std::vector<Expression>& rates, std::vector<bool>& stays) {
    const auto at = [](std::int32_t i) { return static_cast<std::size_t>(i); };
    std::vector<bool> known(at(r.size()));
    const auto is_zero = [&](std::int32_t node) { return known[at(node)] && r.value(node) == 0.0; };
    const auto is_known = [&](const Node& n) {
        switch (n.operation) {
            case Operation::constant: return true;
            case Operation::input: return static_cast<bool>(stays[at(n.a)]);
            case Operation::time:
            case Operation::parameter:
            case Operation::cell:
            case Operation::call: return false;
            case Operation::multiply:
                if (is_zero(n.a) || is_zero(n.b)) return true;
                break;
            case Operation::divide:
                if (is_zero(n.a)) return true;
                break;
            default: break;
        }
        for (const std::int32_t operand : n.operands())
            if (operand >= 0 && !known[at(operand)]) return false;
        return true;
    };
    for (bool has_changed = true; has_changed;) {
        has_changed = false;
        for (std::int32_t n = 0; n < r.size(); ++n) known[at(n)] = is_known(r.node(n));
        for (std::size_t i = 0; i < rates.size(); ++i) {
            const Expression& rate = rates[i];
            if (!stays[i] || rate.is_zero() || (!rate.is_constant() && is_zero(rate.node()))) continue;
            stays[i] = false;
            has_changed = true;
        }
    }
}

}  // namespace staying

/// Which variables stay as they start, as long as no action of the user's changes them; and why that cannot be told, if
/// so.
struct Staying {
    std::vector<bool> variables;
    std::string unknown = {};
};

[[gnu::cold]] inline Staying what_stays(const PointLaws& laws) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<bool> stays(at(laws.variables()), true);
    std::vector<signed char> slip;
    for (const PointLaws::Body& b : laws.bodies()) {
        slip.push_back(b.may_fly ? flies : 1);
        // a velocity that is no double is held to more digits in the state: what it is short of grows with time
        for (int k = 0; b.rigid && k < b.velocities(); ++k)
            if (b.start_velocities[k].lo != 0.0) stays[at(b.first_rate + k)] = false;
        if (!b.rough && !b.may_fly) continue;
        for (int k = 0; k < b.positions(); ++k) stays[at(b.first + k)] = stays[at(b.first_rate + k)] = false;
    }
    const std::vector<double> start = laws.start(), rest = laws.start_rest();
    const auto rates_with = [&](Recorder& r, const std::vector<bool>& constant) {
        const StateMap map(start, constant, rest);
        std::vector<double> x(at(map.size()));
        map.gather(start, x);
        r.follow(0.0, x, {});
        return PointsWriter(r, laws, map, slip).lay_down();
    };
    const auto any_stays = [&] { return std::find(stays.begin(), stays.end(), true) != stays.end(); };
    bool has_changed = true;
    for (int pass = 0; has_changed && any_stays(); ++pass) {
        has_changed = false;
        // a motion that comes along a chain of bodies would take a pass for each
        if (pass == staying::most_passes) {
            Recorder r(Recorder::Purpose::function);
            const std::vector<Expression> rates = rates_with(r, std::vector<bool>(stays.size(), false));
            staying::follow(r, rates, stays);
            if (!any_stays()) break;
        }
        Recorder r(Recorder::Purpose::function);
        const std::vector<Expression> rates = rates_with(r, stays);
        if (!r.branches().empty())
            return {std::vector<bool>(stays.size(), false), "a curve in pieces shows only the one its bead is on"};
        for (int i = 0; i < laws.variables(); ++i) {
            if (!stays[at(i)] || rates[at(i)].is_zero()) continue;
            stays[at(i)] = false;
            has_changed = true;
        }
    }
    return {std::move(stays)};
}

}  // namespace rbdyn
