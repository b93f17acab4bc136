// The event `singular`, held against the coordinate that a linkage has left: how often and when it passes through the
// place where its constraints lose rank, whatever the accuracy and the end of the run.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "random.hpp"
#include "rbdyn/rbdyn.hpp"
#include "support.hpp"

namespace rbdyn::test {
namespace singular_passages {

const Vector3 down{0, -9.81, 0}, z{0, 0, 1};
constexpr double pi = std::numbers::pi;

RigidBody bar(double mass, double length, double moment) {
    return RigidBody(mass, {moment, moment, moment}, {.com = {length / 2, 0, 0}});
}

/// Equal parallelograms side by side, of cranks of length 1: they pass flat together.
struct Row {
    Scene scene{down};
    std::vector<BodyHandle> cranks;
    std::vector<ConstraintHandle> pins;
    double angle, rate, moment, weight;  // of the pendulum they make: moment * angle'' = -weight * cos(angle)

    Row(int count, double crank, double coupler, double width, double from, double at_rate)
        : angle(from),
          rate(at_rate),
          moment((count + 1) * (0.1 + 0.25 * crank) + count * coupler),
          weight(-down[1] * (0.5 * crank * (count + 1) + coupler * count)) {
        std::vector<BodyHandle> couplers;
        for (int i = 0; i <= count; ++i)
            cranks.push_back(scene.add(bar(crank, 1.0, 0.1), Revolute{.axis = z, .at = {width * i, 0, 0}},
                                       {.angle = angle, .rate = rate}));
        for (int i = 0; i < count; ++i)
            couplers.push_back(scene.add(bar(coupler, width, 0.1), Revolute{.axis = z, .at = {1, 0, 0}},
                                         {.angle = -angle, .rate = -rate, .parent = cranks[at(i)]}));
        for (int i = 0; i < count; ++i)
            pins.push_back(
                scene.constrain(Ball{}, couplers[at(i)].point({width, 0, 0}), cranks[at(i + 1)].point({1, 0, 0})));
    }

    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// The pendulum, and when it passes a whole number of half turns, by its own series and a watch that sees
    /// sin(angle) pass zero: no constraint, no rank.
    struct Truth {
        Trajectory run;
        BodyHandle bob;
        std::vector<double> passes;
    };
    Truth truth(double until) const {
        const double mass = 1.0, arm = weight / (-down[1] * mass), own = moment - mass * arm * arm;
        // an inertia that is positive about the center, whatever the arm: a heavier bob nearer to the pivot
        const double m = own > 0.0 ? mass : weight * weight / (0.5 * moment * down[1] * down[1]),
                     a = weight / (-down[1] * m), rest = moment - m * a * a;
        Scene one(down);
        const auto bob = one.add(RigidBody(m, {rest, rest, rest}, {.com = {a, 0, 0}}), Revolute{.axis = z},
                                 {.angle = angle, .rate = rate});
        Trajectory run = simulate(one, {.until = until, .error = 1e-13});
        std::vector<double> passes;
        constexpr int parts = 20000;
        double before = std::sin(run[bob].angle(0.0));
        for (int k = 1; k <= parts; ++k) {
            const double lo = until * (k - 1) / parts, hi = until * k / parts, now = std::sin(run[bob].angle(hi));
            if ((now > 0.0) != (before > 0.0)) {
                double l = lo, h = hi;
                for (int i = 0; i < 60; ++i) {
                    const double middle = 0.5 * (l + h);
                    ((std::sin(run[bob].angle(middle)) > 0.0) == (before > 0.0) ? l : h) = middle;
                }
                passes.push_back(h);
            }
            before = now;
        }
        return {std::move(run), bob, passes};
    }
};

/// The rate with which a row thrown up from an angle turns back at another one.
double rate_to_turn(const Row& row, double at) {
    return std::sqrt(2.0 * row.weight / row.moment * (std::sin(at) - std::sin(row.angle)));
}

TEST(SingularPassages, one_that_turns_just_beyond_flat_passes_it_twice_whatever_the_end_and_the_error) {
    const Row plain(1, 1.0, 2.0, 1.5, -0.4, 0.0);
    for (const double beyond : {3e-3, 3e-4, 1e-4, 3e-5}) {
        const Row row(1, 1.0, 2.0, 1.5, -0.4, rate_to_turn(plain, beyond));
        for (const double until : {0.4, 0.5, 1.0}) {
            const Row::Truth truth = row.truth(until);
            ASSERT_EQ(truth.passes.size(), 2u) << beyond;
            for (const double error : {1e-6, 1e-9, 1e-12}) {
                SCOPED_TRACE(std::to_string(beyond) + " until " + std::to_string(until) + " error " +
                             std::to_string(error));
                const Trajectory run = simulate(row.scene, {.until = until, .error = error});
                const auto times = run.events().times("singular");
                ASSERT_EQ(times.size(), 2u);
                // the truth is known to 1e-13 of the angle, which is that over the rate there in time
                const double known = 1e-12 / std::sqrt(2.0 * row.weight / row.moment * beyond);
                for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(times[k], truth.passes[k], error * until + known);
                for (const double t : {0.3 * until, until})
                    for (const auto crank : row.cranks)
                        EXPECT_NEAR(run[crank].angle(t), truth.run[truth.bob].angle(t), error * pi);
            }
        }
    }
}

TEST(SingularPassages, one_that_turns_short_of_flat_tells_nothing) {
    const Row plain(1, 1.0, 2.0, 1.5, -0.4, 0.0);
    for (const double short_of : {1e-2, 1e-3, 1e-4}) {
        const Row row(1, 1.0, 2.0, 1.5, -0.4, rate_to_turn(plain, -short_of));
        for (const double until : {0.4, 0.5, 1.0})
            for (const double error : {1e-6, 1e-9}) {
                const Trajectory run = simulate(row.scene, {.until = until, .error = error});
                EXPECT_EQ(run.events().size(), 0u) << short_of << " until " << until << " error " << error;
            }
    }
}

TEST(SingularPassages, of_a_row_of_parallelograms_each_tells_once_of_every_passage) {
    struct Start {
        int count;
        double angle, rate;
    };
    for (const Start s : {Start{2, 1.0, -6.0}, {2, -0.5, 5.0}, {3, pi / 2, -1.0}, {5, pi / 2, -1.0}, {5, -0.5, 5.0}}) {
        const Row row(s.count, 1.0, 2.0, 1.0, s.angle, s.rate);
        const Row::Truth truth = row.truth(2.0);
        for (const double error : {1e-6, 1e-9, 1e-12}) {
            SCOPED_TRACE(std::to_string(s.count) + " from " + std::to_string(s.angle) + " error " +
                         std::to_string(error));
            const Trajectory run = simulate(row.scene, {.until = 2.0, .error = error});
            const auto& events = run.events();
            ASSERT_EQ(events.size(), truth.passes.size() * static_cast<std::size_t>(s.count));
            for (std::size_t k = 0; k < events.size(); ++k) {
                EXPECT_EQ(events[k].kind, EventKind::singular);
                const std::size_t one = k % static_cast<std::size_t>(s.count);
                EXPECT_EQ(events[k].name, "constraint " + std::to_string(one + 1));
                EXPECT_NEAR(events[k].time, truth.passes[k / static_cast<std::size_t>(s.count)], error * 2.0 + 1e-12);
                // of one passage all have its time
                EXPECT_EQ(events[k].time, events[k - one].time);
            }
            for (const auto crank : row.cranks)
                EXPECT_NEAR(run[crank].angle(2.0), truth.run[truth.bob].angle(2.0), 10.0 * error + 1e-12);
        }
    }
}

TEST(SingularPassages, random_parallelograms_thrown_through_flat_tell_of_every_passage) {
    const bool table = std::getenv("RBDYN_TEST_TABLE") != nullptr;
    int refused = 0, count = 0;
    std::size_t passes = 0;
    for (int seed = 0; seed < setting("RBDYN_TEST_SINGULAR", 12); ++seed) {
        Random random(static_cast<std::uint64_t>(7100 + seed));
        const double crank = random.uniform(0.5, 2.0), coupler = random.uniform(0.5, 2.0),
                     width = random.uniform(0.5, 2.5), from = random.uniform(-1.2, -0.3),
                     beyond = std::pow(10.0, random.uniform(-4.5, -1.0)), until = random.uniform(0.4, 2.5);
        const Row plain(1, crank, coupler, width, from, 0.0);
        const Row row(1, crank, coupler, width, from, rate_to_turn(plain, beyond));
        const Row::Truth truth = row.truth(until);
        for (const double error : {1e-6, 1e-9, 1e-12}) {
            SCOPED_TRACE("seed " + std::to_string(7100 + seed) + " error " + std::to_string(error));
            ++count;
            try {
                const Trajectory run = simulate(row.scene, {.until = until, .error = error});
                const auto times = run.events().times("singular");
                ASSERT_EQ(times.size(), truth.passes.size());
                passes += times.size();
                const double known = 1e-12 / std::sqrt(2.0 * row.weight / row.moment * beyond);
                for (std::size_t k = 0; k < times.size(); ++k)
                    EXPECT_NEAR(times[k], truth.passes[k], error * until + known);
                EXPECT_NEAR(run[row.cranks[1]].angle(until), truth.run[truth.bob].angle(until), error * 2.0 * pi);
            } catch (const std::exception& e) {
                ++refused;
                if (table) std::cout << e.what() << "\n";
            }
        }
    }
    if (table) std::cout << count << " runs, " << passes << " passages, " << refused << " refused\n";
    EXPECT_EQ(refused, 0);
}

/// Where a run is compared may be the very place at which forces are infinite: that is no error of the motion.
TEST(SingularPassages, forces_at_the_place_itself_are_not_what_a_motion_is_judged_by) {
    // without gravity all turn at the rate they have: flat where the angle is pi
    Scene scene;
    const auto left = scene.add(bar(1, 1, 0.1), Revolute{.axis = z}, {.angle = 2.0, .rate = 1.0}),
               top = scene.add(bar(1, 2, 0.1), Revolute{.axis = z, .at = {1, 0, 0}},
                               {.angle = -2.0, .rate = -1.0, .parent = left}),
               right = scene.add(bar(3, 1, 0.1), Revolute{.axis = z, .at = {2, 0, 0}}, {.angle = 2.0, .rate = 1.0});
    scene.constrain(Ball{}, top.point({2, 0, 0}), right.point({1, 0, 0}));
    for (const double away : {0.0, 1e-12, 1e-9, -1e-6})
        for (const double error : {1e-6, 1e-9}) {
            const double until = pi - 2.0 + away;
            const Trajectory run = simulate(scene, {.until = until, .error = error});
            EXPECT_NEAR(run[right].angle(until), 2.0 + until, error * pi) << away << " " << error;
        }
}

}  // namespace singular_passages
}  // namespace rbdyn::test
