// An attitude from any form a user may hold: a quaternion (w, x, y, z), a rotation matrix, Euler angles.
//
// R(body -> world). Invariant: | |q|^2 - 1 | <= 4 epsilon, and to 32 digits for exact(), which is what the numbers
// given say. What is a rotation to within 1e-6, as text of seven digits is, becomes the nearest one; anything else is
// refused.
#pragma once

#include <optional>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Attitude {
public:
    /// That of the world.
    Attitude() = default;
    /// Throws InvalidInput unless | |q| - 1 | <= 1e-6.
    Attitude(const Quaternion& q);
    /// The same in 32 digits.
    Attitude(const QuaternionOf<DoubleDouble>& q);
    Attitude(const Eigen::Quaterniond& q) : Attitude(Quaternion{q.w(), q.x(), q.y(), q.z()}) {}
    /// Throws InvalidInput unless the angles are finite.
    Attitude(const EulerAngles& angles);
    /// Throws InvalidInput unless the columns are orthonormal to 1e-6 and right-handed.
    Attitude(const Matrix3& matrix);

    /// Unit; q and -q are the same attitude.
    const Quaternion& quaternion() const { return q_; }
    /// The same in 32 digits, of unit length to as many.
    const QuaternionOf<DoubleDouble>& exact() const { return exact_; }
    Matrix3 matrix() const { return rotation_matrix(q_); }
    EulerAngles euler_angles() const { return rbdyn::euler_angles(q_); }
    /// The Euler angles it was given by, of any size, if it was.
    const std::optional<EulerAngles>& given_angles() const { return given_; }

    bool operator==(const Attitude& other) const { return exact_ == other.exact_; }

private:
    static constexpr double near_enough = 1e-6;

    void take(const QuaternionOf<DoubleDouble>& q);

    Quaternion q_;
    QuaternionOf<DoubleDouble> exact_;
    std::optional<EulerAngles> given_;
};

}  // namespace rbdyn::inline RBDYN_FORM
