// Definitions of rbdyn/expression/time_function.hpp.
#pragma once

#include "rbdyn/expression/time_function.hpp"

#include <span>
#include <utility>

#include "rbdyn/expression/function.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE TimeFunction::TimeFunction(Function function)
    : is_constant_(false), function_(std::move(function)), rate_(function_.derivative(0)) {
    if (!function_.depends_on(0) && function_.parameters().empty()) {
        const double zero = 0.0;
        constant_ = function_(std::span<const double>(&zero, 1))[0];
        is_constant_ = true;
        function_ = {};
    }
}

RBDYN_INLINE TimeFunction TimeFunction::frozen() const {
    TimeFunction result = *this;
    if (is_constant_ || function_.parameters().empty()) return result;
    result.function_ = function_.frozen();
    result.rate_ = rate_.frozen();
    const auto same = result.function_.constants();
    result.is_constant_ = same.has_value();
    if (same) result.constant_ = same->front();
    // the formula remains: equations that are recorded hold for other numbers, too
    if (result.is_zero()) result.function_ = {};
    return result;
}

RBDYN_INLINE bool TimeFunction::operator==(const TimeFunction& other) const {
    return constant_ == other.constant_ && function_ == other.function_;
}

}  // namespace rbdyn::inline RBDYN_FORM
