// A fixed piece of work whose time tells how fast a machine is, so that tables made on different machines compare.
//
// It is one step of order 20 of the Taylor series of a free rigid body, I = (1, 2, 3), written out by hand in scalar
// arithmetic: three Euler equations and four for the quaternion, 15 convolutions. It uses nothing of the library and
// never changes. On an AMD Zen 3 core of 2024 with g++ 12 it takes 0.72 to 0.90 microseconds.
#pragma once

#include <algorithm>
#include <chrono>

namespace calibration {

inline constexpr int order = 20;

inline double step(double w1, double w2, double w3, double h) {
    static constexpr double a = -1.0, b = 1.0, c = -1.0 / 3.0;
    double w[3][order + 1], q[4][order + 1];
    w[0][0] = w1;
    w[1][0] = w2;
    w[2][0] = w3;
    q[0][0] = 1.0;
    q[1][0] = q[2][0] = q[3][0] = 0.0;
    for (int k = 0; k < order; ++k) {
        double s[3] = {0.0, 0.0, 0.0}, r[4] = {0.0, 0.0, 0.0, 0.0};
        for (int j = 0; j <= k; ++j) {
            const double x = w[0][j], y = w[1][j], z = w[2][j];
            s[0] += y * w[2][k - j];
            s[1] += z * w[0][k - j];
            s[2] += x * w[1][k - j];
            const double q0 = q[0][k - j], q1 = q[1][k - j], q2 = q[2][k - j], q3 = q[3][k - j];
            r[0] -= q1 * x + q2 * y + q3 * z;
            r[1] += q0 * x + q2 * z - q3 * y;
            r[2] += q0 * y + q3 * x - q1 * z;
            r[3] += q0 * z + q1 * y - q2 * x;
        }
        const double f = 1.0 / (k + 1);
        w[0][k + 1] = a * s[0] * f;
        w[1][k + 1] = b * s[1] * f;
        w[2][k + 1] = c * s[2] * f;
        for (int i = 0; i < 4; ++i) q[i][k + 1] = 0.5 * r[i] * f;
    }
    double sum = 0.0, power = 1.0;
    for (int k = 0; k <= order; ++k, power *= h)
        sum += (w[0][k] + w[1][k] + w[2][k] + q[0][k] + q[1][k] + q[2][k] + q[3][k]) * power;
    return sum;
}

/// Microseconds of a step: the least of several batches.
inline double microseconds() {
    volatile double sink = 0.0;
    double best = 1e300;
    for (int batch = 0; batch < 20; ++batch) {
        const auto start = std::chrono::steady_clock::now();
        constexpr int count = 2000;
        double sum = 0.0;
        for (int i = 0; i < count; ++i) sum += step(0.01 + 1e-6 * i, 1.0, 0.02, 0.1);
        sink = sink + sum;
        best = std::min(best,
                        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / count * 1e6);
    }
    return best;
}

}  // namespace calibration
