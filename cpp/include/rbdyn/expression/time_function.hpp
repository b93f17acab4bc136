// A number that may change in time.
#pragma once

#include <type_traits>
#include <utility>

#include "rbdyn/expression/function.hpp"

namespace rbdyn {

/// A number, or a number that changes in time: a recorded function of t.
class TimeFunction {
public:
    TimeFunction(double constant = 0.0) : constant_(constant) {}
    TimeFunction(Function function)
        : is_constant_(false), function_(std::move(function)), rate_(function_.derivative(0)) {
        if (!function_.depends_on(0) && function_.parameters().empty()) {
            const double zero = 0.0;
            constant_ = function_(std::span<const double>(&zero, 1))[0];
            is_constant_ = true;
            function_ = {};
        }
    }
    /// Any callable over the number type: [](const auto& t) { return 0.5 * sin(t); }
    template <class F>
    requires(std::is_invocable_v<F, const Expression&> && !std::is_same_v<std::decay_t<F>, Function> &&
             !std::is_same_v<std::decay_t<F>, TimeFunction>) TimeFunction(F f)
        : TimeFunction(Function::record(
              1, [&](const std::vector<Expression>& x) { return std::vector<Expression>{f(x[0])}; })) {}

    bool is_constant() const { return is_constant_; }
    bool is_zero() const { return is_constant() && constant_ == 0.0; }
    double constant() const { return constant_; }
    const Function& function() const { return function_; }
    /// With the numbers of the user's as they are now.
    TimeFunction frozen() const {
        TimeFunction result = *this;
        if (is_constant_ || function_.parameters().empty()) return result;
        result.function_ = function_.frozen();
        result.rate_ = rate_.frozen();
        const auto same = result.function_.constants();
        result.is_constant_ = same.has_value();
        if (same) result.constant_ = same->front();
        // the formula remains: equations that are recorded hold for other numbers, too
        if (result.is_zero()) result.function_ = {};
        return result;
    }

    template <class S>
    S operator()(const S& t) const {
        const bool is_formula = function_ && (!is_constant_ || std::is_same_v<S, Expression>);
        return is_formula ? function_(std::span<const S>(&t, 1))[0] : S(constant_);
    }
    template <class S>
    S rate(const S& t) const {
        return is_constant_ ? S(0.0) : rate_(std::span<const S>(&t, 1))[0];
    }

    bool operator==(const TimeFunction& other) const {
        return constant_ == other.constant_ && function_ == other.function_;
    }

private:
    bool is_constant_ = true;
    double constant_ = 0.0;
    Function function_, rate_;
};

}  // namespace rbdyn
