// A force, a drive and an engine of the user's choice, from C++: functors over the number type, recorded once.
#include <cmath>
#include <iostream>
#include <rbdyn/rbdyn.hpp>

int main() {
    using rbdyn::Vector3Of;
    rbdyn::Scene scene({0.0, 0.0, -9.81});
    const rbdyn::Helix coil{.radius = 0.4, .pitch = 0.8, .start = {1, 0, 0}, .toward = {0, 1, 0}};
    const rbdyn::Rail rail(coil, rbdyn::Coulomb{.mu_static = 0.2, .mu_dynamic = 0.15},
                           {.drive = [](const auto& t) { return 0.5 * sin(3.0 * t); }});
    const auto bead = scene.add(rbdyn::Particle{.mass = 0.2}, rail, {.parameter = 0.0, .speed = 1.0});
    // a wind along x that grows with height and drags by its square
    scene.apply(rbdyn::Force([](const auto&, const auto& position, const auto& velocity) {
                    auto relative = velocity;
                    relative[0] = velocity[0] - 0.5 * position[2];
                    const auto speed = rbdyn::length(relative);
                    for (int i = 0; i < 3; ++i) relative[i] = -0.05 * speed * relative[i];
                    return relative;
                }),
                bead);

    const auto taylor = rbdyn::simulate(scene, {.until = 2.0, .error = 1e-10});
    const auto adams = rbdyn::simulate(scene, {.until = 2.0, .error = 1e-8, .engine = "cvode-adams"});
    std::cout << taylor << taylor.plan() << adams;
    const double difference = (taylor[bead].position(2.0) - adams[bead].position(2.0)).norm();
    std::cout << "the two engines differ by " << difference << " m\n";
    return difference < 1e-7 ? 0 : 1;
}
