// Series that share places once nobody reads them any more: states and outputs have the bits that they have order
// after order with a place for each, and so have all others when they are looked at.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "expression/programs.hpp"
#include "random.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::test_slot_ring {
namespace {

using E = Expression;
using test::Random;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Variables, each pulled by those beside it, and what guards look at: a formula of each pair. `to_all`: the first rate
/// is a term of all others.
Program chain(int bodies, int formula, bool to_all, bool reads_far = false) {
    Recorder r;
    const E p = r.parameter(r.new_parameter()), t = r.time();
    const E drive = sin(t) * p;
    std::vector<E> rates, guards;
    for (int i = 0; i < bodies; ++i) rates.push_back(r.input(bodies + i));
    for (int i = 0; i < bodies; ++i) {
        const E x = r.input(i), left = r.input(std::max(i - 1, 0)), right = r.input(std::min(i + 1, bodies - 1));
        const E apart = length({right - x, x - left, E(1.0)});
        guards.push_back(reads_far ? apart - 0.5 * p : apart);
        E force = (right - x) / apart - (x - left) * apart;
        if (formula == 1) force = force + sin(x) * p - sqrt(x * x + 2.0);
        if (formula == 2) force = force - log(right * right + 1.5) * x;
        rates.push_back(to_all && i > 0 ? force + drive : force);
    }
    rates.insert(rates.end(), guards.begin(), guards.end());
    return Program(r, rates, 2 * bodies);
}

class Held {
public:
    Held(const Program& program, int order, Random& random)
        : program_(program), order_(order), apart_(program, order), random_(random) {}

    /// Another start, and its series order after order.
    void start() {
        x_.resize(at(program_.inputs()));
        for (double& x : x_) x = random_.uniform(-0.5, 0.5);
        parameters_.assign(at(program_.parameters()), 0.0);
        parameters_.front() = random_.uniform(0.5, 1.0);
        begin(apart_);
        for (int k = 0; k < order_; ++k) {
            apart_.advance(k);
            apart_.integrate(k);
        }
        apart_.advance(order_);
    }
    void expand(SeriesEvaluator& series, bool whole) const {
        begin(series);
        series.expand(order_, whole);
    }
    /// How many slots, of some, have other coefficients 0 .. order - 1, or 0 .. order.
    template <class Slots>
    int differ(const SeriesEvaluator& series, const Slots& slots, int count, bool whole) const {
        int different = 0;
        for (int i = 0; i < count; ++i) {
            const int slot = slots(i);
            const double *ours = series.coefficients(slot), *theirs = apart_.coefficients(slot);
            const int last = slot < program_.inputs() || whole ? order_ : order_ - 1;
            bool is_same = true;
            for (int k = 0; k <= last; ++k) is_same = is_same && test::are_same(ours[k], theirs[k]);
            different += is_same ? 0 : 1;
        }
        return different;
    }
    int states_differ(const SeriesEvaluator& series) const {
        return differ(
            series, [](int i) { return i; }, program_.inputs(), true);
    }
    int outputs_differ(const SeriesEvaluator& series, bool whole) const {
        const int rates = program_.inputs();
        return differ(
            series, [&](int i) { return program_.output(rates + i); }, program_.outputs() - rates, whole);
    }
    int slots_differ(const SeriesEvaluator& series, bool whole) const {
        return differ(
            series, [](int i) { return i; }, program_.slots(), whole);
    }

private:
    void begin(SeriesEvaluator& series) const {
        series.set_parameters(parameters_);
        series.begin(0.25, 0.125);
        for (int i = 0; i < program_.inputs(); ++i) series.set_input(i, 0, x_[at(i)]);
    }
    const Program& program_;
    int order_;
    SeriesEvaluator apart_;
    Random& random_;
    std::vector<double> x_, parameters_;
};

enum class Way { by_code, by_lists, in_pairs };

TEST(SlotRing, has_the_bits_of_order_after_order) {
    Random random(1);
    int with_code = 0;
    for (const int formula : {0, 1, 2})
        for (const bool to_all : {false, true})
            for (const int order : {12, 19}) {
                const Program program = chain(2500, formula, to_all);
                Held held(program, order, random);
                for (const Way way : {Way::by_code, Way::by_lists, Way::in_pairs}) {
                    SeriesEvaluator series(program, order, SeriesEvaluator::Use::states);
                    if (way == Way::in_pairs)
                        series.go_without_lanes_of_four();
                    else
                        series.use_machine_code(way == Way::by_code);
                    for (const bool whole : {true, false, true}) {
                        held.start();
                        held.expand(series, whole);
                        ASSERT_TRUE(series.is_finite(0) && series.is_finite(order - 1));
                        ASSERT_EQ(held.states_differ(series), 0) << formula << ", order " << order;
                        ASSERT_EQ(held.outputs_differ(series, whole), 0) << formula << ", order " << order;
                    }
                    ASSERT_TRUE(series.has_ring()) << formula << ", order " << order;
                    // it takes no code away
                    SeriesEvaluator all(program, order, SeriesEvaluator::Use::expansion);
                    if (way == Way::by_code) {
                        all.use_machine_code(true);
                        held.expand(all, true);
                        with_code += series.has_repeated_code() ? 1 : 0;
                    }
                    EXPECT_EQ(series.has_repeated_code(), all.has_repeated_code())
                        << formula << (to_all ? ", to all" : "") << ", order " << order;
                    // what nobody was to look at, and from then on
                    for (int time = 0; time < 3; ++time) {
                        ASSERT_EQ(held.slots_differ(series, true), 0) << formula << ", order " << order;
                        ASSERT_FALSE(series.has_ring());
                        held.start();
                        held.expand(series, true);
                        ASSERT_EQ(held.states_differ(series), 0);
                    }
                }
            }
    EXPECT_EQ(with_code > 0, test::is_made());
}

TEST(SlotRing, takes_less_room) {
    const Program program = chain(2500, 0, false);
    const SeriesEvaluator all(program, 20, SeriesEvaluator::Use::expansion),
        states(program, 20, SeriesEvaluator::Use::states);
    EXPECT_LT(3 * states.bytes(), 2 * all.bytes());
}

TEST(SlotRing, is_none_where_it_would_take_code_away) {
    // guards that are computed behind all rates
    const Program program = chain(2500, 0, false, true);
    SeriesEvaluator series(program, 12, SeriesEvaluator::Use::states);
    EXPECT_FALSE(series.has_ring());
    series.use_machine_code(true);
    Random random(2);
    Held held(program, 12, random);
    held.start();
    held.expand(series, true);
    EXPECT_EQ(series.has_repeated_code(), test::is_made());
    EXPECT_EQ(held.slots_differ(series, true), 0);
}

TEST(SlotRing, tells_what_is_not_finite) {
    const Program program = chain(2500, 1, false);
    constexpr int order = 16;
    SeriesEvaluator series(program, order, SeriesEvaluator::Use::states);
    std::vector<double> parameters(at(program.parameters()), 0.0);
    parameters.front() = 0.75;
    series.set_parameters(parameters);
    // in the first rate, in rates of the last order alone, nowhere
    for (const double far : {std::numeric_limits<double>::infinity(), 0x1p150, 0.5}) {
        series.begin(0.0, far > 1.0 && std::isfinite(far) ? 0x1p60 : 0.125);
        for (int i = 0; i < program.inputs(); ++i) series.set_input(i, 0, i == 1200 ? far : 0.25);
        series.expand(order, true);
        ASSERT_TRUE(series.has_ring());
        SeriesEvaluator apart(program, order);
        apart.set_parameters(parameters);
        apart.begin(0.0, series.unit());
        for (int i = 0; i < program.inputs(); ++i) apart.set_input(i, 0, i == 1200 ? far : 0.25);
        apart.expand(order, true);
        EXPECT_EQ(series.is_finite(0), apart.is_finite(0)) << far;
        EXPECT_EQ(series.is_finite(order - 1), apart.is_finite(order - 1)) << far;
        EXPECT_EQ(series.is_finite(0), std::isfinite(far));
        EXPECT_EQ(series.is_finite(order - 1), far < 1.0);
    }
}

}  // namespace
}  // namespace rbdyn::test_slot_ring
