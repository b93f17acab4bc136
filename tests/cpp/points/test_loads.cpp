// Forces of every kind on free particles and beads against closed forms; functions with cases located to rounding.
#include <gtest/gtest.h>

#include <numbers>

#include "support.hpp"

namespace rbdyn::test::test_loads {
namespace {

constexpr double pi = std::numbers::pi;
const Vector3 none = Vector3::Zero();

/// Units in the last place of the larger one between two times.
double ulps(double a, double b) {
    const double largest = std::max(std::abs(a), std::abs(b));
    return std::abs(a - b) / (std::nextafter(largest, 1e300) - largest);
}

/// A free particle on the x axis under a force f(t, x, v) along it.
template <class F>
Trajectory along_axis(F f, double x0, double v0, double until, double error = 1e-12) {
    Scene scene;
    const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{x0, 0, 0}, {v0, 0, 0}});
    scene.apply(Force([=](const auto& t, const auto& r, const auto& v) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{f(t, r[0], v[0]), S(0.0), S(0.0)};
                }),
                body);
    return simulate(scene, {.until = until, .error = error});
}
const BodyHandle first{0};

// --- potentials ---

TEST(Potentials, give_the_force_that_is_their_slope) {
    // U = -(k/2) |r|^2 - b x^2 y + m / sqrt(1 + |r|^2), F = grad U
    const double k = 3.0, b = 0.5, m = 2.0;
    const auto potential = [=](const auto& r) {
        const auto square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
        return -0.5 * k * square - b * r[0] * r[0] * r[1] + m / sqrt(1.0 + square);
    };
    const auto force = [=](const auto& t, const auto& r, const auto&) {
        using S = std::decay_t<decltype(t)>;
        const auto square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
        const auto pull = -k - m / ((1.0 + square) * sqrt(1.0 + square));
        return Vector3Of<S>{pull * r[0] - 2.0 * b * r[0] * r[1], pull * r[1] - b * r[0] * r[0], pull * r[2]};
    };
    for (const bool is_bead : {false, true}) {
        const auto run_with = [&](const Load& load) {
            Scene scene(down);
            const BodyHandle body =
                is_bead ? scene.add(Particle{0.5}, Rail(vertical_circle(0.75)), {.parameter = 1.0, .speed = 0.25})
                        : scene.add(Particle{0.5}, FreeStart{{0.5, 0.1, -0.2}, {0.3, 0.7, -0.1}});
            scene.apply(load, body);
            return simulate(scene, {.until = 6.0, .error = 1e-11});
        };
        const Trajectory a = run_with(Potential(potential)), c = run_with(Force(force));
        const Scales scale = scales(a, first);
        for (double t : {0.0, 1.0, 3.0, 6.0}) {
            EXPECT_LE((a[first].position(t) - c[first].position(t)).norm(), 2e-11 * scale.extent) << t;
            EXPECT_LE((a[first].force(t) - c[first].force(t)).norm(), 1e-9);
        }
        ASSERT_TRUE(a.drift().contains("energy"));
        EXPECT_LE(a.drift().at("energy"), 1e-11);
        // of a force alone nobody knows a potential in space, but along a rail it has one (7.18)
        EXPECT_EQ(c.drift().contains("energy"), is_bead);
        // T - U with gravity
        const Vector3 r = a[first].position(2.0);
        const double u = -0.5 * k * r.squaredNorm() - b * r.x() * r.x() * r.y() + m / std::sqrt(1.0 + r.squaredNorm());
        EXPECT_NEAR(a.potential(2.0), u - 0.5 * gravity * r.z(), 1e-12);
    }
}

TEST(Potentials, of_Kepler_close_their_ellipse) {
    // U = mu m / r; from the perihelion 1 - e with a = 1
    const double e = 0.75, mu = 1.0;
    Scene scene;
    const BodyHandle body =
        scene.add(Particle{2.0}, FreeStart{{1.0 - e, 0, 0}, {0, std::sqrt(mu * (1.0 + e) / (1.0 - e)), 0}});
    scene.apply(Potential([=](const auto& r) { return 2.0 * mu / sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]); }),
                body);
    const Trajectory run = simulate(scene, {.until = 20.0 * pi, .error = 1e-10});
    EXPECT_LE((run[body].position(20.0 * pi) - Vector3(1.0 - e, 0, 0)).norm(), 2e-10);
    EXPECT_NEAR(run[body].position(pi).x(), -1.0 - e, 1e-10);
    EXPECT_LE(run.drift().at("energy"), 1e-11);
}

// --- magnetic and electric ---

TEST(MagneticForce, turns_a_charge_on_circles_with_the_cyclotron_frequency) {
    for (double strength : {2.0, -0.5}) {
        const double mass = 0.25, field = 3.0, v = 1.5, along = 0.75;
        const double w = strength * field / mass, radius = v / std::abs(w);
        Scene scene;
        const BodyHandle body = scene.add(Particle{mass}, FreeStart{{0, 0, 0}, {v, 0, along}});
        const LoadHandle load = scene.apply(Lorentz{strength, {0, 0, field}}, body);
        const double period = 2.0 * pi / std::abs(w);
        const Trajectory run = simulate(scene, {.until = 20.0 * period, .error = 1e-12});
        // v x B with B up: to the right of the way for a positive charge
        for (double t : {0.1 * period, 3.3 * period, 20.0 * period}) {
            const Vector3 place(v / w * std::sin(w * t), v / w * (std::cos(w * t) - 1.0), along * t);
            EXPECT_LE((run[body].position(t) - place).norm(), 1e-12 * 20.0 * period * along) << t;
            EXPECT_NEAR(run[body].velocity(t).norm(), std::hypot(v, along), 1e-12);
            EXPECT_NEAR(run.power(t, load), 0.0, 1e-13 * std::abs(strength) * field * v * v * 10.0);
        }
        EXPECT_LE((run[body].position(period) - Vector3(0, 0, along * period)).norm(), 1e-11 * radius * 40.0);
        ASSERT_TRUE(run.drift().contains("energy"));
        EXPECT_LE(run.drift().at("energy"), 1e-12);
    }
}

TEST(MagneticForce, with_an_electric_one_drifts_across_both) {
    // E x B / B^2, whatever the charge
    const Vector3 electric(0.5, 0.25, 0.0), field(0.0, 0.0, 2.0);
    for (double charge : {3.0, -1.0}) {
        Scene scene;
        const BodyHandle body = scene.add(Particle{0.5}, FreeStart{{0, 0, 0}, {0.1, -0.2, 0.0}});
        scene.apply(Lorentz{charge, field}, body);
        scene.apply(Force(Vector3(charge * electric)), body);
        const double period = 2.0 * pi * 0.5 / (std::abs(charge) * 2.0);
        const Trajectory run = simulate(scene, {.until = 10.0 * period, .error = 1e-12});
        const Vector3 drift = electric.cross(field) / field.squaredNorm();
        EXPECT_LE((run[body].position(10.0 * period) - 10.0 * period * drift).norm(),
                  1e-11 * (10.0 * period * drift.norm()));
        EXPECT_LE(run.drift().at("energy"), 1e-12);
    }
}

TEST(MagneticForce, across_a_rail_presses_and_does_not_drive) {
    for (const bool is_rough : {false, true}) {
        Scene scene(down), plain(down);
        const Rail rail(vertical_circle(0.75), is_rough ? std::optional<Coulomb>({0.2, 0.1}) : std::nullopt);
        const BodyHandle a = scene.add(Particle{0.5}, rail, {.parameter = 1.0, .speed = 1.0});
        plain.add(Particle{0.5}, rail, {.parameter = 1.0, .speed = 1.0});
        scene.apply(Lorentz{2.0, {0.3, -1.0, 0.5}}, a);
        const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-11}),
                         free = simulate(plain, {.until = 2.0, .error = 1e-11});
        if (is_rough) {
            EXPECT_GT(std::abs(run[a].parameter(2.0) - free[a].parameter(2.0)), 1e-4);
        } else {
            EXPECT_NEAR(run[a].parameter(2.0), free[a].parameter(2.0), 2e-11);
            const Vector3 press = 2.0 * run[a].velocity(1.3).cross(Vector3(0.3, -1.0, 0.5));
            EXPECT_LE((run[a].reaction(1.3) + press - free[a].reaction(1.3)).norm(), 1e-10 * press.norm() * 10.0);
        }
    }
}

// --- resistance ---

TEST(QuadraticDrag, from_rest_and_through_a_reversal_has_the_speeds_of_tan_and_tanh) {
    // up: v = w tan(c - g t / w); down: v = -w tanh(g t / w), w^2 = m g / k
    const double mass = 0.5, k = 0.02, w = std::sqrt(mass * gravity / k);
    for (const bool by_force : {false, true})
        for (double v0 : {0.0, 10.0, 50.0}) {
            Scene scene(down);
            const BodyHandle body = scene.add(Particle{mass}, FreeStart{{0, 0, 0}, {0, 0, v0}});
            if (by_force)
                scene.apply(Force([=](const auto& t, const auto&, const auto& v) {
                                using S = std::decay_t<decltype(t)>;
                                return Vector3Of<S>{S(0.0), S(0.0), -k * abs(v[2]) * v[2]};
                            }),
                            body);
            else
                scene.apply(Drag{.quadratic = k}, body);
            const Trajectory run = simulate(scene, {.until = 8.0, .error = 1e-12});
            const double top = w / gravity * std::atan(v0 / w);
            const auto turns = run.events().times("switch");
            if (v0 > 0.0) {
                ASSERT_EQ(turns.size(), 1u) << by_force << kinds(run);
                EXPECT_NEAR(turns[0], top, 1e-12 * top);
            } else {
                EXPECT_TRUE(run.events().empty()) << kinds(run);
            }
            for (double t : {0.1, 0.5, 2.0, 8.0}) {
                const double v =
                    t < top ? w * std::tan((top - t) * gravity / w) : -w * std::tanh((t - top) * gravity / w);
                EXPECT_NEAR(run[body].velocity(t).z(), v, 1e-11 * std::max(v0, w)) << v0 << ' ' << t;
            }
        }
}

TEST(LinearDrag, by_force_and_by_drag_is_the_same) {
    const auto run_with = [](const Load& load) {
        Scene scene(down);
        const BodyHandle body = scene.add(Particle{0.5}, Rail(vertical_circle(1.0)), {.parameter = 2.0});
        scene.apply(load, body);
        return simulate(scene, {.until = 5.0, .error = 1e-11});
    };
    const Trajectory a = run_with(Drag{.linear = 0.25});
    const Trajectory b = run_with(Force([](const auto&, const auto&, const auto& v) {
        return std::decay_t<decltype(v)>{-0.25 * v[0], -0.25 * v[1], -0.25 * v[2]};
    }));
    for (double t : {1.0, 2.0, 5.0}) EXPECT_NEAR(a[first].parameter(t), b[first].parameter(t), 1e-10);
}

// --- cases ---

TEST(Cases, of_time_switch_at_that_time_to_rounding) {
    for (double at : {0.1, 1.0 / 3.0, 0.7, 1.9}) {
        const Trajectory run = along_axis(
            [=](const auto& t, const auto& x, const auto&) {
                using S = std::decay_t<decltype(t)>;
                return where(t > at, S(1.0), -x);
            },
            1.0, 0.0, 2.0);
        const auto times = run.events().times("switch");
        ASSERT_EQ(times.size(), 1u) << kinds(run);
        EXPECT_LE(ulps(times[0], at), 4.0) << at;
        const double s = 2.0 - at;
        EXPECT_NEAR(run[first].position(2.0).x(), std::cos(at) - std::sin(at) * s + 0.5 * s * s, 1e-12);
        // the force is that of its side
        EXPECT_NEAR(run[first].force(at).x(), 1.0, 1e-15);
        EXPECT_NEAR(run[first].force(at, Side::before).x(), -std::cos(at), 1e-12);
    }
}

TEST(Cases, of_place_switch_where_it_is_reached) {
    // free to x = 1, then pulled back: x = v t, until 1/v
    for (double v : {0.7, 1.0, 3.0}) {
        const Trajectory run = along_axis(
            [](const auto& t, const auto& x, const auto&) {
                using S = std::decay_t<decltype(t)>;
                return where(x >= 1.0, S(-2.0), S(0.0));
            },
            0.0, v, 2.0 / v + v);
        const auto times = run.events().times("switch");
        ASSERT_EQ(times.size(), 2u) << kinds(run);
        EXPECT_LE(ulps(times[0], 1.0 / v), 4.0);
        EXPECT_NEAR(times[1], 1.0 / v + v, 1e-14 * times[1] * 4.0);
        EXPECT_NEAR(run[first].velocity(run.end()).x(), -v, 1e-13 * v);
    }
}

TEST(Cases, of_velocity_switch_where_it_is_reached) {
    // accelerated by 2 up to v = 1, by 0.5 beyond
    const Trajectory run = along_axis(
        [](const auto& t, const auto&, const auto& v) {
            using S = std::decay_t<decltype(t)>;
            return where(v < 1.0, S(2.0), S(0.5));
        },
        0.0, 0.3, 3.0);
    const auto times = run.events().times("switch");
    ASSERT_EQ(times.size(), 1u);
    EXPECT_LE(ulps(times[0], 0.35), 4.0);
    EXPECT_NEAR(run[first].velocity(3.0).x(), 1.0 + 0.5 * 2.65, 1e-13);
}

TEST(Cases, within_cases_are_looked_at_where_they_count) {
    // x > 1: (v > 0: -1, else -4), else 0
    const Trajectory run = along_axis(
        [](const auto& t, const auto& x, const auto& v) {
            using S = std::decay_t<decltype(t)>;
            return where(x > 1.0, where(v > 0.0, S(-1.0), S(-4.0)), S(0.0));
        },
        0.5, 1.0, 4.0);
    // reaches 1 at 0.5, turns at 1.5 at x = 1.5, comes back to 1 after 0.5 with speed 2
    const auto times = run.events().times("switch");
    ASSERT_EQ(times.size(), 3u) << kinds(run);
    EXPECT_LE(ulps(times[0], 0.5), 4.0);
    EXPECT_LE(ulps(times[1], 1.5), 4.0);
    EXPECT_LE(ulps(times[2], 2.0), 4.0);
    EXPECT_NEAR(run[first].velocity(4.0).x(), -2.0, 1e-13);
}

TEST(Cases, joined_by_and_and_or_switch_where_the_whole_does) {
    const Trajectory run = along_axis(
        [](const auto& t, const auto& x, const auto&) {
            using S = std::decay_t<decltype(t)>;
            return where((x > 1.0 && x < 2.0) || t > 5.0, S(1.5), S(0.0));
        },
        0.0, 1.0, 6.0);
    // v^2 grows by 3 in the stretch from 1 to 2: 1 to 2 in (2-1)/1.5 s
    ASSERT_GE(run.events().size(), 3u);
    const double out = 1.0 + 2.0 / 3.0;
    EXPECT_NEAR(run[first].velocity(4.0).x(), 2.0, 1e-13);
    EXPECT_NEAR(run[first].position(4.0).x(), 2.0 + 2.0 * (4.0 - out), 1e-12);
    EXPECT_NEAR(run[first].velocity(6.0).x(), 2.0 + 1.5, 1e-12);
}

TEST(Corners, of_maximum_minimum_and_magnitude_are_passed_with_the_energy_kept) {
    // F = -dV/dx with V = max(0, x - 1)^2 + |x| + 1.5 min(0, x + 1)^2
    const Trajectory run = along_axis(
        [](const auto& t, const auto& x, const auto&) {
            using S = std::decay_t<decltype(t)>;
            return -2.0 * max(S(0.0), x - 1.0) - where(x > 0.0, S(1.0), S(-1.0)) - 3.0 * min(S(0.0), x + 1.0);
        },
        0.0, 2.5, 20.0, 1e-11);
    const auto energy = [&](double t) {
        const double x = run[first].position(t).x(), v = run[first].velocity(t).x();
        const double a = std::max(0.0, x - 1.0), b = std::min(0.0, x + 1.0);
        return 0.5 * v * v + a * a + std::abs(x) + 1.5 * b * b;
    };
    EXPECT_GE(run.events().size(), 20u);
    for (double t : {1.0, 3.0, 10.0, 20.0}) EXPECT_NEAR(energy(t), 3.125, 1e-10) << t;
}

TEST(Corners, of_a_hard_ramp_are_periodic) {
    // F = -max(x, 0) k1 + max(-x, 0) k2: half periods pi/sqrt(k1), pi/sqrt(k2)
    const double k1 = 4.0, k2 = 25.0;
    const Trajectory run = along_axis(
        [=](const auto& t, const auto& x, const auto&) {
            using S = std::decay_t<decltype(t)>;
            return k2 * max(-x, S(0.0)) - k1 * max(x, S(0.0));
        },
        0.0, 1.0, 30.0);
    const double period = pi / 2.0 + pi / 5.0;
    std::vector<double> passages = run.events().times("switch");
    // both corners are at one place: two events there, or one
    std::vector<double> times;
    for (double t : passages)
        if (times.empty() || t - times.back() > 1e-9) times.push_back(t);
    ASSERT_GE(times.size(), 20u) << passages.size();
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double expected = static_cast<double>(k / 2) * period + (k % 2 == 0 ? pi / 2.0 : period);
        EXPECT_NEAR(times[k], expected, 1e-12 * expected + 1e-14) << k;
    }
}

TEST(Staircase, of_time_steps_at_every_second) {
    // v = sum of floor over whole seconds
    const Trajectory run = along_axis([](const auto& t, const auto&, const auto&) { return floor(t); }, 0.0, 0.0, 10.5);
    const auto times = run.events().times("switch");
    ASSERT_EQ(times.size(), 10u) << kinds(run);
    for (std::size_t k = 0; k < times.size(); ++k) EXPECT_LE(ulps(times[k], static_cast<double>(k + 1)), 4.0);
    EXPECT_NEAR(run[first].velocity(10.5).x(), 45.0 + 5.0, 1e-12);
    for (double t : {0.5, 3.25, 9.75}) EXPECT_NEAR(run[first].force(t).x(), std::floor(t), 1e-15);
    EXPECT_EQ(run[first].force(times[4], Side::before).x(), 4.0);
    EXPECT_EQ(run[first].force(times[4]).x(), 5.0);
}

TEST(Staircase, of_time_up_to_a_step_ends_before_it_or_on_it) {
    const auto f = [](const auto& t, const auto&, const auto&) { return floor(t); };
    EXPECT_EQ(along_axis(f, 0.0, 0.0, 3.0).events().size(), 3u);
    EXPECT_EQ(along_axis(f, 0.0, 0.0, std::nextafter(3.0, 4.0)).events().size(), 3u);
    EXPECT_EQ(along_axis(f, 0.0, 0.0, 2.999).events().size(), 2u);
}

TEST(Staircase, of_place_is_climbed_and_descended) {
    // F = -floor(x): thrown up the stairs, v^2 falls by 2 n on the n-th
    const Trajectory run = along_axis([](const auto&, const auto& x, const auto&) { return -floor(x); }, 0.5, 3.0, 6.0);
    // 9 - 2 (1 + 2) = 3 at x = 3; it turns on the third step, at 3.5
    double largest = 0.0;
    for (int k = 0; k <= 6000; ++k) largest = std::max(largest, run[first].position(k * 1e-3).x());
    EXPECT_NEAR(largest, 3.5, 1e-6);
    ASSERT_GE(run.events().size(), 6u) << kinds(run);
    EXPECT_NEAR(run[first].velocity(run.events()[2].time).x(), std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(run[first].velocity(run.events()[3].time).x(), -std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(run[first].velocity(run.events()[5].time).x(), -3.0, 1e-12);
}

TEST(SignOfVelocity, as_a_force_of_the_users_own_stops_and_holds) {
    // dry friction written as -0.5 sign(v): after the stop both sides push back, and it stays (docs/events.md)
    SimulateOptions options{.until = 5.0, .error = 1e-9};
    Scene scene;
    const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1.0, 0, 0}});
    scene.apply(Force([=](const auto& t, const auto&, const auto& v) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{where(v[0] > 0.0, S(-0.5), S(0.5)), S(0.0), S(0.0)};
                }),
                body);
    const Trajectory run = simulate(scene, options);
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_NEAR(run.events()[0].time, 2.0, 1e-14);
    EXPECT_NEAR(run[body].position(5.0).x(), 1.0, 1e-14);
    EXPECT_EQ(run[body].velocity(5.0).x(), 0.0);
}

TEST(Cases, that_load_a_resting_bead_beyond_its_cone_make_it_slip) {
    // nothing moves and no number changes but the case
    for (double push : {10.0, -10.0})
        for (const bool is_hoop : {false, true}) {
            Scene scene(is_hoop ? none : down);
            const Curve curve = is_hoop ? Curve(vertical_circle(1.0)) : Curve(along_x);
            const BodyHandle bead = scene.add(Particle{1.0}, Rail(curve, Coulomb{0.5, 0.25}), {.parameter = 0.0});
            scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                            using S = std::decay_t<decltype(t)>;
                            return Vector3Of<S>{where(t > 1.0, S(push), S(0.0)), S(0.0), S(is_hoop ? -gravity : 0.0)};
                        }),
                        bead);
            const Trajectory run = simulate(scene, {.until = 1.25, .error = 1e-11});
            ASSERT_EQ(kinds(run).substr(0, 11), "slip switch") << push << ' ' << is_hoop;
            EXPECT_EQ(run.events()[0].time, 1.0);
            EXPECT_EQ(run[bead].parameter(1.0), 0.0);
            EXPECT_GT(push * run[bead].parameter(1.25), 0.0);
            if (!is_hoop) {
                EXPECT_NEAR(run[bead].parameter(1.25), std::copysign(0.5 * (10.0 - 0.25 * gravity) * 0.0625, push),
                            1e-12);
            }
        }
}

TEST(Cases, that_begin_at_the_start_are_begun_with_silently) {
    for (double push : {10.0, -10.0, 2.0}) {
        Scene scene(down);
        const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5, 0.25}), {.parameter = 0.0});
        scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                        using S = std::decay_t<decltype(t)>;
                        return Vector3Of<S>{where(t > 0.0, S(push), S(0.0)), S(0.0), S(0.0)};
                    }),
                    bead);
        const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-11});
        EXPECT_TRUE(run.events().empty()) << kinds(run);
        const double distance = std::abs(push) > 0.5 * gravity ? std::copysign(5.0 - 0.125 * gravity, push) : 0.0;
        EXPECT_NEAR(run[bead].parameter(1.0), distance, 1e-12);
    }
}

TEST(Cases, that_turn_a_constant_load_lift_a_bead_off_a_straight_rail) {
    for (const RailSide side : {RailSide::plus, RailSide::minus}) {
        Scene scene;
        const BodyHandle bead =
            scene.add(Particle{1.0}, Rail(along_x, std::nullopt, {.side = side}), {.parameter = 0.0, .speed = 1.0});
        const double press = along_x.direction.cross(Vector3(0, 0, 1)).norm() > 0.0 ? 1.0 : 0.0;
        const Vector3 normal = press * Curve(along_x).frenet(0.0).normal * (side == RailSide::plus ? 1.0 : -1.0);
        scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                        using S = std::decay_t<decltype(t)>;
                        const S f = where(t > 1.0, S(2.0), S(-3.0));
                        return Vector3Of<S>{f * normal[0], f * normal[1], f * normal[2]};
                    }),
                    bead);
        const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-11});
        EXPECT_EQ(kinds(run), "detach switch");
        EXPECT_LE((run[bead].position(2.0) - Vector3(2, 0, 0) - normal).norm(), 1e-12);
    }
}

// --- numbers of the user's ---

TEST(Parameters, changed_between_runs_change_the_runs_to_come_alone) {
    Parameter k(1.0, "stiffness");
    Scene scene;
    const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 0, 0}});
    scene.apply(Force([&](const auto&, const auto& r, const auto&) {
                    return std::decay_t<decltype(r)>{-k * r[0], -k * r[1], -k * r[2]};
                }),
                body);
    const Trajectory a = simulate(scene, {.until = 5.0, .error = 1e-12});
    k.set(4.0);
    const Trajectory b = simulate(scene, {.until = 5.0, .error = 1e-12});
    EXPECT_NEAR(a[body].position(5.0).x(), std::cos(5.0), 1e-11);
    EXPECT_NEAR(b[body].position(5.0).x(), std::cos(10.0), 1e-11);
    EXPECT_NEAR(a[body].force(5.0).x(), -std::cos(5.0), 1e-11);
    EXPECT_NEAR(b[body].force(5.0).x(), -4.0 * std::cos(10.0), 1e-11);
    k.set(0.0);
    EXPECT_NEAR(simulate(scene, {.until = 5.0})[body].position(5.0).x(), 1.0, 1e-15);
}

TEST(Parameters, in_potentials_drives_motions_and_watches_are_taken_as_they_are) {
    Parameter p(1.0, "p");
    Scene scene(down);
    const RigidMotion motion = RigidMotion::translation([&](const auto& t) {
        using S = std::decay_t<decltype(t)>;
        return Vector3Of<S>{p * t, S(0.0), S(0.0)};
    });
    const BodyHandle bead =
        scene.add(Particle{1.0}, Rail(along_x, std::nullopt, {.motion = motion}), {.parameter = 0.0});
    scene.apply(Potential([&](const auto& r) { return -0.5 * p * r[0] * r[0]; }), bead);
    scene.watch("there", [&, bead](const Now& now) { return now[bead].position()[0] - 0.5 * p; });
    for (double value : {1.0, 2.25}) {
        p.set(value);
        // x'' = -p x from 0 with speed p
        const double w = std::sqrt(value), amplitude = value / w;
        const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-12});
        p.set(17.0);
        EXPECT_NEAR(run[bead].position(2.0).x(), amplitude * std::sin(2.0 * w), 1e-11) << value;
        ASSERT_FALSE(run.events().times("there").empty());
        EXPECT_NEAR(run.events().times("there")[0], std::asin(0.5 * value / amplitude) / w, 1e-12);
        EXPECT_NEAR(run.energy(1.0), run.energy(2.0), 1e-11);
    }
}

TEST(Loads, in_other_units_have_the_same_motion_bit_by_bit) {
    const auto numbers = [](double length, double time, double mass) {
        const double force = mass * length / (time * time);
        Scene scene(down * (length / (time * time)));
        const BodyHandle body =
            scene.add(Particle{0.5 * mass}, FreeStart{none, Vector3(1.0, 0.5, 2.0) * (length / time)});
        scene.apply(Lorentz{2.0 * mass / time, {0.5, 0.25, 1.0}}, body);
        scene.apply(Drag{.linear = 0.1 * mass / time, .quadratic = 0.2 * mass / length}, body);
        scene.apply(Force([=](const auto& t, const auto& r, const auto&) {
                        using S = std::decay_t<decltype(t)>;
                        return Vector3Of<S>{where(r[2] > 0.1 * length, S(force), S(0.0)), S(0.0),
                                            force * floor(t * (1.0 / time))};
                    }),
                    body);
        scene.apply(Potential([=](const auto& r) { return (-3.0 * force / length) * r[0] * r[0]; }), body);
        const Trajectory run = simulate(scene, {.until = 3.0 * time, .error = 1e-10});
        std::vector<double> result;
        for (const Event& e : run.events()) result.push_back(e.time / time);
        for (double t : {0.5, 1.7, 3.0})
            for (int i = 0; i < 3; ++i) result.push_back(run[body].position(t * time)[i] / length);
        return result;
    };
    const auto expected = numbers(1.0, 1.0, 1.0);
    EXPECT_GE(expected.size(), 13u);
    for (int k : {-60, 7, 60}) {
        EXPECT_EQ(numbers(std::ldexp(1.0, k), 1.0, 1.0), expected) << k;
        EXPECT_EQ(numbers(1.0, std::ldexp(1.0, k), 1.0), expected) << k;
        EXPECT_EQ(numbers(1.0, 1.0, std::ldexp(1.0, k)), expected) << k;
    }
}

}  // namespace
}  // namespace rbdyn::test::test_loads
