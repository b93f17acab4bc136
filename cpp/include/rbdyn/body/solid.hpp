// A body from its density, by quadrature.
//
//   m = Int rho dtau, m (G - O) = Int rho (P - O) dtau, I_ij = Int rho (|x|^2 delta_ij - x_i x_j) dtau
//                                                                        (as in eqs. 7.28, 7.30b, 7.33 and 7.36)
//
// Over x in a range, y in a range that may depend on x, z in a range that may depend on x and y. Each range is walked
// by x = x0 + (x1 - x0) sin^2(pi t/2), t from 0 to 1, which makes the surface of a ball or of anything rounded as
// smooth as the density itself. In t, products of three Gauss-Kronrod rules of 31 points; cells are halved, the worst
// first and across the axis along which the rules of 15 and 31 points differ most, until the whole is accurate enough.
// What lies between the points of a rule does not show in it: so densities at 700,000 others, a grid of 80 along
// each axis of t and lines of 500 along each at 144 places, no two lines with points at the same t, are held against
// the polynomials through those of the rule, and cells are halved where they differ. A unit of t is at most pi/2 of a
// range: so no cube of a fiftieth of the ranges lies between the points of the grid, no plate across a range of a
// ten-thousandth of it between those of the lines. What is smaller in all directions cannot be found by any such means.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/body/validation.hpp"

namespace rbdyn::inline RBDYN_FORM::shapes {

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
    SolidBounds(const Range& x_range, const Range& y_range, const Range& z_range);
};

/// Densities [kg/m^3] at many points: rows x, y, z.
using Points = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
using DensityAtPoints = std::function<Eigen::ArrayXd(const Points&)>;

namespace detail {

/// The 31 nodes on [0, 1] in increasing order, their weights in both rules; those of 15 points are every other node.
struct SolidRule {
    static constexpr int points = 31;
    std::array<double, points> node, kronrod, gauss{};

    SolidRule();
};

/// 1; x, y, z; xx, yy, zz, xy, yz, zx, each times the density, integrated.
using SolidIntegrals = Eigen::Array<double, 10, 1>;

/// A box in the three parameters t.
struct SolidCell {
    std::array<Range, 3> t;
    SolidIntegrals value = SolidIntegrals::Zero(), doubt = SolidIntegrals::Zero();
    int roughest = 0;    // the axis to halve it across
    double worst = 0.0;  // its largest doubt relative to the whole body's integrals

    std::vector<double> density = {};  // at its nodes, until it is looked at between them
    double unseen = 0.0;               // mass that differs there
    Vector3 place = Vector3::Zero();   // where most, what is there, and what the nodes say
    std::array<double, 2> contrast{0.0, 0.0};
};

/// Halves cells until the sum of their doubts is at most `error` of the body's own sizes.
class SolidQuadrature {
public:
    SolidQuadrature(const DensityAtPoints& density, const SolidBounds& bounds, double error);

    MassProperties mass_properties();

private:
    /// Halves all cells that carry most of something at once, so that sums over cells are few.
    template <class Of>
    void halve(std::vector<SolidCell>& cells, Of of, std::size_t most_cells) const {
        const auto worst = std::max_element(cells.begin(), cells.end(),
                                            [&](const SolidCell& a, const SolidCell& b) { return of(a) < of(b); });
        require(cells.size() < most_cells, "solid", "density at " + bodies::vector_text(worst->place),
                worst->contrast[0],
                "between the points of the rule there are parts that these do not show, " + text(worst->contrast[1]) +
                    " by them: give the bounds of each part as functions and add the parts, or give a larger error");
        const double least = 0.1 * of(*worst);
        for (std::size_t k = cells.size(); k-- > 0;) {
            if (!(of(cells[k]) >= least)) continue;
            const SolidCell whole = cells[k];
            const auto axis = static_cast<std::size_t>(whole.roughest);
            const double half = middle(whole.t[axis]);
            std::array<Range, 3> low = whole.t, high = whole.t;
            low[axis][1] = high[axis][0] = half;
            cells[k] = measured(low);
            cells.push_back(measured(high));
        }
    }

    /// Whether what lies between the nodes is what those say, but for ten times the error of all the mass. Smooth
    /// densities are some 1e-8 off where the rules agree to 1e-12.
    bool all_seen(std::vector<SolidCell>& cells, double mass) const;

    /// What lies between the nodes of a cell: its mass, the largest difference, and how much it changes along each
    /// axis.
    struct Between {
        double mass = 0.0, worst = 0.0;
        Vector3 place = Vector3::Zero();
        std::array<double, 2> contrast{};
        std::array<double, 3> change{};
    };

    /// Looks at a cell between its nodes: a grid, and lines along each axis, all at other places of the others, with
    /// points that together are as close as those of one line of 30,000 at least.
    void look_between(SolidCell& cell) const;
    void compare(const SolidCell& cell, const std::array<std::vector<double>, 3>& place, Between& found,
                 double share) const;

    static double middle(const Range& r) { return 0.5 * (r[0] + r[1]); }

    /// What each integral is measured by: the mass, and root mean squares of the coordinates.
    static SolidIntegrals scales(const SolidIntegrals& sum);

    MassProperties properties(const SolidIntegrals& s) const;

    /// Of a way along a range at a parameter: the share gone, the share left, and the rate.
    struct Share {
        double gone, left, rate;

        explicit Share(double t);
        /// From the nearer end, so that the distance to it keeps its digits.
        double along(const Range& r) const;
        double weight(const Range& r) const { return (r[1] - r[0]) * rate; }
    };
    static Range checked(const Range& r, const char* name);

    static const SolidRule& rule();

    /// Densities on a grid of parameters, the last running fastest, with the volumes that they stand for.
    struct Sample {
        Points points;
        Eigen::ArrayXd weight, density;
    };
    Sample sampled(const std::array<std::vector<double>, 3>& t) const;

    SolidCell measured(const std::array<Range, 3>& t) const;

    const DensityAtPoints& density_;
    const SolidBounds& bounds_;
    double error_;
    Vector3 center_;
};

}  // namespace detail

/// A body of density rho(points) [kg/m^3], zero or positive, within bounds; mass, centre of mass and inertia to `error`
/// relative. Throws InvalidInput if that is out of reach, as it is for a density that jumps, or that has parts which
/// the points of the rule do not show, and for bounds or densities that are none. Not found, by any finite number of
/// densities: parts of less than 1e-7 of the mass, narrower than a fiftieth of the ranges in all directions, or than a
/// ten-thousandth in one of them and not as wide as the ranges in the others.
RigidBody solid_of_points(const DensityAtPoints& density, const SolidBounds& bounds, double error = 1e-12);

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

}  // namespace rbdyn::inline RBDYN_FORM::shapes
