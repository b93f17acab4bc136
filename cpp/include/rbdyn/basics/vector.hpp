// Vectors and matrices: Eigen's in doubles, under the names used throughout; in other number types three components
// with the operations that models need, each done component by component as it is written.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <concepts>
#include <type_traits>

#if defined(__FAST_MATH__)
#error "rbdyn: -ffast-math breaks compensated sums, event location and the accuracy estimate; compile without it"
#endif

namespace rbdyn {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

// In doubles, one operation at a time: results are vectors, not expressions, of which there would be hundreds of types
// to compile. Chosen before Eigen's own where both operands are vectors themselves, and only there.
template <std::same_as<Vector3> V>
V operator+(const V& a, const V& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <std::same_as<Vector3> V>
V operator-(const V& a, const V& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <std::same_as<Vector3> V>
V operator-(const V& v) {
    return {-v[0], -v[1], -v[2]};
}
template <std::same_as<Vector3> V, class T>
requires std::is_arithmetic_v<T> V operator*(const V& v, const T& s) { return {v[0] * s, v[1] * s, v[2] * s}; }
template <std::same_as<Vector3> V, class T>
requires std::is_arithmetic_v<T> V operator*(const T& s, const V& v) { return {s * v[0], s * v[1], s * v[2]}; }
template <std::same_as<Vector3> V, class T>
requires std::is_arithmetic_v<T> V operator/(const V& v, const T& s) { return {v[0] / s, v[1] / s, v[2] / s}; }
template <std::same_as<Matrix3> M, std::same_as<Vector3> V>
V operator*(const M& m, const V& v) {
    return m.lazyProduct(v);
}
template <std::same_as<Matrix3> M, std::same_as<Vector3> V>
V operator*(const Eigen::Transpose<const M>& back, const V& v) {
    const M& m = back.nestedExpression();
    const auto along = [&](int i) { return m(0, i) * v[0] + m(1, i) * v[1] + m(2, i) * v[2]; };
    return {along(0), along(1), along(2)};
}

/// A vector in numbers of type S.
template <class S>
class Triple;

/// A vector whose components are of any number type a model may be evaluated with.
template <class S>
using Vector3Of = std::conditional_t<std::is_same_v<S, double>, Vector3, Triple<S>>;

template <class S>
class Triple {
public:
    Triple() = default;
    Triple(const S& x, const S& y, const S& z) : c_{x, y, z} {}
    Triple(const Vector3& v) : c_{S(v[0]), S(v[1]), S(v[2])} {}  // implicit: constants mix freely with other numbers

    const S& operator[](Eigen::Index i) const { return c_[i]; }
    S& operator[](Eigen::Index i) { return c_[i]; }
    const S& x() const { return c_[0]; }
    const S& y() const { return c_[1]; }
    const S& z() const { return c_[2]; }
    const S* data() const { return c_; }
    /// In another number type.
    template <class T>
    Vector3Of<T> cast() const {
        return {static_cast<T>(c_[0]), static_cast<T>(c_[1]), static_cast<T>(c_[2])};
    }

    Triple& operator+=(const Triple& v) { return *this = *this + v; }
    Triple& operator-=(const Triple& v) { return *this = *this - v; }
    Triple& operator*=(const S& s) { return *this = *this * s; }
    Triple& operator/=(const S& s) { return *this = *this / s; }
    friend Triple operator+(const Triple& a, const Triple& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
    friend Triple operator-(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
    friend Triple operator-(const Triple& v) { return {-v[0], -v[1], -v[2]}; }
    friend Triple operator*(const Triple& v, const S& s) { return {v[0] * s, v[1] * s, v[2] * s}; }
    friend Triple operator*(const S& s, const Triple& v) { return {s * v[0], s * v[1], s * v[2]}; }
    friend Triple operator/(const Triple& v, const S& s) { return {v[0] / s, v[1] / s, v[2] / s}; }

    friend S dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    friend Triple cross(const Triple& a, const Triple& b) {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
    S dot(const Triple& b) const { return c_[0] * b[0] + c_[1] * b[1] + c_[2] * b[2]; }
    Triple cross(const Triple& b) const {
        const Triple& a = *this;
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }

private:
    S c_[3]{};
};

/// Scalar and vector product, term by term, so that zero components leave nothing behind.
template <class S>
S dot(const Vector3Of<S>& a, const Vector3Of<S>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class S>
Vector3Of<S> cross(const Vector3Of<S>& a, const Vector3Of<S>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double dot(const Vector3& a, const Vector3& b) { return dot<double>(a, b); }
inline Vector3 cross(const Vector3& a, const Vector3& b) { return cross<double>(a, b); }

}  // namespace rbdyn
