// A recorded function: written once over any number type, kept as data, applied in any number type.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/expression/condition.hpp"
#include "rbdyn/expression/derivative.hpp"
#include "rbdyn/expression/recording.hpp"

namespace rbdyn {

/// A function of several variables with several results, recorded by calling it once with expressions.
class Function {
public:
    Function() = default;

    /// Records `f(std::vector<Expression> inputs) -> std::vector<Expression>`.
    template <class F>
    static Function record(int inputs, F&& f) {
        auto recorder = std::make_shared<Recorder>(Recorder::Purpose::function);
        const recording::Active active(*recorder);
        std::vector<Expression> x;
        for (int i = 0; i < inputs; ++i) x.push_back(recorder->input(i));
        Function result;
        for (const Expression& y : f(x)) result.outputs_.push_back(recorder->node_of(y));
        result.inputs_ = inputs;
        result.recorder_ = std::move(recorder);
        result.prepare();
        return result;
    }

    /// Records `f(Recorder&) -> pair(results, number of inputs)`, which makes its inputs as it needs them.
    template <class F>
    static Function record_growing(F&& f) {
        int inputs = 0;
        Function result = record(0, [&](const std::vector<Expression>&) {
            auto [outputs, count] = f(*recording::active());
            inputs = count;
            return outputs;
        });
        result.inputs_ = inputs;
        return result;
    }

    explicit operator bool() const { return recorder_ != nullptr; }
    int inputs() const { return inputs_; }
    int outputs() const { return static_cast<int>(outputs_.size()); }

    /// The numbers of the user's that it uses by reference.
    const std::vector<Parameter>& parameters() const { return recorder_->cells(); }
    /// What they are: now, or when it was frozen().
    void give(GivenNumbers& numbers) const {
        if (!recorder_) return;
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(parameters().size()); ++i)
            numbers.add(recorder_->cells()[at(i)], cell(i));
    }
    /// Makes what is being recorded depend on their values.
    void settle() const {
        Numbers* numbers = Numbers::active();
        for (std::int32_t i = 0; numbers != nullptr && i < static_cast<std::int32_t>(parameters().size()); ++i)
            (void)numbers->number(recorder_->cells()[at(i)], cell(i)).value();
    }
    /// The same function with the numbers of the user's as they are now, whatever becomes of them.
    Function frozen() const {
        Function result = *this;
        if (!recorder_ || values_ || recorder_->cells().empty()) return result;
        auto values = std::make_shared<std::vector<double>>();
        for (const Parameter& p : recorder_->cells()) values->push_back(p.value());
        result.values_ = std::move(values);
        return result;
    }

    /// The results if they are the same for all inputs, with the numbers of the user's as they are now: what a factor
    /// of zero leaves.
    [[gnu::cold]] std::optional<std::vector<double>> constants() const {
        std::vector<double> result;
        for (const std::int32_t out : outputs_)
            if (const Node& node = recorder_->node(out); node.operation == Operation::constant)
                result.push_back(node.value);
        if (result.size() == outputs_.size()) return result;
        if (recorder_->cells().empty()) return std::nullopt;
        // as where equations are recorded: a number that happens to be one of the constants is none
        GivenNumbers given;
        give(given);
        Numbers own(given);
        const Numbers::Active active(Numbers::active() != nullptr ? Numbers::active() : &own);
        Recorder scratch(Recorder::Purpose::function);
        std::vector<Expression> x;
        for (int i = 0; i < inputs_; ++i) x.push_back(scratch.input(i));
        result.clear();
        for (const Expression& y : (*this)(std::span<const Expression>(x))) {
            if (!y.is_constant()) return std::nullopt;
            result.push_back(y.constant().number.hi);
        }
        return result;
    }

    /// Whether any result depends on an input.
    bool depends_on(int input) const {
        std::vector<bool> depends(static_cast<std::size_t>(recorder_->size()), false);
        for (std::int32_t n = 0; n < recorder_->size(); ++n) {
            const Node& node = recorder_->node(n);
            bool d = node.operation == Operation::input && node.a == input;
            for (std::int32_t operand : node.operands())
                if (operand >= 0) d = d || depends[static_cast<std::size_t>(operand)];
            depends[static_cast<std::size_t>(n)] = d;
        }
        for (std::int32_t out : outputs_)
            if (depends[static_cast<std::size_t>(out)]) return true;
        return false;
    }

    /// The results for given inputs, in numbers of type S; expressions are recorded where the inputs were.
    template <class S>
    std::vector<S> operator()(std::span<const S> x) const {
        std::vector<S> y(static_cast<std::size_t>(recorder_->size()));
        if (!distinguishes_ || into_function(x)) {
            for (std::int32_t n = 0; n < recorder_->size(); ++n) y[at(n)] = applied<S>(n, x, y);
        } else {
            // what is needed, in the order in which it is needed: the other side of a case is not looked at
            std::vector<char> known(y.size(), 0);
            for (const std::int32_t out : outputs_) need<S>(out, x, y, known);
        }
        std::vector<S> result;
        for (std::int32_t out : outputs_) result.push_back(y[at(out)]);
        return result;
    }

    /// The derivatives of all results with respect to one input, as another recorded function.
    Function derivative(int input) const {
        const recording::WideFolding all_digits;
        return record(inputs_, [&](const std::vector<Expression>& x) { return differentiated(x, input); });
    }

    /// What signs and choices between two formulas depend on: they change where one of these passes zero.
    Function distinctions() const {
        Function result = *this;
        result.outputs_.clear();
        for (std::int32_t n = 0; n < size(); ++n)
            if (node(n).operation == Operation::sign || node(n).operation == Operation::select)
                result.outputs_.push_back(node(n).a);
        return result;
    }

    // --- as data ---

    /// Node i of the recorded operations, which come before what uses them.
    std::int32_t size() const { return recorder_->size(); }
    const Node& node(std::int32_t i) const { return recorder_->node(i); }
    const std::vector<std::int32_t>& output_nodes() const { return outputs_; }
    const std::vector<std::string>& names() const { return recorder_->names(); }
    /// A function from its data. Throws InvalidInput if they are none.
    static Function from_data(int inputs, const std::vector<Node>& nodes, const std::vector<std::int32_t>& outputs,
                              const std::vector<std::string>& names, const std::vector<Parameter>& parameters);
    /// The operations, one a line.
    std::string text() const;

    /// Whether they do the same with their inputs, with the same parameters.
    bool operator==(const Function& other) const {
        if (recorder_ == other.recorder_) return true;
        if (!recorder_ || !other.recorder_) return false;
        if (inputs_ != other.inputs_ || outputs_ != other.outputs_ || size() != other.size() ||
            names() != other.names() || parameters().size() != other.parameters().size())
            return false;
        for (std::int32_t n = 0; n < size(); ++n)
            if (!(node(n) == other.node(n))) return false;
        for (std::size_t i = 0; i < parameters().size(); ++i) {
            const Parameter &a = parameters()[i], &b = other.parameters()[i];
            if (!a.is(b) && (a.value() != b.value() || a.name() != b.name())) return false;
        }
        return true;
    }

private:
    static std::size_t at(std::int32_t n) { return static_cast<std::size_t>(n); }

    void prepare() {
        for (std::int32_t n = 0; n < recorder_->size(); ++n) {
            const Operation o = recorder_->node(n).operation;
            distinguishes_ = distinguishes_ || o == Operation::select || o == Operation::whole;
        }
    }

    double cell(std::int32_t index) const {
        return values_ ? (*values_)[at(index)] : recorder_->cells()[at(index)].value();
    }
    const std::string& name(std::int32_t index) const { return recorder_->names()[at(index)]; }

    /// Whether the results become part of another function, which keeps both sides of a case.
    template <class S>
    static bool into_function(std::span<const S> x) {
        if constexpr (std::is_same_v<S, Expression>)
            for (const Expression& input : x)
                if (!input.is_constant()) return input.recorder()->purpose() == Recorder::Purpose::function;
        return false;
    }

    template <class S>
    void need(std::int32_t wanted, std::span<const S> x, std::vector<S>& y, std::vector<char>& known) const {
        std::vector<std::int32_t> todo{wanted};
        while (!todo.empty()) {
            const std::int32_t n = todo.back();
            if (known[at(n)]) {
                todo.pop_back();
                continue;
            }
            const Node& node = recorder_->node(n);
            const std::size_t before = todo.size();
            if (node.operation == Operation::select) {
                if (!known[at(node.a)]) {
                    todo.push_back(node.a);
                    continue;
                }
                if constexpr (std::is_same_v<S, Expression>)
                    if (const auto weight = weight_of(y[at(node.a)], name(node.d))) {
                        for (const std::int32_t side : {node.b, node.c})
                            if (!known[at(side)]) todo.push_back(side);
                        if (todo.size() > before) continue;
                        y[at(n)] = blended(
                            *weight, [&] { return y[at(node.b)]; }, [&] { return y[at(node.c)]; });
                        known[at(n)] = 1;
                        todo.pop_back();
                        continue;
                    }
                const std::int32_t side = above(y[at(node.a)], name(node.d)) ? node.b : node.c;
                if (!known[at(side)]) {
                    todo.push_back(side);
                    continue;
                }
                y[at(n)] = y[at(side)];
            } else {
                for (const std::int32_t operand : node.operands())
                    if (operand >= 0 && !known[at(operand)]) todo.push_back(operand);
                if (todo.size() > before) continue;
                y[at(n)] = applied<S>(n, x, y);
            }
            known[at(n)] = 1;
            todo.pop_back();
        }
    }

    static std::optional<Expression> weight_of(const Expression& x, const std::string& name) {
        return x.is_constant() ? std::nullopt : x.recorder()->weight(x, name);
    }
    template <class S>
    static bool above(const S& x, const std::string& name) {
        if constexpr (std::is_same_v<S, Expression>)
            return x.is_constant() ? x.is_positive() : x.recorder()->side(x, name) > 0;
        else
            return x > S(0.0);
    }
    template <class S>
    static S constant_of(const Node& node) {
        if constexpr (std::is_same_v<S, Expression>)
            return node.constant();
        else
            return exactly<S>({node.value, node.rest});
    }
    template <class S>
    static S whole_of(const S& x) {
        using std::floor;
        return floor(x);
    }

    /// What node n is, its operands known.
    template <class S>
    S applied(std::int32_t n, std::span<const S> x, const std::vector<S>& y) const {
        using std::cos, std::exp, std::log, std::pow, std::sin, std::sqrt, std::sinh, std::cosh, std::tanh;
        const Node& node = recorder_->node(n);
        const auto a = [&]() -> const S& { return y[at(node.a)]; };
        const auto b = [&]() -> const S& { return y[at(node.b)]; };
        switch (node.operation) {
            case Operation::constant: return constant_of<S>(node);
            case Operation::input: return x[at(node.a)];
            case Operation::cell:
                if constexpr (std::is_same_v<S, Expression>)
                    if (Numbers* numbers = Numbers::active())
                        return numbers->number(recorder_->cells()[at(node.a)], cell(node.a));
                return S(cell(node.a));
            case Operation::add: return a() + b();
            case Operation::multiply: return a() * b();
            case Operation::divide: return a() / b();
            case Operation::square_root: return sqrt(a());
            case Operation::norm: {
                const Vector3Of<S> v{a(), b(), y[at(node.c)]};
                return length(v, "norm");
            }
            case Operation::sine: return sin(a());
            case Operation::cosine: return cos(a());
            case Operation::hyperbolic_sine: return sinh(a());
            case Operation::hyperbolic_cosine: return cosh(a());
            case Operation::hyperbolic_tangent: return tanh(a());
            case Operation::exponential: return exp(a());
            case Operation::logarithm: return log(a());
            case Operation::power: return pow(a(), node.value);
            case Operation::angle: return angle_of(a(), b());
            case Operation::sign: return locked_sign(a(), name(node.d));
            case Operation::whole: return whole_of(a());
            case Operation::select:
                if constexpr (std::is_same_v<S, Expression>)
                    return rbdyn::select(
                        a(), b, [&] { return y[at(node.c)]; }, name(node.d));
                [[fallthrough]];
            default: throw Error("a recorded function takes time, and what is called back, as its inputs");
        }
    }

    template <class S>
    static S angle_of(const S& y, const S& x) {
        using std::atan2;
        return atan2(y, x);
    }
    static Expression angle_of(const Expression& y, const Expression& x) { return recording::angle(y, x); }

    std::vector<Expression> differentiated(const std::vector<Expression>& x, int input) const;

    int inputs_ = 0;
    std::vector<std::int32_t> outputs_;
    std::shared_ptr<Recorder> recorder_;
    bool distinguishes_ = false;                         // between cases
    std::shared_ptr<const std::vector<double>> values_;  // of the parameters, frozen
};

inline std::vector<Expression> Function::differentiated(const std::vector<Expression>& x, int input) const {
    const auto size = static_cast<std::size_t>(recorder_->size());
    std::vector<Expression> y(size), d(size);
    Recorder* r = x[0].recorder();
    for (std::int32_t n = 0; n < recorder_->size(); ++n) {
        const Node& node = recorder_->node(n);
        std::array<Expression, 3> operands, slopes;
        for (std::size_t i = 0; i < 3; ++i)
            if (const std::int32_t operand = node.operands()[i]; operand >= 0) {
                operands[i] = y[at(operand)];
                slopes[i] = d[at(operand)];
            }
        Expression &v = y[at(n)], &dv = d[at(n)];
        dv = 0.0;
        // the same operation in the new recording; cases and cells are kept as such
        switch (node.operation) {
            case Operation::cell:
                v = values_ ? Expression(cell(node.a)) : r->cell(recorder_->cells()[at(node.a)]);
                break;
            case Operation::select:
                v = applied<Expression>(n, x, y);
                dv = select(
                    operands[0], [&] { return slopes[1]; }, [&] { return slopes[2]; }, name(node.d));
                break;
            default: v = applied<Expression>(n, x, y); break;
        }
        if (node.operation == Operation::input)
            dv = node.a == input ? 1.0 : 0.0;
        else if (node.operation != Operation::select)
            dv = recording::derivative(node, v, operands, slopes);
    }
    std::vector<Expression> result;
    for (std::int32_t out : outputs_) result.push_back(d[at(out)]);
    return result;
}

inline Function Function::from_data(int inputs, const std::vector<Node>& nodes,
                                    const std::vector<std::int32_t>& outputs, const std::vector<std::string>& names,
                                    const std::vector<Parameter>& parameters) {
    const auto check = [&](bool good, double number) {
        require(good, "Function", "index in its data", number,
                "a node uses earlier nodes, inputs, names and parameters");
    };
    auto recorder = std::make_shared<Recorder>(Recorder::Purpose::function);
    for (const std::string& name : names) recorder->name_index(name);
    for (const Parameter& p : parameters) recorder->cell(p);
    // nodes of cells come first in the new recording, so that the others move
    std::vector<std::int32_t> moved;
    for (Node node : nodes) {
        switch (node.operation) {
            case Operation::constant:
            case Operation::input: break;
            case Operation::cell: check(node.a >= 0 && at(node.a) < parameters.size(), node.a); break;
            case Operation::time:
            case Operation::parameter:
            case Operation::call: check(false, static_cast<double>(moved.size())); break;
            case Operation::sign:
            case Operation::select:
            case Operation::whole: check(node.d >= 0 && at(node.d) < names.size(), node.d); break;
            default: break;
        }
        if (node.operation == Operation::input) check(node.a >= 0 && node.a < inputs, node.a);
        const auto used = node.operands();
        for (std::size_t i = 0; i < 3; ++i) {
            if (used[i] < 0) continue;
            check(at(used[i]) < moved.size(), used[i]);
            (i == 0 ? node.a : i == 1 ? node.b : node.c) = moved[at(used[i])];
        }
        moved.push_back(recorder->record(node).node());
    }
    Function result;
    result.inputs_ = inputs;
    for (const std::int32_t out : outputs) {
        check(out >= 0 && at(out) < moved.size(), out);
        result.outputs_.push_back(moved[at(out)]);
    }
    result.recorder_ = std::move(recorder);
    result.prepare();
    return result;
}

inline std::string Function::text() const {
    static const char* words[] = {"",     "input", "time",    "parameter", "",     "+",     "*",    "/",
                                  "sqrt", "norm",  "sin",     "cos",       "sinh", "cosh",  "tanh", "exp",
                                  "log",  "^",     "arctan2", "call",      "sign", "where", "floor"};
    std::string out = std::to_string(inputs_) + " inputs, " + std::to_string(outputs()) + " results\n";
    for (std::int32_t n = 0; n < size(); ++n) {
        const Node& i = node(n);
        out += "  n" + std::to_string(n) + " = ";
        const auto operand = [](std::int32_t k) { return "n" + std::to_string(k); };
        switch (i.operation) {
            case Operation::constant: out += rbdyn::text(i.value); break;
            case Operation::input: out += "input " + std::to_string(i.a); break;
            case Operation::cell:
                out += "parameter " + recorder_->cells()[at(i.a)].name() + " = " + rbdyn::text(cell(i.a));
                break;
            case Operation::add:
            case Operation::multiply:
            case Operation::divide:
                out += operand(i.a) + " " + words[static_cast<int>(i.operation)] + " " + operand(i.b);
                break;
            case Operation::power: out += operand(i.a) + " ^ " + rbdyn::text(i.value); break;
            case Operation::select:
                out += operand(i.b) + " where " + operand(i.a) + " > 0, else " + operand(i.c);
                break;
            default:
                out += words[static_cast<int>(i.operation)];
                for (const std::int32_t k : i.operands())
                    if (k >= 0) out += " " + operand(k);
                break;
        }
        // the event where it changes
        const bool switches =
            i.operation == Operation::sign || i.operation == Operation::select || i.operation == Operation::whole;
        if (switches && !name(i.d).empty()) out += "  (" + name(i.d) + ")";
        out += '\n';
    }
    for (std::size_t k = 0; k < outputs_.size(); ++k)
        out += "  result " + std::to_string(k) + " = n" + std::to_string(outputs_[k]) + '\n';
    return out;
}

}  // namespace rbdyn
