// The chapter's own formulation in Euler angles, against quaternions.
#include "rbdyn/model/euler_top.hpp"
#include "rbdyn/own_motion.hpp"

#include <gtest/gtest.h>

#include "refusal.hpp"
#include "support.hpp"

namespace rbdyn::test::test_euler_top {
namespace {

const RigidBody body(1.0, {0.5, 0.75, 0.4}, {.com = {0.1, 0.05, 0.3}, .inertia_about = InertiaAbout::origin});
const EulerAngles start{1.25, 0.5, 0.75};
const Vector3 omega(1.0, 2.0, -3.0);

std::string printed(const StateRun& run) {
    std::ostringstream out;
    out << run;
    return out.str();
}

TEST(EulerTop, moves_as_the_body_in_quaternions_does) {
    const double g = 9.8125;
    const EulerTop top(body, g);
    const StateRun angles = simulate(top, EulerTop::state(start, omega), {.until = 1.0, .error = 1e-10});
    ASSERT_EQ(angles.status(), Status::reached_end);
    Scene scene({0, 0, -g});
    const BodyHandle h = scene.add(body, Spherical{}, {.attitude = start, .angular_velocity = omega});
    const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-11});
    for (const double t : {0.1, 0.5, 1.0}) {
        const std::vector<double> x = angles.state(t);
        const Matrix3 r = rotation_matrix(quaternion(EulerAngles{x[0], x[1], x[2]}));
        EXPECT_LT((r - run[h].rotation_matrix(t)).norm(), 1e-9);
        EXPECT_LT(
            (angular_velocity(EulerAngles{x[0], x[1], x[2]}, {x[3], x[4], x[5]}) - run[h].angular_velocity(t)).norm(),
            1e-8);
    }
}

TEST(EulerTop, stops_where_the_angles_fail_and_says_so) {
    // a pendulum that falls through the lowest point, theta = pi
    const RigidBody bob(1.0, {0.5, 0.5, 0.25}, {.com = {0, 0, 0.5}, .inertia_about = InertiaAbout::origin});
    const EulerTop top(bob, 9.8125);
    const StateRun run =
        simulate(top, EulerTop::state({2.0, 0.0, 0.0}, Vector3::Zero()), {.until = 10.0, .error = 1e-9});
    EXPECT_EQ(run.status(), Status::stopped_by_event);
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_EQ(run.events()[0].name, "sin theta too small for Euler angles");
    EXPECT_NE(printed(run).find("stopped by event"), std::string::npos) << printed(run);
    EXPECT_NE(printed(run).find("sin theta too small for Euler angles"), std::string::npos) << printed(run);
    const double theta = run.state(run.end())[0];
    EXPECT_NEAR(std::abs(std::sin(theta)), 1e-3, 1e-12);
}

TEST(EulerTop, refuses_a_start_where_the_angles_fail) {
    const EulerTop top(body, 9.8125);
    for (const double theta : {0.0, 9e-4, 3.1415}) {
        const std::string message = refusal([&] { simulate(top, {theta, 0.0, 0.0, 0.0, 0.0, 1.0}, {.until = 1.0}); });
        EXPECT_NE(message.find("EulerTop: |sin theta| at the start"), std::string::npos) << message;
    }
}

TEST(EulerTop, refuses_axes_that_are_not_principal) {
    Matrix3 inertia;
    inertia << 1.0, 0.1, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 1.0;
    const std::string message = refusal([&] { EulerTop(RigidBody(1.0, inertia), 9.81); });
    EXPECT_NE(message.find("product of inertia 12 is 0.1"), std::string::npos) << message;
}

}  // namespace
}  // namespace rbdyn::test::test_euler_top
