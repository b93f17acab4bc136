// A number with a bound on what rounding has made of it: evaluates a function together with its error.
//
// Running error analysis (Higham, Accuracy and Stability of Numerical Algorithms, 3.3), to first order: an operation
// passes on the errors of its operands by its derivatives and adds a rounding of its own, of one unit in the last
// place. Constants are what they are; a parameter that is itself rounded begins with that error.
#pragma once

#include <cmath>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Rounded {
    double value = 0.0;
    double error = 0.0;  // bound on how far the value may be wrong

    Rounded() = default;
    Rounded(double exact) : value(exact) {}
    /// A result: errors of the operands passed on, and one rounding.
    Rounded(double result, double passed_on);

    /// Whether it may be zero.
    bool may_vanish() const { return !(std::abs(value) > error); }
};

inline Rounded operator+(const Rounded& a, const Rounded& b) { return {a.value + b.value, a.error + b.error}; }
inline Rounded operator-(const Rounded& a, const Rounded& b) { return {a.value - b.value, a.error + b.error}; }
Rounded operator*(const Rounded& a, const Rounded& b);
Rounded operator/(const Rounded& a, const Rounded& b);
inline bool operator>(const Rounded& a, const Rounded& b) { return a.value > b.value; }

Rounded sqrt(const Rounded& x);
inline Rounded sin(const Rounded& x) { return {std::sin(x.value), std::abs(std::cos(x.value)) * x.error}; }
inline Rounded cos(const Rounded& x) { return {std::cos(x.value), std::abs(std::sin(x.value)) * x.error}; }
inline Rounded sinh(const Rounded& x) { return {std::sinh(x.value), std::cosh(x.value) * x.error}; }
inline Rounded cosh(const Rounded& x) { return {std::cosh(x.value), std::abs(std::sinh(x.value)) * x.error}; }
Rounded tanh(const Rounded& x);
inline Rounded exp(const Rounded& x) { return {std::exp(x.value), std::exp(x.value) * x.error}; }
inline Rounded log(const Rounded& x) { return {std::log(x.value), x.error / std::abs(x.value)}; }
inline Rounded expm1(const Rounded& x) { return {std::expm1(x.value), std::exp(x.value) * x.error}; }
inline Rounded log1p(const Rounded& x) { return {std::log1p(x.value), x.error / std::abs(1.0 + x.value)}; }
inline Rounded asinh(const Rounded& x) { return {std::asinh(x.value), x.error / std::hypot(1.0, x.value)}; }
inline Rounded atanh(const Rounded& x) {
    return {std::atanh(x.value), x.error / std::abs((1.0 - x.value) * (1.0 + x.value))};
}
Rounded pow(const Rounded& x, double n);
Rounded pow(const Rounded& x, const Rounded& n);
Rounded atan2(const Rounded& y, const Rounded& x);
inline Rounded floor(const Rounded& x) { return std::floor(x.value); }
inline Rounded locked_sign(const Rounded& x, const std::string& = {}) { return x.value < 0.0 ? -1.0 : 1.0; }
Rounded length(const Vector3Of<Rounded>& v, const std::string& = {}, int = -1);

}  // namespace rbdyn::inline RBDYN_FORM
