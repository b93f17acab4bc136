// A spring with a damper along it.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// -(stiffness (length - rest_length) + damping d(length)/dt) along the line of its ends. stiffness [N/m], rest_length
/// [m], damping [kg/s].
struct Spring {
    Given stiffness = 0.0;
    Given rest_length = 0.0;
    Given damping = 0.0;

    bool present() const { return !stiffness.is_zero() || !damping.is_zero(); }
    bool operator==(const Spring&) const = default;
    /// With the numbers of the user's as they are now.
    Spring frozen() const;
    void give(GivenNumbers& numbers) const;
    void validate() const;

    /// Force on the first end; `d` and `v`: position and velocity of the first end relative to the second.
    /// Along a straight way through the second end the direction is a sign, locked between passages; elsewhere the two
    /// ends may not meet.
    Vector3Of<Expression> operator()(const Vector3Of<Expression>& d, const Vector3Of<Expression>& v) const;
    /// In numbers: where the ends meet, |d| within rounding of numbers of the given size, the direction is that of what
    /// comes next.
    Vector3 operator()(const Vector3& d, const Vector3& v, double size = 0.0) const;
    /// -k (length - rest_length)^2 / 2: U, with F = +grad U (the chapter's sign) [J].
    double potential(double length) const;
};

namespace couplings {

/// The one component of a recorded vector that does not vanish identically, or -1.
int only_component(const Vector3Of<Expression>& d);

/// The direction of a relative position in numbers; where the ends meet, |d| within rounding of numbers of the given
/// size, that of what comes next.
Vector3 direction(const Vector3& d, const Vector3& v, double size);

}  // namespace couplings

}  // namespace rbdyn::inline RBDYN_FORM
