// Machine code made once for all bodies of a chain: the series that its lists give, bit for bit, also where the chain
// is interrupted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "expression/programs.hpp"
#include "random.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/repeated_code.hpp"
#include "rbdyn/expression/repetition.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::test_repeated_code {
namespace {

using E = Expression;
using test::is_made;
using test::Random;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Masses in space, each joined with the next one by a spring of a length, all masses and springs alike or each
/// another.
Program springs(int masses, bool are_alike) {
    Recorder r;
    const E p = r.parameter(r.new_parameter());
    std::vector<E> rates(at(6 * masses)), before(3, 0.0);
    for (int i = 0; i < masses; ++i) {
        const double stiffness = are_alike ? 100.0 : 100.0 + 0.5 * i, mass = are_alike ? 1.0 : 1.0 + 0.125 * (i % 5);
        std::vector<E> apart(3), force(3, 0.0);
        for (int l = 0; l < 3; ++l)
            apart[at(l)] = i + 1 < masses ? r.input(3 * i + 3 + l) - r.input(3 * i + l) : E(0.0);
        if (i + 1 < masses) {
            const E stretched = stiffness * (1.0 - p / length({apart[0], apart[1], apart[2]}));
            for (int l = 0; l < 3; ++l) force[at(l)] = stretched * apart[at(l)];
        }
        for (int l = 0; l < 3; ++l) {
            rates[at(3 * i + l)] = r.input(3 * masses + 3 * i + l);
            rates[at(3 * masses + 3 * i + l)] = (force[at(l)] - before[at(l)]) / mass + (l == 2 ? -9.8125 : 0.0);
        }
        before = force;
    }
    return Program(r, rates, 6 * masses);
}

/// Variables of which each rate is made of those beside it by the same formula, but for some.
Program random_chain(Random& random, int bodies, double exceptions) {
    Recorder r;
    const E p = r.parameter(r.new_parameter()), t = r.time();
    const int formula = random.whole(0, 5), each = random.whole(1, 3);
    const bool are_alike = random.chance(0.5);
    std::vector<E> rates;
    for (int i = 0; i < bodies; ++i)
        for (int j = 0; j < each; ++j) {
            const auto variable = [&](int by) {
                const int body = std::clamp(i + by, 0, bodies - 1);
                return r.input(each * (random.chance(exceptions) ? random.whole(std::max(0, body - 3), body) : body) +
                               j);
            };
            const E x = r.input(each * i + j), left = variable(-1), right = variable(1);
            const double weight = are_alike ? 0.75 : random.uniform(-1.0, 1.0);
            // where it begins and ends there are others
            const bool may_differ = std::abs(2 * i - bodies) > bodies / 2;
            const int which = may_differ && random.chance(exceptions) ? random.whole(0, 5) : formula;
            switch (which) {
                case 0: rates.push_back(weight * sin(right - x) - sin(x - left) + p); break;
                case 1: rates.push_back(weight * (left - x) / ((x + right) * (x + right) + 2.0)); break;
                case 2: rates.push_back(sqrt(x * x + left * right + 4.0) - p * cos(left) * x); break;
                case 3: rates.push_back(weight * length({x, left, right + 3.0}) - 0.5 * x * right + 0.125); break;
                case 4: rates.push_back(log(x * x + 1.5) - weight * left * right + 0.1 * t * x); break;
                default: rates.push_back(right - left + (p + weight) * x * left - x * right); break;
            }
        }
    const int inputs = static_cast<int>(rates.size());
    rates.push_back(p * rates.front() + rates.back());
    return Program(r, rates, inputs);
}

/// All coefficients of all slots; `whole`: of the last order too.
std::vector<double> expanded(SeriesEvaluator& series, const std::vector<double>& x, double parameter, int order,
                             bool whole) {
    std::vector<double> parameters(at(series.program().parameters()), 0.0);
    parameters.front() = parameter;
    series.set_parameters(parameters);
    series.begin(0.25, 0.125);
    for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
    series.expand(order, whole);
    std::vector<double> all;
    for (int slot = 0; slot < series.program().slots(); ++slot)
        all.insert(all.end(), series.coefficients(slot), series.coefficients(slot) + order + (whole ? 1 : 0));
    return all;
}

/// Where masses are: anywhere, a length apart, or some of them where the one before is.
enum class Places { anywhere, in_line, some_are_one };

/// Evaluations with other parameters, one after the other; whether there was code of what repeats itself.
bool hold(Random& random, const Program& program, int order, SeriesEvaluator::Use use, Places places) {
    SeriesEvaluator by_code(program, order, use), by_lists(program, order, use);
    by_code.use_machine_code(true);
    by_lists.use_machine_code(false);
    for (const bool whole : {true, false, true}) {
        std::vector<double> x;
        for (int i = 0; i < program.inputs(); ++i)
            x.push_back(random.chance(0.1) ? (random.chance(0.5) ? 0.0 : -0.0) : random.uniform(-0.25, 0.25));
        const int half = program.inputs() / 2;
        if (places == Places::in_line)
            for (int i = 0; i < half; i += 3) x[at(i)] += i / 3;
        // lengths begin at zero, and at an order that is another for each
        if (places == Places::some_are_one)
            for (int i = 3; i < half; i += 3)
                if (random.chance(0.25)) std::copy_n(x.begin() + i - 3, 3, x.begin() + i);
        const double parameter = random.uniform(0.5, 1.0);
        const std::vector<double> ours = expanded(by_code, x, parameter, order, whole),
                                  theirs = expanded(by_lists, x, parameter, order, whole);
        const auto row = at(order + (whole ? 1 : 0));
        for (std::size_t i = 0; i < ours.size(); ++i) {
            if (test::are_same(ours[i], theirs[i])) continue;
            ADD_FAILURE() << "slot " << i / row << ", order " << i % row << " of " << order << ": " << ours[i]
                          << " and not " << theirs[i];
            return false;
        }
    }
    EXPECT_FALSE(by_lists.has_machine_code());
    return by_code.has_repeated_code();
}

TEST(RepeatedCode, has_the_bits_of_the_lists_for_springs_in_a_row) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(1);
    for (const bool are_alike : {true, false})
        for (const int masses : {40, 101, 402}) {
            const Program program = springs(masses, are_alike);
            for (int order = 2; order <= 26; order += masses > 100 ? 6 : 1)
                for (const auto use :
                     {SeriesEvaluator::Use::any, SeriesEvaluator::Use::expansion, SeriesEvaluator::Use::states}) {
                    EXPECT_TRUE(hold(random, program, order, use, Places::in_line))
                        << masses << " masses, order " << order;
                    if (HasFailure()) return;
                }
        }
}

TEST(RepeatedCode, has_the_bits_of_the_lists_where_springs_begin_at_zero) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(2);
    for (int trial = 0; trial < 10; ++trial)
        EXPECT_TRUE(hold(random, springs(50, true), 16, SeriesEvaluator::Use::expansion, Places::some_are_one));
}

TEST(RepeatedCode, has_the_bits_of_the_lists_for_random_chains_that_are_interrupted) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(3);
    int with_code = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const Program program = random_chain(random, random.whole(200, 800), random.chance(0.3) ? 0.0 : 0.004);
        const auto use = random.chance(0.5) ? SeriesEvaluator::Use::any : SeriesEvaluator::Use::expansion;
        with_code += hold(random, program, random.whole(4, 24), use, Places::anywhere) ? 1 : 0;
        if (HasFailure()) return;
    }
    EXPECT_GT(with_code, 100);
}

TEST(RepeatedCode, is_kept_with_what_it_is_of) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = springs(400, true);
    constexpr int order = 18;
    std::vector<double> x(at(program.inputs()), 0.0), first;
    for (int i = 0; i < program.inputs() / 2; i += 3) x[at(i)] = 1.25 * (i / 3);
    const auto use = SeriesEvaluator::Use::expansion;
    {
        const BorrowedSeries series(program, order, use);
        first = expanded(*series, x, 0.75, order, true);
        for (int i = 0; i < 8; ++i) expanded(*series, x, 1.0, order, true);
        ASSERT_TRUE(series->has_repeated_code());
    }
    // not by one who may ask for single orders
    const BorrowedSeries other(program, order), again(program, order, use);
    EXPECT_FALSE(other->has_repeated_code());
    ASSERT_TRUE(again->has_repeated_code());
    const std::vector<double> second = expanded(*again, x, 0.75, order, true);
    EXPECT_TRUE(std::ranges::equal(first, second, test::are_same));
}

TEST(RepeatedCode, goes_on_where_one_order_is_asked_for_after_the_other) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = springs(60, false);
    constexpr int order = 18;
    SeriesEvaluator together(program, order), apart(program, order);
    together.use_machine_code(true);
    apart.use_machine_code(true);
    std::vector<double> x(at(program.inputs()));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + 3.0 * static_cast<double>(i));
    const std::vector<double> expected = expanded(together, x, 0.75, order, true);
    expanded(apart, x, 0.5, order, true);
    std::vector<double> parameters(at(program.parameters()), 0.0);
    parameters.front() = 0.75;
    apart.set_parameters(parameters);
    apart.begin(0.25, 0.125);
    for (std::size_t i = 0; i < x.size(); ++i) apart.set_input(static_cast<int>(i), 0, x[i]);
    for (int k = 0; k < order; ++k) {
        apart.advance(k);
        apart.integrate(k);
    }
    apart.advance(order);
    ASSERT_TRUE(together.has_repeated_code() && apart.has_repeated_code());
    for (int slot = 0; slot < program.slots(); ++slot)
        for (int k = 0; k <= order; ++k)
            ASSERT_TRUE(test::are_same(apart.coefficients(slot)[k], expected[at(slot * (order + 1) + k)])) << slot;
}

}  // namespace
}  // namespace rbdyn::test_repeated_code
