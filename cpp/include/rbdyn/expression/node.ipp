// Definitions of rbdyn/expression/node.hpp.
#pragma once

#include "rbdyn/expression/node.hpp"

#include <array>
#include <bit>
#include <cstdint>

#include "rbdyn/basics/double_double_functions.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Expression Expression::number(std::int32_t node, const Constant& now) {
    Expression x(now.number);
    x.is_wide_ = now.is_wide;
    x.node_ = node;
    return x;
}

RBDYN_INLINE bool Node::operator==(const Node& other) const {
    const auto same = [](double x, double y) {
        return x == y || std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    };
    return operation == other.operation && a == other.a && b == other.b && c == other.c && d == other.d &&
           same(value, other.value) && same(rest, other.rest) && is_wide == other.is_wide;
}

RBDYN_INLINE std::array<std::int32_t, 3> Node::operands() const {
    switch (operation) {
        case Operation::constant:
        case Operation::input:
        case Operation::time:
        case Operation::parameter:
        case Operation::cell:
        case Operation::call: return {-1, -1, -1};
        default: return {a, b, c};
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
