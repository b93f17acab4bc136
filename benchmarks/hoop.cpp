// A bead on a rough vertical hoop until it sticks for good, 9 events: what each engine needs to reach an error.
//
// R = 1 m, g = 9.81 m/s^2, mu_dynamic = 0.1, mu_static = 0.15, from 2.0 rad above the lowest point at 6.0 m/s.
// Time is the integration alone: engine, driver, events and storage; the model is made once. Error is the largest of
// the event times, relative to the time since the start, against a run at the smallest tolerance.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <rbdyn/event/record.hpp>
#include <rbdyn/integrate.hpp>
#include <rbdyn/rbdyn.hpp>
#include <rbdyn/special/special_model.hpp>
#include <string>
#include <vector>

#include "calibration.hpp"

namespace {

using namespace rbdyn;

struct Timing {
    double median, least;  // microseconds
    Record record;
};

Timing timed(const SpecialModel& model, const SimulateOptions& options, const std::string& engine, double tolerance) {
    std::vector<double> times;
    Timing result{};
    for (int i = 0; i < 401; ++i) {
        simulating::Timed run = simulating::integrate(model, model.start(), options, engine, tolerance, {});
        times.push_back(run.seconds * 1e6);
        if (i == 0) result.record = std::move(run.record);
    }
    std::sort(times.begin(), times.end());
    result.median = times[times.size() / 2];
    result.least = times.front();
    return result;
}

double event_error(const Record& run, const Record& exact) {
    if (run.events.size() != exact.events.size()) return INFINITY;
    double error = 0.0;
    for (std::size_t i = 0; i < run.events.size(); ++i)
        error = std::max(error, std::abs(run.events[i].instant - exact.events[i].instant) / exact.events[i].time);
    return error;
}

}  // namespace

int main() {
    Scene scene(Vector3(0.0, 0.0, -9.81));
    const Rail hoop(Circle{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}},
                    Coulomb{.mu_static = 0.15, .mu_dynamic = 0.1});
    scene.add(Particle{.mass = 1.0}, hoop, {.parameter = 2.0, .speed = 6.0});
    const SpecialModel model(scene, make_plan(scene).view);
    SimulateOptions options;
    options.until = 30.0;

    const double calibration = calibration::microseconds();
    std::printf(
        "calibration: %.3f us (a hand-written Taylor step; 0.72 to 0.90 us on the machine of the yardstick)\n\n",
        calibration);
    const Record exact = simulating::integrate(model, model.start(), options, "taylor", 1e-19, {}).record;
    std::printf("rough hoop, 9 events\n%-12s %10s %12s %11s %8s %8s %10s %18s\n", "engine", "wanted", "time [us]",
                "least [us]", "error", "steps", "guards", "over calibration");
    for (const std::string& engine : simulating::engines()) {
        for (double wanted : {1e-6, 1e-9, 1e-12}) {
            // the loosest tolerance, by tens, that reaches the error
            double tolerance = wanted;
            Timing t = timed(model, options, engine, tolerance);
            while (!(event_error(t.record, exact) <= wanted) && tolerance > simulating::least_tolerance(engine)) {
                tolerance *= 0.1;
                t = timed(model, options, engine, tolerance);
            }
            std::printf("%-12s %10.0e %12.1f %11.1f %8.0e %8lld %10lld %18.0f\n", engine.c_str(), wanted, t.median,
                        t.least, event_error(t.record, exact), static_cast<long long>(t.record.work.steps),
                        static_cast<long long>(t.record.work.guard_evaluations), t.median / calibration);
        }
    }
    // a scene without guards
    Scene smooth(Vector3(0.0, 0.0, -9.81));
    smooth.add(Particle{.mass = 1.0}, Rail(Circle{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}}),
               {.parameter = 2.0, .speed = 0.0});
    const SpecialModel pendulum(smooth, make_plan(smooth).view);
    const Timing t = timed(pendulum, options, "taylor", 1e-12);
    std::printf("\nsmooth hoop, 30 s at tolerance 1e-12: %.1f us, %lld steps, %lld guard evaluations\n", t.median,
                static_cast<long long>(t.record.work.steps), static_cast<long long>(t.record.work.guard_evaluations));
    std::printf("\nwhole call of simulate(), estimate of the error included\n%10s %12s %10s\n", "error", "time [us]",
                "estimate");
    for (double wanted : {1e-6, 1e-9, 1e-12}) {
        std::vector<double> times;
        double estimate = 0.0;
        for (int i = 0; i < 201; ++i) {
            const Trajectory run = simulate(scene, {.until = 30.0, .error = wanted});
            times.push_back(run.statistics().seconds * 1e6);
            estimate = *run.error();
        }
        std::sort(times.begin(), times.end());
        std::printf("%10.0e %12.1f %10.0e\n", wanted, times[times.size() / 2], estimate);
    }
    return 0;
}
