// Definitions of rbdyn/scene/joint_loads.hpp.
#pragma once

#include "rbdyn/scene/joint_loads.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE JointLoad::JointLoad(Function function, std::string name)
    : function_(std::move(function)), name_(std::move(name)) {
    require_shape(function_.inputs(), function_.outputs());
}

RBDYN_INLINE void JointLoad::require_shape(int given, int results) {
    if (given != inputs || results != 1)
        throw InvalidInput("JointTorque, JointForce: the function has " + std::to_string(given) + " arguments and " +
                           std::to_string(results) + " results; it is f(t, q, rate) with one");
}

RBDYN_INLINE JointLoad::JointLoad(std::shared_ptr<const Callback> callback)
    : callback_(callable(std::move(callback), "JointTorque, JointForce")), name_(callback_->name) {
    require_shape(callback_->inputs, callback_->outputs);
}

RBDYN_INLINE void JointLoad::give(GivenNumbers& numbers) const {
    constant_.give(numbers);
    function_.give(numbers);
}

RBDYN_INLINE void JointLoad::validate(const std::string& kind, const std::string& unit) const {
    require(std::isfinite(constant_.now()), kind, "its number", constant_.now(),
            "it is finite; give it in " + unit + ", or as a function");
}

RBDYN_INLINE JointLoad JointLoad::frozen_load() const {
    JointLoad result = *this;
    result.constant_ = constant_.frozen();
    result.validate("JointTorque, JointForce", "N m, N");
    if (function_) result.function_ = function_.frozen();
    return result;
}

RBDYN_INLINE bool JointLoad::operator==(const JointLoad& other) const {
    return constant_ == other.constant_ && function_ == other.function_ && callback_ == other.callback_;
}

}  // namespace rbdyn::inline RBDYN_FORM
