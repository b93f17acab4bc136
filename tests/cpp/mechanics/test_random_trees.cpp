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
    bool is_unique = true;
};

Difference difference(const Maximal& truth, const Trajectory& run, bool is_tree) {
    const auto now = truth.seen(run);
    const auto right = truth.solve(now);
    Difference d;
    d.is_unique = right.is_unique;
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
Trajectory begin(const Scene& scene) { return simulate(scene, {.until = 0x1p-20, .rtol = 1e-6}); }

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
        EXPECT_NO_THROW(run = begin(truth.scene));
        if (!run) continue;
        const Difference d = difference(truth, *run, false);
        ++(d.is_unique ? unique : other);
        EXPECT_LE(d.motion, 1e-10);
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

}  // namespace
}  // namespace rbdyn::test::test_random_trees
