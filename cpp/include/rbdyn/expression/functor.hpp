// Functors of the user's over the number type: what they take and what they give. One that does not fit is told so in
// one line, before what a compiler says of the rest.
#pragma once

#include <concepts>
#include <type_traits>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What can be called with inputs of these types. (std::is_invocable would put lines of its own before what a compiler
/// says of the user's.)
template <class F, class... Inputs>
concept Takes = requires(F& f, const Inputs&... inputs) {
    f(inputs...);
};

/// What was meant as a functor that makes an Owner, and cannot be called so: an object that is nothing else of what
/// could stand there, and no list; or a function.
template <class F, class Owner, class... Others>
concept MeantAsFunctor = (std::is_class_v<F> ||
                          std::is_function_v<std::remove_pointer_t<F>>)&&!std::is_base_of_v<Owner, F> &&
                         !(std::convertible_to<F, Others> || ...) && !requires(F & f) {
    f.begin();
};

namespace recording {

/// False, when a compiler gets there.
template <class>
inline constexpr bool fits = false;

/// What a functor gives that gives a number.
template <class F, class... Inputs>
Expression number(F& f, const Inputs&... inputs) {
    using Given = decltype(f(inputs...));
    if constexpr (std::convertible_to<Given, Expression>) {
        return f(inputs...);
    } else {
        static_assert(fits<Given>, "this function of yours is to return one number, of the type of what it is given");
        return {};
    }
}

/// What a functor gives that gives a vector.
template <class F, class... Inputs>
Vector3Of<Expression> vector(F& f, const Inputs&... inputs) {
    using Given = decltype(f(inputs...));
    if constexpr (std::convertible_to<Given, Vector3Of<Expression>>) {
        return f(inputs...);
    } else {
        static_assert(fits<Given>,
                      "this function of yours is to return three components: rbdyn::Vector3Of<S>{x, y, z}, with S the "
                      "type of the numbers it is given");
        return {};
    }
}

}  // namespace recording

}  // namespace rbdyn::inline RBDYN_FORM
