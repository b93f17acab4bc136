// A fast top, from C++: it precesses at nearly m g l / (C omega), and nods a little.
#include <cmath>
#include <iostream>
#include <rbdyn/rbdyn.hpp>

int main() {
    rbdyn::Scene scene({0.0, 0.0, -9.81});
    const rbdyn::RigidBody body(0.5, {0.002, 0.002, 0.001},
                                {.com = rbdyn::Vector3(0.0, 0.0, 0.05), .inertia_about = rbdyn::InertiaAbout::origin});
    const auto top =
        scene.add(body, rbdyn::Spherical{},
                  {.attitude = rbdyn::EulerAngles{.theta = 0.3}, .angular_velocity = rbdyn::Vector3(0.0, 0.0, 300.0)});
    std::cout << rbdyn::make_plan(scene);

    const rbdyn::Trajectory run = rbdyn::simulate(scene, {.until = 10.0, .error = 1e-12});
    const rbdyn::EulerAngles angles = run[top].euler_angles(run.end());
    const double mean = angles.psi / run.end(), fast = 0.5 * 9.81 * 0.05 / (0.001 * 300.0);
    std::cout << run << "precession " << mean << " rad/s, of a fast top " << fast << " rad/s\nreaction "
              << run[top].reaction(run.end()).transpose() << " N\n";
    return std::abs(mean / fast - 1.0) < 0.01 ? 0 : 1;
}
