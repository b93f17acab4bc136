// Definitions of rbdyn/expression/derivative.hpp.
#pragma once

#include "rbdyn/expression/derivative.hpp"

#include <array>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"

namespace rbdyn::inline RBDYN_FORM::recording {

RBDYN_INLINE Expression derivative(const Node& node, const Expression& v, const std::array<Expression, 3>& x,
                                   const std::array<Expression, 3>& dx) {
    const auto& [a, b, c] = x;
    const auto& [da, db, dc] = dx;
    switch (node.operation) {
        case Operation::add: return da + db;
        case Operation::multiply: return da * b + a * db;
        case Operation::divide: return (da - v * db) / b;
        case Operation::square_root: return da / (2.0 * v);
        case Operation::norm: {
            const Expression along = dot(Vector3Of<Expression>{a, b, c}, Vector3Of<Expression>{da, db, dc});
            return along.is_zero() ? along : along / v;
        }
        case Operation::sine: return cos(a) * da;
        case Operation::cosine: return -(sin(a) * da);
        case Operation::hyperbolic_sine: return cosh(a) * da;
        case Operation::hyperbolic_cosine: return sinh(a) * da;
        case Operation::hyperbolic_tangent: return (1.0 - v * v) * da;
        case Operation::exponential: return v * da;
        case Operation::logarithm: return da / a;
        case Operation::expm1: return exp(a) * da;
        case Operation::log1p: return da / (1.0 + a);
        case Operation::arsinh: return da / sqrt(1.0 + a * a);
        case Operation::artanh: return da / ((1.0 - a) * (1.0 + a));
        case Operation::raise: return (da.is_zero() ? da : b * pow(a, b - 1.0) * da) + v * log(a) * db;
        case Operation::power: return node.value * pow(a, node.value - 1.0) * da;
        case Operation::angle: {
            const Expression turn = b * da - a * db;
            return turn.is_zero() ? turn : turn / (a * a + b * b);
        }
        default: return 0.0;
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::recording
