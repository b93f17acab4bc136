// How much memory there is.
#pragma once

#include <optional>
#include <string>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What this process may still take without making the machine swap, in bytes: of the machine, or of its control group
/// or its own limit if one allows less. None where the system does not tell.
std::optional<double> available_memory();

/// 3.1 GB, 240 MB
std::string bytes_text(double bytes);

}  // namespace rbdyn::inline RBDYN_FORM
