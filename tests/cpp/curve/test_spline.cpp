// Splines: what they pass through, how smooth they are, and which stretch a parameter lies on.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::test::test_spline {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

const std::vector<Vector3> bend{{0, 0, 0},      {1, 0.5, 0}, {1.5, 1.5, 0.25}, {1, 2, 1},
                                {0, 2.25, 1.5}, {-1, 1, 1},  {-1, 0, 3}};

std::vector<Vector3> mapped(const std::vector<Vector3>& points, const auto& f) {
    std::vector<Vector3> result;
    for (const Vector3& p : points) result.push_back(f(p));
    return result;
}

/// Rounding of slopes and second derivatives, and what they change from one number to the next: r''' is below 32.
double tolerance(double u) { return 64 * epsilon + 32.0 * (std::nextafter(std::abs(u), 1e9) - std::abs(u)); }

/// What is on either side of a parameter, the next number to the left standing for the left.
struct Sides {
    Vector3 before, after;
    double jump() const { return (after - before).norm(); }
};
Sides first(const Curve& c, double u) { return {c.first(std::nextafter(u, -1e9)), c.first(u)}; }
Sides second(const Curve& c, double u) { return {c.second(std::nextafter(u, -1e9)), c.second(u)}; }

TEST(Spline, passes_through_its_points) {
    for (const bool closed : {false, true})
        for (std::size_t n = closed ? 3 : 2; n <= bend.size(); ++n) {
            const Curve spline =
                Spline{.points = {bend.begin(), bend.begin() + static_cast<long>(n)}, .closed = closed};
            for (std::size_t k = 0; k < n; ++k)
                EXPECT_LT((spline.position(static_cast<double>(k)) - bend[k]).norm(), 16 * epsilon) << n << ": " << k;
        }
}

TEST(Spline, is_smooth_to_the_second_derivative_at_its_points) {
    const Curve open = Spline{.points = bend}, closed = Spline{.points = bend, .closed = true};
    for (int k = 1; k < 6; ++k) {
        // slopes and second derivatives are below 10
        EXPECT_LT(first(open, k).jump(), tolerance(k)) << k;
        EXPECT_LT(second(open, k).jump(), tolerance(k)) << k;
    }
    for (int k = -7; k < 14; ++k) {
        EXPECT_LT(first(closed, k).jump(), tolerance(k)) << k;
        EXPECT_LT(second(closed, k).jump(), tolerance(k)) << k;
        EXPECT_LT((closed.position(k) - bend[static_cast<std::size_t>((k + 7) % 7)]).norm(), 16 * epsilon) << k;
    }
    EXPECT_EQ(closed.domain().end, std::numeric_limits<double>::infinity());
    EXPECT_TRUE(closed.closed());
    EXPECT_EQ(closed.period(), 7.0);
    EXPECT_EQ(open.period(), 0.0);
    EXPECT_EQ(open.domain(), (rbdyn::Domain{0.0, 6.0}));
}

TEST(Spline, of_points_on_a_cubic_is_that_cubic_beyond_its_ends_too) {
    const std::vector<Vector3> c{{1, -1, 0.5}, {0.5, 2, -1}, {-0.25, 0.5, 0.75}, {0.125, -0.0625, 0.25}};
    const Curve cubic = Polynomial{.coefficients = c};
    for (const int n : {4, 5, 9}) {
        std::vector<Vector3> points;
        for (int k = 0; k < n; ++k) points.push_back(cubic.position(k));
        const Curve spline = Spline{.points = points};
        for (double u : {-0.5, 0.0, 0.3, 1.0, 1.7, 2.9, n - 1.25, n - 1.0, n - 0.5}) {
            const double size = 1.0 + cubic.position(n).norm();
            EXPECT_LT((spline.position(u) - cubic.position(u)).norm(), 32 * epsilon * size) << n << " at " << u;
            EXPECT_LT((spline.second(u) - cubic.second(u)).norm(), 128 * epsilon * size) << n << " at " << u;
        }
        EXPECT_NEAR(spline.length(0.25, n - 1.25), cubic.length(0.25, n - 1.25), 1e-13 * cubic.length(0, n));
        EXPECT_NEAR(spline.torsion(1.5), cubic.torsion(1.5), 1e-11);
    }
}

TEST(Spline, of_three_points_is_a_parabola_and_of_two_a_line) {
    const Curve parabola = Spline{.points = {{0, 0, 0}, {1, 1, 0}, {2, 4, 0}}};
    for (double u : {0.0, 0.7, 1.0, 1.9}) EXPECT_LT((parabola.position(u) - Vector3(u, u * u, 0)).norm(), 8 * epsilon);
    const Curve line = Spline{.points = {{1, 1, 1}, {3, 2, 3}}};
    EXPECT_NEAR(line.length(0.0, 0.5), 1.5, 4 * epsilon);
    EXPECT_EQ(line.curvature(0.3), 0.0);
    EXPECT_TRUE(line.straight());
    EXPECT_EQ(line.frenet(0.3).normal, Curve(Line{.direction = {2, 1, 2}}).frenet(0.0).normal);
}

TEST(Spline, of_points_on_a_circle_comes_near_it_with_the_fourth_power_of_their_distance) {
    const auto error = [](int n) {
        std::vector<Vector3> points;
        const double step = 2.0 * std::acos(-1.0) / n;
        for (int k = 0; k < n; ++k) points.emplace_back(std::cos(k * step), std::sin(k * step), 0.0);
        const Curve spline = Spline{.points = points, .closed = true};
        return std::abs(spline.length(0.0, n) - 2.0 * std::acos(-1.0));
    };
    // the length's error is h^4/720 of the circumference
    EXPECT_NEAR(error(32) / error(64), 16.0, 0.3);
    EXPECT_LT(error(64), 1e-6);
}

TEST(Spline, with_a_slope_given_has_that_slope_and_may_jump_in_curvature_there_alone) {
    // a straight of two stretches, then a bend
    const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0.5, 0}, {3.5, 1.5, 0}, {3.5, 2.5, 0}};
    const Curve rail = Spline{.points = points, .slopes = {{2, {1, 0, 0}}}};
    EXPECT_EQ(rail.first(2.0), Vector3(1, 0, 0));
    EXPECT_LT(first(rail, 2.0).jump(), tolerance(2.0));
    EXPECT_GT(second(rail, 2.0).jump(), 0.1);
    EXPECT_LT(second(rail, 3.0).jump(), tolerance(3.0));
    for (double u : {0.0, 0.3, 1.0, 1.999}) {
        EXPECT_EQ(rail.curvature(u), 0.0) << u;
        EXPECT_LT((rail.position(u) - Vector3(u, 0, 0)).norm(), 2 * epsilon) << u;
    }
    EXPECT_GT(rail.curvature(2.0), 0.1);

    // clamped ends
    const Curve clamped = Spline{.points = points, .slopes = {{0, {0, 1, 0}}, {5, {-1, 0, 0}}}};
    EXPECT_EQ(clamped.first(0.0), Vector3(0, 1, 0));
    EXPECT_LT((clamped.first(5.0) - Vector3(-1, 0, 0)).norm(), 32 * epsilon);
    for (int k = 1; k < 5; ++k) EXPECT_LT(second(clamped, k).jump(), tolerance(k)) << k;

    // both slopes of one stretch: Hermite's cubic
    const Curve hermite = Spline{.points = {{0, 0, 0}, {1, 0, 0}}, .slopes = {{0, {1, 1, 0}}, {1, {1, 1, 0}}}};
    for (double u : {0.2, 0.5, 0.9})
        EXPECT_LT((hermite.position(u) - Vector3(u, u * (1 - u) * (1 - 2 * u), 0)).norm(), 4 * epsilon);
    // one slope and a free end: a parabola
    const Curve quadratic = Spline{.points = {{0, 0, 0}, {1, 1, 0}}, .slopes = {{1, {1, 2, 0}}}};
    for (double u : {0.2, 0.5, 0.9}) EXPECT_LT((quadratic.position(u) - Vector3(u, u * u, 0)).norm(), 4 * epsilon);

    // closed: the seam is a point like any other
    for (const int place : {0, 3}) {
        const Curve closed = Spline{.points = bend, .closed = true, .slopes = {{place, {1, 1, 1}}}};
        for (int k = 0; k < 14; ++k) {
            EXPECT_LT((closed.position(k) - bend[static_cast<std::size_t>(k % 7)]).norm(), 16 * epsilon);
            EXPECT_LT(first(closed, k).jump(), tolerance(k)) << k;
            if (k % 7 == place)
                EXPECT_GT(second(closed, k).jump(), 1e-3);
            else
                EXPECT_LT(second(closed, k).jump(), tolerance(k)) << k;
        }
        EXPECT_LT((closed.first(place) - Vector3(1, 1, 1)).norm(), 8 * epsilon);
    }
}

TEST(Spline, keeps_the_frame_of_the_last_bend_along_a_straight_stretch) {
    // a bend in the plane x y, a straight, a bend upward
    const Curve rail = Spline{.points = {{-1, -1, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 1}},
                              .slopes = {{1, {1, 0, 0}}, {3, {1, 0, 0}}}};
    EXPECT_LT((rail.frenet(0.5).binormal + Vector3::UnitZ()).norm(), 8 * epsilon);
    for (double u : {1.0, 1.5, 2.0, 2.75}) {
        const Frenet f = rail.frenet(u);
        EXPECT_EQ(rail.curvature(u), 0.0);
        EXPECT_LT((f.tangent - Vector3::UnitX()).norm(), 8 * epsilon);
        EXPECT_LT((f.binormal + Vector3::UnitZ()).norm(), 8 * epsilon) << u;
    }
    EXPECT_LT((rail.frenet(3.5).binormal + Vector3::UnitY()).norm(), 8 * epsilon);
    // nothing bends before: as on a line
    const Curve begins =
        Spline{.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 1, 0}, {4, 3, 1}}, .slopes = {{2, {1, 0, 0}}}};
    EXPECT_EQ(begins.frenet(0.7).normal, Vector3::UnitZ());
    EXPECT_EQ(begins.torsion(0.7), 0.0);
}

TEST(Spline, lengths_add_up_over_stretches_and_rounds) {
    for (const Curve& spline : {Curve(Spline{.points = bend}), Curve(Spline{.points = bend, .closed = true})}) {
        double sum = 0.0;
        for (int k = 0; k < 12; ++k) sum += spline.length(0.5 * k, 0.5 * (k + 1));
        EXPECT_NEAR(spline.length(0.0, 6.0), sum, 32 * epsilon * sum);
        EXPECT_EQ(spline.length(6.0, 0.0), -spline.length(0.0, 6.0));
        for (double s : {1e-6, 0.3, 2.0, 5.0}) {
            const double u = spline.parameter_at(0.25, s);
            EXPECT_NEAR(spline.length(0.25, u), s, 16 * epsilon * 10.0);
        }
    }
    const Curve closed = Spline{.points = bend, .closed = true};
    const double round = closed.length(0.0, 7.0);
    EXPECT_NEAR(closed.length(0.5, 7000.5), 1000.0 * round, 1e-12 * 1000.0 * round);
    EXPECT_NEAR(closed.parameter_at(0.0, 100.0 * round), 700.0, 700.0 * 16 * epsilon);
}

TEST(Spline, in_other_units_and_along_other_axes_keeps_every_bit) {
    const double scale = 0x1p-11;
    const auto turned = [](const Vector3& v) { return Vector3(v.z(), v.x(), v.y()); };
    for (const bool closed : {false, true}) {
        const Curve one = Spline{.points = bend, .closed = closed};
        const Curve other =
            Spline{.points = mapped(bend, [&](const Vector3& p) { return Vector3(scale * p); }), .closed = closed};
        const Curve around = Spline{.points = mapped(bend, turned), .closed = closed};
        for (double u : {0.0, 0.3, 1.0, 2.7, 5.5}) {
            EXPECT_EQ(other.position(u), scale * one.position(u));
            EXPECT_EQ(other.frenet(u).normal, one.frenet(u).normal);
            EXPECT_EQ(scale * other.curvature(u), one.curvature(u));
            EXPECT_EQ(other.length(0.0, u), scale * one.length(0.0, u));
            EXPECT_EQ(around.position(u), turned(one.position(u)));
        }
        // far from the origin, by what a double can hold exactly
        const Curve moved =
            Spline{.points = mapped(bend, [](const Vector3& p) { return Vector3(p + Vector3(1024, -512, 0)); }),
                   .closed = closed};
        for (double u : {0.3, 2.7, 5.5}) EXPECT_EQ(moved.first(u), one.first(u));
    }
}

TEST(Spline, of_points_in_a_tilted_plane_or_on_a_line_stays_in_it_exactly) {
    const Vector3 x(1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0), y(-2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0);
    std::vector<Vector3> plane, line;
    for (int k = 0; k < 7; ++k) {
        plane.push_back(Vector3(0.1, 0.2, 0.3) + 0.7 * k * x + 0.3 * k * (5 - k) * y);
        line.push_back(Vector3(0.1, 0.2, 0.3) + (0.7 * k + 0.1 * k * k) * x);
    }
    const Curve flat = Spline{.points = plane}, straight = Spline{.points = line};
    EXPECT_FALSE(flat.straight());
    EXPECT_TRUE(straight.straight());
    for (double u : {0.0, 0.4, 3.3, 5.9}) {
        EXPECT_EQ(flat.own(u).position.z(), 0.0);
        EXPECT_EQ(flat.own(u).second.z(), 0.0);
        EXPECT_EQ(flat.torsion(u), 0.0);
        EXPECT_LT(std::abs(flat.position(u).dot(x.cross(y)) - plane[0].dot(x.cross(y))), 16 * epsilon);
        EXPECT_EQ(straight.own(u).first.tail(2), Eigen::Vector2d::Zero());
        EXPECT_EQ(straight.curvature(u), 0.0);
    }
    // upright, along axes of the world
    const Curve upright = Spline{.points = {{0, 3, 2}, {1, 3, 1}, {2, 3, 1.5}, {3, 3, 0}, {4, 3, 0}}};
    EXPECT_EQ(upright.placement().axes.col(1), Vector3::UnitZ());
    EXPECT_EQ(upright.position(2.2).y(), 3.0);
}

TEST(Spline, is_recorded_as_the_cubic_of_one_stretch) {
    const Curve spline = Spline{.points = bend};
    for (const auto& [u, choice] : {std::pair{1.2, 1L}, std::pair{0.1, 1L}, std::pair{2.0, 2L}, std::pair{5.9, 4L}}) {
        rbdyn::Recorder recorder;
        recorder.follow(0.0, std::array{u}, {});
        const auto p = spline.own(recorder.input(0));
        ASSERT_EQ(recorder.branches().size(), 1u);
        EXPECT_EQ(recorder.branches()[0].choice, choice);
        EXPECT_EQ(recorder.branches()[0].name, "") << "a change of stretch is no event";
        EXPECT_EQ(recorder.branches()[0].has_lower(), choice > 1) << "the first inner point is no knot";
        EXPECT_EQ(recorder.branches()[0].has_upper(), choice < 4);
        const std::vector<Expression> outputs{p.position[0], p.first[1], p.second[2]};
        EXPECT_GT(rbdyn::Program(recorder, outputs, 1).instructions().size(), 0u);
    }
    // four points: one cubic, no choice
    rbdyn::Recorder recorder;
    (void)Curve(Spline{.points = {{0, 0, 0}, {1, 1, 0}, {2, 0, 1}, {3, 0, 0}}}).own(recorder.input(0));
    EXPECT_TRUE(recorder.branches().empty());
}

TEST(Spline, of_a_thousand_random_points_is_as_smooth_as_one_of_ten) {
    std::vector<Vector3> points;
    double a = 0.5, b = 0.3, c = 0.2;
    for (int k = 0; k < 1000; ++k) {
        // a chaotic sequence serves as well as random numbers
        points.emplace_back(a = 3.9 * a * (1 - a), b = 3.9 * b * (1 - b), c = 3.9 * c * (1 - c));
    }
    for (const bool closed : {false, true}) {
        const Curve spline = Spline{.points = points, .closed = closed};
        for (int k = 2; k < 998; ++k) {
            EXPECT_LT((spline.position(k) - points[static_cast<std::size_t>(k)]).norm(), 8 * epsilon);
            EXPECT_LT(second(spline, k).jump(), tolerance(k)) << k;
        }
    }
}

}  // namespace

}  // namespace rbdyn::test::test_spline
