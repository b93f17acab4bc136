// Definitions of rbdyn/scene/rigid_motion.hpp.
#pragma once

#include "rbdyn/scene/rigid_motion.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/function.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RigidMotion::RigidMotion(Function function) : function_(std::move(function)) {
    if (function_.inputs() != 1 || function_.outputs() != 12)
        throw InvalidInput("motion: the function has " + std::to_string(function_.outputs()) +
                           " results; a rigid motion has twelve, a rotation matrix row by row and a displacement");
    for (const double t : {0.0, 0.37, 1.0, 2.9, 17.3}) {
        const RigidPlacement<double> p = at(t);
        double off = 0.0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double product = dot(p.row[i], p.row[j]);
                off = std::max(off, std::abs(i == j ? product - 1.0 : product));
            }
        const double determinant = dot(p.row[0], cross(p.row[1], p.row[2]));
        require(off < 1e-9, "motion", "departure from a rotation at t = " + text(t) + " s", off,
                "the matrix of a rigid motion has orthonormal rows");
        require(determinant > 0.0, "motion", "determinant at t = " + text(t) + " s", determinant,
                "a rigid motion does not mirror: the determinant is 1");
    }
    rate_ = function_.derivative(0);
    second_ = rate_.derivative(0);
}

RBDYN_INLINE RigidMotion RigidMotion::frozen() const {
    RigidMotion result = *this;
    if (!present()) return result;
    result.function_ = function_.frozen();
    if (result.function_.constants() == std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}) return {};
    result.rate_ = rate_.frozen();
    result.second_ = second_.frozen();
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
