// Quaternions as attitudes: R(q) v turns a vector given in body axes into the world's.
//
// Conventions: q = (w, x, y, z) with the scalar first, |q| = 1; q and -q are the same attitude. Products follow
// Hamilton, R(p q) = R(p) R(q). With the angular velocity omega in body axes, q' = 1/2 q (0, omega).
#pragma once

#include <cmath>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A quaternion whose components are of any number type a model may be evaluated with.
template <class S>
struct QuaternionOf {
    S w = 1.0, x = 0.0, y = 0.0, z = 0.0;

    bool operator==(const QuaternionOf&) const = default;
};

using Quaternion = QuaternionOf<double>;

template <class S>
QuaternionOf<S> operator*(const QuaternionOf<S>& p, const QuaternionOf<S>& q) {
    return {p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z, p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y,
            p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x, p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w};
}

template <class S>
QuaternionOf<S> conjugate(const QuaternionOf<S>& q) {
    return {q.w, -q.x, -q.y, -q.z};
}

template <class S>
S squared_norm(const QuaternionOf<S>& q) {
    return q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
}

/// q/|q|.
template <class S>
QuaternionOf<S> normalized(const QuaternionOf<S>& q) {
    using std::sqrt;
    const S n = sqrt(squared_norm(q));
    return {q.w / n, q.x / n, q.y / n, q.z / n};
}
inline Quaternion normalized(const Quaternion& q) { return normalized<double>(q); }

inline QuaternionOf<DoubleDouble> widened(const Quaternion& q) { return {q.w, q.x, q.y, q.z}; }
/// The nearest doubles.
Quaternion rounded(const QuaternionOf<DoubleDouble>& q);

/// Columns of the rotation matrix of a unit quaternion: the body's axes in the world.
template <class S>
struct AxesOf {
    Vector3Of<S> e1, e2, e3;
};

template <class S>
AxesOf<S> axes(const QuaternionOf<S>& q) {
    const S xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, ww = q.w * q.w;
    const S xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    const S two = 2.0;
    return {Vector3Of<S>(ww + xx - yy - zz, two * (xy + wz), two * (xz - wy)),
            Vector3Of<S>(two * (xy - wz), ww - xx + yy - zz, two * (yz + wx)),
            Vector3Of<S>(two * (xz + wy), two * (yz - wx), ww - xx - yy + zz)};
}

/// A vector of the body in world axes, and one of the world in body axes.
template <class S>
Vector3Of<S> to_world(const QuaternionOf<S>& q, const Vector3Of<S>& v) {
    const AxesOf<S> e = axes(q);
    return e.e1 * v[0] + e.e2 * v[1] + e.e3 * v[2];
}
template <class S>
Vector3Of<S> to_body(const QuaternionOf<S>& q, const Vector3Of<S>& v) {
    const AxesOf<S> e = axes(q);
    return Vector3Of<S>(dot<S>(e.e1, v), dot<S>(e.e2, v), dot<S>(e.e3, v));
}

Matrix3 rotation_matrix(const Quaternion& q);
Matrix3Of<DoubleDouble> rotation_matrix(const QuaternionOf<DoubleDouble>& q);

/// The unit quaternion of a rotation matrix, from the largest of its components, so that none is a small difference
/// (Shepperd, "Quaternion from rotation matrix", 1978).
QuaternionOf<DoubleDouble> quaternion(const Matrix3Of<DoubleDouble>& r);

/// The attitude reached from the world's by a turn about an axis, of unit length [rad].
Quaternion turn(const Vector3& axis, double angle);

}  // namespace rbdyn::inline RBDYN_FORM
