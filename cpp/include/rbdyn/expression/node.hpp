// A number type that records what is done with it, and the operations that are recorded (expression.hpp).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Recorder;

/// What a node of a recorded function does with its operands.
enum class Operation : std::uint8_t {
    constant,   // value
    input,      // a: index of the state variable
    time,       //
    parameter,  // a: index of the parameter
    cell,       // a: index of a number of the user's that may be changed later (functions only)
    add,        // a + b
    multiply,   // a * b
    divide,     // a / b
    square_root,
    norm,  // sqrt(a^2 + b^2 + c^2), the sign lost at a zero handled by a switch; d: its switch
    sine,
    cosine,
    hyperbolic_sine,
    hyperbolic_cosine,
    hyperbolic_tangent,
    exponential,
    logarithm,
    expm1,   // exp(a) - 1, all digits of it
    log1p,   // log(1 + a), all digits of it
    arsinh,  // inverses of the hyperbolic sine and tangent
    artanh,
    power,   // a ^ value
    raise,   // a ^ b
    angle,   // of the point (b, a): arctan2(a, b), away from its cut
    call,    // a: index of the call; result d of it
    sign,    // of a (functions only; a parameter in models); d: index of its name
    select,  // b where a > 0, else c (functions only; chosen in models); d: index of its name
    whole,   // the largest whole number <= a (functions only; chosen in models); d: index of its name
};

/// x^r where x is not negative in its mode, r > 0, so that nothing is said of negative x: what goes on beyond zero
/// without a jump. A trial step that ends beyond its mode finds a number there, and so does a zero that rounding has
/// put on the other side. Series, which have no more than the zero to go on from, are as they are.
template <class T>
T locked_power(const T& x, const T& r) {
    using std::pow;
    return x < T(0) ? -pow(-x, r) : pow(x, r);
}

/// A double, or a number of 32 digits.
struct Constant {
    DoubleDouble number;
    bool is_wide = false;
};

/// What an operation makes of two of them: one of 32 digits if either is, unless these fail.
template <class F>
Constant folded(const Constant& a, const Constant& b, F&& f) {
    const double rounded = f(a.number.hi, b.number.hi);
    if (!a.is_wide && !b.is_wide) return {rounded};
    const DoubleDouble exact = f(a.number, b.number);
    return {std::isfinite(exact.hi) && std::isfinite(exact.lo) ? exact : DoubleDouble(rounded), true};
}

/// What a function makes of one.
template <class F>
Constant folded(const Constant& a, F&& f) {
    return folded(a, a, [&](const auto& x, const auto&) { return f(x); });
}

/// A recorded number: a constant, or a node of a recorder.
class Expression {
public:
    Expression() = default;
    Expression(double constant) : value_(constant) {}  // implicit: constants mix freely with expressions
    Expression(int constant) : value_(constant) {}
    Expression(const DoubleDouble& constant) : value_(constant.hi), rest_(constant.lo), is_wide_(true) {}
    Expression(Recorder* recorder, std::int32_t node) : recorder_(recorder), node_(node) {}

    /// A constant that comes from numbers of the user's (numbers.hpp), and what it is at present.
    static Expression number(std::int32_t node, const Constant& now);

    bool is_constant() const { return recorder_ == nullptr; }
    bool is_zero() const { return is_constant() && value_ == 0.0; }
    bool is_number() const { return is_constant() && node_ >= 0; }
    /// Of a constant: what it is, and its sign. What is made of it holds as long as these stay so.
    double value() const;
    bool is_positive() const;
    bool is_negative() const;
    /// What it is at present, and whether that has 32 digits.
    Constant constant() const { return {{value_, rest_}, is_wide_}; }
    bool is_one() const { return is_constant() && !is_number() && value_ == 1.0 && rest_ == 0.0; }
    Recorder* recorder() const { return recorder_; }
    /// Of its recorder; of a number among those numbers.
    std::int32_t node() const { return node_; }

    Expression& operator+=(const Expression& other);
    Expression& operator-=(const Expression& other);
    Expression& operator*=(const Expression& other);
    Expression& operator/=(const Expression& other);

private:
    double value_ = 0.0, rest_ = 0.0;
    Recorder* recorder_ = nullptr;
    std::int32_t node_ = -1;
    bool is_wide_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM

template <>
struct Eigen::NumTraits<rbdyn::Expression> : Eigen::GenericNumTraits<rbdyn::Expression> {
    using Real = rbdyn::Expression;
    using NonInteger = rbdyn::Expression;
    using Nested = rbdyn::Expression;
    using Literal = double;
    enum {
        IsComplex = 0,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = 1,
        ReadCost = 1,
        AddCost = 3,
        MulCost = 3
    };
};

namespace rbdyn::inline RBDYN_FORM {

/// One recorded operation.
struct Node {
    Operation operation;
    std::int32_t a = -1, b = -1, c = -1, d = -1;
    double value = 0.0;
    double rest = 0.0;     // of a constant of 32 digits: what its value is short of them
    bool is_wide = false;  // whether it is one

    /// Numbers are the same that are equal, and those that are not numbers.
    bool operator==(const Node& other) const;
    /// Of a constant.
    Expression constant() const { return is_wide ? Expression(DoubleDouble(value, rest)) : Expression(value); }

    /// The nodes it computes with, those of calls apart.
    std::array<std::int32_t, 3> operands() const;
};

}  // namespace rbdyn::inline RBDYN_FORM
