#include "rbdyn/series/fit.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "rbdyn/series/polynomial.hpp"

namespace rbdyn::series::test_fit {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

template <class Function>
std::array<double, Fit::points> fitted(Function f, double negligible = 0.0) {
    std::array<double, Fit::points> values, c;
    for (int j = 0; j < Fit::points; ++j) values[static_cast<std::size_t>(j)] = f(Fit::place(j));
    Fit::coefficients(values.data(), negligible, c.data());
    return c;
}

template <class Function>
double error(const std::array<double, Fit::points>& c, Function f) {
    double error = 0.0;
    for (int k = 0; k <= 200; ++k)
        error = std::max(error, std::abs(value(c.data(), Fit::degree, k / 200.0) - f(k / 200.0)));
    return error;
}

TEST(Fit, points_go_from_one_end_to_the_other_and_checks_lie_between) {
    EXPECT_EQ(Fit::place(0), 0.0);
    EXPECT_EQ(Fit::place(Fit::degree), 1.0);
    for (int j = 1; j < Fit::points; ++j) EXPECT_LT(Fit::place(j - 1), Fit::place(j));
    for (int i = 0; i < Fit::checks; ++i)
        for (int j = 0; j < Fit::points; ++j) EXPECT_GT(std::abs(Fit::check(i) - Fit::place(j)), 1e-3);
}

TEST(Fit, gives_back_every_power_up_to_its_degree) {
    for (int power = 0; power <= Fit::degree; ++power) {
        const auto f = [&](double x) { return std::pow(x, power); };
        const auto c = fitted(f);
        // sums of the sizes of what is added up: x^power at x = 2, where every T_k is (3 + sqrt 8)^k / 2
        EXPECT_LT(error(c, f), epsilon * std::ldexp(1.0, std::max(3, power))) << power;
        // terms of powers of x feel the rounding of the values by the sum of the sizes of T_12: (3 + sqrt 8)^12 / 2
        for (int k = 0; k <= Fit::degree; ++k)
            EXPECT_NEAR(c[static_cast<std::size_t>(k)], k == power ? 1.0 : 0.0, 8e8 * epsilon);
    }
}

TEST(Fit, without_its_negligible_terms_has_the_powers_that_are_there) {
    const auto f = [](double x) { return 3.0 - 2.0 * x + x * x * x; };
    const auto c = fitted(f, 16.0 * epsilon);
    const std::array expected{3.0, -2.0, 0.0, 1.0};
    for (std::size_t k = 0; k < c.size(); ++k)
        EXPECT_NEAR(c[k], k < expected.size() ? expected[k] : 0.0, 300.0 * epsilon) << k;
    EXPECT_EQ(c[4], 0.0);
}

TEST(Fit, is_the_first_value_at_its_start) {
    for (double place : {0.0, 1e-9, 0.3}) {
        const auto f = [&](double x) { return std::sin(7.0 * (x - place)); };
        EXPECT_EQ(fitted(f)[0], f(0.0));
    }
}

TEST(Fit, of_an_entire_function_is_good_to_rounding) {
    // the terms of exp(x / 2) fall as (1/8)^k / k!
    const auto f = [](double x) { return std::exp(0.5 * x); };
    EXPECT_LT(error(fitted(f), f), 8.0 * epsilon);
}

TEST(Fit, of_a_function_with_a_pole_has_the_error_that_theory_says) {
    // 1 / (x + d): |error| falls as rho^-n, rho = z + sqrt(z^2 - 1), z = 1 + 2 d (Trefethen, theorem 8.2)
    for (double d : {1.0, 0.25, 0.05}) {
        const auto f = [&](double x) { return 1.0 / (x + d); };
        const double z = 1.0 + 2.0 * d, rho = z + std::sqrt(z * z - 1.0);
        const double expected = std::pow(rho, -Fit::degree) / d;
        const double found = error(fitted(f), f);
        EXPECT_LT(found, 2.0 * expected + 1e-14 / d);
        EXPECT_GT(found, 0.05 * expected - 1e-14 / d);
    }
}

TEST(Fit, is_off_by_no_more_than_what_was_left_out) {
    const auto f = [](double x) { return 1.0 / (x + 0.25); };
    for (double negligible : {1e-1, 1e-2, 1e-3}) {
        const auto c = fitted(f, negligible);
        const double found = error(c, f);
        EXPECT_LT(found, 2.0 * negligible + error(fitted(f), f));
        EXPECT_EQ(c[Fit::degree], 0.0);
    }
}

}  // namespace
}  // namespace rbdyn::series::test_fit
