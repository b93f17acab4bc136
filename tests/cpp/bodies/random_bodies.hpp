// Bodies, joints and loads drawn at random: every inertia full, every point off everything.
#pragma once

#include "rbdyn/body/shapes.hpp"
#include "rbdyn/scene/scene.hpp"
#include "support.hpp"

namespace rbdyn::test {

inline Vector3 random_vector(Random& random, double size) {
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}
inline Quaternion random_attitude(Random& random) {
    Quaternion q{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    return normalized(q);
}
/// Some points of mass welded: what they have together is the inertia of a body.
inline RigidBody random_body(Random& random) {
    std::vector<double> masses;
    std::vector<Vector3> places;
    for (int k = 0; k < 5; ++k) {
        masses.push_back(random.uniform(0.25, 1.0));
        places.push_back(random_vector(random, 1.0));
    }
    return shapes::points(masses, places);
}

/// One of the four joints, at a random state of motion.
inline BodyHandle add_random(Scene& scene, Random& random, const RigidBody& body, int joint) {
    const Vector3 at = random_vector(random, 2.0), point = random_vector(random, 1.0);
    const Attitude attitude = random_attitude(random);
    const Vector3 omega = random_vector(random, 3.0);
    const double coordinate = random.uniform(-3.0, 3.0), rate = random.uniform(-3.0, 3.0);
    // not of unit length
    const Vector3 axis = random.uniform(0.5, 2.0) * random.direction();
    switch (joint) {
        case 0:
            return scene.add(body, Free{},
                             {.position = at,
                              .velocity = random_vector(random, 2.0),
                              .attitude = attitude,
                              .angular_velocity = omega});
        case 1:
            return scene.add(body, Spherical{.at = at, .point = point},
                             {.attitude = attitude, .angular_velocity = omega});
        case 2:
            return scene.add(body, Revolute{.axis = axis, .at = at, .point = point},
                             {.angle = coordinate, .rate = rate});
        default:
            return scene.add(body, Prismatic{.axis = axis, .at = at, .point = point},
                             {.displacement = coordinate, .rate = rate});
    }
}

/// A symmetric body with G on its axis, which is turned anyhow and goes through `through`.
inline RigidBody random_top(Random& random, const Vector3& through) {
    const double across = random.uniform(0.5, 1.0), along = random.uniform(0.1, 0.9) * 2.0 * across;
    const RigidBody upright(random.uniform(0.5, 2.0), {across, across, along},
                            {.com = {0, 0, random.uniform(0.2, 1.0)}});
    return upright.rotated(random_attitude(random)).shifted(through);
}

/// The scene of a run as it is at a time: where another run takes it up.
inline Scene taken_up(const Trajectory& run, double t) {
    const Scene& scene = run.scene();
    Scene result(scene.gravity());
    for (int i = 0; i < static_cast<int>(scene.bodies().size()); ++i) {
        const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(i)];
        const RigidReport r = run[BodyHandle{i}].rigid(t);
        if (std::holds_alternative<Free>(b.joint))
            result.add(*b.rigid(), Free{},
                       {.position = r.position,
                        .velocity = r.velocity,
                        .attitude = r.attitude,
                        .angular_velocity = r.angular_velocity});
        else if (const Spherical* ball = std::get_if<Spherical>(&b.joint))
            result.add(*b.rigid(), *ball, {.attitude = r.attitude, .angular_velocity = r.angular_velocity});
        else if (const Revolute* hinge = std::get_if<Revolute>(&b.joint))
            result.add(*b.rigid(), *hinge, {.angle = r.coordinate, .rate = r.rate});
        else
            result.add(*b.rigid(), std::get<Prismatic>(b.joint), {.displacement = r.coordinate, .rate = r.rate});
    }
    for (const Scene::AppliedLoad& load : scene.loads()) result.apply(load.load, {load.body}, load.at);
    for (const Scene::Connection& c : scene.connections()) result.connect(c.coupling, c.a, c.b);
    return result;
}

}  // namespace rbdyn::test
