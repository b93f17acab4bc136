// Changes of a state whose sums are compensated: x + low, low the part that x has no digits for.
#pragma once

#include <span>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace projecting {

/// x + low changed by no more than a few roundings of it, the sum compensated.
void add(std::span<double> x, std::span<double> low, int index, double change);
/// The same by any change.
void add(std::span<double> x, std::span<double> low, int index, long double change);

}  // namespace projecting

}  // namespace rbdyn::inline RBDYN_FORM
