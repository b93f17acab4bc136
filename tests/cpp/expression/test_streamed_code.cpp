// Machine code of streamed series, one for all stages of a kind: the series that the lists give, bit for bit, of chains
// and trees of links, and of random programs whose passes run to and fro along a row.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "expression/programs.hpp"
#include "random.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/stream_kinds.hpp"

namespace rbdyn::test_streamed_code {
namespace {

using E = Expression;
using test::is_made;
using test::Random;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Links hinged in a plane, each on its parent, which comes before it (-1: on what stands), by articulated bodies
/// (Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 7.3): outwards velocities, inwards inertias and
/// forces, outwards accelerations. `differ`: in lengths and masses.
Program links(const std::vector<int>& parents, bool differ) {
    Recorder r;
    const E weight = r.parameter(r.new_parameter());
    const std::size_t count = parents.size();
    const auto input = [&](std::size_t i) { return r.input(static_cast<int>(i)); };
    const auto length_of = [&](std::size_t i) { return differ ? 1.0 + 0.01 * static_cast<double>(i) : 1.0; };
    const auto mass_of = [&](std::size_t i) { return differ ? 1.0 + 0.1 * static_cast<double>(i % 3) : 1.0; };
    struct Link {
        E sine, cosine, turn, vx = 0.0, vy = 0.0, cx = 0.0, cy = 0.0;            // velocity of its hinge, what it adds
        E inertia, ix = 0.0, iy, xx, xy = 0.0, yy, torque, fx, fy, over, drive;  // of all that hangs on it
        E spin, ax = 0.0, ay = 0.0;
    };
    std::vector<Link> all(count);
    for (std::size_t i = 0; i < count; ++i) {
        Link& l = all[i];
        const E rate = input(count + i);
        l.sine = sin(input(i));
        l.cosine = cos(input(i));
        l.turn = rate;
        if (parents[i] >= 0) {
            const Link& p = all[at(parents[i])];
            const E across = p.vy + length_of(at(parents[i])) * p.turn;
            l.turn = p.turn + rate;
            l.vx = l.cosine * p.vx + l.sine * across;
            l.vy = l.cosine * across - l.sine * p.vx;
            l.cx = rate * l.vy;
            l.cy = -(rate * l.vx);
        }
        const double m = mass_of(i), half = 0.5 * length_of(i);
        l.inertia = 0.4 * m;
        l.iy = m * half;
        l.xx = l.yy = m;
        l.torque = m * half * l.turn * l.vx;
        l.fx = -(m * l.turn * (l.vy + half * l.turn));
        l.fy = m * l.turn * l.vx + weight * l.cosine;
    }
    for (std::size_t i = count; i-- > 0;) {
        Link& l = all[i];
        l.over = 1.0 / l.inertia;
        l.drive = -l.torque;
        if (parents[i] < 0) continue;
        Link& p = all[at(parents[i])];
        const double arm = length_of(at(parents[i]));
        const E kx = l.ix * l.over, ky = l.iy * l.over, xx = l.xx - kx * l.ix, xy = l.xy - kx * l.iy,
                yy = l.yy - ky * l.iy;
        const E fx = l.fx + xx * l.cx + xy * l.cy + kx * l.drive, fy = l.fy + xy * l.cx + yy * l.cy + ky * l.drive;
        const E cc = l.cosine * l.cosine, cs = l.cosine * l.sine, ss = l.sine * l.sine;
        const E up_xx = cc * xx - 2.0 * cs * xy + ss * yy, up_yy = ss * xx + 2.0 * cs * xy + cc * yy,
                up_xy = cs * (xx - yy) + (cc - ss) * xy, up_y = l.sine * fx + l.cosine * fy;
        p.inertia += arm * arm * up_yy;
        p.ix += arm * up_xy;
        p.iy += arm * up_yy;
        p.xx += up_xx;
        p.xy += up_xy;
        p.yy += up_yy;
        p.torque += arm * up_y;
        p.fx += l.cosine * fx - l.sine * fy;
        p.fy += up_y;
    }
    std::vector<E> rates(2 * count);
    for (std::size_t i = 0; i < count; ++i) {
        Link& l = all[i];
        E spin = 0.0;
        if (parents[i] >= 0) {
            const Link& p = all[at(parents[i])];
            const E across = p.ay + length_of(at(parents[i])) * p.spin;
            spin = p.spin;
            l.ax = l.cosine * p.ax + l.sine * across + l.cx;
            l.ay = l.cosine * across - l.sine * p.ax + l.cy;
        }
        const E rate = l.over * (l.drive - l.ix * l.ax - l.iy * l.ay) - spin;
        l.spin = spin + rate;
        rates[i] = input(count + i);
        rates[count + i] = rate;
    }
    return Program(r, rates, static_cast<int>(2 * count));
}

std::vector<int> chain(int count) {
    std::vector<int> parents;
    for (int i = 0; i < count; ++i) parents.push_back(i - 1);
    return parents;
}

/// Many branches, or few long ones.
std::vector<int> tree(Random& random, int count) {
    const int back = random.chance(0.5) ? count : random.whole(1, 4);
    std::vector<int> parents{-1};
    for (int i = 1; i < count; ++i) parents.push_back(random.whole(std::max(0, i - back), i - 1));
    return parents;
}

/// A value beside another one along a row, at a place of it.
using Formula = std::function<E(int place, const E& beside, const E& here, const E& there)>;

/// Sums of products, and what is no combination, with weights that are often one.
Formula random_formula(Random& random, const E& parameter, const E& time) {
    const int which = random.whole(0, 12);
    const bool are_alike = random.chance(0.5), has_time = random.chance(0.2);
    const double first = random.chance(0.3) ? 1.0 : random.uniform(-0.5, 0.5), second = random.uniform(-0.5, 0.5);
    return [=](int place, const E& beside, const E& here, const E& there) -> E {
        const double a = are_alike ? first : first * std::cos(place), b = are_alike ? second : second * std::sin(place);
        const E mixed = a * beside + b * here - there + (has_time ? 0.1 * time : E(0.0));
        switch (which) {
            case 0: return a * sin(here) + b * cos(beside) * there;
            case 1: return here / (beside * beside + 2.0);
            case 2: return 0.5 * beside * here + there * there - parameter * here * there;
            case 3: return sqrt(beside * beside + here * here + 1.0) - 1.0;
            case 4: return 0.25 * length({beside, here, there + 2.0});
            case 5: return log(beside * beside + 1.5) + b * here;
            case 6: return tanh(mixed);
            case 7: return recording::angle(beside, here * there + 4.0);
            case 8: return atanh(0.25 * sin(mixed)) + asinh(there);
            case 9: return log1p(0.5 * here * here) * sin(beside);
            case 10: return b + beside * (here + there) + a * here * beside - there * parameter;
            case 11: return mixed;
            default: return parameter * sin(beside + here) * cos(there - here) - beside / (3.0 + here);
        }
    };
}

/// Some passes along a row of variables, outwards and inwards, each by a formula of its own, which is another one here
/// and there; rates are made of what the passes have made.
Program random_passes(Random& random, int length, double exceptions) {
    Recorder r;
    const E parameter = r.parameter(r.new_parameter()), time = r.time();
    std::vector<std::vector<E>> made(1);
    for (int i = 0; i < length; ++i) made[0].push_back(r.input(i));
    for (int passes = random.whole(2, 5); passes > 0; --passes) {
        const Formula usual = random_formula(random, parameter, time), other = random_formula(random, parameter, time);
        const bool is_inwards = passes % 2 == 0;
        const std::vector<E>&here = made[at(random.whole(0, static_cast<int>(made.size()) - 1))], &there = made.back();
        std::vector<E> values(at(length));
        E beside = 0.125;
        for (int i = 0; i < length; ++i) {
            const int place = is_inwards ? length - 1 - i : i;
            const Formula& formula = random.chance(exceptions) ? other : usual;
            beside = 0.5 * formula(place, beside, here[at(place)], there[at(place)]);
            values[at(place)] = beside;
        }
        made.push_back(values);
    }
    std::vector<E> rates;
    for (int i = 0; i < length; ++i)
        rates.push_back(made.back()[at(i)] - 0.5 * made[made.size() - 2][at((i + 1) % length)] * r.input(i));
    rates.push_back(parameter * rates.front() + rates.back());
    return Program(r, rates, length);
}

struct Start {
    std::vector<double> x;
    double parameter, unit;
};

Start random_start(Random& random, const Program& program) {
    Start start{{}, random.uniform(0.5, 1.0), std::exp2(random.whole(-6, 0))};
    for (int i = 0; i < program.inputs(); ++i)
        start.x.push_back(random.chance(0.1) ? (random.chance(0.5) ? 0.0 : -0.0) : random.uniform(-0.5, 0.5));
    return start;
}

void begin(SeriesEvaluator& series, const Start& start) {
    std::vector<double> parameters(at(series.program().parameters()), 0.0);
    if (!parameters.empty()) parameters.front() = start.parameter;
    series.set_parameters(parameters);
    series.begin(0.25, start.unit);
    for (std::size_t i = 0; i < start.x.size(); ++i) series.set_input(static_cast<int>(i), 0, start.x[i]);
}

/// Coefficients 0 .. orders - 1 of all slots; the first one that differs ends the test.
bool are_same(const SeriesEvaluator& ours, const SeriesEvaluator& theirs, int orders) {
    for (int slot = 0; slot < ours.program().slots(); ++slot) {
        const double *a = ours.coefficients(slot), *b = theirs.coefficients(slot);
        for (int k = 0; k < orders; ++k) {
            if (test::are_same(a[k], b[k])) continue;
            ADD_FAILURE() << "slot " << slot << ", order " << k << " of " << orders << ": " << a[k] << " and not "
                          << b[k];
            return false;
        }
    }
    return true;
}

/// Expansions from several starts, one after the other; whether there was code.
bool hold(Random& random, const Program& program, int order, int times = 3) {
    SeriesEvaluator by_code(program, order, SeriesEvaluator::Use::expansion), by_lists(program, order);
    by_code.use_machine_code(true);
    by_lists.use_machine_code(false);
    for (int time = 0; time < times; ++time) {
        const Start start = random_start(random, program);
        const bool whole = time % 2 == 0;
        for (SeriesEvaluator* series : {&by_code, &by_lists}) {
            begin(*series, start);
            series->expand(order, whole);
        }
        if (!are_same(by_code, by_lists, whole ? order + 1 : order)) return false;
    }
    EXPECT_FALSE(by_lists.has_machine_code());
    return by_code.has_streamed_code();
}

TEST(StreamedCode, has_the_bits_of_the_lists_for_links_in_a_row_at_every_order) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(1);
    for (const bool differ : {false, true}) {
        const Program program = links(chain(250), differ);
        for (int order = 2; order <= 26; ++order) {
            EXPECT_TRUE(hold(random, program, order)) << "order " << order;
            if (HasFailure()) return;
        }
    }
}

TEST(StreamedCode, has_the_bits_of_the_lists_for_trees_of_links) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(2);
    for (int trial = 0; trial < 20; ++trial) {
        const Program program = links(tree(random, random.whole(150, 500)), trial % 2 == 0);
        EXPECT_TRUE(hold(random, program, random.whole(6, 26))) << "tree " << trial;
        if (HasFailure()) return;
    }
}

TEST(StreamedCode, has_the_bits_of_the_lists_for_random_passes_along_a_row) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(3);
    int with_code = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const Program program = random_passes(random, random.whole(300, 1500), random.chance(0.3) ? 0.0 : 0.05);
        with_code += hold(random, program, random.whole(2, 26)) ? 1 : 0;
        if (HasFailure()) return;
    }
    EXPECT_GT(with_code, 40);
}

// what is divided by zero, and what is none
TEST(StreamedCode, has_the_bits_of_the_lists_for_what_is_not_finite) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(4);
    const Program program = links(chain(200), false);
    SeriesEvaluator by_code(program, 12), by_lists(program, 12);
    by_code.use_machine_code(true);
    by_lists.use_machine_code(false);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double x : {infinity, -infinity, std::nan(""), 1e200, 1e-310}) {
        Start start = random_start(random, program);
        start.x[at(random.whole(0, program.inputs() - 1))] = x;
        for (SeriesEvaluator* series : {&by_code, &by_lists}) {
            begin(*series, start);
            series->expand(12, true);
        }
        ASSERT_TRUE(are_same(by_code, by_lists, 13)) << x;
        for (int k = 0; k <= 12; ++k) EXPECT_EQ(by_code.is_finite(k), by_lists.is_finite(k)) << x << ", order " << k;
    }
    EXPECT_TRUE(by_code.has_streamed_code());
}

// each needs the one before at the same order, thousands of times
TEST(StreamedCode, has_the_bits_of_the_lists_for_nested_quotients) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Recorder r;
    E force = r.input(0);
    for (int i = 0; i < 30'000; ++i) force = 1.0 / (1.0 + force * force);
    const Program program(r, std::vector<E>{r.input(1), force}, 2);
    SeriesEvaluator by_code(program, 16), by_lists(program, 16);
    by_code.use_machine_code(true);
    by_lists.use_machine_code(false);
    for (const double x : {0.25, -1.0, 40.0}) {
        for (SeriesEvaluator* series : {&by_code, &by_lists}) {
            begin(*series, {{x, 0.5}, 1.0, 0.5});
            series->expand(16, true);
        }
        ASSERT_TRUE(are_same(by_code, by_lists, 17)) << x;
        EXPECT_TRUE(by_code.is_finite(16)) << x;
    }
    EXPECT_TRUE(by_code.has_streamed_code());
}

TEST(StreamedCode, has_the_bits_of_the_lists_when_orders_are_asked_for_one_by_one_and_again) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(5);
    const Program program = links(chain(200), true);
    constexpr int order = 15;
    SeriesEvaluator by_code(program, order), by_lists(program, order);
    by_code.use_machine_code(true);
    by_lists.use_machine_code(false);
    for (int time = 0; time < 3; ++time) {
        const Start start = random_start(random, program);
        for (SeriesEvaluator* series : {&by_code, &by_lists}) begin(*series, start);
        // code is made where all orders are asked for
        if (time == 0) {
            by_code.expand(order, true);
            begin(by_code, start);
        }
        for (int k = 0; k <= order; ++k) {
            const int times = random.whole(1, 2);
            for (SeriesEvaluator* series : {&by_code, &by_lists}) {
                for (int i = 0; i < times; ++i) series->advance(k);
                if (k < order) series->integrate(k);
            }
            ASSERT_TRUE(are_same(by_code, by_lists, k + 1));
        }
    }
    EXPECT_TRUE(by_code.has_streamed_code());
}

TEST(StreamedCode, is_kept_with_what_it_is_of) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    Random random(9);
    const Program program = links(chain(400), true);
    constexpr int order = 18;
    const auto use = SeriesEvaluator::Use::expansion;
    const Start start = random_start(random, program), other = random_start(random, program);
    {
        const BorrowedSeries series(program, order, use);
        begin(*series, other);
        series->expand(order, true);
        ASSERT_TRUE(series->has_streamed_code());
    }
    const BorrowedSeries again(program, order, use);
    ASSERT_TRUE(again->has_streamed_code());
    SeriesEvaluator alone(program, order, use);
    for (SeriesEvaluator* series : {&*again, &alone}) {
        begin(*series, start);
        series->expand(order, true);
    }
    EXPECT_TRUE(are_same(*again, alone, order + 1));
}

/// A pass outwards and one inwards, then what is like nothing else: `lone` sums of products.
Program half_alike(int length, int lone) {
    Recorder r;
    Random random(6);
    std::vector<E> rates;
    E beside = 0.5;
    for (int i = 0; i < length; ++i) {
        beside = 0.5 * beside * r.input(i) + sin(r.input(i)) / (1.0 + beside * beside);
        rates.push_back(beside);
    }
    for (int i = length - 1; i >= 0; --i) {
        beside = 0.5 * beside * rates[at(i)] + r.input(i);
        rates[at(i)] = beside;
    }
    for (int i = 0; i < lone; ++i) {
        E sum = 0.25 * beside;
        // which weights are one tells kinds
        for (int terms = random.whole(10, 20); terms > 0; --terms) {
            const double weight = random.chance(0.5) ? 1.0 : random.uniform(-0.1, 0.1);
            sum += weight * rates[at(random.whole(0, length - 1))];
            sum += random.uniform(-0.1, 0.1) * beside * r.input(random.whole(0, length - 1));
        }
        beside = 0.01 * sum;
    }
    rates.back() += beside;
    return Program(r, rates, length);
}

TEST(StreamedCode, leaves_stages_of_kinds_that_come_seldom_to_the_lists) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = half_alike(2000, 300);
    Random random(7);
    EXPECT_TRUE(hold(random, program, 14));
    SeriesEvaluator series(program, 14);
    StreamKinds kinds(series);
    const std::size_t with_code = kinds.choose(StreamKinds::longest);
    EXPECT_GT(kinds.left.size(), 50U);
    EXPECT_GT(with_code, 4000U);
}

TEST(StreamedCode, is_not_made_where_few_stages_are_alike) {
    if (!is_made()) GTEST_SKIP() << "no machine code here";
    const Program program = half_alike(50, 3000);
    Random random(8);
    EXPECT_FALSE(hold(random, program, 14));
}

}  // namespace
}  // namespace rbdyn::test_streamed_code
