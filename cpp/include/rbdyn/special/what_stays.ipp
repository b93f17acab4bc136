// Definitions of rbdyn/special/what_stays.hpp.
#pragma once

#include "rbdyn/special/what_stays.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/special_writer.hpp"

namespace rbdyn::inline RBDYN_FORM::staying {

RBDYN_INLINE void follow(const Recorder& r, const std::vector<Expression>& rates, std::vector<bool>& stays) {
    const auto at = [](std::int32_t i) { return static_cast<std::size_t>(i); };
    std::vector<bool> known(at(r.size()), true);
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
    // what is made of each node, one list after the other; of an input it stands for, and of a rate it is
    std::vector<std::int32_t> first(at(r.size()) + 1, 0), users;
    const auto each_operand = [&](auto&& take) {
        for (std::int32_t n = 0; n < r.size(); ++n)
            for (const std::int32_t operand : r.node(n).operands())
                if (operand >= 0) take(operand, n);
    };
    each_operand([&](std::int32_t operand, std::int32_t) { ++first[at(operand) + 1]; });
    for (std::int32_t n = 0; n < r.size(); ++n) first[at(n) + 1] += first[at(n)];
    users.resize(at(first.back()));
    std::vector<std::int32_t> next = first;
    each_operand([&](std::int32_t operand, std::int32_t user) { users[at(next[at(operand)]++)] = user; });
    std::vector<std::vector<std::size_t>> rates_of(at(r.size()));
    std::vector<std::vector<std::int32_t>> inputs_of(stays.size());
    for (std::size_t i = 0; i < rates.size(); ++i)
        if (!rates[i].is_constant()) rates_of[at(rates[i].node())].push_back(i);
    for (std::int32_t n = 0; n < r.size(); ++n)
        if (r.node(n).operation == Operation::input) inputs_of[at(r.node(n).a)].push_back(n);
    // each node is looked at when one of its operands has changed, so that the whole is linear in their number
    std::vector<std::int32_t> waiting;
    const auto look = [&](std::int32_t n) {
        if (!known[at(n)] || is_known(r.node(n))) return;
        known[at(n)] = false;
        waiting.push_back(n);
    };
    const auto move = [&](std::size_t i) {
        if (!stays[i]) return;
        stays[i] = false;
        for (const std::int32_t n : inputs_of[i]) look(n);
    };
    for (std::int32_t n = 0; n < r.size(); ++n) look(n);
    for (std::size_t i = 0; i < rates.size(); ++i)
        if (!rates[i].is_zero() && (rates[i].is_constant() || !is_zero(rates[i].node()))) move(i);
    while (!waiting.empty()) {
        Interruption::point();
        const std::int32_t n = waiting.back();
        waiting.pop_back();
        for (std::int32_t k = first[at(n)]; k < first[at(n) + 1]; ++k) look(users[at(k)]);
        for (const std::size_t i : rates_of[at(n)]) move(i);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::staying

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Staying what_stays(const SingleLaws& laws) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<bool> stays(at(laws.variables()), true);
    std::vector<signed char> slip;
    for (const auto& law : laws.bodies()) {
        slip.push_back(law->freest());
        law->keep_in(stays);
    }
    const std::vector<double> start = laws.start(), rest = laws.start_rest();
    const auto rates_with = [&](Recorder& r, const std::vector<bool>& constant) {
        const StateMap map(start, constant, rest);
        std::vector<double> x(at(map.size()));
        map.gather(start, x);
        r.follow(0.0, x, {});
        return SpecialWriter(r, laws, map, slip).lay_down();
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
