// A bead on a rough hoop, from C++.
#include <cmath>
#include <iostream>
#include <rbdyn/rbdyn.hpp>

int main() {
    rbdyn::Scene scene({0.0, 0.0, -9.81});
    const rbdyn::Rail hoop(rbdyn::Circle{.radius = 0.5, .start = {0, 0, -1}, .toward = {1, 0, 0}},
                           rbdyn::Coulomb{.mu_static = 0.4, .mu_dynamic = 0.1});
    const auto bead = scene.add(rbdyn::Particle{.mass = 0.5}, hoop, {.parameter = 0.0, .speed = 7.0});

    const rbdyn::Trajectory run = rbdyn::simulate(scene, {.until = 6.0, .error = 1e-10});
    std::cout << run;
    for (const auto& event : run.events()) std::cout << event << '\n';
    return run[bead].speed(6.0) == 0.0 ? 0 : 1;
}
