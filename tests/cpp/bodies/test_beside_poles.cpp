// Euler angles of whole runs beside theta = 0 and pi, where they go on as the axis does and cost what the motion costs:
// a walk that went by the attitude instead would not end here. Truth: spins about axes at rest, and the axis of a top
// near the vertical by its linear equation.
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "bodies/random_bodies.hpp"

namespace rbdyn::test::test_beside_poles_of_runs {
namespace {

constexpr double pi = std::numbers::pi;
constexpr BodyHandle only{0};
const char* const both_engines[] = {"closed form", "taylor"};

TEST(AnglesBesidePoles, of_a_body_that_spins_about_an_axis_at_rest_phi_alone_goes_on) {
    const double spin = 4.96;
    for (const std::string engine : both_engines)
        for (const Vector3& moments : {Vector3(1, 1, 1.7), Vector3(1, 1.2, 1.7)})
            for (const bool is_free : {true, false})
                for (const double theta : {1e-12, 1e-10, 1e-9, 1e-8, 1e-5, 1e-3, pi - 1.3e-5})
                    for (const Keep::What what : {Keep::What::all, Keep::What::times, Keep::What::end}) {
                        Scene scene;
                        const RigidBody body(1.0, moments);
                        const EulerAngles start{theta, 0.3, 0.2};
                        if (is_free)
                            scene.add(body, Free{}, {.attitude = start, .angular_velocity = Vector3(0, 0, spin)});
                        else
                            scene.add(body, Spherical{}, {.attitude = start, .angular_velocity = Vector3(0, 0, spin)});
                        Keep keep{what, {}};
                        if (what == Keep::What::times) keep.times = {0.0, 2.5, 6.0};
                        const bool is_closed = engine == "closed form";
                        const Trajectory run =
                            simulate(scene, {.until = 6.0, .error = 1e-12, .engine = engine, .keep = keep});
                        const EulerAngles a = run[only].euler_angles(6.0);
                        const double off = (is_closed ? 2e-15 : 1e-13) / std::sin(theta) + 1e-12;
                        // an integrated run of which the end alone is kept knows no whole turns
                        const auto same = [&](double x, double y) {
                            return what == Keep::What::end && !is_closed ? rotations::nearest(x, y) : x;
                        };
                        const double sense = theta > 1.0 ? -1.0 : 1.0, phi = 0.2 + spin * 6.0;
                        EXPECT_NEAR(a.theta, theta, 1e-12) << engine;
                        EXPECT_NEAR(same(a.psi, 0.3), 0.3, off) << engine << theta;
                        EXPECT_NEAR(same(a.phi, phi), phi, off) << engine << theta;
                        EXPECT_NEAR(same(a.psi + sense * a.phi, 0.3 + sense * phi), 0.3 + sense * phi, 1e-11)
                            << engine << theta;
                    }
}

TEST(AnglesBesidePoles, of_a_top_nearly_upright_are_those_of_its_linear_equation) {
    // (e3x + i e3y)'' - i C n/A (...)' - (M g l/A) (...) = 0, from rest, for A = M g l = 1
    const double along = 1.5, spin = 3.0, fast = 0.5 * (along * spin + std::sqrt(along * along * spin * spin - 4.0)),
                 slow = 1.0 / fast;
    const auto psi = [&](double t) {
        const std::complex<double> ripple = std::polar(slow / fast, std::remainder((fast - slow) * t, 2.0 * pi));
        return slow * t + std::arg(1.0 - ripple);
    };
    for (const std::string engine : both_engines)
        for (const double tilt : {1e-5, 1e-9, 1e-12}) {
            const bool is_closed = engine == "closed form";
            const double until = is_closed ? 1e5 : 40.0;
            Scene scene(Vector3(0, 0, -8));
            scene.add(RigidBody(1.0, {1.0, 1.0, along}, {.com = {0, 0, 0.125}, .inertia_about = InertiaAbout::origin}),
                      Spherical{}, {.attitude = EulerAngles{tilt, 0, 0}, .angular_velocity = Vector3(0, 0, spin)});
            const Trajectory run = simulate(scene, {.until = until, .error = 1e-12, .engine = engine});
            // the square of the tilt, in a phase; digits of the attitude and of the time
            const double off = 10.0 * tilt * tilt * until + 2e-14 / tilt * (is_closed ? 1.0 : 100.0) + 1e-11 * until;
            for (const double t : {0.25 * until, until, 0.75 * until}) {
                const EulerAngles a = run[only].euler_angles(t);
                EXPECT_NEAR(a.psi, psi(t), std::min(off, 2.0)) << engine << " at " << t;
                // the share of psi' (1 - cos theta) in omega_3 is none
                EXPECT_NEAR(a.psi + a.phi, spin * t, 1e-9 + 10.0 * tilt * tilt * until) << engine << " at " << t;
            }
        }
}

TEST(AnglesBesidePoles, of_a_sleeping_top_are_known_at_once_over_any_span) {
    for (const double theta : {0.0, pi}) {
        Scene scene(Vector3(0, 0, -8));
        scene.add(RigidBody(1.0, {1.0, 1.0, 1.5}, {.com = {0, 0, 0.125}, .inertia_about = InertiaAbout::origin}),
                  Spherical{}, {.attitude = EulerAngles{theta, 0.5, 0}, .angular_velocity = Vector3(0, 0, 3.0)});
        const Trajectory run = simulate(scene, {.until = 1e9});
        const EulerAngles a = run[only].euler_angles(1e9);
        EXPECT_NEAR(a.psi, 0.5, 1e-6);
        EXPECT_NEAR(a.phi, 3e9, 1e-5);
    }
}

TEST(AnglesBesidePoles, of_a_wobble_about_the_third_axis_keep_their_turns_over_long_spans) {
    // omega_1 + i omega_2 of a body of revolution goes round, so K is at tan(angle) = omega_1/(1.7 omega_3) from e3
    for (const double tilt : {1e-4, 1e-7, 1e-10})
        for (const double wobble : {0.2, 5.0})
            for (const std::string engine : both_engines) {
                Scene scene;
                const double w3 = 4.96, across = wobble * tilt * 1.7 * w3;
                // e3 at the angle `tilt` (1 + wobble) from the vertical, K at `tilt`, all in one plane
                const double lean = std::atan(across / (1.7 * w3));
                scene.add(RigidBody(1.0, {1, 1, 1.7}), Free{},
                          {.attitude = EulerAngles{tilt + lean, 0, 0}, .angular_velocity = Vector3(0, across, w3)});
                const bool is_closed = engine == "closed form";
                const double precession = std::hypot(across, 1.7 * w3), turns = is_closed ? 1e5 : 8.0;
                const double t = 2.0 * pi * turns / precession;
                const Trajectory run = simulate(scene, {.until = t, .error = 1e-12, .engine = engine});
                const EulerAngles a = run[only].euler_angles(t);
                const bool is_round = wobble > 1.0;
                const double off = (is_closed ? 4e-15 : 2e-13) / tilt + 1e-9;
                const double spin = w3 - precession * std::cos(lean);
                EXPECT_NEAR(a.theta, tilt + lean, 1e-11) << engine;
                EXPECT_NEAR(a.psi, is_round ? 2.0 * pi * turns : 0.0, off) << engine << tilt << ' ' << wobble;
                EXPECT_NEAR(a.phi, spin * t + (is_round ? 0.0 : 2.0 * pi * turns), off) << engine << tilt;
            }
}

}  // namespace
}  // namespace rbdyn::test::test_beside_poles_of_runs
