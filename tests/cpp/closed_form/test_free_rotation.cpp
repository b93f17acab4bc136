// The free rotation against reference digits, against an integration in 32 digits, and against what must be conserved.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "closed_form/free_body.hpp"
#include "support.hpp"

namespace rbdyn::test::test_free_rotation {
namespace {

using Json = nlohmann::json;
using Regime = FreeRotation::Regime;

// what is promised, for the exact doubles given
constexpr double accuracy = 2e-15;
// an honest estimate is not exceeded by more
constexpr double honesty = 10.0;

Json read(const std::string& name) {
    std::ifstream file(std::string(RBDYN_TEST_REFERENCE) + "/" + name + ".json");
    EXPECT_TRUE(file.good()) << name;
    return Json::parse(file);
}
double number(const Json& value) { return std::stod(value.get<std::string>()); }
Vector3 vector(const Json& value) { return {number(value[0]), number(value[1]), number(value[2])}; }

/// A decimal to 32 digits.
Wide wide(const Json& value) {
    const std::string digits = value.get<std::string>();
    const std::size_t e = std::min(digits.find_first_of("eE"), digits.size());
    int exponent = e < digits.size() ? std::stoi(digits.substr(e + 1)) : 0;
    Wide result, ten = 1.0;
    bool fraction = false;
    for (const char c : digits.substr(0, e)) {
        if (c == '.') fraction = true;
        if (c < '0' || c > '9') continue;
        result = result * 10.0 + static_cast<double>(c - '0');
        if (fraction) --exponent;
    }
    for (int i = 0; i < std::abs(exponent); ++i) ten *= 10.0;
    result = exponent < 0 ? result / ten : result * ten;
    return digits[0] == '-' ? -result : result;
}
Vector3Of<Wide> wide_vector(const Json& value) { return {wide(value[0]), wide(value[1]), wide(value[2])}; }
WideQuaternion wide_quaternion(const Json& value) {
    return {wide(value[0]), wide(value[1]), wide(value[2]), wide(value[3])};
}

Matrix3Of<Wide> diagonal(const Vector3& moments) { return rbdyn::widened(Matrix3(moments.asDiagonal())); }

void expect_state(const FreeRotation& motion, double t, const WideQuaternion& attitude, const Vector3Of<Wide>& omega,
                  double speed) {
    const FreeRotation::State state = motion.at(t);
    const double error =
        std::max(largest_difference(omega, state.angular_velocity) / speed, angle_between(attitude, state.attitude));
    EXPECT_LT(error, std::max(accuracy, honesty * motion.error(t)));
    EXPECT_LT(error, honesty * motion.error(t));
}

FreeRotation reference_motion(const Json& reference) {
    const Json& p = reference["parameters"];
    const auto parameter = [&](const char* name) { return number(p[name]["value"]); };
    const bool symmetric = p.contains("I1_eq_I2");
    const Vector3 moments(parameter(symmetric ? "I1_eq_I2" : "I1"), parameter(symmetric ? "I1_eq_I2" : "I2"),
                          parameter("I3"));
    const Json& q = reference["values"]["initial"]["quaternion_body_to_world"];
    return {diagonal(moments),
            {number(q[0]), number(q[1]), number(q[2]), number(q[3])},
            {parameter("omega0_1"), parameter("omega0_2"), parameter("omega0_3")}};
}

TEST(FreeRotation, follows_the_reference_cases_to_rounding_at_every_time) {
    for (const char* name :
         {"a_generic_axis1", "a_generic_axis3", "a_near_separatrix", "b_permanent_axis1", "b_permanent_axis2",
          "b_permanent_axis3", "b_perturbed_axis2", "b_perturbed_axis3", "c_earth", "c_oblate", "c_prolate"}) {
        const Json values = read(name)["values"];
        const FreeRotation motion = reference_motion(read(name));
        // the turn since the start, after the start as rounded to doubles
        const WideQuaternion first = unit(widened(motion.at(0.0).attitude));
        const WideQuaternion exact_first = wide_quaternion(values["initial"]["quaternion_body_to_world"]);
        const double speed = motion.at(0.0).angular_velocity.norm();
        for (const Json& sample : values["samples"]) {
            SCOPED_TRACE(std::string(name) + " at " + sample["t"].get<std::string>());
            const WideQuaternion now = wide_quaternion(sample["quaternion_body_to_world"]);
            expect_state(motion, number(sample["t"]), first * (conjugate(exact_first) * now),
                         wide_vector(sample["omega_body"]), speed);
            EXPECT_LT(motion.error(number(sample["t"])), accuracy);
        }
        if (values.contains("period_of_omega")) {
            EXPECT_NEAR(motion.period() / number(values["period_of_omega"]), 1.0, 4 * epsilon) << name;
        }
    }
}

TEST(FreeRotation, holds_fifteen_digits_to_a_million_seconds_whatever_the_body_and_the_start) {
    const Json cases = read("free_bodies")["cases"];
    EXPECT_EQ(cases.size(), 72u);
    for (const Json& c : cases) {
        const Vector3 omega = vector(c["omega0"]);
        const FreeRotation motion(diagonal(vector(c["moments"])), {}, omega);
        SCOPED_TRACE(c.dump());
        const double t = number(c["t"]);
        expect_state(motion, t, wide_quaternion(c["quaternion"]), wide_vector(c["omega"]), omega.norm());
        EXPECT_LT(motion.error(t), accuracy);
        EXPECT_NEAR(motion.period() / number(c["period"]), 1.0, 4 * epsilon);
    }
}

TEST(FreeRotation, of_a_body_whose_axes_are_turned_is_as_good_as_its_estimate) {
    const Json cases = read("free_bodies")["turned"];
    EXPECT_EQ(cases.size(), 36u);
    for (const Json& c : cases) {
        Matrix3 inertia;
        for (int i = 0; i < 9; ++i) inertia(i / 3, i % 3) = number(c["inertia"][static_cast<std::size_t>(i)]);
        const Vector3 omega = vector(c["omega0"]);
        const FreeRotation motion(rbdyn::widened(inertia), {}, omega);
        SCOPED_TRACE(c.dump());
        expect_state(motion, number(c["t"]), wide_quaternion(c["quaternion"]), wide_vector(c["omega"]), omega.norm());
    }
}

struct Drawn {
    Vector3 moments, omega;
};

/// A body and a start of every kind: some moments nearly equal or equal, rods and plates, near an axis, near the
/// separatrix.
Drawn drawn(Random& random) {
    Vector3 moments(1.0, 2.0, 3.0);
    switch (random.whole(0, 5)) {
        case 0: {
            const Vector3 x(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1));
            moments = {x[1] + x[2], x[0] + x[2], x[0] + x[1]};
            break;
        }
        case 1: moments = {1.0, 1.0 + random.logarithmic(1e-15, 0.1), random.uniform(0.2, 1.9)}; break;
        case 2: moments = {1.0, 1.0 + random.logarithmic(1e-14, 0.1), 1.0 - random.logarithmic(1e-14, 0.1)}; break;
        case 3: {
            const double thin = random.logarithmic(1e-12, 0.1);
            moments = {thin, 1.0, 1.0 + random.uniform(0.0, 1.0) * thin};
            break;
        }
        case 4: moments = {1.0, 1.0, random.logarithmic(1e-6, 2.0)}; break;
        default: break;
    }
    for (int i = 0; i < 3; ++i) std::swap(moments[i], moments[random.whole(0, 2)]);
    moments *= random.logarithmic(1e-3, 1e3);

    int least = 0, most = 0;
    moments.minCoeff(&least);
    moments.maxCoeff(&most);
    if (least == most) most = (least + 1) % 3;
    const int middle = 3 - least - most;
    Vector3 omega = random.direction();
    switch (random.whole(0, 3)) {
        case 0: omega[least] *= random.logarithmic(1e-12, 0.1), omega[most] *= random.logarithmic(1e-12, 0.1); break;
        case 1: omega[middle] *= random.logarithmic(1e-12, 0.1), omega[least] *= random.logarithmic(1e-12, 0.1); break;
        case 2: {
            const double a = moments[least], b = moments[middle], c = moments[most];
            if (a < b) omega[least] = std::sqrt(c * (c - b) / (a * (b - a))) * omega[most];
            omega[least] *= 1.0 + random.uniform(-1.0, 1.0) * random.logarithmic(1e-16, 0.1);
            break;
        }
        default: break;
    }
    return {moments, omega.normalized() * random.logarithmic(0.01, 100.0)};
}

TEST(FreeRotation, agrees_with_an_integration_in_thirty_two_digits) {
    Random random(7);
    for (int i = 0; i < setting("RBDYN_TEST_FREE_BODIES", 150); ++i) {
        const auto [moments, omega] = drawn(random);
        const Quaternion q{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        const FreeRotation motion(diagonal(moments), q, omega);
        // the integration loses its digits slowly where the motion is unstable
        const double t = random.logarithmic(0.1, 30.0) / omega.norm();
        SCOPED_TRACE(testing::Message() << "moments " << moments.transpose() << " omega " << omega.transpose());
        for (const double end : {t, -t}) {
            WideIntegration exact(rbdyn::widened(moments), unit(widened(q)), rbdyn::widened(omega));
            exact.advance(end);
            expect_state(motion, end, exact.attitude, exact.omega, omega.norm());
        }
    }
}

TEST(FreeRotation, starts_from_exactly_the_state_given) {
    Random random(3);
    for (int i = 0; i < 20; ++i) {
        const auto [moments, omega] = drawn(random);
        const Matrix3 r = rotation_matrix(turn(random.direction(), 1.0));
        const Matrix3 inertia = r * moments.asDiagonal() * r.transpose();
        const Quaternion q = normalized({0.3, -0.4, 0.5, random.uniform(-1, 1)});
        const FreeRotation motion(rbdyn::widened(Matrix3(0.5 * (inertia + inertia.transpose()))), q, omega);
        EXPECT_EQ(motion.at(0.0).angular_velocity, omega);
        const Quaternion first = motion.at(0.0).attitude;
        for (const auto& [a, b] : {std::pair(first.w, q.w), {first.x, q.x}, {first.y, q.y}, {first.z, q.z}})
            EXPECT_LE(std::abs(a - b), epsilon);
        // and leaves it without a jump or a change of sign
        const FreeRotation::State soon = motion.at(1e-17 / omega.norm());
        EXPECT_LT((soon.angular_velocity - omega).norm(), 4 * epsilon * omega.norm());
        EXPECT_LT(std::sqrt(squared_norm(Quaternion{soon.attitude.w - q.w, soon.attitude.x - q.x, soon.attitude.y - q.y,
                                                    soon.attitude.z - q.z})),
                  4 * epsilon);
    }
}

TEST(FreeRotation, has_quaternions_continuous_in_time) {
    for (const Vector3& omega : {Vector3(1e-3, 1, 0), Vector3(1, 0.2, 0.1), Vector3(0.1, -0.2, -1), Vector3(0, 1, 0)}) {
        const FreeRotation motion(diagonal({1, 2, 3}), {}, omega);
        Quaternion before = motion.at(0.0).attitude;
        for (int i = 1; i < 4000; ++i) {
            const Quaternion q = motion.at(0.05 * i).attitude;
            // half the angle turned by since
            const double moved =
                std::sqrt(squared_norm(Quaternion{q.w - before.w, q.x - before.x, q.y - before.y, q.z - before.z}));
            ASSERT_LT(moved, 0.05 * 0.5 * 1.5 * omega.norm()) << i;
            before = q;
        }
    }
}

TEST(FreeRotation, keeps_energy_and_angular_momentum_over_a_million_seconds) {
    for (const Vector3& omega : {Vector3(1e-3, 1, 0), Vector3(1e-12, 1, 0), Vector3(0.6, 0.5, 0.4)}) {
        const Vector3 moments(1, 2, 3);
        const FreeRotation motion(diagonal(moments), {}, omega);
        const Vector3 k = moments.cwiseProduct(omega);
        const double energy2 = omega.dot(k);
        for (int i = 0; i <= 1000; ++i) {
            const double t = 1000.0 * i;
            const auto [q, w] = motion.at(t);
            const Vector3 now = moments.cwiseProduct(w);
            EXPECT_LT((rotation_matrix(q) * now - k).norm(), 4e-15 * k.norm()) << t;
            EXPECT_NEAR(w.dot(now) / energy2, 1.0, 2e-15) << t;
            EXPECT_NEAR(squared_norm(q), 1.0, 2e-15) << t;
        }
    }
}

TEST(FreeRotation, flips_about_the_intermediate_axis_with_the_known_periods) {
    // of decimals, whose doubles differ by half a unit in the last place
    EXPECT_NEAR(FreeRotation(diagonal({1, 2, 3}), {}, {0.1, 1, 0}).period(), 25.510977876634716929, 1e-14);
    EXPECT_NEAR(FreeRotation(diagonal({1, 2, 3}), {}, {1e-3, 1, 0}).period(), 57.462848874962666871, 2e-14);
    EXPECT_NEAR(FreeRotation(diagonal({1, 2, 3}), {}, {1e-6, 1, 0}).period(), 105.32119394639243715, 4e-14);
}

TEST(FreeRotation, on_the_separatrix_goes_to_the_intermediate_axis_and_stays) {
    // A (B - A) w1^2 = C (C - B) w3^2 exactly: 0.75^2 = 2.25 0.25
    const Vector3 moments(1.0, 2.0, 2.25), omega(0.75, 0.5, 1.0);
    const FreeRotation motion(diagonal(moments), {}, omega);
    EXPECT_EQ(motion.regime(), Regime::separatrix);
    EXPECT_EQ(motion.period(), INFINITY);
    WideIntegration exact(rbdyn::widened(moments), {1.0, 0.0, 0.0, 0.0}, rbdyn::widened(omega));
    for (double t : {0.5, 3.0, 9.0, 20.0}) {
        exact.advance(t);
        expect_state(motion, t, exact.attitude, exact.omega, omega.norm());
    }
    // |K| = B omega_2 at the end, whence it turns at |K|/B
    const double end = moments.cwiseProduct(omega).norm() / 2.0;
    for (double t : {-1e6, 1e6}) {
        const Vector3 last = motion.at(t).angular_velocity;
        EXPECT_LT((last.cwiseAbs() - Vector3(0, end, 0)).norm(), accuracy * end) << last.transpose();
    }
    EXPECT_NEAR(motion.precession_rate(), end, accuracy);
    EXPECT_LT(motion.at(-1e6).angular_velocity[1] * motion.at(1e6).angular_velocity[1], 0.0);
}

TEST(FreeRotation, about_a_principal_axis_or_of_a_sphere_never_changes) {
    for (int axis = 0; axis < 3; ++axis) {
        const FreeRotation motion(diagonal({1, 2, 3}), {}, -0.7 * Vector3::Unit(axis));
        EXPECT_EQ(motion.regime(), Regime::permanent);
        EXPECT_EQ(motion.at(1e9).angular_velocity, -0.7 * Vector3::Unit(axis));
        const double half = std::remainder(-0.35 * 1e6, 2.0 * std::numbers::pi);
        const Quaternion q = motion.at(1e6).attitude;
        // 0.35e6 in doubles and its remainder after 2 pi, to 1e-10
        EXPECT_NEAR(std::abs(q.w), std::abs(std::cos(half)), 1e-10);
        EXPECT_NEAR(motion.precession_rate(), 0.7, epsilon);
    }
    const Vector3 omega(0.1, -0.7, 0.3);
    const FreeRotation sphere(diagonal({0.4, 0.4, 0.4}), {}, omega);
    EXPECT_EQ(sphere.at(12345.678).angular_velocity, omega);
    const FreeRotation rest(diagonal({1, 2, 3}), {}, Vector3::Zero());
    EXPECT_EQ(rest.regime(), Regime::rest);
    EXPECT_EQ(rest.at(1e6).attitude, Quaternion{});
}

TEST(FreeRotation, about_the_exact_intermediate_axis_of_a_tensor_that_is_not_diagonal_stays) {
    // moments 10, 5.5, 1 along (1, 2, 2), (2, 1, -2), (2, -2, 1), in whole numbers and halves
    const Vector3 u(1, 2, 2), v(2, 1, -2);
    const Matrix3 inertia = Matrix3::Identity() + u * u.transpose() + 0.5 * v * v.transpose();
    const FreeRotation motion(rbdyn::widened(inertia), {}, 0.25 * v);
    EXPECT_EQ(motion.regime(), Regime::permanent);
    EXPECT_EQ(motion.at(1e6).angular_velocity, 0.25 * v);
    // a unit in the last place beside it the body flips, at a time known to its estimate
    const FreeRotation beside(rbdyn::widened(inertia), {}, 0.25 * Vector3(2, 1, std::nextafter(-2.0, 0.0)));
    EXPECT_EQ(beside.regime(), Regime::generic);
    EXPECT_LT(beside.period(), 200.0);
    EXPECT_LT(beside.error(1.0), accuracy);
    EXPECT_LT(beside.error(1e6), 1e-9);
}

TEST(FreeRotation, turns_about_the_angular_momentum_by_its_precession_rate_from_period_to_period) {
    Random random(11);
    for (int i = 0; i < 40; ++i) {
        const auto [moments, omega] = drawn(random);
        const FreeRotation motion(diagonal(moments), {}, omega);
        if (!std::isfinite(motion.period()) || motion.period() * omega.norm() > 1e4) continue;
        const Quaternion q = motion.at(motion.period()).attitude;
        const Vector3 k = moments.cwiseProduct(omega).normalized();
        const double half = 0.5 * motion.precession_rate() * motion.period();
        const Vector3 axis = k * std::sin(half);
        const double sign = q.w * std::cos(half) + axis.dot(Vector3(q.x, q.y, q.z)) < 0.0 ? -1.0 : 1.0;
        // the period is rounded, and the rate times it
        const double rounding = 8 * epsilon * (1.0 + motion.period() * omega.norm());
        EXPECT_NEAR(sign * q.w, std::cos(half), rounding);
        EXPECT_LT((sign * Vector3(q.x, q.y, q.z) - axis).norm(), rounding);
    }
}

TEST(FreeRotation, of_a_gyroscope_has_the_rates_and_the_angle_of_regular_precession) {
    for (const char* name : {"c_earth", "c_oblate", "c_prolate"}) {
        const Json values = read(name)["values"];
        const FreeRotation motion = reference_motion(read(name));
        EXPECT_EQ(motion.regime(), Regime::symmetric);
        EXPECT_NEAR(motion.precession_rate() / number(values["precession_rate_psi_dot_about_K"]), 1.0, 4 * epsilon);
        EXPECT_NEAR(motion.proper_rotation_rate() / number(values["proper_rotation_rate_phi_dot"]), 1.0, 4 * epsilon);
        EXPECT_NEAR(std::cos(motion.tilt().first), number(values["cos_theta_axis_to_K"]), 2 * epsilon);
        EXPECT_EQ(motion.tilt().first, motion.tilt().second);
    }
}

TEST(FreeRotation, does_not_depend_on_units_that_are_powers_of_two) {
    const Vector3 moments(1.1, 1.9, 2.3), omega(0.01, 1.2, 0.02);
    const FreeRotation one(diagonal(moments), {}, omega);
    const FreeRotation other(diagonal(std::ldexp(1.0, -60) * moments), {}, std::ldexp(1.0, 30) * omega);
    for (double t : {0.7, 123.4, 1e6}) {
        const auto a = one.at(t), b = other.at(std::ldexp(t, -30));
        EXPECT_EQ(a.attitude, b.attitude);
        EXPECT_EQ(std::ldexp(1.0, 30) * a.angular_velocity, b.angular_velocity);
    }
}

// each attitude is rounded; what the start's own rounding would add is the same in all of them and does not average
// out: 7e-17 or more of these unit quaternions
TEST(FreeRotation, does_not_turn_all_of_the_motion_by_the_rounding_of_its_start) {
    using Real = long double;
    double most = 0.0;
    for (const Quaternion& start :
         {Quaternion{-5, 6, 0, 5}, Quaternion{4, -9, 6, 8}, Quaternion{-8, 4, 6, 9}, Quaternion{3, -6, 8, 1}}) {
        const FreeRotation motion(diagonal({1, 2, 3}), start, {0, 0, 1});
        const Real size = std::sqrt(static_cast<Real>(squared_norm(start)));
        Eigen::Matrix<Real, 3, 1> sum = Eigen::Matrix<Real, 3, 1>::Zero();
        constexpr int times = 4000;
        for (int k = 1; k <= times; ++k) {
            const double t = 0.0021 * k;
            const Real half = 0.5L * static_cast<Real>(t);
            const Eigen::Quaternion<Real> exact =
                Eigen::Quaternion<Real>(start.w / size, start.x / size, start.y / size, start.z / size) *
                Eigen::Quaternion<Real>(std::cos(half), 0.0L, 0.0L, std::sin(half));
            const Quaternion q = motion.at(t).attitude;
            sum += (Eigen::Quaternion<Real>(q.w, q.x, q.y, q.z) * exact.conjugate()).vec();
        }
        most = std::max(most, static_cast<double>(sum.norm()) / times);
    }
    EXPECT_LT(most, 3e-17);
}

}  // namespace
}  // namespace rbdyn::test::test_free_rotation
