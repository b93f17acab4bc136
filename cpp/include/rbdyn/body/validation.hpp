// Which numbers are the mass properties of a body, and what is said of others.
//
// Some distribution of mass has them exactly if m > 0 and the second moments about the centre of mass,
// J = (tr I_G) 1/2 - I_G = Int rho x x^T dtau, are positive semidefinite: in principal axes no moment exceeds the sum
// of the other two, the triangle inequality. Discs and laminae (one second moment 0) and rods (two) are bodies.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/principal_axes.hpp"

namespace rbdyn::bodies {

/// A moment below this share of the largest element given is rounding: a tensor turned in doubles is good to some ten
/// units in the last place.
inline constexpr double no_moment = 16.0 * std::numeric_limits<double>::epsilon();
/// How far, relative to the largest moment, the triangle inequality may fail: numbers written with ten digits pass.
/// No motion depends on it; it is there to find numbers that are wrong.
inline constexpr double triangle_slack = 1e-9;
/// How far a tensor may be from symmetric, relative to its largest element: rounding of products of matrices.
inline constexpr double symmetry_slack = 1e-12;

inline std::string vector_text(const Vector3& v) {
    return "(" + text(v[0]) + ", " + text(v[1]) + ", " + text(v[2]) + ")";
}

inline void require_mass(const std::string& body, double mass) {
    require(std::isfinite(mass) && mass > 0.0, body, "mass", mass, "a mass is positive and finite; give it in kg");
}

inline void require_symmetric(const std::string& body, const Matrix3& inertia) {
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

/// Throws InvalidInput unless a body may have these moments, principal about its centre of mass. `given`: the largest
/// element of the tensor they derive from. `derived`: how, for the message.
inline void require_moments(const std::string& body, const Vector3& moments, double given, const std::string& derived) {
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

}  // namespace rbdyn::bodies
