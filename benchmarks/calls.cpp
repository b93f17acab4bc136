// What a call of simulate() costs from C++ beside its integration, on the smallest scenes there are: the first call for
// a scene, which plans and records, with a local tolerance; a later one, and the integration in it; a later one with an
// estimate of its error. Microseconds, medians of 401. From Python: overhead.py.
#include <algorithm>
#include <cstdio>
#include <optional>
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

/// One row; `change` is called before each run.
template <class Change>
void row(const char* name, const Scene& scene, double until, Change&& change) {
    const auto time_of = [&](const Scene& s, std::optional<double> rtol) {
        change();
        return simulate(s, {.until = until, .rtol = rtol}).statistics();
    };
    const double first = median([&] {
        // a change of the scene leaves its plan behind
        Scene once = scene;
        once.set_gravity(scene.gravity());
        return time_of(once, 1e-9).seconds * 1e6;
    });
    const double later = median([&] { return time_of(scene, 1e-9).seconds * 1e6; });
    const double integration = median([&] { return time_of(scene, 1e-9).integration_seconds * 1e6; });
    const double accurate = median([&] { return time_of(scene, std::nullopt).seconds * 1e6; });
    std::printf("%-50s %8.1f %8.1f %8.1f %8.1f\n", name, first, later, integration, accurate);
}
void row(const char* name, const Scene& scene, double until) {
    row(name, scene, until, [] {});
}

}  // namespace

int main() {
    const Vector3 weight(0.0, 0.0, -9.8125);
    std::printf("calibration: %.3f us\n\n%-50s %8s %8s %8s %8s\n", calibration::microseconds(), "", "first", "later",
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
