// Watched functions of rigid bodies: what they see, and actions that change how a body moves.
#include <gtest/gtest.h>

#include <rbdyn/rbdyn.hpp>

namespace rbdyn::test::test_actions {

namespace {

const RigidBody top(1.5, {0.6, 0.6, 0.2}, {.com = {0, 0, 0.4}, .inertia_about = rbdyn::InertiaAbout::origin});
const RigidBody stone(1.5, {0.6, 0.8, 1.1}, {.com = {0.1, -0.2, 0.3}});
const Vector3 gravity(0, 0, -9.8);

/// The motion of a body with a change at t = 0.5 s.
template <class... How>
rbdyn::Trajectory changed(const StateChange& change, const RigidBody& body, const How&... how) {
    Scene scene(gravity);
    scene.add(body, how...);
    scene.watch("now", [](const Now& now) { return now.time() - 0.5; },
                {.action = {rbdyn::WatchAction::Kind::change, [=](const Observe&) { return std::vector{change}; }}});
    return simulate(scene, {.until = 1.0, .error = 1e-10});
}
constexpr BodyHandle first{0};

TEST(Actions, a_blow_leaves_attitude_and_place) {
    const auto run = changed({.body = first, .angular_velocity = Vector3(1, 2, 3)}, stone, Free{},
                             rbdyn::BodyStart{.attitude = EulerAngles{0.7, -0.4, 1.3}});
    const auto motion = run[first];
    EXPECT_EQ((motion.angular_velocity(0.5) - Vector3(1, 2, 3)).norm(), 0.0);
    EXPECT_LT((motion.position(0.5) - motion.position(0.5, Side::before)).norm(), 1e-14);
    EXPECT_LT((motion.velocity(0.5) - motion.velocity(0.5, Side::before)).norm(), 1e-14);
    EXPECT_LT((motion.rotation_matrix(0.5) - motion.rotation_matrix(0.5, Side::before)).norm(), 1e-14);
}

TEST(Actions, the_spin_of_a_top_is_what_the_action_says_from_then_on) {
    const auto run =
        changed({.body = first, .angular_velocity = Vector3(0.1, 0, 12)}, top, Spherical{},
                rbdyn::SphericalStart{.attitude = EulerAngles{0.7, -0.4, 1.3}, .angular_velocity = Vector3(0, 0, 8)});
    EXPECT_NEAR(run[first].angular_velocity(0.25)[2], 8.0, 1e-14);
    EXPECT_NEAR(run[first].angular_velocity(1.0)[2], 12.0, 1e-14);
}

TEST(Actions, a_hinge_and_a_slide_take_their_own_words) {
    const auto hinge = changed({.body = first, .angle = 2.0, .rate = -1.0}, stone, Revolute{.axis = {0, 1, 0}});
    EXPECT_EQ(hinge[first].angle(0.5), 2.0);
    EXPECT_EQ(hinge[first].rate(0.5), -1.0);
    const auto slide = changed({.body = first, .displacement = 2.0}, stone, Prismatic{.axis = {0, 0, 1}});
    EXPECT_EQ(slide[first].displacement(0.5), 2.0);
    EXPECT_NEAR(slide[first].rate(0.5), -4.9, 1e-12);
    EXPECT_THROW(changed({.body = first, .attitude = Attitude()}, stone, Revolute{.axis = {0, 1, 0}}), InvalidInput);
    EXPECT_THROW(changed({.body = first, .angle = 1.0}, stone, Free{}), InvalidInput);
}

TEST(WatchedBodies, angles_of_a_body_that_does_not_lean_are_its_turn) {
    Scene scene;
    const BodyHandle wheel = scene.add(stone, Revolute{.axis = {0, 0, 1}}, {.angle = 0.3, .rate = 0.5});
    const auto psi = scene.watch("psi", [=](const Now& now) { return now[wheel].euler_angles().psi; });
    const auto phi = scene.watch("phi", [=](const Now& now) { return now[wheel].euler_angles().phi + 1.0; });
    const BodyHandle slider = scene.add(stone, Prismatic{.axis = {1, 0, 0}});
    const auto still = scene.watch("still", [=](const Now& now) { return now[slider].euler_angles().psi + 1.0; });
    const auto run = simulate(scene, {.until = 1.0, .error = 1e-10});
    EXPECT_NEAR(run.watched(psi, 1.0), 0.8, 1e-10);
    EXPECT_EQ(run.watched(phi, 1.0), 1.0);
    EXPECT_EQ(run.watched(still, 1.0), 1.0);
}

TEST(WatchedBodies, what_a_joint_does_not_have_cannot_be_watched) {
    Scene scene;
    const BodyHandle free = scene.add(stone);
    EXPECT_THROW(scene.watch("angle", [=](const Now& now) { return now[free].angle(); }), InvalidInput);
    EXPECT_THROW(scene.watch("reaction", [=](const Now& now) { return now[free].reaction()[0]; }), InvalidInput);
    const BodyHandle bead = scene.add(rbdyn::Particle{1.0});
    EXPECT_THROW(scene.watch("turn", [=](const Now& now) { return now[bead].angular_velocity()[0]; }), InvalidInput);
}

}  // namespace

}  // namespace rbdyn::test::test_actions
