// Definitions of rbdyn/body/solid.hpp.
#pragma once

#include "rbdyn/body/solid.hpp"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/body/solid_probe.hpp"
#include "rbdyn/body/validation.hpp"

namespace rbdyn::inline RBDYN_FORM::shapes {

RBDYN_INLINE SolidBounds::SolidBounds(const Range& x_range, const Range& y_range, const Range& z_range)
    : SolidBounds(
          x_range, [y_range](double) { return y_range; }, [z_range](double, double) { return z_range; }) {}

}  // namespace rbdyn::inline RBDYN_FORM::shapes

namespace rbdyn::inline RBDYN_FORM::shapes::detail {

RBDYN_INLINE SolidRule::SolidRule() {
    using Kronrod = boost::math::quadrature::gauss_kronrod<double, 31>;
    using Gauss = boost::math::quadrature::gauss<double, 15>;
    for (std::size_t i = 0; i < 16; ++i)
        for (const std::size_t k : {15 - i, 15 + i}) {
            node[k] = 0.5 + (k < 15 ? -0.5 : 0.5) * Kronrod::abscissa()[i];
            kronrod[k] = 0.5 * Kronrod::weights()[i];
            if (i % 2 == 0) gauss[k] = 0.5 * Gauss::weights()[i / 2];
        }
}

RBDYN_INLINE SolidQuadrature::SolidQuadrature(const DensityAtPoints& density, const SolidBounds& bounds, double error)
    : density_(density), bounds_(bounds), error_(error) {
    const double x = middle(bounds.x), y = middle(bounds.y(x));
    center_ = Vector3(x, y, middle(bounds.z(x, y)));
}

RBDYN_INLINE MassProperties SolidQuadrature::mass_properties() {
    // 9 million densities: some seconds, and far more than anything smooth needs
    constexpr std::size_t most_cells = 300;
    std::vector<SolidCell> cells{measured({{{0, 1}, {0, 1}, {0, 1}}})};
    for (;;) {
        SolidIntegrals sum = SolidIntegrals::Zero(), doubt = SolidIntegrals::Zero();
        for (const SolidCell& c : cells) {
            sum += c.value;
            doubt += c.doubt;
        }
        // nothing at the points of the rule need not be nothing
        const bool is_unseen = sum[0] == 0.0 && !all_seen(cells, 0.0);
        require(std::isfinite(sum[0]) && (sum[0] > 0.0 || is_unseen), "solid", "mass", sum[0],
                "a mass is positive and finite: check the density [kg/m^3] and the order of the bounds");
        if (is_unseen) {
            halve(
                cells, [](const SolidCell& c) { return c.unseen; }, most_cells);
            continue;
        }
        const SolidIntegrals scale = scales(sum);
        const double reached = (doubt / scale).maxCoeff();
        if (reached <= error_) {
            if (all_seen(cells, sum[0])) return properties(sum);
            halve(
                cells, [](const SolidCell& c) { return c.unseen; }, most_cells);
            continue;
        }
        require(cells.size() < most_cells, "solid", "relative accuracy reached", reached,
                "asked for is " + text(error_) +
                    ": if the density jumps, give the bounds of each part as functions "
                    "and add the parts, or give a larger error");
        for (SolidCell& c : cells) c.worst = (c.doubt / scale).maxCoeff();
        halve(
            cells, [](const SolidCell& c) { return c.worst; }, most_cells);
    }
}

RBDYN_INLINE bool SolidQuadrature::all_seen(std::vector<SolidCell>& cells, double mass) const {
    double unseen = 0.0;
    for (SolidCell& c : cells) {
        if (!c.density.empty()) look_between(c);
        c.density = {};
        unseen += c.unseen;
    }
    return unseen <= std::max(10.0 * error_, 1e-7) * mass;
}

RBDYN_INLINE void SolidQuadrature::look_between(SolidCell& cell) const {
    const std::array<double, 3> length{cell.t[0][1] - cell.t[0][0], cell.t[1][1] - cell.t[1][0],
                                       cell.t[2][1] - cell.t[2][0]};
    const auto count = [](double least, double wanted) { return static_cast<int>(std::max(least, std::ceil(wanted))); };
    // beside the middle, where much is symmetric
    constexpr double aside = 0.382;
    // multiples of each leave the most even gaps
    constexpr double golden = 0.6180339887498949, silver = 0.41421356237309503;
    const auto evenly = [](int n, double first) {
        std::vector<double> places;
        for (int k = 0; k < n; ++k) places.push_back((k + first) / n);
        return places;
    };
    Between grid, lines;
    std::array<std::vector<double>, 3> place;
    for (std::size_t a = 0; a < 3; ++a) place[a] = evenly(count(20.0, 80.0 * length[a]), aside);
    compare(cell, place, grid, 1.0);
    for (std::size_t along = 0; along < 3; ++along) {
        const std::size_t next = (along + 1) % 3, last = (along + 2) % 3;
        const int points = count(40.0, 500.0 * length[along]);
        const int n = count(9.0, 144.0 * length[next] * length[last]);
        for (int k = 0; k < n; ++k) {
            place[along] = evenly(points, std::fmod((k + aside) * silver, 1.0));
            place[next] = {(k + aside) / n};
            place[last] = {std::fmod((k + aside) * golden, 1.0)};
            compare(cell, place, lines, 1.0 / n);
        }
    }
    lines.mass /= 3.0;
    const Between& found = lines.mass > grid.mass ? lines : grid;
    cell.unseen = found.mass;
    cell.place = found.place;
    cell.contrast = found.contrast;
    if (found.worst > 0.0)
        cell.roughest =
            static_cast<int>(std::max_element(found.change.begin(), found.change.end()) - found.change.begin());
}

RBDYN_INLINE void SolidQuadrature::compare(const SolidCell& cell, const std::array<std::vector<double>, 3>& place,
                                           Between& found, double share) const {
    static const Interpolant<SolidRule::points> interpolant(rule().node);
    const std::vector<double> expected = interpolant.at(cell.density, place);
    std::array<std::vector<double>, 3> t;
    double volume = share / static_cast<double>(expected.size());
    for (std::size_t a = 0; a < 3; ++a) {
        volume *= cell.t[a][1] - cell.t[a][0];
        for (const double x : place[a]) t[a].push_back(cell.t[a][0] + (cell.t[a][1] - cell.t[a][0]) * x);
    }
    const Sample sample = sampled(t);
    const std::array<std::size_t, 3> stride{t[1].size() * t[2].size(), t[2].size(), 1};
    const auto off = [&](std::size_t k) { return sample.density[static_cast<Eigen::Index>(k)] - expected[k]; };
    std::array<double, 3> change{};
    std::size_t k = 0;
    for (std::size_t i = 0; i < t[0].size(); ++i)
        for (std::size_t j = 0; j < t[1].size(); ++j)
            for (std::size_t l = 0; l < t[2].size(); ++l, ++k) {
                const double here = off(k);
                const auto at = static_cast<Eigen::Index>(k);
                found.mass += std::abs(here) * sample.weight[at] * volume;
                if (std::abs(here) > found.worst) {
                    found.worst = std::abs(here);
                    found.place = sample.points.col(at);
                    found.contrast = {sample.density[at], expected[k]};
                }
                if (i > 0) change[0] += std::abs(here - off(k - stride[0]));
                if (j > 0) change[1] += std::abs(here - off(k - stride[1]));
                if (l > 0) change[2] += std::abs(here - off(k - stride[2]));
            }
    for (std::size_t a = 0; a < 3; ++a) found.change[a] += change[a] * static_cast<double>(t[a].size()) * volume;
}

RBDYN_INLINE SolidIntegrals SolidQuadrature::scales(const SolidIntegrals& sum) {
    const double m = sum[0];
    const Vector3 r(std::sqrt(std::abs(sum[4] / m)), std::sqrt(std::abs(sum[5] / m)), std::sqrt(std::abs(sum[6] / m)));
    SolidIntegrals s;
    s << 1.0, r[0], r[1], r[2], r[0] * r[0], r[1] * r[1], r[2] * r[2], r[0] * r[1], r[1] * r[2], r[2] * r[0];
    return m * s;
}

RBDYN_INLINE MassProperties SolidQuadrature::properties(const SolidIntegrals& s) const {
    const Vector3Of<DoubleDouble> g = scaled(widened(Vector3(s[1], s[2], s[3])), DoubleDouble(1.0) / s[0]);
    Matrix3 about_center;
    about_center << s[5] + s[6], -s[7], -s[9], -s[7], s[6] + s[4], -s[8], -s[9], -s[8], s[4] + s[5];
    return {s[0], widened(center_) + g, widened(about_center) - point_inertia(s[0], g)};
}

RBDYN_INLINE SolidQuadrature::Share::Share(double t) {
    const double angle = 0.5 * std::numbers::pi * t, s = std::sin(angle), c = std::cos(angle);
    gone = s * s;
    left = c * c;
    rate = std::numbers::pi * s * c;
}

RBDYN_INLINE double SolidQuadrature::Share::along(const Range& r) const {
    const double width = r[1] - r[0];
    return gone < left ? r[0] + width * gone : r[1] - width * left;
}

RBDYN_INLINE Range SolidQuadrature::checked(const Range& r, const char* name) {
    if (std::isfinite(r[0]) && std::isfinite(r[1]) && r[0] <= r[1]) return r;
    for (const double bound : r)
        require(std::isfinite(bound), "solid", std::string("a bound of ") + name, bound,
                "a bound is finite; give it in m");
    require(false, "solid", std::string("the upper bound of ") + name, r[1],
            "it is not below the lower one, here " + text(r[0]) + ": exchange them");
    return r;
}

RBDYN_INLINE const SolidRule& SolidQuadrature::rule() {
    static const SolidRule rule;
    return rule;
}

RBDYN_INLINE SolidQuadrature::Sample SolidQuadrature::sampled(const std::array<std::vector<double>, 3>& t) const {
    const auto total = static_cast<Eigen::Index>(t[0].size() * t[1].size() * t[2].size());
    Sample s{Points(3, total), Eigen::ArrayXd(total), {}};
    std::array<std::vector<Share>, 3> share;
    for (std::size_t a = 0; a < 3; ++a)
        for (const double place : t[a]) share[a].emplace_back(place);
    const Range x_range = checked(bounds_.x, "x");
    Eigen::Index k = 0;
    for (const Share& by_x : share[0]) {
        const double x = by_x.along(x_range), x_weight = by_x.weight(x_range);
        const Range y_range = checked(bounds_.y(x), "y");
        for (const Share& by_y : share[1]) {
            const double y = by_y.along(y_range), weight = x_weight * by_y.weight(y_range);
            const Range z_range = checked(bounds_.z(x, y), "z");
            for (const Share& by_z : share[2]) {
                s.points(0, k) = x;
                s.points(1, k) = y;
                s.points(2, k) = by_z.along(z_range);
                s.weight[k++] = weight * by_z.weight(z_range);
            }
        }
    }
    s.density = density_(s.points);
    for (k = 0; k < s.density.size(); ++k) {
        if (std::isfinite(s.density[k]) && s.density[k] >= 0.0) continue;
        require(false, "solid", "density at " + bodies::vector_text(s.points.col(k)), s.density[k],
                "a density is zero or positive and finite; give it in kg/m^3");
    }
    return s;
}

RBDYN_INLINE SolidCell SolidQuadrature::measured(const std::array<Range, 3>& t) const {
    constexpr int n = SolidRule::points;
    std::array<std::vector<double>, 3> at;
    for (std::size_t a = 0; a < 3; ++a)
        for (const double node : rule().node) at[a].push_back(t[a][0] + (t[a][1] - t[a][0]) * node);
    const double volume = (t[0][1] - t[0][0]) * (t[1][1] - t[1][0]) * (t[2][1] - t[2][0]);
    const Sample sample = sampled(at);
    const Points& points = sample.points;
    const Eigen::ArrayXd& density = sample.density;
    const Eigen::ArrayXd weight = volume * sample.weight;

    // by the finer rule along all axes, and by the coarser one along each axis in turn
    SolidIntegrals fine = SolidIntegrals::Zero(), size = SolidIntegrals::Zero();
    std::array<SolidIntegrals, 3> coarse{fine, fine, fine};
    for (int i = 0, k = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int l = 0; l < n; ++l, ++k) {
                const std::array<std::size_t, 3> at_node{static_cast<std::size_t>(i), static_cast<std::size_t>(j),
                                                         static_cast<std::size_t>(l)};
                const Vector3 p = Vector3(points.col(k)) - center_;
                SolidIntegrals f;
                f << 1.0, p[0], p[1], p[2], p[0] * p[0], p[1] * p[1], p[2] * p[2], p[0] * p[1], p[1] * p[2],
                    p[2] * p[0];
                f *= density[k] * weight[k];
                double share = 1.0;
                for (const std::size_t a : at_node) share *= rule().kronrod[a];
                fine += share * f;
                size += share * f.abs();
                for (std::size_t a = 0; a < 3; ++a)
                    coarse[a] += share / rule().kronrod[at_node[a]] * rule().gauss[at_node[a]] * f;
            }
    SolidCell cell{t, fine, SolidIntegrals::Zero()};
    cell.density.assign(density.data(), density.data() + density.size());
    double roughest = 0.0;
    for (int a = 0; a < 3; ++a)
        for (int k = 0; k < 10; ++k) {
            if (size[k] == 0.0) continue;
            const double apart = std::abs(fine[k] - coarse[static_cast<std::size_t>(a)][k]) / size[k];
            // the pair's difference squared but for a half: the usual estimate (QUADPACK) for a smooth integrand
            cell.doubt[k] += size[k] * std::min(apart, std::pow(200.0 * apart, 1.5));
            if (apart <= roughest) continue;
            roughest = apart;
            cell.roughest = a;
        }
    return cell;
}

}  // namespace rbdyn::inline RBDYN_FORM::shapes::detail

namespace rbdyn::inline RBDYN_FORM::shapes {

RBDYN_INLINE RigidBody solid_of_points(const DensityAtPoints& density, const SolidBounds& bounds, double error) {
    // rounding of sums of thousands of terms
    constexpr double least = 1e-14;
    require(error >= least && error < 1.0, "solid", "error", error, "it is from " + text(least) + " to 1");
    return RigidBody(detail::SolidQuadrature(density, bounds, error).mass_properties(), InertiaAbout::com, "solid");
}

}  // namespace rbdyn::inline RBDYN_FORM::shapes
