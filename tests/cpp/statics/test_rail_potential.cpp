// The potential of a bead along its rail against closed forms, and against its motion.
#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <numbers>

#include "rbdyn/statics/rail_potential.hpp"
#include "support.hpp"

namespace rbdyn::test::test_rail_potential {
namespace {

constexpr double pi = std::numbers::pi;
using Vector = Vector3Of<Expression>;

Scene hoop_scene(double radius, double g = gravity, double mass = 0.7) {
    Scene scene({0.0, 0.0, -g});
    scene.add(Particle{.mass = mass}, Rail(vertical_circle(radius)));
    return scene;
}
RailPotential of(const Scene& scene) { return {scene, BodyHandle{0}}; }
double release(const RailPotential& p, double u) { return p.period(p.energy(u, 0.0), u); }

std::string refusal(const Scene& scene) {
    try {
        of(scene);
    } catch (const InvalidInput& e) {
        return e.what();
    }
    return {};
}

TEST(RailPotential, a_pendulum_has_the_period_of_the_complete_elliptic_integral) {
    const RailPotential p = of(hoop_scene(1.0, 9.81));
    struct Case {
        double angle, period, tolerance;
    };
    // the last one turns 1 degree from the top: its angle is known to 1e-16 / 0.017 of the distance
    for (const Case& c : {Case{0.05, 2.0063801735317490, 4e-16}, Case{0.5 * pi, 2.3678419475762374, 4e-16},
                          Case{179.0 / 180.0 * pi, 7.8257968375376827, 1e-14}})
        EXPECT_LE(std::abs(release(p, c.angle) / c.period - 1.0), c.tolerance) << c.angle;
    for (int k = 1; k < 60; ++k) {
        const double angle = 0.05 * k;
        const long double exact =
            4.0L * boost::math::ellint_1(std::sin(0.5L * angle)) / std::sqrt(static_cast<long double>(9.81));
        EXPECT_LE(std::abs(release(p, angle) / static_cast<double>(exact) - 1.0), 4e-15) << angle;
    }
}

TEST(RailPotential, near_the_separatrix_the_period_is_as_good_as_its_angle) {
    const RailPotential p = of(hoop_scene(1.0));
    for (const double from_top : {0x1p-6, 0x1p-10, 0x1p-14}) {
        const double angle = pi - from_top;
        const long double exact =
            4.0L * boost::math::ellint_1(std::sin(0.5L * angle)) / std::sqrt(static_cast<long double>(gravity));
        // the energy is rounded in units of 2 g, which moves the turning point opposite by that over the slope there
        const double moved = 8.0 * epsilon / from_top / from_top;
        EXPECT_LE(std::abs(release(p, angle) / static_cast<double>(exact) - 1.0), moved + 1e-15) << from_top;
    }
}

TEST(RailPotential, a_pendulum_that_goes_round_takes_the_time_of_the_integral) {
    const double radius = 0.5;
    const RailPotential p = of(hoop_scene(radius));
    for (const double speed : {4.5, 5.0, 7.0, 50.0}) {
        const double e = p.energy(0.0, speed);
        EXPECT_EQ(p.turning_points(e, 0.3), TurningPoints{}) << speed;
        const long double k = 2.0L * std::sqrt(static_cast<long double>(gravity) * radius) / speed;
        const double exact = static_cast<double>(4.0L * radius * boost::math::ellint_1(k) / speed);
        EXPECT_LE(std::abs(p.period(e, 0.0) / exact - 1.0), 4e-15);
        EXPECT_LE(std::abs(p.period(e, 2.0) / exact - 1.0), 4e-15);
        EXPECT_LE(std::abs(p.time(e, 0.0, pi) / exact - 0.5), 2e-15);
    }
}

TEST(RailPotential, a_spring_along_a_line_has_one_period_at_every_amplitude) {
    Scene scene;
    const auto bead = scene.add(Particle{.mass = 0.3}, Rail(along_x), {.parameter = 0.4});
    scene.connect(Spring{.stiffness = 2.0}, bead, Vector3(1.0, 0.0, 0.0));
    const RailPotential p(scene, bead);
    const double exact = 2.0 * pi * std::sqrt(0.15);
    // a small amplitude is known to the rounding of its place
    for (const double a : {0x1p-25, 0x1p-6, 1.0, 300.0, -1e9})
        EXPECT_LE(std::abs(release(p, 1.0 + a) / exact - 1.0), 4.0 * epsilon * std::max(1.0, 1.0 / std::abs(a))) << a;
    // at rest in equilibrium: the limit
    EXPECT_LE(std::abs(release(p, 1.0) / exact - 1.0), 1e-15);
    const TurningPoints t = p.turning_points(p.energy(1.0, 3.0), 0.5);
    const double reach = 3.0 * std::sqrt(0.15);
    EXPECT_NEAR(*t.below, 1.0 - reach, 4e-16);
    EXPECT_NEAR(*t.above, 1.0 + reach, 4e-16);
    // where the way back ends with a piece
    for (const double u : {1.5, 2.0, 3.0, 5.0})
        EXPECT_EQ(p.turning_points(p.energy(u, 0.0), u), (TurningPoints{2.0 - u, u})) << u;
    // a quarter of the period to the middle, a twelfth to half the amplitude
    const double e = p.energy(3.0, 0.0);
    EXPECT_LE(std::abs(p.time(e, 1.0, 3.0) / exact - 0.25), 1e-15);
    EXPECT_LE(std::abs(p.time(e, 1.0, 2.0) / exact - 1.0 / 12.0), 1e-15);
    EXPECT_EQ(p.time(e, 2.0, 1.0), -p.time(e, 1.0, 2.0));
}

TEST(RailPotential, on_a_cycloid_the_period_is_the_same_from_every_height) {
    for (const double radius : {0.25, 0.3, 7.0}) {
        Scene scene(down);
        const auto bead =
            scene.add(Particle{.mass = 0.3}, Rail(Cycloid{.radius = radius, .x = {1, 0, 0}, .y = {0, 0, 1}}));
        const RailPotential p(scene, bead);
        const double exact = 4.0 * pi * std::sqrt(radius / gravity);
        for (const double u : {0.01, 0.5, 1.0, -2.0, 3.0, 3.1}) {
            EXPECT_LE(std::abs(release(p, u) / exact - 1.0), 1e-14) << radius << " " << u;
            EXPECT_LE(std::abs(p.time(p.energy(u, 0.0), 0.0, std::abs(u)) / exact - 0.25), 1e-14) << u;
        }
        EXPECT_LE(std::abs(release(p, 0.0) / exact - 1.0), 1e-15) << "small oscillations";
        // at its cusps a cycloid has no tangent
        EXPECT_THROW(p.tangential_force(pi), InvalidInput);
    }
}

TEST(RailPotential, in_a_parabola_the_period_is_an_elliptic_integral_of_the_second_kind) {
    Scene scene(down);
    const auto bead = scene.add(
        Particle{.mass = 2.0}, Rail(Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}}), {.parameter = 1.0});
    const RailPotential p(scene, bead);
    for (const double a : {0.01, 0.5, 3.0}) {
        // x = a sin(q): T = 4 / sqrt(2 g) times the integral of sqrt(1 + 4 a^2 sin^2 q), by the trapezoidal rule
        long double sum = 0.0L;
        constexpr int n = 4000;
        for (int k = 0; k < n; ++k) {
            const long double s = std::sin((k + 0.5L) * std::numbers::pi_v<long double> / (2 * n));
            sum += std::sqrt(1.0L + 4.0L * a * a * s * s);
        }
        const double exact =
            static_cast<double>(4.0L / std::sqrt(2.0L * gravity) * sum * std::numbers::pi_v<long double> / (2 * n));
        EXPECT_LE(std::abs(release(p, a) / exact - 1.0), 3e-15) << a;
    }
}

TEST(RailPotential, a_bead_thrown_up_a_helix_turns_where_its_energy_ends) {
    const double pitch = 0.5, radius = 1.0;
    Scene scene(down);
    const auto bead = scene.add(Particle{.mass = 0.2},
                                Rail(Helix{.radius = radius, .pitch = pitch, .start = {1, 0, 0}, .toward = {0, 1, 0}}));
    const RailPotential p(scene, bead);
    const double speed = 3.0, rise = speed * speed / (2.0 * gravity);
    const TurningPoints t = p.turning_points(p.energy(0.0, speed), 0.0);
    EXPECT_FALSE(t.below);
    EXPECT_LE(std::abs(*t.above / (2.0 * pi * rise / pitch) - 1.0), 1e-15);
    // constant deceleration along the rail
    const double slope = pitch / std::hypot(pitch, 2.0 * pi * radius);
    EXPECT_LE(std::abs(p.time(p.energy(0.0, speed), 0.0, *t.above) * gravity * slope / speed - 1.0), 4e-15);
    EXPECT_THROW(p.period(p.energy(0.0, speed), 0.0), InvalidInput);
    EXPECT_THROW(p.time(p.energy(0.0, speed), 0.0, *t.above + 1e-3), InvalidInput);
    EXPECT_THROW(p.speed(*t.above + 1e-3, p.energy(0.0, speed)), InvalidInput);
}

TEST(RailPotential, its_slope_is_the_tangential_force_for_every_load) {
    Scene scene(down);
    const Polynomial curve{.coefficients = {{0, 0, 0}, {1, 0.2, 0}, {0, 1, 0.3}, {0, 0, 0.4}}};
    const auto bead = scene.add(Particle{.mass = 0.8}, Rail(curve), {.parameter = 0.1});
    scene.apply(Force(Vector3(0.3, -0.2, 0.1)), bead);
    scene.apply(Force([](const auto&, const auto& r, const auto&) { return Vector(-r[1] * r[2], r[0], sin(r[1])); }),
                bead);
    scene.apply(Potential([](const auto& r) { return r[0] * r[1] - exp(-r[2]); }), bead);
    scene.apply(Lorentz{.strength = 2.0, .field = {1.0, 2.0, 3.0}}, bead);
    scene.connect(Spring{.stiffness = 3.0, .rest_length = 0.5}, bead, Vector3(1.0, 2.0, 0.5));
    scene.connect(Spring{.stiffness = 1.0}, Vector3(-1.0, 0.0, 0.0), bead);
    const RailPotential p(scene, bead);
    EXPECT_EQ(p.value(0.0), 0.0);
    const Curve rail = curve;
    for (const double u : {-1.5, -0.3, 0.0, 0.7, 1.9}) {
        // Richardson's extrapolation of central differences
        const auto difference = [&](double h) { return (p.value(u + h) - p.value(u - h)) / (2.0 * h); };
        const double slope = (4.0 * difference(1e-3) - difference(2e-3)) / 3.0;
        const double force = p.tangential_force(u) * rail.first(u).norm();
        EXPECT_LE(std::abs(slope - force), 1e-9 * (1.0 + std::abs(force))) << u;
    }
}

TEST(RailPotential, a_force_without_potential_in_space_has_one_along_the_rail) {
    const double radius = 0.5, c = 0.75;
    Scene scene;
    const auto bead = scene.add(Particle{.mass = 0.5}, Rail(vertical_circle(radius)), {.parameter = 0.4, .speed = 0.3});
    // about the axis of the hoop, growing with the height over its lowest point: curl is not zero anywhere
    const auto turning = [=](const auto&, const auto& r, const auto&) {
        return Vector(-c * r[2] * r[2], 0.0, c * r[0] * r[2]);
    };
    scene.apply(Force(turning), bead);
    const RailPotential p(scene, bead);
    // r = R (sin u, -cos u), r' = R (cos u, sin u): F.r' = -c R^3 cos u, so U = -c R^3 sin u
    for (const double u : {-20.0, -3.0, 0.4, 1.0, 2.0, 6.0, 100.0}) {
        EXPECT_NEAR(p.work_of_forces(u), -c * radius * radius * radius * std::sin(u), 2e-16 * (1.0 + std::abs(u))) << u;
        EXPECT_EQ(p.value(u), p.work_of_forces(u));
    }
    const Trajectory run = simulate(scene, {.until = 30.0, .error = 1e-12});
    ASSERT_EQ(run.plan().integrals, std::vector<std::string>{"energy"});
    EXPECT_LT(run.drift().at("energy"), 1e-13);
    EXPECT_NEAR(run.energy(7.0), p.energy(0.4, 0.3), 1e-13);
    // its period against its motion
    const double e = p.energy(0.4, 0.3), period = p.period(e, 0.4);
    EXPECT_NEAR(run[bead].parameter(3.0 + period), run[bead].parameter(3.0), 1e-12);
}

TEST(RailPotential, a_force_that_does_work_each_round_has_no_period_but_a_next_round) {
    Scene scene;
    const auto bead = scene.add(Particle{.mass = 0.5}, Rail(vertical_circle(1.0)), {.speed = 1.0});
    scene.apply(Force([](const auto&, const auto& r, const auto&) { return Vector(-r[2], 0.0, r[0]); }), bead);
    const RailPotential p(scene, bead);
    // F_t = 1 all round: uniform acceleration 2
    const double e = p.energy(0.0, 1.0);
    EXPECT_LE(std::abs(p.period(e, 0.0) / (0.5 * (std::sqrt(1.0 + 8.0 * pi) - 1.0)) - 1.0), 2e-15);
    const TurningPoints t = p.turning_points(e, 0.0);
    EXPECT_FALSE(t.above) << "nothing stops it";
    EXPECT_NEAR(t.below.value_or(0.0), -0.25, 1e-16);
    // the other way it turns after many rounds
    EXPECT_NEAR(p.turning_points(p.energy(0.0, 20.0), 0.0).below.value_or(0.0), -100.0, 1e-13);
}

TEST(RailPotential, time_is_that_of_the_motion) {
    Scene scene(down);
    const Polynomial curve{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0.3, -1.0}, {0, 0.2, 0}, {0, 0, 0.8}}};
    const auto bead = scene.add(Particle{.mass = 0.8}, Rail(curve), {.parameter = 1.2, .speed = -0.5});
    const RailPotential p(scene, bead);
    const Trajectory run = simulate(scene, {.until = 4.0, .error = 1e-13});
    const double e = p.energy(1.2, 0.5);
    for (const double t : {0.1, 0.2, 0.3}) {
        ASSERT_LT(run[bead].speed(t), 0.0);
        EXPECT_NEAR(p.time(e, 1.2, run[bead].parameter(t)), -t, 2e-13);
        EXPECT_NEAR(p.speed(run[bead].parameter(t), e), -run[bead].speed(t), 1e-12);
    }
    const double period = p.period(e, 1.2);
    EXPECT_NEAR(run[bead].parameter(period), 1.2, 1e-12);
}

TEST(RailPotential, on_a_separatrix_the_time_is_infinite) {
    const RailPotential p = of(hoop_scene(1.0));
    EXPECT_EQ(release(p, pi), std::numeric_limits<double>::infinity());
    const double exact = 2.0 * pi / std::sqrt(gravity);
    EXPECT_LE(std::abs(release(p, 0.0) / exact - 1.0), 1e-15) << "small oscillations";
}

/// A bead of mass 2 on a line under a potential of its place along it.
template <class U>
RailPotential along_line(U&& u) {
    Scene scene;
    const auto bead = scene.add(Particle{.mass = 2.0}, Rail(along_x));
    scene.apply(Potential([=](const auto& r) { return u(r[0]); }), bead);
    return RailPotential(scene, bead);
}

TEST(RailPotential, on_a_separatrix_the_period_is_infinite_and_the_motion_ends_at_the_equilibrium) {
    for (const double radius : {0.5, 0.453125, 1.7}) {
        Scene scene(down);
        const auto bead = scene.add(Particle{.mass = 0.7}, Rail(vertical_circle(radius)));
        const RailPotential u(scene, bead);
        const double top = u.energy(pi, 0.0);
        for (const double start : {0.0, 0.3, -2.0}) {
            EXPECT_EQ(u.period(top, start), std::numeric_limits<double>::infinity()) << radius;
            const TurningPoints t = u.turning_points(top, start);
            ASSERT_TRUE(t.below && t.above) << radius;
            EXPECT_NEAR(*t.below, -pi, 1e-15);
            EXPECT_NEAR(*t.above, pi, 1e-15);
        }
        EXPECT_EQ(u.time(top, 0.0, 4.0), std::numeric_limits<double>::infinity());
        EXPECT_LT(u.period(top * (1.0 + 1e-10), 0.0), 1e3);
    }
    // two hills of one height, and a point between them
    const RailPotential hills = along_line([](const auto& x) { return -pow(x * x - 1.0, 2.0) + 1.0; });
    EXPECT_EQ(hills.period(-0.0, 0.5), std::numeric_limits<double>::infinity());
    EXPECT_EQ(*hills.turning_points(0.0, 0.5).below, 0.0);
    EXPECT_NEAR(*hills.turning_points(0.0, 0.5).above, std::sqrt(2.0), 1e-15);
}

TEST(RailPotential, a_bead_that_is_pushed_away_for_ever_does_not_turn) {
    const RailPotential away = along_line([](const auto& x) { return x * x; });
    EXPECT_EQ(away.turning_points(1.0, 0.0), (TurningPoints{}));
    EXPECT_EQ(away.turning_points(1.0, -3.0), (TurningPoints{}));
    // E = -1/4: it comes in to x = 1/2
    EXPECT_NEAR(*away.turning_points(-0.25, 0.75).below, 0.5, 1e-15);
    EXPECT_FALSE(away.turning_points(-0.25, 0.75).above);
    const RailPotential cube = along_line([](const auto& x) { return pow(x, 3.0); });
    EXPECT_NEAR(*cube.turning_points(1.0, 0.5).below, -1.0, 1e-15);
    EXPECT_FALSE(cube.turning_points(1.0, 0.5).above);
    const RailPotential slope = along_line([](const auto& x) { return exp(x); });
    EXPECT_FALSE(slope.turning_points(0.0, 0.0).above);
}

TEST(RailPotential, in_a_flat_bottom_it_turns_where_the_walls_are) {
    // U = -x^12: E = 1 turns at -1 and 1, T = 4 sqrt(m/2) Int_0^1 dx / sqrt(1 - x^12)
    const RailPotential well = along_line([](const auto& x) { return -pow(x, 12.0); });
    const double period = 4.0 * std::sqrt(pi) * std::tgamma(1.0 + 1.0 / 12.0) / std::tgamma(0.5 + 1.0 / 12.0);
    for (const double start : {0.0, -1.0, 1.0, 0.3, -0.999}) {
        const TurningPoints t = well.turning_points(1.0, start);
        ASSERT_TRUE(t.below && t.above) << start;
        EXPECT_NEAR(*t.below, -1.0, 1e-14);
        EXPECT_NEAR(*t.above, 1.0, 1e-14);
        EXPECT_NEAR(well.period(1.0, start) / period, 1.0, 1e-13);
    }
}

TEST(RailPotential, the_end_of_a_rail_is_no_turning_point) {
    Scene scene(down);
    const auto bead = scene.add(
        Particle{.mass = 1.0},
        Rail(Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, .domain = {-1.0, 2.0}}), {.parameter = 0.0});
    const RailPotential p(scene, bead);
    // zero at the beginning of the curve
    EXPECT_EQ(p.value(-1.0), 0.0);
    EXPECT_DOUBLE_EQ(p.value(0.0), gravity);
    const TurningPoints t = p.turning_points(p.energy(1.5, 0.0), 1.5);
    EXPECT_FALSE(t.below);
    EXPECT_EQ(t.above, 1.5);
    EXPECT_THROW(p.value(2.5), InvalidInput);
    EXPECT_THROW(p.value(std::nan("")), InvalidInput);
}

TEST(RailPotential, what_has_no_potential_is_refused_by_name) {
    const auto said = [](auto&& change, const Rail& rail = Rail(vertical_circle(1.0))) {
        Scene scene(down);
        const auto bead = scene.add(Particle{.mass = 1.0}, rail, {}, "the bead");
        change(scene, bead);
        return refusal(scene);
    };
    const auto nothing = [](Scene&, BodyHandle) {};
    const auto has = [](const std::string& text, const char* words) { return text.find(words) != std::string::npos; };
    EXPECT_TRUE(has(said([](Scene& s, BodyHandle b) { s.apply(Drag{.linear = 0.1}, b); }), "drag acts on the bead"));
    EXPECT_TRUE(has(said([](Scene& s, BodyHandle b) { s.connect(Spring{.damping = 0.1}, b, Vector3(9, 0, 0)); }),
                    "a damper acts on the bead"));
    EXPECT_TRUE(has(said(nothing, Rail(vertical_circle(1.0), Coulomb{.mu_static = 0.1})), "friction acts on the bead"));
    EXPECT_TRUE(has(said([](Scene& s, BodyHandle b) {
                        s.apply(Force([](const auto& t, const auto&, const auto&) { return Vector(sin(t), 0.0, 0.0); }),
                                b);
                    }),
                    "depends on time"));
    EXPECT_TRUE(has(said([](Scene& s, BodyHandle b) {
                        s.apply(Force([](const auto&, const auto&, const auto& v) { return Vector(v[1], 0.0, 0.0); }),
                                b);
                    }),
                    "depends on velocity"));
    EXPECT_TRUE(has(said([](Scene& s, BodyHandle b) {
                        s.connect(Spring{.stiffness = 0.1}, b, s.add(Particle{.mass = 1.0}, FreeStart{}, "the other"));
                    }),
                    "a spring joins the bead with the other"));
    Scene free;
    free.add(Particle{.mass = 1.0});
    EXPECT_TRUE(has(refusal(free), "particle 1 is free"));
    EXPECT_EQ(said(nothing), "");
}

TEST(RailPotential, powers_of_two_in_the_units_change_no_digit) {
    // lengths times 2^a, masses 2^b, times 2^c
    const auto period = [](int a, int b, int c, double& u_scale) {
        const double length = std::ldexp(1.0, a), mass = std::ldexp(1.0, b), time = std::ldexp(1.0, c);
        Scene scene({0.0, 0.0, -9.81 * length / (time * time)});
        const auto bead = scene.add(Particle{.mass = 0.7 * mass}, Rail(Line{.direction = {3.0, 0.0, 1.0}}),
                                    {.parameter = 0.3 * length});
        scene.connect(Spring{.stiffness = 2.0 * mass / (time * time), .rest_length = 0.4 * length}, bead,
                      Vector3(1.0 * length, 0.5 * length, 0.0));
        const double force = mass * length / (time * time);
        scene.apply(Force([=](const auto&, const auto& r, const auto&) {
                        return Vector(force * sin(r[0] / length), force * cos(r[0] / length), 0.0);
                    }),
                    bead);
        const RailPotential p(scene, bead);
        const TurningPoints t = p.turning_points(p.energy(0.3 * length, 0.0), 0.3 * length);
        u_scale = t.below.value_or(0.0) / length;
        return p.period(p.energy(0.3 * length, 0.0), 0.3 * length) / time;
    };
    double place = 0.0, other = 0.0;
    const double one = period(0, 0, 0, place);
    for (const auto& [a, b, c] :
         {std::array{30, 0, 0}, std::array{0, 25, 0}, std::array{0, 0, -20}, std::array{-30, 7, 9}}) {
        EXPECT_EQ(period(a, b, c, other), one);
        EXPECT_EQ(other, place);
    }
    // times are integrals over the root of the way, which an odd power rounds otherwise
    EXPECT_NEAR(period(-31, 7, 9, other), one, 2e-15);
    EXPECT_EQ(other, place);
}

}  // namespace
}  // namespace rbdyn::test::test_rail_potential
