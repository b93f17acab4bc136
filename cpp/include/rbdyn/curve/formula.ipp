// Definitions of rbdyn/curve/formula.hpp.
#pragma once

#include "rbdyn/curve/formula.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/expression/condition.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE ProductSum product(const ProductSum& a, const ProductSum& b) {
    if (a.size() * b.size() > most_terms) return {};
    ProductSum result;
    for (const auto& [x, c] : a)
        for (const auto& [y, d] : b) {
            if (x.size() + y.size() > most_factors) return {};
            std::vector<std::int32_t> factors = x;
            factors.insert(factors.end(), y.begin(), y.end());
            std::sort(factors.begin(), factors.end());
            result[factors] += c * d;
        }
    return result;
}

RBDYN_INLINE bool is_on_line(const Function& r) {
    std::vector<ProductSum> sums;
    const auto sum = [&](std::int32_t n) -> const ProductSum& { return sums[static_cast<std::size_t>(n)]; };
    for (std::int32_t n = 0; n < r.size(); ++n) {
        const Node& node = r.node(n);
        ProductSum s;
        switch (node.operation) {
            case Operation::constant: s[{}] = node.value; break;
            case Operation::add:
                s = sum(node.a);
                for (const auto& [factors, c] : sum(node.b)) s[factors] += c;
                break;
            case Operation::multiply: s = product(sum(node.a), sum(node.b)); break;
            // beyond the nodes: their reciprocals
            case Operation::divide: s = product(sum(node.a), {{{r.size() + node.b}, 1.0}}); break;
            default: break;
        }
        if (s.size() > most_terms) s.clear();
        if (s.empty()) s[{n}] = 1.0;
        sums.push_back(std::move(s));
    }
    std::map<std::vector<std::int32_t>, Vector3> vectors;
    for (int i = 0; i < 3; ++i)
        for (const auto& [factors, c] : sum(r.output_nodes()[static_cast<std::size_t>(i)]))
            vectors.try_emplace(factors, Vector3::Zero()).first->second[i] += c;
    std::erase_if(vectors, [](const auto& entry) { return entry.first.empty() || largest(entry.second) == 0.0; });
    if (vectors.empty()) return false;
    const Vector3& along = vectors.begin()->second;
    // some roundings of each coefficient
    constexpr double parallel = 16.0 * std::numeric_limits<double>::epsilon();
    return std::all_of(vectors.begin(), vectors.end(), [&](const auto& entry) {
        return is_finite(entry.second) && sine_between(along, entry.second) <= parallel;
    });
}

RBDYN_INLINE bool is_of_angles(const Function& f) {
    std::vector<bool> is_other(static_cast<std::size_t>(f.size()), false);
    for (std::int32_t n = 0; n < f.size(); ++n) {
        const Node& node = f.node(n);
        if (node.operation == Operation::sine || node.operation == Operation::cosine) continue;
        bool is = node.operation == Operation::input;
        for (const std::int32_t operand : node.operands())
            is = is || (operand >= 0 && is_other[static_cast<std::size_t>(operand)]);
        is_other[static_cast<std::size_t>(n)] = is;
    }
    const auto& results = f.output_nodes();
    return std::none_of(results.begin(), results.end(),
                        [&](std::int32_t n) { return is_other[static_cast<std::size_t>(n)]; });
}

RBDYN_INLINE bool may_have_corners(const Function& f) {
    for (std::int32_t n = 0; n < f.size(); ++n) switch (f.node(n).operation) {
            case Operation::sign:
            case Operation::select:
            case Operation::whole:
            case Operation::norm:
            case Operation::square_root:
            case Operation::power:
            case Operation::angle: return true;
            default: break;
        }
    return false;
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
