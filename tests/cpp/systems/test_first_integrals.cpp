// What is conserved follows from what acts: each effect takes what it destroys, and nothing else.
#include <gtest/gtest.h>

#include "scenes.hpp"
#include "support.hpp"

namespace rbdyn::test::test_first_integrals {
namespace {

using Names = std::vector<std::string>;
const Names all{"energy", "momentum x", "momentum y", "momentum z", "angular momentum"};

struct Three {
    Scene scene;
    std::vector<BodyHandle> bodies;
    explicit Three(const Vector3& gravity = Vector3::Zero()) : scene(gravity) {
        bodies.push_back(scene.add(Particle{1.0}, {.velocity = {0.3, 0.2, 0.1}}));
        bodies.push_back(scene.add(shapes::box(2.0, {0.5, 0.7, 0.9}),
                                   BodyStart{.position = {1.0, 0.2, 0.0}, .angular_velocity = Vector3(0.3, 0.2, 0.7)}));
        bodies.push_back(scene.add(Particle{0.5}, {.position = {0.0, 1.0, 0.5}, .velocity = {-0.3, 0.0, 0.4}}));
        scene.connect(Spring{.stiffness = 2.0, .rest_length = 0.7}, bodies[0], bodies[1].point({0.2, 0.1, 0.0}));
        scene.connect(Gravitation{0.5}, bodies[1], bodies[2]);
        scene.connect(Central([](const auto& r) { return 0.2 / r; }), bodies[0], bodies[2]);
    }
    /// The names, and whether none of them drifts in a run.
    Names conserved() const {
        const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-10});
        for (const auto& [name, drift] : run.drift()) EXPECT_LE(drift, 1e-10) << name;
        return run.plan().integrals;
    }
};

TEST(FirstIntegrals, follow_from_what_acts) {
    EXPECT_EQ(Three().conserved(), all);
    EXPECT_EQ(Three(down).conserved(), (Names{"energy", "momentum x", "momentum y", "angular momentum z"}));
    EXPECT_EQ(Three({1.0, 0.0, 0.0}).conserved(), (Names{"energy", "momentum y", "momentum z", "angular momentum x"}));

    Three damped;
    damped.scene.connect(Spring{.damping = 0.4}, damped.bodies[0], damped.bodies[2]);
    EXPECT_EQ(damped.conserved(), Names(all.begin() + 1, all.end()));

    Three whirled;
    whirled.scene.connect(PairForce([](const auto&, const auto& ra, const auto& rb, const auto&, const auto&) {
                              using T = std::decay_t<decltype(ra[0])>;
                              return Vector3Of<T>{ra[1] - rb[1], rb[0] - ra[0], T(0.0)};
                          }),
                          whirled.bodies[0], whirled.bodies[1]);
    EXPECT_EQ(whirled.conserved(), (Names{"momentum x", "momentum y", "momentum z"}));

    Three dragged;
    dragged.scene.apply(Drag{.linear = 0.1}, dragged.bodies[0]);
    EXPECT_EQ(dragged.conserved(), Names{});

    Three pushed;
    pushed.scene.apply(Force(Vector3(0.0, 0.5, 0.0)), pushed.bodies[1], Vector3(0.1, 0.2, 0.3));
    EXPECT_EQ(pushed.conserved(), (Names{"energy", "momentum x", "momentum z", "angular momentum y"}));

    Three pulled;
    pulled.scene.apply(Potential([](const auto& r) { return -0.5 * r[2] * r[2]; }), pulled.bodies[0]);
    EXPECT_EQ(pulled.conserved(), (Names{"energy", "momentum x", "momentum y", "angular momentum z"}));

    Three driven;
    driven.scene.apply(Force([](const auto& t, const auto&, const auto&) {
                           using T = std::decay_t<decltype(t)>;
                           return Vector3Of<T>{T(0.0), T(0.0), sin(t)};
                       }),
                       driven.bodies[0]);
    EXPECT_EQ(driven.conserved(), (Names{"momentum x", "momentum y", "angular momentum z"}));

    Three charged;
    charged.scene.apply(Lorentz{.strength = 0.5, .field = {0, 0, 1}}, charged.bodies[0]);
    EXPECT_EQ(charged.conserved(), (Names{"energy", "momentum z"}));
}

TEST(FirstIntegrals, keep_the_angular_momentum_about_a_fixed_centre) {
    Three held;
    const Vector3 centre(0.3, -0.4, 0.5);
    held.scene.connect(Spring{.stiffness = 1.0, .rest_length = 0.2}, held.bodies[0], centre);
    held.scene.connect(Central([](const auto& r) { return -1.0 / (r * r); }), held.bodies[2], centre);
    EXPECT_EQ(held.conserved(), (Names{"energy", "angular momentum"}));
    const Trajectory run = simulate(held.scene, {.until = 1.0});
    EXPECT_EQ(run.plan().pole, centre);

    // two centres one above the other, and gravity along that line
    held.scene.set_gravity(down);
    held.scene.connect(Spring{.stiffness = 1.0}, held.bodies[1], Vector3(0.3, -0.4, 2.0));
    EXPECT_EQ(held.conserved(), (Names{"energy", "angular momentum z"}));
    // one elsewhere
    held.scene.connect(Spring{.stiffness = 1.0}, held.bodies[1], Vector3(0.4, -0.4, 2.0));
    EXPECT_EQ(held.conserved(), Names{"energy"});
}

TEST(FirstIntegrals, that_actions_or_landings_end_are_none) {
    for (const bool bounces : {false, true}) {
        Scene scene(down);
        const BodyHandle ball = scene.add(Particle{1.0}, {.position = {0.0, 0.0, 1.0}, .velocity = {1.0, 0.0, 0.0}});
        const auto bounce = [ball](const Observe&) {
            return std::vector{StateChange{.body = ball, .velocity = Vector3(1.0, 0.0, 2.0)}};
        };
        scene.watch("floor", [ball](const Now& now) { return now[ball].position()[2]; },
                    {.direction = Direction::falling,
                     .action = bounces ? WatchAction{WatchAction::Kind::change, bounce} : WatchAction{}});
        const Trajectory run = simulate(scene, {.until = 0.6});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_EQ(run.plan().integrals,
                  bounces ? Names{} : Names({"energy", "momentum x", "momentum y", "angular momentum z"}));
    }

    // up the inside of a loop, and back onto it: what a bead has across its rail is lost
    Scene carried(down);
    const Curve loop = Circle{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}};
    carried.add(Particle{1.0}, Rail(loop, std::nullopt, {.side = RailSide::plus}), {.speed = 5.5});
    const Trajectory run = simulate(carried, {.until = 3.0});
    ASSERT_GE(run.events().size(), 2u);
    EXPECT_EQ(run.events()[1].kind, EventKind::land);
    EXPECT_LT(run.energy(3.0), run.energy(0.0) - 0.1);
    EXPECT_EQ(run.plan().integrals, Names{});
}

TEST(FirstIntegrals, of_beads_and_joints_are_what_their_reactions_leave) {
    Scene scene(down);
    const Rail rail(Line{.direction = {1, 0, 0}});
    const auto a = scene.add(Particle{1.0}, rail, {.parameter = 1.0, .speed = 0.4}),
               b = scene.add(Particle{2.0}, rail, {.parameter = -1.0});
    scene.connect(Spring{.stiffness = 2.0, .rest_length = 1.5}, a, b);
    Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-11});
    EXPECT_EQ(run.plan().integrals, (Names{"energy", "momentum x"}));
    for (const auto& [name, drift] : run.drift()) EXPECT_LE(drift, 1e-11) << name;

    Scene hinged(down);
    const auto wheel = hinged.add(shapes::box(1.0, {0.4, 0.6, 0.2}),
                                  Revolute{.axis = {0, 0, 1}, .at = {1, 2, 3}, .point = {0.3, 0, 0}}, {.rate = 1.0});
    const auto ball = hinged.add(Particle{0.5}, {.position = {1.5, 2.5, 3.0}, .velocity = {0.2, 0.0, 1.0}});
    hinged.connect(Spring{.stiffness = 2.0, .rest_length = 0.1}, wheel.point({0.2, 0.1, 0.0}), ball);
    run = simulate(hinged, {.until = 2.0, .error = 1e-11});
    EXPECT_EQ(run.plan().integrals, (Names{"energy", "angular momentum z"}));
    for (const auto& [name, drift] : run.drift()) EXPECT_LE(drift, 1e-11) << name;
}

}  // namespace
}  // namespace rbdyn::test::test_first_integrals
