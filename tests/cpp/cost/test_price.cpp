// Price lists: what is read from them, and what cost() puts into them.
#include "rbdyn/price.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/cost.hpp"
#include "rbdyn/pricing.hpp"
#include "rbdyn/simulate.hpp"

namespace rbdyn::test::test_price {
namespace {

CostRow row(const std::string& engine, double tolerance, double error, double seconds) {
    return {.engine = engine, .tolerance = tolerance, .motion_error = error, .seconds = seconds, .error = error};
}

/// Errors a hundred times and twice the tolerances; times as their powers -1/4 and -1/8.
Price powers() {
    Price price;
    for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) {
        price.rows.push_back(row("steep", tolerance, 100.0 * tolerance, 1e-3 * std::pow(tolerance, -0.25)));
        price.rows.push_back(row("flat", tolerance, 2.0 * tolerance, 1e-2 * std::pow(tolerance, -0.125)));
    }
    price.automatic = "flat";
    return price;
}

TEST(Prices, that_follow_powers_are_predicted_by_them) {
    const Price price = powers();
    for (const double error : {3e-2, 1e-4, 5e-6}) {
        const Prediction p = price.predict(error);
        const bool is_steep = 1e-3 * std::pow(error / 100.0, -0.25) < 1e-2 * std::pow(error / 2.0, -0.125);
        EXPECT_EQ(p.engine, is_steep ? "steep" : "flat") << error;
        EXPECT_NEAR(p.tolerance, error / (is_steep ? 100.0 : 2.0), 1e-12 * error) << error;
        EXPECT_NEAR(p.seconds, is_steep ? 1e-3 * std::pow(p.tolerance, -0.25) : 1e-2 * std::pow(p.tolerance, -0.125),
                    1e-12)
            << error;
        EXPECT_NE(p.basis.find("interpolated between the rows at tolerance"), std::string::npos) << p.basis;
    }
}

TEST(Prices, of_rows_are_their_own) {
    const Price price = powers();
    const Prediction p = price.predict(2e-9);
    EXPECT_EQ(p.engine, "flat");
    EXPECT_EQ(p.tolerance, 1e-9);
    EXPECT_EQ(p.seconds, 1e-2 * std::pow(1e-9, -0.125));
    EXPECT_EQ(p.basis, "measured at tolerance 1e-09");
    // looser than any
    EXPECT_EQ(price.predict(1.0).seconds, 1e-3 * std::pow(1e-3, -0.25));
}

TEST(Prices, are_not_extrapolated) {
    const Price price = powers();
    EXPECT_THROW((void)price.predict(1e-9), InvalidInput);
    EXPECT_THROW((void)price.cheapest(1e-9), InvalidInput);
    EXPECT_THROW((void)price.predict(0.0), InvalidInput);
    EXPECT_THROW((void)price.predict(std::nan("")), InvalidInput);
    EXPECT_THROW((void)Price{}.cheapest(1e-3), InvalidInput);
    EXPECT_THROW((void)Price{}.predict(1e-3), InvalidInput);
}

TEST(Prices, of_a_lucky_row_are_not_relied_on) {
    Price price;
    price.rows = {row("a", 1e-3, 1e-8, 1.0), row("a", 1e-5, 1e-6, 2.0), row("a", 1e-7, 1e-8, 3.0)};
    // the quickest row that reached it, and what is to be expected
    EXPECT_EQ(price.cheapest(1e-7).seconds, 1.0);
    const Prediction p = price.predict(1e-7);
    EXPECT_GT(p.seconds, 2.0);
    EXPECT_LT(p.seconds, 3.0);
}

TEST(Prices, of_what_a_row_alone_has_reached_are_its_own) {
    Price price;
    // beyond its floor an engine gets worse again
    price.rows = {row("a", 1e-3, 1e-6, 1.0), row("a", 1e-5, 1e-9, 2.0), row("a", 1e-7, 5e-9, 3.0)};
    const Prediction p = price.predict(2e-9);
    EXPECT_EQ(p.seconds, 2.0);
    EXPECT_EQ(p.tolerance, 1e-5);
    EXPECT_EQ(p.basis, "measured at tolerance 1e-05");
    EXPECT_THROW((void)price.predict(9e-10), InvalidInput);
}

TEST(Prices, of_what_misses_events_are_none) {
    Price price;
    price.rows = {row("a", 1e-3, 1e-9, 1.0), row("a", 1e-5, 1e-9, 2.0)};
    price.rows[0].has_all_events = false;
    EXPECT_EQ(price.cheapest(1e-6).seconds, 2.0);
    EXPECT_EQ(price.predict(1e-6).seconds, 2.0);
    ASSERT_EQ(price.front().size(), 1u);
    EXPECT_EQ(price.front()[0].seconds, 2.0);
}

TEST(Prices, on_the_front_are_beaten_by_none) {
    Price price;
    price.rows = {row("a", 1e-3, 1e-2, 1.0), row("a", 1e-5, 1e-4, 3.0), row("b", 1e-3, 1e-4, 2.0),
                  row("b", 1e-5, 1e-6, 9.0), row("c", 1e-3, 1e-2, 1.5)};
    std::vector<double> seconds;
    for (const CostRow& r : price.front()) seconds.push_back(r.seconds);
    EXPECT_EQ(seconds, (std::vector<double>{1.0, 2.0, 9.0}));
}

Scene orbit() {
    Scene scene;
    const BodyHandle planet = scene.add(Particle{1.0}, {.position = {1, 0, 0}, .velocity = {0, 1.1, 0}});
    scene.connect(Spring{.stiffness = 3.0, .rest_length = 0.5}, planet, Vector3(0, 0, 0));
    return scene;
}

TEST(Prices, are_of_the_runs_that_simulate_makes) {
    const Scene scene = orbit();
    const Price price = cost(scene, {.until = 5.0, .errors = {1e-3, 1e-8}, .engines = {"taylor", "dop853"}});
    EXPECT_EQ(price.automatic, "taylor");
    EXPECT_TRUE(price.missing.empty());
    ASSERT_GE(price.rows.size(), 4u);
    for (const CostRow& r : price.rows) {
        const Trajectory run = simulate(scene, {.until = 5.0, .rtol = r.tolerance, .engine = r.engine});
        EXPECT_EQ(run.statistics().steps, r.steps);
        EXPECT_EQ(run.statistics().right_hand_sides, r.right_hand_sides);
        EXPECT_TRUE(r.has_all_events);
        EXPECT_EQ(r.error, std::max(r.motion_error, r.event_error));
    }
    EXPECT_LE(price.cheapest(1e-8).error, 1e-8);
    std::ostringstream out;
    out << price << price.predict(1e-6);
    EXPECT_NE(out.str().find("auto takes taylor"), std::string::npos);
}

TEST(Prices, end_where_whoever_watches_says_so) {
    int asked = 0;
    const Price price = cost(orbit(), {.until = 5.0, .monitor = [&](double) { return ++asked < 3; }});
    EXPECT_LE(price.rows.size(), 2u);
    EXPECT_EQ(asked, 3);
}

TEST(Prices, runs_are_compared_at_times_of_the_motion) {
    pricing::Purse purse(1.0, {});
    for (const double start : {0.0, 5.0, -3.0}) {
        const SimulateOptions base{.until = start + 2.0, .start = start};
        const std::vector<double> times = pricing::Runner({}, base, purse).compared().times;
        ASSERT_GE(times.size(), 150u);
        EXPECT_GE(times.front(), start);
        EXPECT_EQ(times.back(), base.until);
        EXPECT_TRUE(std::ranges::is_sorted(times));
    }
}

}  // namespace
}  // namespace rbdyn::test::test_price
