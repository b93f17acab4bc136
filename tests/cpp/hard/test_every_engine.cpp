// What every engine finds alike: events after events, whatever is kept of a run, functions that are called back.
#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <random>

#include "support.hpp"

namespace rbdyn::test::test_every_engine {
namespace {

constexpr double pi = std::numbers::pi;

TEST(EveryEngine, says_each_time_that_a_speed_under_quadratic_drag_passes_zero) {
    // along a line through the anchor: a turning point every half period or so, the drag makes them no rarer
    for (const Vector3& start : {Vector3{1, 1, 0}, Vector3{1, 0.3, -0.7}, Vector3{0, 0, 1}})
        for (const std::string& engine : simulating::engines()) {
            Scene scene;
            const BodyHandle body = scene.add(Particle{1.0}, FreeStart{start, {0, 0, 0}});
            scene.connect(Spring{.stiffness = 4.0}, body, Vector3{0, 0, 0});
            scene.apply(Drag{.quadratic = 0.1}, body);
            const Trajectory run = simulate(scene, {.until = 10.0, .error = 1e-6, .engine = engine});
            ASSERT_EQ(run.events().size(), 6u) << engine << ' ' << run;
            for (const Event& e : run.events()) {
                EXPECT_EQ(e.kind, EventKind::switching);
                EXPECT_LE(run[body].velocity(e.time).norm(), 1e-5) << engine << ' ' << e;
            }
        }
}

TEST(ClosedForms, with_a_watch_are_as_exact_whatever_is_kept) {
    for (double until = 0.5; until < 20.0; until += 0.37) {
        Scene scene(down);
        const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}, {1, 0, 3}});
        scene.connect(Spring{.stiffness = 4.0}, ball, Vector3{0, 0, 0});
        scene.watch("top", [=](const Now& now) { return now[ball].velocity()[2]; });
        const Trajectory all = simulate(scene, {.until = until});
        ASSERT_EQ(all.engine(), "closed form");
        for (const Keep& keep : {Keep{.what = Keep::What::end, .times = {}},
                                 Keep{.what = Keep::What::times, .times = {0.1 * until, 0.5 * until}}}) {
            const Trajectory run = simulate(scene, {.until = until, .keep = keep});
            EXPECT_LE(*run.error(), 1e-13) << until;
            ASSERT_EQ(run.events().size(), all.events().size()) << until;
            for (std::size_t i = 0; i < run.events().size(); ++i)
                EXPECT_EQ(run.events()[i].time, all.events()[i].time) << until;
            EXPECT_EQ(run[ball].position(0.5 * until), all[ball].position(0.5 * until)) << until;
        }
    }
}

TEST(EveryEngine, leaves_a_loop_and_comes_back_to_it_as_the_others) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (int i = 0; i < 10; ++i) {
        const double radius = 0.3 + 1.7 * part(random),
                     speed = std::sqrt(gravity * radius * (2.2 + 2.6 * part(random)));
        std::string expected;
        std::vector<double> times;
        for (const std::string& engine : simulating::engines()) {
            Scene scene(down);
            scene.add(Particle{0.5}, Rail(vertical_circle(radius), std::nullopt, {.side = RailSide::plus}),
                      RailStart{.parameter = 0.0, .speed = speed});
            const Trajectory run = simulate(scene, {.until = 1.5, .error = 1e-7, .engine = engine});
            if (expected.empty()) {
                expected = kinds(run);
                for (const Event& e : run.events()) times.push_back(e.time);
                ASSERT_EQ(expected.substr(0, 6), "detach") << radius << ' ' << speed;
            }
            ASSERT_EQ(kinds(run), expected) << engine << ' ' << radius << ' ' << speed;
            for (std::size_t k = 0; k < times.size(); ++k)
                EXPECT_NEAR(run.events()[k].time, times[k], 2e-7 * times[k]) << engine << ' ' << radius << ' ' << speed;
        }
    }
}

TEST(EveryEngine, slides_on_past_the_centre_of_a_force_that_turns_round_there) {
    // of constant size towards the vertex: friction is never negative, each swing is shorter
    for (const std::string& engine : simulating::engines()) {
        Scene scene({0.0, 0.0, -9.81});
        const BodyHandle bead =
            scene.add(Particle{0.5}, Rail(Cycloid{.radius = 1.0, .x = {1, 0, 0}, .y = {0, 0, 1}}, Coulomb(0.4, 0.1)),
                      RailStart{.parameter = 1.0, .speed = 0.0});
        scene.apply(Force([](const auto&, const auto& p, const auto&) {
                        using S = std::decay_t<decltype(p[0])>;
                        const S size = length(p, "distance");
                        return Vector3Of<S>{-p[0] / size, -p[1] / size, -p[2] / size};
                    }),
                    bead);
        const Trajectory run = simulate(scene, {.until = 2.0, .rtol = 1e-8, .engine = engine});
        // a reference of order 20: the way back is the shorter one
        const auto turns = run.events().times("reverse");
        ASSERT_EQ(turns.size(), 1u) << engine << ' ' << kinds(run);
        EXPECT_NEAR(turns[0], 1.57364668, 1e-6) << engine;
    }
}

TEST(Starts, at_a_zero_of_the_reaction_neither_repeat_it_nor_lose_the_next) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    int restarts = 0;
    for (int i = 0; i < 120; ++i) {
        const double radius = 0.3 + 1.7 * part(random), mu = 0.01 + 0.3 * part(random);
        const auto hoop = [&](double parameter, double speed) {
            Scene scene(down);
            scene.add(Particle{0.5}, Rail(vertical_circle(radius), Coulomb(2.0 * mu, mu)),
                      RailStart{.parameter = parameter, .speed = speed});
            return scene;
        };
        const Trajectory run =
            simulate(hoop(0.0, (1.0 + 2.5 * part(random)) * std::sqrt(gravity * radius)), {.until = 2.0});
        const std::vector<double> times = run.events().times("normal-zero");
        for (std::size_t k = 0; k < times.size(); ++k, ++restarts) {
            const auto bead = run[BodyHandle{0}];
            const Trajectory rest =
                simulate(hoop(bead.parameter(times[k]), bead.speed(times[k])), {.until = 2.0, .start = times[k]});
            const std::vector<double> later = rest.events().times("normal-zero");
            ASSERT_EQ(later.size(), times.size() - k - 1) << i << ' ' << times[k] << ' ' << kinds(rest);
            for (std::size_t j = 0; j < later.size(); ++j) EXPECT_NEAR(later[j], times[k + 1 + j], 1e-8);
        }
    }
    EXPECT_GT(restarts, 100);
}

TEST(Starts, at_the_top_of_a_hoop_against_friction_of_ones_own_begin_silently) {
    // there the velocity is level, but the doubles next to pi are not pi
    std::mt19937 random(2);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (int i = 0; i < 60; ++i) {
        const double size = 0.1 + 2.0 * part(random), stiffness = 6.0 * part(random) - 3.0;
        const RailSide side = i % 3 == 0 ? RailSide::plus : i % 3 == 1 ? RailSide::minus : RailSide::both;
        Scene scene(i % 2 == 0 ? down : Vector3{0, 0, 0});
        const BodyHandle bead = scene.add(
            Particle{0.5},
            Rail(vertical_circle(0.3 + 1.7 * part(random)), Coulomb(0.05 + 0.4 * part(random)), {.side = side}),
            RailStart{.parameter = i % 5 == 0 ? 0.0 : pi, .speed = 6.0 * part(random) - 3.0});
        scene.apply(Potential([=](const auto& p) { return -0.5 * stiffness * p[2] * p[2]; }), bead);
        scene.apply(Force([=](const auto&, const auto&, const auto& v) {
                        using S = std::decay_t<decltype(v[0])>;
                        const auto sign = [](const S& x) { return where(x > S(0.0), S(1.0), S(-1.0)); };
                        return Vector3Of<S>{-size * sign(v[0]), S(0.0), -size * sign(v[2])};
                    }),
                    bead);
        const Attempt run = attempt(scene, {.until = 0.5, .error = 1e-8});
        for (const Event& e : run.run.events()) EXPECT_GT(e.time, 1e-9) << i << ' ' << e;
    }
}

TEST(Dop853, asks_a_function_that_is_called_back_in_proportion_to_its_steps) {
    // values with errors of their own, as those near a cancellation have: guards are no polynomials of them
    const auto counter = std::make_shared<Callback>();
    counter->inputs = 7;
    counter->outputs = 3;
    counter->function = [](const double* x, double* y) {
        const double size = std::sqrt(x[1] * x[1] + x[2] * x[2] + x[3] * x[3]) + 1e-300;
        for (int k = 0; k < 3; ++k) y[k] = -x[k + 1] / size * (1.0 + 1e-11 * std::sin(1e13 * x[1]));
    };
    Scene scene;
    const BodyHandle bead =
        scene.add(Particle{0.5}, Rail(Cycloid{.radius = 0.9, .x = {1, 0, 0}, .y = {0, 0, 1}}, Coulomb(0.6, 0.5)),
                  RailStart{.parameter = 1.75, .speed = 0.0});
    scene.apply(Force(std::shared_ptr<const Callback>(counter)), bead);
    const Trajectory run = simulate(scene, {.until = 3.0, .rtol = 1e-12, .engine = "dop853"});
    // sixteen right-hand sides a step, and fits of its guards through seventeen values
    EXPECT_LE(counter->calls.load(), 200 * (run.statistics().steps + run.statistics().rejected + 10)) << run;
    // and never more than a step of max_steps has
    const std::int64_t before = counter->calls.load();
    const Trajectory few = simulate(scene, {.until = 3.0, .rtol = 1e-12, .engine = "dop853", .max_steps = 20});
    EXPECT_EQ(few.status(), Status::step_limit);
    EXPECT_LE(counter->calls.load() - before, 200 * 40);
}

}  // namespace
}  // namespace rbdyn::test::test_every_engine
