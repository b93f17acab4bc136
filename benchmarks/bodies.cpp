// The closed forms of scenes F and T of bodies.py: set-up once, and the state at a time, in microseconds. bodies.py
// reads the lines.
#include <cstdio>
#include <rbdyn/closed_form/free_rotation.hpp>
#include <rbdyn/closed_form/lagrange_top.hpp>

#include "calibration.hpp"
#include "timing.hpp"

namespace {

using namespace rbdyn;
using timing::microseconds;

volatile double seen;  // so that nothing measured is left out by the compiler

template <class Make>
void report(const char* scene, double until, Make make) {
    const auto motion = make();
    const auto see = [](const auto& state) { seen = state.attitude.w + state.angular_velocity[0]; };
    std::printf("%s;%.9g;%.9g\n", scene,
                microseconds(200,
                             [&](int) {
                                 see(make().at({until, 0.0}));
                             }),
                microseconds(5000, [&](int i) {
                    see(motion.at({until - 0.001 * i, 0.0}));
                }));
}

}  // namespace

int main() {
    std::printf("calibration;%.9g;0\n", calibration::microseconds());
    const Matrix3 inertia = Vector3(1.0, 2.0, 3.0).asDiagonal();
    report("F", 100.0, [&] { return FreeRotation(widened(inertia), {}, Vector3(0.01, 1.0, 0.02)); });
    report("T", 10.0, [] {
        return LagrangeTop(0.002, 0.001, DoubleDouble(0.5) * 0.05 * 9.81, Vector3::UnitZ(), turn(Vector3::UnitX(), 0.3),
                           {0.0, 0.0, 300.0});
    });
    return 0;
}
