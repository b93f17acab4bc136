// Definitions of rbdyn/expression/own_function.hpp.
#pragma once

#include "rbdyn/expression/own_function.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/numbers.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE OwnFunction::OwnFunction(Function function, std::string name)
    : function_(std::move(function)), name_(std::move(name)) {}

RBDYN_INLINE OwnFunction::OwnFunction(std::shared_ptr<const Callback> callback)
    : callback_(callable(std::move(callback), "a function that is called back")), name_(callback_->name) {}

RBDYN_INLINE bool OwnFunction::is_zero() const {
    if (callback_) return false;
    if (!function_) return true;
    const auto same = function_.constants();
    return same && std::all_of(same->begin(), same->end(), [](double x) { return x == 0.0; });
}

RBDYN_INLINE OwnFunction OwnFunction::frozen() const {
    OwnFunction result = *this;
    if (function_) result.function_ = function_.frozen();
    return result;
}

RBDYN_INLINE void OwnFunction::give(GivenNumbers& numbers) const { function_.give(numbers); }

RBDYN_INLINE std::vector<double> OwnFunction::called(const std::vector<double>& x) const {
    std::vector<double> y(static_cast<std::size_t>(callback_->outputs));
    (*callback_)(x.data(), y.data());
    return y;
}

RBDYN_INLINE bool OwnFunction::operator==(const OwnFunction& other) const {
    return function_ == other.function_ && callback_ == other.callback_;
}

}  // namespace rbdyn::inline RBDYN_FORM
