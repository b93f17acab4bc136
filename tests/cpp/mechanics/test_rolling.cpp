// Torques of contacts against rolling and pivoting, against closed forms: what rolls out, is held, spins down, comes
// back and turns as it rolls.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "rbdyn/body/shapes.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"

namespace rbdyn::test {
namespace rolling {

constexpr double g = 9.81, m = 0.5, r = 0.1, rho = 0.004, sigma = 0.002;

ContactOptions resisting(double along, double about, double mu = 0.5) {
    return {.friction = Coulomb{mu, mu, along, about}};
}

TEST(Rolling, a_ball_rolls_out_and_stays) {
    // (2/5 + 1) m r^2 w' = -rho m g
    const double v0 = 2.0, slowing = rho * g / (1.4 * r), stops = v0 / slowing, way = 0.5 * v0 * stops;
    for (const Vector3& along : {Vector3(1, 0, 0), Vector3(0.6, 0.8, 0)})
        for (const double error : {1e-6, 1e-9, 1e-12}) {
            Scene scene(Vector3{0, 0, -g});
            const auto ball = scene.add(shapes::sphere(m, r),
                                        BodyStart{.position = {0, 0, r},
                                                  .velocity = along * v0,
                                                  .angular_velocity = Vector3(0, 0, 1).cross(along) * (v0 / r)});
            const auto touch = scene.contact(ball.sphere(r), Plane{{0, 0, 1}}, resisting(rho, 0.0));
            const Trajectory run = simulate(scene, {.until = 1e5, .error = error});
            ASSERT_EQ(run.events().size(), 2u);
            EXPECT_EQ(run.events()[0].kind, EventKind::stick);
            EXPECT_EQ(run.events()[1].kind, EventKind::rest);
            EXPECT_EQ(run.events()[1].subject, ball.index);
            EXPECT_EQ(run.events()[0].contact, touch.index);
            EXPECT_NEAR(run.events()[0].time, stops, 1e-13);
            for (const double t : {1.0, 5.0}) {
                EXPECT_NEAR(run[ball].velocity(t).dot(along), v0 - slowing * t, 1e-13);
                EXPECT_NEAR(run[touch].force(t).dot(along), -m * slowing, 1e-13);
                EXPECT_LT(run[touch].slip(t).norm(), 1e-14);
            }
            EXPECT_LT((run[ball].position(1e5) - Vector3(0, 0, r) - along * way).norm(), 1e-13);
            EXPECT_EQ((run[ball].position(1e5) - run[ball].position(10.0)).norm(), 0.0);
            // the energy that is gone: the torque times the turn
            EXPECT_NEAR(run.energy(0.0) - run.energy(1e5), rho * m * g * way / r, 1e-13);
        }
}

TEST(Rolling, a_ball_is_held_on_an_incline_up_to_rolling_over_radius) {
    for (const double about : {0.0, sigma})
        for (const double slope : {0.02, rho / r - 1e-9, rho / r + 1e-6, 0.05}) {
            const double tilt = std::atan(slope), end = slope > rho / r ? 30.0 : 1e5;
            const Vector3 normal(std::sin(tilt), 0, std::cos(tilt)), down(std::cos(tilt), 0, -std::sin(tilt));
            Scene scene(Vector3{0, 0, -g});
            const auto ball = scene.add(shapes::sphere(m, r), BodyStart{.position = normal * r});
            scene.contact(ball.sphere(r), Plane{normal}, resisting(rho, about));
            const Trajectory run = simulate(scene, {.until = end, .error = 1e-9});
            EXPECT_TRUE(run.events().empty());
            const double pull = g * (std::sin(tilt) - rho / r * std::cos(tilt)) / 1.4,
                         way = slope > rho / r ? 0.5 * pull * end * end : 0.0;
            EXPECT_NEAR((run[ball].position(end) - normal * r).dot(down), way, 1e-8 * way + 1e-16) << slope;
            if (way == 0.0) {
                EXPECT_EQ(run[ball].velocity(end).norm(), 0.0);
            }
        }
}

TEST(Rolling, a_spinning_ball_spins_down_in_a_line) {
    const double w0 = 30.0, slowing = sigma * g / (0.4 * r * r), stops = w0 / slowing;
    for (const double sign : {1.0, -1.0})
        for (const double error : {1e-6, 1e-12}) {
            Scene scene(Vector3{0, 0, -g});
            const auto ball = scene.add(shapes::sphere(m, r),
                                        BodyStart{.position = {0, 0, r}, .angular_velocity = Vector3(0, 0, sign * w0)});
            scene.contact(ball.sphere(r), Plane{{0, 0, 1}}, resisting(0.0, sigma));
            const Trajectory run = simulate(scene, {.until = 20.0, .error = error});
            ASSERT_EQ(run.events().size(), 2u);
            EXPECT_NEAR(run.events()[0].time, stops, 1e-13);
            EXPECT_NEAR(run[ball].angular_velocity(0.3 * stops)[2], sign * 0.7 * w0, 1e-12);
            EXPECT_EQ(run[ball].angular_velocity(20.0).norm(), 0.0);
        }
}

TEST(Rolling, a_disc_in_a_plane_rolls_out) {
    const double v0 = 1.0, slowing = rho * g / (1.5 * r);
    Scene scene(Vector3{0, -g, 0});
    const auto disc =
        scene.add(shapes::disc(m, r, {0, 0, 1}), Planar{}, {.position = {0, r}, .velocity = {v0, 0}, .rate = -v0 / r});
    const auto touch = scene.contact(disc.disc(r, {0, 0, 1}), Plane{{0, 1, 0}}, resisting(rho, sigma));
    const Trajectory run = simulate(scene, {.until = 10.0, .error = 1e-10});
    ASSERT_EQ(run.events().size(), 2u);
    EXPECT_NEAR(run.events().times("stick", touch).at(0), v0 / slowing, 1e-13);
    EXPECT_EQ(run.events().times("rest", disc), run.events().times("stick", touch));
    EXPECT_EQ(run[disc].velocity(10.0).norm(), 0.0);
}

TEST(Rolling, a_ball_thrown_up_an_incline_comes_back) {
    const double tilt = 0.2, v0 = 1.0, end = 2.0;
    const Vector3 normal(std::sin(tilt), 0, std::cos(tilt)), down(std::cos(tilt), 0, -std::sin(tilt));
    Scene scene(Vector3{0, 0, -g});
    const auto ball = scene.add(
        shapes::sphere(m, r),
        BodyStart{.position = normal * r, .velocity = -down * v0, .angular_velocity = Vector3(0, -v0 / r, 0)});
    scene.contact(ball.sphere(r), Plane{normal}, resisting(rho, 0.0));
    const Trajectory run = simulate(scene, {.until = end, .error = 1e-11});
    const double up = g * (std::sin(tilt) + rho / r * std::cos(tilt)) / 1.4,
                 back = g * (std::sin(tilt) - rho / r * std::cos(tilt)) / 1.4, turns = v0 / up;
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_EQ(run.events()[0].kind, EventKind::reverse);
    EXPECT_NEAR(run.events()[0].time, turns, 1e-13);
    EXPECT_NEAR((run[ball].position(end) - normal * r).dot(down),
                -0.5 * v0 * turns + 0.5 * back * (end - turns) * (end - turns), 1e-13);
}

TEST(Rolling, a_ball_that_rolls_across_an_incline_stops_as_a_thrown_body_does) {
    // v' = g/1.4 (sin(tilt) down - rho/r cos(tilt) v/|v|): that of a body thrown across an incline, which stops after
    // v0 k / (g' (k^2 - 1)), k = rho/(r tan(tilt)), g' = g sin(tilt)/1.4
    const double tilt = 0.1, v0 = 1.0, length = 0.02;
    const double k = length / r / std::tan(tilt), pull = g * std::sin(tilt) / 1.4;
    const Vector3 normal(std::sin(tilt), 0, std::cos(tilt));
    for (const double error : {1e-6, 1e-9, 1e-11}) {
        Scene scene(Vector3{0, 0, -g});
        const auto ball =
            scene.add(shapes::sphere(m, r), BodyStart{.position = normal * r,
                                                      .velocity = {0, v0, 0},
                                                      .angular_velocity = normal.cross(Vector3(0, v0, 0)) / r});
        const auto touch = scene.contact(ball.sphere(r), Plane{normal}, resisting(length, 0.0));
        const Trajectory run = simulate(scene, {.until = 20.0, .error = error});
        EXPECT_NEAR(run.events().times("stick", touch).at(0), v0 * k / (pull * (k * k - 1.0)), error);
        EXPECT_LT(run[ball].velocity(20.0).norm(), 1e-15);
    }
}

TEST(Rolling, what_slides_spins_and_rolls_stops_one_after_the_other) {
    // mu N = -m v', and rho N against the turn: it slides to the right with backspin, both in one line
    const double mu = 0.2, v0 = 3.0, w0 = -20.0, spin = 30.0;
    for (const double error : {1e-6, 1e-12}) {
        Scene scene(Vector3{0, 0, -g});
        const auto ball = scene.add(
            shapes::sphere(m, r),
            BodyStart{.position = {0, 0, r}, .velocity = {v0, 0, 0}, .angular_velocity = Vector3(0, w0, spin)});
        const auto touch = scene.contact(ball.sphere(r), Plane{{0, 0, 1}}, resisting(rho, sigma, mu));
        const Trajectory run = simulate(scene, {.until = 20.0, .error = error});
        // w' = (mu r + rho) g / (0.4 r^2) until it is zero, then with -rho; sliding ends where v = r w
        const double inertia = 0.4 * r * r, first = -w0 * inertia / ((mu * r + rho) * g),
                     gain = (mu * r - rho) * g / inertia, v1 = v0 - mu * g * first, second = v1 / (mu * g + r * gain),
                     v2 = v1 - mu * g * second, last = v2 / (rho * g / (1.4 * r));
        ASSERT_EQ(run.events().size(), 5u);
        EXPECT_EQ(run.events()[0].kind, EventKind::reverse);
        EXPECT_NEAR(run.events()[0].time, first, 1e-13);
        EXPECT_NEAR(run.events()[1].time, first + second, 1e-13);
        EXPECT_NEAR(run.events()[2].time, spin * inertia / (sigma * g), 1e-12);
        EXPECT_NEAR(run.events()[3].time, first + second + last, 1e-12);
        EXPECT_EQ(run.events()[4].kind, EventKind::rest);
        EXPECT_EQ(run.events()[4].time, run.events()[3].time);
        EXPECT_EQ(run[touch].state(19.0), "sticks");
    }
}

TEST(Rolling, what_has_no_law_is_refused) {
    EXPECT_NE(refusal([] { Coulomb{0.3, 0.3, -0.1}.validate(); }).find("rolling"), std::string::npos);
    EXPECT_NE(refusal([] { Coulomb{0.3, 0.3, 0.0, INFINITY}.validate(); }).find("pivoting"), std::string::npos);
    EXPECT_NE(refusal([] { Coulomb{0.0, 0.0, 0.1}.validate(); }).find("mu_static"), std::string::npos);
    Scene scene(Vector3{0, 0, -g});
    const auto ball = scene.add(shapes::sphere(m, r), BodyStart{.position = {0, 0, 1.0 + r}});
    scene.contact(ball.sphere(r), Sphere{}, resisting(rho, 0.0));
    EXPECT_NE(refusal([&] { simulate(scene, {.until = 1.0}); }).find("planes alone"), std::string::npos);
}

}  // namespace rolling
}  // namespace rbdyn::test
