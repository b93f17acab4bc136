// Sliding along surfaces at which the user's own right-hand side jumps: entry, motion along them, and leaving.
#include <gtest/gtest.h>

#include <numbers>

#include "rbdyn/integrate.hpp"
#include "rbdyn/own_motion.hpp"
#include "support.hpp"

namespace rbdyn::test::test_sliding {
namespace {

using Real = long double;
constexpr double pi = std::numbers::pi;

/// x' = f(t, x) from a generic lambda (t, x, rate).
template <class F>
struct Model {
    int size;
    F f;
    int variables() const { return size; }
    template <class S>
    void operator()(const S& t, std::span<const S> x, std::span<S> rate) const {
        f(t, x, rate);
    }
};
template <class F>
Model<F> model(int size, F f) {
    return {size, f};
}

/// Status of a run that may have gone wrong, and its events.
template <class M>
std::pair<Status, std::size_t> outcome(const M& m, const std::vector<double>& x, const SimulateOptions& options) {
    try {
        const StateRun run = simulate(m, x, options);
        return {run.status(), run.events().size()};
    } catch (const ModelError& error) {
        return {error.run.status(), error.run.events().size()};
    }
}

const auto relay = model(1, [](const auto&, const auto& x, auto rate) { rate[0] = -locked_sign(x[0], "relay"); });

// --- entering ---

TEST(Sliding, a_relay_comes_to_zero_and_stays_exactly_there_with_every_engine) {
    for (const std::string& engine : simulating::engines()) {
        const StateRun run = simulate(relay, {1.0}, {.until = 100.0, .engine = engine});
        ASSERT_EQ(run.events().size(), 1u) << engine;
        EXPECT_NEAR(run.events()[0].time, 1.0, 4.0 * epsilon);
        EXPECT_EQ(run.events()[0].kind, EventKind::switching);
        EXPECT_EQ(run.events()[0].name, "relay");
        EXPECT_EQ(run.events()[0].direction, Direction::falling);
        for (const double t : {run.events()[0].time, 1.5, 17.0, 100.0}) EXPECT_EQ(run.state(t)[0], 0.0);
    }
}

TEST(Sliding, a_relay_that_starts_at_zero_rests_there_without_an_event) {
    const StateRun run = simulate(relay, {0.0}, {.until = 1e6});
    EXPECT_TRUE(run.events().empty());
    EXPECT_EQ(run.state(1e6)[0], 0.0);
}

TEST(Sliding, what_one_field_pushes_to_the_surface_and_the_other_away_from_it_crosses) {
    const auto crossing = model(1, [](const auto&, const auto& x, auto rate) { rate[0] = -3.0 - locked_sign(x[0]); });
    const StateRun run = simulate(crossing, {1.0}, {.until = 1.0});
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_NEAR(run.events()[0].time, 0.25, 4.0 * epsilon);
    EXPECT_NEAR(run.state(1.0)[0], -1.5, 8.0 * epsilon);
}

// --- the motion along the surface ---

TEST(Sliding, along_a_plane_between_two_constant_fields_has_filippovs_velocity) {
    // g = y - x / 3; f+ = (2, -1), f- = (-1, 3): g'+ = -5/3, g'- = 10/3, so a = 2/3 and x' = (1, 1/3)
    const auto fields = model(2, [](const auto&, const auto& x, auto rate) {
        const auto g = x[1] - x[0] / 3.0;
        rate[0] = where(g > 0.0, 0.0 * g + 2.0, 0.0 * g - 1.0);
        rate[1] = where(g > 0.0, 0.0 * g - 1.0, 0.0 * g + 3.0);
    });
    for (const std::string& engine : simulating::engines()) {
        const StateRun run = simulate(fields, {0.0, 1.0}, {.until = 1000.0, .engine = engine});
        ASSERT_EQ(run.events().size(), 1u) << engine;
        EXPECT_NEAR(run.events()[0].time, 0.6, 8.0 * epsilon);
        const std::vector<double> x = run.state(1000.0);
        EXPECT_NEAR(x[0], 1.2 + 999.4, 1e-9 * 1000.0);
        EXPECT_NEAR(x[1], 0.4 + 999.4 / 3.0, 1e-9 * 1000.0);
        // it leaves the surface by rounding alone
        EXPECT_LE(std::abs(x[1] - x[0] / 3.0), 8.0 * epsilon * 1000.0) << engine;
    }
}

TEST(Sliding, along_a_circle_stays_on_it_for_a_thousand_turns) {
    // in polar coordinates r' = -+1 on the two sides of r = 1, the angle grows by 1 outside and by 3 inside: by 2 on it
    const auto circle = model(2, [](const auto&, const auto& x, auto rate) {
        const auto r = sqrt(x[0] * x[0] + x[1] * x[1]);
        const auto outside = locked_sign(x[0] * x[0] + x[1] * x[1] - 1.0, "circle");
        const auto turn = 2.0 - outside;
        rate[0] = -outside * x[0] / r - turn * x[1];
        rate[1] = -outside * x[1] / r + turn * x[0];
    });
    const double turns = 1000.0 * pi;
    for (const double error : {1e-9, 1e-11}) {
        const StateRun run = simulate(circle, {1.5, 0.0}, {.until = 0.5 + turns, .error = error});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_NEAR(run.events()[0].time, 0.5, 1e-13);
        const std::vector<double> x = run.state(0.5 + turns);
        EXPECT_NEAR(x[0], std::cos(0.5), error);
        EXPECT_NEAR(x[1], std::sin(0.5), error);
        // nothing holds it there but the rates: it leaves the surface by their error
        EXPECT_NEAR(std::hypot(x[0], x[1]), 1.0, 0.1 * error);
    }
}

// --- leaving ---

TEST(Sliding, ends_where_one_of_two_fields_turns_away_and_does_so_along_the_surface) {
    // above y = 0 down by 1; below up by 1 - x, which is away from x = 1 on; x' = 1
    const auto fields = model(2, [](const auto&, const auto& x, auto rate) {
        rate[0] = 1.0 + 0.0 * x[0];
        rate[1] = where(x[1] > 0.0, 0.0 * x[0] - 1.0, 1.0 - x[0]);
    });
    for (const std::string& engine : simulating::engines()) {
        const StateRun run = simulate(fields, {-2.0, 1.0}, {.until = 5.0, .engine = engine});
        ASSERT_EQ(run.events().size(), 2u) << engine;
        EXPECT_NEAR(run.events()[0].time, 1.0, 1e-9);
        EXPECT_NEAR(run.events()[1].time, 3.0, 1e-9);
        EXPECT_EQ(run.events()[1].kind, EventKind::switching);
        EXPECT_EQ(run.events()[1].name, "where");
        EXPECT_EQ(run.events()[1].direction, Direction::falling);
        EXPECT_EQ(run.state(2.0)[1], 0.0);
        EXPECT_EQ(run.state(3.0)[1], 0.0);
        EXPECT_NEAR(run.state(5.0)[1], -2.0, 1e-8);
    }
}

TEST(Sliding, begins_and_ends_when_fields_that_depend_on_time_say) {
    // up by 1 below zero; t - 2 above it, which is away from t = 2 on
    const auto fields =
        model(1, [](const auto& t, const auto& x, auto rate) { rate[0] = where(x[0] > 0.0, t - 2.0, 0.0 * t + 1.0); });
    const StateRun run = simulate(fields, {-0.5}, {.until = 4.0});
    ASSERT_EQ(run.events().size(), 2u);
    EXPECT_NEAR(run.events()[0].time, 0.5, 4.0 * epsilon);
    EXPECT_NEAR(run.events()[1].time, 2.0, 4.0 * epsilon);
    EXPECT_EQ(run.events()[0].direction, Direction::rising);
    EXPECT_EQ(run.events()[1].direction, Direction::rising);
    EXPECT_EQ(run.state(1.25)[0], 0.0);
    EXPECT_NEAR(run.state(4.0)[0], 2.0, 16.0 * epsilon);
    // begun on the surface, it slides without a word
    const StateRun begun = simulate(fields, {0.0}, {.until = 4.0, .start = 1.0});
    ASSERT_EQ(begun.events().size(), 1u);
    EXPECT_NEAR(begun.events()[0].time, 2.0, 4.0 * epsilon);
    // and where it starts as it would leave, it leaves
    const StateRun late = simulate(fields, {0.0}, {.until = 4.0, .start = 2.0});
    EXPECT_TRUE(late.events().empty());
    EXPECT_NEAR(late.state(4.0)[0], 2.0, 16.0 * epsilon);
}

// --- a block held by its own friction, -F sign(v), pushed by A sin(w t) ---

struct Push {
    double force, push, frequency, mass = 1.0;

    /// m v' = A sin(w t) - F sign(v), x' = v.
    auto own() const {
        return model(2, [p = *this](const auto& t, const auto& x, auto rate) {
            rate[0] = x[1];
            rate[1] = (p.push * sin(p.frequency * t) - p.force * locked_sign(x[1], "slip")) / p.mass;
        });
    }
    /// When it slips for the first time, A sin(w t) = F, and when it stops again.
    Real slips() const { return std::asin(Real(force) / push) / frequency; }
    Real sticks() const {
        const Real w = frequency, t0 = slips();
        Real lo = std::acos(-1.0L) / w - t0, hi = 2.0L * std::acos(-1.0L) / w;
        for (int i = 0; i < 80; ++i) {
            const Real t = 0.5L * (lo + hi);
            const Real v = push / w * (std::cos(w * t0) - std::cos(w * t)) - force * (t - t0);
            (v > 0.0L ? lo : hi) = t;
        }
        return lo;
    }
};

TEST(Sliding, a_block_pushed_against_its_own_friction_slips_and_sticks_at_the_times_of_the_closed_form) {
    const Push p{.force = 3.0, .push = 4.0, .frequency = 2.0};
    for (const std::string& engine : simulating::engines()) {
        const StateRun run =
            simulate(p.own(), {0.0, 0.0}, {.until = 10.0 * pi / p.frequency, .error = 1e-10, .engine = engine});
        ASSERT_EQ(run.events().size(), 20u) << engine;
        const double bound = engine == "taylor" ? 1e-13 : 1e-9;
        for (std::size_t k = 0; k < 10; ++k) {
            const Real half = std::acos(-1.0L) / p.frequency * static_cast<Real>(k);
            const Event &slip = run.events()[2 * k], &stick = run.events()[2 * k + 1];
            EXPECT_NEAR(slip.time, static_cast<double>(half + p.slips()), bound * slip.time);
            EXPECT_NEAR(stick.time, static_cast<double>(half + p.sticks()), bound * stick.time);
            EXPECT_EQ(slip.direction, k % 2 == 0 ? Direction::rising : Direction::falling);
            EXPECT_EQ(run.state(stick.time)[1], 0.0);
            EXPECT_EQ(run.state(stick.time + 0.01)[1], 0.0);
            EXPECT_EQ(run.state(stick.time + 0.01)[0], run.state(stick.time)[0]);
        }
    }
}

TEST(Sliding, every_engine_sees_the_same_holds) {
    const Push p{.force = 3.0, .push = 4.0, .frequency = 2.0};
    const StateRun exact = simulate(p.own(), {0.0, 0.5}, {.until = 20.0, .error = 1e-13});
    ASSERT_GE(exact.events().size(), 20u);
    for (const std::string& engine : simulating::engines()) {
        const StateRun run = simulate(p.own(), {0.0, 0.5}, {.until = 20.0, .error = 1e-8, .engine = engine});
        ASSERT_EQ(run.events().size(), exact.events().size()) << engine;
        for (std::size_t k = 0; k < run.events().size(); ++k)
            EXPECT_NEAR(run.events()[k].time, exact.events()[k].time, 1e-8 * exact.events()[k].time) << engine;
        EXPECT_NEAR(run.state(20.0)[0], exact.state(20.0)[0], 1e-8);
    }
}

TEST(Sliding, a_thousand_holds_are_two_thousand_events) {
    const Push p{.force = 3.0, .push = 4.0, .frequency = 2.0};
    const StateRun run = simulate(p.own(), {0.0, 0.0}, {.until = 1000.0 * pi / p.frequency});
    ASSERT_EQ(run.events().size(), 2000u);
    for (std::size_t k = 0; k < 1000; ++k) {
        const Real half = std::acos(-1.0L) / p.frequency * static_cast<Real>(k);
        const double slip = static_cast<double>(half + p.slips()), stick = static_cast<double>(half + p.sticks());
        EXPECT_NEAR(run.events()[2 * k].time, slip, 1e-13 * slip);
        EXPECT_NEAR(run.events()[2 * k + 1].time, stick, 1e-13 * stick);
    }
}

TEST(Sliding, friction_written_as_a_force_is_coulombs_on_a_level_rail) {
    const double mass = 2.0, mu = 0.25, load = mass * gravity * mu;
    const auto push = [](const auto& t) { return 7.0 * sin(1.5 * t) + 2.0 * cos(0.4 * t); };
    Scene coulomb(down), own(down);
    const BodyHandle a = coulomb.add(Particle{mass}, Rail(along_x, Coulomb{mu, mu}), {.parameter = 0.0, .speed = 1.0});
    coulomb.apply(Force([&](const auto& t, const auto&, const auto&) {
                      return Vector3Of<Expression>{push(t), 0.0, 0.0};
                  }),
                  a);
    const BodyHandle b = own.add(Particle{mass}, Rail(along_x), {.parameter = 0.0, .speed = 1.0});
    own.apply(Force([&](const auto& t, const auto&, const auto& v) {
                  return Vector3Of<Expression>{push(t) - load * locked_sign(v[0], "slip"), 0.0, 0.0};
              }),
              b);
    const Trajectory first = simulate(coulomb, {.until = 60.0, .error = 1e-12});
    const Trajectory second = simulate(own, {.until = 60.0, .error = 1e-12});
    ASSERT_EQ(first.events().size(), second.events().size());
    ASSERT_GE(first.events().times("stick").size(), 5u);
    for (std::size_t k = 0; k < first.events().size(); ++k) {
        const Event &e = first.events()[k], &f = second.events()[k];
        EXPECT_NEAR(e.time, f.time, 1e-12 * e.time);
        EXPECT_EQ(f.kind, EventKind::switching);
        if (e.kind != EventKind::stick) continue;
        // held: what acts on it is balanced, and it does not move
        EXPECT_EQ(second[b].speed(f.time), 0.0);
        EXPECT_LE(second[b].acceleration(f.time).norm(), 8.0 * epsilon * 9.0);
        EXPECT_NEAR(second[b].report(f.time, Side::after).force[0], 0.0, 8.0 * epsilon * 9.0);
    }
    const double extent = scales(first, a).extent;
    for (double t = 0.0; t <= 60.0; t += 0.25)
        EXPECT_NEAR(first[a].position(t)[0], second[b].position(t)[0], 1e-12 * extent);
}

TEST(Sliding, a_free_body_under_friction_of_its_own_stands_still_for_ever) {
    Scene scene(Vector3(0.0, 0.0, 0.0));
    const BodyHandle body = scene.add(Particle{0.5}, {.position = {0, 0, 1}, .velocity = {3.0, 0.0, 0.0}});
    scene.apply(Force([](const auto&, const auto&, const auto& v) {
                    return Vector3Of<Expression>{-2.0 * locked_sign(v[0], "friction"), 0.0, 0.0};
                }),
                body);
    const Trajectory run = simulate(scene, {.until = 1e6});
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_NEAR(run.events()[0].time, 0.75, 4.0 * epsilon);
    const Vector3 there = run[body].position(run.events()[0].time);
    for (const double t : {0.8, 1e3, 1e6}) {
        EXPECT_EQ(run[body].velocity(t)[0], 0.0);
        EXPECT_EQ(run[body].position(t)[0], there[0]);
        EXPECT_EQ(run[body].acceleration(t)[0], 0.0);
    }
}

// --- several switches ---

TEST(Sliding, distinctions_that_lie_on_one_surface_slide_as_one) {
    // a dead zone of no width, as users write it: -1 above, +1 below, nothing at zero; and a sign of its own beside it
    const auto friction = model(1, [](const auto& t, const auto& x, auto rate) {
        const auto dry = where(x[0] > 0.0, 0.0 * x[0] - 1.0, where(x[0] < 0.0, 0.0 * x[0] + 1.0, 0.0 * x[0]));
        rate[0] = dry - 0.5 * locked_sign(2.0 * x[0], "relay") + t;
    });
    // from 1: x = 1 - 1.5 t + t^2 / 2 comes to zero at t = 1; it is held until the push is 1.5
    const StateRun run = simulate(friction, {1.0}, {.until = 3.5});
    EXPECT_EQ(run.status(), Status::reached_end);
    ASSERT_GE(run.events().size(), 2u);
    EXPECT_LE(run.events().size(), 4u);
    EXPECT_NEAR(run.events()[0].time, 1.0, 8.0 * epsilon);
    EXPECT_NEAR(run.events()[run.events().size() - 1].time, 1.5, 8.0 * epsilon);
    EXPECT_EQ(run.state(1.25)[0], 0.0);
    EXPECT_NEAR(run.state(3.5)[0], 2.0, 1e-14);
}

TEST(Sliding, two_surfaces_at_once_hold_both_variables) {
    const auto relays = model(2, [](const auto&, const auto& x, auto rate) {
        const auto a = locked_sign(x[0], "a"), b = locked_sign(x[1], "b");
        rate[0] = -a - 0.5 * b;
        rate[1] = -b + 0.5 * a;
    });
    // x = 1 - 1.5 t, y = 0.25 - 0.5 t: y is met first, at 1/2, with x = 1/4; then b = 1/2 and x' = -5/4
    const StateRun run = simulate(relays, {1.0, 0.25}, {.until = 50.0});
    ASSERT_EQ(run.events().size(), 2u);
    EXPECT_EQ(run.events()[0].name, "b");
    EXPECT_NEAR(run.events()[0].time, 0.5, 4.0 * epsilon);
    EXPECT_EQ(run.events()[1].name, "a");
    EXPECT_NEAR(run.events()[1].time, 0.7, 4.0 * epsilon);
    EXPECT_EQ(run.state(50.0)[0], 0.0);
    EXPECT_EQ(run.state(50.0)[1], 0.0);
    // from both surfaces at once too
    EXPECT_TRUE(simulate(relays, {0.0, 0.0}, {.until = 50.0}).events().empty());
}

TEST(Sliding, ends_on_one_surface_where_the_other_makes_it) {
    // b holds y against 0.75 from either side of a, x = 1; from x = 1/2 on a push of 1 is added and it gives way
    const auto fields = model(3, [](const auto&, const auto& x, auto rate) {
        rate[0] = 0.0 * x[1] - 1.0;
        rate[1] =
            0.75 * locked_sign(x[0] - 1.0, "a") - locked_sign(x[1], "b") - where(x[0] > 0.5, 0.0, 1.0 + 0.0 * x[0]);
        rate[2] = 0.0 * x[0];
    });
    const StateRun run = simulate(fields, {2.0, 0.0, 0.0}, {.until = 3.0});
    EXPECT_EQ(run.status(), Status::reached_end);
    // a; then the choice and with it b
    ASSERT_EQ(run.events().size(), 2u);
    EXPECT_EQ(run.events()[0].name, "a");
    EXPECT_NEAR(run.events()[0].time, 1.0, 4.0 * epsilon);
    EXPECT_EQ(run.events()[1].name, "where");
    EXPECT_NEAR(run.events()[1].time, 1.5, 4.0 * epsilon);
    EXPECT_EQ(run.state(1.25)[1], 0.0);
    EXPECT_NEAR(run.state(3.0)[1], -0.75 * 1.5, 16.0 * epsilon);
}

TEST(Sliding, surfaces_whose_switches_do_not_add_up_have_no_motion_along_both) {
    const auto product = model(2, [](const auto&, const auto& x, auto rate) {
        const auto a = locked_sign(x[0]), b = locked_sign(x[1]);
        rate[0] = -a * (2.0 + 0.5 * b);
        rate[1] = -b * (2.0 + 0.5 * a) + 0.25 * a * b;
    });
    const auto [status, events] = outcome(product, {1.0, 0.5}, {.until = 10.0});
    EXPECT_EQ(status, Status::inconsistent);
    EXPECT_LE(events, 500u);
}

TEST(Sliding, two_bodies_with_friction_of_their_own_stop_one_after_the_other) {
    Scene scene(Vector3(0.0, 0.0, 0.0));
    std::vector<BodyHandle> bodies;
    for (const double speed : {1.0, 2.0, 3.0}) {
        bodies.push_back(scene.add(Particle{1.0}, {.position = {0, speed, 0}, .velocity = {speed, 0.0, 0.0}}));
        scene.apply(Force([](const auto&, const auto&, const auto& v) {
                        return Vector3Of<Expression>{-0.5 * locked_sign(v[0], "friction"), 0.0, 0.0};
                    }),
                    bodies.back());
    }
    const Trajectory run = simulate(scene, {.until = 100.0});
    ASSERT_EQ(run.events().size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(run.events()[k].time, 2.0 * static_cast<double>(k + 1), 16.0 * epsilon);
        EXPECT_EQ(run[bodies[k]].velocity(100.0)[0], 0.0);
        EXPECT_NEAR(run[bodies[k]].position(100.0)[0], static_cast<double>((k + 1) * (k + 1)), 1e-13);
    }
}

// --- beside other guards ---

struct Watched {
    int variables() const { return 2; }
    template <class S>
    void operator()(const S& t, std::span<const S> x, std::span<S> rate) const {
        rate[0] = -locked_sign(x[0], "relay") + 0.5 * abs(x[1]) + 0.0 * t;
        rate[1] = 0.0 * t - 1.0;
    }
    template <class S>
    std::vector<std::pair<std::string, S>> watched(const S& t, std::span<const S> x) const {
        return {{"height", x[1] - 0.25}, {"clock", t - 1.75}};
    }
};

TEST(Sliding, other_switches_and_watched_functions_go_on_meanwhile) {
    // held from 0 on, since |y| / 2 < 1 for y from 1 to -2; then let go
    const StateRun run = simulate(Watched{}, {0.0, 1.0}, {.until = 4.0});
    std::vector<std::string> names;
    std::vector<double> times;
    for (const Event& e : run.events()) {
        names.push_back(e.name);
        times.push_back(e.time);
    }
    EXPECT_EQ(names, (std::vector<std::string>{"height", "abs", "clock", "relay"}));
    const std::vector<double> expected{0.75, 1.0, 1.75, 3.0};
    ASSERT_EQ(times.size(), expected.size());
    for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], expected[k], 8.0 * epsilon);
    EXPECT_EQ(run.state(2.0)[0], 0.0);
    EXPECT_NEAR(run.state(4.0)[0], 0.25, 16.0 * epsilon);
}

TEST(Sliding, a_watched_reaction_is_that_of_the_force_between_both_sides) {
    // a bead held on a line by friction of its own that also presses it sideways: the push along x grows with time,
    // and so does what acts along y
    Scene scene(Vector3(0.0, 0.0, 0.0));
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x), {.parameter = 0.0, .speed = 0.0});
    scene.apply(Force([](const auto& t, const auto&, const auto& v) {
                    const auto s = locked_sign(v[0], "grip");
                    return Vector3Of<Expression>{t - 4.0 * s, 8.0 * s, 0.0};
                }),
                bead);
    // held: s = t / 4, so that the rail carries -2 t along y
    scene.watch("load", [=](const Now& now) { return now[bead].reaction()[1] + 3.0; });
    const Trajectory run = simulate(scene, {.until = 3.0});
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_EQ(run.events()[0].name, "load");
    EXPECT_NEAR(run.events()[0].time, 1.5, 8.0 * epsilon);
    EXPECT_NEAR(run[bead].reaction(2.0)[1], -4.0, 32.0 * epsilon);
    EXPECT_EQ(run[bead].acceleration(2.0).norm(), 0.0);
}

// --- units ---

TEST(Sliding, other_units_by_powers_of_two_change_no_digit) {
    const auto in_units = [](double metre, double second) {
        const double force = 3.0 * metre / (second * second), push = 4.0 * metre / (second * second),
                     frequency = 2.0 / second;
        return Push{force, push, frequency};
    };
    const StateRun base = simulate(in_units(1.0, 1.0).own(), {0.0, 0.5}, {.until = 20.0});
    ASSERT_GE(base.events().size(), 10u);
    for (const auto& [metre, second] : {std::pair{0x1p20, 1.0}, {1.0, 0x1p-12}, {0x1p-33, 0x1p7}}) {
        const StateRun other =
            simulate(in_units(metre, second).own(), {0.0, 0.5 * metre / second}, {.until = 20.0 * second});
        ASSERT_EQ(other.events().size(), base.events().size());
        for (std::size_t k = 0; k < base.events().size(); ++k)
            EXPECT_EQ(other.events()[k].time, base.events()[k].time * second);
        for (const double t : {0.1, 1.0, 7.5, 20.0}) {
            EXPECT_EQ(other.state(t * second)[0], base.state(t)[0] * metre);
            EXPECT_EQ(other.state(t * second)[1], base.state(t)[1] * metre / second);
        }
    }
}

// --- at rest, and where a motion begins ---

/// A bead on a hoop under gravity, held back by c against the horizontal part of its velocity.
Trajectory held_back(double radius, double c, double angle, double speed) {
    Scene scene(down);
    const BodyHandle bead =
        scene.add(Particle{1.25}, Rail(vertical_circle(radius)), {.parameter = angle, .speed = speed});
    scene.apply(Force([c](const auto&, const auto&, const auto& v) {
                    using S = std::decay_t<decltype(v[0])>;
                    return Vector3Of<S>{-c * locked_sign(v[0]), S(0.0), S(0.0)};
                }),
                bead);
    return attempt(scene, {.until = 3.0, .error = 1e-8}).run;
}

TEST(HeldBack, what_rests_is_known_to_rest) {
    // what rounding makes of balanced forces is no motion
    for (const double radius : {0.52, 1.05, 2.36})
        for (const double c : {0.17, 2.36})
            for (const double angle : {0.0, pi}) {
                const Trajectory run = held_back(radius, c, angle, 0.0);
                EXPECT_EQ(run.status(), Status::reached_end);
                EXPECT_TRUE(run.events().empty()) << run;
                EXPECT_LE((run[BodyHandle{0}].position(3.0) - run[BodyHandle{0}].position(0.0)).norm(), 1e-14 * radius);
            }
}

TEST(HeldBack, nothing_fires_where_a_motion_begins) {
    for (const double radius : {0.31, 1.75, 2.36})
        for (const double angle : {0.0, 0.5 * pi, -0.5 * pi, pi})
            for (const double speed : {0.0, 0.9, -2.3})
                for (const Event& e : held_back(radius, 1.56, angle, speed).events())
                    EXPECT_GT(e.time, 1e-9) << e << ' ' << radius << ' ' << angle;
}

TEST(Endings, switching_to_and_fro_without_getting_on_is_told_as_that) {
    // free for a second, then drawn to a place from both sides, 1e-26 m away: a quarter swing takes 1.4e-13 s
    Scene scene;
    const BodyHandle p = scene.add(Particle{1.0}, FreeStart{{1e-26, 0, 0}, {0, 0, 0}});
    scene.apply(Force([](const auto& t, const auto& r, const auto&) {
                    using S = std::decay_t<decltype(r[0])>;
                    return Vector3Of<S>{where(t > 1.0, where(r[0] > 0.0, S(-1.0), S(1.0)), S(0.0)), S(0.0), S(0.0)};
                }),
                p);
    try {
        (void)simulate(scene, {.until = 2.0, .rtol = 1e-10, .engine = "taylor", .max_steps = 20'000});
        FAIL();
    } catch (const IntegrationError& e) {
        EXPECT_EQ(e.run.status(), Status::inconsistent);
        EXPECT_NE(std::string(e.what()).find("goes on switching without getting on"), std::string::npos) << e.what();
        EXPECT_NEAR(e.run.end(), 1.0, 1e-9);
        EXPECT_LT(e.run.events().size(), 5000u);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_sliding
