// Derivatives of recorded operations, by the rules of calculus.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace recording {

/// The derivative of what a node is, v, from those of its operands x. Zero for what is constant between switches.
Expression derivative(const Node& node, const Expression& v, const std::array<Expression, 3>& x,
                      const std::array<Expression, 3>& dx);

/// The derivatives of expressions y in the direction in which the leaves they depend on (state variables, time,
/// parameters) have the derivatives that `leaf(node)` gives; none if they depend on a changing argument of a function
/// that is called back.
template <class Leaf>
std::optional<std::vector<Expression>> derivatives(Recorder& r, std::span<const Expression> y, Leaf&& leaf) {
    const auto at = [](std::int32_t n) { return static_cast<std::size_t>(n); };
    const std::int32_t size = r.size();
    std::vector<bool> needed(at(size), false);
    for (const Expression& out : y)
        if (!out.is_constant()) needed[at(out.node())] = true;
    const auto arguments = [&](const Node& node) -> std::span<const std::int32_t> {
        return r.calls()[at(node.a)].arguments;
    };
    for (std::int32_t n = size - 1; n >= 0; --n) {
        if (!needed[at(n)]) continue;
        for (const std::int32_t operand : r.node(n).operands())
            if (operand >= 0) needed[at(operand)] = true;
        if (r.node(n).operation == Operation::call)
            for (const std::int32_t argument : arguments(r.node(n))) needed[at(argument)] = true;
    }
    std::vector<Expression> d(at(size), Expression(0.0));
    const auto value = [&](std::int32_t n) {
        return r.node(n).operation == Operation::constant ? r.node(n).constant() : Expression(&r, n);
    };
    for (std::int32_t n = 0; n < size; ++n) {
        if (!needed[at(n)]) continue;
        const Node node = r.node(n);
        switch (node.operation) {
            case Operation::input:
            case Operation::time:
            case Operation::parameter: d[at(n)] = leaf(node); continue;
            case Operation::call:
                for (const std::int32_t argument : arguments(node))
                    if (!d[at(argument)].is_zero()) return std::nullopt;
                continue;
            default: break;
        }
        std::array<Expression, 3> operands, slopes;
        bool varies = false;
        for (std::size_t i = 0; i < 3; ++i)
            if (const std::int32_t operand = node.operands()[i]; operand >= 0) {
                operands[i] = value(operand);
                slopes[i] = d[at(operand)];
                varies = varies || !slopes[i].is_zero();
            }
        if (varies) d[at(n)] = derivative(node, value(n), operands, slopes);
    }
    std::vector<Expression> result;
    for (const Expression& out : y) result.push_back(out.is_constant() ? Expression(0.0) : d[at(out.node())]);
    return result;
}

}  // namespace recording

}  // namespace rbdyn::inline RBDYN_FORM
