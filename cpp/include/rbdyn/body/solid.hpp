// A body from its density, by quadrature.
//
//   m = Int rho dtau, m (G - O) = Int rho (P - O) dtau, I_ij = Int rho (|x|^2 delta_ij - x_i x_j) dtau
//                                                                        (as in eqs. 7.28, 7.30b, 7.33 and 7.36)
//
// Over x in a range, y in a range that may depend on x, z in a range that may depend on x and y. Each range is walked
// by x = x0 + (x1 - x0) sin^2(pi t/2), t from 0 to 1, which makes the surface of a ball or of anything rounded as
// smooth as the density itself. In t, products of three Gauss-Kronrod rules of 31 points; cells are halved, the worst
// first and across the axis along which the rules of 15 and 31 points differ most, until the whole is accurate enough.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/body/rigid_body.hpp"

namespace rbdyn::shapes {

/// From, to [m].
using Range = std::array<double, 2>;

/// Where a body's mass lies: ranges of x, of y (a range or a function of x) and of z (a range or a function of x and
/// y).
struct SolidBounds {
    Range x;
    std::function<Range(double)> y;
    std::function<Range(double, double)> z;

    template <class Y, class Z>
    SolidBounds(const Range& x_range, Y y_range, Z z_range) : x(x_range) {
        if constexpr (std::is_invocable_v<Y, double>) {
            y = std::move(y_range);
        } else {
            y = [y_range](double) { return y_range; };
        }
        if constexpr (std::is_invocable_v<Z, double, double>) {
            z = std::move(z_range);
        } else {
            z = [z_range](double, double) { return z_range; };
        }
    }
    SolidBounds(const Range& x_range, const Range& y_range, const Range& z_range)
        : SolidBounds(
              x_range, [y_range](double) { return y_range; }, [z_range](double, double) { return z_range; }) {}
};

/// Densities [kg/m^3] at many points: rows x, y, z.
using Points = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
using DensityAtPoints = std::function<Eigen::ArrayXd(const Points&)>;

namespace detail {

/// The 31 nodes on [0, 1] in increasing order, their weights in both rules; those of 15 points are every other node.
struct SolidRule {
    static constexpr int points = 31;
    std::array<double, points> node, kronrod, gauss{};

    SolidRule() {
        using Kronrod = boost::math::quadrature::gauss_kronrod<double, 31>;
        using Gauss = boost::math::quadrature::gauss<double, 15>;
        for (std::size_t i = 0; i < 16; ++i)
            for (const std::size_t k : {15 - i, 15 + i}) {
                node[k] = 0.5 + (k < 15 ? -0.5 : 0.5) * Kronrod::abscissa()[i];
                kronrod[k] = 0.5 * Kronrod::weights()[i];
                if (i % 2 == 0) gauss[k] = 0.5 * Gauss::weights()[i / 2];
            }
    }
};

/// 1; x, y, z; xx, yy, zz, xy, yz, zx, each times the density, integrated.
using SolidIntegrals = Eigen::Array<double, 10, 1>;

/// A box in the three parameters t.
struct SolidCell {
    std::array<Range, 3> t;
    SolidIntegrals value = SolidIntegrals::Zero(), doubt = SolidIntegrals::Zero();
    int roughest = 0;    // the axis to halve it across
    double worst = 0.0;  // its largest doubt relative to the whole body's integrals
};

/// Halves cells until the sum of their doubts is at most `error` of the body's own sizes.
class SolidQuadrature {
public:
    SolidQuadrature(const DensityAtPoints& density, const SolidBounds& bounds, double error)
        : density_(density), bounds_(bounds), error_(error) {
        const double x = middle(bounds.x), y = middle(bounds.y(x));
        center_ = Vector3(x, y, middle(bounds.z(x, y)));
    }

    MassProperties mass_properties() {
        // 9 million densities: some seconds, and far more than anything smooth needs
        constexpr std::size_t most_cells = 300;
        std::vector<SolidCell> cells{measured({{{0, 1}, {0, 1}, {0, 1}}})};
        const auto milder = [](const SolidCell& a, const SolidCell& b) { return a.worst < b.worst; };
        for (;;) {
            SolidIntegrals sum = SolidIntegrals::Zero(), doubt = SolidIntegrals::Zero();
            for (const SolidCell& c : cells) {
                sum += c.value;
                doubt += c.doubt;
            }
            require(std::isfinite(sum[0]) && sum[0] > 0.0, "solid", "mass", sum[0],
                    "a mass is positive and finite: check the density [kg/m^3] and the order of the bounds");
            const SolidIntegrals scale = scales(sum);
            const double reached = (doubt / scale).maxCoeff();
            if (reached <= error_) return properties(sum);
            require(cells.size() < most_cells, "solid", "relative accuracy reached", reached,
                    "asked for is " + text(error_) +
                        ": if the density jumps, give the bounds of each part as functions "
                        "and add the parts, or give a larger error");
            for (SolidCell& c : cells) c.worst = (c.doubt / scale).maxCoeff();
            // all that carry most of the doubt at once, so that sums over cells are few
            std::sort(cells.begin(), cells.end(), milder);
            const double least = 0.1 * cells.back().worst;
            for (std::size_t k = cells.size(); k-- > 0 && cells[k].worst >= least;) {
                const SolidCell whole = cells[k];
                const auto axis = static_cast<std::size_t>(whole.roughest);
                const double half = middle(whole.t[axis]);
                std::array<Range, 3> low = whole.t, high = whole.t;
                low[axis][1] = high[axis][0] = half;
                cells[k] = measured(low);
                cells.push_back(measured(high));
            }
        }
    }

private:
    static double middle(const Range& r) { return 0.5 * (r[0] + r[1]); }

    /// What each integral is measured by: the mass, and root mean squares of the coordinates.
    static SolidIntegrals scales(const SolidIntegrals& sum) {
        const double m = sum[0];
        const Vector3 r(std::sqrt(std::abs(sum[4] / m)), std::sqrt(std::abs(sum[5] / m)),
                        std::sqrt(std::abs(sum[6] / m)));
        SolidIntegrals s;
        s << 1.0, r[0], r[1], r[2], r[0] * r[0], r[1] * r[1], r[2] * r[2], r[0] * r[1], r[1] * r[2], r[2] * r[0];
        return m * s;
    }

    MassProperties properties(const SolidIntegrals& s) const {
        const Vector3Of<DoubleDouble> g = scaled(widened(Vector3(s[1], s[2], s[3])), DoubleDouble(1.0) / s[0]);
        Matrix3 about_center;
        about_center << s[5] + s[6], -s[7], -s[9], -s[7], s[6] + s[4], -s[8], -s[9], -s[8], s[4] + s[5];
        return {s[0], widened(center_) + g, widened(about_center) - point_inertia(s[0], g)};
    }

    struct Walk {
        double at, weight;
    };
    /// Along a range, at a parameter.
    static Walk walk(const Range& range, double t) {
        const double width = range[1] - range[0], angle = 0.5 * std::numbers::pi * t;
        // from the nearer end, so that the distance to it keeps its digits
        const double s = std::sin(angle), c = std::cos(angle);
        const double at = t < 0.5 ? range[0] + width * s * s : range[1] - width * c * c;
        return {at, width * std::numbers::pi * s * c};
    }
    static Range checked(const Range& r, const char* name) {
        if (std::isfinite(r[0]) && std::isfinite(r[1]) && r[0] <= r[1]) return r;
        for (const double bound : r)
            require(std::isfinite(bound), "solid", std::string("a bound of ") + name, bound,
                    "a bound is finite; give it in m");
        require(false, "solid", std::string("the upper bound of ") + name, r[1],
                "it is not below the lower one, here " + text(r[0]) + ": exchange them");
        return r;
    }

    SolidCell measured(const std::array<Range, 3>& t) const {
        static const SolidRule rule;
        constexpr int n = SolidRule::points;
        const auto at = [&](std::size_t axis, int k) {
            return t[axis][0] + (t[axis][1] - t[axis][0]) * rule.node[static_cast<std::size_t>(k)];
        };
        Points points(3, n * n * n);
        Eigen::ArrayXd weight(n * n * n);
        const double volume = (t[0][1] - t[0][0]) * (t[1][1] - t[1][0]) * (t[2][1] - t[2][0]);
        for (int i = 0, k = 0; i < n; ++i) {
            const Walk x = walk(checked(bounds_.x, "x"), at(0, i));
            const Range y_range = checked(bounds_.y(x.at), "y");
            for (int j = 0; j < n; ++j) {
                const Walk y = walk(y_range, at(1, j));
                const Range z_range = checked(bounds_.z(x.at, y.at), "z");
                for (int l = 0; l < n; ++l, ++k) {
                    const Walk z = walk(z_range, at(2, l));
                    points.col(k) << x.at, y.at, z.at;
                    weight[k] = volume * x.weight * y.weight * z.weight;
                }
            }
        }
        const Eigen::ArrayXd density = density_(points);
        for (Eigen::Index k = 0; k < density.size(); ++k) {
            if (std::isfinite(density[k]) && density[k] >= 0.0) continue;
            require(false, "solid", "density at " + bodies::vector_text(points.col(k)), density[k],
                    "a density is zero or positive and finite; give it in kg/m^3");
        }

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
                    for (const std::size_t a : at_node) share *= rule.kronrod[a];
                    fine += share * f;
                    size += share * f.abs();
                    for (std::size_t a = 0; a < 3; ++a)
                        coarse[a] += share / rule.kronrod[at_node[a]] * rule.gauss[at_node[a]] * f;
                }
        SolidCell cell{t, fine, SolidIntegrals::Zero()};
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

    const DensityAtPoints& density_;
    const SolidBounds& bounds_;
    double error_;
    Vector3 center_;
};

}  // namespace detail

/// A body of density rho(points) [kg/m^3], zero or positive, within bounds; mass, centre of mass and inertia to `error`
/// relative. Throws InvalidInput if that is out of reach, as it is for a density that jumps, and for bounds or
/// densities that are none.
inline RigidBody solid_of_points(const DensityAtPoints& density, const SolidBounds& bounds, double error = 1e-12) {
    // rounding of sums of thousands of terms
    constexpr double least = 1e-14;
    require(error >= least && error < 1.0, "solid", "error", error, "it is from " + text(least) + " to 1");
    return RigidBody(detail::SolidQuadrature(density, bounds, error).mass_properties(), InertiaAbout::com, "solid");
}

/// The same from rho(x, y, z).
template <class Density>
requires std::is_invocable_r_v<double, Density, double, double, double> RigidBody solid(const Density& density,
                                                                                        const SolidBounds& bounds,
                                                                                        double error = 1e-12) {
    return solid_of_points(
        [&density](const Points& p) {
            Eigen::ArrayXd values(p.cols());
            for (Eigen::Index k = 0; k < p.cols(); ++k) values[k] = density(p(0, k), p(1, k), p(2, k));
            return values;
        },
        bounds, error);
}

}  // namespace rbdyn::shapes
