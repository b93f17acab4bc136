// Forces between bodies: what each exerts, keeps and is called, and what is refused.
#include <gtest/gtest.h>

#include "rbdyn/effects.hpp"
#include "rbdyn/model/assembly.hpp"
#include "rbdyn/scene/effects.hpp"
#include "rbdyn/statics/rail_potential.hpp"
#include "refusal.hpp"
#include "scenes.hpp"
#include "support.hpp"

namespace rbdyn::test::test_couplings {
namespace {

/// A coupling between two particles, one of them on its way through the other's neighbourhood.
struct Pair {
    Scene scene;
    BodyHandle a, b;
    CouplingHandle joined;

    explicit Pair(const Coupling& coupling, const Vector3& gravity = Vector3::Zero()) : scene(gravity) {
        a = scene.add(Particle{1.5}, {.position = {1.0, 0.2, -0.3}, .velocity = {0.0, 0.9, 0.1}});
        b = scene.add(Particle{0.75}, {.position = {-0.5, 0.0, 0.25}, .velocity = {0.3, -0.5, 0.0}});
        joined = scene.connect(coupling, a, b);
    }
};

const auto sheared = [](const auto& t, const auto& ra, const auto& rb, const auto& va, const auto& vb) {
    using std::sin;
    using T = std::decay_t<decltype(ra[0])>;
    return Vector3Of<T>{rb[1] - ra[1] + sin(t), vb[0] - va[0], ra[2] * rb[0]};
};

TEST(Couplings, exert_what_their_laws_say) {
    const auto distance = [](const Trajectory& run, const Pair& p, double t) {
        return Vector3(run[p.a].position(t) - run[p.b].position(t));
    };
    const Pair attracted{Gravitation{2.0}}, pushed{Central([](const auto&r) { return 1.0 / (r * r) - 0.5 * r; })},
        any{PairForce(sheared)};
    for (const double t : {0.0, 0.7, 1.9}) {
        Trajectory run = simulate(attracted.scene, {.until = 2.0, .error = 1e-10});
        Vector3 d = distance(run, attracted, t);
        double r = d.norm();
        EXPECT_LE((run[attracted.joined].force(t) + 2.0 * 1.5 * 0.75 / (r * r * r) * d).norm(), 1e-14 / (r * r));
        EXPECT_EQ(run[attracted.joined].length(t), r);
        EXPECT_LE((run[attracted.a].force(t) + run[attracted.b].force(t)).norm(), 0.0);
        run = simulate(pushed.scene, {.until = 2.0, .error = 1e-10});
        d = distance(run, pushed, t);
        r = d.norm();
        EXPECT_LE((run[pushed.joined].force(t) - (1.0 / (r * r) - 0.5 * r) / r * d).norm(), 1e-14);
        run = simulate(any.scene, {.until = 2.0, .error = 1e-10});
        const Vector3 ra = run[any.a].position(t), rb = run[any.b].position(t), va = run[any.a].velocity(t),
                      vb = run[any.b].velocity(t);
        EXPECT_LE(
            (run[any.joined].force(t) - Vector3(rb[1] - ra[1] + std::sin(t), vb[0] - va[0], ra[2] * rb[0])).norm(),
            1e-14);
        EXPECT_EQ(run[any.b].force(t), Vector3(-run[any.a].force(t)));
    }
}

TEST(Couplings, of_functions_that_are_called_back_move_bodies_as_recorded_ones_do) {
    const auto central = std::make_shared<Callback>();
    central->name = "well";
    central->reason = "a test";
    central->inputs = central->outputs = 1;
    central->function = [](const double* x, double* y) { *y = 1.0 / (*x * *x) - 0.5 * *x; };
    const auto pair = std::make_shared<Callback>();
    pair->name = "shear";
    pair->reason = "a test";
    pair->inputs = 13;
    pair->outputs = 3;
    pair->function = [](const double* x, double* y) {
        const Vector3 f = sheared(x[0], Vector3(x[1], x[2], x[3]), Vector3(x[4], x[5], x[6]), Vector3(x[7], x[8], x[9]),
                                  Vector3(x[10], x[11], x[12]));
        for (int i = 0; i < 3; ++i) y[i] = f[i];
    };
    const std::pair<Coupling, Coupling> laws[] = {
        {Central([](const auto& r) { return 1.0 / (r * r) - 0.5 * r; }),
         Central(std::shared_ptr<const Callback>(central))},
        {PairForce(sheared), PairForce(std::shared_ptr<const Callback>(pair))}};
    for (const auto& [recorded, called] : laws) {
        const Pair one(recorded), other(called);
        const Trajectory first = simulate(one.scene, {.until = 2.0, .error = 1e-11}),
                         second = simulate(other.scene, {.until = 2.0, .error = 1e-11});
        EXPECT_EQ(first.engine(), "taylor");
        EXPECT_EQ(second.engine(), "dop853");
        EXPECT_TRUE(second.plan().calls_back);
        EXPECT_LE((first[one.a].position(2.0) - second[other.a].position(2.0)).norm(), 1e-10);
        EXPECT_NEAR(first.potential(2.0), second.potential(2.0), 1e-10);
    }
}

TEST(Couplings, say_what_they_are_and_can_be_taken_away) {
    Pair p{Gravitation{2.0}};
    const auto central = p.scene.connect(Central([](const auto& r) { return -r; }), p.a, Vector3(0, 0, 1));
    p.scene.connect(PairForce(sheared), p.a, p.b);
    EXPECT_EQ(effects_of(p.scene), (std::vector<std::string>{"gravitation", "central force", "user force"}));
    EXPECT_EQ(effects_of(p.scene.without("gravitation", "user force")), std::vector<std::string>{"central force"});
    const Scene left = p.scene.without(central, "user force");
    EXPECT_EQ(effects_of(left), std::vector<std::string>{"gravitation"});
    const Trajectory with = simulate(Pair(Gravitation{2.0}).scene, {.until = 1.0}),
                     without = simulate(left, {.until = 1.0});
    EXPECT_EQ(with[p.a].position(1.0), without[p.a].position(1.0));
    EXPECT_EQ(without[central].force(1.0), Vector3(0, 0, 0));
    // they are values
    EXPECT_EQ(Coupling(Gravitation{2.0}), Coupling(Gravitation{2.0}));
    EXPECT_NE(Coupling(Gravitation{2.0}), Coupling(Gravitation{3.0}));
    const auto law = [](const auto& r) { return -2.0 * r; };
    EXPECT_EQ(Central(law), Central(law));
    EXPECT_NE(Central(law), Central([](const auto& r) { return -3.0 * r; }));
    // one that is zero is not there
    const Scene none = Pair(Central([](const auto& r) { return 0.0 * r; })).scene.frozen();
    EXPECT_TRUE(effects_of(none).empty());
}

TEST(Couplings, take_numbers_of_the_users_by_reference) {
    Parameter strength(1.0, "strength");
    const Coupling laws[] = {Gravitation{strength},
                             Central([&](const auto& r) { return -Expression(strength) / (r * r); })};
    for (const Coupling& law : laws) {
        Pair p(law);
        strength.set(1.0);
        const Vector3 weak = simulate(p.scene, {.until = 1.0})[p.a].position(1.0);
        strength.set(2.0);
        const Vector3 strong = simulate(p.scene, {.until = 1.0})[p.a].position(1.0);
        EXPECT_GT((weak - strong).norm(), 1e-3);
        strength.set(1.0);
        EXPECT_EQ(simulate(p.scene, {.until = 1.0})[p.a].position(1.0), weak);
    }
}

TEST(Couplings, that_nobody_could_mean_are_refused) {
    Scene scene;
    const auto ball = scene.add(Particle{1.0});
    const auto body = scene.add(shapes::box(1.0, {1.0, 1.0, 1.0}));
    EXPECT_NE(
        refusal([&] { scene.connect(Gravitation{1.0}, ball, Vector3(0, 0, 1)); }).find("no mass; connect a Central"),
        std::string::npos);
    EXPECT_NE(refusal([&] {
                  scene.connect(Gravitation{1.0}, ball, body.point({1, 0, 0}));
              }).find("give the body's handle"),
              std::string::npos);
    EXPECT_NE(refusal([&] { scene.connect(Gravitation{-1.0}, ball, body); }).find("Gravitation: constant is -1"),
              std::string::npos);
    EXPECT_NE(refusal([] {
                  (void)Central(Function::record(2, [](const auto& x) { return std::vector<Expression>{x[0]}; }));
              }).find("2 inputs"),
              std::string::npos);
    EXPECT_NE(refusal([] {
                  (void)PairForce(Function::record(13, [](const auto& x) { return std::vector<Expression>{x[0]}; }));
              }).find("1 results"),
              std::string::npos);
}

TEST(Couplings, are_the_same_for_the_special_laws_and_the_general_formulation) {
    Random random(5);
    for (int round = 0; round < 60; ++round) {
        const Scene scene = random_system(random, false);
        const Assembly general(scene);
        const Trajectory run = attempt(scene, {.until = 1e-3, .rtol = 1e-6}).run;
        for (int i = 0; i < static_cast<int>(scene.bodies().size()); ++i) {
            if (scene.bodies()[static_cast<std::size_t>(i)].rail() != nullptr) continue;
            const AssembledBody expected = general.body(i);
            EXPECT_LE((run[BodyHandle{i}].acceleration(0.0) - expected.acceleration).norm(),
                      1e-11 * (1.0 + expected.effort))
                << "round " << round << ", body " << i;
        }
    }
}

TEST(Couplings, let_an_equilibrium_be_found_and_take_part_in_a_potential_along_a_rail) {
    // two beads on one line that attract each other by springs of a length and push each other away
    Scene scene;
    const Rail rail(Line{.direction = {1, 0, 0}});
    const auto a = scene.add(Particle{1.0}, rail, {.parameter = 1.0}),
               b = scene.add(Particle{1.0}, rail, {.parameter = -1.0});
    scene.connect(Central([](const auto& r) { return 4.0 / (r * r) - 0.5 * r; }), a, b);
    scene.connect(Spring{.stiffness = 1.0}, a, Vector3(0, 0, 0));
    scene.connect(Spring{.stiffness = 1.0}, b, Vector3(0, 0, 0));
    const auto rest = equilibria(scene, {1.0, -1.0});
    ASSERT_EQ(rest.size(), 1U);
    // 4/(4 x^2) - x = x
    EXPECT_NEAR(rest[0].coordinates[0], std::cbrt(0.5), 1e-14);
    EXPECT_TRUE(rest[0].stable);

    Scene one;
    const auto bead = one.add(Particle{1.0}, Rail(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}}),
                              {.parameter = 1.0});
    one.connect(Central([](const auto& r) { return -1.0 / (r * r); }), bead, Vector3(2.0, 0.0, 0.0));
    const RailPotential u(one, bead);
    const auto exact = [](double angle) { return 1.0 / std::sqrt(5.0 - 4.0 * std::cos(angle)); };
    EXPECT_NEAR(u.value(2.0) - u.value(0.5), exact(2.0) - exact(0.5), 1e-14);
    Scene twisted = one;
    twisted.connect(PairForce(sheared), bead, Vector3(0, 0, 0));
    EXPECT_NE(refusal([&] { (void)RailPotential(twisted, bead); }), "accepted");
    EXPECT_NE(refusal([&] { (void)equilibria(twisted); }).find("depends on time"), std::string::npos);
}

}  // namespace
}  // namespace rbdyn::test::test_couplings
