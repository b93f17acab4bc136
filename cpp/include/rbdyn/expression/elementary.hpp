// Elementary functions of expressions.
#pragma once

#include <concepts>
#include <cstdint>
#include <string>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace recording {

template <class F>
Expression unary(const Expression& x, Operation operation, F&& f) {
    if (x.is_number()) return Numbers::active()->record(operation, x);
    return x.is_constant() ? folded(x, f) : x.recorder()->record(operation, x.node());
}

}  // namespace recording

Expression sqrt(const Expression& x);
Expression sin(const Expression& x);
Expression cos(const Expression& x);
inline Expression tan(const Expression& x) { return sin(x) / cos(x); }
Expression sinh(const Expression& x);
Expression cosh(const Expression& x);
Expression tanh(const Expression& x);
Expression exp(const Expression& x);
Expression log(const Expression& x);
/// exp(x) - 1 and log(1 + x), with all digits where x is small.
Expression expm1(const Expression& x);
Expression log1p(const Expression& x);

/// x^n for a constant n; whole powers to 65536 become products, which have a series at zero.
Expression pow(const Expression& x, double n);
/// For an exponent that varies x is positive, and 0^0 is 1.
Expression pow(const Expression& x, const Expression& n);

/// The sign of x, locked during smooth motion; its zeros are switching points of the recorded function.
Expression locked_sign(const Expression& x, const std::string& name = "sign");
inline double locked_sign(double x, const std::string& = {}) { return x < 0.0 ? -1.0 : 1.0; }
template <std::same_as<long double> T>
T locked_sign(T x, const std::string& = {}) {
    return x < 0 ? T(-1) : T(1);
}
inline DoubleDouble locked_sign(const DoubleDouble& x, const std::string& = {}) { return x.hi < 0.0 ? -1.0 : 1.0; }

inline Expression abs(const Expression& x) { return locked_sign(x, "abs") * x; }

/// The length of a vector; for expressions, its zeros are switching points of the recorded function.
Expression length(const Vector3Of<Expression>& v, const std::string& name = "norm", int tag = -1);
inline double length(const Vector3& v, const std::string& = {}, int = -1) { return v.norm(); }
DoubleDouble length(const Vector3Of<DoubleDouble>& v, const std::string& = {}, int = -1);
long double length(const Vector3Of<long double>& v, const std::string& = {}, int = -1);

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
long whole(double x, long lowest, long highest);
long whole(const Expression& x, long lowest, long highest, const std::string& name = {});

// whole numbers that a double holds
inline constexpr long most_negative_whole = -(1L << 53), most_positive_whole = 1L << 53;

/// The largest whole number <= x; its changes are switching points of the recorded function.
Expression floor(const Expression& x);

/// arctan2(y, x), in (-pi, pi]; crossing its cut is a switching point of the recorded function.
Expression atan2(const Expression& y, const Expression& x);
inline Expression atan(const Expression& x) { return recording::angle(x, 1.0); }
Expression asin(const Expression& x);
Expression acos(const Expression& x);
Expression asinh(const Expression& x);
inline Expression acosh(const Expression& x) { return log1p((x - 1.0) + sqrt(x - 1.0) * sqrt(x + 1.0)); }
Expression atanh(const Expression& x);
/// The real cube root.
Expression cbrt(const Expression& x);

}  // namespace rbdyn::inline RBDYN_FORM
