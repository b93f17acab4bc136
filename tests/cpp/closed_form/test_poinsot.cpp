// Rates and angles of motions without torque against the closed form and the reference digits.
#include "rbdyn/closed_form/poinsot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rbdyn/closed_form/free_rotation.hpp"

namespace rbdyn::test_poinsot {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

TEST(Poinsot, a_rotation_is_permanent_along_principal_axes_only) {
    const Matrix3 r = rotation_matrix(turn(Vector3(1, 2, 2) / 3.0, 0.7));
    const Matrix3 inertia = r * Vector3(1, 2, 3).asDiagonal() * r.transpose();
    for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(is_permanent_rotation(inertia, 5.0 * r.col(axis)));
    EXPECT_FALSE(is_permanent_rotation(inertia, r * Vector3(1.0, 1e-6, 0.0)));
    EXPECT_TRUE(is_permanent_rotation(inertia, Vector3::Zero()));
}

TEST(Poinsot, a_disturbance_grows_about_the_intermediate_axis_at_the_rate_of_the_closed_form) {
    const Vector3 moments(1.0, 2.0, 2.75);
    const double speed = 1.5, rate = growth_rate(moments, 1, speed);
    EXPECT_NEAR(rate, speed * std::sqrt(1.0 * 0.75 / 2.75), 4 * epsilon);
    EXPECT_EQ(growth_rate(moments, 0, speed), 0.0);
    EXPECT_EQ(growth_rate(moments, 2, speed), 0.0);
    // along the growing direction; second order leaves the square of what it has grown to
    const double w1 = 1e-12, w3 = w1 * std::sqrt(1.0 * 1.0 / (2.75 * 0.75));
    const FreeRotation motion(widened(Matrix3(moments.asDiagonal())), {}, {w1, speed, -w3});
    const FreeRotation mirror(widened(Matrix3(moments.asDiagonal())), {}, {w1, speed, w3});
    const double t = 10.0;
    const double grown =
        std::max(std::abs(motion.at(t).angular_velocity[0]), std::abs(mirror.at(t).angular_velocity[0]));
    EXPECT_NEAR(grown / (w1 * std::exp(rate * t)), 1.0, 1e-13);
    // about a stable axis the disturbance oscillates
    const FreeRotation wobble(widened(Matrix3(moments.asDiagonal())), {}, {1e-9, 0.0, speed});
    EXPECT_NEAR(wobble.period(), 2.0 * std::numbers::pi / std::sqrt(-disturbance_rate_squared(moments, 2, speed)),
                1e-13);
}

TEST(Poinsot, the_earth_s_axis_wobbles_in_three_hundred_days_and_goes_round_in_less_than_one) {
    // I1 = 0.9966 I3, as the chapter has it; polar motion 1e-6 rad
    const double i1 = 0.9966, i3 = 1.0, day = 7.292115e-5;
    const RegularPrecession motion = regular_precession(i1, i3, {1e-6 * day, 0.0, day});
    EXPECT_NEAR(-motion.proper_rotation_rate / day, 0.0034115994380894626, 1e-16);
    EXPECT_NEAR(day / -motion.proper_rotation_rate, 293.11764705882711, 1e-10);
    EXPECT_NEAR(2.0 * std::numbers::pi / motion.precession_rate, 85871.142694980353, 1e-10);
    EXPECT_NEAR(motion.tilt, 9.966e-7, 1e-15);
}

TEST(Poinsot, a_gyroscope_precesses_as_its_closed_form_does) {
    const Vector3 omega(0.5, -0.25, 2.0);
    for (double i3 : {1.5, 0.4}) {
        const RegularPrecession motion = regular_precession(1.0, i3, omega);
        const FreeRotation exact(widened(Matrix3(Vector3(1.0, 1.0, i3).asDiagonal())), {}, omega);
        EXPECT_NEAR(motion.precession_rate, exact.precession_rate(), 4 * epsilon);
        EXPECT_NEAR(motion.proper_rotation_rate, exact.proper_rotation_rate(), 4 * epsilon);
        EXPECT_NEAR(motion.tilt, exact.tilt().first, 4 * epsilon);
    }
}

TEST(Poinsot, the_plane_on_which_the_ellipsoid_rolls_keeps_its_distance) {
    const Vector3 moments(1, 2, 3), omega(0.1, 1.0, -0.3);
    const Matrix3 inertia = moments.asDiagonal();
    const FreeRotation motion(widened(inertia), {}, omega);
    const double distance = poinsot_plane_distance(inertia, omega);
    const Vector3 k = (inertia * omega).normalized();
    for (double t : {1.0, 10.0, 1000.0}) {
        const auto [q, w] = motion.at(t);
        EXPECT_NEAR(poinsot_plane_distance(inertia, w), distance, 4e-15);
        EXPECT_NEAR((rotation_matrix(q) * w).dot(k), distance, 4e-15);
    }
    EXPECT_EQ(poinsot_plane_distance(inertia, Vector3::Zero()), 0.0);
}

}  // namespace
}  // namespace rbdyn::test_poinsot
