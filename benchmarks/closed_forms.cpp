// What closed forms cost: set-up once, and one value at one time, in microseconds of processor time.
#include <rbdyn/closed_form/lagrange_top.hpp>
#include <rbdyn/closed_form/linear_oscillator.hpp>
#include <rbdyn/closed_form/pendulum.hpp>
#include <rbdyn/plan/planning.hpp>
#include <rbdyn/simulate.hpp>
#include <rbdyn/special/door.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <vector>

namespace {

using namespace rbdyn;

volatile double seen;  // so that nothing measured is left out by the compiler

/// The least of many repeats.
template <class F>
double microseconds(F&& call, int times) {
    double least = INFINITY;
    for (int repeat = 0; repeat < 21; ++repeat) {
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

/// Particles in a row, springs of no length between them and to two fixed points.
Scene row(int count, bool in_space) {
    Scene scene;
    std::vector<BodyHandle> bodies;
    for (int i = 0; i < count; ++i)
        bodies.push_back(
            scene.add(Particle{1.0 + 0.01 * i}, FreeStart{.position = {1.0 * i, in_space ? 0.1 * i * i : 0.0, 0.0},
                                                          .velocity = {1.0 / (1.0 + i), 0.0, in_space ? 0.1 : 0.0}}));
    scene.connect(Spring{.stiffness = 40.0}, bodies.front(), Vector3(-1.0, 0.0, 0.0));
    for (std::size_t i = 1; i < bodies.size(); ++i) scene.connect(Spring{.stiffness = 40.0}, bodies[i - 1], bodies[i]);
    scene.connect(Spring{.stiffness = 40.0}, bodies.back(), Vector3(count, 0.0, 0.0));
    return scene;
}
Scene in_a_field() {
    Scene scene({0.0, 0.0, -9.81});
    scene.apply(Lorentz{2.0, {0.3, -1.0, 0.5}}, scene.add(Particle{1.0}, FreeStart{.velocity = {0.0, 1.0, 0.2}}));
    return scene;
}

/// The first plan, a state at about 1000 s, further calls, and Taylor series over long times.
void report(const char* name, const Scene& scene, double period, int times) {
    const Plan plan = make_plan(scene);
    std::vector<double> x(static_cast<std::size_t>(plan.model->variables()));
    const auto calls = [&](const SimulateOptions& options) {
        return microseconds([&](int) { seen = simulate(scene, options).end(); }, times);
    };
    std::printf("%-28s plan %7.1f us, set-up of it %7.1f us, state %6.2f us; %g s: %7.1f us, taylor %7.1f us\n", name,
                microseconds([&](int) { seen = planning::plan_of(scene, false, {}).pole[0]; }, times),
                microseconds([&](int) { seen = planning::closed_form(scene, *plan.model, false).form->pace(); }, times),
                microseconds(
                    [&](int i) {
                        plan.closed->state({1e3 + 0.37 * i, 0.0}, x);
                        seen = x[0];
                    },
                    100 * times),
                period, calls({.until = period}), calls({.until = period, .rtol = 1e-9, .engine = "taylor"}));
    for (const double until : {1e2, 1e4, 1e6}) {
        const auto start = std::chrono::steady_clock::now();
        const Attempt run =
            attempt(scene, {.until = until, .rtol = 1e-16, .engine = "taylor", .keep = {.what = Keep::What::end}});
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        plan.closed->state({until, 0.0}, x);
        const Vector3 end = run.run[BodyHandle{0}].position(until);
        std::printf("    to %g s: error %.1e; taylor, least tolerance, differs by %.1e of 1 m after %.3g s\n", until,
                    plan.closed->error(until, 1e-9),
                    (end - plan.model->center(plan.model->undecided(), 0, until, x)).norm(), seconds);
        if (seconds > 1.0) break;
    }
}

}  // namespace

int main() {
    report("one particle on a line", row(1, false), 1.0, 50);
    report("one particle in a plane", row(1, true), 1.0, 50);
    report("three in space", row(3, true), 2.0, 20);
    report("thirty on a line", row(30, false), 10.0, 1);
    report("thirty in space", row(30, true), 10.0, 1);
    report("one in a magnetic field", in_a_field(), 3.0, 20);
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
