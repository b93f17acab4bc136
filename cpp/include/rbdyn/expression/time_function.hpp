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
    TimeFunction(Function function) : function_(std::move(function)), rate_(function_.derivative(0)) {
        if (!function_.depends_on(0) && function_.parameters().empty()) {
            const double zero = 0.0;
            constant_ = function_(std::span<const double>(&zero, 1))[0];
            function_ = {};
        }
    }
    /// Any callable over the number type: [](const auto& t) { return 0.5 * sin(t); }
    template <class F>
    requires(std::is_invocable_v<F, const Expression&> && !std::is_same_v<std::decay_t<F>, Function> &&
             !std::is_same_v<std::decay_t<F>, TimeFunction>) TimeFunction(F f)
        : TimeFunction(Function::record(
              1, [&](const std::vector<Expression>& x) { return std::vector<Expression>{f(x[0])}; })) {}

    bool is_constant() const { return !function_; }
    bool is_zero() const { return is_constant() && constant_ == 0.0; }
    double constant() const { return constant_; }
    const Function& function() const { return function_; }
    /// With the numbers of the user's as they are now.
    TimeFunction frozen() const {
        if (!function_ || function_.parameters().empty()) return *this;
        return TimeFunction(Frozen{}, function_.frozen());
    }

    template <class S>
    S operator()(const S& t) const {
        return function_ ? function_(std::span<const S>(&t, 1))[0] : S(constant_);
    }
    template <class S>
    S rate(const S& t) const {
        return function_ ? rate_(std::span<const S>(&t, 1))[0] : S(0.0);
    }

    bool operator==(const TimeFunction& other) const {
        return constant_ == other.constant_ && function_ == other.function_;
    }

private:
    struct Frozen {};
    TimeFunction(Frozen, Function function) : function_(std::move(function)), rate_(function_.derivative(0)) {
        const auto same = function_.constants();
        if (!same) return;
        constant_ = same->front();
        function_ = {};
    }

    double constant_ = 0.0;
    Function function_, rate_;
};

}  // namespace rbdyn
