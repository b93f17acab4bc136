// Functions of the user's that fail: by exceptions, by numbers that are not finite; and models of the user's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <random>

#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/own_motion.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "support.hpp"

namespace rbdyn::test::test_own_functions {
namespace {

constexpr double pi = std::numbers::pi;
using Outcome = simulating::Outcome;
const BodyHandle first{0};
const double nan = std::numeric_limits<double>::quiet_NaN();

/// A force that is called back.
Force called_back(std::string name, std::function<Vector3(double t, const Vector3& r, const Vector3& v)> f) {
    auto callback = std::make_shared<Callback>();
    callback->name = std::move(name);
    callback->reason = "a test";
    callback->inputs = 7;
    callback->outputs = 3;
    callback->function = [f = std::move(f)](const double* x, double* y) {
        const Vector3 force = f(x[0], {x[1], x[2], x[3]}, {x[4], x[5], x[6]});
        for (int i = 0; i < 3; ++i) y[i] = force[i];
    };
    return Force(std::shared_ptr<const Callback>(std::move(callback)));
}

/// A particle on a spring, x = cos t.
Scene swinging(const Force& force) {
    Scene scene;
    const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 0, 0}}, "swing");
    scene.apply(force, body);
    return scene;
}

struct Own {
    int number;
};

// --- when they are asked ---

TEST(Callbacks, that_throw_before_the_first_step_leave_a_run_that_has_its_start) {
    // whether it sticks is asked before there is any motion
    Scene scene(down);
    scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5, 0.25}), {.parameter = 0.75});
    scene.apply(called_back("broken", [](double, const Vector3&, const Vector3&) -> Vector3 { throw Own{3}; }), first);
    const Attempt result = attempt(scene, {.until = 1.0});
    EXPECT_EQ(result.outcome, Outcome::thrown);
    EXPECT_EQ(result.run.t(), std::vector<double>{0.0});
    EXPECT_EQ(result.run[first].position(0.0), Vector3(0.75, 0, 0));
}

TEST(Callbacks, are_not_asked_for_positions) {
    const auto calls = std::make_shared<int>(0);
    const Trajectory run = simulate(swinging(called_back("spring",
                                                         [calls](double, const Vector3& r, const Vector3&) -> Vector3 {
                                                             ++*calls;
                                                             return -r;
                                                         })),
                                    {.until = 2.0});
    const int before = *calls;
    for (const double t : {0.0, 0.5, 2.0}) EXPECT_NEAR(run[first].position(t)[0], std::cos(t), 1e-9);
    EXPECT_EQ(*calls, before);
    (void)run[first].acceleration(1.0);
    EXPECT_EQ(*calls, before + 1);
}

// --- lengths that pass zero ---

/// Pressed across its line by (a + b sin(k t)) n + miss m, n and m across it and each other.
struct Pressed {
    Vector3 along, n, m;
    double a, b, k, miss;

    template <class S>
    Vector3Of<S> operator()(const S& t) const {
        using std::sin;
        const S size = a + b * sin(k * t);
        return {n[0] * size + S(miss * m[0]), n[1] * size + S(miss * m[1]), n[2] * size + S(miss * m[2])};
    }
    Scene scene(bool is_recorded) const {
        Scene s;
        const BodyHandle bead =
            s.add(Particle{1.0}, Rail(Line{.direction = along}, Coulomb{0.05, 0.05}), {.parameter = 0.0, .speed = 5.0});
        s.apply(is_recorded
                    ? Force([*this](const auto& t, const auto&, const auto&) { return (*this)(Expression(t)); })
                    : called_back("press",
                                  [*this](double t, const Vector3&, const Vector3&) -> Vector3 { return (*this)(t); }),
                bead);
        return s;
    }
};

TEST(Callbacks, that_press_a_bead_through_zero_make_the_events_of_recorded_ones) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    int passages = 0;
    for (int i = 0; i < 24; ++i) {
        const Vector3 along = Vector3(part(random), part(random) - 0.5, part(random) - 0.5).normalized();
        const Vector3 n = along.cross(Vector3(part(random), 1.0, part(random))).normalized();
        const Pressed press{i % 3 == 0 ? Vector3(1, 0, 0) : along,
                            i % 3 == 0 ? Vector3(0, 0, 1) : n,
                            i % 3 == 0 ? Vector3(0, 1, 0) : Vector3(along.cross(n)),
                            2.0 * part(random) - 1.0,
                            2.0,
                            1.0 + 4.0 * part(random),
                            0.0};
        std::vector<double> times;
        for (int j = -1; j < 10; ++j)
            for (const double angle : {std::asin(-press.a / press.b), pi - std::asin(-press.a / press.b)})
                if (const double t = (angle + 2.0 * pi * j) / press.k; t > 0.0 && t < 3.0) times.push_back(t);
        std::sort(times.begin(), times.end());
        passages += static_cast<int>(times.size());
        for (const std::string& engine : simulating::engines())
            for (const bool is_recorded : {true, false}) {
                if (engine == "taylor" && !is_recorded) continue;
                const Trajectory run =
                    simulate(press.scene(is_recorded), {.until = 3.0, .error = 1e-8, .engine = engine});
                const std::vector<double> found = run.events().times("normal-zero");
                ASSERT_EQ(found.size(), times.size()) << i << ' ' << engine << ' ' << is_recorded << kinds(run);
                for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(found[k], times[k], 1e-8);
            }
    }
    EXPECT_GT(passages, 24);
}

TEST(Callbacks, that_press_a_bead_closely_past_zero_make_no_event) {
    for (const double miss : {1.0, 1e-2, 1e-4, 1e-6}) {
        const Pressed press{{1, 0, 0}, {0, 0.6, 0.8}, {0, -0.8, 0.6}, 0.3, 2.0, 3.0, miss};
        for (const std::string& engine : simulating::engines())
            for (const bool is_recorded : {true, false}) {
                // series do not tell what is far below the error asked for
                if (engine == "taylor" && (!is_recorded || miss < 1e-5)) continue;
                const Trajectory run =
                    simulate(press.scene(is_recorded), {.until = 3.0, .error = 1e-8, .engine = engine});
                EXPECT_EQ(kinds(run), "") << engine << ' ' << is_recorded << ' ' << miss;
            }
    }
}

TEST(Callbacks, that_drag_what_is_thrown_upwards_see_its_speed_pass_zero) {
    const Vector3 up = Vector3(1.0, 2.0, 3.0).normalized();
    for (const bool is_recorded : {true, false})
        for (const std::string& engine : simulating::engines()) {
            if (engine == "taylor" && !is_recorded) continue;
            Scene scene;
            const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, 8.0 * up});
            scene.apply(Drag{.quadratic = 0.1}, ball);
            const Vector3 weight = -10.0 * up;
            scene.apply(is_recorded
                            ? Force([=](const auto&, const auto&, const auto&) {
                                  return Vector3Of<Expression>{weight[0], weight[1], weight[2]};
                              })
                            : called_back("weight", [=](double, const Vector3&, const Vector3&) { return weight; }),
                        ball);
            const Trajectory run = simulate(scene, {.until = 1.5, .error = 1e-9, .engine = engine});
            ASSERT_EQ(kinds(run), "switch") << engine << ' ' << is_recorded;
            // v = 10 tan(c - t), tan c = 0.8
            EXPECT_NEAR(run.events()[0].time, std::atan(0.8), 1e-8) << engine << ' ' << is_recorded;
        }
}

// --- motion from rest ---

TEST(FromRest, a_block_breaks_away_under_a_growing_force_alike_with_every_engine_and_however_that_is_given) {
    const auto push = [](double t, const Vector3&, const Vector3&) { return Vector3(7.0 * std::sin(1.5 * t), 0, 0); };
    const auto scene = [&](bool is_recorded) {
        Scene s(down);
        const BodyHandle block =
            s.add(Particle{2.0}, Rail(along_x, Coulomb{0.25, 0.25}), {.parameter = 0.0, .speed = 0.0});
        s.apply(is_recorded ? Force([](const auto& t, const auto&, const auto&) {
                    return Vector3Of<Expression>{7.0 * sin(1.5 * t), 0.0, 0.0};
                })
                            : called_back("push", push),
                block);
        return s;
    };
    const Trajectory exact = simulate(scene(true), {.until = 10.0, .error = 1e-12, .engine = "taylor"});
    ASSERT_EQ(exact.events().size(), 9u);
    EXPECT_NEAR(exact.events()[0].time, std::asin(0.25 * 2.0 * gravity / 7.0) / 1.5, 4.0 * epsilon);
    for (const std::string& engine : simulating::engines())
        for (const bool is_recorded : {true, false}) {
            if (engine == "taylor" && !is_recorded) continue;
            const Trajectory run = simulate(scene(is_recorded), {.until = 10.0, .engine = engine, .max_steps = 10000});
            ASSERT_EQ(kinds(run), kinds(exact)) << engine;
            ASSERT_EQ(run.status(), Status::reached_end) << engine;
            for (std::size_t k = 0; k < exact.events().size(); ++k)
                EXPECT_NEAR(run.events()[k].time, exact.events()[k].time, 1e-9 * exact.events()[k].time) << engine;
            EXPECT_NEAR(run[first].position(10.0)[0], exact[first].position(10.0)[0], 1e-9) << engine;
        }
}

TEST(FromRest, a_point_follows_a_force_that_begins_as_a_high_power_of_time) {
    // the integrals of sin^3 and sin^5, twice
    const auto third = [](double t) { return 0.75 * (t - std::sin(t)) - (t / 3.0 - std::sin(3.0 * t) / 9.0) / 4.0; };
    const auto fifth = [](double t) {
        return 0.625 * (t - std::sin(t)) - 0.3125 * (t / 3.0 - std::sin(3.0 * t) / 9.0) +
               0.0625 * (t / 5.0 - std::sin(5.0 * t) / 25.0);
    };
    for (const std::string& engine : simulating::engines())
        for (const int power : {3, 5}) {
            Scene scene(Vector3(0, 0, 0));
            const BodyHandle b = scene.add(Particle{1.0}, FreeStart{});
            scene.apply(Force([power](const auto& t, const auto&, const auto&) {
                            using S = std::decay_t<decltype(t)>;
                            return Vector3Of<S>{pow(sin(t), power), S(0.0), S(0.0)};
                        }),
                        b);
            const Trajectory run = simulate(scene, {.until = 20.0, .error = 1e-9, .engine = engine});
            for (const double t : {0.5, 7.0, 20.0})
                EXPECT_NEAR(run[b].position(t)[0], power == 3 ? third(t) : fifth(t), 2e-8) << engine << power;
        }
}

TEST(FromRest, a_force_called_back_is_followed_however_late_the_motion_begins) {
    for (const double start : {0.0, 100.0, -1e4, 1e6})
        for (const std::string engine : {"dop853", "cvode-adams"})
            for (const double base : {0.0, 1.0}) {
                Scene scene(Vector3(0, 0, 0));
                const BodyHandle b = scene.add(Particle{1.0}, FreeStart{});
                scene.apply(
                    called_back("late", [=](double t, const Vector3&,
                                            const Vector3&) { return Vector3(base + std::sin(t - start), 0, 0); }),
                    b);
                const Trajectory run =
                    simulate(scene, {.until = start + 2.0, .start = start, .error = 1e-8, .engine = engine});
                EXPECT_NEAR(run[b].position(start + 2.0)[0], 2.0 * base + 2.0 - std::sin(2.0), 1e-8)
                    << start << engine << base;
            }
}

// --- exceptions ---

TEST(Exceptions, of_a_force_pass_unchanged_and_the_run_until_then_is_kept) {
    for (int calls : {0, 300, 1000}) {
        for (const auto& rtol : {std::optional<double>(), std::optional<double>(1e-10)}) {
            const auto scene = [=] {
                return swinging(called_back(
                    "spring",
                    [left = std::make_shared<int>(calls)](double, const Vector3& r, const Vector3&) -> Vector3 {
                        if (--*left < 0) throw Own{17};
                        return -r;
                    }));
            };
            const SimulateOptions options{
                .until = 200.0, .error = rtol ? SimulateOptions{}.error : 1e-10, .rtol = rtol};
            try {
                (void)simulate(scene(), options);
                FAIL();
            } catch (const Own& own) {
                EXPECT_EQ(own.number, 17);
            }
            const Attempt result = attempt(scene(), options);
            EXPECT_EQ(result.outcome, Outcome::thrown);
            EXPECT_TRUE(static_cast<bool>(result.thrown));
            if (calls == 0) {
                EXPECT_EQ(result.run.end(), 0.0);
                EXPECT_EQ(result.run[first].position(0.0), Vector3(1, 0, 0));
                continue;
            }
            // up to the last step that was complete, some twenty calls each
            EXPECT_GE(result.run.end(), 1.0);
            EXPECT_LT(result.run.end(), 200.0);
            for (double share : {0.25, 1.0}) {
                const double t = share * result.run.end();
                EXPECT_NEAR(state_at(result.run.data()->record, t, Side::after)[0], std::cos(t), 1e-7);
            }
        }
    }
}

TEST(Exceptions, of_a_force_that_is_recorded_come_when_it_is_recorded) {
    EXPECT_THROW((void)Force([](const auto&, const auto& r, const auto&) {
                     if (r[0].is_constant()) return Vector3Of<Expression>{0.0, 0.0, 0.0};
                     throw Own{1};
                     return Vector3Of<Expression>{0.0, 0.0, 0.0};
                 }),
                 Own);
}

// --- numbers that are not finite ---

/// The run fails at the time given, and says why.
void expect_not_finite(const Scene& scene, double at, double within, const std::vector<std::string>& says) {
    for (const auto& rtol : {std::optional<double>(), std::optional<double>(1e-8)}) {
        const Attempt result =
            attempt(scene, {.until = 5.0, .error = rtol ? SimulateOptions{}.error : 1e-8, .rtol = rtol});
        EXPECT_EQ(result.outcome, Outcome::broken) << result.message;
        EXPECT_EQ(result.run.status(), Status::not_finite);
        EXPECT_NEAR(result.run.end(), at, within) << result.message;
        for (const std::string& part : says)
            EXPECT_NE(result.message.find(part), std::string::npos) << part << " in: " << result.message;
        EXPECT_THROW(
            (void)simulate(scene, {.until = 5.0, .error = rtol ? SimulateOptions{}.error : 1e-8, .rtol = rtol}),
            IntegrationError);
    }
}

TEST(NotFinite, from_a_time_on_a_force_called_back_is_named_with_its_body_and_time) {
    for (double at : {0.7, 2.5})
        expect_not_finite(swinging(called_back("engine",
                                               [=](double t, const Vector3& r, const Vector3&) -> Vector3 {
                                                   return t > at ? Vector3(nan, 0, 0) : -r;
                                               })),
                          at, 1e-3 * at, {"not finite", "engine", "swing", "t = "});
}

TEST(NotFinite, at_a_place_a_force_called_back_is_named) {
    // x = cos t is below a half from pi/3 on
    expect_not_finite(swinging(called_back("field",
                                           [=](double, const Vector3& r, const Vector3&) -> Vector3 {
                                               return r.x() < 0.5 ? Vector3(0, nan, 0) : -r;
                                           })),
                      pi / 3.0, 1e-3, {"not finite", "field", "swing"});
}

TEST(NotFinite, at_the_start_a_force_ends_the_run_at_the_start) {
    expect_not_finite(swinging(called_back(
                          "nothing", [=](double, const Vector3&, const Vector3&) { return Vector3(nan, nan, nan); })),
                      0.0, 0.0, {"not finite", "nothing", "swing", "t = 0 s"});
    // recorded: 1/x at x = 0
    Scene scene;
    const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 0}}, "swing");
    scene.apply(Force(Function::record(7,
                                       [](const std::vector<Expression>& x) {
                                           return std::vector<Expression>{1.0 / x[1], 0.0, 0.0};
                                       }),
                      "pole"),
                body);
    expect_not_finite(scene, 0.0, 0.0, {"not finite", "pole", "swing"});
}

TEST(NotFinite, where_it_comes_to_a_pole_a_recorded_force_is_named) {
    // sqrt(1 - t) from t = 1 on; 1/(2 - t)^2 at t = 2
    for (const bool is_root : {true, false}) {
        const Scene scene =
            swinging(Force(Function::record(7,
                                            [=](const std::vector<Expression>& x) {
                                                const Expression f =
                                                    is_root ? sqrt(1.0 - x[0]) : 1.0 / ((2.0 - x[0]) * (2.0 - x[0]));
                                                return std::vector<Expression>{f, 0.0, 0.0};
                                            }),
                           "pole"));
        const Attempt result = attempt(scene, {.until = 5.0, .rtol = 1e-8});
        EXPECT_NE(result.run.status(), Status::reached_end) << is_root;
        // at this tolerance a step of the series may end a little beyond the root; the pole itself is on both sides of
        // it finite, so nothing is named there
        EXPECT_NEAR(result.run.end(), is_root ? 1.0 : 2.0, 1e-4);
        if (is_root) {
            EXPECT_NE(result.message.find("pole"), std::string::npos) << result.message;
        }
    }
}

TEST(NotFinite, on_a_rail_a_force_is_named_too) {
    Scene scene(down);
    const BodyHandle bead =
        scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.1}), {.parameter = 0.0, .speed = 3.0}, "slider");
    scene.apply(called_back("gust",
                            [](double t, const Vector3&, const Vector3&) {
                                return t > 0.5 ? Vector3(std::numeric_limits<double>::infinity(), 0, 0)
                                               : Vector3(1, 0, 0);
                            }),
                bead);
    expect_not_finite(scene, 0.5, 1e-3, {"not finite", "gust", "slider"});
}

TEST(NotFinite, where_a_curve_of_a_function_ends_the_curve_is_named) {
    // (u, 0, -sqrt(1 - u)) has no place beyond u = 1
    Scene scene;
    const Curve curve(
        [](const auto& u) {
            using S = std::decay_t<decltype(u)>;
            using std::sqrt;
            return Vector3Of<S>{u, S(0.0), -sqrt(1.0 - u) * (1.0 - u) * (1.0 - u)};
        },
        Domain{-1.0, 0.999});
    scene.add(Particle{1.0}, Rail(curve), {.parameter = 0.0, .speed = 1.0}, "slider");
    const Attempt result = attempt(scene, {.until = 5.0, .rtol = 1e-8});
    EXPECT_EQ(result.run.status(), Status::stopped_by_event);
    // without a domain that keeps it out it is refused, or the run ends there
    try {
        Scene beyond;
        beyond.add(Particle{1.0}, Rail(Curve([](const auto& u) {
                       using S = std::decay_t<decltype(u)>;
                       using std::sqrt;
                       return Vector3Of<S>{u, S(0.0), -sqrt(1.0 - u) * (1.0 - u) * (1.0 - u)};
                   })),
                   {.parameter = 0.0, .speed = 1.0}, "slider");
        for (const char* engine : {"taylor", "dop853"}) {
            const Attempt run = attempt(beyond, {.until = 5.0, .rtol = 1e-8, .engine = engine});
            EXPECT_EQ(run.run.status(), Status::not_finite) << engine;
            EXPECT_NE(run.message.find("slider"), std::string::npos) << run.message;
            EXPECT_NE(run.message.find("curve"), std::string::npos) << run.message;
            EXPECT_NEAR(run.run[first].parameter(run.run.end()), 1.0, 0.1) << engine;
        }
    } catch (const InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find("curve"), std::string::npos) << e.what();
    }
}

// --- engines ---

TEST(CalledBack, functions_run_with_every_engine_that_needs_no_series_and_the_other_says_so) {
    const Scene scene =
        swinging(called_back("spring", [](double, const Vector3& r, const Vector3&) -> Vector3 { return -r; }));
    for (const std::string& engine : simulating::engines()) {
        const SimulateOptions options{.until = 3.0, .error = 1e-8, .engine = engine};
        if (engine != "taylor") {
            EXPECT_NEAR(simulate(scene, options)[first].position(3.0).x(), std::cos(3.0), 2e-8) << engine;
            continue;
        }
        try {
            (void)simulate(scene, options);
            FAIL() << engine;
        } catch (const InvalidInput& e) {
            EXPECT_NE(std::string(e.what()).find(engine), std::string::npos) << e.what();
            EXPECT_NE(std::string(e.what()).find("dop853"), std::string::npos) << e.what();
        }
    }
    EXPECT_EQ(simulate(scene, {.until = 3.0}).engine(), "dop853");
}

// --- bends ---

TEST(FrictionalBends, of_every_kind_slow_a_bead_by_the_angle_they_turn_alone) {
    // without gravity v = v0 exp(-mu angle)
    const double mu = 0.3, v0 = 2.0;
    Spline spline;
    for (int k = 0; k <= 12; ++k) spline.points.push_back({std::cos(0.4 * k), std::sin(0.4 * k), 0.0});
    struct Case {
        Curve curve;
        double start, end;
    };
    const std::vector<Case> cases{{Parabola{.a = 0.75, .x = {1, 0, 0}, .y = {0, 1, 0}}, -1.0, 2.0},
                                  {Cycloid{.radius = 0.5, .x = {1, 0, 0}, .y = {0, 0, 1}}, -2.0, 2.5},
                                  {spline, 0.5, 11.5},
                                  {Curve([](const auto& u) {
                                       using S = std::decay_t<decltype(u)>;
                                       using std::exp;
                                       return Vector3Of<S>{u, S(0.0), exp(u)};
                                   }),
                                   -3.0, 1.0}};
    for (const Case& c : cases) {
        Scene scene;
        const BodyHandle bead =
            scene.add(Particle{0.5}, Rail(c.curve, Coulomb{mu}), {.parameter = c.start, .speed = v0});
        scene.watch("end", [=, end = c.end](const Now& now) { return now[bead].parameter() - end; },
                    {.action = {WatchAction::Kind::stop}});
        const Trajectory run = simulate(scene, {.until = 100.0, .error = 1e-11});
        ASSERT_EQ(run.status(), Status::stopped_by_event) << c.curve.name();
        // the angle turned, summed over small parts in which it is less than a half turn
        double angle = 0.0;
        for (int k = 0; k < 1000; ++k) {
            const double a = c.start + (c.end - c.start) * k / 1000.0,
                         b = c.start + (c.end - c.start) * (k + 1) / 1000.0;
            const Vector3 s = c.curve.frenet(a).tangent, t = c.curve.frenet(b).tangent;
            angle += std::atan2(s.cross(t).norm(), s.dot(t));
        }
        EXPECT_NEAR(run[bead].speed(run.end(), Side::before), v0 * std::exp(-mu * angle), 5e-11 * v0) << c.curve.name();
    }
}

/// A track with jumps of the curvature: straight, a bend, straight.
Curve track() {
    return Spline{.points = {{0, 0, 1}, {1, 0, 0.5}, {2, 0, 0.2}, {3, 0, 0.4}, {4, 0, 1.2}, {5, 0, 2.5}},
                  .slopes = {{1, {1, 0, -0.5}}, {2, {1, 0, 0.1}}, {3, {1, 0, 0.2}}}};
}

TEST(CurvatureJumps, keep_the_energy_by_Taylor) {
    Scene scene(down);
    scene.add(Particle{0.5}, Rail(track()), {.parameter = 0.5, .speed = 0.0});
    const Trajectory run = simulate(scene, {.until = 30.0, .error = 1e-12});
    EXPECT_EQ(run.status(), Status::reached_end);
    // a motion to 1e-12 has its energy to that, and better: 1.1e-13 here
    EXPECT_LE(run.drift().at("energy"), 2e-13);
}

TEST(CurvatureJumps, keep_the_order_of_the_method) {
    Scene scene(down);
    const BodyHandle bead = scene.add(Particle{0.5}, Rail(track()), {.parameter = 0.5, .speed = 0.0});
    const double until = 10.0;
    const double exact = simulate(scene, {.until = until, .error = 1e-12})[bead].parameter(until);
    // with the order kept the work grows by 10^(1/8) a digit; a jump inside the steps would show as order one
    std::vector<double> errors, work;
    for (double rtol : {1e-6, 1e-8, 1e-10, 1e-12}) {
        const Trajectory run = simulate(scene, {.until = until, .rtol = rtol, .engine = "dop853"});
        errors.push_back(std::max(std::abs(run[bead].parameter(until) - exact), 1e-14));
        work.push_back(static_cast<double>(run.statistics().right_hand_sides));
        EXPECT_LE(errors.back(), 1e3 * rtol) << rtol;
    }
    const double order = std::log(errors[0] / errors[3]) / std::log(work[3] / work[0]);
    EXPECT_GE(order, 5.5) << errors[0] << ' ' << errors[3] << ' ' << work[0] << ' ' << work[3];
}

// --- models of the user's own ---

struct Pendulum {
    double g = 9.8125;
    int variables() const { return 2; }
    int positions() const { return 1; }
    template <class S>
    void operator()(const S&, std::span<const S> x, std::span<S> rate) const {
        rate[0] = x[1];
        rate[1] = -g * sin(x[0]);
    }
    template <class S>
    std::vector<std::pair<std::string, S>> watched(const S&, std::span<const S> x) const {
        return {{"bottom", x[0]}, {"turn", x[1]}};
    }
};

TEST(OwnModels, converge_to_the_period_of_the_pendulum_as_asked) {
    // from a quarter turn: the complete elliptic integral K(sin 45 deg) = 1.8540746773013719
    const double period = 4.0 * 1.8540746773013719184 / std::sqrt(9.8125);
    for (double error : {1e-6, 1e-9, 1e-12})
        for (const std::string& engine : simulating::engines()) {
            if (engine.starts_with("cvode") && error < 1e-9) continue;
            const StateRun run =
                simulate(Pendulum{}, {pi / 2.0, 0.0}, {.until = 10.5 * period, .error = error, .engine = engine});
            EXPECT_EQ(run.status(), Status::reached_end);
            ASSERT_TRUE(run.error().has_value());
            EXPECT_LE(*run.error(), error);
            ASSERT_EQ(run.events().size(), 42u) << engine;
            for (std::size_t k = 0; k < 41; ++k) {
                EXPECT_EQ(run.events()[k].name, k % 2 == 0 ? "bottom" : "turn");
                const double expected = 0.25 * period * static_cast<double>(k + 1);
                EXPECT_NEAR(run.events()[k].time, expected, error * expected + 1e-15 * expected) << engine << ' ' << k;
            }
            EXPECT_EQ(run.events()[0].direction, Direction::falling);
            EXPECT_NEAR(run.state(10.0 * period)[0], pi / 2.0, error * pi + 1e-14);
        }
}

/// x' = -sign(x) by cases, or by |x|: x' = 1 - |x - 1|.
struct Switched {
    int variables() const { return 1; }
    template <class S>
    void operator()(const S& t, std::span<const S> x, std::span<S> rate) const {
        rate[0] = where(t > 0.75, S(-2.0), S(1.0)) + 0.0 * x[0] + floor(t) * 0.5;
    }
};
struct Corner {
    int variables() const { return 1; }
    template <class S>
    void operator()(const S&, std::span<const S> x, std::span<S> rate) const {
        rate[0] = 2.0 - abs(x[0]);
    }
};

TEST(OwnModels, with_cases_switch_at_located_events) {
    const StateRun run = simulate(Switched{}, {0.0}, {.until = 2.5, .error = 1e-12});
    ASSERT_EQ(run.events().size(), 3u);
    EXPECT_EQ(run.events()[0].time, 0.75);
    EXPECT_EQ(run.events()[1].time, 1.0);
    EXPECT_EQ(run.events()[2].time, 2.0);
    // 0.75 - 2 (1.75) + 0.5 (1) + 1.0 (0.5)
    EXPECT_NEAR(run.state(2.5)[0], 0.75 - 3.5 + 0.5 + 0.5, 1e-14);
    // x' = 2 + x to zero: x = -2 + e^t from -1; then x = 2 (1 - e^-(t - log 2))
    const StateRun corner = simulate(Corner{}, {-1.0}, {.until = 3.0, .error = 1e-12});
    ASSERT_EQ(corner.events().size(), 1u);
    EXPECT_NEAR(corner.events()[0].time, std::log(2.0), 4e-16 * 4.0);
    EXPECT_NEAR(corner.state(3.0)[0], 2.0 - 2.0 * std::exp(std::log(2.0) - 3.0), 1e-13);
}

/// Blows up: x' = x^2 from 1 at t = 1.
struct BlowUp {
    int variables() const { return 1; }
    template <class S>
    void operator()(const S&, std::span<const S> x, std::span<S> rate) const {
        rate[0] = x[0] * x[0];
    }
};

TEST(OwnModels, that_blow_up_end_with_a_status_and_keep_what_there_is) {
    try {
        (void)simulate(BlowUp{}, {1.0}, {.until = 2.0, .error = 1e-9, .max_steps = 100000});
        FAIL();
    } catch (const ModelError& e) {
        EXPECT_NEAR(e.run.end(), 1.0, 1e-3);
        EXPECT_NEAR(e.run.state(0.5)[0], 2.0, 1e-7);
    }
    EXPECT_NEAR(simulate(BlowUp{}, {1.0}, {.until = 0.875, .error = 1e-11}).state(0.875)[0], 8.0, 1e-9);
}

TEST(Options, with_an_error_beside_a_local_tolerance_are_refused) {
    EXPECT_THROW((void)simulate(Pendulum{}, {1.0, 0.0}, {.until = 1.0, .error = 1e-8, .rtol = 1e-8}), InvalidInput);
    EXPECT_THROW((void)simulate(Scene(), {.until = 1.0, .error = 1e-8, .rtol = 1e-8}), InvalidInput);
}

TEST(OwnModels, with_input_that_breaks_a_rule_are_refused) {
    EXPECT_THROW((void)simulate(Pendulum{}, {1.0}, {.until = 1.0}), InvalidInput);
    EXPECT_THROW((void)simulate(Pendulum{}, {1.0, 0.0}, {.until = -1.0}), InvalidInput);
    EXPECT_THROW((void)simulate(Pendulum{}, {1.0, 0.0}, {.until = 1.0, .engine = "euler"}), InvalidInput);
    EXPECT_THROW((void)simulate(Pendulum{}, {nan, 0.0}, {.until = 1.0}), Error);
}

TEST(OwnModels, without_motion_stay_where_they_are) {
    struct Still {
        int variables() const { return 2; }
        void operator()(const Expression&, std::span<const Expression>, std::span<Expression> rate) const {
            rate[0] = rate[1] = 0.0;
        }
    };
    const StateRun run = simulate(Still{}, {0.25, -3.0}, {.until = 1e6});
    EXPECT_EQ(run.state(1e6), (std::vector<double>{0.25, -3.0}));
}

}  // namespace
}  // namespace rbdyn::test::test_own_functions
