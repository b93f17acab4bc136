// Vectors of recorded numbers beside Eigen's: constants, and what Eigen has not worked out yet.
#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "rbdyn/rbdyn.hpp"

namespace rbdyn::test::test_vectors {
namespace {

/// The three results of f(vector), recorded, at a place.
template <class F>
Vector3 recorded(const F& f, const Vector3& at) {
    const Function function = Function::record(3, [&](const std::vector<Expression>& x) {
        const Vector3Of<Expression> y = f(Vector3Of<Expression>(x[0], x[1], x[2]));
        return std::vector<Expression>(y.begin(), y.end());
    });
    const std::vector<double> y = function(std::span<const double>(at.data(), 3));
    return {y[0], y[1], y[2]};
}

TEST(RecordedVectors, mix_with_vectors_and_matrices_of_eigen) {
    const Vector3 wind(1, -2, 0.5), at(0.25, 4, -3);
    const Matrix3 m = (Matrix3() << 1, 2, 3, 4, 5, 6, 7, 8, 10).finished();
    EXPECT_EQ(recorded([&](const auto& v) { return v - 2.0 * wind; }, at), at - 2.0 * wind);
    EXPECT_EQ(recorded([&](const auto& v) { return wind * 2.0 - v; }, at), 2.0 * wind - at);
    EXPECT_EQ(recorded([&](const auto& v) { return -0.5 * (v + wind.cross(at)); }, at), -0.5 * (at + wind.cross(at)));
    EXPECT_EQ(recorded([&](const auto&) { return wind * 2.0; }, at), 2.0 * wind);
    EXPECT_EQ(recorded([&](const auto& v) { return m * v; }, at), m * at);
    EXPECT_EQ(recorded([&](const auto& v) { return 2.0 * m * v; }, at), 2.0 * m * at);
    EXPECT_LT((recorded([&](const auto& v) { return -v.normalized(); }, at) + at.normalized()).norm(), 1e-15);
}

TEST(RecordedVectors, are_turned_by_the_rotation_matrix_a_torque_is_given) {
    const Torque torque([](const auto&, const auto& rotation, const auto& w) { return rotation * w; });
    std::vector<double> x{0.0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0.5, -1, 2};
    const std::vector<double> y = torque.function()(std::span<const double>(x));
    EXPECT_EQ(y, (std::vector<double>{4.5, 9.0, 13.5}));
}

}  // namespace
}  // namespace rbdyn::test::test_vectors
