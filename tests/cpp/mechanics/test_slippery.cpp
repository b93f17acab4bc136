// Friction at contacts whose dynamic coefficient is next to nothing, or nothing: closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "rbdyn/body/shapes.hpp"
#include "rbdyn/rbdyn.hpp"

namespace rbdyn::test {
namespace slippery {

constexpr double g = 9.8125;
const std::vector<double> coefficients = {0.0, 1e-300, 1e-100, 1e-30, 1e-17, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3};

/// A particle, or a box on four legs, over a floor.
struct Slippery {
    Slippery(bool is_box, Coulomb friction, double pull, double height, double speed) : scene(Vector3{pull, 0, -g}) {
        if (!is_box) {
            const auto mass =
                scene.add(Particle{2.0}, FreeStart{.position = {0, 0, height}, .velocity = {speed, 0, 0}});
            touches.push_back(scene.contact(mass, Plane{{0, 0, 1}}, {.friction = friction}));
            body = mass;
        } else {
            const auto box = scene.add(shapes::box(2.0, Vector3{1, 1, 0.5}),
                                       BodyStart{.position = {0, 0, 0.25 + height}, .velocity = {speed, 0, 0}});
            for (const double x : {-0.5, 0.5})
                for (const double y : {-0.5, 0.5})
                    touches.push_back(
                        scene.contact(box.point({x, y, -0.25}), Plane{{0, 0, 1}}, {.friction = friction}));
            body = box;
        }
    }
    Scene scene;
    BodyHandle body;
    std::vector<ContactHandle> touches;
};

TEST(Slippery, what_breaks_away_goes_on_with_next_to_no_friction) {
    for (const bool is_box : {false, true})
        for (const double mu : coefficients) {
            Slippery s(is_box, {0.5, mu}, 6.0, 0.0, 0.0);
            const Trajectory run = simulate(s.scene, {.until = 1.0});
            EXPECT_TRUE(run.events().empty());
            EXPECT_NEAR(run[s.body].velocity(1.0)[0], 6.0 - mu * g, 1e-13) << mu;
            for (const auto& touch : s.touches) EXPECT_EQ(run[touch].state(0.5), "slides") << mu;
        }
}

TEST(Slippery, what_a_force_pulls_away_breaks_at_its_static_cone) {
    for (const double mu : coefficients) {
        Slippery s(false, {0.5, mu}, 0.0, 0.0, 0.0);
        s.scene.apply(Force{[](const auto& t, const auto&, const auto&) {
                          using S = std::decay_t<decltype(t)>;
                          return Vector3Of<S>(t * 2.0 * g, S(0.0), S(0.0));
                      }},
                      s.body);
        const Trajectory run = simulate(s.scene, {.until = 1.0});
        ASSERT_EQ(run.events().size(), 1u) << mu;
        EXPECT_NEAR(run.events().times("slip", s.touches[0]).at(0), 0.5, 1e-14) << mu;
        // v' = g t - mu g
        EXPECT_NEAR(run[s.body].velocity(1.0)[0], 0.375 * g - 0.5 * mu * g, 1e-13) << mu;
    }
}

TEST(Slippery, what_lands_keeps_the_speed_along_the_floor_that_no_friction_takes) {
    const double height = 0.5, lands = std::sqrt(2.0 * height / g);
    for (const bool is_box : {false, true})
        for (const double pull : {0.0, 1.0, 6.0})
            for (const double speed : {1.0, 0.0})
                for (const double mu : coefficients) {
                    Slippery s(is_box, {0.5, mu}, pull, height, speed);
                    const Trajectory run = simulate(s.scene, {.until = 1.0});
                    const std::string which = std::to_string(pull) + " " + std::to_string(speed) + " " +
                                              std::to_string(mu) + (is_box ? " box" : "");
                    EXPECT_EQ(run.events().times("land").size(), s.touches.size()) << which;
                    const bool stays = pull == 0.0 && speed == 0.0;
                    EXPECT_EQ(run[s.touches[0]].state(0.9), stays ? "sticks" : "slides") << which;
                    // the impact takes mu g t_l, friction after it the rest; not from what does not move
                    const double lost = stays ? 0.0 : mu * g;
                    EXPECT_NEAR(run[s.body].velocity(lands + 0.5)[0],
                                speed + pull * (lands + 0.5) - lost * (lands + 0.5), 1e-12)
                        << which;
                }
}

TEST(Slippery, what_stops_without_friction_is_held_where_the_static_cone_holds_it) {
    Slippery s(false, {0.5, 0.0}, -1.0, 0.0, 0.5);
    const Trajectory run = simulate(s.scene, {.until = 2.0});
    EXPECT_NEAR(run.events().times("stick", s.touches[0]).at(0), 0.5, 1e-14);
    EXPECT_NEAR(run[s.body].position(2.0)[0], 0.125, 1e-14);
    EXPECT_EQ(run[s.body].velocity(2.0).norm(), 0.0);
}

}  // namespace slippery
}  // namespace rbdyn::test
