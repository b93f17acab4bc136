// Motion that is stiff, and what is taken for it by nobody: when "auto" leaves Taylor series for BDF.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <rbdyn/rbdyn.hpp>
#include <rbdyn/trajectory/run_bytes.hpp>
#include <string>
#include <vector>

namespace test_stiff {

using namespace rbdyn;

struct Case {
    Scene scene;
    double until;
};
const Vector3 down{0.0, 0.0, -9.81};

/// A mass on a spring that moves through something thick: the rate 1e4/s of its drag beside 0.1/s of what it does.
Case creeping(double drag = 1e4) {
    Scene scene(down);
    const BodyHandle mass = scene.add(Particle{.mass = 1.0}, {.position = {1, 0, 0}, .velocity = {0, 0.5, 0}});
    scene.connect(Spring{.stiffness = 1e3, .rest_length = 0.5}, mass, Vector3(0, 0, 0));
    scene.apply(Drag{.linear = drag}, mass);
    return {scene, 20.0};
}

/// Two rods whose hinge is stiff and damped: a rate of 1e5/s.
Case stiff_hinge() {
    Scene scene(down);
    const RigidBody rod = shapes::rod(1.0, 1.0, {0, 0, 1});
    const BodyHandle upper = scene.add(rod, Revolute{.axis = {0, 1, 0}, .point = {0, 0, 0.5}}, {.angle = 1.0});
    const BodyHandle lower =
        scene.add(rod, Revolute{.axis = {0, 1, 0}, .at = {0, 0, -0.5}, .point = {0, 0, 0.5}}, {.parent = upper});
    scene.apply(TorsionSpring{.stiffness = 1e4, .damping = 1e3}, lower);
    return {scene, 10.0};
}

/// Drag that fades: stiff for the first seconds.
Case fading() {
    Scene scene(down);
    const BodyHandle mass = scene.add(Particle{.mass = 1.0}, {.position = {1, 0, 0}, .velocity = {0, 0.5, 0}});
    scene.connect(Spring{.stiffness = 1e3, .rest_length = 0.5}, mass, Vector3(0, 0, 0));
    scene.apply(Force([](const auto& t, const auto&, const auto& v) { return v * (-1e4 * exp(-t)); }), mass);
    return {scene, 20.0};
}

/// A stiff spring that nothing damps: fast, and not stiff.
Case ringing() {
    Scene scene(down);
    const BodyHandle mass = scene.add(Particle{.mass = 1.0}, {.position = {1, 0, 0}, .velocity = {0, 0.5, 0}});
    scene.connect(Spring{.stiffness = 1e6, .rest_length = 1.0}, mass, Vector3(0, 0, 0));
    return {scene, 10.0};
}

/// A thousand turns of a heavy body.
Case spinning() {
    Scene scene(down);
    const RigidBody body(0.5, {0.0022, 0.0019, 0.001},
                         {.com = {0.01, 0.005, 0.05}, .inertia_about = InertiaAbout::origin});
    scene.add(body, Spherical{}, {.attitude = EulerAngles{0.3, 0.0, 0.0}, .angular_velocity = Vector3(0, 0, 300)});
    return {scene, 20.0};
}

/// Without SUNDIALS nothing gives way.
class Stiff : public testing::Test {
    void SetUp() override {
        const std::vector<std::string> names = engines();
        if (std::find(names.begin(), names.end(), "cvode-bdf") == names.end()) GTEST_SKIP() << "without SUNDIALS";
    }
};

double apart(const Trajectory& a, const Trajectory& b) {
    double largest = 0.0;
    for (int i = 0; i < static_cast<int>(a.scene().bodies().size()); ++i)
        for (int k = 0; k <= 40; ++k) {
            const double t = a.end() * k / 40.0;
            largest = std::max(largest, (a[BodyHandle{i}].position(t) - b[BodyHandle{i}].position(t)).norm());
        }
    return largest;
}

TEST_F(Stiff, motion_is_left_to_bdf_and_as_accurate_as_asked_for) {
    for (const auto& [scene, until] : {creeping(), stiff_hinge()}) {
        const Trajectory exact = simulate(scene, {.until = until, .rtol = 1e-15, .engine = "taylor"});
        for (const double error : {1e-3, 1e-6, 1e-9}) {
            const Trajectory run = simulate(scene, {.until = until, .error = error});
            EXPECT_EQ(run.engine(), "taylor, cvode-bdf");
            ASSERT_EQ(run.statistics().changes.size(), 1);
            EXPECT_EQ(run.statistics().changes[0].engine, "cvode-bdf");
            // a third of the steps of the series at the same error
            EXPECT_LT(3 * run.statistics().steps,
                      simulate(scene, {.until = until, .rtol = 1e-3 * error, .engine = "taylor"}).statistics().steps);
            // places move by less than 2 m
            EXPECT_LE(apart(run, exact), 2.0 * error);
            EXPECT_LE(*run.error(), error);
        }
    }
}

TEST_F(Stiff, motion_is_none_where_an_engine_is_named_or_more_is_asked_for_than_bdf_has) {
    const auto [scene, until] = creeping();
    EXPECT_TRUE(simulate(scene, {.until = until, .rtol = 1e-6, .engine = "taylor"}).statistics().changes.empty());
    EXPECT_TRUE(simulate(scene, {.until = until, .rtol = 1e-13}).statistics().changes.empty());
    EXPECT_FALSE(simulate(scene, {.until = until, .rtol = 1e-12}).statistics().changes.empty());
}

TEST_F(Stiff, is_nothing_that_turns_or_rings_fast_and_such_motion_keeps_every_bit) {
    for (const auto& [scene, until] : {ringing(), spinning(), creeping(20.0)})
        for (const double rtol : {1e-3, 1e-6, 1e-9, 1e-12}) {
            const Trajectory run = simulate(scene, {.until = until, .rtol = rtol}),
                             same = simulate(scene, {.until = until, .rtol = rtol, .engine = "taylor"});
            EXPECT_TRUE(run.statistics().changes.empty());
            EXPECT_EQ(run.t(), same.t());
            EXPECT_EQ(apart(run, same), 0.0);
        }
}

TEST_F(Stiff, motion_goes_back_to_series_where_it_is_so_no_longer) {
    const auto [scene, until] = fading();
    const Trajectory exact = simulate(scene, {.until = until, .rtol = 1e-15, .engine = "taylor"});
    for (const double error : {1e-3, 1e-6}) {
        const Trajectory run = simulate(scene, {.until = until, .error = error});
        // where it is hardly stiff any more it may go back once too early
        const auto& changes = run.statistics().changes;
        ASSERT_TRUE(changes.size() == 2 || changes.size() == 4);
        EXPECT_EQ(changes.back().engine, "taylor");
        for (std::size_t k = 1; k < changes.size(); ++k) EXPECT_LT(changes[k - 1].time, changes[k].time);
        EXPECT_LE(apart(run, exact), 2.0 * error);
    }
}

TEST_F(Stiff, motion_has_its_events_where_the_series_have_them) {
    auto [scene, until] = creeping();
    scene.watch("near", [](const Now& now) { return now[BodyHandle{0}].position()[0] - 0.7; });
    const auto times = [&scene = scene, until = until](const SimulateOptions& options) {
        SimulateOptions all = options;
        all.until = until;
        return simulate(scene, all).events().times("near");
    };
    const std::vector<double> exact = times({.rtol = 1e-15, .engine = "taylor"});
    ASSERT_EQ(exact.size(), 1);
    for (const double error : {1e-3, 1e-6, 1e-9}) {
        const std::vector<double> found = times({.error = error});
        ASSERT_EQ(found.size(), 1);
        EXPECT_NEAR(found[0], exact[0], error * exact[0]);
    }
}

TEST_F(Stiff, motion_goes_on_with_bdf_and_its_changes_are_kept_with_the_run) {
    const auto [scene, until] = stiff_hinge();
    const Trajectory half = simulate(scene, {.until = 0.5 * until, .error = 1e-5});
    const Trajectory rest = simulate(half, {.until = until});
    ASSERT_EQ(rest.statistics().changes.size(), 1);
    EXPECT_LT(rest.statistics().changes[0].time, 0.5 * until + 0.01);
    const Trajectory whole = simulate(scene, {.until = until, .rtol = 1e-15, .engine = "taylor"});
    EXPECT_LE((rest[BodyHandle{1}].position(until) - whole[BodyHandle{1}].position(until)).norm(), 2e-5);
    const Trajectory back(run_from(half.scene(), bytes_of(*half.data())));
    EXPECT_EQ(back.statistics().changes, half.statistics().changes);
    EXPECT_EQ(back.engine(), half.engine());
    EXPECT_EQ(simulate(back, {.until = until}).t(), rest.t());
}

TEST_F(Stiff, systems_of_ones_own_are_left_to_bdf_too) {
    // Van der Pol's oscillator, relaxing
    System slow(
        [](const auto&, auto x, auto rate) {
            rate[0] = x[1];
            rate[1] = 1e3 * ((1.0 - x[0] * x[0]) * x[1]) - x[0];
        },
        {2.0, 0.0});
    const SystemRun run = simulate(slow, {.until = 500.0, .error = 1e-4}),
                    exact = simulate(slow, {.until = 500.0, .rtol = 1e-15, .engine = "taylor"});
    EXPECT_FALSE(run.statistics().changes.empty());
    EXPECT_LT(30 * run.statistics().steps, exact.statistics().steps);
    EXPECT_NEAR(run.x(500.0)[0], exact.x(500.0)[0], 2e-4);
}

}  // namespace test_stiff
