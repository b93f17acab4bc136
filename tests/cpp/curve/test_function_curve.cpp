// Curves of any function: against the kinds they repeat, against closed forms, and where they bend in no way.
#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_2.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::test::test_function_curve {

namespace {

using Point = rbdyn::Vector3Of<Expression>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double pi = std::numbers::pi;

void expect_same_frame(const Frenet& a, const Frenet& b, double tolerance) {
    EXPECT_LT((a.tangent - b.tangent).norm(), tolerance);
    EXPECT_LT((a.normal - b.normal).norm(), tolerance);
    EXPECT_LT((a.binormal - b.binormal).norm(), tolerance);
}

TEST(FunctionCurve, a_helix_given_as_a_function_is_the_helix) {
    const double R = 0.5, h = 0.25;
    const Curve one = Helix{.radius = R, .pitch = 2 * pi * h, .start = {1, 0, 0}, .toward = {0, 1, 0}};
    const Curve other([&](const auto& u) { return Point{R * cos(u), R * sin(u), h * u}; });
    for (double u : {-7.0, 0.0, 1e-8, 0.5, 3.0, 1e3}) {
        EXPECT_LT((one.position(u) - other.position(u)).norm(), 2 * epsilon * (1 + std::abs(u)));
        expect_same_frame(one.frenet(u), other.frenet(u), 8 * epsilon);
        EXPECT_NEAR(other.curvature(u), one.curvature(u), 16 * epsilon);
        EXPECT_NEAR(other.torsion(u), one.torsion(u), 16 * epsilon);
        EXPECT_NEAR(other.length(0.0, u), one.length(0.0, u), 8 * epsilon * std::abs(u));
    }
    EXPECT_EQ(other.name(), "curve of a function");
    EXPECT_FALSE(other.closed());
}

TEST(FunctionCurve, a_polynomial_given_as_a_function_is_the_polynomial) {
    const Curve one = Polynomial{.coefficients = {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .domain = {-1, 2}};
    const Curve other([](const auto& u) { return Point{1.0 + u, u * u, pow(u, 3)}; }, {-1, 2});
    EXPECT_EQ(other.domain(), (Domain{-1, 2}));
    for (double u : {-1.0, -0.2, 0.0, 1.3}) {
        EXPECT_EQ(one.position(u), other.position(u));
        expect_same_frame(one.frenet(u), other.frenet(u), 16 * epsilon);
        EXPECT_NEAR(other.torsion(u), one.torsion(u), 32 * epsilon * (1 + one.torsion(u)));
    }
    EXPECT_NEAR(other.length(-1, 2), one.length(-1, 2), 8 * epsilon * 10);
}

TEST(FunctionCurve, a_sine_has_the_length_frame_and_curvature_of_its_closed_forms) {
    // (u, 0, A sin u): |r'|^2 = 1 + A^2 cos^2 u, length from a crest to a crest by the second elliptic integral
    const double A = 0.75;
    const Curve sine([&](const auto& u) { return Point{u, 0.0, A * sin(u)}; });
    const long double squared = 1.0L + static_cast<long double>(A) * A, k = std::sqrt(1.0L - 1.0L / squared);
    const auto quarter = static_cast<double>(std::sqrt(squared) * boost::math::ellint_2(k));
    EXPECT_NEAR(sine.length(0.0, 0.5 * pi), quarter, 4 * epsilon * quarter);
    EXPECT_NEAR(sine.length(-0.5 * pi, 30.5 * pi), 62 * quarter, 32 * epsilon * 62 * quarter);
    EXPECT_EQ(sine.placement().axes.col(1), Vector3::UnitZ());
    for (double u : {-2.0, 1e-7, 0.3, 1.5, 4.0, 77.0}) {
        SCOPED_TRACE(u);
        const long double slope = A * std::cos(1.0L * u), bend = -A * std::sin(1.0L * u);
        const long double q = std::sqrt(1.0L + slope * slope), side = bend > 0.0L ? 1.0L : -1.0L;
        const Frenet f = sine.frenet(u);
        EXPECT_NEAR(f.tangent.x(), static_cast<double>(1.0L / q), 4 * epsilon);
        EXPECT_NEAR(f.tangent.z(), static_cast<double>(slope / q), 4 * epsilon);
        EXPECT_NEAR(f.normal.x(), static_cast<double>(-side * slope / q), 4 * epsilon);
        EXPECT_NEAR(f.normal.z(), static_cast<double>(side / q), 4 * epsilon);
        EXPECT_EQ(f.tangent.y(), 0.0);
        const auto curvature = static_cast<double>(std::abs(bend) / (q * q * q));
        EXPECT_NEAR(sine.curvature(u), curvature, 8 * epsilon * curvature);
        EXPECT_EQ(sine.torsion(u), 0.0);
    }
}

TEST(FunctionCurve, at_an_inflection_the_frame_is_the_one_from_the_side_of_smaller_parameters) {
    const Curve sine([](const auto& u) { return Point{u, sin(u), 0.0}; });
    for (int n = -3; n <= 12; ++n) {
        // the parameter misses the inflection by its own rounding, which is not to be seen
        const double u = n * pi;
        EXPECT_EQ(sine.curvature(u), 0.0) << n;
        EXPECT_EQ(sine.torsion(u), 0.0) << n;
        EXPECT_EQ(sine.frenet(u).binormal, sine.frenet(u - 1e-3).binormal) << n;
        EXPECT_EQ(sine.frenet(u).binormal, -sine.frenet(u + 1e-3).binormal) << n;
        EXPECT_GT(sine.curvature(u + 1e-12 * (1 + std::abs(u))), 0.0) << n;
    }
    // contacts of fourth and fifth order; the second turns into space
    const Curve flat([](const auto& u) { return Point{u, pow(u, 4), 0.0}; });
    EXPECT_EQ(flat.curvature(0.0), 0.0);
    EXPECT_EQ(flat.frenet(0.0).binormal, Vector3::UnitZ());
    const Curve twisted([](const auto& u) { return Point{sin(u), pow(u, 5), pow(u, 6)}; });
    EXPECT_LT((twisted.frenet(0.0).normal + Vector3::UnitY()).norm(), 4 * epsilon);
    EXPECT_EQ(twisted.torsion(0.0), 0.0);
}

TEST(FunctionCurve, that_is_straight_has_one_frame_and_nothing_beside_its_line) {
    const Curve line = Line{.direction = {1, 2, -2}};
    const std::vector<Curve> all{
        Curve([](const auto& u) {
            return Point{u, 2.0 * u, -2.0 * u};
        }),
        Curve([](const auto& u) {
            return Point{0.1 + sinh(u), 2.0 * sinh(u), 7.0 - 2.0 * sinh(u)};
        }),
        Curve(
            [](const auto& u) {
                return Point{u + 0.5 * sin(u), 2.0 * u + sin(u), -2.0 * u - sin(u)};
            },
            {-1, 2}),
    };
    for (const Curve& curve : all) {
        EXPECT_TRUE(curve.straight());
        for (double u : {-0.7, 0.0, 0.3, 1.1}) {
            expect_same_frame(curve.frenet(u), line.frenet(u), 8 * epsilon);
            EXPECT_EQ(curve.curvature(u), 0.0);
            EXPECT_EQ(curve.torsion(u), 0.0);
            EXPECT_EQ(curve.own(u).position.tail(2), Eigen::Vector2d::Zero());
        }
    }
    EXPECT_NEAR(all[0].length(0, 2), 6.0, 8 * epsilon);
    EXPECT_NEAR(all[1].length(-1, 2), 3.0 * (std::sinh(2.0) + std::sinh(1.0)), 32 * epsilon);
    EXPECT_LT((all[1].position(0.5) - Vector3(0.1, 0, 7) - std::sinh(0.5) * Vector3(1, 2, -2)).norm(), 16 * epsilon);
    // there and back: the tangent turns, the normal stays
    const Curve back([](const auto& u) { return Point{0.0, 3.0 * cos(u), 0.0}; });
    EXPECT_EQ(back.frenet(1.0).normal, Vector3::UnitZ());
    EXPECT_EQ(back.frenet(-1.0).normal, Vector3::UnitZ());
    EXPECT_EQ(back.frenet(-1.0).tangent, Vector3::UnitY());
    EXPECT_NEAR(back.length(0.0, 2.0 * pi), 12.0, 1e-13);
    // a bend of a part in 1e17 is still a bend
    EXPECT_FALSE(Curve([](const auto& u) { return Point{u, 1e-17 * sin(u), 0.0}; }).straight());
}

TEST(FunctionCurve, with_a_cusp_has_no_tangent_there) {
    const Curve cycloid([](const auto& u) { return Point{u + sin(u), 0.0, 1.0 - cos(u)}; });
    for (double cusp : {pi, -pi, 5.0 * pi}) EXPECT_THROW(cycloid.frenet(cusp), InvalidInput) << cusp;
    EXPECT_NO_THROW(cycloid.frenet(3.1));
    EXPECT_NEAR(cycloid.length(0.0, 2.0 * pi), 8.0, 1e-12);
    const Curve cubic([](const auto& u) { return Point{u * u, u * u * u, 0.0}; });
    EXPECT_THROW(cubic.frenet(0.0), InvalidInput);
    EXPECT_NO_THROW(cubic.frenet(1e-100));
}

TEST(FunctionCurve, that_is_closed_counts_its_rounds) {
    // the function goes on by itself
    const auto ellipse = [](const auto& u) { return Point{2.0 * cos(u), sin(u), 0.0}; };
    const Curve periodic(ellipse, {0.0, 2.0 * pi}, true);
    EXPECT_TRUE(periodic.closed());
    EXPECT_EQ(periodic.domain(), Domain{});
    EXPECT_EQ(periodic.period(), 2.0 * pi);
    const auto around = static_cast<double>(8.0L * boost::math::ellint_2(std::sqrt(0.75L)));
    EXPECT_NEAR(periodic.length(0.0, 2.0 * pi), around, 8 * epsilon * around);
    EXPECT_NEAR(periodic.length(1.0, 1.0 + 200.0 * pi), 100.0 * around, 1e-12 * around);
    EXPECT_EQ(periodic.position(100.0), Curve(ellipse).position(100.0));
    rbdyn::Recorder recorder;
    (void)periodic.own(recorder.input(0));
    EXPECT_TRUE(recorder.branches().empty()) << "no rounds are counted where the function repeats itself";

    // a polynomial does not
    const auto bean = [](const auto& u) {
        // r(0) = r(1) and r'(0) = r'(1)
        const auto p = u * (u - 1.0);
        return Point{p * (2.0 * u - 1.0), p * p, 0.5 * p * p * (2.0 * u - 1.0)};
    };
    const Curve closed(bean, {0.0, 1.0}, true);
    for (double u : {0.1, 0.7}) {
        EXPECT_LT((closed.position(u + 3.0) - closed.position(u)).norm(), 4 * epsilon);
        EXPECT_LT((closed.position(u - 2.0) - closed.position(u)).norm(), 4 * epsilon);
        expect_same_frame(closed.frenet(u + 3.0), closed.frenet(u), 64 * epsilon);
    }
    const double once = closed.length(0.0, 1.0);
    EXPECT_NEAR(closed.length(-0.5, 9.5), 10.0 * once, 1e-14 * 10 * once);
    EXPECT_NEAR(closed.length(0.75, 1.25), closed.length(0.75, 1.0) + closed.length(0.0, 0.25), 1e-15);
    EXPECT_NEAR(closed.parameter_at(0.0, 5.0 * once), 5.0, 1e-14);
    rbdyn::Recorder counting;
    const double at = 4.25;
    counting.follow(0.0, std::span<const double>(&at, 1), {});
    (void)closed.own(counting.input(0));
    ASSERT_EQ(counting.branches().size(), 1u);
    EXPECT_EQ(counting.branches()[0].choice, 4);
    EXPECT_EQ(counting.branches()[0].name, "");
}

TEST(FunctionCurve, keeps_what_is_constant_out_of_its_recorded_program) {
    rbdyn::Recorder recorder;
    const Expression u = recorder.input(0);
    for (int flat = 0; flat < 3; ++flat) {
        const Curve curve([&](const auto& x) {
            Point r{cos(x), sin(x), x};
            r[flat] = 2.5;
            return r;
        });
        const auto p = curve.own(u);
        EXPECT_TRUE(p.position[2].is_zero() && p.first[2].is_zero() && p.first_cross_second[0].is_zero()) << flat;
        EXPECT_EQ(curve.position(0.3)[flat], 2.5);
        EXPECT_EQ(curve.placement().origin[flat], 2.5);
    }
    const auto line = Curve([](const auto& x) { return Point{1.0, x, 2.0}; }).own(u);
    EXPECT_EQ(line.position[0].node(), u.node());
    EXPECT_TRUE(line.speed_squared.is_constant() && line.first_dot_second.is_zero());
}

TEST(FunctionCurve, may_distinguish_cases) {
    // a straight that goes over into a clothoid-like bend: u + 0, then the cube
    const Curve rail(
        [](const auto& u) {
            return Point{u,
                         select(
                             u, [&] { return u * u * u; }, [] { return Expression(0.0); }),
                         0.0};
        },
        {-1, 1});
    EXPECT_FALSE(rail.straight());
    EXPECT_EQ(rail.curvature(-0.5), 0.0);
    EXPECT_EQ(rail.frenet(-0.5).normal, Vector3::UnitZ());
    EXPECT_NEAR(rail.curvature(1e-3), 6e-3, 1e-12);
    EXPECT_EQ(rail.frenet(1e-3).binormal, Vector3::UnitZ());
    EXPECT_EQ(rail.position(-0.5), Vector3(-0.5, 0, 0));
}

TEST(FunctionCurve, of_straight_pieces_is_those_pieces_and_no_line) {
    const double lift = 0.3;
    const std::vector<Curve> all{
        Curve([=](const auto& u) {
            return Point{u, 0.0, max(u, Expression(lift))};
        }),
        Curve(
            [=](const auto& u) {
                return Point{u, 0.0, max(u, Expression(lift))};
            },
            {-1, 1}),
        Curve([=](const auto& u) {
            return Point{u, 0.0, where(u > lift, u, Expression(lift))};
        }),
        Curve([=](const auto& u) {
            return Point{u, 0.0, 0.5 * (u + lift + abs(u - lift))};
        }),
    };
    for (const Curve& curve : all) {
        EXPECT_FALSE(curve.straight());
        for (const double u : {-0.9, 0.0, 0.25, 0.5, 0.9}) {
            EXPECT_LE((curve.position(u) - Vector3(u, 0.0, std::max(u, lift))).norm(), epsilon) << u;
            EXPECT_NEAR(curve.frenet(u).tangent.z(), u > lift ? std::sqrt(0.5) : 0.0, 2 * epsilon) << u;
            EXPECT_EQ(curve.curvature(u), 0.0) << u;
            EXPECT_FALSE(curve.jumps_at(u)) << u;
        }
        EXPECT_TRUE(curve.jumps_at(lift));
        EXPECT_THROW(curve.frenet(lift), InvalidInput);
        EXPECT_NEAR(curve.length(-1.0, 1.0), 1.3 + 0.7 * std::sqrt(2.0), 8 * epsilon);
    }
    // a line that the formula shows to be one, though it turns back
    const Curve line([](const auto& u) { return Point{abs(u), 0.0, 2.0 * abs(u) - 1.0}; });
    EXPECT_TRUE(line.straight());
    EXPECT_TRUE(line.jumps_at(0.0));
    EXPECT_EQ(line.position(-0.5), Vector3(0.5, 0.0, 0.0));
    // the same function, written in two ways
    EXPECT_TRUE(Curve([](const auto& u) { return Point{u * u + 2.0 * u, 0.0, 0.7 * u * (u + 2.0)}; }).straight());
}

TEST(FunctionCurve, is_not_taken_for_a_line_by_what_lies_between_samples) {
    const Curve bump([](const auto& u) { return Point{u, 0.0, exp(-1e8 * (u - 0.123) * (u - 0.123))}; }, {-1, 1});
    EXPECT_FALSE(bump.straight());
    EXPECT_EQ(bump.position(0.123), Vector3(0.123, 0.0, 1.0));
    const double width = 1e-3;
    const Curve hat([=](const auto& u) { return Point{u, 0.0, max(Expression(0.0), width - abs(u - 0.123))}; });
    EXPECT_FALSE(hat.straight());
    EXPECT_NEAR(hat.position(0.123).z(), width, 1e-18);
    EXPECT_NEAR(hat.length(-1.0, 1.0), 2.0 + 2.0 * width * (std::sqrt(2.0) - 1.0), 16 * epsilon);
}

TEST(FunctionCurve, that_is_closed_is_the_same_in_every_round_also_between_samples) {
    const Curve bumped(
        [](const auto& u) {
            return Point{cos(u), sin(u), exp(-1e8 * (u - 0.123) * (u - 0.123))};
        },
        {-pi, pi}, true);
    EXPECT_NEAR(bumped.position(0.123 + 2.0 * pi).z(), 1.0, 1e-6);
    EXPECT_NEAR(bumped.position(0.123 - 6.0 * pi).z(), 1.0, 1e-6);
}

TEST(FunctionCurve, refuses_numbers_that_are_to_change_for_it_is_measured_once) {
    rbdyn::Parameter radius(2.0, "radius");
    const auto circle = [&](const auto& u) { return Point{radius * cos(u), radius * sin(u), 0.0}; };
    try {
        (void)Curve(circle);
        FAIL() << "made";
    } catch (const rbdyn::InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find("radius"), std::string::npos) << e.what();
    }
    const auto now = [r = radius.value()](const auto& u) { return Point{r * cos(u), r * sin(u), 0.0}; };
    EXPECT_NEAR(Curve(now).curvature(0.3), 0.5, 4 * epsilon);
}

TEST(FunctionCurve, is_equal_to_one_of_the_same_formula) {
    const auto make = [](double A, Domain domain) {
        return Curve([&](const auto& u) { return Point{u, A * sin(u), 0.0}; }, domain);
    };
    EXPECT_TRUE(make(1.5, {}) == make(1.5, {}));
    EXPECT_FALSE(make(1.5, {}) == make(1.25, {}));
    EXPECT_FALSE(make(1.5, {}) == make(1.5, {0, 1}));
}

TEST(FunctionCurve, in_other_units_and_along_other_axes_keeps_every_bit) {
    const double scale = 0x1p-9;
    const auto make = [](double size, int turn) {
        return Curve([=](const auto& u) {
            const Point r{size * u, size * 0.7 * sin(u), size * 0.3 * exp(-u)};
            return Point{r[turn % 3], r[(turn + 1) % 3], r[(turn + 2) % 3]};
        });
    };
    const Curve one = make(1.0, 0), small = make(scale, 0), turned = make(1.0, 1);
    for (double u : {-1.0, 0.2, 2.0}) {
        EXPECT_EQ(small.position(u), scale * one.position(u));
        EXPECT_EQ(small.frenet(u).normal, one.frenet(u).normal);
        EXPECT_EQ(scale * small.torsion(u), one.torsion(u));
        EXPECT_EQ(small.length(0.0, u), scale * one.length(0.0, u));
        EXPECT_EQ(turned.position(u).z(), one.position(u).x());
    }
}

}  // namespace

}  // namespace rbdyn::test::test_function_curve
