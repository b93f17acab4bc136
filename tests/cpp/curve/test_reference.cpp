// Curves against reference digits: tests/reference/f_*.json, 25 digits or more.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "rbdyn/curve/curve.hpp"

namespace rbdyn::test::test_reference {

namespace {

// parameters and arc lengths are read as doubles, so that each value differs by a few units in the last place times
// the slope of what is compared; slopes are below 10 in these files
constexpr double tolerance = 4e-15;

double number(const nlohmann::json& value) { return std::stod(value.get<std::string>()); }
Vector3 vector(const nlohmann::json& value) { return {number(value[0]), number(value[1]), number(value[2])}; }

nlohmann::json values(const std::string& name) {
    std::ifstream file(std::string(RBDYN_TEST_REFERENCE) + "/" + name + ".json");
    EXPECT_TRUE(file.good()) << name;
    return nlohmann::json::parse(file)["values"];
}

std::vector<nlohmann::json> instants(const nlohmann::json& reference) {
    std::vector<nlohmann::json> all{reference["initial"]};
    for (const auto& sample : reference["samples"]) all.push_back(sample);
    return all;
}

void expect_near(const Vector3& value, const Vector3& reference, double scale, const char* what) {
    EXPECT_LT((value - reference).cwiseAbs().maxCoeff(), tolerance * scale) << what;
}

void expect_bent_curve(const Curve& curve, const std::string& name) {
    const nlohmann::json reference = values(name);
    const double u0 = number(reference["initial"]["u"]);
    for (const nlohmann::json& now : instants(reference)) {
        const double u = number(now["u"]), s = number(now["s"]), scale = std::max(1.0, std::abs(s));
        SCOPED_TRACE(name + " at u = " + now["u"].get<std::string>());
        expect_near(curve.position(u), vector(now["position"]), scale, "position");
        EXPECT_NEAR(curve.length(u0, u), s, tolerance * scale);
        EXPECT_NEAR(curve.parameter_at(u0, s), u, tolerance * scale);
        const Frenet frame = curve.frenet(u);
        expect_near(frame.tangent, vector(now["tangent"]), 1.0, "tangent");
        expect_near(frame.normal, vector(now["normal"]), 1.0, "normal");
        expect_near(frame.binormal, vector(now["binormal"]), 1.0, "binormal");
        const double curvature = number(now["curvature"]);
        // plane curves have no entry for it beyond the first
        const double torsion = now.contains("torsion") ? number(now["torsion"]) : 0.0;
        EXPECT_NEAR(curve.curvature(u), curvature, tolerance * std::max(1.0, curvature));
        EXPECT_NEAR(curve.torsion(u), torsion, tolerance * std::max(1.0, std::abs(torsion)));
    }
}

TEST(CurveReference, a_vertical_circle_has_the_reference_frame_curvature_and_arc_length) {
    expect_bent_curve(Circle{.radius = 0.75, .start = {0, 0, -1}, .toward = {1, 0, 0}}, "f_circle_libration");
}

TEST(CurveReference, a_helix_has_the_reference_frame_curvature_torsion_and_arc_length) {
    const double pitch = 2.0 * std::numbers::pi * 0.25;
    expect_bent_curve(Helix{.radius = 0.5, .pitch = pitch, .start = {1, 0, 0}, .toward = {0, 1, 0}}, "f_helix");
}

TEST(CurveReference, a_twisted_cubic_has_the_reference_frame_curvature_torsion_and_arc_length) {
    expect_bent_curve(Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, "f_twisted_cubic");
}

TEST(CurveReference, a_helix_pushed_round_has_the_reference_frame_also_when_it_is_given_as_a_function) {
    const double pitch = 2.0 * std::numbers::pi * 0.25;
    expect_bent_curve(Helix{.radius = 0.5, .pitch = pitch, .start = {1, 0, 0}, .toward = {0, 1, 0}}, "f_helix_swirl");
    const Curve helix([](const auto& u) { return Vector3Of<Expression>{0.5 * cos(u), 0.5 * sin(u), 0.25 * u}; });
    expect_bent_curve(helix, "f_helix_swirl");
}

TEST(CurveReference, a_parabola_has_the_reference_frame_curvature_and_arc_length) {
    expect_bent_curve(Parabola{.a = 0.75, .x = {1, 0, 0}, .y = {0, 0, 1}}, "f_parabola");
    expect_bent_curve(Curve([](const auto& u) { return Vector3Of<Expression>{u, 0.0, 0.75 * u * u}; }), "f_parabola");
}

TEST(CurveReference, a_cycloid_has_the_reference_frame_curvature_and_arc_length) {
    expect_bent_curve(Cycloid{.radius = 0.5, .x = {1, 0, 0}, .y = {0, 0, 1}}, "f_cycloid");
}

TEST(CurveReference, a_line_and_a_polynomial_of_degree_one_are_the_reference_line) {
    const nlohmann::json reference = values("f_line");
    const Curve by_length = Line{.direction = {1, 2, -2}};
    const Curve by_coefficient = Polynomial{.coefficients = {{0, 0, 0}, {1, 2, -2}}};
    for (const nlohmann::json& now : instants(reference)) {
        const double u = number(now["u"]), s = number(now["s"]), scale = std::max(1.0, std::abs(s));
        SCOPED_TRACE("at u = " + now["u"].get<std::string>());
        expect_near(by_length.position(s), vector(now["position"]), scale, "position by length");
        expect_near(by_coefficient.position(u), vector(now["position"]), scale, "position");
        expect_near(by_length.frenet(s).tangent, vector(now["tangent"]), 1.0, "tangent by length");
        expect_near(by_coefficient.frenet(u).tangent, vector(now["tangent"]), 1.0, "tangent");
        EXPECT_NEAR(by_coefficient.length(0.0, u), s, tolerance * scale);
        EXPECT_NEAR(by_coefficient.parameter_at(0.0, s), u, tolerance * scale);
        EXPECT_EQ(by_length.length(0.0, s), s);
        EXPECT_EQ(by_length.curvature(s), 0.0);
        EXPECT_EQ(by_coefficient.curvature(u), 0.0);
    }
}

}  // namespace

}  // namespace rbdyn::test::test_reference
