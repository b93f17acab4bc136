// What the tests of systems share: reference cases as scenes, and random systems of everything there is.
#pragma once

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "closed_form/reference.hpp"
#include "random.hpp"
#include "rbdyn/body/shapes.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/statics/equilibria.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn::test {

using Real = long double;
using Wide = Eigen::Matrix<Real, 3, 1>;

/// A vector of a reference file; the third component of a plane one is zero.
inline Wide wide3(const nlohmann::json& list) {
    Wide v = Wide::Zero();
    for (std::size_t i = 0; i < list.size(); ++i) v[static_cast<Eigen::Index>(i)] = digits(list[i]);
    return v;
}
inline Vector3 vector3(const nlohmann::json& list) { return wide3(list).cast<double>(); }
inline double off(const Vector3& value, const nlohmann::json& exact) {
    return static_cast<double>((value.cast<Real>() - wide3(exact)).norm());
}

/// Particles under their gravitation: the cases o_*.
struct Attracted {
    Scene scene;
    std::vector<BodyHandle> bodies;

    explicit Attracted(const nlohmann::json& file) {
        const auto& p = file["parameters"];
        for (std::size_t i = 0; i < p["mass"].size(); ++i)
            bodies.push_back(scene.add(Particle{static_cast<double>(digits(p["mass"][i]))},
                                       {vector3(p["position0"][i]), vector3(p["velocity0"][i])}));
        const Gravitation law{static_cast<double>(digits(p["constant"]["value"]))};
        for (std::size_t j = 0; j < bodies.size(); ++j)
            for (std::size_t i = 0; i < j; ++i) scene.connect(law, bodies[i], bodies[j]);
    }
};

/// Free particles, beads and rigid bodies on joints of all kinds, with loads, joined by couplings of all kinds.
/// `is_central`: internal forces are along the lines of their ends.
inline Scene random_system(Random& random, bool is_central = true) {
    Scene scene(random.chance(0.5) ? Vector3(0, 0, -9.8125) : Vector3(0, 0, 0));
    const auto place = [&] { return Vector3(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)); };
    const auto some = [&] { return Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
    std::vector<BodyHandle> bodies;
    const int count = random.whole(2, 5);
    const auto box = [&] {
        return shapes::box(random.uniform(0.5, 2.0),
                           {random.uniform(0.5, 1.0), random.uniform(0.5, 1.0), random.uniform(0.5, 1.0)});
    };
    for (int i = 0; i < count; ++i) {
        switch (random.whole(0, 5)) {
            case 0: bodies.push_back(scene.add(Particle{random.uniform(0.5, 2.0)}, {place(), some()})); break;
            case 1:
                bodies.push_back(scene.add(Particle{random.uniform(0.5, 2.0)},
                                           Rail(Circle{.radius = 2.0, .start = some(), .toward = some()}),
                                           {.parameter = random.uniform(0, 6), .speed = random.uniform(-1, 1)}));
                break;
            case 2:
                bodies.push_back(
                    scene.add(box().shifted(some()),
                              BodyStart{.position = place(), .velocity = some(), .angular_velocity = some()}));
                break;
            case 3:
                bodies.push_back(
                    scene.add(box(), Spherical{.at = place(), .point = some()}, {.angular_velocity = some()}));
                break;
            case 4:
                bodies.push_back(scene.add(box(), Revolute{.axis = some(), .at = place(), .point = some()},
                                           {.angle = random.uniform(-3, 3), .rate = random.uniform(-1, 1)}));
                break;
            default:
                bodies.push_back(scene.add(box(), Prismatic{.axis = some(), .at = place()},
                                           {.displacement = random.uniform(-1, 1), .rate = random.uniform(-1, 1)}));
        }
    }
    const auto is_rigid = [&](BodyHandle b) {
        return scene.bodies()[static_cast<std::size_t>(b.index)].rigid() != nullptr;
    };
    for (const BodyHandle b : bodies) {
        if (random.chance(0.3)) scene.apply(Drag{.linear = 0.1, .quadratic = 0.05}, b);
        if (random.chance(0.3)) scene.apply(Force(some()), b);
        if (random.chance(0.3))
            scene.apply(Force([](const auto& t, const auto& r, const auto&) {
                            using T = std::decay_t<decltype(r[0])>;
                            return Vector3Of<T>{sin(t), -r[1], T(0.5)};
                        }),
                        b);
        if (is_rigid(b) && random.chance(0.3)) scene.apply(Force(some()), b, some());
        if (is_rigid(b) && random.chance(0.3)) scene.apply(Torque(some()), b);
        if (random.chance(0.4)) {
            const End end = is_rigid(b) && random.chance(0.5) ? End(b.point(some())) : End(b);
            scene.connect(Spring{.stiffness = 2.0, .rest_length = 0.5, .damping = 0.1}, end, Vector3(place()));
        }
    }
    for (int i = 0; i < count; ++i)
        for (int j = 0; j < i; ++j) {
            const BodyHandle a = bodies[static_cast<std::size_t>(i)], b = bodies[static_cast<std::size_t>(j)];
            switch (random.whole(0, is_central ? 3 : 4)) {
                case 0: scene.connect(Spring{.stiffness = 3.0, .rest_length = 1.0, .damping = 0.2}, a, b); break;
                case 1: scene.connect(Gravitation{0.5}, a, b); break;
                case 2: scene.connect(Central([](const auto& r) { return 0.3 / (1.0 + r * r); }), a, b); break;
                case 3: break;
                default:
                    scene.connect(
                        PairForce([](const auto& t, const auto& ra, const auto& rb, const auto& va, const auto&) {
                            using T = std::decay_t<decltype(ra[0])>;
                            return Vector3Of<T>{0.5 * (rb[1] - ra[1]), cos(t) - 0.1 * va[0], ra[2] * rb[0]};
                        }),
                        a, b);
            }
        }
    return scene;
}

}  // namespace rbdyn::test
