// Elementary functions of numbers of 32 digits: inverses, addition theorems, digits known from elsewhere.
#include <gtest/gtest.h>

#include "random.hpp"
#include "rbdyn/basics/double_double_functions.hpp"

namespace rbdyn::test::test_double_double {
namespace {

// a few roundings of 106 bits
constexpr double digits = 1e-30;

double size(const DoubleDouble& x) { return std::abs(x.hi); }

TEST(DoubleDouble, has_the_digits_of_known_constants) {
    const DoubleDouble two = 2.0, three = 3.0;
    const DoubleDouble log_2{0.6931471805599453, 2.3190468138462996e-17},
        root_3{1.7320508075688772, 1.0035084221806903e-16};
    EXPECT_LE(size(log(two) - log_2), digits);
    EXPECT_LE(size(sqrt(three) - root_3), digits);
    EXPECT_LE(size(atan2(DoubleDouble(1.0), DoubleDouble(1.0)) * 4.0 - double_double::pi), digits);
    EXPECT_LE(size(acos(DoubleDouble(0.5)) * 3.0 - double_double::pi), digits);
    EXPECT_LE(size(asin(DoubleDouble(0.5)) * 6.0 - double_double::pi), digits);
    EXPECT_LE(size(tanh(log_2) - DoubleDouble(3.0) / 5.0), digits);
}

TEST(DoubleDouble, inverses_have_all_digits_of_what_is_small_and_of_what_is_large) {
    for (double a = 1e-290; a < 1e300; a *= 7e6)
        for (const DoubleDouble x : {DoubleDouble(a), -DoubleDouble(a) / 3.0}) {
            if (a < 1e-3) {
                const DoubleDouble half = x * x / 2.0, third = half * x / 1.5;
                const double all = digits + 4.0 * a * a * a;
                EXPECT_LE(size((log1p(x) - (x - half + third)) / x), all) << a;
                EXPECT_LE(size((expm1(x) - (x + half + third / 2.0)) / x), all) << a;
                EXPECT_LE(size((asinh(x) - (x - third / 2.0)) / x), all) << a;
                EXPECT_LE(size((atanh(x) - (x + third)) / x), all) << a;
            }
            const DoubleDouble y = asinh(x);
            if (a < 1e100) {
                EXPECT_LE(size((sinh(y) - x) / x), digits * (1.0 + size(y))) << a;
            }
        }
    const DoubleDouble log_10{2.302585092994046, -2.1707562233822494e-16},
        log_2{0.6931471805599453, 2.3190468138462996e-17};
    EXPECT_LE(size(asinh(DoubleDouble(1e300)) - log(DoubleDouble(1e300)) - log_2), 1e-28);
    EXPECT_LE(size(log1p(DoubleDouble(9.0)) - log_10), 1e-30);
    EXPECT_EQ(log1p(DoubleDouble(0.0)).hi, 0.0);
    EXPECT_EQ(expm1(DoubleDouble(-2000.0)), DoubleDouble(-1.0));
    EXPECT_EQ(atanh(DoubleDouble(1.0)).hi, std::numeric_limits<double>::infinity());
}

TEST(DoubleDouble, angles_of_any_size_have_sines_and_cosines) {
    // beside those of the C library, whose arguments are exact; those of 32 digits are known to a rounding of the angle
    for (const double x : {1e3, 1e10, 1e15, 1e16, 3e16, -1e17, 1.1e18, 1e19, -1.2345e22, 1e25, 1e31, 1e300}) {
        const DoubleDouble s = sin(DoubleDouble(x)), c = cos(DoubleDouble(x));
        EXPECT_LE(size(s * s + c * c - 1.0), x > 0x1p100 ? 1e-15 : digits) << x;
        const double off = 2e-15 + (std::abs(x) < 0x1p100 ? 1e-31 * std::abs(x) : 0.0);
        EXPECT_NEAR(s.hi, std::sin(x), off) << x;
        EXPECT_NEAR(c.hi, std::cos(x), off) << x;
    }
}

TEST(DoubleDouble, functions_undo_each_other_and_add_up) {
    Random random(5);
    for (int k = 0; k < 200; ++k) {
        const DoubleDouble x = DoubleDouble(random.uniform(-4.0, 4.0)) / 3.0,
                           y = DoubleDouble(random.uniform(0.1, 9.0)) / 7.0;
        EXPECT_LE(size(exp(log(y)) - y), digits * size(y));
        EXPECT_LE(size(sin(x) * sin(x) + cos(x) * cos(x) - 1.0), digits);
        EXPECT_LE(size(cosh(x) * cosh(x) - sinh(x) * sinh(x) - 1.0), digits * size(cosh(x) * cosh(x)));
        EXPECT_LE(size(sinh(x) + cosh(x) - exp(x)), digits * size(cosh(x)));
        EXPECT_LE(size(sinh(x + y) - (sinh(x) * cosh(y) + cosh(x) * sinh(y))), digits * size(cosh(x + y)));
        EXPECT_LE(size(pow(y, 2.5) * pow(y, -2.5) - 1.0), digits);
        EXPECT_LE(size(pow(y, 3.0) - y * y * y), digits * size(y * y * y));
        EXPECT_LE(size(expm1(log1p(y)) - y), digits * size(y));
        EXPECT_LE(size(sinh(asinh(4.0 * x)) - 4.0 * x), 4.0 * digits * size(x));
        EXPECT_LE(size(tanh(atanh(x / 6.0)) - x / 6.0), digits * size(x));
        const DoubleDouble angle = atan2(x, y);
        EXPECT_LE(size(sin(angle) * y - cos(angle) * x), digits * (size(x) + size(y)));
        EXPECT_EQ(floor(x).hi, std::floor(x.hi));
    }
    EXPECT_EQ(floor(DoubleDouble(2.0, -1e-20)), DoubleDouble(1.0));
    EXPECT_EQ(exactly<double>({1.0, 1e-17}), 1.0);
    EXPECT_EQ(exactly<long double>({1.0, 0x1p-60}), 1.0L + 0x1p-60L);
}

}  // namespace
}  // namespace rbdyn::test::test_double_double
