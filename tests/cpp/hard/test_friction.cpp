// Friction and resistance where libraries break: sticking for ever, release, edges of the cone, reversal, inflection.
#include <gtest/gtest.h>

#include <numbers>

#include "rbdyn/integrate.hpp"
#include "support.hpp"

namespace rbdyn::test::test_friction {
namespace {

using Real = long double;
constexpr double pi = std::numbers::pi;

/// One bead on one rail.
struct Bead {
    Scene scene;
    BodyHandle handle;

    Bead(const Vector3& field, const Curve& curve, std::optional<Coulomb> friction, RailStart start,
         TimeFunction drive = 0.0, double mass = 1.0)
        : scene(field), handle(scene.add(Particle{mass}, Rail(curve, friction, {.drive = std::move(drive)}), start)) {}
};

const Vector3 none = Vector3::Zero();

// --- sticking ---

TEST(Sticking, a_bead_below_the_cone_stays_exactly_where_it_is_for_a_million_seconds) {
    const Bead bead(down, incline(0.5), Coulomb{0.6, 0.3}, {.parameter = 0.3});
    const Trajectory run = simulate(bead.scene, {.until = 1e6});
    EXPECT_EQ(run.status(), Status::reached_end);
    EXPECT_EQ(run.end(), 1e6);
    EXPECT_TRUE(run.events().empty());
    const Vector3 there = run[bead.handle].position(0.0);
    for (double t : {0.0, 1e-9, 1.0, 12345.678, 999999.9, 1e6}) {
        EXPECT_EQ(run[bead.handle].parameter(t), 0.3);
        EXPECT_EQ(run[bead.handle].position(t), there);
        EXPECT_EQ(run[bead.handle].speed(t), 0.0);
        EXPECT_EQ(run[bead.handle].velocity(t).norm(), 0.0);
        EXPECT_EQ(run[bead.handle].acceleration(t).norm(), 0.0);
        // the rail carries the weight
        EXPECT_LE((run[bead.handle].reaction(t) + down).norm(), 4.0 * epsilon * gravity);
    }
}

TEST(Sticking, a_bead_that_came_to_rest_stays_exactly_where_it_stopped) {
    const Bead bead(down, vertical_circle(1.0), Coulomb{0.5, 0.25}, {.parameter = 1.5});
    const Trajectory run = simulate(bead.scene, {.until = 1e6, .error = 1e-12});
    const auto sticks = run.events().times("stick");
    ASSERT_EQ(sticks.size(), 1u);
    const Vector3 there = run[bead.handle].position(sticks[0]);
    for (double t : {sticks[0], 3.0, 1e3, 1e6}) {
        EXPECT_EQ(run[bead.handle].position(t), there);
        EXPECT_EQ(run[bead.handle].speed(t), 0.0);
    }
}

TEST(Sticking, at_the_time_of_its_turn_a_bead_has_speed_zero_exactly) {
    for (double mass : {0.75, 1.0, 2.0}) {
        const Bead bead(down, vertical_circle(1.0), Coulomb{0.25, 0.125}, {.parameter = 2.5}, 0.0, mass);
        const Trajectory run = simulate(bead.scene, {.until = 6.0, .error = 1e-12});
        ASSERT_EQ(kinds(run), "normal-zero reverse reverse reverse reverse stick");
        for (const Event& e : run.events()) {
            if (e.kind == EventKind::normal_zero) continue;
            EXPECT_EQ(run[bead.handle].speed(e.time), 0.0) << e;
            EXPECT_NEAR(run[bead.handle].speed(e.time, Side::before), 0.0, 1e-13) << e;
        }
    }
}

TEST(Sticking, on_a_slope_equal_to_the_static_coefficient_a_bead_holds) {
    for (double slope : {0.5, 0.25, 1.0, 2.0, 0.1, 0.2, 0.3, 1.0 / 3.0, 0.7, 0.9, 1.1, 2.718281828, 1e-3, 7.3, 100.0}) {
        for (double start : {0.0, 0.3, -1e3}) {
            const Bead bead(down, incline(slope), Coulomb{slope, 0.5 * slope}, {.parameter = start});
            const Trajectory run = simulate(bead.scene, {.until = 10.0});
            EXPECT_TRUE(run.events().empty()) << slope;
            EXPECT_EQ(run[bead.handle].parameter(10.0), start) << slope;
        }
    }
}

TEST(Sticking, a_pull_that_grows_past_equal_coefficients_breaks_away_once_however_late) {
    // m w' = 4 sin(rate d) - mu m g from d = asin(mu m g/4)/rate on: the slip begins with the square of time, and the
    // rounding of the time gives it a slope of either sign
    for (const char* engine : {"taylor", "dop853", "cvode-adams"})
        for (const double error : {1e-6, 1e-8})
            for (const double start : {0.0, 1.0, 20.0, 100.0, 1000.0, 1e5, 1e7})
                for (const double rate : {1.0, 1.25}) {
                    // as exact as the time is
                    if (start == 1e7 && (error < 1e-6 || engine == std::string("cvode-adams"))) continue;
                    Scene scene(down);
                    const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.3}));
                    scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                                    using S = std::decay_t<decltype(t)>;
                                    return Vector3Of<S>{S(4.0) * sin(S(rate) * (t - S(start))), S(0.0), S(0.0)};
                                }),
                                bead);
                    const Trajectory run =
                        simulate(scene, {.until = start + 1.25, .start = start, .error = error, .engine = engine});
                    ASSERT_EQ(kinds(run), "slip") << engine << ' ' << error << ' ' << start << ' ' << rate;
                    const Real limit = 0.3L * Real(gravity), away = std::asin(limit / 4) / rate;
                    EXPECT_NEAR(run.events()[0].time - start, static_cast<double>(away), 1e-13 + 2.0 * epsilon * start);
                    const Real speed =
                        4 / Real(rate) * (std::cos(rate * away) - std::cos(1.25L * rate)) - limit * (1.25L - away);
                    EXPECT_NEAR(run[bead].speed(run.end()), static_cast<double>(speed), error + 8.0 * epsilon * start);
                }
}

TEST(Sticking, on_a_slope_a_little_above_the_static_coefficient_a_bead_slides_and_a_little_below_it_holds) {
    for (double slope : {0.5, 0.3, 1.0, 1.0 / 3.0, 7.3})
        for (double nearness : {1e-6, 1e-9, 1e-12}) {
            const double dynamic = 0.5 * slope, cosine = 1.0 / std::sqrt(1.0 + slope * slope);
            const Bead above(down, incline(slope * (1.0 + nearness)), Coulomb{slope, dynamic}, {.parameter = 0.0});
            const double pull = gravity * cosine * (slope - dynamic);
            EXPECT_NEAR(simulate(above.scene, {.until = 1.0})[above.handle].parameter(1.0), 0.5 * pull,
                        (1e-9 + 2.0 * nearness) * pull);
            const Bead below(down, incline(slope * (1.0 - nearness)), Coulomb{slope, dynamic}, {.parameter = 0.0});
            EXPECT_EQ(simulate(below.scene, {.until = 1.0})[below.handle].parameter(1.0), 0.0);
        }
}

TEST(Sticking, a_rail_that_only_holds_lets_a_moving_bead_slide_as_if_smooth) {
    // mu_dynamic = 0: up the slope it slows by gravity alone, and is held where it stops
    const double slope = 0.5, sine = slope / std::sqrt(1.0 + slope * slope), v0 = 3.0;
    const Bead up(down, incline(slope), Coulomb{0.6, 0.0}, {.parameter = 0.0, .speed = -v0});
    const Trajectory run = simulate(up.scene, {.until = 5.0, .error = 1e-12});
    ASSERT_EQ(kinds(run), "stick");
    EXPECT_NEAR(run.events()[0].time, v0 / (gravity * sine), 1e-12 * run.events()[0].time);
    EXPECT_NEAR(run[up.handle].parameter(5.0), -0.5 * v0 * v0 / (gravity * sine), 1e-12);
    EXPECT_EQ(run[up.handle].speed(5.0), 0.0);
    // too steep to hold: it turns back and slides for ever
    const Bead back(down, incline(slope), Coulomb{0.4, 0.0}, {.parameter = 0.0, .speed = -v0});
    const Trajectory slides = simulate(back.scene, {.until = 5.0, .error = 1e-12});
    EXPECT_EQ(kinds(slides), "reverse");
    EXPECT_NEAR(slides[back.handle].speed(5.0), 5.0 * gravity * sine - v0, 1e-11);
}

// --- the belt: m = k = V = 1 and a spring that begins at rest ---

/// Belt with weight 1: stick 2 A/V, slip 2/w (pi - atan(w A/V)), where A = (mu_s - mu_d) m g/k and w^2 = k/m.
struct Belt {
    Bead bead;
    double slip, stick;

    Belt(double mu_static, double mu_dynamic, double belt_speed)
        : bead({0, 0, -1}, along_x, Coulomb{mu_static, mu_dynamic}, {.parameter = 0.0, .speed = belt_speed},
               belt_speed),
          slip(2.0 * (pi - std::atan((mu_static - mu_dynamic) / belt_speed))),
          stick(2.0 * (mu_static - mu_dynamic) / belt_speed) {
        bead.scene.connect(Spring{.stiffness = 1.0}, bead.handle, Vector3(Vector3::Zero()));
    }
};

TEST(Belt, slips_and_sticks_with_the_period_of_the_closed_form) {
    Belt belt(1.0, 0.5, 1.0);
    EXPECT_NEAR(belt.slip, 5.35589008917797424, 1e-15);
    const Trajectory run = simulate(belt.bead.scene, {.until = 100.0, .error = 1e-12});
    // it begins stuck, silently, and first lets go where the spring pulls with mu_s m g = 1
    ASSERT_GE(run.events().size(), 30u);
    for (std::size_t k = 0; k < run.events().size(); ++k) {
        const double cycles = static_cast<double>(k / 2);
        const double expected = 1.0 + cycles * (1.0 + 5.35589008917797424) + (k % 2 == 1 ? 5.35589008917797424 : 0.0);
        EXPECT_EQ(run.events()[k].kind, k % 2 == 0 ? EventKind::slip : EventKind::stick) << k;
        EXPECT_NEAR(run.events()[k].time, expected, 1e-12 * expected) << k;
    }
}

TEST(Belt, holds_and_lets_go_with_a_static_coefficient_a_hundred_times_the_dynamic_one) {
    const Belt belt(1.0, 0.01, 0.125);
    const Trajectory run = simulate(belt.bead.scene, {.until = 100.0, .error = 1e-12});
    const auto slips = run.events().times("slip"), sticks = run.events().times("stick");
    ASSERT_GE(slips.size(), 5u);
    ASSERT_GE(sticks.size(), 4u);
    EXPECT_NEAR(slips[0], 8.0, 8e-12);
    for (std::size_t k = 0; k + 1 < std::min(slips.size(), sticks.size()); ++k) {
        EXPECT_NEAR(sticks[k] - slips[k], belt.slip, 2e-12 * sticks[k]);
        EXPECT_NEAR(slips[k + 1] - sticks[k], belt.stick, 2e-12 * slips[k + 1]);
    }
}

TEST(Belt, is_nearly_harmonic_as_the_static_coefficient_falls_to_the_dynamic_one) {
    // a gap of 1e-3 is resolved to all digits
    const Belt wide(0.5 + 0x1p-10, 0.5, 1.0);
    const Trajectory run = simulate(wide.bead.scene, {.until = 60.0, .error = 1e-9});
    const auto slips = run.events().times("slip");
    ASSERT_EQ(slips.size(), 10u);
    for (std::size_t k = 1; k < slips.size(); ++k)
        EXPECT_NEAR(slips[k] - slips[k - 1], wide.slip + wide.stick, 2e-9 * slips[k]);
    // gaps below rounding: the stick is shorter than its time can be known, but the motion is as well known as ever,
    // x = 1/2 + sin t, and the events stay few
    for (double gap : {1e-9, 1e-12, 0.0}) {
        const Belt narrow(0.5 * (1.0 + gap), 0.5, 1.0);
        const Trajectory harmonic = simulate(narrow.bead.scene, {.until = 60.0, .rtol = 1e-13});
        EXPECT_EQ(harmonic.status(), Status::reached_end);
        EXPECT_LE(harmonic.events().size(), 4u * 10u) << gap;
        for (double t = 1.0; t < 60.0; t += 0.71) {
            EXPECT_NEAR(harmonic[narrow.bead.handle].parameter(t), 0.5 + std::sin(t - 0.5), 1e-7) << gap << ' ' << t;
            EXPECT_NEAR(harmonic[narrow.bead.handle].speed(t), std::cos(t - 0.5), 1e-7) << gap << ' ' << t;
        }
    }
}

TEST(Belt, has_all_holds_of_a_tiny_gap_or_says_from_where_on_rounding_decides_of_them) {
    // slip rises to gap^2/2 above zero and falls again: rounding where gap^2 is
    for (const double gap : {0x1p-18, 0x1p-21, 0x1p-24, 0x1p-27, 0x1p-30, 1e-12})
        for (const double error : {1e-6, 1e-8, 1e-10, 1e-13})
            for (const std::string engine : {"taylor", "dop853"}) {
                const Belt belt(0.5 + gap, 0.5, 1.0);
                const Attempt result = attempt(belt.bead.scene, {.until = 30.0, .error = error, .engine = engine});
                const auto certain = result.outcome == simulating::Outcome::good ? 30.0 : result.run.certain_until();
                std::size_t k = 0;
                for (double t = 0.5 + gap; t < certain - 2.0 * belt.stick;
                     t += k % 2 == 0 ? belt.slip : belt.stick, ++k) {
                    ASSERT_LT(k, result.run.events().size()) << gap << ' ' << error << engine;
                    EXPECT_EQ(result.run.events()[k].kind, k % 2 == 0 ? EventKind::slip : EventKind::stick);
                    EXPECT_NEAR(result.run.events()[k].time, t, error * t) << gap << ' ' << error << engine;
                }
                const bool is_good = result.outcome == simulating::Outcome::good;
                EXPECT_TRUE(!is_good || result.run.events().size() == k) << gap << ' ' << error;
                EXPECT_TRUE(is_good || gap < 0x1p-18 || error < 1e-10) << gap << ' ' << error;
            }
}

TEST(Belt, of_equal_coefficients_never_holds_again_whatever_the_accuracy) {
    const Belt belt(0.5, 0.5, 1.0);
    for (const double error : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13})
        for (const std::string engine : {"taylor", "dop853"})
            EXPECT_EQ(simulate(belt.bead.scene, {.until = 30.0, .error = error, .engine = engine}).events().size(), 1u)
                << error << engine;
}

/// Motion of a bead with spring w^2 on a line whose surface moves with V(t) = a sin(b t), piece by piece in closed
/// form; zeros by bisection on a fine grid, all in long double.
struct DrivenLine {
    Real w2, a, b, hold, slide;  // accelerations mu g
    struct Change {
        Real time;
        std::string kind;
    };

    Real V(Real t) const { return a * std::sin(b * t); }
    Real V_rate(Real t) const { return a * b * std::cos(b * t); }

    /// From rest at x on a rail that sets out from rest, up to a time; the last state is left in x, v.
    std::vector<Change> operator()(Real& x, Real& v, Real until) const {
        std::vector<Change> changes;
        const Real w = std::sqrt(w2);
        int slip = sign_of(0, x);  // 0 sticks
        Real t = 0;
        while (t < until) {
            const Real t0 = t, x0 = x, v0 = v, centre = -slip * slide / w2;
            const auto position = [&](Real s) {
                if (slip == 0) return x0 + a / b * (std::cos(b * t0) - std::cos(b * s));
                return centre + (x0 - centre) * std::cos(w * (s - t0)) + v0 / w * std::sin(w * (s - t0));
            };
            const auto speed = [&](Real s) {
                if (slip == 0) return V(s);
                return -(x0 - centre) * w * std::sin(w * (s - t0)) + v0 * std::cos(w * (s - t0));
            };
            const auto valid = [&](Real s) {
                if (slip == 0) return hold - std::abs(V_rate(s) + w2 * position(s));
                return slip * (speed(s) - V(s));
            };
            // the first change of sign beyond the start
            const Real step = 1e-3L;
            Real lo = t0 + 1e-6L, hi = lo + step;
            while (hi < until && valid(hi) > 0) lo = hi, hi += step;
            if (hi >= until) {
                x = position(until);
                v = speed(until);
                return changes;
            }
            for (int k = 0; k < 80; ++k) {
                const Real middle = (lo + hi) / 2;
                (valid(middle) > 0 ? lo : hi) = middle;
            }
            t = hi;
            x = position(t);
            v = V(t);
            const int before = slip;
            slip = before == 0 ? (V_rate(t) + w2 * x < 0 ? 1 : -1) : sign_of(t, x);
            changes.push_back({t, before == 0 ? "slip" : slip == 0 ? "stick" : "reverse"});
        }
        return changes;
    }

    int sign_of(Real t, Real x) const {
        const Real needed = V_rate(t) + w2 * x;
        return std::abs(needed) <= hold ? 0 : needed < 0 ? 1 : -1;
    }
};

void compare_with_pieces(const DrivenLine& line, double x0, double until, const std::string& needs) {
    const double a = static_cast<double>(line.a), b = static_cast<double>(line.b);
    Bead bead(down, along_x,
              Coulomb{static_cast<double>(line.hold / gravity), static_cast<double>(line.slide / gravity)},
              {.parameter = x0, .speed = 0.0}, TimeFunction([a, b](const auto& t) { return a * sin(b * t); }));
    if (line.w2 > 0) bead.scene.connect(Spring{.stiffness = static_cast<double>(line.w2)}, bead.handle, Vector3(none));
    const Trajectory run = simulate(bead.scene, {.until = until, .error = 1e-11});
    Real x = x0, v = 0;
    const auto expected = line(x, v, until);
    std::string line_of_kinds;
    for (const auto& change : expected) line_of_kinds += (line_of_kinds.empty() ? "" : " ") + change.kind;
    ASSERT_NE(line_of_kinds.find(needs), std::string::npos) << "the case shows too little: " << line_of_kinds;
    ASSERT_EQ(kinds(run), line_of_kinds);
    for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_NEAR(run.events()[k].time, static_cast<double>(expected[k].time), 1e-11 * run.events()[k].time) << k;
    const Scales scale = scales(run, bead.handle);
    EXPECT_NEAR(run[bead.handle].parameter(until), static_cast<double>(x), 1e-11 * scale.extent);
    EXPECT_NEAR(run[bead.handle].speed(until), static_cast<double>(v), 1e-11 * scale.speed);
}

TEST(Drive, a_shaking_rail_drags_a_bead_on_a_spring_as_pieces_of_closed_form_say) {
    // coefficients exact in binary, so that both sides have the same numbers
    compare_with_pieces({.w2 = 9, .a = 0.3, .b = 2, .hold = 0.125L * gravity, .slide = 0.0625L * gravity}, 0.25, 30.0,
                        "stick");
    compare_with_pieces({.w2 = 9, .a = 0.3, .b = 5, .hold = 0.0625L * gravity, .slide = 0.03125L * gravity}, 0.5, 30.0,
                        "reverse");
    compare_with_pieces({.w2 = 4, .a = 0.75, .b = 1, .hold = 0.25L * gravity, .slide = 0.125L * gravity}, 0.25, 30.0,
                        "slip");
}

TEST(Drive, a_belt_that_jumps_to_another_speed_leaves_a_bead_behind_until_friction_has_brought_it_there) {
    // the belt runs with 0, 1, 2 m/s, a second each
    const double rate = 0.25 * gravity;
    const Bead bead(down, along_x, Coulomb{0.5, 0.25}, {.parameter = 0.0},
                    TimeFunction([](const auto& t) { return floor(t); }));
    for (const std::string& engine : simulating::engines()) {
        const Trajectory run = simulate(bead.scene, {.until = 2.9, .engine = engine});
        ASSERT_EQ(kinds(run), "slip switch stick slip switch stick") << engine;
        for (const double jump : {1.0, 2.0}) {
            const std::size_t k = jump == 1.0 ? 0 : 3;
            EXPECT_NEAR(run.events()[k].time, jump, 2.0 * epsilon) << engine;
            EXPECT_EQ(run.events()[k].direction, Direction::falling);
            EXPECT_NEAR(run.events()[k + 2].time, jump + 1.0 / rate, 1e-9) << engine;
            // friction pulls from the jump on, and the speed has none
            EXPECT_NEAR(run[bead.handle].speed(jump, Side::before), jump - 1.0, 1e-9) << engine;
            EXPECT_NEAR(run[bead.handle].speed(jump), jump - 1.0, 1e-9) << engine;
            EXPECT_NEAR(run[bead.handle].acceleration(jump)[0], rate, 1e-12) << engine;
            EXPECT_NEAR(run[bead.handle].speed(jump + 0.25), jump - 1.0 + 0.25 * rate, 1e-9) << engine;
        }
        EXPECT_NEAR(run[bead.handle].position(2.9)[0], 0.9 * 2.0 + 1.0 - 2.0 * 0.5 / rate, 1e-9) << engine;
    }
}

TEST(Drive, a_belt_that_turns_round_at_once_drags_a_sliding_bead_the_other_way) {
    const double rate = 0.25 * gravity, turn = 0.125;
    const auto by_case = [=](const auto& t) { return where(t > turn, 0.0 * t - 1.0, 0.0 * t + 1.0); };
    const auto by_sign = [=](const auto& t) { return -locked_sign(t - turn, "turn"); };
    for (const TimeFunction& drive : {TimeFunction(by_case), TimeFunction(by_sign)}) {
        const Bead bead(down, along_x, Coulomb{0.5, 0.25}, {.parameter = 0.0}, drive);
        const Trajectory run = simulate(bead.scene, {.until = 2.0, .error = 1e-12});
        ASSERT_EQ(kinds(run), "reverse switch stick");
        EXPECT_EQ(run.events()[0].direction, Direction::rising);
        const double speed = rate * turn, stick = turn + (speed + 1.0) / rate;
        EXPECT_NEAR(run.events()[0].time, turn, epsilon);
        EXPECT_NEAR(run.events()[2].time, stick, 1e-12);
        // a state on an edge is looked at from within, some hundred roundings of the time away
        EXPECT_NEAR(run[bead.handle].speed(turn), speed, 1e-13);
        EXPECT_NEAR(run[bead.handle].speed(1.9), -1.0, 1e-14);
        const double there = 0.5 * speed * turn + (speed * speed - 1.0) / (2.0 * rate) - (2.0 - stick);
        EXPECT_NEAR(run[bead.handle].position(2.0)[0], there, 1e-12);
    }
}

TEST(Drive, a_bead_that_nothing_presses_on_its_rail_feels_none_of_its_shaking) {
    // no gravity, no curvature: no reaction, so no friction; the slip is minus the speed of the rail, zero at k pi/4
    const Bead bead(none, along_x, Coulomb{0.5, 0.5}, {.parameter = 1.0},
                    TimeFunction([](const auto& t) { return sin(4.0 * t); }));
    const Trajectory run = simulate(bead.scene, {.until = 18.0, .error = 1e-12});
    ASSERT_EQ(run.events().size(), 22u);
    for (std::size_t k = 0; k < run.events().size(); ++k) {
        EXPECT_EQ(run.events()[k].kind, EventKind::reverse);
        EXPECT_NEAR(run.events()[k].time, static_cast<double>(k + 1) * pi / 4.0, 1e-12 * run.events()[k].time);
    }
    // at an event the slip is zero exactly, so that the bead takes the rounding of the rail's speed, which is near 1
    EXPECT_NEAR(run[bead.handle].parameter(18.0), 1.0, 18.0 * 1e-12);
    EXPECT_NEAR(run[bead.handle].speed(18.0), 0.0, 1e-12);
}

TEST(Drive, a_belt_carries_a_bead_round_a_bend_until_its_weight_breaks_it_away) {
    // held on a vertical circle at speed V: m g sin u = mu_s (m V^2/R + m g cos u), so
    // sin(u - a) = sin(a) V^2/(g R) with tan a = mu_s
    for (double R : {0.1875, 1.0, 6.0})
        for (double V : {0.125, 0.5, -1.0}) {
            const double mu = 0.75, angle = std::atan(mu);
            const double ratio = std::sin(angle) * V * V / (gravity * R);
            ASSERT_LT(ratio, 1.0);
            const double u = angle + std::asin(ratio), time = u * R / std::abs(V);
            const Bead bead(down, vertical_circle(R), Coulomb{mu, 0.5}, {.parameter = 0.0, .speed = V}, V);
            const Trajectory run = simulate(bead.scene, {.until = 10.0 * time, .error = 1e-10});
            ASSERT_FALSE(run.events().empty()) << R << ' ' << V;
            EXPECT_EQ(run.events()[0].kind, EventKind::slip);
            EXPECT_NEAR(run.events()[0].time, time, 1e-10 * time) << R << ' ' << V;
            // back toward the bottom: against V
            EXPECT_EQ(run.events()[0].direction, V > 0.0 ? Direction::falling : Direction::rising);
        }
}

// --- coasting: v = v0 exp(-mu alpha), alpha the angle the tangent has turned by ---

TEST(Coasting, round_a_rough_circle_loses_speed_with_the_angle_alone_and_never_stops) {
    const double mu = 0.25, R = 0.75, v0 = 3.0, u0 = 0.5;
    const Bead bead(none, vertical_circle(R), Coulomb{mu, mu}, {.parameter = u0, .speed = v0});
    const Trajectory run = simulate(bead.scene, {.until = 100.0, .error = 1e-12});
    EXPECT_TRUE(run.events().empty());
    const double extent = 2.0 * R * std::sqrt(2.0);
    for (double t = 0.0; t <= 100.0; t += 2.5) {
        const double alpha = std::log1p(mu * v0 * t / R) / mu;
        EXPECT_NEAR(run[bead.handle].parameter(t) - u0, alpha, 1e-12 * extent / R);
        EXPECT_NEAR(run[bead.handle].speed(t), v0 * std::exp(-mu * alpha), 1e-12 * v0);
    }
}

/// Integral by Gauss's rule of five points on many panels, in long double.
template <class F>
Real integral(F&& f, Real a, Real b, int panels = 400) {
    const Real x1 = std::sqrt(5 - 2 * std::sqrt(Real(10) / 7)) / 3, x2 = std::sqrt(5 + 2 * std::sqrt(Real(10) / 7)) / 3;
    const Real w0 = Real(128) / 225, w1 = (322 + 13 * std::sqrt(Real(70))) / 900,
               w2 = (322 - 13 * std::sqrt(Real(70))) / 900;
    Real sum = 0;
    const Real half = (b - a) / (2 * panels);
    for (int k = 0; k < panels; ++k) {
        const Real m = a + (2 * k + 1) * half;
        sum += half *
               (w0 * f(m) + w1 * (f(m - x1 * half) + f(m + x1 * half)) + w2 * (f(m - x2 * half) + f(m + x2 * half)));
    }
    return sum;
}

/// A curve (u, c u^4, u^3) with its inflection at u = 0; c = 0: in a plane.
struct Bend {
    Real c;
    Real speed(Real u) const { return std::sqrt(1 + 16 * c * c * u * u * u * u * u * u + 9 * u * u * u * u); }
    /// |r' x r''| / |r'|^2, what the tangent turns by a unit of u
    Real turning(Real u) const {
        const Real x = 1, y = 4 * c * u * u * u, z = 3 * u * u, y2 = 12 * c * u * u, z2 = 6 * u;
        const Real a = y * z2 - z * y2, b = -x * z2, d = x * y2;
        return std::sqrt(a * a + b * b + d * d) / (speed(u) * speed(u));
    }
    Real angle(Real from, Real to) const {
        const auto f = [&](Real u) { return turning(u); };
        // smooth on either side of the inflection alone
        if (from < 0 && to > 0) return integral(f, from, 0) + integral(f, 0, to);
        return integral(f, from, to);
    }
    Polynomial curve() const {
        return {.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, static_cast<double>(c), 0}}};
    }
};

void coast_through_an_inflection(Real c) {
    const Bend bend{c};
    const double mu = 0.3125, v0 = 2.0, u0 = -1.0;
    const Bead bead(none, bend.curve(), Coulomb{0.5, mu}, {.parameter = u0, .speed = v0});
    const Trajectory run = simulate(bead.scene, {.until = 2.0, .error = 1e-12});
    ASSERT_EQ(kinds(run), "normal-zero");
    EXPECT_NEAR(run[bead.handle].parameter(run.events()[0].time), 0.0, 1e-12);
    const auto speed_at = [&](Real u) { return v0 * std::exp(-mu * bend.angle(u0, u)); };
    for (double t : {0.25, 0.5, 1.0, 1.5, 2.0}) {
        const Real u = run[bead.handle].parameter(t);
        EXPECT_NEAR(run[bead.handle].speed(t), static_cast<double>(speed_at(u)), 1e-12 * v0) << t;
    }
    // and it is there in time: t = integral ds/v
    const Real end = run[bead.handle].parameter(2.0);
    ASSERT_GT(end, 0.5);
    const auto slowness = [&](Real u) { return bend.speed(u) / speed_at(u); };
    const Real time = integral(slowness, u0, 0, 60) + integral(slowness, 0, end, 60);
    EXPECT_NEAR(static_cast<double>(time), 2.0, 2e-12);
}

TEST(Coasting, through_an_inflection_in_a_plane_loses_speed_with_the_angle_alone) { coast_through_an_inflection(0); }
TEST(Coasting, through_an_inflection_in_space_loses_speed_with_the_angle_alone) { coast_through_an_inflection(1); }

TEST(Coasting, on_a_straight_rail_without_weight_never_slows) {
    const Bead bead(none, Line{.direction = {1, 2, 3}}, Coulomb{0.5, 0.5}, {.parameter = 0.0, .speed = 2.0});
    const Trajectory run = simulate(bead.scene, {.until = 1000.0});
    EXPECT_TRUE(run.events().empty());
    EXPECT_EQ(run[bead.handle].parameter(1000.0), 2000.0);
    EXPECT_EQ(run[bead.handle].speed(1000.0), 2.0);
}

TEST(Coasting, friction_never_makes_energy) {
    for (const Curve& curve : {Curve(vertical_circle(1.0)), Curve(Bend{1}.curve()),
                               Curve(Helix{.radius = 0.5, .pitch = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}})}) {
        Bead bead(down, curve, Coulomb{0.375, 0.125}, {.parameter = 0.75, .speed = 5.0});
        bead.scene.connect(Spring{.stiffness = 20.0, .rest_length = 0.5}, bead.handle, Vector3(0.25, 0.5, 0.75));
        const Trajectory run = simulate(bead.scene, {.until = 10.0, .error = 1e-13});
        ASSERT_GE(run.events().size(), 2u);
        double before = run.energy(0.0);
        for (double t : run.t()) {
            const double scale = run.kinetic_energy(t) + std::abs(run.potential(t));
            EXPECT_LE(run.energy(t), before + 1e-13 * scale + 1e-13) << t;
            EXPECT_NEAR(run.energy(t, Side::before), run.energy(t), 1e-12 * scale + 1e-13);
            before = run.energy(t);
        }
        EXPECT_LT(before, run.energy(0.0));
    }
}

// --- resistance ---

/// Thrown straight up with v0 under |v| v drag: height and speed in closed form; vt the terminal speed.
struct Throw {
    double v0, vt;
    double apex() const { return vt / gravity * std::atan(v0 / vt); }
    double top() const { return 0.5 * vt * vt / gravity * std::log1p(v0 * v0 / (vt * vt)); }
    double speed(double t) const {
        if (t < apex()) return vt * std::tan((apex() - t) * gravity / vt);
        return -vt * std::tanh((t - apex()) * gravity / vt);
    }
    double height(double t) const {
        const double angle = (t - apex()) * gravity / vt;
        return top() + vt * vt / gravity * (t < apex() ? std::log(std::cos(angle)) : -std::log(std::cosh(angle)));
    }
};

TEST(Resistance, a_bead_let_go_on_a_slope_under_quadratic_drag_falls_as_tanh) {
    const double slope = 0.75, c = 0.25, pull = gravity * 0.6;
    Bead bead(down, incline(slope), std::nullopt, {.parameter = 0.0});
    bead.scene.apply(Drag{.quadratic = c}, bead.handle);
    const Trajectory run = simulate(bead.scene, {.until = 5.0, .error = 1e-12});
    const double vt = std::sqrt(pull / c);
    for (double t : {1e-6, 0.01, 0.5, 1.0, 5.0}) {
        EXPECT_NEAR(run[bead.handle].speed(t), vt * std::tanh(pull * t / vt), 1e-12 * vt) << t;
        EXPECT_NEAR(run[bead.handle].parameter(t), vt * vt / pull * std::log(std::cosh(pull * t / vt)), 1e-11) << t;
    }
}

TEST(Resistance, a_bead_thrown_up_a_vertical_line_turns_where_the_arctangent_says) {
    const Throw thrown{.v0 = 6.0, .vt = std::sqrt(gravity / 0.5)};
    Bead bead(down, Line{.direction = {0, 0, 1}}, std::nullopt, {.parameter = 0.0, .speed = thrown.v0});
    bead.scene.apply(Drag{.quadratic = 0.5}, bead.handle);
    const Trajectory run = simulate(bead.scene, {.until = 3.0, .error = 1e-12});
    const double extent = thrown.top() - thrown.height(3.0);
    for (double t = 0.0; t <= 3.0; t += 0.125) {
        EXPECT_NEAR(run[bead.handle].parameter(t), thrown.height(t), 1e-12 * extent) << t;
        EXPECT_NEAR(run[bead.handle].speed(t), thrown.speed(t), 1e-12 * thrown.v0) << t;
    }
    const auto turns = run.events().times("switch");
    ASSERT_EQ(turns.size(), 1u);
    EXPECT_NEAR(turns[0], thrown.apex(), 1e-12 * turns[0]);
}

TEST(Resistance, a_free_particle_thrown_straight_up_turns_where_the_arctangent_says) {
    const Throw thrown{.v0 = 6.0, .vt = std::sqrt(gravity / 0.5)};
    Scene scene(down);
    const BodyHandle particle = scene.add(Particle{1.0}, FreeStart{.velocity = {0, 0, thrown.v0}});
    scene.apply(Drag{.quadratic = 0.5}, particle);
    const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-11});
    const double extent = thrown.top() - thrown.height(3.0);
    for (double t = 0.0; t <= 3.0; t += 0.125) {
        EXPECT_NEAR(run[particle].position(t).z(), thrown.height(t), 1e-11 * extent) << t;
        EXPECT_NEAR(run[particle].velocity(t).z(), thrown.speed(t), 1e-11 * thrown.v0) << t;
        EXPECT_EQ(run[particle].position(t).x(), 0.0);
    }
}

TEST(Resistance, a_free_particle_at_rest_in_quadratic_drag_falls_as_tanh) {
    Scene scene(down);
    const BodyHandle particle = scene.add(Particle{2.0});
    scene.apply(Drag{.quadratic = 0.5}, particle);
    const Trajectory run = simulate(scene, {.until = 4.0, .error = 1e-12});
    const double vt = std::sqrt(2.0 * gravity / 0.5);
    for (double t : {1e-6, 0.25, 1.0, 4.0})
        EXPECT_NEAR(run[particle].velocity(t).z(), -vt * std::tanh(gravity * t / vt), 1e-12 * vt) << t;
}

TEST(Resistance, a_spring_with_a_damper_pulls_a_bead_through_its_anchor_as_the_damped_oscillator) {
    const double k = 4.0, c = 0.5, rate = 0.5 * c, w = std::sqrt(k - rate * rate);
    Bead bead(none, along_x, std::nullopt, {.parameter = 1.0});
    bead.scene.connect(Spring{.stiffness = k, .damping = c}, bead.handle, Vector3(none));
    const Trajectory run = simulate(bead.scene, {.until = 10.0, .error = 1e-11});
    EXPECT_EQ(run.end(), 10.0);
    for (double t = 0.0; t <= run.end(); t += 0.5)
        EXPECT_NEAR(run[bead.handle].parameter(t), std::exp(-rate * t) * (std::cos(w * t) + rate / w * std::sin(w * t)),
                    1e-11);
}

TEST(Resistance, a_spring_with_a_damper_pulls_a_bead_through_its_anchor_on_a_bend) {
    // on r = (u, 0, u^2), anchored at u = 0: the rate of its length is finite there, (d.v)(d.r')/d^2 = w (1 + 2
    // u^2)^2/(1 + u^2)
    const double k = 4.0, c = 0.5;
    Bead bead(none, Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}}, std::nullopt, {.parameter = 1.0});
    bead.scene.connect(Spring{.stiffness = k, .damping = c}, bead.handle, Vector3(none));
    const Trajectory run = simulate(bead.scene, {.until = 5.0, .error = 1e-10});
    ASSERT_EQ(run.end(), 5.0);
    // the same by Runge and Kutta's steps in long double
    const auto rate = [&](Real u, Real w) {
        const Real bend = 1 + 2 * u * u, pull = k * (u + 2 * u * u * u) + c * w * bend * bend / (1 + u * u);
        return -(pull + 4 * u * w * w) / (1 + 4 * u * u);
    };
    Real u = 1, w = 0;
    const int steps = 20000;
    const Real h = Real(5) / steps;
    for (int i = 0; i < steps; ++i) {
        const Real a1 = rate(u, w), w2 = w + h / 2 * a1, a2 = rate(u + h / 2 * w, w2), w3 = w + h / 2 * a2,
                   a3 = rate(u + h / 2 * w2, w3), w4 = w + h * a3, a4 = rate(u + h * w3, w4);
        u += h / 6 * (w + 2 * w2 + 2 * w3 + w4);
        w += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    EXPECT_NEAR(run[bead.handle].parameter(5.0), static_cast<double>(u), 1e-9);
}

// --- several beads ---

TEST(SeveralBeads, a_stuck_bead_lets_go_when_the_spring_pulls_as_hard_as_static_friction_holds) {
    // one bead runs away on a smooth line, the other holds: x = v0/w sin(w t), until k x = mu_s m g
    Scene scene(down);
    const double k = 8.0, m = 2.0, mu = 0.25, v0 = 4.0, w = std::sqrt(k);
    const BodyHandle runner = scene.add(Particle{1.0}, Rail(along_x), {.parameter = 0.0, .speed = v0});
    const BodyHandle holder = scene.add(Particle{m}, Rail(along_x, Coulomb{mu, 0.125}), {.parameter = 0.0});
    scene.connect(Spring{.stiffness = k}, runner, holder);
    const Trajectory run = simulate(scene, {.until = 20.0, .error = 1e-11});
    ASSERT_FALSE(run.events().empty());
    const double expected = std::asin(mu * m * gravity / k * w / v0) / w;
    EXPECT_EQ(run.events()[0].kind, EventKind::slip);
    EXPECT_EQ(run.events()[0].subject, holder.index);
    EXPECT_EQ(run.events()[0].direction, Direction::rising);
    EXPECT_NEAR(run.events()[0].time, expected, 1e-11 * expected);
    EXPECT_EQ(run[holder].parameter(0.999 * expected), 0.0);
    EXPECT_GT(run[holder].parameter(1.1 * expected), 0.0);
    // friction takes what energy there is, but for the swing it cannot reach
    double before = run.energy(0.0);
    for (double t : run.t()) {
        EXPECT_LE(run.energy(t), before + 1e-10);
        before = run.energy(t);
    }
    EXPECT_LT(before, 0.5 * run.energy(0.0));
}

TEST(SeveralBeads, two_rough_beads_that_mirror_each_other_move_as_one_on_a_spring_twice_as_stiff) {
    const Coulomb friction{0.25, 0.125};
    const double k = 8.0;
    Scene pair(down);
    const Line left{.direction = {1, 0, 0}}, right{.direction = {-1, 0, 0}};
    const BodyHandle a = pair.add(Particle{1.0}, Rail(left, friction), {.parameter = 2.0});
    const BodyHandle b = pair.add(Particle{1.0}, Rail(right, friction), {.parameter = 2.0});
    pair.connect(Spring{.stiffness = k}, a, b);
    Bead alone(down, along_x, friction, {.parameter = 2.0});
    alone.scene.connect(Spring{.stiffness = 2.0 * k}, alone.handle, Vector3(none));
    const Trajectory both = simulate(pair, {.until = 10.0, .error = 1e-12}),
                     one = simulate(alone.scene, {.until = 10.0, .error = 1e-12});
    ASSERT_GE(one.events().size(), 3u);
    ASSERT_EQ(both.events().size(), 2 * one.events().size());
    for (std::size_t i = 0; i < one.events().size(); ++i)
        for (std::size_t j : {2 * i, 2 * i + 1}) {
            EXPECT_EQ(both.events()[j].kind, one.events()[i].kind);
            EXPECT_NEAR(both.events()[j].time, one.events()[i].time, 2e-12 * one.events()[i].time);
        }
    EXPECT_NEAR(both[a].parameter(10.0), one[alone.handle].parameter(10.0), 1e-11);
    EXPECT_NEAR(both[b].parameter(10.0), one[alone.handle].parameter(10.0), 1e-11);
}

TEST(SeveralBeads, two_identical_beads_that_know_nothing_of_each_other_do_all_at_once) {
    Scene scene(down);
    for (int i = 0; i < 2; ++i)
        scene.add(Particle{0.5}, Rail(vertical_circle(0.5), Coulomb{0.375, 0.125}), {.parameter = 0.0, .speed = 7.0});
    const Trajectory run = simulate(scene, {.until = 5.0, .error = 1e-12});
    // as g_circle_turns of the references, twice
    ASSERT_EQ(run.events().size(), 14u);
    for (std::size_t k = 0; k < run.events().size(); k += 2) {
        EXPECT_EQ(run.events()[k].time, run.events()[k + 1].time);
        EXPECT_EQ(run.events()[k].kind, run.events()[k + 1].kind);
        EXPECT_EQ(run.events()[k].subject, 0);
        EXPECT_EQ(run.events()[k + 1].subject, 1);
    }
    for (double t = 0.0; t <= 5.0; t += 0.125)
        EXPECT_EQ(run[BodyHandle{0}].position(t), run[BodyHandle{1}].position(t));
}

TEST(Friction, a_reaction_that_dies_away_is_no_event_when_only_its_rounding_is_left) {
    // a spring to the centre carries the bead at sqrt(k/m) R: friction brings it there, ever more slowly, and never
    // past
    Scene scene;
    const BodyHandle bead = scene.add(
        Particle{15.0}, Rail(Circle{.radius = 2.0, .start = {0, 0, -1}, .toward = {1, 0, 0}}, Coulomb{1.0, 0.625}),
        RailStart{.parameter = -0.375, .speed = 4.5});
    scene.connect(Spring{.stiffness = 35.0}, bead, Vector3(0, 0, 0));
    for (double error : {1e-6, 1e-9, 1e-12}) {
        const Trajectory run = simulate(scene, {.until = 12.0, .error = error});
        EXPECT_EQ(run.events().size(), 0u) << error;
        EXPECT_NEAR(run[bead].speed(12.0), 2.0 * std::sqrt(35.0 / 15.0), 4.5 * (error + 2e-9)) << error;
    }
    // much later the reaction is less than any accuracy: nothing is certain, and nothing hangs or is called
    // inconsistent
    for (double tolerance : {2e-8, 2e-11, 2e-14})
        EXPECT_EQ(simulate(scene, {.until = 40.0, .rtol = tolerance}).status(), Status::reached_end) << tolerance;
}

TEST(Springs, one_with_a_rest_length_pushes_the_other_way_beyond_its_anchor) {
    // x'' = -(x - 0.3 sign x) from x = 1: zero at acos(-3/7), and every twice that after
    Scene scene;
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(Line{.direction = {1, 2, -2}}), RailStart{.parameter = 1.0});
    scene.connect(Spring{.stiffness = 1.0, .rest_length = 0.3}, bead, Vector3(0, 0, 0));
    const Trajectory run = simulate(scene, {.until = 30.0, .error = 1e-12});
    const std::vector<double> passages = run.events().times("switch", bead);
    const double first = std::acos(-3.0 / 7.0);
    ASSERT_GE(passages.size(), 7u);
    for (std::size_t k = 0; k < passages.size(); ++k)
        EXPECT_NEAR(passages[k], (2.0 * static_cast<double>(k) + 1.0) * first, 2e-12 * passages[k]);
    EXPECT_LE(run.drift().at("energy"), 2e-12);
}

TEST(Springs, one_with_a_rest_length_keeps_its_energy_through_an_anchor_on_a_bend) {
    Scene scene({0.0, 0.0, -1.0});
    const BodyHandle bead =
        scene.add(Particle{0.5}, Rail(Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0.5, 0.5}}}),
                  RailStart{.parameter = 0.75});
    scene.connect(Spring{.stiffness = 3.0, .rest_length = 0.25}, bead, Vector3(0, 0, 0));
    const Trajectory run = simulate(scene, {.until = 20.0, .error = 1e-10});
    EXPECT_EQ(run.status(), Status::reached_end);
    EXPECT_GE(run.events().times("switch").size(), 6u);
    // near the anchor the direction of the spring is known to the rounding of the position over the distance only
    EXPECT_LE(run.drift().at("energy"), 1e-9);
    // wherever the steps end beside it: a few of these begin so near that its direction has no series
    for (double rtol = 1e-10; rtol > 1e-15; rtol *= 0.5)
        EXPECT_LE(simulate(scene, {.until = 20.0, .rtol = rtol}).drift().at("energy"), 100.0 * rtol + 1e-13) << rtol;
}

TEST(LongRuns, a_thousand_periods_kept_by_their_end_alone_are_estimated_honestly) {
    Scene scene({0.0, 0.0, -9.81});
    const BodyHandle bead =
        scene.add(Particle{1.0}, Rail(Circle{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}}),
                  RailStart{.parameter = std::numbers::pi / 2});
    // the period from the horizontal (complete elliptic integral), to more digits than a double holds
    const double until = 1000.0 * 2.3678419475762374493;
    const Trajectory run = simulate(scene, {.until = until, .error = 1e-10, .keep = {Keep::What::end}});
    const double error = std::abs(run[bead].speed(until)) / std::sqrt(2.0 * 9.81);
    EXPECT_LE(error, 1e-10);
    EXPECT_LE(error, 10.0 * *run.error());
    EXPECT_LE(*run.error(), 1e-10);
}

TEST(Resistance, a_bead_at_rest_on_a_running_rail_starts_under_drag_without_an_event) {
    // the sign of its speed to come depends on the side of its normal reaction
    Scene scene;
    const BodyHandle bead =
        scene.add(Particle{1.0}, Rail(Line{.direction = {1, 0, 0}}, Coulomb{0.75}, RailOptions{.drive = 0.125}),
                  RailStart{.parameter = 0.375});
    scene.connect(Spring{.stiffness = 0.75, .rest_length = 0.625}, bead, Vector3(-0.25, 1.375, 0.5));
    scene.apply(Drag{.quadratic = 1.0}, bead);
    const Trajectory run = simulate(scene, {.until = 0.5, .error = 1e-9});
    EXPECT_TRUE(run.events().empty());
    EXPECT_GT(run[bead].speed(0.25), 0.0);
}

}  // namespace
}  // namespace rbdyn::test::test_friction
