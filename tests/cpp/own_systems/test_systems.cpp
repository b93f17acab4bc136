// First-order equations of one's own from C++: functors recorded, watched and run, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <rbdyn/rbdyn.hpp>
#include <span>
#include <string>
#include <vector>

namespace test_systems {

using namespace rbdyn;

struct Oscillator {
    double square = 4.0;
    template <class S>
    void operator()(const S& /*t*/, std::span<const S> x, std::span<S> rate) const {
        rate[0] = x[1];
        rate[1] = -square * x[0];
    }
};

System oscillator() { return {Oscillator{}, {1.0, 0.0}, {"x", "v"}}; }

TEST(Systems, a_functor_moves_as_the_closed_form_says_on_every_engine) {
    for (const std::string engine : {"auto", "taylor", "dop853", "cvode-adams", "cvode-bdf"}) {
        const double error = engine.starts_with("cvode") ? 1e-8 : 1e-12;
        const SystemRun run = simulate(oscillator(), {.until = 3.0, .error = error, .engine = engine});
        EXPECT_LE(*run.error(), error);
        for (const double t : {0.7, 1.9, 3.0}) {
            EXPECT_NEAR(run.x(t)[0], std::cos(2.0 * t), 10.0 * error) << engine;
            EXPECT_NEAR(run.rate(t)[1], -4.0 * std::cos(2.0 * t), 80.0 * error) << engine;
        }
    }
}

TEST(Systems, watched_functions_note_stop_and_change) {
    System ball([](const auto&, auto x, auto rate) { rate[0] = x[1], rate[1] = -10.0; }, {1.0, 0.0});
    const auto bounce = [](double, std::span<const double> x) { return std::vector<double>{0.0, -0.5 * x[1]}; };
    ball.watch("floor", [](const auto&, auto x) { return x[0]; },
               {.direction = Direction::falling, .action = {WatchAction::Kind::change, bounce}});
    ball.watch("enough", [](const auto& t, auto) { return t - 1.1; }, {.action = {WatchAction::Kind::stop}});
    const SystemRun run = simulate(ball, {.until = 3.0, .error = 1e-12});
    const double fall = std::sqrt(0.2);
    ASSERT_EQ(run.events().size(), 3U);
    EXPECT_NEAR(run.events()[0].time, fall, 1e-12);
    EXPECT_NEAR(run.events()[1].time, 2.0 * fall, 2e-12);
    EXPECT_EQ(run.end(), 1.1);
    EXPECT_EQ(run.x(run.events()[0].time)[0], 0.0);
    EXPECT_NEAR(run.x(run.events()[0].time, Side::before)[1], -10.0 * fall, 1e-11);
}

TEST(Systems, events_are_handed_on_once_and_in_order_or_the_last_is_kept) {
    System system = oscillator();
    system.watch("x", [](const auto&, auto x) { return x[0]; });
    system.watch("v", [](const auto&, auto x) { return x[1]; });
    for (const bool is_alone : {false, true}) {
        SimulateOptions options{.until = 10.0};
        if (is_alone) options.rtol = 1e-9;
        const SystemRun whole = simulate(system, options);
        ASSERT_EQ(whole.events().size(), 12U);
        std::vector<double> times;
        options.events.each = [&](const Event& e) { times.push_back(e.time); };
        EXPECT_TRUE(simulate(system, options).events().empty());
        ASSERT_EQ(times.size(), 12U);
        for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], whole.events()[i].time);
        options.events = {.what = KeepEvents::What::last};
        const SystemRun last = simulate(system, options);
        ASSERT_EQ(last.events().size(), 2U);
        EXPECT_EQ(last.events()[1].time, times.back());
        EXPECT_EQ(last.events()[0].count + last.events()[1].count, 12);
        EXPECT_EQ(last.statistics().events, 12);
    }
}

TEST(Systems, runs_are_read_back_from_their_bytes) {
    const System system = oscillator();
    const SystemRun run = simulate(system, {.until = 3.0});
    const SystemRun again = system_run_from(system, bytes_of(run));
    EXPECT_EQ(again.x(1.3), run.x(1.3));
    EXPECT_EQ(again.rate(1.3), run.rate(1.3));
    EXPECT_THROW(system_run_from(System(Oscillator{9.0}, {1.0, 0.0}), bytes_of(run)), InvalidInput);
}

TEST(Systems, prices_tell_errors_as_large_as_they_are) {
    const Price price = cost(oscillator(), {.until = 3.0, .errors = {1e-4, 1e-8}, .budget = 3.0});
    EXPECT_EQ(price.automatic, "taylor");
    ASSERT_GE(price.rows.size(), 4u);
    for (const CostRow& row : price.rows) {
        const SystemRun run = simulate(oscillator(), {.until = 3.0, .rtol = row.tolerance, .engine = row.engine});
        const double apart =
            std::max(std::abs(run.x(3.0)[0] - std::cos(6.0)), std::abs(run.x(3.0)[1] + 2 * std::sin(6.0)) / 2);
        EXPECT_LE(apart, 3.0 * row.error + 1e-14) << row.engine << ' ' << row.tolerance;
    }
}

TEST(Systems, what_breaks_a_rule_is_refused_by_name) {
    EXPECT_THROW(System(Oscillator{}, {}), InvalidInput);
    EXPECT_THROW(System(Oscillator{}, {1.0, std::nan("")}), InvalidInput);
    EXPECT_THROW(System(Oscillator{}, {1.0, 0.0}, {"x"}), InvalidInput);
    EXPECT_THROW(oscillator().place("y"), InvalidInput);
    EXPECT_THROW(simulate(oscillator(), {.until = 1.0, .engine = "closed form"}), InvalidInput);
}

TEST(Systems, what_grows_without_bound_ends_as_an_error_with_its_run) {
    const System system([](const auto&, auto x, auto rate) { rate[0] = x[0] * x[0]; }, {1.0});
    try {
        (void)simulate(system, {.until = 2.0});
        FAIL() << "it has no end";
    } catch (const SystemError& e) {
        EXPECT_NEAR(e.run.end(), 1.0, 1e-9);
        EXPECT_NEAR(e.run.x(0.5)[0], 2.0, 1e-8);
    }
}

}  // namespace test_systems
