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
    : cell_(std::make_shared<Cell>(Cell{value, std::move(name)})) {
    require(std::isfinite(value), "parameter", cell_->name.empty() ? "its value" : cell_->name, value, "it is finite");
}

RBDYN_INLINE void Parameter::set(double value) {
    require(std::isfinite(value), "parameter", name().empty() ? "its value" : name(), value, "it is finite");
    cell_->value = value;
}

}  // namespace rbdyn::inline RBDYN_FORM
