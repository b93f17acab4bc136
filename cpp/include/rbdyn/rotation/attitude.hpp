// An attitude from any form a user may hold: a quaternion (w, x, y, z), a rotation matrix, Euler angles.
//
// R(body -> world). Invariant: | |q|^2 - 1 | <= 4 epsilon. What is a rotation to within 1e-6, as text of seven digits
// is, becomes the nearest one; anything else is refused.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/rotation/euler_angles.hpp"

namespace rbdyn {

class Attitude {
public:
    /// That of the world.
    Attitude() = default;
    /// Throws InvalidInput unless | |q| - 1 | <= 1e-6.
    Attitude(const Quaternion& q) : q_(q) {
        const double size = std::sqrt(squared_norm(q));
        require(std::abs(size - 1.0) <= near_enough, "attitude", "norm of the quaternion", size,
                "a unit quaternion (w, x, y, z) is an attitude: divide it by its norm");
        // digits of what is unit already are kept
        if (std::abs(squared_norm(q) - 1.0) > 4.0 * std::numeric_limits<double>::epsilon()) q_ = normalized(q);
    }
    Attitude(const Eigen::Quaterniond& q) : Attitude(Quaternion{q.w(), q.x(), q.y(), q.z()}) {}
    /// Throws InvalidInput unless the angles are finite.
    Attitude(const EulerAngles& angles) : q_(rbdyn::quaternion(angles)), given_(angles) {
        for (const auto& [name, value] :
             {std::pair("theta", angles.theta), std::pair("psi", angles.psi), std::pair("phi", angles.phi)})
            require(std::isfinite(value), "EulerAngles", name, value, "an angle is finite; give it in radians");
    }
    /// Throws InvalidInput unless the columns are orthonormal to 1e-6 and right-handed.
    Attitude(const Matrix3& matrix) {
        Matrix3 square = matrix.transpose() * matrix;
        for (int i = 0; i < 3; ++i) square(i, i) -= 1.0;
        const bool finite = std::all_of(matrix.data(), matrix.data() + 9, [](double x) { return std::isfinite(x); });
        const double off = finite ? largest(square) : std::numeric_limits<double>::quiet_NaN();
        require(off <= near_enough, "attitude", "departure of the matrix from a rotation", off,
                "the columns of a rotation matrix are orthonormal: they are the body's axes in world components");
        const double volume = column(matrix, 0).dot(column(matrix, 1).cross(column(matrix, 2)));
        require(volume > 0.0, "attitude", "determinant of the matrix", volume,
                "a rotation does not mirror: its determinant is 1; turn the sign of one axis");
        // the nearest rotation: Newton's steps for the polar factor square the departure, 1e-6 to 1e-12 to 1e-24
        // (Higham, "Computing the polar decomposition", 1986)
        Matrix3 r = matrix;
        for (int k = 0; k < 2; ++k) {
            // the columns of the transposed inverse are cross products over the determinant
            const Vector3 x = column(r, 0), y = column(r, 1), z = column(r, 2), yz = y.cross(z);
            const double det = x.dot(yz);
            r = columns(0.5 * (x + yz / det), 0.5 * (y + z.cross(x) / det), 0.5 * (z + x.cross(y) / det));
        }
        q_ = normalized(of_rotation(r));
    }

    /// Unit; q and -q are the same attitude.
    const Quaternion& quaternion() const { return q_; }
    Matrix3 matrix() const { return rotation_matrix(q_); }
    EulerAngles euler_angles() const { return rbdyn::euler_angles(q_); }
    /// The Euler angles it was given by, of any size, if it was.
    const std::optional<EulerAngles>& given_angles() const { return given_; }

    bool operator==(const Attitude& other) const { return q_ == other.q_; }

private:
    static constexpr double near_enough = 1e-6;

    /// From the largest of its components, so that none is a small difference (Shepperd, "Quaternion from rotation
    /// matrix", 1978).
    static Quaternion of_rotation(const Matrix3& r) {
        // four times the squares of w, x, y, z
        const std::array square{1.0 + r(0, 0) + r(1, 1) + r(2, 2), 1.0 + r(0, 0) - r(1, 1) - r(2, 2),
                                1.0 - r(0, 0) + r(1, 1) - r(2, 2), 1.0 - r(0, 0) - r(1, 1) + r(2, 2)};
        const double wx = r(2, 1) - r(1, 2), wy = r(0, 2) - r(2, 0), wz = r(1, 0) - r(0, 1);
        const double xy = r(1, 0) + r(0, 1), xz = r(0, 2) + r(2, 0), yz = r(2, 1) + r(1, 2);
        switch (std::max_element(square.begin(), square.end()) - square.begin()) {
            case 0: return {square[0], wx, wy, wz};
            case 1: return {wx, square[1], xy, xz};
            case 2: return {wy, xy, square[2], yz};
            default: return {wz, xz, yz, square[3]};
        }
    }

    Quaternion q_;
    std::optional<EulerAngles> given_;
};

}  // namespace rbdyn
