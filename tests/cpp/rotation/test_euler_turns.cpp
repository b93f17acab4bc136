// Turns of Euler angles of motions that repeat themselves, against the way gone in steps that lose none.
#include <gtest/gtest.h>

#include "random.hpp"
#include "rbdyn/closed_form/free_rotation.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/rotation/euler_turns.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::test::test_euler_turns {

TEST(FloorSum, is_the_sum_term_by_term) {
    Random random(11);
    for (int k = 0; k < 5000; ++k) {
        const long double alpha = random.uniform(-5.0, 5.0), beta = random.uniform(-5.0, 5.0);
        const int n = k % 200;
        long double sum = 0.0L;
        for (int i = 0; i < n; ++i) sum += std::floor(alpha * i + beta);
        EXPECT_EQ(floor_sum(n, alpha, beta), sum) << n;
    }
}

Turning at(const FreeRotation& rotation, double t) {
    const FreeRotation::State s = rotation.at(t);
    return {s.attitude, s.angular_velocity};
}

TEST(EulerTurns, of_free_rotations_are_those_of_the_way_gone) {
    Random random(12);
    int compared = 0;
    for (int k = 0; k < 120; ++k) {
        Vector3 moments(0, 0, 0), omega(0, 0, 0);
        for (int i = 0; i < 3; ++i) {
            moments[i] = random.uniform(0.5, 1.0);
            omega[i] = random.uniform(-4.0, 4.0);
        }
        const Vector3 about = random.direction();
        Quaternion start = turn(about, random.uniform(-3.0, 3.0));
        const int kind = k % 6;
        if (kind == 1) moments[1] = moments[0];
        if (kind == 2) moments[1] = moments[2] = moments[0];
        if (kind == 3) omega = {0.0, 0.0, 2.0};
        if (kind == 4) start = {1.0, 0.0, 0.0, 0.0};  // at theta = 0
        if (kind == 5) omega = {2.0, 0.01 * omega[1], 0.01 * omega[2]};
        Matrix3Of<DoubleDouble> inertia;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) inertia(i, j) = i == j ? moments[i] : 0.0;
        const FreeRotation rotation(inertia, start, omega);
        const auto motion = [&](double t) { return at(rotation, t); };
        const auto forget = [](const EulerStep&) {};
        EulerStep walked(0.0, motion(0.0), euler_path::begin(motion(0.0), std::nullopt));
        walked = euler_path::follow(walked, 0.5 / walked.speed, motion, forget);
        Vector3 momentum(0, 0, 0);
        for (int i = 0; i < 3; ++i) momentum[i] = moments[i] * omega[i];
        momentum = to_world<double>(start, momentum);
        // omega constant, or the third axis that of revolution: any time is a period
        const bool is_steady = rotation.regime() == FreeRotation::Regime::permanent || kind == 1;
        const double period = is_steady ? 1.0 / omega.norm() : rotation.period();
        const auto turns = EulerTurns::of({momentum, period}, walked, motion);
        ASSERT_TRUE(turns) << k;
        for (const double t : {1.0, 3.0, 10.0, 60.0}) {
            walked = euler_path::follow(walked, t, motion, forget);
            const Quaternion now = motion(t).attitude;
            const EulerAngles way = continue_from(walked.angles, now);
            const auto angles = turns->at(t, now);
            ASSERT_TRUE(angles) << k << " at " << t;
            EXPECT_NEAR(angles->theta, way.theta, 1e-9) << k << " at " << t;
            EXPECT_NEAR(angles->psi, way.psi, 1e-9) << k << " at " << t;
            EXPECT_NEAR(angles->phi, way.phi, 1e-9) << k << " at " << t;
            ++compared;
        }
    }
    EXPECT_EQ(compared, 480);
}

TEST(EulerPath, of_a_turn_about_an_axis_goes_on_through_the_poles) {
    const EulerAngles over = euler_path::of_turn({0.0, 1.0, 0.0}, 40.0, 0.0);
    EXPECT_EQ(over.theta, 40.0);
    EXPECT_EQ(over.psi + over.phi, 0.0);
    const Vector3 tilted = Vector3(0.6, 0.0, 0.8);
    EulerAngles before = euler_path::of_turn(tilted, 0.3, 0.3);
    for (int k = 1; k <= 4000; ++k) {
        const double angle = 0.3 + 0.01 * k;
        const EulerAngles a = euler_path::of_turn(tilted, angle, 0.3);
        EXPECT_LT(std::abs(a.theta - before.theta) + std::abs(a.psi - before.psi) + std::abs(a.phi - before.phi), 0.04);
        EXPECT_LE((rotation_matrix(quaternion(a)) - rotation_matrix(turn(tilted, angle))).norm(), 1e-13);
        before = a;
    }
    // half a turn of psi and phi each with every turn about the axis, upwards
    EXPECT_NEAR(before.psi + before.phi - 2.0 * std::atan2(0.8 * std::sin(20.15), std::cos(20.15)),
                12.0 * std::numbers::pi, 1e-12);
}

TEST(EulerPath, begins_at_a_pole_with_the_angles_that_it_leaves_it_by) {
    for (const bool is_fallen : {false, true})
        for (const Vector3& omega :
             {Vector3(1, 0, 0), Vector3(0.5, -2, 0.25), Vector3(-1, 1, 3), Vector3(0, -1, -0.5)}) {
            const Quaternion spun{std::cos(0.4), 0.0, 0.0, std::sin(0.4)};
            const Quaternion start = is_fallen ? Quaternion{0.0, 1.0, 0.0, 0.0} * spun : spun;
            const EulerAngles first = euler_path::begin({start, omega}, std::nullopt);
            constexpr double soon = 1e-6;
            const EulerAngles next = euler_angles(start * turn(omega.normalized(), soon * omega.norm()));
            EXPECT_NEAR(first.theta, next.theta, 2.0 * soon * omega.norm()) << omega.transpose();
            EXPECT_NEAR(std::remainder(first.psi - next.psi, 2.0 * std::numbers::pi), 0.0, 10.0 * soon)
                << omega.transpose();
            EXPECT_NEAR(std::remainder(first.phi - next.phi, 2.0 * std::numbers::pi), 0.0, 10.0 * soon)
                << omega.transpose();
        }
}

}  // namespace rbdyn::test::test_euler_turns
