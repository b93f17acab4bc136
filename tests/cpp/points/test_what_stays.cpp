// What stays as it starts is not simulated: which variables that are, and that no result tells.
#include <gtest/gtest.h>

#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/special/special_model.hpp"
#include "support.hpp"

namespace rbdyn::test::test_what_stays {
namespace {

/// Variables that are simulated, and of the whole scene, as "4 of 6".
std::string simulated(const Plan& plan) {
    const auto [simulated, all] = plan.variables();
    return std::to_string(simulated) + " of " + std::to_string(all);
}
std::string simulated(const Scene& scene) { return simulated(make_plan(scene)); }

/// The largest difference of any variable from the motion with all variables simulated, relative to the largest of any.
double difference(const Scene& scene, double until, const std::string& engine = "taylor") {
    const Plan plan = make_plan(scene);
    const SpecialModel all(scene, plan.view);
    const SimulateOptions options{.until = until};
    const auto run = [&](const SceneModel& model) {
        return simulating::integrate(model, model.start(), options, engine, 1e-12, {}).record;
    };
    const Record reduced = run(*plan.model), whole = run(all);
    EXPECT_LT(reduced.variables, whole.variables);
    EXPECT_EQ(reduced.end.hi, whole.end.hi);
    double worst = 0.0, size = 0.0;
    for (int k = 0; k <= 100; ++k) {
        const double t = std::min(until * k / 100.0, whole.end.hi);
        const std::vector<double> y = state_at(whole, t, Side::after);
        std::vector<double> x(y.size());
        plan.model->map().spread(state_at(reduced, t, Side::after), x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            worst = std::max(worst, std::abs(x[i] - y[i]));
            size = std::max(size, std::abs(y[i]));
        }
    }
    return worst / size;
}

const RigidBody box(2.0, {0.25, 0.5, 0.625});
const BodyStart thrown{.position = {0, 0, 10}, .velocity = {20, 0, 15}};

Scene planar_box() {
    Scene scene(down);
    BodyStart start = thrown;
    start.angular_velocity = Vector3(0, 1, 0);
    scene.apply(Drag{.linear = 0.125, .quadratic = 0.03125}, scene.add(box, start), Vector3(0.03125, 0, 0.125));
    return scene;
}

TEST(WhatStays, a_throw_in_a_plane_has_no_third_coordinate) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 7, 10}, {20, 0, 15}}, "ball");
    scene.apply(Drag{.linear = 0.125, .quadratic = 0.03125}, ball);
    EXPECT_EQ(simulated(scene), "4 of 6");
    for (const char* engine : {"taylor", "dop853"}) EXPECT_EQ(difference(scene, 3.0, engine), 0.0);
    const Trajectory run = simulate(scene, {.until = 3.0});
    EXPECT_EQ(run[ball].position(2.0).y(), 7.0);
    EXPECT_EQ(run[ball].acceleration(2.0).y(), 0.0);
    EXPECT_EQ(run.plan().coordinates, std::vector<std::string>{"ball: x, z in the world"});
    // a wind across brings it in
    scene.apply(Force(Vector3(0, 1, 0)), ball);
    EXPECT_EQ(simulated(scene), "6 of 6");
}

TEST(WhatStays, two_particles_on_a_spring_stay_in_the_plane_they_start_in) {
    Scene scene;
    const BodyHandle a = scene.add(Particle{1.0}, FreeStart{{0, 0, 3}, {0, 1, 0}});
    const BodyHandle b = scene.add(Particle{2.0}, FreeStart{{1, 0, 3}, {0.25, -0.5, 0}});
    scene.connect(Spring{.stiffness = 30.0, .rest_length = 0.75}, a, b);
    EXPECT_EQ(simulated(scene), "8 of 12");
    EXPECT_EQ(difference(scene, 5.0), 0.0);
    EXPECT_LT(simulate(scene, {.until = 5.0, .error = 1e-12}).drift().at("angular momentum"), 1e-12);
}

TEST(WhatStays, a_motion_that_comes_along_a_chain_reaches_all_of_it_and_leaves_its_plane_to_none) {
    Scene scene;
    std::vector<BodyHandle> links;
    for (int i = 0; i < 8; ++i)
        links.push_back(scene.add(Particle{1.0}, FreeStart{{1.0 * i, 0, 0}, {0, i == 0 ? 0.5 : 0.0, 0}}));
    for (std::size_t i = 1; i < links.size(); ++i)
        scene.connect(Spring{.stiffness = 8.0, .rest_length = 1.0}, links[i - 1], links[i]);
    EXPECT_EQ(simulated(scene), "32 of 48");
    // products of zero are no longer summed in between
    EXPECT_LT(difference(scene, 4.0), 4.0 * epsilon);
    // one at rest far away in balance is no part of it
    scene.add(Particle{1.0}, FreeStart{{0, 0, 5}});
    EXPECT_EQ(simulated(scene), "32 of 54");
}

TEST(WhatStays, on_a_line_a_spring_may_pass_its_anchor_without_loss) {
    Scene scene;
    const BodyHandle a = scene.add(Particle{1.0}, FreeStart{{1, 0, 0}});
    scene.connect(Spring{.stiffness = 30.0, .rest_length = 0.25}, a, Vector3(0, 0, 0));
    EXPECT_EQ(simulated(scene), "2 of 6");
    const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-12});
    EXPECT_EQ(kinds(run), "switch switch switch switch");
    EXPECT_EQ(run.events()[0].name, "length of a spring");
    EXPECT_LT(run.drift().at("energy"), 1e-12);
}

TEST(WhatStays, forces_through_the_centre_of_mass_turn_nothing) {
    Scene scene(down);
    const BodyHandle body = scene.add(box, thrown);
    scene.apply(Drag{.linear = 0.125, .quadratic = 0.03125}, body);
    const Plan plan = make_plan(scene);
    EXPECT_EQ(simulated(plan), "4 of 13");
    EXPECT_FALSE(plan.has("rotation"));
    EXPECT_EQ(difference(scene, 3.0), 0.0);
    const Trajectory run = simulate(scene, {.until = 3.0});
    EXPECT_EQ(run[body].angular_velocity(2.0).norm(), 0.0);
    // off it, they do
    scene.apply(Drag{.linear = 0.125}, body, Vector3(0, 0.25, 0.25));
    EXPECT_EQ(simulated(scene), "13 of 13");
    EXPECT_TRUE(make_plan(scene).has("rotation"));
}

TEST(WhatStays, a_body_that_turns_in_a_plane_has_one_angular_velocity) {
    const Scene scene = planar_box();
    EXPECT_EQ(simulated(scene), "7 of 13");
    // constants are put together in another order
    for (const char* engine : {"taylor", "dop853"}) EXPECT_LT(difference(scene, 3.0, engine), 1e-13);
    EXPECT_EQ(make_plan(scene).coordinates[0], "body 1: centre of mass x, z; q0, q2 of its attitude");
}

TEST(WhatStays, a_permanent_rotation_keeps_its_angular_velocity_also_where_it_is_unstable) {
    for (int axis = 0; axis < 3; ++axis) {
        Scene scene;
        Vector3 omega(0, 0, 0);
        omega[axis] = 3.0;
        const BodyHandle body = scene.add(RigidBody(1.0, {1, 2, 3}), BodyStart{.angular_velocity = omega});
        EXPECT_EQ(simulated(scene), "2 of 13");
        const Trajectory run = simulate(scene, {.until = 100.0, .error = 1e-12, .engine = "taylor"});
        EXPECT_EQ(run[body].angular_velocity(100.0), omega);
        EXPECT_NEAR(run[body].quaternion(100.0).w, std::cos(150.0), 1e-13);
        EXPECT_EQ(difference(scene, 10.0), 0.0);
    }
}

TEST(WhatStays, where_nothing_moves_a_run_comes_to_its_end) {
    Scene scene;
    const BodyHandle ball = scene.add(Particle{2.0}, FreeStart{{1, 2, 3}});
    const BodyHandle body = scene.add(RigidBody(1.0, {1, 2, 3}), BodyStart{.attitude = EulerAngles{0.7, -0.4, 1.3}});
    scene.connect(Spring{.stiffness = 8.0, .rest_length = 5.0}, ball, Vector3(1, 2, -2));
    EXPECT_EQ(simulated(scene), "0 of 19");
    const Matrix3 axes = rotation_matrix(Attitude(EulerAngles{0.7, -0.4, 1.3}).quaternion());
    for (const char* engine : {"auto", "taylor", "dop853"}) {
        const Trajectory run = simulate(scene, {.until = 3.0, .engine = engine});
        EXPECT_EQ(run.status(), Status::reached_end);
        EXPECT_EQ(run.end(), 3.0);
        EXPECT_EQ(run[ball].position(2.0), Vector3(1, 2, 3));
        EXPECT_EQ(run.kinetic_energy(3.0), 0.0);
        EXPECT_LT((run[body].rotation_matrix(3.0) - axes).norm(), 4.0 * epsilon);
        EXPECT_EQ(run.statistics().steps, 0);
    }
    // what is watched happens all the same
    scene.watch("noon", [](const Now& now) { return now.time() - 1.5; });
    for (const char* engine : {"taylor", "dop853"}) {
        const Trajectory run = simulate(scene, {.until = 3.0, .engine = engine});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_NEAR(run.events()[0].time, 1.5, 1e-14);
        EXPECT_EQ(run.end(), 3.0);
    }
}

TEST(WhatStays, what_is_zero_on_one_side_of_a_case_is_simulated) {
    Scene scene;
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{});
    scene.apply(Force([](const auto& t, const auto&, const auto&) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{S(0.0), S(0.0), where(t > 1.0, S(2.0), S(0.0))};
                }),
                ball);
    EXPECT_EQ(simulated(scene), "2 of 6");
    EXPECT_NEAR(simulate(scene, {.until = 3.0})[ball].position(3.0).z(), 4.0, 1e-12);
}

TEST(WhatStays, a_number_of_the_users_counts_as_it_is_when_a_run_begins) {
    Scene scene;
    const Parameter wind(0.0, "wind");
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{.velocity = {1, 0, 0}});
    scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                    using S = std::decay_t<decltype(t)>;
                    if constexpr (std::is_same_v<S, Expression>)
                        return Vector3Of<S>{S(0.0), S(wind), S(0.0)};
                    else
                        return Vector3Of<S>{S(0.0), S(wind.value()), S(0.0)};
                }),
                ball);
    Parameter(wind).set(2.0);
    EXPECT_NEAR(simulate(scene, {.until = 1.0})[ball].position(1.0).y(), 1.0, 1e-12);
    Parameter(wind).set(0.0);
    EXPECT_EQ(simulate(scene, {.until = 1.0})[ball].position(1.0).y(), 0.0);
}

TEST(WhatStays, an_action_may_bring_in_anything) {
    Scene scene;
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{.velocity = {1, 0, 0}});
    scene.watch("kick", [](const Now& now) { return now.time() - 0.5; },
                {.action = {WatchAction::Kind::change, [=](const Observe&) {
                                return std::vector{StateChange{.body = ball, .velocity = Vector3(0, 0, 2)}};
                            }}});
    EXPECT_EQ(simulated(scene), "6 of 6");
    EXPECT_NEAR(simulate(scene, {.until = 1.5})[ball].position(1.5).z(), 2.0, 1e-14);
}

// beads beside something that is left out: their variables are elsewhere in the state
TEST(WhatStays, a_bead_sticks_and_slips_whatever_rests_beside_it) {
    const auto run = [](bool beside) {
        Scene scene(down);
        if (beside) scene.add(Particle{1.0}, Rail(along_x), {.parameter = 3.0});
        const BodyHandle bead =
            scene.add(Particle{1.0}, Rail(vertical_circle(0.5), Coulomb{0.5, 0.25}), {.parameter = 1.0, .speed = 3.0});
        scene.apply(Force([](const auto& t, const auto&, const auto&) {
                        using S = std::decay_t<decltype(t)>;
                        using std::sin;
                        return Vector3Of<S>{S(8.0) * sin(S(3.0) * t), S(0.0), S(0.0)};
                    }),
                    bead);
        EXPECT_EQ(simulated(scene), beside ? "2 of 4" : "2 of 2");
        return std::pair(simulate(scene, {.until = 4.0, .error = 1e-10}), bead);
    };
    const auto [alone, bead] = run(false);
    const auto [accompanied, same_bead] = run(true);
    ASSERT_GT(alone.events().size(), 3u);
    EXPECT_EQ(kinds(accompanied), kinds(alone));
    for (std::size_t i = 0; i < alone.events().size(); ++i)
        EXPECT_NEAR(accompanied.events()[i].time, alone.events()[i].time, 1e-10);
    EXPECT_NEAR(accompanied[same_bead].parameter(4.0), alone[bead].parameter(4.0), 1e-10);
}

TEST(WhatStays, a_bead_leaves_and_meets_its_rail_whatever_rests_beside_it) {
    const auto events = [](bool beside) {
        Scene scene(down);
        if (beside) scene.add(Particle{1.0}, Rail(along_x), {.parameter = 3.0});
        const Circle loop{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}};
        const BodyHandle bead =
            scene.add(Particle{1.0}, Rail(loop, {}, {.side = RailSide::plus}), {.parameter = 0.0, .speed = 6.5});
        EXPECT_EQ(simulated(scene), beside ? "8 of 10" : "8 of 8");
        Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-10});
        return std::pair(std::move(run), bead);
    };
    const auto [alone, bead] = events(false);
    const auto [accompanied, same_bead] = events(true);
    EXPECT_EQ(kinds(alone).substr(0, 11), "detach land");
    EXPECT_EQ(kinds(accompanied), kinds(alone));
    EXPECT_LT((accompanied[same_bead].position(2.0) - alone[bead].position(2.0)).norm(), 1e-9);
}

TEST(WhatStays, a_spring_to_a_bead_that_may_fly_leaves_no_plane) {
    Scene scene(down);
    const Circle loop{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}};
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(loop, {}, {.side = RailSide::plus}), {.speed = 1.0});
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, -2}});
    EXPECT_EQ(simulated(scene), "10 of 14");
    scene.connect(Spring{.stiffness = 4.0, .rest_length = 1.0}, bead, ball);
    EXPECT_EQ(simulated(scene), "14 of 14");
}

}  // namespace
}  // namespace rbdyn::test::test_what_stays
