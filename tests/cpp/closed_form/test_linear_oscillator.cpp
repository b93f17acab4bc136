// The linear oscillator against elementary functions, through every change of kind.
#include <gtest/gtest.h>

#include <numbers>

#include "rbdyn/closed_form/linear_oscillator.hpp"

namespace rbdyn::test::test_linear_oscillator {
namespace {

constexpr double limit = 2e-15;  // what the closed forms promise

TEST(LinearOscillator, swings_about_where_the_force_holds_it) {
    // x = 0.5 + 0.5 cos 2t + 0.25 sin 2t
    const LinearOscillator o({4.0, 0.0, 2.0}, 1.0, 0.5);
    for (double t : {-3.0, 0.01, 1.0, 1e3}) {
        EXPECT_NEAR(o.at({t, 0.0}).position, 0.5 + 0.5 * std::cos(2 * t) + 0.25 * std::sin(2 * t), limit);
        EXPECT_NEAR(o.at({t, 0.0}).velocity, 0.5 * std::cos(2 * t) - std::sin(2 * t), limit);
    }
    EXPECT_DOUBLE_EQ(o.period(), std::numbers::pi);
    EXPECT_EQ(o.at({}).position, 1.0);
    EXPECT_EQ(o.at({}).velocity, 0.5);
}

TEST(LinearOscillator, keeps_its_phase_until_a_million_seconds) {
    // 3e6 = 477464 turns and 5.206 rad, sine and cosine of the C library reduce it exactly
    const LinearOscillator o({9.0, 0.0, 0.0}, 1.0, 0.0);
    EXPECT_NEAR(o.at({1e6, 0.0}).position, std::cos(3e6), limit);
}

TEST(LinearOscillator, creeps_as_the_sum_of_two_exponentials) {
    // exponents -1 and -4
    const LinearOscillator o({4.0, 5.0, 0.0}, 1.0, 0.0);
    for (double t : {-0.5, 0.01, 1.0, 30.0}) {
        const double exact = (4.0 * std::exp(-t) - std::exp(-4.0 * t)) / 3.0;
        EXPECT_NEAR(o.at({t, 0.0}).position / exact, 1.0, limit);
    }
    EXPECT_EQ(o.period(), INFINITY);
}

TEST(LinearOscillator, is_continuous_through_critical_damping) {
    // x = e^{-t} (1 + 3 t), and the change by damping is of first order in its distance from critical
    for (double off : {0.0, 1e-15, -1e-15, 1e-9, -1e-9}) {
        const LinearOscillator o({1.0, 2.0 * (1.0 + off), 0.0}, 1.0, 2.0);
        for (double t : {0.1, 1.0, 7.0, 40.0}) {
            EXPECT_NEAR(o.at({t, 0.0}).position, std::exp(-t) * (1.0 + 3.0 * t), limit + 10.0 * std::abs(off));
            EXPECT_NEAR(o.at({t, 0.0}).velocity, std::exp(-t) * (2.0 - 3.0 * t), limit + 10.0 * std::abs(off));
        }
    }
}

TEST(LinearOscillator, is_continuous_where_spring_and_damper_vanish) {
    // x = 1 + 2 t + 3 t^2 / 2
    for (double stiffness : {0.0, 1e-18, -1e-18})
        for (double damping : {0.0, 1e-18}) {
            const LinearOscillator o({stiffness, damping, 3.0}, 1.0, 2.0);
            EXPECT_NEAR(o.at({10.0, 0.0}).position / 171.0, 1.0, limit);
            EXPECT_NEAR(o.at({10.0, 0.0}).velocity / 32.0, 1.0, limit);
        }
    // a damper alone: the speed tends to force/damping
    for (double stiffness : {0.0, 1e-20}) {
        const LinearOscillator o({stiffness, 2.0, 3.0}, 0.0, 0.0);
        EXPECT_NEAR(o.at({100.0, 0.0}).position / (150.0 - 0.75), 1.0, limit);
        EXPECT_NEAR(o.at({100.0, 0.0}).velocity, 1.5, limit);
    }
}

TEST(LinearOscillator, damped_away_keeps_the_digits_of_what_is_left) {
    // exponents -1/8 +- i sqrt(4 - 1/64)
    const LinearOscillator o({4.0, 0.25, 0.0}, 1.0, 0.0);
    const double w = std::sqrt(4.0 - 0.015625), t = 1000.0;
    const double exact = std::exp(-0.125 * t) * (std::cos(w * t) + 0.125 / w * std::sin(w * t));
    // the digits of w t in doubles
    EXPECT_NEAR(o.at({t, 0.0}).position / exact, 1.0, 1e-12);
}

}  // namespace
}  // namespace rbdyn::test::test_linear_oscillator
