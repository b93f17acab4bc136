// A number type that records what is done with it.
//
// A model of motion is written once, as a function over any number type. Called with `Expression` it leaves behind
// the list of its operations, from which program.hpp makes one native program for doubles, Taylor coefficients,
// Jacobians and extended precision alike. Constants are folded and equal subexpressions shared while recording, so
// what a scene does not call for (a zero component, a coefficient of zero, an absent effect) is not in the program.
//
// Conventions: an expression is a constant or a node of one Recorder. `parameter` nodes are numbers that are fixed
// during smooth motion and may change between pieces (the sign of a slip, a coefficient of a sweep).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn {

class Recorder;

/// What a node of a recorded function does with its operands.
enum class Operation : std::uint8_t {
    constant,   // value
    input,      // a: index of the state variable
    time,       //
    parameter,  // a: index of the parameter
    add,        // a + b
    multiply,   // a * b
    divide,     // a / b
    square_root,
    norm,  // sqrt(a^2 + b^2 + c^2), the sign lost at a zero handled by a switch; d: its switch
    sine,
    cosine,
    exponential,
    logarithm,
    power,  // a ^ value
};

/// A recorded number: a constant, or a node of a recorder.
class Expression {
public:
    Expression() = default;
    Expression(double constant) : value_(constant) {}  // implicit: constants mix freely with expressions
    Expression(int constant) : value_(constant) {}
    Expression(Recorder* recorder, std::int32_t node) : recorder_(recorder), node_(node) {}

    bool is_constant() const { return recorder_ == nullptr; }
    bool is_zero() const { return is_constant() && value_ == 0.0; }
    double value() const { return value_; }
    Recorder* recorder() const { return recorder_; }
    std::int32_t node() const { return node_; }

    Expression& operator+=(const Expression& other);
    Expression& operator-=(const Expression& other);
    Expression& operator*=(const Expression& other);
    Expression& operator/=(const Expression& other);

private:
    double value_ = 0.0;
    Recorder* recorder_ = nullptr;
    std::int32_t node_ = -1;
};

}  // namespace rbdyn

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

namespace rbdyn {

/// One recorded operation.
struct Node {
    Operation operation;
    std::int32_t a = -1, b = -1, c = -1, d = -1;
    double value = 0.0;

    bool operator==(const Node&) const = default;
};

/// Where a recorded function is not smooth: an absolute value or a norm at its zero.
/// The sign is a parameter of the program, +1 or -1 times what is inside; `argument` is the guard.
struct Switch {
    std::int32_t argument;   // node whose zero is the switching point
    std::int32_t parameter;  // index of the sign (absolute value) or of the "starts at zero" flag (norm)
    bool is_norm;
    std::string name;
    int tag;      // what the writer of the model makes of it; -1: nothing
    int subject;  // the body it was recorded for; -1: none
};

/// Holds the nodes of one recorded function.
class Recorder {
public:
    Expression input(int index) { return {this, intern({Operation::input, index})}; }
    Expression time() { return {this, intern({Operation::time})}; }
    Expression parameter(int index) {
        if (index >= parameters_) parameters_ = index + 1;
        return {this, intern({Operation::parameter, index})};
    }
    /// The body that what is recorded from now on belongs to.
    void set_subject(int body) { subject_ = body; }

    /// A parameter that nothing else uses.
    int new_parameter() { return parameters_++; }

    Expression constant(double value) { return {this, intern({Operation::constant, -1, -1, -1, -1, value})}; }

    const Node& node(std::int32_t index) const { return nodes_[static_cast<std::size_t>(index)]; }
    std::int32_t size() const { return static_cast<std::int32_t>(nodes_.size()); }
    int parameters() const { return parameters_; }

    /// The node of an expression, constants included.
    std::int32_t node_of(const Expression& x) { return x.is_constant() ? constant(x.value()).node() : x.node(); }

    Expression record(Operation operation, std::int32_t a, std::int32_t b = -1, double value = 0.0) {
        return {this, intern({operation, a, b, -1, -1, value})};
    }

    /// The sign of x, locked: a parameter, +1 or -1, chosen by whoever runs the program; zeros of x are switches.
    Expression sign(const Expression& x, const std::string& name, int tag = -1);
    /// sqrt(x^2 + y^2 + z^2), smooth up to and beyond a zero; zeros are switches. One component alone: sign(x) x.
    Expression norm(const Expression& x, const Expression& y, const Expression& z, const std::string& name,
                    int tag = -1);

    std::vector<Switch>& switches() { return switches_; }
    const std::vector<Switch>& switches() const { return switches_; }

private:
    struct Hash {
        std::size_t operator()(const Node& n) const {
            std::size_t h = static_cast<std::size_t>(n.operation);
            for (std::int32_t x : {n.a, n.b, n.c, n.d}) h = h * 1000003u ^ static_cast<std::size_t>(x + 7);
            return h * 1000003u ^ std::hash<double>{}(n.value);
        }
    };
    std::int32_t intern(const Node& node) {
        auto [found, is_new] = index_.try_emplace(node, static_cast<std::int32_t>(nodes_.size()));
        if (is_new) nodes_.push_back(node);
        return found->second;
    }

    std::vector<Node> nodes_;
    std::unordered_map<Node, std::int32_t, Hash> index_;
    std::vector<Switch> switches_;
    int parameters_ = 0;
    int subject_ = -1;
};

namespace recording {

inline Recorder* common(const Expression& a, const Expression& b) {
    Recorder* recorder = a.is_constant() ? b.recorder() : a.recorder();
    if (!a.is_constant() && !b.is_constant() && a.recorder() != b.recorder())
        throw Error("an expression of one recorded function was used in another");
    return recorder;
}

}  // namespace recording

inline Expression operator+(const Expression& a, const Expression& b) {
    if (a.is_constant() && b.is_constant()) return a.value() + b.value();
    if (a.is_zero()) return b;
    if (b.is_zero()) return a;
    Recorder* r = recording::common(a, b);
    std::int32_t i = r->node_of(a), j = r->node_of(b);
    return r->record(Operation::add, std::min(i, j), std::max(i, j));
}

inline Expression operator*(const Expression& a, const Expression& b) {
    if (a.is_constant() && b.is_constant()) return a.value() * b.value();
    if (a.is_zero() || b.is_zero()) return 0.0;
    if (a.is_constant() && a.value() == 1.0) return b;
    if (b.is_constant() && b.value() == 1.0) return a;
    Recorder* r = recording::common(a, b);
    std::int32_t i = r->node_of(a), j = r->node_of(b);
    return r->record(Operation::multiply, std::min(i, j), std::max(i, j));
}

inline Expression operator-(const Expression& a) { return Expression(-1.0) * a; }
inline Expression operator+(const Expression& a) { return a; }
inline Expression operator-(const Expression& a, const Expression& b) {
    if (!a.is_constant() && !b.is_constant() && a.node() == b.node()) return 0.0;
    return a + (-b);
}

inline Expression operator/(const Expression& a, const Expression& b) {
    if (a.is_constant() && b.is_constant()) return a.value() / b.value();
    if (a.is_zero()) return 0.0;
    if (b.is_constant()) return a * Expression(1.0 / b.value());
    Recorder* r = recording::common(a, b);
    return r->record(Operation::divide, r->node_of(a), r->node_of(b));
}

inline Expression& Expression::operator+=(const Expression& other) { return *this = *this + other; }
inline Expression& Expression::operator-=(const Expression& other) { return *this = *this - other; }
inline Expression& Expression::operator*=(const Expression& other) { return *this = *this * other; }
inline Expression& Expression::operator/=(const Expression& other) { return *this = *this / other; }

inline Expression sqrt(const Expression& x) {
    return x.is_constant() ? Expression(std::sqrt(x.value())) : x.recorder()->record(Operation::square_root, x.node());
}
inline Expression sin(const Expression& x) {
    return x.is_constant() ? Expression(std::sin(x.value())) : x.recorder()->record(Operation::sine, x.node());
}
inline Expression cos(const Expression& x) {
    return x.is_constant() ? Expression(std::cos(x.value())) : x.recorder()->record(Operation::cosine, x.node());
}
inline Expression tan(const Expression& x) { return sin(x) / cos(x); }
inline Expression exp(const Expression& x) {
    return x.is_constant() ? Expression(std::exp(x.value())) : x.recorder()->record(Operation::exponential, x.node());
}
inline Expression log(const Expression& x) {
    return x.is_constant() ? Expression(std::log(x.value())) : x.recorder()->record(Operation::logarithm, x.node());
}
inline Expression tanh(const Expression& x) {
    if (x.is_constant()) return std::tanh(x.value());
    const Expression e = exp(Expression(2.0) * x);
    return 1.0 - 2.0 / (e + 1.0);
}

/// x^n for a constant n; small whole powers become products.
inline Expression pow(const Expression& x, double n) {
    if (x.is_constant()) return std::pow(x.value(), n);
    if (n == 0.0) return 1.0;
    if (n == 0.5) return sqrt(x);
    if (n == std::floor(n) && std::abs(n) <= 16.0) {
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

inline Expression Recorder::sign(const Expression& x, const std::string& name, int tag) {
    if (x.is_constant()) return x.value() < 0.0 ? -1.0 : 1.0;
    for (const Switch& known : switches_)
        if (!known.is_norm && known.argument == x.node()) return parameter(known.parameter);
    const int index = new_parameter();
    switches_.push_back({x.node(), index, false, name, tag, subject_});
    return parameter(index);
}

inline Expression Recorder::norm(const Expression& x, const Expression& y, const Expression& z, const std::string& name,
                                 int tag) {
    const Expression* part[3] = {&x, &y, &z};
    const Expression* alone = nullptr;
    int present = 0;
    bool constant = true;
    for (const Expression* p : part) {
        if (!p->is_zero()) {
            ++present;
            alone = p;
        }
        constant = constant && p->is_constant();
    }
    if (present == 0) return 0.0;
    if (present == 1) return sign(*alone, name, tag) * *alone;
    if (constant) return std::sqrt(x.value() * x.value() + y.value() * y.value() + z.value() * z.value());
    Node node{Operation::norm, node_of(x), node_of(y), node_of(z)};
    for (const Switch& known : switches_) {
        const Node& other = this->node(known.argument);
        if (known.is_norm && other.a == node.a && other.b == node.b && other.c == node.c) return {this, known.argument};
    }
    node.d = new_parameter();
    const Expression result(this, intern(node));
    switches_.push_back({result.node(), node.d, true, name, tag, subject_});
    return result;
}

/// The sign of x, locked during smooth motion; its zeros are switching points of the recorded function.
inline Expression locked_sign(const Expression& x, const std::string& name = "sign") {
    return x.is_constant() ? Expression(x.value() < 0.0 ? -1.0 : 1.0) : x.recorder()->sign(x, name);
}
inline double locked_sign(double x, const std::string& = {}) { return x < 0.0 ? -1.0 : 1.0; }

inline Expression abs(const Expression& x) { return locked_sign(x, "abs") * x; }

/// The length of a vector; for expressions, its zeros are switching points of the recorded function.
inline Expression length(const Vector3Of<Expression>& v, const std::string& name = "norm", int tag = -1) {
    for (int i = 0; i < 3; ++i)
        if (!v[i].is_constant()) return v[i].recorder()->norm(v[0], v[1], v[2], name, tag);
    return std::sqrt(v[0].value() * v[0].value() + v[1].value() * v[1].value() + v[2].value() * v[2].value());
}
inline double length(const Vector3& v, const std::string& = {}, int = -1) { return v.norm(); }

}  // namespace rbdyn
