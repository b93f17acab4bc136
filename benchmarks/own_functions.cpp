// Quadratic drag built in and as a functor of the user's: what a law of one's own costs from C++.
//
// A mass of 0.5 kg on a spring of 20 N/m, gravity, drag of 0.05 kg/m, 20 s at a local tolerance of 1e-10. Times are of
// the whole call of simulate(). With the argument "rows" the table comes as one line for each row: name, engine,
// microseconds; benchmarks/own_functions.py makes one table of it and of what Python does.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <rbdyn/expression/evaluate.hpp>
#include <rbdyn/rbdyn.hpp>
#include <string>
#include <vector>

#include "calibration.hpp"

namespace {

using namespace rbdyn;

/// -k |v| v over any number type.
struct QuadraticDrag {
    double k = 0.05;
    template <class S>
    Vector3Of<S> operator()(const S& /*t*/, const Vector3Of<S>& /*r*/, Vector3Of<S> v) const {
        const S speed = length(v);
        for (S& component : v) component = -k * speed * component;
        return v;
    }
};

double median(std::vector<double> times) {
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

double microseconds(const Load& load, const char* engine) {
    Scene scene(Vector3(0.0, 0.0, -9.81));
    const auto ball = scene.add(Particle{.mass = 0.5}, {.position = {1.0, 0.0, 0.0}, .velocity = {0.0, 2.0, 1.0}});
    scene.connect(Spring{.stiffness = 20.0}, ball, Vector3(0.0, 0.0, 0.0));
    scene.apply(load, ball);
    std::vector<double> times;
    for (int i = 0; i < 201; ++i)
        times.push_back(simulate(scene, {.until = 20.0, .rtol = 1e-10, .engine = engine}).statistics().seconds * 1e6);
    return median(std::move(times));
}

/// One evaluation of the recorded law in doubles [ns]; `chained`: each waits for the one before.
double evaluation(bool chained) {
    Recorder recorder;
    std::vector<Expression> x;
    for (int i = 0; i < 6; ++i) x.push_back(recorder.input(i));
    const Vector3Of<Expression> f = QuadraticDrag{}(recorder.time(), Vector3Of<Expression>{x[0], x[1], x[2]},
                                                    Vector3Of<Expression>{x[3], x[4], x[5]});
    const Program program(recorder, std::vector<Expression>{f[0], f[1], f[2]}, 6);
    Evaluator<double> evaluate(program);
    std::vector<double> parameters(static_cast<std::size_t>(program.parameters()), 1.0);
    evaluate.set_parameters(parameters);
    std::vector<double> state{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, times;
    volatile double sink = 0.0;
    for (int batch = 0; batch < 101; ++batch) {
        constexpr int count = 10000;
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < count; ++i) {
            evaluate(0.0, std::span<const double>(state));
            if (chained)
                state[3] = 4.0 + 1e-9 * evaluate.output(0);
            else
                state[3] += 1e-9;
        }
        times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / count * 1e9);
        sink = sink + state[3] + evaluate.output(0);
    }
    return median(std::move(times));
}

}  // namespace

int main(int argc, char** argv) {
    const bool rows = argc > 1 && std::strcmp(argv[1], "rows") == 0;
    if (!rows)
        std::printf("calibration: %.3f us\n\n%-12s %-10s %12s\n", calibration::microseconds(), "drag", "engine",
                    "time [us]");
    const char* row = rows ? "%s;%s;%.3f\n" : "%-12s %-10s %12.1f\n";
    for (const char* engine : {"taylor", "dop853"}) {
        std::printf(row, "built in", engine, microseconds(Drag{.quadratic = 0.05}, engine));
        std::printf(row, "C++ functor", engine, microseconds(Force(QuadraticDrag{}), engine));
    }
    const double free = evaluation(false), chained = evaluation(true);
    if (rows)
        std::printf("calibration;;%.4f\nevaluation;;%.3f\nchained;;%.3f\n", calibration::microseconds(), free * 1e-3,
                    chained * 1e-3);
    else
        std::printf("\none evaluation of the recorded law in doubles: %.1f ns, %.1f ns where each waits for the last\n",
                    free, chained);
    return 0;
}
