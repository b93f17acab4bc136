// Rough, moving and one-sided rails of bodies that give way, against closed forms: a cart, a wedge, belts, a line that
// turns, a dome.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"

namespace rbdyn::test {
namespace rough_rails {

constexpr double g = 9.81, cart_mass = 2.0, bead_mass = 0.5;

RigidBody cart_body() { return {cart_mass, Matrix3(Matrix3::Identity() * 0.1)}; }

struct Carts {
    Scene scene{Vector3{0, -g, 0}};
    BodyHandle cart = scene.add(cart_body(), Prismatic{.axis = {1, 0, 0}});

    BodyHandle add(const Rail& rail, double speed, double parameter = 0.0) {
        return scene.add(Particle{bead_mass}, rail, {.parameter = parameter, .speed = speed, .parent = cart});
    }
};

Rail level(const Coulomb& friction, TimeFunction drive = 0.0) {
    return Rail(Line{.direction = {1, 0, 0}}, friction, {.drive = drive});
}

TEST(RoughRails, a_bead_thrown_along_a_cart_takes_it_along) {
    const double mu = 0.3, v0 = 2.0, part = bead_mass / cart_mass;
    const double stop = v0 / (mu * g * (1.0 + part)), common = v0 * bead_mass / (bead_mass + cart_mass), end = 2.0;
    for (const double error : {1e-6, 1e-9, 1e-12}) {
        Carts s;
        const BodyHandle bead = s.add(level({0.4, mu}), v0);
        const Trajectory run = simulate(s.scene, {.until = end, .error = error});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_EQ(run.events()[0].kind, EventKind::stick);
        EXPECT_EQ(run.events()[0].subject, bead.index);
        EXPECT_NEAR(run.events()[0].time, stop, 1e-14);
        EXPECT_NEAR(run[s.cart].rate(end), common, 1e-14);
        EXPECT_NEAR(run[bead].parameter(end), 0.5 * v0 * stop, 1e-14);
        EXPECT_EQ(run[bead].speed(end), 0.0);
        EXPECT_EQ(run[bead].parameter(end), run[bead].parameter(stop + 0.5));
        EXPECT_NEAR(run[bead].reaction(0.1)[0], -mu * bead_mass * g, 1e-14);
        // what slides apart takes energy, half of m M / (m + M) v^2 all in all
        EXPECT_NEAR(run.energy(0.0) - run.energy(end), 0.5 * bead_mass * cart_mass / (bead_mass + cart_mass) * v0 * v0,
                    1e-13);
    }
}

TEST(RoughRails, a_bead_at_rest_breaks_loose_from_a_cart_that_is_pulled) {
    const double mu_static = 0.3, k = 4.0, breaks = mu_static * g * (bead_mass + cart_mass) / k;
    for (const double mu : {0.2, 0.3}) {
        Carts s;
        const BodyHandle bead = s.add(level({mu_static, mu}), 0.0);
        s.scene.apply(Force([=](auto t, auto, auto) { return Vector3Of<decltype(t)>(k * t, 0.0 * t, 0.0 * t); }),
                      s.cart);
        const double end = breaks + 0.5;
        const Trajectory run = simulate(s.scene, {.until = end, .error = 1e-11});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_EQ(run.events()[0].kind, EventKind::slip);
        EXPECT_NEAR(run.events()[0].time, breaks, 1e-13);
        // it lags behind: s'' = mu g - (k t - mu m g) / M
        const double d = 0.5, start = mu * g * (1.0 + bead_mass / cart_mass) - k * breaks / cart_mass;
        EXPECT_NEAR(run[bead].parameter(end), 0.5 * start * d * d - k * d * d * d / (6.0 * cart_mass), 1e-12);
    }
}

TEST(RoughRails, what_presses_on_a_wedge_that_gives_way_depends_on_friction) {
    for (const double tilt : {0.5, 1.0}) {
        const double c = std::cos(tilt), s = std::sin(tilt), mu = 0.25, part = bead_mass / cart_mass, end = 0.5;
        Carts carts;
        const Rail slope(Line{.direction = {c, -s, 0}}, Coulomb{0.3, mu});
        const BodyHandle bead = carts.add(slope, 0.1);
        const Trajectory run = simulate(carts.scene, {.until = end, .error = 1e-11});
        const double pressing = bead_mass * g * c / (1.0 + part * s * (s - mu * c));
        const double cart = -pressing * (s - mu * c) / cart_mass;
        const double along = g * s - mu * pressing / bead_mass - cart * c;
        EXPECT_NEAR(run[bead].parameter(end), 0.1 * end + 0.5 * along * end * end, 1e-13);
        EXPECT_NEAR(run[carts.cart].displacement(end), 0.5 * cart * end * end, 1e-13);
        const Vector3 reaction = run[bead].reaction(0.3);
        EXPECT_NEAR(reaction.dot(Vector3(s, c, 0)), pressing, 1e-13);
        EXPECT_NEAR(reaction.dot(Vector3(c, -s, 0)), -mu * pressing, 1e-13);
        // and on one that cannot move it does not
        Scene fixed(Vector3{0, -g, 0});
        const auto post = fixed.add(cart_body(), Fixed{});
        const auto still = fixed.add(Particle{bead_mass}, slope, {.parameter = 0.0, .speed = 0.1, .parent = post});
        const Trajectory there = simulate(fixed, {.until = end, .error = 1e-11});
        EXPECT_NEAR(there[still].parameter(end), 0.1 * end + 0.5 * g * (s - mu * c) * end * end, 1e-13);
    }
}

TEST(RoughRails, a_wedge_that_a_bead_jams_on_has_no_motion_to_follow) {
    // where mu c > s + M / (m s) what presses would grow with itself without end
    Carts carts;
    const double tilt = 0.7;
    carts.add(Rail(Line{.direction = {std::cos(tilt), -std::sin(tilt), 0}}, Coulomb{30.0}), 1.0);
    EXPECT_THROW(simulate(carts.scene, {.until = 1.0}), IntegrationError);
}

TEST(RoughRails, a_belt_on_a_cart_drives_it_back_and_then_carries_its_bead) {
    const double mu = 0.2, v = 1.0, part = bead_mass / cart_mass, stick = v / (mu * g * (1.0 + part));
    Carts s;
    const BodyHandle bead = s.add(level({0.3, mu}, v), 0.0);
    const Trajectory run = simulate(s.scene, {.until = 100.0, .error = 1e-10});
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_EQ(run.events()[0].kind, EventKind::stick);
    EXPECT_NEAR(run.events()[0].time, stick, 1e-14);
    EXPECT_NEAR(run[bead].parameter(100.0), 0.5 * v * stick + v * (100.0 - stick), 1e-12);
    EXPECT_NEAR(run[bead].speed(50.0), v, 1e-15);
    EXPECT_NEAR(run[s.cart].rate(100.0), -v * bead_mass / (bead_mass + cart_mass), 1e-14);
}

TEST(RoughRails, a_belt_that_turns_back_at_once_leaves_its_bead_behind) {
    const double mu = 0.2, v = 1.0, jump = 2.0, part = bead_mass / cart_mass;
    const double stick = v / (mu * g * (1.0 + part)), again = jump + 2.0 * stick;
    const auto belt = [=](const auto& t) { return v * locked_sign(jump - t); };
    Carts s;
    const BodyHandle bead = s.add(level({0.3, mu}, belt), 0.0);
    const Trajectory run = simulate(s.scene, {.until = 5.0, .error = 1e-10});
    std::vector<EventKind> kinds;
    std::vector<double> times;
    for (const Event& e : run.events()) {
        if (e.kind == EventKind::switching) continue;
        kinds.push_back(e.kind);
        times.push_back(e.time);
    }
    ASSERT_EQ(kinds, (std::vector{EventKind::stick, EventKind::slip, EventKind::stick}));
    EXPECT_NEAR(times[0], stick, 1e-14);
    EXPECT_NEAR(times[1], jump, 1e-14);
    EXPECT_NEAR(times[2], again, 1e-13);
    EXPECT_NEAR(run[bead].speed(4.5), -v, 1e-14);
}

TEST(RoughRails, a_line_that_turns_in_a_weld_throws_its_bead_out) {
    const double spin = 2.0, from = 0.3, end = 1.2;
    Scene scene;
    const auto post = scene.add(cart_body(), Fixed{});
    const RailOptions turns{.motion = RigidMotion::rotation([=](const auto& t) { return spin * t; }, {0, 0, 1})};
    const auto bead = scene.add(Particle{bead_mass}, Rail(Line{.direction = {1, 0, 0}}, std::nullopt, turns),
                                {.parameter = from, .parent = post});
    const Trajectory run = simulate(scene, {.until = end, .error = 1e-12});
    const double s = from * std::cosh(spin * end), rate = spin * from * std::sinh(spin * end);
    EXPECT_NEAR(run[bead].parameter(end), s, 1e-12);
    EXPECT_NEAR(run[bead].speed(end), rate, 1e-12);
    const Vector3 across(-std::sin(spin * end), std::cos(spin * end), 0);
    EXPECT_LT((run[bead].reaction(end) - across * (2.0 * bead_mass * spin * rate)).norm(), 1e-11);
    EXPECT_LT((run[bead].velocity(end) - across * (spin * s) - Vector3(across[1], -across[0], 0) * rate).norm(), 1e-11);
}

const Circle dome{.radius = 1.0, .start = {0, 1, 0}, .toward = {1, 0, 0}};
const RailOptions from_above{.side = RailSide::plus, .up = Vector3(0, 1, 0)};

TEST(LooseRails, a_bead_leaves_a_dome_of_a_weld_at_two_thirds_of_its_height) {
    Scene scene(Vector3{0, -g, 0});
    const auto post = scene.add(cart_body(), Fixed{});
    const auto bead = scene.add(Particle{bead_mass}, Rail(dome, std::nullopt, from_above),
                                {.parameter = 0.0, .speed = 1e-6, .parent = post});
    const Trajectory run = simulate(scene, {.until = 7.0});
    ASSERT_EQ(run.events().size(), 1u);
    const Event& leaves = run.events()[0];
    EXPECT_EQ(leaves.kind, EventKind::detach);
    EXPECT_NEAR(run[bead].parameter(leaves.time), std::acos(2.0 / 3.0), 1e-12);
    EXPECT_EQ(run[bead].reaction(6.5), Vector3(0, 0, 0));
    EXPECT_LT((run[bead].acceleration(6.5) - Vector3(0, -g, 0)).norm(), 1e-14);
}

TEST(LooseRails, a_bead_leaves_a_dome_that_slides_away_where_a_cubic_says) {
    Carts s;
    const BodyHandle bead = s.add(Rail(dome, std::nullopt, from_above), 0.0, 1e-3);
    const Trajectory run = simulate(s.scene, {.until = 3.0, .error = 1e-11});
    ASSERT_EQ(run.events().size(), 1u);
    const double leaves = run.events()[0].time, c = std::cos(run[bead].parameter(leaves)),
                 k = bead_mass / (bead_mass + cart_mass);
    EXPECT_NEAR(k * c * c * c - 3.0 * c + 2.0 * std::cos(1e-3), 0.0, 1e-13);
    EXPECT_EQ(run[s.cart].rate(2.5), run[s.cart].rate(leaves));
    EXPECT_NEAR(cart_mass * run[s.cart].rate(2.5) + bead_mass * run[bead].velocity(2.5)[0], 0.0, 1e-13);
}

TEST(LooseRails, what_lands_on_a_ramp_of_a_cart_loses_what_is_across_and_drives_it) {
    const double tilt = 0.6, c = std::cos(tilt), s = std::sin(tilt);
    Carts carts;
    const Rail ramp(Line{.direction = {c, -s, 0}}, std::nullopt, from_above);
    const BodyHandle bead = carts.add(ramp, 0.0);
    // a short push throws it up
    carts.scene.apply(Force([=](auto t, auto, auto) {
                          const auto push = 40.0 * exp(-(t - 0.1) * (t - 0.1) / 0.001);
                          return Vector3Of<decltype(t)>(0.0 * t, push, 0.0 * t);
                      }),
                      bead);
    const Trajectory run = simulate(carts.scene, {.until = 2.0, .error = 1e-11});
    const Event* lands = nullptr;
    for (const Event& e : run.events())
        if (e.kind == EventKind::land && lands == nullptr) lands = &e;
    ASSERT_NE(lands, nullptr);
    const double t = lands->time;
    const Vector3 was = run[bead].velocity(t, Side::before), is = run[bead].velocity(t), n(s, c, 0);
    const double cart_was = run[carts.cart].rate(t, Side::before), cart_is = run[carts.cart].rate(t);
    const double impulse = -(was - Vector3(cart_was, 0, 0)).dot(n) / (1.0 / bead_mass + s * s / cart_mass);
    EXPECT_GT(impulse, 0.1);
    EXPECT_NEAR(lands->impulse, impulse, 1e-12);
    EXPECT_LT((is - was - n * (impulse / bead_mass)).norm(), 1e-13);
    EXPECT_NEAR(cart_is - cart_was, -impulse * s / cart_mass, 1e-13);
    EXPECT_NEAR((run[bead].position(t) - Vector3(run[carts.cart].displacement(t), 0, 0)).dot(n), 0.0, 1e-14);
}

TEST(LooseRails, beside_contacts_they_are_refused) {
    Carts s;
    s.add(Rail(dome, std::nullopt, from_above), 0.0, 0.1);
    s.scene.contact(s.cart.sphere(0.1), Plane{.normal = {0, 1, 0}, .point = {0, -5, 0}});
    const std::string said = refusal([&] { simulate(s.scene, {.until = 1.0}); });
    EXPECT_NE(said.find("bead 2: a rail that it may leave, beside contacts"), std::string::npos) << said;
}

}  // namespace rough_rails
}  // namespace rbdyn::test
