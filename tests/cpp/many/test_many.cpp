// Many members: each is what simulate() makes of it, whatever the threads, the order and the fate of the others.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "many/same_run.hpp"
#include "random.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_many {
namespace {

using Number = Expression;
using Vector = Vector3Of<Expression>;

const Vector3 down(0.0, 0.0, -9.81);

/// A mass on a spring whose stiffness is a number of the user's, in a wind.
Scene oscillator(const Parameter& k) {
    Scene scene;
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 0, 0}}, "ball");
    scene.apply(Force([k](const Number&, const Vector& r, const Vector&) { return Vector(r * -Number(k)); }), ball);
    return scene;
}

/// A bead on a rough hoop that stops where it has gone round.
Scene rough_hoop() {
    Scene scene(down);
    const Circle hoop{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}};
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(hoop, Coulomb{0.3, 0.2}), RailStart{.speed = 3.0});
    scene.watch("round", WatchFunction([=](const Now& now) { return now[bead].parameter() - 6.0; }),
                {.action = {.kind = WatchAction::Kind::stop}});
    return scene;
}

std::vector<Variation> speeds(std::size_t count) {
    std::vector<Variation> members;
    for (std::size_t i = 0; i < count; ++i)
        members.push_back(
            {.starts = {{BodyHandle{0}, RailStart{.parameter = 0.0, .speed = 0.5 * static_cast<double>(i)}}}});
    return members;
}

TEST(Many, are_what_simulate_makes_of_each_on_any_number_of_threads) {
    const Scene scene = rough_hoop();
    const std::vector<Variation> members = speeds(24);
    for (const int threads : {1, 2, 5, 0}) {
        const std::vector<Member> many =
            simulate_many(scene, members, {.run = {.until = 2.0, .error = 1e-9}, .threads = threads});
        ASSERT_EQ(many.size(), members.size());
        for (std::size_t i = 0; i < many.size(); ++i) {
            SCOPED_TRACE(i);
            Scene own = scene;
            own.replace(BodyHandle{0}, members[i].starts[0].second);
            ASSERT_TRUE(many[i].is_good());
            expect_same_run(*many[i].attempt, attempt(unplanned(own), {.until = 2.0, .error = 1e-9}));
        }
    }
}

TEST(Many, numbers_of_one_member_are_not_those_of_another) {
    Parameter k(4.0, "k");
    const Scene scene = oscillator(k);
    std::vector<Variation> members;
    for (int i = 0; i < 64; ++i)
        members.push_back({.starts = {{scene.body("ball"), FreeStart{.position = {0.5 + 0.1 * i, 0, 0}}}},
                           .numbers = {{k, 1.0 + 0.25 * i}}});
    const std::vector<Member> many =
        simulate_many(scene, members, {.run = {.until = 3.0, .error = 1e-11}, .threads = 2});
    int planned = 0;
    for (int i = 0; i < 64; ++i) {
        const Trajectory& run = many[static_cast<std::size_t>(i)].run();
        const double omega = std::sqrt(1.0 + 0.25 * i);
        EXPECT_NEAR(run[BodyHandle{0}].position(3.0)[0], (0.5 + 0.1 * i) * std::cos(3.0 * omega), 1e-10);
        EXPECT_EQ(run[BodyHandle{0}].force(0.0)[0], -(1.0 + 0.25 * i) * (0.5 + 0.1 * i));
        planned += run.statistics().planned;
    }
    EXPECT_LE(planned, 2);  // each thread may have been the first
    EXPECT_EQ(k.value(), 4.0);
    EXPECT_EQ(std::get<FreeStart>(scene.start(BodyHandle{0})).position, Vector3(1, 0, 0));
}

TEST(Many, numbers_that_are_not_varied_are_the_same_in_all_members) {
    Parameter k(4.0, "k"), wind(1.0, "wind");
    Scene scene = oscillator(k);
    scene.apply(Force([wind](const Number&, const auto&, const auto&) { return Vector(0.0, Number(wind), 0.0); }),
                BodyHandle{0});
    std::vector<Variation> members(2000);
    for (std::size_t i = 0; i < members.size(); ++i) members[i].numbers = {{k, 1.0 + static_cast<double>(i)}};
    std::atomic<bool> done = false;
    std::thread other([&] {
        while (!done) wind.set(wind.value() + 1.0);
    });
    const std::vector<Member> many =
        simulate_many(scene, members, {.run = {.until = 1.0, .rtol = 1e-12, .engine = "taylor"}, .threads = 2});
    done = true;
    other.join();
    const auto wind_of = [](const Member& m) { return m.run()[BodyHandle{0}].force(0.0)[1]; };
    for (const Member& m : many) EXPECT_EQ(wind_of(m), wind_of(many[0]));
    EXPECT_GT(wind.value(), wind_of(many[0]));
}

TEST(Many, one_that_fails_does_not_stop_the_others) {
    // two bodies that meet if they start at rest
    Scene scene;
    const BodyHandle a = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 0, 0}}),
                     b = scene.add(Particle{1.0}, FreeStart{});
    scene.connect(Gravitation{1.0}, a, b);
    std::vector<Variation> members;
    for (const double speed : {1.0, 0.0, 1.2})
        members.push_back({.starts = {{a, FreeStart{{1, 0, 0}, {0, speed, 0}}}}});
    const std::vector<Member> many = simulate_many(scene, members, {.run = {.until = 2.0}, .threads = 2});
    EXPECT_TRUE(many[0].is_good());
    EXPECT_TRUE(many[2].is_good());
    ASSERT_TRUE(many[1].attempt);
    EXPECT_FALSE(many[1].is_good());
    EXPECT_EQ(many[1].attempt->run.status(), Status::not_finite);
    try {
        (void)many[1].run();
        FAIL();
    } catch (const IntegrationError& e) {
        // two masses 1 from rest at distance 1 meet after pi / 4
        EXPECT_NEAR(e.run.end(), 0.25 * M_PI, 1e-6);
    }
}

TEST(Many, one_that_is_refused_as_it_starts_does_not_stop_the_others) {
    Parameter k(4.0, "k");
    Scene scene;
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 0, 0}});
    scene.connect(Spring{.stiffness = k}, ball, Vector3(0, 0, 0));
    const std::vector<Member> many = simulate_many(
        scene, {{.numbers = {{k, 1.0}}}, {.numbers = {{k, -1.0}}}, {.numbers = {{k, 2.0}}}}, {.run = {.until = 1.0}});
    EXPECT_TRUE(many[0].is_good());
    EXPECT_FALSE(many[1].attempt);
    EXPECT_NE(refusal([&] { (void)many[1].run(); }).find("stiffness"), std::string::npos);
    EXPECT_NEAR(many[2].run()[ball].position(1.0)[0], std::cos(std::sqrt(2.0)), 1e-9);
}

TEST(Many, starts_and_numbers_that_break_a_rule_are_refused_before_anything_runs) {
    Parameter k(4.0, "k");
    const Scene scene = oscillator(k);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const auto refused = [&](const Variation& bad) {
        return refusal([&] { (void)simulate_many(scene, {{}, bad}, {.run = {.until = 1.0}}); });
    };
    EXPECT_EQ(refused({.starts = {{BodyHandle{0}, FreeStart{.position = {nan, 0, 0}}}}}),
              "simulate_many, member 1: ball: component 0 of position is nan; a position is finite; give it in m");
    EXPECT_EQ(refused({.numbers = {{k, nan}}}), "simulate_many, member 1: parameter: k is nan; it is finite");
    EXPECT_NE(refused({.starts = {{BodyHandle{3}, FreeStart{}}}}), "accepted");
    EXPECT_NE(refusal([&] { (void)simulate_many(scene, {{}}, {.run = {.until = -1.0}}); }), "accepted");
    EXPECT_NE(refusal([&] { (void)simulate_many(scene, {{}}, {.run = {.until = 1.0}, .threads = -1}); }), "accepted");
    EXPECT_TRUE(simulate_many(scene, {}, {.run = {.until = 1.0}}).empty());
}

TEST(Many, stop_when_they_are_told_to_and_keep_what_is_done) {
    const Scene scene = rough_hoop();
    for (const int threads : {1, 2}) {
        SCOPED_TRACE(threads);
        int asked = 0;
        double last = 0.0;
        const auto began = std::chrono::steady_clock::now();
        const std::vector<Member> many =
            simulate_many(scene, speeds(200000),
                          {.run = {.until = 2.0, .error = 1e-9}, .threads = threads, .monitor = [&](double fraction) {
                               last = fraction;
                               return ++asked < 3;
                           }});
        EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), 5.0);
        EXPECT_EQ(asked, 3);
        EXPECT_GT(last, 0.0);
        EXPECT_LT(last, 1.0);
        EXPECT_TRUE(many.front().is_good());
        EXPECT_FALSE(many.back().attempt);
        EXPECT_THROW((void)many.back().run(), Error);
    }
    EXPECT_THROW((void)simulate_many(scene, speeds(200000),
                                     {.run = {.until = 2.0},
                                      .threads = 2,
                                      .monitor = [](double) -> bool { throw std::runtime_error("enough"); }}),
                 std::runtime_error);
}

TEST(Many, one_long_run_among_them_is_stopped_too) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 1, 0}});
    scene.apply(Force([](const Number& t, const Vector& r, const Vector& v) {
                    return Vector(r * -dot<Number>(r, r) - v * 0.1 + Vector(cos(t), 0.0, 9.81));
                }),
                ball);
    for (const int threads : {1, 2}) {
        const auto began = std::chrono::steady_clock::now();
        const std::vector<Member> many =
            simulate_many(scene, std::vector<Variation>(2),
                          {.run = {.until = 1e9, .rtol = 1e-12, .keep = {.what = Keep::What::end}},
                           .threads = threads,
                           .monitor = [](double) { return false; }});
        EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), 1.0);
        ASSERT_TRUE(many[0].attempt);
        EXPECT_EQ(many[0].attempt->run.status(), Status::stopped_by_user);
    }
}

TEST(Many, may_have_scenes_of_their_own) {
    const std::vector<Member> many =
        simulate_many(4,
                      [](std::size_t i) {
                          if (i == 2) throw InvalidInput("not this one");
                          Scene scene(down);
                          scene.add(Particle{1.0}, FreeStart{{0, 0, static_cast<double>(i)}, {0, 0, 0}});
                          return scene;
                      },
                      {.run = {.until = 1.0}, .threads = 2});
    for (const std::size_t i : {0, 1, 3})
        EXPECT_NEAR(many[i].run()[BodyHandle{0}].position(1.0)[2], static_cast<double>(i) - 0.5 * 9.81, 1e-14);
    EXPECT_EQ(refusal([&] { (void)many[2].run(); }), "not this one");
}

TEST(BoundParameters, are_what_they_are_bound_to_in_one_thread_and_while_it_lasts) {
    Parameter a(1.0, "a"), b(2.0, "b");
    const BoundParameters::Values outer{{a, 3.0}, {b, 4.0}}, inner{{a, 5.0}};
    {
        const BoundParameters first(outer);
        EXPECT_EQ(a.value(), 3.0);
        {
            const BoundParameters second(inner);
            EXPECT_EQ(a.value(), 5.0);
            EXPECT_EQ(b.value(), 4.0);
            std::thread([&] { EXPECT_EQ(a.value(), 1.0); }).join();
        }
        EXPECT_EQ(a.value(), 3.0);
    }
    EXPECT_EQ(a.value(), 1.0);
}

}  // namespace
}  // namespace rbdyn::test::test_many
