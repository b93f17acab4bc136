// Watched functions: what is found, once each, in which order; what is done about it.
#include <gtest/gtest.h>

#include <numbers>

#include "support.hpp"

namespace rbdyn::test::test_watch {
namespace {

constexpr double pi = std::numbers::pi;
const BodyHandle first{0};

/// A free particle that moves as x = x0 + v t + a t^2/2, without gravity.
Scene thrown(double x0, double v, double a) {
    Scene scene;
    const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{x0, 0, 0}, {v, 0, 0}});
    scene.apply(Force(Vector3(a, 0, 0)), body);
    return scene;
}
WatchFunction place(double x) {
    return [=](const Now& now) { return now[first].position()[0] - x; };
}
double number(const Observe& now, Quantity q, BodyHandle body, int component = 0) {
    return now({q, body.index, component});
}

// --- what is found ---

TEST(Watches, find_every_passage_with_its_direction) {
    for (const auto& [direction, expected] : {std::pair{Direction::either, "rising falling rising"},
                                              {Direction::rising, "rising rising"},
                                              {Direction::falling, "falling"}}) {
        // a cubic path by a force that grows in time: x = (t - 1)(t - 2)(t - 3)
        Scene scene;
        const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{-6, 0, 0}, {11, 0, 0}});
        scene.apply(Force([](const auto& t, const auto&, const auto&) {
                        using S = std::decay_t<decltype(t)>;
                        return Vector3Of<S>{6.0 * t - 12.0, S(0.0), S(0.0)};
                    }),
                    body);
        scene.watch("zero", place(0.0), {.direction = direction});
        const Trajectory run = simulate(scene, {.until = 5.0, .error = 1e-12});
        std::string found;
        for (const Event& e : run.events()) {
            EXPECT_EQ(e.kind, EventKind::watch);
            EXPECT_EQ(e.name, "zero");
            EXPECT_NEAR(e.time, std::round(e.time), 1e-14) << e;
            found += (found.empty() ? "" : " ") + std::string(name_of(e.direction));
        }
        EXPECT_EQ(found, expected);
    }
}

TEST(Watches, near_a_graze_find_both_passages_or_none) {
    // x = -(t-1)^2/2 + height
    for (double height : {1e-4, 1e-8, 1e-12}) {
        Scene scene = thrown(-0.5, 1.0, -1.0);
        scene.watch("above", place(-height));
        scene.watch("below", place(height));
        const Trajectory run = simulate(scene, {.until = 2.5, .error = 1e-12});
        const auto above = run.events().times("above");
        EXPECT_TRUE(run.events().times("below").empty()) << height;
        ASSERT_EQ(above.size(), 2u) << height;
        const double half = std::sqrt(2.0 * height);
        EXPECT_NEAR(above[0], 1.0 - half, 1e-15 / half);
        EXPECT_NEAR(above[1], 1.0 + half, 1e-15 / half);
    }
}

TEST(Watches, of_passages_an_instant_apart_find_both_in_order) {
    for (double apart : {1e-6, 1e-9, 1e-12}) {
        Scene scene = thrown(0.0, 1.0, 0.0);
        scene.watch("second", place(1.0 + apart));
        scene.watch("first", place(1.0));
        const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-12});
        ASSERT_EQ(run.events().size(), 2u);
        EXPECT_EQ(run.events()[0].name, "first") << apart;
        EXPECT_EQ(run.events()[1].name, "second") << apart;
        EXPECT_NEAR(run.events()[1].time - run.events()[0].time, apart, 4e-16);
    }
}

TEST(Watches, at_the_start_are_silent_and_at_the_end_are_heard) {
    for (double v : {1.0, 0.7, -3.0}) {
        Scene scene = thrown(0.0, v, 0.0);
        scene.watch("start", place(0.0));
        scene.watch("end", place(2.0 * v));
        scene.watch("later", place(2.0 * v * (1.0 + 1e-9)));
        const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-12});
        ASSERT_EQ(run.events().size(), 1u) << v << ' ' << kinds(run);
        EXPECT_EQ(run.events()[0].name, "end");
        EXPECT_EQ(run.events()[0].time, 2.0);
        EXPECT_EQ(run.status(), Status::reached_end);
    }
    // comes back to where it started
    Scene scene = thrown(0.0, 1.0, -1.0);
    scene.watch("start", place(0.0));
    const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-12});
    EXPECT_EQ(run.events().size(), 1u);
}

TEST(Watches, stop_a_run_where_they_pass_zero) {
    Scene scene = thrown(0.0, 3.0, -1.0);
    scene.watch("wall", place(4.0), {.action = {WatchAction::Kind::stop}});
    scene.watch("before", place(3.99));
    const Trajectory run = simulate(scene, {.until = 10.0, .error = 1e-12});
    EXPECT_EQ(run.status(), Status::stopped_by_event);
    EXPECT_NEAR(run.end(), 2.0, 1e-14);
    ASSERT_EQ(run.events().size(), 2u);
    EXPECT_EQ(run.events()[1].name, "wall");
    // the other way it does not
    Scene other = thrown(0.0, 3.0, -1.0);
    other.watch("wall", place(4.0), {.direction = Direction::falling, .action = {WatchAction::Kind::stop}});
    EXPECT_NEAR(simulate(other, {.until = 10.0, .error = 1e-12}).end(), 4.0, 1e-14);
}

TEST(Watches, that_pass_zero_as_friction_reverses_or_holds_are_heard_once_and_first) {
    struct Case {
        double mu_static, mu_dynamic;
        const char* expected;
    };
    for (const auto& c : {Case{0.9, 0.5, "watch stick"}, Case{0.25, 0.25, "watch reverse"}}) {
        // up a slope of 3/4 until it stops
        Scene scene(down);
        const BodyHandle bead = scene.add(Particle{1.0}, Rail(incline(0.75), Coulomb{c.mu_static, c.mu_dynamic}),
                                          {.parameter = 0.0, .speed = -3.0});
        scene.watch("speed", [=](const Now& now) { return now[bead].speed(); });
        const Trajectory run = simulate(scene, {.until = 0.75, .error = 1e-12});
        EXPECT_EQ(kinds(run), c.expected);
        ASSERT_EQ(run.events().size(), 2u);
        EXPECT_EQ(run.events()[0].time, run.events()[1].time);
        EXPECT_EQ(run.events()[0].direction, Direction::rising);
    }
}

TEST(Watches, of_velocity_in_the_world_pass_zero_with_a_reversal_on_a_hoop_once) {
    Scene scene(down);
    const BodyHandle bead =
        scene.add(Particle{1.0}, Rail(vertical_circle(1.0), Coulomb{0.25, 0.125}), {.parameter = 2.5});
    scene.watch("vx", [=](const Now& now) { return now[bead].velocity()[0]; });
    const Trajectory run = simulate(scene, {.until = 6.0, .error = 1e-12});
    // vx = v cos(angle) passes zero at every stop, and where the angle passes a quarter turn
    const auto times = run.events().times("vx");
    std::size_t stops = run.events().times("reverse").size() + run.events().times("stick").size();
    std::size_t quarters = 0;
    double before = run[bead].parameter(0.0);
    for (int k = 1; k <= 60000; ++k) {
        const double u = run[bead].parameter(k * 1e-4);
        if ((std::abs(before) > pi / 2) != (std::abs(u) > pi / 2)) ++quarters;
        before = u;
    }
    EXPECT_EQ(times.size(), stops + quarters) << kinds(run);
    for (const double stop : run.events().times("reverse"))
        EXPECT_EQ(std::count_if(times.begin(), times.end(),
                                [=](double t) { return std::abs(t - stop) <= 4.0 * epsilon * stop; }),
                  1)
            << stop;
}

// --- what may be watched ---

TEST(Watches, may_ask_for_everything_a_run_can_tell) {
    Scene scene(down);
    const BodyHandle bead = scene.add(Particle{0.5}, Rail(vertical_circle(0.75), Coulomb{0.1}), {.parameter = 1.0});
    const BodyHandle ball = scene.add(Particle{2.0}, FreeStart{{0.3, 0.2, 0.1}, {1.0, 0.0, 3.0}});
    const CouplingHandle spring = scene.connect(Spring{.stiffness = 5.0, .rest_length = 0.1}, bead, ball);
    std::vector<WatchHandle> watches;
    const auto watch = [&](const char* name, WatchFunction f) { watches.push_back(scene.watch(name, std::move(f))); };
    watch("time", [](const Now& now) { return now.time() - 1.0; });
    watch("z", [=](const Now& now) { return now[ball].position()[2]; });
    watch("vz", [=](const Now& now) { return now[ball].velocity()[2]; });
    watch("az", [=](const Now& now) { return now[ball].acceleration()[2] + gravity; });
    watch("fx", [=](const Now& now) { return now[bead].force()[0]; });
    watch("reaction", [=](const Now& now) { return now[bead].reaction()[2] - 5.0; });
    watch("parameter", [=](const Now& now) { return now[bead].parameter(); });
    watch("speed", [=](const Now& now) { return now[bead].speed(); });
    watch("ball's speed", [=](const Now& now) { return dot(now[ball].velocity(), now[ball].velocity()) - 4.0; });
    watch("tangential", [=](const Now& now) { return now[bead].tangential_force(); });
    watch("kinetic", [=](const Now& now) { return now[bead].kinetic_energy() - 0.1; });
    watch("length", [=](const Now& now) { return now[spring].length() - 1.0; });
    watch("pull", [=](const Now& now) { return now[spring].force()[0]; });
    const Trajectory run = simulate(scene, {.until = 4.0, .error = 1e-10});
    for (std::size_t k = 0; k < watches.size(); ++k) {
        const auto times = run.events().times(scene.watches()[k].name);
        EXPECT_FALSE(times.empty()) << scene.watches()[k].name;
        for (const double t : times) {
            const double v = std::abs(run.watched(watches[k], t));
            if (v > 1e-9) {
                // a jump, at another event
                EXPECT_LT(run.watched(watches[k], t, Side::before) * run.watched(watches[k], t), 1e-9)
                    << scene.watches()[k].name;
            }
        }
        // and no change of sign without an event
        std::size_t changes = 0;
        double before = run.watched(watches[k], 0.0);
        for (int j = 1; j <= 4000; ++j) {
            const double value = run.watched(watches[k], j * 1e-3);
            changes += (before > 0.0) != (value > 0.0);
            before = value;
        }
        // a speed that comes to zero, is held there and goes back has passed it twice
        if (scene.watches()[k].name != "speed") {
            EXPECT_EQ(times.size(), changes) << scene.watches()[k].name;
        }
    }
    // the same from the run
    EXPECT_NEAR(run.watched(watches[5], 2.2), run[bead].reaction(2.2).z() - 5.0, 1e-13);
    EXPECT_NEAR(run.watched(watches[9], 2.2), run[bead].tangential_force(2.2), 1e-13);
    EXPECT_NEAR(run.watched(watches[11], 2.2), run[spring].length(2.2) - 1.0, 1e-13);
    EXPECT_NEAR(run.watched(watches[12], 2.2), run[spring].force(2.2).x(), 1e-13);
}

TEST(Watches, called_back_find_the_same_times) {
    const auto scene_with = [](bool is_called) {
        Scene scene(down);
        const BodyHandle bead =
            scene.add(Particle{0.5}, Rail(vertical_circle(0.75), Coulomb{0.05}), {.parameter = 1.0, .speed = 1.0});
        const auto watch = [&](const char* name, auto recorded, std::function<double(const Observe&)> callback) {
            if (is_called)
                scene.watch(name, WatchFunction::called_back(std::move(callback), "a test"));
            else
                scene.watch(name, recorded);
        };
        watch(
            "height", [=](const Now& now) { return now[bead].position()[2] + 0.6; },
            [=](const Observe& now) { return number(now, Quantity::position, bead, 2) + 0.6; });
        watch(
            "speed", [=](const Now& now) { return now[bead].speed(); },
            [=](const Observe& now) { return number(now, Quantity::speed, bead); });
        watch(
            "reaction", [=](const Now& now) { return now[bead].reaction()[2] - 7.0; },
            [=](const Observe& now) { return number(now, Quantity::reaction, bead, 2) - 7.0; });
        return scene;
    };
    const Trajectory recorded = simulate(scene_with(false), {.until = 4.0, .error = 1e-11});
    for (const char* engine : {"auto", "taylor", "dop853"}) {
        const Trajectory called = simulate(scene_with(true), {.until = 4.0, .error = 1e-11, .engine = engine});
        for (const char* name : {"height", "speed", "reaction"}) {
            const auto a = recorded.events().times(name), b = called.events().times(name);
            ASSERT_EQ(a.size(), b.size())
                << name << ' ' << engine << " | " << kinds(recorded) << " | " << kinds(called);
            EXPECT_GE(a.size(), 4u) << name;
            for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-10) << name << ' ' << engine;
        }
    }
}

TEST(Watches, called_back_at_the_end_and_at_the_start_are_as_recorded_ones) {
    Scene scene = thrown(0.0, 1.0, 0.0);
    for (const double x : {0.0, 1.0, 2.0})
        scene.watch("at " + std::to_string(x),
                    WatchFunction::called_back(
                        [=](const Observe& now) { return number(now, Quantity::position, first) - x; }, "a test"));
    const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-10});
    ASSERT_EQ(run.events().size(), 2u);
    EXPECT_NEAR(run.events()[0].time, 1.0, 1e-12);
    EXPECT_NEAR(run.events()[1].time, 2.0, 1e-12);
}

// --- changes ---

/// A ball that bounces from z = 0 with a coefficient of restitution.
Scene bouncing(double height, double restitution, bool is_called = false) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, height}, {0, 0, 0}});
    const WatchAction bounce{WatchAction::Kind::change, [=](const Observe& now) {
                                 Vector3 v;
                                 for (int i = 0; i < 3; ++i) v[i] = number(now, Quantity::velocity, ball, i);
                                 v[2] = -restitution * v[2];
                                 return std::vector<StateChange>{{.body = ball, .velocity = v}};
                             }};
    WatchFunction z = [=](const Now& now) { return now[ball].position()[2]; };
    if (is_called)
        z = WatchFunction::called_back([=](const Observe& now) { return number(now, Quantity::position, ball, 2); },
                                       "a test");
    scene.watch("floor", std::move(z), {.direction = Direction::falling, .action = bounce});
    return scene;
}

TEST(BouncingBall, meets_the_floor_at_the_times_of_the_closed_form) {
    for (double e : {1.0, 0.9, 0.5}) {
        const double height = 2.0, fall = std::sqrt(2.0 * height / gravity);
        std::vector<double> expected{fall};
        double flight = 2.0 * e * fall;
        while (expected.size() < 20) {
            expected.push_back(expected.back() + flight);
            flight *= e;
        }
        const double until = expected.back() + 0.25 * flight;
        const Trajectory run = simulate(bouncing(height, e), {.until = until, .error = 1e-12});
        const auto times = run.events().times("floor");
        ASSERT_EQ(times.size(), 20u) << e;
        for (std::size_t k = 0; k < 20; ++k) EXPECT_NEAR(times[k], expected[k], 1e-12 * expected[k]) << e << ' ' << k;
        // the speeds at the floor
        for (std::size_t k = 0; k < 5; ++k)
            EXPECT_NEAR(run[first].velocity(times[k]).z(), std::pow(e, k + 1.0) * gravity * fall, 1e-11);
        for (int k = 0; k <= 1000; ++k) EXPECT_GE(run[first].position(until * k / 1000.0).z(), -1e-12);
    }
}

TEST(BouncingBall, watched_by_a_function_called_back_meets_the_floor_at_the_same_times) {
    const Trajectory a = simulate(bouncing(2.0, 0.9), {.until = 5.0, .error = 1e-11}),
                     b = simulate(bouncing(2.0, 0.9, true), {.until = 5.0, .error = 1e-11});
    const auto s = a.events().times("floor"), t = b.events().times("floor");
    ASSERT_EQ(s.size(), t.size());
    for (std::size_t k = 0; k < s.size(); ++k) EXPECT_NEAR(s[k], t[k], 1e-10);
}

TEST(BouncingBall, accumulating_ends_with_a_status_and_never_falls_through) {
    // the limit of bounces is (1 + e) / (1 - e) times the fall
    for (double e : {0.5, 0.9})
        for (std::optional<double> rtol : {std::optional<double>(1e-10), std::optional<double>()}) {
            const Attempt result = attempt(bouncing(2.0, e), {.until = 100.0, .rtol = rtol});
            const double limit = (1.0 + e) / (1.0 - e) * std::sqrt(4.0 / gravity);
            EXPECT_EQ(result.run.status(), Status::inconsistent);
            EXPECT_NEAR(result.run.end(), limit, 1e-11 * limit);
            EXPECT_NEAR(result.run[first].position(result.run.end()).z(), 0.0, 1e-14);
        }
}

TEST(Changes, of_a_bead_on_a_rough_rail_set_its_slip_anew) {
    // kicked when it has come to rest, stopped while it slides
    Scene scene(down);
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5, 0.25}), {.parameter = 0.0});
    const auto set = [&](const char* name, double at, double speed) {
        scene.watch(name, [=](const Now& now) { return now.time() - at; },
                    {.action = {WatchAction::Kind::change, [=](const Observe&) {
                                    return std::vector<StateChange>{{.body = bead, .speed = speed}};
                                }}});
    };
    set("kick", 1.0, 2.0);
    set("stop", 1.5, 0.0);
    set("back", 2.0, -2.0);
    const Trajectory run = simulate(scene, {.until = 4.0, .error = 1e-12});
    EXPECT_EQ(kinds(run), "watch watch watch stick");
    const double a = 0.25 * gravity, there = 2.0 * 0.5 - 0.5 * a * 0.25;
    EXPECT_EQ(run[bead].parameter(0.9), 0.0);
    EXPECT_NEAR(run[bead].parameter(1.75), there, 1e-13);
    EXPECT_EQ(run[bead].speed(1.75), 0.0);
    EXPECT_NEAR(run[bead].speed(1.5, Side::before), 2.0 - 0.5 * a, 1e-13);
    EXPECT_EQ(run[bead].speed(1.5), 0.0);
    EXPECT_NEAR(run.events()[3].time, 2.0 + 2.0 / a, 1e-12);
    EXPECT_NEAR(run[bead].parameter(4.0), there - 0.5 * 4.0 / a, 1e-12);
}

TEST(Changes, of_place_and_speed_together_count_the_speed_at_the_new_place) {
    Scene scene;
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(Parabola{.a = 0.5, .x = {1, 0, 0}, .y = {0, 0, 1}}),
                                      {.parameter = 0.0, .speed = 1.0});
    scene.watch("now", [=](const Now& now) { return now.time() - 1.0; },
                {.action = {WatchAction::Kind::change, [=](const Observe&) {
                                return std::vector<StateChange>{{.body = bead, .parameter = 2.0, .speed = 3.0}};
                            }}});
    scene.watch("later", [=](const Now& now) { return now.time() - 2.0; },
                {.action = {WatchAction::Kind::change, [=](const Observe&) {
                                return std::vector<StateChange>{{.body = bead, .parameter = -1.0}};
                            }}});
    const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-12});
    EXPECT_EQ(run[bead].parameter(1.0), 2.0);
    EXPECT_NEAR(run[bead].speed(1.0), 3.0, 1e-15);
    // without a speed given it keeps the one it had along the rail
    EXPECT_EQ(run[bead].parameter(2.0), -1.0);
    EXPECT_NEAR(run[bead].speed(2.5), 3.0, 1e-12);
}

TEST(Changes, made_by_two_watches_at_one_instant_are_both_made) {
    Scene scene = thrown(0.0, 1.0, 0.0);
    const BodyHandle other = scene.add(Particle{1.0}, FreeStart{{0, 1, 0}, {1, 0, 0}});
    for (const BodyHandle body : {first, other})
        scene.watch(
            "wall of " + std::to_string(body.index), [=](const Now& now) { return now[body].position()[0] - 1.0; },
            {.action = {WatchAction::Kind::change, [=](const Observe& now) {
                            return std::vector<StateChange>{
                                {.body = body, .velocity = Vector3(-number(now, Quantity::velocity, body), 0, 0)}};
                        }}});
    const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-12});
    ASSERT_EQ(run.events().size(), 2u) << kinds(run);
    for (const BodyHandle body : {first, other}) EXPECT_NEAR(run[body].position(3.0).x(), -1.0, 1e-13);
}

TEST(Changes, that_break_a_rule_say_so_and_keep_the_run_until_then) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    struct Case {
        StateChange change;
        const char* says;
    };
    for (const auto& [change, says] :
         {Case{{.body = {0}, .position = Vector3(0, 0, 0)}, "position"}, Case{{.body = {0}, .speed = nan}, "finite"},
          Case{{.body = {7}, .speed = 1.0}, "body"}, Case{{.body = {0}, .parameter = 5.0}, "domain"},
          Case{{.body = {0}, .parameter = nan}, "finite"}, Case{{.body = {1}, .speed = 1.0}, "free"},
          Case{{.body = {1}, .velocity = Vector3(0, nan, 0)}, "finite"}}) {
        Scene scene;
        const Polynomial line{.coefficients = {{0, 0, 0}, {1, 0, 0}}, .domain = {-1.0, 4.0}};
        scene.add(Particle{1.0}, Rail(line), {.parameter = 0.0, .speed = 1.0});
        scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {0, 1, 0}});
        scene.watch("now", [](const Now& now) { return now.time() - 1.0; },
                    {.action = {WatchAction::Kind::change,
                                [=, c = change](const Observe&) { return std::vector<StateChange>{c}; }}});
        const Attempt result = attempt(scene, {.until = 2.0, .error = 1e-10});
        ASSERT_EQ(result.outcome, simulating::Outcome::thrown) << says;
        try {
            std::rethrow_exception(result.thrown);
        } catch (const InvalidInput& e) {
            EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what();
            EXPECT_NE(std::string(e.what()).find("watch now"), std::string::npos) << e.what();
        }
        EXPECT_NEAR(result.run.end(), 1.0, 1e-12);
        EXPECT_NEAR(result.run[first].parameter(0.5), 0.5, 1e-12);
        EXPECT_THROW((void)simulate(scene, {.until = 2.0, .error = 1e-10}), InvalidInput);
    }
}

TEST(Changes, thrown_out_of_pass_unchanged) {
    struct Own {
        int number;
    };
    Scene scene = thrown(0.0, 1.0, 0.0);
    scene.watch(
        "now", place(0.75),
        {.action = {WatchAction::Kind::change, [](const Observe&) -> std::vector<StateChange> { throw Own{42}; }}});
    try {
        (void)simulate(scene, {.until = 2.0});
        FAIL();
    } catch (const Own& own) {
        EXPECT_EQ(own.number, 42);
    }
}

TEST(Watches, with_names_taken_or_handles_of_nothing_are_refused) {
    Scene scene = thrown(0.0, 1.0, 0.0);
    scene.watch("a", place(0.0));
    EXPECT_THROW(scene.watch("a", place(1.0)), InvalidInput);
    EXPECT_THROW(scene.watch("", place(1.0)), InvalidInput);
    EXPECT_THROW(scene.watch("b", [](const Now& now) { return now[BodyHandle{3}].position()[0]; }), InvalidInput);
    EXPECT_THROW(scene.watch("c", [](const Now& now) { return now[first].reaction()[0]; }), InvalidInput);
    EXPECT_THROW(scene.watch("e", [](const Now& now) { return now[first].speed(); }), InvalidInput);
    EXPECT_THROW(scene.watch("d", [](const Now& now) { return now[CouplingHandle{0}].length(); }), InvalidInput);
}

TEST(Watches, that_are_constant_or_stay_zero_are_never_heard) {
    Scene scene = thrown(0.0, 1.0, 0.0);
    scene.watch("zero", [](const Now& now) { return now[first].position()[1]; });
    scene.watch("none", [](const Now& now) { return 0.0 * now[first].position()[0]; });
    scene.watch("one", [](const Now&) { return Expression(1.0); });
    scene.watch("called", WatchFunction::called_back([](const Observe&) { return 0.0; }, "a test"));
    EXPECT_TRUE(simulate(scene, {.until = 5.0}).events().empty());
}

TEST(Watches, with_a_corner_or_a_case_are_heard_where_they_pass_zero) {
    Scene scene = thrown(-1.0, 1.0, 0.0);
    scene.watch("corner", [](const Now& now) { return abs(now[first].position()[0]) - 0.5; });
    scene.watch("case", [](const Now& now) {
        const Expression x = now[first].position()[0];
        return where(x > 0.25, Expression(1.0), Expression(-1.0));
    });
    const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-12});
    const auto corner = run.events().times("corner"), jump = run.events().times("case");
    ASSERT_EQ(corner.size(), 2u) << kinds(run);
    EXPECT_NEAR(corner[0], 0.5, 1e-14);
    EXPECT_NEAR(corner[1], 1.5, 1e-14);
    ASSERT_EQ(jump.size(), 1u);
    EXPECT_NEAR(jump[0], 1.25, 1e-14);
}

}  // namespace
}  // namespace rbdyn::test::test_watch
