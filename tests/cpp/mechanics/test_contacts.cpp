// Contacts without friction: ladders, impacts, landings and accumulations, against cases of 25 digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "random.hpp"
#include "rbdyn/body/shapes.hpp"
#include "refusal.hpp"

namespace rbdyn::test {
namespace contacts {

using figures::Case;
using figures::file_of;
using figures::given;
using figures::number;
using figures::rectangle;
using figures::vector;

const Plane floor_of_y{{0, 1, 0}};

class Ladder : public testing::TestWithParam<const char*> {};

TEST_P(Ladder, slides_down_its_wall_leaves_it_and_goes_on) {
    const auto file = file_of(GetParam());
    const double m = given(file, "m"), l = given(file, "l"), theta = given(file, "theta0");
    for (const double error : {1e-6, 1e-9, 1e-12}) {
        Scene scene(Vector3{0, 0, -given(file, "g")});
        const auto rod = scene.add(
            shapes::rod(m, l, {1, 0, 0}), Planar{.x = {1, 0, 0}, .y = {0, 0, 1}},
            {.position = {l / 2 * std::cos(theta), l / 2 * std::sin(theta)}, .angle = std::numbers::pi - theta});
        const auto floor = scene.contact(rod.point({-l / 2, 0, 0}), Plane{{0, 0, 1}});
        const auto wall = scene.contact(rod.point({l / 2, 0, 0}), Plane{{1, 0, 0}});
        const auto& values = file["values"];
        const double leaves = number(values["detachment"]["t"]), flat = number(values["lies_flat"]["t"]);
        const Trajectory run = simulate(scene, {.until = 0.5 * (leaves + flat), .error = error});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_NEAR(run.events().times("detach", wall).at(0), leaves, error * leaves);
        EXPECT_NEAR(run[rod].rate(leaves), -number(values["detachment"]["theta_dot"]), error * 3.0);
        for (const auto& s : values["phase_1_wall_and_floor"]) {
            const double t = number(s["t"]);
            EXPECT_NEAR(run[wall].force(t)[0], number(s["wall_reaction"]), error * 100.0);
            EXPECT_NEAR(run[floor].force(t)[2], number(s["floor_reaction"]), error * 100.0);
            EXPECT_NEAR(run[rod].angle(t), std::numbers::pi - number(s["theta"]), error);
        }
        // between the ends of steps it is what the piece leaves
        EXPECT_LT(std::abs(run[floor].gap(run.end())), 1e-14 + 1e-6 * error);
        EXPECT_GT(run[wall].gap(run.end()), 0.0);
        EXPECT_EQ(run[wall].state(run.end()), "open");
        EXPECT_EQ(run[wall].force(run.end()).norm(), 0.0);
    }
}
INSTANTIATE_TEST_SUITE_P(Contacts, Ladder, testing::Values("j_steep", "j_shallow", "j_theta0_60deg_like"),
                         [](const auto& p) { return std::string(p.param); });

TEST(Contacts, a_rod_strikes_the_floor_with_both_ends) {
    const auto file = file_of("n_rod_fall");
    const double l = given(file, "length"), moment = l * l / 12.0;
    Scene scene(Vector3{0, -given(file, "g"), 0});
    const auto g = vector(file["parameters"]["G0"]), v = vector(file["parameters"]["velocity_G0"]);
    const auto rod = scene.add(RigidBody(1.0, {moment / 2, moment / 2, moment}), Planar{},
                               {.position = {g[0], g[1]},
                                .velocity = {v[0], v[1]},
                                .angle = given(file, "angle0"),
                                .rate = given(file, "rate0")});
    const double e = given(file, "restitution");
    scene.contact(rod.point({-l / 2, 0, 0}), floor_of_y, {.restitution = e}, "-");
    scene.contact(rod.point({l / 2, 0, 0}), floor_of_y, {.restitution = e}, "+");
    const auto& impacts = file["values"]["impacts"];
    const double until = number(impacts.back()["t"]) * (1.0 + 1e-9);
    const Trajectory run = simulate(scene, {.until = until, .error = 1e-11});
    ASSERT_EQ(run.events().size(), impacts.size());
    for (std::size_t k = 0; k < impacts.size(); ++k) {
        const Event& event = run.events()[k];
        EXPECT_EQ(event.kind, EventKind::impact);
        EXPECT_EQ(event.name, impacts[k]["end"].get<std::string>());
        EXPECT_NEAR(event.time, number(impacts[k]["t"]), 1e-12);
        EXPECT_NEAR(event.push[1], number(impacts[k]["impulse"]), 1e-11);
        EXPECT_NEAR(run[rod].rate(event.time), number(impacts[k]["rate_after"]), 1e-11);
        EXPECT_NEAR(run[rod].rate(event.time, Side::before), number(impacts[k]["rate_before"]), 1e-11);
        EXPECT_NEAR(run.energy(event.time), number(impacts[k]["E_after"]), 1e-11);
    }
}

TEST(Contacts, a_block_rocks_to_rest_in_infinitely_many_steps) {
    const auto file = file_of("n_rocking_frictionless");
    const double b = given(file, "half_width"), h = given(file, "half_height"), tilt = given(file, "tilt0");
    Scene scene(Vector3{0, -given(file, "g"), 0});
    const auto block = scene.add(rectangle(given(file, "mass"), b, h), Planar{},
                                 {.position = {0, b * std::sin(tilt) + h * std::cos(tilt)}, .angle = tilt});
    scene.contact(block.point({-b, -h, 0}), floor_of_y, {}, "left");
    scene.contact(block.point({b, -h, 0}), floor_of_y, {}, "right");
    const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-9});
    const auto& impacts = file["values"]["impacts"];
    const std::vector<double> lands = run.events().times("land"), ends = run.events().times("accumulation");
    ASSERT_GE(lands.size(), impacts.size());
    for (std::size_t k = 0; k < impacts.size(); ++k) {
        EXPECT_NEAR(lands[k], number(impacts[k]["t"]), 1e-9);
        EXPECT_NEAR(std::abs(run[block].rate(lands[k])), number(impacts[k]["rate_after"]), 1e-9);
    }
    ASSERT_EQ(ends.size(), 1u);
    EXPECT_NEAR(ends[0], number(file["values"]["accumulation_time_at_rest_upright"]), 1e-12);
    // down to 1e-14 of the first one, but for what takes less than two roundings of the time
    EXPECT_LT(std::abs(run[block].rate(lands[lands.size() - 2])), 1e-12 * std::abs(run[block].rate(lands[0])));
    EXPECT_LT(std::abs(run[block].angle(1.0)), 1e-14);
    EXPECT_LT(run.energy(1.0), run.energy(0.0));
}

TEST(Contacts, a_box_lands_on_a_corner_and_then_flat) {
    const auto file = file_of("n_box_landing");
    const double b = given(file, "half_width"), h = given(file, "half_height");
    const auto g = vector(file["parameters"]["G0"]), v = vector(file["parameters"]["velocity_G0"]);
    Scene scene(Vector3{0, -given(file, "g"), 0});
    const auto box = scene.add(rectangle(given(file, "mass"), b, h), Planar{},
                               {.position = {g[0], g[1]},
                                .velocity = {v[0], v[1]},
                                .angle = given(file, "angle0"),
                                .rate = given(file, "rate0")});
    const auto left = scene.contact(box.point({-b, -h, 0}), floor_of_y),
               right = scene.contact(box.point({b, -h, 0}), floor_of_y);
    const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-11});
    const auto& landing = file["values"]["landing"];
    const auto& flat = file["values"]["flat"];
    ASSERT_EQ(run.events().size(), 2u);
    EXPECT_NEAR(run.events().times("land", left).at(0), number(landing["t"]), 1e-13);
    EXPECT_NEAR(run.events()[0].push[1], number(landing["impulse"]), 1e-12);
    EXPECT_NEAR(run[box].rate(number(landing["t"])), number(landing["rate_after"]), 1e-11);
    EXPECT_NEAR(run.events().times("land", right).at(0), number(flat["t"]), 1e-13);
    EXPECT_NEAR(run[left].force(number(landing["t"]))[1], number(file["values"]["contact_force_just_after_landing"]),
                1e-10);
    EXPECT_LT((run[box].velocity(1.0) - Vector3(1, 0, 0)).norm(), 1e-13);
    EXPECT_NEAR(run[left].force(1.0)[1] + run[right].force(1.0)[1], given(file, "mass") * given(file, "g"), 1e-12);
}

TEST(Contacts, balls_strike_each_other_off_centre_and_in_line) {
    for (const char* name : {"n_two_balls_line", "n_two_balls_oblique"})
        for (const bool is_swapped : {false, true}) {
            const auto file = file_of(name);
            const auto& p = file["parameters"];
            Scene scene;
            std::vector<BodyHandle> balls(2);
            for (const std::size_t k : is_swapped ? std::vector<std::size_t>{1, 0} : std::vector<std::size_t>{0, 1})
                balls[k] = scene.add(Particle{number(p["mass"][k])}, FreeStart{.position = vector(p["position0"][k]),
                                                                               .velocity = vector(p["velocity0"][k])});
            scene.contact(balls[0].sphere(number(p["radius"][0])), balls[1].sphere(number(p["radius"][1])),
                          {.restitution = given(file, "restitution")});
            const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-12});
            ASSERT_EQ(run.events().size(), 1u);
            EXPECT_NEAR(run.events()[0].time, number(file["values"]["t"]), 1e-15);
            EXPECT_NEAR(run.events()[0].push.norm(), number(file["values"]["impulse"]), 1e-14);
            EXPECT_LT((run[balls[0]].velocity(2.0) - vector(file["values"]["v1_after"])).norm(), 1e-14);
            EXPECT_LT((run[balls[1]].velocity(2.0) - vector(file["values"]["v2_after"])).norm(), 1e-14);
            EXPECT_NEAR(run.kinetic_energy(2.0), number(file["values"]["KE_after"]), 1e-14);
        }
}

TEST(Contacts, a_cradle_whose_balls_hang_apart_strikes_one_after_another) {
    const auto file = file_of("n_newton_cradle");
    const double l = given(file, "rod_length"), r = given(file, "radius"), gap = given(file, "gap");
    Scene scene(Vector3{0, -given(file, "g"), 0});
    std::vector<BodyHandle> balls;
    for (int k = 0; k < 3; ++k)
        balls.push_back(scene.add(RigidBody(given(file, "mass"), {0, 0, 0}, {.com = {0, -l, 0}}),
                                  Revolute{.axis = {0, 0, 1}, .at = {k * (2 * r + gap), 0, 0}},
                                  {.angle = k == 0 ? given(file, "angle0_first") : 0.0}));
    for (std::size_t k = 0; k < 2; ++k)
        scene.contact(balls[k].sphere(r, {0, -l, 0}), balls[k + 1].sphere(r, {0, -l, 0}),
                      {.restitution = given(file, "restitution")});
    const auto& collisions = file["values"]["collisions"];
    const Trajectory run = simulate(scene, {.until = number(collisions[3]["t"]) + 0.1, .error = 1e-6});
    ASSERT_EQ(run.events().size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(run.events()[k].time, number(collisions[k]["t"]), 1e-6);
}

TEST(Contacts, a_ball_bounces_to_rest_on_a_slope_and_slides_on) {
    const auto file = file_of("n_bouncing_ball");
    const auto& p = file["parameters"];
    Scene scene(Vector3{0, -given(file, "g"), 0});
    const auto value = [](const nlohmann::json& v) { return vector(v.is_object() ? v["value"] : v); };
    const auto ball = scene.add(Particle{given(file, "mass")},
                                FreeStart{.position = value(p["position0"]), .velocity = value(p["velocity0"])});
    const auto hit =
        scene.contact(ball, Plane{value(p["plane_normal_direction"])}, {.restitution = given(file, "restitution")});
    const Trajectory run = simulate(scene, {.until = 40.0, .error = 1e-9});
    const std::vector<double> impacts = run.events().times("impact", hit);
    // down to 1e-14 of the first speed, as far as the speed along the slope lets doubles tell
    EXPECT_GT(impacts.size(), 240u);
    for (const auto& landing : file["values"]["landings"])
        if (const auto k = landing["k"].get<std::size_t>(); k < impacts.size()) {
            EXPECT_NEAR(impacts[k], number(landing["t"]), 1e-13 * number(landing["t"]));
        }
    ASSERT_EQ(run.events().times("accumulation", hit).size(), 1u);
    EXPECT_NEAR(run.events().times("accumulation", hit)[0], 27.091427978515566, 1e-12);
    EXPECT_LT((run[ball].position(40.0) - vector(file["values"]["samples"].back()["position"])).norm(), 1e-9);
    EXPECT_NEAR(run[hit].force(40.0).norm(), number(file["values"]["samples"].back()["normal_force"]), 1e-11);
}

TEST(Contacts, what_starts_closed_stays_or_opens_and_nothing_fires) {
    Scene scene(down);
    const auto lies = scene.add(Particle{2.0}),
               flies = scene.add(Particle{1.0}, FreeStart{.position = {1, 0, 0}, .velocity = {0, 0, 3}});
    const auto a = scene.contact(lies, Plane{{0, 0, 1}}),
               b = scene.contact(flies, Plane{{0, 0, 1}}, {.restitution = 0.5});
    const Trajectory run = simulate(scene, {.until = 0.5});
    EXPECT_TRUE(run.events().empty());
    EXPECT_LT((run[a].force(0.25) - Vector3(0, 0, 2 * gravity)).norm(), 1e-13);
    EXPECT_EQ(run[a].gap(0.5), 0.0);
    EXPECT_GT(run[b].gap(0.25), 0.0);
}

TEST(Contacts, a_table_on_four_legs_stands) {
    Scene scene(down);
    const auto table = scene.add(shapes::box(3.0, {2, 1, 0.5}), BodyStart{.position = {0, 0, 0.25}});
    std::vector<ContactHandle> legs;
    for (const double x : {-1.0, 1.0})
        for (const double y : {-0.5, 0.5}) legs.push_back(scene.contact(table.point({x, y, -0.25}), Plane{{0, 0, 1}}));
    const Trajectory run = simulate(scene, {.until = 2.0});
    EXPECT_TRUE(run.events().empty());
    Vector3 sum = Vector3::Zero();
    for (const auto leg : legs) {
        sum += run[leg].force(1.0);
        EXPECT_GE(run[leg].force(1.0)[2], -1e-12);
        EXPECT_LT(std::abs(run[leg].gap(2.0)), 1e-13);
    }
    EXPECT_LT((sum - Vector3(0, 0, 3 * gravity)).norm(), 1e-12);
}

TEST(Contacts, a_ball_on_a_table_leaves_the_table_at_rest) {
    Scene scene(down);
    const auto table = scene.add(shapes::box(5.0, {2, 2, 0.2}), BodyStart{.position = {0, 0, 0.1}});
    std::vector<ContactHandle> legs;
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0}) legs.push_back(scene.contact(table.point({x, y, -0.1}), Plane{{0, 0, 1}}));
    const auto ball = scene.add(Particle{1.0}, FreeStart{.position = {0.3, 0.1, 0.9}});
    const auto hit = scene.contact(ball.sphere(0.2), table.plane({{0, 0, 1}, {0, 0, 0.1}}), {.restitution = 0.5});
    const Trajectory run = simulate(scene, {.until = 0.6});
    ASSERT_EQ(run.events().size(), 1u);
    EXPECT_NEAR(run.events().times("impact", hit).at(0), std::sqrt(1.0 / gravity), 1e-12);
    EXPECT_NEAR(run.events()[0].push[2], 1.5 * std::sqrt(gravity), 1e-12);
    EXPECT_LT(run[table].velocity(0.6).norm() + run[table].angular_velocity(0.6).norm(), 1e-13);
    for (const auto leg : legs) EXPECT_EQ(run[leg].state(0.6), "slides");
}

/// A force along z.
template <class F>
Force lifting(F f) {
    return Force([f](const auto& t, const auto&, const auto&) {
        Vector3Of<std::decay_t<decltype(t)>> force;
        force[0] = force[1] = 0.0 * t;
        force[2] = f(t);
        return force;
    });
}

TEST(Contacts, open_where_their_force_jumps_below_zero) {
    Scene scene(down);
    const auto ball = scene.add(Particle{1.0});
    const auto touch = scene.contact(ball, Plane{{0, 0, 1}});
    scene.apply(lifting([](const auto& t) { return where(t > 1.0, 15.0 + 0.0 * t, 0.0 * t); }), ball);
    const Trajectory run = simulate(scene, {.until = 2.0});
    EXPECT_EQ(run.events().times("detach", touch), std::vector<double>{1.0});
    EXPECT_NEAR(run[ball].position(2.0)[2], (15.0 - gravity) / 2, 1e-13);
    EXPECT_EQ(run[touch].force(1.5).norm(), 0.0);
}

TEST(Contacts, what_lies_at_rest_takes_off_where_it_is_lifted) {
    for (const double g : {gravity, 0.0}) {
        Scene scene(Vector3{0, 0, -g});
        const auto ball = scene.add(Particle{1.0});
        scene.contact(ball, Plane{{0, 0, 1}});
        scene.apply(lifting([](const auto& t) { return 5.0 * t; }), ball);
        const Trajectory run = simulate(scene, {.until = 3.0});
        const double off = 3.0 - g / 5.0;
        EXPECT_NEAR(run[ball].position(3.0)[2], 5.0 * off * off * off / 6.0, 1e-12);
    }
}

TEST(Contacts, boxes_that_stand_on_more_than_they_need_stand_on_all_of_it) {
    for (const double size : {1e-3, 1.0, 1e3}) {
        Scene scene(down);
        const auto box = scene.add(shapes::box(1.0, {size, size, 0.5 * size}), BodyStart{.position = {0, 0, size / 4}});
        std::vector<ContactHandle> corners;
        for (const double x : {-0.5, 0.5})
            for (const double y : {-0.5, 0.5})
                corners.push_back(scene.contact(box.point({x * size, y * size, -size / 4}), Plane{{0, 0, 1}}));
        const Trajectory run = simulate(scene, {.until = 1.0, .rtol = 1e-12});
        EXPECT_TRUE(run.events().empty());
        // one choice of many forces: all push, together they are the weight
        double sum = 0.0;
        for (const auto corner : corners) {
            EXPECT_GT(run[corner].force(1.0)[2], 0.1 * gravity) << size;
            sum += run[corner].force(1.0)[2];
        }
        EXPECT_NEAR(sum, gravity, 1e-12);
    }
}

TEST(Contacts, refuse_what_they_cannot_do) {
    Scene scene(down);
    const auto ball = scene.add(Particle{1.0}, FreeStart{.position = {0, 0, -1}});
    scene.contact(ball, Plane{{0, 0, 1}}, {}, "touch");
    EXPECT_NE(refusal([&] { simulate(scene, {.until = 1.0}); }).find("touch: gap is -1"), std::string::npos);
    EXPECT_NE(refusal([&] {
                  scene.contact(ball, Plane{{0, 0, 1}}, {.restitution = 1.5});
              }).find("restitution is 1.5"),
              std::string::npos);
    const auto refused = [&](const ContactSurface& surface) { return refusal([&] { scene.contact(ball, surface); }); };
    EXPECT_NE(refused(BodyHandle{}.plane(Plane{})).find("body is -1"), std::string::npos);
    EXPECT_NE(refused(BodyHandle{}.sphere(1.0)).find("body is -1"), std::string::npos);
}

TEST(Contacts, that_strike_together_are_told_in_the_order_of_their_names) {
    Scene scene(down);
    const BodyHandle box = scene.add(shapes::box(3.0, {2, 1, 0.5}), BodyStart{.position = {0, 0, 1.25}});
    for (const auto& [name, x] : {std::pair("zeta", -1.0), {"alpha", 1.0}, {"mu", 0.5}})
        scene.contact(box.point({x, 0.0, -0.25}), Plane{{0, 0, 1}}, {.restitution = 0.5}, name);
    const Trajectory run = simulate(scene, {.until = 0.5});
    std::vector<std::string> names;
    for (const Event& e : run.events()) {
        names.push_back(e.name);
        EXPECT_EQ(e.time, run.events()[0].time);
    }
    EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
    EXPECT_GE(names.size(), 2u);
}

TEST(Contacts, strike_to_the_velocity_of_their_law_to_the_last_digit) {
    for (const double mass : {0.3, 0.7, 1.3})
        for (const double speed : {0.3, 0.7, 3.1})
            for (const double e : {1.0, 0.0}) {
                Scene scene;
                const BodyHandle a = scene.add(Particle{mass}, FreeStart{{0, 0, 1}, {0.1, 0.2, -speed}});
                scene.contact(a, Plane{{0, 0, 1}}, {.restitution = e});
                const Trajectory run = simulate(scene, {.until = 2.0 / speed});
                EXPECT_EQ(run[a].velocity(1.5 / speed)[2], e * speed) << mass << ' ' << speed << ' ' << e;
            }
}

/// A box above a floor, somehow turned in space with it, on its corners; beside a wall that it touches, or not.
struct Dropped {
    Scene scene;
    BodyHandle box;
    std::vector<ContactHandle> corners;

    /// `along` the floor, as the box sees it.
    Dropped(Random& random, double height, const Vector3& along, std::optional<Coulomb> friction, bool has_wall) {
        const double angle = random.uniform(0.0, 3.0);
        const Quaternion frame = turn(random.direction(), angle);
        const Matrix3 axes = rotation_matrix(frame);
        scene.set_gravity(axes * Vector3(0, 0, -9.81));
        box = scene.add(
            shapes::box(random.uniform(0.5, 3.0), {2, 1, 0.5}),
            BodyStart{.position = axes * Vector3(0, 0, 0.25 + height), .velocity = axes * along, .attitude = frame});
        const double x[] = {-1, 1, -1, 1}, y[] = {-0.5, 0.5, 0.5, -0.5};
        for (int i = 0; i < 4; ++i)
            corners.push_back(
                scene.contact(box.point({x[i], y[i], -0.25}), Plane{axes * Vector3(0, 0, 1)}, {.friction = friction}));
        if (has_wall)
            scene.contact(box.point({1, 0, 0}), Plane{axes * Vector3(-1, 0, 0), axes * Vector3(1, 0, 0)},
                          {.friction = friction}, "wall");
    }
};

TEST(Contacts, with_a_wall_that_nothing_presses_on_stay_as_they_are) {
    Random random(7);
    for (int trial = 0; trial < 12; ++trial) {
        const Dropped d(random, random.uniform(0.1, 1.0), {0, 0, 0}, std::nullopt, true);
        const Trajectory run = simulate(d.scene, {.until = 1.0, .rtol = 1e-11});
        EXPECT_TRUE(run.events().times("detach").empty()) << trial << ' ' << kinds(run);
        for (const ContactHandle corner : d.corners)
            EXPECT_EQ(run.events().times("land", corner).size(), 1u) << trial << ' ' << kinds(run);
    }
}

}  // namespace contacts

}  // namespace rbdyn::test
