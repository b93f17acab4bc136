// Rough beads at rest where what presses them on their rail and what pulls them along it vanish together.
#include <gtest/gtest.h>

#include "support.hpp"

namespace rbdyn::test::test_nothing_presses {
namespace {

constexpr double mu_static = 0.5, mu_dynamic = 0.375;

/// A bead at rest on a rail along x, of which along and across, functions of time, are the forces.
template <class Along, class Across>
Trajectory pushed(const Along& along, const Across& across, double until, BodyHandle* bead, double start = 0.0) {
    Scene scene;
    *bead = scene.add(Particle{2.0}, Rail(along_x, Coulomb{mu_static, mu_dynamic}));
    scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{S(along(t)), S(0.0), S(across(t))};
                }),
                *bead);
    return simulate(scene, {.until = until, .start = start, .error = 1e-10});
}
const auto nothing = [](const auto& t) { return 0.0 * t; };

TEST(NothingPresses, a_load_that_grows_alone_moves_the_bead_from_the_start_and_silently) {
    BodyHandle bead;
    for (const double sign : {1.0, -1.0}) {
        const Trajectory run = pushed([=](const auto& t) { return sign * t; }, nothing, 2.0, &bead);
        EXPECT_EQ(kinds(run), "");
        EXPECT_NEAR(run[bead].position(2.0).x(), sign * 8.0 / 12.0, 1e-10);
        const Trajectory cubed = pushed([=](const auto& t) { return sign * t * t * t; }, nothing, 2.0, &bead);
        EXPECT_EQ(kinds(cubed), "");
        EXPECT_NEAR(cubed[bead].position(2.0).x(), sign * 32.0 / 40.0, 1e-10);
    }
}

TEST(NothingPresses, load_and_reaction_that_grow_together_are_told_by_their_ratio) {
    BodyHandle bead;
    for (const double side : {1.0, -1.0})
        for (const double sign : {1.0, -1.0})
            for (const double ratio : {0.25, 0.75}) {
                const auto along = [=](const auto& t) { return sign * ratio * t; };
                const auto across = [=](const auto& t) { return side * t; };
                const Trajectory run = pushed(along, across, 2.0, &bead);
                EXPECT_EQ(kinds(run), "") << ratio;
                // m x'' = (ratio - mu_d) t
                const double far = ratio < mu_static ? 0.0 : sign * (ratio - mu_dynamic) * 8.0 / 12.0;
                EXPECT_NEAR(run[bead].position(2.0).x(), far, 1e-10) << ratio;
            }
}

TEST(NothingPresses, the_one_of_lower_order_wins_until_the_other_has_grown) {
    BodyHandle bead;
    // t^2 along, t across: held until t = mu_s
    const auto square = [](const auto& t) { return t * t; };
    const auto once = [](const auto& t) { return -1.0 * t; };
    const Trajectory held = pushed(square, once, 1.0, &bead);
    ASSERT_EQ(kinds(held), "slip");
    EXPECT_NEAR(held.events()[0].time, mu_static, 1e-12);
    // t along, t^2 across: m x'' = t - mu_d t^2 until it would be held again
    const Trajectory free = pushed([](const auto& t) { return 1.0 * t; }, square, 1.0, &bead);
    EXPECT_EQ(kinds(free), "");
    EXPECT_NEAR(free[bead].position(1.0).x(), 0.5 * (1.0 / 6.0 - mu_dynamic / 12.0), 1e-10);
}

TEST(NothingPresses, what_rounding_leaves_of_a_load_at_the_start_is_none) {
    // 3 t - 0.3 is 5.6e-17 at t = 0.1, and so on
    BodyHandle bead;
    for (const auto& [start, third] : {std::pair{0.1, 0.3}, {0.7, 2.1}, {1.1, 3.3}}) {
        const auto along = [=, c = third](const auto& t) { return 0.25 * (3.0 * t - c); };
        const auto across = [=, s = start](const auto& t) { return 3.0 * (t - s); };
        const Trajectory run = pushed(along, across, start + 1.0, &bead, start);
        EXPECT_EQ(kinds(run), "") << start;
        EXPECT_EQ(run[bead].position(start + 1.0).x(), 0.0);
    }
}

TEST(NothingPresses, a_load_that_sets_in_later_makes_the_bead_slip_then_and_to_its_side) {
    BodyHandle bead;
    for (const double sign : {1.0, -1.0}) {
        const auto later = [=](const auto& t) { return where(t > 0.5, sign * (t - 0.5), 0.0 * t); };
        const Trajectory run = pushed(later, nothing, 1.5, &bead);
        EXPECT_EQ(kinds(run), "slip switch");
        EXPECT_NEAR(run.events().times("slip").at(0), 0.5, 1e-12);
        EXPECT_NEAR(run[bead].position(1.5).x(), sign / 12.0, 1e-10);
    }
}

TEST(NothingPresses, a_spring_that_begins_to_pull_along_the_rail_moves_the_bead) {
    // m x'' = t - k x, x = (t - sin(omega t) / omega) / k
    Scene scene;
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(along_x, Coulomb{mu_static}));
    scene.connect(Spring{.stiffness = 4.0}, bead, Vector3(0, 0, 0));
    scene.apply(Force([](const auto& t, const auto&, const auto&) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{t, S(0.0), S(0.0)};
                }),
                bead);
    const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-10});
    EXPECT_EQ(kinds(run), "");
    EXPECT_NEAR(run[bead].position(1.0).x(), (1.0 - std::sin(2.0) / 2.0) / 4.0, 1e-10);
}

}  // namespace
}  // namespace rbdyn::test::test_nothing_presses
