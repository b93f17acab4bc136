// Friction at contacts: what slides, sticks, rolls, breaks away and strikes, against cases of 25 digits and closed
// forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "figures.hpp"
#include "rbdyn/body/shapes.hpp"
#include "refusal.hpp"

namespace rbdyn::test {
namespace rough_contacts {

using figures::file_of;
using figures::given;
using figures::number;
using figures::rectangle;
using figures::vector;

ContactOptions rough(double mu) { return {.friction = Coulomb{mu}}; }

TEST(RoughContacts, a_ball_with_backspin_slides_then_rolls) {
    const auto file = file_of("n_ball_backspin");
    const double r = given(file, "radius");
    const auto& p = file["parameters"];
    for (const double error : {1e-6, 1e-9, 1e-12}) {
        Scene scene(Vector3{0, 0, -given(file, "g")});
        const auto ball = scene.add(shapes::sphere(given(file, "mass"), r),
                                    BodyStart{.position = {0, 0, r},
                                              .velocity = vector(p["velocity0"]),
                                              .angular_velocity = vector(p["angular_velocity0"])});
        const auto touch = scene.contact(ball.sphere(r), Plane{{0, 0, 1}}, rough(given(file, "mu")));
        const Trajectory run = simulate(scene, {.until = 2.0, .error = error});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_NEAR(run.events().times("stick", touch).at(0), number(file["values"]["rolling_from"]), error);
        for (const auto& s : file["values"]["samples"]) {
            const double t = number(s["t"]);
            EXPECT_LT((run[ball].position(t) - vector(s["position"])).norm(), 3.0 * error);
            EXPECT_LT((run[ball].velocity(t) - vector(s["velocity"])).norm(), 3.0 * error);
            EXPECT_LT((run[ball].angular_velocity_world(t) - vector(s["angular_velocity_world"])).norm(), 24.0 * error);
            Vector3 along = run[touch].force(t);
            along[2] = 0.0;
            EXPECT_LT((along - vector(s["friction_force"])).norm(), 2.0 * error);
            EXPECT_NEAR(run.kinetic_energy(t), number(s["KE"]), 4.0 * error);
        }
        EXPECT_EQ(run[touch].state(0.5), "slides");
        EXPECT_EQ(run[touch].state(1.0), "sticks");
        // what rolls keeps its condition to rounding
        for (double t = 0.7; t <= 2.0; t += 0.05) EXPECT_LT(run[touch].slip(t).norm(), 1e-14);
    }
}

TEST(RoughContacts, a_block_thrown_up_an_incline_stops_and_stays) {
    const auto file = file_of("n_sliding_block");
    for (const double error : {1e-6, 1e-9, 1e-12}) {
        Scene scene(Vector3{0, -given(file, "g"), 0});
        const Vector3 along = vector(file["parameters"]["incline_tangent_direction"]) / 5.0;
        const auto block =
            scene.add(Particle{given(file, "mass")}, FreeStart{.velocity = along * given(file, "speed0_up_the_slope")});
        const auto touch = scene.contact(block, Plane{{-3, 4, 0}},
                                         {.friction = Coulomb{given(file, "mu_static"), given(file, "mu_dynamic")}});
        const Trajectory run = simulate(scene, {.until = 1e5, .error = error});
        ASSERT_EQ(run.events().size(), 2u);
        EXPECT_NEAR(run.events().times("stick", touch).at(0), number(file["values"]["stop"]["t"]), error);
        EXPECT_EQ(run.events().times("rest", block), run.events().times("stick", touch));
        for (const auto& s : file["values"]["samples"]) {
            const double t = number(s["t"]);
            EXPECT_NEAR(run[block].position(t).dot(along), number(s["s"]), error);
            EXPECT_NEAR(run[block].velocity(t).dot(along), number(s["v"]), 3.0 * error);
            EXPECT_NEAR(run[touch].force(t).dot(along), number(s["friction_force_along_s"]), 10.0 * error);
        }
        // it does not creep
        EXPECT_EQ((run[block].position(1e5) - run[block].position(1.0)).norm(), 0.0);
        EXPECT_EQ(run[block].velocity(1e5).norm(), 0.0);
    }
}

TEST(RoughContacts, a_disk_on_an_incline_rolls_or_slides) {
    const auto file = file_of("n_disk_incline");
    const double r = given(file, "radius"), m = given(file, "mass");
    for (const auto& one : file["values"]["cases"]) {
        const Vector3 down = -vector(one["slope_tangent_direction"]).normalized(), normal(down[1], -down[0], 0);
        Scene scene(Vector3{0, -given(file, "g"), 0});
        const auto disk = scene.add(shapes::disc(m, r, {0, 0, 1}), BodyStart{.position = normal * r});
        const auto touch = scene.contact(disk.disc(r, {0, 0, 1}), Plane{normal}, rough(number(one["mu"])));
        const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-11});
        EXPECT_TRUE(run.events().empty());
        for (const auto& s : one["samples"]) {
            const double t = number(s["t"]);
            EXPECT_NEAR((run[disk].position(t) - normal * r).dot(down), number(s["distance"]), 1e-10);
            EXPECT_NEAR(run[disk].velocity(t).dot(down), number(s["speed"]), 1e-10);
            EXPECT_NEAR(run[disk].angular_velocity(t).norm(), number(s["rate"]), 1e-9);
            EXPECT_NEAR(run[touch].slip(t).norm(), number(s["slip_speed"]), 1e-10);
        }
        EXPECT_EQ(run[touch].state(1.0), one["rolls"].get<bool>() ? "sticks" : "slides") << one["mu"];
        EXPECT_NEAR(run[touch].force(1.0).dot(-down), number(one["friction"]), 1e-10);
    }
}

/// A ladder of a file, its foot on the floor and its top against the wall x = 0, at an angle.
struct Ladder {
    Scene scene;
    BodyHandle rod;
    ContactHandle floor, wall;

    Ladder(const nlohmann::json& file, double angle) : scene(Vector3{0, -given(file, "g"), 0}) {
        const double l = given(file, "length");
        rod = scene.add(
            shapes::rod(given(file, "mass"), l, {1, 0, 0}), Planar{},
            {.position = {l / 2 * std::cos(angle), l / 2 * std::sin(angle)}, .angle = std::numbers::pi - angle});
        floor = scene.contact(rod.point({-l / 2, 0, 0}), Plane{{0, 1, 0}}, rough(given(file, "mu_floor")), "floor");
        wall = scene.contact(rod.point({l / 2, 0, 0}), Plane{{1, 0, 0}}, rough(given(file, "mu_wall")), "wall");
    }
};

TEST(RoughContacts, a_ladder_slides_at_both_ends_and_leaves_its_wall) {
    const auto file = file_of("n_ladder_friction");
    const double angle = given(file, "angle0");
    for (const double error : {1e-6, 1e-9, 1e-12}) {
        const Ladder ladder(file, angle);
        const auto& leaves = file["values"]["leaves_wall"];
        const Trajectory run = simulate(ladder.scene, {.until = number(leaves["t"]) + 0.05, .error = error});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_NEAR(run.events().times("detach", ladder.wall).at(0), number(leaves["t"]), error * 2.0);
        const double t1 = number(leaves["t"]);
        EXPECT_NEAR(run[ladder.rod].rate(t1), -number(leaves["rate"]), error * 2.0);
        EXPECT_NEAR(run[ladder.floor].force(t1)[1], number(leaves["N_floor"]), error * 100.0);
        EXPECT_NEAR(run[ladder.floor].force(0.0)[1], number(file["values"]["at_release"]["N_floor"]), 1e-12);
        EXPECT_NEAR(run[ladder.wall].force(0.0)[0], number(file["values"]["at_release"]["N_wall"]), 1e-12);
        for (const auto& s : file["values"]["samples"]) {
            const double t = number(s["t"]);
            EXPECT_NEAR(run[ladder.rod].angle(t), std::numbers::pi - number(s["angle"]), error);
            EXPECT_NEAR(run[ladder.floor].force(t)[1], number(s["N_floor"]), error * 100.0);
            EXPECT_NEAR(run[ladder.wall].force(t)[0], number(s["N_wall"]), error * 100.0);
            EXPECT_NEAR(run.energy(t), number(s["E"]), error * 200.0);
        }
    }
}

TEST(RoughContacts, a_ladder_stands_while_any_forces_inside_its_cones_hold_it) {
    const auto file = file_of("n_ladder_friction");
    const double limit = number(file["values"]["static_limit_angle"]);
    for (const double off : {1e-2, 1e-5, 1e-9}) {
        const Ladder stands(file, limit + off);
        const Trajectory run = simulate(stands.scene, {.until = 1e5});
        EXPECT_TRUE(run.events().empty());
        EXPECT_EQ(run[stands.floor].state(0.0), "sticks") << off;
        EXPECT_EQ(run[stands.wall].state(0.0), "sticks");
        EXPECT_EQ(run[stands.rod].angle(1e5), run[stands.rod].angle(0.0));
        const Vector3 f = run[stands.floor].force(1.0), w = run[stands.wall].force(1.0);
        EXPECT_LE(std::abs(f[0]), 0.25 * f[1] * (1 + 1e-12));
        EXPECT_LE(std::abs(w[1]), 0.25 * w[0] * (1 + 1e-12));
        EXPECT_LT((f + w - Vector3(0, given(file, "mass") * given(file, "g"), 0)).norm(), 1e-11);
        const Ladder falls(file, limit - off);
        EXPECT_EQ(simulate(falls.scene, {.until = 0.01, .rtol = 1e-12})[falls.floor].state(0.0), "slides") << off;
    }
}

TEST(RoughContacts, a_load_that_grows_breaks_a_ladder_away_where_no_forces_hold_it) {
    // a person of weight W = rate t at 3/4 of the ladder: it stands as long as
    //     (1 + mu^2)(P l/2 + W 3l/4) cos = ... closed form below by moments about where the edges of the cones meet
    const auto file = file_of("n_ladder_friction");
    const double mu = 0.25, l = given(file, "length"), weight = given(file, "mass") * given(file, "g"), angle = 1.1;
    Ladder ladder(file, angle);
    const double rate = 10.0, part = 0.9;
    ladder.scene.apply(Force([=](const auto& t, const auto&, const auto&) {
                           Vector3Of<std::decay_t<decltype(t)>> f;
                           f[0] = f[2] = 0.0 * t;
                           f[1] = -rate * t;
                           return f;
                       }),
                       ladder.rod, Vector3(l * (part - 0.5), 0, 0));
    // at the limit both ends are on their edges: N_w = mu N_f, N_f (1 + mu^2) = P + W; moments about the foot:
    // (P l/2 + W part l) cos = N_w l sin + mu N_w l cos
    const double c = std::cos(angle), s = std::sin(angle), k = mu * (s + mu * c) / (1 + mu * mu);
    const double load = weight * (k - c / 2) / (part * c - k);
    ASSERT_GT(load, 0.0);
    const Trajectory run = simulate(ladder.scene, {.until = load / rate + 0.1, .error = 1e-9});
    ASSERT_EQ(run.events().size(), 2u);
    EXPECT_NEAR(run.events().times("slip", ladder.floor).at(0), load / rate, 1e-9 * load / rate);
    EXPECT_NEAR(run.events().times("slip", ladder.wall).at(0), load / rate, 1e-9 * load / rate);
}

TEST(RoughContacts, a_block_rocks_to_rest_on_a_floor_that_never_lets_it_slip) {
    const auto file = file_of("n_rocking_housner");
    const double b = given(file, "half_width"), h = given(file, "half_height"), tilt = given(file, "tilt0");
    Scene scene(Vector3{0, -given(file, "g"), 0});
    const Vector3 corner(b, -h, 0);
    const auto block = scene.add(rectangle(given(file, "mass"), b, h), Planar{},
                                 {.position = {0, b * std::sin(tilt) + h * std::cos(tilt)}, .angle = tilt});
    const ContactOptions never{.friction = Coulomb{std::numeric_limits<double>::infinity()}};
    scene.contact(block.point({-b, -h, 0}), Plane{{0, 1, 0}}, never, "left");
    scene.contact(block.point(corner), Plane{{0, 1, 0}}, never, "right");
    const Trajectory run = simulate(scene, {.until = 6.0, .error = 1e-9});
    const auto& impacts = file["values"]["impacts"];
    const std::vector<double> lands = run.events().times("land"), ends = run.events().times("accumulation");
    ASSERT_GE(lands.size(), impacts.size());
    for (std::size_t k = 0; k < impacts.size(); ++k) {
        EXPECT_NEAR(lands[k], number(impacts[k]["t"]), 1e-9);
        EXPECT_NEAR(std::abs(run[block].rate(lands[k])), number(impacts[k]["rate_after"]), 1e-9);
    }
    EXPECT_TRUE(run.events().times("slip").empty());
    ASSERT_EQ(ends.size(), 1u);
    EXPECT_NEAR(ends[0], number(file["values"]["accumulation_time_at_rest_upright"]), 1e-9);
    EXPECT_LT(std::abs(run[block].angle(6.0)), 1e-12);
}

struct PainleveRod {
    Scene scene;
    BodyHandle rod;
    ContactHandle touch;

    PainleveRod(const nlohmann::json& file, double mu, double angle, double rate, double v)
        : scene(Vector3{0, -given(file, "g"), 0}) {
        const double l = given(file, "half_length");
        const Vector3 arm = l * Vector3(std::cos(angle), std::sin(angle), 0);
        rod = scene.add(shapes::rod(given(file, "mass"), 2 * l, {1, 0, 0}), Planar{},
                        {.position = {arm[0], arm[1]},
                         .velocity = {v - rate * arm[1], rate * arm[0]},
                         .angle = angle,
                         .rate = rate});
        touch = scene.contact(rod.point({-l, 0, 0}), Plane{{0, 1, 0}}, rough(mu));
    }
};

TEST(RoughContacts, a_rod_slides_until_no_motion_satisfies_the_laws) {
    const auto file = file_of("n_painleve_rod");
    const auto& values = file["values"];
    const double t_c = number(values["t_c"]);
    const PainleveRod one(file, given(file, "mu"), given(file, "angle0"), given(file, "rate0"), given(file, "v_P0"));
    for (const double error : {1e-6, 1e-9, 1e-11}) {
        const Trajectory run = simulate(one.scene, {.until = 0.999 * t_c, .error = error});
        for (const auto& s : values["samples"]) {
            const double t = number(s["t"]);
            EXPECT_NEAR(run[one.rod].angle(t), number(s["angle"]), error);
            EXPECT_NEAR(run[one.rod].rate(t), number(s["rate"]), 6.0 * error);
            EXPECT_NEAR(run[one.touch].force(t)[1], number(s["normal_force"]), 100.0 * error);
        }
    }
    try {
        simulate(one.scene, {.until = 1.0, .rtol = 1e-12});
        FAIL() << "it went on";
    } catch (const IntegrationError& e) {
        EXPECT_EQ(e.run.status(), Status::inconsistent) << e.what();
        EXPECT_NEAR(e.run.end(), t_c, 1e-5);
        EXPECT_NE(std::string(e.what()).find("Painleve"), std::string::npos) << e.what();
    }
    const auto& leaves = values["with_mu_detach"];
    const PainleveRod other(file, given(file, "mu_detach"), given(file, "angle0"), given(file, "rate0"),
                            given(file, "v_P0"));
    const Trajectory run = simulate(other.scene, {.until = 0.2, .error = 1e-9});
    ASSERT_GE(run.events().size(), 1u);
    EXPECT_NEAR(run.events().times("detach", other.touch).at(0), number(leaves["leaves_the_floor_t"]), 1e-9);
}

TEST(RoughContacts, what_has_no_motion_at_its_start_says_so) {
    const auto file = file_of("n_painleve_rod");
    const PainleveRod none(file, given(file, "mu"), 1.125, 0.0, -20.0);
    try {
        simulate(none.scene, {.until = 1.0});
        FAIL() << "it went on";
    } catch (const IntegrationError& e) {
        EXPECT_EQ(e.run.status(), Status::inconsistent);
        EXPECT_EQ(e.run.end(), 0.0);
    }
}

/// Thrown across an incline of angle alpha with mu cot(alpha) = k: with phi the angle between the velocity and the way
/// down, v = C tan(phi/2)^k / sin(phi), dt = - v dphi / (g sin(alpha) sin(phi)).
TEST(RoughContacts, a_direction_that_turns_to_the_end_ends_where_the_closed_form_does) {
    for (const double mu : {0.9, 1.0, 1.5, 3.0, 12.0}) {
        Scene scene(Vector3{0, -9.81, 0});
        const auto p = scene.add(Particle{1.25}, FreeStart{.velocity = {0, 0, 2}});
        const auto touch = scene.contact(p, Plane{{-3, 4, 0}}, rough(mu));
        const double stop = 2.0 / 9.81 * mu * 0.8 / (mu * mu * 0.64 - 0.36);
        const Trajectory run = simulate(scene, {.until = stop + 1.0, .error = 1e-11});
        ASSERT_EQ(run.events().size(), 2u);
        EXPECT_NEAR(run.events().times("stick", touch).at(0), stop, 2e-11 * stop) << mu;
        EXPECT_EQ(run.events().times("rest", p), run.events().times("stick", touch));
        EXPECT_EQ(run[p].velocity(stop + 1.0).norm(), 0.0);
        const double k = mu * 0.8 / 0.6;
        for (double t = 0.1 * stop; t < 0.99 * stop; t += 0.1 * stop) {
            const Vector3 v = run[p].velocity(t);
            const double down = v.dot(Vector3(-0.8, -0.6, 0)), phi = std::atan2(v[2], down);
            // C = v0 at phi = pi/2; an error of v turns it by itself over v
            EXPECT_NEAR(v.norm(), 2.0 * std::pow(std::tan(phi / 2), k) / std::sin(phi), 2e-11 * (1 + k / std::sin(phi)))
                << mu << " " << t;
        }
    }
}

TEST(RoughContacts, what_the_incline_cannot_hold_slides_on_down) {
    Scene scene(Vector3{0, -9.81, 0});
    const auto p = scene.add(Particle{1.0}, FreeStart{.velocity = {0, 0, 2}});
    const auto touch = scene.contact(p, Plane{{-3, 4, 0}}, rough(0.5));
    const Trajectory run = simulate(scene, {.until = 50.0, .error = 1e-10});
    EXPECT_TRUE(run.events().empty());
    const double k = 0.5 * 0.8 / 0.6;
    for (const double t : {0.1, 0.5, 1.0, 5.0}) {
        const Vector3 v = run[p].velocity(t);
        const double phi = std::atan2(v[2], v.dot(Vector3(-0.8, -0.6, 0)));
        EXPECT_NEAR(v.norm() * std::sin(phi), 2.0 * std::pow(std::tan(phi / 2), k), 1e-9) << t;
    }
    // down the slope at g (sin - mu cos) in the end
    EXPECT_NEAR(run[p].acceleration(50.0).norm(), 9.81 * (0.6 - 0.5 * 0.8), 1e-4);
    EXPECT_EQ(run[touch].state(50.0), "slides");
}

TEST(RoughContacts, a_box_pushed_ever_harder_breaks_away_at_its_static_cone) {
    // planar, on two corners that share the load: hyperstatic along the floor
    Scene scene(Vector3{0, -9.8125, 0});
    const auto box = scene.add(rectangle(2.0, 0.5, 0.125), Planar{}, {.position = {0, 0.125}});
    const ContactOptions friction{.friction = Coulomb{0.5, 0.25}};
    const auto left = scene.contact(box.point({-0.5, -0.125, 0}), Plane{{0, 1, 0}}, friction, "left"),
               right = scene.contact(box.point({0.5, -0.125, 0}), Plane{{0, 1, 0}}, friction, "right");
    scene.apply(Force([](const auto& t, const auto&, const auto&) {
                    Vector3Of<std::decay_t<decltype(t)>> f;
                    f[0] = 3.0 * t;
                    f[1] = f[2] = 0.0 * t;
                    return f;
                }),
                box, Vector3(0, -0.125, 0));
    const double breaks = 0.5 * 2.0 * 9.8125 / 3.0;
    const Trajectory run = simulate(scene, {.until = breaks + 1.0, .error = 1e-9});
    EXPECT_NEAR(run.events().times("slip", left).at(0), breaks, 1e-9);
    EXPECT_NEAR(run.events().times("slip", right).at(0), breaks, 1e-9);
    EXPECT_EQ(run.events().size(), 2u);
    // v' = 3 t / m - mu g
    const double t = breaks + 1.0;
    EXPECT_NEAR(run[box].velocity(t)[0], 1.5 * (t * t - breaks * breaks) / 2.0 - 0.25 * 9.8125, 1e-8);
    EXPECT_EQ(run[box].velocity(breaks * 0.99).norm(), 0.0);
}

TEST(RoughContacts, a_table_on_four_rough_legs_stands_and_breaks_away) {
    Scene scene(down);
    const auto table = scene.add(shapes::box(3.0, {2, 1, 0.5}), BodyStart{.position = {0, 0, 0.25}});
    std::vector<ContactHandle> legs;
    for (const double x : {-1.0, 1.0})
        for (const double y : {-0.5, 0.5})
            legs.push_back(scene.contact(table.point({x, y, -0.25}), Plane{{0, 0, 1}}, rough(0.5)));
    const Trajectory run = simulate(scene, {.until = 1e5});
    EXPECT_TRUE(run.events().empty());
    Vector3 sum = Vector3::Zero();
    for (const auto leg : legs) {
        const Vector3 f = run[leg].force(1.0);
        sum += f;
        EXPECT_LE(std::hypot(f[0], f[1]), 0.5 * f[2] + 1e-12);
        EXPECT_EQ(run[leg].state(1.0), "sticks");
    }
    EXPECT_LT((sum - Vector3(0, 0, 3 * gravity)).norm(), 1e-11);
    EXPECT_EQ((run[table].position(1e5) - Vector3(0, 0, 0.25)).norm(), 0.0);
}

TEST(RoughContacts, a_ball_lands_and_rolls) {
    // dropped with spin: one impact, whose tangential impulse is mu P or what stops the slip, whichever is less
    for (const double spin : {5.0, 200.0}) {
        Scene scene(down);
        const double r = 0.25, m = 2.0, mu = 0.25, e = 0.5;
        const auto ball = scene.add(shapes::sphere(m, r),
                                    BodyStart{.position = {0, 0, r + 1.0}, .angular_velocity = Vector3(0, spin, 0)});
        const auto hit = scene.contact(ball.sphere(r), Plane{{0, 0, 1}}, {.friction = Coulomb{mu}, .restitution = e});
        const double t = std::sqrt(2.0 / gravity), v = gravity * t, normal = m * (1 + e) * v;
        const Trajectory run = simulate(scene, {.until = 1.5 * t, .error = 1e-11});
        ASSERT_EQ(run.events().size(), 1u);
        EXPECT_EQ(run.events()[0].kind, EventKind::impact);
        EXPECT_NEAR(run.events()[0].push[2], normal, 1e-10);
        // slip -spin r; m_eff = 2/7 m
        const double along = std::min(mu * normal, 2.0 / 7.0 * m * spin * r);
        EXPECT_NEAR(run.events()[0].push[0], along, 1e-10) << spin;
        EXPECT_NEAR(run[ball].velocity(1.2 * t)[0], along / m, 1e-10);
        EXPECT_NEAR(run[ball].angular_velocity_world(1.2 * t)[1], spin - along * r / (0.4 * m * r * r), 1e-9);
        EXPECT_EQ(run[hit].state(1.2 * t), "open");
    }
}

TEST(RoughContacts, an_impact_never_gains_energy) {
    // a rod that would, by Newton's law with Coulomb's: e is lowered to where it gains none
    const double angle = 0.84, l = 1.0;
    const Vector3 arm = l / 2 * Vector3(std::cos(angle), std::sin(angle), 0);
    int lowered = 0;
    for (const double slip : {-0.55, 0.55}) {
        Scene scene;
        const auto rod = scene.add(shapes::rod(1.0, l, {1, 0, 0}), Planar{},
                                   {.position = {arm[0], arm[1] + 0.5}, .velocity = {slip, -1.0}, .angle = angle});
        const auto hit =
            scene.contact(rod.point({-l / 2, 0, 0}), Plane{{0, 1, 0}}, {.friction = Coulomb{0.5}, .restitution = 0.9});
        const Trajectory run = simulate(scene, {.until = 0.6, .error = 1e-11});
        ASSERT_EQ(run.events().times("impact", hit).size(), 1u);
        const double gain = run.kinetic_energy(0.55) - run.kinetic_energy(0.45);
        if (run.events()[0].note.find("restitution lowered") != std::string::npos) {
            ++lowered;
            EXPECT_NEAR(gain, 0.0, 1e-14);
        } else {
            EXPECT_LT(gain, 0.0);
        }
    }
    EXPECT_EQ(lowered, 1);
}

TEST(RoughContacts, what_is_held_by_more_than_it_needs_slides_when_it_is_struck_however_slowly) {
    // a box on two corners that share its load, struck by a ball of half its mass that gives all of its energy to both
    const double mu = 0.1, g = 9.8125;
    for (const double speed : {1.0, 3.0, 0.01}) {
        Scene scene({0, -g, 0});
        const auto box = scene.add(shapes::box(2.0, {1, .5, .5}), Planar{}, {.position = {0, .25}});
        for (const double x : {-.5, .5}) scene.contact(box.point({x, -.25, 0}), Plane{{0, 1, 0}}, rough(mu));
        const auto ball =
            scene.add(Particle{1.0}, FreeStart{.position = {-.5 - speed, .25, 0}, .velocity = {speed, 0, 0}});
        scene.apply(Force(Vector3(0, g, 0)), ball);
        scene.contact(ball, box.plane({{-1, 0, 0}, {-.5, 0, 0}}), {.restitution = 1.0});
        const double goes = 2.0 / 3.0 * speed, stops = goes / (mu * g);
        const Trajectory run = simulate(scene, {.until = 1.0 + 2.0 * stops, .error = 1e-11});
        EXPECT_NEAR(run[ball].velocity(run.end())[0], -speed / 3.0, 1e-10) << speed;
        EXPECT_NEAR(run[box].velocity(1.0 + 0.5 * stops)[0], 0.5 * goes, 1e-10 * speed) << speed;
        EXPECT_NEAR(run[box].position(1.0 + 2.0 * stops)[0], 0.5 * goes * stops, 1e-10) << speed;
        for (const double t : run.events().times("stick")) EXPECT_NEAR(t, 1.0 + stops, 1e-10) << speed;
        EXPECT_EQ(run.events().times("stick").size(), 2u) << speed;
    }
}

}  // namespace rough_contacts
}  // namespace rbdyn::test
