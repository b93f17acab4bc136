// Definitions of rbdyn/scene/watch.hpp.
#pragma once

#include "rbdyn/scene/watch.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/recording.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE int components_of(Quantity q) {
    switch (q) {
        case Quantity::time:
        case Quantity::parameter:
        case Quantity::speed:
        case Quantity::tangential_force:
        case Quantity::kinetic_energy:
        case Quantity::angle:
        case Quantity::displacement:
        case Quantity::rate:
        case Quantity::displacement_rate:
        case Quantity::length: return 1;
        case Quantity::angles:
        case Quantity::rates: return 2;
        case Quantity::quaternion: return 4;
        case Quantity::rotation_matrix: return 9;
        default: return 3;
    }
}

RBDYN_INLINE Expression Now::value(const Observable& what) const {
    auto found = std::find(asked_.begin(), asked_.end(), what);
    const auto index = static_cast<int>(found - asked_.begin());
    if (found == asked_.end()) asked_.push_back(what);
    return recording::active()->input(index);
}

RBDYN_INLINE Vector3Of<Expression> Now::vector(Quantity quantity, int subject) const {
    return {value({quantity, subject, 0}), value({quantity, subject, 1}), value({quantity, subject, 2})};
}

RBDYN_INLINE Vector3Of<Expression> Now::Body::center_of_mass_velocity() const {
    return now_.vector(Quantity::center_of_mass_velocity, index_);
}

RBDYN_INLINE Vector3Of<Expression> Now::Body::center_of_mass_acceleration() const {
    return now_.vector(Quantity::center_of_mass_acceleration, index_);
}

RBDYN_INLINE QuaternionOf<Expression> Now::Body::quaternion() const {
    const auto q = [&](int i) { return now_.value({Quantity::quaternion, index_, i}); };
    return {q(0), q(1), q(2), q(3)};
}

RBDYN_INLINE std::array<Expression, 9> Now::Body::rotation_matrix() const {
    std::array<Expression, 9> r;
    for (std::size_t i = 0; i < 9; ++i) r[i] = now_.value({Quantity::rotation_matrix, index_, static_cast<int>(i)});
    return r;
}

RBDYN_INLINE EulerAnglesOf<Expression> Now::Body::euler_angles() const {
    const Vector3Of<Expression> a = now_.vector(Quantity::euler_angles, index_);
    return {a[0], a[1], a[2]};
}

RBDYN_INLINE std::array<Expression, 2> Now::Body::angles() const {
    return {now_.value({Quantity::angles, index_, 0}), now_.value({Quantity::angles, index_, 1})};
}

RBDYN_INLINE std::array<Expression, 2> Now::Body::rates() const {
    return {now_.value({Quantity::rates, index_, 0}), now_.value({Quantity::rates, index_, 1})};
}

RBDYN_INLINE Vector3Of<Expression> Now::Body::angular_acceleration() const {
    return now_.vector(Quantity::angular_acceleration, index_);
}

RBDYN_INLINE Vector3Of<Expression> Now::Body::angular_velocity_world() const {
    return now_.vector(Quantity::angular_velocity_world, index_);
}

RBDYN_INLINE WatchFunction::WatchFunction(Function function, std::vector<Observable> arguments)
    : function_(std::move(function)), arguments_(std::move(arguments)) {
    require(function_.outputs() == 1, "WatchFunction", "count of results", function_.outputs(),
            "its function gives one");
    require(function_.inputs() == static_cast<int>(arguments_.size()), "WatchFunction", "count of inputs",
            function_.inputs(), "its function takes one for each of what it asks for");
}

RBDYN_INLINE WatchFunction WatchFunction::called_back(std::function<double(const Observe&)> callback,
                                                      std::string reason, bool is_python) {
    if (!callback) throw InvalidInput("WatchFunction: what is called back is empty; give a function");
    WatchFunction result;
    result.callback_ = std::move(callback);
    auto counter = std::make_shared<Callback>();
    counter->reason = std::move(reason);
    counter->is_python = is_python;
    result.counter_ = std::move(counter);
    return result;
}

RBDYN_INLINE bool WatchFunction::asks_for(Quantity quantity) const {
    return std::any_of(arguments_.begin(), arguments_.end(),
                       [&](const Observable& o) { return o.quantity == quantity; });
}

RBDYN_INLINE WatchFunction WatchFunction::frozen() const {
    WatchFunction result = *this;
    result.function_ = function_.frozen();
    return result;
}

RBDYN_INLINE double WatchFunction::operator()(const Observe& observe) const {
    if (callback_) {
        counter_->calls.fetch_add(1, std::memory_order_relaxed);
        return callback_(observe);
    }
    std::vector<double> x;
    for (const Observable& o : arguments_) x.push_back(observe(o));
    return function_(std::span<const double>(x))[0];
}

RBDYN_INLINE std::vector<std::string> StateChange::words() const {
    std::vector<std::string> given;
    const auto look = [&](const char* word, const auto& value) {
        if (value) given.emplace_back(word);
    };
    look("position", position);
    look("velocity", velocity);
    look("position (2)", position_in_plane);
    look("velocity (2)", velocity_in_plane);
    look("parameter", parameter);
    look("speed", speed);
    look("attitude", attitude);
    look("angular_velocity", angular_velocity);
    look("angular_velocity_world", angular_velocity_world);
    look("angle", angle);
    look("angles", angles);
    look("displacement", displacement);
    look("rate", rate);
    look("rates", rates);
    look("displacement_rate", displacement_rate);
    return given;
}

RBDYN_INLINE void StateChange::require_words(const std::vector<std::string>& own, const std::string& user,
                                             const std::string& name) const {
    for (const std::string& word : words()) {
        if (std::find(own.begin(), own.end(), word) != own.end()) continue;
        std::string list;
        for (const std::string& w : own) list += (list.empty() ? "" : ", ") + w;
        throw InvalidInput(user + ": its action changes " + word + " of " + name + ", whose joint has none" +
                           (own.empty() ? ", nor anything else to change" : "; give " + list));
    }
}

RBDYN_INLINE void WatchAction::require_change(const std::string& user) const {
    if (kind == Kind::change && !change)
        throw InvalidInput(user + ": its action changes states and has no function; give one as its change");
}

RBDYN_INLINE bool WatchFunction::operator==(const WatchFunction& other) const {
    return !callback_ && !other.callback_ && arguments_ == other.arguments_ && function_ == other.function_;
}

}  // namespace rbdyn::inline RBDYN_FORM
