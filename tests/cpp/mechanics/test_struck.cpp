// Impacts with friction where contacts and joints together leave little freedom: what is known by symmetry, by closed
// forms, and from an integration of 40 digits.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "figures.hpp"
#include "rbdyn/body/shapes.hpp"

namespace rbdyn::test {
namespace struck {

using figures::rectangle;

/// Turned about the vertical.
Vector3 turned(double by, const Vector3& v) {
    return {std::cos(by) * v[0] - std::sin(by) * v[1], std::sin(by) * v[0] + std::cos(by) * v[1], v[2]};
}
const Plane floor_of_z{{0, 0, 1}};

TEST(Struck, a_slide_that_jams_on_a_rough_incline_stops) {
    // tan(0.3) is below all these coefficients: no impulse in the cone pushes it back
    for (const double mu : {0.32, 0.5, 1.5})
        for (const double e : {0.0, 0.4, 1.0})
            for (const double turn : {0.0, 0.1, 0.7}) {
                Scene scene;
                const auto block = scene.add(shapes::box(1, {.2, .2, .2}), Prismatic{.axis = turned(turn, {1, 0, 0})},
                                             {.displacement = -1, .rate = 2});
                scene.contact(block.point({0, 0, 0}), Plane{turned(turn, {-std::sin(.3), 0, std::cos(.3)})},
                              {.friction = Coulomb{mu}, .restitution = e});
                const Trajectory run = simulate(scene, {.until = 1.5});
                ASSERT_EQ(run.events().size(), 2u);
                EXPECT_EQ(run.events()[1].kind, EventKind::rest);
                EXPECT_NEAR(run[block].rate(1.5), 0.0, 1e-12) << mu << ' ' << e << ' ' << turn;
                EXPECT_NEAR(run.events()[0].time, 0.5, 1e-12);
                EXPECT_EQ(run.events()[0].note.empty(), e == 0.0);
            }
}

TEST(Struck, a_ball_in_a_symmetric_groove_stays_in_its_middle) {
    for (const double beta : {0.3, 0.7, 1.0, 1.3})
        for (const double mu : {0.05, 0.3, 0.7, 2.0})
            for (const double e : {0.0, 0.5, 0.9})
                for (const double turn : {0.0, 0.3, 2.0}) {
                    Scene scene;
                    const auto ball =
                        scene.add(shapes::sphere(1, .1),
                                  BodyStart{.position = {0, 0, .1 / std::cos(beta) + .1}, .velocity = {0, 0, -1}});
                    for (const double side : {1.0, -1.0})
                        scene.contact(ball.sphere(.1), Plane{turned(turn, {side * std::sin(beta), 0, std::cos(beta)})},
                                      {.friction = Coulomb{mu}, .restitution = e});
                    const Trajectory run = simulate(scene, {.until = .15});
                    const Vector3 v = run[ball].velocity(.15);
                    const std::string which = std::to_string(beta) + ' ' + std::to_string(mu) + ' ' + std::to_string(e);
                    EXPECT_LT(std::hypot(v[0], v[1]), 1e-12) << which;
                    EXPECT_LT(run[ball].angular_velocity_world(.15).norm(), 1e-11) << which;
                    EXPECT_GE(v[2], -1e-12) << which;
                    EXPECT_LE(v[2], e + 1e-12) << which;
                    // each of the two faces takes its half
                    const double p = run.events()[0].push[2];
                    for (const Event& event : run.events())
                        if (event.kind != EventKind::rest) {
                            EXPECT_NEAR(event.push[2], p, 1e-12) << which;
                        }
                    EXPECT_LT(e == 0.0 ? v.norm() : 0.0, 1e-12) << which;
                }
}

TEST(Struck, a_ball_in_a_plane_bounces_as_in_any_other) {
    // it sticks: 5/7 of its speed is left, wherever its plane is; just below what sticking needs it slides
    const double along = 2.0, down = 1.0, e = 0.5, needed = 2.0 / 7.0 * along / ((1 + e) * down);
    for (const double part : {0.5, 1.0 - 1e-9, 1.0 - 1e-13, 1.0, 1.0 + 1e-13, 1.01, 1.2, 30.0})
        for (const double turn : {0.0, 0.1, std::numbers::pi / 4, 1.2, 2.5}) {
            const Vector3 x = turned(turn, {1, 0, 0});
            const double left = along - std::min(part, 1.0) * needed * (1 + e) * down;
            for (const bool in_plane : {true, false}) {
                Scene scene;
                const auto ball =
                    in_plane
                        ? scene.add(shapes::sphere(1, .1), Planar{.x = x, .y = {0, 0, 1}},
                                    {.position = {0, .3}, .velocity = {along, -down}})
                        : scene.add(shapes::sphere(1, .1),
                                    BodyStart{.position = {0, 0, .3}, .velocity = along * x - down * Vector3(0, 0, 1)});
                scene.contact(ball.sphere(.1), floor_of_z, {.friction = Coulomb{part * needed}, .restitution = e});
                const Trajectory run = simulate(scene, {.until = .5});
                EXPECT_LT((run[ball].velocity(.5) - left * x - Vector3(0, 0, e * down)).norm(), 1e-12)
                    << part << ' ' << turn << ' ' << in_plane;
            }
        }
}

TEST(Struck, a_block_rocks_alike_in_every_vertical_plane) {
    const double a = .15, h = .3;
    std::vector<double> ends;
    std::vector<std::size_t> counts;
    for (const double turn : {0.0, 0.1, 0.2, 0.7, 1.0}) {
        Scene scene(Vector3{0, 0, -9.8125});
        const Vector3 x = turned(turn, {1, 0, 0}), across = turned(turn, {0, 1, 0});
        const Matrix3 inertia = shapes::box(1.3, {2 * a, .3, 2 * h}).inertia();
        Matrix3 axes;
        axes << x, across, Vector3(0, 0, 1);
        const auto block =
            scene.add(RigidBody(1.3, Matrix3(axes * inertia * axes.transpose())), Planar{.x = x, .y = {0, 0, 1}},
                      {.position = {0, .5358}, .velocity = {-1.48, 1.793}, .angle = -.859, .rate = .731});
        for (const double side : {-1.0, 1.0})
            scene.contact(block.point(side * a * x - h * Vector3(0, 0, 1)), floor_of_z, {.friction = Coulomb{.6, .19}});
        const Trajectory run = simulate(scene, {.until = 2.0});
        ends.push_back(run[block].position(2.0).dot(x));
        counts.push_back(run.events().size());
        EXPECT_LT(std::abs(run[block].position(2.0).dot(across)), 1e-12);
    }
    for (std::size_t k = 1; k < ends.size(); ++k) {
        EXPECT_NEAR(ends[k], ends[0], 1e-9);
        EXPECT_EQ(counts[k], counts[0]);
    }
}

TEST(Struck, bounces_that_slide_to_rest_have_the_limit_of_all_of_them) {
    // one corner of a body in a plane, all bounces in 40 digits, by an event-driven program of its own
    const double w = 0.8658336633434207, h = 0.606796531688617, mass = 1.3, mu = 0.49104566384219395,
                 e = 0.2698111264576114;
    const double inertia = mass * (w * w + h * h) / 12;
    Scene scene(Vector3{0, 0, -9.81});
    const auto body = scene.add(RigidBody(mass, {inertia, inertia, inertia}), Planar{.x = {1, 0, 0}, .y = {0, 0, 1}},
                                {.position = {0, h / 2 + w / 2 * .8 + .1},
                                 .velocity = {0.659147749832255, -0.6073558319950296},
                                 .angle = 0.4833705939953929,
                                 .rate = -0.024702683124545488});
    scene.contact(body.point({w / 2, 0, -h / 2}), floor_of_z, {.friction = Coulomb{mu}, .restitution = e});
    for (const double error : {1e-9, 1e-12}) {
        const Trajectory run = simulate(scene, {.until = .55, .error = error});
        const double t = run.events().times("accumulation").at(0);
        EXPECT_NEAR(t, 0.48659918146179687, 0.5 * error);
        EXPECT_NEAR(run[body].velocity(t)[0], 0.8920387156633658, error);
        EXPECT_NEAR(run[body].velocity(t)[2], -2.3918465729811706, 2.0 * error);
        EXPECT_NEAR(run[body].rate(t), 9.084964559163716, 9.0 * error);
        EXPECT_LE(*run.error(), error);
    }
}

TEST(Struck, what_has_come_to_rest_holds_by_its_static_cone) {
    // corners that rocked to rest; pushed at 2 (t - 1.5) N it breaks away at mu_static m g
    const double a = .2307889106422243, h = .4949107373351702, mass = 1.3, g = 9.81;
    const Coulomb friction{.31871083848551673, .2715366163110993};
    const auto push = [](const auto& t, const auto& r, const auto&) {
        using V = std::decay_t<decltype(r)>;
        const auto late = t - 1.5;
        return V(late + abs(late), late * 0.0, late * 0.0);
    };
    for (const double way : {1.0, -1.0}) {
        Scene scene(Vector3{0, 0, -g});
        const auto block = scene.add(shapes::box(mass, {2 * a, .3, 2 * h}), Planar{.x = {1, 0, 0}, .y = {0, 0, 1}},
                                     {.position = {0, .7460770634306721},
                                      .velocity = {way * -.5090043876425878, -1.5721856141089026},
                                      .angle = way * -.12423625375440239,
                                      .rate = way * -.126207275023698});
        std::vector<ContactHandle> corners;
        for (const double side : {-1.0, 1.0})
            corners.push_back(scene.contact(block.point({side * a, 0, -h}), floor_of_z, {.friction = friction}));
        scene.apply(Force(push), block);
        const Trajectory run = simulate(scene, {.until = 4.0});
        for (const ContactHandle& corner : corners) {
            EXPECT_EQ(run[corner].state(1.45), "sticks");
            EXPECT_EQ(run[corner].state(3.4), "sticks");
            EXPECT_NEAR(run.events().times("slip", corner).back(),
                        1.5 + static_cast<double>(friction.mu_static) * mass * g / 2, 1e-9);
        }
    }
}

}  // namespace struck
}  // namespace rbdyn::test
