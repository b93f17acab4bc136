// Machine code made for series abreast: the coefficients that the lists give, bit for bit, zeros with their signs, in
// every lane.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "expression/programs.hpp"
#include "random.hpp"
#include "rbdyn/expression/abreast_code.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/series_abreast.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::test_abreast_code {
namespace {

using E = Expression;
using abreast::AbreastCode;
using test::are_same;
using test::everything;
using test::is_made;
using test::Random;
using test::random_program;
using Processor = SeriesAbreast::Processor;

/// Those of which there is code.
std::vector<Processor> processors() {
    std::vector<Processor> all = SeriesAbreast::processors();
    std::erase(all, Processor::any);
    return all;
}

/// Some motions, and what they refer to.
struct Motions {
    std::vector<std::vector<double>> states, weights;
    std::vector<SeriesAbreast::Motion> all;

    void add(const Program& program, double t, double unit, std::vector<double> x, double first) {
        states.push_back(std::move(x));
        // parameters of norms say that they begin at zero
        std::vector<double> parameters(static_cast<std::size_t>(program.parameters()), 0.0);
        if (!parameters.empty()) parameters[0] = first;
        SeriesEvaluator series(program, 4);
        series.set_parameters(parameters);
        weights.emplace_back(series.weights().begin(), series.weights().end());
        all.push_back({t, unit, states.back(), weights.back()});
    }
};

/// As many as there are lanes or fewer; what is zero, of either sign, stays so in many slots.
Motions some(Random& random, const Program& program, int count) {
    Motions m;
    for (int n = 0; n < count; ++n) {
        std::vector<double> x;
        for (int i = 0; i < program.inputs(); ++i)
            x.push_back(random.chance(0.25) ? (random.chance(0.5) ? 0.0 : -0.0) : random.uniform(-1.5, 1.5));
        m.add(program, random.uniform(-1.0, 1.0), std::exp2(random.whole(-8, 1)), x, random.uniform(0.5, 2.0));
    }
    return m;
}

/// All coefficients of all motions, those with a norm that begins at zero or without end among them.
void expect_same(SeriesAbreast& ours, SeriesAbreast& theirs, const Program& program, int order, const Motions& m,
                 bool whole) {
    ours.expand(m.all, whole);
    theirs.expand(m.all, whole);
    for (std::size_t i = 0; i < m.all.size(); ++i) {
        const auto motion = static_cast<int>(i);
        EXPECT_EQ(ours.is_good(motion), theirs.is_good(motion));
        SeriesEvaluator a(program, order), b(program, order);
        ours.give_all(motion, a, whole);
        theirs.give_all(motion, b, whole);
        for (int slot = 0; slot < program.slots(); ++slot)
            for (int k = 0; k <= order; ++k)
                ASSERT_TRUE(are_same(a.coefficients(slot)[k], b.coefficients(slot)[k]))
                    << "slot " << slot << ", " << k << " of order " << order << " in " << ours.width()
                    << " lanes: " << a.coefficients(slot)[k] << " and not " << b.coefficients(slot)[k] << "\n"
                    << program.text();
    }
}

void hold(Random& random, const Program& program, int order, int trials) {
    for (const Processor processor : processors()) {
        SeriesAbreast by_code(program, order, processor), by_lists(program, order, processor);
        by_code.use_machine_code(true);
        by_lists.use_machine_code(false);
        for (int trial = 0; trial < trials; ++trial) {
            const Motions m = some(random, program, random.whole(1, by_code.width()));
            expect_same(by_code, by_lists, program, order, m, trial % 2 == 0);
            if (testing::Test::HasFatalFailure()) return;
        }
        ASSERT_TRUE(by_code.has_machine_code());
        ASSERT_FALSE(by_lists.has_machine_code());
    }
}

TEST(AbreastCode, has_the_bits_of_the_lists_for_every_instruction_and_order) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(1);
    const Program program = everything();
    for (int order = 2; order <= 26; ++order) hold(random, program, order, 8);
}

TEST(AbreastCode, has_the_bits_of_the_lists_for_random_programs) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(2);
    for (int trial = 0; trial < 300; ++trial) {
        const Program program = random_program(random, random.whole(1, 6));
        if (SeriesAbreast::takes(program)) hold(random, program, random.whole(5, 24), 4);
        if (HasFatalFailure()) return;
    }
}

TEST(AbreastCode, leaves_to_the_lists_what_is_one_here_and_another_number_in_a_motion) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    const auto oscillator = [](double stiffness, double damping) {
        Recorder r;
        const E x = r.input(0), v = r.input(1);
        return Program(r, std::vector<E>{v, -stiffness * x - damping * v + x * v}, 2);
    };
    const Program program = oscillator(1.0, 0.5), other = oscillator(7.0, 1.0);
    for (const Processor processor : processors()) {
        SeriesAbreast series(program, 16, processor);
        ASSERT_TRUE(series.fits(other, 16));
        series.use_machine_code(true);
        Motions m;
        m.add(program, 0.0, 0.5, {0.3, 0.7}, 0.0);
        for (const bool are_alike : {true, false, true}) {
            Motions now = m;
            if (!are_alike) now.add(other, 0.0, 0.5, {0.2, -0.4}, 0.0);
            for (std::size_t i = 0; i < now.all.size(); ++i) {
                now.all[i].state = now.states[i];
                now.all[i].weights = now.weights[i];
            }
            series.expand(now.all, false);
            for (std::size_t i = 0; i < now.all.size(); ++i) {
                const Program& own = i == 0 ? program : other;
                SeriesEvaluator alone(own, 16), given(own, 16);
                alone.set_parameters({});
                alone.begin(0.0, 0.5);
                for (int k = 0; k < 2; ++k) alone.set_input(k, 0, now.states[i][static_cast<std::size_t>(k)]);
                alone.expand(16, false);
                series.give_all(static_cast<int>(i), given, false);
                for (int slot = 0; slot < own.slots(); ++slot)
                    for (int k = 0; k < 16; ++k)
                        ASSERT_EQ(given.coefficients(slot)[k], alone.coefficients(slot)[k]) << slot << ' ' << k;
            }
        }
        EXPECT_TRUE(series.has_machine_code());
    }
}

TEST(AbreastCode, is_made_when_it_pays_and_kept) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = everything();
    for (const Processor processor : processors()) {
        SeriesAbreast series(program, 20, processor);
        Random random(3);
        const Motions m = some(random, program, 3);
        for (int i = 0; i < AbreastCode::expansions; ++i) series.expand(m.all, true);
        EXPECT_FALSE(series.has_machine_code());
        for (int i = 0; i < 2; ++i) {
            series.expand(m.all, true);
            EXPECT_TRUE(series.has_machine_code());
        }
    }
}

TEST(AbreastCode, is_not_made_of_what_is_too_long_to_pay) {
    Recorder r;
    std::vector<E> rates;
    const int count = 300;
    for (int i = 0; i < count; ++i) {
        E sum = 0.0;
        for (int j = 1; j < 8; ++j) sum = sum + (0.5 + i + j) * r.input(i) * r.input((i + j) % count);
        rates.push_back(sum);
    }
    const Program program(r, rates, count);
    for (const Processor processor : processors()) {
        SeriesAbreast series(program, 24, processor);
        series.use_machine_code(true);
        Motions m;
        m.add(program, 0.0, 1.0, std::vector<double>(count, 1e-3), 0.0);
        series.expand(m.all, true);
        EXPECT_FALSE(series.has_machine_code());
    }
}

}  // namespace
}  // namespace rbdyn::test_abreast_code
