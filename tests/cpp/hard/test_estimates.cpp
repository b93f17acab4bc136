// What an estimate of the error contains: event times measured from the start, the worst of several parts.
#include <gtest/gtest.h>

#include "rbdyn/trajectory/accuracy.hpp"
#include "rbdyn/trajectory/run_data.hpp"
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

// two runs share the doubles of a place, and with them what a force that waves a hundred million times a metre loses
TEST(Estimates, contain_what_the_doubles_of_a_place_make_of_a_reaction) {
    Scene scene;
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x), {.parameter = 2e-3, .speed = 1e-3});
    scene.apply(Force([](const auto& t, const auto& r, const auto&) {
                    using std::sin;
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{S(0.0), sin(1e8 * r[0]), S(0.0)};
                }),
                bead);
    const Trajectory run = simulate(scene, {.until = 0.01, .error = 1e-3, .engine = "taylor"});
    double worst = 0.0;
    for (int k = 1; k <= 100; ++k) {
        const double t = 1e-4 * k;
        const long double x = static_cast<long double>(2e-3) + static_cast<long double>(1e-3) * t;
        worst = std::max(worst, std::abs(static_cast<double>(run[bead].reaction(t)[1] + std::sin(1e8L * x))));
    }
    EXPECT_GT(worst, 1e-12);
    EXPECT_LT(worst, 3.0 * *run.error());
}

TEST(Estimates, say_nothing_beyond_the_end_of_a_judge_that_ends_early) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {0.5, 0, 4}});
    scene.apply(Drag{.quadratic = 0.125}, ball);
    const Trajectory run = simulate(scene, {.until = 2.0}), judge = simulate(scene, {.until = 1.0});
    AccuracyCheck check(*run.data()->model, 1e-9);
    const Comparison whole = check(run.data()->record, run.data()->record, {});
    EXPECT_TRUE(whole.same_events);
    EXPECT_EQ(whole.certain_until, 2.0);
    const Comparison early = check(run.data()->record, judge.data()->record, {});
    EXPECT_FALSE(early.same_events);
    EXPECT_EQ(early.certain_until, 1.0);
    EXPECT_EQ(early.error, std::numeric_limits<double>::infinity());
}

// what was wrong before is wrong after, however little is added
TEST(Estimates, of_what_goes_on_are_those_of_the_whole_motion) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {0.5, 0, 4}});
    scene.apply(Drag{.quadratic = 0.5}, ball);
    const Trajectory first = simulate(scene, {.until = 2.0, .error = 1e-5, .engine = "dop853"}),
                     on = simulate(first, {.until = 2.0 + 0x1p-30});
    ASSERT_GT(*first.error(), 1e-9);
    EXPECT_GE(*on.error(), *first.error());
}

}  // namespace
}  // namespace rbdyn::test::test_estimates
