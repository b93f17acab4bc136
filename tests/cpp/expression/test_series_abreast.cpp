// Series of several motions abreast: those that each motion has alone, bit for bit, on every processor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "expression/programs.hpp"
#include "random.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/gradient.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/series_abreast.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/wide_series.hpp"
#include "rbdyn/series/abreast.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/step_length.hpp"

#ifdef RBDYN_HAS_LANES
namespace rbdyn::test::test_series_abreast {
namespace {

using E = Expression;

struct Alone {
    double t, unit;
    std::vector<double> x, parameters;
};

/// A motion by itself; with guards, coefficient `order` of everything.
void expand(SeriesEvaluator& series, const Alone& motion, int order, bool has_guards) {
    series.set_parameters(motion.parameters);
    series.begin(motion.t, motion.unit);
    for (std::size_t i = 0; i < motion.x.size(); ++i) series.set_input(static_cast<int>(i), 0, motion.x[i]);
    series.expand(order, has_guards);
}

std::vector<Alone> motions(Random& random, const Program& program, int count) {
    std::vector<Alone> all;
    for (int i = 0; i < count; ++i) {
        // the other parameter says of the norm that it begins at zero
        std::vector<double> parameters(static_cast<std::size_t>(program.parameters()), 0.0);
        parameters[0] = random.uniform(0.5, 2.0);
        all.push_back({random.uniform(-1.0, 1.0),
                       std::exp2(random.whole(-8, 1)),
                       {random.uniform(-1.5, 1.5), random.uniform(0.1, 1.5), random.uniform(-1.5, 1.5)},
                       parameters});
    }
    return all;
}

bool are_same(const double* a, const double* b, int count) {
    return std::memcmp(a, b, static_cast<std::size_t>(count) * sizeof(double)) == 0;
}

TEST(SeriesEvaluator, has_the_same_bits_on_every_processor_and_order_by_order) {
    const Program program = everything();
    Random random(2);
    for (int order = 12; order <= 24; ++order)
        for (const Alone& motion : motions(random, program, 20)) {
            SeriesEvaluator here(program, order), everywhere(program, order), one_by_one(program, order);
            everywhere.go_without_lanes_of_four();
            expand(here, motion, order, true);
            expand(everywhere, motion, order, true);
            expand(one_by_one, motion, 0, false);
            for (int k = 0; k <= order; ++k) {
                one_by_one.advance(k);
                if (k < order) one_by_one.integrate(k);
            }
            for (int slot = 0; slot < program.slots(); ++slot)
                for (const SeriesEvaluator* other : {&everywhere, &one_by_one})
                    ASSERT_TRUE(are_same(here.coefficients(slot), other->coefficients(slot), order + 1)) << slot;
        }
}

TEST(SeriesEvaluator, is_what_32_digits_round_to) {
    const Program program = everything();
    constexpr int order = 20;
    Random random(3);
    for (const Alone& motion : motions(random, program, 40)) {
        SeriesEvaluator series(program, order), rounded(program, order);
        expand(series, motion, order, true);
        WideSeries wide(program, order);
        wide.set_parameters(motion.parameters);
        wide.expand(motion.t, motion.unit, std::vector<DoubleDouble>(motion.x.begin(), motion.x.end()));
        wide.give(rounded);
        for (int output = 0; output < program.outputs(); ++output) {
            // by the size that the coefficients have where the largest one has its like
            double size = 0.0, growth = 1e-3;
            for (int k = 0; k <= order; ++k) {
                const double c = std::abs(rounded.output(output)[k]);
                size = std::max(size, c);
                if (k > 0) growth = std::max(growth, std::pow(c, 1.0 / k));
            }
            for (int k = 0; k <= order; ++k)
                EXPECT_NEAR(series.output(output)[k], rounded.output(output)[k],
                            1e-11 * std::max(1.0, std::pow(growth, k)))
                    << output << ' ' << k;
            EXPECT_NEAR(series.output(output)[0], rounded.output(output)[0], 1e-14 * std::max(1.0, size));
        }
    }
}

TEST(Gradient, of_every_instruction_is_the_jacobian) {
    const Program program = everything();
    Random random(4);
    GradientEvaluator gradients(program);
    JacobianEvaluator jacobian(program);
    for (const Alone& motion : motions(random, program, 20)) {
        gradients.set_parameters(motion.parameters);
        jacobian.set_parameters(motion.parameters);
        gradients(motion.t, motion.x);
        jacobian.differentiate(motion.t, motion.x);
        for (int output = 0; output < program.outputs(); ++output) {
            std::vector<double> found(3, 0.0);
            for (const auto& [slot, slope] : gradients.gradient(output))
                if (slot < 3) found[static_cast<std::size_t>(slot)] += slope;
            for (int i = 0; i < 3; ++i) {
                const double known = jacobian.derivative(output, i);
                EXPECT_NEAR(found[static_cast<std::size_t>(i)], known, 1e-13 * std::max(1.0, std::abs(known)));
            }
        }
    }
}

TEST(SeriesAbreast, have_the_bits_of_each_motion_alone_on_every_processor) {
    const Program program = everything();
    std::set<Code> codes;
    for (const Instruction& i : program.instructions()) codes.insert(i.code);
    EXPECT_EQ(codes.size(), 15U) << program.text();  // all but calls
    Random random(1);
    int steps_found = 0;
    for (const SeriesAbreast::Processor processor : SeriesAbreast::processors())
        for (const int order : {12, 13, 20, 24}) {
            SeriesAbreast abreast(program, order, processor);
            for (int trial = 0; trial < 40; ++trial) {
                // lanes to spare, too; guards or none, one after the other
                const std::vector<Alone> all = motions(random, program, random.whole(1, abreast.width()));
                const bool has_guards = trial % 3 != 0;
                std::vector<std::unique_ptr<SeriesEvaluator>> alone;
                std::vector<SeriesAbreast::Motion> lanes;
                for (const Alone& motion : all) {
                    alone.push_back(std::make_unique<SeriesEvaluator>(program, order));
                    expand(*alone.back(), motion, order, has_guards);
                    lanes.push_back({motion.t, motion.unit, motion.x, alone.back()->weights()});
                }
                abreast.expand(lanes, has_guards);
                std::vector<std::unique_ptr<SeriesEvaluator>> given;
                std::vector<SeriesEvaluator*> to;
                std::vector<double> scales, log_tolerances, places;
                for (std::size_t i = 0; i < all.size(); ++i) {
                    given.push_back(std::make_unique<SeriesEvaluator>(program, order));
                    to.push_back(given.back().get());
                    scales.push_back(random.uniform(0.0, 2.0));
                    log_tolerances.push_back(random.uniform(-50.0, -10.0));
                    places.push_back(random.uniform(0.1, 1.5));
                }
                abreast.give_states(to);
                abreast.find_increments(places);
                for (const int count : {2, 3}) abreast.find_log_steps(3 - count, count, scales, log_tolerances);
                for (std::size_t i = 0; i < all.size(); ++i) {
                    ASSERT_TRUE(abreast.is_good(static_cast<int>(i)));
                    SeriesEvaluator all_of_it(program, order), &some = *given[i];
                    abreast.give_all(static_cast<int>(i), all_of_it, has_guards);
                    const std::vector<int> last = {program.output(6)};
                    abreast.give(static_cast<int>(i), some, last, has_guards);
                    for (int slot = 0; slot < program.slots(); ++slot)
                        ASSERT_TRUE(are_same(all_of_it.coefficients(slot), alone[i]->coefficients(slot), order + 1))
                            << slot;
                    for (int slot = 0; slot < 3; ++slot)
                        ASSERT_TRUE(are_same(some.coefficients(slot), alone[i]->coefficients(slot), order + 1));
                    // what they add up to at the end of a step
                    std::vector<double> powers{places[i]};
                    while (powers.size() < static_cast<std::size_t>(order)) powers.push_back(powers.back() * places[i]);
                    for (int slot = 0; slot < 3; ++slot) {
                        const double sum = series::dot(alone[i]->coefficients(slot) + 1, powers.data(), order),
                                     found = abreast.increment(static_cast<int>(i), slot);
                        ASSERT_TRUE(are_same(&found, &sum, 1)) << order;
                    }
                    // of two and of all three together, and zeros with their signs
                    for (const int count : {2, 3}) {
                        const auto rows = static_cast<std::size_t>(order + 1);
                        std::vector<double> ours(rows), theirs(rows), one_by_one(rows);
                        abreast.sizes(static_cast<int>(i), 3 - count, count, ours.data());
                        series::sizes(theirs.data(), alone[i]->rows(3 - count, count), alone[i]->stride(), count,
                                      order);
                        for (int slot = 3 - count; slot < 3; ++slot)
                            series::widen(one_by_one.data(), alone[i]->coefficients(slot), order);
                        ASSERT_TRUE(are_same(ours.data(), theirs.data(), order + 1));
                        ASSERT_TRUE(are_same(ours.data(), one_by_one.data(), order + 1));
                        // how long a step may be by them
                        const double length = series::log_step(theirs.data(), order, scales[i], log_tolerances[i]);
                        if (const auto found = abreast.log_step(static_cast<int>(i), 3 - count, count)) {
                            ASSERT_TRUE(are_same(&*found, &length, 1)) << order;
                            ++steps_found;
                        }
                    }
                    ASSERT_TRUE(are_same(some.output(6), alone[i]->output(6), order + 1));
                    for (const int k : {0, order - 1}) {
                        ASSERT_TRUE(some.is_finite(k));
                        for (int rate = 0; rate < 3; ++rate) ASSERT_EQ(some.output(rate)[k], alone[i]->output(rate)[k]);
                    }
                }
            }
        }
    EXPECT_GT(steps_found, 1000);
}

TEST(SeriesAbreast, say_of_one_motion_that_it_is_to_be_computed_alone_and_have_the_others) {
    Recorder r;
    const E x = r.input(0), y = r.input(1);
    const Program program(r, std::vector<E>{length({x, y, 0.0 * x}) + 1.0, 1.0 / (x - 2.0)}, 2);
    for (const SeriesAbreast::Processor processor : SeriesAbreast::processors()) {
        SeriesAbreast abreast(program, 12, processor);
        // a norm that begins at zero, a pole, one that is fine
        const std::vector<Alone> all = {
            {0.0, 0.5, {0.0, 0.0}, {}}, {0.0, 0.5, {2.0, 1.0}, {}}, {0.0, 0.5, {1.0, 1.0}, {}}};
        std::vector<std::unique_ptr<SeriesEvaluator>> alone;
        std::vector<SeriesAbreast::Motion> lanes;
        for (Alone motion : all) {
            motion.parameters.assign(static_cast<std::size_t>(program.parameters()), 0.0);
            alone.push_back(std::make_unique<SeriesEvaluator>(program, 12));
            expand(*alone.back(), motion, 12, false);
        }
        for (std::size_t i = 0; i < all.size(); ++i) lanes.push_back({0.0, 0.5, all[i].x, alone[i]->weights()});
        abreast.expand(lanes, false);
        EXPECT_FALSE(abreast.is_good(0));
        EXPECT_FALSE(abreast.is_good(1));
        ASSERT_TRUE(abreast.is_good(2));
        // and the next time again
        const std::vector<SeriesAbreast::Motion> other = {lanes[2], lanes[0]};
        abreast.expand(other, false);
        EXPECT_TRUE(abreast.is_good(0));
        EXPECT_FALSE(abreast.is_good(1));
        SeriesEvaluator given(program, 12);
        abreast.give_all(0, given, false);
        for (int slot = 0; slot < program.slots(); ++slot)
            EXPECT_TRUE(are_same(given.coefficients(slot), alone[2]->coefficients(slot), 12)) << slot;
    }
}

TEST(SeriesAbreast, fit_programs_of_the_same_instructions_with_other_numbers_in_them) {
    const auto oscillator = [](double stiffness, double extra) {
        Recorder r;
        const E x = r.input(0), v = r.input(1);
        std::vector<E> outputs = {v, -stiffness * x * x - 0.1 * v};
        if (extra != 0.0) outputs[1] = outputs[1] + extra * x * v;
        return Program(r, outputs, 2);
    };
    const Program program = oscillator(3.0, 0.0);
    const SeriesAbreast abreast(program, 16);
    EXPECT_TRUE(abreast.fits(program, 16));
    EXPECT_TRUE(abreast.fits(oscillator(7.0, 0.0), 16));
    EXPECT_FALSE(abreast.fits(program, 17));
    EXPECT_FALSE(abreast.fits(oscillator(3.0, 1.0), 16));
    EXPECT_FALSE(abreast.fits(everything(), 16));
}

TEST(SeriesAbreast, leave_a_norm_that_begins_at_zero_to_its_motion_alone) {
    Recorder r;
    const Expression x = r.input(0), y = r.input(1);
    const Expression outputs[] = {1.0 + 0.0 * y, length({x, y, 0.5 * x})};
    const Program program(r, outputs, 2);
    ASSERT_EQ(program.parameters(), 1);
    constexpr int order = 12;
    SeriesEvaluator alone(program, order), zero(program, order);
    const double none[] = {0.0}, first[] = {1.0}, at_zero[] = {0.0, 0.0}, rounded[] = {1e-17, 0.0},
                 beside[] = {0.5, 0.25};
    alone.set_parameters(none);
    zero.set_parameters(first);
    for (const SeriesAbreast::Processor processor : SeriesAbreast::processors()) {
        SeriesAbreast abreast(program, order, processor);
        const std::vector<SeriesAbreast::Motion> both{
            {0.0, 1.0, beside, alone.weights()},
            {0.0, 1.0, at_zero, zero.weights()},
            // that its state is zero but for rounding is for its parameter to say
            {0.0, 1.0, rounded, zero.weights()}};
        abreast.expand(both, true);
        EXPECT_FALSE(abreast.is_good(2));
        EXPECT_TRUE(abreast.is_good(0));
        EXPECT_FALSE(abreast.is_good(1));
    }
}

TEST(SeriesAbreast, tell_programs_apart_that_differ_in_a_term) {
    const auto program = [](double a, bool is_last) {
        Recorder r;
        const Expression x = r.input(0), y = r.input(1), z = r.input(2);
        const Expression outputs[] = {a * x + 3.0 * (is_last ? z : y) + 1.0, sin(x) * y, z * y};
        return Program(r, outputs, 3);
    };
    const SeriesAbreast abreast(program(2.0, false), 12);
    EXPECT_TRUE(abreast.fits(program(2.0, false), 12));
    EXPECT_FALSE(abreast.fits(program(2.0, false), 13));
    EXPECT_FALSE(abreast.fits(program(2.0, true), 12));
    // numbers are each motion's own
    EXPECT_TRUE(abreast.fits(program(4.0, false), 12));
}

}  // namespace
}  // namespace rbdyn::test::test_series_abreast
#endif
