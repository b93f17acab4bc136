// Parabola and cycloid against closed forms in extended precision, near the cusps above all.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::test::test_parabola_cycloid {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr long double pi = std::numbers::pi_v<long double>;

// y downward-upward: x along world x, y along world z
Parabola parabola(double a) { return {.a = a, .x = {1, 0, 0}, .y = {0, 0, 1}}; }
Cycloid cycloid(double radius) { return {.radius = radius, .x = {1, 0, 0}, .y = {0, 0, 1}}; }

/// Arc length of (u, a u^2) from its vertex.
long double parabola_length(long double a, long double u) {
    const long double w = 2.0L * a * u;
    return (w * std::sqrt(1.0L + w * w) + std::asinh(w)) / (4.0L * a);
}

void expect_equal(double value, long double exact, double ulps, const char* what) {
    EXPECT_NEAR(value, static_cast<double>(exact), ulps * epsilon * static_cast<double>(std::abs(exact))) << what;
}

TEST(Parabola, has_the_frame_and_curvature_of_its_formula) {
    for (const double a : {0.75, -2.0, 1e-6, 1e9})
        for (const double u : {-3.0, 0.0, 1e-9, 0.4, 1e4}) {
            const Curve curve = parabola(a);
            const long double w = 2.0L * a * u, q = std::sqrt(1.0L + w * w), side = a > 0.0 ? 1.0L : -1.0L;
            const Frenet f = curve.frenet(u);
            SCOPED_TRACE(testing::Message() << a << " at " << u);
            expect_equal(curve.position(u).z(), static_cast<long double>(a) * u * u, 2, "height");
            expect_equal(f.tangent.x(), 1.0L / q, 4, "tangent");
            expect_equal(f.tangent.z(), w / q, 4, "tangent");
            expect_equal(f.normal.x(), -side * w / q, 4, "normal");
            expect_equal(f.normal.z(), side / q, 4, "normal");
            expect_equal(curve.curvature(u), 2.0L * std::abs(static_cast<long double>(a)) / (q * q * q), 8,
                         "curvature");
            EXPECT_EQ(curve.torsion(u), 0.0);
        }
}

TEST(Parabola, is_as_long_as_the_closed_form_says_also_over_short_stretches_far_out) {
    for (const double a : {0.5, -0.5, 3e-4}) {
        const Curve curve = parabola(a);
        for (const double u : {1e-12, 1e-3, 1.0, 30.0, 1e6}) {
            expect_equal(curve.length(0.0, u), parabola_length(a, u), 2, "from the vertex");
            expect_equal(curve.length(-u, 2.0 * u), parabola_length(a, u) + parabola_length(a, 2.0L * u), 2, "across");
            EXPECT_EQ(curve.length(2.0 * u, -u), -curve.length(-u, 2.0 * u));
            EXPECT_NEAR(curve.parameter_at(0.0, curve.length(0.0, u)), u, 4 * epsilon * u);
        }
        // |r'| at the middle, to a relative 1e-12 here
        const double u = 1e6, w = 2.0 * a * u;
        expect_equal(curve.length(u - 0x1p-20, u + 0x1p-20), 0x1p-19L * std::sqrt(1.0L + w * w), 4, "short");
    }
}

TEST(Cycloid, has_the_frame_and_curvature_of_its_formula_up_to_its_cusps) {
    const double R = 0.75;
    const Curve curve = cycloid(R);
    for (const double u : {0.0, 0.3, -2.0, 3.0, 3.1415926, 3.1415927, 9.42477, 100.0, -1e4}) {
        SCOPED_TRACE(u);
        const long double c = std::cos(0.5L * u), s = std::sin(0.5L * u), way = c > 0.0L ? 1.0L : -1.0L;
        const Frenet f = curve.frenet(u);
        EXPECT_NEAR(curve.position(u).x(), static_cast<double>(R * (u + std::sin(1.0L * u))),
                    2 * epsilon * R * (1 + std::abs(u)));
        EXPECT_NEAR(curve.position(u).z(), static_cast<double>(R * 2.0L * s * s), 4 * epsilon * R);
        // cos(u/2) itself, with the error of half a unit that a sine of doubles has
        const double near = 8 * epsilon;
        EXPECT_NEAR(f.tangent.x(), static_cast<double>(way * c), near * std::abs(static_cast<double>(c)));
        EXPECT_NEAR(f.tangent.z(), static_cast<double>(way * s), near);
        EXPECT_EQ(f.binormal, -Vector3::UnitY());
        expect_equal(curve.curvature(u), 1.0L / (4.0L * R * std::abs(c)), 16, "curvature");
        EXPECT_EQ(curve.torsion(u), 0.0);
        const auto p = curve.own(u);
        expect_equal(p.speed_squared, 4.0L * R * R * c * c, 8, "|r'|^2");
        expect_equal(p.first_dot_second, -2.0L * R * R * c * s, 8, "r'.r''");
        expect_equal(p.first_cross_second.z(), 2.0L * R * R * c * c, 8, "r' x r''");
    }
}

TEST(Cycloid, has_no_tangent_at_its_cusps_and_only_there) {
    const Curve curve = cycloid(2.0);
    for (int k = -9; k <= 9; k += 2) {
        const double cusp = k * std::numbers::pi;
        EXPECT_THROW(curve.frenet(cusp), InvalidInput) << k;
        EXPECT_THROW(curve.curvature(cusp), InvalidInput) << k;
        EXPECT_NO_THROW(curve.frenet(cusp * (1.0 + 1e-14))) << k;
        EXPECT_NO_THROW(curve.frenet(cusp + std::numbers::pi)) << k;
        EXPECT_LT((curve.position(cusp) - Vector3(2.0 * cusp, 0.0, 4.0)).norm(), 64 * epsilon);
    }
}

TEST(Cycloid, has_arches_of_eight_radii) {
    const double R = 0.5, arch = 2.0 * std::numbers::pi;
    const Curve curve = cycloid(R);
    expect_equal(curve.length(-std::numbers::pi, std::numbers::pi), 8.0L * R, 1, "arch");
    expect_equal(curve.length(0.0, arch), 8.0L * R, 2, "across a cusp");
    // ends that are no multiples of pi in doubles miss them by a rounding
    for (int n : {1, 2, 7, 1000}) expect_equal(curve.length(0.3, 0.3 + n * arch), 8.0L * R * n, 8, "arches");
    for (const double u : {1e-9, 0.3, 2.0, 3.0, 3.14159})
        expect_equal(curve.length(0.0, u), 4.0L * R * std::sin(0.5L * u), 1, "from the vertex");
    // 4 R (2 - sin) across the cusp
    for (const double u : {3.2, 4.0, 6.0})
        expect_equal(curve.length(0.0, u), 4.0L * R * (2.0L - std::sin(0.5L * u)), 1, "past the cusp");
    // next to the cusp |r'| is R times the distance from it
    const long double gap = pi - 3.14159L;
    EXPECT_NEAR(curve.length(3.14159, std::numbers::pi), static_cast<double>(0.5L * R * gap * gap), 1e-21);
    EXPECT_EQ(curve.length(2.0, -5.0), -curve.length(-5.0, 2.0));
}

TEST(Cycloid, is_measured_back_to_the_parameter_across_cusps) {
    const Curve curve = cycloid(0.5);
    for (const double s : {0.1, 1.9, 2.5, 6.5, -3.0, 123.4}) {
        const double u = curve.parameter_at(0.0, s);
        EXPECT_NEAR(curve.length(0.0, u), s, 8 * epsilon * std::abs(s)) << s;
    }
    // from the bottom, s = 4 R sin(u/2)
    EXPECT_NEAR(curve.parameter_at(0.0, 1.0), 2.0 * std::asin(0.5), 4 * epsilon);
}

TEST(Cycloid, is_recorded_with_one_sine_and_cosine) {
    rbdyn::Recorder recorder;
    const auto p = Curve(cycloid(0.5)).own(recorder.input(0));
    std::vector<Expression> outputs{p.speed_squared, p.first_dot_second, p.first_cross_second[2]};
    for (const auto& v : {p.position, p.first, p.second})
        for (int i = 0; i < 2; ++i) outputs.push_back(v[i]);
    const std::string program = rbdyn::Program(recorder, outputs, 1).text();
    EXPECT_EQ(program.find("sincos"), program.rfind("sincos")) << program;
    EXPECT_TRUE(p.position[2].is_zero() && p.first_cross_second[0].is_zero());

    const auto q = Curve(parabola(0.5)).own(recorder.input(0));
    EXPECT_EQ(q.position[0].node(), recorder.input(0).node());
    EXPECT_TRUE(q.first_cross_second[2].is_constant() && q.second[1].is_constant());
}

TEST(Cycloid, and_parabola_in_other_units_keep_every_bit) {
    const double scale = 0x1p+13;
    const Curve one = cycloid(0.7), other = cycloid(scale * 0.7), low = parabola(0.3), high = parabola(0.3 / scale);
    for (const double u : {-4.0, 0.1, 2.5, 3.1}) {
        EXPECT_EQ(other.position(u), scale * one.position(u));
        EXPECT_EQ(scale * other.curvature(u), one.curvature(u));
        EXPECT_EQ(other.length(-5.0, u), scale * one.length(-5.0, u));
        EXPECT_EQ(high.position(scale * u), scale * low.position(u));
        EXPECT_EQ(scale * high.curvature(scale * u), low.curvature(u));
        EXPECT_EQ(high.length(-scale, scale * u), scale * low.length(-1.0, u));
        EXPECT_EQ(high.frenet(scale * u).normal, low.frenet(u).normal);
    }
}

}  // namespace

}  // namespace rbdyn::test::test_parabola_cycloid
