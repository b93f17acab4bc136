// A recorded function: written once over any number type, kept as data, applied in any number type.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/expression/expression.hpp"

namespace rbdyn {

/// A function of several variables with several results, recorded by calling it once with expressions.
class Function {
public:
    Function() = default;

    /// Records `f(std::vector<Expression> inputs) -> std::vector<Expression>`.
    template <class F>
    static Function record(int inputs, F&& f) {
        Function result;
        auto recorder = std::make_shared<Recorder>();
        std::vector<Expression> x;
        for (int i = 0; i < inputs; ++i) x.push_back(recorder->input(i));
        for (const Expression& y : f(x)) result.outputs_.push_back(recorder->node_of(y));
        result.inputs_ = inputs;
        result.recorder_ = std::move(recorder);
        return result;
    }

    explicit operator bool() const { return recorder_ != nullptr; }
    int inputs() const { return inputs_; }
    int outputs() const { return static_cast<int>(outputs_.size()); }

    /// Whether any result depends on an input.
    bool depends_on(int input) const {
        std::vector<bool> depends(static_cast<std::size_t>(recorder_->size()), false);
        for (std::int32_t n = 0; n < recorder_->size(); ++n) {
            const Node& node = recorder_->node(n);
            bool d = node.operation == Operation::input && node.a == input;
            if (node.operation != Operation::input && node.operation != Operation::parameter)
                for (std::int32_t operand : {node.a, node.b, node.c})
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
        using std::cos, std::exp, std::log, std::pow, std::sin, std::sqrt;
        std::vector<S> y(static_cast<std::size_t>(recorder_->size()));
        const auto at = [&](std::int32_t n) -> S& { return y[static_cast<std::size_t>(n)]; };
        for (std::int32_t n = 0; n < recorder_->size(); ++n) {
            const Node& node = recorder_->node(n);
            switch (node.operation) {
                case Operation::constant: at(n) = node.value; break;
                case Operation::input: at(n) = x[static_cast<std::size_t>(node.a)]; break;
                case Operation::time: throw Error("a recorded function takes time as one of its inputs");
                case Operation::parameter: at(n) = locked(node.a, y); break;
                case Operation::add: at(n) = at(node.a) + at(node.b); break;
                case Operation::multiply: at(n) = at(node.a) * at(node.b); break;
                case Operation::divide: at(n) = at(node.a) / at(node.b); break;
                case Operation::square_root: at(n) = sqrt(at(node.a)); break;
                case Operation::norm: {
                    const Vector3Of<S> v{at(node.a), at(node.b), at(node.c)};
                    at(n) = length(v, "norm");
                    break;
                }
                case Operation::sine: at(n) = sin(at(node.a)); break;
                case Operation::cosine: at(n) = cos(at(node.a)); break;
                case Operation::exponential: at(n) = exp(at(node.a)); break;
                case Operation::logarithm: at(n) = log(at(node.a)); break;
                case Operation::power: at(n) = pow(at(node.a), node.value); break;
            }
        }
        std::vector<S> result;
        for (std::int32_t out : outputs_) result.push_back(at(out));
        return result;
    }

    /// The derivatives of all results with respect to one input, as another recorded function.
    Function derivative(int input) const {
        Function self = *this;
        return record(inputs_, [&](const std::vector<Expression>& x) { return self.differentiated(x, input); });
    }

private:
    /// The locked sign that parameter `index` stands for.
    template <class S>
    S locked(int index, const std::vector<S>& y) const {
        for (const Switch& s : recorder_->switches())
            if (s.parameter == index && !s.is_norm) return locked_sign(y[static_cast<std::size_t>(s.argument)], s.name);
        return S(0.0);
    }

    std::vector<Expression> differentiated(const std::vector<Expression>& x, int input) const {
        const auto size = static_cast<std::size_t>(recorder_->size());
        std::vector<Expression> y(size), d(size);
        const auto at = [](std::int32_t n) { return static_cast<std::size_t>(n); };
        for (std::int32_t n = 0; n < recorder_->size(); ++n) {
            const Node& node = recorder_->node(n);
            const auto a = [&] { return y[at(node.a)]; };
            const auto b = [&] { return y[at(node.b)]; };
            const auto da = [&] { return d[at(node.a)]; };
            const auto db = [&] { return d[at(node.b)]; };
            Expression &v = y[at(n)], &dv = d[at(n)];
            dv = 0.0;
            switch (node.operation) {
                case Operation::constant: v = node.value; break;
                case Operation::input:
                    v = x[at(node.a)];
                    dv = node.a == input ? 1.0 : 0.0;
                    break;
                case Operation::time: break;
                case Operation::parameter: v = locked(node.a, y); break;
                case Operation::add:
                    v = a() + b();
                    dv = da() + db();
                    break;
                case Operation::multiply:
                    v = a() * b();
                    dv = da() * b() + a() * db();
                    break;
                case Operation::divide:
                    v = a() / b();
                    dv = (da() - v * db()) / b();
                    break;
                case Operation::square_root:
                    v = sqrt(a());
                    dv = da() / (2.0 * v);
                    break;
                case Operation::norm: {
                    const Vector3Of<Expression> u{y[at(node.a)], y[at(node.b)], y[at(node.c)]};
                    const Vector3Of<Expression> du{d[at(node.a)], d[at(node.b)], d[at(node.c)]};
                    v = length(u, "norm");
                    dv = dot(u, du) / v;
                    break;
                }
                case Operation::sine:
                    v = sin(a());
                    dv = cos(a()) * da();
                    break;
                case Operation::cosine:
                    v = cos(a());
                    dv = -(sin(a()) * da());
                    break;
                case Operation::exponential:
                    v = exp(a());
                    dv = v * da();
                    break;
                case Operation::logarithm:
                    v = log(a());
                    dv = da() / a();
                    break;
                case Operation::power:
                    v = pow(a(), node.value);
                    dv = node.value * pow(a(), node.value - 1.0) * da();
                    break;
            }
        }
        std::vector<Expression> result;
        for (std::int32_t out : outputs_) result.push_back(d[at(out)]);
        return result;
    }

    int inputs_ = 0;
    std::vector<std::int32_t> outputs_;
    std::shared_ptr<Recorder> recorder_;
};

/// A number, or a number that changes in time.
class TimeFunction {
public:
    TimeFunction(double constant = 0.0) : constant_(constant) {}
    TimeFunction(Function function) : function_(std::move(function)), rate_(function_.derivative(0)) {
        if (!function_.depends_on(0)) {
            const double zero = 0.0;
            constant_ = function_(std::span<const double>(&zero, 1))[0];
            function_ = {};
        }
    }
    /// Any callable over the number type: [](const auto& t) { return 0.5 * sin(t); }
    template <class F>
    requires(std::is_invocable_v<F, const Expression&> && !std::is_same_v<std::decay_t<F>, Function>) TimeFunction(F f)
        : TimeFunction(Function::record(
              1, [&](const std::vector<Expression>& x) { return std::vector<Expression>{f(x[0])}; })) {}

    bool is_constant() const { return !function_; }
    bool is_zero() const { return is_constant() && constant_ == 0.0; }
    double constant() const { return constant_; }

    template <class S>
    S operator()(const S& t) const {
        return function_ ? function_(std::span<const S>(&t, 1))[0] : S(constant_);
    }
    template <class S>
    S rate(const S& t) const {
        return function_ ? rate_(std::span<const S>(&t, 1))[0] : S(0.0);
    }

private:
    double constant_ = 0.0;
    Function function_, rate_;
};

}  // namespace rbdyn
