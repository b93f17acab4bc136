// What the tests of motion share: scales of a run, reference digits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "random.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::test {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();
inline constexpr double gravity = 9.8125;  // m/s^2, exact in binary
inline const Vector3 down{0.0, 0.0, -gravity};

/// A vertical circle by its angle from the lowest point, growing toward x.
inline Circle vertical_circle(double radius) { return {.radius = radius, .start = {0, 0, -1}, .toward = {1, 0, 0}}; }
/// A line down a slope.
inline Line incline(double slope) { return {.direction = {1.0, 0.0, -slope}}; }
inline const Line along_x{.direction = {1.0, 0.0, 0.0}};

/// The sizes a motion's errors are measured by.
struct Scales {
    double extent = 0.0, speed = 0.0, reaction = 0.0;
};

/// Of one body, from many times of a run.
inline Scales scales(const Trajectory& run, BodyHandle body, int times = 2000) {
    Vector3 low = run[body].position(run.start()), high = low;
    Scales s;
    const auto take = [&](double t, Side side) {
        const PointReport r = run[body].report(t, side);
        low = low.cwiseMin(r.position);
        high = high.cwiseMax(r.position);
        s.speed = std::max(s.speed, r.velocity.norm());
        s.reaction = std::max(s.reaction, r.reaction.norm());
    };
    for (int k = 0; k <= times; ++k)
        take(std::min(run.end(), run.start() + (run.end() - run.start()) * k / times), Side::after);
    for (const Event& e : run.events()) {
        take(e.time, Side::before);
        take(e.time, Side::after);
    }
    s.extent = (high - low).norm();
    return s;
}

/// An error relative to a scale; where nothing ever happens, nothing may differ.
inline double relative(double error, double scale) {
    if (scale > 0.0) return error / scale;
    return error == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
}

/// Kinds of the events of a run, in order, as one line.
inline std::string kinds(const Trajectory& run) {
    std::string line;
    for (const Event& e : run.events()) line += (line.empty() ? "" : " ") + std::string(name_of(e.kind));
    return line;
}

/// A whole number from the environment.
inline int setting(const char* name, int otherwise) {
    const char* value = std::getenv(name);
    return value == nullptr ? otherwise : std::atoi(value);
}

}  // namespace rbdyn::test
