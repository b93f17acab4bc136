// A number type that records what is done with it.
//
// A model of motion is written once, as a function over any number type. Called with `Expression` it leaves behind
// the list of its operations, from which program.hpp makes one native program for doubles, Taylor coefficients,
// Jacobians and extended precision alike. Constants are folded and equal subexpressions shared while recording, so
// what a scene does not call for (a zero component, a coefficient of zero, an absent effect) is not in the program.
//
// A recorder serves one of two purposes. As a function it keeps everything, case distinctions included, so that the
// function can be applied again (function.hpp). As a model of one smooth mode it keeps one side of every distinction:
// signs become parameters of the program with the argument as guard (`Switch`), choices between formulas are made
// by the state the mode begins in, or by whoever knows better (`Branch`).
//
// Constants are doubles, or numbers of 32 digits where a model gives such; what is folded with one of these is one, and
// is rounded once, by the program that uses it. Who asks for all digits (WideFolding) has them of all constants.
//
// Conventions: an expression is a constant or a node of one Recorder. `parameter` nodes are numbers that are fixed
// during smooth motion and may change between pieces (the sign of a slip).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"

namespace rbdyn {

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
    power,   // a ^ value
    angle,   // of the point (b, a): arctan2(a, b), away from its cut
    call,    // a: index of the call; result d of it
    sign,    // of a (functions only; a parameter in models); d: index of its name
    select,  // b where a > 0, else c (functions only; chosen in models); d: index of its name
    whole,   // the largest whole number <= a (functions only; chosen in models); d: index of its name
};

/// A recorded number: a constant, or a node of a recorder.
class Expression {
public:
    Expression() = default;
    Expression(double constant) : value_(constant) {}  // implicit: constants mix freely with expressions
    Expression(int constant) : value_(constant) {}
    Expression(const DoubleDouble& constant) : value_(constant.hi), rest_(constant.lo), is_wide_(true) {}
    Expression(Recorder* recorder, std::int32_t node) : recorder_(recorder), node_(node) {}

    bool is_constant() const { return recorder_ == nullptr; }
    bool is_zero() const { return is_constant() && value_ == 0.0; }
    double value() const { return value_; }
    DoubleDouble exact() const { return {value_, rest_}; }
    /// Whether it is a constant of 32 digits.
    bool is_wide() const { return is_wide_; }
    Recorder* recorder() const { return recorder_; }
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
    double rest = 0.0;     // of a constant of 32 digits: what its value is short of them
    bool is_wide = false;  // whether it is one

    bool operator==(const Node&) const = default;
    /// Of a constant.
    Expression constant() const { return is_wide ? Expression(DoubleDouble(value, rest)) : Expression(value); }

    /// The nodes it computes with, those of calls apart.
    std::array<std::int32_t, 3> operands() const {
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
};

/// Where a recorded function is not smooth: an absolute value or a norm at its zero.
/// The sign is a parameter of the program, +1 or -1 times what is inside; `argument` is the guard.
struct Switch {
    std::int32_t argument;   // node whose zero is the switching point
    std::int32_t parameter;  // index of the sign (absolute value) or of the "starts at zero" flag (norm)
    bool is_norm;
    std::string name;
    int tag;                // what the writer of the model makes of it; -1: nothing
    int subject;            // the body it was recorded for; -1: none
    std::uint64_t id;       // the same for the same argument in every recording
    std::uint64_t surface;  // on which it lies, as its id
    int orientation;        // +1: its argument is positive where that of the surface is; -1: where it is negative
};

/// A choice between formulas, made for one smooth mode: valid while lower <= argument <= upper.
struct Branch {
    std::int32_t argument;
    long choice;           // of two: 1 where the argument is positive, else 0; of many: the whole number below it
    bool is_select;        // of two formulas, at zero
    long lowest, highest;  // choices there are; nothing lies beyond them
    std::string name;      // of the event where it changes; empty: silent
    int subject;
    std::uint64_t id = 0;       // the same for the same argument in every recording
    std::uint64_t surface = 0;  // on which it lies, as its id
    int orientation = 1;        // +1: its argument is positive where that of the surface is; -1: where it is negative

    double lower() const { return is_select ? 0.0 : static_cast<double>(choice); }
    double upper() const { return is_select ? 0.0 : static_cast<double>(choice) + 1.0; }
    bool has_lower() const { return choice > lowest; }
    bool has_upper() const { return choice < highest; }
};

/// A surface on which no case distinction is made: both sides are written, each with its weight.
struct Blend {
    Expression weight;           // of the side where the argument is positive; the other has the rest of 1
    std::int32_t argument = -1;  // node whose zero is the surface; -1: nothing lies on it so far
    std::string name = {};       // of the first that lies on it
    int subject = -1;
};

/// A number of the user's, used in recorded functions by reference: it may be changed between runs.
class Parameter {
public:
    explicit Parameter(double value, std::string name = {})
        : cell_(std::make_shared<Cell>(Cell{value, std::move(name)})) {
        require(std::isfinite(value), "parameter", cell_->name.empty() ? "its value" : cell_->name, value,
                "it is finite");
    }
    double value() const { return cell_->value; }
    const std::string& name() const { return cell_->name; }
    void set(double value) {
        require(std::isfinite(value), "parameter", name().empty() ? "its value" : name(), value, "it is finite");
        cell_->value = value;
    }
    /// In the function that is being recorded. Throws Error if none is.
    operator Expression() const;

    /// Whether they are one parameter.
    bool is(const Parameter& other) const { return cell_ == other.cell_; }

private:
    struct Cell {
        double value;
        std::string name;
    };
    std::shared_ptr<Cell> cell_;
};

/// Holds the nodes of one recorded function.
class Recorder {
public:
    /// A function of the user's being kept whole, or the model of one smooth mode.
    enum class Purpose { function, model };

    explicit Recorder(Purpose purpose = Purpose::model) : purpose_(purpose) {}
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    Purpose purpose() const { return purpose_; }

    /// A model whose choices follow from a state: the numbers of time, inputs and parameters from here on. Choices in
    /// `forced`, by id, are made so whatever the state; those on the surfaces in `sides` are on that side, +1 or -1.
    void follow(double t, std::span<const double> inputs, std::span<const double> parameters,
                std::map<std::uint64_t, long> forced = {}, std::map<std::uint64_t, long> sides = {}) {
        follows_ = true;
        time_ = t;
        inputs_.assign(inputs.begin(), inputs.end());
        parameter_values_.assign(parameters.begin(), parameters.end());
        forced_ = std::move(forced);
        sides_ = std::move(sides);
        values_.clear();
        for (const Node& n : nodes_) values_.push_back(value_of(n));
    }

    /// The number a node stands for in the state that is followed; not a number where cases are kept, or before a call.
    double value(std::int32_t index) const { return values_[at(index)]; }

    /// From here on, what lies on a surface is blended with this weight instead of distinguished.
    void blend(std::uint64_t surface, const Expression& weight) { blends_[surface].weight = weight; }
    const std::map<std::uint64_t, Blend>& blends() const { return blends_; }
    /// The weight of the side where x > 0, if what x distinguishes is blended.
    std::optional<Expression> weight(const Expression& x, const std::string& name);

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
    std::int32_t node_of(const Expression& x) {
        if (!x.is_constant()) return x.node();
        const DoubleDouble value = x.exact();
        return intern({Operation::constant, -1, -1, -1, -1, value.hi, value.lo, x.is_wide()});
    }

    Expression record(Operation operation, std::int32_t a, std::int32_t b = -1, double value = 0.0) {
        return {this, intern({operation, a, b, -1, -1, value})};
    }
    /// A node as another recording has it.
    Expression record(const Node& node) { return {this, intern(node)}; }

    /// The sign of x, locked in a model: a parameter, +1 or -1, chosen by whoever runs the program; zeros of x are
    /// switches.
    Expression sign(const Expression& x, const std::string& name, int tag = -1);
    /// sqrt(x^2 + y^2 + z^2), smooth up to and beyond a zero; zeros are switches. One component alone: sign(x) x.
    Expression norm(const Expression& x, const Expression& y, const Expression& z, const std::string& name,
                    int tag = -1);
    /// Whether x > 0 (1) or not (0), in a model that follows a state.
    long side(const Expression& x, const std::string& name);
    /// The whole number below x, kept within [lowest, highest], in a model that follows a state.
    long whole(const Expression& x, long lowest, long highest, const std::string& name);
    /// What a function of the user's that is called back gives for these arguments.
    std::vector<Expression> call(const std::shared_ptr<const Callback>& function,
                                 std::span<const Expression> arguments);
    /// A number of the user's.
    Expression cell(const Parameter& parameter) {
        std::int32_t index = 0;
        while (index < static_cast<std::int32_t>(cells_.size()) &&
               !cells_[static_cast<std::size_t>(index)].is(parameter))
            ++index;
        if (index == static_cast<std::int32_t>(cells_.size())) cells_.push_back(parameter);
        return {this, intern({Operation::cell, index})};
    }
    const std::vector<Parameter>& cells() const { return cells_; }

    /// A name kept with nodes of a function.
    std::int32_t name_index(const std::string& name) {
        const auto found = std::find(names_.begin(), names_.end(), name);
        if (found != names_.end()) return static_cast<std::int32_t>(found - names_.begin());
        names_.push_back(name);
        return static_cast<std::int32_t>(names_.size()) - 1;
    }
    const std::vector<std::string>& names() const { return names_; }

    struct Call {
        std::shared_ptr<const Callback> function;
        std::vector<std::int32_t> arguments;
    };
    const std::vector<Call>& calls() const { return calls_; }
    const std::vector<Switch>& switches() const { return switches_; }
    const std::vector<Branch>& branches() const { return branches_; }

private:
    /// Where to begin to look for a node among 2^bits places.
    static std::size_t place_of(const Node& n, int bits) {
        std::uint64_t h = static_cast<std::uint64_t>(n.operation);
        for (std::int32_t x : {n.a, n.b, n.c, n.d}) h = h * 1000003u ^ static_cast<std::uint64_t>(x + 7);
        // zeros of both signs are one number
        h = h * 1000003u ^ (n.value == 0.0 ? 0 : std::bit_cast<std::uint64_t>(n.value));
        // the high bits of a product with 2^64 over the golden section depend on all of h
        return static_cast<std::size_t>((h ^ h >> 32) * 0x9e3779b97f4a7c15u >> (64 - bits));
    }
    std::int32_t intern(const Node& node) {
        if (2 * nodes_.size() >= index_.size()) {
            bits_ = bits_ == 0 ? 6 : bits_ + 1;
            index_.assign(std::size_t{1} << bits_, -1);
            for (std::size_t n = 0; n < nodes_.size(); ++n)
                index_[free_place(nodes_[n])] = static_cast<std::int32_t>(n);
        }
        std::int32_t& found = index_[free_place(node)];
        if (found < 0) {
            found = static_cast<std::int32_t>(nodes_.size());
            nodes_.push_back(node);
            if (follows_) values_.push_back(value_of(node));
        }
        return found;
    }
    /// The place in the index that holds a node, or where it goes.
    std::size_t free_place(const Node& node) const {
        std::size_t place = place_of(node, bits_);
        while (index_[place] >= 0 && !(nodes_[at(index_[place])] == node)) place = (place + 1) & (index_.size() - 1);
        return place;
    }
    static std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

    /// The number a new node stands for in the state that is followed.
    double value_of(const Node& n) const;
    /// The number a node stands for, what is called back included.
    double followed(std::int32_t index);
    /// What a node stands for, whatever its index: the same in every recording that writes it so.
    std::uint64_t identity(std::int32_t index);
    /// The node whose zeros are those of another, which is a multiple of it, and the sign of the factor.
    std::pair<std::int32_t, int> surface(std::int32_t index) const;
    long choose(Branch branch, long by_state);

    Purpose purpose_;
    std::vector<Node> nodes_;
    std::vector<std::uint64_t> identities_;
    std::vector<std::int32_t> index_;  // nodes by what they are: 2^bits places, at least half of them empty (-1)
    int bits_ = 0;
    std::vector<Switch> switches_;
    std::vector<Branch> branches_;
    std::vector<Call> calls_;
    std::vector<Parameter> cells_;
    std::vector<std::string> names_;
    int parameters_ = 0;
    int subject_ = -1;

    // the state a model follows
    bool follows_ = false;
    double time_ = 0.0;
    std::vector<double> inputs_, parameter_values_, values_;
    std::vector<std::vector<double>> results_;  // of calls
    std::map<std::uint64_t, long> forced_;
    std::map<std::uint64_t, long> sides_;
    std::map<std::uint64_t, Blend> blends_;
};

namespace recording {

inline Recorder* common(const Expression& a, const Expression& b) {
    Recorder* recorder = a.is_constant() ? b.recorder() : a.recorder();
    if (!a.is_constant() && !b.is_constant() && a.recorder() != b.recorder())
        throw Error("an expression of one recorded function was used in another");
    return recorder;
}

/// While one lives, this thread folds all constants with 32 digits.
class WideFolding {
public:
    WideFolding() { is_on = true; }
    ~WideFolding() { is_on = false; }
    WideFolding(const WideFolding&) = delete;
    WideFolding& operator=(const WideFolding&) = delete;
    inline static thread_local bool is_on = false;
};

/// What an operation makes of two constants.
template <class F>
Expression folded(const Expression& a, const Expression& b, F&& f) {
    const double rounded = f(a.value(), b.value());
    if (!a.is_wide() && !b.is_wide() && !WideFolding::is_on) return rounded;
    const DoubleDouble exact = f(a.exact(), b.exact());
    return std::isfinite(exact.hi) && std::isfinite(exact.lo) ? exact : DoubleDouble(rounded);
}

}  // namespace recording

inline Expression operator+(const Expression& a, const Expression& b) {
    if (a.is_constant() && b.is_constant())
        return recording::folded(a, b, [](const auto& x, const auto& y) { return x + y; });
    if (a.is_zero()) return b;
    if (b.is_zero()) return a;
    Recorder* r = recording::common(a, b);
    std::int32_t i = r->node_of(a), j = r->node_of(b);
    return r->record(Operation::add, std::min(i, j), std::max(i, j));
}

inline Expression operator*(const Expression& a, const Expression& b) {
    if (a.is_constant() && b.is_constant())
        return recording::folded(a, b, [](const auto& x, const auto& y) { return x * y; });
    if (a.is_zero() || b.is_zero()) return 0.0;
    if (a.is_constant() && a.exact() == DoubleDouble(1.0)) return b;
    if (b.is_constant() && b.exact() == DoubleDouble(1.0)) return a;
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
    if (a.is_constant() && b.is_constant())
        return recording::folded(a, b, [](const auto& x, const auto& y) { return x / y; });
    if (a.is_zero()) return 0.0;
    if (b.is_constant()) return a * (Expression(1.0) / b);
    Recorder* r = recording::common(a, b);
    return r->record(Operation::divide, r->node_of(a), r->node_of(b));
}

inline Expression& Expression::operator+=(const Expression& other) { return *this = *this + other; }
inline Expression& Expression::operator-=(const Expression& other) { return *this = *this - other; }
inline Expression& Expression::operator*=(const Expression& other) { return *this = *this * other; }
inline Expression& Expression::operator/=(const Expression& other) { return *this = *this / other; }

// --- switching operations of a recorder ---

inline std::uint64_t Recorder::identity(std::int32_t index) {
    // operands come before what uses them
    while (static_cast<std::int32_t>(identities_.size()) <= index) {
        const Node& n = node(static_cast<std::int32_t>(identities_.size()));
        std::uint64_t h = 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(n.operation);
        const auto mix = [&](std::uint64_t x) {
            h = (h ^ (x + 0x9e3779b97f4a7c15u + (h << 6) + (h >> 2))) * 0xff51afd7ed558ccdu;
        };
        const auto operands = n.operands();
        if (n.operation == Operation::add || n.operation == Operation::multiply) {
            // written in any order
            const std::uint64_t x = identities_[at(n.a)], y = identities_[at(n.b)];
            mix(std::min(x, y));
            mix(std::max(x, y));
        } else if (n.operation == Operation::call) {
            mix(static_cast<std::uint64_t>(n.d));
            for (const std::int32_t argument : calls_[at(n.a)].arguments) mix(identities_[at(argument)]);
        } else if (operands[0] < 0) {
            mix(static_cast<std::uint64_t>(n.a + 1));
            // the sign of a switch goes by its argument, not by the order of recording
            if (n.operation == Operation::parameter)
                for (const Switch& s : switches_)
                    if (s.parameter == n.a) h = s.id;
        } else {
            for (const std::int32_t operand : operands)
                if (operand >= 0) mix(identities_[at(operand)]);
        }
        mix(std::hash<double>{}(n.value));
        identities_.push_back(h);
    }
    return identities_[at(index)];
}

inline double Recorder::value_of(const Node& n) const {
    const auto value = [&](std::int32_t index) { return values_[at(index)]; };
    switch (n.operation) {
        case Operation::constant: return n.value;
        case Operation::input: return inputs_[at(n.a)];
        case Operation::time: return time_;
        case Operation::parameter: return at(n.a) < parameter_values_.size() ? parameter_values_[at(n.a)] : 0.0;
        case Operation::add: return value(n.a) + value(n.b);
        case Operation::multiply: return value(n.a) * value(n.b);
        case Operation::divide: return value(n.a) / value(n.b);
        case Operation::square_root: return std::sqrt(value(n.a));
        case Operation::norm: return std::hypot(value(n.a), value(n.b), value(n.c));
        case Operation::sine: return std::sin(value(n.a));
        case Operation::cosine: return std::cos(value(n.a));
        case Operation::hyperbolic_sine: return std::sinh(value(n.a));
        case Operation::hyperbolic_cosine: return std::cosh(value(n.a));
        case Operation::hyperbolic_tangent: return std::tanh(value(n.a));
        case Operation::exponential: return std::exp(value(n.a));
        case Operation::logarithm: return std::log(value(n.a));
        case Operation::power: return std::pow(value(n.a), n.value);
        case Operation::angle: return std::atan2(value(n.a), value(n.b));
        case Operation::call:
            // not before a choice depends on it
            return results_[at(n.a)].empty() ? std::numeric_limits<double>::quiet_NaN() : results_[at(n.a)][at(n.d)];
        default: return std::numeric_limits<double>::quiet_NaN();
    }
}

inline double Recorder::followed(std::int32_t index) {
    if (std::isnan(values_[at(index)]))
        for (std::int32_t i = 0; i <= index; ++i) {
            const Node& n = node(i);
            if (n.operation == Operation::call && results_[at(n.a)].empty()) {
                const Call& c = calls_[at(n.a)];
                std::vector<double> x, y(at(c.function->outputs));
                for (const std::int32_t argument : c.arguments) x.push_back(values_[at(argument)]);
                (*c.function)(x.data(), y.data());
                results_[at(n.a)] = std::move(y);
            }
            values_[at(i)] = value_of(n);
        }
    return values_[at(index)];
}

inline std::pair<std::int32_t, int> Recorder::surface(std::int32_t index) const {
    int orientation = 1;
    while (node(index).operation == Operation::multiply) {
        const Node& n = node(index);
        const bool first = node(n.a).operation == Operation::constant;
        if (!first && node(n.b).operation != Operation::constant) break;
        if (node(first ? n.a : n.b).value < 0.0) orientation = -orientation;
        index = first ? n.b : n.a;
    }
    return {index, orientation};
}

inline std::optional<Expression> Recorder::weight(const Expression& x, const std::string& name) {
    if (blends_.empty() || x.is_constant()) return std::nullopt;
    const auto [argument, orientation] = surface(x.node());
    const auto found = blends_.find(identity(argument));
    if (found == blends_.end()) return std::nullopt;
    Blend& blend = found->second;
    if (blend.argument < 0) {
        blend.argument = argument;
        blend.name = name;
        blend.subject = subject_;
    }
    return orientation > 0 ? blend.weight : 1.0 - blend.weight;
}

inline Expression Recorder::sign(const Expression& x, const std::string& name, int tag) {
    if (x.is_constant()) return x.value() < 0.0 ? -1.0 : 1.0;
    if (purpose_ == Purpose::function) return record({Operation::sign, x.node(), -1, -1, name_index(name)});
    if (const auto above = weight(x, name)) return 2.0 * *above - 1.0;
    for (const Switch& known : switches_)
        if (!known.is_norm && known.argument == x.node()) return parameter(known.parameter);
    const int index = new_parameter();
    if (follows_) {
        parameter_values_.resize(at(index) + 1, 0.0);
        parameter_values_[at(index)] = followed(x.node()) < 0.0 ? -1.0 : 1.0;
    }
    const auto [argument, orientation] = surface(x.node());
    switches_.push_back(
        {x.node(), index, false, name, tag, subject_, identity(x.node()), identity(argument), orientation});
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
    if (purpose_ == Purpose::function) return record(node);
    for (const Switch& known : switches_) {
        const Node& other = this->node(known.argument);
        if (known.is_norm && other.a == node.a && other.b == node.b && other.c == node.c) return {this, known.argument};
    }
    node.d = new_parameter();
    const Expression result(this, intern(node));
    const std::uint64_t id = identity(result.node());
    switches_.push_back({result.node(), node.d, true, name, tag, subject_, id, id, 1});
    return result;
}

inline long Recorder::choose(Branch branch, long by_state) {
    branch.id = identity(branch.argument) + (branch.is_select ? 1 : 2);
    for (const Branch& known : branches_)
        if (known.id == branch.id && known.argument == branch.argument && known.is_select == branch.is_select)
            return known.choice;
    if (branch.is_select) {
        const auto [argument, orientation] = surface(branch.argument);
        branch.surface = identity(argument);
        branch.orientation = orientation;
    }
    const auto forced = forced_.find(branch.id);
    branch.choice = forced != forced_.end() ? forced->second : by_state;
    if (const auto side = sides_.find(branch.surface); branch.is_select && side != sides_.end())
        branch.choice = side->second * branch.orientation > 0 ? 1 : 0;
    branches_.push_back(std::move(branch));
    return branches_.back().choice;
}

inline long Recorder::side(const Expression& x, const std::string& name) {
    if (x.is_constant()) return x.value() > 0.0 ? 1 : 0;
    if (!follows_) throw Error("a choice between formulas was recorded where no state says which");
    return choose({x.node(), 0, true, 0, 1, name, subject_}, followed(x.node()) > 0.0 ? 1 : 0);
}

inline long Recorder::whole(const Expression& x, long lowest, long highest, const std::string& name) {
    const auto below = [&](double value) {
        const double least = static_cast<double>(lowest), most = static_cast<double>(highest);
        return value > least ? static_cast<long>(std::min(std::floor(value), most)) : lowest;
    };
    if (x.is_constant()) return below(x.value());
    if (!follows_) throw Error("a choice between formulas was recorded where no state says which");
    return choose({x.node(), 0, false, lowest, highest, name, subject_}, below(followed(x.node())));
}

inline std::vector<Expression> Recorder::call(const std::shared_ptr<const Callback>& function,
                                              std::span<const Expression> arguments) {
    Call call{function, {}};
    for (const Expression& x : arguments) call.arguments.push_back(node_of(x));
    const auto same = [&](const Call& c) { return c.function == function && c.arguments == call.arguments; };
    const auto known = std::find_if(calls_.begin(), calls_.end(), same);
    const auto index = static_cast<std::int32_t>(known - calls_.begin());
    if (known == calls_.end()) {
        calls_.push_back(std::move(call));
        results_.emplace_back();
    }
    std::vector<Expression> result;
    for (int i = 0; i < function->outputs; ++i) result.push_back(record({Operation::call, index, -1, -1, i}));
    return result;
}

}  // namespace rbdyn
