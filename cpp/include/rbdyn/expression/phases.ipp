// Definitions of rbdyn/expression/phases.hpp.
#pragma once

#include "rbdyn/expression/phases.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/time_function.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace phases {

/// A phase as slope x + offset; x: the node below all sums and products with constants.
struct Line {
    std::int32_t x;
    DoubleDouble slope = 1.0, offset = 0.0;
};

inline Line line(const Function& f, std::int32_t phase) {
    Line result{phase};
    const auto constant = [&](std::int32_t n) { return f.node(n).operation == Operation::constant; };
    while (true) {
        const Node& node = f.node(result.x);
        const bool is_sum = node.operation == Operation::add;
        if ((!is_sum && node.operation != Operation::multiply) || constant(node.a) == constant(node.b)) return result;
        const Node& c = f.node(constant(node.a) ? node.a : node.b);
        const DoubleDouble value = c.is_wide ? DoubleDouble(c.value, c.rest) : DoubleDouble(c.value);
        if (is_sum)
            result.offset = result.offset + result.slope * value;
        else
            result.slope = result.slope * value;
        result.x = constant(node.a) ? node.b : node.a;
    }
}

/// Of more than this 32 digits do not tell what is left beside the whole turns to the digits of a double.
inline constexpr double most = 1e15;

}  // namespace phases

RBDYN_INLINE SmallPhases small_phases(const Function& f) {
    SmallPhases result{f};
    if (!f) return result;
    std::vector<phases::Line> lines;
    std::vector<std::int32_t> line_of(static_cast<std::size_t>(f.size()), -1);
    for (std::int32_t n = 0; n < f.size(); ++n) {
        const Node& node = f.node(n);
        if (node.operation != Operation::sine && node.operation != Operation::cosine) continue;
        phases::Line line = phases::line(f, node.a);
        const double written = std::abs(line.offset.hi);
        if (!(written > double_double::pi.hi && written <= phases::most) || line.slope.hi == 0.0) continue;
        result.ahead = std::max(result.ahead, written / std::abs(line.slope.hi));
        const DoubleDouble turn = double_double::pi * 2.0;
        line.offset = line.offset - turn * std::round((line.offset / turn).hi);
        line_of[static_cast<std::size_t>(n)] = static_cast<std::int32_t>(lines.size());
        lines.push_back(line);
    }
    if (lines.empty()) return result;
    result.function = f.rewritten([&](std::int32_t n, const std::vector<Expression>& y) -> std::optional<Expression> {
        const std::int32_t index = line_of[static_cast<std::size_t>(n)];
        if (index < 0) return std::nullopt;
        const phases::Line& line = lines[static_cast<std::size_t>(index)];
        const Expression slope = line.slope.lo == 0.0 ? Expression(line.slope.hi) : Expression(line.slope);
        const Expression phase = slope * y[static_cast<std::size_t>(line.x)] + Expression(line.offset);
        return f.node(n).operation == Operation::sine ? sin(phase) : cos(phase);
    });
    return result;
}

RBDYN_INLINE TimeFunction with_small_phases(const TimeFunction& f) {
    const SmallPhases small = small_phases(f.function());
    return small.ahead > 0.0 ? TimeFunction(small.function) : f;
}

}  // namespace rbdyn::inline RBDYN_FORM
