// Actions of watched functions on bodies joined to bodies: what they change, what they leave, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"

namespace rbdyn::test {
namespace tree_actions {

const Vector3 z{0, 0, 1};
const RigidBody rod(1.0, {1.0 / 12, 1.0 / 12, 1.0 / 12}, {.com = {0, -0.5, 0}});

struct Rods {
    Scene scene{Vector3(0, -9.8125, 0)};
    BodyHandle upper, lower;

    Rods() {
        upper = scene.add(rod, Revolute{.axis = z}, {.angle = 1.2});
        lower = scene.add(rod, Revolute{.axis = z, .at = {0, -1, 0}}, {.angle = 0.4, .rate = 0.5, .parent = upper});
    }
    Trajectory changed(const std::vector<StateChange>& changes) {
        scene.watch("now", [](const Now& now) { return now.time() - 0.5; },
                    {.action = {WatchAction::Kind::change, [=](const Observe&) { return changes; }}});
        return simulate(scene, {.until = 1.0, .error = 1e-10});
    }
};

TEST(TreeActions, what_an_action_does_not_name_stays) {
    Rods rods;
    const Trajectory run = rods.changed({{.body = rods.upper, .rate = -2.0}});
    EXPECT_EQ(run[rods.upper].rate(0.5), -2.0);
    EXPECT_NEAR(run[rods.upper].angle(0.5), run[rods.upper].angle(0.5, Side::before), 1e-15);
    EXPECT_NEAR(run[rods.lower].angle(0.5), run[rods.lower].angle(0.5, Side::before), 1e-15);
    EXPECT_NEAR(run[rods.lower].rate(0.5), run[rods.lower].rate(0.5, Side::before), 1e-14);
    EXPECT_EQ(run.events().times("now"), std::vector<double>{0.5});
}

TEST(TreeActions, words_of_other_joints_are_refused_with_those_there_are) {
    Rods rods;
    const std::string message = refusal([&] { rods.changed({{.body = rods.lower, .displacement = 1.0}}); });
    EXPECT_NE(message.find("changes displacement of body 2, whose joint has none; give angle, rate"), std::string::npos)
        << message;
    Rods others;
    const std::string pair = refusal([&] { others.changed({{.body = others.lower, .angles = {{1.0, 2.0}}}}); });
    EXPECT_NE(pair.find("changes angles of body 2"), std::string::npos) << pair;
}

TEST(TreeActions, a_universal_and_a_planar_joint_take_pairs) {
    Scene scene;
    const BodyHandle base = scene.add(rod, Universal{.first = {1, 0, 0}, .second = {0, 1, 0}});
    const BodyHandle plate = scene.add(rod, Planar{.x = {1, 0, 0}, .y = {0, 1, 0}});
    scene.watch("now", [](const Now& now) { return now.time() - 0.5; },
                {.action = {WatchAction::Kind::change, [=](const Observe&) {
                                return std::vector<StateChange>{
                                    {.body = base, .angles = {{0.1, 0.2}}, .rates = {{0.3, 0.4}}},
                                    {.body = plate, .position_in_plane = {{1.5, 2.5}}, .velocity_in_plane = {{1, 2}}}};
                            }}});
    const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-10});
    EXPECT_EQ(run[base].angles(0.5), (std::array{0.1, 0.2}));
    EXPECT_EQ(run[base].rates(0.5), (std::array{0.3, 0.4}));
    EXPECT_EQ(run[plate].position(0.5), Vector3(1.5, 2.5, 0));
    EXPECT_EQ(run[plate].velocity(0.5), Vector3(1, 2, 0));
}

TEST(TreeActions, a_ball_at_rest_is_thrown_and_lands) {
    Scene scene({0, 0, -8});
    const BodyHandle ball = scene.add(Particle{1.0});
    const ContactHandle floor = scene.contact(ball, Plane{z});
    scene.watch("throw", [](const Now& now) { return now.time() - 1.0; },
                {.action = {WatchAction::Kind::change, [=](const Observe&) {
                                return std::vector<StateChange>{{.body = ball, .velocity = Vector3(0, 0, 4)}};
                            }}});
    const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-11});
    EXPECT_EQ(run.events().times("detach", floor), std::vector<double>{1.0});
    ASSERT_EQ(run.events().times("land", floor).size(), 1u);
    EXPECT_NEAR(run.events().times("land", floor)[0], 2.0, 1e-11);
}

/// How far from t the nearest zero of a watched function is.
template <class F>
double off(Scene scene, double t, F&& of) {
    scene.watch("zero", WatchFunction([=](const Now& now) { return of(now); }));
    double least = 1.0;
    for (const double zero : simulate(scene, {.until = 1.0, .error = 1e-12}).events().times("zero"))
        least = std::min(least, std::abs(zero - t));
    return least;
}

TEST(TreeActions, watched_functions_have_every_number_of_a_joint_that_runs_have) {
    Scene scene(Vector3(0, -9.8125, 0));
    const RigidBody box(2.0, {0.3, 0.4, 0.5}, {.com = {0.1, -0.5, 0.2}});
    const auto cross = scene.add(box, Universal{.first = {1, 0, 0}, .second = {0, 1, 0}},
                                 {.angles = {0.1, 0.2}, .rates = {0.3, -0.4}});
    const auto sleeve = scene.add(box, Cylindrical{.axis = z},
                                  {.angle = 0.2, .rate = 1.0, .displacement = 0.5, .displacement_rate = 2});
    const auto plate = scene.add(box, Planar{.x = {1, 0, 0}, .y = {0, 1, 0}}, {.angle = 0.3, .rate = 2.0});
    const auto sine = [](const auto& t) {
        using std::sin;
        return sin(3.0 * t);
    };
    const auto driven = scene.add(box, Revolute{.axis = z, .motion = sine});
    const auto pushed = scene.add(box, Prismatic{.axis = z, .motion = sine});
    const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-12});
    const double t = 0.375;
    const auto expect = [&](double value, auto&& of) {
        EXPECT_LT(off(scene, t, [&](const Now& now) { return of(now) - value + 3.0 * (now.time() - t); }), 1e-11);
    };
    for (const std::size_t k : {0U, 1U}) {
        expect(run[cross].angles(t)[k], [&](const Now& now) { return now[cross].angles()[k]; });
        expect(run[cross].rates(t)[k], [&](const Now& now) { return now[cross].rates()[k]; });
    }
    expect(run[sleeve].angle(t), [&](const Now& now) { return now[sleeve].angle(); });
    expect(run[sleeve].rate(t), [&](const Now& now) { return now[sleeve].rate(); });
    expect(run[sleeve].displacement(t), [&](const Now& now) { return now[sleeve].displacement(); });
    expect(run[sleeve].displacement_rate(t), [&](const Now& now) { return now[sleeve].displacement_rate(); });
    expect(run[plate].angle(t), [&](const Now& now) { return now[plate].angle(); });
    expect(run[plate].rate(t), [&](const Now& now) { return now[plate].rate(); });
    expect(std::sin(3.0 * t), [&](const Now& now) { return now[driven].angle(); });
    expect(3.0 * std::cos(3.0 * t), [&](const Now& now) { return now[driven].rate(); });
    expect(std::sin(3.0 * t), [&](const Now& now) { return now[pushed].displacement(); });
    expect(3.0 * std::cos(3.0 * t), [&](const Now& now) { return now[pushed].rate(); });
}

TEST(TreeActions, numbers_that_a_joint_has_not_are_refused_with_the_joints_that_have_them) {
    Rods rods;
    const auto refused = [&](auto&& of) {
        return refusal([&] { rods.scene.watch("zero", WatchFunction([&](const Now& now) { return of(now); })); });
    };
    EXPECT_NE(refused([&](const Now& now) { return now[rods.upper].angles()[0]; }).find("a Universal joint has"),
              std::string::npos);
    EXPECT_NE(
        refused([&](const Now& now) { return now[rods.upper].displacement_rate(); }).find("a Cylindrical joint has"),
        std::string::npos);
}

}  // namespace tree_actions
}  // namespace rbdyn::test
