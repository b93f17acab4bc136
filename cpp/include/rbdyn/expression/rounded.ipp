// Definitions of rbdyn/expression/rounded.hpp.
#pragma once

#include "rbdyn/expression/rounded.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Rounded::Rounded(double result, double passed_on)
    : value(result), error(passed_on + std::numeric_limits<double>::epsilon() * std::abs(result)) {}

RBDYN_INLINE Rounded operator*(const Rounded& a, const Rounded& b) {
    return {a.value * b.value, std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error};
}

RBDYN_INLINE Rounded operator/(const Rounded& a, const Rounded& b) {
    const double quotient = a.value / b.value;
    return {quotient, (a.error + std::abs(quotient) * b.error) / std::abs(b.value)};
}

RBDYN_INLINE Rounded sqrt(const Rounded& x) {
    const double root = std::sqrt(x.value);
    return {root, root > 0.0 ? 0.5 * x.error / root : std::sqrt(x.error)};
}

RBDYN_INLINE Rounded tanh(const Rounded& x) {
    const double t = std::tanh(x.value);
    return {t, (1.0 - t * t) * x.error};
}

RBDYN_INLINE Rounded pow(const Rounded& x, double n) {
    const double power = std::pow(x.value, n);
    return {power, x.value != 0.0 ? std::abs(n * power / x.value) * x.error : std::pow(x.error, n)};
}

RBDYN_INLINE Rounded pow(const Rounded& x, const Rounded& n) {
    const Rounded power = pow(x, n.value);
    if (n.error == 0.0) return power;
    return {power.value, power.error + std::abs(power.value * std::log(x.value)) * n.error};
}

RBDYN_INLINE Rounded atan2(const Rounded& y, const Rounded& x) {
    const double square = x.value * x.value + y.value * y.value;
    return {std::atan2(y.value, x.value), (std::abs(x.value) * y.error + std::abs(y.value) * x.error) / square};
}

RBDYN_INLINE Rounded length(const Vector3Of<Rounded>& v, const std::string&, int) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace rbdyn::inline RBDYN_FORM
