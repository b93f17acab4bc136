// Numbers that make no curve are refused, in a message that contains the number.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "rbdyn/curve/curve.hpp"

namespace rbdyn::test::test_invalid {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Expects InvalidInput whose message contains all of the words.
template <class Function>
void expect_refused(const Function& function, std::initializer_list<std::string> words) {
    try {
        function();
    } catch (const InvalidInput& error) {
        for (const std::string& word : words)
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " not in: " << error.what();
        return;
    }
    ADD_FAILURE() << "accepted: " << *words.begin();
}

template <class Kind>
void expect_no_curve(const Kind& kind, std::initializer_list<std::string> words) {
    expect_refused([&] { kind.validate(); }, words);
    expect_refused([&] { Curve{kind}; }, words);
}

TEST(CurveInput, a_line_without_direction_is_refused) {
    expect_no_curve(Line{}, {"line", "direction is 0;"});
    expect_no_curve(Line{.direction = {1, infinity, 0}}, {"direction[1] is inf"});
    expect_no_curve(Line{.direction = {1, 0, 0}, .point = {0, 0, std::nan("")}}, {"point[2] is nan"});
    EXPECT_NO_THROW(Curve(Line{.direction = {1e-300, 2e-300, 0}}));
    EXPECT_NO_THROW(Curve(Line{.direction = {1e300, 2e300, 0}}));
}

TEST(CurveInput, a_circle_of_no_size_or_no_plane_is_refused) {
    expect_no_curve(Circle{.radius = -1.5, .start = {1, 0, 0}, .toward = {0, 1, 0}}, {"circle", "radius is -1.5;"});
    expect_no_curve(Circle{.radius = 0.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}, {"radius is 0;"});
    expect_no_curve(Circle{.radius = infinity, .start = {1, 0, 0}, .toward = {0, 1, 0}}, {"radius is inf;"});
    expect_no_curve(Circle{.radius = 1.0, .start = {0, 0, 0}, .toward = {0, 1, 0}}, {"length of start is 0;"});
    expect_no_curve(Circle{.radius = 1.0, .start = {1, 0, 0}}, {"length of toward is 0;"});
    expect_no_curve(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {-2, 0, 0}}, {"angle", "is 0;", "parallel"});
    expect_no_curve(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {1, 1e-9, 0}},
                    {"angle", "is 1e-09;", "parallel"});
    expect_no_curve(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}, .center = {infinity, 0, 0}},
                    {"center[0] is inf"});
}

TEST(CurveInput, a_helix_that_is_a_circle_is_refused_with_advice) {
    expect_no_curve(Helix{.radius = 1.0, .pitch = 0.0, .start = {1, 0, 0}, .toward = {0, 1, 0}},
                    {"helix", "pitch is 0;", "Circle"});
    expect_no_curve(Helix{.radius = 1.0, .pitch = std::nan(""), .start = {1, 0, 0}, .toward = {0, 1, 0}},
                    {"pitch is nan"});
    expect_no_curve(Helix{.radius = -2.0, .pitch = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}, {"radius is -2;"});
    expect_no_curve(Helix{.radius = 2.0, .pitch = 1.0, .start = {1, 1, 1}, .toward = {2, 2, 2}}, {"is 0;", "parallel"});
}

TEST(CurveInput, a_polynomial_that_stays_at_one_point_is_refused) {
    expect_no_curve(Polynomial{}, {"polynomial", "number of coefficients is 0;"});
    expect_no_curve(Polynomial{.coefficients = {{1, 2, 3}}}, {"number of coefficients is 1;"});
    expect_no_curve(Polynomial{.coefficients = {{1, 2, 3}, {0, 0, 0}, {0, 0, 0}}}, {"is 0;", "single point"});
    expect_no_curve(Polynomial{.coefficients = {{1, 2, 3}, {0, infinity, 0}}}, {"coefficient 1[1] is inf"});
    expect_no_curve(Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}}, .domain = {2.5, 2.5}}, {"is 2.5;", "less"});
    expect_no_curve(Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}}, .domain = {std::nan(""), 1.0}}, {"is nan;"});
}

TEST(CurveInput, a_parabola_that_is_a_line_is_refused_with_advice) {
    expect_no_curve(Parabola{.a = 0.0, .x = {1, 0, 0}, .y = {0, 1, 0}}, {"parabola", "a is 0;", "Line"});
    expect_no_curve(Parabola{.a = infinity, .x = {1, 0, 0}, .y = {0, 1, 0}}, {"a is inf;"});
    expect_no_curve(Parabola{.a = 1.0, .x = {1, 0, 0}, .y = {3, 0, 0}}, {"from x to y is 0;", "parallel to x"});
    expect_no_curve(Parabola{.a = 1.0, .y = {3, 0, 0}}, {"length of x is 0;"});
    expect_no_curve(Parabola{.a = 1.0, .x = {1, 0, 0}, .y = {0, 1, 0}, .vertex = {0, infinity, 0}},
                    {"vertex[1] is inf"});
}

TEST(CurveInput, a_cycloid_of_no_size_or_no_plane_is_refused) {
    expect_no_curve(Cycloid{.radius = -0.5, .x = {1, 0, 0}, .y = {0, 1, 0}}, {"cycloid", "radius is -0.5;"});
    expect_no_curve(Cycloid{.radius = 1.0, .x = {1, 0, 0}}, {"length of y is 0;"});
    expect_no_curve(Cycloid{.radius = 1.0, .x = {1, 0, 0}, .y = {1, 0, 0}}, {"parallel"});
    expect_no_curve(Cycloid{.radius = 1.0, .x = {1, 0, 0}, .y = {0, 1, 0}, .vertex = {std::nan(""), 0, 0}},
                    {"vertex[0] is nan"});
}

TEST(CurveInput, a_spline_needs_points_that_differ) {
    expect_no_curve(Spline{.points = {{1, 2, 3}}}, {"spline", "number of points is 1;", "at least 2"});
    expect_no_curve(Spline{.points = {{1, 2, 3}, {0, 0, 0}}, .closed = true}, {"is 2;", "at least 3"});
    expect_no_curve(Spline{.points = {{1, 2, 3}, {0, infinity, 0}}}, {"point 1[1] is inf"});
    expect_no_curve(Spline{.points = {{1, 2, 3}, {0, 1, 0}, {0, 1, 0}, {1, 1, 1}}},
                    {"distance from point 1 to point 2 is 0;", "differ"});
    expect_no_curve(Spline{.points = {{1, 2, 3}, {0, 1, 0}, {0, 1, 1}, {1, 2, 3}}, .closed = true},
                    {"distance from point 3 to point 0 is 0;", "do not repeat"});
    const std::vector<rbdyn::Vector3> points{{0, 0, 0}, {1, 0, 0}, {2, 1, 0}};
    expect_no_curve(Spline{.points = points, .slopes = {{3, {1, 0, 0}}}}, {"index of a slope is 3;", "0 to 2"});
    expect_no_curve(Spline{.points = points, .slopes = {{-1, {1, 0, 0}}}}, {"index of a slope is -1;"});
    expect_no_curve(Spline{.points = points, .slopes = {{1, {0, 0, 0}}}}, {"slope at point 1 is 0;"});
    expect_no_curve(Spline{.points = points, .slopes = {{1, {0, infinity, 0}}}}, {"slope at point 1[1] is inf"});
}

TEST(CurveInput, a_function_that_makes_no_curve_is_refused) {
    using Point = rbdyn::Vector3Of<Expression>;
    const auto refuse = [](auto f, Domain domain, bool closed, std::initializer_list<std::string> words) {
        const FunctionCurve kind{FunctionCurve::recorded(f), domain, closed, "f"};
        expect_refused([&] { Curve{kind}; }, words);
        expect_refused([&] { Curve(f, domain, closed); }, {"curve of a function: "});
    };
    const auto sine = [](const auto& u) { return Point{u, sin(u), 0.0}; };
    refuse(sine, {1.0, 1.0}, false, {"curve of f", "begin of the domain is 1;"});
    refuse(sine, {std::nan(""), 1.0}, false, {"is nan;"});
    refuse(sine, {}, true, {"an end of the domain is -inf;", "one round"});
    refuse(sine, {0.0, 6.0}, true, {"distance between the ends is 6.0", "ends where it began"});
    refuse(
        [](const auto& u) {
            return Point{sin(u), sin(2.0 * u), 0.0};
        },
        {0.0, 3.141592653589793}, true, {"difference of r' at the ends is 2;", "ends as it began"});
    refuse([](const auto&) { return Point{1.0, 2.0, 3.0}; }, {}, false, {"that depend on the parameter is 0;"});
    refuse(
        [](const auto& u) {
            return Point{pow(sin(u) + 2.0, 0.3) * pow(sin(u) + 2.0, -0.3), 0.0 * u, 3.0};
        },
        {}, false, {"the largest |r'| is 0;", "single point"});
    refuse(
        [](const auto& u) {
            return Point{log(u), u, 0.0};
        },
        {-1.0, 1.0}, false, {"component 0 at parameter -1 is", "finite", "domain"});
    refuse(
        [](const auto& u) {
            return Point{u, 1.0 / (u - 0.5), 0.0};
        },
        {0.0, 1.0}, false, {"component 1 at parameter 0.5 is"});
    refuse(
        [](const auto& u) {
            return Point{u, sqrt(u), 0.0};
        },
        {0.0, 1.0}, false, {"r' of component 1 at parameter 0"});

    const auto two = rbdyn::Function::record(1, [](const std::vector<Expression>& u) { return u; });
    expect_no_curve(FunctionCurve{two, {}, false, {}}, {"number of components is 1;"});
    const auto both = rbdyn::Function::record(2, [](const std::vector<Expression>& u) { return u; });
    expect_no_curve(FunctionCurve{both, {}, false, {}}, {"number of arguments is 2;"});
    expect_no_curve(FunctionCurve{}, {"number of arguments is 0;"});
}

TEST(CurveInput, a_cusp_has_no_tangent) {
    // (u^2, u^3), and the same with its cusp at u = 1
    const Curve cusp = Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const Curve moved = Polynomial{.coefficients = {{1, -1, 0}, {-2, 3, 0}, {1, -3, 0}, {0, 1, 0}}};
    expect_refused([&] { cusp.require_regular(0.0); }, {"polynomial of degree 3", "parameter is 0;", "cusp"});
    expect_refused([&] { moved.require_regular(1.0); }, {"parameter is 1;", "cusp"});
    expect_refused([&] { cusp.frenet(0.0); }, {"cusp"});
    expect_refused([&] { cusp.curvature(0.0); }, {"cusp"});
    expect_refused([&] { cusp.torsion(0.0); }, {"cusp"});
    EXPECT_NO_THROW(cusp.require_regular(1e-100));
    EXPECT_NO_THROW(moved.require_regular(1.0 + 1e-12));
    expect_refused([&] { cusp.require_regular(infinity); }, {"parameter is inf"});
}

}  // namespace

}  // namespace rbdyn::test::test_invalid
