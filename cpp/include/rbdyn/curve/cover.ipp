// Definitions of rbdyn/curve/cover.hpp.
#pragma once

#include "rbdyn/curve/cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE double Box::farthest() const {
    return std::max(std::max(std::abs(x0), std::abs(x1)), std::max(std::abs(y0), std::abs(y1)));
}

RBDYN_INLINE void Box::add(double x, double y) {
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
}

RBDYN_INLINE void Box::add(const Box& b) {
    add(b.x0, b.y0);
    add(b.x1, b.y1);
}

RBDYN_INLINE void Box::widen(double by_x, double by_y) {
    x0 -= by_x;
    x1 += by_x;
    y0 -= by_y;
    y1 += by_y;
}

RBDYN_INLINE double Graph::along_from(const Vector3& point) const {
    return ((point[0] - x) * along_x + (point[1] - y) * along_y) / half;
}

RBDYN_INLINE double roundest(double a, double b) {
    if (a < 0.0 && b > 0.0) return 0.0;
    for (int k = std::ilogb(std::max(std::abs(a), std::abs(b))), last = k - 54; k >= last; --k) {
        const double unit = std::ldexp(1.0, k), next = (std::floor(a / unit) + 1.0) * unit;
        if (next > a && next < b) return next;
    }
    return a + 0.5 * (b - a);
}

RBDYN_INLINE CurveCover::CurveCover(Curve curve, double period) : curve_(std::move(curve)), domain_(curve_.domain()) {
    if (!curve_.closed()) {
        require(period == 0.0, curve_.name(), "period", period, "a curve that is not closed has none: leave it out");
        return;
    }
    require(std::isfinite(period) && period > 0.0, curve_.name(), "period", period,
            "it must be by how much the parameter grows in a turn: 2 pi for a circle");
    period_ = period;
    if (!std::isfinite(domain_.begin)) domain_.begin = 0.0;
    domain_.end = domain_.begin + period;
}

RBDYN_INLINE void CurveCover::find(const Box& box, std::vector<int>& found) {
    if (chains_.empty()) begin(box);
    for (const Chain& chain : chains_)
        for (std::size_t k = 0; k < chain.stretches.size() && chain.beyond[k].meets(box); ++k)
            if (stretch(chain.stretches[k]).box.meets(box)) found.push_back(chain.stretches[k]);
}

RBDYN_INLINE void CurveCover::refine(int i) {
    Stretch s = stretch(i);
    if (s.state != State::whole) return;
    const double size = s.box.size(), farthest = s.box.farthest();
    if (!(size > 16.0 * epsilon * farthest) || s.end - s.begin <= 8.0 * spacing(s)) {
        s.state = State::point;
    } else if (make_graph(s)) {
        s.state = State::graph;
        s.child = static_cast<int>(graphs_.size()) - 1;
    } else {
        const double middle = roundest(s.begin, s.end);
        s.state = State::divided;
        s.child = add(s.begin, middle);
        add(middle, s.end);
    }
    stretches_[static_cast<std::size_t>(i)] = s;
}

RBDYN_INLINE double CurveCover::sample(const Stretch& s, int k) {
    if (k == 0 || k == samples - 1) return k == 0 ? s.begin : s.end;
    const double half = 0.5 * (s.end - s.begin);
    return s.begin + half - half * static_cast<double>(chebyshev<samples - 1>(k));
}

RBDYN_INLINE void CurveCover::begin(const Box& box) {
    if (std::isfinite(domain_.end - domain_.begin)) {
        chains_.push_back(chain(domain_.begin, {domain_.end}));
        return;
    }
    const double origin = std::isfinite(domain_.begin) ? domain_.begin : std::isfinite(domain_.end) ? domain_.end : 0.0;
    const double first = first_length(origin, box.size());
    for (const double sign : {1.0, -1.0}) {
        if (sign > 0.0 ? origin == domain_.end : origin == domain_.begin) continue;
        std::vector<double> ends;
        double length = first;
        for (int k = 0; k < octaves && std::isfinite(origin + length); ++k, length *= 2.0)
            ends.push_back(origin + sign * length);
        chains_.push_back(chain(origin, ends));
    }
}

RBDYN_INLINE CurveCover::Chain CurveCover::chain(double from, const std::vector<double>& ends) {
    Chain c;
    for (double end : ends) {
        c.stretches.push_back(add(std::min(from, end), std::max(from, end)));
        from = end;
    }
    Box all;
    for (auto i = c.stretches.rbegin(); i != c.stretches.rend(); ++i) {
        all.add(stretch(*i).box);
        c.beyond.push_back(all);
    }
    std::reverse(c.beyond.begin(), c.beyond.end());
    return c;
}

RBDYN_INLINE double CurveCover::first_length(double u, double distance) const {
    const CurvePoint<double> p = curve_.own(u);
    const double speed = largest(p.first), bend = largest(p.second);
    double length = std::numeric_limits<double>::infinity();
    if (speed > 0.0) length = distance / speed;
    if (bend > 0.0) length = std::min(length, std::sqrt(2.0 * distance / bend));
    return std::isfinite(length) && length > 0.0 ? std::ldexp(1.0, std::ilogb(length) + 1) : 1.0;
}

RBDYN_INLINE int CurveCover::add(double begin, double end) {
    Stretch s{begin, end, {}};
    double gap_x = 0.0, gap_y = 0.0, before_x = 0.0, before_y = 0.0;
    int finite = 0;
    for (int k = 0; k < samples; ++k) {
        const CurvePoint<double> p = curve_.own(sample(s, k));
        const double x = p.position[0], y = p.position[1];
        if (!std::isfinite(x) || !std::isfinite(y)) continue;
        if (finite++ > 0) {
            gap_x = std::max(gap_x, std::abs(x - before_x));
            gap_y = std::max(gap_y, std::abs(y - before_y));
        }
        s.box.add(x, y);
        before_x = x;
        before_y = y;
    }
    // where numbers overflow the curve may be anywhere, or is nowhere
    if (finite < samples) gap_x = gap_y = std::numeric_limits<double>::infinity();
    if (finite == 0) s.state = State::point;
    s.box.widen(gap_x, gap_y);
    stretches_.push_back(s);
    return static_cast<int>(stretches_.size()) - 1;
}

RBDYN_INLINE bool CurveCover::make_graph(Stretch& s) {
    const CurvePoint<double> a = curve_.own(s.begin), b = curve_.own(s.end);
    Graph g;
    const double dx = 0.5 * (b.position[0] - a.position[0]), dy = 0.5 * (b.position[1] - a.position[1]);
    g.half = std::sqrt(dx * dx + dy * dy);
    if (!(g.half > 0.0) || !std::isfinite(g.half)) return false;
    g.along_x = dx / g.half;
    g.along_y = dy / g.half;
    g.x = a.position[0] + dx;
    g.y = a.position[1] + dy;

    // turning little, forward everywhere
    double fastest = 0.0;
    for (int k = 1; k + 1 < samples; ++k) {
        const CurvePoint<double> p = curve_.own(sample(s, k));
        const double along = g.along(p.first), across = g.across(p.first);
        if (!(std::abs(across) <= 0.5 * along)) return false;
        fastest = std::max(fastest, along);
    }

    // eta and u at Chebyshev points of xi; rounded once, at the end, since a landing soon after a start depends on
    // third and higher derivatives of f
    constexpr int n = Graph::degree;
    const double places = s.box.farthest() / g.half + std::max(std::abs(s.begin), std::abs(s.end)) * fastest;
    g.noise = 4.0 * epsilon * places;
    Values eta, u;
    double guess = s.end;
    for (int k = 0; k <= n; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const std::optional<double> met = k == 0 ? s.end : k == n ? s.begin : met_at(g, s, k, guess);
        if (!met || (k > 0 && !(*met < u[i - 1]))) return false;
        guess = *met;
        const CurvePoint<long double> p = curve_.own<long double>(guess);
        const CurvePoint<double> rounded = curve_.own(guess);
        for (int c = 0; c < 2; ++c)
            g.noise =
                std::max(g.noise, 4.0 * std::abs(static_cast<double>(p.position[c] - rounded.position[c])) / g.half);
        const long double x = (p.position[0] - g.x) / g.half, y = (p.position[1] - g.y) / g.half;
        const long double missed = chebyshev<n>(k) - (x * g.along_x + y * g.along_y);
        const double slope = g.across(rounded.first) / g.along(rounded.first);
        u[i] = guess;
        // at an end of a stretch the tangent may be lost in a cusp, and nothing is missed
        eta[i] = y * g.along_x - x * g.along_y + (std::isfinite(slope) ? missed * slope : 0.0L);
    }
    constexpr double finest = std::numeric_limits<long double>::epsilon();
    if (!fit(eta, std::max(0x1p-53, 0.25 * g.noise), std::max(0x1p-62, 4.0 * finest * places), g.f, g.order))
        return false;
    fit(u, 0.0, 0x1p-30 * (s.end - s.begin), g.u, g.u_order);

    const auto [low, high] = std::minmax_element(eta.begin(), eta.end());
    // between points so close a graph that turns little goes no farther beyond them
    const double margin = 0.05 * static_cast<double>(*high - *low) + 0x1p-40 + 4.0 * g.noise;
    g.low = static_cast<double>(*low) - margin;
    g.high = static_cast<double>(*high) + margin;
    s.box = {};
    for (const double end : {-1.0, 1.0})
        for (const double side : {g.low, g.high})
            s.box.add(g.x + g.half * (end * g.along_x - side * g.along_y),
                      g.y + g.half * (end * g.along_y + side * g.along_x));
    s.box.widen(0x1p-20 * g.half, 0x1p-20 * g.half);
    graphs_.push_back(g);
    return true;
}

RBDYN_INLINE std::optional<double> CurveCover::met_at(const Graph& g, const Stretch& s, int k, double guess) const {
    const auto target = static_cast<double>(chebyshev<Graph::degree>(k));
    double u = guess, before = std::numeric_limits<double>::infinity();
    for (int iteration = 0; iteration < 30; ++iteration) {
        const CurvePoint<double> p = curve_.own(u);
        const double missed = target - g.along_from(p.position), size = std::abs(missed);
        // little enough to be made up for along the tangent, and no less by another step
        if (size <= 0x1p-50 || (size <= 0x1p-32 && !(size < 0.5 * before))) return u;
        before = size;
        u += missed / g.along(p.first);
        // out of the stretch, or out of a cusp at its end where there is no slope
        if (!(u > s.begin && u < s.end)) u = s.begin + 0.5 * (s.end - s.begin) * (1.0 + target);
    }
    return std::nullopt;
}

RBDYN_INLINE bool CurveCover::fit(const Values& values, double resolved, double negligible,
                                  std::array<double, Graph::degree + 1>& coefficients, int& order) {
    constexpr int n = Graph::degree;
    Values series;
    for (int j = 0; j <= n; ++j) {
        long double sum = 0.5L * (values[0] + (j % 2 == 0 ? values[n] : -values[n]));
        for (int k = 1; k < n; ++k) sum += values[static_cast<std::size_t>(k)] * chebyshev<n>(j * k);
        series[static_cast<std::size_t>(j)] = sum * (j == 0 || j == n ? 1.0L : 2.0L) / n;
        if (resolved > 0.0 && j > n - 3 && !(std::abs(series[static_cast<std::size_t>(j)]) <= resolved)) return false;
    }
    order = n;
    while (order > 0 && std::abs(series[static_cast<std::size_t>(order)]) <= negligible) --order;
    // sum_j series_j T_j in powers, T_(j+1) = 2 x T_j - T_(j-1)
    Values c{}, now{1.0L}, before{};
    for (int j = 0; j <= order; ++j) {
        for (std::size_t k = 0; k <= n; ++k) c[k] += series[static_cast<std::size_t>(j)] * now[k];
        Values next{};
        for (std::size_t k = 0; k < n; ++k) next[k + 1] = (j == 0 ? 1.0L : 2.0L) * now[k];
        for (std::size_t k = 0; k <= n; ++k) next[k] -= before[k];
        before = now;
        now = next;
    }
    for (std::size_t k = 0; k <= n; ++k) coefficients[k] = static_cast<double>(c[k]);
    return true;
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
