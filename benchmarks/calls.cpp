// What a call of simulate() costs from C++ beside its integration, on the smallest scenes there are: the plan, the call
// with a local tolerance and the integration in it, the call with an estimate of its error. Microseconds, medians of
// 401. From Python: overhead.py.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <rbdyn/rbdyn.hpp>
#include <vector>

#include "calibration.hpp"

namespace {

using namespace rbdyn;

/// Of f(), which returns the microseconds that count.
template <class F>
double median(F&& f) {
    std::vector<double> times;
    for (int i = 0; i < 401; ++i) times.push_back(f());
    std::nth_element(times.begin(), times.begin() + 200, times.end());
    return times[200];
}
/// Of a call.
template <class F>
double median_of_call(F&& f) {
    return median([&] {
        const auto start = std::chrono::steady_clock::now();
        f();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() * 1e6;
    });
}

/// One row; `change` is called before each run.
template <class Change>
void row(const char* name, const Scene& scene, double until, Change&& change) {
    const SimulateOptions cheap{.until = until, .rtol = 1e-9};
    const double plan = median_of_call([&] { (void)make_plan(scene.frozen()); });
    const double call = median_of_call([&] {
        change();
        (void)simulate(scene, cheap);
    });
    const double integration = median([&] { return simulate(scene, cheap).statistics().integration_seconds * 1e6; });
    const double accurate = median_of_call([&] {
        change();
        (void)simulate(scene, {.until = until});
    });
    std::printf("%-44s %8.1f %8.1f %8.1f %8.1f\n", name, plan, call, integration, accurate);
}
void row(const char* name, const Scene& scene, double until) {
    row(name, scene, until, [] {});
}

}  // namespace

int main() {
    const Vector3 weight(0.0, 0.0, -9.8125);
    std::printf("calibration: %.3f us\n\n%-44s %8s %8s %8s %8s\n", calibration::microseconds(), "", "plan", "rtol",
                "of it", "error");

    Scene thrown(weight);
    const BodyHandle ball = thrown.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 4}});
    row("particle, thrown, 1 s", thrown, 1.0);

    Scene dragged = thrown;
    dragged.apply(Drag{.linear = 0.125, .quadratic = 0.0625}, ball);
    row("particle with drag, 1 s", dragged, 1.0);

    Scene swept = thrown;
    Parameter stiffness(1.0, "stiffness");
    swept.apply(Force([&](const auto&, const auto& r, const auto&) {
                    using T = std::decay_t<decltype(r[0])>;
                    const T k = stiffness;
                    return Vector3Of<T>{-k * r[0], -k * r[1], -k * r[2]};
                }),
                ball);
    double k = 1.0;
    row("particle, traced force, its parameter swept, 1 s", swept, 1.0, [&] { stiffness.set(k += 0.03); });

    Scene hoop(weight);
    hoop.add(Particle{1.0}, Rail(Circle{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}}, Coulomb{0.15, 0.1}),
             {.parameter = 2.0, .speed = 6.0});
    row("bead on a rough hoop, 30 s, 9 events", hoop, 30.0);

    Scene joint(weight);
    const Vector3 unequal(0.0022, 0.0019, 0.001);
    joint.add(RigidBody(0.5, unequal), Spherical{.point = {0.01, 0, -0.05}}, {.angular_velocity = Vector3(0, 0, 30)});
    row("unequal body on a ball joint, 1 s", joint, 1.0);

    Scene free;
    free.add(RigidBody(0.5, unequal), BodyStart{.angular_velocity = Vector3(0.1, 5.0, 0.2)});
    row("unequal free body in closed form, 1 s", free, 1.0);

    Scene top(weight);
    top.add(RigidBody(0.5, Vector3(0.002, 0.002, 0.001)), Spherical{.point = {0, 0, -0.05}},
            {.attitude = EulerAngles{0.3, 0.0, 0.0}, .angular_velocity = Vector3(0, 0, 300)});
    row("symmetric top in closed form, 1 s", top, 1.0);
    return 0;
}
