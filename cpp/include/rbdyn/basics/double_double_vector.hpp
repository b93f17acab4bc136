// Vectors and matrices of 32 digits: Eigen's, to hold and to add; products written out.
#pragma once

#include <limits>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/vector.hpp"

/// What Eigen asks of a number type.
template <>
struct Eigen::NumTraits<rbdyn::DoubleDouble> : Eigen::NumTraits<double> {
    using Real = rbdyn::DoubleDouble;
    using NonInteger = rbdyn::DoubleDouble;
    using Nested = rbdyn::DoubleDouble;
    enum { RequireInitialization = 1, ReadCost = 2, AddCost = 20, MulCost = 10 };
};

namespace rbdyn {

/// A matrix whose elements are of any number type a model may be evaluated with.
template <class S>
using Matrix3Of = Eigen::Matrix<S, 3, 3>;

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

/// m v
inline Vector3Of<DoubleDouble> product(const Matrix3Of<DoubleDouble>& m, const Vector3Of<DoubleDouble>& v) {
    Vector3Of<DoubleDouble> result;
    for (int i = 0; i < 3; ++i) result[i] = m(i, 0) * v[0] + m(i, 1) * v[1] + m(i, 2) * v[2];
    return result;
}
/// a b
inline Matrix3Of<DoubleDouble> product(const Matrix3Of<DoubleDouble>& a, const Matrix3Of<DoubleDouble>& b) {
    Matrix3Of<DoubleDouble> result;
    for (int j = 0; j < 3; ++j) result.col(j) = product(a, Vector3Of<DoubleDouble>(b.col(j)));
    return result;
}

}  // namespace rbdyn
