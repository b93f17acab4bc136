// Where a path, polynomials in time, first crosses a plane curve from one side to the other: a bead that flies lands.
//
//   P(tau) = (x(tau), y(tau)), 0 <= tau <= length;   gap = (P - r(u)) . n,   n = b x t, b the third own axis
//
// The path's time is halved until each part either misses the boxes of the curve or passes, in a chord's length or so,
// graphs eta = f(xi) over chords (curve/cover.hpp); there the gap along eta,
//   G(tau) = eta(tau) - f(xi(tau)),
// has the sign and the zeros of the gap, with their multiplicity, and is a polynomial whose roots are all found
// (series/roots.hpp). A crossing is finished by Newton's method on the curve itself, P(tau) = r(u).
//
// Contract: the first tau in (0, length] where the gap goes through zero away from the allowed side. Touching without
// crossing is no landing. The contact that a bead has just left is divided out with its multiplicity: 2, or more if the
// coefficient of tau^2 is rounding. tau = 0 is returned where nothing is left to find because the path begins by going
// through: a contact at the start, just left or within rounding, whose first coefficient points to the wrong side.
// A crossing within rounding after the end is met at the end. A path that starts on the wrong side lands only after it
// has come back. Of two crossings closer than 2^-30 of a part's length, either is returned.
// The work is bounded; if it was not enough, complete() is false and what was not looked at counts as free of curve.
// A power of two as change of units changes no bit but the scale.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/curve/cover.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::curves {

/// A path in the plane of a curve, own axes: x = sum_k x[k] tau^k, degree at most 24.
struct Flight {
    const double* x;
    const double* y;
    int degree;
    double length;
};

/// Where a flight ends on a curve.
struct Landing {
    double tau, u;
};

class LandingFinder {
public:
    static constexpr int max_path_degree = 24;

    explicit LandingFinder(Curve curve, double period = 0.0) : cover_(std::move(curve), period) {}

    /// `side`: 1 if the bead may be where the gap is positive, -1 where it is negative. `last`: the parameter where the
    /// bead was last on the curve; the result's turn of a closed curve is that of `last`, counted from the beginning of
    /// the domain. `just_left`: the path begins there, with gap and first derivative of the gap zero within rounding.
    std::optional<Landing> first_landing(const Flight& path, int side, double last, bool just_left) {
        complete_ = true;
        visits_ = 0;
        best_ = {std::numeric_limits<double>::infinity(), 0.0};
        if (!scale(path)) return std::nullopt;
        const double period = cover_.period();
        turn_ = period > 0.0 ? std::floor((last - cover_.domain().begin) / period) * period : 0.0;
        side_ = side;
        contact_ = last - turn_;
        just_left_ = just_left;

        nodes_.clear();
        const Box box = bounding(x_.data(), y_.data(), degree_);
        cover_.find(box, nodes_);
        if (nodes_.empty()) return std::nullopt;
        search(0.0, 1.0, 0, 0, nodes_.size());
        if (!(best_.tau <= 1.0)) return std::nullopt;
        return Landing{best_.tau == 1.0 ? path.length : best_.tau * path.length, best_.u + turn_};
    }

    /// Whether the last search looked everywhere.
    bool complete() const { return complete_; }
    const CurveCover& cover() const { return cover_; }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // parts of the path reach a little over each other, so that rounding hides no crossing between them
    static constexpr double overlap = 0x1p-30;
    // a graph is used this far from its middle, and answers for crossings this far
    static constexpr double reach = 1.6, window = 1.0 + 0x1p-30;
    // degree of the gap; beyond it coefficients must be negligible
    static constexpr int gap_degree = 32;
    // a contact of a higher order is not told from a path along the curve
    static constexpr int max_contact = 8;
    static constexpr int max_depth = 50, max_visits = 20000;

    using Path = std::array<double, max_path_degree + 1>;
    using Gap = std::array<double, series::max_degree + 1>;

    /// A part of the path as seen from a graph.
    struct View {
        Path xi, eta;
        int degree;
    };

    /// The path on [0, 1], coefficients that are nothing left out; false if it does not move or is not finite.
    bool scale(const Flight& path) {
        double power = 1.0, motion = 0.0;
        for (int k = 0; k <= path.degree; ++k, power *= path.length) {
            const auto i = static_cast<std::size_t>(k);
            x_[i] = path.x[k] * power;
            y_[i] = path.y[k] * power;
            if (k > 0) motion += std::abs(x_[i]) + std::abs(y_[i]);
        }
        degree_ = path.degree;
        for (double rest = 0.0; degree_ > 0; --degree_) {
            const auto i = static_cast<std::size_t>(degree_);
            rest += std::abs(x_[i]) + std::abs(y_[i]);
            if (rest > 0x1p-62 * motion) break;
        }
        return motion > 0.0 && std::isfinite(motion) && std::isfinite(x_[0]) && std::isfinite(y_[0]);
    }

    static Box bounding(const double* x, const double* y, int degree) {
        const series::Bounds across = series::bounds(x, degree), up = series::bounds(y, degree);
        Box box{across.low, across.high, up.low, up.high};
        box.widen(0x1p-20 * box.size(), 0x1p-20 * box.size());
        return box;
    }

    /// The path on [from, from + width], as polynomials on [0, 1].
    void part(double from, double width, Path& x, Path& y) const {
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

    /// Looks at the path on [begin, begin + width] for crossings of the stretches nodes_[first .. last).
    void search(double begin, double width, int depth, std::size_t first, std::size_t last) {
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

    /// Keeps what of a stretch the part of the path may meet; `divide` if the path is too long for it.
    void meet(int node, const Box& box, const Path& x, const Path& y, bool& divide) {
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
        View view;
        see(g, x, y, 0x1p-58, view);
        const series::Bounds xi = series::bounds(view.xi.data(), view.degree);
        if (xi.low > window || xi.high < -window) return;
        const series::Bounds eta = series::bounds(view.eta.data(), view.degree);
        if (eta.low > g.high || eta.high < g.low) return;
        nodes_.push_back(node);
        if (xi.low < -reach || xi.high > reach) divide = true;
    }

    void see(const Graph& g, const Path& x, const Path& y, double negligible, View& view) const {
        const double scale = 1.0 / g.half, cosine = g.along_x * scale, sine = g.along_y * scale;
        for (int k = 0; k <= degree_; ++k) {
            const auto i = static_cast<std::size_t>(k);
            const double dx = k == 0 ? x[0] - g.x : x[i], dy = k == 0 ? y[0] - g.y : y[i];
            view.xi[i] = dx * cosine + dy * sine;
            view.eta[i] = dy * cosine - dx * sine;
        }
        view.degree = degree_;
        for (double rest = 0.0; view.degree > 0; --view.degree) {
            const auto i = static_cast<std::size_t>(view.degree);
            rest += std::abs(view.xi[i]) + std::abs(view.eta[i]);
            if (rest > negligible) break;
        }
    }

    /// f(xi(s)) up to the degree of a gap, `dropped` bounding the rest; returns its degree.
    static int compose(const double* f, int order, const double* xi, int degree, Gap& out, double& dropped) {
        double size = 0.0;
        std::array<double, max_path_degree + 2> beyond{};  // sum of |xi_j| from j on
        for (int j = degree; j >= 0; --j) {
            size += std::abs(xi[j]);
            beyond[static_cast<std::size_t>(j)] = size;
        }
        Gap now{};
        now[0] = f[order];
        int reached = 0;
        dropped = 0.0;
        for (int k = order - 1; k >= 0; --k) {
            Gap next{};
            const int whole = reached + degree, kept = std::min(whole, gap_degree);
            for (int i = 0; i <= reached; ++i) {
                const double factor = now[static_cast<std::size_t>(i)];
                const int end = std::min(degree, gap_degree - i);
                for (int j = 0; j <= end; ++j) next[static_cast<std::size_t>(i + j)] += factor * xi[j];
            }
            if (dropped > 0.0) dropped *= size;
            if (whole > gap_degree)
                for (int i = gap_degree - degree + 1; i <= reached; ++i)
                    dropped += std::abs(now[static_cast<std::size_t>(i)]) *
                               beyond[static_cast<std::size_t>(gap_degree - i + 1)];
            next[0] += f[k];
            now = next;
            reached = kept;
        }
        out = now;
        return reached;
    }

    /// Looks for crossings of one graph by a part of the path; false if the part is too long to tell.
    bool examine(const CurveCover::Stretch& stretch, const Path& x, const Path& y, double from, double width,
                 bool is_last) {
        const CurveCover::Stretch s = stretch;
        const Graph& g = cover_.graph(s);
        View view;
        // at the start nothing is too small to tell which way the path leaves
        see(g, x, y, from > 0.0 ? 0x1p-58 : 0.0, view);
        Gap gap;
        double dropped = 0.0;
        int degree = compose(g.f.data(), g.order, view.xi.data(), view.degree, gap, dropped);
        if (!is_last && !(dropped <= std::max(0x1p-49, g.noise))) return false;
        degree = std::max(degree, view.degree);
        double motion = 0.0;
        for (int k = 0; k <= degree; ++k) {
            const auto i = static_cast<std::size_t>(k);
            gap[i] = side_ * ((k <= view.degree ? view.eta[i] : 0.0) - gap[i]);
            if (k > 0) motion += std::abs(gap[i]);
        }

        // a contact at the very start, known or within rounding
        int known = 0;
        if (from == 0.0) {
            const double u = contact_near(s);
            const bool here = std::abs(view.xi[0]) <= 1.0 + 0x1p-13;
            if (here && just_left_ && std::isfinite(u)) {
                known = leaving(g, view, s, u, gap, degree);
            } else if (here && std::abs(gap[0]) <= 1e-13 * motion + g.noise) {
                known = leading(g, view, gap, degree, 1, 4e-12);
            }
            if (known > degree) return true;
            if (known > 0 && gap[static_cast<std::size_t>(known)] < 0.0) {
                // begins by going through, if this graph is where it goes
                const bool enters = std::abs(view.xi[0]) < 1.0 - 0x1p-30 || view.xi[0] * view.xi[1] < 0.0;
                if (enters && std::abs(view.xi[0]) <= window)
                    best_ = {0.0, std::isfinite(u) && just_left_ ? u : parameter(g, s, view.xi[0])};
            }
        }

        const double* p = gap.data() + known;
        degree -= known;
        motion = 0.0;
        for (int k = 0; k <= degree; ++k) motion += std::abs(p[k]);
        for (double rest = 0.0; degree > 0; --degree) {
            rest += std::abs(p[degree]);
            if (rest > 0x1p-60 * motion) break;
        }
        if (p[0] != 0.0 && series::keeps_sign(p, degree)) return true;
        roots_.clear();
        finder_.find(p, degree, roots_);
        int before = 0;
        for (int k = 0; k <= degree && before == 0; ++k) before = p[k] > 0.0 ? 1 : p[k] < 0.0 ? -1 : 0;
        for (double root : roots_) {
            before = -before;
            if (before > 0) continue;
            const double xi = series::value(view.xi.data(), view.degree, root);
            if (std::abs(xi) <= window && offer(g, s, p, degree, known, root, xi, motion, from, width)) break;
        }
        return true;
    }

    /// The parameter of the contact if it lies in a stretch or next to it; otherwise not a number.
    double contact_near(const CurveCover::Stretch& s) const {
        const double margin = 0x1p-13 * (s.end - s.begin);
        for (const double shift : {0.0, cover_.period(), -cover_.period()}) {
            const double u = contact_ + shift;
            if (u >= s.begin - margin && u <= s.end + margin) return u;
        }
        return std::numeric_limits<double>::quiet_NaN();
    }

    /// The multiplicity of the contact just left; what is rounding is taken out of the gap. The coefficient of tau^2
    /// comes from the curve's own derivatives, f' = eta'/xi' and f'' = (xi' eta'' - eta' xi'')/xi'^3.
    int leaving(const Graph& g, const View& view, const CurveCover::Stretch& s, double u, Gap& gap, int degree) const {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const double inside = std::clamp(u, std::nextafter(s.begin, infinity), std::nextafter(s.end, -infinity));
        const CurvePoint<double> p = cover_.curve().own(inside);
        const double xi1 = g.along(p.first), eta1 = g.across(p.first);
        const double xi2 = g.along(p.second), eta2 = g.across(p.second);
        const double slope = eta1 / xi1, size = xi1 * xi1 * xi1;
        const double bend = 0.5 * view.xi[1] * view.xi[1] / size;
        const double second = view.degree > 1 ? view.eta[2] - slope * view.xi[2] : 0.0;
        const double terms = view.degree > 1 ? std::abs(view.eta[2]) + std::abs(slope * view.xi[2]) : 0.0;
        gap[0] = gap[1] = 0.0;
        gap[2] = side_ * (second - bend * (xi1 * eta2 - eta1 * xi2));
        const double rounding = 4e-12 * (terms + std::abs(bend * xi1 * eta2) + std::abs(bend * eta1 * xi2));
        if (std::abs(gap[2]) > rounding) return 2;
        return leading(g, view, gap, degree, 3, 1e-10);
    }

    /// The first coefficient of the gap from `order` on that is more than rounding: of its terms, and of points of the
    /// graph.
    static int leading(const Graph& g, const View& view, const Gap& gap, int degree, int order, double rounding) {
        std::array<double, Graph::degree + 1> f;
        Path xi;
        for (std::size_t k = 0; k < f.size(); ++k) f[k] = std::abs(g.f[k]);
        for (std::size_t k = 0; k <= static_cast<std::size_t>(view.degree); ++k) xi[k] = std::abs(view.xi[k]);
        double motion = 0.0;
        for (int k = 1; k <= view.degree; ++k)
            motion += xi[static_cast<std::size_t>(k)] + std::abs(view.eta[static_cast<std::size_t>(k)]);
        // how far derivative m of a polynomial of degree n between -1 and 1 may be wrong if its values are (Markov):
        // T_n^(m)(1) = product of (n^2 - i^2)/(2 i + 1), i < m
        constexpr int n2 = Graph::degree * Graph::degree;
        double floor = 0x1p-58;
        Gap terms;
        double dropped;
        compose(f.data(), g.order, xi.data(), view.degree, terms, dropped);
        for (int m = 0; m <= std::min(degree, max_contact); ++m) {
            const auto i = static_cast<std::size_t>(m);
            const double eta = m <= view.degree ? std::abs(view.eta[i]) : 0.0;
            if (m >= order && std::abs(gap[i]) > rounding * (terms[i] + eta) + floor) return m;
            floor *= motion * (n2 - m * m) / ((2 * m + 1) * (m + 1));
        }
        return degree + 1;
    }

    /// The parameter on the curve itself for a place on a chord.
    double parameter(const Graph& g, const CurveCover::Stretch& s, double xi) const {
        double u = std::clamp(series::value(g.u.data(), g.u_order, xi), s.begin, s.end);
        for (int iteration = 0; iteration < 3; ++iteration) {
            const CurvePoint<double> p = cover_.curve().own(u);
            const double next = std::clamp(u + (xi - g.along_from(p.position)) / g.along(p.first), s.begin, s.end);
            if (next == u || !std::isfinite(next)) break;
            u = next;
        }
        return u;
    }

    /// Takes a crossing as the landing if none is earlier; false if it is beyond the end.
    bool offer(const Graph& g, const CurveCover::Stretch& s, const double* p, int degree, int known, double root,
               double xi, double motion, double from, double width) {
        double slope = 0.0;
        for (int k = degree; k >= 1; --k) slope = slope * root + k * p[k];
        // all of the gap is rounding: the path goes along the curve
        if (!(std::abs(slope) > 2.0 * g.noise + 16.0 * epsilon)) return true;
        const double factor = std::pow(root, known);
        slope = std::abs(slope) * factor;
        Landing found{from + width * root, parameter(g, s, xi)};
        if (!(found.tau < best_.tau + overlap)) return true;

        // well across the curve, and not so near the contact that places are too rough: P(tau) = r(u) itself
        if (slope > 0x1p-20 * motion && factor > 0x1p-4) {
            for (int iteration = 0; iteration < 3; ++iteration) {
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
                const double d_tau = -(ex * r.first[1] - ey * r.first[0]) / across;
                const double d_u = (vx * ey - vy * ex) / across;
                // what is left to gain is small, or the curve is not what its graph says
                if (!(std::abs(d_tau) <= 0x1p-20 * width)) break;
                found = {found.tau + d_tau, std::clamp(found.u + d_u, s.begin, s.end)};
                if (std::abs(d_tau) <= epsilon * found.tau) break;
            }
        }
        if (found.tau > 1.0) {
            const double late = slope > 0.0 ? width * (g.noise + 4.0 * epsilon * motion) / slope : 0.0;
            if (found.tau > 1.0 + std::min(late, overlap * width) + 2.0 * epsilon) return false;
            found.tau = 1.0;
        }
        if (found.tau > 0.0 && found.tau < best_.tau) best_ = found;
        return true;
    }

    CurveCover cover_;
    Path x_, y_;  // the path on [0, 1]
    int degree_ = 0;
    double side_ = 1.0, contact_ = 0.0, turn_ = 0.0;
    bool just_left_ = false, complete_ = true;
    int visits_ = 0;
    Landing best_{};
    std::vector<int> nodes_;
    std::vector<double> roots_;
    series::RootFinder finder_;
};

}  // namespace rbdyn::curves
