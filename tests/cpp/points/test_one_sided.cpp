// Rails that only push, and rails that end: where a bead leaves, how it flies, where and how it lands.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "refusal.hpp"
#include "support.hpp"

namespace rbdyn::test::test_one_sided {
namespace {

using Real = long double;
constexpr Real pi = std::numbers::pi_v<Real>;

/// A circle by its angle from the highest point, growing toward x; its normal points inwards.
Circle from_the_top(double radius) { return {.radius = radius, .start = {0, 0, 1}, .toward = {1, 0, 0}}; }

struct Bead {
    Scene scene;
    BodyHandle handle;
    Bead(double g, const Curve& curve, RailSide side, RailStart start, std::optional<Coulomb> friction = std::nullopt,
         double mass = 1.0)
        : scene({0.0, 0.0, -g}), handle(scene.add(Particle{mass}, Rail(curve, friction, {.side = side}), start)) {}
    Trajectory run(double until, double error = 1e-12) const {
        return simulate(scene, {.until = until, .error = error});
    }
};

/// A zero of an increasing or decreasing function between two places.
Real zero(const std::function<Real(Real)>& f, Real lo, Real hi) {
    const bool rises = f(hi) > 0;
    for (int i = 0; i < 200; ++i) {
        const Real middle = (lo + hi) / 2;
        ((f(middle) > 0) == rises ? hi : lo) = middle;
    }
    return (lo + hi) / 2;
}

// --- leaving ---

TEST(Sphere, is_left_where_the_weight_no_longer_bends_the_path_enough) {
    // v^2 = v0^2 + 2 g R (cos start - cos there) = g R cos there
    for (double g : {9.8125, 1.625, 100.0})
        for (double radius : {1.0, 0.01, 250.0})
            for (double start : {0.0, 1e-3, 0.25, 0.7})
                for (double reduced : {0.0, 1e-4, 0.3, 0.6}) {
                    const double v0 = reduced * std::sqrt(g * radius);
                    const Real c = (2 * std::cos(Real(start)) + Real(v0) * v0 / (Real(g) * radius)) / 3;
                    if ((start == 0.0 && v0 == 0.0) || c >= std::cos(Real(start))) continue;
                    const Bead bead(g, from_the_top(radius), RailSide::minus, {.parameter = start, .speed = v0});
                    const Trajectory run = bead.run(12.0 * std::sqrt(radius / g), 1e-11);
                    ASSERT_EQ(kinds(run), "detach") << g << ' ' << radius << ' ' << start << ' ' << v0;
                    const double t = run.events()[0].time;
                    // a start close to the top is left e-fold by e-fold: what is asked for is relative to the extent
                    const Vector3 place = run[bead.handle].position(t) / radius;
                    EXPECT_NEAR(place.z(), static_cast<double>(c), 2e-10) << g << ' ' << radius << ' ' << start;
                    EXPECT_NEAR(run[bead.handle].velocity(t).squaredNorm() / (g * radius), static_cast<double>(c),
                                2e-10);
                    // the reaction vanishes there, and stays away
                    EXPECT_LE(run[bead.handle].reaction(t, Side::before).norm(), 1e-9 * g);
                    EXPECT_EQ(run[bead.handle].reaction(t).norm(), 0.0);
                    EXPECT_NEAR(run.energy(run.end()) / run.energy(0.0), 1.0, 1e-10);
                }
}

TEST(Sphere, left_to_the_other_side_is_left_at_the_same_height) {
    for (double direction : {1.0, -1.0}) {
        const Bead bead(gravity, from_the_top(2.0), RailSide::minus, {.parameter = 0.0, .speed = direction * 0.5});
        const Trajectory run = bead.run(3.0);
        ASSERT_EQ(kinds(run), "detach");
        const Vector3 place = run[bead.handle].position(run.events()[0].time);
        EXPECT_NEAR(place.z(), (4.0 + 0.25 / gravity) / 3.0, 1e-11);
        EXPECT_GT(direction * place.x(), 0.0);
    }
}

TEST(Sphere, rough_is_left_later) {
    // y = v^2/(g R): y' = 2 (sin - mu cos) + 2 mu y over the angle, left where y = cos
    for (double mu : {0.05, 0.2, 0.4})
        for (double y0 : {0.3, 0.7, 0.9}) {
            const Real m = mu, A = (4 * m * m - 2) / (1 + 4 * m * m), B = -6 * m / (1 + 4 * m * m), C = y0 - A;
            const auto y = [&](Real u) { return A * std::cos(u) + B * std::sin(u) + C * std::exp(2 * m * u); };
            // it stops before for these, or not
            bool stops = false;
            for (int k = 0; k < 1000; ++k) {
                const Real u = k * Real(1.2) / 1000;
                if (y(u) >= std::cos(u)) break;
                stops = stops || y(u) <= Real(0.01);
            }
            if (stops) continue;
            const Real angle = zero([&](Real u) { return y(u) - std::cos(u); }, 0, 1.4L);
            const double radius = 0.5;
            const Bead bead(gravity, from_the_top(radius), RailSide::minus,
                            {.parameter = 0.0, .speed = std::sqrt(y0 * gravity * radius)}, Coulomb{mu});
            const Trajectory run = bead.run(1.5);
            ASSERT_EQ(kinds(run), "detach") << mu << ' ' << y0;
            EXPECT_NEAR(run[bead.handle].parameter(run.events()[0].time), static_cast<double>(angle), 1e-11)
                << mu << ' ' << y0;
        }
}

TEST(Parabola, below_the_speed_of_free_fall_is_never_left) {
    const double a = 0.75, limit = std::sqrt(gravity / (2.0 * a));
    for (double share : {1e-3, 0.5, 0.9, 0.999, 1.0 - 1e-9}) {
        const Bead bead(gravity, Parabola{.a = a, .x = {1, 0, 0}, .y = {0, 0, -1}}, RailSide::minus,
                        {.parameter = 0.0, .speed = share * limit});
        // the reaction is the small difference of the weight and what bends the path: rounding over that
        const Trajectory run = bead.run(5.0, std::max(1e-11, 1e3 * epsilon / (1.0 - share)));
        EXPECT_TRUE(run.events().empty()) << share << ' ' << kinds(run);
    }
}

TEST(Parabola, above_the_speed_of_free_fall_is_left_at_once_and_silently) {
    const double a = 0.75, limit = std::sqrt(gravity / (2.0 * a));
    for (double share : {1.0 + 1e-9, 1.001, 1.5, 40.0}) {
        const double v = share * limit;
        const Bead bead(gravity, Parabola{.a = a, .x = {1, 0, 0}, .y = {0, 0, -1}}, RailSide::minus,
                        {.parameter = 0.0, .speed = v});
        const Trajectory run = bead.run(5.0);
        EXPECT_TRUE(run.events().empty()) << share << ' ' << kinds(run);
        for (double t : {0.0, 0.1, 2.0, 5.0}) {
            const Vector3 path(v * t, 0.0, -0.5 * gravity * t * t);
            EXPECT_LE((run[bead.handle].position(t) - path).norm(), 1e-12 * std::hypot(v * 5.0, 12.5 * gravity));
            EXPECT_EQ(run[bead.handle].reaction(t).norm(), 0.0);
            // ds/dt along a curve it has left
            EXPECT_EQ(run[bead.handle].speed(t), 0.0);
            EXPECT_NEAR(run[bead.handle].velocity(t).norm(), std::hypot(v, gravity * t),
                        1e-12 * std::hypot(v, gravity * 5.0));
        }
    }
}

TEST(Parabola, at_the_speed_of_free_fall_needs_no_rail) {
    const double a = 0.5, v = 3.0;  // g = 2 a v^2 exactly
    const Bead bead(9.0, Parabola{.a = a, .x = {1, 0, 0}, .y = {0, 0, -1}}, RailSide::minus,
                    {.parameter = 0.0, .speed = v});
    const Trajectory run = bead.run(2.0);
    EXPECT_LE(run.events().size(), 1u) << kinds(run);
    for (double t : {0.5, 2.0})
        EXPECT_LE((run[bead.handle].position(t) - Vector3(v * t, 0.0, -4.5 * t * t)).norm(), 2e-11);
}

TEST(Cycloid, as_a_hump_is_left_where_the_cosine_of_its_angle_is_the_reduced_energy) {
    for (double radius : {0.5, 2.0})
        for (double share : {0.01, 0.3, 0.9}) {
            const double v = std::sqrt(share * 4.0 * gravity * radius);
            const Bead bead(gravity, Cycloid{.radius = radius, .x = {1, 0, 0}, .y = {0, 0, -1}}, RailSide::minus,
                            {.parameter = 0.0, .speed = v});
            const Trajectory run = bead.run(3.0);
            ASSERT_FALSE(run.events().empty());
            EXPECT_EQ(run.events()[0].kind, EventKind::detach);
            EXPECT_NEAR(run[bead.handle].parameter(run.events()[0].time, Side::before), std::acos(share), 2e-11);
        }
}

// --- flying and landing ---

/// The loop of radius R entered at its lowest point with v^2 = energy g R, left at `leaves`, met again at `lands`.
struct Loop {
    Real leaves, lands, speed, flight;
    Loop(double g, double radius, double v0) {
        const Real R = radius, gR = Real(g) * R;
        leaves = std::acos((2 * gR - Real(v0) * v0) / (3 * gR));
        speed = std::sqrt(-gR * std::cos(leaves));
        // the parabola osculates the circle where it leaves it, and meets it once more; the angles from its axis add
        // up to whole turns
        lands = std::remainder(-3 * leaves, 2 * pi);
        flight = R * (std::sin(lands) - std::sin(leaves)) / (speed * std::cos(leaves));
    }
};

TEST(Loops, are_left_and_met_again_where_the_osculating_parabola_meets_them) {
    for (double radius : {1.0, 0.125, 30.0})
        for (double energy : {2.1, 2.5, 3.0, 3.5, 4.0, 4.5, 4.9}) {
            const double v0 = std::sqrt(energy * gravity * radius), mass = 0.75;
            const Bead bead(gravity, vertical_circle(radius), RailSide::plus, {.parameter = 0.0, .speed = v0},
                            std::nullopt, mass);
            const Trajectory run = bead.run(2.4 * std::sqrt(radius / gravity) + 1e-9, 1e-12);
            const Loop loop(gravity, radius, v0);
            ASSERT_GE(run.events().size(), 1u) << energy;
            const Event& left = run.events()[0];
            EXPECT_EQ(left.kind, EventKind::detach);
            EXPECT_NEAR(run[bead.handle].parameter(left.time, Side::before), static_cast<double>(loop.leaves), 1e-11);
            const Trajectory longer = bead.run(8.0 * std::sqrt(radius / gravity), 1e-12);
            ASSERT_GE(longer.events().size(), 2u) << energy;
            const Event& landed = longer.events()[1];
            EXPECT_EQ(landed.kind, EventKind::land);
            // what is asked for, relative to the time since the start
            EXPECT_NEAR(landed.time - longer.events()[0].time, static_cast<double>(loop.flight), 1e-11 * landed.time)
                << energy;
            const double there = longer[bead.handle].parameter(landed.time);
            EXPECT_NEAR(std::remainder(there - static_cast<double>(loop.lands), 2.0 * std::numbers::pi), 0.0, 2e-11)
                << energy;
            // the impulse takes the velocity across the rail and nothing else
            const Vector3 before = longer[bead.handle].velocity(landed.time, Side::before);
            const Vector3 after = longer[bead.handle].velocity(landed.time);
            const Vector3 normal = -longer[bead.handle].position(landed.time).normalized();
            const double across = -before.dot(normal);
            EXPECT_GE(across, 0.0);
            EXPECT_NEAR(landed.impulse, mass * across, 1e-11 * mass * v0);
            EXPECT_LE((after - before - across * normal).norm(), 1e-11 * v0);
            EXPECT_NEAR(after.dot(normal), 0.0, 1e-11 * v0);
            EXPECT_NEAR(longer.energy(landed.time, Side::before) - longer.energy(landed.time),
                        0.5 * landed.impulse * landed.impulse / mass, 1e-11 * mass * v0 * v0);
            EXPECT_NEAR(longer.energy(landed.time, Side::before), longer.energy(0.0), 1e-11 * mass * v0 * v0);
        }
}

TEST(Loops, with_just_enough_speed_are_gone_round_and_with_less_are_left) {
    const double radius = 1.0, g = gravity;
    for (double part : {1e-3, 1e-6, 1e-9}) {
        const Bead round(g, vertical_circle(radius), RailSide::plus,
                         {.parameter = 0.0, .speed = std::sqrt(5.0 * g * radius * (1.0 + part))});
        const Trajectory whole = round.run(6.0, 1e-10);
        EXPECT_TRUE(whole.events().empty()) << part << ' ' << kinds(whole);
        EXPECT_GT(whole[round.handle].parameter(6.0), 4.0 * std::numbers::pi);
        const double v0 = std::sqrt(5.0 * g * radius * (1.0 - part));
        const Bead less(g, vertical_circle(radius), RailSide::plus, {.parameter = 0.0, .speed = v0});
        const Loop loop(g, radius, v0);
        const Trajectory run = less.run(1.4, 1e-10);
        ASSERT_EQ(kinds(run), "detach land") << part;
        // the reaction has a slope of order sqrt(part) there
        EXPECT_NEAR(run[less.handle].parameter(run.events()[0].time, Side::before), static_cast<double>(loop.leaves),
                    1e-10 / std::sqrt(part));
    }
}

/// A rail of hills: z = h cos x.
Curve hills(double h) {
    return Curve([h](const auto& u) {
        using S = std::decay_t<decltype(u)>;
        using std::cos;
        return Vector3Of<S>{u, S(0.0), h * cos(u)};
    });
}

/// What is true of every run on a rail that only pushes, whatever its shape. Returns the number of flights.
int check_flights(const Trajectory& run, const Bead& bead, const std::function<double(const Vector3&)>& above,
                  double mass, double tolerance) {
    const Scales scale = scales(run, bead.handle);
    const double g = -bead.scene.gravity().z();
    int flights = 0;
    double energy = run.energy(run.start());
    const double size = mass * scale.speed * scale.speed;
    for (std::size_t k = 0; k < run.events().size(); ++k) {
        const Event& e = run.events()[k];
        EXPECT_NEAR(run.energy(e.time, Side::before), energy, tolerance * size) << e;
        if (e.kind == EventKind::detach) {
            ++flights;
            EXPECT_LE(run[bead.handle].reaction(e.time, Side::before).norm(), tolerance * scale.reaction) << e;
            EXPECT_LE((run[bead.handle].velocity(e.time) - run[bead.handle].velocity(e.time, Side::before)).norm(),
                      tolerance * scale.speed);
            // ballistic, and never below the rail
            const double end = k + 1 < run.events().size() ? run.events()[k + 1].time : run.end();
            const Vector3 r0 = run[bead.handle].position(e.time), v0 = run[bead.handle].velocity(e.time);
            for (int j = 0; j <= 16; ++j) {
                const double t = std::min(end, e.time + (end - e.time) * j / 16.0), s = t - e.time;
                const Vector3 r = run[bead.handle].position(t, Side::before);
                EXPECT_LE((r - (r0 + v0 * s - Vector3(0, 0, 0.5 * g * s * s))).norm(), tolerance * scale.extent);
                EXPECT_GE(above(r), -tolerance * scale.extent) << e << " at " << t;
            }
        } else {
            EXPECT_EQ(e.kind, EventKind::land) << e;
            EXPECT_NEAR(above(run[bead.handle].position(e.time)), 0.0, tolerance * scale.extent) << e;
            EXPECT_GE(e.impulse, 0.0);
            const double lost = 0.5 * e.impulse * e.impulse / mass;
            EXPECT_NEAR(run.energy(e.time), energy - lost, tolerance * size) << e;
            energy = run.energy(e.time);
            EXPECT_LE((run[bead.handle].position(e.time) - run[bead.handle].position(e.time, Side::before)).norm(),
                      tolerance * scale.extent);
        }
    }
    return flights;
}

TEST(Hills, are_left_and_met_again_many_times) {
    int flights = 0;
    for (double speed : {1.5, 3.0, 5.0, 8.0}) {
        const double h = 0.4, mass = 2.0;
        const Bead bead(gravity, hills(h), RailSide::minus, {.parameter = 0.0, .speed = speed}, std::nullopt, mass);
        const Trajectory run = bead.run(12.0, 1e-9);
        flights += check_flights(
            run, bead, [&](const Vector3& r) { return r.z() - h * std::cos(r.x()); }, mass, 1e-8);
    }
    EXPECT_GE(flights, 5);
}

TEST(Hills, as_a_spline_are_left_and_met_again) {
    const double mass = 2.0;
    Spline spline;
    for (int k = 0; k <= 60; ++k) spline.points.push_back({0.5 * k, 0.0, 0.4 * std::cos(0.5 * k)});
    const Curve curve = spline;
    const auto above = [&](const Vector3& r) {
        // x grows along it, as the parameter does
        const Real u = zero([&](Real v) { return curve.position(static_cast<double>(v)).x() - r.x(); }, 0, 60);
        return r.z() - curve.position(static_cast<double>(u)).z();
    };
    const Bead bead(gravity, curve, RailSide::minus, {.parameter = 0.0, .speed = 5.0}, std::nullopt, mass);
    const Trajectory run = bead.run(4.0, 1e-9);
    EXPECT_GE(check_flights(run, bead, above, mass, 1e-8), 1) << kinds(run);
}

TEST(Loops, a_bead_that_hops_settles_into_swinging) {
    const double radius = 1.0, mass = 0.5;
    const Bead bead(gravity, vertical_circle(radius), RailSide::plus,
                    {.parameter = 0.0, .speed = std::sqrt(4.6 * gravity * radius)}, std::nullopt, mass);
    const Trajectory run = bead.run(20.0, 1e-9);
    EXPECT_GE(check_flights(
                  run, bead, [&](const Vector3& r) { return radius - r.norm(); }, mass, 1e-8),
              1);
    EXPECT_EQ(run.status(), Status::reached_end);
}

TEST(Loops, in_other_units_have_the_same_motion_bit_by_bit) {
    const auto events = [](double length, double time, double mass) {
        const double g = gravity * length / (time * time);
        const Bead bead(g, vertical_circle(length), RailSide::plus, {.parameter = 0.0, .speed = 6.5 * length / time},
                        std::nullopt, mass);
        const Trajectory run = simulate(bead.scene, {.until = 4.0 * time, .error = 1e-10});
        std::vector<double> numbers;
        for (const Event& e : run.events()) {
            numbers.push_back(e.time / time);
            numbers.push_back(e.impulse * time / (mass * length));
        }
        for (double t : {0.3, 0.9, 1.7, 4.0}) {
            const Vector3 r = run[bead.handle].position(t * time) / length;
            numbers.insert(numbers.end(), {r.x(), r.y(), r.z()});
        }
        return numbers;
    };
    const auto expected = events(1.0, 1.0, 1.0);
    EXPECT_GE(expected.size(), 16u);
    for (int k : {-60, -30, -5, 3, 30, 60}) {
        EXPECT_EQ(events(std::ldexp(1.0, k), 1.0, 1.0), expected) << k;
        EXPECT_EQ(events(1.0, std::ldexp(1.0, k), 1.0), expected) << k;
        EXPECT_EQ(events(1.0, 1.0, std::ldexp(1.0, k)), expected) << k;
        EXPECT_EQ(events(std::ldexp(1.0, k), std::ldexp(1.0, -k), std::ldexp(1.0, k / 2)), expected) << k;
    }
}

TEST(Loops, a_change_of_state_into_itself_in_flight_or_on_the_rail_changes_nothing) {
    const double v0 = std::sqrt(3.5 * gravity);
    const auto run_with = [&](std::optional<double> at, bool in_flight) {
        Bead bead(gravity, vertical_circle(1.0), RailSide::plus, {.parameter = 0.0, .speed = v0});
        if (at) {
            WatchAction same{
                WatchAction::Kind::change, [=, handle = bead.handle](const Observe& now) {
                    const auto three = [&](Quantity q) {
                        return Vector3(now({q, handle.index, 0}), now({q, handle.index, 1}), now({q, handle.index, 2}));
                    };
                    StateChange c{.body = handle};
                    if (in_flight) {
                        c.position = three(Quantity::position);
                        c.velocity = three(Quantity::velocity);
                    } else {
                        c.parameter = now({Quantity::parameter, handle.index});
                        c.speed = now({Quantity::speed, handle.index});
                    }
                    return std::vector<StateChange>{c};
                }};
            bead.scene.watch("now", [=](const Now& now) { return now.time() - *at; }, {.action = same});
        }
        return bead.run(3.0, 1e-11);
    };
    const Trajectory plain = run_with(std::nullopt, false);
    ASSERT_GE(plain.events().size(), 2u);
    const double left = plain.events()[0].time, landed = plain.events()[1].time;
    const BodyHandle bead{0};
    for (const auto& [at, in_flight] : {std::pair{0.5 * left, false},
                                        {0.999999 * left, false},
                                        {left + 1e-6, true},
                                        {0.5 * (left + landed), true},
                                        {landed - 1e-7, true},
                                        {landed + 1e-7, false}}) {
        const Trajectory run = run_with(at, in_flight);
        ASSERT_EQ(run.events().size(), plain.events().size() + 1) << at << ' ' << kinds(run);
        for (double t : {0.4, 1.0, 2.0, 3.0})
            EXPECT_LE((run[bead].position(t) - plain[bead].position(t)).norm(), 1e-10) << at << ' ' << t;
    }
}

// --- falling onto a rail: in flight from the start, and set anew ---

/// A sphere that is left at once, and a bead put above it at a tenth of a second.
struct Drop {
    Bead bead;
    Drop(double angle, double height, std::optional<Coulomb> friction, const Vector3& velocity = Vector3::Zero())
        : bead(gravity, from_the_top(1.0), RailSide::minus, {.parameter = 0.0, .speed = 6.0}, friction) {
        const Vector3 there(std::sin(angle), 0.0, std::cos(angle) + height);
        const WatchAction put{
            WatchAction::Kind::change, [=, handle = bead.handle](const Observe&) {
                return std::vector<StateChange>{{.body = handle, .position = there, .velocity = velocity}};
            }};
        bead.scene.watch("put", [](const Now& now) { return now.time() - 0.125; }, {.action = put});
    }
};

TEST(Landing, on_top_of_a_rough_sphere_a_falling_bead_sticks) {
    const Drop drop(0.0, 0.5, Coulomb{0.3, 0.2});
    const Trajectory run = drop.bead.run(2.0);
    ASSERT_EQ(kinds(run), "watch land");
    const double fall = std::sqrt(2.0 * 0.5 / gravity);
    EXPECT_NEAR(run.events()[1].time, 0.125 + fall, 1e-12);
    EXPECT_NEAR(run.events()[1].impulse, gravity * fall, 1e-11);
    EXPECT_EQ(run[drop.bead.handle].speed(2.0), 0.0);
    EXPECT_LE((run[drop.bead.handle].position(2.0) - Vector3(0, 0, 1)).norm(), 1e-14);
    EXPECT_LE((run[drop.bead.handle].reaction(2.0) + down).norm(), 1e-13);
}

// Coulomb's law of impulses: what it has along the rail is taken, up to mu_dynamic times the impulse across it
TEST(Landing, on_a_rough_slope_a_falling_bead_is_slowed_by_the_impulse_of_friction) {
    const double angle = 0.3, v = std::sqrt(2.0 * gravity * 0.5);
    for (const double mu : {0.5, 0.1}) {
        const Drop drop(angle, 0.5, Coulomb{mu + 0.1, mu});
        const Trajectory run = drop.bead.run(2.0);
        ASSERT_GE(run.events().size(), 2u);
        EXPECT_EQ(run.events()[1].kind, EventKind::land);
        const double t = run.events()[1].time;
        EXPECT_NEAR(run[drop.bead.handle].parameter(t), angle, 1e-12);
        const double along = std::min(mu * std::cos(angle), std::sin(angle));
        EXPECT_NEAR(run[drop.bead.handle].speed(t), v * (std::sin(angle) - along), 1e-11) << mu;
        EXPECT_NEAR(run.events()[1].impulse, v * std::hypot(std::cos(angle), along), 1e-11) << mu;
    }
}

TEST(Landing, along_the_normal_of_a_slope_a_bead_sticks_or_slips_as_the_cone_says) {
    // it arrives along the normal: no velocity along the rail but rounding
    const double angle = 0.3;
    for (double mu : {0.2, 0.5}) {
        Bead bead(0.0, from_the_top(1.0), RailSide::minus, {.parameter = 0.0, .speed = 6.0}, Coulomb{mu});
        const Vector3 normal(std::sin(angle), 0.0, std::cos(angle));
        bead.scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                             using S = std::decay_t<decltype(t)>;
                             return Vector3Of<S>{S(0.0), S(0.0), where(t > 1.0, S(-gravity), S(0.0))};
                         }),
                         bead.handle);
        const WatchAction put{
            WatchAction::Kind::change, [=, handle = bead.handle](const Observe&) {
                return std::vector<StateChange>{{.body = handle, .position = 1.5 * normal, .velocity = -normal}};
            }};
        bead.scene.watch("put", [](const Now& now) { return now.time() - 0.125; }, {.action = put});
        const Trajectory run = simulate(bead.scene, {.until = 1.5, .error = 1e-10});
        const auto landings = run.events().times("land");
        ASSERT_EQ(landings.size(), 1u) << kinds(run);
        EXPECT_NEAR(landings[0], 0.625, 1e-12);
        const double angle_after = run[bead.handle].parameter(1.5);
        if (mu > std::tan(angle))
            EXPECT_NEAR(angle_after, angle, 1e-12);
        else
            EXPECT_GT(angle_after, angle + 0.01);
    }
}

TEST(Landing, a_fast_bead_that_falls_on_a_crest_flies_on_at_once) {
    // along the crest it is faster than the weight could bend: it lands, and is let go at the same time
    const Drop drop(0.0, 0.125, std::nullopt, Vector3(0.0, 0.0, 0.0));
    const Drop fast(-0.5, 0.5, std::nullopt, Vector3(0.0, 0.0, 0.0));
    EXPECT_EQ(kinds(drop.bead.run(0.5)), "watch land");
    EXPECT_EQ(kinds(fast.bead.run(0.4375)).substr(0, 5), "watch");
    const double rise = 2.0, time = std::sqrt(2.0 * rise / gravity);
    const Drop over(0.0, rise, std::nullopt, Vector3(5.0, 0.0, 0.0));
    Scene scene = over.bead.scene;
    const Trajectory run = simulate(scene, {.until = 0.125 + 0.5 * time, .error = 1e-10});
    EXPECT_EQ(kinds(run), "watch");
}

TEST(Landing, on_a_crest_with_more_speed_than_it_can_bend_leaves_again_at_the_same_time) {
    // thrown at the top with 45 degrees: along the rail remains v, and v^2 > g R
    const double v = 4.0;
    Bead bead(gravity, from_the_top(1.0), RailSide::minus, {.parameter = 0.0, .speed = 6.0});
    // where it was a twentieth of a second before
    const double s = 0.05;
    const Vector3 velocity(v, 0.0, -v + gravity * s),
        there = Vector3(0, 0, 1) - s * velocity - Vector3(0, 0, -0.5 * gravity * s * s);
    const WatchAction put{
        WatchAction::Kind::change, [=, handle = bead.handle](const Observe&) {
            return std::vector<StateChange>{{.body = handle, .position = there, .velocity = velocity}};
        }};
    bead.scene.watch("put", [](const Now& now) { return now.time() - 0.125; }, {.action = put});
    const Trajectory run = bead.run(0.5);
    ASSERT_EQ(kinds(run), "watch detach land");
    EXPECT_EQ(run.events()[1].time, run.events()[2].time);
    EXPECT_NEAR(run.events()[1].time, 0.125 + s, 1e-12);
    for (double t : {0.25, 0.5}) {
        const double after = t - 0.125 - s;
        EXPECT_LE((run[bead.handle].position(t) - Vector3(v * after, 0.0, 1.0 - 0.5 * gravity * after * after)).norm(),
                  1e-11);
    }
}

// --- rails that end ---

TEST(SkiJump, is_left_at_its_end_with_the_velocity_it_gives) {
    // down z = (1 - u)^2 h and off horizontally; and one that throws up
    for (double lip : {0.0, 0.5}) {
        const double h = 3.0;
        const Polynomial ramp{.coefficients = {{0, 0, h}, {2, 0, -2.0 * h}, {0, 0, h + lip}}, .domain = {0.0, 1.0}};
        Scene scene(down);
        const BodyHandle bead =
            scene.add(Particle{0.5}, Rail(ramp, std::nullopt, {.ends = RailEnds::release}), {.parameter = 0.25});
        const Trajectory run = simulate(scene, {.until = 4.0, .error = 1e-12});
        ASSERT_EQ(kinds(run), "rail-end");
        EXPECT_EQ(run.status(), Status::reached_end);
        const Curve curve = ramp;
        const double t = run.events()[0].time;
        const double v = std::sqrt(2.0 * gravity * (curve.position(0.25).z() - curve.position(1.0).z()));
        const Vector3 velocity = v * curve.frenet(1.0).tangent, place = curve.position(1.0);
        const Scales scale = scales(run, bead);
        EXPECT_LE((run[bead].velocity(t) - velocity).norm(), 1e-12 * scale.speed);
        for (double later : {t, 0.5 * (t + 4.0), 4.0}) {
            const double s = later - t;
            EXPECT_LE((run[bead].position(later) - place - velocity * s - 0.5 * s * s * down).norm(),
                      2e-12 * scale.extent);
            EXPECT_EQ(run[bead].reaction(later).norm(), 0.0);
        }
        EXPECT_LE(run.drift().at("energy"), 1e-12);
    }
}

TEST(SkiJump, that_stops_at_its_end_ends_the_run_there) {
    const Polynomial ramp{.coefficients = {{0, 0, 1}, {1, 0, -1}}, .domain = {0.0, 1.0}};
    Scene scene(down);
    scene.add(Particle{0.5}, Rail(ramp), {.parameter = 0.0});
    const Trajectory run = simulate(scene, {.until = 4.0, .error = 1e-12});
    EXPECT_EQ(run.status(), Status::stopped_by_event);
    EXPECT_NEAR(run.end(), std::sqrt(4.0 / gravity), 1e-12);
}

TEST(SkiJump, rough_is_left_with_what_friction_leaves) {
    // a straight ramp: v^2 = 2 g L (sin - mu cos)
    const double mu = 0.25;
    const Polynomial ramp{.coefficients = {{0, 0, 3}, {4, 0, -3}}, .domain = {0.0, 1.0}};
    Scene scene(down);
    const BodyHandle bead =
        scene.add(Particle{0.5}, Rail(ramp, Coulomb{mu}, {.ends = RailEnds::release}), {.parameter = 0.0});
    const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-12});
    ASSERT_EQ(kinds(run), "rail-end");
    const double v = std::sqrt(2.0 * gravity * 5.0 * (0.6 - mu * 0.8));
    EXPECT_LE((run[bead].velocity(run.events()[0].time) - v * Vector3(0.8, 0, -0.6)).norm(), 1e-11);
}

// --- ends ---

TEST(RailEnds, a_bead_that_starts_at_one_moving_outward_flies_silently_or_is_refused) {
    const Curve arc([](const auto& u) { return Vector3Of<std::decay_t<decltype(u)>>(u, 0.0 * u, 0.0 * u); },
                    {-1.0, 2.0});
    for (const double end : {-1.0, 2.0}) {
        const double out = end > 0.0 ? 1.0 : -1.0;
        const auto scene = [&](RailEnds ends, double speed) {
            Scene s(down);
            s.add(Particle{1.0}, Rail(arc, {}, {.ends = ends}), {.parameter = end, .speed = speed});
            return s;
        };
        const BodyHandle bead{0};
        const Trajectory flight = simulate(scene(RailEnds::release, 3.0 * out), {.until = 0.5});
        EXPECT_TRUE(flight.events().empty());
        EXPECT_NEAR((flight[bead].position(0.5) - Vector3(end + 1.5 * out, 0, -0.125 * gravity)).norm(), 0.0, 1e-12);
        try {
            (void)simulate(scene(RailEnds::stop, 3.0 * out), {.until = 0.5});
            FAIL();
        } catch (const InvalidInput& e) {
            EXPECT_NE(std::string(e.what()).find("an end of its rail"), std::string::npos) << e.what();
        }
        // inward, and at rest, it is on its rail like any other
        const Trajectory inward = simulate(scene(RailEnds::stop, -out), {.until = 5.0});
        EXPECT_EQ(kinds(inward), "rail-end");
        EXPECT_NEAR(inward.end(), 3.0, 1e-12);
        EXPECT_TRUE(simulate(scene(RailEnds::stop, 0.0), {.until = 5.0}).events().empty());
    }
}

// --- straight rails: one normal, and a reaction that may be constant ---

TEST(StraightRails, hold_a_bead_on_the_side_they_push_to_and_on_no_other) {
    // without up, the normal of a line is the perpendicular nearest to world z
    for (const std::optional<Coulomb>& friction : {std::optional<Coulomb>(), std::optional(Coulomb{1.0, 0.5})})
        for (const double slope : {0.0, 0.5})
            for (const double speed : {0.0, 2.0, -2.0}) {
                const Vector3 along = Vector3(1.0, 0.0, slope) / std::hypot(1.0, slope);
                const Bead on(gravity, Line{.direction = along}, RailSide::plus, {.speed = speed}, friction);
                const Trajectory held = on.run(0.25);
                for (const Event& e : held.events()) EXPECT_NE(e.kind, EventKind::detach);
                EXPECT_NEAR(held[on.handle].reaction(0.25).dot(Vector3(-along.z(), 0.0, along.x())),
                            gravity * along.x(), 1e-12);
                const Bead under(gravity, Line{.direction = along}, RailSide::minus, {.speed = speed}, friction);
                const Trajectory run = under.run(1.0);
                EXPECT_EQ(kinds(run), "");
                EXPECT_EQ(run[under.handle].reaction(1.0).norm(), 0.0);
                EXPECT_LE((run[under.handle].position(1.0) - along * speed - 0.5 * down).norm(), 1e-14);
            }
}

TEST(StraightRails, push_to_the_side_of_up) {
    const Vector3 along = Vector3(2.0, -1.0, 0.5) / std::sqrt(5.25);
    for (const Vector3& up : {Vector3(0, 0, 1), Vector3(1, 5, -3), Vector3(-1e3, 0, 2), Vector3(0, -1e-9, 0)})
        for (const RailSide side : {RailSide::plus, RailSide::minus}) {
            const double sign = side == RailSide::plus ? 1.0 : -1.0;
            const Vector3 normal = sign * (up - along * along.dot(up)) / (up - along * along.dot(up)).norm();
            const Rail rail(Line{.direction = 3.0 * along, .point = {1, 2, 3}}, std::nullopt, {.side = side, .up = up});
            EXPECT_LE((*rail.pushes(0.7) - normal).norm(), 4e-16 + 1e-15);
            for (const double press : {1.0, -1.0}) {
                Scene scene;
                const BodyHandle bead = scene.add(Particle{1.0}, rail, {.parameter = 0.5});
                scene.apply(Force(Vector3(-press * normal + 0.25 * along)), bead);
                const Trajectory run = simulate(scene, {.until = 2.0});
                const Vector3 start = Vector3(1, 2, 3) + 0.5 * along;
                EXPECT_EQ(kinds(run), "");
                EXPECT_LE((run[bead].position(2.0) - start - 0.5 * along - (press > 0.0 ? 0.0 : 2.0) * normal).norm(),
                          1e-14);
            }
        }
}

TEST(StraightRails, are_left_and_met_again_as_a_load_has_it) {
    // pulled up by t against the weight: it leaves at t = g and falls back when the integrals meet
    const Bead bead(gravity, along_x, RailSide::plus, {.speed = 1.0});
    Scene scene = bead.scene;
    scene.apply(Force([](const auto& t, const auto&, const auto&) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{S(0.0), S(0.0), S(2.0 * gravity) * sin(t)};
                }),
                bead.handle);
    const Trajectory run = simulate(scene, {.until = 10.0, .error = 1e-11});
    ASSERT_EQ(kinds(run).substr(0, 11), "detach land");
    const Real from = pi / 6, back = zero(
                                  [&](Real t) {
                                      const Real v = 2 * std::cos(from), d = t - from;
                                      return v * d - 2 * (std::sin(t) - std::sin(from)) - d * d / 2;
                                  },
                                  2.0L, 8.0L);
    EXPECT_NEAR(run.events()[0].time, static_cast<double>(from), 1e-13);
    EXPECT_NEAR(run.events()[1].time, static_cast<double>(back), 1e-11);
    EXPECT_NEAR(run[bead.handle].position(10.0).x(), 10.0, 1e-11);
}

TEST(StraightRails, are_left_once_by_every_engine) {
    // the way across begins with a high power of time, and polynomials of most engines know the powers below it to
    // their errors only
    for (const int power : {1, 3})
        for (const char* engine : {"taylor", "dop853", "cvode-adams", "cvode-bdf"})
            for (const double error : {1e-5, 1e-7, 1e-9, 1e-11}) {
                const Bead bead(gravity, along_x, RailSide::plus, {.speed = 1.0});
                Scene scene = bead.scene;
                scene.apply(Force([power](const auto& t, const auto&, const auto&) {
                                using S = std::decay_t<decltype(t)>;
                                const S d = t - 0.5;
                                return Vector3Of<S>{
                                    S(0.0), S(0.0),
                                    power == 1 ? S(12.0) * sin(S(2.0) * t) : S(gravity) + S(100.0) * (d * d * d)};
                            }),
                            bead.handle);
                const Trajectory run = simulate(scene, {.until = 1.5, .error = error, .engine = engine});
                ASSERT_EQ(kinds(run), "detach") << engine << ' ' << error << ' ' << power;
                const Real from = power == 1 ? std::asin(Real(gravity) / 12) / 2 : 0.5L, d = 1.5L - from;
                EXPECT_NEAR(run.events()[0].time, static_cast<double>(from), power == 1 ? 1e-12 : 1e-5);
                const Real height = power == 1
                                        ? 6 * std::cos(2 * from) * d + 3 * (std::sin(2 * from) - std::sin(3.0L)) -
                                              Real(gravity) * d * d / 2
                                        : 5 * std::pow(d, 5);
                EXPECT_NEAR(run[bead.handle].position(1.5).z(), static_cast<double>(height), 10.0 * error)
                    << engine << ' ' << error << ' ' << power;
            }
}

TEST(StraightRails, that_slant_and_pull_along_are_left_once) {
    // where the reaction has come to zero the way across begins with the third power of time: rounding of the large
    // acceleration along the rail has no say in it
    int left = 0;
    for (int k = 0; k < 64; ++k) {
        const double angle = 0.1 + 0.09 * k;
        const Vector3 along(std::cos(angle), 0.0, std::sin(angle)), normal(-along.z(), 0.0, along.x());
        Scene scene(-9.81 * normal);
        const BodyHandle bead = scene.add(
            Particle{0.7}, Rail(Line{.direction = along}, Coulomb{0.3, 0.2}, {.side = RailSide::plus, .up = normal}),
            {.speed = 1.1});
        scene.connect(Spring{.stiffness = 7.3}, bead, Vector3(2.0 * along - 0.4 * normal));
        const Vector3 lift = 11.3 * normal + 5.7 * along;
        scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                        using S = std::decay_t<decltype(t)>;
                        const S size = sin(S(1.3) * t);
                        return Vector3Of<S>{S(lift.x()) * size, S(0.0), S(lift.z()) * size};
                    }),
                    bead);
        const Trajectory run = simulate(scene, {.until = 1.4});
        const auto leaves = run.events().times("detach");
        left += static_cast<int>(leaves.size());
        for (const double t : run.events().times("land"))
            for (const double before : leaves) EXPECT_FALSE(t >= before && t < before + 1e-3) << angle << kinds(run);
    }
    EXPECT_GE(left, 32);
}

TEST(StraightRails, that_lose_a_constant_load_are_left_when_it_changes_and_where_friction_held_the_bead) {
    const Bead bead(gravity, along_x, RailSide::plus, {}, Coulomb{0.5});
    Scene scene = bead.scene;
    scene.apply(Force([](const auto& t, const auto&, const auto&) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{S(0.0), S(0.0), where(t > 0.5, S(2.0 * gravity), S(0.0))};
                }),
                bead.handle);
    const Trajectory run = simulate(scene, {.until = 1.5});
    EXPECT_EQ(kinds(run), "detach switch");
    EXPECT_NEAR(run[bead.handle].position(1.5).z(), 0.5 * gravity, 1e-12);
}

TEST(StraightRails, without_any_load_across_them_neither_hold_nor_lose_a_bead) {
    const Vector3 along = Vector3(1.0, 1.0, 1.0) / std::sqrt(3.0);
    for (const RailSide side : {RailSide::plus, RailSide::minus}) {
        Scene scene(9.81 * along);
        const BodyHandle bead = scene.add(Particle{1.0}, Rail(Line{.direction = along}, std::nullopt, {.side = side}));
        scene.add(Particle{1.0}, {.position = {5, 0, 0}});
        const Trajectory run = simulate(scene, {.until = 1.0});
        EXPECT_EQ(kinds(run), "");
        EXPECT_LE((run[bead].position(1.0) - 0.5 * 9.81 * along).norm(), 1e-14);
    }
}

// --- which side it is ---

TEST(Sides, follow_up_where_the_bead_starts) {
    // over the top of a circle up is outward, at the bottom inward
    const Curve circle = from_the_top(2.0);
    const Vector3 up(0.25, 1.0, 1.0);
    for (const double angle : {0.0, 1.0, 2.5, 4.0}) {
        const Rail rail(circle, std::nullopt, {.side = RailSide::plus, .up = up}),
            other(circle, std::nullopt, {.side = RailSide::minus, .up = up});
        const Vector3 outward(std::sin(angle), 0.0, std::cos(angle));
        const double sign = outward.dot(up) > 0.0 ? 1.0 : -1.0;
        EXPECT_LE((*rail.pushes(angle) - sign * outward).norm(), 1e-15);
        EXPECT_LE((*other.pushes(angle) + sign * outward).norm(), 1e-15);
        EXPECT_LE((*Rail(circle, std::nullopt, {.side = RailSide::plus}).pushes(angle) + outward).norm(), 1e-15);
    }
    EXPECT_FALSE(Rail(circle).pushes(0.0));
}

TEST(Sides, are_said_by_up_or_it_is_refused) {
    const Curve circle = from_the_top(2.0);
    EXPECT_NE(refusal([&] { Rail(circle, std::nullopt, {.up = Vector3(0, 0, 1)}); }).find("side is \"both\""),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  Rail(circle, std::nullopt, {.side = RailSide::plus, .up = Vector3(0, 0, 0)});
              }).find("length of up is 0"),
              std::string::npos);
    // across the plane, along the rail
    for (const Vector3& up : {Vector3(0, 1, 0), Vector3(1, 0, 0)})
        EXPECT_NE(refusal([&] {
                      Rail(circle, std::nullopt, {.side = RailSide::plus, .up = up}).pushes(0.0);
                  }).find("cosine of the angle between up"),
                  std::string::npos);
    EXPECT_NE(refusal([&] {
                  Rail(along_x, std::nullopt, {.side = RailSide::plus, .up = Vector3(1, 0, 0)}).pushes(0.0);
              }).find("sine of the angle between up"),
              std::string::npos);
}

TEST(Sides, of_curves_in_space_are_refused_with_a_distance_that_is_true) {
    const Curve helix = Helix{.radius = 1.0, .pitch = 0.5, .start = {1, 0, 0}, .toward = {0, 1, 0}};
    const Curve twisted = Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .domain = {-1, 2}};
    for (const Curve& curve : {helix, twisted})
        for (const double u : {0.25, 1.0}) {
            const std::string words = refusal([&] { Rail(curve, std::nullopt, {.side = RailSide::plus}).pushes(u); });
            const std::string place = "its rail at parameter ", value = "is ";
            ASSERT_NE(words.find(place), std::string::npos) << words;
            const double at = std::stod(words.substr(words.find(place) + place.size()));
            const double distance = std::stod(words.substr(words.rfind(value, words.find("; ")) + value.size()));
            const Vector3 away = curve.position(at) - curve.position(u);
            EXPECT_NEAR(distance, std::abs(curve.frenet(u).binormal.dot(away)), 1e-5 * distance) << words;
            EXPECT_NE(words.find("flies past it"), std::string::npos);
        }
}

TEST(Landing, a_bead_that_has_left_the_plane_of_its_rail_flies_past_it) {
    // thrown up from a table, pushed aside or not
    for (const double aside : {0.0, 1e-3, 1.0}) {
        Scene scene(down);
        const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x, std::nullopt, {.side = RailSide::plus}));
        scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                        using S = std::decay_t<decltype(t)>;
                        return Vector3Of<S>{S(0.0), S(aside), where(t < 0.25, S(5.0 * gravity), S(0.0))};
                    }),
                    bead);
        const Trajectory run = simulate(scene, {.until = 4.0});
        EXPECT_EQ(run.events().times("land").size(), aside == 0.0 ? 1u : 0u) << aside << kinds(run);
        EXPECT_EQ(run[bead].position(4.0).z() < -1.0, aside != 0.0);
    }
}

TEST(Landing, along_the_normal_of_a_smooth_curve_a_bead_stays_where_it_lands) {
    for (const double angle : {0.3, 0.1, 0.7, -0.4, 1.1}) {
        Scene scene;
        const Vector3 normal(std::sin(angle), 0.0, std::cos(angle));
        const BodyHandle bead = scene.add(Particle{1.0},
                                          Rail(Circle{.radius = 1.0, .start = {0, 0, 1}, .toward = {1, 0, 0}},
                                               std::nullopt, {.side = RailSide::minus}),
                                          {.parameter = 0.0, .speed = 6.0});
        scene.watch("put", [](const Now& now) { return now.time() - 0.125; },
                    {.action = {WatchAction::Kind::change, [=](const Observe&) {
                                    return std::vector<StateChange>{
                                        {.body = bead, .position = 1.5 * normal, .velocity = -0.7 * normal}};
                                }}});
        const Trajectory run = simulate(scene, {.until = 1e4, .error = 1e-10});
        ASSERT_EQ(kinds(run), "watch land");
        EXPECT_NEAR(run.events()[1].time, 0.125 + 0.5 / 0.7, 1e-12);
        EXPECT_EQ(run[bead].speed(1e4), 0.0) << angle;
        EXPECT_EQ(run[bead].parameter(1e4), run[bead].parameter(run.events()[1].time, Side::after)) << angle;
    }
}

}  // namespace
}  // namespace rbdyn::test::test_one_sided
