// First-order equations of one's own, x' = f(t, x), with what is watched for: data, simulated like a scene.
//
//     System pendulum([](const auto&, auto x, auto rate) { rate[0] = x[1]; rate[1] = -9.81 * sin(x[0]); }, {1.0,
//     0.0});
//
// The equations are recorded once, with their case distinctions, or called back where they cannot be; units are the
// user's. Each variable is measured by its largest size in the motion, and by least_share() (equations.hpp) of the
// largest of all at least: variables that differ by more than a million times are better given in other units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/own_function.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What is done where a watched function of a System passes zero: it is noted; the run ends; or the state becomes what
/// `change` makes of it.
struct StateAction {
    WatchAction::Kind kind = WatchAction::Kind::record;
    std::function<std::vector<double>(double t, std::span<const double> x)> change = {};
};

/// Options of a watched function of a System.
struct StateWatchOptions {
    Direction direction = Direction::either;
    StateAction action = {};
};

class System {
public:
    struct Watch {
        std::string name;
        OwnFunction function;  // of (t, x)
        StateWatchOptions options;
    };

    // a move copies: what was moved from stays what it was
    System(const System&) = default;
    System& operator=(const System&) = default;

    /// f: 1 + n inputs, the time and the variables, and n results, their rates. names: of the variables, or none.
    /// Throws InvalidInput for sizes that do not fit, for a start that is not finite, for names that are not unique.
    System(OwnFunction f, std::vector<double> start, std::vector<std::string> names = {});

    /// Any functor over the number type, f(t, x, rate), as models of the user's own are (own_model.hpp).
    template <class F>
    requires Takes<const F, Expression, std::span<const Expression>, std::span<Expression>> System(
        const F& f, std::vector<double> start, std::vector<std::string> names = {})
        : System(OwnFunction(Function::record(1 + count(start),
                                              [&](const std::vector<Expression>& x) {
                                                  std::vector<Expression> rate(x.size() - 1, Expression(0.0));
                                                  f(x[0], std::span<const Expression>(x).subspan(1),
                                                    std::span<Expression>(rate));
                                                  return rate;
                                              }),
                             "f"),
                 start, std::move(names)) {}
    template <class F>
    requires(!Takes<const F, Expression, std::span<const Expression>, std::span<Expression>> &&
             MeantAsFunctor<F, System, OwnFunction, Function>)
        System(const F&, std::vector<double>, std::vector<std::string> = {}) {
        static_assert(recording::fits<F>,
                      "the function of a System is called as f(t, x, rate), a number and two spans: take each as const "
                      "auto& or auto");
    }

    int variables() const { return static_cast<int>(start_.size()); }
    const OwnFunction& function() const { return f_; }
    const std::vector<double>& start() const { return start_; }
    /// Of the variables; none if they have none.
    const std::vector<std::string>& names() const { return names_; }
    /// The name of a variable, or "x[2]".
    std::string name(int variable) const;
    /// The place of a variable. Throws InvalidInput, with the names there are, for a name that is none.
    int place(const std::string& name) const;

    /// The same equations from another state. Throws InvalidInput for one of another size, or that is not finite.
    System from(std::vector<double> start) const;

    /// Watches a function of (t, x): where it passes zero is an event of kind "watch". Throws InvalidInput for a name
    /// that is empty or taken, and a function of another size.
    void watch(std::string name, OwnFunction function, StateWatchOptions options = {});
    /// Any functor over the number type, f(t, x).
    template <class F>
    requires Takes<const F, Expression, std::span<const Expression>>
    void watch(std::string name, const F& f, StateWatchOptions options = {}) {
        const auto recorded = [&](const std::vector<Expression>& x) {
            return std::vector<Expression>{recording::number(f, x[0], std::span<const Expression>(x).subspan(1))};
        };
        OwnFunction own(Function::record(1 + variables(), recorded), name);
        watch(std::move(name), std::move(own), std::move(options));
    }
    template <class F>
    requires(!Takes<const F, Expression, std::span<const Expression>> &&
             MeantAsFunctor<F, System, OwnFunction, Function>) void watch(const std::string&, const F&,
                                                                          const StateWatchOptions& = {}) {
        static_assert(recording::fits<F>,
                      "the function that a System watches is called as f(t, x), a number and a span: take each as "
                      "const auto& or auto");
    }
    const std::vector<Watch>& watches() const { return watches_; }

    /// With the numbers of the user's as they are now.
    System frozen() const;
    /// The numbers of the user's that it depends on.
    GivenNumbers numbers() const;
    /// Whether f is called back, which leaves no Taylor series.
    bool calls_back() const { return f_.callback() != nullptr; }
    /// Whether any function or action runs in Python while a run goes on.
    bool calls_python() const;
    /// How often Python was called so far.
    std::int64_t python_calls() const;

private:
    /// Of the variables of a state. Throws InvalidInput if there are none.
    static int count(const std::vector<double>& start);

    OwnFunction f_;
    std::vector<double> start_;
    std::vector<std::string> names_;
    std::vector<Watch> watches_;
};

}  // namespace rbdyn::inline RBDYN_FORM
