// Definitions of rbdyn/scene/loads.hpp.
#pragma once

#include "rbdyn/scene/loads.hpp"

#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Force::Force(const Vector3& constant, Frame frame) : constant_(constant), frame_(frame) {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(constant[i]), "Force", "component " + std::to_string(i), constant[i],
                "a force is finite; give it in N");
}

RBDYN_INLINE Force::Force(std::initializer_list<double> constant, Frame frame)
    : Force(components(constant, "Force"), frame) {}

RBDYN_INLINE Force::Force(Function function, std::string name, Frame frame)
    : is_constant_(false), function_(std::move(function)), name_(std::move(name)), frame_(frame) {
    require_shape(function_.inputs(), function_.outputs());
}

RBDYN_INLINE Force::Force(std::shared_ptr<const Callback> callback, Frame frame)
    : is_constant_(false), callback_(callable(std::move(callback), "Force")), name_(callback_->name), frame_(frame) {
    require_shape(callback_->inputs, callback_->outputs);
}

RBDYN_INLINE const Vector3& Force::settled() const {
    if (function_) function_.settle();
    return constant_;
}

RBDYN_INLINE bool Force::depends_on_velocity() const {
    return callback_ || (function_ && (function_.depends_on(4) || function_.depends_on(5) || function_.depends_on(6)));
}

RBDYN_INLINE Force Force::frozen() const {
    Force result = *this;
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

RBDYN_INLINE bool Force::operator==(const Force& other) const {
    return constant_ == other.constant_ && function_ == other.function_ && callback_ == other.callback_ &&
           frame_ == other.frame_;
}

RBDYN_INLINE void Force::require_shape(int inputs, int outputs) {
    if (inputs != 7 || outputs != 3)
        throw InvalidInput("Force: the function has " + std::to_string(outputs) +
                           " results; a force has three components, in N");
}

RBDYN_INLINE Potential::Potential(Function function, std::string name)
    : function_(std::move(function)), name_(std::move(name)) {
    if (function_.inputs() != 3 || function_.outputs() != 1)
        throw InvalidInput("Potential: the function has " + std::to_string(function_.outputs()) +
                           " results; a potential is one number, in J");
    for (int i = 0; i < 3; ++i) slope_[i] = function_.derivative(i);
}

RBDYN_INLINE Potential Potential::frozen() const {
    Potential result = *this;
    result.function_ = function_.frozen();
    result.present_ = false;
    for (Function& f : result.slope_) {
        f = f.frozen();
        const auto same = f.constants();
        result.present_ = result.present_ || !same || same->front() != 0.0;
    }
    return result;
}

RBDYN_INLINE void Lorentz::validate() const {
    require(std::isfinite(strength.now()), "Lorentz", "strength", strength.now(), "it is finite");
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(field[i]), "Lorentz", "component " + std::to_string(i) + " of field", field[i],
                "it is finite");
}

RBDYN_INLINE Drag Drag::frozen() const {
    const Drag result{linear.frozen(), quadratic.frozen()};
    result.validate();
    return result;
}

RBDYN_INLINE void Drag::validate() const {
    for (auto [name, value] : {std::pair{"linear", linear.now()}, std::pair{"quadratic", quadratic.now()}})
        require(std::isfinite(value) && value >= 0.0, "Drag", name, value,
                "a resistance is zero or positive and finite; a driving force is a Force");
}

RBDYN_INLINE TorsionSpring TorsionSpring::frozen() const {
    const TorsionSpring result{stiffness.frozen(), rest_angle.frozen(), damping.frozen()};
    result.validate();
    return result;
}

RBDYN_INLINE void TorsionSpring::validate() const {
    for (auto [name, value] : {std::pair{"stiffness", stiffness.now()}, std::pair{"damping", damping.now()}})
        require(std::isfinite(value) && value >= 0.0, "TorsionSpring", name, value,
                "it is zero or positive and finite");
    require(std::isfinite(rest_angle.now()), "TorsionSpring", "rest_angle", rest_angle.now(),
            "an angle is finite, in rad");
}

RBDYN_INLINE std::string title_of(const Load& load) {
    if (const Force* force = std::get_if<Force>(&load)) return "force \"" + force->name() + "\"";
    if (const Potential* u = std::get_if<Potential>(&load)) return "the slope of potential \"" + u->name() + "\"";
    return "the force";
}

RBDYN_INLINE bool is_present(const Load& load) {
    return std::visit([](const auto& l) { return l.present(); }, load);
}

RBDYN_INLINE Load frozen(const Load& load) {
    return std::visit([](const auto& l) -> Load { return l.frozen(); }, load);
}

RBDYN_INLINE void give(const Load& load, GivenNumbers& numbers) {
    const auto give_all = [&](std::initializer_list<const Given*> all) {
        for (const Given* number : all) number->give(numbers);
    };
    if (const auto* force = std::get_if<Force>(&load)) force->function().give(numbers);
    if (const auto* torque = std::get_if<Torque>(&load)) torque->function().give(numbers);
    if (const auto* torque = std::get_if<JointTorque>(&load)) torque->give(numbers);
    if (const auto* force = std::get_if<JointForce>(&load)) force->give(numbers);
    if (const auto* potential = std::get_if<Potential>(&load)) potential->function().give(numbers);
    if (const auto* lorentz = std::get_if<Lorentz>(&load)) give_all({&lorentz->strength});
    if (const auto* drag = std::get_if<Drag>(&load)) give_all({&drag->linear, &drag->quadratic});
    if (const auto* spring = std::get_if<TorsionSpring>(&load))
        give_all({&spring->stiffness, &spring->rest_angle, &spring->damping});
}

}  // namespace rbdyn::inline RBDYN_FORM
