// Definitions of rbdyn/model/what_stays.hpp.
#pragma once

#include "rbdyn/model/what_stays.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/point_equations.hpp"
#include "rbdyn/model/point_laws.hpp"
#include "rbdyn/model/state_map.hpp"

namespace rbdyn::inline RBDYN_FORM::staying {

RBDYN_INLINE void follow(const Recorder& r, const std::vector<Expression>& rates, std::vector<bool>& stays) {
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
        Interruption::point();
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

}  // namespace rbdyn::inline RBDYN_FORM::staying

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Staying what_stays(const PointLaws& laws) {
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

}  // namespace rbdyn::inline RBDYN_FORM
