// Rails that move: closed forms of rotating and shaken rails, and motions that must be the same seen otherwise.
#include <gtest/gtest.h>

#include <numbers>

#include "support.hpp"

namespace rbdyn::test::test_moving_rails {
namespace {

constexpr double pi = std::numbers::pi;

RigidMotion turning(double rate, const Vector3& axis = {0, 0, 1}) {
    return RigidMotion::rotation([=](const auto& t) { return rate * t; }, axis);
}
/// Uniform motion, and uniformly accelerated.
RigidMotion moving(const Vector3& velocity, const Vector3& acceleration = Vector3::Zero()) {
    return RigidMotion::translation([=](const auto& t) {
        using S = std::decay_t<decltype(t)>;
        Vector3Of<S> d;
        for (int i = 0; i < 3; ++i) d[i] = velocity[i] * t + 0.5 * acceleration[i] * (t * t);
        return d;
    });
}

struct Bead {
    Scene scene;
    BodyHandle handle;
    Bead(const Vector3& g, const Curve& curve, RailOptions options, RailStart start,
         std::optional<Coulomb> friction = std::nullopt, double mass = 1.0)
        : scene(g), handle(scene.add(Particle{mass}, Rail(curve, friction, options), start)) {}
    Trajectory run(double until, double error = 1e-12, double start = 0.0) const {
        return simulate(scene, {.until = until, .start = start, .error = error});
    }
};

/// Both runs have the same events and the same motion in the world.
void expect_same_motion(const Trajectory& a, BodyHandle in_a, const Trajectory& b, BodyHandle in_b, double tolerance) {
    ASSERT_EQ(kinds(a), kinds(b));
    for (std::size_t k = 0; k < a.events().size(); ++k)
        EXPECT_NEAR(a.events()[k].time, b.events()[k].time, tolerance * a.events()[k].time) << a.events()[k];
    const Scales scale = scales(a, in_a);
    for (int k = 0; k <= 200; ++k) {
        const double t = std::min(a.end(), a.start() + (a.end() - a.start()) * k / 200.0);
        const PointReport p = a[in_a].report(t), q = b[in_b].report(t);
        EXPECT_LE((p.position - q.position).norm(), tolerance * scale.extent) << t;
        EXPECT_LE((p.velocity - q.velocity).norm(), tolerance * scale.speed) << t;
        EXPECT_LE((p.reaction - q.reaction).norm(), tolerance * scale.reaction) << t;
    }
}

// --- the hoop that turns about its vertical diameter ---

TEST(TurningHoop, has_a_relative_equilibrium_where_the_cosine_is_g_over_the_centripetal_acceleration) {
    for (double rate : {6.0, 8.0, 30.0}) {
        const double radius = 0.5, angle = std::acos(gravity / (rate * rate * radius)), mass = 0.25;
        const Bead bead(down, vertical_circle(radius), {.motion = turning(rate)}, {.parameter = angle}, std::nullopt,
                        mass);
        const Trajectory run = bead.run(3.0);
        for (double t : {0.5, 1.0, 3.0}) {
            EXPECT_NEAR(run[bead.handle].parameter(t), angle, 1e-14 * rate * t * 10.0) << rate;
            const double r = radius * std::sin(angle);
            const Vector3 place(r * std::cos(rate * t), r * std::sin(rate * t), -radius * std::cos(angle));
            EXPECT_LE((run[bead.handle].position(t) - place).norm(), 1e-12);
            // the rail carries the weight and bends the path
            const Vector3 reaction = -mass * down - mass * rate * rate * Vector3(place.x(), place.y(), 0.0);
            EXPECT_LE((run[bead.handle].reaction(t) - reaction).norm(), 1e-11 * reaction.norm());
        }
    }
}

TEST(TurningHoop, swings_about_its_equilibria_with_the_frequencies_of_small_oscillations) {
    const double radius = 0.5;
    for (double rate : {0.0, 2.0, 4.0, 5.0, 8.0, 20.0}) {
        const double critical = gravity / (rate * rate * radius);
        const bool is_low = critical >= 1.0;
        const double angle = is_low ? 0.0 : std::acos(critical);
        const double frequency = is_low ? std::sqrt(gravity / radius - rate * rate) : rate * std::sin(angle);
        const double amplitude = 1e-5;
        Bead bead(down, vertical_circle(radius), {.motion = turning(rate)}, {.parameter = angle + amplitude});
        bead.scene.watch("turn", [h = bead.handle](const Now& now) { return now[h].speed(); });
        // relative to the swing, which is rounding over its width
        const Trajectory run = bead.run(10.0 * 2.0 * pi / frequency + 0.01, 1e-9);
        const auto turns = run.events().times("turn");
        ASSERT_GE(turns.size(), 20u) << rate;
        // a swing of finite width differs by its square
        EXPECT_NEAR(turns[19] * frequency / (20.0 * pi), 1.0, 1e-8) << rate;
    }
}

TEST(TurningHoop, keeps_the_integral_of_Jacobi_and_not_the_energy) {
    const double radius = 0.5, rate = 7.0;
    for (double start : {0.1, 1.0, 2.5}) {
        Bead bead(down, vertical_circle(radius), {.motion = turning(rate)}, {.parameter = start, .speed = 0.5});
        bead.scene.integral("Jacobi", [=, h = bead.handle](const Now& now) {
            const Vector3Of<Expression> r = now[h].position();
            const Expression v = now[h].speed();
            return 0.5 * v * v - 0.5 * rate * rate * (r[0] * r[0] + r[1] * r[1]) + gravity * r[2];
        });
        const Trajectory run = bead.run(20.0, 1e-11);
        const auto drift = run.drift();
        ASSERT_TRUE(drift.contains("Jacobi"));
        EXPECT_LE(drift.at("Jacobi"), 1e-10) << start;
        EXPECT_FALSE(drift.contains("energy"));
        EXPECT_GT(std::abs(run.energy(1.0) - run.energy(0.0)), 1e-3);
    }
}

TEST(TurningHoop, works_as_much_as_the_energy_grows) {
    const Bead bead(down, vertical_circle(0.5), {.motion = turning(7.0)}, {.parameter = 1.0, .speed = 0.5},
                    std::nullopt, 0.25);
    const Trajectory run = bead.run(3.0);
    const auto power = [&](double t) {
        const PointReport r = run[bead.handle].report(t);
        // an ideal rail works through its own motion alone
        const Vector3 carried = Vector3(0, 0, 7.0).cross(r.position);
        EXPECT_NEAR(r.reaction.dot(r.velocity), r.reaction.dot(carried), 1e-12 * r.reaction.norm() * 10.0);
        return r.reaction.dot(carried);
    };
    for (double t : {0.4, 1.1, 2.3}) {
        const double h = 1e-3;
        const double slope =
            (8.0 * (run.energy(t + h) - run.energy(t - h)) - run.energy(t + 2 * h) + run.energy(t - 2 * h)) /
            (12.0 * h);
        EXPECT_NEAR(power(t), slope, 1e-7) << t;
    }
    EXPECT_NEAR(run.work(0.0, 3.0), run.kinetic_energy(3.0) - run.kinetic_energy(0.0), 1e-10);
}

TEST(TurningHoop, rough_carries_a_bead_at_rest_about_its_equilibrium) {
    // sticks where friction holds it; the relative speed is zero and the position in the hoop constant for ever
    const double radius = 0.5, rate = 8.0, angle = std::acos(gravity / (rate * rate * radius)) + 0.02;
    const Bead bead(down, vertical_circle(radius), {.motion = turning(rate)}, {.parameter = angle}, Coulomb{0.2});
    const Trajectory run = bead.run(1000.0);
    EXPECT_TRUE(run.events().empty()) << kinds(run);
    EXPECT_EQ(run[bead.handle].parameter(1000.0), angle);
    EXPECT_NEAR(run[bead.handle].velocity(777.0).norm(), rate * radius * std::sin(angle), 1e-12);
}

// --- straight rails ---

TEST(TurningLine, throws_a_bead_out_with_the_hyperbolic_cosine) {
    const double rate = 1.5, r0 = 0.25, mass = 2.0;
    const Bead bead(Vector3::Zero(), along_x, {.motion = turning(rate)}, {.parameter = r0}, std::nullopt, mass);
    const Trajectory run = bead.run(6.0);
    for (double t : {0.0, 1.0, 3.3, 6.0}) {
        const double r = r0 * std::cosh(rate * t), v = r0 * rate * std::sinh(rate * t);
        const Vector3 along(std::cos(rate * t), std::sin(rate * t), 0.0), across(-along.y(), along.x(), 0.0);
        const double largest = r0 * std::cosh(rate * 6.0);
        EXPECT_LE((run[bead.handle].position(t) - r * along).norm(), 2e-12 * largest);
        EXPECT_LE((run[bead.handle].velocity(t) - v * along - rate * r * across).norm(), 3e-12 * rate * largest);
        EXPECT_NEAR(run[bead.handle].speed(t), v, 2e-12 * rate * largest);
        // Coriolis
        EXPECT_LE((run[bead.handle].reaction(t) - 2.0 * mass * rate * v * across).norm(),
                  4e-12 * mass * rate * rate * largest);
    }
}

TEST(TurningLine, spun_up_has_Eulers_force_too) {
    // angle = b t^2/2: across the line m (2 w v + b r)
    const double b = 0.75, mass = 0.5;
    const Bead bead(Vector3::Zero(), along_x,
                    {.motion = RigidMotion::rotation([=](const auto& t) { return 0.5 * b * t * t; }, {0, 0, 1})},
                    {.parameter = 1.0, .speed = 0.25}, std::nullopt, mass);
    const Trajectory run = bead.run(3.0);
    for (double t : {0.0, 0.7, 1.9, 3.0}) {
        const double r = run[bead.handle].parameter(t), v = run[bead.handle].speed(t);
        const Vector3 along(std::cos(0.5 * b * t * t), std::sin(0.5 * b * t * t), 0.0),
            across(-along.y(), along.x(), 0);
        const Vector3 expected = mass * (2.0 * b * t * v + b * r) * across;
        EXPECT_LE((run[bead.handle].reaction(t) - expected).norm(), 1e-12 * std::max(1.0, expected.norm()));
    }
}

TEST(AcceleratedLine, equals_a_line_at_rest_in_a_tilted_field) {
    const Vector3 a(1.5, -0.5, 2.0);
    for (const auto& friction : {std::optional<Coulomb>(), std::optional<Coulomb>({0.25, 0.125})})
        for (double speed : {0.0, -2.0}) {
            const Bead moved(down, incline(0.75), {.motion = moving(Vector3::Zero(), a)},
                             {.parameter = 0.5, .speed = speed}, friction, 0.5);
            const Bead rest(down - a, incline(0.75), {}, {.parameter = 0.5, .speed = speed}, friction, 0.5);
            const Trajectory run = moved.run(2.0), same = rest.run(2.0);
            ASSERT_EQ(kinds(run), kinds(same));
            for (double t : {0.3, 1.0, 2.0}) {
                EXPECT_NEAR(run[moved.handle].parameter(t), same[rest.handle].parameter(t), 1e-11);
                EXPECT_NEAR(run[moved.handle].speed(t), same[rest.handle].speed(t), 1e-11);
                EXPECT_LE((run[moved.handle].reaction(t) - same[rest.handle].reaction(t)).norm(), 1e-11);
                EXPECT_LE((run[moved.handle].position(t) - same[rest.handle].position(t) - 0.5 * t * t * a).norm(),
                          1e-11);
            }
        }
}

TEST(TranslatedRails, in_uniform_motion_are_as_rails_at_rest) {
    const Vector3 u(1.5, -0.75, 0.25);
    struct Case {
        Curve curve;
        double start, speed;
        std::optional<Coulomb> friction;
    };
    const std::vector<Case> cases{
        {vertical_circle(0.75), 1.0, 2.0, std::nullopt},
        {vertical_circle(0.75), 2.5, 0.0, Coulomb{0.25, 0.125}},
        {Helix{.radius = 0.5, .pitch = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}, 0.5, 3.0, Coulomb{0.5, 0.25}},
        {Parabola{.a = 0.75, .x = {1, 0, 0}, .y = {0, 0, 1}}, 1.0, 0.5, Coulomb{0.2, 0.1}},
        {Cycloid{.radius = 0.5, .x = {1, 0, 0}, .y = {0, 0, 1}}, 2.0, 0.0, std::nullopt}};
    for (const Case& c : cases) {
        const Bead moved(down, c.curve, {.motion = moving(u)}, {.parameter = c.start, .speed = c.speed}, c.friction);
        const Bead rest(down, c.curve, {}, {.parameter = c.start, .speed = c.speed}, c.friction);
        const Trajectory run = moved.run(3.0), same = rest.run(3.0);
        ASSERT_EQ(kinds(run), kinds(same)) << c.curve.name();
        for (std::size_t k = 0; k < run.events().size(); ++k)
            EXPECT_NEAR(run.events()[k].time, same.events()[k].time, 2e-12 * 3.0);
        for (double t : {0.3, 1.0, 2.0, 3.0}) {
            EXPECT_LE((run[moved.handle].position(t) - same[rest.handle].position(t) - t * u).norm(), 2e-11);
            EXPECT_LE((run[moved.handle].velocity(t) - same[rest.handle].velocity(t) - u).norm(), 2e-11);
            EXPECT_LE((run[moved.handle].reaction(t) - same[rest.handle].reaction(t)).norm(), 1e-10);
        }
    }
}

// --- rails that move along themselves ---

TEST(SpinningCircle, smooth_is_not_noticed) {
    // turned along itself; the relative speed is the speed less the rail's
    const double radius = 0.75, rate = 3.0;
    const Bead spun(down, vertical_circle(radius), {.motion = turning(rate, {0, -1, 0})},
                    {.parameter = 1.0, .speed = 2.0 - rate * radius});
    const Bead rest(down, vertical_circle(radius), {}, {.parameter = 1.0, .speed = 2.0});
    const Trajectory run = spun.run(5.0), same = rest.run(5.0);
    expect_same_motion(same, rest.handle, run, spun.handle, 1e-11);
    for (double t : {1.0, 4.0})
        EXPECT_NEAR(run[spun.handle].parameter(t) + rate * t, same[rest.handle].parameter(t), 1e-11);
}

TEST(SpinningCircle, rough_is_a_circle_at_rest_whose_surface_is_driven) {
    const double radius = 0.75;
    for (double rate : {0.5, -2.0, 6.0})
        for (double mu : {0.1, 0.5, 1.5}) {
            const Coulomb friction{mu, 0.8 * mu};
            const Bead spun(down, vertical_circle(radius), {.motion = turning(rate, {0, -1, 0})},
                            {.parameter = 1.0, .speed = 0.5 - rate * radius}, friction);
            const Bead driven(down, vertical_circle(radius), {.drive = rate * radius}, {.parameter = 1.0, .speed = 0.5},
                              friction);
            expect_same_motion(driven.run(3.0, 1e-10), driven.handle, spun.run(3.0, 1e-10), spun.handle, 1e-9);
        }
}

TEST(ShakenTable, holds_a_bead_while_the_acceleration_is_within_the_cone) {
    const double mu = 0.5, w = 5.0, limit = mu * gravity / (w * w);
    for (double share : {0.5, 0.999, 1.001, 3.0}) {
        const double amplitude = share * limit;
        const RigidMotion shaking = RigidMotion::translation([=](const auto& t) {
            using S = std::decay_t<decltype(t)>;
            return Vector3Of<S>{amplitude * sin(w * t), S(0.0), S(0.0)};
        });
        const Bead bead(down, along_x, {.motion = shaking}, {.parameter = 0.25}, Coulomb{mu, 0.3});
        const Trajectory run = bead.run(4.0);
        if (share < 1.0) {
            EXPECT_TRUE(run.events().empty()) << share;
            EXPECT_EQ(run[bead.handle].parameter(4.0), 0.25);
            continue;
        }
        ASSERT_GE(run.events().size(), 2u);
        const double first = std::asin(1.0 / share) / w;
        EXPECT_EQ(run.events()[0].kind, EventKind::slip);
        // near the threshold the reaction meets the cone flatly
        EXPECT_NEAR(run.events()[0].time, first, 2e-13 / std::sqrt(share - 1.0));
        // sliding, it is slowed by the dynamic friction alone
        const double t = 0.5 * (first + run.events()[1].time);
        EXPECT_NEAR(run[bead.handle].velocity(t).x(), amplitude * w * std::cos(w * first) - 0.3 * gravity * (t - first),
                    1e-11);
    }
}

TEST(ShakenTable, along_itself_is_a_table_at_rest_whose_surface_is_driven) {
    const double w = 5.0, amplitude = 0.5;
    const RigidMotion shaking = RigidMotion::translation([=](const auto& t) {
        using S = std::decay_t<decltype(t)>;
        return Vector3Of<S>{amplitude * sin(w * t), S(0.0), S(0.0)};
    });
    for (double mu : {0.2, 0.7, 1.1}) {
        const Coulomb friction{mu, 0.75 * mu};
        const Bead shaken(down, along_x, {.motion = shaking}, {.parameter = 0.25}, friction);
        const Bead driven(down, along_x, {.drive = [=](const auto& t) { return amplitude * w * cos(w * t); }},
                          {.parameter = 0.25, .speed = amplitude * w}, friction);
        const Trajectory run = shaken.run(3.0, 1e-11), same = driven.run(3.0, 1e-11);
        EXPECT_GE(run.events().size(), 3u);
        expect_same_motion(same, driven.handle, run, shaken.handle, 1e-10);
    }
}

TEST(ShakenTable, up_and_down_lightens_and_loads_the_friction) {
    // on a slope below the cone at rest nothing changes it: both sides of the cone scale with g + z''
    const RigidMotion shaking = RigidMotion::translation([](const auto& t) {
        using S = std::decay_t<decltype(t)>;
        return Vector3Of<S>{S(0.0), S(0.0), 0.125 * sin(8.0 * t)};
    });
    const Bead held(down, incline(0.5), {.motion = shaking}, {.parameter = 0.25}, Coulomb{0.6, 0.3});
    EXPECT_TRUE(held.run(20.0).events().empty());
    // sliding up it stops after the effective time: v0 = (sin + mu cos) (g t + z'(t) - z'(0))
    const Bead sliding(down, along_x, {.motion = shaking}, {.parameter = 0.0, .speed = 2.0}, Coulomb{0.3, 0.25});
    const Trajectory run = sliding.run(3.0);
    ASSERT_EQ(kinds(run), "stick");
    const double t = run.events()[0].time;
    EXPECT_NEAR(0.25 * (gravity * t + std::cos(8.0 * t) - 1.0), 2.0, 1e-11);
}

// --- all kinds together ---

TEST(MovingRails, seen_from_a_turned_world_have_the_turned_motion) {
    Random random(5);
    const Curve curve = vertical_circle(0.75);
    const Vector3 axis(0.2, -0.5, 1.0), point(0.3, 0.1, -0.2);
    const auto angle = [](const auto& t) { return 2.0 * sin(1.5 * t); };
    for (int k = 0; k < 3; ++k) {
        const Eigen::AngleAxisd turn(random.uniform(0.3, 3.0), random.direction());
        const Matrix3 q = turn.toRotationMatrix();
        const Bead plain(down, curve, {.motion = RigidMotion::rotation(angle, axis, point)},
                         {.parameter = 1.0, .speed = 0.5}, Coulomb{0.3, 0.2});
        const Bead turned(q * down,
                          Circle{.radius = 0.75, .start = q * Vector3(0, 0, -1), .toward = q * Vector3(1, 0, 0)},
                          {.motion = RigidMotion::rotation(angle, q * axis, q * point)},
                          {.parameter = 1.0, .speed = 0.5}, Coulomb{0.3, 0.2});
        const Trajectory a = plain.run(3.0, 1e-10), b = turned.run(3.0, 1e-10);
        ASSERT_EQ(kinds(a), kinds(b));
        for (double t : {0.5, 1.5, 3.0}) {
            EXPECT_LE((q * a[plain.handle].position(t) - b[turned.handle].position(t)).norm(), 1e-9);
            EXPECT_LE((q * a[plain.handle].reaction(t) - b[turned.handle].reaction(t)).norm(), 1e-8);
        }
    }
}

TEST(MovingRails, reaction_is_what_the_acceleration_of_the_path_asks_for) {
    // the acceleration by differences of the velocity, no formula of the library's
    const RigidMotion motion = RigidMotion::rotation([](const auto& t) { return 2.0 * sin(1.5 * t) + t; },
                                                     Vector3(0.2, -0.5, 1.0), Vector3(0.3, 0.1, -0.2));
    for (const auto& friction : {std::optional<Coulomb>(), std::optional<Coulomb>({0.05, 0.04})}) {
        const Bead bead(down, Helix{.radius = 0.5, .pitch = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}},
                        {.motion = motion}, {.parameter = 0.5, .speed = 3.0}, friction, 0.75);
        const Trajectory run = bead.run(1.0);
        for (double t : {0.2, 0.5, 0.8}) {
            const double h = 1e-3;
            const auto v = [&](double at) { return run[bead.handle].velocity(at); };
            const Vector3 a = (8.0 * (v(t + h) - v(t - h)) - v(t + 2 * h) + v(t - 2 * h)) / (12.0 * h);
            const auto r = [&](double at) { return run[bead.handle].position(at); };
            const Vector3 velocity = (8.0 * (r(t + h) - r(t - h)) - r(t + 2 * h) + r(t - 2 * h)) / (12.0 * h);
            EXPECT_LE((velocity - v(t)).norm(), 1e-7 * v(t).norm());
            const Vector3 reaction = 0.75 * (a - down);
            EXPECT_LE((run[bead.handle].reaction(t) - reaction).norm(), 1e-6 * reaction.norm()) << t;
        }
    }
}

TEST(MovingRails, in_other_units_have_the_same_motion_bit_by_bit) {
    const auto numbers = [](double length, double time, double mass) {
        const Bead bead(
            down * (length / (time * time)), vertical_circle(0.75 * length),
            {.motion = RigidMotion::rotation([=](const auto& t) { return 2.0 * sin(t * (1.5 / time)); }, {0, 0, 1})},
            {.parameter = 1.0, .speed = 0.5 * length / time}, Coulomb{0.3, 0.2}, mass);
        const Trajectory run = simulate(bead.scene, {.until = 3.0 * time, .error = 1e-10});
        std::vector<double> result;
        for (const Event& e : run.events()) result.push_back(e.time / time);
        for (double t : {0.5, 1.7, 3.0})
            for (int i = 0; i < 3; ++i) {
                result.push_back(run[bead.handle].position(t * time)[i] / length);
                result.push_back(run[bead.handle].reaction(t * time)[i] * time * time / (length * mass));
            }
        return result;
    };
    const auto expected = numbers(1.0, 1.0, 1.0);
    for (int k : {-40, 7, 60}) {
        EXPECT_EQ(numbers(std::ldexp(1.0, k), 1.0, 1.0), expected) << k;
        EXPECT_EQ(numbers(1.0, std::ldexp(1.0, k), 1.0), expected) << k;
        EXPECT_EQ(numbers(1.0, 1.0, std::ldexp(1.0, k)), expected) << k;
    }
}

TEST(MovingRails, that_end_throw_a_bead_with_the_velocity_of_the_rail_too) {
    const Vector3 u(1.5, -0.75, 0.25);
    const Polynomial ramp{.coefficients = {{0, 0, 0}, {4, 0, -3}}, .domain = {0.0, 1.0}};
    const Bead bead(down, ramp, {.motion = moving(u), .ends = RailEnds::release}, {.parameter = 0.0});
    const Trajectory run = bead.run(3.0);
    ASSERT_EQ(kinds(run), "rail-end");
    const double t = run.events()[0].time, v = 0.6 * gravity * t;
    EXPECT_NEAR(0.5 * v * t, 5.0, 1e-11);
    EXPECT_LE((run[bead.handle].velocity(t) - u - v * Vector3(0.8, 0.0, -0.6)).norm(), 1e-11);
    const double s = 3.0 - t;
    EXPECT_LE((run[bead.handle].position(3.0) - u * t - Vector3(4, 0, -3) - s * (u + v * Vector3(0.8, 0.0, -0.6)) -
               0.5 * s * s * down)
                  .norm(),
              1e-10);
}

TEST(MovingRails, start_later_where_they_are_by_then) {
    const Bead bead(down, vertical_circle(0.5), {.motion = turning(7.0)}, {.parameter = 1.0, .speed = 0.5});
    const Trajectory from_zero = bead.run(2.0), later = bead.run(7.0, 1e-12, 5.0);
    // the turn makes no difference to the motion in the hoop
    for (double t : {0.0, 0.5, 2.0})
        EXPECT_NEAR(later[bead.handle].parameter(5.0 + t), from_zero[bead.handle].parameter(t), 1e-11);
    EXPECT_LE((later[bead.handle].position(5.0) -
               0.5 * Vector3(std::sin(1.0) * std::cos(35.0), std::sin(1.0) * std::sin(35.0), -std::cos(1.0)))
                  .norm(),
              1e-13);
}

TEST(MovingRails, with_drag_are_resisted_by_a_medium_at_rest) {
    // a bead stuck to a rail carried through the medium: held, and the rail pays
    const Vector3 u(2.0, 0.0, 0.0);
    Bead bead(down, along_x, {.motion = moving(u)}, {.parameter = 0.0}, Coulomb{0.5}, 1.0);
    const LoadHandle drag = bead.scene.apply(Drag{.linear = 0.5, .quadratic = 0.25}, bead.handle);
    const Trajectory run = bead.run(5.0);
    EXPECT_TRUE(run.events().empty());
    EXPECT_NEAR(run.power(2.5, drag), -(0.5 * 4.0 + 0.25 * 8.0), 1e-12);
    EXPECT_LE((run[bead.handle].reaction(2.5) - Vector3(2.0, 0.0, gravity)).norm(), 1e-12);
    // smooth, it comes to rest in the medium: u' = -c u
    Bead smooth(down, along_x, {.motion = moving(u)}, {.parameter = 0.0}, std::nullopt, 1.0);
    smooth.scene.apply(Drag{.linear = 0.5}, smooth.handle);
    const Trajectory free = smooth.run(5.0);
    EXPECT_NEAR(free[smooth.handle].velocity(5.0).x(), 2.0 * std::exp(-2.5), 1e-11);
}

TEST(MovingRails, are_refused_where_nobody_knows_the_landing_or_no_rigid_motion_is_given) {
    EXPECT_THROW(Rail(vertical_circle(1.0), std::nullopt, {.motion = turning(1.0), .side = RailSide::plus}),
                 InvalidInput);
    const auto matrix = [](double a, double b) {
        return RigidMotion(Function::record(1, [=](const std::vector<Expression>& t) {
            return std::vector<Expression>{a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, 1.0, t[0], 0.0, 0.0};
        }));
    };
    EXPECT_NO_THROW(matrix(1.0, 1.0));
    EXPECT_THROW(matrix(1.0, -1.0), InvalidInput);
    EXPECT_THROW(matrix(2.0, 0.5), InvalidInput);
    EXPECT_THROW(RigidMotion::rotation([](const auto& t) { return t; }, Vector3::Zero()), InvalidInput);
}

TEST(MovingRails, have_a_frame_of_frenet_that_turns_with_them) {
    constexpr double rate = 2.0, radius = 0.5;
    Scene scene(down);
    const RailOptions hoop{.motion = RigidMotion::rotation([=](const auto& t) { return rate * t; }, {0, 0, 1})};
    const BodyHandle bead =
        scene.add(Particle{0.25}, Rail(vertical_circle(radius), std::nullopt, hoop), {.parameter = 0.75, .speed = 1.0});
    const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-11});
    for (const double t : {0.0, 0.25, 0.9, 2.0}) {
        const double u = run[bead].parameter(t), turn = rate * t;
        const Vector3 out(std::cos(turn), std::sin(turn), 0), up(0, 0, 1);
        const Vector3 tangent = std::cos(u) * out + std::sin(u) * up, normal = std::cos(u) * up - std::sin(u) * out;
        const Vector3 reaction = run[bead].reaction(t), frenet = run[bead].reaction_frenet(t);
        EXPECT_NEAR(frenet[0], 0.0, 1e-12) << t;
        EXPECT_NEAR(reaction.dot(tangent), 0.0, 1e-12) << t;
        EXPECT_NEAR(frenet[1], reaction.dot(normal), 1e-12) << t;
        EXPECT_NEAR(frenet[2], reaction.dot(tangent.cross(normal)), 1e-12) << t;
        // Coriolis: across the hoop 2 m Omega v cos u
        EXPECT_NEAR(std::abs(frenet[2]), std::abs(2.0 * 0.25 * rate * run[bead].speed(t) * std::cos(u)), 1e-9) << t;
    }
}

}  // namespace
}  // namespace rbdyn::test::test_moving_rails
