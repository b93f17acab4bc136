// Functions that have values only: every root and no pole, whatever they are at the start and on the way.
#include "rbdyn/event/rough_passages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace rbdyn::test_rough_passages {
namespace {

struct Found {
    std::vector<double> roots;
    std::optional<double> broken;
    int values = 0;
};

/// What a search finds on [0, 1], with the polynomials' roots by series/roots.hpp.
Found found(const std::function<double(double)>& f) {
    Found result;
    int side = 0;
    RoughPassages rough;
    series::RootFinder finder;
    result.broken = rough.find(
        1e-16,
        [&](double x) {
            ++result.values;
            return f(x);
        },
        f, [&] { return side; },
        [&](const series::Coefficients& q, double lo, double hi, double) {
            if (side == 0) side = q[0] > 0.0 ? 1 : q[0] < 0.0 ? -1 : 0;
            std::vector<double> roots;
            finder.find(q.data(), series::Fit::degree, roots);
            for (const double x : roots) {
                result.roots.push_back(lo + x * (hi - lo));
                side = -side;
            }
        },
        [&](double x, double, bool rising, bool is_pole) {
            side = rising ? 1 : -1;
            if (!is_pole) result.roots.push_back(x);
        });
    return result;
}

TEST(RoughPassages, find_every_root_and_no_pole) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), pi = std::numbers::pi;
    struct Case {
        std::string name;
        std::function<double(double)> f;
        std::vector<double> roots;
        std::optional<double> broken = std::nullopt;
    };
    const std::vector<Case> cases{
        {"a root of a polynomial", [](double x) { return x * x - 0.25; }, {0.5}},
        {"infinite slope at the start", [](double x) { return std::sqrt(x) - 0.125; }, {0.015625}},
        {"and a root near it", [](double x) { return std::pow(x, 0.1) - 0.25; }, {std::pow(0.25, 10)}},
        {"infinite at the start", [](double x) { return std::log(x) + 10.0; }, {std::exp(-10.0)}},
        {"a pole at the start", [](double x) { return 1.0 / x - 1000.0; }, {0.001}},
        {"no number at the start", [](double x) { return std::sin(x) / x - 0.9; }, {0.78668307204921184}},
        {"a pole", [](double x) { return 1.0 / (x - 0.3); }, {}},
        {"a pole met exactly", [](double x) { return 1.0 / (x - 0.25); }, {}},
        {"a weak pole", [](double x) { return 1.0 / std::cbrt(x - 0.3); }, {}},
        {"roots and poles in turn", [](double x) { return std::tan(8.0 * x); }, {pi / 8.0, 2.0 * pi / 8.0}},
        {"a root beside a pole", [](double x) { return 1.0 / (x - 0.3) + 1e4; }, {0.3 - 1e-4}},
        {"two poles and a root between", [](double x) { return 1.0 / (x - 0.3) + 1.0 / (x - 0.31); }, {0.305}},
        {"a vertical tangent at a root", [](double x) { return std::cbrt(x - 0.3); }, {0.3}},
        {"a corner", [](double x) { return std::abs(x - 0.3) - 0.01; }, {0.29, 0.31}},
        {"a jump through zero", [](double x) { return x < 0.3 ? -1.0 : 2.0; }, {0.3}},
        {"an instant that is no number", [](double x) { return x == 0.5 ? nan : x - 0.7; }, {0.7}},
        {"no number from a place on", [](double x) { return x > 0.6 ? nan : x - 0.3; }, {0.3}, 0.6},
        {"its end with a slope", [](double x) { return std::sqrt(0.6 - x) - 0.3; }, {0.51}, 0.6},
        {"no number at all", [](double) { return nan; }, {}, 0.0},
        {"no number at first", [](double x) { return std::sqrt(x - 0.2) - 0.3; }, {}, 0.0}};
    for (const Case& c : cases) {
        const Found now = found(c.f);
        EXPECT_EQ(now.broken.has_value(), c.broken.has_value()) << c.name;
        // places to rounding of the fits' values, which is 1e-10 of the largest
        if (now.broken && c.broken) {
            EXPECT_NEAR(*now.broken, *c.broken, 1e-15) << c.name;
        }
        ASSERT_EQ(now.roots.size(), c.roots.size()) << c.name;
        for (std::size_t i = 0; i < c.roots.size(); ++i) EXPECT_NEAR(now.roots[i], c.roots[i], 1e-10) << c.name;
        EXPECT_LT(now.values, 10000) << c.name;
    }
}

TEST(RoughPassages, know_a_pole_from_a_root_and_a_jump_however_near_the_function_is_first_looked_at) {
    // between two doubles, of which time resolves a few
    constexpr double place = 0.3, beside = 2e-17, finest = 4e-16;
    const std::vector<double> away{1e-3, 1e-8, 1e-13, 1e-15, 1e-16};
    for (const double before : away)
        for (const double after : away) {
            // nothing tells what is closer than time resolves from its surroundings
            if (before + after < 64.0 * finest) continue;
            const double a = place - before, b = place + after;
            const auto is_pole = [&](auto f) {
                return RoughPassages::is_pole([&](double x) { return f(x - place - beside); }, a, b,
                                              f(-before) > 0 ? 1 : -1, finest);
            };
            EXPECT_TRUE(is_pole([](double d) { return 1.0 / d; })) << before << ' ' << after;
            EXPECT_TRUE(is_pole([](double d) { return -1.0 / (d * d * d); })) << before << ' ' << after;
            EXPECT_FALSE(is_pole([](double d) { return d; })) << before << ' ' << after;
            EXPECT_FALSE(is_pole([](double d) { return std::cbrt(d); })) << before << ' ' << after;
            EXPECT_FALSE(is_pole([](double d) { return d < 0.0 ? -1.0 : 2.0 + d; })) << before << ' ' << after;
        }
}

TEST(RoughPassages, are_found_where_a_function_is_smaller_by_far_than_elsewhere) {
    // beside the largest value, and of no polynomial that a fit would find on all of the interval
    for (const double root : {1e-5, 1e-8, 1e-11}) {
        const Found now = found([=](double x) { return std::pow(x, 14) - std::pow(root, 14); });
        ASSERT_EQ(now.roots.size(), 1u) << root;
        EXPECT_NEAR(now.roots[0], root, 1e-8 * root);
    }
}

TEST(RoughPassages, of_a_function_that_is_rough_by_itself_cost_no_more) {
    // values with errors of 1e-9, as a table may have
    const Found now = found([](double x) { return x - 0.3 + 1e-9 * std::sin(1e9 * x); });
    ASSERT_EQ(now.roots.size(), 1u);
    EXPECT_NEAR(now.roots[0], 0.3, 1e-8);
    EXPECT_LT(now.values, 200);
}

}  // namespace
}  // namespace rbdyn::test_rough_passages
