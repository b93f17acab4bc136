// Models of the user's own: what is said of what they cannot go on from, runs that their limits stop, and times that
// are kept in any order.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <rbdyn/rbdyn.hpp>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace test_own_models {

using namespace rbdyn;

constexpr double for_ever = std::numeric_limits<double>::infinity();

struct Decay {
    int variables() const { return 2; }
    template <class S>
    void operator()(const S&, std::span<const S> x, std::span<S> rate) const {
        rate[0] = -x[0];
        rate[1] = x[1] * x[1];
    }
};

struct Stone {
    int variables() const { return 2; }
    int positions() const { return 1; }
    template <class S>
    void operator()(const S&, std::span<const S> x, std::span<S> rate) const {
        rate[0] = x[1];
        rate[1] = S(-9.81);
    }
    template <class S>
    std::vector<std::pair<std::string, S>> limits(const S&, std::span<const S> x) const {
        return {{"floor", x[0]}};
    }
};

/// The message of the error a run ends with.
template <class Run>
std::string message(const Run& run) {
    try {
        run();
    } catch (const Error& e) {
        return e.what();
    }
    return "none";
}

TEST(OwnModel, a_start_that_is_not_finite_is_refused_by_its_variable) {
    for (const double bad : {std::nan(""), for_ever})
        EXPECT_NE(message([&] {
                      simulate(Decay{}, {1.0, bad}, {.until = 1.0});
                  }).find("x[1] of the state is "),
                  std::string::npos);
}

TEST(OwnModel, what_grows_beyond_all_bounds_is_named) {
    // x[1] is 1/(1 - t)
    for (const SimulateOptions& options :
         {SimulateOptions{.until = 2.0}, SimulateOptions{.until = 2.0, .rtol = 1e-9}}) {
        const std::string said = message([&] { simulate(Decay{}, {1.0, 1.0}, options); });
        EXPECT_NE(said.find("the rate of x[1]"), std::string::npos) << said;
    }
}

TEST(OwnModel, its_limits_stop_a_run_without_an_end) {
    const StateRun run = simulate(Stone{}, {1.0, 2.0}, {.until = for_ever, .error = 1e-12});
    EXPECT_EQ(run.status(), Status::stopped_by_event);
    EXPECT_NEAR(run.end(), (2.0 + std::sqrt(4.0 + 2.0 * 9.81)) / 9.81, 1e-11);
    EXPECT_NE(message([] {
                  simulate(Decay{}, {1.0, -1.0}, {.until = for_ever});
              }).find("nothing can stop the run"),
              std::string::npos);
}

TEST(Run, says_rtol_only_where_that_was_asked_for) {
    const auto printed = [](const auto& run) {
        std::ostringstream out;
        out << run;
        return out.str();
    };
    const StateRun cut = simulate(Decay{}, {1.0, -1.0}, {.until = 100.0, .error = 1e-9, .max_steps = 3});
    EXPECT_EQ(cut.status(), Status::step_limit);
    EXPECT_NE(printed(cut).find("no estimate of the global error"), std::string::npos);
    EXPECT_EQ(printed(cut).find("rtol"), std::string::npos) << printed(cut);
    EXPECT_NE(printed(simulate(Decay{}, {1.0, -1.0}, {.until = 1.0, .rtol = 1e-9})).find("(rtol)"), std::string::npos);
}

TEST(Run, keeps_times_given_in_any_order) {
    Scene scene({0, 0, -9.81});
    const BodyHandle ball = scene.add(Particle{2.0}, {.position = {1, 0, 0}, .velocity = {0, 30, 0}});
    scene.apply(Drag{.quadratic = 0.5}, ball);
    const std::vector<double> times = {18.0, 2.0, 10.0};
    for (const std::optional<double> rtol : {std::optional<double>(), std::optional<double>(1e-10)}) {
        SimulateOptions options{.until = 20.0, .rtol = rtol};
        const Trajectory all = simulate(scene, options);
        options.keep = {.what = Keep::What::times, .times = times};
        const Trajectory kept = simulate(scene, options);
        EXPECT_LT(kept.t().size(), all.t().size());
        for (const double t : times) EXPECT_EQ(kept[ball].position(t), all[ball].position(t)) << t;
    }
}

// x = (1 - t/3)^3, a polynomial that a series would follow to any time, but x^(2/3) is none below zero
struct Falling {
    int variables() const { return 1; }
    template <class S>
    void operator()(const S&, std::span<const S> x, std::span<S> rate) const {
        rate[0] = -pow(x[0], 2.0 / 3.0);
    }
};

TEST(OwnModel, that_comes_to_a_root_at_its_zero_does_not_go_on_beyond_it) {
    for (const bool is_local : {true, false}) {
        SimulateOptions options{.until = 6.0, .engine = "taylor"};
        if (is_local)
            options.rtol = 1e-6;
        else
            options.error = 1e-6;
        double end = 6.0, last = 0.0;
        try {
            last = simulate(Falling{}, {1.0}, options).state(end)[0];
        } catch (const ModelError& e) {
            end = e.run.end();
            last = e.run.state(end)[0];
        }
        EXPECT_LE(std::abs(last), 1e-2) << end;
        EXPECT_GE(end, 2.4);
    }
}

}  // namespace test_own_models
