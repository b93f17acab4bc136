// Numbers that make no curve are refused, in a message that contains the number.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "rbdyn/curve/curve.hpp"

namespace {

using rbdyn::Circle, rbdyn::Curve, rbdyn::Helix, rbdyn::InvalidInput, rbdyn::Line, rbdyn::Polynomial;

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
