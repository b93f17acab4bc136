// One driver runs every hybrid model, a user's own included: balls, watched functions and fields written by hand.
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/expression/elementary.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace rbdyn::test_driver {
namespace {

constexpr double g = 9.81;

/// Equations of a model written by hand: derivatives, then the values of its guards.
Equations equations(int variables, const std::function<std::vector<Expression>(Recorder&)>& write,
                    std::vector<Guard> guards) {
    Recorder recorder;
    const std::vector<Expression> outputs = write(recorder);
    Equations result;
    result.program = Program(recorder, outputs, variables);
    for (std::size_t k = 0; k < guards.size(); ++k) guards[k].output = variables + static_cast<int>(k);
    result.guards = std::move(guards);
    for (int i = 0; i < variables; ++i) result.groups.push_back({i, 1, i == 0});
    return result;
}

Mode mode_of(const Equations& e) {
    Mode mode;
    mode.equations = &e;
    mode.parameters.assign(static_cast<std::size_t>(e.program.parameters()), 0.0);
    return mode;
}

/// A ball over a plane at height zero; x = (height, speed upward).
class BouncingBall : public HybridModel {
public:
    explicit BouncingBall(double restitution)
        : restitution_(restitution),
          flight_(equations(2,
                            [](Recorder& r) {
                                return std::vector<Expression>{r.input(1), r.constant(-g), r.input(0)};
                            },
                            {{.kind = EventKind::impact, .subject = 0, .name = "plane"}})) {}

    int variables() const override { return 2; }
    Mode begin(double, std::span<double>) const override { return mode_of(flight_); }
    Mode next(const Mode& mode, std::span<const int>, double, std::span<double> x,
              std::vector<Happening>& happenings) const override {
        x[0] = 0.0;
        x[1] = -restitution_ * x[1];
        happenings.push_back({EventKind::impact, 0, Direction::falling, "plane"});
        return mode;
    }

private:
    double restitution_;
    Equations flight_;
};

Record run(const HybridModel& model, std::vector<double> x, double until, double start = 0.0,
           std::int64_t max_steps = 1'000'000, Keep keep = {}, Monitor monitor = {}) {
    TaylorEngine engine(1e-16);
    Driver driver(model, engine, max_steps, std::move(keep), std::move(monitor));
    return driver.run(start, std::move(x), until);
}

/// Smooth motion with functions to watch.
class Watched : public HybridModel {
public:
    Watched(int variables, const std::function<std::vector<Expression>(Recorder&)>& write, std::vector<Guard> guards)
        : equations_(equations(variables, write, std::move(guards))) {}

    int variables() const override { return equations_.variables(); }
    Mode begin(double, std::span<double>) const override { return mode_of(equations_); }
    Mode next(const Mode& mode, std::span<const int>, double, std::span<double>,
              std::vector<Happening>&) const override {
        return mode;
    }

private:
    Equations equations_;
};

Guard watch(std::string name, Direction direction = Direction::either) {
    return {.role = GuardRole::record, .direction = direction, .name = std::move(name)};
}

// --- the ball ---

TEST(BouncingBall, meets_the_plane_when_the_closed_form_says) {
    const double h = 10.0, e = 0.9;
    const Record record = run(BouncingBall(e), {h, 0.0}, 20.0);
    EXPECT_EQ(record.status, Status::reached_end);
    double time = std::sqrt(2.0 * h / g), speed = std::sqrt(2.0 * g * h);
    std::size_t count = 0;
    for (; time < 20.0; ++count) {
        ASSERT_LT(count, record.events.size());
        EXPECT_EQ(record.events[count].kind, EventKind::impact);
        EXPECT_NEAR(record.events[count].time, time, 1e-14 * static_cast<double>(count + 1) * time);
        speed *= e;
        time += 2.0 * speed / g;
    }
    EXPECT_EQ(record.events.size(), count);
}

TEST(BouncingBall, started_exactly_on_the_plane_bounces_next_when_it_comes_back) {
    for (double speed : {1e-6, 0.3, 5.0, 1234.5}) {
        const Record record = run(BouncingBall(0.5), {0.0, speed}, 2.5 * speed / g);
        ASSERT_EQ(record.events.size(), 1u) << speed;
        EXPECT_NEAR(record.events[0].time, 2.0 * speed / g, 1e-14 * speed);
    }
}

TEST(BouncingBall, taken_up_again_at_each_bounce_loses_none_and_repeats_none) {
    const Record whole = run(BouncingBall(0.9), {10.0, 0.0}, 20.0);
    ASSERT_GE(whole.events.size(), 8u);
    double speed = std::sqrt(2.0 * g * 10.0);
    for (std::size_t k = 0; k < whole.events.size(); ++k) {
        speed *= 0.9;
        const Record rest = run(BouncingBall(0.9), {0.0, speed}, 20.0, whole.events[k].time);
        ASSERT_EQ(rest.events.size(), whole.events.size() - k - 1) << "taken up at bounce " << k;
        for (std::size_t j = 0; j < rest.events.size(); ++j)
            EXPECT_NEAR(rest.events[j].time, whole.events[k + 1 + j].time, 1e-12);
    }
}

TEST(BouncingBall, that_lies_still_without_a_mode_for_it_is_called_inconsistent_and_does_not_hang) {
    const Record record = run(BouncingBall(0.5), {0.0, 0.0}, 1.0);
    EXPECT_EQ(record.status, Status::inconsistent);
    EXPECT_EQ(record.end.hi, 0.0);
    EXPECT_LE(record.events.size(), 1000u);
}

TEST(BouncingBall, whose_bounces_accumulate_ends_at_their_limit_and_does_not_hang) {
    const Record record = run(BouncingBall(0.9), {10.0, 0.0}, 30.0);
    EXPECT_NE(record.status, Status::step_limit);
    EXPECT_LE(record.events.size(), 2000u);
    // sqrt(2 h/g) (1 + e)/(1 - e)
    const double reached = record.events.back().time;
    EXPECT_NEAR(reached, 27.129019335612225, 1e-9);
    EXPECT_LE(reached, record.end.hi);
}

// --- watched functions ---

TEST(Watching, a_graze_is_two_events_below_the_threshold_and_none_above) {
    // x = (1 - t)^2, watched at x - threshold, in steps that know nothing of it
    for (double gap : {1e-4, 1e-8, 1e-12}) {
        for (double threshold : {gap, -gap}) {
            const Watched model(2,
                                [&](Recorder& r) {
                                    return std::vector<Expression>{r.input(1), r.constant(2.0), r.input(0) - threshold};
                                },
                                {watch("graze")});
            const Record record = run(model, {1.0, -2.0}, 2.0);
            if (threshold < 0.0) {
                EXPECT_TRUE(record.events.empty()) << threshold;
                continue;
            }
            ASSERT_EQ(record.events.size(), 2u) << threshold;
            // near a graze a value known to epsilon gives a time known to epsilon over the slope
            const double apart = std::sqrt(gap), tolerance = 4e-16 / apart;
            EXPECT_NEAR(record.events[0].time, 1.0 - apart, tolerance);
            EXPECT_NEAR(record.events[1].time, 1.0 + apart, tolerance);
            EXPECT_EQ(record.events[0].direction, Direction::falling);
            EXPECT_EQ(record.events[1].direction, Direction::rising);
        }
    }
}

TEST(Watching, several_crossings_in_one_step_come_in_order_and_only_in_the_direction_asked_for) {
    // x = -(t - 1)(t - 3)(t - 4): one step of a polynomial
    const auto write = [](Recorder& r) {
        const Expression t = r.time();
        const Expression rate = -((t - 3.0) * (t - 4.0) + (t - 1.0) * (t - 4.0) + (t - 1.0) * (t - 3.0));
        return std::vector<Expression>{rate, r.input(0), r.input(0), r.input(0)};
    };
    const Watched model(1, write, {watch("any"), watch("up", Direction::rising), watch("down", Direction::falling)});
    const Record record = run(model, {12.0}, 5.0);
    std::vector<double> any, up, down;
    double before = 0.0;
    for (const Event& e : record.events) {
        EXPECT_GE(e.time, before);
        before = e.time;
        (e.name == "any" ? any : e.name == "up" ? up : down).push_back(e.time);
    }
    const auto expect_near = [](const std::vector<double>& found, const std::vector<double>& expected) {
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-13);
    };
    expect_near(any, {1.0, 3.0, 4.0});
    expect_near(up, {3.0});
    expect_near(down, {1.0, 4.0});
}

TEST(Watching, a_value_that_starts_at_zero_fires_when_it_comes_back_and_not_before) {
    // x = t^m (1 - t) leaves zero with multiplicity m
    for (int m : {1, 2, 3, 4}) {
        const auto write = [m](Recorder& r) {
            const Expression t = r.time();
            return std::vector<Expression>{m * pow(t, m - 1) - (m + 1) * pow(t, m), r.input(0)};
        };
        for (bool changes_mode : {false, true}) {
            Guard guard = watch("back");
            if (changes_mode) guard.role = GuardRole::stop;
            const Record record = run(Watched(1, write, {guard}), {0.0}, 1.5);
            ASSERT_EQ(record.events.size(), 1u) << m;
            EXPECT_NEAR(record.events[0].time, 1.0, 1e-13) << m;
            EXPECT_EQ(record.status, changes_mode ? Status::stopped_by_event : Status::reached_end);
        }
    }
}

TEST(Watching, a_value_that_stays_at_zero_never_fires) {
    const Watched model(2,
                        [](Recorder& r) {
                            return std::vector<Expression>{r.input(1), -1.0 * r.input(0), r.input(0)};
                        },
                        {watch("still")});
    EXPECT_TRUE(run(model, {0.0, 0.0}, 10.0).events.empty());
}

TEST(Watching, times_of_events_close_together_keep_their_order_after_a_long_run) {
    // a clock started at t = 1e6 s, watched every 1e-8 s
    std::vector<Guard> guards;
    for (int k = 1; k <= 5; ++k) guards.push_back(watch("tick " + std::to_string(k)));
    const auto write = [](Recorder& r) {
        std::vector<Expression> outputs{r.constant(1.0)};
        for (int k = 1; k <= 5; ++k) outputs.push_back(r.input(0) - 1e-8 * k);
        return outputs;
    };
    const Record record = run(Watched(1, write, guards), {0.0}, 1e6 + 1e-6, 1e6);
    ASSERT_EQ(record.events.size(), 5u);
    for (int k = 1; k <= 5; ++k) {
        const Event& e = record.events[static_cast<std::size_t>(k - 1)];
        EXPECT_EQ(e.name, "tick " + std::to_string(k));
        // the instant holds what a double of seconds cannot
        const double after = e.instant - Instant{1e6, 0.0};
        EXPECT_NEAR(after, 1e-8 * k, 1e-8 * 1e-12);
    }
}

TEST(Watching, an_event_is_in_the_half_open_interval_after_the_start_up_to_the_end) {
    // x = t - 1
    const auto write = [](Recorder& r) { return std::vector<Expression>{r.constant(1.0), r.input(0)}; };
    const Watched clock(1, write, {watch("one")});
    EXPECT_EQ(run(clock, {-1.0}, 1.0).events.size(), 1u);
    EXPECT_EQ(run(clock, {-1.0}, 1.0 - 1e-9).events.size(), 0u);
    EXPECT_EQ(run(clock, {0.0}, 2.0, 1.0).events.size(), 0u);
    EXPECT_EQ(run(clock, {-1.0}, 2.0).events.size(), 1u);
}

TEST(Watching, a_ball_falls_on_the_floor_whenever_the_run_would_have_ended) {
    // one step of a polynomial, as long as the run: 1 m high, then 1e-9 m
    const auto write = [](Recorder& r) { return std::vector<Expression>{r.input(1), r.constant(-g), r.input(0)}; };
    for (const double height : {1.0, 1e-9, 1e-20}) {
        const double time = std::sqrt(2.0 * height / g);
        for (double until = 2.0 * time; until < 1e10; until *= 10.0)
            for (const GuardRole role : {GuardRole::record, GuardRole::stop, GuardRole::mode}) {
                Guard guard{.role = role, .direction = Direction::falling, .name = "floor"};
                const Record record = run(Watched(2, write, {guard}), {height, 0.0}, until, 0.0, 3);
                if (role == GuardRole::mode) {
                    ASSERT_GE(record.entries().size(), 1u);
                    EXPECT_NEAR(record.piece(0).at(record.entries()[0].length).hi, time, 4e-16 * time) << until;
                    continue;
                }
                ASSERT_EQ(record.events.size(), 1u) << height << ' ' << until;
                EXPECT_NEAR(record.events[0].time, time, 4e-16 * time) << until;
            }
    }
}

TEST(Watching, a_value_that_starts_a_few_units_from_zero_passes_it) {
    // x = 1 + n ulp falls through 1; below the rounding of x - 1 nothing is promised
    const auto write = [](Recorder& r) { return std::vector<Expression>{r.constant(-1.0), r.input(0) - 1.0}; };
    for (const double n : {16.0, 100.0, 450.0, 1e4})
        for (const double until : {1.0, 1e-11, 1e9}) {
            const double off = n * 0x1p-52;
            const Record record = run(Watched(1, write, {watch("one")}), {1.0 + off}, until);
            ASSERT_EQ(record.events.size(), 1u) << n << ' ' << until;
            EXPECT_NEAR(record.events[0].time, off, 1e-15 * off);
            EXPECT_EQ(record.events[0].direction, Direction::falling);
        }
}

TEST(Watching, roots_of_high_odd_multiplicity_are_one_event_and_of_even_none) {
    // x = t, watched at (x - a)^m
    for (const int m : {3, 5, 7, 9, 11, 13, 15, 2, 4, 8, 14})
        for (const double a : {1.0, 0.7, 1e-6, 12.0})
            for (const double until : {2.0 * a, 1.1 * a, 1e3 * a}) {
                const auto write = [&](Recorder& r) {
                    return std::vector<Expression>{r.constant(1.0), pow(r.input(0) - a, m)};
                };
                const Record record = run(Watched(1, write, {watch("power")}), {0.0}, until);
                ASSERT_EQ(record.events.size(), m % 2 == 0 ? 0u : 1u) << m << ' ' << a << ' ' << until;
                // its own rounding hides it in an interval that is wide where the power is high
                if (m % 2 == 0) continue;
                EXPECT_NEAR(record.events[0].time, a, 1e-9 * a) << m << ' ' << a << ' ' << until;
            }
}

TEST(Watching, a_root_at_the_very_end_counts_whatever_comes_before_it) {
    // x = t, watched at (x - 0.3)(x - 0.6)(x - u) up to u
    for (const double u : {0.7, 0.9, 1.0, 1.3, 2.9}) {
        const auto write = [&](Recorder& r) {
            const Expression x = r.input(0);
            return std::vector<Expression>{r.constant(1.0), (x - 0.3) * (x - 0.6) * (x - u), x - u,
                                           (x - 0.3) * (x - u) * (x - u)};
        };
        const Watched model(1, write, {watch("three"), watch("one"), watch("touches at the end")});
        const Record record = run(model, {0.0}, u);
        std::vector<std::string> names;
        for (const Event& e : record.events) names.push_back(e.name);
        EXPECT_EQ(names, (std::vector<std::string>{"three", "touches at the end", "three", "one", "three"})) << u;
        // what two roots nearby leave of its digits
        EXPECT_NEAR(record.events.back().time, u, 1e-14 * u);
    }
}

TEST(Watching, events_of_one_instant_have_one_time_and_an_order_of_their_own) {
    const auto write = [](Recorder& r) {
        const Expression x = r.input(0);
        return std::vector<Expression>{r.constant(1.0), x - 0.7, 3.0 * x - 2.1, 0.1 * (0.7 - x)};
    };
    const auto names_of = [&](const std::vector<std::string>& names) {
        std::vector<Guard> guards;
        for (const std::string& name : names) guards.push_back(watch(name));
        std::vector<std::string> result;
        const Record record = run(Watched(1, write, guards), {0.0}, 1.0);
        for (const Event& e : record.events) {
            result.push_back(e.name);
            EXPECT_EQ(e.time, record.events.front().time);
        }
        return result;
    };
    const std::vector<std::string> expected{"a", "b", "c"};
    EXPECT_EQ(names_of({"a", "b", "c"}), expected);
    EXPECT_EQ(names_of({"c", "b", "a"}), expected);
    EXPECT_EQ(names_of({"b", "c", "a"}), expected);
}

TEST(Modes, keep_the_digits_of_the_state_beyond_doubles_where_an_event_does_not_set_it) {
    // a motion at 0.1 m/s under a clock that ends its mode 10,000 times
    class Clock : public HybridModel {
    public:
        int variables() const override { return 2; }
        Mode begin(double, std::span<double>) const override { return mode_of(down_); }
        Mode next(const Mode& mode, std::span<const int>, double, std::span<double> x,
                  std::vector<Happening>&) const override {
            const bool fell = mode.equations == &down_;
            x[1] = fell ? 0.0 : 0.1;
            return mode_of(fell ? up_ : down_);
        }

    private:
        static Equations moving(double rate) {
            return equations(
                2,
                [&](Recorder& r) {
                    const Expression x = r.input(1);
                    return std::vector<Expression>{r.constant(0.1), r.constant(rate), rate < 0.0 ? x : 0.1 - x};
                },
                {Guard{}});
        }
        Equations down_ = moving(-1.0), up_ = moving(1.0);
    };
    const Record record = run(Clock(), {0.0, 0.1}, 1000.0);
    std::vector<double> x(2);
    record.last_state(x);
    EXPECT_GT(record.modes.size(), 9990u);
    EXPECT_NEAR(x[0], 100.0, 3e-14);  // two units in the last place
}

// --- ends of runs ---

/// Two fields that point at each other, x' = -1 above zero and +1 below, without a sliding mode.
class Chatter : public HybridModel {
public:
    Chatter()
        : above_(equations(1,
                           [](Recorder& r) {
                               return std::vector<Expression>{r.constant(-1.0), r.input(0)};
                           },
                           {Guard{}})),
          below_(equations(1,
                           [](Recorder& r) {
                               return std::vector<Expression>{r.constant(1.0), -r.input(0)};
                           },
                           {Guard{}})) {}
    int variables() const override { return 1; }
    Mode begin(double, std::span<double> x) const override { return mode_of(x[0] >= 0.0 ? above_ : below_); }
    Mode next(const Mode& mode, std::span<const int>, double, std::span<double> x,
              std::vector<Happening>& happenings) const override {
        x[0] = 0.0;
        happenings.push_back({EventKind::switching, 0, Direction::falling, {}});
        return mode_of(mode.equations == &above_ ? below_ : above_);
    }

private:
    Equations above_, below_;
};

TEST(Endings, chatter_is_called_inconsistent_where_it_begins_and_does_not_hang) {
    const Record record = run(Chatter(), {1.0}, 5.0);
    EXPECT_EQ(record.status, Status::inconsistent);
    EXPECT_NEAR(record.end.hi, 1.0, 1e-12);
    EXPECT_LE(record.events.size(), 1000u);
}

TEST(Endings, guards_that_stop_end_the_run_at_the_first_of_them) {
    const auto write = [](Recorder& r) {
        return std::vector<Expression>{r.input(1), -1.0 * r.input(0), 0.5 - r.input(0), 0.25 - r.input(0)};
    };
    Guard far{.role = GuardRole::stop, .name = "far"}, near{.role = GuardRole::stop, .name = "near"};
    const Record record = run(Watched(2, write, {far, near}), {0.0, 1.0}, 5.0);
    EXPECT_EQ(record.status, Status::stopped_by_event);
    ASSERT_EQ(record.events.size(), 1u);
    EXPECT_EQ(record.events[0].name, "near");
    EXPECT_NEAR(record.end.hi, std::asin(0.25), 1e-15);
}

TEST(Endings, too_many_steps_and_a_user_s_wish_end_a_run_with_their_own_status) {
    const Watched swing(2, [](Recorder& r) { return std::vector<Expression>{r.input(1), -1.0 * sin(r.input(0))}; }, {});
    const Record limited = run(swing, {1.0, 0.0}, 1e6, 0.0, 10);
    EXPECT_EQ(limited.status, Status::step_limit);
    EXPECT_EQ(limited.work.steps, 10);
    EXPECT_GT(limited.end.hi, 0.0);
    const Record stopped = run(swing, {1.0, 0.0}, 1e6, 0.0, 1'000'000, {}, [](double t) { return t < 100.0; });
    EXPECT_EQ(stopped.status, Status::stopped_by_user);
    EXPECT_GE(stopped.end.hi, 100.0);
    EXPECT_LT(stopped.end.hi, 1000.0);
}

TEST(Endings, a_right_hand_side_that_is_not_finite_ends_the_run_where_it_is_so) {
    // x' = sqrt(1 - t), and one that is never finite
    const Watched late(1, [](Recorder& r) { return std::vector<Expression>{sqrt(1.0 - r.time())}; }, {});
    const Record record = run(late, {0.0}, 2.0);
    EXPECT_EQ(record.status, Status::not_finite);
    EXPECT_NEAR(record.end.hi, 1.0, 1e-6);
    const Watched never(1, [](Recorder& r) { return std::vector<Expression>{1.0 / r.input(0)}; }, {});
    const Record at_once = run(never, {0.0}, 2.0);
    EXPECT_EQ(at_once.status, Status::not_finite);
    EXPECT_EQ(at_once.end.hi, 0.0);
}

TEST(Endings, what_is_kept_is_what_was_asked_for) {
    const BouncingBall ball(0.9);
    const Record all = run(ball, {10.0, 0.0}, 15.0),
                 end = run(ball, {10.0, 0.0}, 15.0, 0.0, 1000, {Keep::What::end, {}}),
                 some = run(ball, {10.0, 0.0}, 15.0, 0.0, 1000, {Keep::What::times, {2.0, 9.0}});
    EXPECT_EQ(end.entries().size(), 1u);
    EXPECT_LT(some.entries().size(), all.entries().size());
    EXPECT_EQ(end.events.size(), all.events.size());
    const auto state = [](const Record& r, double t) {
        const Piece piece = r.piece(r.find(t, Side::after));
        std::vector<double> x(2);
        piece.state(Record::tau(piece, t), x);
        return x;
    };
    for (double t : {2.0, 9.0}) EXPECT_EQ(state(some, t), state(all, t));
    EXPECT_EQ(state(end, 15.0), state(all, 15.0));
}

// at a bounce both sides are wanted, and at the start the first piece
TEST(Endings, what_is_kept_holds_a_wanted_time_where_a_piece_begins) {
    const BouncingBall ball(0.9);
    const Record all = run(ball, {10.0, 0.0}, 15.0);
    const auto state = [](const Record& r, double t, Side side) {
        const Piece piece = r.piece(r.find(t, side));
        std::vector<double> x(2);
        piece.state(Record::tau(piece, t), x);
        return x;
    };
    std::vector<double> starts;
    for (const Record::Entry& e : all.entries())
        if (e.after_event) starts.push_back(e.start.hi);
    ASSERT_GE(starts.size(), 4u);
    for (std::size_t k = 0; k < starts.size(); ++k) {
        const double t = starts[k];
        const Record some = run(ball, {10.0, 0.0}, 15.0, 0.0, 1000, {Keep::What::times, {t}});
        Record later = all;
        later.keep_only({t});
        EXPECT_LE(some.entries().size(), 3u);
        EXPECT_LE(later.entries().size(), 3u);
        for (const Record* r : {&some, static_cast<const Record*>(&later)})
            for (const Side side : {Side::before, Side::after}) EXPECT_EQ(state(*r, t, side), state(all, t, side)) << t;
        if (k > 0) {
            EXPECT_GT(state(some, t, Side::after)[1], 0.0);
            EXPECT_LT(state(some, t, Side::before)[1], 0.0);
        }
    }
}

}  // namespace
}  // namespace rbdyn::test_driver
