// Long runs of the Taylor engine: time adds up exactly, and rounding grows no faster than it must.
#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>

#include "rbdyn/engine/dop853.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/series/step_length.hpp"

namespace rbdyn::test_accuracy {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// u'' = -w2 sin u.
Equations pendulum(double w2) {
    Recorder r;
    const Expression outputs[] = {r.input(1), -w2 * sin(r.input(0))};
    Equations e;
    e.program = Program(r, outputs, 2);
    e.groups = {{0, 1, true}, {1, 1, false}};
    return e;
}

/// From rest at `angle`: sin(u/2) = k sn(K - w t; k), in long double.
struct ExactPendulum {
    long double angle, w2;

    std::pair<double, double> operator()(long double t) const {
        const long double w = std::sqrt(w2), k = std::sin(angle / 2);
        const long double quarter = boost::math::ellint_1(k);
        const long double phase = std::remainder(quarter - w * t, 4 * quarter);
        long double cn, dn;
        const long double sn = boost::math::jacobi_elliptic(k, phase, &cn, &dn);
        return {static_cast<double>(2 * std::asin(k * sn)), static_cast<double>(-2 * k * w * cn)};
    }
};

TEST(Steps, of_a_polynomial_computed_as_more_end_where_the_rounding_of_its_series_is_the_error_allowed) {
    // u'' = 2 cos^2 u + 2 sin^2 u = 2: the coefficients beyond u = t^2 are the rounding of those of cos and sin
    Recorder r;
    const Expression u = r.input(0), cosine = cos(u), sine = sin(u);
    const Expression outputs[] = {r.input(1), 2.0 * cosine * cosine + 2.0 * sine * sine};
    Equations e;
    e.program = Program(r, outputs, 2);
    e.groups = {{0, 1, true}, {1, 1, false}};
    for (const double tolerance : {1e-8, 1e-10, 1e-12, 1e-14}) {
        TaylorEngine engine(tolerance);
        const double rest[] = {0.0, 0.0};
        engine.start(e, {}, {0.0, 0.0}, rest);
        int steps = 0;
        std::vector<double> x(2);
        for (Instant t; 8.0 - t > 0.0; ++steps, t = engine.piece().at(engine.piece().length))
            ASSERT_EQ(engine.step(8.0), StepStatus::ok);
        engine.state(engine.piece().length, x);
        EXPECT_LE(std::abs(x[0] - 64.0) / 64.0, 10.0 * tolerance) << tolerance;
        EXPECT_LE(steps, 40);
    }
}

TEST(Steps, of_numbers_at_the_end_of_doubles_hold_nothing_up) {
    // the far end of a chain that was just struck at the other: its last terms are beyond where doubles end
    constexpr int p = 15;
    std::array<double, p + 1> size{};
    for (int k = 1; k <= p - 4; ++k) size[static_cast<std::size_t>(k)] = std::pow(10.0, k - 300);
    EXPECT_EQ(series::log_step(size.data(), p, 1e-300, -30.0), std::numeric_limits<double>::infinity());
    for (double& x : size) x *= 0x1p-60;
    EXPECT_EQ(series::log_step(size.data(), p, 1e-318, -30.0), std::numeric_limits<double>::infinity());
}

TEST(Steps, of_what_has_hardly_begun_to_move_are_those_of_its_scale) {
    // a spring of 0.1 m far along a chain: its length changes from 1e-40 m on, by terms of the sixth order and more
    constexpr int p = 12;
    std::array<double, p + 1> size{};
    size[0] = 0.1;
    for (int k = 3; k <= p - 4; ++k) size[static_cast<std::size_t>(k)] = std::pow(10.0, 5 * k - 55);
    // its last term reaches 2^-20 of 0.1 m where 1e-15 tau^8 does, not where it is that part of the first one
    const double length = std::exp2(series::log_step(size.data(), p, size[0], -20.0));
    EXPECT_NEAR(1e-15 * std::pow(length, 8) / (0.1 * 0x1p-20), 1.0, 0.7);
}

TEST(Steps, do_not_depend_on_units) {
    constexpr int p = 20;
    std::array<double, p + 1> size{}, other{};
    for (int k = 0; k <= p; ++k) size[static_cast<std::size_t>(k)] = 1.0 / (1.0 + k * k) * std::pow(0.7, k);
    for (const int power : {1, 30, -30, 200, -200}) {
        for (int k = 0; k <= p; ++k)
            other[static_cast<std::size_t>(k)] = std::ldexp(size[static_cast<std::size_t>(k)], power);
        EXPECT_EQ(series::log_step(other.data(), p, std::ldexp(0.3, power), -40.0),
                  series::log_step(size.data(), p, 0.3, -40.0));
    }
}

TEST(LongRuns, a_pendulum_s_error_at_rounding_level_grows_no_faster_than_time_to_the_power_three_halves) {
    const double angle = 1.5, w2 = 1.0;
    const ExactPendulum exact{angle, w2};
    const Equations equations = pendulum(w2);
    TaylorEngine engine(1e-16);
    const double start[] = {angle, 0.0};
    engine.start(equations, {}, {0.0, 0.0}, start);
    double checked = 1.0, worst = 0.0;
    int steps = 0;
    for (double until : {10.0, 100.0, 1000.0}) {
        Instant t = engine.piece().coefficients == nullptr ? Instant{} : engine.piece().at(engine.piece().length);
        while (until - t > 0.0) {
            ASSERT_EQ(engine.step(until), StepStatus::ok);
            t = engine.piece().at(engine.piece().length);
            ++steps;
        }
        EXPECT_EQ(t.hi, until);
        std::vector<double> x(2);
        engine.state(engine.piece().length, x);
        const auto [u, w] = exact(until);
        worst = std::hypot((x[0] - u) / (2.0 * angle), (x[1] - w) / (2.0 * std::sin(angle / 2.0)));
        RecordProperty("error_at_" + std::to_string(static_cast<int>(until)),
                       std::to_string(worst / epsilon) + " epsilon");
        // rounding of steps: the energy walks at random, by epsilon a step, and the phase adds that up in time
        // (Brouwer's law); at this amplitude the frequency changes by 0.2 of the energy's relative change
        EXPECT_LE(worst, epsilon * (4.0 + std::sqrt(steps) + 0.2 * until * std::sqrt(steps))) << "t = " << until;
        checked = until;
    }
    EXPECT_EQ(checked, 1000.0);
    EXPECT_LT(worst, 5e-12);
    EXPECT_LT(steps, 3000);
}

TEST(LongRuns, the_steps_of_a_run_join_without_a_gap_and_their_times_are_exact) {
    const Equations equations = pendulum(9.81);
    TaylorEngine engine(1e-12);
    const double start[] = {2.5, 0.0}, begin = 0.1;
    engine.start(equations, {}, {begin, 0.0}, start);
    Instant expected{begin, 0.0};
    std::vector<double> before{2.5, 0.0}, x(2);
    for (int k = 0; k < 2000; ++k) {
        ASSERT_EQ(engine.step(1e6), StepStatus::ok);
        const Piece& piece = engine.piece();
        // a step starts where the one before ended, in time exactly and in state to its last digits
        EXPECT_EQ(piece.start - expected, 0.0);
        piece.state(0.0, x);
        EXPECT_NEAR(x[0], before[0], 4.0 * epsilon * 2.5);
        EXPECT_NEAR(x[1], before[1], 4.0 * epsilon * 8.0);
        // the end is the start and the length, without rounding; in one double, but where the step is longer than the
        // time so far
        const Instant end = piece.at(piece.length);
        const Instant length = exact_difference(end, piece.start);
        EXPECT_EQ(length.hi, piece.duration());
        EXPECT_EQ(length.lo, 0.0);
        if (piece.duration() <= piece.start.hi) {
            EXPECT_EQ(end.lo, piece.start.lo);
        }
        piece.state(piece.length, before);
        expected = end;
    }
}

TEST(LongRuns, a_smaller_tolerance_gives_a_smaller_error_down_to_rounding) {
    const ExactPendulum exact{2.0L, 9.81};
    const Equations equations = pendulum(9.81);
    double last = 1.0;
    for (double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14}) {
        TaylorEngine engine(tolerance);
        const double start[] = {2.0, 0.0};
        engine.start(equations, {}, {}, start);
        Instant t;
        while (20.0 - t > 0.0) {
            ASSERT_EQ(engine.step(20.0), StepStatus::ok);
            t = engine.piece().at(engine.piece().length);
        }
        std::vector<double> x(2);
        engine.state(engine.piece().length, x);
        const double error = std::abs(x[0] - exact(20.0).first) / 4.0;
        // some tens of steps a period, ten periods
        EXPECT_LE(error, 1e3 * tolerance) << tolerance;
        EXPECT_LE(error, last) << tolerance;
        last = error;
    }
    EXPECT_LT(last, 1e-13);
}

TEST(LongRuns, a_motion_that_is_a_polynomial_is_one_step_of_any_length) {
    Recorder r;
    const Expression outputs[] = {r.input(1), Expression(-9.8125)};
    Equations e;
    e.program = Program(r, outputs, 2);
    e.groups = {{0, 1, true}, {1, 1, false}};
    for (double length : {1e-6, 1.0, 1e6}) {
        TaylorEngine engine(1e-12);
        const double start[] = {1.0, 2.0};
        engine.start(e, {}, {}, start);
        ASSERT_EQ(engine.step(length), StepStatus::ok);
        EXPECT_EQ(engine.piece().duration(), length);
        std::vector<double> x(2);
        engine.state(engine.piece().length, x);
        const double exact = 1.0 + 2.0 * length - 0.5 * 9.8125 * length * length;
        EXPECT_NEAR(x[0], exact, 4.0 * epsilon * (1.0 + std::abs(exact)));
    }
}

// where the origin is says nothing of how well a place is to be known
TEST(Steps, are_as_long_far_from_the_origin_as_near_it) {
    const auto steps = [](Engine& engine, double far) {
        // places alone, round a circle that is passed ever faster
        Recorder r;
        const Expression x = r.input(0) - far, y = r.input(1) - far, rate = 1.0 + 0.5 * sin(r.time());
        const Expression outputs[] = {-y * rate, x * rate};
        Equations e;
        e.program = Program(r, outputs, 2);
        e.groups = {{0, 2, true}};
        const double start[] = {far + 1.0, far};
        engine.start(e, {}, {0.0, 0.0}, start);
        int count = 0;
        for (Instant t; 20.0 - t > 0.0; ++count, t = engine.piece().at(engine.piece().length))
            if (engine.step(20.0) != StepStatus::ok) return -1;
        return count;
    };
    for (const double tolerance : {1e-7, 1e-9}) {
        TaylorEngine near(tolerance), away(tolerance);
        EXPECT_EQ(steps(near, 0.0), steps(away, 0x1p16));
        Dop853Engine one(tolerance), other(tolerance);
        const int n = steps(one, 0.0);
        EXPECT_NEAR(steps(other, 0x1p16), n, 0.05 * n);
    }
}

}  // namespace
}  // namespace rbdyn::test_accuracy
