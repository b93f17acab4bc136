// Vectors in doubles and in number types of our own: the same text means the same.
#include "rbdyn/basics/vector.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <type_traits>

#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/rounded.hpp"

namespace rbdyn::test::test_vector {

namespace {

/// Every operation a model may use on vectors.
template <class S>
Vector3Of<S> all_operations(const Vector3Of<S>& a, const Vector3Of<S>& b, const S& s) {
    Vector3Of<S> c = (a + b) * s - s * a / S(3.0);
    c += a * dot(a, b);
    c -= cross(a, b) * a.dot(b);
    c *= a.squaredNorm();
    c /= S(1.0) + b.norm();
    for (auto& component : c) component = component + S(0.5);
    c[2] = c.x() - c.y() * c.z();
    return c.cross(b);
}

}  // namespace

TEST(Vectors, the_machine_s_numbers_are_eigen_s_vectors) {
    EXPECT_TRUE((std::is_same_v<Vector3Of<double>, Eigen::Vector3d>));
    EXPECT_TRUE((std::is_same_v<Vector3Of<long double>, Eigen::Matrix<long double, 3, 1>>));
}

TEST(Vectors, numbers_of_our_own_do_what_doubles_do) {
    using rbdyn::Rounded;
    const Vector3 a(0.25, -1.5, 3.0), b(2.0, 0.125, -0.75);
    const Vector3 plain = all_operations<double>(a, b, 1.75);
    const Vector3Of<Rounded> rounded = all_operations<Rounded>(a, b, 1.75);
    const Vector3Of<long double> precise =
        all_operations<long double>(a.cast<long double>(), b.cast<long double>(), 1.75L);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(plain[i], static_cast<double>(precise[i]), rounded[i].error);
        EXPECT_NEAR(rounded[i].value, static_cast<double>(precise[i]), rounded[i].error);
        EXPECT_LT(rounded[i].error, 1e-12 * plain.norm());
    }
    const Vector3Of<rbdyn::Expression> constant = all_operations<rbdyn::Expression>(a, b, 1.75);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(constant[i].value(), rounded[i].value);
}

TEST(Vectors, matrices_turn_vectors_as_eigen_turns_them) {
    const Matrix3 m{{0.3, -1.7, 2.1}, {1.1, 0.9, -0.4}, {-2.3, 0.6, 1.9}};
    const Vector3 v(0.7, -1.3, 2.9);
    // to the rounding of three products and two sums on each side, whose order is free
    const auto expect_same = [&](const Vector3& ours, const Vector3& eigens, const Matrix3& matrix) {
        const Vector3 sizes = matrix.cwiseAbs().lazyProduct(v.cwiseAbs());
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(ours[i], eigens[i], 3.0 * std::numeric_limits<double>::epsilon() * sizes[i]);
    };
    expect_same(m * v, m.lazyProduct(v), m);
    expect_same(m.transpose() * v, m.transpose().lazyProduct(v), m.transpose());
}

}  // namespace rbdyn::test::test_vector
