// Definitions of rbdyn/scene/pair_laws.hpp.
#pragma once

#include "rbdyn/scene/pair_laws.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/quadrature.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/own_function.hpp"
#include "rbdyn/scene/spring.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace couplings {

RBDYN_INLINE void require_shape(const OwnFunction& law, int inputs, int outputs, const std::string& rule) {
    if (law.inputs() != inputs || law.outputs() != outputs)
        throw InvalidInput(rule + "; the function has " + std::to_string(law.inputs()) + " inputs and " +
                           std::to_string(law.outputs()) + " results");
}

}  // namespace couplings

RBDYN_INLINE Gravitation Gravitation::frozen() const {
    const Gravitation result{constant.frozen()};
    result.validate();
    return result;
}

RBDYN_INLINE void Gravitation::validate() const {
    require(std::isfinite(constant.now()) && constant.now() >= 0.0, "Gravitation", "constant", constant.now(),
            "bodies attract each other: it is zero or positive and finite, in m^3/(kg s^2); a repulsion is a Central");
}

RBDYN_INLINE Central::Central(Function function, std::string name)
    : law_(std::move(function), std::move(name)), present_(true) {
    couplings::require_shape(law_, 1, 1, "Central: a central force is one number, in N, of the distance");
}

RBDYN_INLINE Central::Central(std::shared_ptr<const Callback> callback) : law_(std::move(callback)), present_(true) {
    couplings::require_shape(law_, 1, 1, "Central: a central force is one number, in N, of the distance");
}

RBDYN_INLINE Central Central::frozen() const {
    Central result = *this;
    result.law_ = law_.frozen();
    result.present_ = !result.law_.is_zero();
    return result;
}

RBDYN_INLINE Vector3Of<Expression> Central::operator()(const Vector3Of<Expression>& d) const {
    using S = Expression;
    if (const int only = couplings::only_component(d); only >= 0) {
        const S sign = locked_sign(d[only], "distance of a central force");
        Vector3Of<S> force{S(0.0), S(0.0), S(0.0)};
        force[only] = sign * magnitude<S>(sign * d[only]);
        return force;
    }
    const S distance = length(d, "distance of a central force");
    return d * (magnitude<S>(distance) / distance);
}

RBDYN_INLINE Vector3 Central::operator()(const Vector3& d, const Vector3& v, double size) const {
    return magnitude<double>(d.norm()) * couplings::direction(d, v, size);
}

RBDYN_INLINE double Central::gain(double from, double to) const {
    return curves::integral([&](double r) { return magnitude<double>(r); }, from, to);
}

RBDYN_INLINE PairForce::PairForce(Function function, std::string name)
    : law_(std::move(function), std::move(name)), present_(true) {
    couplings::require_shape(law_, inputs, 3,
                             "PairForce: a force has three components, in N, of t, r_a, r_b, v_a, v_b");
}

RBDYN_INLINE PairForce::PairForce(std::shared_ptr<const Callback> callback)
    : law_(std::move(callback)), present_(true) {
    couplings::require_shape(law_, inputs, 3,
                             "PairForce: a force has three components, in N, of t, r_a, r_b, v_a, v_b");
}

RBDYN_INLINE bool PairForce::depends_on_velocity() const {
    for (int i = 7; i < inputs; ++i)
        if (law_.may_depend_on(i)) return true;
    return false;
}

RBDYN_INLINE PairForce PairForce::frozen() const {
    PairForce result = *this;
    result.law_ = law_.frozen();
    result.present_ = !result.law_.is_zero();
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
