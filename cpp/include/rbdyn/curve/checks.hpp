// The rules a curve's numbers must keep, shared by the kinds of curve. Each throws InvalidInput.
#pragma once

#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

void require_finite(const std::string& curve, const std::string& what, double value);

void require_finite(const std::string& curve, const std::string& what, const Vector3& v);

void require_positive(const std::string& curve, const std::string& what, double value, const std::string& unit);

void require_direction(const std::string& curve, const std::string& what, const Vector3& v);

/// Two directions that span a plane.
void require_plane(const std::string& curve, const Vector3& start, const Vector3& toward,
                   const std::string& first = "start", const std::string& second = "toward");

void require_domain(const std::string& curve, const Domain& domain);

/// A vector as text: (1, 0, -0.5).
std::string vector_text(const Vector3& v);

}  // namespace rbdyn::inline RBDYN_FORM::curves
