// Loads along joints: between a body and its parent, on both of them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A number, or a function (t, q, rate) of time, the joint's coordinate and its rate, recorded or called back.
class JointLoad {
public:
    JointLoad(double constant = 0.0) : constant_(constant) {}
    JointLoad(Given constant) : constant_(std::move(constant)) {}
    explicit JointLoad(Function function, std::string name = "function");
    explicit JointLoad(std::shared_ptr<const Callback> callback);
    /// [](const auto& t, const auto& q, const auto& rate) { return ...; }
    template <class F>
    requires Takes<F, Expression, Expression, Expression> JointLoad(F f)
        : JointLoad(Function::record(inputs, [&](const std::vector<Expression>& x) {
              return std::vector<Expression>{recording::number(f, x[0], x[1], x[2])};
          })) {}
    template <class F>
    requires(!Takes<F, Expression, Expression, Expression> &&
             MeantAsFunctor<F, JointLoad, Given, Function, std::shared_ptr<const Callback>>) explicit JointLoad(F) {
        static_assert(recording::fits<F>,
                      "the function of a JointTorque or JointForce is called as f(t, q, rate), three numbers: take "
                      "each as const auto&");
    }

    bool is_constant() const { return !function_ && !callback_; }
    const Given& constant() const { return constant_; }
    const Function& function() const { return function_; }
    const std::shared_ptr<const Callback>& callback() const { return callback_; }
    const std::string& name() const { return name_; }
    /// Whether there is any.
    bool present() const { return !is_constant() || !constant_.is_zero(); }
    void give(GivenNumbers& numbers) const;
    /// Throws unless a number is finite. `kind`: what it is; `unit`: what it is given in.
    void validate(const std::string& kind, const std::string& unit) const;

    template <class S>
    S operator()(const S& t, const S& q, const S& rate) const {
        if (is_constant()) return constant_.in<S>();
        const S x[inputs] = {t, q, rate};
        if (function_) return function_(std::span<const S>(x, inputs))[0];
        if constexpr (std::is_same_v<S, Expression>) {
            for (const Expression& e : x)
                if (!e.is_constant()) return e.recorder()->call(callback_, std::span<const Expression>(x, inputs))[0];
            throw Error("a function is called back with numbers that vary");
        } else {
            const double in[inputs] = {static_cast<double>(t), static_cast<double>(q), static_cast<double>(rate)};
            double out = 0.0;
            (*callback_)(in, &out);
            return S(out);
        }
    }

    bool operator==(const JointLoad& other) const;

protected:
    static constexpr int inputs = 3;
    JointLoad frozen_load() const;

private:
    static void require_shape(int given, int results);

    Given constant_ = 0.0;
    Function function_;
    std::shared_ptr<const Callback> callback_;
    std::string name_;
};

/// A torque about the axis of a hinge (of a universal joint the first): on the body [N m], its opposite on the parent.
/// No part of the joint's reaction.
struct JointTorque : JointLoad {
    using JointLoad::JointLoad;
    explicit JointTorque(JointLoad load) : JointLoad(std::move(load)) {}
    JointTorque frozen() const { return JointTorque(frozen_load()); }
    bool operator==(const JointTorque&) const = default;
};

/// A force along a slide: on the body [N], its opposite on the parent. No part of the joint's reaction.
struct JointForce : JointLoad {
    using JointLoad::JointLoad;
    explicit JointForce(JointLoad load) : JointLoad(std::move(load)) {}
    JointForce frozen() const { return JointForce(frozen_load()); }
    bool operator==(const JointForce&) const = default;
};

}  // namespace rbdyn::inline RBDYN_FORM
