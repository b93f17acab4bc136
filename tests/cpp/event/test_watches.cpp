// Watched functions whose roots are known, where rounding or the length of a step might hide them or make them up.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "support.hpp"

namespace rbdyn::test::test_watches {
namespace {

using Function = std::function<Expression(const Expression&)>;

/// Times of what a watch says, and its directions as signs.
struct Passage {
    double time;
    int direction;
};
std::vector<Passage> passages(const Trajectory& run, const std::string& name = "watched") {
    std::vector<Passage> found;
    for (const Event& e : run.events())
        if (e.name == name) found.push_back({e.time, e.direction == Direction::rising ? 1 : -1});
    return found;
}

TEST(Watches, of_a_corner_begin_silently_within_the_rounding_of_the_time) {
    const std::vector<std::pair<const char*, Function>> corners{
        {"abs", [](const Expression& u) { return abs(u); }},
        {"choice", [](const Expression& u) { return where(u > 0.0, u, -u); }},
        {"maximum", [](const Expression& u) { return max(u, -u); }},
        {"minimum", [](const Expression& u) { return min(u, -u); }}};
    for (const auto& [name, corner] : corners)
        for (const std::string engine : {"auto", "taylor", "dop853", "cvode-adams"})
            for (const int units : {0, 1, 40, 130, 200, 450, -1, -200, -450})
                for (const double speed : {1.0, -1.0}) {
                    Scene scene(Vector3(0, 0, 0));
                    const BodyHandle p =
                        scene.add(Particle{1.0}, FreeStart{{1.0 + units * epsilon, 0, 0}, {speed, 0, 0}});
                    scene.watch("watched", [=, f = corner](const Now& now) { return f(now[p].position()[0] - 1.0); });
                    // a unit in the last place of the start is 512 of those
                    const Trajectory run =
                        simulate(scene, {.until = 1001.0, .start = 1000.0, .error = 1e-6, .engine = engine});
                    EXPECT_TRUE(passages(run).empty()) << name << ' ' << engine << ' ' << units << ' ' << speed;
                }
}

TEST(Watches, that_rounding_leaves_wide_are_apart_from_a_change_of_another_one) {
    // a power whose root is known to a hundredth from the terms of a long step, and a corner half as far again
    for (const std::string engine : {"auto", "taylor", "dop853"})
        for (const double until : {1.0, 1e3, 1e5})
            for (const int power : {3, 5, 7}) {
                Scene scene(Vector3(0, 0, -1e8));
                const BodyHandle p = scene.add(Particle{1.0}, FreeStart{{0, 0, 131.25}, {0, 0, 108052.4375}});
                scene.watch("corner", [=](const Now& now) { return abs(now[p].position()[2]); });
                scene.watch("watched",
                            [=](const Now& now) { return pow((now[p].position()[2] - 144.625) / 100.0, power); });
                const double root = std::sqrt(108052.4375 * 108052.4375 - 2.0 * 1e8 * (144.625 - 131.25));
                const Trajectory run = simulate(scene, {.until = until, .error = 1e-6, .engine = engine});
                const std::vector<Passage> found = passages(run);
                ASSERT_EQ(found.size(), 2u) << engine << ' ' << until << ' ' << power;
                EXPECT_NEAR(found[0].time, (108052.4375 - root) / 1e8, 1e-6 * found[0].time) << engine << until;
                EXPECT_NEAR(found[1].time, (108052.4375 + root) / 1e8, 1e-6 * found[1].time) << engine << until;
                EXPECT_EQ(found[0].direction, 1);
                EXPECT_EQ(found[1].direction, -1);
                EXPECT_TRUE(passages(run, "corner").empty()) << engine << ' ' << until << ' ' << power;
            }
}

TEST(Watches, of_a_product_whose_factors_hardly_reach_zero_are_found_on_long_steps) {
    // round a circle of radius 1 at unit speed: x = cos t, and two levels a little below its greatest value
    constexpr double high = 1.0 - 0x1p-28, low = 1.0 - 0x1p-26;
    const double first = std::acos(high), second = std::acos(low);
    for (const std::string engine : {"auto", "taylor", "dop853"})
        for (const double phase : {0.0, 1.0, 2.5, 4.0}) {
            Scene scene(Vector3(0, 0, 0));
            const BodyHandle bead =
                scene.add(Particle{1.0}, Rail(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}),
                          {.parameter = -phase - 1.0, .speed = 1.0});
            scene.watch("watched", [=](const Now& now) {
                const Expression x = now[bead].position()[0];
                return (x - high) * (x - low);
            });
            const Trajectory run = simulate(scene, {.until = phase + 10.0, .error = 1e-9, .engine = engine});
            std::vector<double> expected;
            for (const double top : {phase + 1.0, phase + 1.0 + 2.0 * std::numbers::pi})
                for (const double away : {-second, -first, first, second})
                    if (top + away < phase + 10.0) expected.push_back(top + away);
            const std::vector<Passage> found = passages(run);
            ASSERT_EQ(found.size(), expected.size()) << engine << ' ' << phase;
            for (std::size_t i = 0; i < found.size(); ++i) {
                EXPECT_NEAR(found[i].time, expected[i], 1e-8) << engine << ' ' << phase;
                EXPECT_EQ(found[i].direction, i % 2 == 0 ? -1 : 1) << engine << ' ' << phase;
            }
        }
}

TEST(Watches, of_a_corner_hardly_reached_pass_nothing_on_long_steps) {
    for (const std::string engine : {"auto", "taylor", "dop853"})
        for (const double level : {1.0 - 0x1p-28, 1.0 - 0x1p-34, 1.0 - 0x1p-40}) {
            Scene scene(Vector3(0, 0, 0));
            const BodyHandle bead =
                scene.add(Particle{1.0}, Rail(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}),
                          {.parameter = -1.0, .speed = 1.0});
            scene.watch("watched", [=](const Now& now) { return abs(now[bead].position()[0] - level); });
            const Trajectory run = simulate(scene, {.until = 200.0, .error = 1e-6, .engine = engine});
            EXPECT_TRUE(passages(run).empty()) << engine << ' ' << level;
        }
}

TEST(Watches, of_squares_pass_nothing_where_they_are_searched_by_values) {
    for (const std::string engine : {"taylor", "dop853"})
        for (const double level : {-0.9588623853412877, -0.3, 0.0, 0.71, 1.0 - 0x1p-20}) {
            Scene scene(Vector3(0, 0, 0));
            const BodyHandle bead =
                scene.add(Particle{1.0}, Rail(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}),
                          {.parameter = 0.0, .speed = 1.0});
            scene.watch("watched", [=](const Now& now) {
                const Expression u = now[bead].position()[0] - level;
                return u * u;
            });
            const Trajectory run = simulate(scene, {.until = 200.0, .error = 1e-9, .engine = engine});
            EXPECT_TRUE(passages(run).empty()) << engine << ' ' << level;
        }
}

TEST(Watches, of_powers_pass_in_one_direction_only_where_they_are_searched_by_values) {
    for (const std::string engine : {"auto", "taylor", "dop853"})
        for (const int power : {3, 5, 7})
            for (const double until : {2.5e-3, 2.6768222853561473e-3, 2.7e-3, 1.0, 1e6}) {
                Scene scene(Vector3(0, 0, -9.8125));
                const BodyHandle p = scene.add(Particle{1.0}, FreeStart{{-1.33936, 0, 0}, {-0.7515, 0, 0}});
                scene.watch("watched",
                            [=](const Now& now) { return pow(now[p].position()[0] + 1.3413808871017614, power); });
                const double root = (1.3413808871017614 - 1.33936) / 0.7515;
                const Trajectory run = simulate(scene, {.until = until, .error = 1e-6, .engine = engine});
                const std::vector<Passage> found = passages(run);
                ASSERT_LE(found.size(), 1u) << engine << ' ' << power << ' ' << until;
                if (until > root) {
                    ASSERT_EQ(found.size(), 1u) << engine << ' ' << power << ' ' << until;
                    EXPECT_NEAR(found[0].time, root, 1e-6 * root) << engine << ' ' << power << ' ' << until;
                }
                for (const Passage& x : found) EXPECT_EQ(x.direction, -1) << engine << ' ' << power << ' ' << until;
            }
}

TEST(Watches, begin_thousands_of_roundings_beside_a_corner_and_pass_it) {
    for (const std::string engine : {"taylor", "dop853"})
        for (const int units : {500, 4000, 20000})
            for (const double side : {1.0, -1.0}) {
                Scene scene;
                const BodyHandle p =
                    scene.add(Particle{1.0}, FreeStart{{1.0 + side * units * epsilon, 0, 0}, {-side, 0, 0}});
                scene.watch("watched", [=](const Now& now) {
                    const Expression u = now[p].position()[0] - 1.0;
                    return where(u > 0.0, u, 2.0 * u);
                });
                const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-9, .engine = engine});
                ASSERT_EQ(run.events().size(), 2u) << engine << units << side << kinds(run);
                for (const Event& e : run.events()) EXPECT_NEAR(e.time, units * epsilon, 4 * epsilon);
            }
}

TEST(Watches, of_polynomials_do_not_shorten_steps) {
    const auto steps = [](int power) {
        Scene scene(down);
        const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 4}});
        if (power > 0)
            scene.watch("level", [=](const Now& now) {
                return pow(now[ball].position()[2] + 0.3 * now[ball].position()[0] + 1.7, power) - 9.0;
            });
        return simulate(scene, {.until = 0.75, .rtol = 1e-12, .engine = "taylor"}).statistics().steps;
    };
    EXPECT_EQ(steps(0), 1);
    for (const int power : {2, 3, 4, 5, 6, 7, 8}) EXPECT_EQ(steps(power), 1) << power;
}

}  // namespace
}  // namespace rbdyn::test::test_watches
