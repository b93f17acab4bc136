#include "rbdyn/engine/dop853.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/series/polynomial.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

namespace rbdyn::test_dop853 {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

Equations equations(Recorder& r, const std::vector<Expression>& outputs, int variables,
                    std::vector<VariableGroup> groups) {
    Equations result;
    result.program = Program(r, outputs, variables);
    result.groups = std::move(groups);
    for (int i = variables; i < static_cast<int>(outputs.size()); ++i) {
        Guard guard;
        guard.output = i;
        result.guards.push_back(guard);
    }
    return result;
}
const std::vector<VariableGroup> one_freedom{{0, 1, true}, {1, 1, false}};

/// u'' = -g sin u, with lengths of time and angle in other units if asked for; guards sin u, 1 / (1.1 + sin u), u'.
Equations pendulum(double second = 1.0, double radian = 1.0) {
    Recorder r;
    const Expression u = r.input(0), w = r.input(1), sine = sin(u / radian);
    return equations(r, {w, -9.81 * radian / (second * second) * sine, sine, 1.0 / (1.1 + sine), w}, 2, one_freedom);
}
/// The same without guards: every piece a whole step.
Equations free_pendulum() {
    Recorder r;
    return equations(r, {r.input(1), -9.81 * sin(r.input(0))}, 2, one_freedom);
}
constexpr double period = 2.3678419475762374;  // s, l = 1 m, g = 9.81 m/s2, from 90 degrees: 4 K(sin 45 deg) / sqrt(g)
constexpr std::array<double, 2> at_90_degrees{std::numbers::pi / 2.0, 0.0};
const std::array<double, 2> size_of_swing{std::numbers::pi, std::sqrt(2.0 * 9.81)};

double swing_error(std::span<const double> x, std::span<const double> expected) {
    double error = 0.0;
    for (std::size_t i = 0; i < 2; ++i) error = std::max(error, std::abs(x[i] - expected[i]) / size_of_swing[i]);
    return error;
}

struct Motion {
    StepStatus status = StepStatus::ok;
    Instant end;
    std::vector<double> x;
};

template <class Watch>
Motion follow(Engine& engine, const Equations& equations, Instant t, std::span<const double> x, double limit,
              Watch watch, int most_steps = 200000) {
    Motion result{StepStatus::ok, t, {x.begin(), x.end()}};
    engine.start(equations, {}, t, x);
    while (limit - result.end > 0.0 && most_steps-- > 0) {
        result.status = engine.step(limit);
        if (result.status != StepStatus::ok) return result;
        const Piece& piece = engine.piece();
        result.end = piece.at(piece.length);
        engine.state(piece.length, result.x);
        watch(piece);
    }
    return result;
}

Motion follow(Engine& engine, const Equations& equations, Instant t, std::span<const double> x, double limit,
              int most_steps = 200000) {
    return follow(
        engine, equations, t, x, limit, [](const Piece&) {}, most_steps);
}

/// A tolerance that no step of a given length breaks, for tests of the method alone.
constexpr double any = 1e30;

TEST(Dop853Coefficients, rows_sum_to_their_times) {
    for (int s = 0; s < dop853::stages; ++s) {
        double sum = 0.0, size = 1.0;
        for (int j = 0; j < s; ++j) {
            sum += dop853::a[s][j];
            size += std::abs(dop853::a[s][j]);
        }
        EXPECT_NEAR(sum, dop853::c[s], 2.0 * epsilon * size) << s;
    }
}

TEST(Dop853Coefficients, weights_meet_the_conditions_of_order_eight) {
    // Hairer, Norsett, Wanner, II.2: each rooted tree one condition; those of the bushes and of the tall trees, in
    // which every row of a takes part
    std::array<double, dop853::stages> tall;
    tall.fill(1.0);
    double factorial = 1.0;
    for (int order = 1; order <= 8; ++order) {
        double bush = 0.0, trunk = 0.0, mixed = 0.0, size = 1.0;
        std::array<double, dop853::stages> next{};
        for (int i = 0; i < 12; ++i) {
            const double b = dop853::a[12][i];
            bush += b * std::pow(dop853::c[i], order - 1);
            trunk += b * tall[static_cast<std::size_t>(i)];
            double inner = 0.0;
            for (int j = 0; j < i; ++j) {
                next[static_cast<std::size_t>(i)] += dop853::a[i][j] * tall[static_cast<std::size_t>(j)];
                inner += dop853::a[i][j] * std::pow(dop853::c[j], std::max(0, order - 3));
                size += std::abs(b * dop853::a[i][j]);
            }
            mixed += b * dop853::c[i] * inner;
        }
        factorial *= order;
        EXPECT_NEAR(bush, 1.0 / order, 4.0 * epsilon * size) << order;
        EXPECT_NEAR(trunk, 1.0 / factorial, 4.0 * epsilon * size) << order;
        // sum b_i c_i a_ij c_j^q = 1 / ((q + 1) (q + 3))
        if (order >= 3) {
            EXPECT_NEAR(mixed, 1.0 / ((order - 2) * order), 4.0 * epsilon * size) << order;
        }
        tall = next;
    }
}

TEST(Dop853Coefficients, embedded_methods_have_orders_five_and_three) {
    for (const auto& [row, order] : {std::pair{dop853::fifth, 5}, std::pair{dop853::third, 3}})
        for (int power = 0; power <= order; ++power) {
            double sum = 0.0;
            for (int j = 0; j < 12; ++j) sum += dop853::weight(row, j) * std::pow(dop853::c[j], power);
            // the difference of two methods sees no power below the order of the lesser one
            if (power < order)
                EXPECT_NEAR(sum, 0.0, 16.0 * epsilon) << row << ' ' << power;
            else
                EXPECT_GT(std::abs(sum), 1e-6) << row;
        }
}

TEST(Dop853Coefficients, interpolant_is_exact_for_powers_of_time) {
    // x' = t^p from 0, p = 0 .. 6: x = t^(p + 1) / (p + 1)
    Recorder r;
    const Expression t = r.time();
    for (int p = 0; p <= 6; ++p) {
        const Equations motion = equations(r, {p == 0 ? Expression(1.0) + 0.0 * t : pow(t, p)}, 1, {{0, 1, true}});
        Dop853Engine engine(any);
        engine.start(motion, {}, {}, std::array{0.0});
        ASSERT_EQ(engine.step(1.0), StepStatus::ok);
        ASSERT_EQ(engine.piece().length, 1.0);
        for (int k = 0; k <= 7; ++k)
            EXPECT_NEAR(engine.piece().variable(0)[k], k == p + 1 ? 1.0 / k : 0.0, 2000.0 * epsilon) << p << ' ' << k;
    }
}

/// Errors of steps of equal length over half a period: at the end, and within steps.
std::pair<double, double> errors_of_steps(int steps) {
    const Equations swing = free_pendulum();
    Dop853Engine engine(any), exact(1e-16);
    const double h = 0.5 * period / steps;
    engine.start(swing, {}, {}, at_90_degrees);
    double within = 0.0;
    std::array<double, 2> x, y;
    for (int k = 1; k <= steps; ++k) {
        EXPECT_EQ(engine.step(k * h), StepStatus::ok);
        const Piece& piece = engine.piece();
        // from the start of this very step, so that the error is the polynomial's own
        piece.state(0.0, x);
        for (const double tau : {0.3, 0.5, 0.7, 0.8}) {
            piece.state(0.0, x);
            const Motion there = follow(exact, swing, piece.start, x, piece.at(tau).hi);
            piece.state(tau, y);
            within = std::max(within, swing_error(y, there.x));
        }
    }
    engine.state(engine.piece().length, x);
    return {swing_error(x, std::array{-at_90_degrees[0], 0.0}), within};
}

TEST(Dop853, converges_with_order_eight_and_its_pieces_with_order_seven) {
    const auto coarse = errors_of_steps(16), fine = errors_of_steps(32);
    EXPECT_NEAR(std::log2(coarse.first / fine.first), 8.0, 0.7);
    // an error of order 7 is one of h^8 in a step
    EXPECT_NEAR(std::log2(coarse.second / fine.second), 8.0, 0.7);
    EXPECT_LT(fine.first, 1e-8);
}

TEST(Dop853, a_state_within_a_step_is_that_of_the_method_itself) {
    const Equations swing = free_pendulum();
    Dop853Engine engine(1e-6), exact(1e-16);
    double by_method = 0.0, by_piece = 0.0;
    std::array<double, 2> x, y;
    follow(engine, swing, {}, at_90_degrees, period, [&](const Piece& piece) {
        for (const double tau : {0.2, 0.5, 0.5001, 0.8}) {
            piece.state(0.0, x);
            const Motion there = follow(exact, swing, piece.start, x, piece.at(tau).hi);
            engine.state(tau, x);
            piece.state(tau, y);
            by_method = std::max(by_method, swing_error(x, there.x));
            by_piece = std::max(by_piece, swing_error(y, there.x));
        }
    });
    EXPECT_LT(by_piece, 2e-6);
    EXPECT_LT(by_method, 0.1 * by_piece);
}

TEST(Dop853, a_pendulum_is_back_after_ten_periods) {
    const Equations swing = free_pendulum();
    // measured: 2 to 130 times the tolerance; the values between the steps are as good
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
        Dop853Engine engine(tolerance);
        const Motion result = follow(engine, swing, {}, at_90_degrees, 10.0 * period);
        EXPECT_EQ(result.status, StepStatus::ok);
        EXPECT_LT(swing_error(result.x, at_90_degrees), 300.0 * tolerance);
        // measured: 1 step in 4 at 1e-4, one in 20 below 1e-7
        EXPECT_LT(engine.work().rejected, engine.work().steps / (tolerance < 1e-7 ? 10 : 3));
        EXPECT_LT(engine.work().right_hand_sides, 16 * engine.work().steps + 17 * engine.work().rejected + 50);
    }
}

TEST(Dop853, values_within_a_step_are_as_accurate_as_asked) {
    // the local error of the polynomial, largest over two periods: measured 0.1 to 1.5 times the tolerance
    const Equations swing = free_pendulum();
    std::array<double, 2> x;
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
        Dop853Engine engine(tolerance), exact(1e-16);
        double worst = 0.0;
        follow(engine, swing, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
            for (const double fraction : {0.3, 0.5, 0.8, 1.0}) {
                const double tau = fraction * piece.length;
                piece.state(0.0, x);
                const Motion there = follow(exact, swing, piece.start, x, piece.at(tau).hi);
                piece.state(tau, x);
                worst = std::max(worst, swing_error(x, there.x));
            }
        });
        EXPECT_LT(worst, 4.0 * tolerance);
        EXPECT_GT(worst, 0.01 * tolerance);
    }
}

TEST(Dop853, accuracy_asked_for_below_rounding_gives_what_rounding_allows) {
    const Equations swing = free_pendulum();
    for (const double tolerance : {1e-15, 1e-16, 1e-18}) {
        Dop853Engine engine(tolerance);
        const Motion result = follow(engine, swing, {}, at_90_degrees, 10.0 * period);
        EXPECT_EQ(result.status, StepStatus::ok);
        EXPECT_LT(swing_error(result.x, at_90_degrees), 5e-14);  // measured: 4e-15 to 1e-14
        EXPECT_LT(engine.work().steps, 3000);
    }
}

TEST(Dop853, pieces_join_to_rounding) {
    const Equations swing = pendulum();
    for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
        Dop853Engine engine(tolerance);
        std::array<double, 2> before = at_90_degrees;
        Instant end;
        int parts = 0;
        follow(engine, swing, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
            ASSERT_LE(std::abs(piece.start - end), 1e-15 * piece.unit);
            end = piece.at(piece.length);
            std::array<double, 2> first;
            engine.state(0.0, first);
            EXPECT_LT(swing_error(first, before), 2e-15);
            piece.state(piece.length, before);
            parts += piece.length < 1.0 ? 1 : 0;
        });
        // some of the pieces are parts of steps
        if (tolerance > 1e-9) {
            EXPECT_GT(parts, 2);
        }
    }
}

TEST(Dop853, a_step_ends_with_the_state_it_goes_on_from) {
    const Equations swing = free_pendulum();
    Dop853Engine engine(1e-6);
    std::array<double, 2> before = at_90_degrees;
    follow(engine, swing, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
        std::array<double, 2> first, last;
        engine.state(0.0, first);
        EXPECT_EQ(first, before);
        engine.state(1.0, before);
        piece.state(1.0, last);
        EXPECT_LT(swing_error(last, before), 2e-15);
    });
}

TEST(Dop853, a_piece_has_the_slopes_of_the_motion_at_both_ends) {
    const Equations swing = free_pendulum();
    Dop853Engine engine(1e-6);
    double worst = 0.0;
    follow(engine, swing, {}, at_90_degrees, period, [&](const Piece& piece) {
        for (const double tau : {0.0, 1.0}) {
            std::array<double, 2> x, change{};
            piece.state(tau, x);
            for (int i = 0; i < 2; ++i)
                for (int k = piece.order; k > 0; --k)
                    change[static_cast<std::size_t>(i)] =
                        change[static_cast<std::size_t>(i)] * tau + k * piece.variable(i)[k];
            const std::array expected{x[1] * piece.unit, -9.81 * std::sin(x[0]) * piece.unit};
            worst = std::max(worst, swing_error(change, expected));
        }
    });
    EXPECT_LT(worst, 1e-13);  // the coefficients of the interpolant are up to 500
}

TEST(Dop853, motion_goes_on_from_any_of_its_states) {
    const Equations swing = pendulum();
    Dop853Engine engine(1e-9);
    const Motion half = follow(engine, swing, {}, at_90_degrees, 1.7);
    EXPECT_EQ(half.end.hi, 1.7);
    engine.start(swing, {}, half.end, half.x);
    ASSERT_EQ(engine.step(10.0 * period), StepStatus::ok);
    EXPECT_EQ(engine.piece().start.hi, 1.7);
    EXPECT_EQ(engine.piece().variable(0)[0], half.x[0]);
    EXPECT_EQ(engine.piece().variable(1)[0], half.x[1]);
    const Motion whole = follow(engine, swing, half.end, half.x, 10.0 * period);
    EXPECT_LT(swing_error(whole.x, at_90_degrees), 1e-6);
}

TEST(Dop853, a_step_ends_at_the_limit_and_never_beyond) {
    const Equations swing = pendulum();
    Dop853Engine engine(1e-9);
    // limits as near as the next number, asked for in the middle of a run
    double t = 1.0, limit = 1.0;
    engine.start(swing, {}, {t, 0.0}, at_90_degrees);
    for (int k = 0; k < 400; ++k) {
        limit = std::max(limit, k % 3 == 0 ? std::nextafter(t, 1e9) : t + 1e-17 * std::pow(10.0, k % 17));
        if (!(limit > t)) limit = std::nextafter(t, 1e9);
        ASSERT_EQ(engine.step(limit), StepStatus::ok) << t << " to " << limit;
        t = engine.piece().at(engine.piece().length).hi;
        ASSERT_LE(t, limit);
    }
    EXPECT_EQ(engine.step(t), StepStatus::stalled);
    EXPECT_EQ(engine.step(t - 1.0), StepStatus::stalled);
    std::array<double, 2> x;
    engine.state(engine.piece().length, x);
    const Motion home = follow(engine, swing, {t, 0.0}, x, 5.0 * period);
    Dop853Engine undisturbed(1e-9);
    const Motion expected = follow(undisturbed, swing, {1.0, 0.0}, at_90_degrees, 5.0 * period);
    EXPECT_LT(swing_error(home.x, expected.x), 1e-7);
}

TEST(Dop853, the_unit_of_time_and_length_does_not_matter) {
    const double second = 0x1p10, radian = 0x1p-7;
    const Equations swing = pendulum(), scaled = pendulum(second, radian);
    for (const bool fits : {false, true}) {
        Dop853Engine engine(1e-9, fits), other(1e-9, fits);
        std::vector<std::array<double, 5>> path, other_path;
        std::array<double, 2> x;
        follow(engine, swing, {}, at_90_degrees, 2.0 * period, [&](const Piece& p) {
            engine.state(0.6 * p.length, x);
            path.push_back({p.at(p.length).hi, x[0], x[1], p.variable(1)[p.order], engine.guard(0)[3]});
        });
        follow(other, scaled, {}, std::array{radian * at_90_degrees[0], 0.0}, 2.0 * period * second,
               [&](const Piece& p) {
                   other.state(0.6 * p.length, x);
                   const double speed = radian / second;
                   other_path.push_back({p.at(p.length).hi / second, x[0] / radian, x[1] / speed,
                                         p.variable(1)[p.order] / speed, other.guard(0)[3]});
               });
        EXPECT_EQ(path, other_path);
    }
}

TEST(Dop853, a_guard_is_its_function_along_the_piece) {
    const Equations swing = pendulum();
    for (const bool fits : {false, true})
        for (const double tolerance : {1e-4, 1e-6, 1e-9, 1e-12}) {
            Dop853Engine engine(tolerance, fits);
            double smooth = 0.0, nearly_singular = 0.0, variable = 0.0;
            follow(engine, swing, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
                const auto guard = [&](int index, double tau) {
                    return series::value(engine.guard(index), engine.guard_order(), tau);
                };
                for (const double fraction : {0.0, 0.37, 0.5, 0.9, 1.0}) {
                    const double tau = fraction * piece.length;
                    std::array<double, 2> x;
                    piece.state(tau, x);
                    const double sine = std::sin(x[0]);
                    smooth = std::max(smooth, std::abs(guard(0, tau) - sine));
                    nearly_singular =
                        std::max(nearly_singular, std::abs(guard(1, tau) - 1.0 / (1.1 + sine)) * (1.1 + sine));
                    variable = std::max(variable, std::abs(guard(2, tau) - x[1]));
                }
            });
            EXPECT_EQ(variable, 0.0);
            // what is cut off of a guard is within 32 tolerances, by the last coefficients
            EXPECT_LT(smooth, 32.0 * tolerance + 1e-14);
            EXPECT_LT(nearly_singular, 32.0 * tolerance + 1e-13);
        }
}

TEST(Dop853, guards_fitted_through_values_are_those_of_their_series) {
    const Equations swing = pendulum();
    for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
        Dop853Engine engine(tolerance), fitting(tolerance, true);
        engine.start(swing, {}, {}, at_90_degrees);
        fitting.start(swing, {}, {}, at_90_degrees);
        for (int k = 0; k < 10; ++k) {
            ASSERT_EQ(engine.step(10.0), StepStatus::ok);
            ASSERT_EQ(fitting.step(10.0), StepStatus::ok);
            if (engine.piece().length != fitting.piece().length) break;
            for (int g = 0; g < 2; ++g) {
                EXPECT_EQ(fitting.guard(g)[0], engine.guard(g)[0]);
                EXPECT_NEAR(fitting.guard(g)[1], engine.guard(g)[1], 1e3 * tolerance + 1e-10);
            }
        }
    }
}

TEST(Dop853, a_piece_is_cut_where_its_guards_would_not_hold) {
    // carried at a constant speed: one step as long as asked for, and a guard with many turns on it
    Recorder r;
    const Expression u = r.input(0), w = r.input(1);
    const Equations carried = equations(r, {w, 0.0 * u, sin(u)}, 2, one_freedom);
    for (const bool fits : {false, true}) {
        Dop853Engine engine(1e-9, fits);
        int roots = 0;
        double worst = 0.0, before = 0.0, end = 0.0;
        follow(engine, carried, {}, std::array{0.1, 1.0}, 100.0, [&](const Piece& piece) {
            EXPECT_EQ(piece.start.hi, end);
            end = piece.at(piece.length).hi;
            for (int k = 0; k <= 50; ++k) {
                const double tau = piece.length * k / 50.0, t = piece.at(tau).hi;
                const double g = series::value(engine.guard(0), engine.guard_order(), tau);
                worst = std::max(worst, std::abs(g - std::sin(t + 0.1)));
                roots += g * before < 0.0 ? 1 : 0;
                before = g;
                std::array<double, 2> x;
                engine.state(tau, x);
                EXPECT_NEAR(x[0], t + 0.1, 1e-13);
            }
        });
        EXPECT_NEAR(end, 100.0, 200.0 * epsilon);
        EXPECT_EQ(engine.work().steps, 1);
        EXPECT_EQ(roots, 31);
        EXPECT_LT(worst, 32e-9);
    }
}

TEST(Dop853, a_guard_that_was_no_number_recovers) {
    // sqrt(u) for a swing through u = 0
    Recorder r;
    const Expression u = r.input(0), w = r.input(1);
    const Equations swing = equations(r, {w, -9.81 * sin(u), sqrt(u)}, 2, one_freedom);
    for (const bool fits : {false, true}) {
        Dop853Engine engine(1e-6, fits);
        int good = 0, bad = 0;
        const Motion result = follow(engine, swing, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
            const double value = engine.guard(0)[0], start = piece.variable(0)[0];
            if (start >= 0.0)
                EXPECT_EQ(value, std::sqrt(start));
            else
                EXPECT_TRUE(std::isnan(value));
            (start >= 0.0 ? good : bad) += 1;
        });
        EXPECT_EQ(result.status, StepStatus::ok);
        EXPECT_EQ(result.end.hi, 2.0 * period);
        EXPECT_GT(good, 5);
        EXPECT_GT(bad, 5);
        EXPECT_LT(good + bad, 5000);
    }
}

TEST(Dop853, a_start_flag_holds_for_the_first_step) {
    // the flag makes the guard 7 in the first piece, 0 after it
    Recorder r;
    const Expression flag = r.parameter(0);
    Equations swing = equations(r, {r.input(1), -r.input(0), 7.0 * flag + 0.0 * r.time()}, 2, one_freedom);
    swing.start_flags = {0};
    Dop853Engine engine(1e-6);
    for (int begin = 0; begin < 2; ++begin) {
        engine.start(swing, std::array{1.0}, {}, std::array{1.0, 0.0});
        for (int step = 0; step < 3; ++step) {
            ASSERT_EQ(engine.step(10.0), StepStatus::ok);
            EXPECT_EQ(engine.guard(0)[0], step == 0 ? 7.0 : 0.0);
        }
    }
}

TEST(Dop853, what_rests_stays_at_rest_in_one_step) {
    Recorder r;
    const Equations bead = equations(r, {r.input(1), -4.0 * r.input(0)}, 2, one_freedom);
    Dop853Engine engine(1e-9);
    const Motion result = follow(engine, bead, {}, std::array{0.0, 0.0}, 1e6);
    EXPECT_EQ(result.status, StepStatus::ok);
    EXPECT_EQ(result.x, (std::vector{0.0, 0.0}));
    EXPECT_EQ(engine.work().steps, 1);
}

TEST(Dop853, a_force_that_grows_from_nothing_is_not_overlooked) {
    // x'' = t^20: neither x nor any of its first 21 derivatives tell that it will move
    Recorder r;
    const Equations bead = equations(r, {r.input(1), pow(pow(r.time(), 10), 2)}, 2, one_freedom);
    Dop853Engine engine(1e-9);
    const Motion result = follow(engine, bead, {}, std::array{0.0, 0.0}, 1.0);
    EXPECT_EQ(result.status, StepStatus::ok);
    EXPECT_NEAR(result.x[1] * 21.0, 1.0, 1e-8);
    EXPECT_NEAR(result.x[0] * 21.0 * 22.0, 1.0, 1e-8);
    EXPECT_LT(engine.work().steps, 100);
}

TEST(Dop853, a_first_step_may_be_asked_for_a_million_times_too_long) {
    const Equations swing = pendulum();
    for (const double limit : {1e2, 1e6, 1e12, 1e300}) {
        Dop853Engine engine(1e-9);
        engine.start(swing, {}, {}, at_90_degrees);
        ASSERT_EQ(engine.step(limit), StepStatus::ok);
        EXPECT_LT(engine.piece().duration(), 0.5);
        EXPECT_LT(engine.work().rejected, 400);
        std::array<double, 2> x;
        engine.state(engine.piece().length, x);
        Dop853Engine exact(1e-15);
        const Motion there = follow(exact, swing, {}, at_90_degrees, engine.piece().at(engine.piece().length).hi);
        EXPECT_LT(swing_error(x, there.x), 1e-8);
    }
}

TEST(Dop853, free_fall_is_exact_to_rounding) {
    Recorder r;
    const Equations stone = equations(r, {r.input(1), -9.81}, 2, one_freedom);
    Dop853Engine engine(1e-9);
    const Motion result = follow(engine, stone, {}, std::array{100.0, 0.0}, 4.0);
    EXPECT_NEAR(result.x[0], 100.0 - 0.5 * 9.81 * 16.0, 1e-13);
    EXPECT_NEAR(result.x[1], -9.81 * 4.0, 1e-14);
    EXPECT_EQ(engine.work().steps, 1);
}

TEST(Dop853, a_motion_far_from_its_origin_keeps_the_digits_that_are_there) {
    // an oscillation of 1 m a thousand km away: positions are rounded to 1e-10 of it
    Recorder r;
    const double away = 1e6;
    const Equations bead = equations(r, {r.input(1), away - r.input(0)}, 2, one_freedom);
    Dop853Engine engine(1e-12);
    const Motion result = follow(engine, bead, {}, std::array{away + 1.0, 0.0}, 20.0 * std::numbers::pi);
    EXPECT_EQ(result.status, StepStatus::ok);
    EXPECT_NEAR(result.x[0] - away, 1.0, 1e-9);
    EXPECT_LT(engine.work().steps, 3000);
}

TEST(Dop853, a_slope_that_is_no_number_is_told_at_once) {
    Recorder r;
    const Equations root = equations(r, {sqrt(r.input(0))}, 1, {{0, 1, false}});
    Dop853Engine engine(1e-9);
    engine.start(root, {}, {}, std::array{-1.0});
    EXPECT_EQ(engine.step(1.0), StepStatus::not_finite);
    EXPECT_EQ(engine.step(1.0), StepStatus::not_finite);
    engine.start(root, {}, {}, std::array{std::numeric_limits<double>::quiet_NaN()});
    EXPECT_EQ(engine.step(1.0), StepStatus::not_finite);
    // and the engine is as good as new after it
    engine.start(root, {}, {}, std::array{1.0});
    EXPECT_EQ(engine.step(1.0), StepStatus::ok);
}

TEST(Dop853, motion_into_a_singularity_stalls_there) {
    // x' = -1/x ends at t = 1/2; x' = -sqrt(x) - 1 beyond zero is no number
    Recorder r;
    const Equations fall = equations(r, {-1.0 / r.input(0)}, 1, {{0, 1, true}});
    const Equations drain = equations(r, {-sqrt(r.input(0)) - 1.0}, 1, {{0, 1, true}});
    for (const Equations* equations : {&fall, &drain}) {
        Dop853Engine engine(1e-9);
        const Motion result = follow(engine, *equations, {}, std::array{1.0}, 2.0, [](const Piece& piece) {
            for (int k = 0; k <= piece.order; ++k) ASSERT_TRUE(std::isfinite(piece.coefficients[k]));
        });
        const double end = equations == &fall ? 0.5 : 2.0 - 2.0 * std::log(2.0);
        EXPECT_NE(result.status, StepStatus::ok);
        EXPECT_NEAR(result.end.hi, end, 1e-6);
        EXPECT_LT(engine.work().right_hand_sides, 100000);
    }
}

TEST(Dop853, a_singularity_right_after_the_start_ends_with_a_status) {
    Recorder r;
    const Expression t = r.time();
    const Equations early = equations(r, {r.input(1), 1.0 / (1e-15 - t)}, 2, one_freedom);
    const Equations edge = equations(r, {r.input(1), sqrt(1e-15 - t)}, 2, one_freedom);
    for (const Equations* equations : {&early, &edge})
        for (const double start : {0.0, 1e-15}) {
            Dop853Engine engine(1e-9);
            const Motion result = follow(engine, *equations, {start, 0.0}, std::array{0.0, 1.0}, 1.0);
            EXPECT_NE(result.status, StepStatus::ok);
            EXPECT_LE(result.end.hi, 1.01e-15);
            EXPECT_LT(engine.work().right_hand_sides, 200000);
        }
}

TEST(Dop853, a_stiff_spring_takes_many_steps_and_no_wrong_ones) {
    // a relaxation of rate 1e4 that the motion itself knows nothing of: steps as short as stability asks
    Recorder r;
    const Equations relaxation = equations(r, {-1e4 * (r.input(0) - cos(r.time()))}, 1, {{0, 1, true}});
    Dop853Engine engine(1e-6);
    const Motion result = follow(engine, relaxation, {}, std::array{1.0}, 1.0);
    EXPECT_EQ(result.status, StepStatus::ok);
    EXPECT_NEAR(result.x[0], (1e8 * std::cos(1.0) + 1e4 * std::sin(1.0)) / (1.0 + 1e8), 1e-6);
    EXPECT_LT(engine.work().steps, 10000);
}

TEST(Dop853, a_thousand_changes_of_mode_reuse_what_is_there) {
    const Equations swing = free_pendulum();
    Recorder r;
    const Equations damped =
        equations(r, {r.input(1), -9.81 * sin(r.input(0)) - r.parameter(0) * r.input(1)}, 2, one_freedom);
    Dop853Engine engine(1e-9);
    std::array<double, 2> x = at_90_degrees;
    Instant t;
    for (int k = 0; k < 1000; ++k) {
        // no damping in either: the same swing in two modes
        if (k % 2 == 0)
            engine.start(swing, {}, t, x);
        else
            engine.start(damped, std::array{0.0}, t, x);
        const double limit = 10.0 * period * (k + 1) / 1000.0;
        while (t.hi < limit) {
            ASSERT_EQ(engine.step(limit), StepStatus::ok);
            t = engine.piece().at(engine.piece().length);
        }
        engine.state(engine.piece().length, x);
    }
    EXPECT_LT(swing_error(x, at_90_degrees), 1e-9);
    EXPECT_EQ(engine.work().steps, 1000);
}

/// The pendulum with a sine that is called back, and a guard that needs it.
Equations called_back(std::function<double(double)> sine) {
    const auto function = std::make_shared<Callback>();
    function->name = "sine";
    function->inputs = function->outputs = 1;
    function->function = [sine](const double* x, double* y) { y[0] = sine(x[0]); };
    Recorder r;
    const std::array<Expression, 1> u{r.input(0)};
    const Expression force = r.call(function, u)[0];
    return equations(r, {r.input(1), -9.81 * force, force - 0.25}, 2, one_freedom);
}

TEST(Dop853, a_function_called_back_gives_the_same_motion_and_guards) {
    const Equations recorded = free_pendulum(), swing = called_back([](double u) { return std::sin(u); });
    for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
        Dop853Engine engine(tolerance), other(tolerance);
        double worst = 0.0;
        const Motion result = follow(engine, swing, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
            for (const double fraction : {0.0, 0.3, 0.9, 1.0}) {
                const double tau = fraction * piece.length;
                std::array<double, 2> x;
                piece.state(tau, x);
                const double g = series::value(engine.guard(0), engine.guard_order(), tau);
                worst = std::max(worst, std::abs(g - (std::sin(x[0]) - 0.25)));
            }
        });
        const Motion expected = follow(other, recorded, {}, at_90_degrees, 2.0 * period);
        EXPECT_EQ(result.x, expected.x);
        EXPECT_EQ(engine.work().steps, other.work().steps);
        EXPECT_LT(worst, 32.0 * tolerance + 1e-14);
    }
}

TEST(Dop853, what_a_function_called_back_throws_comes_out_unharmed_and_the_engine_goes_on_after_it) {
    struct Refusal {
        double u;
    };
    bool refuses = true;
    const Equations swing = called_back([&](double u) {
        if (refuses && u < 0.5) throw Refusal{u};
        return std::sin(u);
    });
    Dop853Engine engine(1e-9);
    try {
        follow(engine, swing, {}, at_90_degrees, period);
        FAIL() << "nothing was thrown";
    } catch (const Refusal& refusal) {
        EXPECT_LT(refusal.u, 0.5);
    }
    refuses = false;
    const Motion result = follow(engine, swing, {}, at_90_degrees, period);
    EXPECT_LT(swing_error(result.x, at_90_degrees), 1e-7);
}

TEST(Dop853, a_function_called_back_is_never_given_what_is_no_number) {
    bool was_finite = true;
    const Equations swing = called_back([&](double u) {
        was_finite = was_finite && std::isfinite(u);
        // no number beyond a wall, very large before it
        return u < 0.0 ? std::numeric_limits<double>::quiet_NaN() : 1e300 * u * u;
    });
    Dop853Engine engine(1e-6);
    const Motion result = follow(engine, swing, {}, at_90_degrees, 1e6);
    EXPECT_NE(result.status, StepStatus::ok);
    EXPECT_TRUE(was_finite);
}

}  // namespace
}  // namespace rbdyn::test_dop853
