// What an estimate of the error contains: event times measured from the start, the worst of several parts.
#include <gtest/gtest.h>

#include "support.hpp"

namespace rbdyn::test::test_estimates {
namespace {

/// A ball in air that hardly reaches a level: when it does is known far worse than where it is.
Trajectory hardly_reached(double start) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {0.5, 0, 4}});
    scene.apply(Drag{.quadratic = 0.125}, ball);
    scene.watch("level", [=](const Now& now) { return now[ball].position()[2] - 0.741034; });
    return simulate(scene, {.until = start + 1.0, .start = start, .error = 1e-6, .engine = "dop853"});
}

// the motion does not know what the clock says
TEST(Estimates, of_event_times_are_measured_from_the_start) {
    const Trajectory early = hardly_reached(0.0), late = hardly_reached(0x1p20);
    ASSERT_EQ(early.events().size(), 2U);
    ASSERT_EQ(late.events().size(), 2U);
    EXPECT_GT(*early.error(), 1e-7);
    EXPECT_NEAR(*late.error() / *early.error(), 1.0, 0.5);
}

TEST(Estimates, of_several_parts_are_the_worst_of_theirs) {
    const auto swing = [](Scene& scene, double stiffness, double y) {
        const BodyHandle point = scene.add(Particle{1.0}, FreeStart{{1, y, 0}, {0, 1, 0}});
        scene.apply(Force([=](const auto& t, const auto& r, const auto&) {
                        using S = std::decay_t<decltype(t)>;
                        return Vector3Of<S>{-stiffness * r[0] * r[0] * r[0], -r[1], S(0.0)};
                    }),
                    point);
    };
    const SimulateOptions options{.until = 3.0, .error = 1e-8, .engine = "dop853"};
    Scene both, other_way, one, other;
    swing(both, 40.0, 0.0);
    swing(both, 1.0, 5.0);
    swing(other_way, 1.0, 5.0);
    swing(other_way, 40.0, 0.0);
    swing(one, 40.0, 0.0);
    swing(other, 1.0, 5.0);
    const double worst = *simulate(one, options).error(), best = *simulate(other, options).error();
    ASSERT_GT(worst, 1.5 * best);
    EXPECT_EQ(*simulate(both, options).error(), worst);
    EXPECT_EQ(*simulate(other_way, options).error(), worst);
}

}  // namespace
}  // namespace rbdyn::test::test_estimates
