// Members whose series are expanded side by side: each has the bits that it has alone, whatever its steps are, whatever
// happens to it and whoever is beside it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "many/same_run.hpp"
#include "many/varied.hpp"
#include "random.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/abreast.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/series_abreast.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/passes.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/rbdyn.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_abreast {
namespace {

using namespace varied;

/// The same where all of a run is kept and where some times are.
void expect_same_numbers(const Attempt& a, const Attempt& b) {
    if (a.outcome == simulating::Outcome::thrown || b.outcome == simulating::Outcome::thrown) {
        EXPECT_EQ(a.outcome, b.outcome);
        return;
    }
    if (a.run.data()->asked.keep.what == Keep::What::all) return expect_same_run(a, b);
    EXPECT_EQ(a.message, b.message);
    EXPECT_EQ(a.run.status(), b.run.status());
    EXPECT_EQ(a.run.end(), b.run.end());
    EXPECT_EQ(a.run.error(), b.run.error());
    EXPECT_EQ(a.run.statistics().steps, b.run.statistics().steps);
    std::vector<double> times = a.run.data()->asked.keep.times;
    times.push_back(a.run.end());
    for (std::size_t i = 0; i < a.run.scene().bodies().size(); ++i)
        for (const double t : times) {
            if (t > a.run.end()) continue;
            const BodyHandle body{static_cast<int>(i)};
            EXPECT_EQ(a.run[body].position(t), b.run[body].position(t));
            EXPECT_EQ(a.run[body].velocity(t), b.run[body].velocity(t));
        }
}

/// Whether members have the bits, the counts and the messages that they have one after the other.
void expect_same(const std::vector<Member>& many, std::size_t count, const std::function<Attempt(std::size_t)>& alone) {
    ASSERT_EQ(many.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
        SCOPED_TRACE(i);
        std::optional<Attempt> own;
        const std::string refused = refusal([&] { own = alone(i); });
        if (!own) {
            EXPECT_EQ(refusal([&] { (void)many[i].run(); }), refused);
            continue;
        }
        ASSERT_TRUE(many[i].attempt);
        const Attempt& run = *many[i].attempt;
        expect_same_numbers(run, *own);
        if (run.outcome == simulating::Outcome::thrown) continue;
        const Statistics &a = run.run.statistics(), &b = own->run.statistics();
        EXPECT_EQ(a.runs, b.runs);
        EXPECT_EQ(a.rejected, b.rejected);
        EXPECT_EQ(a.right_hand_sides, b.right_hand_sides);
        EXPECT_EQ(a.jacobians, b.jacobians);
        EXPECT_EQ(a.guard_evaluations, b.guard_evaluations);
        EXPECT_EQ(a.changes, b.changes);
        EXPECT_GT(a.integration_seconds, 0.0);
        EXPECT_GE(a.seconds, a.integration_seconds);
    }
}

void expect_same(const std::vector<Scene>& scenes, const SimulateOptions& options, int threads = 1) {
    expect_same(
        simulate_many(scenes.size(), [&](std::size_t i) { return scenes[i]; }, {.run = options, .threads = threads}),
        scenes.size(), [&](std::size_t i) { return attempt(scenes[i], options); });
}

TEST(Abreast, members_of_all_kinds_have_the_bits_that_they_have_alone) {
    const Keep end{Keep::What::end, {}}, times{Keep::What::times, {0.1, 0.3}};
    const SimulateOptions ways[] = {{.until = 0.5, .rtol = 1e-10},
                                    {.until = 0.5, .error = 1e-8},
                                    {.until = 0.75, .rtol = 1e-14, .engine = "taylor", .keep = end},
                                    {.until = 0.5, .error = 1e-11, .engine = "taylor", .keep = times}};
    for (const Kind& kind : kinds()) {
        SCOPED_TRACE(kind.name);
        Random random(11);
        int way = 0;
        for (const SimulateOptions& options : ways) {
            SCOPED_TRACE(++way);
            std::vector<Scene> scenes;
            for (int i = 0; i < 18; ++i) scenes.push_back(started_elsewhere(random, kind.scene));
            expect_same(scenes, options);
        }
    }
}

TEST(Abreast, steps_of_members_may_be_of_very_different_lengths) {
    std::vector<Scene> scenes;
    for (int i = 0; i < 25; ++i) {
        Scene& scene = scenes.emplace_back(down);
        scene.add(RigidBody(0.5, Inertia{0.0022, 0.0019, 0.001}), Spherical{.point = {0.01, 0.005, -0.05}},
                  SphericalStart{.angular_velocity = Vector3(0.1, 0.2, std::pow(10.0, -3.0 + 0.25 * i))});
    }
    const std::vector<Member> many =
        simulate_many(scenes.size(), [&](std::size_t i) { return scenes[i]; }, {.run = {.until = 0.25, .rtol = 1e-10}});
    EXPECT_GT(many.back().run().statistics().steps, 40 * many.front().run().statistics().steps);
    for (const int threads : {1, 2, 3}) expect_same(scenes, {.until = 0.25, .rtol = 1e-10}, threads);
    expect_same(scenes, {.until = 0.05, .error = 1e-9});
}

TEST(Abreast, members_end_fail_and_are_refused_for_themselves) {
    // two bodies: some meet, some are stopped on their way, one after the other; one is too fast for its square
    std::vector<Scene> scenes;
    for (int i = 0; i < 24; ++i) {
        Scene& scene = scenes.emplace_back();
        const double speed = i % 4 == 0 ? 0.0 : 0.3 + 0.05 * i;
        const BodyHandle a = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, i == 7 ? 1e151 : speed, 0}}),
                         b = scene.add(Particle{1.0}, FreeStart{});
        scene.connect(Gravitation{1.0}, a, b);
        if (i % 3 == 1)
            scene.watch("far", WatchFunction([=](const Now& now) { return now[a].position()[0] - 0.02 * i; }),
                        {.action = {.kind = WatchAction::Kind::stop}});
    }
    expect_same(scenes, {.until = 2.0, .rtol = 1e-11});
    expect_same(scenes, {.until = 2.0, .error = 1e-8});
    // and those that take too many steps
    expect_same(scenes, {.until = 2.0, .rtol = 1e-11, .max_steps = 20});
}

TEST(Abreast, members_are_in_modes_of_their_own) {
    std::vector<Scene> scenes;
    for (int i = 0; i < 21; ++i) {
        Scene& scene = scenes.emplace_back(down);
        scene.add(Particle{1.0}, Rail(hoop, Coulomb{0.3, 0.2}), RailStart{.parameter = 2.0, .speed = 0.3 * i - 3.0});
    }
    expect_same(scenes, {.until = 6.0, .error = 1e-9}, 2);
    std::vector<Scene> bouncing;
    for (int i = 0; i < 13; ++i) {
        Scene& scene = bouncing.emplace_back(down);
        const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1.0 + 0.1 * i}, {0.5, 0, 0}});
        scene.apply(Drag{0.1, 0.05}, ball);
        scene.contact(ball, Plane{.normal = {0, 0, 1}}, {.restitution = 0.7});
    }
    expect_same(bouncing, {.until = 2.0, .error = 1e-9});
}

TEST(Abreast, programs_with_other_numbers_in_them_go_side_by_side) {
    // the stiffness is a constant of the equations: each is planned anew
    std::vector<Scene> scenes;
    for (int i = 0; i < 12; ++i) {
        Scene& scene = scenes.emplace_back();
        const double stiffness = 1.0 + i;
        const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 0.5, 0}});
        scene.apply(Force([=](const Number&, const Vector& r, const Vector&) {
                        return Vector(r * (-stiffness * dot<Number>(r, r)));
                    }),
                    ball);
    }
    expect_same(scenes, {.until = 3.0, .error = 1e-10});
}

TEST(Abreast, stiff_members_go_to_an_engine_of_their_own) {
    std::vector<Scene> scenes;
    for (int i = 0; i < 6; ++i) {
        Scene& scene = scenes.emplace_back(down);
        const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 0.5, 0}});
        scene.connect(Spring{.stiffness = 1e3, .rest_length = 0.5}, ball, Vector3(0, 0, 0));
        scene.apply(Drag{.linear = std::pow(10.0, i - 1)}, ball);
    }
    const SimulateOptions options{.until = 20.0, .rtol = 1e-8, .keep = {Keep::What::end, {}}};
    expect_same(scenes, options);
    EXPECT_FALSE(attempt(scenes.back(), options).run.statistics().changes.empty());
}

TEST(Abreast, actions_see_the_numbers_of_their_member) {
    Parameter gain(1.0, "gain");
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}, {0, 0, 0}});
    scene.apply(Drag{0.1, 0.05}, ball);
    const WatchAction bounce{WatchAction::Kind::change, [=](const Observe& now) {
                                 Vector3 v;
                                 for (int i = 0; i < 3; ++i)
                                     v[i] = -gain.value() * now({Quantity::velocity, ball.index, i});
                                 return std::vector<StateChange>{{.body = ball, .velocity = v}};
                             }};
    scene.watch("floor", WatchFunction([=](const Now& now) { return now[ball].position()[2]; }),
                {.direction = Direction::falling, .action = bounce});
    std::vector<Variation> members;
    for (int i = 0; i < 10; ++i) members.push_back({.numbers = {{gain, 0.5 + 0.05 * i}}});
    const SimulateOptions options{.until = 0.8, .error = 1e-9};
    expect_same(simulate_many(scene, members, {.run = options, .threads = 2}), members.size(), [&](std::size_t i) {
        const BoundParameters own(members[i].numbers);
        return attempt(scene, options);
    });
}

TEST(Abreast, are_one_after_the_other_if_that_is_asked_for) {
    std::vector<Scene> scenes(9, with_drag());
    for (const bool lanes : {false, true}) {
        const SimulateOptions options{.until = 0.5, .error = 1e-9};
        expect_same(simulate_many(scenes.size(), [&](std::size_t i) { return scenes[i]; },
                                  {.run = options, .threads = 1, .lanes = lanes}),
                    scenes.size(), [&](std::size_t i) { return attempt(scenes[i], options); });
    }
}

TEST(Abreast, expansions_are_made_together) {
    if (Abreast::room() == 0) GTEST_SKIP() << "no vectors of four here";
    const Scene scene = double_pendulum();
    const Plan plan = make_plan(scene);
    const SimulateOptions options{.until = 20.0, .rtol = 1e-10};
    const BoundParameters::Values none;
    std::vector<std::unique_ptr<RunAbreast>> runs;
    std::vector<RunAbreast*> all;
    for (std::size_t i = 0; i < Abreast::room(); ++i) {
        auto engine = std::make_unique<TaylorEngine>(1e-10);
        auto driver = simulating::make_driver(*plan.model, *engine, options, {0.0}, 1e-10, {}, {});
        runs.push_back(std::make_unique<RunAbreast>(std::move(engine), std::move(driver), options.until, none));
        runs.back()->begin(0.0, plan.model->start(0.0));
        all.push_back(runs.back().get());
    }
    Abreast abreast;
    int turns = 0;
    for (; turns < 100'000 && std::any_of(all.begin(), all.end(), [](const RunAbreast* r) { return !r->is_over(); });
         ++turns)
        abreast.turn(all);
    std::int64_t expansions = 0;
    for (const auto& run : runs) {
        EXPECT_EQ(run->record.status, Status::reached_end);
        expansions += run->record.work.steps + run->record.work.rejected;
    }
    EXPECT_GT(expansions, 500);
    // four or eight at once
    EXPECT_LE(4 * turns, expansions + 4);
}

TEST(Abreast, guards_of_members_have_the_sizes_that_they_have_alone) {
    Recorder r;
    const Expression x = r.input(0), v = r.input(1);
    const Expression outputs[] = {v, -sin(x), (x * x + exp(v) * 3.0) * cos(x) - 1e3 * v * v * x};
    Equations e;
    e.program = Program(r, outputs, 2);
    e.groups = {{0, 1, true}, {1, 1, false}};
    Guard guard;
    guard.output = 2;
    e.guards.push_back(guard);
    const double start[] = {0.75, 0.5};
    TaylorEngine alone(1e-10), member(1e-10);
    alone.start(e, {}, {0.0, 0.0}, start);
    member.start(e, {}, {0.0, 0.0}, start);
    ASSERT_EQ(alone.step(1.0), StepStatus::ok);
    ASSERT_FALSE(member.begin_step(1.0));
    SeriesAbreast abreast(e.program, member.order());
    const std::vector<SeriesAbreast::Motion> motions{member.motion()};
    abreast.expand(motions, member.has_guards());
    TaylorEngine* const engines[] = {&member};
    TaylorEngine::take(abreast, engines);
    ASSERT_EQ(member.end_step(), StepStatus::ok);
    std::vector<double> own(static_cast<std::size_t>(alone.guard_order()) + 1), sizes(own.size());
    alone.guard_sizes(0, own.data());
    member.guard_sizes(0, sizes.data());
    EXPECT_EQ(sizes, own);
    for (int k = 0; k <= alone.guard_order(); ++k) EXPECT_EQ(member.guard(0)[k], alone.guard(0)[k]) << k;
}

TEST(Abreast, runs_made_ahead_are_those_of_their_tolerance_and_manner) {
    simulating::Ahead ahead;
    const simulating::Pass coarse{.tolerance = 1e-8}, fine{.tolerance = 1e-10};
    simulating::Pass otherwise = coarse;
    otherwise.manner.stride = 0.5 * coarse.manner.stride;
    simulating::Timed first, second;
    first.record.end = {1.0, 0.0};
    second.record.end = {2.0, 0.0};
    ahead.add(coarse, first);
    ahead.add(fine, second);
    EXPECT_FALSE(ahead.take(otherwise));
    const auto found = ahead.take(fine);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->record.end.hi, 2.0);
    EXPECT_FALSE(ahead.take(fine));
    EXPECT_EQ(ahead.take(coarse)->record.end.hi, 1.0);
}

}  // namespace
}  // namespace rbdyn::test::test_abreast
