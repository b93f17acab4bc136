// Points held on curves: of the world, and of bodies that move.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "rbdyn/mechanics/foot.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"

namespace rbdyn::test {
namespace point_on_curve {

const Circle ring{.radius = 0.6, .start = {1, 0, 0}, .toward = {0, 0.6, 0.8}};

TEST(PointOnCurve, a_bead_goes_round_uniformly_and_is_pulled_to_the_centre) {
    Scene scene;
    const BodyHandle bead = scene.add(Particle{0.5}, FreeStart{.position = {0.6, 0, 0}, .velocity = {0, 0.72, 0.96}});
    const ConstraintHandle on = scene.constrain(PointOnCurve{ring}, bead);
    const Trajectory run = simulate(scene, {.until = 10.0, .error = 1e-11});
    for (const double t : {0.0, 2.5, 10.0}) {
        const double angle = 2.0 * t;  // 1.2 m/s on 0.6 m
        const Vector3 place = 0.6 * Vector3(std::cos(angle), 0.6 * std::sin(angle), 0.8 * std::sin(angle));
        EXPECT_LT((run[bead].position(t) - place).norm(), 1e-12) << t;
        EXPECT_LT((run[on].force(t) + 0.5 * 4.0 * place).norm(), 1e-11) << t;
        EXPECT_LT(run[on].gap(t), 1e-14) << t;
    }
}

TEST(PointOnCurve, a_curve_of_a_body_is_pushed_back) {
    Scene scene;
    const BodyHandle plate =
        scene.add(RigidBody(2.0, {0.3, 0.5, 0.7}), BodyStart{.angular_velocity = Vector3(1, 2, 3)});
    const BodyHandle bead = scene.add(
        Particle{0.5}, FreeStart{.position = {0.6, 0, 0}, .velocity = Vector3(1, 2, 3).cross(Vector3(0.6, 0, 0))});
    const ConstraintHandle on = scene.constrain(PointOnCurve{ring}, bead, plate);
    const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-11});
    for (const auto& [name, drift] : run.drift()) EXPECT_LT(drift, 1e-11) << name;
    EXPECT_LT((run[on].force(1.0) - 0.5 * run[bead].acceleration(1.0)).norm(), 1e-10);
    EXPECT_LT((run[on].force(1.0) + 2.0 * run[plate].center_of_mass_acceleration(1.0)).norm(), 1e-10);
}

TEST(PointOnCurve, a_start_beside_the_curve_is_refused_with_its_gap) {
    Scene scene;
    const BodyHandle bead = scene.add(Particle{0.5}, FreeStart{.position = {0.7, 0, 0}});
    scene.constrain(PointOnCurve{ring}, bead, std::nullopt, "ring");
    const std::string message = refusal([&] { simulate(scene, {.until = 1.0}); });
    EXPECT_NE(message.find("ring: gap is 0.09999999999999"), std::string::npos) << message;
}

TEST(Foot, the_nearest_place_is_found_far_out_and_where_a_curve_meets_itself) {
    const Curve line = Line{.direction = {1, 0, 0}};
    const auto far = mechanics::Foot::nearest(line, {12345.678, 1, 0});
    ASSERT_EQ(far.size(), 1u);
    EXPECT_NEAR(far[0], 12345.678, 1e-9);
    const Curve coil = Helix{.radius = 1.0, .pitch = 0.5, .start = {1, 0, 0}, .toward = {0, 1, 0}};
    const auto turn = mechanics::Foot::nearest(coil, coil.position(200.0));
    ASSERT_EQ(turn.size(), 1u);
    EXPECT_NEAR(turn[0], 200.0, 1e-9);
    const Curve eight(
        [](const auto& u) {
            return Vector3Of<std::decay_t<decltype(u)>>{sin(u), sin(u) * cos(u), 0.0 * u};
        },
        {0.0, 6.283185307179586}, true);
    EXPECT_EQ(mechanics::Foot::nearest(eight, {0, 0, 0}).size(), 2u);
}

TEST(Foot, no_tangent_points_aside) {
    // a curve whose tangents go all over the sphere but for some gaps
    const Polynomial cubic{.coefficients = {{0, 0, 0}, {1, 0.25, 0}, {0, 0.5, 0.5}, {0.1, 0, 0.3}}};
    for (const Curve& curve : {Curve(cubic), Curve(ring), Curve(Line{.direction = {1, 2, 3}})}) {
        const Vector3 aside = mechanics::Foot::direction_aside(curve);
        EXPECT_NEAR(aside.norm(), 1.0, 1e-15);
        for (double u = -20.0; u <= 20.0; u += 0.01) {
            const Vector3 first = curve.own<double>(u).first;
            EXPECT_GT(aside.cross(first).norm(), 0.1 * first.norm()) << curve.name() << " " << u;
        }
    }
}

}  // namespace point_on_curve
}  // namespace rbdyn::test
