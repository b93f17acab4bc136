// Runs that go on from others: what happens where one ends and the next begins is told once.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support.hpp"

namespace rbdyn::test::test_going_on {
namespace {

// computed anew for a smaller error, or gone on from where it ended
TEST(GoingOn, tells_an_event_at_the_end_of_the_run_before_once) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {0.5, 0, 4}});
    scene.apply(Drag{.quadratic = 0.125}, ball);
    scene.watch("level", [=](const Now& now) { return now[ball].position()[2] - 0.5; });
    const double first = simulate(scene, {.until = 1.0}).events()[0].time;
    for (const double until :
         {first, std::nextafter(first, 2.0), first + 1e-12, std::nextafter(first, 0.0), first - 1e-12}) {
        const Trajectory run = simulate(scene, {.until = until, .error = 1e-8}),
                         on = simulate(run, {.until = 0.5, .error = 1e-10}),
                         same = simulate(run, {.until = 0.5, .error = 1e-8});
        EXPECT_EQ(run.events().size() + on.events().size(), 1u) << until - first;
        EXPECT_EQ(run.events().size() + same.events().size(), 1u) << until - first;
    }
}

// a line in time: rounding leaves its zero before or after the end of the first run
TEST(GoingOn, tells_a_passage_beside_the_end_of_the_run_before_once) {
    for (const std::string engine : {"taylor", "dop853"})
        for (const double v : {1.0, 0.7, 3.0, 0.3})
            for (int units = -6; units <= 6; ++units) {
                Scene scene;
                const BodyHandle p = scene.add(Particle{1.0}, FreeStart{{-1.0, 0, 0}, {v, 0, 0}});
                scene.watch("zero", [=](const Now& now) { return now[p].position()[0]; });
                double until = 1.0 / v;
                for (int k = 0; k < std::abs(units); ++k) until = std::nextafter(until, units > 0 ? 10.0 : 0.0);
                const Trajectory run = simulate(scene, {.until = until, .error = 1e-9, .engine = engine}),
                                 on = simulate(run, {.until = 5.0});
                EXPECT_EQ(run.events().size() + on.events().size(), 1u) << engine << v << units;
                for (const Event& e : run.events()) EXPECT_EQ(e.direction, Direction::rising);
                for (const Event& e : on.events()) EXPECT_EQ(e.direction, Direction::rising);
            }
}

}  // namespace
}  // namespace rbdyn::test::test_going_on
