// Definitions of rbdyn/curve/point.hpp.
#pragma once

#include "rbdyn/curve/point.hpp"

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Matrix3Of<DoubleDouble> Placement::exact_axes() const {
    Matrix3Of<DoubleDouble> m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m(i, j) = {axes(i, j), rest(i, j)};
    return m;
}

RBDYN_INLINE Placement placed(const Vector3& origin, const Matrix3Of<DoubleDouble>& axes) {
    Placement p{origin};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            p.axes(i, j) = axes(i, j).hi;
            p.rest(i, j) = axes(i, j).lo;
        }
    return p;
}

}  // namespace rbdyn::inline RBDYN_FORM
