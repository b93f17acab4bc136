// Rails with places where the tangent is not defined: what is reached slowly, turned at, or passed by a parameter
// alone.
#include <gtest/gtest.h>

#include <numbers>

#include "rbdyn/curve/regular_stretch.hpp"
#include "support.hpp"

namespace rbdyn::test::test_singular_rails {
namespace {

constexpr double pi = std::numbers::pi;
const Cycloid bowl{.radius = 1.0, .x = {1, 0, 0}, .y = {0, 0, 1}};  // its cusps are up

struct Bead {
    Scene scene;
    BodyHandle handle;
    Bead(const Curve& curve, RailStart start, const Vector3& field = down)
        : scene(field), handle(scene.add(Particle{1.0}, Rail(curve), start)) {}
    Trajectory run(double until, double error = 1e-9) const {
        return simulate(scene, {.until = until, .error = error});
    }
    /// The words that a run ends with, and when.
    std::pair<std::string, double> broken(double until) const {
        try {
            run(until);
        } catch (const IntegrationError& error) {
            return {error.what(), error.run.end()};
        }
        return {"reached its end", until};
    }
};
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Cusps, that_a_bead_just_does_not_reach_turn_it_back_or_end_the_run) {
    // let go at a distance from one cusp it comes as near to the other: arc length is a harmonic motion
    const double omega = std::sqrt(gravity / 4.0);
    int ended = 0;
    for (double distance = 0.25; distance > 1e-14; distance *= 0.125) {
        const Bead bead(bowl, {.parameter = pi - distance});
        const auto [words, when] = bead.broken(5.0);
        if (has(words, "cusp")) {
            // within rounding of where it turns or is lost
            EXPECT_LT(distance, 1e-7);
            EXPECT_NEAR(when, pi / omega, 1e-6);
            ++ended;
            continue;
        }
        ASSERT_EQ(words, "reached its end") << distance;
        const Trajectory run = bead.run(5.0);
        for (double t = 0.125; t <= 5.0; t += 0.125) {
            const double s = std::sin(0.5 * (pi - distance)) * std::cos(omega * t);
            EXPECT_NEAR(run[bead.handle].position(t).z(), 2.0 * s * s, 1e-8) << distance << " " << t;
        }
    }
    EXPECT_GT(ended, 3);
}

TEST(Cusps, reached_with_no_speed_left_end_the_run_though_the_parameter_goes_on_evenly) {
    // u = 2 omega t, to all digits of any step
    const double omega = std::sqrt(gravity / 4.0);
    const auto [words, when] = Bead(bowl, {.parameter = 0.0, .speed = 2.0 * std::sqrt(gravity)}).broken(10.0);
    EXPECT_TRUE(has(words, "cusp")) << words;
    EXPECT_NEAR(when, 0.5 * pi / omega, 1e-9);
    // straight up to where u and -u are one place
    const Curve folded([](const auto& u) {
        using S = std::decay_t<decltype(u)>;
        return Vector3Of<S>{S(0.0), S(0.0), -(u * u)};
    });
    const auto [more, then] = Bead(folded, {.parameter = -1.0, .speed = std::sqrt(2.0 * gravity)}).broken(2.0);
    EXPECT_TRUE(has(more, "no tangent")) << more;
    EXPECT_NEAR(then, std::sqrt(2.0 / gravity), 1e-9);
}

TEST(Cusps, of_every_kind_of_curve_end_a_run_that_comes_to_them) {
    const auto of = [](const auto& f) { return Curve(f); };
    const std::vector<std::pair<Curve, RailStart>> rails = {
        {Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}}, {.parameter = 1.0}},
        {Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, -1}}}, {.parameter = -1.0}},
        {of([](const auto& u) {
             return Vector3Of<std::decay_t<decltype(u)>>{u * u * u, 0.0, -(u * u)};
         }),
         {.parameter = -1.0, .speed = 5.0}},
        {of([](const auto& u) {
             return Vector3Of<std::decay_t<decltype(u)>>{cos(u) * cos(u) * cos(u), 0.0, sin(u) * sin(u) * sin(u)};
         }),
         {.parameter = 4.0}},
    };
    for (const auto& [curve, start] : rails) {
        const auto [words, when] = Bead(curve, start).broken(10.0);
        EXPECT_TRUE(has(words, "r' = 0")) << curve.name() << ": " << words;
        EXPECT_LT(when, 10.0);
    }
}

// --- slopes that become vertical ---

TEST(VerticalEnds, of_a_graph_end_the_run_of_a_bead_that_would_go_on_and_turn_back_one_that_would_not) {
    // x = 1 - z^2: z = -sqrt(1 - x) has its lower half alone
    const Curve half([](const auto& u) {
        using S = std::decay_t<decltype(u)>;
        return Vector3Of<S>{u, S(0.0), -sqrt(S(1.0) - u)};
    });
    const Curve whole = Parabola{.a = -1.0, .x = {0, 0, 1}, .y = {1, 0, 0}, .vertex = {1, 0, 0}};
    for (const double speed : {0.0, 1.0, 3.0, 4.0, 4.375, 4.5, 5.0, 6.0, 8.0}) {
        const Bead bead(half, {.parameter = 0.0, .speed = speed}), same(whole, {.parameter = -1.0, .speed = speed});
        const Trajectory run = same.run(1.0, 1e-11);
        const bool passes = speed * speed > 2.0 * gravity;
        const auto [words, when] = bead.broken(1.0);
        EXPECT_EQ(has(words, "it becomes vertical"), passes) << speed << words;
        if (!passes)
            EXPECT_LE((bead.run(1.0)[bead.handle].position(1.0) - run[same.handle].position(1.0)).norm(), 1e-8);
        else
            EXPECT_NEAR(run[same.handle].position(when).z(), 0.0, 1e-6) << speed;
    }
}

TEST(VerticalEnds, of_half_a_circle_are_no_places_to_turn_back) {
    // at constant speed, where the rates are smooth through the end
    const Curve half([](const auto& u) {
        using S = std::decay_t<decltype(u)>;
        return Vector3Of<S>{u, S(0.0), -sqrt(S(1.0) - u * u)};
    });
    for (const double speed : {6.0, -2.0, 0.5}) {
        const auto [words, when] = Bead(half, {.parameter = 0.0, .speed = speed}, {0, 0, 0}).broken(4.0);
        EXPECT_TRUE(has(words, "it becomes vertical")) << words;
        EXPECT_NEAR(when, 0.5 * pi / std::abs(speed), 1e-6);
    }
}

// --- cusps that are met in flight ---

TEST(Cusps, between_two_humps_are_where_a_bead_that_falls_into_the_notch_ends) {
    // it leaves one hump and lands on the other, again and again, ever deeper: in the notch nothing says what follows
    const Cycloid humps{.radius = 1.0, .x = {1, 0, 0}, .y = {0, 0, -1}};
    for (const double speed : {1.0, 2.5, 3.5, 6.0}) {
        Scene scene(down);
        const BodyHandle bead = scene.add(Particle{1.0}, Rail(humps, std::nullopt, {.side = RailSide::minus}),
                                          {.parameter = 0.125, .speed = speed});
        const Trajectory run = simulate(scene, {.until = 3.0});
        EXPECT_EQ(run.status(), Status::stopped_by_event);
        EXPECT_EQ(run.events()[run.events().size() - 1].kind, EventKind::rail_end);
        EXPECT_LE((run[bead].position(run.end()) - Vector3(pi, 0.0, -2.0)).norm(), 1e-5);
    }
}

TEST(Cusps, are_no_hindrance_to_a_flight_that_comes_down_on_another_hump) {
    // far over the next cusp, down on the hump behind it, and on
    const Cycloid humps{.radius = 1.0, .x = {1, 0, 0}, .y = {0, 0, -1}};
    Scene scene(down);
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(humps, Coulomb{0.5}, {.side = RailSide::minus}),
                                      {.parameter = 0.0, .speed = 10.0});
    const Trajectory run = simulate(scene, {.until = 0.75});
    const auto landings = run.events().times("land");
    ASSERT_GE(landings.size(), 1u) << kinds(run);
    const double u = run[bead].parameter(landings[0]);
    EXPECT_GT(u, pi);
    const double t = landings[0];
    EXPECT_LE((run[bead].position(t) - Vector3(10.0 * t, 0.0, -0.5 * gravity * t * t)).norm(), 1e-9);
}

// --- what is looked at ---

TEST(RegularStretch, ends_where_the_tangent_does_and_nowhere_else) {
    curves::RegularStretch cycloid(bowl, 1.0);
    EXPECT_FALSE(cycloid.end_above(3.0));
    ASSERT_TRUE(cycloid.end_above(20.0));
    EXPECT_NEAR(*cycloid.end_above(20.0), pi, 1e-14);
    EXPECT_FALSE(cycloid.end_above(3.14));
    ASSERT_TRUE(cycloid.end_below(-20.0));
    EXPECT_NEAR(*cycloid.end_below(-20.0), -pi, 1e-14);
    cycloid.include(4.0);
    EXPECT_FALSE(cycloid.end_above(9.0));
    EXPECT_NEAR(*cycloid.end_below(0.0), pi, 1e-14);
    const Curve waves([](const auto& u) {
        using S = std::decay_t<decltype(u)>;
        return Vector3Of<S>{u, S(0.0), sin(S(10.0) * u)};
    });
    curves::RegularStretch wave(waves, 0.0);
    EXPECT_FALSE(wave.end_above(100.0));
    EXPECT_FALSE(wave.end_below(-100.0));
}

}  // namespace
}  // namespace rbdyn::test::test_singular_rails
