// Roots of polynomials on (0, 1]: none missed, none twice, in order, and no hang on noise.
#include "rbdyn/series/roots.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

namespace rbdyn::series::test_roots {
namespace {

std::vector<double> roots_of(const std::vector<double>& coefficients) {
    RootFinder finder;
    std::vector<double> roots;
    finder.find(coefficients.data(), static_cast<int>(coefficients.size()) - 1, roots);
    return roots;
}

/// Coefficients of scale (x - r1)(x - r2)..., in long double before they are rounded.
std::vector<double> product(const std::vector<double>& roots, double scale = 1.0) {
    std::vector<long double> c{scale};
    for (double r : roots) {
        c.insert(c.begin(), 0.0L);
        for (std::size_t k = 0; k + 1 < c.size(); ++k) c[k] -= r * c[k + 1];
    }
    return {c.begin(), c.end()};
}

double uniform(std::uint64_t& state) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11) * 0x1p-53;
}

TEST(Roots, three_roots_in_one_step_are_all_found_wherever_the_step_lies) {
    // -(t + 6)(t + 2)(t - 2), the step scaled so that all, two or one of them are in it
    for (const auto& [begin, length, expected] :
         {std::tuple{-7.0, 10.0, std::vector{0.1, 0.5, 0.9}}, std::tuple{-8.0, 16.0, std::vector{0.125, 0.375, 0.625}},
          std::tuple{-4.0, 8.0, std::vector{0.25, 0.75}}, std::tuple{0.0, 4.0, std::vector{0.5}}}) {
        std::vector<double> shifted;
        for (double r : {-6.0, -2.0, 2.0}) shifted.push_back((r - begin) / length);
        for (double scale : {-1.0, 1e-200, -1e200}) {
            const auto found = roots_of(product(shifted, scale));
            ASSERT_EQ(found.size(), expected.size()) << begin;
            for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 4e-16 * 10.0);
        }
    }
}

TEST(Roots, one_of_odd_multiplicity_is_found_once_and_one_of_even_multiplicity_is_no_change_of_sign) {
    for (double root = 0.03125; root < 1.0; root += 0.03125)
        for (const double scale : {1.0, -1e-200, 1e200}) {
            for (const std::vector<double>& others : {std::vector<double>{}, {-2.0}, {1.5, 1.5}, {3.0, -0.5, 2.0}}) {
                for (int multiplicity = 2; multiplicity <= 5; ++multiplicity) {
                    std::vector<double> all = others;
                    all.insert(all.end(), static_cast<std::size_t>(multiplicity), root);
                    const auto found = roots_of(product(all, scale));
                    if (multiplicity % 2 == 0) {
                        // rounding of the coefficients may make it a pair
                        EXPECT_EQ(found.size() % 2, 0u) << root << ' ' << multiplicity;
                        continue;
                    }
                    ASSERT_EQ(found.size(), 1u) << root << ' ' << multiplicity << ' ' << others.size();
                    // by the derivative that has a simple root there, up to what the coefficients' rounding moves it by
                    EXPECT_NEAR(found[0], root, 1e-12) << multiplicity;
                }
            }
        }
    const auto both = roots_of(product({0.25, 0.625, 0.625, 0.625, 0.875}));
    ASSERT_EQ(both.size(), 3u);
    EXPECT_NEAR(both[0], 0.25, 4e-16 * 10.0);
    EXPECT_NEAR(both[1], 0.625, 1e-12);
    EXPECT_NEAR(both[2], 0.875, 1e-14);
}

TEST(Roots, are_found_at_every_scale_of_the_step) {
    // (y - 1)(y - 3), and 1 - y^2, of y = s x: what is found does not depend on where the step ends
    for (double s = 4.0; s < 1e40; s *= 10.0) {
        for (const double scale : {1.0, -1e-100, 1e100}) {
            const auto two = roots_of({3.0 * scale, -4.0 * s * scale, s * s * scale});
            ASSERT_EQ(two.size(), 2u) << s;
            EXPECT_NEAR(two[0] * s, 1.0, 1e-15) << s;
            EXPECT_NEAR(two[1] * s, 3.0, 3e-15) << s;
            const auto one = roots_of({scale, 0.0, -s * s * scale});
            ASSERT_EQ(one.size(), 1u) << s;
            EXPECT_NEAR(one[0] * s, 1.0, 1e-15) << s;
        }
    }
}

TEST(Roots, of_every_multiplicity_are_found_at_every_scale) {
    for (int m = 1; m <= 15; ++m)
        for (const double s : {1.0, 1.05, 1.5, 2.0, 3.0, 10.0, 1e3, 1e6, 1e12}) {
            // (y - 1)^m of y = s x
            std::vector<double> g;
            double binomial = m % 2 == 0 ? 1.0 : -1.0;
            for (int k = 0; k <= m; ++k) {
                g.push_back(binomial * std::pow(s, k));
                binomial *= -static_cast<double>(m - k) / (k + 1);
            }
            const auto found = roots_of(g);
            ASSERT_EQ(found.size(), m % 2 == 0 ? 0u : 1u) << m << ' ' << s;
            for (const double root : found) EXPECT_NEAR(root * s, 1.0, 1e-12) << m << ' ' << s;
        }
}

TEST(Roots, a_root_at_the_end_counts_and_one_at_the_beginning_does_not) {
    EXPECT_EQ(roots_of({-1.0, 1.0}), std::vector{1.0});
    EXPECT_EQ(roots_of({1.0, -1.0}), std::vector{1.0});
    EXPECT_EQ(roots_of({-1.0, 0.0, 0.0, 1.0}), std::vector{1.0});
    EXPECT_TRUE(roots_of({0.0, 1.0}).empty());
    EXPECT_TRUE(roots_of({0.0, 1.0, 0.5, 0.25}).empty());
    EXPECT_TRUE(roots_of({-1.0, 1.0 - 1e-15}).empty());
    EXPECT_EQ(roots_of({-1.0, 1.0 + 1e-15}).size(), 1u);
    // x (x - 1/2): the root at zero belongs to the step before
    const auto half = roots_of({0.0, -0.5, 1.0});
    ASSERT_EQ(half.size(), 1u);
    EXPECT_EQ(half[0], 0.5);
}

TEST(Roots, a_polynomial_without_a_change_of_sign_has_none) {
    EXPECT_TRUE(roots_of({0.0}).empty());
    EXPECT_TRUE(roots_of({3.0}).empty());
    EXPECT_TRUE(roots_of({0.0, 0.0, 0.0}).empty());
    EXPECT_TRUE(roots_of({1.0, -1.0, 1.0}).empty());
    // touches zero at 1/2 and turns back: exactly, no change of sign
    EXPECT_TRUE(roots_of({0.25, -1.0, 1.0}).empty());
}

TEST(Roots, known_roots_of_random_polynomials_come_in_order_each_once) {
    std::uint64_t state = 42;
    for (int trial = 0; trial < 3000; ++trial) {
        const int inside = static_cast<int>(uniform(state) * 6.0), outside = static_cast<int>(uniform(state) * 4.0);
        std::vector<double> expected, all;
        for (int k = 0; k < inside; ++k) {
            // well apart, so that each is known to many digits
            const double r = (static_cast<double>(k) + 0.2 + 0.6 * uniform(state)) / inside;
            if (r > 0.0) expected.push_back(r);
        }
        all = expected;
        for (int k = 0; k < outside; ++k)
            all.push_back(uniform(state) < 0.5 ? -0.1 - 3.0 * uniform(state) : 1.1 + 3.0 * uniform(state));
        const auto found = roots_of(product(all, uniform(state) < 0.5 ? -1.0 : 1.0));
        ASSERT_EQ(found.size(), expected.size()) << "trial " << trial;
        ASSERT_TRUE(std::is_sorted(found.begin(), found.end()));
        for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-9) << "trial " << trial;
    }
}

/// Taylor coefficients about `from` of a sine whose frequency grows, sin(2 x + x^2), on a step of length `step`.
std::vector<double> chirp(double from, double step, int degree) {
    // s' = p' c, c' = -p' s with p = 2 x + x^2
    std::vector<long double> s{std::sin(static_cast<long double>(2 * from + from * from))},
        c{std::cos(static_cast<long double>(2 * from + from * from))};
    const long double h = step, p1 = h * (2 + 2 * static_cast<long double>(from)), p2 = 2 * h * h;
    for (int k = 0; k < degree; ++k) {
        long double next_s = p1 * c[static_cast<std::size_t>(k)], next_c = -p1 * s[static_cast<std::size_t>(k)];
        if (k > 0) {
            next_s += p2 * c[static_cast<std::size_t>(k - 1)];
            next_c -= p2 * s[static_cast<std::size_t>(k - 1)];
        }
        s.push_back(next_s / (k + 1));
        c.push_back(next_c / (k + 1));
    }
    return {s.begin(), s.end()};
}

TEST(Roots, grazing_pairs_a_little_below_every_maximum_are_all_found) {
    // every maximum of the chirp up to x = 7, on steps as an integrator would make them; thresholds below 1 by gap
    for (double gap : {1e-4, 1e-6, 1e-9, 1e-12}) {
        int crossings = 0, expected = 0;
        for (int n = 0;; ++n) {
            // 2 x + x^2 = pi/2 + 2 pi n
            const double phase = (0.5 + 2.0 * n) * 3.14159265358979323846;
            const double top = std::sqrt(1.0 + phase) - 1.0;
            if (top > 7.0) break;
            ++expected;
            const double step = 1.0 / (2.0 + 2.0 * top);  // one radian
            auto g = chirp(top - 0.37 * step, step, 24);
            g[0] -= 1.0 - gap;
            const auto found = roots_of(g);
            crossings += static_cast<int>(found.size());
            ASSERT_EQ(found.size(), 2u) << "gap " << gap << ", maximum " << n;
            // sin(pi/2 - a) = 1 - gap at a = acos(1 - gap), a radian being about the step
            const double apart = 2.0 * std::sqrt(2.0 * gap);
            EXPECT_NEAR(found[1] - found[0], apart, 0.1 * apart + 1e-9) << "gap " << gap << ", maximum " << n;
            EXPECT_GT(found[0], 0.37 - apart);
        }
        EXPECT_EQ(crossings, 2 * expected);
        EXPECT_EQ(expected, 10);
    }
}

TEST(Roots, no_crossing_is_found_a_little_above_every_maximum) {
    for (double gap : {1e-4, 1e-6, 1e-9, 1e-12})
        for (double top : {0.6, 1.6, 2.9, 5.3}) {
            const double phase =
                (0.5 + 2.0 * std::round((2.0 * top + top * top) / 6.283185307179586)) * 3.14159265358979323846;
            const double x = std::sqrt(1.0 + phase) - 1.0, step = 1.0 / (2.0 + 2.0 * x);
            auto g = chirp(x - 0.37 * step, step, 24);
            g[0] -= 1.0 + gap;
            EXPECT_TRUE(roots_of(g).empty()) << gap;
        }
}

TEST(Roots, noise_around_zero_ends_soon) {
    std::uint64_t state = 7;
    const auto began = std::chrono::steady_clock::now();
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<double> noise(25), flat(25, 0.0);
        for (double& c : noise) c = 1e-17 * (uniform(state) - 0.5);
        const auto found = roots_of(noise);
        EXPECT_LE(found.size(), 24u);
        // (x - 1/2)^12, all of it rounding near its root
        flat = product(std::vector<double>(12, 0.5));
        EXPECT_LE(roots_of(flat).size(), 100u);
        for (double r : found) EXPECT_TRUE(r > 0.0 && r <= 1.0);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    EXPECT_LT(seconds, 20.0);  // 0.1 s where this was written
}

TEST(Roots, numbers_that_are_not_finite_give_no_root_and_no_hang) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (double bad : {nan, infinity, -infinity}) {
        for (double r : roots_of({1.0, bad, 1.0})) EXPECT_TRUE(std::isfinite(r));
        for (double r : roots_of({bad, 1.0, -1.0})) EXPECT_TRUE(std::isfinite(r));
    }
}

}  // namespace
}  // namespace rbdyn::series::test_roots
