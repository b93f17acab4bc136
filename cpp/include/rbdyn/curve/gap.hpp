// The gap between a path and a graph over a chord, as a polynomial in time.
//
//   G(s) = side (eta(s) - f(xi(s))) = sum_k G_k s^k,   0 <= s <= 1 along a part of the path
//
// in the coordinates of the graph (curve/cover.hpp). G has the sign and the zeros, with their multiplicity, of the
// distance along the normal. The composition is cut off at degree 32; `dropped` bounds the rest on [0, 1].
//
// What is rounding in a coefficient of order m: a fraction of its terms, and derivative m of a polynomial whose values
// are rounded; by Markov's inequality that is up to T_n^(m)(1) = product of (n^2 - i^2)/(2 i + 1), i < m, times the
// rounding of the values, near the ends of a graph of degree n.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "rbdyn/curve/cover.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::curves {

/// Highest degree of a path.
inline constexpr int max_path_degree = 24;
using PathCoefficients = std::array<double, max_path_degree + 1>;

/// A part of a path as seen from a graph.
struct PathView {
    PathCoefficients xi, eta;
    int degree;

    /// Coefficients at the end whose sum is at most `negligible` are left out.
    PathView(const Graph& g, const PathCoefficients& x, const PathCoefficients& y, int path_degree, double negligible)
        : degree(path_degree) {
        const double cosine = g.along_x / g.half, sine = g.along_y / g.half;
        for (int k = 0; k <= degree; ++k) {
            const auto i = static_cast<std::size_t>(k);
            const double dx = k == 0 ? x[0] - g.x : x[i], dy = k == 0 ? y[0] - g.y : y[i];
            xi[i] = dx * cosine + dy * sine;
            eta[i] = dy * cosine - dx * sine;
        }
        for (double rest = 0.0; degree > 0; --degree) {
            const auto i = static_cast<std::size_t>(degree);
            rest += std::abs(xi[i]) + std::abs(eta[i]);
            if (rest > negligible) break;
        }
    }
    /// Bounds how far the path goes, in half chords.
    double motion() const {
        double sum = 0.0;
        for (std::size_t k = 1; k <= static_cast<std::size_t>(degree); ++k) sum += std::abs(xi[k]) + std::abs(eta[k]);
        return sum;
    }
};

class Gap {
public:
    static constexpr int max_degree = 32;
    // a contact of a higher order is not told from a path along the curve
    static constexpr int max_contact = 8;

    Gap(const Graph& g, const PathView& path, double side) : graph_(g), path_(path), side_(side) {
        degree_ = std::max(compose(g.f.data(), g.order, path.xi.data(), c_, dropped_), path.degree);
        for (int k = 0; k <= degree_; ++k) {
            const auto i = static_cast<std::size_t>(k);
            c_[i] = side * ((k <= path.degree ? path.eta[i] : 0.0) - c_[i]);
        }
    }

    int degree() const { return degree_; }
    double dropped() const { return dropped_; }
    double operator[](int k) const { return c_[static_cast<std::size_t>(k)]; }
    const double* from(int k) const { return c_.data() + k; }
    /// Sum of the sizes of the coefficients from order k on.
    double size(int k) const {
        double sum = 0.0;
        for (; k <= degree_; ++k) sum += std::abs((*this)[k]);
        return sum;
    }

    /// What the rounding of f makes of the coefficient of order m, if the path goes as far as `motion`.
    static double rounding(int m, double motion) {
        constexpr int n2 = Graph::degree * Graph::degree;
        double bound = 0x1p-58;
        for (int i = 0; i < m; ++i) bound *= motion * (n2 - i * i) / ((2 * i + 1) * (i + 1));
        return bound;
    }

    /// The first order from `first` on whose coefficient is more than rounding, `relative` that of its terms; a number
    /// above the degree if there is none.
    int leading(int first, double relative) const {
        std::array<double, Graph::degree + 1> f;
        PathCoefficients xi;
        for (std::size_t k = 0; k < f.size(); ++k) f[k] = std::abs(graph_.f[k]);
        for (std::size_t k = 0; k <= static_cast<std::size_t>(path_.degree); ++k) xi[k] = std::abs(path_.xi[k]);
        Coefficients terms;
        double dropped;
        compose(f.data(), graph_.order, xi.data(), terms, dropped);
        const double motion = path_.motion();
        for (int m = first; m <= std::min(degree_, max_contact); ++m) {
            const auto i = static_cast<std::size_t>(m);
            const double size = terms[i] + (m <= path_.degree ? std::abs(path_.eta[i]) : 0.0);
            // turning the path into the axes of the chord has mixed its coefficients
            const double mixed = m <= path_.degree ? 16.0 * epsilon * std::abs(path_.xi[i]) : 0.0;
            if (std::abs(c_[i]) > relative * size + rounding(m, motion) + mixed) return m;
        }
        return degree_ + 1;
    }

    /// The order of a contact at s = 0 that is known to be at least 2, where the curve is at p: what is rounding is
    /// taken out. The coefficient of s^2 comes from the curve's own derivatives by u,
    ///   f' = eta'/xi',  f'' = (xi' eta'' - eta' xi'')/xi'^3.
    /// Where a reaction has just come to zero that coefficient is zero, too, and rounding may give it either sign: what
    /// would lead back through the curve and is next to nothing beside all that follows is none.
    int contact(const CurvePoint<double>& p) {
        c_[0] = c_[1] = 0.0;
        if (degree_ >= 2) {
            const double xi1 = graph_.along(p.first), eta1 = graph_.across(p.first);
            const double xi2 = graph_.along(p.second), eta2 = graph_.across(p.second);
            const double slope = eta1 / xi1, factor = 0.5 * path_.xi[1] * path_.xi[1] / (xi1 * xi1 * xi1);
            double sum = 0.0, size = 0.0;
            for (const double term :
                 {path_.degree > 1 ? path_.eta[2] : 0.0, path_.degree > 1 ? -slope * path_.xi[2] : 0.0,
                  -factor * xi1 * eta2, factor * eta1 * xi2}) {
                sum += term;
                size += std::abs(term);
            }
            c_[2] = side_ * sum;
            if (path_.degree > 1) size += 16.0 * epsilon / 4e-12 * std::abs(path_.xi[2]);
            if (std::abs(sum) > 4e-12 * size && !is_next_to_nothing(2)) return 2;
        }
        int order = leading(3, 1e-10);
        while (order <= degree_ && is_next_to_nothing(order)) order = leading(order + 1, 1e-10);
        return order;
    }

private:
    using Coefficients = std::array<double, series::max_degree + 1>;
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    bool is_next_to_nothing(int m) const { return (*this)[m] < 0.0 && -(*this)[m] <= 1e-9 * size(m + 1); }

    /// f(xi(s)) up to max_degree, `dropped` bounding the rest; returns its degree.
    int compose(const double* f, int order, const double* xi, Coefficients& out, double& dropped) const {
        const int degree = path_.degree;
        double size = 0.0;
        std::array<double, max_path_degree + 2> beyond{};  // sum of |xi_j| from j on
        for (int j = degree; j >= 0; --j) {
            size += std::abs(xi[j]);
            beyond[static_cast<std::size_t>(j)] = size;
        }
        out = {};
        out[0] = f[order];
        int reached = 0;
        dropped = 0.0;
        for (int k = order - 1; k >= 0; --k) {
            Coefficients next{};
            dropped *= size;
            for (int i = 0; i <= reached; ++i) {
                const double factor = out[static_cast<std::size_t>(i)];
                const int end = std::min(degree, max_degree - i);
                for (int j = 0; j <= end; ++j) next[static_cast<std::size_t>(i + j)] += factor * xi[j];
                if (end < degree) dropped += std::abs(factor) * beyond[static_cast<std::size_t>(end + 1)];
            }
            next[0] += f[k];
            out = next;
            reached = std::min(reached + degree, max_degree);
        }
        return reached;
    }

    const Graph& graph_;
    const PathView& path_;
    double side_;
    Coefficients c_;
    int degree_;
    double dropped_;
};

}  // namespace rbdyn::curves
