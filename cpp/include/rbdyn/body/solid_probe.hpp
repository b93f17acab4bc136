// Polynomials through values at the nodes of a product rule, at other points: what a quadrature takes for granted
// between its own points, held against what is there.
//
// Barycentric interpolation (Berrut and Trefethen, "Barycentric Lagrange interpolation", SIAM Review 46, 2004) along
// one axis after the other, so that a grid of n^3 points costs about 31 n^3 products.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::shapes::detail {

template <std::size_t points>
class Interpolant {
public:
    explicit Interpolant(const std::array<double, points>& node) : node_(node) {
        for (std::size_t i = 0; i < points; ++i) {
            long double product = 1.0L;
            // differences of nodes on [0, 1], by 4 so that the product stays near one
            for (std::size_t j = 0; j < points; ++j)
                if (j != i) product *= 4.0L * (static_cast<long double>(node[i]) - node[j]);
            weight_[i] = static_cast<double>(1.0L / product);
        }
    }

    /// Values at a grid from those at the nodes, the last axis running fastest.
    std::vector<double> at(const std::vector<double>& values, const std::array<std::vector<double>, 3>& place) const {
        std::vector<double> now = values;
        std::array<std::size_t, 3> size{points, points, points}, order{0, 1, 2};
        // the axes with the fewest places first
        std::sort(order.begin(), order.end(),
                  [&](std::size_t a, std::size_t b) { return place[a].size() < place[b].size(); });
        for (const std::size_t axis : order) {
            std::size_t before = 1, after = 1;
            for (std::size_t a = 0; a < axis; ++a) before *= size[a];
            for (std::size_t a = axis + 1; a < 3; ++a) after *= size[a];
            const std::size_t n = place[axis].size();
            std::vector<double> next(before * n * after, 0.0);
            for (std::size_t k = 0; k < n; ++k) {
                const std::array<double, points> share = shares(place[axis][k]);
                for (std::size_t b = 0; b < before; ++b) {
                    double* out = &next[(b * n + k) * after];
                    for (std::size_t j = 0; j < points; ++j) {
                        const double* in = &now[(b * points + j) * after];
                        for (std::size_t i = 0; i < after; ++i) out[i] += share[j] * in[i];
                    }
                }
            }
            size[axis] = n;
            now = std::move(next);
        }
        return now;
    }

private:
    /// What each node contributes at a place.
    std::array<double, points> shares(double place) const {
        std::array<double, points> share{};
        double sum = 0.0;
        for (std::size_t j = 0; j < points; ++j) {
            const double apart = place - node_[j];
            if (apart == 0.0) {
                share.fill(0.0);
                share[j] = 1.0;
                return share;
            }
            sum += share[j] = weight_[j] / apart;
        }
        for (double& s : share) s /= sum;
        return share;
    }

    std::array<double, points> node_, weight_{};
};

}  // namespace rbdyn::inline RBDYN_FORM::shapes::detail
