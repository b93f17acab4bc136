// Recorded rates that are linear in the variables with constant coefficients, and forced in time, if at all, by sines,
// exponentials and powers: as a system of closed_form/waves.hpp.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/waves.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

/// The system that the rates of a program with values at the start are; none if they are something else.
[[gnu::cold]] std::optional<ForcedSystem> forced_system(const Program& program, std::vector<DoubleDouble> start);

}  // namespace rbdyn::inline RBDYN_FORM::planning
