// States of rest and small oscillations of bodies joined to bodies, against closed forms and against their motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "rbdyn/body/shapes.hpp"
#include "rbdyn/rbdyn.hpp"
#include "rbdyn/statics/equilibria.hpp"
#include "rbdyn/statics/normal_modes.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_tree_equilibria {
namespace {

constexpr double g = 9.81, pi = std::numbers::pi;
const Vector3 down{0, 0, -g}, y{0, 1, 0};

/// Two equal rods, hinged: omega^2 L/g = 3 -+ 6/sqrt(7).
struct DoublePendulum {
    double length = 0.7;
    Scene scene{down};
    BodyHandle upper, lower;

    DoublePendulum() {
        const RigidBody rod = shapes::rod(1.3, length, {0, 0, 1});
        const Vector3 top(0, 0, length / 2);
        upper = scene.add(rod, Revolute{.axis = y, .point = top}, {.angle = 0.3}, "upper");
        lower = scene.add(rod, Revolute{.axis = y, .at = -top, .point = top}, {.angle = -0.2, .parent = upper});
    }
};

TEST(TreeEquilibria, a_double_pendulum_hangs_and_has_its_two_modes) {
    const DoublePendulum p;
    const std::vector<Equilibrium> found = equilibria(p.scene);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(found[0].stable);
    for (const double angle : found[0].coordinates) EXPECT_NEAR(angle, 0.0, 1e-14);
    const NormalModes modes = normal_modes(p.scene, found[0]);
    const double slow = (3.0 - 6.0 / std::sqrt(7.0)) * g / p.length, fast = (3.0 + 6.0 / std::sqrt(7.0)) * g / p.length;
    ASSERT_EQ(modes.squares.size(), 2u);
    EXPECT_NEAR(modes.squares[0], slow, 1e-14 * slow);
    EXPECT_NEAR(modes.squares[1], fast, 1e-14 * fast);
    ASSERT_EQ(found[0].periods.size(), 2u);
    EXPECT_NEAR(found[0].periods[0], 2.0 * pi / std::sqrt(slow), 1e-14);
}

TEST(TreeEquilibria, all_four_of_a_double_pendulum_are_found_from_near_them) {
    const DoublePendulum p;
    const struct {
        std::vector<double> near, at;
        bool stable;
    } cases[] = {{{0.1, -0.1}, {0, 0}, true},
                 {{3.0, 0.1}, {pi, 0}, false},
                 {{3.0, 3.0}, {pi, pi}, false},
                 {{0.1, 3.0}, {0, pi}, false}};
    for (const auto& c : cases) {
        const std::vector<Equilibrium> found = equilibria(p.scene, c.near);
        ASSERT_EQ(found.size(), 1u);
        for (int k = 0; k < 2; ++k)
            EXPECT_NEAR(std::remainder(found[0].coordinates[static_cast<std::size_t>(k)], 2.0 * pi),
                        std::remainder(c.at[static_cast<std::size_t>(k)], 2.0 * pi), 1e-13);
        EXPECT_EQ(found[0].stable, c.stable);
        EXPECT_TRUE(found[0].decided);
    }
}

TEST(TreeEquilibria, rods_on_ball_joints_swing_in_two_planes_and_turn_freely) {
    Scene scene(down);
    const double length = 0.7;
    const RigidBody rod = shapes::rod(1.3, length, {0, 0, 1}) + shapes::sphere(0.01, 0.05);
    const Vector3 top(0, 0, length / 2);
    const BodyHandle upper =
        scene.add(rod, Spherical{.point = top}, {.attitude = EulerAngles{.theta = 0.3, .psi = 0.1, .phi = 0.2}});
    scene.add(rod, Spherical{.at = -top, .point = top}, {.parent = upper});
    const std::vector<Equilibrium> found = equilibria(scene);
    ASSERT_EQ(found.size(), 1u);
    const NormalModes modes = normal_modes(scene, found[0]);
    ASSERT_EQ(modes.squares.size(), 6u);
    EXPECT_EQ(modes.squares[0], 0.0);
    EXPECT_EQ(modes.squares[1], 0.0);
    for (const int k : {2, 4}) {
        EXPECT_GT(modes.squares[static_cast<std::size_t>(k)], 1.0);
        EXPECT_NEAR(modes.squares[static_cast<std::size_t>(k)], modes.squares[static_cast<std::size_t>(k + 1)], 1e-11);
    }
    EXPECT_EQ(found[0].axes.size(), 2u);
    EXPECT_TRUE(found[0].stable);
}

TEST(TreeEquilibria, a_parallelogram_is_a_pendulum) {
    // cranks of length a and mass m, a coupler of mass c: omega^2 = g (m + c) / (a (2/3 m + c))
    const double a = 0.5, m = 0.8, c = 2.0, width = 1.2;
    const RigidBody crank = shapes::rod(m, a, {0, 0, 1}), coupler = shapes::rod(c, width, {1, 0, 0});
    Scene scene(down);
    const Vector3 top(0, 0, a / 2);
    const BodyHandle left = scene.add(crank, Revolute{.axis = y, .point = top}, {.angle = 0.5}),
                     right = scene.add(crank, Revolute{.axis = y, .at = {width, 0, 0}, .point = top}, {.angle = 0.5}),
                     bar = scene.add(coupler, Revolute{.axis = y, .at = -top, .point = {-width / 2, 0, 0}},
                                     {.angle = -0.5, .parent = left});
    scene.constrain(Ball{}, bar.point({width / 2, 0, 0}), right.point(-top));
    const std::vector<Equilibrium> found = equilibria(scene);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(found[0].stable);
    for (const double angle : found[0].coordinates) EXPECT_NEAR(angle, 0.0, 1e-13);
    const NormalModes modes = normal_modes(scene, found[0]);
    const double square = g * (m + c) / (a * (2.0 / 3.0 * m + c));
    ASSERT_EQ(modes.squares.size(), 1u);
    EXPECT_NEAR(modes.squares[0], square, 1e-13 * square);
    ASSERT_EQ(modes.shapes.rows(), 3);
    EXPECT_NEAR(modes.shapes(0, 0), modes.shapes(1, 0), 1e-13);
    EXPECT_NEAR(modes.shapes(0, 0), -modes.shapes(2, 0), 1e-13);
}

TEST(TreeEquilibria, a_particle_on_a_rod_is_a_spherical_pendulum) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{2.0}, {.position = {0.36, 0.48, -0.8}});
    scene.constrain(Rod{1.0}, ball, Vector3(0, 0, 0));
    const std::vector<Equilibrium> found = equilibria(scene);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(found[0].stable);
    EXPECT_NEAR(found[0].coordinates[2], -1.0, 1e-14);
    const NormalModes modes = normal_modes(scene, found[0]);
    ASSERT_EQ(modes.squares.size(), 2u);
    for (const double square : modes.squares) EXPECT_NEAR(square, g, 1e-13 * g);
    EXPECT_EQ(modes.shapes.rows(), 3);
    EXPECT_EQ(modes.shapes.columns(), 2);
}

TEST(TreeEquilibria, a_mechanism_oscillates_as_its_modes_say) {
    // a slider crank held by a spring: amplitude e, so that the period is the mode's to some e^2
    const auto made = [](std::vector<double> at, double off) {
        Scene scene(Vector3(0, -g, 0));
        const Vector3 z(0, 0, 1);
        const BodyHandle crank = scene.add(shapes::rod(1.0, 0.4, {1, 0, 0}), Revolute{.axis = z, .point = {-0.2, 0, 0}},
                                           {.angle = at[0] + off});
        const BodyHandle rod =
            scene.add(shapes::rod(0.7, 1.1, {1, 0, 0}), Revolute{.axis = z, .at = {0.2, 0, 0}, .point = {-0.55, 0, 0}},
                      {.angle = at[1], .parent = crank});
        const BodyHandle slider =
            scene.add(shapes::box(0.5, {0.1, 0.1, 0.1}), Prismatic{.axis = {1, 0, 0}}, {.displacement = at[2]});
        scene.constrain(Ball{}, rod.point({0.55, 0, 0}), slider);
        scene.connect(Spring{.stiffness = 40.0, .rest_length = 0.3}, slider, Vector3(2.0, 0.2, 0));
        if (off != 0.0) scene.assemble({crank});
        scene.watch("back", [crank, at](const Now& now) { return now[crank].angle() - at[0]; },
                    {.direction = Direction::rising});
        return scene;
    };
    const std::vector<double> guess{0.6, -0.95, 1.3};
    Scene first = made(guess, 0.0);
    first.assemble();
    const std::vector<Equilibrium> found = equilibria(first);
    ASSERT_EQ(found.size(), 1u);
    ASSERT_TRUE(found[0].stable);
    const NormalModes modes = normal_modes(first, found[0]);
    ASSERT_EQ(modes.frequencies.size(), 1u);
    const double period = 2.0 * pi / modes.frequencies[0];
    EXPECT_NEAR(found[0].periods[0], period, 1e-12 * period);
    const Trajectory run = simulate(made(found[0].coordinates, 1e-4), {.until = 3.6 * period, .error = 1e-10});
    std::vector<double> times;
    for (const Event& e : run.events())
        if (e.name == "back") times.push_back(e.time);
    ASSERT_GE(times.size(), 3u);
    EXPECT_NEAR((times[2] - times[0]) / 2.0, period, 1e-7 * period);
}

TEST(TreeEquilibria, what_depends_on_time_or_touches_is_refused) {
    Scene driven(down);
    const BodyHandle arm = driven.add(shapes::rod(1.0, 1.0, {1, 0, 0}),
                                      Revolute{.axis = y, .motion = [](const auto& t) { return 0.3 * t; }});
    driven.add(shapes::rod(1.0, 1.0, {1, 0, 0}), Revolute{.axis = y}, {.parent = arm});
    EXPECT_NE(refusal([&] { equilibria(driven); }).find("driven"), std::string::npos);
    Scene touching(down);
    const BodyHandle ball = touching.add(Particle{1.0}, {.position = {0, 0, 1}});
    touching.contact(ball, Plane{.normal = {0, 0, 1}});
    EXPECT_NE(refusal([&] { equilibria(touching); }).find("contacts"), std::string::npos);
    DoublePendulum p;
    p.scene.apply(JointTorque([](const auto& t, const auto&, const auto&) { return 0.1 * t; }), p.lower);
    EXPECT_NE(refusal([&] { equilibria(p.scene); }).find("depends on time"), std::string::npos);
}

}  // namespace
}  // namespace rbdyn::test::test_tree_equilibria
