// Definitions of rbdyn/model/sliding.hpp.
#pragma once

#include "rbdyn/model/sliding.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM::sliding {

RBDYN_INLINE std::optional<int> only_variable(const Recorder& r, std::int32_t node) {
    std::vector<std::int32_t> todo{node};
    std::set<std::int32_t> seen;
    std::optional<int> variable;
    while (!todo.empty()) {
        const std::int32_t n = todo.back();
        todo.pop_back();
        if (!seen.insert(n).second) continue;
        const Node& now = r.node(n);
        if (now.operation == Operation::time || now.operation == Operation::call) return std::nullopt;
        if (now.operation == Operation::input) {
            if (variable) return std::nullopt;
            variable = now.a;
        }
        for (const std::int32_t operand : now.operands())
            if (operand >= 0) todo.push_back(operand);
    }
    return variable;
}

RBDYN_INLINE std::optional<std::vector<Expression>> solved(std::vector<std::vector<Expression>> m,
                                                           std::vector<Expression> b) {
    const std::size_t n = b.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        while (pivot < n && m[pivot][k].is_zero()) ++pivot;
        if (pivot == n) return std::nullopt;
        std::swap(m[k], m[pivot]);
        std::swap(b[k], b[pivot]);
        for (std::size_t i = k + 1; i < n; ++i) {
            if (m[i][k].is_zero()) continue;
            const Expression factor = m[i][k] / m[k][k];
            for (std::size_t j = k + 1; j < n; ++j) m[i][j] -= factor * m[k][j];
            b[i] -= factor * b[k];
        }
    }
    for (std::size_t k = n; k-- > 0;) {
        for (std::size_t j = k + 1; j < n; ++j) b[k] -= m[k][j] * b[j];
        b[k] = b[k] / m[k][k];
    }
    return b;
}

}  // namespace rbdyn::inline RBDYN_FORM::sliding
