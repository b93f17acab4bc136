#ifdef RBDYN_WITH_SUNDIALS

#include "rbdyn/engine/cvode.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/series/polynomial.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace rbdyn::test_cvode {
namespace {

using Method = CvodeEngine::Method;
constexpr std::array both{Method::adams, Method::bdf};

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

/// u'' = -g sin u, with lengths of time and angle in other units if asked for; guards sin u and 1 / (1.1 + sin u).
Equations pendulum(double second = 1.0, double radian = 1.0) {
    Recorder r;
    const Expression u = r.input(0), w = r.input(1), sine = sin(u / radian);
    return equations(r, {w, -9.81 * radian / (second * second) * sine, sine, 1.0 / (1.1 + sine)}, 2,
                     {{0, 1, true}, {1, 1, false}});
}
constexpr double period = 2.3678419475762374;  // s, l = 1 m, g = 9.81 m/s2, from 90 degrees: 4 K(sin 45 deg) / sqrt(g)
constexpr std::array<double, 2> at_90_degrees{std::numbers::pi / 2.0, 0.0};
const std::array<double, 2> size_of_swing{std::numbers::pi, std::sqrt(2.0 * 9.81)};

struct Motion {
    StepStatus status = StepStatus::ok;
    Instant end;
    std::vector<double> x;
};

template <class Watch>
Motion follow(CvodeEngine& engine, const Equations& equations, Instant t, std::span<const double> x, double limit,
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

Motion follow(CvodeEngine& engine, const Equations& equations, Instant t, std::span<const double> x, double limit,
              int most_steps = 200000) {
    return follow(
        engine, equations, t, x, limit, [](const Piece&) {}, most_steps);
}

double swing_error(std::span<const double> x, std::span<const double> expected) {
    double error = 0.0;
    for (std::size_t i = 0; i < 2; ++i) error = std::max(error, std::abs(x[i] - expected[i]) / size_of_swing[i]);
    return error;
}

TEST(Cvode, is_named_after_its_method) {
    EXPECT_EQ(CvodeEngine(Method::adams, 1e-9).name(), "cvode-adams");
    EXPECT_EQ(CvodeEngine(Method::bdf, 1e-9).name(), "cvode-bdf");
}

TEST(Cvode, a_pendulum_is_back_after_ten_periods) {
    const Equations equations = pendulum();
    // measured: Adams 200 and 290 times rtol, BDF 150 and 2000 times
    for (const Method method : both)
        for (const double rtol : {1e-6, 1e-9}) {
            CvodeEngine engine(method, rtol);
            const Motion result = follow(engine, equations, {}, at_90_degrees, 10.0 * period);
            EXPECT_EQ(result.status, StepStatus::ok);
            EXPECT_LT(swing_error(result.x, at_90_degrees), rtol * (method == Method::adams ? 1e3 : 1e4));
            EXPECT_GT(engine.work().steps, 100);
            EXPECT_LT(engine.work().right_hand_sides, 2 * engine.work().steps + 50);
            EXPECT_LT(engine.work().rejected, engine.work().steps / 10);
        }
}

TEST(Cvode, accuracy_asked_for_below_rounding_gives_what_rounding_allows) {
    const Equations equations = pendulum();
    // measured: 1e-12 and 3e-11
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-17);
        const Motion result = follow(engine, equations, {}, at_90_degrees, 10.0 * period);
        EXPECT_EQ(result.status, StepStatus::ok);
        EXPECT_LT(swing_error(result.x, at_90_degrees), 2e-10);
    }
}

TEST(Cvode, a_stiff_relaxation_takes_bdf_few_steps) {
    Recorder r;
    const Expression x = r.input(0);
    const double rate = 1e6;
    for (const bool is_position : {false, true}) {
        const Equations relaxation = equations(r, {-rate * (x - cos(r.time()))}, 1, {{0, 1, is_position}});
        for (const double start : {1.0, 3.0}) {
            CvodeEngine engine(Method::bdf, 1e-6);
            const Motion result = follow(engine, relaxation, {}, std::array{start}, 10.0);
            EXPECT_EQ(result.status, StepStatus::ok);
            EXPECT_NEAR(result.x[0], (rate * rate * std::cos(10.0) + rate * std::sin(10.0)) / (1.0 + rate * rate),
                        1e-4);
            EXPECT_LT(engine.work().steps, 600);
            EXPECT_LT(engine.work().jacobians, engine.work().steps / 4);
        }
    }
}

TEST(Cvode, the_exact_jacobian_carries_robertsons_reaction) {
    // H. H. Robertson 1966, the standard stiff test: values at t = 40 from the CVODE documentation's sample output,
    // which has 4 to 5 right digits, and the invariant y1 + y2 + y3 = 1
    Recorder r;
    const Expression a = r.input(0), b = r.input(1), c = r.input(2);
    const Expression slow = 0.04 * a, back = 1e4 * b * c, fast = 3e7 * b * b;
    const Equations reaction =
        equations(r, {back - slow, slow - back - fast, fast}, 3, {{0, 1, false}, {1, 1, false}, {2, 1, false}});
    CvodeEngine engine(Method::bdf, 1e-9);
    const Motion result = follow(engine, reaction, {}, std::array{1.0, 0.0, 0.0}, 40.0);
    EXPECT_EQ(result.status, StepStatus::ok);
    EXPECT_NEAR(result.x[0], 0.71582706, 2e-7);
    EXPECT_NEAR(result.x[1], 9.1855e-6, 1e-9);
    EXPECT_NEAR(result.x[2], 0.28416375, 2e-7);
    EXPECT_NEAR(result.x[0] + result.x[1] + result.x[2], 1.0, 1e-12);
    // Newton's method converges with a Jacobian that is right: hardly a step fails, few Jacobians are needed
    EXPECT_LT(engine.work().steps, 1500);
    EXPECT_LT(engine.work().rejected, engine.work().steps / 10);
    EXPECT_LT(engine.work().jacobians, engine.work().steps / 10);
    EXPECT_LT(engine.work().right_hand_sides, 1.5 * static_cast<double>(engine.work().steps));
}

TEST(Cvode, pieces_join_to_rounding) {
    const Equations equations = pendulum();
    for (const Method method : both)
        for (const double rtol : {1e-3, 1e-6, 1e-9, 1e-12}) {
            CvodeEngine engine(method, rtol);
            std::array<double, 2> before = at_90_degrees;
            Instant end;
            follow(engine, equations, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
                ASSERT_EQ(piece.length, 1.0);
                ASSERT_LE(std::abs(piece.start - end), 1e-15 * piece.unit);
                ASSERT_LE(piece.start - end, 0.0);
                end = piece.at(1.0);
                // the first is set to what it must be; the second is CVODE's polynomial at the start of its step
                std::array<double, 2> first, second, last;
                engine.state(0.0, first);
                engine.state(1e-20, second);
                EXPECT_EQ(first, before);
                EXPECT_LT(swing_error(second, before), 1e-14);
                piece.state(0.0, first);
                EXPECT_EQ(first, before);
                engine.state(1.0, before);
                piece.state(1.0, last);
                EXPECT_LT(swing_error(last, before), 1e-14);
            });
        }
}

TEST(Cvode, a_piece_obeys_the_equation_of_motion_all_along) {
    const Equations equations = pendulum();
    for (const Method method : both)
        for (const double rtol : {1e-6, 1e-9}) {
            CvodeEngine engine(method, rtol);
            double worst = 0.0;
            follow(engine, equations, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
                for (const double tau : {0.0, 0.3, 0.7, 1.0}) {
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
            EXPECT_LT(worst, 20.0 * rtol);  // measured: 2.5 to 8 times
        }
}

TEST(Cvode, motion_goes_on_from_any_of_its_states) {
    const Equations equations = pendulum();
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9);
        const Motion half = follow(engine, equations, {}, at_90_degrees, 1.7);
        EXPECT_EQ(half.end.hi, 1.7);
        engine.start(equations, {}, half.end, half.x);
        ASSERT_EQ(engine.step(10.0 * period), StepStatus::ok);
        EXPECT_EQ(engine.piece().start.hi, 1.7);
        EXPECT_EQ(engine.piece().variable(0)[0], half.x[0]);
        EXPECT_EQ(engine.piece().variable(1)[0], half.x[1]);
        const Motion whole = follow(engine, equations, half.end, half.x, 10.0 * period);
        EXPECT_LT(swing_error(whole.x, at_90_degrees), 1e-5);
    }
}

TEST(Cvode, a_step_ends_at_the_limit_and_never_beyond) {
    const Equations equations = pendulum();
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9);
        // limits as near as the next number, asked for in the middle of a run
        double t = 1.0, limit = 1.0;
        engine.start(equations, {}, {t, 0.0}, at_90_degrees);
        for (int k = 0; k < 400; ++k) {
            limit = std::max(limit, k % 3 == 0 ? std::nextafter(t, 1e9) : t + 1e-17 * std::pow(10.0, k % 17));
            if (!(limit > t)) limit = std::nextafter(t, 1e9);
            ASSERT_EQ(engine.step(limit), StepStatus::ok) << t << " to " << limit;
            const double far = limit - t;
            t = engine.piece().at(1.0).hi;
            ASSERT_LE(t, limit);
            std::array<double, 2> first, middle;
            engine.state(0.0, first);
            engine.state(0.5, middle);
            ASSERT_LE(swing_error(middle, first), 10.0 * far + 1e-15);
        }
        // the end has more digits than t, which may be a little beyond it
        const bool is_beyond = engine.piece().at(1.0).lo < 0.0;
        EXPECT_EQ(engine.step(is_beyond ? std::nextafter(t, 0.0) : t), StepStatus::stalled);
        EXPECT_EQ(engine.step(t - 1.0), StepStatus::stalled);
        std::array<double, 2> x;
        engine.state(1.0, x);
        const Motion home = follow(engine, equations, {t, 0.0}, x, 5.0 * period);
        CvodeEngine undisturbed(method, 1e-9);
        const Motion expected = follow(undisturbed, equations, {1.0, 0.0}, at_90_degrees, 5.0 * period);
        EXPECT_LT(swing_error(home.x, expected.x), 1e-5);
    }
}

TEST(Cvode, the_unit_of_time_and_length_does_not_matter) {
    const double second = 0x1p10, radian = 0x1p-7;
    const Equations equations = pendulum(), scaled = pendulum(second, radian);
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9), other(method, 1e-9);
        std::vector<std::array<double, 4>> path, other_path;
        follow(engine, equations, {}, at_90_degrees, 2.0 * period, [&](const Piece& p) {
            std::array<double, 2> x;
            engine.state(1.0, x);
            path.push_back({p.at(1.0).hi, x[0], x[1], p.variable(1)[p.order]});
        });
        follow(other, scaled, {}, std::array{radian * at_90_degrees[0], 0.0}, 2.0 * period * second,
               [&](const Piece& p) {
                   std::array<double, 2> x;
                   other.state(1.0, x);
                   const double speed = radian / second;
                   other_path.push_back(
                       {p.at(1.0).hi / second, x[0] / radian, x[1] / speed, p.variable(1)[p.order] / speed});
               });
        EXPECT_EQ(path, other_path);
    }
}

TEST(Cvode, short_steps_late_in_a_run_keep_their_digits) {
    // a swing of 1e-6 s at t = 1e9 s, where neighbouring numbers are 1.2e-7 s apart
    const double second = 1e-6;
    const Equations equations = pendulum(second);
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9);
        const double end = 1e9 + 0x1p-18;  // 32 neighbours on
        const Motion late = follow(engine, equations, {1e9, 0.0}, at_90_degrees, end);
        CvodeEngine again(method, 1e-9);
        const Motion early = follow(again, equations, {}, at_90_degrees, 0x1p-18);
        EXPECT_EQ(late.status, StepStatus::ok);
        EXPECT_EQ(late.x, early.x);
        EXPECT_EQ(engine.work().steps, again.work().steps);
    }
}

TEST(Cvode, a_guard_is_its_function_along_the_piece) {
    const Equations equations = pendulum();
    for (const Method method : both)
        for (const double rtol : {1e-6, 1e-9, 1e-12}) {
            CvodeEngine engine(method, rtol);
            double smooth = 0.0, nearly_singular = 0.0;
            follow(engine, equations, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
                for (const double tau : {0.0, 0.5, 1.0}) {
                    std::array<double, 2> x;
                    piece.state(tau, x);
                    const double sine = std::sin(x[0]);
                    smooth =
                        std::max(smooth, std::abs(series::value(engine.guard(0), engine.guard_order(), tau) - sine));
                    nearly_singular = std::max(
                        nearly_singular,
                        std::abs(series::value(engine.guard(1), engine.guard_order(), tau) - 1.0 / (1.1 + sine)));
                }
            });
            EXPECT_LT(smooth, 1e-15);
            EXPECT_LT(nearly_singular, 1e-3 * rtol + 1e-13);
            EXPECT_EQ(engine.work().guard_evaluations, 6 * engine.work().steps);
        }
}

TEST(Cvode, a_guard_that_was_no_number_recovers) {
    // sqrt(u) for a swing through u = 0
    Recorder r;
    const Expression u = r.input(0), w = r.input(1);
    const Equations swing = equations(r, {w, -9.81 * sin(u), sqrt(u)}, 2, {{0, 1, true}, {1, 1, false}});
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-6);
        int good = 0, bad = 0;
        follow(engine, swing, {}, at_90_degrees, 2.0 * period, [&](const Piece& piece) {
            const double value = engine.guard(0)[0], start = piece.variable(0)[0];
            if (start >= 0.0)
                EXPECT_EQ(value, std::sqrt(start));
            else
                EXPECT_TRUE(std::isnan(value));
            (start >= 0.0 ? good : bad) += 1;
            if (start > 0.5) {
                EXPECT_TRUE(std::isfinite(series::value(engine.guard(0), engine.guard_order(), 1.0)));
            }
        });
        EXPECT_GT(good, 10);
        EXPECT_GT(bad, 10);
    }
}

TEST(Cvode, a_start_flag_holds_for_the_first_step) {
    // the flag makes the guard 7 in the first piece, 0 after it
    Recorder r;
    const Expression flag = r.parameter(0);
    Equations swing =
        equations(r, {r.input(1), -r.input(0), 7.0 * flag + 0.0 * r.time()}, 2, {{0, 1, true}, {1, 1, false}});
    swing.start_flags = {0};
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-6);
        for (int begin = 0; begin < 2; ++begin) {
            engine.start(swing, std::array{1.0}, {}, std::array{1.0, 0.0});
            for (int step = 0; step < 3; ++step) {
                ASSERT_EQ(engine.step(10.0), StepStatus::ok);
                EXPECT_EQ(engine.guard(0)[0], step == 0 ? 7.0 : 0.0);
            }
        }
    }
}

TEST(Cvode, what_rests_stays_at_rest_in_one_step) {
    Recorder r;
    const Equations bead = equations(r, {r.input(1), -4.0 * r.input(0)}, 2, {{0, 1, true}, {1, 1, false}});
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9);
        const Motion result = follow(engine, bead, {}, std::array{0.0, 0.0}, 1e6);
        EXPECT_EQ(result.status, StepStatus::ok);
        EXPECT_EQ(result.x, (std::vector{0.0, 0.0}));
        EXPECT_EQ(engine.work().steps, 1);
    }
}

TEST(Cvode, a_force_that_grows_from_nothing_is_not_overlooked) {
    // x'' = t^20: neither x nor any of its first 21 derivatives tell that it will move
    Recorder r;
    const Expression t = r.time();
    const Equations bead = equations(r, {r.input(1), pow(pow(t, 10), 2)}, 2, {{0, 1, true}, {1, 1, false}});
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9);
        const Motion result = follow(engine, bead, {}, std::array{0.0, 0.0}, 1.0);
        EXPECT_EQ(result.status, StepStatus::ok);
        // the first scale is that of a force at full strength for all of the time: 462 times the motion
        EXPECT_NEAR(result.x[1] * 21.0, 1.0, 1e-4);
        EXPECT_NEAR(result.x[0] * 21.0 * 22.0, 1.0, 1e-4);
    }
}

TEST(Cvode, free_fall_is_exact_to_the_tolerance_from_rest) {
    Recorder r;
    const Equations stone = equations(r, {r.input(1), -9.81}, 2, {{0, 1, true}, {1, 1, false}});
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9);
        const Motion result = follow(engine, stone, {}, std::array{100.0, 0.0}, 4.0);
        EXPECT_NEAR(result.x[0], 100.0 - 0.5 * 9.81 * 16.0, 1e-6);
        EXPECT_NEAR(result.x[1], -9.81 * 4.0, 1e-7);
        EXPECT_LT(engine.work().steps, 60);
    }
}

TEST(Cvode, a_slope_that_is_no_number_is_told_at_once) {
    Recorder r;
    const Equations root = equations(r, {sqrt(r.input(0))}, 1, {{0, 1, false}});
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9);
        engine.start(root, {}, {}, std::array{-1.0});
        EXPECT_EQ(engine.step(1.0), StepStatus::not_finite);
        EXPECT_EQ(engine.step(1.0), StepStatus::not_finite);
        engine.start(root, {}, {}, std::array{std::numeric_limits<double>::quiet_NaN()});
        EXPECT_EQ(engine.step(1.0), StepStatus::not_finite);
        // and the engine is as good as new after it
        engine.start(root, {}, {}, std::array{1.0});
        EXPECT_EQ(engine.step(1.0), StepStatus::ok);
    }
}

TEST(Cvode, motion_into_a_singularity_stalls_there) {
    // x' = -1/x ends at t = 1/2; x' = -sqrt(x) / 0 beyond zero is no number
    Recorder r;
    const Equations fall = equations(r, {-1.0 / r.input(0)}, 1, {{0, 1, true}});
    const Equations drain = equations(r, {-sqrt(r.input(0)) - 1.0}, 1, {{0, 1, true}});
    for (const Method method : both)
        for (const Equations* equations : {&fall, &drain}) {
            CvodeEngine engine(method, 1e-9);
            const Motion result = follow(engine, *equations, {}, std::array{1.0}, 2.0, [](const Piece& piece) {
                for (int k = 0; k <= piece.order; ++k) ASSERT_TRUE(std::isfinite(piece.coefficients[k]));
            });
            const double end = equations == &fall ? 0.5 : 2.0 - 2.0 * std::log(2.0);
            EXPECT_NE(result.status, StepStatus::ok);
            EXPECT_NEAR(result.end.hi, end, 1e-5);
        }
}

TEST(Cvode, a_thousand_changes_of_mode_reuse_what_is_there) {
    const Equations swing = pendulum();
    Recorder r;
    const Equations damped = equations(r, {r.input(1), -9.81 * sin(r.input(0)) - r.parameter(0) * r.input(1)}, 2,
                                       {{0, 1, true}, {1, 1, false}});
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-9);
        std::array<double, 2> x = at_90_degrees;
        Instant t;
        std::int64_t rejected = 0, steps = 0;
        for (int k = 0; k < 1000; ++k) {
            // no damping in either: the same swing in two modes
            if (k % 2 == 0)
                engine.start(swing, {}, t, x);
            else
                engine.start(damped, std::array{0.0}, t, x);
            const double limit = 10.0 * period * (k + 1) / 1000.0;
            while (t.hi < limit) {
                ASSERT_EQ(engine.step(limit), StepStatus::ok);
                t = engine.piece().at(1.0);
            }
            engine.state(1.0, x);
            EXPECT_GE(engine.work().rejected, rejected);
            EXPECT_GT(engine.work().steps, steps);
            rejected = engine.work().rejected;
            steps = engine.work().steps;
        }
        // the errors each step may make, had they all one sign; measured: 0.6 of it
        EXPECT_LT(swing_error(x, at_90_degrees), 1e-9 * static_cast<double>(steps));
    }
}

TEST(Cvode, failures_are_told_by_status_alone) {
    Recorder r;
    const Equations fall = equations(r, {-1.0 / r.input(0)}, 1, {{0, 1, true}});
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    for (const Method method : both) {
        CvodeEngine engine(method, 1e-12);
        EXPECT_NE(follow(engine, fall, {}, std::array{1.0}, 2.0).status, StepStatus::ok);
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace rbdyn::test_cvode

#endif
