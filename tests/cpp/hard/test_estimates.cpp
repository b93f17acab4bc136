// What an estimate of the error contains: event times measured from the start, the worst of several parts.
#include <gtest/gtest.h>

#include "rbdyn/body/shapes.hpp"
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

// far from the origin a place is known to the last of its doubles, of which neither of two runs knows more
TEST(Estimates, contain_what_doubles_of_places_far_away_are_off) {
    Scene scene;
    constexpr double far = 1e9;
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(Line{.direction = {1, 0, 0}, .point = {far, 0, 0}}),
                                      {.parameter = 0.0, .speed = 0.3});
    scene.apply(Drag{.quadratic = 0.5}, bead);
    const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-5, .engine = "taylor"});
    double worst = 0.0;
    for (int k = 1; k <= 200; ++k) {
        // u' = u0' / (1 + c u0' t / m)
        const long double t = 0.01L * k, u = 2.0L * std::log1p(0.5L * static_cast<long double>(0.3) * t);
        worst = std::max(worst, std::abs(static_cast<double>(run[bead].position(static_cast<double>(t))[0] - far - u)));
    }
    const double way = 2.0 * std::log1p(0.3);
    EXPECT_GT(worst, 0.25 * epsilon * far);
    EXPECT_LT(worst / way, *run.error());
}

/// A record with the times of two events, which are next to each other, exchanged.
Record exchanged(Record record, std::size_t i) {
    Event &a = record.events[i], &b = record.events[i + 1];
    std::swap(a.time, b.time);
    std::swap(a.instant, b.instant);
    std::swap(a, b);
    return record;
}

TEST(Estimates, take_events_nearer_than_the_error_for_the_same_in_either_order) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {0.5, 0, 4}});
    scene.apply(Drag{.quadratic = 0.125}, ball);
    for (const auto& [name, more] : {std::pair("a", 1e-11), {"b", 0.0}, {"c", 0.125}})
        scene.watch(name, [=, m = more](const Now& now) { return now[ball].position()[2] - 0.5 - m; },
                    {.direction = Direction::rising});
    const Trajectory run = simulate(scene, {.until = 1.0});
    const Record& record = run.data()->record;
    ASSERT_EQ(record.events.size(), 3u);
    ASSERT_EQ(record.events[0].name, "b");
    AccuracyCheck check(*run.data()->model, 1e-9);
    const Comparison swapped = check(record, exchanged(record, 0), {});
    EXPECT_TRUE(swapped.same_events);
    EXPECT_LT(swapped.error, 1e-9);
    EXPECT_GT(swapped.event_difference, 1e-12);
    // what the error tells apart is another motion
    const Comparison other = check(record, exchanged(record, 1), {});
    EXPECT_FALSE(other.same_events);
    EXPECT_NEAR(other.certain_until, record.events[1].time, 1e-10);
}

// across a slope to rest the slip turns ever faster, like a root of the time that is left: of its force two runs differ
// by more than of anything else, and it is known as well as the time of that
TEST(Estimates, are_not_those_of_forces_that_turn_with_a_slip_just_before_it_rests) {
    // a foot on two slides across each other, whose joints bear what friction does
    const auto thrown = [](double speed) {
        Scene scene(Vector3{6.0, 0, -8.0});
        const RigidBody slide = shapes::sphere(0.125, 0.125);
        const BodyHandle along = scene.add(slide, Prismatic{.axis = {1, 0, 0}}, PrismaticStart{}),
                         across = scene.add(slide, Prismatic{.axis = {0, 1, 0}},
                                            PrismaticStart{.rate = speed, .parent = along}),
                         foot = scene.add(shapes::sphere(4.0, 0.125), Prismatic{.axis = {0, 0, 1}},
                                          PrismaticStart{.parent = across});
        // without the slides the direction goes with the power 1 / (mu cot(alpha) - 1) of the time that is left: 1/2
        scene.contact(foot.point({0, 0, 0}), Plane{{0, 0, 1}}, {.friction = Coulomb{2.25}});
        return simulate(scene, {.until = 1.0, .rtol = 1e-14});
    };
    constexpr double late = 1e-11, wanted = 1e-8;
    const Trajectory run = thrown(2.0), judge = thrown(2.0 * (1.0 + late));
    ASSERT_EQ(kinds(run), "stick rest");
    AccuracyCheck check(*run.data()->model, wanted);
    // their equations are the same; those of the other scene stand elsewhere
    Record better = judge.data()->record;
    better.modes = run.data()->record.modes;
    const Comparison found = check(run.data()->record, better, {});
    EXPECT_TRUE(found.same_events);
    EXPECT_GT(found.error, late);
    // at a part `wanted` of the time before the end; later it is sqrt(late)
    EXPECT_LT(found.error, late / std::sqrt(wanted));
}

TEST(Estimates, of_few_pieces_look_within_them_too) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {0.5, 0, 4}});
    scene.apply(Drag{.linear = 1e-3}, ball);
    const Trajectory run = simulate(scene, {.until = 1.0, .engine = "taylor"});
    const Record& record = run.data()->record;
    ASSERT_LT(record.entries().size(), 8u);
    const std::vector<double> places = AccuracyCheck::places(record);
    ASSERT_GE(places.size(), 15u);
    double before = 0.0;
    for (const double t : places) {
        EXPECT_LE(t - before, 0.25);
        before = t;
    }
    EXPECT_EQ(places.back(), 1.0);
    // between steps that are interpolated, also of many
    const Trajectory interpolated = simulate(scene, {.until = 40.0, .engine = "dop853"});
    const std::vector<double> between = AccuracyCheck::places(interpolated.data()->record);
    std::size_t ends = 0;
    for (const double t : between)
        for (const double end : interpolated.t())
            if (t == end) ++ends;
    EXPECT_GE(2 * (between.size() - ends), between.size());
}

// up to where the last digits of its start have grown to what was asked for, and no further
TEST(Estimates, of_a_closed_form_that_loses_its_digits_say_until_when_it_is_certain) {
    Scene scene(Vector3(0, 0, -1));
    // with just the speed that reaches the top, sin(psi / 2) = tanh(t)
    const BodyHandle body = scene.add(RigidBody(1.0, {0.25, 0.25, 0.25}, {.com = {0.0, 0.0, -0.5}}),
                                      Revolute{.axis = {0, 1, 0}}, RevoluteStart{.rate = 2.0});
    try {
        (void)simulate(scene, {.until = 200.0, .error = 1e-9});
        FAIL() << "whether it falls is for digits to say that nobody knows";
    } catch (const AccuracyError& e) {
        EXPECT_EQ(e.run.engine(), "closed form");
        const double until = e.run.certain_until();
        // what is off by 1e-30 to 1e-36 grows as e^t
        EXPECT_GT(until, std::log(1e-9 / 1e-30));
        EXPECT_LT(until, std::log(1e-9 / 1e-36));
        EXPECT_NEAR(std::sin(0.5 * e.run[body].angle(until)), std::tanh(until), 1e-9);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_estimates
