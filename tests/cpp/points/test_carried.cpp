// Beads that a moving surface carries: what they need to be held, and when it is too much.
#include <gtest/gtest.h>

#include "rbdyn/trajectory/run_data.hpp"
#include "support.hpp"

namespace rbdyn::test::test_carried {
namespace {

// held by mu N against m a + c v with v = a t: until t = (mu g / a - 1) m / c
TEST(Carried, beads_are_held_against_drag_too) {
    Scene scene(down);
    RailOptions belt;
    belt.drive = TimeFunction([](const auto& t) { return 1.0 * t; });
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5, 0.25}, belt), {.parameter = 0.0});
    scene.apply(Drag{.linear = 1.0}, bead);
    const Trajectory run = simulate(scene, {.until = 5.0, .error = 1e-10});
    ASSERT_FALSE(run.events().empty());
    EXPECT_EQ(run.events()[0].kind, EventKind::slip);
    EXPECT_NEAR(run.events()[0].time, 0.5 * gravity - 1.0, 1e-9);
    EXPECT_NEAR(run[bead].tangential_force(2.0), -2.0, 1e-12);
}

// a straight way whose parameter goes ever slower needs no force
TEST(Carried, beads_need_no_force_for_the_parameter_of_a_straight_way) {
    Scene scene(down);
    RailOptions belt;
    belt.drive = 1.0;
    const Polynomial way{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}, .domain = {0.0, 4.0}};
    const BodyHandle bead =
        scene.add(Particle{1.0}, Rail(way, Coulomb{1e-3, 1e-3}, belt), {.parameter = 0.25, .speed = 1.0});
    const Trajectory run = simulate(scene, {.until = 5.0, .error = 1e-10});
    EXPECT_TRUE(run.events().empty()) << kinds(run);
    EXPECT_NEAR(run[bead].position(5.0)[0], 0.28125 + 5.0, 1e-9);
}

TEST(Carried, beads_that_stick_have_the_speed_of_the_belt_to_the_last_digit) {
    for (const double radius : {0.3, 0.7, 1.1, 1.3, 0.9}) {
        Scene scene;
        RailOptions belt;
        belt.drive = 0.1;
        const BodyHandle bead =
            scene.add(Particle{1.0}, Rail(Parabola{.a = radius, .x = {1, 0, 0}, .y = {0, 0, 1}}, Coulomb{0.5}, belt),
                      {.parameter = 0.2, .speed = 0.1});
        const Trajectory run = simulate(scene, {.until = 5.0, .error = 1e-10});
        EXPECT_TRUE(run.events().empty());
        for (int k = 0; k <= 20; ++k) EXPECT_EQ(run[bead].speed(0.25 * k), 0.1) << radius << ' ' << k;
    }
}

TEST(Carried, beads_as_fast_as_their_belt_but_for_rounding_stick_to_it) {
    Scene scene(down);
    RailOptions belt;
    belt.drive = 0.3;
    const BodyHandle bead =
        scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5}, belt), {.parameter = 0.0, .speed = 0.1 + 0.2});
    const Trajectory run = simulate(scene, {.until = 5.0, .error = 1e-10});
    EXPECT_TRUE(run.events().empty());
    EXPECT_EQ(run[bead].tangential_force(0.0), 0.0);
    // from the start on
    EXPECT_EQ(run.data()->record.modes.size(), 1u);
    EXPECT_EQ(run[bead].speed(0.0), 0.3);
    EXPECT_EQ(run[bead].speed(5.0), 0.3);
}

TEST(Carried, beads_that_begin_a_few_roundings_faster_than_their_belt_tell_nothing) {
    for (const double units : {20.0, -20.0, 6.0}) {
        Scene scene(down);
        RailOptions belt;
        belt.drive = 0.3;
        const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5}, belt),
                                          {.parameter = 1.0, .speed = 0.3 * (1.0 + units * epsilon)});
        const Trajectory run = simulate(scene, {.until = 5.0, .error = 1e-10});
        EXPECT_TRUE(run.events().empty()) << kinds(run);
        EXPECT_EQ(run[bead].speed(5.0), 0.3);
    }
    // farther away it has a way to go
    Scene scene(down);
    RailOptions belt;
    belt.drive = 0.3;
    scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5}, belt), {.parameter = 1.0, .speed = 0.3 * (1.0 + 1e-9)});
    EXPECT_EQ(kinds(simulate(scene, {.until = 5.0, .error = 1e-10})), "stick");
}

}  // namespace
}  // namespace rbdyn::test::test_carried
