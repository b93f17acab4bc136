// Definitions of rbdyn/curve/crossing.hpp.
#pragma once

#include "rbdyn/curve/crossing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/cover.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/gap.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE std::optional<Landing> LandingFinder::first_landing(const Flight& path, int side, double last,
                                                                 bool just_left) {
    if (path.degree > max_path_degree)
        require(false, cover_.curve().name(), "degree of a path", path.degree,
                "it must be at most " + std::to_string(max_path_degree));
    complete_ = true;
    visits_ = 0;
    best_ = {std::numeric_limits<double>::infinity(), 0.0};
    if (!scale(path, just_left ? 0.0 : 0x1p-62)) return std::nullopt;
    turn_ = turn_of(last);
    side_ = side;
    contact_ = last - turn_;
    just_left_ = just_left;
    in_doubt_ = just_left && path.doubt != nullptr;

    nodes_.clear();
    const Box box = bounding(x_.data(), y_.data(), degree_);
    cover_.find(box, nodes_);
    if (nodes_.empty()) return std::nullopt;
    search(0.0, 1.0, 0, 0, nodes_.size());
    if (!(best_.tau <= 1.0)) return std::nullopt;
    return Landing{best_.tau == 1.0 ? path.length : best_.tau * path.length, best_.u + turn_};
}

RBDYN_INLINE double LandingFinder::turn_of(double u) const {
    const double period = cover_.period();
    return period > 0.0 ? std::floor((u - cover_.domain().begin) / period) * period : 0.0;
}

RBDYN_INLINE double LandingFinder::parameter_at(double x, double y, double last) {
    const Vector3 point{x, y, 0.0};
    double least = std::numeric_limits<double>::infinity(), nearest = last;
    const auto look = [&](double u) {
        const double distance = (cover_.curve().own(u).position - point).norm();
        if (distance < least) {
            least = distance;
            nearest = u + turn_of(last);
        }
    };
    // a curve and a point that are computed are apart by rounding: a little is enough, as a rule
    for (double wide = 0x1p-40 * (std::abs(x) + std::abs(y)) + std::numeric_limits<double>::min();
         std::isinf(least) && std::isfinite(wide); wide *= 0x1p10) {
        const Box box{x - wide, x + wide, y - wide, y + wide};
        nodes_.clear();
        cover_.find(box, nodes_);
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const int node = nodes_[i];
            if (!cover_.stretch(node).box.meets(box)) continue;
            cover_.refine(node);
            const CurveCover::Stretch s = cover_.stretch(node);
            if (s.state == CurveCover::State::divided) {
                nodes_.push_back(s.child);
                nodes_.push_back(s.child + 1);
            } else if (s.state == CurveCover::State::graph && s.box.meets(box)) {
                const Graph& g = cover_.graph(s);
                look(parameter(g, s, std::clamp(g.along_from(point), -1.0, 1.0)));
            } else if (s.state == CurveCover::State::point) {
                look(s.begin);
            }
        }
    }
    return nearest;
}

RBDYN_INLINE bool LandingFinder::scale(const Flight& path, double negligible) {
    double power = 1.0, motion = 0.0;
    for (int k = 0; k <= path.degree; ++k, power *= path.length) {
        const auto i = static_cast<std::size_t>(k);
        x_[i] = path.x[k] * power;
        y_[i] = path.y[k] * power;
        if (path.doubt != nullptr) doubt_[i] = path.doubt[k] * power;
        if (k > 0) motion += std::abs(x_[i]) + std::abs(y_[i]);
    }
    degree_ = path.degree;
    for (double rest = 0.0; degree_ > 0; --degree_) {
        const auto i = static_cast<std::size_t>(degree_);
        rest += std::abs(x_[i]) + std::abs(y_[i]);
        if (rest > negligible * motion) break;
    }
    return motion > 0.0 && std::isfinite(motion) && std::isfinite(x_[0]) && std::isfinite(y_[0]);
}

RBDYN_INLINE Box LandingFinder::bounding(const double* x, const double* y, int degree) {
    const series::Bounds across = series::bounds(x, degree), up = series::bounds(y, degree);
    Box box{across.low, across.high, up.low, up.high};
    box.widen(0x1p-20 * box.size(), 0x1p-20 * box.size());
    return box;
}

RBDYN_INLINE void LandingFinder::part(double from, double width, Path& x, Path& y) const {
    x = x_;
    y = y_;
    if (from != 0.0)
        for (int i = 0; i < degree_; ++i)
            for (int k = degree_ - 1; k >= i; --k) {
                const auto at = static_cast<std::size_t>(k);
                x[at] += from * x[at + 1];
                y[at] += from * y[at + 1];
            }
    double power = 1.0;
    for (int k = 0; k <= degree_; ++k, power *= width) {
        x[static_cast<std::size_t>(k)] *= power;
        y[static_cast<std::size_t>(k)] *= power;
    }
}

RBDYN_INLINE void LandingFinder::search(double begin, double width, int depth, std::size_t first, std::size_t last) {
    if (best_.tau <= begin) return;
    if (++visits_ > max_visits) {
        complete_ = false;
        return;
    }
    const double from = std::max(0.0, begin - overlap * width), stretch = begin + width * (1.0 + overlap) - from;
    Path x, y;
    part(from, stretch, x, y);
    const Box box = bounding(x.data(), y.data(), degree_);

    // the stretches that it may meet, divided until they are graphs or small against the path
    const std::size_t mine = nodes_.size();
    bool divide = false;
    for (std::size_t i = first; i < last; ++i) meet(nodes_[i], box, x, y, divide);
    if (nodes_.size() > mine && (depth == max_depth || !divide)) {
        const bool is_last = depth == max_depth;
        divide = false;
        const std::size_t end = nodes_.size();
        for (std::size_t i = mine; i < end && !divide; ++i)
            if (cover_.stretch(nodes_[i]).state == CurveCover::State::graph)
                divide = !examine(cover_.stretch(nodes_[i]), x, y, from, stretch, is_last);
    }
    if (nodes_.size() > mine && divide) {
        const std::size_t end = nodes_.size();
        search(begin, 0.5 * width, depth + 1, mine, end);
        search(begin + 0.5 * width, 0.5 * width, depth + 1, mine, end);
    }
    nodes_.resize(mine);
}

RBDYN_INLINE void LandingFinder::meet(int node, const Box& box, const Path& x, const Path& y, bool& divide) {
    if (!cover_.stretch(node).box.meets(box)) return;
    if (cover_.stretch(node).state == CurveCover::State::whole) {
        // far smaller than the path: first see which part of the path comes near
        if (cover_.stretch(node).box.size() < 0.125 * box.size()) {
            divide = true;
            nodes_.push_back(node);
            return;
        }
        cover_.refine(node);
    }
    const CurveCover::Stretch s = cover_.stretch(node);
    switch (s.state) {
        case CurveCover::State::whole:
        case CurveCover::State::point: return;
        case CurveCover::State::divided:
            meet(s.child, box, x, y, divide);
            meet(s.child + 1, box, x, y, divide);
            return;
        case CurveCover::State::graph: break;
    }
    if (!s.box.meets(box)) return;
    const Graph& g = cover_.graph(s);
    const PathView view(g, x, y, degree_, 0x1p-58);
    const series::Bounds xi = series::bounds(view.xi.data(), view.degree);
    if (xi.low > window || xi.high < -window) return;
    const series::Bounds eta = series::bounds(view.eta.data(), view.degree);
    if (eta.low > g.high || eta.high < g.low) return;
    nodes_.push_back(node);
    if (xi.low < -reach || xi.high > reach) divide = true;
}

RBDYN_INLINE bool LandingFinder::examine(const CurveCover::Stretch& stretch, const Path& x, const Path& y, double from,
                                         double width, bool is_last) {
    const CurveCover::Stretch s = stretch;
    const Graph& g = cover_.graph(s);
    // at the start nothing is too small to tell which way the path leaves
    const PathView view(g, x, y, degree_, from > 0.0 ? 0x1p-58 : 0.0);
    Gap gap(g, view, side_);
    if (!is_last && !(gap.dropped() <= std::max(0x1p-49, g.noise))) return false;

    // a contact at the very start, known or within rounding
    int known = 0;
    double least_slope = 2.0 * g.noise + 16.0 * epsilon, contact = std::numeric_limits<double>::quiet_NaN();
    if (from == 0.0 && std::abs(view.xi[0]) <= 1.0 + 0x1p-13) {
        const double u = just_left_ ? contact_near(s) : std::numeric_limits<double>::quiet_NaN();
        if (std::isfinite(u)) {
            constexpr double infinity = std::numeric_limits<double>::infinity();
            known = gap.contact(
                cover_.curve().own(std::clamp(u, std::nextafter(s.begin, infinity), std::nextafter(s.end, -infinity))));
            least_slope = Gap::rounding(known + 1, view.motion());
        } else if (std::abs(gap[0]) <= 1e-13 * gap.size(1) + g.noise) {
            known = gap.leading(1, 4e-12);
        }
        if (known > gap.degree()) return true;
        if (std::isfinite(u)) contact = u;
    }

    const double* p = gap.from(known);
    const double motion = gap.size(known);
    int degree = gap.degree() - known;
    for (double rest = 0.0; degree > 0; --degree) {
        rest += std::abs(p[degree]);
        if (rest > 0x1p-60 * motion) break;
    }
    roots_.clear();
    const bool keeps_sign = p[0] != 0.0 && series::keeps_sign(p, degree);
    if (!keeps_sign) finder_.find(p, degree, roots_);
    int before = 0;
    for (int k = 0; k <= degree && before == 0; ++k) before = p[k] > 0.0 ? 1 : p[k] < 0.0 ? -1 : 0;
    std::size_t first = 0;
    if (in_doubt_ && std::isfinite(contact))
        first =
            within_doubt(g, width, [&](double tau) { return std::pow(tau, known) * series::value(p, degree, tau); });
    if (first % 2 == 1) before = -before;
    if (first > 0 && before < 0) {
        // the last of these is where it goes through
        before = 1;
        --first;
    } else if (first == 0 && known > 0 && p[0] < 0.0) {
        // begins by going through, if this graph is where it goes
        const bool enters = std::abs(view.xi[0]) < 1.0 - 0x1p-30 || view.xi[0] * view.xi[1] < 0.0;
        if (enters && std::abs(view.xi[0]) <= window)
            best_ = {0.0, std::isfinite(contact) ? contact : parameter(g, s, view.xi[0])};
    }
    for (std::size_t i = first; i < roots_.size(); ++i) {
        const double root = roots_[i];
        before = -before;
        if (before > 0) continue;
        const double xi = series::value(view.xi.data(), view.degree, root);
        double slope = 0.0;
        for (int k = degree; k >= 1; --k) slope = slope * root + k * p[k];
        // with less, all of the gap is rounding: the path goes along the curve
        if (std::abs(xi) > window || !(std::abs(slope) > least_slope)) continue;
        const double factor = std::pow(root, known);
        const bool exact = factor > 0x1p-4 && factor * std::abs(slope) > 0x1p-20 * motion;
        const double doubt = (g.noise + 4.0 * epsilon * motion) / (factor * std::abs(slope));
        offer(s, {from + width * root, parameter(g, s, xi)}, exact, width, doubt);
        break;
    }
    return true;
}

template <class Value>
std::size_t LandingFinder::within_doubt(const Graph& g, double width, const Value& gap) const {
    const auto doubt = [&](double x) { return 2.0 * series::value(doubt_.data(), degree_, x * width) / g.half; };
    double from = 0.0;
    for (std::size_t i = 0; i < roots_.size(); from = roots_[i++])
        for (const double part : {0.25, 0.5, 0.75})
            if (const double x = from + part * (roots_[i] - from); std::abs(gap(x)) > doubt(x)) return i;
    return roots_.size();
}

RBDYN_INLINE double LandingFinder::contact_near(const CurveCover::Stretch& s) const {
    const double margin = 0x1p-13 * (s.end - s.begin);
    for (const double shift : {0.0, cover_.period(), -cover_.period()}) {
        const double u = contact_ + shift;
        if (u >= s.begin - margin && u <= s.end + margin) return u;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

RBDYN_INLINE double LandingFinder::parameter(const Graph& g, const CurveCover::Stretch& s, double xi) const {
    double u = std::clamp(series::value(g.u.data(), g.u_order, xi), s.begin, s.end);
    for (int iteration = 0; iteration < 3; ++iteration) {
        const CurvePoint<double> p = cover_.curve().own(u);
        const double next = std::clamp(u + (xi - g.along_from(p.position)) / g.along(p.first), s.begin, s.end);
        if (next == u || !std::isfinite(next)) break;
        u = next;
    }
    return u;
}

RBDYN_INLINE void LandingFinder::offer(const CurveCover::Stretch& s, Landing found, bool exact, double width,
                                       double doubt) {
    if (!(found.tau < best_.tau + overlap)) return;
    // P(tau) = r(u) itself
    for (int iteration = 0; iteration < 3 && exact; ++iteration) {
        const CurvePoint<double> r = cover_.curve().own(found.u);
        double px = x_[static_cast<std::size_t>(degree_)], py = y_[static_cast<std::size_t>(degree_)];
        double vx = 0.0, vy = 0.0;
        for (int k = degree_ - 1; k >= 0; --k) {
            vx = vx * found.tau + px;
            vy = vy * found.tau + py;
            px = px * found.tau + x_[static_cast<std::size_t>(k)];
            py = py * found.tau + y_[static_cast<std::size_t>(k)];
        }
        const double ex = px - r.position[0], ey = py - r.position[1];
        const double across = vx * r.first[1] - vy * r.first[0];
        const double d_tau = (ey * r.first[0] - ex * r.first[1]) / across, d_u = (vx * ey - vy * ex) / across;
        // what is left to gain is small, or rounding
        if (!(std::abs(d_tau) <= 0x1p-20 * width)) break;
        found = {found.tau + d_tau, std::clamp(found.u + d_u, s.begin, s.end)};
        if (std::abs(d_tau) <= epsilon * found.tau) break;
    }
    if (found.tau > 1.0 && found.tau <= 1.0 + width * std::min(doubt, overlap) + 2.0 * epsilon) found.tau = 1.0;
    if (found.tau > 0.0 && found.tau <= 1.0 && found.tau < best_.tau) best_ = found;
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
