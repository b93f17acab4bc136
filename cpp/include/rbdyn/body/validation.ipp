// Definitions of rbdyn/body/validation.hpp.
#pragma once

#include "rbdyn/body/validation.hpp"

#include <cmath>
#include <string>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM::bodies {

RBDYN_INLINE std::string vector_text(const Vector3& v) {
    return "(" + text(v[0]) + ", " + text(v[1]) + ", " + text(v[2]) + ")";
}

RBDYN_INLINE void require_mass(const std::string& body, double mass) {
    require(std::isfinite(mass) && mass > 0.0, body, "mass", mass, "a mass is positive and finite; give it in kg");
}

RBDYN_INLINE void require_symmetric(const std::string& body, const Matrix3& inertia) {
    const double size = largest(inertia);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const std::string ij = std::to_string(i) + "][" + std::to_string(j) + "]";
            require(std::isfinite(inertia(i, j)), body, "inertia[" + ij, inertia(i, j),
                    "an inertia is finite; give it in kg m^2");
            if (j < i)
                require(std::abs(inertia(i, j) - inertia(j, i)) <= symmetry_slack * size, body, "inertia[" + ij,
                        inertia(i, j),
                        "it is equal to inertia[" + std::to_string(j) + "][" + std::to_string(i) + "], which is " +
                            text(inertia(j, i)) + ": an inertia is symmetric");
        }
}

RBDYN_INLINE void require_moments(const std::string& body, const Vector3& moments, double given,
                                  const std::string& derived) {
    const int smallest = least(moments), largest = greatest(moments);
    const std::string what =
        "among the principal moments about the centre of mass, " + vector_text(moments) + " kg m^2" + derived + ", one";
    const std::string fix =
        ": check the products of inertia (I_12 = -Int rho x1 x2) and what the inertia is about "
        "(inertia_about)";
    require(moments[smallest] >= -no_moment * given, body, what, moments[smallest],
            "a moment of inertia is zero or positive" + fix);
    const double others = moments[(largest + 1) % 3] + moments[(largest + 2) % 3];
    require(moments[largest] - others <= triangle_slack * moments[largest] + no_moment * given, body, what,
            moments[largest],
            "each is at most the sum of the other two (triangle inequality), here " + text(others) + fix);
}

}  // namespace rbdyn::inline RBDYN_FORM::bodies
