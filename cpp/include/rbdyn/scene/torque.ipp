// Definitions of rbdyn/scene/torque.hpp.
#pragma once

#include "rbdyn/scene/torque.hpp"

#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Vector3 components(std::initializer_list<double> numbers, const std::string& object) {
    require(numbers.size() == 3, object, "number of components", static_cast<double>(numbers.size()),
            "a vector has three");
    return {numbers.begin()[0], numbers.begin()[1], numbers.begin()[2]};
}

RBDYN_INLINE Torque::Torque(const Vector3& constant, Frame frame) : constant_(constant), frame_(frame) {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(constant[i]), "Torque", "component " + std::to_string(i), constant[i],
                "a torque is finite; give it in N m");
}

RBDYN_INLINE Torque::Torque(std::initializer_list<double> constant, Frame frame)
    : Torque(components(constant, "Torque"), frame) {}

RBDYN_INLINE Torque::Torque(Function function, std::string name, Frame frame)
    : is_constant_(false), function_(std::move(function)), name_(std::move(name)), frame_(frame) {
    require_shape(function_.inputs(), function_.outputs());
}

RBDYN_INLINE Torque::Torque(std::shared_ptr<const Callback> callback, Frame frame)
    : is_constant_(false), callback_(callable(std::move(callback), "Torque")), name_(callback_->name), frame_(frame) {
    require_shape(callback_->inputs, callback_->outputs);
}

RBDYN_INLINE Torque Torque::frozen() const {
    Torque result = *this;
    if (!function_) return result;
    result.function_ = function_.frozen();
    if (const auto same = result.function_.constants()) {
        result.is_constant_ = true;
        result.constant_ = {(*same)[0], (*same)[1], (*same)[2]};
        // the formula remains: equations that are recorded hold for other numbers, too
        if (function_.parameters().empty() || !result.present()) result.function_ = {};
    }
    return result;
}

RBDYN_INLINE bool Torque::operator==(const Torque& other) const {
    return constant_ == other.constant_ && function_ == other.function_ && callback_ == other.callback_ &&
           frame_ == other.frame_;
}

RBDYN_INLINE void Torque::require_shape(int given_inputs, int outputs) {
    if (given_inputs != static_cast<int>(inputs) || outputs != 3)
        throw InvalidInput("Torque: the function has " + std::to_string(outputs) +
                           " results; a torque has three components, in N m");
}

}  // namespace rbdyn::inline RBDYN_FORM
