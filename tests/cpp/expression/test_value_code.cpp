// Machine code made for a program's values: those that its lists give, bit for bit, zeros with their signs.
#include <gtest/gtest.h>

#include <iterator>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "expression/programs.hpp"
#include "random.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/value_code.hpp"

namespace rbdyn::test_value_code {
namespace {

using E = Expression;
using test::are_same;
using test::Random;

/// What a motion may come to, and what it may not.
double some(Random& random) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    constexpr double special[] = {0.0,
                                  -0.0,
                                  1.0,
                                  -1.0,
                                  infinity,
                                  -infinity,
                                  std::numeric_limits<double>::quiet_NaN(),
                                  std::numeric_limits<double>::denorm_min(),
                                  -0x1p-1040,
                                  0x1p1000,
                                  -0x1p-600};
    if (random.chance(0.4)) return special[random.whole(0, static_cast<int>(std::size(special)) - 1)];
    return random.uniform(-2.0, 2.0);
}

/// All slots and rates at many points, most of them zero or no number in part.
void hold(const Program& program, Random& random, int points) {
    Evaluator<double> by_code(program), by_lists(program);
    by_code.use_machine_code(true);
    by_lists.use_machine_code(false);
    ASSERT_TRUE(by_code.has_machine_code());
    ASSERT_FALSE(by_lists.has_machine_code());
    const auto inputs = static_cast<std::size_t>(program.inputs());
    const bool has_rates = program.outputs() >= program.inputs();
    std::vector<double> x(inputs), ours(ValueCode::padded(inputs), -1.0),
        theirs = ours, parameters(static_cast<std::size_t>(program.parameters()));
    for (int point = 0; point < points; ++point) {
        const bool is_plain = point % 2 == 0;
        const auto one = [&] { return is_plain ? random.uniform(-2.0, 2.0) : some(random); };
        for (double& value : x) value = one();
        for (double& value : parameters) value = one();
        by_code.set_parameters(parameters);
        by_lists.set_parameters(parameters);
        const double t = one();
        if (has_rates) {
            by_code.rates(t, x, ours.data());
            by_lists.rates(t, x, theirs.data());
        } else {
            by_code(t, x);
            by_lists(t, x);
        }
        for (int slot = 0; slot < program.slots(); ++slot)
            ASSERT_TRUE(are_same(by_code.slot(slot), by_lists.slot(slot)))
                << "slot " << slot << " at point " << point << ": " << by_code.slot(slot) << " and not "
                << by_lists.slot(slot) << "\n"
                << program.text();
        for (std::size_t i = 0; i < ours.size(); ++i) ASSERT_TRUE(are_same(ours[i], theirs[i])) << "rate " << i;
    }
}

TEST(ValueCode, has_the_bits_of_the_lists_for_every_instruction) {
    if (!test::is_made()) GTEST_SKIP() << "no machine code here";
    Random random(1);
    hold(test::everything(), random, 2000);
    // each by itself, of inputs at once
    for (int which = 0; which < 12; ++which) {
        Recorder r;
        const E x = r.input(0), y = r.input(1), z = r.input(2), p = r.parameter(r.new_parameter());
        const std::vector<E> each{
            x / y,  sqrt(x), length({x, y, z}), sin(x) * cos(x),        sinh(x) + cosh(y), tanh(x),
            log(x), exp(y),  pow(x, 0.3),       recording::angle(x, y), p - x + y * z,     r.time() * x - p};
        hold(Program(r, std::vector<E>{each[static_cast<std::size_t>(which)], y, -x}, 3), random, 500);
        if (HasFatalFailure()) return;
    }
}

TEST(ValueCode, has_the_bits_of_the_lists_for_random_programs) {
    if (!test::is_made()) GTEST_SKIP() << "no machine code here";
    Random random(2);
    for (int trial = 0; trial < 300; ++trial) {
        hold(test::random_program(random, random.whole(1, 9)), random, 40);
        if (HasFatalFailure()) return;
    }
}

TEST(ValueCode, is_made_when_it_pays_and_kept_for_all_evaluators) {
    if (!test::is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = test::everything();
    const std::vector<double> x{0.5, 0.25, -0.5}, parameters(static_cast<std::size_t>(program.parameters()), 1.0);
    Evaluator<double> first(program, parameters);
    first(0.25, x);
    const double before = first.output(0);
    int made_after = 1;
    for (; made_after < 10 * ValueCode::evaluations && !first.has_machine_code(); ++made_after) first(0.25, x);
    EXPECT_EQ(made_after, ValueCode::evaluations);
    EXPECT_TRUE(are_same(first.output(0), before));
    Evaluator<double> second(program, parameters);
    EXPECT_TRUE(second.has_machine_code());
    second(0.25, x);
    EXPECT_TRUE(are_same(second.output(0), before));
    // a copy is another program
    const Program copy = program;
    EXPECT_FALSE(Evaluator<double>(copy, parameters).has_machine_code());
}

TEST(ValueCode, is_made_once_by_many_threads) {
    if (!test::is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = test::everything();
    const std::vector<double> x{0.5, 0.25, -0.5};
    std::vector<double> results(4);
    {
        std::vector<std::jthread> threads;
        for (double& result : results)
            threads.emplace_back([&] {
                Evaluator<double> values(program);
                for (int i = 0; i < 2 * ValueCode::evaluations; ++i) values(0.25, x);
                result = values.output(0);
            });
    }
    for (const double result : results) EXPECT_TRUE(are_same(result, results[0]));
    EXPECT_NE(program.kept_code().get(), nullptr);
}

TEST(ValueCode, is_not_made_of_what_is_too_long_to_pay) {
    Recorder r;
    std::vector<E> rates;
    const int count = 2000;
    for (int i = 0; i < count; ++i) {
        E sum = 0.0;
        for (int j = 1; j < 8; ++j) sum = sum + (0.5 + i + j) * r.input(i) * r.input((i + j) % count);
        rates.push_back(sum);
    }
    const Program program(r, rates, count);
    Evaluator<double> values(program);
    values.use_machine_code(true);
    EXPECT_FALSE(values.has_machine_code());
}

TEST(ValueCode, is_not_made_of_what_is_called_back) {
    const auto function = std::make_shared<Callback>();
    function->inputs = function->outputs = 1;
    function->function = [](const double*, double*) { throw 1; };
    Recorder r;
    const std::vector<E> arguments{r.input(0)};
    const Program program(r, r.call(function, arguments), 1);
    Evaluator<double> values(program);
    values.use_machine_code(true);
    EXPECT_FALSE(values.has_machine_code());
    // so that what is thrown gets through
    EXPECT_THROW(values(0.0, std::vector<double>{1.0}), int);
}

}  // namespace
}  // namespace rbdyn::test_value_code
