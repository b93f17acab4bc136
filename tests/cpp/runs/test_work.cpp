// Work along a run: what of it is there, and where velocities jump.
#include <gtest/gtest.h>

#include <vector>

#include "rbdyn/body/shapes.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "rbdyn/trajectory/work.hpp"
#include "support.hpp"

namespace rbdyn::test::test_work {
namespace {

TEST(Work, is_that_of_a_motion_that_is_all_there) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}, {0.5, 0, 4}});
    scene.apply(Drag{.quadratic = 0.125}, ball);
    scene.contact(ball, Plane{{0, 0, 1}}, {.restitution = 0.75});
    const Trajectory run = simulate(scene, {.until = 3.0});
    const RunData& data = *run.data();
    EXPECT_TRUE(working::covers(data.record, 0.0, 3.0));
    EXPECT_TRUE(working::covers(data.record, 0.5, 2.5));
    Record some = data.record;
    some.keep_only({0.01, 2.99});
    ASSERT_GE(some.entries().size(), 2u);
    EXPECT_TRUE(working::covers(some, 0.005, 0.01));
    EXPECT_FALSE(working::covers(some, 0.01, 2.99));
    // velocities jump at its impacts
    const std::vector<double> impacts = run.events().times("impact");
    ASSERT_GE(impacts.size(), 2u);
    EXPECT_EQ(working::jumps(data, 0.0, 3.0), impacts);
    EXPECT_EQ(working::jumps(data, impacts[0], 3.0), std::vector<double>(impacts.begin() + 1, impacts.end()));
}

TEST(Work, of_a_torsion_spring_in_a_mechanism_is_what_the_energy_gains) {
    Scene scene(down);
    const RigidBody rod = shapes::rod(1.3, 0.7, {0, 0, 1});
    const Vector3 top(0, 0, 0.35), y(0, 1, 0);
    const BodyHandle upper = scene.add(rod, Revolute{.axis = y, .point = top}, {.angle = 0.3}),
                     lower = scene.add(rod, Revolute{.axis = y, .at = -top, .point = top},
                                       {.angle = -0.2, .parent = upper});
    const LoadHandle spring = scene.apply(TorsionSpring{.stiffness = 3.0, .damping = 0.2}, lower);
    const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-10});
    const auto energy = [&](double t) {
        return run.kinetic_energy(t) + 1.3 * gravity * (run[upper].position(t)[2] + run[lower].position(t)[2]);
    };
    for (const double t : {0.3, 1.0}) EXPECT_NEAR(run.work(0.0, t, spring), energy(t) - energy(0.0), 1e-8);
}

}  // namespace
}  // namespace rbdyn::test::test_work
