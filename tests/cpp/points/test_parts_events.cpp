// Events of a scene in parts: their order is that of one scene.
#include <gtest/gtest.h>

#include "support.hpp"

namespace rbdyn::test::test_parts_events {
namespace {

// events of one instant have an order of their own, in whichever parts of a scene they happen
TEST(PartsEvents, of_one_instant_are_in_the_order_of_one_scene) {
    Scene scene(down);
    const BodyHandle one = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}, {0, 0, 0}}),
                     other = scene.add(Particle{2.0}, FreeStart{{5, 0, 1}, {0, 0, 0}});
    scene.watch("b", [=](const Now& now) { return now[one].position()[2]; });
    scene.watch("a", [=](const Now& now) { return now[other].position()[2]; });
    const Trajectory run = simulate(scene, {.until = 1.0});
    ASSERT_EQ(run.events().size(), 2U);
    EXPECT_EQ(run.events()[0].time, run.events()[1].time);
    EXPECT_EQ(run.events()[0].name, "a");
}

}  // namespace
}  // namespace rbdyn::test::test_parts_events
