// Principal axes: I = E diag(moments) E^T, the columns of E orthonormal and right-handed.
//
// By Jacobi's rotations in numbers of 32 digits; a tensor that is diagonal stays as it is. The axes come in the order
// in which they lie nearest to the given ones, so that a tensor nearly diagonal keeps the order of its moments.
// Moments equal to within the rounding of this are made equal, and one that is rounding is made zero: bodies of
// revolution and rods stay what they are in any attitude.
//
// Accuracy: moments to 1e-30 of the largest, axes to 1e-30 over the relative gap between their moments.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class S>
struct PrincipalAxesOf {
    Vector3Of<S> moments;  // [kg m^2]
    Matrix3Of<S> axes;     // columns: unit vectors, in the axes of the tensor
};

using PrincipalAxes = PrincipalAxesOf<double>;

inline PrincipalAxes rounded(const PrincipalAxesOf<DoubleDouble>& p) { return {rounded(p.moments), rounded(p.axes)}; }

namespace bodies {

/// Sets a(p, q) to zero by a turn in the plane of axes p and q, and turns the axes e with it.
void jacobi_turn(Matrix3Of<DoubleDouble>& a, Matrix3Of<DoubleDouble>& e, int p, int q);

}  // namespace bodies

/// Of a symmetric tensor of finite elements.
PrincipalAxesOf<DoubleDouble> principal_axes(Matrix3Of<DoubleDouble> a);

}  // namespace rbdyn::inline RBDYN_FORM
