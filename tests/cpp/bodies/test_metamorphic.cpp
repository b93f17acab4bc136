// Checks that need no answer: the same motion of a rigid body told differently is the same motion.
#include <gtest/gtest.h>

#include <functional>
#include <iostream>
#include <variant>

#include "bodies/random_bodies.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::test::test_metamorphic {
namespace {

constexpr BodyHandle first{0};
const bool table = setting("RBDYN_TEST_TABLE", 0) != 0;

/// Lengths, times and masses of a telling; how its world is turned (or mirrored: det -1) and where its origin is.
struct Telling {
    double m = 1.0, s = 1.0, kg = 1.0;
    Matrix3 turn = Matrix3::Identity();
    Vector3 shift = Vector3::Zero();
    bool with_nothing = false;  // effects with coefficient zero

    bool is_mirrored() const { return turn.determinant() < 0.0; }
    // the body's axes of a mirrored world are mirrored too, so that attitudes stay turns
    Matrix3 of_body() const { return is_mirrored() ? turn : Matrix3::Identity(); }
    // on hinges and slides body axes are the world's at the start
    Matrix3 of_body(bool is_guided) const { return is_guided ? turn : of_body(); }

    Vector3 place(const Vector3& v) const { return shift + turn * v * m; }
    Vector3 axis(const Vector3& v) const { return turn * v; }
    Vector3 field(const Vector3& v) const { return turn * v * (m / (s * s)); }
    Vector3 velocity(const Vector3& v) const { return turn * v * (m / s); }
    Attitude attitude(const EulerAngles& a) const {
        const Matrix3 r = rotation_matrix(quaternion(a)), b = of_body();
        if (turn == Matrix3::Identity()) return a;
        return Attitude(Matrix3(turn * r * b.transpose()));
    }
    Vector3 omega(const Vector3& v) const { return of_body() * v * (is_mirrored() ? -1.0 : 1.0) / s; }
    double sense() const { return is_mirrored() ? -1.0 : 1.0; }
    Vector3 point(const Vector3& p, bool is_guided = false) const { return of_body(is_guided) * p * m; }
    RigidBody body(double mass, const Matrix3& inertia, const Vector3& com, bool is_guided = false) const {
        const Matrix3 b = of_body(is_guided);
        return {mass * kg, Matrix3(b * inertia * b.transpose() * (kg * m * m)), {.com = b * com * m}};
    }
    Spring spring(double k, double length, double damping) const {
        return {.stiffness = k * kg / (s * s), .rest_length = length * m, .damping = damping * kg / s};
    }
};

struct Motion {
    std::string name;
    std::function<Scene(const Telling&)> tell;
    double until;
    bool is_closed, loses_energy;
};

Matrix3 full() {
    Matrix3 i;
    i << 0.5, 0.0625, -0.03125, 0.0625, 0.75, 0.125, -0.03125, 0.125, 0.625;
    return i;
}
const Matrix3 round_one = Vector3(0.5, 0.5, 0.25).asDiagonal();

std::vector<Motion> motions() {
    std::vector<Motion> all;
    const auto nothing = [](Scene& scene, const Telling& w, bool on_hinge = false) {
        if (!w.with_nothing) return;
        scene.apply(Drag{0.0, 0.0}, first);
        scene.apply(Force(Vector3(0, 0, 0)), first, Vector3(1, 2, 3));
        scene.apply(Force(Vector3(0, 0, 0), Frame::body), first);
        scene.apply(Torque(Vector3(0, 0, 0)), first);
        scene.apply(Lorentz{0.0, {1, 2, 3}}, first);
        if (on_hinge) scene.apply(TorsionSpring{0.0, 1.0, 0.0}, first);
        scene.connect(Spring{.stiffness = 0.0, .rest_length = 1.0}, first.point({1, 0, 0}), Vector3(1, 2, 3));
    };
    const auto free = [=](bool is_dragged) {
        return [=](const Telling& w) {
            Scene scene(w.field({0, 0.5, -9.8125}));
            const BodyHandle b = scene.add(w.body(1.5, full(), {0.125, -0.25, 0.375}), Free{},
                                           {.position = w.place({0.5, 1, 2}),
                                            .velocity = w.velocity({1, -2, 3}),
                                            .attitude = w.attitude({0.5, 0.25, 0.75}),
                                            .angular_velocity = w.omega({1.5, -2.0, 0.5})});
            if (is_dragged)
                scene.apply(Drag{.linear = 0.25 * w.kg / w.s, .quadratic = 0.0625 * w.kg / w.m}, b,
                            w.point({0.5, 0.25, 0.125}));
            nothing(scene, w);
            return scene;
        };
    };
    all.push_back({"thrown", free(false), 3.0, true, false});
    all.push_back({"thrown with drag", free(true), 3.0, false, true});
    const auto ball = [=](bool is_sprung) {
        return [=](const Telling& w) {
            Scene scene(w.field({0, 0.5, -9.8125}));
            const BodyHandle b =
                scene.add(w.body(1.5, full(), {0.125, -0.25, 0.375}),
                          Spherical{.at = w.place({0.25, 0.5, 0.75}), .point = w.point({0.25, 0.125, -0.0625})},
                          {.attitude = w.attitude({0.5, 0.25, 0.75}), .angular_velocity = w.omega({1.5, -2.0, 0.5})});
            if (is_sprung)
                scene.connect(w.spring(8.0, 0.5, 0.25), b.point(w.point({0.5, 0.25, 0.125})),
                              Vector3(w.place({1, 2, 3})));
            nothing(scene, w);
            return scene;
        };
    };
    all.push_back({"heavy on a ball joint", ball(false), 2.0, false, false});
    all.push_back({"the same with a spring", ball(true), 2.0, false, true});
    const auto top = [=](bool is_dragged) {
        return [=](const Telling& w) {
            Scene scene(w.field({0, 0, -9.8125}));
            const BodyHandle b =
                scene.add(w.body(1.5, round_one, {0, 0, 0.5}), Spherical{.at = w.place({0.25, 0.5, 0.75})},
                          {.attitude = w.attitude({0.5, 0.25, 0.75}), .angular_velocity = w.omega({0.25, -0.5, 12})});
            if (is_dragged) scene.apply(Drag{.linear = 0.25 * w.kg / w.s}, b);
            nothing(scene, w);
            return scene;
        };
    };
    all.push_back({"Lagrange's top", top(false), 3.0, true, false});
    all.push_back({"Lagrange's top with drag", top(true), 3.0, false, true});
    const auto hinge = [=](bool is_sprung) {
        return [=](const Telling& w) {
            Scene scene(w.field({0, 0.5, -9.8125}));
            const BodyHandle b = scene.add(w.body(1.5, full(), {0.125, -0.25, 0.375}, true),
                                           Revolute{.axis = w.sense() * w.axis({1, 2, 0.5}),
                                                    .at = w.place({0.25, 0.5, 0.75}),
                                                    .point = w.point({0.25, 0.125, -0.0625}, true)},
                                           {.angle = 0.75, .rate = 2.0 / w.s});
            if (is_sprung) {
                const double torque = w.kg * w.m * w.m / (w.s * w.s);
                scene.apply(TorsionSpring{.stiffness = 3 * torque, .rest_angle = 0.25, .damping = 0.5 * torque * w.s},
                            b);
                scene.apply(Drag{.linear = 0.25 * w.kg / w.s, .quadratic = 0.0625 * w.kg / w.m}, b,
                            w.point({0.5, 0.25, 0.125}, true));
            }
            nothing(scene, w, true);
            return scene;
        };
    };
    all.push_back({"compound pendulum", hinge(false), 3.0, true, false});
    all.push_back({"hinge with torsion spring and drag", hinge(true), 3.0, false, true});
    all.push_back({"slide with a spring",
                   [=](const Telling& w) {
                       Scene scene(w.field({0, 0.5, -9.8125}));
                       const BodyHandle b =
                           scene.add(w.body(1.5, full(), {0.125, -0.25, 0.375}, true),
                                     Prismatic{.axis = w.axis({1, 2, 0.5}), .at = w.place({0.25, 0.5, 0.75})},
                                     {.displacement = 0.5 * w.m, .rate = 2.0 * w.m / w.s});
                       scene.connect(w.spring(8.0, 0.5, 0.0), b.point(w.point({0.5, 0.25, 0.125}, true)),
                                     Vector3(w.place({1, 2, 3})));
                       nothing(scene, w);
                       return scene;
                   },
                   3.0, false, false});
    return all;
}

/// How far two reports are apart, the second told back into the world of the first; relative to what they are.
double distance(const RigidReport& a, const RigidReport& b, const Telling& w, bool is_guided) {
    const Matrix3 back = w.turn.transpose(), body = w.of_body(is_guided).transpose();
    const double sense = w.sense();
    const auto off = [](const Vector3& x, const Vector3& y, double size) { return (x - y).norm() / size; };
    double worst = 0.0;
    const auto see = [&](double d) { worst = std::max(worst, d); };
    const double length = 1.0 + a.position.norm();
    see(off(a.position, back * (b.position - w.shift) / w.m, length + w.shift.norm()));
    see(off(a.velocity, back * b.velocity * (w.s / w.m), 1.0 + a.velocity.norm()));
    const Matrix3 turned = back * rotation_matrix(b.attitude) * body.transpose();
    see((rotation_matrix(a.attitude) - turned).norm());
    see(off(a.angular_velocity, sense * (body * b.angular_velocity) * w.s, 1.0 + a.angular_velocity.norm()));
    const double force = w.kg * w.m / (w.s * w.s);
    const double size = 1.0 + a.force_effort;
    see(off(a.reaction, back * b.reaction / force, size));
    see(off(a.reaction_torque, sense * (back * b.reaction_torque) / (force * w.m), size + a.torque_effort));
    return worst;
}
bool is_guided(const Trajectory& run) {
    const Joint& joint = run.data()->scene.bodies()[0].joint;
    return !std::holds_alternative<Free>(joint) && !std::holds_alternative<Spherical>(joint);
}

/// The largest distance over a run and another of the same scene told differently.
double distance(const Trajectory& a, const Trajectory& b, const Telling& w) {
    double worst = 0.0;
    for (int k = 0; k <= 20; ++k) {
        const double t = a.start() + (a.end() - a.start()) * k / 20;
        worst = std::max(worst, distance(a[first].rigid(t), b[first].rigid(t * w.s), w, is_guided(a)));
    }
    return worst;
}

TEST(Metamorphic, bodies_do_not_know_how_the_world_is_turned_nor_where_its_origin_is) {
    Random random(7);
    double worst = 0.0;
    for (const Motion& motion : motions()) {
        const SimulateOptions options{.until = motion.until, .error = 1e-12};
        const Trajectory upright = simulate(motion.tell({}), options);
        EXPECT_EQ(upright.engine() == "closed form", motion.is_closed) << motion.name;
        for (int k = 0; k < 4; ++k) {
            Telling w{.turn = rotation_matrix(random_attitude(random))};
            if (k % 2 == 1) w.shift = random_vector(random, 10.0);
            const Trajectory turned = simulate(motion.tell(w), options);
            EXPECT_EQ(turned.engine(), upright.engine()) << motion.name;
            const double off = distance(upright, turned, w);
            worst = std::max(worst, off);
            EXPECT_LE(off, 2e-12) << motion.name;
        }
    }
    if (table) std::cout << "turned world: " << worst << '\n';
}

TEST(Metamorphic, bodies_in_a_mirror_move_as_the_mirror_shows) {
    Random random(8);
    double worst = 0.0;
    for (const Motion& motion : motions()) {
        const SimulateOptions options{.until = motion.until, .error = 1e-12};
        const Trajectory upright = simulate(motion.tell({}), options);
        for (int k = 0; k < 3; ++k) {
            const Vector3 n = k == 0 ? Vector3::UnitX() : random.direction();
            const Telling w{.turn = Matrix3::Identity() - 2.0 * n * n.transpose()};
            const Trajectory mirrored = simulate(motion.tell(w), options);
            const double off = distance(upright, mirrored, w);
            worst = std::max(worst, off);
            EXPECT_LE(off, 2e-12) << motion.name;
        }
    }
    if (table) std::cout << "mirrored: " << worst << '\n';
}

TEST(Metamorphic, bodies_do_not_know_their_units) {
    const int powers[][3] = {{1, 0, 0},  {0, 1, 0},   {0, 0, 1},  {30, 0, 0},  {-30, 0, 0},
                             {0, 30, 0}, {0, -30, 0}, {0, 0, 30}, {0, 0, -30}, {10, -7, 13}};
    for (const Motion& motion : motions())
        for (const std::string engine : {"auto", "taylor"}) {
            double worst = 0.0;
            const Trajectory in_si =
                simulate(motion.tell({}), {.until = motion.until, .error = 1e-10, .engine = engine});
            for (const auto& [metre, second, kilogram] : powers) {
                const Telling units{
                    .m = std::ldexp(1.0, metre), .s = std::ldexp(1.0, second), .kg = std::ldexp(1.0, kilogram)};
                const Trajectory run =
                    simulate(motion.tell(units), {.until = motion.until * units.s, .error = 1e-10, .engine = engine});
                EXPECT_EQ(run.statistics().steps, in_si.statistics().steps) << motion.name;
                worst = std::max(worst, distance(in_si, run, units));
            }
            if (table) std::cout << "units, " << engine << ", " << motion.name << ": " << worst << '\n';
            EXPECT_EQ(worst, 0.0) << motion.name << ' ' << engine;
        }
}

TEST(Metamorphic, an_effect_that_is_there_with_coefficient_zero_changes_no_bit_of_a_body) {
    for (const Motion& motion : motions())
        for (const std::string engine : {"auto", "taylor"}) {
            const SimulateOptions options{.until = motion.until, .error = 1e-10, .engine = engine};
            const Trajectory with = simulate(motion.tell({.with_nothing = true}), options),
                             without = simulate(motion.tell({}), options);
            EXPECT_EQ(with.engine(), without.engine()) << motion.name;
            EXPECT_EQ(with.plan().effects, without.plan().effects) << motion.name;
            EXPECT_EQ(with.plan().integrals, without.plan().integrals) << motion.name;
            EXPECT_EQ(distance(with, without, {}), 0.0) << motion.name << ' ' << engine;
        }
}

TEST(Metamorphic, a_motion_with_reversed_velocities_goes_back_the_way_it_came) {
    double worst = 0.0;
    for (const Motion& motion : motions()) {
        if (motion.loses_energy) continue;
        const Scene scene = motion.tell({});
        const Trajectory there = simulate(scene, {.until = motion.until, .error = 1e-13});
        const RigidReport turning = there[first].rigid(motion.until);
        Scene reversed(scene.gravity());
        const Scene::Body& b = scene.bodies()[0];
        if (std::holds_alternative<Free>(b.joint))
            reversed.add(*b.rigid(), Free{},
                         {.position = turning.position,
                          .velocity = -turning.velocity,
                          .attitude = turning.attitude,
                          .angular_velocity = -turning.angular_velocity});
        else if (const Spherical* ball = std::get_if<Spherical>(&b.joint))
            reversed.add(*b.rigid(), *ball,
                         {.attitude = turning.attitude, .angular_velocity = -turning.angular_velocity});
        else if (const Revolute* hinge = std::get_if<Revolute>(&b.joint))
            reversed.add(*b.rigid(), *hinge, {.angle = turning.coordinate, .rate = -turning.rate});
        else
            reversed.add(*b.rigid(), std::get<Prismatic>(b.joint),
                         {.displacement = turning.coordinate, .rate = -turning.rate});
        for (const auto& c : scene.connections()) reversed.connect(c.coupling, c.a, c.b);
        const Trajectory back = simulate(reversed, {.until = motion.until, .error = 1e-13});
        for (int k = 0; k <= 10; ++k) {
            const double t = motion.until * k / 10;
            RigidReport was = there[first].rigid(t), is = back[first].rigid(motion.until - t);
            is.velocity = -is.velocity;
            is.angular_velocity = -is.angular_velocity;
            const double off = distance(was, is, {}, is_guided(there));
            worst = std::max(worst, off);
            EXPECT_LE(off, 1e-12) << motion.name << " at " << t;
        }
    }
    if (table) std::cout << "time reversed: " << worst << '\n';
}

TEST(Metamorphic, a_motion_taken_up_in_the_middle_goes_on_as_it_would_have) {
    double worst = 0.0;
    for (const Motion& motion : motions()) {
        const Trajectory whole = simulate(motion.tell({}), {.until = motion.until, .error = 1e-13});
        for (const double part : {0.25, 0.5, 0.875}) {
            const double t = part * motion.until;
            const Trajectory rest = simulate(taken_up(whole, t), {.until = motion.until, .start = t, .error = 1e-13});
            for (int k = 0; k <= 10; ++k) {
                const double now = std::min(motion.until, t + (motion.until - t) * k / 10);
                const double off = distance(whole[first].rigid(now), rest[first].rigid(now), {}, is_guided(whole));
                worst = std::max(worst, off);
                EXPECT_LE(off, 1e-12) << motion.name << " at " << now;
            }
        }
    }
    if (table) std::cout << "taken up: " << worst << '\n';
}

TEST(Metamorphic, the_order_in_which_bodies_are_told_changes_nothing) {
    const auto tell = [](const std::vector<int>& order) {
        Random random(9);
        // every body with its own draws, whatever the order
        std::vector<std::function<BodyHandle(Scene&)>> adds;
        for (int joint = 0; joint < 4; ++joint) {
            const RigidBody body = random_body(random);
            const Random state = random;
            adds.push_back([=](Scene& scene) {
                Random own = state;
                return add_random(scene, own, body, joint);
            });
            random.bits();
        }
        Scene scene(down);
        std::vector<BodyHandle> handles(4);
        for (const int i : order) handles[static_cast<std::size_t>(i)] = adds[static_cast<std::size_t>(i)](scene);
        const Spring spring{.stiffness = 6.0, .rest_length = 0.5, .damping = 0.25};
        for (std::size_t i = 0; i < 4; ++i)
            scene.connect(spring, handles[i].point({0.5, 0.25, 0.125}), handles[(i + 1) % 4]);
        return std::pair(scene, handles);
    };
    const SimulateOptions options{.until = 2.0, .error = 1e-12};
    const auto [scene, handles] = tell({0, 1, 2, 3});
    const Trajectory one = simulate(scene, options);
    for (const std::vector<int>& order : {std::vector{3, 1, 0, 2}, std::vector{2, 3, 1, 0}}) {
        const auto [again, others] = tell(order);
        const Trajectory other = simulate(again, options);
        for (std::size_t i = 0; i < 4; ++i)
            for (const double t : {0.5, 1.0, 2.0})
                EXPECT_LE(distance(one[handles[i]].rigid(t), other[others[i]].rigid(t), {}, false), 2e-12) << i;
    }
}

TEST(Metamorphic, a_body_welded_of_pieces_is_the_whole) {
    const RigidBody whole = shapes::box(6.0, {1.0, 2.0, 3.0}).shifted({0.25, 0.5, 0.125});
    RigidBody pieces = shapes::box(2.0, {1.0, 2.0, 1.0}).shifted({0.25, 0.5, 0.125 - 1.0});
    pieces = pieces + shapes::box(2.0, {1.0, 2.0, 1.0}).shifted({0.25, 0.5, 0.125 + 1.0});
    pieces = pieces + shapes::box(1.0, {1.0, 1.0, 1.0}).shifted({0.25, 0.0, 0.125});
    pieces = shapes::box(1.0, {1.0, 1.0, 1.0}).shifted({0.25, 1.0, 0.125}) + pieces;
    for (int joint = 0; joint < 4; ++joint) {
        const auto tell = [&](const RigidBody& body) {
            Random random(10);
            Scene scene(down);
            add_random(scene, random, body, joint);
            return scene;
        };
        const Trajectory a = simulate(tell(whole), {.until = 3.0, .error = 1e-12}),
                         b = simulate(tell(pieces), {.until = 3.0, .error = 1e-12});
        EXPECT_EQ(a.engine(), b.engine());
        EXPECT_LE(distance(a, b, {}), 1e-13) << joint;
    }
}

}  // namespace
}  // namespace rbdyn::test::test_metamorphic
