// Starts that change without building anew: the same checks as where a body is added, and every run is what it would be
// of a scene that was built with that start and planned anew.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "effects/random_formula.hpp"
#include "many/same_run.hpp"
#include "many/varied.hpp"
#include "random.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_starts {
namespace {

using namespace varied;

SimulateOptions until(double end, bool is_estimated) {
    SimulateOptions options{.until = end};
    if (is_estimated)
        options.error = 1e-8;
    else
        options.rtol = 1e-10;
    return options;
}

/// What attempt() gives or refuses.
std::variant<Attempt, std::string> tried(const Scene& scene, const SimulateOptions& options) {
    try {
        return attempt(scene, options);
    } catch (const InvalidInput& e) {
        return std::string(e.what());
    }
}

TEST(Starts, runs_that_start_elsewhere_are_those_of_scenes_built_so) {
    int all_kept = 0;
    for (const Kind& kind : kinds()) {
        SCOPED_TRACE(kind.name);
        Random random(7);
        ASSERT_NO_THROW((void)attempt(kind.scene, until(0.5, false)));
        int kept = 0;
        for (int i = 0; i < 40; ++i) {
            SCOPED_TRACE(i);
            const Scene scene = started_elsewhere(random, kind.scene);
            const SimulateOptions options = until(0.5, i % 4 == 0);
            const auto run = tried(scene, options), anew = tried(unplanned(scene), options);
            ASSERT_EQ(run.index(), anew.index());
            if (run.index() == 1) {
                EXPECT_EQ(std::get<1>(run), std::get<1>(anew));
                continue;
            }
            expect_same_run(std::get<0>(run), std::get<0>(anew));
            kept += std::get<0>(run).run.statistics().planned ? 0 : 1;
        }
        if (kind.shares) {
            EXPECT_GE(kept, 15);
        }
        all_kept += kept;
    }
    EXPECT_GT(all_kept, 400);
}

TEST(Starts, random_formulas_give_the_same_from_wherever_they_start) {
    int kept = 0;
    for (unsigned seed = 0; seed < 120; ++seed) {
        SCOPED_TRACE(seed);
        Parameter a(0.5, "a"), b(0.7, "b");
        const auto force = [=](const Number& t, const Vector& r, const Vector& v) {
            RandomFormula formula(seed);
            const std::vector<Number> x{a, b, t, r[0], r[1], r[2], v[0], v[1], v[2]};
            Vector f;
            for (int i = 0; i < 3; ++i) f[i] = formula.draw(2) == 0 ? Number(0.0) : 0.3 * formula(3, x);
            return f;
        };
        Scene scene = seed % 3 == 0 ? on_rail(hoop, Coulomb{0.3, 0.2}) : Scene(down);
        if (seed % 3 != 0) scene.add(Particle{1.0}, FreeStart{{0.1, 0, 1}, {0.5, 0, 0.5}});
        scene.apply(Force(force), BodyHandle{0});
        Random random(seed + 1000);
        for (int i = 0; i < 6; ++i) {
            static constexpr double some[] = {0.5, 0.7, 0.0, 1.0, -1.0, 0.3};
            a.set(some[random.whole(0, 5)]);
            b.set(some[random.whole(0, 5)]);
            Scene other = scene;
            if (i > 0) other.replace(BodyHandle{0}, drawn(random, scene.start(BodyHandle{0})));
            const Attempt run = attempt(other, until(0.5, i % 3 == 0));
            kept += run.run.statistics().planned ? 0 : 1;
            expect_same_run(run, attempt(unplanned(other), until(0.5, i % 3 == 0)));
        }
    }
    EXPECT_GT(kept, 150);
}

TEST(Starts, plan_once_where_the_same_stays_as_it_starts) {
    const Scene scene = with_drag();
    EXPECT_TRUE(attempt(scene, until(0.5, false)).run.statistics().planned);
    for (const double speed : {0.5, 1.0, 2.0, 3.0}) {
        Scene other = scene;
        other.replace(BodyHandle{0}, FreeStart{{speed, 0, 2}, {speed, 0, -1}});
        EXPECT_FALSE(attempt(other, until(0.5, false)).run.statistics().planned);
        other.replace(BodyHandle{0}, FreeStart{{0, speed, 2}, {speed, 0, -1}});
        EXPECT_TRUE(attempt(other, until(0.5, false)).run.statistics().planned);
    }
    EXPECT_FALSE(attempt(scene, until(0.5, false)).run.statistics().planned);
}

TEST(Starts, anchors_of_a_loop_that_lie_where_it_starts_are_found_anew) {
    Scene scene(down);
    const BodyHandle body = scene.add(brick, BodyStart{});
    scene.constrain(Ball{}, body.point({-0.5, 0, 0}));
    (void)attempt(scene, until(0.5, false));
    Scene other = scene;
    other.replace(body, BodyStart{.position = {1, 0, 0}});
    expect_same_run(attempt(other, until(0.5, false)), attempt(unplanned(other), until(0.5, false)));
    EXPECT_NEAR(attempt(other, until(0.5, false)).run[body].position(0.0)[0], 1.0, 1e-15);
}

TEST(Starts, a_start_that_breaks_a_constraint_is_refused_with_its_gap) {
    Scene scene = swung_by_a_point();
    (void)attempt(scene, until(0.2, false));
    scene.replace(BodyHandle{0}, BodyStart{.position = {0.75, 0, 0}});
    const std::string message = refusal([&] { (void)attempt(scene, until(0.2, false)); });
    EXPECT_NE(message.find("gap is 0.25"), std::string::npos) << message;
}

TEST(Starts, what_add_refuses_is_refused_with_the_same_words) {
    const auto both = [](auto body, auto joint, auto bad) {
        Scene built;
        const std::string message = refusal([&] { built.add(body, joint, bad, "it"); });
        Scene scene;
        const BodyHandle it = scene.add(body, joint, decltype(bad){}, "it");
        EXPECT_NE(message, "accepted");
        EXPECT_EQ(refusal([&] { scene.replace(it, bad); }), message);
    };
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    both(Particle{1.0}, Free{}, FreeStart{.position = {0, nan, 0}});
    both(Particle{1.0}, Rail(hoop), RailStart{.parameter = 1.0, .arc_length = 1.0});
    both(Particle{1.0}, Rail(Curve(hoop)), RailStart{.speed = nan});
    both(brick, Free{}, BodyStart{.angular_velocity = Vector3(1, 0, 0), .angular_velocity_world = Vector3(1, 0, 0)});
    both(brick, Revolute{}, RevoluteStart{.rate = nan});
    both(brick, Prismatic{}, PrismaticStart{.displacement = nan});
    both(brick, Universal{}, UniversalStart{.angles = {0, nan}});
    both(brick, Cylindrical{}, CylindricalStart{.displacement_rate = nan});
    both(brick, Planar{}, PlanarStart{.position = {nan, 0}});
}

TEST(Starts, words_of_another_joint_are_refused) {
    Scene scene;
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{}, "ball"), wheel = scene.add(brick, Revolute{});
    for (const Start& start : std::vector<Start>{RevoluteStart{}, BodyStart{}, RailStart{}})
        EXPECT_EQ(refusal([&] { scene.replace(ball, start); }),
                  "ball: its start is given in the words of another joint; give those of its own, as add() takes them");
    EXPECT_NE(refusal([&] { scene.replace(wheel, PrismaticStart{}); }), "accepted");
    EXPECT_NE(refusal([&] { scene.replace(BodyHandle{5}, FreeStart{}); }), "accepted");
    EXPECT_NE(refusal([&] { scene.replace(wheel, RevoluteStart{.parent = {0}}); }), "accepted");
}

TEST(Starts, are_told_in_the_words_they_were_given_in) {
    for (const Kind& kind : kinds())
        for (std::size_t k = 0; k < kind.scene.bodies().size(); ++k) {
            SCOPED_TRACE(kind.name);
            const BodyHandle body{static_cast<int>(k)};
            Scene same = kind.scene;
            same.replace(body, same.start(body));
            EXPECT_EQ(same, kind.scene);
        }
    Scene scene;
    const BodyHandle top = scene.add(brick, Spherical{}, SphericalStart{.angular_velocity_world = Vector3(1, 2, 3)});
    auto start = std::get<SphericalStart>(scene.start(top));
    EXPECT_EQ(start.angular_velocity_world, Vector3(1, 2, 3));
    EXPECT_FALSE(start.angular_velocity);
}

TEST(Starts, bodies_are_found_by_name) {
    Scene scene;
    EXPECT_EQ(refusal([&] { (void)scene.body("ball"); }),
              "Scene: there is no body named \"ball\"; it has no bodies: add() some");
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{}, "ball"), second = scene.add(Particle{1.0});
    EXPECT_EQ(scene.body("ball"), ball);
    EXPECT_EQ(scene.body("particle 2"), second);
    EXPECT_EQ(refusal([&] { (void)scene.body("bell"); }),
              "Scene: there is no body named \"bell\"; there are \"ball\", \"particle 2\"");
}

}  // namespace
}  // namespace rbdyn::test::test_starts
