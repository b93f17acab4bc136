// The special laws of rigid bodies against the general assembly, and ideal joints.
#include <gtest/gtest.h>

#include <iostream>
#include <rbdyn/body/shapes.hpp>
#include <rbdyn/model/assembly.hpp>
#include <rbdyn/special/laws_now.hpp>
#include <rbdyn/special/rigid_law.hpp>
#include <rbdyn/special/single_laws.hpp>

#include "bodies/random_bodies.hpp"

namespace rbdyn::test::test_assembly {
namespace {

const char* const joints[] = {"free", "ball joint", "hinge", "slide"};

/// Loads of every kind on a body.
void load(Scene& scene, Random& random, BodyHandle body, bool on_hinge) {
    const auto point = [&] { return random_vector(random, 1.0); };
    scene.apply(Force(random_vector(random, 3.0)), body, point());
    scene.apply(Force(random_vector(random, 3.0), Frame::body), body, point());
    const auto pull = [](const auto& t, const auto& r, const auto& v) {
        using V = std::decay_t<decltype(r)>;
        return V(r[1] * 0.5 - v[0] * t, r[2] * v[1], cos(t) * r[0] - v[2]);
    };
    scene.apply(Force(pull), body, point());
    scene.apply(Force(pull, Frame::body), body);
    scene.apply(Potential([](const auto& r) { return sin(r[0]) * r[1] - r[2] * r[2]; }), body, point());
    scene.apply(Lorentz{0.75, random_vector(random, 1.0)}, body, point());
    scene.apply(Drag{.linear = 0.25, .quadratic = 0.5}, body, point());
    scene.apply(Torque(random_vector(random, 2.0)), body);
    scene.apply(Torque(random_vector(random, 2.0), Frame::world), body);
    const auto twist = [](const auto& t, const auto& r, const auto& omega) {
        using V = std::decay_t<decltype(omega)>;
        return V(r[0][1] * omega[0] - t, r[2][0] * 3.0 + r[1][2], omega[1] * omega[2] - r[0][2]);
    };
    scene.apply(Torque(twist), body);
    scene.apply(Torque(twist, Frame::world), body);
    if (on_hinge) scene.apply(TorsionSpring{.stiffness = 1.5, .rest_angle = 0.25, .damping = 0.5}, body);
    const Spring spring{.stiffness = 4.0, .rest_length = 0.5, .damping = 0.75};
    scene.connect(spring, body.point(point()), random_vector(random, 3.0));
    scene.connect(spring, random_vector(random, 3.0), body);
    // both ends on one body: it does nothing to its motion
    scene.connect(spring, body.point(point()), body.point(point()));
}

double expect_like_the_assembly(const Scene& scene, double t, const std::string& what) {
    const Assembly assembly(scene, t);
    const SingleLaws laws(scene, Placement{});
    const std::vector<double> x = laws.start(t);
    double worst = 0.0;
    const auto compare = [&](const Vector3& value, const Vector3& right, double size, const char* name) {
        const double off = (value - right).norm() / size;
        worst = std::max(worst, off);
        // a few dozen operations on each side
        EXPECT_LE(off, 20 * epsilon) << what << ": " << name;
    };
    for (int i = 0; i < static_cast<int>(scene.bodies().size()); ++i) {
        if (scene.bodies()[static_cast<std::size_t>(i)].rigid() == nullptr) continue;
        const std::vector<signed char> slip(scene.bodies().size(), 1);
        const RigidReport r = laws.rigid(i).rigid_report(LawsNow(laws, slip, t, x));
        const AssembledBody b = assembly.body(i);
        const Matrix3 axes = assembly.motion(i).axes;
        const double effort = b.effort, least = scene.bodies()[static_cast<std::size_t>(i)].mass() * 0.05;
        compare(r.position, assembly.motion(i).position, 1.0 + r.position.norm(), "position");
        compare(r.velocity, assembly.motion(i).velocity.tail(3), 1.0 + r.velocity.norm(), "velocity");
        compare(r.force, b.force, effort, "force");
        compare(r.acceleration, b.acceleration, effort / least, "acceleration of the origin");
        compare(axes * r.angular_acceleration, b.angular_acceleration, effort / least, "angular acceleration");
        compare(r.reaction, b.reaction, effort, "reaction");
        compare(r.reaction_torque, b.reaction_torque, effort, "reaction torque");
        for (const double power : b.virtual_power)
            EXPECT_LE(std::abs(power), 100 * epsilon * effort) << what << ": power of the reactions";
    }
    return worst;
}

TEST(Assembly, says_of_every_joint_and_load_what_the_special_laws_say) {
    Random random(1);
    double worst = 0.0;
    for (int k = 0; k < 400; ++k) {
        Scene scene(random_vector(random, 10.0));
        const BodyHandle body = add_random(scene, random, random_body(random), k % 4);
        if (k % 3 > 0) load(scene, random, body, k % 4 == 2);
        worst = std::max(worst, expect_like_the_assembly(scene, random.uniform(-2.0, 2.0), joints[k % 4]));
    }
    if (setting("RBDYN_TEST_TABLE", 0) != 0) std::cout << "worst difference " << worst << '\n';
}

TEST(Assembly, says_of_symmetric_bodies_what_the_frame_that_does_not_spin_says) {
    Random random(2);
    for (int k = 0; k < 200; ++k) {
        const Vector3 through = random_vector(random, 1.0);
        const RigidBody top = random_top(random, through);
        Scene scene(random_vector(random, 10.0));
        const Attitude attitude = random_attitude(random);
        const Vector3 omega = random_vector(random, 4.0);
        const BodyHandle body = k % 2 == 0
                                    ? scene.add(top, Spherical{.at = random_vector(random, 1.0), .point = through},
                                                {.attitude = attitude, .angular_velocity = omega})
                                    : scene.add(top, Free{}, {.attitude = attitude, .angular_velocity = omega});
        const Vector3 along = top.com() - through;
        if (k % 3 > 0) {
            scene.apply(Drag{.linear = 0.25, .quadratic = 0.5}, body);
            scene.apply(Force(random_vector(random, 3.0)), body, Vector3(through + along * 1.0));
        }
        expect_like_the_assembly(scene, 0.5, "symmetric body");
        if (k % 3 == 0) {
            EXPECT_TRUE(SingleLaws(scene, {}).rigid(0).follows_axis) << k;
        }
    }
}

TEST(Assembly, says_of_bodies_that_springs_join_what_the_special_laws_say) {
    Random random(3);
    for (int k = 0; k < 100; ++k) {
        Scene scene(random_vector(random, 10.0));
        std::vector<BodyHandle> all;
        for (int joint = 0; joint < 4; ++joint) all.push_back(add_random(scene, random, random_body(random), joint));
        all.push_back(scene.add(Particle{1.5}, Free{},
                                {.position = random_vector(random, 2.0), .velocity = random_vector(random, 2.0)}));
        all.push_back(scene.add(Particle{0.5}, Rail(Circle{.radius = 1.5, .start = {1, 2, 0}, .toward = {0, 1, 3}}),
                                {.parameter = random.uniform(-3, 3), .speed = random.uniform(-2, 2)}));
        for (std::size_t i = 0; i < all.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const auto end = [&](std::size_t b) -> End {
                    if (b >= 4 || random.chance(0.3)) return all[b];
                    return all[b].point(random_vector(random, 1.0));
                };
                scene.connect(Spring{.stiffness = random.uniform(1, 9), .rest_length = 0.5, .damping = 0.5}, end(i),
                              end(j));
            }
        expect_like_the_assembly(scene, 0.0, "bodies joined by springs");
        // beads and particles too
        const SingleLaws laws(scene, Placement{});
        const Assembly assembly(scene);
        const std::vector<double> x = laws.start();
        const std::vector<signed char> slip(all.size(), 1);
        for (const int i : {4, 5}) {
            const PointReport r = laws.body(i).report(LawsNow(laws, slip, 0.0, x));
            const AssembledBody b = assembly.body(i);
            EXPECT_LE((r.acceleration - b.acceleration).norm(), 200 * epsilon * b.effort) << i;
            EXPECT_LE((r.reaction - b.reaction).norm(), 200 * epsilon * b.effort) << i;
        }
    }
}

TEST(IdealJoints, reactions_of_every_joint_do_no_work_on_what_it_allows) {
    // on the library's own reactions: at a ball no torque, about a hinge none along it, on a slide no force along it
    Random random(4);
    for (int k = 0; k < 150; ++k) {
        Scene scene(random_vector(random, 10.0));
        const int joint = 1 + k % 3;
        const BodyHandle body = add_random(scene, random, random_body(random), joint);
        load(scene, random, body, joint == 2);
        const SingleLaws laws(scene, Placement{});
        const std::vector<signed char> slip{1};
        const std::vector<double> x = laws.start();
        const RigidReport r = laws.rigid(0).rigid_report(LawsNow(laws, slip, 0.25, x));
        const Joint& j = scene.bodies()[0].joint;
        EXPECT_GT(r.reaction.norm(), 1e-3);
        if (joint == 1) {
            EXPECT_EQ(r.reaction_torque.norm(), 0.0);
        } else if (joint == 2) {
            EXPECT_LE(std::abs(std::get<Revolute>(j).axis.normalized().dot(r.reaction_torque)),
                      20 * epsilon * r.torque_effort);
        } else {
            EXPECT_LE(std::abs(std::get<Prismatic>(j).axis.normalized().dot(r.reaction)),
                      20 * epsilon * r.force_effort);
        }
    }
}

TEST(IdealJoints, a_balanced_rotor_asks_nothing_of_its_bearings_and_another_does) {
    // weightless and driven: reactions vanish just when G lies on the axis and I13 = I23 = 0 (after 7.60)
    Random random(5);
    for (int k = 0; k < 40; ++k) {
        const Vector3 axis = random.direction(), point = random_vector(random, 1.0);
        const RigidBody upright(2.0, {0.5, 0.75, random.uniform(0.3, 1.2)});
        const Attitude along = Attitude(Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis).toRotationMatrix());
        const RigidBody balanced = upright.rotated(along).shifted(point + 0.5 * axis);
        for (const bool is_off : {false, true}) {
            const Vector3 across = axis.cross(random.direction());
            // two masses opposite each other across the axis, at different heights: G stays on it
            const RigidBody body =
                is_off
                    ? balanced + shapes::points({0.25, 0.25}, {Vector3(point + axis + across), Vector3(point - across)})
                    : balanced;
            Scene scene;
            const BodyHandle b = scene.add(body, Revolute{.axis = axis, .point = point}, {.angle = 1.0, .rate = 2.0});
            scene.apply(Torque(axis * 3.0, Frame::world), b);
            const SingleLaws laws(scene, Placement{});
            const std::vector<signed char> slip{1};
            const std::vector<double> x = laws.start();
            const RigidReport r = laws.rigid(0).rigid_report(LawsNow(laws, slip, 0.0, x));
            EXPECT_LE(r.reaction.norm(), 40 * epsilon * 10.0);
            if (is_off) {
                EXPECT_GT(r.reaction_torque.norm(), 0.1 * across.norm());
            } else {
                EXPECT_LE(r.reaction_torque.norm(), 100 * epsilon * 10.0);
            }
        }
    }
}

}  // namespace
}  // namespace rbdyn::test::test_assembly
