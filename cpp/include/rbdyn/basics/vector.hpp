// Vectors and matrices: Eigen's for the machine's numbers, under the names used throughout; in number types of our own
// three components with the operations that models need, each done component by component as it is written.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <type_traits>

#if defined(__FAST_MATH__)
#error "rbdyn: -ffast-math breaks compensated sums, event location and the accuracy estimate; compile without it"
#endif

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

using Vector3 = Eigen::Vector3d;
// by columns whatever EIGEN_DEFAULT_TO_ROW_MAJOR says
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::ColMajor>;

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
    const auto row = [&](int i) { return m(i, 0) * v[0] + (m(i, 1) * v[1] + m(i, 2) * v[2]); };
    return {row(0), row(1), row(2)};
}
template <std::same_as<Vector3> V>
bool operator==(const V& a, const V& b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}
template <class M>
concept Transposed = std::same_as<M, Eigen::Transpose<Matrix3>> || std::same_as<M, Eigen::Transpose<const Matrix3>>;
template <Transposed M, std::same_as<Vector3> V>
V operator*(const M& back, const V& v) {
    const Matrix3& m = back.nestedExpression();
    const auto column = [&](int j) { return m(0, j) * v[0] + (m(1, j) * v[1] + m(2, j) * v[2]); };
    return {column(0), column(1), column(2)};
}
template <std::same_as<Matrix3> M>
M operator*(const M& a, const M& b) {
    M result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result(i, j) = a(i, 0) * b(0, j) + (a(i, 1) * b(1, j) + a(i, 2) * b(2, j));
    return result;
}
template <Transposed M>
Matrix3 operator*(const M& back, const Matrix3& b) {
    const Matrix3& a = back.nestedExpression();
    Matrix3 result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result(i, j) = a(0, i) * b(0, j) + (a(1, i) * b(1, j) + a(2, i) * b(2, j));
    return result;
}
template <std::same_as<Matrix3> M>
bool operator==(const M& a, const M& b) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(a(i, j) == b(i, j))) return false;
    return true;
}

/// Column j, as a vector of its own.
inline Vector3 column(const Matrix3& m, int j) { return {m(0, j), m(1, j), m(2, j)}; }
Matrix3 columns(const Vector3& x, const Vector3& y, const Vector3& z);
/// v/|v|, v not zero.
inline Vector3 direction(const Vector3& v) { return v / v.norm(); }
/// |v|, also of components whose squares are beyond the range of doubles.
inline double safe_norm(const Vector3& v) {
    const double norm = v.norm();
    if (norm > 0x1p-480 && norm < 0x1p480) return norm;
    const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
    return largest > 0.0 && std::isfinite(largest) ? largest * (v / largest).norm() : largest + norm;
}
/// The sizes of the components, and of two vectors the lesser and the greater of each.
inline Vector3 sizes(const Vector3& v) { return {std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}; }
Vector3 lesser(const Vector3& a, const Vector3& b);
Vector3 greater(const Vector3& a, const Vector3& b);
inline bool is_finite(const Vector3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }
/// Which component is least, and which greatest: the first of those.
inline int least(const Vector3& v) { return static_cast<int>(std::min_element(v.data(), v.data() + 3) - v.data()); }
inline int greatest(const Vector3& v) { return static_cast<int>(std::max_element(v.data(), v.data() + 3) - v.data()); }
/// The largest size of an element.
double largest(const Matrix3& m);

/// Three components in numbers of type S.
template <class S>
class Triple {
public:
    Triple() = default;
    Triple(const S& x, const S& y, const S& z) : c_{x, y, z} {}
    Triple(const Vector3& v) : c_{S(v[0]), S(v[1]), S(v[2])} {}  // implicit: constants mix freely with other numbers
    /// Of what Eigen has not worked out yet: 2.0 * wind.
    template <class Derived>
    requires(std::floating_point<typename Derived::Scalar>&& Derived::RowsAtCompileTime == 3 &&
             Derived::ColsAtCompileTime == 1) Triple(const Eigen::MatrixBase<Derived>& v)
        : Triple(Vector3(v)) {}

    const S& operator[](Eigen::Index i) const { return c_[i]; }
    S& operator[](Eigen::Index i) { return c_[i]; }
    const S& x() const { return c_[0]; }
    const S& y() const { return c_[1]; }
    const S& z() const { return c_[2]; }
    S* begin() { return c_; }
    S* end() { return c_ + 3; }
    const S* begin() const { return c_; }
    const S* end() const { return c_ + 3; }
    const S* data() const { return c_; }

    Triple& operator+=(const Triple& v) { return *this = *this + v; }
    Triple& operator-=(const Triple& v) { return *this = *this - v; }
    Triple& operator*=(const S& s) { return *this = *this * s; }
    Triple& operator/=(const S& s) { return *this = *this / s; }
    bool operator==(const Triple&) const = default;
    friend Triple operator+(const Triple& a, const Triple& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
    friend Triple operator-(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
    friend Triple operator-(const Triple& v) { return {-v[0], -v[1], -v[2]}; }
    friend Triple operator*(const Triple& v, const S& s) { return {v[0] * s, v[1] * s, v[2] * s}; }
    friend Triple operator*(const S& s, const Triple& v) { return {s * v[0], s * v[1], s * v[2]}; }
    friend Triple operator/(const Triple& v, const S& s) { return {v[0] / s, v[1] / s, v[2] / s}; }
    friend Triple operator*(const std::array<std::array<S, 3>, 3>& rows, const Triple& v) {
        const auto row = [&](std::size_t i) { return rows[i][0] * v[0] + rows[i][1] * v[1] + rows[i][2] * v[2]; };
        return {row(0), row(1), row(2)};
    }
    friend Triple operator*(const Matrix3& m, const Triple& v) {
        const auto row = [&](int i) { return S(m(i, 0)) * v[0] + S(m(i, 1)) * v[1] + S(m(i, 2)) * v[2]; };
        return {row(0), row(1), row(2)};
    }

    S dot(const Triple& b) const { return c_[0] * b[0] + c_[1] * b[1] + c_[2] * b[2]; }
    S squaredNorm() const { return dot(*this); }
    S norm() const {
        using std::sqrt;
        return sqrt(squaredNorm());
    }
    Triple normalized() const { return *this / norm(); }
    Triple cross(const Triple& b) const {
        const Triple& a = *this;
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }

private:
    S c_[3]{};
};

/// Numbers whose vectors are Eigen's: the machine's.
template <class S>
concept EigenNumber = std::floating_point<S>;

/// A vector whose components are of any number type a model may be evaluated with.
template <class S>
using Vector3Of = std::conditional_t<EigenNumber<S>, Eigen::Matrix<S, 3, 1>, Triple<S>>;

/// Scalar and vector product, term by term, so that zero components leave nothing behind.
template <EigenNumber S>
S dot(const Eigen::Matrix<S, 3, 1>& a, const Eigen::Matrix<S, 3, 1>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <EigenNumber S>
Eigen::Matrix<S, 3, 1> cross(const Eigen::Matrix<S, 3, 1>& a, const Eigen::Matrix<S, 3, 1>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class S>
requires(!EigenNumber<S>) S dot(const Triple<S>& a, const Triple<S>& b) { return a.dot(b); }
template <class S>
requires(!EigenNumber<S>) Triple<S> cross(const Triple<S>& a, const Triple<S>& b) { return a.cross(b); }

}  // namespace rbdyn::inline RBDYN_FORM
