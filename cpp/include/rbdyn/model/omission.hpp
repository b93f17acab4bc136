// What a scene does not call for, and what would bring it in.
#pragma once

#include <string>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Something a scene does not call for, and why; what would bring it in.
struct Omission {
    std::string what, why;
};

}  // namespace rbdyn::inline RBDYN_FORM
