// The closed forms of scenes F and T of bodies.py: set-up once, and the state at a time, in microseconds. bodies.py
// reads the lines.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <rbdyn/closed_form/free_rotation.hpp>
#include <rbdyn/closed_form/lagrange_top.hpp>

#include "calibration.hpp"

namespace {

using namespace rbdyn;

volatile double seen;  // so that nothing measured is left out by the compiler

/// Microseconds of one call: the least of several batches.
template <class Function>
double microseconds(int count, Function f) {
    double best = 1e300;
    for (int batch = 0; batch < 51; ++batch) {
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < count; ++i) f(i);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / count);
    }
    return best * 1e6;
}

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
