// Functions watched by the signs of their factors.
#include "rbdyn/expression/same_sign.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/expression/condition.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/parameter.hpp"

namespace {

using rbdyn::Expression, rbdyn::Function, rbdyn::SignFactors;
using Inputs = std::vector<Expression>;

Function recorded(const std::function<Expression(const Inputs&)>& f) {
    return Function::record(2, [&](const Inputs& x) { return Inputs{f(x)}; });
}

double value(const Function& f, const std::array<double, 2>& x) { return f(std::span<const double>(x))[0]; }

double product(const SignFactors& signs, const std::array<double, 2>& x) {
    double result = 1.0;
    for (const double factor : signs.factors(std::span<const double>(x))) result *= factor;
    return result;
}

int sign(double x) { return x > 0.0 ? 1 : x < 0.0 ? -1 : 0; }

struct Case {
    const char* name;
    std::function<Expression(const Inputs&)> f;
    int factors;
    bool is_itself = false;
};

TEST(SameSign, is_that_of_few_and_simple_factors) {
    const auto power = [](const Expression& x, int n) { return rbdyn::pow(x, n); };
    const Case cases[] = {
        {"x - 1", [](const Inputs& x) { return x[0] - 1.0; }, 1, true},
        {"-2 (x - 1)", [](const Inputs& x) { return -2.0 * (x[0] - 1.0); }, 1, true},
        {"x / y", [](const Inputs& x) { return x[0] / x[1]; }, 1, true},
        {"sqrt(x) - 1", [](const Inputs& x) { return sqrt(x[0]) - 1.0; }, 1, true},
        {"sqrt(x) y", [](const Inputs& x) { return sqrt(x[0]) * x[1]; }, 2},
        {"x y", [](const Inputs& x) { return x[0] * x[1]; }, 2},
        {"(x - 1)^7", [&](const Inputs& x) { return power(x[0] - 1.0, 7); }, 1},
        {"(x - 1)^6 y^3", [&](const Inputs& x) { return power(x[0] - 1.0, 6) * power(x[1], 3); }, 2},
        {"cbrt((x - 1)^5 (y - 1)^5)",
         [&](const Inputs& x) { return cbrt(power(x[0] - 1.0, 5) * power(x[1] - 1.0, 5)); }, 2},
        {"sqrt|x|", [](const Inputs& x) { return sqrt(abs(x[0])); }, 1},
        {"sqrt(sqrt|x y|)", [](const Inputs& x) { return sqrt(sqrt(abs(x[0] * x[1]))); }, 1},
        {"log|x|", [](const Inputs& x) { return log(abs(x[0])); }, 1},
        {"x exp(y)", [](const Inputs& x) { return x[0] * exp(x[1]); }, 1},
        {"tanh(sinh(x))", [](const Inputs& x) { return tanh(sinh(x[0])); }, 1},
        {"arctan(x^3)", [&](const Inputs& x) { return atan(power(x[0], 3)); }, 1},
        {"x / (1 + y^2)", [](const Inputs& x) { return x[0] / (1.0 + x[1] * x[1]); }, 1},
        {"x^5 / y^3", [&](const Inputs& x) { return power(x[0], 5) / power(x[1], 3); }, 1, true},
        {"x / |x|", [](const Inputs& x) { return x[0] / abs(x[0]); }, 1, true},
        {"x^4 / x^3", [&](const Inputs& x) { return power(x[0], 4) / power(x[0], 3); }, 1, true},
        {"|x| (1 / x)", [](const Inputs& x) { return abs(x[0]) * (1.0 / x[0]); }, 1, true},
        {"arctan(1 / x)", [](const Inputs& x) { return atan(1.0 / x[0]); }, 1, true},
        {"cbrt(x) / length(x, y)",
         [](const Inputs& x) {
             return cbrt(x[0]) / rbdyn::length({x[0], x[1], Expression(0.0)});
         },
         1, true},
        {"x y / (2 + cos x)", [](const Inputs& x) { return x[0] * x[1] / (2.0 + cos(x[0])); }, 2},
        {"arsinh(x)^3", [&](const Inputs& x) { return power(asinh(x[0]), 3); }, 1},
        {"expm1(x)^3", [&](const Inputs& x) { return power(expm1(x[0]), 3); }, 1},
        {"artanh(tanh(x) / 2)", [&](const Inputs& x) { return atanh(0.5 * tanh(x[0])); }, 1},
        {"log1p(x)", [&](const Inputs& x) { return log1p(x[0]); }, 1, true},
        {"x^3 log1p(y)", [&](const Inputs& x) { return power(x[0], 3) * log1p(x[1]); }, 2},
        {"sqrt|x tan(x)|", [](const Inputs& x) { return sqrt(abs(x[0] * tan(x[0]))); }, 1},
        {"sqrt|x log(x)|", [](const Inputs& x) { return sqrt(abs(x[0] * log(x[0]))); }, 2},
        {"1 / |x|", [](const Inputs& x) { return 1.0 / abs(x[0]); }, 1},
        {"x^3 tan(y)", [&](const Inputs& x) { return power(x[0], 3) * tan(x[1]); }, 2},
        {"tanh(1 / x)", [](const Inputs& x) { return tanh(1.0 / x[0]); }, 1, true},
        {"x^2 (1 / x)", [](const Inputs& x) { return x[0] * x[0] * (1.0 / x[0]); }, 1, true},
        {"|x| + |y|", [](const Inputs& x) { return abs(x[0]) + abs(x[1]); }, 1},
        {"1 where min(x, y) > 0, else -1",
         [](const Inputs& x) { return rbdyn::where(rbdyn::min(x[0], x[1]) > 0.0, 1.0, -1.0); }, 1},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        const Function f = recorded(c.f);
        const SignFactors signs = rbdyn::sign_factors(f);
        EXPECT_EQ(signs.factors.outputs(), c.factors);
        EXPECT_EQ(signs.is_itself, c.is_itself);
        for (const double x : {-2.0, -0.5, 0.25, 1.0, 3.0})
            for (const double y : {-1.0, 0.5, 1.0, 2.0}) {
                const double known = value(f, {x, y});
                if (!std::isfinite(known)) continue;
                EXPECT_EQ(sign(product(signs, {x, y})), sign(known)) << x << ' ' << y;
            }
    }
}

TEST(SameSign, keeps_no_absolute_value_that_makes_no_corner) {
    const Function f = recorded([](const Inputs& x) { return sqrt(abs(x[0])) * cbrt(x[1]); });
    EXPECT_EQ(f.distinctions().outputs(), 2);
    EXPECT_EQ(rbdyn::sign_factors(f).factors.distinctions().outputs(), 0);
}

TEST(SameSign, is_not_finite_where_the_function_is_not_for_longer) {
    const std::function<Expression(const Inputs&)> functions[] = {
        [](const Inputs& x) { return sqrt(x[0]) * x[1]; },
        [](const Inputs& x) { return exp(log(x[0])) * x[1]; },
        [](const Inputs& x) { return rbdyn::pow(x[0], 1.5); },
        [](const Inputs& x) { return sqrt(abs(log(x[0]))); },
        [](const Inputs& x) { return x[1] / (1.0 + sqrt(x[0])); },
        [](const Inputs& x) { return tanh(acos(x[0] - 2.0)); },
    };
    for (const auto& f : functions) {
        const Function whole = recorded(f);
        ASSERT_FALSE(std::isfinite(value(whole, {-0.5, 2.0})));
        EXPECT_FALSE(std::isfinite(product(rbdyn::sign_factors(whole), {-0.5, 2.0})));
    }
}

TEST(SameSign, depends_on_numbers_by_reference_as_the_function_does) {
    rbdyn::Parameter a(2.0, "a");
    const rbdyn::Parameter b(3.0, "b");
    const Function f = recorded(
        [&](const Inputs& x) { return rbdyn::pow(x[0] - Expression(b), 3) * rbdyn::pow(x[1] - Expression(a), 3); });
    const SignFactors now = rbdyn::sign_factors(f), frozen = rbdyn::sign_factors(f.frozen());
    EXPECT_EQ(product(now, {4.0, 3.0}), 1.0);
    a.set(5.0);
    EXPECT_EQ(product(now, {4.0, 3.0}), -2.0);
    EXPECT_EQ(product(frozen, {4.0, 3.0}), 1.0);
}

// Made-up functions at points where many of their parts are zero.
TEST(SameSign, holds_for_made_up_functions) {
    std::mt19937_64 random(7);
    const auto draw = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const std::function<Expression(int, const Inputs&)> made_up = [&](int depth, const Inputs& x) -> Expression {
        if (depth == 0) {
            constexpr std::array constants{-1.0, 0.5, 1.0, 2.0};
            return draw(4) == 0 ? Expression(constants[static_cast<std::size_t>(draw(4))])
                                : x[static_cast<std::size_t>(draw(2))];
        }
        const Expression a = made_up(depth - 1, x);
        switch (draw(18)) {
            case 0: return abs(a);
            case 1: return cbrt(a);
            case 2: return sqrt(abs(a));
            case 3: return rbdyn::pow(a, 1 + draw(6));
            case 4: return tanh(a);
            case 5: return atan(a);
            case 6: return sqrt(1.0 + a * a);
            case 7: return log(abs(a) + 0.5);
            case 8: return a - 1.0;
            case 9: return exp(sin(a));
            case 10: return rbdyn::pow(abs(a), 0.3);
            case 11: return sqrt(a);
            default: break;
        }
        const Expression b = made_up(depth - 1, x);
        switch (draw(8)) {
            case 0: return a + b;
            case 1: return rbdyn::max(a, b);
            case 2: return rbdyn::min(a, b);
            case 3: return rbdyn::where(a > b, a, -b);
            case 4: return a / (1.0 + b * b);
            case 5: return rbdyn::length({a, b, Expression(0.0)});
            default: return a * b;
        }
    };
    int simpler = 0, compared = 0;
    for (int k = 0; k < 4000; ++k) {
        const Function f = recorded([&](const Inputs& x) { return made_up(2 + k % 4, x); });
        const SignFactors signs = rbdyn::sign_factors(f);
        simpler += signs.is_itself ? 0 : 1;
        // what is never negative passes nothing
        const bool is_one = signs.factors.constants() == std::vector<double>{1.0};
        for (const double x : {-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0})
            for (const double y : {-1.5, -1.0, 0.0, 0.25, 1.0, 2.0}) {
                const double known = value(f, {x, y}), now = product(signs, {x, y});
                SCOPED_TRACE(f.text() + "at " + std::to_string(x) + ", " + std::to_string(y) + "\n" +
                             signs.factors.text());
                if (!std::isfinite(known)) {
                    EXPECT_FALSE(std::isfinite(now) && std::isnan(value(f, {x + 1e-6, y + 1e-7})));
                    continue;
                }
                // a zero that rounding may have made, or hidden
                constexpr double rounding = 1e-12;
                if (std::abs(known) > rounding) {
                    ASSERT_EQ(sign(now), sign(known));
                    ++compared;
                } else if (known == 0.0 && !is_one) {
                    ASSERT_LT(std::abs(now), rounding);
                }
            }
    }
    EXPECT_GT(simpler, 2000);
    EXPECT_GT(compared, 60000);
}

}  // namespace
