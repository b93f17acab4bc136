// The parameter at an arc length beyond the digits of a double: where motion starts.
//
// Long double knows a length to some 1e-19 of itself, by Gauss's rule of ten points on pieces that are halved until the
// rule on the whole and on the halves agree.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// Integral of `speed` from u0 to u1.
template <class Speed>
long double long_length(const Speed& speed, long double u0, long double u1) {
    // Legendre's polynomial of degree ten: positive zeros, by Newton's steps
    struct Rule {
        std::array<long double, 5> place, weight;
        Rule() {
            constexpr long double pi = 3.14159265358979323846264338327950288L;
            for (std::size_t i = 0; i < 5; ++i) {
                long double x = std::cos(pi * (static_cast<long double>(i) + 0.75L) / 10.5L), slope = 1.0L;
                for (int k = 0; k < 8; ++k) {
                    long double before = 1.0L, now = x;
                    for (int n = 2; n <= 10; ++n) {
                        const long double next = ((2.0L * n - 1.0L) * x * now - (n - 1.0L) * before) / n;
                        before = now;
                        now = next;
                    }
                    slope = 10.0L * (x * now - before) / (x * x - 1.0L);
                    x -= now / slope;
                }
                place[i] = x;
                weight[i] = 2.0L / ((1.0L - x * x) * slope * slope);
            }
        }
    };
    static const Rule rule;
    const auto integral = [&](long double begin, long double end) {
        const long double middle = 0.5L * (begin + end), half = 0.5L * (end - begin);
        long double sum = 0.0L;
        for (std::size_t i = 0; i < 5; ++i)
            sum += rule.weight[i] * (speed(middle - half * rule.place[i]) + speed(middle + half * rule.place[i]));
        return half * sum;
    };
    // what counts nothing in the sum; a knot of a spline takes two pieces a halving
    constexpr long double negligible = 1e-20L;
    constexpr int most_pieces = 4000;
    struct Part {
        long double begin, end, length;
    };
    std::vector<Part> waiting{{u0, u1, integral(u0, u1)}};
    const long double whole = std::abs(waiting.front().length);
    long double length = 0.0L;
    for (int pieces = 0; !waiting.empty(); ++pieces) {
        Interruption::point();
        const Part p = waiting.back();
        waiting.pop_back();
        const long double middle = 0.5L * (p.begin + p.end);
        const long double left = integral(p.begin, middle), right = integral(middle, p.end);
        if (std::abs(left + right - p.length) <= negligible * whole || pieces > most_pieces) {
            length += left + right;
            continue;
        }
        waiting.push_back({middle, p.end, right});
        waiting.push_back({p.begin, middle, left});
    }
    return length;
}

/// The parameter at the arc length s from u0, to long double's digits, from that to double's. `speed`: |r'| at a
/// parameter.
template <class Speed>
DoubleDouble refined_parameter(const Speed& speed, double u0, double s, double u) {
    // a parameter that doubles know is wrong by its rounding and by that of the length
    constexpr long double rounding = 64.0L * std::numeric_limits<double>::epsilon();
    const long double rate = speed(static_cast<long double>(u));
    const long double rest = (s - long_length(speed, u0, u)) / rate;
    if (!(std::abs(rest) <= rounding * (std::abs(u) + std::abs(u0) + std::abs(s) / rate))) return u;
    const auto high = static_cast<double>(u + rest);
    return {high, static_cast<double>((static_cast<long double>(u) - high) + rest)};
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
