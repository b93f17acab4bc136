// Definitions of rbdyn/engine/near_singular.hpp.
#pragma once

#include "rbdyn/engine/near_singular.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/step_length.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace near_singular {

/// Of the distance of such a place: how close to it no step ends, and how long one is at most. Numbers of yours that
/// make a parallelogram but for their rounding are expanded as they are, and 1.4^order is 1e3.
inline constexpr double beside = 0.3, longest = 1.4, instead = 0.6;
/// Of the length of a step: from how near on digits are lost, and what is looked at, to both sides, so that a step that
/// ends before such a place is seen to.
inline constexpr double loses = 4.0, reach = 1.5;
/// Of a pivot where a step begins: what it is at least where several places are as one.
inline constexpr double deep = 0x1p-6;

}  // namespace near_singular

RBDYN_INLINE NearSingular::NearSingular(const Equations& equations) {
    for (const Guard& guard : equations.guards)
        if (guard.kind == EventKind::singular && guard.least < 0.0 && guard.output >= 0)
            pivots_.push_back(guard.output);
}

RBDYN_INLINE std::vector<std::complex<double>> NearSingular::places(const SeriesEvaluator& series, int order,
                                                                    double length) const {
    constexpr int samples = 24;  // to each side
    std::vector<std::complex<double>> found;
    const double far = near_singular::reach * length;
    for (const int output : pivots_) {
        const double* c = series.output(output);
        const double first = c[0] + 1.0;
        // a double zero as it is told from afar, p = p'' (t - a)^2 / 2: where rounding keeps steps short it is not seen
        if (const double away = -2.0 * first / c[1]; std::abs(away) > length && std::abs(away) < 4.0 * length &&
                                                     std::abs(4.0 * first * c[2] / (c[1] * c[1]) - 1.0) < 0.25) {
            found.emplace_back(away, 0.0);
            continue;
        }
        // no zero where all others together are less
        double others = 0.0;
        for (int k = order; k > 0; --k) others = (others + std::abs(c[k])) * far;
        if (!(others > first)) continue;
        const auto place = [&](int i) { return far * i / samples; };
        std::array<double, 2 * samples + 1> value;
        for (int i = -samples; i <= samples; ++i)
            value[static_cast<std::size_t>(i + samples)] = series::value(c, order, place(i)) + 1.0;
        for (int i = -samples; i <= samples; ++i) {
            const auto at = static_cast<std::size_t>(i + samples);
            if ((i > -samples && value[at - 1] < value[at]) || (i < samples && value[at + 1] <= value[at])) continue;
            // p + p' s + p''/2 s^2 from there
            double p = 0.0, slope = 0.0, half = 0.0;
            for (int k = order; k >= 0; --k) {
                half = half * place(i) + slope;
                slope = slope * place(i) + p;
                p = p * place(i) + c[k];
            }
            p += 1.0;
            const double middle = -0.5 * slope / half;
            if (!(half > 0.0) || !(std::abs(middle) < 2.0 * far / samples)) {
                // no parabola, as between two places: of those here is the middle
                if (i != 0 && p < near_singular::deep * first) found.emplace_back(place(i), 0.0);
                continue;
            }
            const double square = p / half - middle * middle;
            // of two zeros that rounding has drawn apart the one between
            const std::complex<double> z(place(i) + middle, square > 0.0 ? std::sqrt(square) : 0.0);
            if (z.imag() < 0.25 * std::abs(z)) found.push_back(z);
        }
    }
    return found;
}

RBDYN_INLINE double NearSingular::told(const SeriesEvaluator& series, int order, double length,
                                       double log_tolerance) const {
    std::vector<double> size(static_cast<std::size_t>(order + 1));
    for (const int output : pivots_) {
        std::ranges::fill(size, 0.0);
        series::widen(size.data(), series.output(output), order);
        const double most = *std::ranges::max_element(size);
        if (std::isfinite(most) && most > 0.0)
            length = std::min(length, std::exp2(series::log_step(size.data(), order, most, log_tolerance)));
    }
    return length;
}

RBDYN_INLINE bool NearSingular::loses_digits(const std::vector<std::complex<double>>& places, double length) {
    return std::any_of(places.begin(), places.end(),
                       [&](const auto& z) { return std::abs(z) < near_singular::loses * length; });
}

RBDYN_INLINE double NearSingular::clear_of(const std::vector<std::complex<double>>& places, double length,
                                           bool is_given) {
    for (const auto& z : places) length = std::min(length, near_singular::longest * std::abs(z));
    if (is_given) return length;
    // twice, for a shorter step may end beside another one
    for (int pass = 0; pass < 2; ++pass)
        for (const auto& z : places)
            if (std::abs(z - length) < near_singular::beside * std::abs(z)) length = near_singular::instead * z.real();
    return length;
}

}  // namespace rbdyn::inline RBDYN_FORM
