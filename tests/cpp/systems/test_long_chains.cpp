// Chains so long that their series do not fit the caches, and their Jacobians no square: the order of work changes no
// digit, and what is done for each mass does not grow with their number.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>
#include <vector>

#include "rbdyn/engine/band.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/series_abreast.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/state_jacobian.hpp"
#include "rbdyn/expression/wavefront.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/series/abreast.hpp"
#include "support.hpp"

namespace rbdyn::test::test_long_chains {
namespace {

constexpr int order = 20;

/// In space; the springs have a length and, if they are stiff, every other one is 1e6 times as stiff and damped.
Scene chain(int masses, bool is_stiff = false) {
    Scene scene;
    std::vector<BodyHandle> all;
    for (int i = 0; i < masses; ++i) {
        const Vector3 velocity = i == 0 ? Vector3(0.3, 0.4, 0.2) : Vector3(0, 0, 0);
        all.push_back(scene.add(Particle{1.0}, {.position = {1.0 * i, 0.01 * (i % 3), 0.0}, .velocity = velocity}));
        if (i == 0) continue;
        const double factor = is_stiff && i % 2 == 1 ? 1e6 : 1.0;
        scene.connect(Spring{.stiffness = factor, .rest_length = 1.0, .damping = is_stiff ? factor : 0.0},
                      all[static_cast<std::size_t>(i - 1)], all.back());
    }
    return scene;
}

/// Of links that hang from one another and turn, in a plane or in space: each acceleration is made of those of all.
Scene links(int count, bool is_plane) {
    Scene scene({0.0, 0.0, -9.8125});
    const double length = 1.0 / count, across = length * length / (12.0 * count);
    const RigidBody rod(length, Vector3(across, across, across));
    BodyHandle last;
    for (int i = 0; i < count; ++i) {
        const Vector3 at(0, 0, i == 0 ? 0.0 : -length / 2), point(0, 0, length / 2);
        if (is_plane)
            last = scene.add(rod, Revolute{.axis = {0, 1, 0}, .at = at, .point = point},
                             {.angle = 0.1, .rate = 0.5, .parent = last});
        else
            last = scene.add(rod, Spherical{.at = at, .point = point},
                             {.angular_velocity_world = Vector3(0.3, 0.5, 0.1), .parent = last});
    }
    return scene;
}

struct Equipped {
    explicit Equipped(const Scene& scene)
        : plan(make_plan(scene)), x(plan.model->start(0.0)), mode(plan.model->begin(0.0, x)) {}
    const Program& program() const { return mode.equations->program; }
    Plan plan;
    std::vector<double> x;
    Mode mode;
};

void have_the_series_they_have_order_by_order(const Scene& scene, bool is_skewed) {
    const Equipped one(scene);
    Schedule schedule(one.program());
    const Wavefront wavefront(one.program(), schedule, order);
    ASSERT_FALSE(wavefront.chunks.empty());
    ASSERT_EQ(wavefront.is_skewed, is_skewed);
    SeriesEvaluator together(one.program(), order), apart(one.program(), order),
        sparing(one.program(), order, SeriesEvaluator::Use::expansion);
    for (SeriesEvaluator* series : {&together, &apart, &sparing}) {
        series->set_parameters(one.mode.parameters);
        series->begin(0.0, 0.125);
        for (std::size_t i = 0; i < one.x.size(); ++i) series->set_input(static_cast<int>(i), 0, one.x[i]);
    }
    together.expand(order, true);
    for (int k = 0; k < order; ++k) {
        apart.advance(k);
        apart.integrate(k);
    }
    apart.advance(order);
    // where lanes share places, those of the first time are what the second one finds there
    for (int time = 0; time < 2; ++time) {
        sparing.begin(0.0, 0.125);
        sparing.expand(order, true);
    }
    for (int slot = 0; slot < one.program().slots(); ++slot)
        for (const SeriesEvaluator* series : {&together, &sparing})
            ASSERT_EQ(std::memcmp(series->coefficients(slot), apart.coefficients(slot), sizeof(double) * (order + 1)),
                      0)
                << slot;
    if (is_skewed) {
        EXPECT_LT(10 * sparing.bytes(), 9 * together.bytes());
    }
    for (int i = 0; i < one.program().outputs() + static_cast<int>(one.program().switches().size()); ++i)
        for (int k = 0; k <= order; ++k) ASSERT_EQ(together.output(i)[k], apart.output(i)[k]) << i << ", order " << k;
    // and they are no zeros
    EXPECT_NE(apart.output(static_cast<int>(one.x.size()) / 2)[order], 0.0);
}

TEST(LongChains, have_the_series_they_have_order_by_order) {
    have_the_series_they_have_order_by_order(chain(600), true);
    have_the_series_they_have_order_by_order(links(300, true), false);
    have_the_series_they_have_order_by_order(links(80, false), false);
}

#ifdef RBDYN_HAS_LANES
/// Every operation that long programs have, and time: each variable's rate is made of all variables before it, and of
/// the sum of all.
Program long_program(int variables) {
    Recorder r;
    const Expression t = r.time(), p = r.parameter(r.new_parameter());
    Expression all = 0.0, before = 0.25;
    std::vector<Expression> x, rates;
    for (int i = 0; i < variables; ++i) x.push_back(r.input(i));
    for (int i = 0; i < variables; ++i) all = all + x[static_cast<std::size_t>(i)];
    for (int i = 0; i < variables; ++i) {
        const Expression u = x[static_cast<std::size_t>(i)], v = x[static_cast<std::size_t>((i + 1) % variables)];
        const Expression turned = 0.5 * sin(u) * before + cos(v) * u - 0.1 * t, square = u * u + v * v + 1.5;
        switch (i % 5) {
            case 0: before = turned / square + p * u; break;
            case 1: before = 0.1 * length({u, v, turned + 2.0}) - 0.25 * u * v + p; break;
            case 2: before = 0.1 * log(square) * turned + 0.2 * sqrt(square); break;
            case 3: before = 0.2 * asinh(turned) + 0.1 * atanh(0.1 * sin(u)) - 0.3; break;
            default: before = 0.1 * recording::angle(v, u + 4.0) - 0.5 * turned + 0.1 * log1p(u * u); break;
        }
        rates.push_back(i % 7 == 3 ? v : before - 1e-3 * all * u);
    }
    rates.push_back(before * all);
    rates.push_back(p * t);
    return Program(r, rates, variables);
}

TEST(LongChains, have_in_all_slots_the_bits_of_the_same_motion_beside_others) {
    const auto hold = [](const Program& program, std::span<const double> parameters, std::span<const double> x) {
        Schedule schedule(program);
        ASSERT_FALSE(Wavefront(program, schedule, order).is_skewed);
        SeriesEvaluator alone(program, order), everywhere(program, order), beside(program, order);
        ASSERT_GT(alone.bytes(), std::size_t{1} << 20) << "no longer than what fits the caches";
        everywhere.go_without_lanes_of_four();
        // what is asked for between two runs is of the first, and then of the second
        for (const double t : {0.25, 0.5}) {
            for (SeriesEvaluator* series : {&alone, &everywhere}) {
                series->set_parameters(parameters);
                series->begin(t, 0.125);
                for (std::size_t i = 0; i < x.size(); ++i) series->set_input(static_cast<int>(i), 0, x[i]);
                series->expand(order, true);
            }
            SeriesAbreast abreast(program, order);
            const SeriesAbreast::Motion motion{t, 0.125, x, alone.weights()};
            abreast.expand(std::span(&motion, 1), true);
            ASSERT_TRUE(abreast.is_good(0));
            abreast.give_all(0, beside, true);
            for (int slot = 0; slot < program.slots(); ++slot)
                for (const SeriesEvaluator* other : {&everywhere, &beside})
                    ASSERT_EQ(
                        std::memcmp(alone.coefficients(slot), other->coefficients(slot), sizeof(double) * (order + 1)),
                        0)
                        << slot << ", t = " << t;
            ASSERT_TRUE(alone.is_finite(order));
        }
    };
    const Program program = long_program(700);
    std::vector<double> x(700);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + 3.0 * static_cast<double>(i));
    // each norm has a parameter that says whether it begins at zero
    std::vector<double> parameters(static_cast<std::size_t>(program.parameters()), 0.0);
    parameters.front() = 0.75;
    hold(program, parameters, x);
    const Equipped one(links(300, true)), other(links(80, false));
    hold(one.program(), one.mode.parameters, one.x);
    hold(other.program(), other.mode.parameters, other.x);
}
#endif

TEST(LongChains, take_for_each_mass_what_shorter_ones_take) {
    const auto counts = [](int masses) {
        const Equipped one(chain(masses));
        Schedule schedule(one.program());
        const Wavefront wavefront(one.program(), schedule, order);
        std::size_t longest = 0;
        for (const Wavefront::Chunk& c : wavefront.chunks) longest = std::max(longest, c.inputs.last - c.inputs.first);
        const StateJacobian jacobian(one.program());
        const BandOrder band = BandOrder::of(jacobian.rows(), jacobian.columns());
        return std::array<double, 4>{static_cast<double>(longest), static_cast<double>(band.width),
                                     static_cast<double>(jacobian.columns().size()) / masses,
                                     static_cast<double>(one.program().slots()) / masses};
    };
    const auto few = counts(500), many = counts(4000);
    ASSERT_GT(few[0], 0.0);
    EXPECT_LE(many[0], few[0]) << "variables at work at a time";
    EXPECT_LE(many[1], few[1]) << "bandwidth";
    EXPECT_LE(few[1], 18.0) << "of three bodies, each with its six variables";
    EXPECT_NEAR(many[2], few[2], 0.1) << "entries of the Jacobian";
    EXPECT_NEAR(many[3], few[3], 0.1) << "slots";
}

TEST(LongChains, have_the_jacobian_that_all_directions_give) {
    Equipped one(chain(20, true));
    for (std::size_t i = 0; i < one.x.size(); ++i) one.x[i] += 0.01 * std::sin(static_cast<double>(i));
    StateJacobian few(one.program());
    JacobianEvaluator all(one.program());
    few.set_parameters(one.mode.parameters, Program::Rounding::nearest);
    all.set_parameters(one.mode.parameters);
    ASSERT_TRUE(few.is_sparse());
    few.differentiate(0.0, one.x);
    all.differentiate(0.0, one.x);
    for (int i = 0; i < few.size(); ++i) {
        std::vector<double> row(one.x.size(), 0.0);
        for (std::size_t k = 0; k < few.columns(i).size(); ++k)
            row[static_cast<std::size_t>(few.columns(i)[k])] = few.entries(i)[k];
        for (int j = 0; j < few.size(); ++j) ASSERT_EQ(row[static_cast<std::size_t>(j)], all.derivative(i, j));
    }
}

TEST(Bands, solve_what_full_matrices_solve) {
    // small diagonals, so that rows are exchanged; variables named in a mixed order
    constexpr int n = 60, reach = 3;
    Eigen::MatrixXd full = Eigen::MatrixXd::Zero(n, n);
    const auto name = [](int i) { return (7 * i + 3) % n; };
    std::vector<std::size_t> first{0};
    std::vector<int> columns;
    for (int i = 0; i < n; ++i)
        for (int j = std::max(0, i - reach); j <= std::min(n - 1, i + reach); ++j)
            full(name(i), name(j)) = i == j ? 1e-3 : std::sin(1.0 + 13.0 * i + 7.0 * j);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j)
            if (full(i, j) != 0.0) columns.push_back(j);
        first.push_back(columns.size());
    }
    const BandOrder order_found = BandOrder::of(first, columns);
    ASSERT_LE(order_found.width, 2 * reach);
    BandMatrix band(n, order_found.width);
    const auto place = [&](int i) { return order_found.place[static_cast<std::size_t>(i)]; };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            if (full(i, j) != 0.0) band(place(i), place(j)) = full(i, j);
    ASSERT_TRUE(band.factorise());
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(n, -1.0, 2.0), expected = full.partialPivLu().solve(right);
    std::vector<double> x(n);
    for (int i = 0; i < n; ++i) x[static_cast<std::size_t>(place(i))] = right[i];
    band.solve(x);
    for (int i = 0; i < n; ++i)
        EXPECT_NEAR(x[static_cast<std::size_t>(place(i))], expected[i], 1e-11 * expected.norm()) << i;
    band.clear();
    EXPECT_FALSE(band.factorise()) << "a matrix without entries";
}

TEST(LongChains, along_a_line_move_as_their_modes_say) {
    // m u_i'' = k (u_(i-1) - 2 u_i + u_(i+1)), both ends free: shapes cos(j pi (i + 1/2) / n) and frequencies
    // 2 sqrt(k / m) sin(j pi / (2 n))
    constexpr int masses = 2000, seen = 60;
    constexpr double stiffness = 100.0, kick = 0.1, until = 1.0, error = 1e-9;
    Scene scene;
    std::vector<BodyHandle> all;
    for (int i = 0; i < masses; ++i) {
        all.push_back(scene.add(Particle{1.0}, {.position = {1.0 * i, 0, 0}, .velocity = {i == 0 ? kick : 0.0, 0, 0}}));
        if (i > 0)
            scene.connect(Spring{.stiffness = stiffness, .rest_length = 1.0}, all[static_cast<std::size_t>(i - 1)],
                          all.back());
    }
    const Trajectory run = simulate(scene, {.until = until, .error = error, .keep = {Keep::What::end}});
    ASSERT_LE(*run.error(), error);
    constexpr double pi = std::numbers::pi;
    for (int i = 0; i < seen; ++i) {
        long double u = until;
        for (int j = 1; j < masses; ++j) {
            const double frequency = 2.0 * std::sqrt(stiffness) * std::sin(j * pi / (2.0 * masses));
            u += 2.0 * std::cos(j * pi / (2.0 * masses)) * std::cos(j * pi * (i + 0.5) / masses) *
                 std::sin(frequency * until) / frequency;
        }
        const double moved = run[all[static_cast<std::size_t>(i)]].position(until).x() - i;
        // places of hundreds of metres round
        EXPECT_NEAR(moved, static_cast<double>(u) * kick / masses, error * kick + 4.0 * epsilon * masses) << i;
    }
}

}  // namespace
}  // namespace rbdyn::test::test_long_chains
