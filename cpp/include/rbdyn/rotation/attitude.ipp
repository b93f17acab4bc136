// Definitions of rbdyn/rotation/attitude.hpp.
#pragma once

#include "rbdyn/rotation/attitude.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Attitude::Attitude(const Quaternion& q) : Attitude(widened(q)) {
    // digits of what is unit already are kept
    if (std::abs(squared_norm(q) - 1.0) <= 4.0 * std::numeric_limits<double>::epsilon()) q_ = q;
}

RBDYN_INLINE Attitude::Attitude(const QuaternionOf<DoubleDouble>& q) {
    const double size = std::sqrt(squared_norm(rounded(q)));
    require(std::abs(size - 1.0) <= near_enough, "attitude", "norm of the quaternion", size,
            "a unit quaternion (w, x, y, z) is an attitude: divide it by its norm");
    // what is unit already stays as it is
    const DoubleDouble off = squared_norm(q) - 1.0;
    take(std::abs(off.hi) > 0x1p-98 ? normalized(q) : q);
}

RBDYN_INLINE Attitude::Attitude(const EulerAngles& angles) : given_(angles) {
    for (const auto& [name, value] :
         {std::pair("theta", angles.theta), std::pair("psi", angles.psi), std::pair("phi", angles.phi)})
        // of larger ones doubles are a turn apart soon, and whole turns are not taken off exactly
        require(std::abs(value) <= 1e15, "EulerAngles", name, value,
                "an angle is finite and at most 1e15, so that doubles tell its last turn; give it in radians");
    take(exact_quaternion(angles));
}

RBDYN_INLINE Attitude::Attitude(const Matrix3& matrix) {
    Matrix3 square = matrix.transpose() * matrix;
    for (int i = 0; i < 3; ++i) square(i, i) -= 1.0;
    const bool finite = std::all_of(matrix.data(), matrix.data() + 9, [](double x) { return std::isfinite(x); });
    const double off = finite ? largest(square) : std::numeric_limits<double>::quiet_NaN();
    require(off <= near_enough, "attitude", "departure of the matrix from a rotation", off,
            "the columns of a rotation matrix are orthonormal: they are the body's axes in world components");
    const double volume = column(matrix, 0).dot(column(matrix, 1).cross(column(matrix, 2)));
    require(volume > 0.0, "attitude", "determinant of the matrix", volume,
            "a rotation does not mirror: its determinant is 1; turn the sign of one axis");
    // the nearest rotation: Newton's steps for the polar factor square the departure, 1e-6 to 1e-12, 1e-24, 1e-48
    // (Higham, "Computing the polar decomposition", 1986)
    Matrix3Of<DoubleDouble> r = widened(matrix);
    for (int k = 0; k < 3; ++k) {
        // the columns of the transposed inverse are cross products over the determinant
        const Vector3Of<DoubleDouble> x = r.col(0), y = r.col(1), z = r.col(2), yz = y.cross(z);
        const DoubleDouble inverse = 1.0 / x.dot(yz), half = 0.5;
        r.col(0) = scaled(x + scaled(yz, inverse), half);
        r.col(1) = scaled(y + scaled(z.cross(x), inverse), half);
        r.col(2) = scaled(z + scaled(x.cross(y), inverse), half);
    }
    take(rbdyn::quaternion(r));
}

RBDYN_INLINE void Attitude::take(const QuaternionOf<DoubleDouble>& q) {
    exact_ = q;
    q_ = rounded(q);
}

}  // namespace rbdyn::inline RBDYN_FORM
