// A recorded function: written once over any number type, kept as data, applied in any number type.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/condition.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/recording.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct SignFactors;

/// A function of several variables with several results, recorded by calling it once with expressions.
class Function {
public:
    Function() = default;
    // a move copies: what was moved from stays what it was
    Function(const Function&) = default;
    Function& operator=(const Function&) = default;

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
    void give(GivenNumbers& numbers) const;
    /// Makes what is being recorded depend on their values.
    void settle() const;
    /// The same function with the numbers of the user's as they are now, whatever becomes of them.
    Function frozen() const;

    /// The results if they are the same for all inputs, with the numbers of the user's as they are now: what a factor
    /// of zero leaves.
    [[gnu::cold]] std::optional<std::vector<double>> constants() const;

    /// Whether any result depends on an input.
    bool depends_on(int input) const;

    /// The results for given inputs, in numbers of type S; expressions are recorded where the inputs were.
    template <class S>
    std::vector<S> operator()(std::span<const S> x) const {
        if (!recorder_) refuse_empty();
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

    /// A node in the recording that its inputs and operands are in now, cases and numbers of the user's kept as such.
    Expression again(std::int32_t n, std::span<const Expression> x, const std::vector<Expression>& y) const;
    /// The same with other operations in place of some: `instead` of node n, from all before it, if any.
    Function rewritten(const std::function<std::optional<Expression>(std::int32_t n, const std::vector<Expression>& y)>&
                           instead) const;
    /// The same without the operations that no result uses.
    Function trimmed() const;

    /// The derivatives of all results with respect to one input, as another recorded function.
    Function derivative(int input) const;

    /// What signs and choices between two formulas depend on: they change where one of these passes zero.
    Function distinctions() const;

    // --- as data ---

    /// Node i of the recorded operations, which come before what uses them.
    std::int32_t size() const { return recorder_->size(); }
    const Node& node(std::int32_t i) const { return recorder_->node(i); }
    const std::vector<std::int32_t>& output_nodes() const { return outputs_; }
    const std::vector<std::string>& names() const { return recorder_->names(); }
    /// A function from its data. Throws InvalidInput if they are none.
    static Function from_data(int inputs, const std::vector<Node>& nodes, const std::vector<std::int32_t>& outputs,
                              const std::vector<std::string>& names, const std::vector<Parameter>& parameters);
    /// The same with its parameters first and names in the order in which operations use them: what is compared, and
    /// written to files.
    [[gnu::cold]] Function canonical() const;
    /// The operations, one a line.
    std::string text() const;

    /// Whether they do the same with their inputs, with the same parameters.
    bool operator==(const Function& other) const;

private:
    friend SignFactors sign_factors(const Function& function);
    static std::size_t at(std::int32_t n) { return static_cast<std::size_t>(n); }

    [[noreturn, gnu::cold]] static void refuse_empty();
    void prepare();
    /// Whether all operations are the same, in the same order.
    bool is_same(const Function& other) const;

    double cell(std::int32_t index) const;
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

    static std::optional<Expression> weight_of(const Expression& x, const std::string& name);
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
        using std::asinh, std::atanh, std::cos, std::cosh, std::exp, std::expm1, std::log, std::log1p, std::pow,
            std::sin, std::sinh, std::sqrt, std::tanh;
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
                // squares may leave the numbers; of three at once a NaN would be nothing
                if constexpr (std::is_same_v<S, double>) return std::hypot(a(), std::hypot(b(), y[at(node.c)]));
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
            case Operation::expm1: return expm1(a());
            case Operation::log1p: return log1p(a());
            case Operation::arsinh: return asinh(a());
            case Operation::artanh: return atanh(a());
            case Operation::raise: return pow(a(), b());
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

}  // namespace rbdyn::inline RBDYN_FORM
