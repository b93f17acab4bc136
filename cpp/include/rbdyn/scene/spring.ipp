// Definitions of rbdyn/scene/spring.hpp.
#pragma once

#include "rbdyn/scene/spring.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"

namespace rbdyn::inline RBDYN_FORM::couplings {

RBDYN_INLINE int only_component(const Vector3Of<Expression>& d) {
    int only = -1;
    for (int i = 0; i < 3; ++i)
        if (!d[i].is_zero()) only = only < 0 ? i : 3;
    return only < 3 ? only : -1;
}

RBDYN_INLINE Vector3 direction(const Vector3& d, const Vector3& v, double size) {
    const double l = d.norm(), speed = v.norm();
    const bool apart = l > 8.0 * std::numeric_limits<double>::epsilon() * size;
    return apart ? Vector3(d / l) : speed > 0.0 ? Vector3(v / speed) : Vector3(0, 0, 0);
}

}  // namespace rbdyn::inline RBDYN_FORM::couplings

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Spring Spring::frozen() const {
    const Spring result{stiffness.frozen(), rest_length.frozen(), damping.frozen()};
    result.validate();
    return result;
}

RBDYN_INLINE void Spring::give(GivenNumbers& numbers) const {
    for (const Given* number : {&stiffness, &rest_length, &damping}) number->give(numbers);
}

RBDYN_INLINE void Spring::validate() const {
    for (auto [name, value] : {std::pair{"stiffness", stiffness.now()}, std::pair{"rest_length", rest_length.now()},
                               std::pair{"damping", damping.now()}})
        require(std::isfinite(value) && value >= 0.0, "Spring", name, value, "it is zero or positive and finite");
}

RBDYN_INLINE Vector3Of<Expression> Spring::operator()(const Vector3Of<Expression>& d,
                                                      const Vector3Of<Expression>& v) const {
    using S = Expression;
    const S k = stiffness.in<S>(), c = damping.in<S>(), tension = k * rest_length.in<S>();
    Vector3Of<S> force = d * -k;
    if (tension.is_zero() && c.is_zero()) return force;
    if (const int only = couplings::only_component(d); only >= 0) {
        if (!tension.is_zero()) force[only] += tension * locked_sign(d[only], "length of a spring");
        force[only] -= c * v[only];
        return force;
    }
    const S l = length(d, "length of a spring");
    if (!tension.is_zero()) force += d * (tension / l);
    if (!c.is_zero()) force -= d * (c * dot<S>(d, v) / (l * l));
    return force;
}

RBDYN_INLINE Vector3 Spring::operator()(const Vector3& d, const Vector3& v, double size) const {
    const double l = d.norm();
    const Vector3 along = couplings::direction(d, v, size);
    return -(stiffness * (l - rest_length) + damping * along.dot(v)) * along;
}

RBDYN_INLINE double Spring::potential(double length) const {
    const double stretch = length - rest_length;
    return -0.5 * stiffness * stretch * stretch;
}

}  // namespace rbdyn::inline RBDYN_FORM
