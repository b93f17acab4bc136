// Arc length and its inverse against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/curve/arc_length.hpp"
#include "rbdyn/curve/curve.hpp"

namespace rbdyn::test::test_length {

namespace {

// sums of 31 rounded terms a piece: a few units in the last place
constexpr double relative = 1e-14;

/// Arc length of (u, a u^2) from its vertex.
long double parabola(long double a, long double u) {
    const long double w = 2.0L * a * u;
    return (w * std::sqrt(1.0L + w * w) + std::asinh(w)) / (4.0L * a);
}

/// Arc length of (u^2, u^3) from its cusp, signed.
long double cuspidal_cubic(long double u) {
    return std::copysign((std::pow(4.0L + 9.0L * u * u, 1.5L) - 8.0L) / 27.0L, u);
}

void expect_length(const Curve& curve, double u0, double u1, long double exact) {
    const double reference = static_cast<double>(exact);
    EXPECT_NEAR(curve.length(u0, u1), reference, relative * std::abs(reference)) << u0 << " to " << u1;
    EXPECT_EQ(curve.length(u1, u0), -curve.length(u0, u1));
}

TEST(CurveLength, a_helix_is_as_long_as_the_line_on_the_unrolled_cylinder) {
    const Curve helix = Helix{.radius = 3.0, .pitch = 4.0, .start = {0, 1, 0}, .toward = {0, 0, 1}};
    const long double turn = 2.0L * std::acos(-1.0L);
    for (double turns : {1e-9, 0.3, 1.0, 1e6}) {
        const auto u = static_cast<double>(turns * turn);
        expect_length(helix, 0.0, u, u / turn * std::hypot(3.0L * turn, 4.0L));
    }
}

TEST(CurveLength, a_circle_is_as_long_as_its_angle_says_round_after_round) {
    const Curve circle = Circle{.radius = 0.3, .start = {1, 1, 0}, .toward = {0, 0, 1}};
    expect_length(circle, -1.0, 1e6, 0.3L * 1000001.0L);
    EXPECT_TRUE(circle.closed());
}

TEST(CurveLength, a_parabola_is_as_long_as_the_closed_form_says) {
    const Curve curve = Polynomial{.coefficients = {{1, 2, 3}, {0, 1, 0}, {0, 0, 0.5}}};
    for (double u : {1e-9, 1e-3, 1.0, 30.0, 1e6}) {
        expect_length(curve, 0.0, u, parabola(0.5L, u));
        expect_length(curve, -u, 2.0 * u, parabola(0.5L, u) + parabola(0.5L, 2.0L * u));
    }
    // a short stretch far out, where the difference of two closed forms would have lost its digits
    const double middle = std::sqrt(1.0 + 1e12);
    EXPECT_NEAR(curve.length(1e6 - 0.0625, 1e6 + 0.0625), 0.125 * middle, relative * 0.125 * middle);
}

TEST(CurveLength, a_tilted_parabola_is_as_long_as_an_upright_one) {
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {0.6, 0.48, 0.64}, {-0.4, 0.18, 0.24}}};
    expect_length(curve, -1.0, 2.0, parabola(0.5L, 1.0L) + parabola(0.5L, 2.0L));
}

TEST(CurveLength, a_parabola_almost_folded_on_itself_keeps_its_length) {
    // |r'| falls to 1e-7 of its size at u = 0 and has a corner there to any coarser eye
    const long double width = 1e-7L;
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {1e-7, 0, 0}, {0, 1, 0}}};
    const auto from_vertex = [&](long double u) { return width * parabola(1.0L / width, u); };
    expect_length(curve, -1.0, 2.0, from_vertex(1.0L) + from_vertex(2.0L));
}

TEST(CurveLength, a_curve_is_measured_through_its_cusp) {
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    expect_length(curve, -1.0, 2.0, cuspidal_cubic(1.0L) + cuspidal_cubic(2.0L));
    // the same curve with its cusp at u = 1, where expanded coefficients cancel
    const Curve shifted = Polynomial{.coefficients = {{1, -1, 0}, {-2, 3, 0}, {1, -3, 0}, {0, 1, 0}}};
    expect_length(shifted, 0.0, 3.0, cuspidal_cubic(1.0L) + cuspidal_cubic(2.0L));
    EXPECT_NEAR(shifted.length(1.0, 1.0 + 1e-6), 1e-12, 1e-14);
}

TEST(CurveLength, going_there_and_back_on_a_line_counts_both_ways) {
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 2, 2}}};
    expect_length(curve, -1.0, 2.0, 15.0L);
}

TEST(CurveLength, a_turning_point_is_counted_wherever_it_falls_among_the_points_of_the_quadrature) {
    // 3 u^2 along a line turns at u = 0: near the end of the range, near its middle, and in between
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 2, 2}}};
    for (int k = 0; k < 500; ++k) {
        const double small = std::pow(10.0, -k / 50.0), plain = k / 500.0;
        for (double end : {small, 1.0 - 0.9 * small, 1.0 + small, plain})
            expect_length(curve, -1.0, end, 3.0L * (1.0L + static_cast<long double>(end) * end));
    }
}

TEST(CurveLength, the_parameter_at_an_arc_length_inverts_the_arc_length) {
    const std::vector<Curve> curves{
        Line{.direction = {1, 2, 3}, .point = {1, 1, 1}},
        Circle{.radius = 0.3, .start = {1, 1, 0}, .toward = {0, 0, 1}},
        Helix{.radius = 2.0, .pitch = -0.7, .start = {1, 0, 0}, .toward = {1, 1, 0}},
        Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
        Polynomial{.coefficients = {{0, 0, 0}, {1e-7, 0, 0}, {0, 1, 0}}},
        Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
        Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 3, 1}}},
    };
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    for (const Curve& curve : curves)
        for (double u0 : {0.0, -1.25, 7.0})
            for (double s : {1e-12, 1e-3, 0.5, 4.0, 1e4, -1e-3, -0.5, -4.0, -1e4}) {
                const double u = curve.parameter_at(u0, s);
                // what rounding of the parameter makes of the length, and of the sum
                const double rounding = 4.0 * epsilon * (std::abs(s) + std::abs(u) * curve.first(u).norm());
                EXPECT_NEAR(curve.length(u0, u), s, rounding) << curve.name() << " from " << u0 << " by " << s;
            }
}

TEST(CurveLength, an_arc_length_that_ends_on_a_cusp_is_found) {
    const Curve curve = Polynomial{.coefficients = {{1, -1, 0}, {-2, 3, 0}, {1, -3, 0}, {0, 1, 0}}};
    const double to_cusp = curve.length(0.0, 1.0);
    // |r'| vanishes there: the length is flat and fixes the parameter to half its digits
    EXPECT_NEAR(curve.parameter_at(0.0, to_cusp), 1.0, 4e-8);
    EXPECT_GT(curve.parameter_at(0.0, 1.1 * to_cusp), 1.0);
}

TEST(CurveLength, a_curve_with_ends_is_not_left) {
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {3, 0, 0}}, .domain = {-1.0, 1.0}};
    EXPECT_EQ(curve.parameter_at(0.0, 3.0), 1.0);
    EXPECT_EQ(curve.parameter_at(0.0, -3.0), -1.0);
    try {
        curve.parameter_at(0.0, 3.5);
        FAIL() << "went past the end";
    } catch (const rbdyn::InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("3.5"), std::string::npos) << error.what();
    }
}

TEST(CurveLength, a_length_that_is_infinite_or_unknown_is_an_error) {
    const auto diverging = [](double u) { return 1.0 / std::abs(u - 0.3); };
    EXPECT_THROW(rbdyn::curves::arc_length(diverging, 0.0, 1.0, 0.0, "test"), rbdyn::Error);
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    EXPECT_THROW(curve.length(0.0, 1e300), rbdyn::Error);
    EXPECT_THROW(curve.length(0.0, std::numeric_limits<double>::infinity()), rbdyn::InvalidInput);
    EXPECT_THROW(curve.parameter_at(0.0, std::nan("")), rbdyn::InvalidInput);
}

// s = 4 R sin(u/2) on a cycloid, R u on a circle, hypot(R, h) u on a helix; on a parabola 4 a s = w q + asinh w
TEST(CurveLength, a_start_at_an_arc_length_is_known_to_more_than_doubles) {
    const double radius = 0.37, s = 0.83;
    const auto off = [](const DoubleDouble& found, const DoubleDouble& expected) {
        return std::abs((found - expected).hi) / std::abs(expected.hi);
    };
    const Vector3 x(1, 0, 0), y(0, 1, 0);
    const DoubleDouble R = radius, l = s;
    // long double knows the length to 1e-19 of itself
    constexpr double known = 4e-19;
    const Curve circle = Circle{.radius = radius, .start = x, .toward = y};
    EXPECT_LE(off(circle.exact_parameter_at(0.0, s), l / R), known);
    const Curve cycloid = Cycloid{.radius = radius, .x = x, .y = y};
    EXPECT_LE(off(cycloid.exact_parameter_at(0.0, s), 2.0 * asin(l / (4.0 * R))), known);
    const Curve helix = Helix{.radius = radius, .pitch = 0.9, .start = x, .toward = y};
    const DoubleDouble h = DoubleDouble(0.9) / (2.0 * double_double::pi);
    EXPECT_LE(off(helix.exact_parameter_at(0.0, s), l / sqrt(R * R + h * h)), known);
    const Curve bent = Parabola{.a = 0.7, .x = x, .y = y};
    const DoubleDouble u = bent.exact_parameter_at(0.0, s), w = DoubleDouble(1.4) * u, q = sqrt(1.0 + w * w);
    EXPECT_LE(off((w * q + log(w + q)) / DoubleDouble(2.8), l), known);
}

}  // namespace

}  // namespace rbdyn::test::test_length
