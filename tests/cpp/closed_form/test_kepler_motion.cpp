// Kepler's motion in closed form: conics of every kind, there and back, against series, and what has none.
#include <gtest/gtest.h>

#include "rbdyn/closed_form/kepler_motion.hpp"
#include "rbdyn/special/two_body_motion.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "random.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"
#include "support.hpp"

namespace rbdyn::test::test_kepler_motion {
namespace {

using Wide = DoubleDouble;
using WideVector = Vector3Of<Wide>;

double relative(const WideVector& a, const WideVector& b) { return rounded(a - b).norm() / rounded(b).norm(); }

Vector3 some(Random& random, double size) {
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

TEST(KeplerMotion, is_not_refused_for_the_rounding_of_the_error_that_is_asked_for) {
    Scene scene;
    const Vector3 place(-1267598980.8976488, 365100164.2583233, 1387752469.4196053),
        apart(1553455249.7026067, -791177197.975116, -1200148822.3585756);
    const BodyHandle a = scene.add(Particle{3.217029430317578e-11}, {.position = place}, "a"),
                     b = scene.add(
                         Particle{1.1008587198350558e-16},
                         {.position = place + apart,
                          .velocity = {-3.4401463125952376e-12, 1.6010822273244288e-12, 1.3954191780893229e-11}},
                         "b");
    scene.connect(Gravitation{0.006878927594340793}, a, b);
    for (double error = 1e-8; error > 5e-14; error *= 0.7) {
        const Attempt run = attempt(scene, {.until = 3.686014277496344e+18, .error = error});
        EXPECT_EQ(run.message, "") << error;
        EXPECT_LE(*run.run.error(), error);
    }
}

TEST(KeplerMotion, comes_back_from_where_it_went_in_thirty_digits_less_what_the_orbit_makes_of_them) {
    Random random(20261101);
    int closed = 0, open = 0;
    for (int i = 0; i < 4000; ++i) {
        const WideVector place = widened(some(random, random.logarithmic(1e-3, 1e3)));
        const Wide mu = random.logarithmic(1e-4, 1e4) * (random.chance(0.2) ? -1.0 : 1.0);
        // from near the speed of escape to a tenth or ten times of it
        const double escape = std::sqrt(2.0 * std::abs(mu.hi) / rounded(place).norm());
        const double kind = random.uniform(0.0, 1.0),
                     near = random.logarithmic(1e-15, 1e-1) * (random.chance(0.5) ? 1.0 : -1.0);
        double part = random.logarithmic(0.01, 100.0);
        Vector3 way = random.direction();
        if (kind < 0.3) part = 1.0 + near;
        if (kind > 0.6 && mu.hi > 0.0) {
            // next to a circle
            part = std::sqrt(0.5) * (1.0 + near);
            way = rounded(place).cross(way).normalized();
        }
        const WideVector velocity = widened(part * escape * way);
        const KeplerMotion there(mu, place, velocity);
        const bool is_closed = std::isfinite(there.period());
        (is_closed ? closed : open) += 1;
        const double time =
            rounded(place).norm() / escape * random.logarithmic(1e-4, 1e7) * (random.chance(0.5) ? 1.0 : -1.0);
        const KeplerMotion::State far = there.at({time, 0.0});
        const KeplerMotion back(mu, far.place, far.velocity);
        const KeplerMotion::State home = back.at({-time, 0.0});
        // the estimate is of 29 digits; of them what the way back makes, of speeds the escape's
        const double allowed = 1e7 * there.error(time);
        EXPECT_LE(relative(home.place, place), allowed) << i << ", " << part << " of escape, " << time << " s";
        EXPECT_LE(rounded(home.velocity - velocity).norm(), allowed * (1.0 + part) * escape)
            << i << ", " << part << " of escape, " << time << " s";
        // 2 mu / r - v^2 stays
        const auto lack = [&](const KeplerMotion::State& s) {
            return 2.0 * mu / sqrt(dot<Wide>(s.place, s.place)) - dot<Wide>(s.velocity, s.velocity);
        };
        EXPECT_LE(std::abs((lack(far) - lack({place, velocity})).hi),
                  1e-22 * (2.0 * std::abs(mu.hi) / rounded(far.place).norm() + rounded(velocity).squaredNorm()));
        EXPECT_LE(there.pericentre(), rounded(place).norm() * (1.0 + 1e-7));
    }
    EXPECT_GT(closed, 1000);
    EXPECT_GT(open, 1000);
}

TEST(KeplerMotion, of_an_ellipse_has_its_known_places) {
    // a = 1, e = 3/5, mu = 1, from the pericentre (2/5, 0): at the apocentre (-8/5, 0) after pi, and where E = pi/2, at
    // (-3/5, 4/5), after pi/2 - 3/5
    const KeplerMotion motion(1.0, {0.4, 0.0, 0.0}, {0.0, 2.0, 0.0});
    EXPECT_NEAR(motion.period(), 2.0 * std::numbers::pi, 4e-15);  // 2/5 is none of binary
    EXPECT_NEAR(motion.pericentre(), 0.4, 1e-16);
    EXPECT_NEAR(motion.largest_speed(), 2.0, 1e-15);
    const auto at = [&](double t) { return rounded(motion.at({t, 0.0}).place); };
    EXPECT_LT((at(std::numbers::pi) - Vector3(-1.6, 0, 0)).norm(), 1e-15);
    EXPECT_LT((at(std::numbers::pi / 2 - 0.6) - Vector3(-0.6, 0.8, 0)).norm(), 1e-15);
    EXPECT_LT((at(-std::numbers::pi / 2 + 0.6) - Vector3(-0.6, -0.8, 0)).norm(), 1e-15);
    // Barker's equation: the parabola of pericentre 1 with mu = 2 has y = 2 D where t = D + D^3 / 3
    const KeplerMotion parabola(2.0, {1.0, 0.0, 0.0}, {0.0, 2.0, 0.0});
    for (const double d : {0.1, 1.0, 3.0, -20.0})
        EXPECT_NEAR(parabola.at({d + d * d * d / 3.0, 0.0}).place[1].hi, 2.0 * d, 4e-15 * std::abs(d)) << d;
}

/// Two bodies, or one and a fixed point, with their relative speed as a part of that of escape.
struct Pair {
    Scene scene;
    std::vector<BodyHandle> bodies;
    double time;  // [s] that of a turn, or of the like
};
Pair pair(Random& random, bool is_fixed) {
    Pair p;
    const double first = random.logarithmic(0.1, 10.0), second = random.logarithmic(0.1, 10.0),
                 strength = random.logarithmic(0.5, 5.0), distance = random.logarithmic(0.5, 3.0);
    const Vector3 center = some(random, 1.0), apart = distance * random.direction();
    const bool is_gravity = !is_fixed && random.chance(0.5), repels = !is_gravity && random.chance(0.3);
    const double mu =
        is_gravity ? strength * (first + second) : strength * (1.0 / first + (is_fixed ? 0.0 : 1.0 / second));
    const double escape = std::sqrt(2.0 * mu / distance);
    Vector3 velocity = random.uniform(0.3, 1.5) * escape * random.direction();
    p.time = 2.0 * std::numbers::pi * distance / escape;
    const double sign = repels ? 1.0 : -1.0;
    const Central central([=](const auto& r) { return sign * strength / (r * r); });
    if (is_fixed) {
        p.bodies.push_back(p.scene.add(Particle{first}, {.position = center + apart, .velocity = velocity}));
        p.scene.connect(central, p.bodies[0], center);
        return p;
    }
    if (random.chance(0.5)) p.scene.set_gravity(some(random, 5.0));
    const Vector3 drift = some(random, 1.0);
    p.bodies.push_back(p.scene.add(Particle{first}, {.position = center, .velocity = drift}));
    p.bodies.push_back(p.scene.add(Particle{second}, {.position = center + apart, .velocity = drift + velocity}));
    if (is_gravity)
        p.scene.connect(Gravitation{strength}, p.bodies[1], p.bodies[0]);
    else
        p.scene.connect(central, p.bodies[0], p.bodies[1]);
    return p;
}

TEST(TwoBodies, move_in_closed_form_as_their_series_do) {
    Random random(20261102);
    for (int i = 0; i < 30; ++i) {
        const Pair p = pair(random, i % 3 == 0);
        const double until = p.time * random.logarithmic(0.3, 5.0);
        ASSERT_EQ(make_plan(p.scene).engine, "closed form") << i;
        const Trajectory closed = simulate(p.scene, {.until = until, .error = 1e-12});
        const Attempt series = attempt(p.scene, {.until = until, .error = 1e-10, .engine = "taylor"});
        ASSERT_EQ(series.outcome, simulating::Outcome::good) << i << ": " << series.message;
        for (const BodyHandle b : p.bodies) {
            const Scales s = scales(closed, b);
            for (const double part : {0.2, 0.5, 0.77, 1.0}) {
                EXPECT_LE((closed[b].position(part * until) - series.run[b].position(part * until)).norm(),
                          (*series.run.error() + *closed.error()) * s.extent)
                    << i;
                EXPECT_LE((closed[b].velocity(part * until) - series.run[b].velocity(part * until)).norm(),
                          (*series.run.error() + *closed.error()) * s.speed)
                    << i;
            }
        }
    }
}

TEST(TwoBodies, have_their_events_at_their_times) {
    // e = 3/5: the distance is 1 at E = +-pi/2, t = pi/2 - 3/5 and 2 pi less that
    Scene scene;
    const auto planet = scene.add(Particle{1.0}, {.position = {0.4, 0, 0}, .velocity = {0, 2.0, 0}});
    scene.connect(Central([](const auto& r) { return -1.0 / (r * r); }), planet, Vector3(0, 0, 0));
    scene.watch("distance", [=](const Now& now) { return length(now[planet].position()) - 1.0; });
    const Trajectory run = simulate(scene, {.until = 200.0 * std::numbers::pi, .error = 1e-13});
    EXPECT_EQ(run.engine(), "closed form");
    ASSERT_EQ(run.events().size(), 200u);
    const double first = std::numbers::pi / 2 - 0.6;
    for (std::size_t k = 0; k < 200; ++k) {
        const double turn = 2.0 * std::numbers::pi * static_cast<double>(k / 2);
        EXPECT_NEAR(run.events()[k].time, k % 2 == 0 ? turn + first : turn + 2.0 * std::numbers::pi - first,
                    1e-15 * (turn + 10.0));
    }
}

TEST(TwoBodies, have_a_closed_form_under_an_inverse_square_alone) {
    const auto reason = [](const Scene& scene) {
        const Plan p = make_plan(scene);
        for (const Omission& o : p.omissions)
            if (o.what == "closed form") return o.why;
        return p.engine;
    };
    const auto with = [&](const Central& law, const Vector3& velocity, const Vector3& gravity = Vector3(0, 0, 0)) {
        Scene scene(gravity);
        const auto b = scene.add(Particle{2.0}, {.position = {1, 0, 0}, .velocity = velocity});
        scene.connect(law, b, Vector3(0, 0, 0));
        return reason(scene);
    };
    const Vector3 across(0, 1, 0);
    EXPECT_EQ(with(Central([](const auto& r) { return -3.0 / (r * r); }), across), "closed form");
    EXPECT_EQ(with(Central([](const auto& r) { return -3.0 * pow(r, -2.0); }), across), "closed form");
    EXPECT_NE(with(Central([](const auto& r) { return -3.0 / (r * r) + 1e-20 * r; }), across), "closed form");
    EXPECT_NE(with(Central([](const auto& r) { return -3.0 / (r * r * r); }), across), "closed form");
    EXPECT_NE(with(Central([](const auto& r) { return where(r < 1e6, -3.0 / (r * r), 0.0 * r); }), across),
              "closed form");
    EXPECT_NE(with(Central([](const auto& r) { return -3.0 / (r * r); }), across, {0, 0, -9.81}), "closed form");
    EXPECT_EQ(with(Central([](const auto& r) { return -3.0 / (r * r); }), Vector3(-1, 0, 0)),
              "the two move along one line");
}

}  // namespace
}  // namespace rbdyn::test::test_kepler_motion
