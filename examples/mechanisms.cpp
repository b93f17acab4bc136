// Bodies joined to bodies, from C++: a double pendulum of two plates, a four-bar linkage whose loop a pin closes, and a
// ladder that slides down a wall until it leaves it.
#include <cmath>
#include <iostream>
#include <numbers>
#include <rbdyn/rbdyn.hpp>

namespace {

const rbdyn::Vector3 z{0, 0, 1}, gravity{0, -9.81, 0};

/// A plate in the plane of motion.
rbdyn::RigidBody plate(double mass, const rbdyn::Vector3& com, double moment) {
    return rbdyn::RigidBody(mass, {moment / 2, moment / 2, moment}, {.com = com});
}

bool double_pendulum() {
    rbdyn::Scene scene(gravity);
    const auto upper = scene.add(plate(2.0, {0, -0.5, 0}, 0.2), rbdyn::Revolute{.axis = z}, {.angle = 1.5});
    const auto lower = scene.add(plate(1.0, {0, -0.4, 0}, 0.1), rbdyn::Revolute{.axis = z, .at = {0, -1, 0}},
                                 {.angle = -0.75, .rate = 2.0, .parent = upper});
    const rbdyn::Trajectory run = rbdyn::simulate(scene, {.until = 5.0, .error = 1e-10});
    std::cout << run << "the lower plate has turned by " << run[lower].angle(5.0) << " rad; its pin carries "
              << run[lower].reaction(5.0).norm() << " N\n";
    return std::abs(run.energy(5.0) / run.energy(0.0) - 1.0) < 1e-12;
}

bool linkage() {
    rbdyn::Scene scene(gravity);
    const auto crank =
        scene.add(plate(1.0, {0.4, 0, 0}, 0.05), rbdyn::Revolute{.axis = z}, {.angle = 0.5, .rate = 3.0});
    const auto coupler = scene.add(plate(2.0, {1, 0, 0}, 0.7), rbdyn::Revolute{.axis = z, .at = {0.75, 0, 0}},
                                   {.angle = 0.1, .parent = crank});
    const auto rocker =
        scene.add(plate(1.5, {0.75, 0, 0}, 0.3), rbdyn::Revolute{.axis = z, .at = {2, 0, 0}}, {.angle = 1.4});
    const auto pin = scene.constrain(rbdyn::Ball{}, coupler.point({2, 0, 0}), rocker.point({1.5, 0, 0}));
    scene.assemble({crank});
    const rbdyn::Trajectory run = rbdyn::simulate(scene, {.until = 5.0, .error = 1e-10});
    std::cout << run << run.plan().freedom() << " degree of freedom; the pin carries " << run[pin].force(5.0).norm()
              << " N, and is open by " << run[pin].gap(2.5) << " m\n";
    return run.plan().freedom() == 1 && run[pin].gap(2.5) < 1e-12;
}

bool ladder() {
    const double length = 4.0, theta = 1.2;
    rbdyn::Scene scene({0, 0, -9.81});
    const auto rod = scene.add(
        rbdyn::shapes::rod(10.0, length, {1, 0, 0}), rbdyn::Planar{.x = {1, 0, 0}, .y = {0, 0, 1}},
        {.position = {length / 2 * std::cos(theta), length / 2 * std::sin(theta)}, .angle = std::numbers::pi - theta});
    scene.contact(rod.point({-length / 2, 0, 0}), rbdyn::Plane{{0, 0, 1}});
    const auto wall = scene.contact(rod.point({length / 2, 0, 0}), rbdyn::Plane{{1, 0, 0}});
    const rbdyn::Trajectory run = rbdyn::simulate(scene, {.until = 1.0});
    const double leaves = run.events().times("detach", wall).at(0);
    // where the sine of its slope is two thirds of what it was
    const double sine = std::sin(std::numbers::pi - run[rod].angle(leaves));
    std::cout << run << "the ladder leaves its wall at " << leaves << " s\n";
    return std::abs(sine / std::sin(theta) - 2.0 / 3.0) < 1e-9;
}

}  // namespace

int main() { return double_pendulum() && linkage() && ladder() ? 0 : 1; }
