// Definitions of rbdyn/curve/spline.hpp.
#pragma once

#include "rbdyn/curve/spline.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/own_axes.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/polynomial_piece.hpp"
#include "rbdyn/curve/stretch.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Spline::validate() const {
    const auto n = points.size();
    require(n >= (closed ? 3u : 2u), "spline", "number of points", static_cast<double>(n),
            closed ? "it must be at least 3 for a closed spline" : "it must be at least 2");
    for (std::size_t k = 0; k < n; ++k) {
        if (k % 64 == 0) Interruption::point();
        if (!is_finite(points[k])) curves::require_finite("spline", "point " + std::to_string(k), points[k]);
        const std::size_t before = (k + n - 1) % n;
        if ((k == 0 && !closed) || points[k] != points[before]) continue;
        refuse("spline", "distance from point " + std::to_string(before) + " to point " + std::to_string(k), 0.0,
               k == 0 ? "a closed spline goes on to its first point: do not repeat it"
                      : "points that follow each other must differ");
    }
    for (const auto& [k, slope] : slopes) {
        require(k >= 0 && static_cast<std::size_t>(k) < n, "spline", "index of a slope", k,
                "it must be that of a point, 0 to " + std::to_string(n - 1));
        curves::require_direction("spline", "slope at point " + std::to_string(k), slope);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE std::vector<WideVector> spline_slopes(const std::vector<WideVector>& chord,
                                                   const std::optional<WideVector>& begin,
                                                   const std::optional<WideVector>& end) {
    using Number = DoubleDouble;
    const auto times = [](double factor, const WideVector& v) { return Number(factor) * v; };
    const std::size_t n = chord.size();
    if (n == 1) {
        // a line; with one slope a parabola
        const WideVector& d = chord[0];
        return {begin ? *begin : end ? times(2.0, d) - *end : d, end ? *end : begin ? times(2.0, d) - *begin : d};
    }
    if (n == 2 && !begin && !end)
        return {times(0.5, times(3.0, chord[0]) - chord[1]), times(0.5, chord[0] + chord[1]),
                times(0.5, times(3.0, chord[1]) - chord[0])};
    // rows: below[k] m_(k-1) + diagonal[k] m_k + above[k] m_(k+1) = m[k], eliminated from the first on
    std::vector<WideVector> m(n + 1);
    std::vector<Number> below(n + 1, 1.0), diagonal(n + 1, 4.0), above(n + 1, 1.0);
    for (std::size_t k = 1; k < n; ++k) {
        if (k % 64 == 0) Interruption::point();
        m[k] = times(3.0, chord[k - 1] + chord[k]);
    }
    diagonal[0] = diagonal[n] = 1.0;
    above[0] = begin ? 0.0 : 2.0;
    below[n] = end ? 0.0 : 2.0;
    m[0] = begin ? *begin : times(0.5, times(5.0, chord[0]) + chord[1]);
    m[n] = end ? *end : times(0.5, times(5.0, chord[n - 1]) + chord[n - 2]);
    // pivots lie between 0.4 and 4: no rows need be exchanged
    for (std::size_t k = 1; k <= n; ++k) {
        if (k % 64 == 0) Interruption::point();
        const Number factor = below[k] / diagonal[k - 1];
        diagonal[k] -= factor * above[k - 1];
        m[k] -= factor * m[k - 1];
    }
    m[n] /= diagonal[n];
    for (std::size_t k = n; k-- > 0;) {
        if (k % 64 == 0) Interruption::point();
        m[k] = (m[k] - above[k] * m[k + 1]) / diagonal[k];
    }
    return m;
}

RBDYN_INLINE std::vector<WideVector> closed_spline_slopes(const std::vector<WideVector>& chord) {
    const std::size_t n = chord.size();
    const WideVector zero = widened(Vector3(Vector3::Zero())), one = widened(Vector3(Vector3::Ones()));
    const std::vector<WideVector> none(n, zero);
    const std::vector<WideVector> rest = spline_slopes(chord, zero, zero), part = spline_slopes(none, one, one);
    const WideVector first =
        (DoubleDouble(3.0) * (chord[n - 1] + chord[0]) - rest[n - 1] - rest[1]) / (4.0 + part[n - 1].x() + part[1].x());
    std::vector<WideVector> m(n + 1);
    for (std::size_t k = 0; k <= n; ++k) {
        if (k % 64 == 0) Interruption::point();
        m[k] = rest[k] + part[k].x() * first;
    }
    return m;
}

}  // namespace rbdyn::inline RBDYN_FORM::curves

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SplineForm::SplineForm(const Spline& spline) : closed_(spline.closed), last_(spline.points.size() - 1) {
    const std::vector<Vector3>& points = spline.points;
    const std::size_t n = points.size(), stretches = closed_ ? n : n - 1;
    double largest = 0.0;
    std::vector<Vector3> from_first;
    for (const Vector3& p : points) {
        if (from_first.size() % 64 == 0) Interruption::point();
        largest = std::max(largest, curves::largest(p));
        if (p != points[0]) from_first.emplace_back(p - points[0]);
    }
    // the farthest point gives the best known direction
    std::iter_swap(from_first.begin(),
                   std::max_element(from_first.begin(), from_first.end(), [](const Vector3& a, const Vector3& b) {
                       return curves::norm(a) < curves::norm(b);
                   }));
    for (const auto& [k, slope] : spline.slopes) from_first.push_back(slope);
    // the points themselves are rounded
    const double rounding = std::numeric_limits<double>::epsilon() * largest;
    const curves::OwnAxes axes = curves::own_axes(from_first, 4.0 * rounding);
    placement_ = placed(points[0], axes.axes);
    straight_ = axes.dimension == 1;

    using curves::WideVector;
    std::vector<WideVector> p, chord;
    std::map<std::size_t, WideVector> given;
    for (const Vector3& point : points) {
        if (p.size() % 64 == 0) Interruption::point();
        p.push_back(axes.of(widened(point) - widened(points[0])));
    }
    for (std::size_t k = 0; k < stretches; ++k) {
        if (k % 64 == 0) Interruption::point();
        chord.push_back(p[(k + 1) % n] - p[k]);
    }
    for (const auto& [k, slope] : spline.slopes) given.emplace(static_cast<std::size_t>(k), axes.of(widened(slope)));
    const std::vector<WideVector> m = slopes(chord, given);

    // what a slope owes to a chord falls by 2 - sqrt(3) a point
    std::vector<double> size(stretches);
    for (std::size_t k = 0; k < stretches; ++k)
        size[k] = std::max({curves::norm(rounded(chord[k])), curves::norm(rounded(m[k])), largest});
    for (std::size_t k = 1; k < stretches; ++k) size[k] = std::max(size[k], 0.3 * size[k - 1]);
    for (std::size_t k = stretches - 1; k-- > 0;) size[k] = std::max(size[k], 0.3 * size[k + 1]);
    const Vector3 present(1, axes.dimension > 1 ? 1 : 0, axes.dimension > 2 ? 1 : 0);
    for (std::size_t k = 0; k < stretches; ++k) {
        Interruption::point();
        const WideVector &d = chord[k], &a = m[k], &b = m[k + 1];
        const DoubleDouble two = 2.0, three = 3.0;
        const Vector3 s = size[k] * present;
        pieces_.emplace_back(std::vector<WideVector>{p[k], a, three * d - two * a - b, a + b - two * d},
                             std::vector<Vector3>{s, s, 6.0 * s, 4.0 * s});
    }

    // stretches about a point that is no knot are one
    lowest_ = 0;
    highest_ = static_cast<long>(stretches) - 1;
    if (closed_) {
        lowest_ = -curves::most_stretches;
        highest_ = curves::most_stretches;
    } else {
        const bool joined_first = given.count(0) == 0 && given.count(1) == 0;
        const bool joined_last = given.count(last_) == 0 && given.count(last_ - 1) == 0;
        if (stretches >= 2 && joined_first) lowest_ = 1;
        if (stretches >= 2 && joined_last) highest_ = std::max(lowest_, highest_ - 1);
    }
    for (std::size_t k = 0; k < stretches; ++k) {
        Interruption::point();
        lengths_.push_back(pieces_[k].length(0.0, 1.0, name()));
    }
    for (const double length : lengths_) round_ += length;
}

RBDYN_INLINE std::string SplineForm::name() const {
    return (closed_ ? "closed spline of " : "spline of ") + std::to_string(last_ + 1) + " points";
}

RBDYN_INLINE Vector3 SplineForm::third(double u) const {
    const long k = stretch(u);
    return piece(k).third(u - static_cast<double>(k));
}

RBDYN_INLINE double SplineForm::length(double u0, double u1) const {
    if (u1 < u0) return -length(u1, u0);
    const long first = stretch(u0), last = stretch(u1);
    const double begin = u0 - static_cast<double>(first), end = u1 - static_cast<double>(last);
    if (first == last) return piece(first).length(begin, end, name());
    double sum = piece(first).length(begin, 1.0, name()) + piece(last).length(0.0, end, name());
    const long between = last - first - 1, rounds = between / static_cast<long>(pieces_.size());
    for (long k = first + 1 + rounds * static_cast<long>(pieces_.size()); k < last; ++k) sum += lengths_[index(k)];
    return sum + static_cast<double>(rounds) * round_;
}

RBDYN_INLINE bool SplineForm::regular_at(double u) const {
    const long k = stretch(u);
    return piece(k).regular_at(u - static_cast<double>(k));
}

RBDYN_INLINE std::optional<Vector3> SplineForm::straight_binormal(double u) const {
    const Vector3 tangent = own(u).first;
    // one normal all along, also where the curve goes back on itself
    if (straight_) return Vector3(0.0, 0.0, tangent.x() < 0.0 ? -1.0 : 1.0);
    long k = stretch(u);
    double x = u - static_cast<double>(k);
    if (piece(k).bends_at(x)) return std::nullopt;
    for (std::size_t steps = 0; steps <= pieces_.size(); ++steps, --k, x = 1.0) {
        const bool is_first = k == lowest_;
        if (x > 0.0 || is_first)
            if (const auto before = piece(k).binormal_before(x)) return before;
        if (is_first) break;
    }
    return curves::binormal_of_line(placement_.axes, tangent);
}

RBDYN_INLINE std::vector<curves::WideVector> SplineForm::slopes(
    const std::vector<curves::WideVector>& chord, const std::map<std::size_t, curves::WideVector>& given) const {
    using curves::WideVector;
    const std::size_t n = chord.size();
    if (closed_ && given.empty()) return curves::closed_spline_slopes(chord);
    std::vector<WideVector> m(n + 1);
    std::optional<WideVector> slope_begin;
    std::size_t begin = 0;
    if (closed_) {
        begin = given.begin()->first;
        slope_begin = given.begin()->second;
    } else if (given.count(0) != 0) {
        slope_begin = given.at(0);
    }
    // from a given slope, or an end, to the next
    for (const std::size_t stop = begin + n; begin < stop;) {
        std::size_t end = begin + 1;
        while (end < stop && given.count(end % n) == 0) ++end;
        const auto found = given.find(closed_ ? end % n : end);
        const std::optional<WideVector> slope_end =
            found == given.end() ? std::nullopt : std::optional<WideVector>(found->second);
        std::vector<WideVector> part;
        for (std::size_t k = begin; k < end; ++k) part.push_back(chord[k % n]);
        const std::vector<WideVector> inner = curves::spline_slopes(part, slope_begin, slope_end);
        for (std::size_t k = begin; k <= end; ++k) m[closed_ ? k % n : k] = inner[k - begin];
        slope_begin = slope_end;
        begin = end;
    }
    if (closed_) m[n] = m[0];
    return m;
}

RBDYN_INLINE std::size_t SplineForm::index(long k) const {
    const auto n = static_cast<long>(pieces_.size());
    return static_cast<std::size_t>((k % n + n) % n);
}

RBDYN_INLINE SplineForm Spline::form() const {
    validate();
    return SplineForm(*this);
}

}  // namespace rbdyn::inline RBDYN_FORM
