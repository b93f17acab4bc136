// One step of Dormand and Prince's method: the same bits in lanes of two and of four, with machine code and without.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "expression/programs.hpp"
#include "random.hpp"
#include "rbdyn/engine/dop853_step.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::test_dop853_step {
namespace {

using test::are_same;
using test::Random;
using Doubles = Dop853Step::Doubles;

/// All that a step gives.
struct Result {
    bool is_there = false, is_interpolated = false;
    std::vector<double> numbers;
};

struct Kind {
    bool wide, by_code, asks_each;
};

Result result(const Program& program, const std::vector<double>& parameters, const std::vector<double>& state, double h,
              const Kind& kind) {
    Evaluator<double> equations(program, parameters);
    equations.use_machine_code(kind.by_code);
    const auto n = state.size();
    Dop853Step step;
    if (!kind.wide) step.go_without_lanes_of_four();
    step.follow(equations, kind.asks_each, static_cast<int>(n));
    const std::size_t padded = Dop853Step::padded(n);
    Doubles x(padded, 0.0), low = x, slope = x, next_x = x, next_low = x, next_slope = x;
    std::copy(state.begin(), state.end(), x.begin());
    for (std::size_t i = 0; i < n; ++i) low[i] = 1e-17 * x[i];
    equations.rates(0.5, state, slope.data());
    const Dop853Step::Start start{{0.5, 1e-18}, x.data(), low.data(), slope.data()};
    Result all;
    const auto take = [&](auto values) { all.numbers.insert(all.numbers.end(), values, values + n); };
    all.is_there = step.attempt(start, h);
    if (!all.is_there) return all;
    take(step.end());
    for (std::size_t i = 0; i < n; ++i) {
        all.numbers.push_back(step.fifth(static_cast<int>(i)));
        all.numbers.push_back(step.third(static_cast<int>(i)));
    }
    all.is_interpolated = step.interpolate(start, h);
    if (!all.is_interpolated) return all;
    for (std::size_t i = 0; i < n; ++i) all.numbers.push_back(step.defect(static_cast<int>(i)));
    const auto& rows = step.coefficients();
    all.numbers.insert(all.numbers.end(), rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(n * 8));
    step.finish(start, h, next_x.data(), next_low.data(), next_slope.data());
    for (const Doubles* v : {&next_x, &next_low, &next_slope}) take(v->data());
    EXPECT_EQ(step.evaluations(), 16);
    if (step.go(start, 0.375 * h)) take(step.end());
    return all;
}

TEST(Dop853Step, has_the_same_bits_in_lanes_of_two_and_of_four_with_machine_code_and_without) {
    Random random(3);
    int finite = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const int inputs = random.whole(1, 9);
        const Program program = test::random_program(random, inputs);
        std::vector<double> state, parameters(static_cast<std::size_t>(program.parameters()), 0.75);
        for (int i = 0; i < inputs; ++i) state.push_back(random.chance(0.1) ? 0.0 : random.uniform(-1.5, 1.5));
        // at times far too long, so that slopes are no numbers
        const double h = random.chance(0.2) ? 1e100 : random.logarithmic(1e-3, 1.0);
        const Result first = result(program, parameters, state, h, {false, false, true});
        finite += first.is_interpolated ? 1 : 0;
        for (const Kind& kind : {Kind{false, false, false}, Kind{true, false, false}, Kind{true, false, true},
                                 Kind{true, test::is_made(), false}, Kind{false, test::is_made(), true}}) {
            const Result other = result(program, parameters, state, h, kind);
            ASSERT_EQ(other.is_there, first.is_there);
            ASSERT_EQ(other.is_interpolated, first.is_interpolated);
            ASSERT_EQ(other.numbers.size(), first.numbers.size());
            for (std::size_t i = 0; i < first.numbers.size(); ++i)
                ASSERT_TRUE(are_same(other.numbers[i], first.numbers[i])) << i << " of " << first.numbers.size();
        }
    }
    EXPECT_GT(finite, 100);
}

TEST(Dop853Step, is_no_step_where_a_slope_on_the_way_is_no_number) {
    // of a variable that nothing depends on, at one stage alone: c = 0.25 of the step
    Recorder r;
    const Program program(r, std::vector<Expression>{1.0 / (r.time() - 0.75), r.input(1)}, 2);
    for (const bool wide : {false, true})
        for (const bool asks_each : {false, true})
            EXPECT_FALSE(result(program, {}, {0.0, 1.0}, 1.0, {wide, false, asks_each}).is_there);
}

}  // namespace
}  // namespace rbdyn::test_dop853_step
