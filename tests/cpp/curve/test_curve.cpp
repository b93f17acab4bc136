// Geometry of curves: derivatives, frames, own axes, and what a recorded model sees of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::test::test_curve {

namespace {

using LongVector = Eigen::Matrix<long double, 3, 1>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

std::vector<Curve> some_curves() {
    return {
        Line{.direction = {1, -2, 0.5}, .point = {3, 1, 2}},
        Circle{.radius = 0.7, .start = {1, 2, 3}, .toward = {0, 1, 0}, .center = {0.1, 0.2, 0.3}},
        Helix{.radius = 0.5, .pitch = -1.3, .start = {1, 1, 0}, .toward = {0, 0, 1}, .center = {1, 0, 0}},
        Polynomial{.coefficients = {{1, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1, -0.2, 0.3}}},
        Polynomial{.coefficients = {{1, 1, 1}, {0.6, 0.48, 0.64}, {-0.4, 0.18, 0.24}, {0.2, 0.66, 0.88}}},
        Polynomial{.coefficients = {{0, 0, 1}, {1, 0, 0}, {0.5, 0, 0.5}}},
        Polynomial{.coefficients = {{0, 0, 0}, {1, 1, 2}, {0, 0, 0}, {1, 1, 2}}},
        Parabola{.a = -0.6, .x = {1, 1, 0}, .y = {0, 1, 2}, .vertex = {1, 0, 2}},
        Cycloid{.radius = 0.4, .x = {1, 0, 0}, .y = {0, 1, 1}, .vertex = {0, 1, 0}},
        Spline{.points = {{0, 0, 0}, {1, 0.5, 0}, {1.5, 1.5, 0.2}, {1, 2, 1}, {0, 2, 1.5}, {-1, 1, 1}}},
        Spline{.points = {{1, 0, 0}, {1, 1, 1}, {1, 1, 3}, {1, 0, 2}}},
        Curve([](const auto& u) {
            return Vector3Of<Expression>{u, sin(u), 0.2 * u * u};
        }),
        Curve([](const auto& u) {
            return Vector3Of<Expression>{u * cos(u), 0.5, 1.0 / (2.0 + sin(u))};
        }),
        Curve([](const auto& u) {
            return Vector3Of<Expression>{u + 0.3 * sin(u), 2.0 * u + 0.6 * sin(u), 1.0};
        }),
    };
}

std::string program_of(const CurvePoint<Expression>& p, rbdyn::Recorder& recorder) {
    std::vector<Expression> outputs;
    for (const auto& v : {p.position, p.first, p.second, p.first_cross_second})
        for (int i = 0; i < 3; ++i) outputs.push_back(v[i]);
    outputs.push_back(p.speed_squared);
    outputs.push_back(p.first_dot_second);
    return rbdyn::Program(recorder, outputs, 1).text();
}

int count(const std::string& text, const std::string& word) {
    int found = 0;
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
    return found;
}

Placement tilted() {
    // columns (2, 1, 2)/3, (-2, 2, 1)/3, (-1, -2, 2)/3
    Placement view{.origin = {0.5, -0.25, 2.0}};
    view.axes << 2, -2, -1, 1, 2, -2, 2, 1, 2;
    view.axes /= 3.0;
    return view;
}

TEST(Curve, derivatives_are_those_of_the_position) {
    // fourth-order differences: h^4/30 times a fifth derivative below 10 is 3e-17; the coefficients' own rounding does
    // not show, since all is one formula; that of long double does, over h (on some machines it is double)
    const long double h = 1e-4L;
    const long double tolerance = 1e-13L + 32.0L * std::numeric_limits<long double>::epsilon() / h;
    const auto slope = [&](const std::function<LongVector(long double)>& f, long double u) {
        return LongVector((8.0L * (f(u + h) - f(u - h)) - (f(u + 2.0L * h) - f(u - 2.0L * h))) / (12.0L * h));
    };
    for (const Curve& curve : some_curves())
        for (double u : {-2.0, -0.3, 0.0, 1e-3, 1.7}) {
            SCOPED_TRACE(curve.name() + " at " + std::to_string(u));
            const auto p = curve.own<long double>(u);
            const LongVector first = slope([&](long double x) { return curve.own(x).position; }, u);
            const LongVector second = slope([&](long double x) { return curve.own(x).first; }, u);
            EXPECT_LT((p.first - first).norm(), tolerance);
            EXPECT_LT((p.second - second).norm(), tolerance);
            const long double size = 1.0L + first.norm() + second.norm(), product = tolerance * size * size;
            EXPECT_LT(std::abs(p.speed_squared - first.squaredNorm()), product);
            EXPECT_LT(std::abs(p.first_dot_second - first.dot(second)), product);
            EXPECT_LT((p.first_cross_second - first.cross(second)).norm(), product);
        }
}

TEST(Curve, torsion_is_how_fast_the_binormal_turns) {
    // db/ds = -tau n; central differences: h^2 times a third derivative below 100, rounding 1e-16 / h
    const double h = 1e-5;
    for (const Curve& curve : some_curves())
        for (double u : {-2.0, -0.3, 1.7}) {
            const Vector3 turning = (curve.frenet(u + h).binormal - curve.frenet(u - h).binormal) / (2.0 * h);
            const Vector3 expected = -curve.torsion(u) * curve.frenet(u).normal * curve.first(u).norm();
            EXPECT_LT((turning - expected).norm(), 1e-8) << curve.name() << " at " << u;
        }
}

TEST(Curve, the_position_of_each_kind_is_its_formula) {
    const Curve helix =
        Helix{.radius = 2.0, .pitch = 3.0, .start = {0, 5, 0}, .toward = {0, 1, 7}, .center = {1, 1, 1}};
    const double u = 1.2, rise = 3.0 * u / (2.0 * std::numbers::pi);
    EXPECT_LT((helix.position(u) - Vector3(1.0 + rise, 1.0 + 2.0 * std::cos(u), 1.0 + 2.0 * std::sin(u))).norm(),
              4 * epsilon);
    EXPECT_GT(helix.torsion(u), 0.0);

    const std::vector<Vector3> c{{1, 1, 1}, {0.6, 0.48, 0.64}, {-0.4, 0.18, 0.24}, {0.2, 0.66, 0.88}};
    const Curve cubic = Polynomial{.coefficients = c};
    EXPECT_LT((cubic.position(u) - (c[0] + u * (c[1] + u * (c[2] + u * c[3])))).norm(), 16 * epsilon);
    EXPECT_EQ(cubic.torsion(u), 0.0) << "a plane curve";
}

TEST(Curve, the_frame_is_orthonormal_and_right_handed_everywhere) {
    for (const Curve& curve : some_curves())
        for (double u : {-1e6, -2.0, -1.0 / 3.0, 0.0, 1e-12, 1.0, 1e6, 1e12}) {
            const Frenet f = curve.frenet(u);
            Matrix3 axes;
            axes << f.tangent, f.normal, f.binormal;
            EXPECT_LT((axes.transpose() * axes - Matrix3::Identity()).cwiseAbs().maxCoeff(), 8 * epsilon)
                << curve.name() << " at " << u;
            EXPECT_NEAR(axes.determinant(), 1.0, 16 * epsilon);
            EXPECT_GE(f.tangent.dot(curve.first(u)), 0.0);
            EXPECT_TRUE(std::isfinite(curve.curvature(u)) && std::isfinite(curve.torsion(u)));
        }
}

TEST(Curve, a_circle_keeps_its_digits_over_a_million_radians) {
    const Curve circle = Circle{.radius = 0.5, .start = {1, 0, 0}, .toward = {0, 1, 0}};
    for (double u : {1e6, -1e6, 123456.789}) {
        const auto x = static_cast<double>(0.5L * std::cos(static_cast<long double>(u)));
        const auto y = static_cast<double>(0.5L * std::sin(static_cast<long double>(u)));
        EXPECT_LT((circle.position(u) - Vector3(x, y, 0.0)).norm(), epsilon);
        EXPECT_EQ(circle.position(u).z(), 0.0);
        // eight roundings, of half a unit in the last place each
        EXPECT_NEAR(circle.curvature(u), 2.0, 8 * epsilon);
        EXPECT_EQ(circle.torsion(u), 0.0);
        EXPECT_NEAR(circle.parameter_at(u, 1.0), u + 2.0, std::abs(u) * epsilon);
    }
    EXPECT_TRUE(circle.closed());
    EXPECT_EQ(circle.domain().end, std::numeric_limits<double>::infinity());
}

TEST(Curve, a_line_has_an_upward_normal_and_no_curvature) {
    const Curve incline = Line{.direction = {3, 0, -4}};
    EXPECT_LT((incline.frenet(5.0).normal - Vector3(0.8, 0.0, 0.6)).norm(), 2 * epsilon);
    EXPECT_EQ(incline.frenet(5.0).binormal, Vector3(0, -1, 0));
    EXPECT_EQ(incline.curvature(5.0), 0.0);
    EXPECT_EQ(incline.torsion(5.0), 0.0);
    const Curve vertical = Line{.direction = {0, 0, -2}};
    EXPECT_EQ(vertical.frenet(1.0).normal, Vector3::UnitX());
}

TEST(Curve, a_polynomial_that_goes_back_on_its_line_keeps_its_normal) {
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}};
    EXPECT_EQ(curve.frenet(1.0).normal, Vector3::UnitZ());
    EXPECT_EQ(curve.frenet(-1.0).normal, Vector3::UnitZ());
    EXPECT_EQ(curve.frenet(-1.0).tangent, -Vector3::UnitX());
    EXPECT_EQ(curve.curvature(1.0), 0.0);
}

TEST(Curve, at_an_inflection_the_frame_is_the_one_from_the_side_of_smaller_parameters) {
    // (u, (u - 1)^3, (u - 1)^4), expanded so that what vanishes at u = 1 does so by cancellation
    const Curve curve = Polynomial{.coefficients = {{0, -1, 1}, {1, 3, -4}, {0, -3, 6}, {0, 1, -4}, {0, 0, 1}}};
    EXPECT_EQ(curve.curvature(1.0), 0.0);
    EXPECT_EQ(curve.torsion(1.0), 0.0);
    const Frenet at = curve.frenet(1.0), before = curve.frenet(1.0 - 1e-6), after = curve.frenet(1.0 + 1e-6);
    EXPECT_LT((at.normal - Vector3(0, -1, 0)).norm(), 8 * epsilon);
    // the limit is reached in proportion to the distance, the slope is 2; beyond, the normal has changed sides
    EXPECT_LT((at.normal - before.normal).norm(), 1e-5);
    EXPECT_LT((at.normal + after.normal).norm(), 1e-5);

    // a fourth-order contact does not change sides
    const Curve flat = Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 2}}};
    EXPECT_EQ(flat.frenet(0.0).normal, Vector3::UnitZ());
    EXPECT_EQ(flat.frenet(0.1).binormal, -Vector3::UnitY());
}

TEST(Curve, far_out_on_a_parabola_the_curvature_is_still_that_of_the_parabola) {
    const Curve curve = Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    for (double u : {1e3, 1e9, 1e16}) {
        const double exact = 2.0 / std::pow(1.0 + 4.0 * u * u, 1.5);
        EXPECT_NEAR(curve.curvature(u), exact, 8 * epsilon * exact);
        EXPECT_EQ(curve.frenet(u).binormal, Vector3::UnitZ());
    }
}

TEST(Curve, a_tilted_circle_seen_from_its_own_placement_stays_in_its_plane_exactly) {
    const Curve circle = Circle{.radius = 0.7, .start = {1, 2, 3}, .toward = {0.3, 1, -0.2}, .center = {0.1, 0.2, 0.3}};
    for (double u : {0.0, 0.4, 3.0, 1e5}) {
        const auto seen = circle.at(u, circle.placement());
        const auto own = circle.own(u);
        EXPECT_EQ(seen.position, own.position);
        EXPECT_EQ(seen.first, own.first);
        EXPECT_EQ(seen.second, own.second);
        EXPECT_EQ(seen.first_cross_second, own.first_cross_second);
        EXPECT_EQ(seen.position.z(), 0.0);
    }
}

TEST(Curve, circles_in_one_tilted_plane_see_each_other_in_that_plane) {
    const Vector3 x(1, 2, 3), y(0.3, 1, -0.2);
    const Curve one = Circle{.radius = 1.0, .start = x, .toward = y};
    const Curve other = Circle{.radius = 2.0, .start = x + 0.3 * y, .toward = y - x, .center = 2.0 * x - y};
    rbdyn::Recorder recorder;
    const auto seen = other.at(recorder.input(0), one.placement());
    EXPECT_TRUE(seen.position[2].is_zero());
    EXPECT_TRUE(seen.first[2].is_zero());
    EXPECT_TRUE(seen.second[2].is_zero());
    EXPECT_TRUE(seen.first_cross_second[0].is_zero());
    EXPECT_TRUE(seen.first_cross_second[1].is_zero());
}

TEST(Curve, any_view_shows_the_same_curve) {
    const Placement view = tilted();
    for (const Curve& curve : some_curves())
        for (double u : {-1.5, 0.0, 0.8}) {
            const auto seen = curve.at(u, view);
            const Vector3 back = view.origin + view.axes * seen.position;
            EXPECT_LT((back - curve.position(u)).norm(), 32 * epsilon) << curve.name();
            EXPECT_LT((view.axes * seen.first - curve.first(u)).norm(), 32 * epsilon);
            EXPECT_LT((view.axes * seen.second - curve.second(u)).norm(), 64 * epsilon);
            EXPECT_LT((seen.first.cross(seen.second) - seen.first_cross_second).norm(), 64 * epsilon);
            EXPECT_EQ(seen.speed_squared, curve.own(u).speed_squared);
            const auto world = curve.at(u, Placement{});
            EXPECT_EQ(world.position, curve.position(u));
        }
    // a small component beside a large one is no rounding
    EXPECT_EQ((Curve(Line{.direction = {1, 0, 0}, .point = {1e20, 1, 0}}).at(0.0, Placement{}).position.y()), 1.0);
}

TEST(Curve, a_recorded_circle_costs_one_sine_and_cosine) {
    rbdyn::Recorder recorder;
    const Curve circle = Circle{.radius = 0.7, .start = {1, 2, 3}, .toward = {0.3, 1, -0.2}};
    const auto p = circle.at(recorder.input(0), Placement{});
    EXPECT_EQ(count(program_of(p, recorder), "sincos"), 1);
    EXPECT_TRUE(p.speed_squared.is_constant());
    EXPECT_EQ(p.speed_squared.value(), 0.7 * 0.7);
    EXPECT_TRUE(p.first_dot_second.is_zero());
    EXPECT_TRUE(p.first_cross_second[0].is_constant()) << "the binormal of a circle is fixed, however it is turned";
}

TEST(Curve, a_recorded_line_costs_nothing_and_a_parabola_one_sum) {
    rbdyn::Recorder recorder;
    const Expression u = recorder.input(0);
    const auto line = Curve(Line{.direction = {1, 2, 3}}).own(u);
    EXPECT_EQ(line.position[0].node(), u.node());
    EXPECT_TRUE(line.speed_squared.is_constant() && line.first_cross_second[2].is_zero());

    const auto parabola = Curve(Polynomial{.coefficients = {{0, 0, 3}, {2, 0, 0}, {0, 0, 1}}}).own(u);
    EXPECT_EQ(parabola.first[0].value(), 2.0);
    EXPECT_TRUE(parabola.first_cross_second[2].is_constant());
    EXPECT_EQ(parabola.first_cross_second[2].value(), 4.0);
    EXPECT_TRUE(parabola.position[2].is_zero());
}

TEST(Curve, own_axes_are_exact_where_the_input_is_along_world_axes) {
    const Placement circle = Curve(Circle{.radius = 2.0, .start = {0, 0, -3}, .toward = {5, 0, 1}}).placement();
    EXPECT_EQ(circle.axes.col(0), -Vector3::UnitZ());
    EXPECT_EQ(circle.axes.col(1), Vector3::UnitX());
    EXPECT_EQ(circle.axes.col(2), -Vector3::UnitY());
    // cos(pi/2) is 6e-17 in doubles
    const double right = std::numbers::pi / 2.0;
    const Placement line = Curve(Line{.direction = {std::cos(right), std::sin(right), 0.0}}).placement();
    EXPECT_EQ(line.axes.col(0), Vector3::UnitY());
    EXPECT_EQ(line.axes.col(1), Vector3::UnitZ());
    const Placement plane = Curve(Polynomial{.coefficients = {{1, 2, 3}, {0, 1, 1}, {0, 0, 2}}}).placement();
    EXPECT_EQ(plane.axes.col(0), Vector3::UnitY());
    EXPECT_EQ(plane.axes.col(2), Vector3::UnitX());
    EXPECT_EQ(plane.origin, Vector3(1, 2, 3));
}

TEST(Curve, a_tilted_plane_polynomial_has_no_component_out_of_its_plane) {
    const Curve curve =
        Polynomial{.coefficients = {{1, 1, 1}, {0.6, 0.48, 0.64}, {-0.4, 0.18, 0.24}, {0.2, 0.66, 0.88}}};
    for (double u : {-7.0, 0.1, 1e5}) {
        EXPECT_EQ(curve.own(u).position.z(), 0.0);
        EXPECT_EQ(curve.own(u).second.z(), 0.0);
    }
    EXPECT_EQ(curve.own(0.0).first.y(), 0.0) << "the first axis is along the first coefficient";
}

TEST(Curve, a_curve_is_a_value) {
    const Curve one = Circle{.radius = 0.5, .start = {1, 0, 0}, .toward = {0, 1, 0}};
    Curve other = Line{.direction = {1, 0, 0}};
    EXPECT_FALSE(one == other);
    other = one;
    EXPECT_TRUE(one == other);
    EXPECT_EQ(other.name(), "circle of radius 0.5");
}

}  // namespace

}  // namespace rbdyn::test::test_curve
