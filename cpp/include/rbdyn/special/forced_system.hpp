// Recorded rates that are linear in the variables with constant coefficients, and forced in time, if at all, by sines,
// exponentials and powers: as a system of closed_form/waves.hpp.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/waves.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

/// The system that the rates of a program with values at the start are; none if they are something else.
[[gnu::cold]] std::optional<ForcedSystem> forced_system(const Program& program, std::vector<DoubleDouble> start);
/// The same with the weights that the program has for its parameters.
[[gnu::cold]] std::optional<ForcedSystem> forced_system(const Program& program, std::span<const DoubleDouble> weights,
                                                        std::vector<DoubleDouble> start);

/// An output that is a sum of variables with factors and of a constant.
struct LinearOutput {
    std::vector<double> factors;  // one a variable
    double constant = 0.0;
};
/// Each output of a program, those of its switches counted on, with the weights that it has for its parameters; none if
/// it is something else.
[[gnu::cold]] std::vector<std::optional<LinearOutput>> linear_outputs(const Program& program,
                                                                      std::span<const DoubleDouble> weights);

}  // namespace rbdyn::inline RBDYN_FORM::planning
