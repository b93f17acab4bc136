// What it costs that models are recorded and not instantiated: the same text of a model as a compiled functor and as a
// recorded program.
//
// Right-hand sides in doubles, nanoseconds, least of several batches: each evaluation depends on the last, as the
// stages of a step do. Taylor series of order 20 of the rotation of a free body, microseconds: recorded, and by the
// recurrences written by hand in calibration.hpp (with the sum of the series, which the recorded figure has not).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <rbdyn/expression/evaluate.hpp>
#include <rbdyn/expression/series_evaluator.hpp>
#include <rbdyn/rbdyn.hpp>
#include <vector>

#include "calibration.hpp"

namespace {

using namespace rbdyn;

/// A bead that slides forward on a rough hoop: u, w.
struct RoughHoop {
    static constexpr int variables = 2;
    template <class T>
    static void rates(const T* x, T* dx) {
        using std::sin, std::cos;
        const T press = x[1] * x[1] + 9.8125 * cos(x[0]);
        dx[0] = x[1];
        dx[1] = -9.8125 * sin(x[0]) - 0.125 * press;
    }
};

/// A mass on a spring with quadratic drag: place, velocity.
struct Swing {
    static constexpr int variables = 6;
    template <class T>
    static void rates(const T* x, T* dx) {
        using std::sqrt;
        const T speed = sqrt(x[3] * x[3] + x[4] * x[4] + x[5] * x[5]);
        for (int i = 0; i < 3; ++i) {
            dx[i] = x[3 + i];
            dx[3 + i] = -40.0 * x[i] - 0.1 * speed * x[3 + i];
        }
        dx[5] = dx[5] - 9.8125;
    }
};

/// A free body, I = (1, 2, 3): quaternion, angular velocity.
struct TurningBody {
    static constexpr int variables = 7;
    template <class T>
    static void rates(const T* x, T* dx) {
        const T* w = x + 4;
        dx[0] = -0.5 * (x[1] * w[0] + x[2] * w[1] + x[3] * w[2]);
        dx[1] = 0.5 * (x[0] * w[0] + x[2] * w[2] - x[3] * w[1]);
        dx[2] = 0.5 * (x[0] * w[1] + x[3] * w[0] - x[1] * w[2]);
        dx[3] = 0.5 * (x[0] * w[2] + x[1] * w[1] - x[2] * w[0]);
        dx[4] = -1.0 * (w[1] * w[2]);
        dx[5] = 1.0 * (w[2] * w[0]);
        dx[6] = (-1.0 / 3.0) * (w[0] * w[1]);
    }
};

template <class Model>
Program recorded() {
    Recorder r;
    std::vector<Expression> x, dx(Model::variables);
    for (int i = 0; i < Model::variables; ++i) x.push_back(r.input(i));
    Model::rates(x.data(), dx.data());
    return Program(r, dx, Model::variables);
}

/// Least time of one of many calls of f, in seconds.
template <class F>
double seconds(F&& f) {
    constexpr int count = 20000;
    double least = 1e300;
    for (int batch = 0; batch < 40; ++batch) {
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < count; ++i) f();
        least =
            std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / count);
    }
    return least;
}

template <class Model>
void compare(const char* name) {
    const Program program = recorded<Model>();
    Evaluator<double> evaluate(program);
    evaluate.set_parameters(std::vector<double>(static_cast<std::size_t>(program.parameters())));
    constexpr std::size_t n = Model::variables;
    const std::vector<double> start{0.5, 0.25, 0.125, 0.75, 0.375, 0.625, 0.875};
    std::vector<double> x(start.begin(), start.begin() + n);
    const double program_time = seconds([&] {
        evaluate(0.0, x);
        for (std::size_t i = 0; i < n; ++i) x[i] = start[i] + 1e-12 * evaluate.output(static_cast<int>(i));
    });
    double dx[n];
    const double functor_time = seconds([&] {
        Model::rates(x.data(), dx);
        for (std::size_t i = 0; i < n; ++i) x[i] = start[i] + 1e-12 * dx[i];
    });
    SeriesEvaluator series(program, calibration::order);
    series.set_parameters(std::vector<double>(static_cast<std::size_t>(program.parameters())));
    const double series_time = seconds([&] {
        series.begin(0.0, 0.125);
        for (std::size_t i = 0; i < n; ++i) series.set_input(static_cast<int>(i), 0, x[i]);
        for (int k = 0; k < calibration::order; ++k) {
            series.advance(k);
            series.integrate(k);
        }
    });
    std::printf("%-26s %12zu %15.1f %15.1f %18.2f\n", name, program.instructions().size(), functor_time * 1e9,
                program_time * 1e9, series_time * 1e6);
}

}  // namespace

int main() {
    const double by_hand = calibration::microseconds();
    std::printf("calibration: %.3f us\n\n%-26s %12s %15s %15s %18s\n", by_hand, "right-hand side", "instructions",
                "functor [ns]", "recorded [ns]", "series of 20 [us]");
    compare<RoughHoop>("bead on a rough hoop");
    compare<Swing>("mass on a spring, drag");
    compare<TurningBody>("rotation of a free body");
    std::printf("\nthe last series by hand: %.2f us\n", by_hand);
    return 0;
}
