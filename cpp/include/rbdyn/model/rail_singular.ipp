// Definitions of rbdyn/model/rail_singular.hpp.
#pragma once

#include "rbdyn/model/rail_singular.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/regular_stretch.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RailSingularity::RailSingularity(const Curve& curve, double u, int parameter, int rate)
    : stretch_(curve, u), parameter_(parameter), rate_(rate) {}

RBDYN_INLINE std::optional<double> RailSingularity::first(const Piece& piece, bool /*fresh*/) const {
    const double* u = piece.variable(parameter_);
    const double* w = piece.variable(rate_);
    const std::lock_guard lock(mutex_);
    take(u, piece.order, piece.length);
    const series::Bounds range = series::bounds(scaled_.data(), piece.order);
    const double width = range.high - range.low;
    if (!std::isfinite(width)) return std::nullopt;
    // it may have landed, or been put, elsewhere; or the bead of another run was looked at last, in another thread
    stretch_.include(u[0]);
    // before it by what u is rounded, so that the last state is one of this side
    const double before = 16.0 * epsilon * std::max(std::abs(range.low), std::abs(range.high));
    std::optional<double> place;
    if (const auto end = stretch_.end_above(range.high)) place = passed(piece.order, *end - before, 1.0);
    if (const auto end = stretch_.end_below(range.low))
        if (const auto other = passed(piece.order, *end + before, -1.0); other && !(place && *place < *other))
            place = other;
    // where |r'| varies little as far as the piece goes a turn is one
    if (rate_ >= 0 && stretch_.sharpness() * width > most_even) {
        take(w, piece.order, piece.length);
        if (!series::keeps_sign(scaled_.data(), piece.order))
            if (const auto turn = turned(u, w, piece, width); turn && !(place && *place < *turn)) place = turn;
    }
    if (!place) return std::nullopt;
    return *place * piece.length;
}

RBDYN_INLINE void RailSingularity::take(const double* c, int order, double length) const {
    scaled_.resize(static_cast<std::size_t>(order) + 1);
    double power = 1.0;
    for (int k = 0; k <= order; ++k, power *= length) scaled_[static_cast<std::size_t>(k)] = c[k] * power;
}

RBDYN_INLINE std::optional<double> RailSingularity::passed(int order, double end, double sign) const {
    std::vector<double> gap = scaled_;
    gap[0] -= end;
    for (double& c : gap) c *= sign;
    if (gap[0] >= 0.0) return series::value(gap.data(), order, 1.0) > gap[0] ? std::optional(0.0) : std::nullopt;
    roots_.clear();
    finder_.find(gap.data(), order, roots_);
    if (roots_.empty()) return std::nullopt;
    return roots_.front();
}

RBDYN_INLINE std::optional<double> RailSingularity::turned(const double* u, const double* w, const Piece& piece,
                                                           double width) const {
    roots_.clear();
    finder_.find(scaled_.data(), piece.order, roots_);
    const auto speed = [&](double place) {
        const double tau = place * piece.length;
        return norm(series::value(u, piece.order, tau)).first * std::abs(series::value(w, piece.order, tau));
    };
    for (const double root : roots_) {
        const auto [first, second] = norm(series::value(u, piece.order, root * piece.length));
        if (std::isfinite(first) && std::isfinite(second) && second * width <= most_even * first) continue;
        const double step = root > 0.5 ? -0x1p-6 : 0x1p-6, near = speed(root + step), far = speed(root + 2.0 * step);
        if (near < 0.75 * far) continue;
        // rounding may have put the turn where there is no curve any more
        double last = root;
        for (double back = 0x1p-50; back < 0x1p-6 && last > 0.0; back *= 2.0) {
            if (std::isfinite(norm(series::value(u, piece.order, last * piece.length)).first)) break;
            last = std::max(0.0, root - back);
        }
        return last;
    }
    return std::nullopt;
}

RBDYN_INLINE std::pair<double, double> RailSingularity::norm(double u) const {
    const CurvePoint<double> p = stretch_.curve().own(u);
    return {curves::norm(p.first), curves::norm(p.second)};
}

RBDYN_INLINE SingularLanding::SingularLanding(Curve curve, double u, const Placement& view, int position)
    : curve_(std::move(curve)), view_(view), start_(u), position_(position) {}

RBDYN_INLINE std::optional<double> SingularLanding::first(const Piece& piece, bool /*fresh*/) const {
    Vector3 low, high;
    for (int i = 0; i < 3; ++i) {
        std::vector<double> c(piece.variable(position_ + i), piece.variable(position_ + i) + piece.order + 1);
        double power = 1.0;
        for (double& one : c) {
            one *= power;
            power *= piece.length;
        }
        const series::Bounds b = series::bounds(c.data(), piece.order);
        low[i] = b.low;
        high[i] = b.high;
    }
    // as close as a crossing is told from none (curve/crossing.hpp)
    const double near = 0x1p-28 * (high - low).norm();
    std::optional<double> first;
    for (const Vector3& place : places()) {
        bool is_inside = true;
        for (int i = 0; i < 3; ++i) is_inside = is_inside && place[i] >= low[i] - near && place[i] <= high[i] + near;
        if (!is_inside) continue;
        const auto tau = closest(piece, place);
        if (away(piece, place, tau) <= near && !(first && *first < tau)) first = tau;
    }
    return first;
}

RBDYN_INLINE double SingularLanding::away(const Piece& piece, const Vector3& place, double tau) const {
    Vector3 r;
    for (int i = 0; i < 3; ++i) r[i] = series::value(piece.variable(position_ + i), piece.order, tau);
    return (r - place).norm();
}

RBDYN_INLINE double SingularLanding::closest(const Piece& piece, const Vector3& place) const {
    constexpr int samples = 256;
    int best = 0;
    for (int k = 0; k <= samples; ++k)
        if (away(piece, place, piece.length * k / samples) < away(piece, place, piece.length * best / samples))
            best = k;
    double lo = piece.length * std::max(0, best - 1) / samples,
           hi = piece.length * std::min(samples, best + 1) / samples;
    for (int k = 0; k < 100; ++k) {
        const double a = lo + (hi - lo) / 3.0, b = hi - (hi - lo) / 3.0;
        (away(piece, place, a) < away(piece, place, b) ? hi : lo) =
            away(piece, place, a) < away(piece, place, b) ? b : a;
    }
    return 0.5 * (lo + hi);
}

RBDYN_INLINE const std::vector<Vector3>& SingularLanding::places() const {
    const std::lock_guard lock(mutex_);
    if (!places_) {
        places_.emplace();
        for (const double point : curves::singular_points(curve_, start_)) {
            const Vector3 place = curve_.at<double>(point, view_).position;
            if (is_finite(place)) places_->push_back(place);
        }
    }
    return *places_;
}

RBDYN_INLINE std::string singular_at(const Curve& curve, double u) {
    const double speed = curve.first(u).norm(), before = curve.first(u - 0.125).norm(),
                 usual = std::isfinite(before) ? before : curve.first(u + 0.125).norm();
    curves::RegularStretch stretch(curve, u);
    const double near = 1e-6 * std::max(1.0, std::abs(u));
    // a rate of the parameter that is beyond all measure beside a finite speed, or none of the speed
    if (speed < 1e-6 * usual) return "it has a cusp or its parameter stands still, r' = 0, and no tangent";
    if (speed > 1e6 * usual) return "it becomes vertical, |r'| = " + text(speed) + " and growing";
    const bool is_singular = curve.jumps_at(u) || stretch.end_above(u + near) || stretch.end_below(u - near);
    return is_singular ? "its tangent jumps or is not defined" : "";
}

}  // namespace rbdyn::inline RBDYN_FORM
