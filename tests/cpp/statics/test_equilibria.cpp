// States of rest against closed forms, and against a search by hand.
#include "rbdyn/statics/equilibria.hpp"
#include "rbdyn/statics/path_forces.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "support.hpp"

namespace rbdyn::test::test_equilibria {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
using Vector = Vector3Of<Expression>;

/// A bead on a rail under gravity.
Scene bead_on(const Curve& curve, std::optional<Coulomb> friction = std::nullopt, RailOptions options = {},
              double start = 0.0) {
    Scene scene(down);
    scene.add(Particle{.mass = 0.7}, Rail(curve, friction, options), {.parameter = start});
    return scene;
}
/// A bead on a horizontal line without gravity, under a force along it that depends on its place.
template <class F>
Scene bead_under(F&& f, double start = 0.0) {
    Scene scene;
    const auto bead = scene.add(Particle{.mass = 2.0}, Rail(along_x), {.parameter = start});
    scene.apply(Force([=](const auto&, const auto& r, const auto&) { return Vector(f(r[0]), 0.0, 0.0); }), bead);
    return scene;
}
std::vector<double> places(const std::vector<Equilibrium>& all) {
    std::vector<double> u;
    for (const Equilibrium& e : all) u.push_back(e.coordinates[0]);
    return u;
}
std::string refusal(const Scene& scene, const std::vector<double>& near = {}) {
    try {
        equilibria(scene, near);
    } catch (const InvalidInput& e) {
        return e.what();
    }
    return {};
}
bool has(const std::string& text, const char* words) { return text.find(words) != std::string::npos; }

TEST(Equilibria, a_pendulum_rests_below_stably_and_above_not) {
    const auto all = equilibria(bead_on(vertical_circle(0.5)));
    ASSERT_EQ(places(all), (std::vector<double>{0.0, pi}));
    EXPECT_TRUE(all[0].stable);
    EXPECT_FALSE(all[1].stable);
    EXPECT_FALSE(all[0].interval);
    ASSERT_EQ(all[0].periods.size(), 1u);
    EXPECT_LE(std::abs(all[0].periods[0] / (2.0 * pi * std::sqrt(0.5 / gravity)) - 1.0), 4e-16);
    EXPECT_TRUE(all[1].periods.empty());
}

TEST(Equilibria, on_a_rough_hoop_they_fill_the_angle_of_friction_below_and_above) {
    for (const double mu : {1e-6, 0.1, 0.4, 1.0, 7.5}) {
        const auto all = equilibria(bead_on(vertical_circle(0.5), Coulomb{.mu_static = mu, .mu_dynamic = 0.0}));
        ASSERT_EQ(places(all), (std::vector<double>{0.0, pi})) << mu;
        for (const Equilibrium& e : all) {
            EXPECT_TRUE(e.stable) << "held";
            ASSERT_TRUE(e.interval);
            EXPECT_NEAR(e.interval->first, e.coordinates[0] - std::atan(mu), 1e-15) << mu;
            EXPECT_NEAR(e.interval->second, e.coordinates[0] + std::atan(mu), 1e-15) << mu;
        }
    }
}

TEST(Equilibria, an_incline_holds_all_along_or_nowhere_with_the_edge_at_the_tangent_of_its_slope) {
    for (const double slope : {0.125, 0.3, 1.0, 3.7}) {
        EXPECT_TRUE(equilibria(bead_on(incline(slope))).empty()) << "smooth";
        EXPECT_TRUE(equilibria(bead_on(incline(slope), Coulomb{.mu_static = slope * (1.0 - 1e-13)})).empty()) << slope;
        for (const double mu : {slope, slope * (1.0 + 1e-13), 10.0}) {
            const auto all = equilibria(bead_on(incline(slope), Coulomb{.mu_static = mu}, {}, 2.5));
            ASSERT_EQ(all.size(), 1u) << slope << " " << mu;
            EXPECT_EQ(all[0], (Equilibrium{{2.5}, true, std::pair(-infinity, infinity)}));
        }
    }
}

TEST(Equilibria, what_they_say_of_friction_is_what_a_run_does) {
    for (const double mu : {0.2, 0.6}) {
        const auto all = equilibria(bead_on(vertical_circle(0.5), Coulomb{.mu_static = mu, .mu_dynamic = 0.5 * mu}));
        for (const Equilibrium& e : all)
            for (const auto& [u, way] : {std::pair(e.interval->first, -1.0), std::pair(e.interval->second, 1.0)})
                for (const double off : {-1e-9, 1e-9}) {
                    const Scene scene = bead_on(vertical_circle(0.5), Coulomb{.mu_static = mu, .mu_dynamic = 0.5 * mu},
                                                {}, u + way * off);
                    const Trajectory run = simulate(scene, {.until = 1.0, .rtol = 1e-9});
                    EXPECT_EQ(run[BodyHandle{0}].speed(1e-3) == 0.0, off < 0.0) << u << " " << off;
                }
    }
}

TEST(Equilibria, without_a_force_along_it_a_whole_rail_is_one_indifferent_equilibrium) {
    for (const Line& line : {along_x, Line{.direction = {1.0, 1.0, 0.0}, .point = {0.1, 0.2, 0.3}}}) {
        const auto all = equilibria(bead_on(line, std::nullopt, {}, 3.0));
        ASSERT_EQ(all.size(), 1u);
        EXPECT_EQ(all[0], (Equilibrium{{3.0}, false, std::pair(-infinity, infinity)}));
    }
    Scene nothing;
    nothing.add(Particle{.mass = 1.0}, Rail(vertical_circle(1.0)));
    const auto all = equilibria(nothing);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].interval, std::pair(0.0, 2.0 * pi));
    EXPECT_FALSE(all[0].stable);
    // a spring from the centre of a hoop pulls across it only, wherever the hoop lies
    Scene centred;
    const auto bead =
        centred.add(Particle{.mass = 1.0},
                    Rail(Circle{.radius = 0.3, .start = {1, 2, 3}, .toward = {0, 1, 0}, .center = {0.1, 0.7, 0.2}}));
    centred.connect(Spring{.stiffness = 30.0, .rest_length = 0.1}, bead, Vector3(0.1, 0.7, 0.2));
    ASSERT_EQ(equilibria(centred).size(), 1u);
    EXPECT_EQ(equilibria(centred)[0].interval, std::pair(0.0, 2.0 * pi));
}

TEST(Equilibria, a_bead_on_a_hoop_with_a_spring_from_its_top) {
    const double radius = 0.5, mass = 0.5, stiffness = 40.0, rest = 0.3;
    Scene scene(down);
    const auto bead = scene.add(Particle{.mass = mass}, Rail(vertical_circle(radius)));
    scene.connect(Spring{.stiffness = stiffness, .rest_length = rest}, bead, Vector3(0.0, 0.0, radius));
    // the length is 2 R cos(u/2): balance where cos(u/2) = k l0 / (2 (k R - m g))
    const double c = stiffness * rest / (2.0 * (stiffness * radius - mass * gravity)), u = 2.0 * std::acos(c);
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 4u);
    EXPECT_EQ(all[0].coordinates[0], 0.0);
    EXPECT_FALSE(all[0].stable);
    EXPECT_NEAR(all[1].coordinates[0], u, 1e-15);
    EXPECT_NEAR(all[3].coordinates[0], 2.0 * pi - u, 2e-15);
    // at its anchor the spring pushes away on both sides
    EXPECT_NEAR(all[2].coordinates[0], pi, 1e-12);
    EXPECT_FALSE(all[2].stable);
    // -dQ/du = (k R - m g) R 2 sin^2(u/2) / 2 there, from Q = 2 R sin(u/2) ((k R - m g) cos(u/2) - k l0/2)
    const double omega2 = (stiffness * radius - mass * gravity) * std::pow(std::sin(0.5 * u), 2) / (mass * radius);
    for (const std::size_t k : {1u, 3u}) {
        EXPECT_TRUE(all[k].stable);
        EXPECT_LE(std::abs(all[k].periods.at(0) * std::sqrt(omega2) / (2.0 * pi) - 1.0), 2e-15);
    }
}

TEST(Equilibria, in_a_chain_of_wells_every_bottom_is_stable_and_every_top_between_is_not) {
    // z' = (u + 3)(u + 1.25)(u - 0.5)(u - 0.50001)(u - 2)
    const std::vector<double> roots{-3.0, -1.25, 0.5, 0.50001, 2.0};
    std::vector<double> slope{1.0};
    for (const double root : roots) {
        slope.insert(slope.begin(), 0.0);
        for (std::size_t k = 0; k + 1 < slope.size(); ++k) slope[k] -= root * slope[k + 1];
    }
    Polynomial wells{.coefficients = {{0, 0, 0}, {1, 0, slope[0]}}};
    for (std::size_t k = 1; k < slope.size(); ++k)
        wells.coefficients.push_back({0.0, 0.0, slope[k] / (static_cast<double>(k) + 1.0)});
    for (const double start : {0.0, 2.0, -1000.0}) {
        const auto all = equilibria(bead_on(wells, std::nullopt, {}, start));
        ASSERT_EQ(all.size(), 5u) << start;
        for (std::size_t k = 0; k < 5; ++k) {
            // the coefficients are rounded: a root moves by that over its slope
            double steep = 1.0;
            for (std::size_t j = 0; j < 5; ++j)
                if (j != k) steep *= std::abs(roots[k] - roots[j]);
            EXPECT_NEAR(all[k].coordinates[0], roots[k], 1e-14 / steep + 1e-15) << k;
            EXPECT_EQ(all[k].stable, k % 2 == 0) << k;
        }
    }
}

TEST(Equilibria, higher_zeros_of_the_force_count_once_and_are_stable_by_their_first_derivative) {
    const auto power = [](double sign, int n) {
        return [=](const auto& x) { return sign * pow(x - 0.375, static_cast<double>(n)); };
    };
    for (const double start : {0.0, 3.3, -40.0}) {
        for (const int n : {2, 3, 4}) {
            const auto pulled = equilibria(bead_under(power(-1.0, n), start));
            ASSERT_EQ(pulled.size(), 1u) << n << " from " << start;
            EXPECT_NEAR(pulled[0].coordinates[0], 0.375, 1e-9);
            EXPECT_EQ(pulled[0].stable, n % 2 == 1) << "an inflection of U is none";
            EXPECT_TRUE(pulled[0].periods.empty());
            const auto pushed = equilibria(bead_under(power(1.0, n), start));
            ASSERT_EQ(pushed.size(), 1u);
            EXPECT_FALSE(pushed[0].stable);
        }
    }
    // the pitchfork of a bead on a hoop that turns about its vertical diameter, at its critical rate
    Scene scene(down);
    const double radius = 0.5, rate2 = gravity / radius;
    const auto bead = scene.add(Particle{.mass = 0.7}, Rail(vertical_circle(radius)));
    scene.apply(Potential([=](const auto& r) { return 0.5 * 0.7 * rate2 * r[0] * r[0]; }), bead);
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_NEAR(all[0].coordinates[0], 0.0, 1e-9);
    EXPECT_TRUE(all[0].stable) << "in fourth order";
    EXPECT_FALSE(all[1].stable);
}

TEST(Equilibria, zeros_of_every_order_are_found_where_they_are_and_judged_by_their_first_derivative) {
    // U = sign (x - a)^n at places and scales without any pattern: a maximum, a minimum, or an inflection
    Random random(5);
    for (int n = 2; n <= 11; ++n)
        for (int trial = 0; trial < 12; ++trial) {
            const double sign = random.uniform(-1.0, 1.0) > 0.0 ? 1.0 : -1.0, a = random.uniform(-2.0, 2.0);
            const double scale = std::exp2(random.uniform(-20.0, 20.0)), start = a + random.uniform(-3.0, 3.0);
            const auto all = equilibria(bead_under(
                [=](const auto& x) { return sign * scale * n * pow(x - a, static_cast<double>(n - 1)); }, start));
            ASSERT_EQ(all.size(), 1u) << n << " at " << a << " from " << start;
            EXPECT_NEAR(all[0].coordinates[0], a, 1e-14) << n;
            EXPECT_EQ(all[0].stable, n % 2 == 0 && sign < 0.0) << n << " at " << a << " from " << start;
            EXPECT_TRUE(all[0].decided);
        }
}

TEST(Equilibria, a_double_zero_between_triple_ones_is_found_wherever_the_search_begins) {
    constexpr double a = -0x1.7f4cacb36068ep+0, b = -0x1.04811f274f890p+0, c = 0x1.018df8ebd3d30p-3,
                     scale = -0x1.2237849c0ba5dp+2;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (int i = 0; i < 100; ++i) {
        const double start = i == 0 ? 0x1.3c576a79a234cp+1 : 6.0 * part(random) - 3.0;
        Scene scene;
        const BodyHandle bead = scene.add(Particle{2.0}, Rail(along_x), {.parameter = start});
        scene.apply(Force([=](const auto&, const auto& r, const auto&) {
                        using S = std::decay_t<decltype(r[0])>;
                        const S p = r[0] - a, q = r[0] - b, s = r[0] - c;
                        return Vector3Of<S>{scale * (p * (p * p)) * (q * q) * (s * (s * s)), S(0.0), S(0.0)};
                    }),
                    bead);
        const auto all = equilibria(scene);
        ASSERT_EQ(all.size(), 3u) << start;
        EXPECT_NEAR(all[1].coordinates[0], b, 1e-9) << start;
        EXPECT_FALSE(all[1].stable) << start;
    }
}

TEST(Equilibria, flat_minima_up_to_the_power_20_are_where_they_are_and_stable) {
    // z = sign (u - a)^n: beside gravity the force along the rail is rounding from a - 0.15 to a + 0.15
    for (const int n : {4, 8, 12, 16, 17, 18, 19, 20, 21})
        for (const double a : {0.0, 0.1, -0.3137})
            for (const double sign : {1.0, -1.0})
                for (const bool is_product : {false, true}) {
                    const Curve curve(
                        [=](const auto& u) {
                            using S = std::decay_t<decltype(u)>;
                            const S x = u - S(a);
                            S power = sign * (is_product ? S(1.0) : pow(x, static_cast<double>(n)));
                            for (int k = 0; is_product && k < n; ++k) power = power * x;
                            return Vector3Of<S>{u, S(0.0), power};
                        },
                        Domain{-1.0, 1.1});
                    const auto all = equilibria(bead_on(curve));
                    ASSERT_EQ(all.size(), 1u) << n << " at " << a;
                    EXPECT_NEAR(all[0].coordinates[0], a, 1e-15) << n;
                    EXPECT_TRUE(all[0].decided) << n << " at " << a;
                    EXPECT_EQ(all[0].stable, n % 2 == 0 && sign > 0.0) << n << " at " << a;
                    EXPECT_FALSE(all[0].interval.has_value());
                }
    for (const int n : {16, 18, 20}) {
        Polynomial valley;
        valley.domain = {-1.0, 1.1};
        for (int k = 0; k <= n; ++k) valley.coefficients.push_back({k == 1 ? 1.0 : 0.0, 0.0, k == n ? 1.0 : 0.0});
        for (const double start : {0.5, 0.0, 1.0}) {
            Scene scene;
            const auto bead = scene.add(Particle{.mass = 2.0}, Rail(along_x), {.parameter = start});
            scene.apply(Potential([=](const auto& r) { return -pow(r[0], static_cast<double>(n)); }), bead);
            for (const Scene& s : {bead_on(valley, std::nullopt, {}, start), scene}) {
                // open: a potential of a higher power on a rail without ends is not found
                if (n > 16 && s == scene) continue;
                const auto all = equilibria(s);
                ASSERT_EQ(all.size(), 1u) << n << " from " << start;
                EXPECT_NEAR(all[0].coordinates[0], 0.0, 1e-15) << n;
                EXPECT_TRUE(all[0].stable && all[0].decided) << n;
            }
        }
    }
}

TEST(Equilibria, what_rounding_hides_is_one_place_in_the_middle_and_not_decided) {
    for (const int n : {26, 30, 40})
        for (const double a : {0.0, 0.1, -0.3137}) {
            const Curve curve(
                [=](const auto& u) {
                    using S = std::decay_t<decltype(u)>;
                    return Vector3Of<S>{u, S(0.0), pow(u - S(a), static_cast<double>(n))};
                },
                Domain{-1.0, 1.1});
            const auto all = equilibria(bead_on(curve));
            ASSERT_EQ(all.size(), 1u) << n << " at " << a;
            // about zero numbers are as small as they need to be for signs to tell
            if (a == 0.0 && all[0].decided) {
                EXPECT_TRUE(all[0].stable && std::abs(all[0].coordinates[0]) <= 1e-15) << n;
                continue;
            }
            EXPECT_FALSE(all[0].decided || all[0].stable) << n << " at " << a;
            ASSERT_TRUE(all[0].interval.has_value());
            EXPECT_TRUE(all[0].interval->first < a && a < all[0].interval->second) << n << " at " << a;
            // places are looked at by the thirty-second part of a piece
            EXPECT_TRUE(a == 0.0 || std::abs(all[0].coordinates[0] - a) <= 0.01) << n;
        }
    // level all along is known to be level; so is what is level to where its formula ends
    const auto level = equilibria(bead_on(along_x));
    ASSERT_EQ(level.size(), 1u);
    EXPECT_TRUE(level[0].decided && level[0].interval);
    const auto plain = equilibria(bead_under([](const auto& x) { return where(x > 1.0, 1.0 - x, x * 0.0); }));
    ASSERT_EQ(plain.size(), 1u);
    EXPECT_TRUE(plain[0].decided && plain[0].interval);
}

TEST(Equilibria, a_small_lower_order_rules_over_a_large_higher_one) {
    // F = e (x - a) - (x - a)^3, e down to where the zeros beside it are rounding of what F is a unit away
    for (const double e : {1e-3, 1e-7, 1e-9})
        for (const double sign : {-1.0, 1.0})
            for (const double a : {0.0, 0.375}) {
                const auto all = equilibria(
                    bead_under([=](const auto& x) { return sign * e * (x - a) - pow(x - a, 3.0); }, a + 1.0));
                ASSERT_EQ(all.size(), sign > 0.0 ? 3u : 1u) << e << " at " << a;
                EXPECT_EQ(all[all.size() / 2].stable, sign < 0.0) << e << " at " << a;
                if (sign > 0.0) {
                    EXPECT_NEAR((all[2].coordinates[0] - a) / std::sqrt(e), 1.0, 1e-4);
                    EXPECT_TRUE(all[0].stable && all[2].stable);
                }
            }
}

TEST(Equilibria, above_its_critical_rate_a_hoop_that_turns_has_two_more) {
    Scene scene(down);
    const double radius = 0.5, rate2 = 1.5 * gravity / radius;
    const auto bead = scene.add(Particle{.mass = 0.7}, Rail(vertical_circle(radius)));
    scene.apply(Potential([=](const auto& r) { return 0.5 * 0.7 * rate2 * r[0] * r[0]; }), bead);
    const auto all = equilibria(scene);
    const double u = std::acos(1.0 / 1.5);
    ASSERT_EQ(all.size(), 4u);
    const double expected[] = {0.0, u, pi, 2.0 * pi - u};
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(all[k].coordinates[0], expected[k], 2e-15);
        EXPECT_EQ(all[k].stable, k % 2 == 1);
    }
    EXPECT_NEAR(all[1].periods.at(0), 2.0 * pi / std::sqrt(rate2) / std::sin(u), 1e-14);
}

TEST(Equilibria, a_field_that_drives_round_leaves_rest_where_gravity_holds_against_it) {
    const double radius = 0.5, mass = 0.7, drive = 4.0;
    Scene scene(down);
    const auto bead = scene.add(Particle{.mass = mass}, Rail(vertical_circle(radius)));
    scene.apply(
        Force([=](const auto&, const auto& r, const auto&) { return Vector(-drive * r[2], 0.0, drive * r[0]); }), bead);
    // F_t = drive R all round, against m g sin u
    const double u = std::asin(drive * radius / (mass * gravity));
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_NEAR(all[0].coordinates[0], u, 1e-15);
    EXPECT_TRUE(all[0].stable);
    EXPECT_NEAR(all[1].coordinates[0], pi - u, 1e-15);
    EXPECT_FALSE(all[1].stable);
}

TEST(Equilibria, where_the_force_has_a_corner_or_a_jump) {
    const auto corner = equilibria(bead_under([](const auto& x) { return -x - 0.5 * abs(x); }, 3.3));
    ASSERT_EQ(corner.size(), 1u);
    EXPECT_NEAR(corner[0].coordinates[0], 0.0, 1e-15);
    EXPECT_TRUE(corner[0].stable);
    const auto jump = equilibria(bead_under([](const auto& x) { return -locked_sign(x - 1.25); }, 3.3));
    ASSERT_EQ(jump.size(), 1u);
    EXPECT_NEAR(jump[0].coordinates[0], 1.25, 1e-15);
    EXPECT_TRUE(jump[0].stable);
    // a well that is flat between -1 and 1
    const auto flat = equilibria(bead_under(
        [](const auto& x) { return where(x > 1.0, 1.0 - x, where(x < -1.0, -1.0 - x, Expression(0.0))); }, 3.3));
    ASSERT_EQ(flat.size(), 1u);
    EXPECT_NEAR(flat[0].interval->first, -1.0, 1e-15);
    EXPECT_NEAR(flat[0].interval->second, 1.0, 1e-15);
    EXPECT_FALSE(flat[0].stable) << "indifferent";
}

TEST(Equilibria, a_bead_pressed_against_an_end_is_in_none) {
    const Polynomial slope{.coefficients = {{0, 0, 0}, {1, 0, 0.5}}, .domain = {-1.0, 1.0}};
    EXPECT_TRUE(equilibria(bead_on(slope)).empty());
    // a force that vanishes at the very end
    const Polynomial level{.coefficients = {{0, 0, 0}, {1, 0, -0.2}, {0, 0, 0.1}}, .domain = {-1.0, 1.0}};
    const auto all = equilibria(bead_on(level));
    ASSERT_EQ(places(all), std::vector<double>{1.0});
    EXPECT_TRUE(all[0].stable);
}

TEST(Equilibria, a_rail_that_only_pushes_holds_what_is_pressed_on_it) {
    // plus: along the normal, towards the centre
    EXPECT_EQ(places(equilibria(bead_on(vertical_circle(0.5), std::nullopt, {.side = RailSide::plus}))),
              std::vector<double>{0.0});
    EXPECT_EQ(places(equilibria(bead_on(vertical_circle(0.5), std::nullopt, {.side = RailSide::minus}))),
              std::vector<double>{pi});
    const auto rough = equilibria(bead_on(vertical_circle(0.5), Coulomb{.mu_static = 0.5}, {.side = RailSide::minus}));
    ASSERT_EQ(rough.size(), 1u);
    EXPECT_NEAR(rough[0].interval->first, pi - std::atan(0.5), 1e-15);
}

TEST(Equilibria, on_a_rail_without_ends_they_are_sought_about_a_place) {
    const Helix helix{.radius = 1.0, .pitch = 0.5, .start = {1, 0, 0}, .toward = {0, 1, 0}};
    Scene scene(down);
    const auto bead = scene.add(Particle{.mass = 0.7}, Rail(helix));
    scene.connect(Spring{.stiffness = 3.0}, bead, Vector3(2.0, 0.0, 0.1));
    // Q = -k (2 R sin u + h (h u - 0.1)) - m g h, h = pitch / 2 pi
    const double h = 0.5 / (2.0 * pi);
    const auto q = [&](double u) { return 3.0 * (2.0 * std::sin(u) + h * (h * u - 0.1)) + 0.7 * gravity * h; };
    for (const double near : {0.0, 60.0}) {
        const auto all = equilibria(scene, {near});
        ASSERT_GE(all.size(), 8u);
        double before = all[0].coordinates[0] - 1e-3;
        for (const Equilibrium& e : all) {
            const double u = e.coordinates[0];
            EXPECT_LE(std::abs(q(u)), 1e-14 * (1.0 + std::abs(u)));
            // none is left out on the way
            int changes = 0;
            for (double x = before + 1e-3; x < u - 1e-3; x += 1e-3) changes += (q(x) > 0.0) != (q(x + 1e-3) > 0.0);
            EXPECT_EQ(changes, 0);
            before = u;
        }
        EXPECT_LT(all.front().coordinates[0], near);
        EXPECT_GT(all.back().coordinates[0], near);
    }
    // a helix under gravity alone is as steep everywhere
    const auto held = equilibria(bead_on(helix, Coulomb{.mu_static = h + 1e-9}));
    ASSERT_EQ(held.size(), 1u);
    EXPECT_EQ(held[0].interval, std::pair(-infinity, infinity));
    EXPECT_TRUE(equilibria(bead_on(helix, Coulomb{.mu_static = h - 1e-9})).empty());
}

TEST(Equilibria, every_arch_of_a_cycloid_has_its_bottom_and_cusps_are_none) {
    const auto all = equilibria(bead_on(Cycloid{.radius = 0.3, .x = {1, 0, 0}, .y = {0, 0, 1}}));
    ASSERT_GE(all.size(), 5u);
    for (const Equilibrium& e : all) {
        EXPECT_TRUE(e.stable);
        EXPECT_NEAR(std::remainder(e.coordinates[0], 2.0 * pi), 0.0, epsilon * std::abs(e.coordinates[0]));
        EXPECT_LE(std::abs(e.periods.at(0) / (4.0 * pi * std::sqrt(0.3 / gravity)) - 1.0), 1e-14);
    }
}

TEST(Equilibria, a_closed_spline_is_searched_all_round_once) {
    const Spline loop{.points = {{1, 0, 0}, {0.2, 0, 1}, {-1, 0, 0.3}, {-0.5, 0, -0.8}, {0.1, 0, -0.2}, {0.6, 0, -0.9}},
                      .closed = true};
    const auto all = equilibria(bead_on(loop));
    // two hollows and two crests
    ASSERT_EQ(all.size(), 4u);
    const Curve curve = loop;
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_GE(all[k].coordinates[0], 0.0);
        EXPECT_LT(all[k].coordinates[0], 6.0);
        EXPECT_NE(all[k].stable, all[(k + 1) % 4].stable);
        EXPECT_NEAR(curve.first(all[k].coordinates[0])[2], 0.0, 1e-14);
    }
}

TEST(Equilibria, none_is_missed_on_random_hoops) {
    Random random(7);
    int found = 0;
    for (int trial = 0; trial < 60; ++trial) {
        Scene scene(down);
        const double radius = random.logarithmic(0.1, 3.0);
        const auto bead = scene.add(Particle{.mass = 0.5}, Rail(vertical_circle(radius)));
        for (int k = 0; k < 3; ++k)
            scene.connect(Spring{.stiffness = random.logarithmic(1.0, 300.0), .rest_length = random.uniform(0.0, 2.0)},
                          bead, random.direction() * random.uniform(0.1, 2.0) * radius);
        const double wave = random.uniform(1.0, 12.0) / radius;
        scene.apply(Force([=](const auto&, const auto& r, const auto&) {
                        return Vector(3.0 * sin(wave * r[2]), 0.0, 2.0 * cos(wave * r[0]));
                    }),
                    bead);
        const PathForces forces(scene);
        int changes = 0;
        constexpr int n = 40000;
        for (int k = 0; k < n; ++k)
            changes += (forces.along_path(2.0 * pi * k / n) > 0.0) != (forces.along_path(2.0 * pi * (k + 1) / n) > 0.0);
        const auto all = equilibria(scene);
        EXPECT_EQ(static_cast<int>(all.size()), changes) << trial;
        int stable = 0;
        for (const Equilibrium& e : all) {
            EXPECT_LE(std::abs(forces.along_path(e.coordinates[0])), 64.0 * epsilon * forces.effort(e.coordinates[0]));
            stable += e.stable;
        }
        EXPECT_EQ(2 * stable, static_cast<int>(all.size())) << "maxima and minima of U alternate";
        found += changes;
    }
    EXPECT_GT(found, 120);
}

// --- more freedoms ---

TEST(Equilibria, beads_on_a_line_with_springs_rest_where_the_linear_equations_say) {
    Scene scene;
    const auto a = scene.add(Particle{.mass = 2.0}, Rail(along_x), {.parameter = 0.2});
    const auto b = scene.add(Particle{.mass = 3.0}, Rail(along_x), {.parameter = 1.0});
    scene.connect(Spring{.stiffness = 5.0}, a, Vector3(0, 0, 0));
    scene.connect(Spring{.stiffness = 7.0, .rest_length = 1.0, .damping = 0.3}, b, Vector3(3, 0, 0));
    scene.connect(Spring{.stiffness = 2.0, .rest_length = 0.5}, a, b);
    scene.apply(Drag{.linear = 0.1, .quadratic = 0.2}, a);
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 1u);
    // (5 + 2) x1 - 2 x2 = -1, -2 x1 + (7 + 2) x2 = 15
    EXPECT_NEAR(all[0].coordinates[0], 21.0 / 59.0, 1e-15);
    EXPECT_NEAR(all[0].coordinates[1], 103.0 / 59.0, 1e-15);
    EXPECT_TRUE(all[0].stable);
    // (7 - 2 w)(9 - 3 w) = 4
    const double root = std::sqrt(39.0 * 39.0 - 4.0 * 6.0 * 59.0);
    ASSERT_EQ(all[0].periods.size(), 2u);
    EXPECT_NEAR(all[0].periods[0], 2.0 * pi / std::sqrt((39.0 - root) / 12.0), 1e-14);
    EXPECT_NEAR(all[0].periods[1], 2.0 * pi / std::sqrt((39.0 + root) / 12.0), 1e-14);
}

TEST(Equilibria, a_particle_on_a_spring_hangs_below_and_balances_above) {
    Scene scene(down);
    const double mass = 2.0, stiffness = 50.0, rest = 1.0, sag = mass * gravity / stiffness;
    const auto a = scene.add(Particle{.mass = mass}, FreeStart{.position = {0.3, 0.1, -1.0}});
    scene.connect(Spring{.stiffness = stiffness, .rest_length = rest}, a, Vector3(0, 0, 0));
    const auto below = equilibria(scene);
    ASSERT_EQ(below.size(), 1u);
    EXPECT_NEAR(below[0].coordinates[0], 0.0, 1e-15);
    EXPECT_NEAR(below[0].coordinates[2], -rest - sag, 4e-16);
    EXPECT_TRUE(below[0].stable);
    ASSERT_EQ(below[0].periods.size(), 3u);
    EXPECT_NEAR(below[0].periods[0], 2.0 * pi * std::sqrt((rest + sag) / gravity), 1e-14);
    EXPECT_NEAR(below[0].periods[2], 2.0 * pi * std::sqrt(mass / stiffness), 1e-14);
    const auto above = equilibria(scene, {0.01, 0.02, 0.7});
    ASSERT_EQ(above.size(), 1u);
    EXPECT_NEAR(above[0].coordinates[2], rest - sag, 4e-16);
    EXPECT_FALSE(above[0].stable);
}

TEST(Equilibria, three_beads_on_a_rough_and_a_curved_rail_and_one_free_balance) {
    Scene scene(down);
    const auto a = scene.add(Particle{.mass = 0.4}, Rail(vertical_circle(1.0)), {.parameter = 0.2});
    const auto b =
        scene.add(Particle{.mass = 0.3}, Rail(Polynomial{.coefficients = {{1, 0, -1}, {1, 0.2, 0}, {0, 0, 0.6}}}),
                  {.parameter = 0.4});
    const auto c = scene.add(Particle{.mass = 0.5}, FreeStart{.position = {0.5, 0.0, -2.0}});
    scene.connect(Spring{.stiffness = 20.0, .rest_length = 0.3}, a, b);
    scene.connect(Spring{.stiffness = 30.0, .rest_length = 0.5}, b, c);
    scene.connect(Spring{.stiffness = 10.0, .rest_length = 0.2}, c, a);
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].coordinates.size(), 5u);
    EXPECT_TRUE(all[0].stable);
    EXPECT_EQ(all[0].periods.size(), 5u);
    // started there it stays there
    const std::vector<double>& q = all[0].coordinates;
    EXPECT_EQ(equilibria(scene, q)[0].coordinates.size(), 5u);
    Scene there(down);
    const auto a2 = there.add(Particle{.mass = 0.4}, Rail(vertical_circle(1.0)), {.parameter = q[0]});
    const auto b2 =
        there.add(Particle{.mass = 0.3}, Rail(Polynomial{.coefficients = {{1, 0, -1}, {1, 0.2, 0}, {0, 0, 0.6}}}),
                  {.parameter = q[1]});
    const auto c2 = there.add(Particle{.mass = 0.5}, FreeStart{.position = {q[2], q[3], q[4]}});
    there.connect(Spring{.stiffness = 20.0, .rest_length = 0.3}, a2, b2);
    there.connect(Spring{.stiffness = 30.0, .rest_length = 0.5}, b2, c2);
    there.connect(Spring{.stiffness = 10.0, .rest_length = 0.2}, c2, a2);
    const Trajectory run = simulate(there, {.until = 5.0, .rtol = 1e-13});
    EXPECT_NEAR(run[c2].position(5.0)[2], q[4], 1e-13);
}

TEST(Equilibria, a_field_without_potential_is_judged_by_its_symmetric_part) {
    Scene scene;
    const auto a = scene.add(Particle{.mass = 2.0}, FreeStart{.position = {0.3, 0.1, -1.0}});
    scene.apply(Force([](const auto&, const auto& r, const auto&) {
                    return Vector(1.0 - 3.0 * r[0] - 5.0 * r[1], 5.0 * r[0] - 3.0 * r[1], -2.0 * r[2]);
                }),
                a);
    const auto all = equilibria(scene);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_NEAR(all[0].coordinates[0], 3.0 / 34.0, 1e-16);
    EXPECT_NEAR(all[0].coordinates[1], 5.0 / 34.0, 1e-16);
    EXPECT_TRUE(all[0].stable);
    EXPECT_TRUE(all[0].periods.empty());
}

TEST(Equilibria, where_there_is_none_the_list_is_empty) {
    Scene falls(down);
    falls.add(Particle{.mass = 1.0}, FreeStart{.position = {1.0, 2.0, 3.0}});
    EXPECT_TRUE(equilibria(falls).empty());
    // a force that dies away is not zero
    Scene fades;
    const auto a = fades.add(Particle{.mass = 1.0}, FreeStart{.position = {1.0, 2.0, 3.0}});
    fades.apply(Force([](const auto&, const auto& r, const auto&) { return r / dot<Expression>(r, r); }), a);
    EXPECT_TRUE(equilibria(fades).empty());
    Scene nothing;
    nothing.add(Particle{.mass = 1.0}, FreeStart{.position = {1.0, 2.0, 3.0}});
    EXPECT_EQ(equilibria(nothing), (std::vector<Equilibrium>{{{1.0, 2.0, 3.0}, false}}));
}

// --- input ---

TEST(Equilibria, what_makes_no_sense_is_refused_by_name) {
    EXPECT_TRUE(has(refusal(Scene()), "0 bodies"));
    Scene timed = bead_on(vertical_circle(1.0));
    timed.apply(Force([](const auto& t, const auto&, const auto&) { return Vector(sin(t), 0.0, 0.0); }), BodyHandle{0});
    EXPECT_TRUE(has(refusal(timed), "force \"function\" on bead 1 depends on time"));
    const RailOptions belt{.drive = 0.5};
    EXPECT_TRUE(has(refusal(bead_on(along_x, Coulomb{.mu_static = 0.5}, belt)), "moves (drive)"));
    EXPECT_EQ(refusal(bead_on(along_x, std::nullopt, belt)), "") << "a smooth belt does not pull";
    EXPECT_TRUE(has(refusal(bead_on(along_x), {1.0, 2.0}), "number of coordinates in near is 2"));
    EXPECT_TRUE(has(refusal(bead_on(along_x), {std::nan("")}), "near"));
    // square roots of negative numbers
    EXPECT_TRUE(has(refusal(bead_under([](const auto& x) { return sqrt(x) - 1.0; }, -2.0)),
                    "bead 1: at parameter -2 force \"function\" on bead 1, which is [nan, 0, 0] is not finite"))
        << refusal(bead_under([](const auto& x) { return sqrt(x) - 1.0; }, -2.0));
    Scene free;
    const auto a = free.add(Particle{.mass = 1.0}, FreeStart{.position = {-1.0, 2.0, 3.0}});
    free.apply(Force([](const auto&, const auto& r, const auto&) { return Vector(log(r[0]), 0.0, 0.0); }), a);
    EXPECT_TRUE(has(refusal(free), "force \"function\" on particle 1, which is [nan, 0, 0] is not finite"))
        << refusal(free);
}

TEST(Equilibria, powers_of_two_in_the_units_change_no_digit) {
    const auto all = [](int a, int b, int c) {
        const double length = std::ldexp(1.0, a), mass = std::ldexp(1.0, b), time = std::ldexp(1.0, c);
        Scene scene({0.0, 0.0, -9.81 * length / (time * time)});
        Polynomial wells;
        // u in lengths too
        wells.coefficients = {{0, 0, 0},
                              {1, 0, -0.3},
                              {0, 0, -2.0 / length},
                              {0, 0, 0.1 / length / length},
                              {0, 0, 1.0 / length / length / length}};
        const auto bead = scene.add(Particle{.mass = 0.7 * mass}, Rail(wells, Coulomb{.mu_static = 0.3}),
                                    {.parameter = 0.3 * length});
        scene.connect(Spring{.stiffness = 2.0 * mass / (time * time), .rest_length = 0.4 * length}, bead,
                      Vector3(1.0 * length, 0.5 * length, 0.0));
        std::vector<double> digits;
        for (const Equilibrium& e : equilibria(scene))
            for (const double x : {e.coordinates[0], e.interval->first, e.interval->second})
                digits.push_back(x / length);
        return digits;
    };
    const auto one = all(0, 0, 0);
    EXPECT_EQ(one.size(), 9u);
    for (const auto& [a, b, c] :
         {std::array{30, 0, 0}, std::array{0, 25, 0}, std::array{0, 0, -20}, std::array{-31, 7, 9}})
        EXPECT_EQ(all(a, b, c), one);
}

TEST(Equilibria, a_rail_that_only_pushes_pulls_no_bead_that_is_joined_to_another) {
    Scene scene(down);
    const BodyHandle bead =
                         scene.add(Particle{0.7}, Rail(vertical_circle(0.5), std::nullopt, {.side = RailSide::minus}),
                                   {.parameter = 3.0}),
                     other = scene.add(Particle{0.3}, Rail(along_x), {.parameter = 0.1});
    scene.connect(Spring{.stiffness = 2.0}, bead, other);
    scene.connect(Spring{.stiffness = 3.0}, other, Vector3(0, 0, 0));
    for (const Equilibrium& e : equilibria(scene, {0.1, 0.1})) EXPECT_GT(std::abs(e.coordinates[0]), 1.0);
    for (const Equilibrium& e : equilibria(scene, {3.0, 0.1})) EXPECT_NEAR(e.coordinates[0], std::numbers::pi, 1e-9);
    EXPECT_EQ(equilibria(scene, {3.0, 0.1}).size(), 1u);
    // the one that it has, however far
    EXPECT_EQ(equilibria(scene, {0.1, 0.1}).size(), 1u);
}

TEST(Equilibria, at_a_corner_are_stable_where_the_force_leads_back_on_both_sides) {
    for (const double sign : {1.0, -1.0}) {
        const auto found = equilibria(bead_under([=](const auto& x) { return -sign * (x + 0.5 * abs(x)); }, 0.3));
        ASSERT_EQ(found.size(), 1u);
        EXPECT_NEAR(found[0].coordinates[0], 0.0, 1e-15);
        EXPECT_EQ(found[0].stable, sign > 0.0);
    }
    // it leads away on one of them
    for (const double sign : {1.0, -1.0}) {
        const auto found = equilibria(bead_under([=](const auto& x) { return sign * (abs(x) + 0.5 * x); }, 0.3));
        ASSERT_EQ(found.size(), 1u);
        EXPECT_FALSE(found[0].stable);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_equilibria
