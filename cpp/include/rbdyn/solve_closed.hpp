// Motions known in closed form, as accurate as asked for: in one, or in one for each of their modes.
#pragma once

#include <memory>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/closed_form.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/options.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

/// What rounding makes of what is computed from the state of a closed form from where it begins up to a time, over its
/// scales there.
double rounding_seen(const HybridModel& model, const Mode& mode, const ClosedForm& form, const SimulateOptions& options,
                     double start, double end);

/// A motion known in closed form. Nothing is integrated unless there is something to watch for: then Taylor series from
/// exact states find the events, twice, and the two are compared.
Solution solve_closed(const HybridModel& model, std::vector<double> x, const SimulateOptions& options,
                      const Beginning& beginning, const std::shared_ptr<const ClosedForm>& form);

/// The same of a motion whose formula changes: from one to the next, each from the state that the one before ends in.
Solution solve_by_modes(const HybridModel& model, const std::vector<double>& x, const SimulateOptions& options,
                        const Beginning& beginning, const std::shared_ptr<const FormsByMode>& forms);

/// Whichever the form is of.
Solution solve_in_form(const HybridModel& model, const std::vector<double>& x, const SimulateOptions& options,
                       const Beginning& beginning, const std::shared_ptr<const ClosedForm>& form);

}  // namespace rbdyn::inline RBDYN_FORM::simulating
