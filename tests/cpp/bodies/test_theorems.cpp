// The theorems of the chapter along motions, and motions of random bodies against an integration of their own.
#include <gtest/gtest.h>

#include <array>
#include <iostream>
#include <optional>

#include "bodies/random_bodies.hpp"
#include "bodies/truth.hpp"
#include "rbdyn/body/shapes.hpp"
#include "rbdyn/model/assembly.hpp"

namespace rbdyn::test::test_theorems {
namespace {

constexpr BodyHandle first{0};
const bool table = setting("RBDYN_TEST_TABLE", 0) != 0;

/// The derivative of a smooth function of time, by a difference of order 8 (its weights times 840).
template <class F>
auto slope(const F& f, double t, double h) {
    using Value = decltype(f(t));
    const auto pair = [&](int k) { return Value(f(t + k * h) - f(t - k * h)); };
    return Value((672.0 * pair(1) - 168.0 * pair(2) + 32.0 * pair(3) - 3.0 * pair(4)) / (840.0 * h));
}
// error of the difference: h^8 and rounding over h
constexpr double step = 1.0 / 256.0, of_slopes = 1e-10;

/// Points of mass: a body whose sums can be made by hand.
struct Points {
    std::vector<double> masses;
    std::vector<Vector3> places;
    RigidBody body;

    static Points random(Random& random) {
        std::vector<double> masses;
        std::vector<Vector3> places;
        for (int k = 0; k < 6; ++k) {
            masses.push_back(random.uniform(0.25, 1.0));
            places.push_back(random_vector(random, 1.0));
        }
        return {masses, places, shapes::points(masses, places)};
    }
};

/// Bodies on all joints with loads that do and do not keep the energy.
struct Case {
    Points points;
    Scene scene;
    int joint;
};
Case random_case(Random& random, int joint, bool is_lossy) {
    Case c{Points::random(random), Scene(random_vector(random, 6.0)), joint};
    const BodyHandle b = add_random(c.scene, random, c.points.body, joint);
    c.scene.connect(Spring{.stiffness = 5.0, .rest_length = 0.5, .damping = is_lossy ? 0.5 : 0.0},
                    b.point(random_vector(random, 1.0)), random_vector(random, 3.0));
    if (joint == 2) c.scene.apply(TorsionSpring{.stiffness = 1.5, .rest_angle = 0.25}, b);
    if (!is_lossy) return c;
    c.scene.apply(Drag{.linear = 0.25, .quadratic = 0.125}, b, random_vector(random, 1.0));
    c.scene.apply(Force(random_vector(random, 2.0), Frame::body), b, random_vector(random, 1.0));
    c.scene.apply(Torque([](const auto& t, const auto&, const auto& w) {
                      using V = std::decay_t<decltype(w)>;
                      return V(sin(t), -w[1], cos(t) * 0.5);
                  }),
                  b);
    return c;
}

TEST(Theorems, sums_over_the_points_of_a_body_are_what_its_mass_and_inertia_say) {
    // momentum, angular momentum about any pole (7.31, 7.33-7.35), kinetic energy and Koenig's split of it (7.37)
    Random random(21);
    for (int k = 0; k < 24; ++k) {
        const Case c = random_case(random, k % 4, k % 2 == 0);
        const Trajectory run = simulate(c.scene, {.until = 1.0, .error = 1e-10});
        const Vector3 pole = random_vector(random, 2.0), inside = random_vector(random, 1.0);
        for (const double t : {0.0, 0.375, 1.0}) {
            Vector3 momentum = Vector3::Zero(), spin = momentum;
            double energy = 0.0;
            for (std::size_t i = 0; i < c.points.masses.size(); ++i) {
                const auto [r, v] = run[first].point(c.points.places[i], t);
                momentum += c.points.masses[i] * v;
                spin += (r - pole).cross(c.points.masses[i] * v);
                energy += 0.5 * c.points.masses[i] * v.squaredNorm();
            }
            const double size = 1.0 + energy, tolerance = 40 * epsilon * size;
            EXPECT_LE((run.momentum(t) - momentum).norm(), tolerance);
            EXPECT_LE((run.angular_momentum(t, pole) - spin).norm(), 4.0 * tolerance);
            EXPECT_NEAR(run.kinetic_energy(t), energy, tolerance);
            const RigidReport r = run[first].rigid(t);
            const double m = c.points.body.mass();
            EXPECT_NEAR(0.5 * m * run.center_of_mass_velocity(t).squaredNorm() + r.spin_energy, energy, tolerance);
            // about any pole Q of the body: m v_Q^2/2 + m v_Q . omega x (G - Q) + I_Q omega . omega/2
            const auto [q, v] = run[first].point(inside, t);
            const Matrix3 axes = run[first].rotation_matrix(t);
            const Vector3 w = r.angular_velocity;
            EXPECT_NEAR(0.5 * m * v.squaredNorm() + m * v.dot(axes * w.cross(c.points.body.com() - inside)) +
                            0.5 * w.dot(c.points.body.inertia(inside) * w),
                        energy, 4.0 * tolerance);
        }
    }
}

TEST(Theorems, momenta_and_kinetic_energy_change_as_the_forces_say) {
    // Q' = R (7.38), K' = M about G, the fixed point and any other (7.39), T' = the power of all forces (7.44)
    Random random(22);
    double worst = 0.0;
    for (int k = 0; k < 24; ++k) {
        const Case c = random_case(random, k % 4, k % 8 < 4);
        const Trajectory run = simulate(c.scene, {.until = 1.0, .error = 1e-13});
        const Vector3 pole = random_vector(random, 2.0);
        for (const double t : {0.25, 0.5, 0.75}) {
            const RigidReport r = run[first].rigid(t);
            const Scene now = taken_up(run, t);
            const Assembly assembly(now, t);
            const AssembledBody body = assembly.body(0);
            const JointMotion& joint = assembly.motion(0);
            // what acts, by the assembly; what the joint exerts, by the run
            const Vector3 force = body.force + r.reaction;
            const auto moment = [&](const Vector3& about) {
                return Vector3(assembly.moment(0, about) + (joint.held - about).cross(r.reaction) + r.reaction_torque);
            };
            const double size = 1.0 + body.effort;
            const auto expect = [&](double off, const char* what) {
                worst = std::max(worst, off / size);
                EXPECT_LE(off, of_slopes * size) << what << " on joint " << c.joint;
            };
            expect((slope([&](double s) { return run.momentum(s); }, t, step) - force).norm(), "momentum");
            for (const Vector3& about : {Vector3::Zero().eval(), pole, joint.held})
                expect(
                    (slope([&](double s) { return run.angular_momentum(s, about); }, t, step) - moment(about)).norm(),
                    "angular momentum");
            const auto about_center = [&](double s) { return run[first].rigid(s).spin_momentum; };
            expect((slope(about_center, t, step) - moment(run.center_of_mass(t))).norm(), "about G");
            expect(std::abs(slope([&](double s) { return run.kinetic_energy(s); }, t, step) - run.power(t)), "energy");
        }
        EXPECT_NEAR(run.work(0.0, 1.0), run.kinetic_energy(1.0) - run.kinetic_energy(0.0),
                    1e-12 * (1.0 + run.kinetic_energy(0.0) + run.kinetic_energy(1.0)));
    }
    if (table) std::cout << "theorems: " << worst << '\n';
}

TEST(Theorems, energy_stays_where_the_forces_have_a_potential) {
    // on a hinge: the energy integral of 7.60
    Random random(23);
    for (int k = 0; k < 16; ++k) {
        const Case c = random_case(random, k % 4, false);
        const Trajectory run = simulate(c.scene, {.until = 3.0, .error = 1e-12});
        ASSERT_TRUE(run.drift().contains("energy"));
        EXPECT_LE(run.drift().at("energy"), 1e-12) << c.joint;
        const Case lossy = random_case(random, k % 4, true);
        EXPECT_FALSE(simulate(lossy.scene, {.until = 0.5}).drift().contains("energy"));
    }
}

TEST(Theorems, a_thrown_body_keeps_its_angular_momentum_about_its_centre_and_not_about_another_point) {
    Random random(24);
    for (int k = 0; k < 8; ++k) {
        Scene scene(down);
        add_random(scene, random, random_body(random), 0);
        const Trajectory run = simulate(scene, {.until = 2.0, .error = 1e-12});
        const Vector3 start = run[first].rigid(0.0).spin_momentum, about = run.angular_momentum(0.0);
        const double m = scene.bodies()[0].mass();
        for (const double t : {0.5, 1.0, 2.0}) {
            EXPECT_LE((run[first].rigid(t).spin_momentum - start).norm(), 1e-14 * start.norm());
            // K' = (G - O) x m g: with G - O = c + v t + g t^2/2, K - K(0) = (c t + v t^2/2) x m g
            const Vector3 c = run.center_of_mass(0.0), v = run.center_of_mass_velocity(0.0);
            const Vector3 gained = (c * t + v * (0.5 * t * t)).cross(m * down);
            EXPECT_LE((run.angular_momentum(t) - about - gained).norm(), 1e-13 * (about.norm() + gained.norm()));
            EXPECT_GT(gained.norm(), 1e-2);
        }
        EXPECT_FALSE(run.drift().contains("angular momentum"));
        EXPECT_LE(run.drift().at("angular momentum z"), 1e-14);
    }
}

TEST(Theorems, the_vertical_as_the_body_sees_it_has_unit_length_and_turns_as_poisson_says) {
    Random random(25);
    for (int k = 0; k < 12; ++k) {
        const Case c = random_case(random, k % 3, k % 2 == 0);
        const Trajectory run = simulate(c.scene, {.until = 1.0, .error = 1e-13});
        for (const double t : {0.25, 0.5, 0.75}) {
            const Vector3 u = run[first].poisson_vector(t), omega = run[first].angular_velocity(t);
            EXPECT_NEAR(u.norm(), 1.0, 4 * epsilon);
            // u' + omega x u = 0 (7.59)
            const Vector3 rate = slope([&](double s) { return run[first].poisson_vector(s); }, t, step);
            EXPECT_LE((rate + omega.cross(u)).norm(), of_slopes * (1.0 + omega.norm()));
            // angular velocity and acceleration are those of the attitude
            const Matrix3 r = run[first].rotation_matrix(t);
            const Matrix3 turning = slope([&](double s) { return run[first].rotation_matrix(s); }, t, step);
            EXPECT_LE((turning - r * JointMotion::cross_matrix(omega)).norm(), of_slopes * (1.0 + omega.norm()));
            const Vector3 a = run[first].angular_acceleration(t);
            EXPECT_LE((slope([&](double s) { return run[first].angular_velocity(s); }, t, step) - a).norm(),
                      of_slopes * (1.0 + a.norm()));
        }
    }
}

TEST(Theorems, kovalevskayas_top_keeps_her_integral_in_any_axes_and_others_have_none) {
    Random random(26);
    for (int k = 0; k < 8; ++k) {
        // about the fixed point A = B = 2 C, G in the plane of A and B; a body as wide as it is allowed to be
        const double c = random.uniform(0.5, 1.0), mass = 1.0;
        const Vector3 com(0.3 * std::cos(k), 0.3 * std::sin(k), 0.0);
        const RigidBody upright(mass, {2 * c, 2 * c, c}, {.com = com, .inertia_about = InertiaAbout::origin});
        const RigidBody body = k % 2 == 0 ? upright : upright.rotated(random_attitude(random));
        Scene scene(down);
        scene.add(body, Spherical{},
                  {.attitude = random_attitude(random), .angular_velocity = random_vector(random, 3.0)});
        const Trajectory run = simulate(scene, {.until = 20.0, .error = 1e-9});
        const auto drift = run.drift();
        ASSERT_TRUE(drift.contains("Kovalevskaya")) << k;
        for (const auto& [name, value] : drift) EXPECT_LE(value, 1e-9) << name;
        Scene other(down);
        other.add(random_body(random), Spherical{.point = {0.5, 0, 0}}, {.angular_velocity = Vector3(1, 2, 3)});
        EXPECT_FALSE(simulate(other, {.until = 0.5}).drift().contains("Kovalevskaya"));
    }
}

TEST(RandomBodies, move_as_an_integration_of_their_own_says_and_know_their_error) {
    using Kind = Truth::Kind;
    Random random(27);
    const int draws = setting("RBDYN_TEST_DRAWS", 36);
    std::vector<double> ratios;
    int refused = 0;
    for (int k = 0; k < draws; ++k) {
        const Kind kind =
            std::array{Kind::free, Kind::spherical, Kind::revolute, Kind::prismatic}[static_cast<std::size_t>(k % 4)];
        const double error = std::array{1e-6, 1e-9, 1e-12}[static_cast<std::size_t>(k / 4 % 3)];
        const std::string engine = std::array{"auto", "taylor", "dop853"}[static_cast<std::size_t>(k / 12 % 3)];
        const Truth truth = Truth::random(random, kind, random.chance(0.75));
        std::optional<Trajectory> run;
        try {
            run = simulate(truth.scene(), {.until = 3.0, .error = error, .engine = engine});
        } catch (const AccuracyError& e) {
            // its floor is above that of Taylor series
            ++refused;
            EXPECT_TRUE(engine == "dop853" && error == 1e-12) << k << ' ' << e.what();
            continue;
        }
        const double actual = truth.error(*run, 30), estimate = *run->error();
        if (table)
            std::cout << k << ' ' << run->engine() << " asked " << error << " estimate " << estimate << " true "
                      << actual << '\n';
        EXPECT_LE(actual, error) << k << ' ' << engine;
        EXPECT_LE(actual, 10.0 * estimate) << k << ' ' << engine;
        if (actual > 1e-14) ratios.push_back(estimate / actual);
    }
    EXPECT_LE(refused, draws / 50);
    ASSERT_GE(static_cast<int>(ratios.size()), draws / 4);
    std::sort(ratios.begin(), ratios.end());
    EXPECT_LE(ratios[ratios.size() / 2], 30.0);
}

TEST(RandomBodies, tops_and_free_bodies_have_the_digits_that_closed_forms_promise) {
    Random random(28);
    double worst = 0.0;
    for (int k = 0; k < 40; ++k) {
        const Truth truth = k % 2 == 0 ? Truth::top(random) : Truth::random(random, Truth::Kind::free, false);
        const Trajectory run = simulate(truth.scene(), {.until = 3.0, .error = 1e-13});
        ASSERT_EQ(run.engine(), "closed form") << k;
        const double actual = truth.error(run, 20);
        worst = std::max(worst, actual);
        EXPECT_LE(actual, 10.0 * *run.error()) << k;
        EXPECT_LE(actual, 4e-15) << k;
    }
    if (table) std::cout << "closed forms of random bodies: " << worst << '\n';
}

TEST(RandomBodies, tops_built_turned_moved_and_welded_have_the_motion_of_the_upright_one) {
    Random random(29);
    double worst = 0.0;
    for (int k = 0; k < 20; ++k) {
        const double height = random.uniform(0.5, 1.0);
        const RigidBody upright =
            shapes::cone(1.5, 0.25, height, {0, 0, 1}) +
            (shapes::cylinder(0.5, 0.3, 0.1, {0, 0, 3}) + shapes::ring(0.25, 0.4, {0, 0, -1})).shifted({0, 0, height});
        const Attitude turn = EulerAngles{random.uniform(0, 3), random.uniform(-7, 7), random.uniform(-7, 7)},
                       start = random_attitude(random);
        // far from its own origin: what a sum of doubles would lose
        const Vector3 moved = random_vector(random, 100.0);
        const RigidBody body = upright.rotated(turn).shifted(moved);
        const Vector3 omega = 5.0 * random_vector(random, 1.0);
        const auto run = [&](const RigidBody& b, const Vector3& point, const Attitude& attitude) {
            Scene scene(down);
            scene.add(b, Spherical{.point = point}, {.attitude = attitude, .angular_velocity_world = omega});
            return simulate(scene, {.until = 10.0, .error = 1e-12});
        };
        const Trajectory right = run(upright, {0, 0, 0}, start),
                         other = run(body, moved, start.exact() * conjugate(turn.exact()));
        ASSERT_EQ(right.engine(), "closed form");
        ASSERT_EQ(other.engine(), "closed form") << k;
        for (int i = 1; i <= 10; ++i) {
            const Matrix3 r = right[first].rotation_matrix(i),
                          s = other[first].rotation_matrix(i) * rotation_matrix(turn.quaternion());
            worst = std::max({worst, (r - s).norm() / std::sqrt(2.0),
                              (right[first].angular_velocity_world(i) - other[first].angular_velocity_world(i)).norm() /
                                  right[first].angular_velocity_world(i).norm()});
        }
    }
    if (table) std::cout << "tops built in any way: " << worst << '\n';
    EXPECT_LE(worst, 4e-15);
}

TEST(InstantaneousAxis, is_where_a_body_moves_along_its_angular_velocity) {
    Scene scene(Vector3(0, 0, -9.8125));
    const BodyHandle body =
        scene.add(shapes::box(1.0, {0.1, 0.2, 0.3}),
                  BodyStart{.position = {1, 2, 3}, .velocity = {2, -1, 0.5}, .angular_velocity = Vector3(1, -2, 0.75)});
    const Trajectory run = simulate(scene, {.until = 1.0});
    for (const double t : {0.0, 0.3, 1.0}) {
        const auto [point, direction] = run[body].instantaneous_axis(t);
        const Vector3 omega = run[body].angular_velocity_world(t), arm = point - run[body].position(t);
        const Vector3 velocity = run[body].velocity(t) + omega.cross(arm);
        EXPECT_LE((direction - omega.normalized()).norm(), 1e-14);
        EXPECT_LE(velocity.cross(omega).norm(), 1e-13 * velocity.norm() * omega.norm() + 1e-13) << t;
        EXPECT_NEAR(arm.dot(omega), 0.0, 1e-13);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_theorems
