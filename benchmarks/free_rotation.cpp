// The closed form of the free rotation: set-up, and a state at a time.
#include <cstdio>
#include <rbdyn/closed_form/free_rotation.hpp>

#include "calibration.hpp"
#include "timing.hpp"

using namespace rbdyn;
using timing::microseconds;

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
