// A number that may change in time.
#pragma once

#include <span>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/node.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A number, or a number that changes in time: a recorded function of t.
class TimeFunction {
public:
    TimeFunction(double constant = 0.0) : constant_(constant) {}
    TimeFunction(Function function);
    /// Any callable over the number type: [](const auto& t) { return 0.5 * sin(t); }
    template <class F>
    requires(Takes<F, Expression> && !std::is_same_v<std::decay_t<F>, Function> &&
             !std::is_same_v<std::decay_t<F>, TimeFunction>) TimeFunction(F f)
        : TimeFunction(Function::record(1, [&](const std::vector<Expression>& x) {
              return std::vector<Expression>{recording::number(f, x[0])};
          })) {}
    template <class F>
    requires(!Takes<F, Expression> && MeantAsFunctor<F, TimeFunction, Function, double>) TimeFunction(F) {
        static_assert(recording::fits<F>,
                      "a function of time is called as f(t), with a number: take it as const auto&");
    }

    bool is_constant() const { return is_constant_; }
    bool is_zero() const { return is_constant() && constant_ == 0.0; }
    double constant() const { return constant_; }
    const Function& function() const { return function_; }
    /// With the numbers of the user's as they are now.
    TimeFunction frozen() const;

    template <class S>
    S operator()(const S& t) const {
        const bool is_formula = function_ && (!is_constant_ || std::is_same_v<S, Expression>);
        return is_formula ? function_(std::span<const S>(&t, 1))[0] : S(constant_);
    }
    template <class S>
    S rate(const S& t) const {
        return is_constant_ ? S(0.0) : rate_(std::span<const S>(&t, 1))[0];
    }

    bool operator==(const TimeFunction& other) const;

private:
    bool is_constant_ = true;
    double constant_ = 0.0;
    Function function_, rate_;
};

}  // namespace rbdyn::inline RBDYN_FORM
