// States of rest of rigid bodies against closed forms, and against the general assembly.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>
#include <random>

#include "rbdyn/body/shapes.hpp"
#include "rbdyn/model/assembly.hpp"
#include "rbdyn/statics/equilibria.hpp"
#include "refusal.hpp"
#include "support.hpp"

namespace rbdyn::test::test_body_equilibria {
namespace {

constexpr double pi = std::numbers::pi;
using Vector = Vector3Of<Expression>;

// about the origin, G half a metre below it
const RigidBody bob(2.0, {0.7, 0.9, 0.4}, {.com = {0, 0, -0.5}, .inertia_about = InertiaAbout::origin});
const double moment = 2.0 * gravity * 0.5;  // m g d
const Revolute across{.axis = {0, 1, 0}};
// nothing of it is symmetric
const RigidBody stone(1.5, {0.6, 0.8, 1.1}, {.com = {0.1, -0.2, 0.3}});

double period(double inertia, double stiffness) { return 2.0 * pi * std::sqrt(inertia / stiffness); }
Vector3 body_z(const Equilibrium& e) {
    return to_world<double>({e.coordinates[0], e.coordinates[1], e.coordinates[2], e.coordinates[3]}, Vector3(0, 0, 1));
}
/// What accelerates the bodies of a scene where it starts, beside what acts on them: coordinates are rounded, and
/// springs answer that by some 1e-14.
double unrest(const Scene& scene) {
    const Assembly assembly(scene);
    double most = 0.0;
    for (int i = 0; i < static_cast<int>(scene.bodies().size()); ++i) {
        const AssembledBody b = assembly.body(i);
        most = std::max(most, (b.angular_acceleration.norm() + b.acceleration.norm()) / (1.0 + b.effort));
    }
    return most;
}

TEST(BodyEquilibria, a_compound_pendulum_rests_below_stably_and_above_not) {
    Scene scene(down);
    scene.add(bob, across, {.angle = 9.0});
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].coordinates, std::vector{0.0});
    EXPECT_EQ(all[1].coordinates, std::vector{pi});
    EXPECT_TRUE(all[0].stable);
    EXPECT_FALSE(all[1].stable);
    ASSERT_EQ(all[0].periods.size(), 1u);
    EXPECT_NEAR(all[0].periods[0] / period(0.9, moment), 1.0, 4e-16);
    EXPECT_TRUE(all[1].periods.empty());
}

TEST(BodyEquilibria, a_door_hung_askew_swings_the_slower_the_steeper_its_axis) {
    const RigidBody door(12.0, {4.0, 0.75, 4.5}, {.com = {0.4, 0, 0}});
    for (const double tilt : {1e-6, 0.1, 1.0}) {
        // the upper hinge leans towards x: there the door's G lies lowest
        Scene scene(down);
        scene.add(door, Revolute{.axis = {std::sin(tilt), 0, std::cos(tilt)}}, {.angle = 0.3});
        const auto all = equilibria(scene);
        ASSERT_EQ(all.size(), 2u) << tilt;
        const Vector3 e(std::sin(tilt), 0, std::cos(tilt));
        const double about = e.dot(door.inertia(InertiaAbout::origin) * e);
        const double pull = 12.0 * gravity * 0.4 * std::cos(tilt) * std::sin(tilt);
        EXPECT_NEAR(all[0].coordinates[0], 0.0, 1e-15 / tilt);
        EXPECT_TRUE(all[0].stable);
        EXPECT_NEAR(all[1].coordinates[0], pi, 1e-15 / tilt);
        EXPECT_FALSE(all[1].stable);
        EXPECT_NEAR(all[0].periods.at(0) / period(about, pull), 1.0, 1e-15 / tilt);
    }
}

TEST(BodyEquilibria, a_wheel_in_balance_rests_at_every_angle) {
    const RigidBody wheel(3.0, {0.2, 0.2, 0.3});
    for (const auto& [body, axis] : {std::pair(wheel, Vector3(0, 1, 0)),
                                     {bob, Vector3(0, 0, 1)},
                                     {stone.shifted(-stone.com()), Vector3(1, 2, 3)}}) {
        Scene scene(down);
        scene.add(body, Revolute{.axis = axis}, {.angle = 7.0});
        const auto all = equilibria(scene);
        ASSERT_EQ(all.size(), 1u) << axis;
        EXPECT_EQ(all[0], (Equilibrium{{7.0}, false, std::pair(7.0 - pi, 7.0 + pi)}));
    }
}

TEST(BodyEquilibria, a_torsion_pendulum_rests_where_its_springs_together_do) {
    Scene scene(down);
    const BodyHandle h = scene.add(bob, Revolute{.axis = {0, 0, 1}}, {.angle = 20.0});
    scene.apply(TorsionSpring{.stiffness = 3.0, .rest_angle = 8.0, .damping = 0.5}, h);
    scene.apply(TorsionSpring{.stiffness = 1.0, .rest_angle = -4.0}, h);
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_NEAR(all[0].coordinates[0], 5.0, 2e-15);
    EXPECT_TRUE(all[0].stable);
    EXPECT_NEAR(all[0].periods.at(0) / period(0.4, 4.0), 1.0, 1e-15);
}

TEST(BodyEquilibria, of_a_pendulum_with_a_torsion_spring_all_are_found_however_far_it_is_wound) {
    // k (psi - psi0) + m g d sin psi = 0
    for (const auto& [stiffness, rest] : {std::pair(0.05, 0.0), {0.3, 1.0}, {0.004, -30.0}, {1.5, 40.0}}) {
        Scene scene(down);
        const BodyHandle h = scene.add(bob, across, {});
        scene.apply(TorsionSpring{.stiffness = stiffness * moment, .rest_angle = rest}, h);
        const auto torque = [stiffness = stiffness, rest = rest](double psi) {
            return -stiffness * (psi - rest) - std::sin(psi);
        };
        std::vector<double> roots;
        const double reach = 1.0 / stiffness + 0.1;
        constexpr int n = 200000;
        for (int k = 0; k < n; ++k) {
            double low = rest + reach * (2.0 * k / n - 1.0 + 1e-7), high = low + 2.0 * reach / n;
            if ((torque(low) > 0.0) == (torque(high) > 0.0)) continue;
            for (int i = 0; i < 80; ++i)
                ((torque(0.5 * (low + high)) > 0.0) == (torque(low) > 0.0) ? low : high) = 0.5 * (low + high);
            roots.push_back(low);
        }
        const auto all = equilibria(scene);
        ASSERT_EQ(all.size(), roots.size()) << stiffness;
        for (std::size_t k = 0; k < all.size(); ++k) {
            const double psi = all[k].coordinates[0], slope = stiffness + std::cos(psi);
            EXPECT_NEAR(psi, roots[k], 1e-15 * (1.0 + std::abs(roots[k])) * (2.0 + 2.0 / std::abs(slope)));
            EXPECT_EQ(all[k].stable, slope > 0.0) << psi;
            EXPECT_EQ(all[k].stable, k % 2 == 0) << "they alternate";
            if (slope > 0.0) {
                EXPECT_NEAR(all[k].periods.at(0) / period(0.9, slope * moment), 1.0, 1e-13 / slope);
            }
        }
    }
}

TEST(BodyEquilibria, an_upright_pendulum_on_a_spring_of_its_critical_stiffness_rests_in_fourth_order) {
    const RigidBody upright(2.0, {0.7, 0.875, 0.4}, {.com = {0, 0, 0.5}, .inertia_about = InertiaAbout::origin});
    for (const double share : {0.75, 1.0, 1.25}) {
        Scene scene(down);
        const BodyHandle h = scene.add(upright, across, {});
        scene.apply(TorsionSpring{.stiffness = share * moment}, h);
        const auto all = equilibria(scene);
        ASSERT_EQ(all.size(), share < 1.0 ? 3u : 1u) << share;
        EXPECT_NEAR(all[all.size() / 2].coordinates[0], 0.0, 1e-9) << share;
        EXPECT_EQ(all[all.size() / 2].stable, share >= 1.0) << share;
    }
}

TEST(BodyEquilibria, an_upright_rod_on_a_torsion_spring_is_stable_from_the_critical_stiffness_on_however_near) {
    // k psi = m g d sin psi: 1e-k above the critical stiffness alone and stable, below it between two others
    const RigidBody upright(2.0, {0.7, 0.875, 0.4}, {.com = {0, 0, 0.5}, .inertia_about = InertiaAbout::origin});
    for (int k = 1; k <= 10; ++k)
        for (const double sign : {-1.0, 1.0}) {
            const double off = sign * std::pow(10.0, -k);
            Scene scene(down);
            const BodyHandle h = scene.add(upright, across, {});
            scene.apply(TorsionSpring{.stiffness = (1.0 + off) * moment}, h);
            const auto all = equilibria(scene);
            ASSERT_EQ(all.size(), sign < 0.0 ? 3u : 1u) << off;
            const Equilibrium& straight = all[all.size() / 2];
            EXPECT_NEAR(straight.coordinates[0], 0.0, 1e-15) << off;
            EXPECT_EQ(straight.stable, sign > 0.0) << off;
            EXPECT_TRUE(straight.decided) << off;
            if (sign > 0.0) continue;
            // psi^2 = 6 off (1 + 3 off / 10 ...), from sin psi / psi = 1 + off
            for (const std::size_t side : {0u, 2u}) {
                const double psi = all[side].coordinates[0];
                EXPECT_TRUE(all[side].stable) << off;
                EXPECT_NEAR(psi * psi / (-6.0 * off), 1.0, -off + 1e-2 * std::pow(10.0, k - 10)) << off;
            }
        }
}

TEST(BodyEquilibria, an_upright_rod_is_found_upright_wherever_the_search_begins) {
    // at zero all terms of the moment vanish, and with them what rounding makes of it
    const RigidBody rod = shapes::rod(4.0, 128.0, Vector3(0, 0, 1)).shifted({0, 0, 64.0});
    std::mt19937 random(1);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (int i = 0; i < 300; ++i) {
        const double off = i == 0 ? -0x1.94867f80b0e3fp-8 : -std::pow(10.0, -1.0 - 3.0 * part(random));
        const double start = i == 0 ? -0x1.a903e24c10470p-2 : 2.0 * part(random) - 1.0;
        Scene scene({0, 0, -9.8125});
        const BodyHandle h = scene.add(rod, across, {.angle = start});
        scene.apply(TorsionSpring{.stiffness = (1.0 + off) * 4.0 * 9.8125 * 64.0}, h);
        const auto all = equilibria(scene);
        ASSERT_EQ(all.size(), 3u) << i << ' ' << off;
        EXPECT_NEAR(all[1].coordinates[0], 0.0, 1e-15) << i << ' ' << off;
        EXPECT_FALSE(all[1].stable) << i << ' ' << off;
    }
}

TEST(BodyEquilibria, a_rod_on_a_ball_joint_held_by_springs_is_judged_in_fourth_order_where_the_second_vanishes) {
    // upright, from its tip four springs to points on a cross at its height; along x they are just strong enough
    // against gravity, along y stronger; one along z across the rod keeps it from turning about itself
    const RigidBody rod(1.0, {0.4, 0.375, 0.2}, {.com = {0, 0, 0.5}, .inertia_about = InertiaAbout::origin});
    const double need = 1.0 * gravity * 0.5;
    for (const double share : {0.75, 1.0, 1.25}) {
        Scene scene(down);
        const BodyHandle h = scene.add(rod, Spherical{}, {});
        // F = -c x along x at the tip: torque c sin cos against m g d sin, so past the critical c the rod stands, at it
        // it falls in fourth order, for the springs yield as the cosine
        scene.apply(Potential([=](const auto& r) {
                        return -0.5 * share * need * r[0] * r[0] - 0.5 * 3.0 * need * r[1] * r[1];
                    }),
                    h, Vector3(0, 0, 1));
        scene.apply(Potential([=](const auto& r) { return -0.5 * 4.0 * r[1] * r[1]; }), h, Vector3(1, 0, 0));
        const auto found = equilibria(scene, {1, 0, 0, 0});
        ASSERT_FALSE(found.empty());
        const auto straight = std::find_if(
            found.begin(), found.end(), [](const Equilibrium& e) { return std::abs(e.coordinates[0]) > 1.0 - 1e-9; });
        ASSERT_NE(straight, found.end()) << share;
        EXPECT_TRUE(straight->decided) << share;
        EXPECT_EQ(straight->stable, share > 1.0) << share;
    }
}

TEST(BodyEquilibria, a_torque_holds_a_pendulum_aside_where_gravity_holds_against_it) {
    for (const Frame frame : {Frame::body, Frame::world}) {
        Scene scene(down);
        const BodyHandle h = scene.add(bob, across, {});
        scene.apply(Torque({3.0, 4.0, -1.0}, frame), h);
        const auto all = equilibria(scene);
        ASSERT_EQ(all.size(), 2u);
        EXPECT_NEAR(all[0].coordinates[0], std::asin(4.0 / moment), 1e-15);
        EXPECT_NEAR(all[1].coordinates[0], pi - std::asin(4.0 / moment), 1e-15);
        EXPECT_TRUE(all[0].stable && !all[1].stable);
        scene.apply(Torque(Vector3(0, 7.0, 0), frame), h);
        EXPECT_TRUE(equilibria(scene).empty()) << "it is turned over";
    }
}

TEST(BodyEquilibria, a_slide_sinks_into_its_springs_and_has_as_many_equilibria_as_they_have) {
    const double slope = 0.3;
    Scene scene(down);
    const BodyHandle h =
        scene.add(stone, Prismatic{.axis = {std::cos(slope), 0, -std::sin(slope)}}, {.displacement = 4});
    EXPECT_TRUE(equilibria(scene).empty()) << "it slides away";
    scene.apply(Potential([](const auto& r) { return -0.5 * 80.0 * dot<Expression>(r, r); }), h);
    const auto held = equilibria(scene);
    ASSERT_EQ(held.size(), 1u);
    const double sag =
        1.5 * gravity * std::sin(slope) / 80.0 - stone.com().dot(Vector3(std::cos(slope), 0, -std::sin(slope)));
    EXPECT_NEAR(held[0].coordinates[0], sag, 2e-15);
    EXPECT_NEAR(held[0].periods.at(0) / period(1.5, 80.0), 1.0, 1e-15);
    // a spring from a point beside the way that is longer than the way is far snaps through
    Scene snap;
    const BodyHandle s = snap.add(stone, Prismatic{.axis = {0, 0, 1}}, {.displacement = 0.3});
    snap.connect(Spring{.stiffness = 50.0, .rest_length = 0.5}, s.point({0.2, 0, 0}), Vector3(0.6, 0, 0.1));
    const auto all = equilibria(snap);
    ASSERT_EQ(all.size(), 3u);
    const double places[] = {0.1 - 0.3, 0.1, 0.1 + 0.3};
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(all[k].coordinates[0], places[k], 1e-15);
        EXPECT_EQ(all[k].stable, k != 1);
    }
}

TEST(BodyEquilibria, a_heavy_body_on_a_ball_joint_hangs_or_stands_and_may_turn_about_the_vertical) {
    const Attitude aslant(EulerAngles{2.0, 0.5, 1.0});
    for (const Attitude& start : {aslant, Attitude(), Attitude(EulerAngles{pi, 0.3, 0.0})}) {
        Scene scene(down);
        scene.add(bob, Spherical{.at = {1, 2, 3}}, {.attitude = start, .angular_velocity = Vector3(1, 2, 3)});
        const auto all = equilibria(scene);
        ASSERT_EQ(all.size(), 2u);
        EXPECT_LE((body_z(all[0]) - Vector3(0, 0, 1)).norm(), 2e-15);
        EXPECT_LE((body_z(all[1]) - Vector3(0, 0, -1)).norm(), 2e-15);
        EXPECT_TRUE(all[0].stable);
        EXPECT_FALSE(all[1].stable);
        ASSERT_EQ(all[0].periods.size(), 2u);
        EXPECT_NEAR(all[0].periods[0] / period(0.9, moment), 1.0, 1e-15);
        EXPECT_NEAR(all[0].periods[1] / period(0.7, moment), 1.0, 1e-15);
        for (const Equilibrium& e : all) {
            ASSERT_EQ(e.axes.size(), 1u);
            EXPECT_LE((e.axes[0] - Vector3(0, 0, 1)).norm(), 1e-14);
            // no turn about the vertical brings it nearer to where it starts
            const auto& c = e.coordinates;
            const Quaternion way = Quaternion{c[0], c[1], c[2], c[3]} * conjugate(start.quaternion());
            EXPECT_NEAR(way.z, 0.0, 1e-12) << e;
        }
    }
}

TEST(BodyEquilibria, the_periods_of_a_hanging_body_are_those_of_its_inertia_across_the_vertical) {
    Scene scene(down);
    scene.add(stone, Spherical{.point = {0.5, 0.1, -0.2}}, {.attitude = EulerAngles{1.0, 0.5, 1.0}});
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 2u);
    const Vector3 arm = stone.com() - Vector3(0.5, 0.1, -0.2), n = arm.normalized();
    const Matrix3 project = Matrix3::Identity() - n * n.transpose();
    const Matrix3 inverse = project * stone.inertia({0.5, 0.1, -0.2}).inverse() * project;
    const Vector3 squares =
        Eigen::SelfAdjointEigenSolver<Matrix3>(Matrix3(inverse * (1.5 * gravity * arm.norm()))).eigenvalues();
    ASSERT_EQ(all[0].periods.size(), 2u);
    for (int k = 0; k < 2; ++k)
        EXPECT_NEAR(all[0].periods[static_cast<std::size_t>(k)] * std::sqrt(squares[k + 1]) / (2.0 * pi), 1.0, 2e-15);
}

TEST(BodyEquilibria, two_forces_at_two_points_leave_a_ball_joint_four_attitudes_and_one_of_them_is_stable) {
    // critical points of tr(R^T sum F p^T), known as Wahba's problem
    Scene scene(down);
    const BodyHandle h = scene.add(stone, Spherical{}, {.attitude = EulerAngles{1.0, 0.5, 1.0}});
    scene.apply(Force(Vector3(3.0, -1.0, 2.0)), h, Vector3(0.4, 0.3, 0.1));
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(all[k].stable, k == 0);
        EXPECT_TRUE(all[k].axes.empty());
        const auto& c = all[k].coordinates;
        Scene there(down);
        const BodyHandle b = there.add(stone, Spherical{}, {.attitude = Attitude(Quaternion{c[0], c[1], c[2], c[3]})});
        there.apply(Force(Vector3(3.0, -1.0, 2.0)), b, Vector3(0.4, 0.3, 0.1));
        EXPECT_LE(unrest(there), 1e-12);
    }
    EXPECT_EQ(all[0].periods.size(), 3u);
}

TEST(BodyEquilibria, a_body_held_at_its_centre_of_mass_rests_as_it_is_and_is_indifferent) {
    Scene scene(down);
    const Attitude start(EulerAngles{1.0, 0.5, 1.0});
    scene.add(stone, Spherical{.point = stone.com()}, {.attitude = start});
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 1u);
    const auto& c = all[0].coordinates;
    EXPECT_LE((rotation_matrix(Quaternion{c[0], c[1], c[2], c[3]}) - start.matrix()).norm(), 1e-15);
    EXPECT_FALSE(all[0].stable);
    EXPECT_TRUE(all[0].axes.empty() && all[0].periods.empty());
}

TEST(BodyEquilibria, a_free_body_hangs_from_springs) {
    // one above G: it bobs as a mass on a spring does, and may turn about the vertical
    Scene one(down);
    const BodyHandle h = one.add(bob, Free{}, {.position = {0.3, 0.1, -1.0}, .attitude = EulerAngles{0.4, 0.2, 0.1}});
    one.connect(Spring{.stiffness = 100.0, .rest_length = 1.0}, h.point({0, 0, 0}), Vector3(0, 0, 0));
    const auto hanging = equilibria(one);
    ASSERT_EQ(hanging.size(), 1u);
    EXPECT_TRUE(hanging[0].stable);
    ASSERT_EQ(hanging[0].axes.size(), 1u);
    EXPECT_LE((hanging[0].axes[0] - Vector3(0, 0, 1)).norm(), 1e-12);
    const Vector3 place(hanging[0].coordinates.data());
    EXPECT_LE((place - Vector3(0, 0, -1.0 - 2.0 * gravity / 100.0)).norm(), 1e-14);
    ASSERT_EQ(hanging[0].periods.size(), 5u);
    double nearest = 1.0;
    for (const double t : hanging[0].periods) nearest = std::min(nearest, std::abs(t / period(2.0, 100.0) - 1.0));
    EXPECT_LE(nearest, 1e-14);
    // three hold it from turning
    Scene three(down);
    const BodyHandle g = three.add(stone, Free{}, {.position = {0, 0, -1.0}});
    const Vector3 points[] = {{0.5, 0, 0.2}, {-0.4, 0.4, 0.2}, {-0.3, -0.5, 0.1}};
    for (const Vector3& p : points)
        three.connect(Spring{.stiffness = 80.0, .rest_length = 0.5}, g.point(p), Vector3(1.5 * p));
    const auto held = equilibria(three);
    ASSERT_EQ(held.size(), 1u);
    EXPECT_TRUE(held[0].stable && held[0].axes.empty());
    EXPECT_EQ(held[0].periods.size(), 6u);
    const auto& c = held[0].coordinates;
    Scene there(down);
    const BodyHandle b = there.add(
        stone, Free{}, {.position = {c[0], c[1], c[2]}, .attitude = Attitude(Quaternion{c[3], c[4], c[5], c[6]})});
    for (const Vector3& p : points)
        there.connect(Spring{.stiffness = 80.0, .rest_length = 0.5}, b.point(p), Vector3(1.5 * p));
    EXPECT_LE(unrest(there), 1e-12);
}

/// A bead, a particle and four bodies, joined in a chain by springs; at given coordinates.
Scene chain(const std::vector<double>& c) {
    Scene scene(down);
    const auto bead = scene.add(Particle{.mass = 0.5}, Rail(vertical_circle(1.0)), {.parameter = c[0]});
    const auto hinge = scene.add(bob, Revolute{.axis = {0, 1, 0}, .at = {2, 0, 0}}, {.angle = c[1]});
    const auto slide = scene.add(stone, Prismatic{.axis = {1, 0, 0}, .at = {3, 0, -1}}, {.displacement = c[2]});
    const auto ball =
        scene.add(stone, Spherical{.at = {4, 0, 0}}, {.attitude = Attitude(Quaternion{c[3], c[4], c[5], c[6]})});
    const auto free = scene.add(
        bob, Free{}, {.position = {c[7], c[8], c[9]}, .attitude = Attitude(Quaternion{c[10], c[11], c[12], c[13]})});
    const auto weight = scene.add(Particle{.mass = 0.25}, {.position = {c[14], c[15], c[16]}});
    const Spring spring{.stiffness = 60.0, .rest_length = 0.3};
    scene.connect(spring, bead, hinge.point({0, 0, -0.8}));
    scene.connect(spring, hinge.point({0, 0.1, -1.0}), slide.point({0.2, 0, 0}));
    scene.connect(spring, slide.point({0.5, 0, 0}), ball.point({0, 0, 0.6}));
    scene.connect(spring, ball.point({0.3, 0, 0.2}), free.point({0.2, 0, 0}));
    scene.connect(spring, free.point({0, 0.2, 0}), Vector3(6, 0, 1));
    scene.connect(spring, free, weight);
    return scene;
}

TEST(BodyEquilibria, bodies_and_beads_joined_by_springs_come_to_rest_together) {
    const std::vector<double> start{0.2, 0.1, 0.3, 1, 0, 0, 0, 5.5, 0, -0.5, 1, 0, 0, 0, 5.5, 0, -1.5};
    const auto all = equilibria(chain(start));
    ASSERT_EQ(all.size(), 1u);
    EXPECT_TRUE(all[0].stable);
    ASSERT_EQ(all[0].coordinates.size(), start.size());
    EXPECT_EQ(all[0].periods.size(), 15u);
    EXPECT_LE(unrest(chain(all[0].coordinates)), 1e-12);
    const auto again = equilibria(chain(start), all[0].coordinates);
    ASSERT_EQ(again.size(), 1u);
    for (std::size_t k = 0; k < start.size(); ++k)
        EXPECT_NEAR(again[0].coordinates[k], all[0].coordinates[k], 1e-13) << k;
}

TEST(BodyEquilibria, what_they_cannot_answer_they_refuse) {
    Scene timed(down);
    const BodyHandle h = timed.add(bob, across, {});
    timed.apply(Torque([](const auto& t, const auto&, const auto&) { return Vector(0.0, sin(t), 0.0); }), h);
    EXPECT_NE(refusal([&] { equilibria(timed); }).find("torque \"function\" on body 1 depends on time"),
              std::string::npos);
    Scene ball(down);
    ball.add(bob, Spherical{}, {});
    EXPECT_NE(refusal([&] {
                  equilibria(ball, {1.0, 2.0, 0.0, 0.0});
              }).find("norm of the quaternion"),
              std::string::npos);
    EXPECT_NE(refusal([&] { equilibria(ball, {0.0}); }).find("this scene has 4"), std::string::npos);
}

}  // namespace
}  // namespace rbdyn::test::test_body_equilibria
