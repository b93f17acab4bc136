// Which way a quantity passes a zero.
#pragma once

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

enum class Direction { either, rising, falling };

}  // namespace rbdyn::inline RBDYN_FORM
