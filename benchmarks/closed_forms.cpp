// What closed forms cost: set-up once, and one value at one time, in microseconds of processor time.
#include <rbdyn/closed_form/lagrange_top.hpp>
#include <rbdyn/closed_form/linear_oscillator.hpp>
#include <rbdyn/closed_form/pendulum.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace {

using namespace rbdyn;

volatile double seen;  // so that nothing measured is left out by the compiler

/// The least of many repeats.
template <class F>
double microseconds(F&& call, int times) {
    double least = INFINITY;
    for (int repeat = 0; repeat < 51; ++repeat) {
        const std::clock_t start = std::clock();
        for (int i = 0; i < times; ++i) call(i);
        least = std::min(least, static_cast<double>(std::clock() - start) * 1e6 / CLOCKS_PER_SEC / times);
    }
    return least;
}

template <class Make, class Value>
void report(const char* name, Make&& make, Value&& value) {
    const auto motion = make();
    std::printf("%-44s set-up %6.2f us, value %6.3f us\n", name,
                microseconds([&](int) { seen = value(make(), 0.1); }, 200),
                microseconds([&](int i) { seen = value(motion, 0.01 * i); }, 5000));
}

}  // namespace

int main() {
    const Vector3 up(0.0, 0.0, 1.0);
    const auto of_top = [](const LagrangeTop& top, double t) {
        const LagrangeTop::State s = top.at({t, 0.0});
        return s.attitude.w + s.angular_velocity[0];
    };
    const auto of_pendulum = [](const Pendulum& p, double t) { return p.at({t, 0.0}).angle; };
    const auto of_oscillator = [](const LinearOscillator& o, double t) { return o.at({t, 0.0}).position; };
    report(
        "Lagrange's top, fast (scene T)",
        [&] {
            return LagrangeTop(0.002, 0.001, DoubleDouble(0.5) * 0.05 * 9.81, up, turn(Vector3::UnitX(), 0.3),
                               {0.0, 0.0, 300.0});
        },
        of_top);
    report(
        "Lagrange's top, slow, with cusps",
        [&] {
            return LagrangeTop(0.5, 0.25, 4.90625, up, turn(Vector3::UnitX(), 1.0), {0.0, 0.0, 8.0});
        },
        of_top);
    report(
        "Pendulum, libration", [] { return Pendulum(9.81, 1.0, 0.5); }, of_pendulum);
    report(
        "Pendulum, libration near the highest place", [] { return Pendulum(9.81, 3.1, 0.0); }, of_pendulum);
    report(
        "Pendulum, rotation", [] { return Pendulum(9.81, 1.0, 9.0); }, of_pendulum);
    report(
        "Linear oscillator",
        [] {
            return LinearOscillator({9.0, 0.25, 1.0}, 1.0, 0.5);
        },
        of_oscillator);
}
