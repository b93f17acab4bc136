// Runs without an end of their own: what stops them, what they need of memory, and how what takes long is interrupted.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <rbdyn/basics/interruption.hpp>
#include <rbdyn/basics/memory.hpp>
#include <rbdyn/rbdyn.hpp>
#include <rbdyn/trajectory/run_data.hpp>
#include <span>
#include <string>
#include <vector>

namespace test_runs {

using namespace rbdyn;

constexpr double for_ever = std::numeric_limits<double>::infinity();
const WatchOptions stops{.action = {WatchAction::Kind::stop}};

/// A stone that falls from a height, stopped on the ground.
Scene falling(double height) {
    Scene scene({0.0, 0.0, -9.81});
    const BodyHandle stone = scene.add(Particle{.mass = 1.0}, {.position = {0.0, 0.0, height}});
    scene.watch(
        "ground", [=](const Now& now) { return now[stone].position()[2]; }, stops);
    return scene;
}

/// A pendulum that hardly slows down, stopped at a time.
Scene swinging(double end) {
    Scene scene({0.0, 0.0, -9.81});
    const BodyHandle rod =
        scene.add(shapes::rod(1.0, 1.0, {0, 0, 1}), Revolute{.axis = {0, 1, 0}, .point = {0, 0, 0.5}}, {.angle = 1.0});
    scene.apply(Drag{.linear = 1e-12}, rod);
    scene.watch(
        "enough", [=](const Now& now) { return now.time() - end; }, stops);
    return scene;
}

TEST(Runs, without_an_end_end_where_they_are_stopped) {
    for (const double height : {1e-6, 3.0, 1e7}) {
        const double fall = std::sqrt(2.0 * height / 9.81);
        const Trajectory run = simulate(falling(height), {.until = for_ever});
        EXPECT_EQ(run.status(), Status::stopped_by_event);
        EXPECT_NEAR(run.end(), fall, 1e-9 * fall);
        EXPECT_DOUBLE_EQ(run.end(), simulate(falling(height), {.until = 3.0 * fall}).end());
    }
    System decay([](const auto&, auto x, auto rate) { rate[0] = -x[0]; }, {1.0});
    decay.watch("small", [](const auto&, auto x) { return x[0] - 1e-3; }, {.action = {WatchAction::Kind::stop}});
    EXPECT_NEAR(simulate(decay, {.until = for_ever}).end(), std::log(1000.0), 1e-8);
}

TEST(Runs, without_an_end_hand_on_their_events_once) {
    Scene scene = swinging(70.0);
    const BodyHandle rod{0};
    scene.watch("lowest", [=](const Now& now) { return now[rod].angle(); });
    std::vector<double> times;
    SimulateOptions options{.until = for_ever, .rtol = 1e-10};
    options.events.each = [&](const Event& e) { times.push_back(e.time); };
    const Trajectory run = simulate(scene, options);
    const Trajectory whole = simulate(scene, {.until = 100.0, .rtol = 1e-10});
    EXPECT_EQ(times.size(), whole.events().times("lowest").size() + 1);
    ASSERT_EQ(times.size(), whole.events().size());
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], whole.events()[i].time, 1e-7);
    EXPECT_EQ(run.end(), 70.0);
}

TEST(Runs, without_an_end_that_nothing_stops_are_refused) {
    Scene scene({0.0, 0.0, -9.81});
    scene.add(Particle{.mass = 1.0});
    EXPECT_THROW(simulate(scene, {.until = for_ever}), InvalidInput);
    scene.watch(
        "never", [](const Now& now) { return now.time() + 1.0; }, stops);
    EXPECT_THROW(simulate(scene, {.until = for_ever}), InvalidInput) << "a closed form passes all of time in a moment";
    System still([](const auto&, auto, auto rate) { rate[0] = 1.0; }, {0.0});
    EXPECT_THROW(simulate(still, {.until = for_ever}), InvalidInput);
    EXPECT_THROW(simulate(falling(1.0), {.until = -for_ever}), InvalidInput);
}

TEST(Runs, that_need_more_memory_than_there_is_say_so_once_with_figures) {
    if (!available_memory()) GTEST_SKIP() << "this system does not tell how much memory there is";
    for (const bool is_judged : {true, false}) {
        std::vector<std::string> said;
        SimulateOptions options{.until = 1e10, .max_steps = 1'000'000'000'000};
        if (!is_judged) options.rtol = 1e-12;
        options.warn = [&](const std::string& sentence) { said.push_back(sentence); };
        const Trajectory run = simulate(swinging(1000.0), options);
        EXPECT_EQ(run.end(), 1000.0);
        ASSERT_EQ(said.size(), 1U);
        // what is kept of each second, to the end
        const double kept = run.data()->record.bytes() / run.end() * options.until;
        const std::size_t at = said[0].find("would take ") + 11;
        const double told = std::stod(said[0].substr(at));
        EXPECT_NE(said[0].find("TB at t = 1e+10 s"), std::string::npos) << said[0];
        // from the hundredth part of the run, whose steps are not all alike
        EXPECT_NEAR(told, kept * 1e-12, 0.25 * told) << said[0];
        EXPECT_GT(told, 1.0);
    }
}

TEST(Runs, whose_motion_does_not_stay_need_no_warning) {
    const auto said = [](const Scene& scene, SimulateOptions options) {
        int count = 0;
        options.warn = [&](const std::string&) { ++count; };
        (void)simulate(scene, options);
        return count;
    };
    const Keep end{.what = Keep::What::end};
    EXPECT_EQ(said(swinging(1000.0), {.until = 1e10, .keep = end}), 0);
    EXPECT_EQ(said(swinging(1000.0), {.until = 1e10, .rtol = 1e-12, .keep = end}), 0);
    EXPECT_EQ(said(swinging(1000.0), {.until = 1001.0}), 0) << "a short run";
    // events are kept if nobody says otherwise
    Scene ticking = swinging(1000.0);
    ticking.watch("tick", [](const Now& now) { return sin(50.0 * now.time()); });
    SimulateOptions all{.until = 1e10, .rtol = 1e-12, .keep = end, .max_steps = 1'000'000'000'000};
    EXPECT_EQ(said(ticking, all), 1);
    all.events.what = KeepEvents::What::last;
    EXPECT_EQ(said(ticking, all), 0);
}

TEST(Runs, memory_is_told_in_words) {
    EXPECT_EQ(bytes_text(999.0), "999 B");
    EXPECT_EQ(bytes_text(1234.0), "1.2 kB");
    EXPECT_EQ(bytes_text(2.5e10), "25 GB");
    EXPECT_EQ(bytes_text(9.62e12), "9.6 TB");
    EXPECT_GT(available_memory().value_or(1e8), 1e7);
}

TEST(Runs, what_takes_long_is_interrupted) {
    using Clock = std::chrono::steady_clock;
    struct Enough {};
    Scene chain({0.0, 0.0, -9.81});
    BodyHandle last =
        chain.add(shapes::rod(1.0, 0.2, {0, 0, 1}), Revolute{.axis = {0, 1, 0}, .point = {0, 0, 0.1}}, {.angle = 0.1});
    for (int i = 1; i < 160; ++i)
        last = chain.add(shapes::rod(1.0, 0.2, {0, 0, 1}),
                         Revolute{.axis = {0, 1, 0}, .at = {0, 0, -0.1}, .point = {0, 0, 0.1}},
                         {.angle = 0.1, .parent = last});
    const auto began = Clock::now();
    const Interruption after_a_while([&] {
        if (Clock::now() - began > std::chrono::milliseconds(200)) throw Enough{};
    });
    EXPECT_THROW(equilibria(chain), Enough);
    EXPECT_LT(Clock::now() - began, std::chrono::seconds(1));
}

TEST(Runs, interruptions_are_of_their_scope) {
    int outer = 0, inner = 0;
    const auto work = [] {
        const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(120);
        while (std::chrono::steady_clock::now() < end) Interruption::point();
    };
    {
        const Interruption one([&] { ++outer; });
        {
            const Interruption other([&] { ++inner; });
            work();
        }
        EXPECT_GE(inner, 1);
        EXPECT_EQ(outer, 0);
        work();
    }
    const int seen = outer;
    EXPECT_GE(seen, 1);
    work();
    EXPECT_EQ(outer, seen);
}

}  // namespace test_runs
