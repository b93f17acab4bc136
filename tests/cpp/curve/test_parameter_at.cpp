// The parameter of a place on a curve, as a landing finder tells it: whatever it looked for before, or nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rbdyn/curve/circle.hpp"
#include "rbdyn/curve/crossing.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/polynomial.hpp"
#include "rbdyn/curve/spline.hpp"

namespace rbdyn::curves::test_parameter_at {
namespace {

TEST(ParameterAt, is_that_of_a_place_that_was_computed_from_it) {
    const Spline hills{.points = {{0, 0, 0}, {1, 0.8, 0}, {2, -0.3, 0}, {3, 0.5, 0}, {4, 0, 0}}};
    const Polynomial slope{.coefficients = {{0, 0, 0}, {1, 0.3, 0}, {0, -0.7, 0}, {0, 0.01, 0}, {0, 0.02, 0}}};
    for (const Curve& curve : {Curve(hills), Curve(slope)}) {
        for (const bool has_searched : {false, true}) {
            LandingFinder finder(curve);
            if (has_searched) {
                const std::vector<double> x{0.1, 900.0}, y{7.0, -1000.0};
                finder.first_landing({x.data(), y.data(), 1, 1.0}, 1, 0.0, false);
            }
            for (double u = 0.03125; u < 3.9; u += 0.1875) {
                const CurvePoint<double> p = curve.own(u);
                EXPECT_NEAR(finder.parameter_at(p.position.x(), p.position.y(), 0.5), u, 1e-14) << curve.name();
            }
        }
    }
}

TEST(ParameterAt, is_on_the_turn_of_the_last_one) {
    const Curve circle(Circle{.radius = 2.0, .start = {1, 0, 0}, .toward = {0, 1, 0}});
    LandingFinder finder(circle, circle.period());
    for (const double turns : {-3.0, 0.0, 5.0})
        for (double u = 0.1; u < 6.2; u += 0.3)
            EXPECT_NEAR(finder.parameter_at(2.0 * std::cos(u), 2.0 * std::sin(u), 1.0 + turns * circle.period()),
                        u + turns * circle.period(), 3e-14);
}

}  // namespace
}  // namespace rbdyn::curves::test_parameter_at
