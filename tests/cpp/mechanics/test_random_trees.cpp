// Trees and loops drawn at random: accelerations and reactions against a formulation that shares nothing with the
// library's (mechanics/maximal.hpp), energy of conservative motions.
//
// RBDYN_TEST_TREES: how many of each. RBDYN_TEST_TABLE=1 prints the largest errors.
#include <gtest/gtest.h>

#include <iostream>

#include "mechanics/maximal.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_random_trees {
namespace {

using Real = Maximal::Real;
using Vec = Maximal::Vec;

/// The largest errors of accelerations and of reactions, over the largest there are.
struct Difference {
    double start = 0.0, motion = 0.0, joints = 0.0, held = 0.0;
    double doubt = 0.0;  // of accelerations, by rows too many that the state satisfies to rounding only
    bool is_unique = true;
};

Difference difference(const Maximal& truth, const Trajectory& run, bool is_tree) {
    const auto now = truth.seen(run);
    const auto right = truth.solve(now);
    Difference d;
    d.is_unique = right.is_unique;
    for (const ConstraintHandle c : truth.held)
        d.doubt = std::max(d.doubt, run[c].gap(0.0) / static_cast<double>(right.least_pivot));
    const std::size_t n = truth.handles.size();
    if (is_tree) {
        const auto start = truth.start();
        for (std::size_t i = 0; i < n; ++i) {
            d.start = std::max<double>(d.start, (start[i].r - now[i].r).norm());
            d.start = std::max<double>(d.start, (start[i].origin - now[i].origin).norm() / 10.0L);
            d.start = std::max<double>(d.start, (start[i].velocity - now[i].velocity).norm() / 50.0L);
            d.start = std::max<double>(d.start, (start[i].omega - now[i].omega).norm() / 10.0L);
        }
    }
    Real most = 0.0L, force = 0.0L;
    for (std::size_t i = 0; i < n; ++i) {
        most = std::max({most, right.acceleration[i].norm(), right.turning[i].norm()});
        force = std::max({force, right.joints[i].force.norm(), right.joints[i].torque.norm()});
    }
    for (const auto& w : right.held) force = std::max({force, w.force.norm(), w.torque.norm()});
    const auto off = [](const Vector3& value, const Vec& r, Real scale) {
        return static_cast<double>((value.cast<Real>() - r).norm() / std::max(scale, 1e-3L));
    };
    for (std::size_t i = 0; i < n; ++i) {
        const BodyMotion m = run[truth.handles[i]];
        if (truth.is_bead(i)) {
            d.motion = std::max(d.motion, off(m.acceleration(0.0), right.acceleration[i], most));
            if (right.is_unique) d.joints = std::max(d.joints, off(m.reaction(0.0), right.joints[i].force, force));
            continue;
        }
        d.motion = std::max(d.motion, off(m.center_of_mass_acceleration(0.0), right.acceleration[i], most));
        const Vec turning = now[i].r * m.angular_acceleration(0.0).cast<Real>();
        d.motion = std::max(d.motion, static_cast<double>((turning - right.turning[i]).norm() / std::max(most, 1e-3L)));
        if (!right.is_unique || std::holds_alternative<Free>(truth.scene.bodies()[i].joint)) continue;
        d.joints = std::max(d.joints, off(m.reaction(0.0), right.joints[i].force, force));
        d.joints = std::max(d.joints, off(m.reaction_torque(0.0), right.joints[i].torque, force));
    }
    if (right.is_unique)
        for (std::size_t k = 0; k < truth.held.size(); ++k) {
            d.held = std::max(d.held, off(run[truth.held[k]].force(0.0), right.held[k].force, force));
            d.held = std::max(d.held, off(run[truth.held[k]].torque(0.0), right.held[k].torque, force));
        }
    return d;
}

/// A run as short as can be, without an estimate of its error: what is asked for is its start.
Trajectory begin(const Scene& scene, const std::string& engine = "auto") {
    return simulate(scene, {.until = 0x1p-20, .rtol = 1e-6, .engine = engine, .max_steps = 20});
}

TEST(RandomTrees, accelerate_and_react_as_their_bodies_do_one_by_one) {
    Difference worst;
    const int count = setting("RBDYN_TEST_TREES", 200);
    for (int k = 0; k < count; ++k) {
        Random random(static_cast<std::uint64_t>(1000 + k));
        const Maximal truth(random, {});
        SCOPED_TRACE("seed " + std::to_string(1000 + k) + ": " + truth.kinds());
        std::optional<Trajectory> run;
        EXPECT_NO_THROW(run = begin(truth.scene));
        if (!run) continue;
        const Difference d = difference(truth, *run, true);
        EXPECT_TRUE(d.is_unique);
        EXPECT_LE(d.start, 1e-14);
        EXPECT_LE(d.motion, 1e-10);
        EXPECT_LE(d.joints, 1e-10);
        worst.start = std::max(worst.start, d.start);
        worst.motion = std::max(worst.motion, d.motion);
        worst.joints = std::max(worst.joints, d.joints);
    }
    if (std::getenv("RBDYN_TEST_TABLE") != nullptr)
        std::cout << count << " trees: start " << worst.start << ", accelerations " << worst.motion << ", reactions "
                  << worst.joints << '\n';
}

TEST(RandomLoops, accelerate_and_react_as_their_bodies_do_one_by_one) {
    Difference worst;
    int unique = 0, other = 0, refused = 0;
    const int count = setting("RBDYN_TEST_TREES", 200);
    for (int k = 0; k < count; ++k) {
        Random random(static_cast<std::uint64_t>(5000 + k));
        Maximal truth(random, {.least = 2, .most = 12, .loops = 0.3, .driven = k % 4 == 0});
        if (truth.held.empty()) continue;
        SCOPED_TRACE("seed " + std::to_string(5000 + k) + ": " + truth.kinds());
        // places fit already, rates do not
        double moved = 0.0;
        const std::string said = refusal([&] { moved = truth.scene.assemble(); });
        if (said != "accepted") {
            // driven bodies, or ones held too much, may not be able to keep to it
            ++refused;
            if (std::getenv("RBDYN_TEST_TABLE") != nullptr) std::cout << truth.kinds() << ": " << said << '\n';
            continue;
        }
        EXPECT_LE(moved, 1e-13);
        std::optional<Trajectory> run;
        EXPECT_NO_THROW(run = begin(truth.scene, "dop853"));
        if (!run) continue;
        const Difference d = difference(truth, *run, false);
        ++(d.is_unique ? unique : other);
        EXPECT_LE(d.motion, 1e-10 + d.doubt);
        EXPECT_LE(d.joints, 1e-10);
        EXPECT_LE(d.held, 1e-10);
        worst.motion = std::max(worst.motion, d.motion);
        worst.joints = std::max(worst.joints, d.joints);
        worst.held = std::max(worst.held, d.held);
    }
    if (std::getenv("RBDYN_TEST_TABLE") != nullptr)
        std::cout << unique << " loops, and " << other << " with rows too many, " << refused
                  << " refused: accelerations " << worst.motion << ", reactions " << worst.joints << ", of constraints "
                  << worst.held << '\n';
}

TEST(RandomLoops, and_trees_with_beads_loads_along_joints_and_points_on_curves_do_so_too) {
    Difference worst;
    int trees = 0, unique = 0, other = 0, refused = 0;
    const int count = setting("RBDYN_TEST_TREES", 200);
    for (int k = 0; k < count; ++k) {
        Random random(static_cast<std::uint64_t>(20000 + k));
        const bool is_tree = k % 2 == 0;
        Maximal truth(
            random,
            {.loops = is_tree ? 0.0 : 0.3, .driven = k % 4 < 2, .beads = true, .exerted = true, .curves = true});
        SCOPED_TRACE("seed " + std::to_string(20000 + k) + ": " + truth.kinds());
        if (!truth.held.empty() && refusal([&] { truth.scene.assemble(); }) != "accepted") {
            ++refused;
            continue;
        }
        std::optional<Trajectory> run;
        EXPECT_NO_THROW(run = begin(truth.scene, truth.held.empty() ? "auto" : "dop853"));
        if (!run) continue;
        const Difference d = difference(truth, *run, truth.held.empty());
        ++(truth.held.empty() ? trees : d.is_unique ? unique : other);
        EXPECT_LE(d.start, 1e-14);
        EXPECT_LE(d.motion, 1e-10);
        EXPECT_LE(d.joints, 1e-10);
        EXPECT_LE(d.held, 1e-10);
        worst.motion = std::max(worst.motion, d.motion);
        worst.joints = std::max(worst.joints, d.joints);
        worst.held = std::max(worst.held, d.held);
    }
    if (std::getenv("RBDYN_TEST_TABLE") != nullptr)
        std::cout << trees << " trees, " << unique << " loops, and " << other << " with rows too many, " << refused
                  << " refused: accelerations " << worst.motion << ", reactions " << worst.joints << ", of constraints "
                  << worst.held << '\n';
}

TEST(RandomLoops, and_trees_move_as_the_same_integrated_with_more_digits) {
    double worst = 0.0, told = 0.0;
    int trees = 0, loops = 0;
    for (int k = 0; k < setting("RBDYN_TEST_TREES", 200) / 10; ++k) {
        Random random(static_cast<std::uint64_t>(30000 + k));
        Maximal truth(random, {.least = 1,
                               .most = 4,
                               .loops = k % 2 == 0 ? 0.0 : 0.35,
                               .driven = k % 3 == 0,
                               .springs = false,
                               .beads = true,
                               .curves = true});
        SCOPED_TRACE("seed " + std::to_string(30000 + k) + ": " + truth.kinds());
        if (!truth.held.empty() && refusal([&] { truth.scene.assemble(); }) != "accepted") continue;
        constexpr double until = 0.5, error = 1e-12;
        std::optional<Trajectory> run;
        EXPECT_NO_THROW(run = simulate(truth.scene, {.until = until, .error = error}));
        if (!run || run->end() < until) continue;
        const auto first = truth.seen(*run);
        const auto right = truth.moved(first, until, 1.0L / 64), coarse = truth.moved(first, until, 1.0L / 32),
                   ours = truth.seen(*run, until);
        double off = 0.0, sure = 0.0;
        for (std::size_t i = 0; i < right.size(); ++i) {
            const auto apart = [&](const Maximal::Motion& a, const Maximal::Motion& b) {
                return static_cast<double>(
                    std::max({(a.origin - b.origin).norm() / (1 + right[i].origin.norm()), (a.r - b.r).norm(),
                              (a.velocity - b.velocity).norm() / (1 + right[i].velocity.norm()),
                              (a.omega - b.omega).norm() / (1 + right[i].omega.norm())}));
            };
            off = std::max(off, apart(ours[i], right[i]));
            sure = std::max(sure, apart(coarse[i], right[i]));
        }
        // rows that are too many, and what whirls, are beyond this integration
        if (!(sure <= 1e-13)) continue;
        ++(truth.held.empty() ? trees : loops);
        // a start that is rounded, and scales of places and velocities apart
        EXPECT_LE(off, 10.0 * error);
        worst = std::max(worst, off);
        told = std::max(told, *run->error());
    }
    if (std::getenv("RBDYN_TEST_TABLE") != nullptr)
        std::cout << trees << " trees and " << loops << " loops, 0.5 s: off by " << worst << ", told " << told << '\n';
}

TEST(RandomLoops, what_is_held_still_beside_what_moves_is_no_trouble) {
    Random random(5033);
    Maximal truth(random, {.least = 2, .most = 12, .loops = 0.3, .driven = false});
    truth.scene.assemble();
    EXPECT_NO_THROW(begin(truth.scene, "taylor"));
}

TEST(RandomTrees, keep_their_energy) {
    double worst = 0.0;
    for (int k = 0; k < setting("RBDYN_TEST_TREES", 200) / 8; ++k) {
        Random random(static_cast<std::uint64_t>(9000 + k));
        const Maximal truth(random, {.least = 1, .most = 4, .loaded = false, .driven = false});
        SCOPED_TRACE("seed " + std::to_string(9000 + k) + ": " + truth.kinds());
        const Trajectory run = simulate(truth.scene, {.until = 2.0, .error = 1e-12});
        double size = 0.0, off = 0.0;
        for (int i = 0; i <= 64; ++i) {
            const double t = run.end() * i / 64;
            size = std::max(size, run.kinetic_energy(t));
            off = std::max(off, std::abs(run.energy(t) - run.energy(0.0)));
        }
        EXPECT_LE(off, 1e-12 * size);
        worst = std::max(worst, off / size);
    }
    if (std::getenv("RBDYN_TEST_TABLE") != nullptr) std::cout << "energy " << worst << '\n';
}

/// Three bodies in a row, hinged, that float: told from either end, the motion is the same.
TEST(RandomTrees, move_alike_from_whichever_body_they_are_told) {
    for (int k = 0; k < 12; ++k) {
        Random random(static_cast<std::uint64_t>(7000 + k));
        const RigidBody one = random_body(random), two = random_body(random), three = random_body(random);
        const Vector3 a = random_vector(random, 1), b = random_vector(random, 1), c = random_vector(random, 1),
                      d = random_vector(random, 1), e = random.direction(), f = random.direction();
        const BodyStart start{.position = random_vector(random, 1.0),
                              .velocity = random_vector(random, 2.0),
                              .attitude = random_attitude(random),
                              .angular_velocity = random_vector(random, 2.0)};
        const double angles[] = {random.uniform(-3, 3), random.uniform(-3, 3)},
                     rates[] = {random.uniform(-3, 3), random.uniform(-3, 3)};
        const Vector3 gravity = random_vector(random, 8.0);
        Scene forth(gravity), back(gravity);
        const BodyHandle first = forth.add(one, start),
                         second = forth.add(two, Revolute{.axis = e, .at = a, .point = b},
                                            {.angle = angles[0], .rate = rates[0], .parent = first}),
                         third = forth.add(three, Revolute{.axis = f, .at = c, .point = d},
                                           {.angle = angles[1], .rate = rates[1], .parent = second});
        forth.connect(Spring{.stiffness = 4.0, .rest_length = 0.5}, first.point(c), third.point(a));
        const Trajectory run = simulate(forth, {.until = 2.0, .error = 1e-12});
        const BodyHandle last = back.add(three, BodyStart{.position = run[third].position(0.0),
                                                          .velocity = run[third].velocity(0.0),
                                                          .attitude = run[third].quaternion(0.0),
                                                          .angular_velocity = run[third].angular_velocity(0.0)}),
                         middle = back.add(two, Revolute{.axis = f, .at = d, .point = c},
                                           {.angle = -angles[1], .rate = -rates[1], .parent = last}),
                         front = back.add(one, Revolute{.axis = e, .at = b, .point = a},
                                          {.angle = -angles[0], .rate = -rates[0], .parent = middle});
        back.connect(Spring{.stiffness = 4.0, .rest_length = 0.5}, last.point(a), front.point(c));
        const Trajectory other = simulate(back, {.until = 2.0, .error = 1e-12});
        double off = 0.0;
        for (const auto& [x, y] : {std::pair(first, front), std::pair(second, middle), std::pair(third, last)}) {
            off = std::max(off, (run[x].center_of_mass(2.0) - other[y].center_of_mass(2.0)).norm() / 10.0);
            off = std::max(off, (run[x].rotation_matrix(2.0) - other[y].rotation_matrix(2.0)).norm());
        }
        off = std::max(off, (run[third].reaction(2.0) + other[middle].reaction(2.0)).norm() / 50.0);
        EXPECT_LE(off, 1e-11) << "seed " << 7000 + k;
    }
}

/// RBDYN_TEST_STEPS: how many of a four bar with gravity, seen each time the run is taken up again: at the end of a
/// series, which is as closed as its tolerance.
TEST(Loops, stay_closed_to_rounding_however_many_steps) {
    const int steps = setting("RBDYN_TEST_STEPS", 20000);
    const Vector3 z{0, 0, 1};
    Scene scene(Vector3{0, -9.81, 0});
    const auto bar = [](double mass, double length) {
        const double moment = mass * length * length / 12.0;
        return RigidBody(mass, {moment / 2, moment, moment}, {.com = {length / 2, 0, 0}});
    };
    const BodyHandle crank = scene.add(bar(1.0, 0.75), Revolute{.axis = z}, {.angle = 0.5, .rate = 9.0}),
                     coupler = scene.add(bar(2.0, 2.0), Revolute{.axis = z, .at = {0.75, 0, 0}},
                                         {.angle = 0.1, .parent = crank}),
                     rocker = scene.add(bar(1.5, 1.5), Revolute{.axis = z, .at = {2, 0, 0}}, {.angle = 1.4});
    const ConstraintHandle pin = scene.constrain(Ball{}, coupler.point({2, 0, 0}), rocker.point({1.5, 0, 0}));
    scene.assemble({crank});
    double widest = 0.0, energy = 0.0, turned = 0.0;
    std::int64_t done = 0;
    const double first = simulate(scene, {.until = 0x1p-10, .rtol = 1e-13}).energy(0.0);
    Trajectory run = simulate(scene, {.until = 4.0, .rtol = 1e-13, .keep = {.what = Keep::What::end}});
    for (int part = 1;; ++part) {
        done += run.statistics().steps;
        widest = std::max(widest, run[pin].gap(run.end()));
        energy = std::max(energy, std::abs(run.energy(run.end()) - first));
        turned = std::max(turned, std::abs(run[crank].angle(run.end())));
        if (done >= steps) break;
        run = simulate(run, {.until = 4.0 * (part + 1)});
    }
    if (std::getenv("RBDYN_TEST_TABLE") != nullptr)
        std::cout << done << " steps, " << turned << " rad: gap " << widest << ", energy off by " << energy << '\n';
    // an angle that has grown is rounded as a whole, at an arm of up to 2 m
    EXPECT_LE(widest, epsilon * (20.0 + 3.0 * turned));
}

}  // namespace
}  // namespace rbdyn::test::test_random_trees
