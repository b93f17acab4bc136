// A user's program, built against an installed rbdyn: where a bead on a rough incline turns, by hand and by run.
#include <bit>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <rbdyn/rbdyn.hpp>

int main() {
    rbdyn::Scene scene;
    scene.set_gravity({0.0, 0.0, -9.8125});
    const rbdyn::Rail incline(rbdyn::Line{.direction = {4, 0, -3}},
                              rbdyn::Coulomb{.mu_static = 0.5, .mu_dynamic = 0.25});
    const auto bead = scene.add(rbdyn::Particle{.mass = 2.0}, incline, {.parameter = 0.0, .speed = -4.0});
    const rbdyn::Trajectory run = rbdyn::simulate(scene, {.until = 2.0, .error = 1e-12});
    std::cout << run << run.plan();

    // up it is slowed by g (sin + mu cos), and tan = 3/4 > mu_static lets it come back
    const double turn = 4.0 / (9.8125 * (0.6 + 0.25 * 0.8));
    const double down = 9.8125 * (0.6 - 0.25 * 0.8) * (2.0 - turn);
    std::uint64_t bits = 0;
    for (const double x :
         {run[bead].speed(2.0), run[bead].position(1.7)[0], run[bead].reaction(0.4)[2], run.energy(1.9)})
        bits = (bits << 1 | bits >> 63) ^ std::bit_cast<std::uint64_t>(x);
    std::cout << "all numbers: " << std::hex << bits << std::dec << '\n';
    std::cout << "turns at " << run.events().front().time << " s, by hand " << turn << " s\n";
    return std::abs(run.events().front().time - turn) < 1e-12 && std::abs(run[bead].speed(2.0) - down) < 1e-11 ? 0 : 1;
}
