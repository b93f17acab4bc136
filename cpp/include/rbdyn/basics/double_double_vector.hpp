// Vectors and matrices of 32 digits.
#pragma once

#include <type_traits>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Three columns of three numbers, zero to begin with.
class WideMatrix3 {
public:
    using Column = Triple<DoubleDouble>;

    const DoubleDouble& operator()(int i, int j) const { return columns_[j][i]; }
    DoubleDouble& operator()(int i, int j) { return columns_[j][i]; }
    const Column& col(int j) const { return columns_[j]; }
    Column& col(int j) { return columns_[j]; }
    WideMatrix3 transpose() const {
        WideMatrix3 result;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) result(i, j) = (*this)(j, i);
        return result;
    }

    WideMatrix3& operator+=(const WideMatrix3& b) {
        for (int j = 0; j < 3; ++j) columns_[j] += b.columns_[j];
        return *this;
    }
    WideMatrix3& operator-=(const WideMatrix3& b) {
        for (int j = 0; j < 3; ++j) columns_[j] -= b.columns_[j];
        return *this;
    }
    friend WideMatrix3 operator+(WideMatrix3 a, const WideMatrix3& b) { return a += b; }
    friend WideMatrix3 operator-(WideMatrix3 a, const WideMatrix3& b) { return a -= b; }
    bool operator==(const WideMatrix3&) const = default;

private:
    Column columns_[3];
};

/// A matrix of the machine's numbers, or of 32 digits.
template <class S>
using Matrix3Of = std::conditional_t<std::is_same_v<S, DoubleDouble>, WideMatrix3, Eigen::Matrix<S, 3, 3>>;

/// Doubles as they are, in numbers of 32 digits.
inline Vector3Of<DoubleDouble> widened(const Vector3& v) { return {v[0], v[1], v[2]}; }
inline Matrix3Of<DoubleDouble> widened(const Matrix3& m) {
    Matrix3Of<DoubleDouble> result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result(i, j) = m(i, j);
    return result;
}

/// The nearest doubles.
inline Vector3 rounded(const Vector3Of<DoubleDouble>& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}
inline Matrix3 rounded(const Matrix3Of<DoubleDouble>& m) {
    Matrix3 result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result(i, j) = static_cast<double>(m(i, j));
    return result;
}

inline Vector3Of<DoubleDouble> scaled(const Vector3Of<DoubleDouble>& v, const DoubleDouble& factor) {
    return {v[0] * factor, v[1] * factor, v[2] * factor};
}

/// A vector of 32 digits in numbers of type S.
template <class S>
Vector3Of<S> exactly(const Vector3Of<DoubleDouble>& v) {
    return Vector3Of<S>(exactly<S>(v[0]), exactly<S>(v[1]), exactly<S>(v[2]));
}

/// m v
inline Vector3Of<DoubleDouble> product(const Matrix3Of<DoubleDouble>& m, const Vector3Of<DoubleDouble>& v) {
    Vector3Of<DoubleDouble> result;
    for (int i = 0; i < 3; ++i) result[i] = m(i, 0) * v[0] + m(i, 1) * v[1] + m(i, 2) * v[2];
    return result;
}
/// a b
inline Matrix3Of<DoubleDouble> product(const Matrix3Of<DoubleDouble>& a, const Matrix3Of<DoubleDouble>& b) {
    Matrix3Of<DoubleDouble> result;
    for (int j = 0; j < 3; ++j) result.col(j) = product(a, b.col(j));
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
