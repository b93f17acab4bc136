// Engines by SUNDIALS CVODE, in builds that have it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM::cvode {

/// Their names; none in a build without SUNDIALS.
std::vector<std::string> names();

/// The engine of a name; none if it is not one of them.
std::unique_ptr<Engine> make(const std::string& name, double tolerance,
                             Program::Rounding rounding = Program::Rounding::nearest);

}  // namespace rbdyn::inline RBDYN_FORM::cvode
