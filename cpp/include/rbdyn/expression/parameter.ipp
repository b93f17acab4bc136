// Definitions of rbdyn/expression/parameter.hpp.
#pragma once

#include "rbdyn/expression/parameter.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Parameter::Parameter(double value, std::string name)
    : cell_(std::make_shared<Cell>(value, std::move(name))) {
    require_no_zero("parameter", cell_->name);
    require_finite(value);
}

RBDYN_INLINE double Parameter::value() const {
    if (const BoundParameters* bound = BoundParameters::active())
        if (const double* value = bound->find(*this)) return *value;
    return cell_->value;
}

RBDYN_INLINE void Parameter::set(double value) {
    require_finite(value);
    cell_->value = value;
}

RBDYN_INLINE void Parameter::require_finite(double value) const {
    require(std::isfinite(value), "parameter", name().empty() ? "its value" : name(), value, "it is finite");
}

RBDYN_INLINE BoundParameters::BoundParameters(const Values& values) : values_(values), before_(active()) {
    for (const auto& [parameter, value] : values_) parameter.require_finite(value);
    active() = this;
}

RBDYN_INLINE const BoundParameters*& BoundParameters::active() {
    static thread_local const BoundParameters* bound = nullptr;
    return bound;
}

RBDYN_INLINE const double* BoundParameters::find(const Parameter& parameter) const {
    for (auto one = values_.rbegin(); one != values_.rend(); ++one)
        if (one->first.is(parameter)) return &one->second;
    return before_ != nullptr ? before_->find(parameter) : nullptr;
}

}  // namespace rbdyn::inline RBDYN_FORM
