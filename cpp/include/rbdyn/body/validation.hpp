// Which numbers are the mass properties of a body, and what is said of others.
//
// Some distribution of mass has them exactly if m > 0 and the second moments about the centre of mass,
// J = (tr I_G) 1/2 - I_G = Int rho x x^T dtau, are positive semidefinite: in principal axes no moment exceeds the sum
// of the other two, the triangle inequality. Discs and laminae (one second moment 0) and rods (two) are bodies.
#pragma once

#include <limits>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM::bodies {

/// A moment below this share of the largest element given is rounding: a tensor turned in doubles is good to some ten
/// units in the last place.
inline constexpr double no_moment = 16.0 * std::numeric_limits<double>::epsilon();
/// How far, relative to the largest moment, the triangle inequality may fail: numbers written with ten digits pass.
/// No motion depends on it; it is there to find numbers that are wrong.
inline constexpr double triangle_slack = 1e-9;
/// How far a tensor may be from symmetric, relative to its largest element: rounding of products of matrices.
inline constexpr double symmetry_slack = 1e-12;

std::string vector_text(const Vector3& v);

void require_mass(const std::string& body, double mass);

void require_symmetric(const std::string& body, const Matrix3& inertia);

/// Throws InvalidInput unless a body may have these moments, principal about its centre of mass. `given`: the largest
/// element of the tensor they derive from. `derived`: how, for the message.
void require_moments(const std::string& body, const Vector3& moments, double given, const std::string& derived);

}  // namespace rbdyn::inline RBDYN_FORM::bodies
