// The pendulum against reference digits, its known periods and its limits.
#include <gtest/gtest.h>

#include <numbers>

#include "rbdyn/closed_form/pendulum.hpp"
#include "reference.hpp"

namespace rbdyn::test::test_pendulum {
namespace {

constexpr double pi = std::numbers::pi, limit = 2e-15;  // what the closed forms promise

TEST(Pendulum, moves_as_the_reference_cases_do) {
    for (const char* name :
         {"e_libration", "e_near_separatrix_above", "e_near_separatrix_below", "e_rotation", "e_small_oscillation"}) {
        SCOPED_TRACE(name);
        const nlohmann::json r = reference(name);
        const auto p = [&](const char* of) { return parameter(r, of); };
        const Pendulum pendulum(DoubleDouble(p("m")) * p("g") * p("d") / p("I33"), p("psi0"), p("psidot0"));
        double widest = std::abs(p("psi0")), fastest = std::abs(p("psidot0"));
        for (const auto& s : r["values"]["samples"]) {
            widest = std::max(widest, static_cast<double>(std::abs(digits(s["psi"]))));
            fastest = std::max(fastest, static_cast<double>(std::abs(digits(s["psi_dot"]))));
        }
        for (const auto& s : r["values"]["samples"]) {
            const double t = static_cast<double>(digits(s["t"]));
            const Pendulum::State at = pendulum.at({t, 0.0});
            const double error = std::max(static_cast<double>(std::abs(at.angle - digits(s["psi"]))) / widest,
                                          static_cast<double>(std::abs(at.rate - digits(s["psi_dot"]))) / fastest);
            EXPECT_LE(error, limit) << "t = " << t;
            EXPECT_LE(error, 10.0 * pendulum.error(t)) << "t = " << t;
        }
    }
}

TEST(Pendulum, has_the_known_periods) {
    const DoubleDouble w2 = 9.81;
    EXPECT_DOUBLE_EQ(Pendulum(w2, 0.05, 0.0).period(), 2.0063801735317490);
    EXPECT_DOUBLE_EQ(Pendulum(w2, 0.5 * pi, 0.0).period(), 2.3678419475762374);
    EXPECT_DOUBLE_EQ(Pendulum(w2, double_double::pi * 179.0 / 180.0, 0.0).period(), 7.8257968375376827);
    EXPECT_DOUBLE_EQ(Pendulum(w2, 0.0, 0.0).period(), 2.0 * pi / std::sqrt(9.81));
}

TEST(Pendulum, keeps_its_phase_for_a_million_periods) {
    const Pendulum pendulum(9.81, 2.5, 0.0);
    // a time whose distance from a whole period is known: the same motion, set up from a later state, meets it
    const Pendulum::State once = pendulum.at({0.3, 0.0}), late = pendulum.at({0.3 + 1e6, 0.0});
    const auto energy = [](const Pendulum::State& s) { return 0.5 * s.rate * s.rate - 9.81 * std::cos(s.angle); };
    EXPECT_NEAR(energy(late), energy(once), 1e-13);
    const Pendulum::State back = Pendulum(9.81, late.angle, late.rate).at({-1e3, 0.0}),
                          direct = pendulum.at({0.3 + 1e6 - 1e3, 0.0});
    // the rounded state starts another motion, 1e-16 off, whose phase drifts for 450 periods
    EXPECT_NEAR(back.angle, direct.angle, 1e-11);
}

TEST(Pendulum, rests_in_the_highest_place_and_leaves_it_for_the_smallest_push) {
    const Pendulum inverted(9.0, double_double::pi, 0.0);
    EXPECT_EQ(inverted.kind(), Pendulum::Kind::rest);
    EXPECT_EQ(inverted.at({1e9, 0.0}).angle, pi);
    EXPECT_EQ(inverted.period(), INFINITY);
    // the double pi is 1.22e-16 below: psi = pi - 1.22e-16 cosh(w t) while that is small
    const Pendulum near(9.0, pi, 0.0);
    EXPECT_EQ(near.kind(), Pendulum::Kind::libration);
    EXPECT_NEAR((pi - near.at({8.0, 0.0}).angle) / (1.2246467991473532e-16 * std::cosh(24.0)), 1.0, 1e-9);
    const Pendulum pushed(9.0, double_double::pi, -1e-30);
    EXPECT_EQ(pushed.kind(), Pendulum::Kind::rotation);
    EXPECT_NEAR((pi - pushed.at({20.0, 0.0}).angle) / (1e-30 / 3.0 * std::sinh(60.0)), 1.0, 1e-9);
}

TEST(Pendulum, rests_in_the_highest_place_however_its_turns_are_counted) {
    for (const double turns : {-3.0, -1.0, 1.0, 3.0})
        for (const DoubleDouble& square : {DoubleDouble(9.0), DoubleDouble(9.81) / 0.7}) {
            const DoubleDouble top = double_double::pi * turns;
            const Pendulum inverted(square, top, 0.0);
            EXPECT_EQ(inverted.kind(), Pendulum::Kind::rest) << turns;
            EXPECT_EQ(inverted.at({1e9, 0.0}).angle, top.hi) << turns;
        }
}

// the energy of the highest place in 32 digits: what they leave is not told from none
TEST(Pendulum, comes_to_the_highest_place_and_no_further_with_the_speed_that_takes_it_there) {
    for (const double square : {9.81, 1.7, 0.3})
        for (const double angle : {0.3, 1.0, 2.5, -0.7}) {
            const DoubleDouble w = sqrt(DoubleDouble(square));
            const Pendulum pendulum(square, angle, w * 2.0 * sine_cosine(DoubleDouble(0.5 * angle)).cosine);
            EXPECT_EQ(pendulum.kind(), Pendulum::Kind::separatrix) << square << " " << angle;
            EXPECT_NEAR(pendulum.at({60.0 / w.hi, 0.0}).angle, pi, 1e-12) << square << " " << angle;
        }
}

TEST(Pendulum, follows_the_hyperbolic_functions_on_the_separatrix) {
    for (double side : {1.0, -1.0}) {
        const Pendulum pendulum(1.0, 0.0, side * 2.0);
        EXPECT_EQ(pendulum.kind(), Pendulum::Kind::separatrix);
        for (double t : {0.5, 3.0, 30.0, 1e4}) {
            EXPECT_NEAR(pendulum.at({t, 0.0}).angle, side * 2.0 * std::atan(std::sinh(std::min(t, 700.0))), limit);
            EXPECT_NEAR(pendulum.at({t, 0.0}).rate, side * 2.0 / std::cosh(std::min(t, 700.0)), limit);
        }
    }
}

// on its separatrix what 32 digits leave grows like the distance from the highest place
TEST(Pendulum, says_that_its_error_grows_on_the_separatrix) {
    const Pendulum pendulum(1.0, 0.0, 2.0);
    EXPECT_LT(pendulum.error(20.0), limit);
    EXPECT_GT(pendulum.error(60.0), 1e-8);
}

TEST(Pendulum, swings_harmonically_when_tiny_and_turns_evenly_without_weight) {
    for (double size : {1e-9, 1e-200}) {
        const Pendulum pendulum(4.0, size, size);
        for (double t : {0.7, 1e4}) {
            EXPECT_NEAR(pendulum.at({t, 0.0}).angle / size, std::cos(2.0 * t) + 0.5 * std::sin(2.0 * t), limit);
            EXPECT_NEAR(pendulum.at({t, 0.0}).rate / size, std::cos(2.0 * t) - 2.0 * std::sin(2.0 * t), 2 * limit);
        }
    }
    const Pendulum wheel(0.0, 1.0, -3.0);
    EXPECT_DOUBLE_EQ(wheel.at({1000.0, 0.0}).angle, -2999.0);
    EXPECT_DOUBLE_EQ(wheel.at({1000.0, 0.0}).rate, -3.0);
    EXPECT_EQ(Pendulum(0.0, 1.0, 0.0).at({10.0, 0.0}).angle, 1.0);
}

TEST(Pendulum, counts_its_turns_and_returns_the_start_exactly) {
    const double start = 20.0 * pi + 0.5;
    const Pendulum pendulum(1.0, start, 5.0);
    EXPECT_EQ(pendulum.at({}).angle, start);
    EXPECT_EQ(pendulum.at({}).rate, 5.0);
    EXPECT_NEAR(pendulum.at({1e3 * pendulum.period(), 0.0}).angle - start, 2000.0 * pi, 1e-11);
    // a libration about the tenth turn stays there
    EXPECT_NEAR(Pendulum(1.0, start, 0.0).at({12.0, 0.0}).angle, 20.0 * pi, 0.5 + 1e-14);
}

TEST(Pendulum, refuses_a_weight_above_the_axis) { EXPECT_THROW(Pendulum(-1.0, 0.0, 0.0), InvalidInput); }

}  // namespace
}  // namespace rbdyn::test::test_pendulum
