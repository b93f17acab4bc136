// Definitions of rbdyn/curve/checks.hpp.
#pragma once

#include "rbdyn/curve/checks.hpp"

#include <cmath>
#include <string>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE void require_finite(const std::string& curve, const std::string& what, double value) {
    require(std::isfinite(value), curve, what, value, "it must be a finite number");
}

RBDYN_INLINE void require_finite(const std::string& curve, const std::string& what, const Vector3& v) {
    for (int i = 0; i < 3; ++i) require_finite(curve, what + "[" + std::to_string(i) + "]", v[i]);
}

RBDYN_INLINE void require_positive(const std::string& curve, const std::string& what, double value,
                                   const std::string& unit) {
    require(std::isfinite(value) && value > 0.0, curve, what, value, "it must be positive and finite, in " + unit);
}

RBDYN_INLINE void require_direction(const std::string& curve, const std::string& what, const Vector3& v) {
    require_finite(curve, what, v);
    require(largest(v) > 0.0, curve, "length of " + what, 0.0,
            "a direction must not be zero: give a vector of any other length");
}

RBDYN_INLINE void require_plane(const std::string& curve, const Vector3& start, const Vector3& toward,
                                const std::string& first, const std::string& second) {
    require_direction(curve, first, start);
    require_direction(curve, second, toward);
    // below, the given numbers would fix the plane to fewer than half of their digits
    constexpr double least = 1e-8;
    require(sine_between(start, toward) > least, curve, "sine of the angle from " + first + " to " + second,
            sine_between(start, toward),
            "it must be above " + text(least) + ": give a " + second + " that is not parallel to " + first);
}

RBDYN_INLINE void require_domain(const std::string& curve, const Domain& domain) {
    require(domain.begin < domain.end, curve, "begin of the domain", domain.begin,
            "it must be less than the end " + text(domain.end));
}

RBDYN_INLINE std::string vector_text(const Vector3& v) {
    return "(" + text(v.x()) + ", " + text(v.y()) + ", " + text(v.z()) + ")";
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
