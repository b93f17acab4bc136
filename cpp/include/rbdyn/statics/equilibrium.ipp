// Definitions of rbdyn/statics/equilibrium.hpp.
#pragma once

#include "rbdyn/statics/equilibrium.hpp"

#include <cstddef>
#include <ostream>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Equilibrium& e) {
    out << "Equilibrium at ";
    for (std::size_t k = 0; k < e.coordinates.size(); ++k) out << (k == 0 ? "" : ", ") << text(e.coordinates[k]);
    out << (e.stable ? ", stable" : e.decided ? ", not stable" : ", stable or not (rounding hides it)");
    if (e.interval) out << ", from " << text(e.interval->first) << " to " << text(e.interval->second);
    for (std::size_t k = 0; k < e.periods.size(); ++k) out << (k == 0 ? ", periods " : ", ") << text(e.periods[k]);
    if (!e.periods.empty()) out << " s";
    for (const Vector3& a : e.axes)
        out << ", free to turn about (" << text(a[0]) << ", " << text(a[1]) << ", " << text(a[2]) << ')';
    return out << '\n';
}

}  // namespace rbdyn::inline RBDYN_FORM
