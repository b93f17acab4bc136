// Bodies of uniform density by their shape, and points of mass: mass, centre of mass and inertia in closed form.
//
//   I_ij = Int rho (|x|^2 delta_ij - x_i x_j) dtau                       (proof of eq. 7.33), over the volume, the
//                                                                        surface or the line that carries the mass
//
// All are centred on their centre of mass but the cone, whose apex is at the origin. Lengths [m], positive; directions
// of any length. Computed in 32 digits from the doubles given. Each throws InvalidInput for numbers that make no shape.
#pragma once

#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/rigid_body.hpp"

namespace rbdyn::inline RBDYN_FORM::shapes {

namespace detail {

DoubleDouble positive(const std::string& shape, const std::string& what, double value, const std::string& unit = "m");

/// The unit vector of a direction, in 32 digits.
Vector3Of<DoubleDouble> unit(const std::string& shape, const std::string& what, const Vector3& v);

/// A body of revolution: moments along its axis and across it, about its centre of mass at a height on the axis.
RigidBody revolved(const std::string& shape, const DoubleDouble& mass, const Vector3Of<DoubleDouble>& axis,
                   const DoubleDouble& along, const DoubleDouble& across, const DoubleDouble& height = 0.0);

/// The moments are k (b^2 + c^2), k (c^2 + a^2), k (a^2 + b^2).
RigidBody three_planes(const std::string& shape, double mass, const Vector3& size, const DoubleDouble& share);

}  // namespace detail

/// A thin straight rod: m l^2/12 across, 0 along it.
RigidBody rod(double mass, double length, const Vector3& along);

/// A block with faces across the body's axes, its edges `size`: m (b^2 + c^2)/12 and so on.
RigidBody box(double mass, const Vector3& size);

/// A thin disc: m r^2/2 about its normal, half of it across.
RigidBody disc(double mass, double radius, const Vector3& normal);

/// A thin ring: m r^2 about its normal, half of it across.
RigidBody ring(double mass, double radius, const Vector3& normal);

/// A solid cylinder: m r^2/2 about its axis, m (3 r^2 + h^2)/12 across.
RigidBody cylinder(double mass, double radius, double height, const Vector3& axis);

/// A solid ball: 2/5 m r^2.
RigidBody sphere(double mass, double radius);

/// A thin spherical shell: 2/3 m r^2.
RigidBody shell(double mass, double radius);

/// A solid cone, its apex at the origin, its axis from there to the middle of its base; G at 3/4 of its height. About
/// G: 3/10 m r^2 about the axis, 3/80 m (4 r^2 + h^2) across.
RigidBody cone(double mass, double radius, double height, const Vector3& axis);

/// A solid ellipsoid with its semi-axes along the body's: m (b^2 + c^2)/5 and so on.
RigidBody ellipsoid(double mass, const Vector3& semi_axes);

/// Points of mass [kg] at positions [m] in the body's axes, held together.
RigidBody points(const std::vector<double>& masses, const std::vector<Vector3>& positions);

}  // namespace rbdyn::inline RBDYN_FORM::shapes
