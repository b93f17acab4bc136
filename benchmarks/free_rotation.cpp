// The closed form of the free rotation: set-up, and a state at a time.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <rbdyn/closed_form/free_rotation.hpp>

#include "calibration.hpp"

namespace {

using namespace rbdyn;

/// Microseconds of one call: the least of several batches.
template <class Function>
double microseconds(int count, Function f) {
    double best = 1e300;
    for (int batch = 0; batch < 20; ++batch) {
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < count; ++i) f(i);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / count);
    }
    return best * 1e6;
}

}  // namespace

int main() {
    volatile double sink = 0.0;
    std::printf("calibration: %.3f us\n\n%-28s %10s %16s %10s\n", calibration::microseconds(), "body", "set-up [us]",
                "axes turned [us]", "state [us]");
    struct Case {
        const char* name;
        Vector3 moments, omega;
    };
    for (const Case& c : {Case{"scene F", {1, 2, 3}, {0.01, 1, 0.02}},
                          {"about the largest moment", {1, 2, 3}, {0.1, 0.2, 1}},
                          {"body of revolution", {1, 1, 1.5}, {0.5, -0.25, 2}},
                          {"permanent rotation", {1, 2, 3}, {0, 1, 0}}}) {
        const Matrix3 inertia = c.moments.asDiagonal(), r = rotation_matrix(turn(Vector3(1, 2, 2) / 3.0, 0.7));
        const Matrix3 turned = r * inertia * r.transpose();
        const auto exact = widened(inertia), exact_turned = widened(Matrix3(0.5 * (turned + turned.transpose())));
        const FreeRotation motion(exact, {}, c.omega);
        const double setup = microseconds(200, [&](int) { sink = FreeRotation(exact, {}, c.omega).error(1.0); });
        const double setup_turned =
            microseconds(200, [&](int) { sink = FreeRotation(exact_turned, {}, r * c.omega).error(1.0); });
        const double state = microseconds(5000, [&](int i) { sink = motion.at(1.0 + 19.7 * i).attitude.w; });
        std::printf("%-28s %10.2f %16.2f %10.3f\n", c.name, setup, setup_turned, state);
    }
    return 0;
}
