// Evaluators of series that programs keep: whoever borrows one has it as if it were new.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::test_kept_series {
namespace {

constexpr int order = 20;

Program pendulum() {
    Recorder r;
    const Expression angle = r.input(0), rate = r.input(1);
    return Program(r, std::vector<Expression>{rate, -9.81 * sin(angle) - 0.5 * rate * rate / (angle + 4.0)}, 2);
}

std::vector<double> expanded(SeriesEvaluator& series, double angle, int to) {
    series.set_parameters({});
    series.begin(0.0, 0.25);
    series.set_input(0, 0, angle);
    series.set_input(1, 0, 0.5);
    series.expand(to, to == order);
    std::vector<double> all;
    for (int slot = 0; slot < series.program().slots(); ++slot)
        all.insert(all.end(), series.coefficients(slot), series.coefficients(slot) + order + 1);
    return all;
}

TEST(KeptSeries, are_as_new_whatever_they_computed_before) {
    const Program program = pendulum();
    SeriesEvaluator made(program, order);
    // less than all of it: what is left of what came before would show
    const std::vector<double> fresh = expanded(made, 1.0, order - 2);
    const SeriesEvaluator* first = nullptr;
    {
        const BorrowedSeries one(program, order);
        first = &*one;
        expanded(*one, -0.75, order);
    }
    const BorrowedSeries again(program, order);
    EXPECT_EQ(&*again, first);
    const std::vector<double> second = expanded(*again, 1.0, order - 2);
    EXPECT_EQ(std::memcmp(second.data(), fresh.data(), fresh.size() * sizeof(double)), 0);
}

TEST(KeptSeries, are_lent_to_one_at_a_time_of_their_own_order_and_program) {
    const Program program = pendulum();
    const SeriesEvaluator* first = nullptr;
    {
        const BorrowedSeries one(program, order), other(program, order);
        first = &*one;
        EXPECT_NE(&*one, &*other);
    }
    const Program copy = program;
    const BorrowedSeries longer(program, order + 1), of_copy(copy, order);
    EXPECT_NE(&*longer, first);
    EXPECT_EQ(&longer->program(), &program);
    EXPECT_EQ(&of_copy->program(), &copy);
}

}  // namespace
}  // namespace rbdyn::test_kept_series
