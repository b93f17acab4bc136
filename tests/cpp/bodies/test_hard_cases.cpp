// Hard cases of rotation: what breaks libraries of this kind, with answers from closed forms.
//
// The periods and angles come from elliptic integrals computed to more digits than are given here.
#include <gtest/gtest.h>

#include <iostream>
#include <numbers>

#include "bodies/random_bodies.hpp"

namespace rbdyn::test::test_hard_cases {
namespace {

constexpr double pi = std::numbers::pi;
constexpr BodyHandle only{0};
const char* const both_engines[] = {"closed form", "taylor"};
const bool table = setting("RBDYN_TEST_TABLE", 0) != 0;

Scene thrown(const Vector3& moments, const Vector3& omega, const Attitude& attitude = {}) {
    Scene scene;
    scene.add(RigidBody(1.0, moments), Free{}, {.attitude = attitude, .angular_velocity = omega});
    return scene;
}

/// The largest change of T and K along a run, relative.
std::pair<double, double> changes(const Trajectory& run, const std::vector<double>& times) {
    const double t0 = run.kinetic_energy(run.start());
    const Vector3 k0 = run.angular_momentum(run.start());
    std::pair<double, double> worst{0.0, 0.0};
    for (const double t : times) {
        worst.first = std::max(worst.first, std::abs(run.kinetic_energy(t) - t0) / t0);
        worst.second = std::max(worst.second, (run.angular_momentum(t) - k0).norm() / k0.norm());
    }
    return worst;
}
std::vector<double> spread(double until, int count) {
    std::vector<double> times;
    for (int k = 1; k <= count; ++k) times.push_back(until * k / count);
    return times;
}

TEST(HardRotation, flips_about_the_intermediate_axis_come_at_the_period_of_omega) {
    struct Case {
        Vector3 omega;
        double period, error;
    };
    // by steps, rounding of the state moves a flip by 1e-16 times what a departure from the axis grows in a period
    for (const Case& c : {Case{{0.1, 1, 0}, 25.510977876634716929, 1e-12},
                          {{1e-3, 1, 0}, 57.462848874962666871, 1e-11},
                          {{1e-6, 1, 0}, 105.32119394639243715, 1e-8}})
        for (const std::string engine : both_engines) {
            const bool is_closed = engine == "closed form";
            Scene scene = thrown({1, 2, 3}, c.omega);
            scene.watch("flip", [](const Now& now) { return now[only].angular_velocity()[1]; });
            const Trajectory run =
                simulate(scene, {.until = 3.2 * c.period, .error = is_closed ? 1e-12 : c.error, .engine = engine});
            const std::vector<double> flips = run.events().times("flip");
            ASSERT_EQ(flips.size(), 6u) << engine;
            for (std::size_t k = 0; k < flips.size(); ++k) {
                const double right = c.period * (0.25 + 0.5 * static_cast<double>(k));
                EXPECT_NEAR(flips[k], right, (is_closed ? 1e-14 : c.error) * right) << engine << ' ' << c.omega[0];
            }
            const auto [energy, momentum] = changes(run, spread(run.end(), 500));
            // what is held at the ends of steps is let go a little within them
            EXPECT_LE(energy, is_closed ? 4e-15 : 0.1 * c.error) << engine;
            EXPECT_LE(momentum, is_closed ? 4e-15 : 0.1 * c.error) << engine;
        }
}

TEST(HardRotation, exactly_on_the_intermediate_axis_a_body_stays_for_ever) {
    for (const std::string engine : both_engines) {
        const double until = engine == "taylor" ? 1e3 : 1e6;
        const Trajectory run =
            simulate(thrown({1, 2, 3}, {0, 1, 0}, EulerAngles{0.5, 0.25, 0.75}), {.until = until, .engine = engine});
        for (const double t : spread(until, 50)) EXPECT_EQ(run[only].angular_velocity(t), Vector3(0, 1, 0)) << engine;
    }
}

TEST(HardRotation, turned_axes_seed_a_flip_that_the_closed_form_knows_and_integration_owns_up_to) {
    // in axes of its own that are turned, omega along the intermediate axis is so but for rounding
    const Attitude turn = EulerAngles{0.5, 0.25, 0.75};
    const Vector3 axis = rotation_matrix(turn.quaternion()).col(1);
    Scene scene;
    scene.add(RigidBody(1.0, {1, 2, 3}).rotated(turn), Free{}, {.angular_velocity = axis});
    const Trajectory closed = simulate(scene, {.until = 200.0, .error = 1e-9});
    double flip = 0.0;
    for (double t = 0.0; t < 200.0 && flip == 0.0; t += 0.125)
        if (closed[only].angular_velocity(t).dot(axis) < 0.0) flip = t;
    EXPECT_GT(flip, 50.0);
    EXPECT_LT(flip, 80.0);
    const auto [energy, momentum] = changes(closed, spread(200.0, 500));
    EXPECT_LE(energy, 4e-15);
    EXPECT_LE(momentum, 4e-15);
    try {
        const Trajectory run = simulate(scene, {.until = 200.0, .error = 1e-6, .engine = "taylor"});
        for (const double t : spread(200.0, 100))
            EXPECT_LE((run[only].angular_velocity(t) - closed[only].angular_velocity(t)).norm(), 1e-6);
    } catch (const AccuracyError& e) {
        EXPECT_GT(e.run.certain_until(), 15.0);
        EXPECT_LT(e.run.certain_until(), flip);
        // estimates are good to a factor of ten
        for (const double t : spread(e.run.certain_until(), 100))
            EXPECT_LE((e.run[only].angular_velocity(t) - closed[only].angular_velocity(t)).norm(), 1e-5);
    }
}

TEST(HardRotation, a_million_turns_about_a_stable_axis_do_not_wander) {
    const double until = 2e6 * pi;
    for (const Vector3& omega : {Vector3(1, 1e-3, 0), Vector3(1e-3, 0, 1), Vector3(1, 0, 0), Vector3(0, 0, 1)}) {
        const Trajectory run = simulate(thrown({1, 2, 3}, omega), {.until = until, .error = 1e-12});
        Eigen::Index axis = 0;
        omega.maxCoeff(&axis);
        const std::vector<double> times = spread(until, 2000);
        const auto [energy, momentum] = changes(run, times);
        EXPECT_LE(energy, 4e-15);
        EXPECT_LE(momentum, 4e-15);
        // on the polhode the share across the axis is at most sqrt(3) times that at the start
        const double across = std::sqrt(1.0 - std::pow(omega[axis] / omega.norm(), 2));
        for (const double t : times) {
            const Vector3 w = run[only].angular_velocity(t).normalized();
            EXPECT_LE((w - Vector3::Unit(axis)).norm(), 2.0 * across);
        }
    }
}

TEST(HardRotation, nearly_equal_moments_do_not_precess_but_as_far_as_they_differ) {
    const Vector3 omega(0.5, 0.75, 1.0);
    for (const std::string engine : both_engines) {
        const Trajectory run =
            simulate(thrown({1, 1 + 1e-12, 1 + 2e-12}, omega), {.until = 100.0, .error = 1e-12, .engine = engine});
        const Trajectory ball = simulate(thrown({1, 1, 1}, omega), {.until = 100.0, .error = 1e-13, .engine = engine});
        for (const double t : spread(100.0, 40)) {
            const Vector3 change = run[only].angular_velocity(t) - omega;
            // Euler's equations with omega constant but for terms of their square
            const Vector3 rate(-1e-12 * omega[1] * omega[2], 2e-12 * omega[0] * omega[2], -1e-12 * omega[0] * omega[1]);
            // moments of 1 are doubles 2e-16 apart
            EXPECT_LE((change - rate * t).norm(), 3e-16 * t + 1e-15) << engine;
            // integrated, it is seen from axes that do not turn about the third
            EXPECT_LE((ball[only].angular_velocity(t) - omega).norm(), engine == "taylor" ? 1e-14 : 4e-16) << engine;
            // its angle in doubles would be off by more
            const long double speed = std::sqrt(0.5L * 0.5L + 0.75L * 0.75L + 1.0L),
                              angle = std::remainder(speed * t, 2.0L * std::numbers::pi_v<long double>);
            const Quaternion turned = turn(omega.normalized(), static_cast<double>(angle));
            EXPECT_LE((ball[only].rotation_matrix(t) - rotation_matrix(turned)).norm(),
                      engine == "taylor" ? 2e-14 : 2e-15)
                << engine;
        }
    }
}

TEST(HardRotation, the_symmetric_body_precesses_at_its_rate) {
    for (const std::string engine : both_engines) {
        const double a = 1.0, c = 1.5, spin = 2.0;
        const Trajectory run =
            simulate(thrown({a, a, c}, {0.25, 0, spin}), {.until = 100.0, .error = 1e-12, .engine = engine});
        const double rate = (c - a) * spin / a;
        for (const double t : spread(100.0, 40)) {
            const Vector3 right(0.25 * std::cos(rate * t), 0.25 * std::sin(rate * t), spin);
            EXPECT_LE((run[only].angular_velocity(t) - right).norm(), engine == "taylor" ? 1e-13 : 1e-14) << engine;
        }
    }
}

TEST(HardRotation, a_body_all_but_a_rod_keeps_its_motion_bounded) {
    // a needle of moment 1e-12 turns end over end, its spin about its line a billion times as free
    for (const Vector3& moments : {Vector3(1, 1, 1e-12), Vector3(1, 1 + 5e-13, 1e-12)}) {
        const Vector3 omega(0.5, 0.75, 1.0);
        const Trajectory closed = simulate(thrown(moments, omega), {.until = 100.0, .error = 1e-9});
        const Trajectory run = simulate(thrown(moments, omega), {.until = 100.0, .error = 1e-9, .engine = "taylor"});
        for (const double t : spread(100.0, 50)) {
            // w3' = (A - B)/C w1 w2 and w1' = w2 w3 keep w3^2 + w1^2/2, A - B = -C/2 as near as doubles at 1 can be
            const double along = closed[only].angular_velocity(t)[2];
            EXPECT_LE(along * along, 1.0 + 0.5 * 0.25 * 1.001);
            EXPECT_LE((run[only].angular_velocity(t) - closed[only].angular_velocity(t)).norm(), 2e-9);
            EXPECT_LE((run[only].rotation_matrix(t) - closed[only].rotation_matrix(t)).norm(), 2e-9);
        }
        const auto [energy, momentum] = changes(closed, spread(100.0, 200));
        EXPECT_LE(energy, 4e-15);
        EXPECT_LE(momentum, 4e-15);
    }
}

TEST(HardRotation, a_rod_is_refused_where_its_spin_would_be_free_and_carried_elsewhere) {
    const RigidBody rod(1.0, {1, 1, 0});
    const auto refusal = [&](auto add) -> std::string {
        try {
            Scene scene(down);
            add(scene);
        } catch (const InvalidInput& e) {
            return e.what();
        }
        return "";
    };
    for (const std::string& why : {refusal([&](Scene& s) { s.add(rod, Free{}, {}, "rod"); }), refusal([&](Scene& s) {
                                       s.add(rod, Spherical{.point = {0, 0, 1}}, {}, "rod");
                                   }),
                                   refusal([&](Scene& s) {
                                       // until the motion begins it may be given something to carry
                                       s.add(rod, Revolute{.axis = {0, 0, 1}}, {}, "rod");
                                       simulate(s, {.until = 1.0});
                                   })}) {
        EXPECT_NE(why.find("rod"), std::string::npos) << why;
        EXPECT_NE(why.find("moment"), std::string::npos) << why;
    }
    // across its line it swings as any pendulum; held off its line it turns freely
    Scene hinge(down), ball(down);
    hinge.add(rod, Revolute{.axis = {0, 1, 0}, .point = {0, 0, 1}}, {.angle = 0.25});
    ball.add(rod, Spherical{.point = {0.5, 0, 1}}, {.angular_velocity = Vector3(0.5, 0.25, 1.0)});
    EXPECT_EQ(simulate(hinge, {.until = 5.0}).engine(), "closed form");
    const Trajectory run = simulate(ball, {.until = 5.0});
    EXPECT_LE(run.drift().at("energy"), 1e-13);
}

TEST(HardRotation, angles_are_continuous_through_nutation_zero_and_pi) {
    for (const std::string engine : both_engines) {
        // end over end about the line of nodes: theta goes on for ever, the others keep still
        const Trajectory over = simulate(thrown({1, 2, 3}, {1, 0, 0}, EulerAngles{0.5, 0.25, 0.0}),
                                         {.until = 20.0, .error = 1e-12, .engine = engine});
        for (double t = 0.0; t <= 20.0; t += 0.25) {
            const EulerAngles a = over[only].euler_angles(t);
            EXPECT_NEAR(a.theta, 0.5 + t, 1e-11) << engine;
            EXPECT_NEAR(a.psi, 0.25, 1e-11) << engine;
            EXPECT_NEAR(a.phi, 0.0, 1e-11) << engine;
        }
        // past the pole at a small distance: psi and phi turn by pi each in no time, psi + phi does not jump
        const double miss = 1e-7;
        Scene near;
        near.add(RigidBody(1.0, {1, 1, 1}), Free{},
                 {.attitude = Attitude(turn({0, 1, 0}, miss) * turn({1, 0, 0}, -0.5)),
                  .angular_velocity = Vector3(1, 0, 0)});
        const Trajectory past = simulate(near, {.until = 1.0, .error = 1e-12, .engine = engine});
        double before = 0.0;
        for (int k = 0; k <= 20000; ++k) {
            const EulerAngles a = past[only].euler_angles(k / 20000.0);
            if (k > 0) {
                EXPECT_NEAR(a.psi + a.phi, before, 1e-6) << engine << " at " << k / 20000.0;
            }
            before = a.psi + a.phi;
            const Matrix3 r = rotation_matrix(quaternion(a));
            ASSERT_LE((r - past[only].rotation_matrix(k / 20000.0)).norm(), 1e-14);
        }
    }
}

TEST(HardRotation, angles_start_as_they_were_given_and_go_on_from_there) {
    for (const std::string engine : both_engines)
        for (const EulerAngles given : {EulerAngles{0.5, 4.0, -9.0}, EulerAngles{0.0, 0.25, 7.5},
                                        EulerAngles{-2.5, 0.25, 20.0}, EulerAngles{8.0, -4.0, 0.0}}) {
            const SimulateOptions options{.until = 1.0, .error = 1e-12, .engine = engine};
            const Trajectory run = simulate(thrown({1, 2, 3}, {0.5, 1.5, -1}, given), options);
            // the same attitude in another form says nothing about whole turns
            const Trajectory other = simulate(thrown({1, 2, 3}, {0.5, 1.5, -1}, quaternion(given)), options);
            const EulerAngles start = run[only].euler_angles(0.0), principal = other[only].euler_angles(0.0);
            EXPECT_NEAR(start.theta, given.theta, 4e-15) << engine;
            EXPECT_NEAR(start.psi, given.psi, 4e-15) << engine;
            EXPECT_NEAR(start.phi, given.phi, 8e-15) << engine;
            EXPECT_LE(std::abs(principal.psi), std::numbers::pi);
            EXPECT_LE(std::abs(principal.phi), std::numbers::pi);
            EulerAngles before = start;
            for (int k = 1; k <= 1000; ++k) {
                const EulerAngles a = run[only].euler_angles(k / 1000.0);
                EXPECT_LT(std::abs(a.theta - before.theta), 0.01);
                EXPECT_LE((rotation_matrix(quaternion(a)) - run[only].rotation_matrix(k / 1000.0)).norm(), 2e-14);
                before = a;
            }
        }
}

TEST(HardRotation, the_angle_of_a_hinge_keeps_its_turns) {
    for (const std::string engine : both_engines) {
        Scene scene(down), turned(down);
        const RigidBody bob(1.0, {0.2, 0.3, 0.25}, {.com = {0, 0, -0.5}});
        for (auto& [s, angle] : {std::pair(&scene, 7.0), std::pair(&turned, 7.0 - 2.0 * std::numbers::pi)})
            s->add(bob, Revolute{.axis = {0, 1, 0}}, {.angle = angle, .rate = 0.5});
        const SimulateOptions options{.until = 3.0, .error = 1e-12, .engine = engine};
        const Trajectory run = simulate(scene, options), other = simulate(turned, options);
        EXPECT_EQ(run[only].angle(0.0), 7.0) << engine;
        for (const double t : {0.5, 1.7, 3.0})
            EXPECT_NEAR(run[only].angle(t) - other[only].angle(t), 2.0 * std::numbers::pi, 1e-12) << engine << t;
    }
}

TEST(HardRotation, a_touch_too_slight_for_its_digits_leaves_what_came_before_certain) {
    // omega2 returns to -1 at half its period; a hair before it, the time is known to the root of rounding only
    Scene scene = thrown({1, 2, 3}, {0.1, 1, 0});
    scene.watch("touch", [](const Now& now) { return now[only].angular_velocity()[1] + (1.0 - 1e-12); });
    const double touch = 0.5 * 25.510977876634716929;
    for (const std::string engine : both_engines) {
        try {
            simulate(scene, {.until = 20.0, .error = 1e-13, .engine = engine});
            FAIL() << engine;
        } catch (const AccuracyError& e) {
            EXPECT_GT(e.run.certain_until(), 0.9 * touch) << engine;
            EXPECT_LT(e.run.certain_until(), 1.001 * touch) << engine;
        }
    }
}

/// Gravity 8, mass 1, G at 1/8: M g l = 1.
Scene top(double across, double along, const EulerAngles& attitude, double spin) {
    Scene scene(Vector3(0, 0, -8));
    scene.add(RigidBody(1.0, {across, across, along}, {.com = {0, 0, 0.125}, .inertia_about = InertiaAbout::origin}),
              Spherical{}, {.attitude = attitude, .angular_velocity = Vector3(0, 0, spin)});
    return scene;
}

TEST(HardRotation, a_top_let_go_makes_cusps) {
    const double period = 1.4610376297378547, precession = 0.33168586628482653,
                 lowest = 65.257837854397279 * pi / 180.0;
    for (const std::string engine : both_engines) {
        Scene scene = top(1.0, 1.5, {pi / 3.0, 0.0, 0.0}, 3.0);
        // a little below the circle of cusps, which the axis touches: twice at each
        const double below = std::cos(pi / 3.0) * (1.0 - 1e-6);
        scene.watch("cusp", [=](const Now& now) { return now[only].rotation_matrix()[8] - below; });
        const Trajectory run = simulate(scene, {.until = 10.5 * period, .error = 1e-12, .engine = engine});
        const double tolerance = engine == "taylor" ? 1e-11 : 1e-13;
        for (int k = 1; k <= 10; ++k) {
            const EulerAngles cusp = run[only].euler_angles(k * period),
                              low = run[only].euler_angles((k - 0.5) * period);
            // about a cusp the axis moves with the square of time, psi with its cube
            EXPECT_NEAR(cusp.theta, pi / 3.0, tolerance) << engine;
            EXPECT_NEAR(cusp.psi, k * precession, tolerance) << engine;
            EXPECT_NEAR(low.theta, lowest, tolerance) << engine;
            EXPECT_NEAR(low.psi, (k - 0.5) * precession, tolerance) << engine;
        }
        // at the start the axis is above; then it comes and goes at every cusp
        EXPECT_EQ(run.events().times("cusp").size(), 21u) << engine;
    }
}

TEST(HardRotation, a_sleeping_top_sleeps_above_its_threshold_and_wakes_below) {
    const double a = 0.002, c = 0.0008, m = 0.5, l = 0.04, g = 9.81, critical = 49.522722057657533;
    for (const std::string engine : both_engines)
        for (const double share : {0.0, 0.99, 1.01}) {
            const double spin = share == 0.0 ? 0.9 * critical : share * critical, tilt = share == 0.0 ? 0.0 : 1e-7;
            Scene scene(Vector3(0, 0, -g));
            scene.add(RigidBody(m, {a, a, c}, {.com = {0, 0, l}, .inertia_about = InertiaAbout::origin}), Spherical{},
                      {.attitude = EulerAngles{tilt, 0.0, 0.0}, .angular_velocity = Vector3(0, 0, spin)});
            const Trajectory run = simulate(scene, {.until = 6.0, .error = 1e-9, .engine = engine});
            const auto lean = [&](double t) {
                const Vector3 axis = run[only].rotation_matrix(t).col(2);
                return std::hypot(axis[0], axis[1]);
            };
            double most = 0.0;
            for (const double t : spread(6.0, 600)) most = std::max(most, lean(t));
            if (share == 0.0) {
                EXPECT_EQ(most, 0.0) << engine << ": exactly upright it has no reason to wake";
            } else if (share < 1.0) {
                const double growth = std::sqrt(4.0 * a * m * g * l - c * c * spin * spin) / (2.0 * a);
                EXPECT_NEAR(std::log(lean(6.0) / lean(5.0)), growth, 1e-3 * growth) << engine;
            } else {
                // theta oscillates between 1e-7 and 1e-7 over sqrt(1 - (critical / spin)^2)
                EXPECT_LE(most, 1.001e-7 / std::sqrt(1.0 - std::pow(critical / spin, 2))) << engine;
                EXPECT_GE(most, 5e-7) << engine;
            }
        }
}

TEST(HardRotation, long_integration_loses_next_to_nothing) {
    // RBDYN_TEST_LONG=1: a million seconds
    const bool is_long = setting("RBDYN_TEST_LONG", 0) != 0;
    const Scene scene = thrown({1, 2, 3}, {0.01, 1, 0.02});
    const double until = is_long ? 1e6 : 1e5, asked = is_long ? 1e-11 : 1e-12;
    std::vector<double> times = spread(until, 200);
    times.insert(times.begin(), 0.0);
    const Trajectory closed = simulate(scene, {.until = until, .error = 1e-12});
    const Trajectory run = simulate(
        scene,
        {.until = until, .error = asked, .engine = "taylor", .keep = {.what = Keep::What::times, .times = times}});
    double error = 0.0;
    for (const double t : times) {
        error =
            std::max(error, (run[only].rotation_matrix(t) - closed[only].rotation_matrix(t)).norm() / std::sqrt(2.0));
        error = std::max(error, (run[only].angular_velocity(t) - closed[only].angular_velocity(t)).norm());
    }
    const auto [energy, momentum] = changes(run, times);
    if (table)
        std::cout << "error " << error << ", drift of energy " << energy << ", of momentum " << momentum << ", steps "
                  << run.statistics().steps << ", one integration " << run.statistics().integration_seconds << " s\n";
    EXPECT_LE(error, asked);
    EXPECT_LE(error, 10.0 * *run.error());
    EXPECT_LE(energy, 1e-14);
    EXPECT_LE(momentum, 1e-14);
}

}  // namespace
}  // namespace rbdyn::test::test_hard_cases
