// Definitions of rbdyn/model/size.hpp.
#pragma once

#include "rbdyn/model/size.hpp"

#include <ostream>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Size::Size(const Mode& mode) {
    if (mode.equations == nullptr) return;
    variables = mode.equations->variables();
    guards = static_cast<int>(mode.equations->guards.size());
    instructions = static_cast<int>(mode.equations->program.instructions().size());
}

RBDYN_INLINE Size& Size::operator+=(const Size& other) {
    variables += other.variables;
    guards += other.guards;
    instructions += other.instructions;
    return *this;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Size& s) {
    const auto counted = [&](int n, const char* what, const char* end) {
        out << n << ' ' << what << (n == 1 ? "" : "s") << end;
    };
    counted(s.variables, "variable", ", ");
    counted(s.guards, "guard", ", ");
    counted(s.instructions, "instruction", "");
    return out;
}

}  // namespace rbdyn::inline RBDYN_FORM
