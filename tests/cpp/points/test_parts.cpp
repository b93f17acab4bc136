// Scenes in parts: each is solved as the scene it would be alone, and the run is one.
#include <gtest/gtest.h>

#include <functional>
#include <numeric>

#include "rbdyn/body/shapes.hpp"
#include "rbdyn/cost.hpp"
#include "support.hpp"

namespace rbdyn::test::test_parts {
namespace {

using Add = std::function<BodyHandle(Scene&)>;

/// -4 r, called back.
Force called_back_spring() {
    auto callback = std::make_shared<Callback>();
    callback->name = "spring";
    callback->inputs = 7;
    callback->outputs = 3;
    callback->function = [](const double* x, double* y) {
        for (int i = 0; i < 3; ++i) y[i] = -4.0 * x[1 + i];
    };
    return Force(std::shared_ptr<const Callback>(std::move(callback)));
}

/// Most kinds of motion, each of one body: with and without events, in closed form and integrated, called back.
std::vector<Add> kinds_of_motion() {
    std::vector<Add> all;
    all.push_back([](Scene& s) {
        return s.add(Particle{1.0}, Rail(vertical_circle(1.0), Coulomb{0.25, 0.125}), {.parameter = 2.5}, "circle");
    });
    all.push_back([](Scene& s) {
        const BodyHandle b = s.add(Particle{1.0}, Rail(along_x, Coulomb{0.5, 0.25}, {.drive = 0.25}),
                                   {.parameter = 0.125, .speed = 2.0}, "belt");
        s.connect(Spring{.stiffness = 16.0}, b, Vector3(0, 0, 0));
        return b;
    });
    all.push_back([](Scene& s) {
        const BodyHandle b = s.add(Particle{2.0}, {.velocity = {1, 0, 20}}, "thrown");
        s.apply(Drag{.quadratic = 0.125}, b);
        s.watch("highest", [=](const Now& now) { return now[b].velocity()[2]; });
        return b;
    });
    all.push_back([](Scene& s) {
        const RigidBody bar = shapes::rod(1.0, 1.5, {0, 0, 1}).shifted({0, 0, -0.75});
        return s.add(bar, Revolute{.axis = {0, 1, 0}}, {.angle = 1.0}, "pendulum");
    });
    all.push_back([](Scene& s) {
        const RigidBody top(0.5, Vector3(0.002, 0.0015, 0.001), {.com = {0.01, 0.005, 0.05}});
        const BodyHandle b = s.add(top, Spherical{}, {.angular_velocity = Vector3(0.1, 0, 200.0)}, "top");
        s.watch("level", [=](const Now& now) { return now[b].poisson_vector()[0]; });
        return b;
    });
    all.push_back([](Scene& s) {
        const BodyHandle b = s.add(Particle{1.0}, {.position = {1, 0, 0}}, "called back");
        s.apply(called_back_spring(), b);
        return b;
    });
    return all;
}

void expect_same_bits(const Vector3& a, const Vector3& b, const std::string& what) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(a[i], b[i]) << what;
}

/// What a run says of one body, at many times and on both sides of its events.
void expect_same_motion(const Trajectory& a, BodyHandle in_a, const Trajectory& b, BodyHandle in_b) {
    const std::string name = a.scene().bodies()[static_cast<std::size_t>(in_a.index)].name;
    std::vector<double> times;
    for (int i = 0; i <= 50; ++i) times.push_back(a.start() + (a.end() - a.start()) * i / 50);
    for (const Event& e : b.events()) times.push_back(e.time);
    for (const double t : times)
        for (const Side side : {Side::before, Side::after}) {
            const PointReport x = a[in_a].report(t, side), y = b[in_b].report(t, side);
            expect_same_bits(x.position, y.position, name);
            expect_same_bits(x.velocity, y.velocity, name);
            expect_same_bits(x.acceleration, y.acceleration, name);
            expect_same_bits(x.reaction, y.reaction, name);
        }
}

TEST(Parts, are_solved_bit_for_bit_as_scenes_of_their_own_in_any_order) {
    const std::vector<Add> all = kinds_of_motion();
    const SimulateOptions options{.until = 3.0, .error = 1e-10};
    std::vector<Trajectory> alone;
    for (const Add& add : all) {
        Scene scene(down);
        add(scene);
        alone.push_back(simulate(scene, options));
    }
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), 0u);
    for (int turn = 0; turn < 3; ++turn) {
        Scene scene(down);
        std::vector<BodyHandle> handles(all.size());
        for (const std::size_t i : order) handles[i] = all[i](scene);
        const Trajectory run = simulate(scene, options);
        EXPECT_EQ(run.status(), Status::reached_end);
        ASSERT_EQ(run.plan().parts.size(), all.size());
        double error = 0.0;
        std::int64_t steps = 0;
        std::size_t events = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
            expect_same_motion(run, handles[i], alone[i], {0});
            const std::vector<double> theirs = alone[i].events().times("watch"),
                                      here = i == 2   ? run.events().times("highest")
                                             : i == 4 ? run.events().times("level")
                                                      : std::vector<double>{};
            EXPECT_EQ(here, theirs);
            for (const Event& e : alone[i].events())
                if (e.subject == 0) {
                    const auto found = run.events().times(std::string(name_of(e.kind)), handles[i]);
                    EXPECT_EQ(std::count(found.begin(), found.end(), e.time), 1) << e;
                }
            error = std::max(error, *alone[i].error());
            steps += alone[i].statistics().steps;
            events += alone[i].events().size();
            EXPECT_EQ(run.work(0.5, 2.5, {handles[i]}), alone[i].work(0.5, 2.5));
        }
        EXPECT_EQ(run.events().size(), events);
        EXPECT_TRUE(std::is_sorted(run.events().begin(), run.events().end(),
                                   [](const Event& a, const Event& b) { return a.time < b.time; }));
        EXPECT_EQ(run.error(), error);
        EXPECT_EQ(run.statistics().steps, steps);
        EXPECT_EQ(run.statistics().events, static_cast<std::int64_t>(events));
        std::rotate(order.begin(), order.begin() + 2, order.end());
        std::swap(order[0], order[1]);
    }
}

TEST(Parts, together_have_the_sums_of_their_energies_momenta_and_times) {
    Scene scene(down);
    std::vector<BodyHandle> handles;
    for (const Add& add : kinds_of_motion()) handles.push_back(add(scene));
    const Trajectory run = simulate(scene, {.until = 3.0});
    const double t = 1.75;
    double kinetic = 0.0;
    Vector3 momentum = Vector3::Zero();
    for (const BodyHandle b : handles) {
        kinetic += run.kinetic_energy(t, {b});
        momentum += run.momentum(t, {b});
    }
    EXPECT_NEAR(run.kinetic_energy(t), kinetic, 1e-14 * kinetic);
    EXPECT_LE((run.momentum(t) - momentum).norm(), 1e-14 * momentum.norm());
    EXPECT_NEAR(run.work(0.0, 3.0), run.kinetic_energy(3.0) - run.kinetic_energy(0.0), 1e-6 * kinetic);
    const std::vector<double> times = run.t();
    EXPECT_EQ(times.front(), 0.0);
    EXPECT_EQ(times.back(), 3.0);
    for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LT(times[i - 1], times[i]);
}

// --- what is a part ---

/// Two particles; `also` adds what may join them.
std::size_t parts_with(const std::function<void(Scene&, BodyHandle, BodyHandle)>& also) {
    Scene scene(down);
    const BodyHandle a = scene.add(Particle{1.0}, {.position = {1, 0, 0}}), b = scene.add(Particle{2.0});
    also(scene, a, b);
    const Plan plan = make_plan(scene);
    EXPECT_EQ(plan.model == nullptr, !plan.parts.empty());
    return std::max<std::size_t>(plan.parts.size(), 1);
}

TEST(Parts, are_joined_by_couplings_and_by_functions_that_look_at_several_bodies_and_by_nothing_else) {
    using Handle = BodyHandle;
    const auto apart = [](const Now& now) { return now.time() - 0.5; };
    EXPECT_EQ(parts_with([](Scene&, Handle, Handle) {}), 2u);
    EXPECT_EQ(parts_with([](Scene& s, Handle a, Handle b) { s.connect(Spring{.stiffness = 1.0}, a, b); }), 1u);
    EXPECT_EQ(parts_with([](Scene& s, Handle a, Handle b) { s.connect(Spring{.rest_length = 1.0}, a, b); }), 2u);
    EXPECT_EQ(parts_with([](Scene& s, Handle a, Handle b) {
                  for (const Handle h : {a, b}) s.connect(Spring{.stiffness = 1.0}, h, Vector3(0, 0, 0));
              }),
              2u);
    EXPECT_EQ(parts_with([&](Scene& s, Handle, Handle) { s.watch("clock", apart); }), 2u);
    EXPECT_EQ(parts_with([](Scene& s, Handle, Handle b) {
                  s.watch("one", [=](const Now& now) { return now[b].position()[0]; });
              }),
              2u);
    EXPECT_EQ(parts_with([](Scene& s, Handle a, Handle b) {
                  s.watch("both", [=](const Now& now) { return now[b].position()[0] - now[a].position()[0]; });
              }),
              1u);
    EXPECT_EQ(parts_with([](Scene& s, Handle a, Handle b) {
                  const CouplingHandle idle = s.connect(Spring{}, a, b);
                  s.watch("length", [=](const Now& now) { return now[idle].length() - 1.0; });
              }),
              1u);
    EXPECT_EQ(parts_with([](Scene& s, Handle a, Handle b) {
                  s.integral("sum", [=](const Now& now) { return now[b].velocity()[0] + now[a].velocity()[0]; });
              }),
              2u);
    const auto force = [](const auto& t, const auto&, const auto&) {
        using S = std::decay_t<decltype(t)>;
        return Vector3Of<S>{t, S(0.0), S(0.0)};
    };
    EXPECT_EQ(parts_with([&](Scene& s, Handle a, Handle b) {
                  for (const Handle h : {a, b}) s.apply(Force(force), h);
              }),
              2u);
    // nobody knows what these look at
    EXPECT_EQ(parts_with([](Scene& s, Handle, Handle) {
                  s.watch("opaque", WatchFunction::called_back([](const Observe&) { return 1.0; }, "test"));
              }),
              1u);
    EXPECT_EQ(
        parts_with([&](Scene& s, Handle, Handle) {
            s.watch("kick", apart,
                    {.action = {WatchAction::Kind::change, [](const Observe&) { return std::vector<StateChange>{}; }}});
        }),
        1u);
}

TEST(Parts, of_three_bodies_two_may_be_one) {
    Scene scene(down);
    const BodyHandle a = scene.add(Particle{1.0}, {.position = {1, 0, 0}}, "a");
    const BodyHandle b = scene.add(Particle{2.0}, FreeStart{}, "b");
    const BodyHandle c = scene.add(Particle{3.0}, {.velocity = {0, 1, 0}}, "c");
    const CouplingHandle idle = scene.connect(Spring{}, a, b);
    const CouplingHandle spring = scene.connect(Spring{.stiffness = 5.0}, c, a);
    scene.watch("passes b", [=](const Now& now) { return now[b].position()[2] + 1.0; });
    scene.integral("turning", [=](const Now& now) {
        return now[a].position()[0] * now[c].velocity()[1] + now[b].velocity()[0] + now.time() * 0.0;
    });
    const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-12});
    ASSERT_EQ(run.plan().parts.size(), 2u);
    EXPECT_NE(run.plan().reason.find("2 parts, solved apart: a + c (closed form), b (taylor)"), std::string::npos)
        << run.plan();
    EXPECT_NEAR(run.events().times("passes b").at(0), std::sqrt(2.0 / gravity), 1e-14);
    for (const double t : {0.0, 0.75, 2.0}) {
        EXPECT_EQ(run[idle].length(t), (run[a].position(t) - run[b].position(t)).norm());
        EXPECT_EQ(run[idle].force(t).norm(), 0.0);
        EXPECT_EQ(run[spring].length(t), (run[c].position(t) - run[a].position(t)).norm());
        EXPECT_LE((run[spring].force(t) + 5.0 * (run[c].position(t) - run[a].position(t))).norm(), 1e-14);
        EXPECT_EQ(run.integral("turning", t), run[a].position(t)[0] * run[c].velocity(t)[1] + run[b].velocity(t)[0]);
    }
    EXPECT_EQ(run.work(0.0, 2.0, idle), 0.0);
    EXPECT_LE(run.drift().at("energy"), 1e-13);
    EXPECT_LE(run.drift().at("momentum x"), 1e-13);
}

// --- events ---

/// Two beads that slide to rest alike, and a watch on the speed of the second.
Scene stopping(bool joined) {
    Scene scene(down);
    for (const char* name : {"one", "two"})
        scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5, 0.25}), {.speed = 2.0}, name);
    const BodyHandle one{0}, two{1};
    scene.watch("slow", [=](const Now& now) { return now[two].speed() - 1.0; });
    scene.watch("slow too", [=](const Now& now) { return now[one].speed() - 1.0; });
    if (joined) scene.watch("join", [=](const Now& now) { return now[one].speed() + now[two].speed() + 1.0; });
    return scene;
}

TEST(Parts, list_what_happens_at_one_instant_in_the_order_of_events_of_one) {
    const Trajectory apart = simulate(stopping(false), {.until = 3.0}),
                     joined = simulate(stopping(true), {.until = 3.0});
    ASSERT_EQ(apart.plan().parts.size(), 2u);
    ASSERT_TRUE(joined.plan().parts.empty());
    ASSERT_EQ(kinds(apart), "watch watch stick stick");
    ASSERT_EQ(kinds(joined), kinds(apart));
    EXPECT_EQ(apart.events()[0].time, apart.events()[1].time);
    EXPECT_EQ(apart.events()[2].time, apart.events()[3].time);
    EXPECT_EQ(apart.events()[2].subject, 0);
    EXPECT_EQ(apart.events()[3].subject, 1);
}

/// Particles that fly away from the origin along x at their speeds; each is watched at x = 1 and stops the run at x = 2
/// if it is one of `stopping`.
Scene flying(const std::vector<double>& speeds, const std::vector<int>& stopping) {
    Scene scene;
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        const BodyHandle b = scene.add(Particle{1.0}, FreeStart{.velocity = {speeds[i], 0, 0}});
        scene.apply(Drag{.linear = 0.0625}, b);
        const auto passes = [=](double x) { return [=](const Now& now) { return now[b].position()[0] - x; }; };
        scene.watch("passes " + std::to_string(i), passes(1.0));
        if (std::count(stopping.begin(), stopping.end(), static_cast<int>(i)) > 0)
            scene.watch("stops " + std::to_string(i), passes(2.0), {.action = {WatchAction::Kind::stop, {}}});
    }
    return scene;
}

TEST(Parts, end_together_at_the_first_event_that_stops_one) {
    const auto when = [](double speed, double x) { return -16.0 * std::log1p(-0.0625 * x / speed); };
    for (const auto& speeds : {std::vector{3.0, 1.0, 0.25}, {1.0, 3.0, 0.25}, {1.0, 0.25, 3.0}})
        for (const auto& stopping : {std::vector<int>{0, 1, 2}, {2}, {1, 0}}) {
            double fastest = 0.0;
            for (const int i : stopping) fastest = std::max(fastest, speeds[static_cast<std::size_t>(i)]);
            const double end = when(fastest, 2.0);
            const Trajectory run = simulate(flying(speeds, stopping), {.until = 40.0, .error = 1e-12});
            ASSERT_EQ(run.plan().parts.size(), 3u);
            EXPECT_EQ(run.status(), Status::stopped_by_event);
            EXPECT_NEAR(run.end(), end, 1e-12 * end);
            EXPECT_EQ(run.certain_until(), run.end());
            EXPECT_EQ(run.events().back().time, run.end());
            std::size_t passed = 1;
            for (std::size_t i = 0; i < 3; ++i) {
                const BodyHandle b{static_cast<int>(i)};
                passed += when(speeds[i], 1.0) < end;
                EXPECT_NEAR(run[b].position(run.end())[0], -16.0 * speeds[i] * std::expm1(-0.0625 * end), 1e-11);
                EXPECT_THROW((void)run[b].position(run.end() + 1e-6), InvalidInput);
                // as a scene of its own until then
                const Trajectory alone = simulate(flying({speeds[i]}, {}), {.until = run.end(), .error = 1e-12});
                if (run.events().back().name != "stops " + std::to_string(i)) expect_same_motion(run, b, alone, {0});
            }
            EXPECT_EQ(run.events().size(), passed) << run.events().size();
        }
}

TEST(Parts, that_stop_at_one_instant_both_say_so) {
    const Trajectory run = simulate(flying({3.0, 0.5, 3.0}, {0, 1, 2}), {.until = 40.0});
    ASSERT_EQ(run.events().size(), 4u);
    EXPECT_EQ(run.events()[2].name, "stops 0");
    EXPECT_EQ(run.events()[3].name, "stops 2");
    EXPECT_EQ(run.status(), Status::stopped_by_event);
}

// --- failures ---

TEST(Parts, of_which_one_misses_the_error_make_one_run_that_says_so) {
    Scene scene(down);
    const BodyHandle easy = scene.add(Particle{1.0}, {.velocity = {1, 0, 0}}, "easy");
    const RigidBody body(1.0, Vector3(1.0, 2.0, 3.0));
    const BodyHandle hard = scene.add(body, {.angular_velocity = Vector3(1e-9, 1.0, 1e-9)}, "hard");
    const SimulateOptions options{.until = 60.0, .error = 4e-15, .engine = "dop853"};
    const Attempt result = attempt(scene, options);
    ASSERT_EQ(result.outcome, simulating::Outcome::inaccurate);
    EXPECT_NE(result.message.find("hard"), std::string::npos) << result.message;
    EXPECT_EQ(result.message.find("easy"), std::string::npos) << result.message;
    EXPECT_EQ(result.run.status(), Status::accuracy_not_reached);
    EXPECT_EQ(result.run.end(), 60.0);
    Scene only;
    only.set_gravity(down);
    only.add(body, {.angular_velocity = Vector3(1e-9, 1.0, 1e-9)});
    const Attempt alone = attempt(only, options);
    EXPECT_EQ(result.run.certain_until(), alone.run.certain_until());
    EXPECT_EQ(result.run.error(), alone.run.error());
    EXPECT_NEAR(result.run[easy].position(60.0)[0], 60.0, 1e-12);
    expect_same_motion(result.run, hard, alone.run, {0});
}

TEST(Parts, end_where_the_motion_of_one_breaks_off) {
    for (const bool is_first : {true, false}) {
        Scene scene;
        const auto steady = [&] { return scene.add(Particle{1.0}, {.velocity = {1, 0, 0}}, "steady"); };
        if (!is_first) steady();
        const BodyHandle b = scene.add(Particle{1.0}, {.position = {1, 0, 0}}, "bursting");
        scene.apply(Force([](const auto&, const auto& r, const auto&) {
                        using S = std::decay_t<decltype(r[0])>;
                        return Vector3Of<S>{r[0] * r[0] * r[0], S(0.0), S(0.0)};
                    }),
                    b);
        if (is_first) steady();
        const Attempt result = attempt(scene, {.until = 10.0});
        EXPECT_EQ(result.outcome, simulating::Outcome::broken);
        EXPECT_EQ(result.run.status(), Status::not_finite);
        EXPECT_LT(result.run.end(), 3.0);
        EXPECT_EQ(result.run.t().back(), result.run.end());
        EXPECT_NEAR(result.run.momentum(1.0)[0], 1.0 + result.run[b].velocity(1.0)[0], 1e-14);
    }
}

TEST(Parts, of_an_interrupted_run_are_there_as_far_as_they_were_solved) {
    Scene scene(down);
    std::vector<BodyHandle> handles;
    for (const Add& add : kinds_of_motion()) handles.push_back(add(scene));
    Scene pendulum(down);
    kinds_of_motion()[3](pendulum);
    SimulateOptions options{.until = 100.0, .rtol = 1e-12};
    options.monitor = [](double) { return false; };
    const Trajectory run = simulate(scene, options);
    EXPECT_EQ(run.status(), Status::stopped_by_user);
    EXPECT_EQ(run.certain_until(), 0.0);
    for (const BodyHandle b : handles) EXPECT_TRUE(std::isfinite(run[b].velocity(run.end()).norm()));
    EXPECT_NEAR(run[handles[3]].angle(100.0), simulate(pendulum, {.until = 100.0})[BodyHandle{0}].angle(100.0), 0.0);
}

TEST(Parts, stop_at_the_limit_of_steps_of_one) {
    Scene scene(down);
    std::vector<BodyHandle> handles;
    for (const Add& add : kinds_of_motion()) handles.push_back(add(scene));
    const Trajectory run = simulate(scene, {.until = 100.0, .rtol = 1e-12, .max_steps = 40});
    EXPECT_EQ(run.status(), Status::step_limit);
    EXPECT_GT(run.end(), 0.0);
    EXPECT_LT(run.end(), 100.0);
    EXPECT_TRUE(std::isfinite(run.kinetic_energy(run.end())));
    for (const Event& e : run.events()) EXPECT_LE(e.time, run.end());
}

// --- options ---

TEST(Parts, keep_what_is_asked_for) {
    Scene scene(down);
    std::vector<BodyHandle> handles;
    for (const Add& add : kinds_of_motion()) handles.push_back(add(scene));
    const Trajectory all = simulate(scene, {.until = 3.0});
    const Trajectory end = simulate(scene, {.until = 3.0, .keep = {Keep::What::end, {}}});
    const Trajectory some = simulate(scene, {.until = 3.0, .keep = {Keep::What::times, {0.5, 1.5}}});
    for (const BodyHandle b : handles) {
        EXPECT_LE((end[b].position(3.0) - all[b].position(3.0)).norm(), 1e-8);
        for (const double t : {0.5, 1.5}) EXPECT_LE((some[b].position(t) - all[b].position(t)).norm(), 1e-8);
    }
    EXPECT_THROW((void)end[handles[0]].position(1.0), InvalidInput);
    EXPECT_THROW((void)some.kinetic_energy(1.0), InvalidInput);
}

TEST(Parts, are_each_asked_whether_the_engine_named_can_do_them) {
    Scene scene(down);
    const std::vector<Add> all = kinds_of_motion();
    all[0](scene);
    all[3](scene);
    EXPECT_EQ(simulate(scene, {.until = 1.0}).engine(), "taylor, closed form");
    EXPECT_EQ(simulate(scene, {.until = 1.0, .engine = "dop853"}).engine(), "dop853");
    EXPECT_THROW((void)simulate(scene, {.until = 1.0, .engine = "closed form"}), InvalidInput);
    all[5](scene);
    EXPECT_EQ(make_plan(scene).engine, "taylor, closed form, dop853");
    EXPECT_THROW((void)simulate(scene, {.until = 1.0, .engine = "taylor"}), InvalidInput);
    // a particle falls in closed form beside bodies that have one
    Scene closed(down);
    all[3](closed);
    const BodyHandle ball = closed.add(Particle{1.0});
    const Trajectory run = simulate(closed, {.until = 1.0, .engine = "closed form"});
    EXPECT_EQ(run.plan().parts.size(), 2u);
    EXPECT_EQ(run[ball].position(1.0)[2], -0.5 * gravity);
}

TEST(Parts, cost_what_they_cost_alone) {
    const std::vector<Add> all = kinds_of_motion();
    const CostOptions options{.until = 1.0, .errors = {1e-6}, .engines = {"dop853"}, .budget = 0.05};
    Scene scene(down);
    std::int64_t steps = 0;
    for (const int i : {0, 1, 2}) {
        Scene alone(down);
        all[static_cast<std::size_t>(i)](alone);
        steps += cost(alone, options).rows.front().steps;
        all[static_cast<std::size_t>(i)](scene);
    }
    EXPECT_EQ(cost(scene, options).rows.front().steps, steps);
}

}  // namespace
}  // namespace rbdyn::test::test_parts
