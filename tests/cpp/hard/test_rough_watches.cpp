// Watched functions that are not finite, or have infinite slope, where a step begins; poles; ends.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "rbdyn/integrate.hpp"
#include "support.hpp"

namespace rbdyn::test::test_rough_watches {
namespace {

constexpr double pi = std::numbers::pi, nan = std::numeric_limits<double>::quiet_NaN();

/// A particle along x from 0 with a unit speed; with linear drag it is steps that carry it, x = 1 - exp(-t).
struct Path {
    Scene scene;
    BodyHandle body;
    bool is_slowed;
    explicit Path(bool slowed) : body(scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 0}})), is_slowed(slowed) {
        if (slowed) scene.apply(Drag{.linear = 1.0}, body);
    }
    double time(double x) const { return is_slowed ? -std::log1p(-x) : x; }
};

struct Case {
    std::string name;
    std::function<Expression(Expression)> recorded;
    std::function<double(double)> called_back;
    std::vector<double> roots;
    double end = nan;  // of its numbers
};

template <class F>
Case of(const std::string& name, F f, std::vector<double> roots, double end = nan) {
    return {name, [=](Expression x) { return f(x); }, [=](double x) { return f(x); }, std::move(roots), end};
}

double root(double x) { return std::sqrt(x); }
double logarithm(double x) { return std::log(x); }
double tangent(double x) { return std::tan(x); }
Expression root(const Expression& x) { return sqrt(x); }
Expression logarithm(const Expression& x) { return log(x); }
Expression tangent(const Expression& x) { return sin(x) / cos(x); }

std::vector<Case> cases() {
    return {
        of("x^1.5", [](const auto& x) { return x * root(x) - 0.125; }, {0.25}),
        of("sqrt", [](const auto& x) { return root(x) - 0.5; }, {0.25}),
        of("log", [](const auto& x) { return logarithm(x) + 1.0; }, {std::exp(-1.0)}),
        of("1/x", [](const auto& x) { return 1.0 / x - 4.0; }, {0.25}),
        of("pole", [](const auto& x) { return 1.0 / (x - 0.3); }, {}),
        of("pole and root", [](const auto& x) { return 1.0 / (x - 0.3) + 50.0; }, {0.28}),
        of("tan", [](const auto& x) { return tangent(10.0 * x); }, {pi / 10.0, 2.0 * pi / 10.0}),
        of(
            "log to its end", [](const auto& x) { return logarithm(0.5 - x) + 2.0; }, {0.5 - std::exp(-2.0)}, 0.5),
        of(
            "log to its end, no root that doubles tell", [](const auto& x) { return logarithm(0.5 - x) + 100.0; }, {},
            0.5),
        of(
            "sqrt to its end", [](const auto& x) { return root(0.5 - x) - 0.5; }, {0.25}, 0.5),
        of(
            "never a number", [](const auto& x) { return root(x - 2.0); }, {}, 0.0),
    };
}

TEST(RoughWatches, find_roots_and_no_poles_and_say_where_they_end) {
    std::vector<std::string> engines = simulating::engines();
    engines.push_back("auto");
    for (const Case& c : cases())
        for (const std::string& engine : engines)
            for (const bool is_slowed : {false, true})
                for (const bool is_called : {false, true}) {
                    Path path(is_slowed);
                    const BodyHandle body = path.body;
                    if (is_called)
                        path.scene.watch("w", WatchFunction::called_back(
                                                  [=](const Observe& now) {
                                                      return c.called_back(now({Quantity::position, body.index, 0}));
                                                  },
                                                  "for the test"));
                    else
                        path.scene.watch("w", [=](const Now& now) { return c.recorded(now[body].position()[0]); });
                    const std::string what = c.name + ", " + engine + (is_slowed ? ", slowed" : "") +
                                             (is_called ? ", called back" : ", recorded");
                    const Attempt run =
                        attempt(path.scene, {.until = path.time(0.75), .error = 1e-8, .engine = engine});
                    if (std::isnan(c.end)) {
                        EXPECT_EQ(run.outcome, simulating::Outcome::good) << what << ": " << run.message;
                    } else {
                        EXPECT_EQ(run.outcome, simulating::Outcome::broken) << what;
                        EXPECT_NE(run.message.find("watched function \"w\""), std::string::npos)
                            << what << ": " << run.message;
                        // where doubles of the place tell it, to the error asked for
                        EXPECT_NEAR(run.run.end(), path.time(c.end), 1e-7) << what;
                    }
                    const auto found = run.run.events().times("w");
                    EXPECT_EQ(found.size(), c.roots.size()) << what;
                    for (std::size_t i = 0; i < std::min(found.size(), c.roots.size()); ++i)
                        EXPECT_NEAR(found[i], path.time(c.roots[i]), 1e-7) << what;
                }
}

TEST(RoughWatches, that_stop_being_numbers_while_nothing_moves_say_so_too) {
    Scene scene(down);
    scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.3}), RailStart{.parameter = 0.0, .speed = 0.0});
    scene.watch("w", WatchFunction::called_back(
                         [](const Observe& now) { return now({Quantity::time}) > 0.5 ? nan : 1.0; }, "for the test"));
    const Attempt run = attempt(scene, {.until = 2.0});
    EXPECT_EQ(run.outcome, simulating::Outcome::broken);
    EXPECT_NEAR(run.run.end(), 0.5, 1e-15);
    EXPECT_NE(run.message.find("watched function \"w\""), std::string::npos) << run.message;
}

// --- corners, touches, and what comes after the end ---

Scene swinging_unit(BodyHandle& body) {
    Scene scene(Vector3(0, 0, 0));
    body = scene.add(Particle{1.0}, FreeStart{.velocity = Vector3(1, 0, 0)});
    scene.connect(Spring{.stiffness = 1.0}, body, Vector3(0, 0, 0));
    return scene;
}

TEST(Corners, that_touch_zero_pass_nothing_and_stop_nothing) {
    for (const std::string& engine : simulating::engines())
        for (const auto kind : {WatchAction::Kind::record, WatchAction::Kind::stop})
            for (double c = -0.97; c < 0.97; c += engine == "cvode-bdf" ? 0.3 : 0.0387) {
                BodyHandle b;
                Scene scene = swinging_unit(b);
                scene.watch("w", [=](const auto& now) { return abs(now[b].position()[0] - c); },
                            {.action = WatchAction{kind}});
                const Trajectory run = simulate(scene, {.until = 60.0, .error = 1e-7, .engine = engine});
                EXPECT_EQ(run.status(), Status::reached_end) << engine << c;
                for (const Event& e : run.events()) EXPECT_EQ(e.kind, EventKind::switching) << engine << c << e;
            }
}

TEST(Corners, where_the_run_ends_or_begins_are_none) {
    for (const std::string& engine : simulating::engines()) {
        BodyHandle b;
        Scene ends = swinging_unit(b);
        ends.watch("w", [=](const auto& now) { return abs(now[b].position()[0] - std::sin(0.5)); });
        for (const Event& e : simulate(ends, {.until = 0.5, .error = 1e-8, .engine = engine}).events())
            EXPECT_EQ(e.kind, EventKind::switching) << engine << e;
        // CVODE does not know its own switch from such a start
        for (const double units : {4.0, 16.0, 30.0, 64.0, 128.0, 256.0}) {
            if (engine.starts_with("cvode")) continue;
            Scene begins(Vector3(-1, 0, 0));
            const BodyHandle p =
                begins.add(Particle{1.0}, FreeStart{.position = Vector3(1, 0, 0), .velocity = Vector3(1, 0, 0)});
            begins.watch("w", [=](const auto& now) { return abs(now[p].position()[0] - (1.0 + units * epsilon)); });
            for (const Event& e : simulate(begins, {.until = 3.0, .error = 1e-8, .engine = engine}).events())
                EXPECT_EQ(e.kind, EventKind::switching) << engine << units << e;
        }
    }
}

TEST(Touches, do_not_stop_a_run) {
    for (double c = -0.97; c < 0.97; c += 0.0129) {
        Scene scene(Vector3(0, 0, 0));
        const BodyHandle b = scene.add(
            Particle{1.0}, Rail(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}), {.speed = 1.0});
        scene.watch("w",
                    [=](const auto& now) {
                        const auto y = now[b].position()[1] - c;
                        return y * y;
                    },
                    {.action = WatchAction{WatchAction::Kind::stop}});
        EXPECT_EQ(simulate(scene, {.until = 100.0, .error = 1e-9, .engine = "taylor"}).status(), Status::reached_end)
            << c;
    }
}

TEST(Stops, note_nothing_that_comes_after_them_however_vague_their_own_time_is) {
    Scene scene(Vector3(0, 0, 0));
    const BodyHandle b = scene.add(Particle{1.0}, Rail(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}),
                                   {.parameter = 0.1, .speed = 1.0});
    scene.watch("seven", [=](const auto& now) { return pow(now[b].position()[1], 7); },
                {.direction = Direction::rising, .action = WatchAction{WatchAction::Kind::stop}});
    scene.watch("later", [=](const auto& now) { return now[b].parameter() - (2.0 * pi + 1e-3); });
    const Trajectory run = simulate(scene, {.until = 20.0});
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_NEAR(run.events()[0].time, 2.0 * pi - 0.1, 1e-8);
}

TEST(HighPowers, from_where_a_step_begins_hide_no_root) {
    for (const int power : {5, 7, 9}) {
        Scene scene(Vector3(0, 0, 0));
        const BodyHandle b = scene.add(Particle{1.0}, FreeStart{.velocity = Vector3(1, 0, 0)});
        scene.watch("w", [=](const auto& now) { return pow(sin(now[b].position()[0]), power); });
        const Trajectory run = simulate(scene, {.until = 20.0, .error = 1e-9});
        ASSERT_EQ(run.events().size(), 6u) << power;
        for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(run.events()[k].time, (k + 1) * pi, 1e-9 * (k + 1)) << power;
    }
}

TEST(InfiniteSlopes, of_recorded_functions_are_passed_by_every_engine) {
    for (const std::string& engine : simulating::engines())
        for (int k = 0; k < 15; ++k) {
            const double root = 0.113 + 0.051 * k;
            Scene scene(down);
            const BodyHandle b = scene.add(Particle{1.0}, FreeStart{.velocity = Vector3(1, 0, 3.3)});
            scene.apply(Drag{.linear = 0.1, .quadratic = 0.3}, b);
            scene.watch("cbrt", [=](const auto& now) { return cbrt(now.time() - root); });
            scene.watch("edge", [=](const auto& now) { return sqrt(abs(now.time() - root)) - 0.1; });
            const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-7, .engine = engine});
            std::vector<double> roots;
            for (const Event& e : run.events())
                if (e.kind == EventKind::watch) roots.push_back(e.time);
            ASSERT_EQ(roots.size(), 3u) << engine << root;
            for (int i = 0; i < 3; ++i) EXPECT_NEAR(roots[static_cast<std::size_t>(i)], root + 0.01 * (i - 1), 1e-9);
        }
}

}  // namespace
}  // namespace rbdyn::test::test_rough_watches
