// Definitions of rbdyn/expression/elementary.hpp.
#pragma once

#include "rbdyn/expression/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Expression sqrt(const Expression& x) {
    using std::sqrt;
    return recording::unary(x, Operation::square_root, [](const auto& v) { return sqrt(v); });
}

RBDYN_INLINE Expression sin(const Expression& x) {
    using std::sin;
    return recording::unary(x, Operation::sine, [](const auto& v) { return sin(v); });
}

RBDYN_INLINE Expression cos(const Expression& x) {
    using std::cos;
    return recording::unary(x, Operation::cosine, [](const auto& v) { return cos(v); });
}

RBDYN_INLINE Expression sinh(const Expression& x) {
    using std::sinh;
    return recording::unary(x, Operation::hyperbolic_sine, [](const auto& v) { return sinh(v); });
}

RBDYN_INLINE Expression cosh(const Expression& x) {
    using std::cosh;
    return recording::unary(x, Operation::hyperbolic_cosine, [](const auto& v) { return cosh(v); });
}

RBDYN_INLINE Expression tanh(const Expression& x) {
    using std::tanh;
    return recording::unary(x, Operation::hyperbolic_tangent, [](const auto& v) { return tanh(v); });
}

RBDYN_INLINE Expression exp(const Expression& x) {
    using std::exp;
    return recording::unary(x, Operation::exponential, [](const auto& v) { return exp(v); });
}

RBDYN_INLINE Expression log(const Expression& x) {
    using std::log;
    return recording::unary(x, Operation::logarithm, [](const auto& v) { return log(v); });
}

RBDYN_INLINE Expression expm1(const Expression& x) {
    using std::expm1;
    return recording::unary(x, Operation::expm1, [](const auto& v) { return expm1(v); });
}

RBDYN_INLINE Expression log1p(const Expression& x) {
    using std::log1p;
    return recording::unary(x, Operation::log1p, [](const auto& v) { return log1p(v); });
}

RBDYN_INLINE Expression pow(const Expression& x, double n) {
    if (x.is_number()) return Numbers::active()->power(x, n);
    if (x.is_constant())
        return recording::folded(x, [n](const auto& v) {
            using std::pow;
            return pow(v, n);
        });
    if (n == 0.0) return 1.0;
    if (n == 0.5) return sqrt(x);
    // by products, which have series at zero too
    constexpr double most = 65536.0;
    if (n == std::floor(n) && std::abs(n) <= most) {
        Expression result = 1.0, base = x;
        for (int k = static_cast<int>(std::abs(n)); k > 0; k /= 2) {
            if (k % 2 == 1) result = result * base;
            if (k > 1) base = base * base;
        }
        return n < 0.0 ? 1.0 / result : result;
    }
    return x.recorder()->record(Operation::power, x.node(), -1, n);
}

RBDYN_INLINE Expression pow(const Expression& x, const Expression& n) {
    if (n.is_constant()) return pow(x, n.value());
    Recorder* r = recording::common(x, n);
    return r->record(Operation::raise, r->node_of(x), r->node_of(n));
}

RBDYN_INLINE Expression locked_sign(const Expression& x, const std::string& name) {
    return x.is_constant() ? Expression(x.is_negative() ? -1.0 : 1.0) : x.recorder()->sign(x, name);
}

RBDYN_INLINE Expression length(const Vector3Of<Expression>& v, const std::string& name, int tag) {
    for (int i = 0; i < 3; ++i)
        if (!v[i].is_constant()) return v[i].recorder()->norm(v[0], v[1], v[2], name, tag);
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

RBDYN_INLINE DoubleDouble length(const Vector3Of<DoubleDouble>& v, const std::string&, int) {
    return sqrt(dot<DoubleDouble>(v, v));
}

RBDYN_INLINE long double length(const Vector3Of<long double>& v, const std::string&, int) {
    return std::sqrt(dot(v, v));
}

RBDYN_INLINE long whole(double x, long lowest, long highest) {
    return x > static_cast<double>(lowest) ? static_cast<long>(std::min(std::floor(x), static_cast<double>(highest)))
                                           : lowest;
}

RBDYN_INLINE long whole(const Expression& x, long lowest, long highest, const std::string& name) {
    return x.is_constant() ? whole(x.value(), lowest, highest) : x.recorder()->whole(x, lowest, highest, name);
}

RBDYN_INLINE Expression floor(const Expression& x) {
    if (x.is_constant()) return std::floor(x.value());
    Recorder* r = x.recorder();
    if (r->purpose() == Recorder::Purpose::model)
        return static_cast<double>(r->whole(x, most_negative_whole, most_positive_whole, "floor"));
    return r->record({Operation::whole, x.node(), -1, -1, r->name_index("floor")});
}

RBDYN_INLINE Expression atan2(const Expression& y, const Expression& x) {
    if (x.is_constant() && y.is_constant()) return recording::angle(y, x);
    // on the left the cut is near: the angle from the upright or downright direction
    return select(
        x, [&] { return recording::angle(y, x); },
        [&] {
            constexpr double half_pi = 1.5707963267948966;
            const Expression s = locked_sign(y, "arctan2");
            return s * half_pi + recording::angle(-(s * x), s * y);
        },
        {});
}

RBDYN_INLINE Expression asin(const Expression& x) {
    if (x.is_constant())
        return recording::folded(x, [](const auto& v) {
            using std::asin;
            return asin(v);
        });
    return x.recorder()->record(Operation::angle, x.node(), x.recorder()->node_of(sqrt((1.0 - x) * (1.0 + x))));
}

RBDYN_INLINE Expression acos(const Expression& x) {
    if (x.is_constant())
        return recording::folded(x, [](const auto& v) {
            using std::acos;
            return acos(v);
        });
    const Expression across = sqrt((1.0 - x) * (1.0 + x));
    return x.recorder()->record(Operation::angle, x.recorder()->node_of(across), x.node());
}

RBDYN_INLINE Expression asinh(const Expression& x) {
    using std::asinh;
    return recording::unary(x, Operation::arsinh, [](const auto& v) { return asinh(v); });
}

RBDYN_INLINE Expression atanh(const Expression& x) {
    using std::atanh;
    return recording::unary(x, Operation::artanh, [](const auto& v) { return atanh(v); });
}

RBDYN_INLINE Expression cbrt(const Expression& x) {
    const Expression s = locked_sign(x, "cbrt");
    return s * pow(s * x, 1.0 / 3.0);
}

}  // namespace rbdyn::inline RBDYN_FORM
