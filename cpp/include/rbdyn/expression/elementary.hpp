// Elementary functions of expressions.
#pragma once

#include "rbdyn/expression/expression.hpp"

namespace rbdyn {

namespace recording {

template <class F>
Expression unary(const Expression& x, Operation operation, F&& f) {
    if (x.is_number()) return Numbers::active()->record(operation, x);
    return x.is_constant() ? folded(x, f) : x.recorder()->record(operation, x.node());
}

}  // namespace recording

inline Expression sqrt(const Expression& x) {
    using std::sqrt;
    return recording::unary(x, Operation::square_root, [](const auto& v) { return sqrt(v); });
}
inline Expression sin(const Expression& x) {
    using std::sin;
    return recording::unary(x, Operation::sine, [](const auto& v) { return sin(v); });
}
inline Expression cos(const Expression& x) {
    using std::cos;
    return recording::unary(x, Operation::cosine, [](const auto& v) { return cos(v); });
}
inline Expression tan(const Expression& x) { return sin(x) / cos(x); }
inline Expression sinh(const Expression& x) {
    using std::sinh;
    return recording::unary(x, Operation::hyperbolic_sine, [](const auto& v) { return sinh(v); });
}
inline Expression cosh(const Expression& x) {
    using std::cosh;
    return recording::unary(x, Operation::hyperbolic_cosine, [](const auto& v) { return cosh(v); });
}
inline Expression tanh(const Expression& x) {
    using std::tanh;
    return recording::unary(x, Operation::hyperbolic_tangent, [](const auto& v) { return tanh(v); });
}
inline Expression exp(const Expression& x) {
    using std::exp;
    return recording::unary(x, Operation::exponential, [](const auto& v) { return exp(v); });
}
inline Expression log(const Expression& x) {
    using std::log;
    return recording::unary(x, Operation::logarithm, [](const auto& v) { return log(v); });
}

/// x^n for a constant n; small whole powers become products, which have a series at zero: as many as equilibria look
/// for.
inline Expression pow(const Expression& x, double n) {
    if (x.is_number()) return Numbers::active()->power(x, n);
    if (x.is_constant())
        return recording::folded(x, [n](const auto& v) {
            using std::pow;
            return pow(v, n);
        });
    if (n == 0.0) return 1.0;
    if (n == 0.5) return sqrt(x);
    if (n == std::floor(n) && std::abs(n) <= 32.0) {
        Expression result = 1.0, base = x;
        for (int k = static_cast<int>(std::abs(n)); k > 0; k /= 2) {
            if (k % 2 == 1) result = result * base;
            if (k > 1) base = base * base;
        }
        return n < 0.0 ? 1.0 / result : result;
    }
    return x.recorder()->record(Operation::power, x.node(), -1, n);
}
inline Expression pow(const Expression& x, const Expression& n) {
    return n.is_constant() ? pow(x, n.value()) : exp(n * log(x));
}

/// The sign of x, locked during smooth motion; its zeros are switching points of the recorded function.
inline Expression locked_sign(const Expression& x, const std::string& name = "sign") {
    return x.is_constant() ? Expression(x.is_negative() ? -1.0 : 1.0) : x.recorder()->sign(x, name);
}
inline double locked_sign(double x, const std::string& = {}) { return x < 0.0 ? -1.0 : 1.0; }
inline DoubleDouble locked_sign(const DoubleDouble& x, const std::string& = {}) { return x.hi < 0.0 ? -1.0 : 1.0; }

inline Expression abs(const Expression& x) { return locked_sign(x, "abs") * x; }

/// The length of a vector; for expressions, its zeros are switching points of the recorded function.
inline Expression length(const Vector3Of<Expression>& v, const std::string& name = "norm", int tag = -1) {
    for (int i = 0; i < 3; ++i)
        if (!v[i].is_constant()) return v[i].recorder()->norm(v[0], v[1], v[2], name, tag);
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}
inline double length(const Vector3& v, const std::string& = {}, int = -1) { return v.norm(); }
inline DoubleDouble length(const Vector3Of<DoubleDouble>& v, const std::string& = {}, int = -1) {
    return sqrt(dot<DoubleDouble>(v, v));
}
inline long double length(const Vector3Of<long double>& v, const std::string& = {}, int = -1) {
    return std::sqrt(dot(v, v));
}

/// Two sides of a case with the weight of the first.
template <class B, class C>
Expression blended(const Expression& weight, B&& b, C&& c) {
    if (weight.is_constant() && weight.value() == 1.0) return b();
    const Expression below = c();
    return weight.is_zero() ? below : below + weight * (b() - below);
}

/// b where x > 0, else c; its change is a switching point of the recorded function, silent if the name is empty.
/// `b` and `c` are called for what is needed only.
template <class B, class C>
Expression select(const Expression& x, B&& b, C&& c, const std::string& name = "where") {
    if (x.is_constant()) return x.is_positive() ? b() : c();
    Recorder* r = x.recorder();
    if (r->purpose() == Recorder::Purpose::model) {
        if (const auto weight = r->weight(x, name)) return blended(*weight, b, c);
        return r->side(x, name) > 0 ? b() : c();
    }
    const Expression above = b(), below = c();
    const std::int32_t i = r->node_of(above), j = r->node_of(below);
    if (i == j) return above;
    return r->record({Operation::select, x.node(), i, j, r->name_index(name)});
}

/// The largest whole number <= x, kept within [lowest, highest]: for expressions of a model fixed during smooth motion,
/// its changes located as switching points, silent ones if the name is empty.
inline long whole(double x, long lowest, long highest) {
    return x > static_cast<double>(lowest) ? static_cast<long>(std::min(std::floor(x), static_cast<double>(highest)))
                                           : lowest;
}
inline long whole(const Expression& x, long lowest, long highest, const std::string& name = {}) {
    return x.is_constant() ? whole(x.value(), lowest, highest) : x.recorder()->whole(x, lowest, highest, name);
}

// whole numbers that a double holds
inline constexpr long most_negative_whole = -(1L << 53), most_positive_whole = 1L << 53;

/// The largest whole number <= x; its changes are switching points of the recorded function.
inline Expression floor(const Expression& x) {
    if (x.is_constant()) return std::floor(x.value());
    Recorder* r = x.recorder();
    if (r->purpose() == Recorder::Purpose::model)
        return static_cast<double>(r->whole(x, most_negative_whole, most_positive_whole, "floor"));
    return r->record({Operation::whole, x.node(), -1, -1, r->name_index("floor")});
}

/// arctan2(y, x), in (-pi, pi]; crossing its cut is a switching point of the recorded function.
inline Expression atan2(const Expression& y, const Expression& x) {
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
inline Expression atan(const Expression& x) { return recording::angle(x, 1.0); }
inline Expression asin(const Expression& x) {
    if (x.is_constant())
        return recording::folded(x, [](const auto& v) {
            using std::asin;
            return asin(v);
        });
    return x.recorder()->record(Operation::angle, x.node(), x.recorder()->node_of(sqrt((1.0 - x) * (1.0 + x))));
}
inline Expression acos(const Expression& x) {
    if (x.is_constant())
        return recording::folded(x, [](const auto& v) {
            using std::acos;
            return acos(v);
        });
    const Expression across = sqrt((1.0 - x) * (1.0 + x));
    return x.recorder()->record(Operation::angle, x.recorder()->node_of(across), x.node());
}
inline Expression asinh(const Expression& x) {
    const Expression s = locked_sign(x, std::string());
    return s * log(s * x + sqrt(x * x + 1.0));
}
inline Expression acosh(const Expression& x) { return log(x + sqrt((x - 1.0) * (x + 1.0))); }
inline Expression atanh(const Expression& x) { return 0.5 * log((1.0 + x) / (1.0 - x)); }
/// The real cube root.
inline Expression cbrt(const Expression& x) {
    const Expression s = locked_sign(x, "cbrt");
    return s * pow(s * x, 1.0 / 3.0);
}

}  // namespace rbdyn
