// The nearest and the farthest point of a disc and an ellipsoid: against what makes it so, and against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/nearest_point.hpp"

namespace rbdyn::test::test_nearest_point {
namespace {

using mechanics::NearestPoint;
namespace nearest = mechanics::nearest;

std::array<nearest::Led<double>, 3> along_axes(const Vector3& semi_axes, const Vector3& omega) {
    std::array<nearest::Led<double>, 3> axes;
    for (int k = 0; k < 3; ++k) {
        const Vector3 e = semi_axes[k] * Vector3::Unit(k);
        axes[static_cast<std::size_t>(k)] = {e, omega.cross(e)};
    }
    return axes;
}

/// The place on the surface, and whether the line from there to the centre is along its normal.
void is_stationary(const Vector3& semi_axes, const Vector3& apart, const NearestPoint<double>& found) {
    // at -s from the centre of the ellipsoid; the surface's normal there is (x_i/a_i^2)
    const Vector3 x = -found.s;
    const Vector3 inverse = semi_axes.cwiseInverse(),
                  normal = x.cwiseProduct(inverse.cwiseProduct(inverse)).normalized();
    EXPECT_NEAR(x.cwiseProduct(inverse).norm(), 1.0, 1e-14);
    const Vector3 d = apart - found.s;
    EXPECT_NEAR(d.norm(), found.far, 1e-14 * found.far);
    EXPECT_LT(d.normalized().cross(normal).norm(), 1e-13);
}

TEST(NearestPoint, of_an_ellipsoid_lies_along_a_normal) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (const double aspect : {1.0, 3.0, 30.0, 300.0})
        for (int k = 0; k < 300; ++k) {
            const Vector3 semi_axes(1.0, std::pow(aspect, 0.5 * (1.0 + any(random))), aspect);
            const Vector3 p = Vector3(any(random), any(random), any(random)).normalized();
            const Vector3 x = semi_axes.cwiseProduct(p), normal = p.cwiseQuotient(semi_axes).normalized();
            const double outside = aspect * std::pow(10.0, 2.0 * any(random));
            // the centre of the surface lies across the normal from x, which is -s
            const Vector3 apart = -(x + normal * outside);
            const auto near = nearest::OfEllipsoid(semi_axes, outside, false)
                                  .of<double>(along_axes(semi_axes, Vector3::Zero()), {apart, Vector3::Zero()});
            is_stationary(semi_axes, apart, near);
            EXPECT_NEAR(near.far, outside, 1e-13 * (outside + aspect));
            const double bowl = 1.5 * aspect * aspect;
            const Vector3 within = -(x - normal * bowl);
            const auto far = nearest::OfEllipsoid(semi_axes, bowl, true)
                                 .of<double>(along_axes(semi_axes, Vector3::Zero()), {within, Vector3::Zero()});
            is_stationary(semi_axes, within, far);
            EXPECT_NEAR(far.far, bowl, 1e-13 * bowl);
        }
}

TEST(NearestPoint, has_all_digits_in_pairs_of_doubles) {
    const Vector3 semi_axes(0.3, 0.5, 0.7), apart(-0.9, 0.4, -0.8);
    std::array<nearest::Led<DoubleDouble>, 3> axes;
    for (int k = 0; k < 3; ++k)
        axes[static_cast<std::size_t>(k)].value = widened(Vector3(semi_axes[k] * Vector3::Unit(k)));
    const auto found = nearest::OfEllipsoid(semi_axes, 0.2, false).of<DoubleDouble>(axes, {widened(apart), {}});
    DoubleDouble sum(-1.0);
    for (int k = 0; k < 3; ++k) {
        const DoubleDouble one = found.s[k] / DoubleDouble(semi_axes[k]);
        sum += one * one;
    }
    EXPECT_LT(std::abs(static_cast<double>(sum)), 1e-30);
}

/// s moves as its rate says: differences over a small time.
TEST(NearestPoint, moves_as_its_rate_says) {
    const Vector3 semi_axes(0.3, 0.5, 0.7), omega(0.4, -0.7, 1.1), velocity(0.3, 0.2, -0.5);
    const auto turned = [&](const Vector3& v, double t) {
        return Vector3(Eigen::AngleAxisd(omega.norm() * t, omega.normalized()) * v);
    };
    const auto at = [&](double t, int kind) {
        const bool is_farthest = kind % 2 == 1;
        const Vector3 from = is_farthest ? Vector3(0.5, -0.3, 0.9) : Vector3(-0.9, 0.4, -0.8);
        const nearest::Led<double> apart{from + velocity * t, velocity};
        if (kind < 2) {
            auto axes = along_axes(semi_axes, Vector3::Zero());
            for (auto& e : axes) {
                e.value = turned(e.value, t);
                e.rate = omega.cross(e.value);
            }
            return nearest::OfEllipsoid(semi_axes, is_farthest ? 3.0 : 0.2, is_farthest).of<double>(axes, apart);
        }
        const Vector3 normal = turned(Vector3(0.0, 0.6, 0.8), t);
        return nearest::of_disc<double>({normal, omega.cross(normal)}, kind == 4 ? 5.0 : 0.3, apart, is_farthest);
    };
    // of an ellipsoid and of a rim the nearest and the farthest point, and of a face the nearest one
    for (int kind = 0; kind < 5; ++kind) {
        const double h = 1e-4;
        const Vector3 slope = (at(h, kind).s - at(-h, kind).s) / (2.0 * h);
        EXPECT_LT((slope - at(0.0, kind).s_rate).norm(), 1e-7) << kind;
        EXPECT_GT(at(0.0, kind).s_rate.norm(), 1e-2);
    }
}

/// In a bowl that is far away it tells the distance itself, also where two points are as far.
TEST(NearestPoint, tells_the_distance_deep_in_a_bowl) {
    const Vector3 semi_axes(0.3, 0.5, 0.7);
    const nearest::OfEllipsoid of(semi_axes, 3.0, true);
    for (const Vector3& apart :
         {Vector3(0, 0, 0), Vector3(0.05, -0.02, 0.0), Vector3(0.0, 0.0, 0.2), Vector3(0.1, 0.2, 0.3)}) {
        double most = 0.0;
        for (int i = 0; i <= 400; ++i)
            for (int k = 0; k < 800; ++k) {
                const double polar = std::numbers::pi * i / 400, round = 2.0 * std::numbers::pi * k / 800;
                const Vector3 x(0.3 * std::sin(polar) * std::cos(round), 0.5 * std::sin(polar) * std::sin(round),
                                0.7 * std::cos(polar));
                most = std::max(most, (x + apart).norm());
            }
        EXPECT_NEAR(of.of<double>(along_axes(semi_axes, Vector3::Zero()), {apart, Vector3::Zero()}).far, most, 2e-5);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_nearest_point
