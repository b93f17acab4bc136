// The size of the equations that a motion is integrated with.
#pragma once

#include <ostream>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Mode;  // model/hybrid.hpp

/// The size of what is integrated in a mode.
struct Size {
    int variables = 0, guards = 0;
    int instructions = 0;  // of the right-hand side and its guards

    Size() = default;
    explicit Size(const Mode& mode);
    bool operator==(const Size&) const = default;
    Size& operator+=(const Size& other);
};

std::ostream& operator<<(std::ostream& out, const Size& s);

}  // namespace rbdyn::inline RBDYN_FORM
