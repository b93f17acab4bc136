// Machine code made for a program: the series that its lists give, bit for bit, zeros with their signs.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "expression/programs.hpp"
#include "random.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/machine_code.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::test_machine_code {
namespace {

using E = Expression;
using test::are_same;
using test::everything;
using test::is_made;
using test::Random;
using test::random_program;

struct Start {
    double t, unit;
    std::vector<double> x, parameters;
};

/// All coefficients that the evaluator has; `whole`: of the last order too, which comes by itself.
std::vector<double> expanded(SeriesEvaluator& series, const Start& start, int order, bool whole) {
    series.set_parameters(start.parameters);
    series.begin(start.t, start.unit);
    for (std::size_t i = 0; i < start.x.size(); ++i) series.set_input(static_cast<int>(i), 0, start.x[i]);
    series.expand(order, whole);
    std::vector<double> all;
    for (int slot = 0; slot < series.program().slots(); ++slot)
        all.insert(all.end(), series.coefficients(slot), series.coefficients(slot) + series.stride());
    return all;
}

bool are_same(const std::vector<double>& a, const std::vector<double>& b) {
    return std::ranges::equal(a, b, [](double x, double y) { return are_same(x, y); });
}

/// The same from several starts, one after the other.
void hold(const Program& program, int order, const std::vector<Start>& starts) {
    SeriesEvaluator by_code(program, order), by_lists(program, order);
    by_code.use_machine_code(true);
    by_lists.use_machine_code(false);
    bool whole = false;
    for (const Start& start : starts) {
        const std::vector<double> ours = expanded(by_code, start, order, whole),
                                  theirs = expanded(by_lists, start, order, whole);
        for (std::size_t i = 0; i < ours.size(); ++i)
            ASSERT_TRUE(are_same(ours[i], theirs[i]))
                << "slot " << i / static_cast<std::size_t>(by_code.stride()) << ", "
                << i % static_cast<std::size_t>(by_code.stride()) << " of order " << order << ": " << ours[i]
                << " and not " << theirs[i] << "\n"
                << program.text();
        whole = !whole;
    }
    ASSERT_TRUE(by_code.has_machine_code());
    ASSERT_FALSE(by_lists.has_machine_code());
}

std::vector<Start> starts(Random& random, const Program& program, int count) {
    std::vector<Start> all;
    for (int n = 0; n < count; ++n) {
        Start s{random.uniform(-1.0, 1.0), std::exp2(random.whole(-8, 1)), {}, {}};
        // what is zero, of either sign, stays so in many slots
        for (int i = 0; i < program.inputs(); ++i)
            s.x.push_back(random.chance(0.25) ? (random.chance(0.5) ? 0.0 : -0.0) : random.uniform(-1.5, 1.5));
        // parameters of norms say that they begin at zero
        s.parameters.assign(static_cast<std::size_t>(program.parameters()), 0.0);
        s.parameters[0] = random.uniform(0.5, 2.0);
        all.push_back(s);
    }
    return all;
}

TEST(MachineCode, has_the_bits_of_the_lists_for_every_instruction_and_order) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = everything();
    Random random(1);
    for (int order = 2; order <= 26; ++order) hold(program, order, starts(random, program, 20));
}

TEST(MachineCode, has_the_bits_of_the_lists_for_random_programs) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(2);
    for (int trial = 0; trial < 300; ++trial) {
        const Program program = random_program(random, random.whole(1, 6));
        hold(program, random.whole(5, 24), starts(random, program, 8));
        if (HasFatalFailure()) return;
    }
}

// an even order by itself goes on with what the one before it has left
TEST(MachineCode, has_the_bits_of_the_lists_when_orders_are_asked_for_one_by_one_and_again) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(11);
    for (int trial = 0; trial < 60; ++trial) {
        const Program program = random_program(random, random.whole(1, 6));
        const int order = random.whole(5, 24);
        SeriesEvaluator by_code(program, order), by_lists(program, order);
        by_code.use_machine_code(true);
        by_lists.use_machine_code(false);
        for (const Start& start : starts(random, program, 3)) {
            for (SeriesEvaluator* series : {&by_code, &by_lists}) {
                series->set_parameters(start.parameters);
                series->begin(start.t, start.unit);
                for (std::size_t i = 0; i < start.x.size(); ++i) series->set_input(static_cast<int>(i), 0, start.x[i]);
            }
            for (int k = 0; k <= order; ++k) {
                const int times = random.whole(1, 2);
                for (SeriesEvaluator* series : {&by_code, &by_lists}) {
                    for (int i = 0; i < times; ++i) series->advance(k);
                    if (k < order) series->integrate(k);
                }
                for (int slot = 0; slot < program.slots(); ++slot)
                    ASSERT_TRUE(are_same(by_code.coefficients(slot)[k], by_lists.coefficients(slot)[k]))
                        << trial << " " << slot << " " << k << "\n"
                        << program.text();
            }
        }
    }
}

TEST(MachineCode, has_the_bits_of_the_lists_from_order_0_on_where_nothing_can_overflow) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Recorder r;
    const E x = r.input(0), y = r.input(1), z = r.input(2), p = r.parameter(r.new_parameter());
    std::vector<E> outputs = {p * y * z - 0.3 * x * sin(x) + 0.1 * r.time() - 0.5,
                              cos(z) * sqrt(x * x + 2.0) - x / (y * y + 1.0) + 0.25 * (x * x + y * y),
                              log(x * x + 1.5) - 0.5 * z + p * x * y + recording::angle(y, x + 4.0)};
    outputs.push_back(length({x, y, z}) + atanh(0.2 * x) + 1.25);
    outputs.push_back(outputs[0] / (outputs[1] * outputs[1] + 3.0));
    const Program program(r, outputs, 3);
    ASSERT_FALSE(SeriesEvaluator::may_overflow(program));
    Random random(5);
    for (int order = 2; order <= 26; ++order) hold(program, order, starts(random, program, 20));
}

TEST(MachineCode, leaves_what_grows_beyond_the_largest_double_to_the_lists) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Recorder r;
    const E x = r.input(0), y = r.input(1);
    const Program program(r, std::vector<E>{y, -x / (1.0 + exp(x * x))}, 2);
    hold(program, 20, {{0.0, 0.5, {0.1, 1.0}, {}}, {0.0, 0.5, {40.0, 1.0}, {}}, {0.0, 0.5, {0.2, 1.0}, {}}});
}

TEST(MachineCode, is_made_when_it_pays_once_and_kept) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = everything();
    const Start start{0.0, 0.25, {0.5, 0.25, -0.5}, {1.0, 0.0}};
    std::vector<double> first;
    {
        const BorrowedSeries series(program, 20);
        first = expanded(*series, start, 20, true);
        for (int i = 1; i < MachineCode::expansions; ++i) expanded(*series, start, 20, true);
        EXPECT_FALSE(series->has_machine_code());
        EXPECT_TRUE(are_same(expanded(*series, start, 20, true), first));
        EXPECT_TRUE(series->has_machine_code());
    }
    const BorrowedSeries again(program, 20);
    EXPECT_TRUE(again->has_machine_code());
    EXPECT_TRUE(are_same(expanded(*again, start, 20, true), first));
}

TEST(MachineCode, is_made_by_kinds_of_stages_of_what_is_too_long_to_pay) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Recorder r;
    std::vector<E> rates;
    const int count = 300;
    for (int i = 0; i < count; ++i) {
        E sum = 0.0;
        // rates that are no repetition of others
        const int products = std::sin(i * i) > 0.0 ? 7 : 6;
        for (int j = 1; j <= products; ++j) sum = sum + (0.5 + i + j) * r.input(i) * r.input((i + j) % count);
        rates.push_back(sum);
    }
    const Program program(r, rates, count);
    const Start start{0.0, 1.0, std::vector<double>(count, 1e-3), {}};
    SeriesEvaluator series(program, 24), by_lists(program, 24);
    series.use_machine_code(true);
    const auto found = expanded(series, start, 24, true);
    EXPECT_TRUE(series.has_streamed_code());
    EXPECT_FALSE(series.has_repeated_code());
    EXPECT_TRUE(are_same(found, expanded(by_lists, start, 24, true)));
}

}  // namespace
}  // namespace rbdyn::test_machine_code
