// Friction in hinges and slides against closed forms: what is thrown, held, broken loose, driven and turned.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"

namespace rbdyn::test {
namespace joint_friction {

constexpr double g = 9.81;

RigidBody plate(double mass, double moment) {
    return {mass, Matrix3(Vector3(0.5 * moment, 0.5 * moment, moment).asDiagonal())};
}

TEST(JointFriction, a_block_thrown_up_a_slide_stops_and_stays_or_comes_back) {
    const double tilt = 0.4, v0 = 3.0, mu = 0.2, c = std::cos(tilt), s = std::sin(tilt);
    const double t1 = v0 / (g * (s + mu * c)), x1 = 0.5 * v0 * t1, end = 4.0;
    for (const double error : {1e-6, 1e-9, 1e-12})
        for (const double mu_static : {0.3, 0.5}) {
            Scene scene(Vector3{0, -g, 0});
            const auto block = scene.add(
                plate(2.0, 0.1), Prismatic{.axis = {c, s, 0}, .friction = Coulomb{mu_static, mu}}, {.rate = v0});
            const bool stays = mu_static > std::tan(tilt);
            const Trajectory run = simulate(scene, {.until = stays ? 1e5 : end, .error = error});
            ASSERT_EQ(run.events().size(), 1u);
            EXPECT_NEAR(run.events()[0].time, t1, 1e-13);
            EXPECT_EQ(run.events()[0].subject, block.index);
            EXPECT_NEAR(run[block].displacement(t1), x1, 1e-13);
            EXPECT_EQ(run.events()[0].kind, stays ? EventKind::stick : EventKind::reverse);
            if (stays) {
                // it does not creep, and what holds it is what pulls it
                EXPECT_EQ(run[block].displacement(1e5), run[block].displacement(1.0));
                EXPECT_EQ(run[block].rate(1e5), 0.0);
                EXPECT_LT((run[block].reaction(5.0) - Vector3(0, 2.0 * g, 0)).norm(), 1e-13);
            } else {
                const double after = end - t1;
                EXPECT_NEAR(run[block].displacement(end), x1 - 0.5 * g * (s - mu * c) * after * after, 1e-12);
                // the energy that is gone: friction times the way
                EXPECT_NEAR(run.energy(0.0) - run.energy(end),
                            mu * 2.0 * g * c * (2.0 * x1 - run[block].displacement(end)), 1e-11);
            }
        }
}

TEST(JointFriction, a_hinge_at_rest_breaks_loose_where_its_load_does) {
    const double m = 2.0, moment = 0.2, r = 0.05, k = 0.3, end = 3.0;
    for (const double mu_dynamic : {0.25, 0.4})
        for (const double error : {1e-6, 1e-12}) {
            Scene scene(Vector3{0, -g, 0});
            const auto wheel =
                scene.add(plate(m, moment), Revolute{.friction = Coulomb{0.4, mu_dynamic}, .pin_radius = r});
            scene.apply(JointTorque([=](auto t, auto, auto) { return k * t; }), wheel);
            const Trajectory run = simulate(scene, {.until = end, .error = error});
            ASSERT_EQ(run.events().size(), 1u);
            const double breaks = 0.4 * r * m * g / k;
            EXPECT_EQ(run.events()[0].kind, EventKind::slip);
            EXPECT_NEAR(run.events()[0].time, breaks, 1e-13);
            EXPECT_EQ(run[wheel].angle(breaks), 0.0);
            EXPECT_NEAR(run[wheel].reaction_torque(0.5 * breaks)[2], -0.5 * k * breaks, 1e-14);
            const double rate =
                (0.5 * k * (end * end - breaks * breaks) - mu_dynamic * r * m * g * (end - breaks)) / moment;
            EXPECT_NEAR(run[wheel].rate(end), rate, 1e-12);
            EXPECT_NEAR(run[wheel].reaction_torque(end)[2], -mu_dynamic * r * m * g, 1e-13);
        }
}

TEST(JointFriction, a_bead_on_a_rough_arm_that_turns) {
    // N = 2 m w r', so r'' + 2 mu w r' - w^2 r = 0 both ways
    const double w = 2.0, mu = 0.3, r0 = 0.5, v0 = -1.5, end = 2.0;
    const double root = std::sqrt(mu * mu + 1.0) * w, fast = -mu * w - root, slow = -mu * w + root;
    const double a = (v0 - fast * r0) / (slow - fast), b = r0 - a;
    for (const double error : {1e-6, 1e-9, 1e-12}) {
        Scene scene;
        const auto arm = scene.add(plate(1.0, 0.1), Revolute{.motion = TimeFunction([=](auto t) { return w * t; })});
        const auto bead = scene.add(plate(1.0, 0.1), Prismatic{.friction = Coulomb{mu}},
                                    {.displacement = r0, .rate = v0, .parent = arm});
        const Trajectory run = simulate(scene, {.until = end, .error = error});
        EXPECT_TRUE(run.events().empty());
        EXPECT_NEAR(run[bead].displacement(end), a * std::exp(slow * end) + b * std::exp(fast * end),
                    std::max(10.0 * error, 1e-13));
    }
}

TEST(JointFriction, a_spinning_hinge_that_nothing_presses_goes_on) {
    Scene scene;
    const auto wheel = scene.add(plate(1.0, 0.3), Revolute{.friction = Coulomb{0.5}, .pin_radius = 0.1}, {.rate = 2.0});
    const Trajectory run = simulate(scene, {.until = 100.0});
    EXPECT_NEAR(run[wheel].angle(100.0), 200.0, 1e-12);
    EXPECT_TRUE(run.events().empty());
}

TEST(JointFriction, two_slides_on_each_other_stop_one_by_one) {
    // the upper one rubs on the lower one, which is pressed by both
    const double m1 = 2.0, m2 = 1.0, mu1 = 0.1, mu2 = 0.3, v2 = 3.0;
    for (const double error : {1e-6, 1e-12}) {
        Scene scene(Vector3{0, 0, -g});
        const auto lower = scene.add(plate(m1, 0.1), Prismatic{.friction = Coulomb{0.12, mu1}});
        const auto upper =
            scene.add(plate(m2, 0.1), Prismatic{.friction = Coulomb{mu2}}, {.rate = v2, .parent = lower});
        const Trajectory run = simulate(scene, {.until = 5.0, .error = error});
        // mu2 m2 g is less than what holds the lower one: it never moves
        EXPECT_EQ(run[lower].displacement(5.0), 0.0);
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_NEAR(run.events()[0].time, v2 / (mu2 * g), 1e-13);
        EXPECT_NEAR(run[upper].displacement(5.0), 0.5 * v2 * v2 / (mu2 * g), 1e-13);
        EXPECT_NEAR(run[lower].reaction(0.1)[0], -mu2 * m2 * g, 1e-13);
    }
}

TEST(JointFriction, what_has_no_law_is_refused) {
    const auto hinge = [](Coulomb friction, double radius) {
        return refusal([&] { Scene().add(plate(1.0, 0.1), Revolute{.friction = friction, .pin_radius = radius}); });
    };
    EXPECT_NE(hinge(Coulomb{0.3}, 0.0).find("pin_radius"), std::string::npos);
    EXPECT_NE(hinge(Coulomb{0.3}, -0.1).find("pin_radius"), std::string::npos);
    EXPECT_NE(hinge(Coulomb{INFINITY}, 0.1).find("finite"), std::string::npos);
    EXPECT_NE(hinge(Coulomb{0.3, 0.3, 0.01}, 0.1).find("rolling"), std::string::npos);
    EXPECT_EQ(hinge(Coulomb{0.3}, 0.1), "accepted");
    const auto driven = refusal([] {
        Scene().add(plate(1.0, 0.1),
                    Prismatic{.motion = TimeFunction([](auto t) { return t; }), .friction = Coulomb{0.1}});
    });
    EXPECT_NE(driven.find("motion"), std::string::npos);
}

TEST(JointFriction, a_block_on_a_rough_slide_strikes_another_and_both_slide_on) {
    // in line with their slides an impact presses neither; the second is rough as well
    const double m1 = 2.0, m2 = 0.5, mu1 = 0.3, mu2 = 0.2, v = 3.0, apart = 0.5, e = 0.6;
    Scene scene(Vector3{0, -g, 0});
    const auto first =
        scene.add(plate(m1, 0.1), Prismatic{.axis = {1, 0, 0}, .friction = Coulomb{mu1}}, PrismaticStart{.rate = v});
    const auto second = scene.add(plate(m2, 0.1), Prismatic{.axis = {1, 0, 0}, .friction = Coulomb{mu2}},
                                  PrismaticStart{.displacement = apart});
    const auto touch = scene.contact(first.point({0, 0, 0}), second.plane(Plane{{-1, 0, 0}}), {.restitution = e});
    const Trajectory run = simulate(scene, {.until = 5.0, .error = 1e-12});
    // the first slows down by mu g, and what is left is shared by Newton's law
    const double meets = std::sqrt(v * v - 2.0 * mu1 * g * apart), t = (v - meets) / (mu1 * g);
    const double u1 = meets * (m1 - e * m2) / (m1 + m2), u2 = meets * m1 * (1.0 + e) / (m1 + m2);
    ASSERT_EQ(run.events().times("impact", touch).size(), 1u);
    EXPECT_NEAR(run.events().times("impact", touch)[0], t, 1e-13);
    EXPECT_NEAR(run[first].displacement(5.0), apart + u1 * u1 / (2.0 * mu1 * g), 1e-12);
    EXPECT_NEAR(run[second].displacement(5.0), apart + u2 * u2 / (2.0 * mu2 * g), 1e-12);
    EXPECT_EQ(run[first].rate(5.0), 0.0);
    EXPECT_EQ(run[second].rate(5.0), 0.0);
}

}  // namespace joint_friction
}  // namespace rbdyn::test
