// Watched functions whose terms cancel: high powers and products with roots close together, far from where a step
// begins. Expanded there, they are rounding where they pass zero; their values are not. Every truth is a closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "rbdyn/integrate.hpp"
#include "support.hpp"

namespace rbdyn::test::test_cancelling_terms {
namespace {

struct Watched {
    std::string name;
    std::function<Expression(Expression)> function;  // of u = (x - c) / w
    std::vector<double> roots;                       // of it
    int degree;
};

std::vector<Watched> watched(std::mt19937_64& random) {
    std::uniform_real_distribution<double> in(-1.0, 1.0);
    std::vector<Watched> all;
    for (int n = 2; n <= 32; n += 2) {
        all.push_back({"power " + text(n), [=](const Expression& u) { return pow(u, n) - 1.0; }, {-1.0, 1.0}, n});
        all.push_back({"power " + text(n) + " and its square",
                       [=](const Expression& u) { return pow(u, n) * (1.0 + pow(u, n)) - 2.0; },
                       {-1.0, 1.0},
                       2 * n});
    }
    for (int count = 2; count <= 8; ++count) {
        std::vector<double> roots(static_cast<std::size_t>(count));
        const auto are_near = [&] {
            for (std::size_t k = 1; k < roots.size(); ++k)
                if (roots[k] - roots[k - 1] < 0.01) return true;
            return false;
        };
        do {
            for (double& root : roots) root = in(random);
            std::sort(roots.begin(), roots.end());
        } while (are_near());
        all.push_back({"product of " + text(count),
                       [=](const Expression& u) {
                           Expression product = 1.0;
                           for (const double root : roots) product = product * (u - root);
                           return product;
                       },
                       roots, count});
    }
    return all;
}

/// x = t, in one step if nothing shortens it; also where the run ends among the roots, or at one.
TEST(CancellingTerms, hide_no_root_of_a_watched_function) {
    std::mt19937_64 random(20261123);
    for (const double width : {0.1, 1e-2, 1e-3, 1e-5})
        for (const double place : {0.5, 0.3, 0.871})
            for (const Watched& w : watched(random))
                for (const int end : {0, 1, 2, 3}) {
                    std::vector<double> roots;
                    for (const double u : w.roots) roots.push_back(place + width * u);
                    const double until = end == 0   ? 1.0
                                         : end == 1 ? place
                                         : end == 2 ? 0.5 * (roots.back() + place)
                                                    : 1e3;
                    // not beyond the largest double
                    if (w.degree * std::log10(std::max(until - place, place) / width) > 290.0) continue;
                    std::erase_if(roots, [=](double x) { return x > until; });
                    for (const std::string engine : {"auto", "dop853"}) {
                        Scene scene;
                        const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1.0, 0, 0}});
                        scene.watch(
                            "w", [=](const Now& now) { return w.function((now[body].position()[0] - place) / width); });
                        SCOPED_TRACE(w.name + " at " + text(place) + ", width " + text(width) + ", until " +
                                     text(until) + ", " + engine);
                        const Attempt run = attempt(scene, {.until = until, .error = 1e-9, .engine = engine});
                        // what its steps cannot tell is refused
                        if (engine == "dop853" && run.outcome != simulating::Outcome::good) continue;
                        ASSERT_EQ(run.outcome, simulating::Outcome::good) << run.message;
                        const auto found = run.run.events().times("w");
                        ASSERT_EQ(found.size(), roots.size());
                        for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], roots[k], 1e-12);
                    }
                }
}

/// A root of an odd power is one event, however near to each other rounding puts the roots of its polynomial.
TEST(CancellingTerms, make_one_root_of_an_odd_power_no_more) {
    std::mt19937_64 random(20261124);
    const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    for (int i = 0; i < 6000; ++i) {
        const double x0 = (in(-1.0, 1.0) < 0.0 ? -1.0 : 1.0) * std::pow(10.0, in(-3.0, 3.0));
        const double v = -x0 * std::pow(10.0, in(-0.5, 2.0)), unit = std::pow(10.0, in(-3.0, 3.0));
        const double g = i % 3 == 0 ? in(-0.2, 0.2) * std::abs(v / x0 * v) : 0.0;
        const double start = i % 2 == 0 ? in(-10.0, 10.0) : 0.0, span = 3.0 * std::abs(x0 / v);
        const int n = 3 + 2 * (i % 4);
        // x0 + v s + g s^2 / 2
        std::vector<double> roots;
        if (g == 0.0) {
            roots = {-x0 / v};
        } else if (const double square = v * v - 2.0 * g * x0; square > 0.0) {
            const double q = -(v + std::copysign(std::sqrt(square), v));
            roots = {q / g, 2.0 * x0 / q};
            std::sort(roots.begin(), roots.end());
        }
        if (std::ranges::any_of(roots, [&](double s) { return std::abs(s - span) < 1e-6 * span; })) continue;
        std::erase_if(roots, [&](double s) { return s <= 0.0 || s > span; });
        Scene scene(Vector3{g, 0.0, 0.0});
        const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{x0, 0, 0}, {v, 0, 0}});
        scene.watch("w", [=](const Now& now) { return pow(now[body].position()[0] / unit, n); });
        SCOPED_TRACE("scene " + text(i) + ", power " + text(n));
        const Attempt run = attempt(scene, {.until = start + span, .start = start, .error = 1e-9});
        ASSERT_EQ(run.outcome, simulating::Outcome::good) << run.message;
        const auto& events = run.run.events();
        ASSERT_EQ(events.size(), roots.size());
        bool rises = v > 0.0;
        for (std::size_t k = 0; k < roots.size(); ++k, rises = !rises) {
            EXPECT_NEAR(events[k].time - start, roots[k], 1e-6 * span);
            EXPECT_EQ(events[k].direction, rises ? Direction::rising : Direction::falling);
        }
    }
}

/// What another function of the scene switches by, just before, has no part in it: |x - c| with x = c at the end of the
/// run, and |v - d| with v = d a ten-thousandth of a millionth of the run before.
TEST(CancellingTerms, leave_a_corner_to_its_own_function) {
    Scene scene;
    const BodyHandle body =
        scene.add(Particle{10.0}, FreeStart{{0.00010795866773708775, 0, 0}, {0.1293504803484055, 0, 0}});
    scene.connect(Spring{.stiffness = 115351.41682821824}, body, Vector3{0, 0, 0});
    scene.watch("speed", [=](const Now& now) { return abs(now[body].velocity()[0] - 0.12935023458763836); });
    scene.watch("place", [=](const Now& now) { return abs(now[body].position()[0] - 0.0001079841917174526); });
    const Attempt run =
        attempt(scene, {.until = -3.9464877969440303e-07, .start = -5.919731695416045e-07, .error = 1e-9});
    ASSERT_EQ(run.outcome, simulating::Outcome::good) << run.message;
    EXPECT_TRUE(run.run.events().times("speed").empty());
    EXPECT_TRUE(run.run.events().times("place").empty());
}

/// A square that touches zero sooner after the start than time can be told, beside a corner that the motion begins on.
TEST(CancellingTerms, are_no_event_of_what_turns_back_where_the_motion_begins) {
    Scene scene;
    const BodyHandle bead = scene.add(
        Particle{1.0}, Rail(Circle{.radius = 0.00046275614273367214, .start = {1, 0, 0}, .toward = {0, 1, 0}}),
        {.speed = 1.924283619769486e-09});
    scene.watch("corner", [=](const Now& now) { return abs(now[bead].parameter()); });
    scene.watch("square", [=](const Now& now) {
        const auto y = (now[bead].position()[1] - 3.0447063223693797e-22) * 2160.965371723926;
        return y * y;
    });
    const Attempt run = attempt(scene, {.until = 6004.379692408521, .start = 5826.595291886181, .error = 1e-9});
    ASSERT_EQ(run.outcome, simulating::Outcome::good) << run.message;
    EXPECT_TRUE(run.run.events().times("square").empty());
}

/// What happens exactly where a run ends is an event there if it is one of a longer run, and none if it is none.
TEST(CancellingTerms, say_the_same_of_a_run_that_ends_at_a_root) {
    struct Ended {
        std::string name;
        std::function<Expression(Expression)> function;  // of x = t
        std::vector<double> roots;
    };
    const std::vector<Ended> all = {
        {"sign", [](const Expression& x) { return where(x > 1.0, 1.0, where(x < 1.0, -1.0, 0.0)); }, {1.0}},
        {"jump", [](const Expression& x) { return where(x > 1.0, 1.0, -1.0); }, {1.0}},
        {"jump down", [](const Expression& x) { return where(x > 1.0, 1.0, -1.0) * (x - 3.0); }, {1.0}},
        {"odd", [](const Expression& x) { return (x - 1.0) * abs(x - 1.0); }, {1.0}},
        {"corner", [](const Expression& x) { return abs(x - 1.0); }, {}},
        {"cube", [](const Expression& x) { return pow(x - 1.0, 3); }, {1.0}},
        {"square", [](const Expression& x) { return pow(x - 1.0, 2); }, {}},
        {"a corner of another", [](const Expression& x) { return x - 1.0000001 + 0.0 * abs(x - 1.0); }, {1.0000001}},
        {"a touch, and a root soon after", [](const Expression& x) { return pow(x - 1.0, 4) * (x - 1.001); }, {1.001}},
        {"a touch, and a root at once", [](const Expression& x) { return pow(x - 1.0, 4) * (x - 1.00001); }, {1.00001}},
    };
    for (const Ended& w : all)
        for (const double until : {1.0, 2.0})
            for (const std::string engine : {"auto", "dop853", "cvode-adams"}) {
                Scene scene;
                const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1.0, 0, 0}});
                scene.watch("w", [=](const Now& now) { return w.function(now[body].position()[0]); });
                SCOPED_TRACE(w.name + ", until " + text(until) + ", " + engine);
                const Attempt run = attempt(scene, {.until = until, .error = 1e-9, .engine = engine});
                ASSERT_EQ(run.outcome, simulating::Outcome::good) << run.message;
                std::vector<double> roots = w.roots;
                std::erase_if(roots, [=](double x) { return x > until; });
                const auto found = run.run.events().times("w");
                ASSERT_EQ(found.size(), roots.size());
                for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], roots[k], 1e-9);
            }
}

}  // namespace
}  // namespace rbdyn::test::test_cancelling_terms
