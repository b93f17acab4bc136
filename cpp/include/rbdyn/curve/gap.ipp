// Definitions of rbdyn/curve/gap.hpp.
#pragma once

#include "rbdyn/curve/gap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "rbdyn/curve/cover.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE PathView::PathView(const Graph& g, const PathCoefficients& x, const PathCoefficients& y, int path_degree,
                                double negligible)
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

RBDYN_INLINE double PathView::motion() const {
    double sum = 0.0;
    for (std::size_t k = 1; k <= static_cast<std::size_t>(degree); ++k) sum += std::abs(xi[k]) + std::abs(eta[k]);
    return sum;
}

RBDYN_INLINE Gap::Gap(const Graph& g, const PathView& path, double side) : graph_(g), path_(path), side_(side) {
    degree_ = std::max(compose(g.f.data(), g.order, path.xi.data(), c_, dropped_), path.degree);
    for (int k = 0; k <= degree_; ++k) {
        const auto i = static_cast<std::size_t>(k);
        c_[i] = side * ((k <= path.degree ? path.eta[i] : 0.0) - c_[i]);
    }
}

RBDYN_INLINE double Gap::size(int k) const {
    double sum = 0.0;
    for (; k <= degree_; ++k) sum += std::abs((*this)[k]);
    return sum;
}

RBDYN_INLINE double Gap::rounding(int m, double motion) {
    constexpr int n2 = Graph::degree * Graph::degree;
    double bound = 0x1p-58;
    for (int i = 0; i < m; ++i) bound *= motion * (n2 - i * i) / ((2 * i + 1) * (i + 1));
    return bound;
}

RBDYN_INLINE int Gap::leading(int first, double relative) const {
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

RBDYN_INLINE int Gap::contact(const CurvePoint<double>& p) {
    c_[0] = c_[1] = 0.0;
    if (degree_ >= 2) {
        const double xi1 = graph_.along(p.first), eta1 = graph_.across(p.first);
        const double xi2 = graph_.along(p.second), eta2 = graph_.across(p.second);
        const double slope = eta1 / xi1, factor = 0.5 * path_.xi[1] * path_.xi[1] / (xi1 * xi1 * xi1);
        double sum = 0.0, size = 0.0;
        for (const double term : {path_.degree > 1 ? path_.eta[2] : 0.0, path_.degree > 1 ? -slope * path_.xi[2] : 0.0,
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

RBDYN_INLINE int Gap::compose(const double* f, int order, const double* xi, Coefficients& out, double& dropped) const {
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

}  // namespace rbdyn::inline RBDYN_FORM::curves
