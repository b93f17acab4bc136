// What every engine finds alike: events after events, whatever is kept of a run, also from an event on.
#include <gtest/gtest.h>

#include <random>

#include "rbdyn/integrate.hpp"
#include "support.hpp"

namespace rbdyn::test::test_every_engine {
namespace {

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

TEST(EveryEngine, finds_where_a_fall_ends_however_long_the_run_may_go_on) {
    // 1 m down and a micrometre, in a vacuum and under a drag that is felt after a hundred seconds
    for (const double drag : {0.0, 1e-2})
        for (const double height : {1.0, 1e-6})
            for (const std::string& engine : simulating::engines())
                for (const double until : {1.0, 1e3, 1e6, 1e9}) {
                    Scene scene(Vector3(0, 0, -9.81));
                    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, height}, {0, 0, 0}});
                    if (drag != 0.0) scene.apply(Drag{.linear = drag}, ball);
                    scene.watch("floor", [ball](const Now& now) { return now[ball].position()[2]; },
                                {.action = {WatchAction::Kind::stop}});
                    const Trajectory run = simulate(scene, {.until = until, .error = 1e-9, .engine = engine});
                    // h = g t^2 (1/2 - k t / 6 + (k t)^2 / 24 - ...)
                    double time = std::sqrt(2.0 * height / 9.81);
                    for (int pass = 0; pass < 20; ++pass) {
                        const double k = drag * time;
                        time = std::sqrt(height / 9.81 / (0.5 - k / 6.0 * (1.0 - k / 4.0 * (1.0 - k / 5.0))));
                    }
                    ASSERT_EQ(run.status(), Status::stopped_by_event) << engine << ' ' << until << ' ' << height;
                    EXPECT_NEAR(run.end(), time, 2e-9 * time) << engine << ' ' << until << ' ' << drag;
                }
}

/// A force along x with a power of what a choice keeps from being negative, and its potential.
struct EdgePower {
    const char* name;
    Force force;
    std::function<double(double)> potential;
};

std::vector<EdgePower> edge_powers() {
    const auto along = [](auto f) {
        return Force([f](const auto&, const auto& r, const auto&) {
            using S = std::decay_t<decltype(r[0])>;
            return Vector3Of<S>{f(r[0]), S(0.0), S(0.0)};
        });
    };
    const auto beyond = [](double x) { return std::max(-x, 0.0); };
    return {
        {"contact", along([](const auto& x) { return 1e3 * pow(max(-x, std::decay_t<decltype(x)>(0.0)), 1.5) - 9.81; }),
         [=](double x) { return 400.0 * std::pow(beyond(x), 2.5) + 9.81 * x; }},
        {"cube root", along([](const auto& x) { return -cbrt(x); }),
         [](double x) { return 0.75 * std::pow(std::abs(x), 4.0 / 3.0); }},
        {"absolute value", along([](const auto& x) { return -locked_sign(x) * pow(abs(x), 1.5); }),
         [](double x) { return 0.4 * std::pow(std::abs(x), 2.5); }},
        {"square root", along([](const auto& x) { return 2.0 * sqrt(max(-x, std::decay_t<decltype(x)>(0.0))) - 1.0; }),
         [=](double x) { return 4.0 / 3.0 * std::pow(beyond(x), 1.5) + x; }},
        {"case", along([](const auto& x) {
             using S = std::decay_t<decltype(x)>;
             return where(x < 0.3, pow(0.3 - x, 2.5), S(0.0)) - 1.0;
         }),
         [](double x) { return std::pow(std::max(0.3 - x, 0.0), 3.5) / 3.5 + x; }},
    };
}

TEST(EveryEngine, passes_the_edge_of_a_power_that_ends_there) {
    for (const EdgePower& law : edge_powers())
        for (const std::string& engine : simulating::engines()) {
            Scene scene(Vector3(0, 0, 0));
            const BodyHandle p = scene.add(Particle{1.0}, {.position = {1.0, 0.0, 0.0}});
            scene.apply(law.force, p);
            const Trajectory run = simulate(scene, {.until = 8.0, .error = 1e-8, .engine = engine});
            ASSERT_EQ(run.status(), Status::reached_end) << law.name << ' ' << engine;
            EXPECT_GE(run.events().size(), 2u) << law.name << ' ' << engine;
            const double energy = law.potential(1.0);
            double least = 1.0;
            for (double t = 0.0; t <= 8.0; t += 0.037) {
                const double x = run[p].position(t)[0], v = run[p].velocity(t)[0];
                EXPECT_NEAR(0.5 * v * v + law.potential(x), energy, 3e-7 * energy) << law.name << engine << t;
                least = std::min(least, x);
            }
            EXPECT_LT(least, -0.05) << law.name;
        }
}

TEST(EveryEngine, passes_the_anchor_of_a_spring_that_pushes_on_its_other_side_along_any_axis) {
    // 2 -> 1/2 + 3/2 cos 2t up to the anchor, and the same mirrored: back after 4 quarters
    const double quarter = 0.5 * std::acos(-1.0 / 3.0), late = 10.0 - 8.0 * quarter;
    const double expected = -(0.5 + 1.5 * std::cos(2.0 * (late - 2.0 * quarter)));
    ASSERT_GT(late, quarter);
    ASSERT_LT(late, 3.0 * quarter);
    const Vector3 spin(1.0, 2.0, 0.5);
    for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(1, 2, 3), Vector3(0.3, -0.7, 0.2), Vector3(1, 1, 0)})
        for (const std::string engine : {"taylor", "dop853"})
            for (const int kind : {0, 1, 2}) {
                const Vector3 along = axis.normalized();
                Scene scene(Vector3(0, 0, 0));
                const RigidBody body(1.0, {0.1, 0.2, 0.25});
                const BodyHandle b = kind == 0 ? scene.add(Particle{1.0}, FreeStart{.position = 2.0 * along})
                                     : kind == 1
                                         ? scene.add(body, Free{}, {.position = 2.0 * along})
                                         : scene.add(body, Free{}, {.position = 2.0 * along, .angular_velocity = spin});
                scene.connect(Spring{.stiffness = 4.0, .rest_length = 0.5}, b, Vector3(0, 0, 0));
                const Trajectory run = simulate(scene, {.until = 10.0, .error = 1e-8, .engine = engine});
                EXPECT_NEAR(run[b].position(10.0).dot(along), expected, 2e-8) << engine << kind << axis.transpose();
                EXPECT_EQ(run.events().size(), 5u) << engine << kind << axis.transpose();
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

TEST(Starts, at_a_zero_of_the_reaction_neither_repeat_it_nor_lose_the_next) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    int restarts = 0;
    for (int i = 0; i < 120; ++i) {
        const double radius = 0.3 + 1.7 * part(random), mu = 0.01 + 0.3 * part(random);
        const auto hoop = [&](double parameter, double speed) {
            Scene scene(down);
            scene.add(Particle{0.5}, Rail(vertical_circle(radius), Coulomb{2.0 * mu, mu}),
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

}  // namespace
}  // namespace rbdyn::test::test_every_engine
