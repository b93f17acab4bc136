// Euler angles: attitudes there and back, continuity, rates and second derivatives (eqs. 7.49-7.52).
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "random.hpp"
#include "rbdyn/rotation/attitude.hpp"

namespace rbdyn::test::test_euler_angles {

namespace {

using rbdyn::Quaternion, rbdyn::turn, rbdyn::Vector3, rbdyn::test::Random;

constexpr double pi = std::numbers::pi;
constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double rounding = 8.0 * epsilon;

double angle_between(const Quaternion& a, const Quaternion& b) {
    const Quaternion d = conjugate(a) * b;
    return 2.0 * std::atan2(std::hypot(d.x, d.y, d.z), std::abs(d.w));
}
double distance(const EulerAngles& a, const EulerAngles& b) {
    return std::max({std::abs(a.theta - b.theta), std::abs(a.psi - b.psi), std::abs(a.phi - b.phi)});
}
Matrix3 basic(int axis, double angle) { return Eigen::AngleAxisd(angle, Vector3::Unit(axis)).toRotationMatrix(); }

TEST(EulerAngles, the_attitude_is_precession_after_nutation_after_proper_rotation) {
    Random random(1);
    for (int k = 0; k < 200; ++k) {
        const EulerAngles a{random.uniform(-7, 7), random.uniform(-7, 7), random.uniform(-7, 7)};
        const Matrix3 expected = basic(2, a.psi) * basic(0, a.theta) * basic(2, a.phi);
        EXPECT_LE((rotation_matrix(quaternion(a)) - expected).cwiseAbs().maxCoeff(), rounding);
    }
}

TEST(EulerAngles, every_attitude_has_angles_that_give_it_back) {
    Random random(2);
    for (const double theta : {0.0, 1e-11, 1e-5, 0.5, pi / 2, pi - 1e-5, pi - 1e-8, pi})
        for (int k = 0; k < 50; ++k) {
            const EulerAngles a{theta, random.uniform(-pi, pi), random.uniform(-pi, pi)};
            const EulerAngles b = euler_angles(quaternion(a));
            EXPECT_LE(angle_between(quaternion(a), quaternion(b)), rounding);
            EXPECT_TRUE(b.theta >= 0.0 && b.theta <= pi && std::abs(b.psi) <= pi && std::abs(b.phi) <= pi);
            if (theta > 1e-6 && pi - theta > 1e-6) {
                EXPECT_LE(distance(a, b), rounding / std::sin(theta));
            }
        }
}

TEST(EulerAngles, upright_the_sum_of_psi_and_phi_is_all_there_is) {
    const EulerAngles upright = euler_angles(turn({0, 0, 1}, 0.75));
    EXPECT_EQ(upright.theta, 0.0);
    EXPECT_NEAR(upright.psi + upright.phi, 0.75, epsilon);
    const EulerAngles kept = continue_from({1e-3, 0.5, 10.0 * pi}, turn({0, 0, 1}, 0.75));
    EXPECT_EQ(kept.theta, 0.0);
    EXPECT_EQ(kept.psi, 0.5);
    EXPECT_NEAR(kept.phi, 0.25 + 10.0 * pi, 16.0 * epsilon * 10.0 * pi);
}

TEST(EulerAngles, upside_down_the_difference_of_psi_and_phi_is_all_there_is) {
    const Quaternion fallen = turn({0, 0, 1}, 0.75) * turn({1, 0, 0}, pi);
    const EulerAngles angles = euler_angles(fallen);
    EXPECT_NEAR(angles.theta, pi, rounding);
    EXPECT_NEAR(angles.psi - angles.phi, 0.75, rounding);
    const EulerAngles kept = continue_from({pi - 1e-3, 0.5, -6.0 * pi}, fallen);
    EXPECT_EQ(kept.psi, 0.5);
    EXPECT_NEAR(kept.phi, -0.25 - 6.0 * pi, 16.0 * epsilon * 6.0 * pi);
}

TEST(EulerAngles, a_somersault_passes_theta_0_and_pi_with_precession_and_spin_at_rest) {
    for (const double phi : {0.0, -2.0})
        for (const double sense : {1.0, -1.0}) {
            EulerAngles angles{sense * 1.0, 0.5, phi};
            // over theta = 0 and pi themselves too
            for (int k = 0; k <= 4000; ++k) {
                const double theta = sense * (k % 2 == 0 ? 1.0 + 0.005 * k : pi * std::round((1.0 + 0.005 * k) / pi));
                const EulerAngles truth{theta, 0.5, phi};
                angles = continue_from(angles, quaternion(truth));
                ASSERT_LE(distance(angles, truth), 4.0 * epsilon * (1.0 + std::abs(theta)) +
                                                       rounding / std::max(std::abs(std::sin(theta)), 1e-3))
                    << k << " " << theta << " " << angles.theta << " " << angles.psi << " " << angles.phi;
            }
        }
}

TEST(EulerAngles, a_top_that_only_nears_the_vertical_swings_psi_round_by_half_a_turn) {
    // e3 along a straight line that passes the vertical at a distance d: psi turns by pi, psi + phi does not
    const double d = 1e-3;
    EulerAngles angles{};
    double first = 0.0, last = 0.0;
    for (int k = -2000; k <= 2000; ++k) {
        const double x = d * std::sinh(0.003 * k);
        const EulerAngles truth{std::hypot(x, d), std::atan2(d, x), 0.25 - std::atan2(d, x)};
        angles = k == -2000 ? truth : continue_from(angles, quaternion(truth));
        ASSERT_LE(distance(angles, truth), 1e-12) << k;
        (k == -2000 ? first : last) = angles.psi;
    }
    EXPECT_NEAR(last - first, -pi, 0.02);
}

TEST(EulerAngles, many_turns_are_counted) {
    EulerAngles angles{0.4, 0.0, 0.0};
    for (int k = 1; k <= 100000; ++k) {
        const EulerAngles truth{0.4, -0.7 * k, 1.1 * k};
        angles = continue_from(angles, quaternion(truth));
        ASSERT_LE(distance(angles, truth), 16.0 * epsilon * (1.0 + truth.phi)) << k;
    }
}

/// A motion in Euler angles, polynomials of time.
struct Motion {
    Vector3 value, rate, half_second;
    EulerAngles at(double t) const {
        const Vector3 a = value + t * rate + t * t * half_second;
        return {a[0], a[1], a[2]};
    }
};

TEST(EulerAngles, angular_velocity_is_that_of_the_rotation_matrix) {
    Random random(3);
    for (int k = 0; k < 50; ++k) {
        const Motion m{3.0 * random.direction(), 2.0 * random.direction(), random.direction()};
        const auto r = [&](double t) { return rotation_matrix(quaternion(m.at(t))); };
        // central differences of two steps, error h^4/30 times the fifth derivative
        const double h = 1e-3;
        const Matrix3 rate = (8.0 * (r(h) - r(-h)) - (r(2 * h) - r(-2 * h))) / (12.0 * h);
        const Matrix3 spin = r(0.0).transpose() * rate;
        const Vector3 omega = angular_velocity(m.at(0.0), m.rate);
        EXPECT_LE((omega - Vector3(spin(2, 1), spin(0, 2), spin(1, 0))).norm(), 1e-9);
        EXPECT_LE((spin + spin.transpose()).norm(), 1e-9);
    }
}

TEST(EulerAngles, angular_acceleration_is_the_derivative_of_angular_velocity) {
    Random random(4);
    for (int k = 0; k < 50; ++k) {
        const Motion m{3.0 * random.direction(), 2.0 * random.direction(), random.direction()};
        const auto w = [&](double t) { return angular_velocity(m.at(t), Vector3(m.rate + 2.0 * t * m.half_second)); };
        const double h = 1e-3;
        const Vector3 expected = (8.0 * (w(h) - w(-h)) - (w(2 * h) - w(-2 * h))) / (12.0 * h);
        EXPECT_LE((angular_acceleration(m.at(0.0), m.rate, 2.0 * m.half_second) - expected).norm(), 1e-9);
    }
}

TEST(EulerAngles, rates_and_second_derivatives_come_back) {
    Random random(5);
    for (int k = 0; k < 200; ++k) {
        const EulerAngles a{random.uniform(0.1, 3.0), random.uniform(-9, 9), random.uniform(-9, 9)};
        const Vector3 rates = 3.0 * random.direction(), second = 3.0 * random.direction();
        EXPECT_NEAR(euler_matrix(a).determinant(), std::sin(a.theta), rounding);
        const double accuracy = 100.0 * epsilon / std::sin(a.theta);
        EXPECT_LE((euler_rates(a, angular_velocity(a, rates)) - rates).norm(), accuracy);
        const Vector3 beside = angular_acceleration(a, rates, second) - euler_matrix_rate(a, rates);
        EXPECT_LE((euler_inverse(a, beside) - second).norm(), 10.0 * accuracy);
    }
}

TEST(EulerAngles, the_right_side_is_that_of_eulers_equations) {
    Random random(6);
    for (int k = 0; k < 50; ++k) {
        const EulerAngles a{random.uniform(0.3, 2.8), random.uniform(-9, 9), random.uniform(-9, 9)};
        const Vector3 rates = 3.0 * random.direction(), moments(0.5, 0.75, 1.125), torque = random.direction();
        const Vector3 second = euler_inverse(a, euler_right_side(a, rates, moments, torque));
        const Vector3 w = angular_velocity(a, rates), w_rate = angular_acceleration(a, rates, second);
        // I w' + w x I w = M                                                                 (eq. 7.47)
        const Vector3 i_w = moments.cwiseProduct(w);
        EXPECT_LE((moments.cwiseProduct(w_rate) + w.cross(i_w) - torque).norm(), 1e-13);
    }
}

TEST(EulerAngles, rates_at_theta_0_and_pi_are_finite_where_the_motion_allows) {
    const EulerAngles upright{0.0, 0.5, 0.25}, fallen{pi, 0.5, 0.25};
    for (const EulerAngles& a : {upright, fallen}) {
        // a sleeping top, and a somersault about the axis of nutation
        EXPECT_EQ(euler_rates(a, {0, 0, 3.0}), Vector3(0, 0, 3.0));
        const Vector3 nutation{2.0 * std::cos(a.phi), -2.0 * std::sin(a.phi), 0.0};
        EXPECT_LE((euler_rates(a, nutation) - Vector3(2, 0, 0)).norm(), rounding);
        const Vector3 across = euler_rates(a, {0.0, 1.0, 1.0});
        EXPECT_TRUE(std::isinf(across[1]) && std::isinf(across[2]) && std::isfinite(across[0]));
    }
}

}  // namespace

}  // namespace rbdyn::test::test_euler_angles
