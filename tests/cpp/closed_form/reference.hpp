// Reference cases in files, their decimal strings read with all the digits of a long double.
#pragma once

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::test {

inline nlohmann::json reference(const std::string& name) {
    std::ifstream file(std::string(RBDYN_TEST_REFERENCE) + "/" + name + ".json");
    if (!file) throw std::runtime_error("no reference case " + name);
    return nlohmann::json::parse(file);
}
inline long double digits(const nlohmann::json& value) { return std::stold(value.get<std::string>()); }
inline double parameter(const nlohmann::json& of, const char* name) {
    return std::stod(of["parameters"][name]["value"].get<std::string>());
}

/// The attitude of Euler angles that are exact in doubles: Rz(psi) Rx(theta) Rz(phi).
inline QuaternionOf<DoubleDouble> from_euler(double theta, double psi, double phi) {
    const auto tilt = sine_cosine(DoubleDouble(theta) * 0.5);
    const auto sum = sine_cosine((DoubleDouble(psi) + phi) * 0.5),
               difference = sine_cosine((DoubleDouble(psi) - phi) * 0.5);
    return {tilt.cosine * sum.cosine, tilt.sine * difference.cosine, tilt.sine * difference.sine,
            tilt.cosine * sum.sine};
}

/// The angle between two attitudes, the second of four reference strings [rad].
inline double angle_between(const Quaternion& q, const nlohmann::json& exact) {
    const long double a[4] = {q.w, q.x, q.y, q.z};
    long double b[4], scalar = 0.0L, size = 0.0L, other = 0.0L;
    for (std::size_t i = 0; i < 4; ++i) {
        b[i] = digits(exact[i]);
        scalar += a[i] * b[i];
        size += a[i] * a[i];
        other += b[i] * b[i];
    }
    long double square = 0.0L;
    for (int i = 0; i < 4; ++i) {
        const long double d = a[i] / std::sqrt(size) - std::copysign(1.0L, scalar) * b[i] / std::sqrt(other);
        square += d * d;
    }
    return static_cast<double>(2.0L * std::sqrt(square));
}

}  // namespace rbdyn::test
