// Which stretch of a curve made of several a parameter lies on.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/elementary.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// Rounds of a closed curve, one way: beyond, a parameter has no digits left to say where on it.
inline constexpr long most_stretches = 1L << 30;

/// The largest whole number <= u, kept within [lowest, highest]; of a model fixed during smooth motion, its changes
/// located but no events.
template <class S>
long stretch(const S& u, long lowest, long highest) {
    if (lowest == highest) return lowest;
    return whole(u, lowest, highest);
}
long stretch(long double u, long lowest, long highest);

inline long stretch(const DoubleDouble& u, long lowest, long highest) { return stretch(u.hi, lowest, highest); }

}  // namespace rbdyn::inline RBDYN_FORM::curves
