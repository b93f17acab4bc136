// Numbers of about 32 digits as unevaluated sums of two doubles: hi + lo, |lo| at most half a unit in the last place
// of hi (Dekker, "A floating-point technique for extending the available precision", 1971; error bounds of the
// operations: Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
// arithmetic", 2017).
//
// For what derives from a user's doubles and must keep all their digits: constants of equations, starts, moments about
// another point, principal axes, phases of closed forms at late times.
#pragma once

#include <cmath>
#include <compare>
#include <numbers>
#include <type_traits>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct DoubleDouble {
    double hi = 0.0, lo = 0.0;

    constexpr DoubleDouble() = default;
    constexpr DoubleDouble(double value) : hi(value) {}
    constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}
    constexpr DoubleDouble(Instant t) : hi(t.hi), lo(t.lo) {}

    explicit constexpr operator double() const { return hi + lo; }
    explicit constexpr operator long double() const { return static_cast<long double>(hi) + lo; }

    friend constexpr bool operator==(const DoubleDouble&, const DoubleDouble&) = default;
    friend constexpr auto operator<=>(const DoubleDouble& a, const DoubleDouble& b) {
        return a.hi == b.hi ? a.lo <=> b.lo : a.hi <=> b.hi;
    }
};

namespace double_double {

/// hi + lo of two doubles with |a| >= |b| or a = 0 (Dekker's fast two-sum).
inline DoubleDouble ordered_sum(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
}

/// a b exactly, short of overflow and underflow.
inline DoubleDouble exact_product(double a, double b) {
    const double p = a * b;
    // Veltkamp's splitting into halves of 26 bits; a fused operation would do as well, where the processor that this is
    // compiled for has one, and files of one program may differ in that
    constexpr double splitter = 0x1p27 + 1.0;
    const double a_big = splitter * a, b_big = splitter * b;
    const double a_hi = a_big - (a_big - a), b_hi = b_big - (b_big - b);
    const double a_lo = a - a_hi, b_lo = b - b_hi;
    return {p, ((a_hi * b_hi - p) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
}

}  // namespace double_double

inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.hi, -a.lo}; }

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    using double_double::ordered_sum;
    const Instant s = exact_sum(a.hi, b.hi), t = exact_sum(a.lo, b.lo);
    const DoubleDouble u = ordered_sum(s.hi, s.lo + t.hi);
    return ordered_sum(u.hi, t.lo + u.lo);
}
inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + (-b); }

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = double_double::exact_product(a.hi, b.hi);
    return double_double::ordered_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    // long division, three digits of 53 bits
    const double q1 = a.hi / b.hi;
    if (!std::isfinite(q1) || !std::isfinite(b.hi)) return q1;
    DoubleDouble rest = a - b * q1;
    const double q2 = rest.hi / b.hi;
    rest = rest - b * q2;
    const double q3 = rest.hi / b.hi;
    return double_double::ordered_sum(q1, q2) + q3;
}

inline DoubleDouble& operator+=(DoubleDouble& a, const DoubleDouble& b) { return a = a + b; }
inline DoubleDouble& operator-=(DoubleDouble& a, const DoubleDouble& b) { return a = a - b; }
inline DoubleDouble& operator*=(DoubleDouble& a, const DoubleDouble& b) { return a = a * b; }
inline DoubleDouble& operator/=(DoubleDouble& a, const DoubleDouble& b) { return a = a / b; }

inline DoubleDouble abs(const DoubleDouble& a) { return a.hi < 0.0 ? -a : a; }
inline DoubleDouble floor(const DoubleDouble& a) {
    const double whole = std::floor(a.hi);
    return whole == a.hi ? double_double::ordered_sum(whole, std::floor(a.lo)) : DoubleDouble(whole);
}
inline bool isfinite(const DoubleDouble& a) { return std::isfinite(a.hi); }

inline DoubleDouble sqrt(const DoubleDouble& a) {
    if (!(a.hi > 0.0) || !std::isfinite(a.hi)) return std::sqrt(a.hi);
    // one Newton step for the root from its double
    const double root = std::sqrt(a.hi);
    const DoubleDouble rest = a - double_double::exact_product(root, root);
    const DoubleDouble once = double_double::ordered_sum(root, rest.hi / (2.0 * root));
    const DoubleDouble again = a - once * once;
    return once + again.hi / (2.0 * root);
}

namespace double_double {

/// pi and pi/2 to 32 digits.
inline constexpr DoubleDouble pi{std::numbers::pi, 1.2246467991473532e-16};
inline constexpr DoubleDouble half_pi{std::numbers::pi / 2.0, 6.123233995736766e-17};

}  // namespace double_double

/// A number of 32 digits in numbers of type S, with as many of them as those have.
template <class S>
S exactly(const DoubleDouble& x) {
    if constexpr (std::is_constructible_v<S, const DoubleDouble&>)
        return S(x);
    else
        return S(static_cast<double>(x));
}

}  // namespace rbdyn::inline RBDYN_FORM
