// Definitions of rbdyn/mechanics/foot.hpp.
#pragma once

#include "rbdyn/mechanics/foot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace feet {

inline constexpr int samples = 512;

/// Parameters all along a curve; of one without end, those of a part around its middle and, ever further apart, beyond.
inline std::vector<double> along(const Curve& curve) {
    std::vector<double> result;
    const Domain d = curve.domain();
    const double begin = curve.closed() && !std::isfinite(d.begin) ? 0.0 : d.begin,
                 end = curve.closed() && !std::isfinite(d.end) ? begin + curve.period() : d.end;
    for (int k = 0; k <= samples; ++k) {
        const double part = static_cast<double>(k) / samples;
        if (std::isfinite(begin) && std::isfinite(end))
            result.push_back(k == samples ? end : begin + (end - begin) * part);
        else if (std::isfinite(begin))
            result.push_back(begin + std::sinh(24.0 * part));
        else if (std::isfinite(end))
            result.push_back(end - std::sinh(24.0 * (1.0 - part)));
        else
            result.push_back(std::sinh(24.0 * (2.0 * part - 1.0)));
    }
    return result;
}

}  // namespace feet

RBDYN_INLINE Vector3 Foot::direction_aside(const Curve& curve) {
    std::vector<Vector3> tangents;
    for (const double u : feet::along(curve)) {
        const Vector3 first = curve.own<double>(u).first;
        const double length = first.norm();
        if (std::isfinite(length) && length > 0.0) tangents.push_back(first / length);
    }
    const auto clearance = [&](const Vector3& e) {
        double least = 1.0;
        for (const Vector3& t : tangents) least = std::min(least, e.cross(t).norm());
        return least;
    };
    // of directions spread over half a sphere the best, unless one of the curve's own axes is about as good: in these
    // what is zero stays so
    Vector3 best(0, 0, 1);
    double most = 0.0;
    const auto look = [&](const Vector3& e, double weight) {
        const double clear = clearance(e);
        if (clear <= weight * most) return;
        most = clear;
        best = e;
    };
    for (const Vector3& own : {Vector3(0, 0, 1), Vector3(0, 1, 0), Vector3(1, 0, 0)}) look(own, 1.0);
    if (most >= 0.5) return best;
    constexpr int directions = 200;
    for (int k = 0; k < directions; ++k) {
        const double z = (k + 0.5) / directions, turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0)),
                     across = std::sqrt(1.0 - z * z);
        look({across * std::cos(turn), across * std::sin(turn), z}, 2.0);
    }
    return best;
}

RBDYN_INLINE std::vector<double> Foot::nearest(const Curve& curve, const Vector3& point) {
    const auto distance = [&](double u) {
        const double d = (curve.position(u) - point).norm();
        return std::isfinite(d) ? d : std::numeric_limits<double>::infinity();
    };
    struct Place {
        double u, distance;
    };
    const auto is_nearer = [](const Place& a, const Place& b) { return a.distance < b.distance; };
    std::vector<Place> places;
    const auto look = [&](double u) { places.push_back({u, distance(u)}); };
    for (const double u : feet::along(curve)) look(u);
    const Domain d = curve.domain();
    // what has no end is looked at about the point, too, as far out as that is
    if (!curve.closed() && !(std::isfinite(d.begin) && std::isfinite(d.end))) {
        for (const double part : {8.0, 2.0, 2.0}) {
            const double best = std::min_element(places.begin(), places.end(), is_nearer)->u;
            const double reach = std::max(1.0, std::abs(best)) * part;
            for (int k = 0; k <= feet::samples; ++k) {
                const double u = best + reach * (2.0 * k / feet::samples - 1.0);
                if (u >= d.begin && u <= d.end) look(u);
            }
        }
        std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.u < b.u; });
        const auto same = [](const Place& a, const Place& b) { return a.u == b.u; };
        places.erase(std::unique(places.begin(), places.end(), same), places.end());
    }
    std::vector<double> found, gaps;
    double rounding = std::numeric_limits<double>::infinity();  // a part of the way between two places looked at
    const std::size_t n = places.size();
    for (std::size_t k = 0; k < n; ++k) {
        const double before = places[k > 0 ? k - 1 : k].u, after = places[k + 1 < n ? k + 1 : k].u;
        if ((k > 0 && places[k - 1].distance < places[k].distance) ||
            (k + 1 < n && places[k + 1].distance < places[k].distance))
            continue;
        // Newton's method for the zero of r'.(p - r), where |r'|^2 stands for its slope if that has the wrong sign
        double low = before, high = after, u = places[k].u;
        if (curve.closed() && k == 0) low -= high - low;
        if (curve.closed() && k + 1 == n) high += high - low;
        for (int pass = 0; pass < 60; ++pass) {
            const Vector3 first = curve.first(u), away = point - curve.position(u);
            const double slope = first.squaredNorm() - curve.second(u).dot(away), value = first.dot(away);
            const double step = value / (slope > 0.0 ? slope : first.squaredNorm());
            if (!std::isfinite(step)) break;
            (step > 0.0 ? low : high) = u;
            double next = u + step;
            if (next < low || next > high) next = 0.5 * (low + high);
            if (next == u || std::abs(next - u) <= 1e-16 * std::abs(u)) break;
            u = next;
        }
        if (!curve.closed()) u = std::clamp(u, d.begin, d.end);
        found.push_back(u);
        gaps.push_back(distance(u));
        rounding = std::min(rounding, 1e-6 * curve.first(u).norm() * (after - before));
    }
    std::vector<double> result;
    const double least = *std::min_element(gaps.begin(), gaps.end());
    for (std::size_t k = 0; k < found.size(); ++k) {
        const bool is_new = std::none_of(result.begin(), result.end(), [&](double u) {
            const double round = curve.closed() ? std::remainder(found[k] - u, curve.period()) : found[k] - u;
            return std::abs(round) <= 1e-6 * std::max(1.0, std::abs(u));
        });
        if (gaps[k] <= least + rounding && is_new) result.push_back(found[k]);
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
