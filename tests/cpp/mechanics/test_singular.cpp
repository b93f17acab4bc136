// Constraints that lose rank, driven joints that cannot be followed, starts and numbers that are wrong: refused, told,
// or ended by name, and nothing carried through in silence.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "random.hpp"
#include "rbdyn/body/shapes.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"
#include "support.hpp"

namespace rbdyn::test {
namespace singular {

const Vector3 down{0, -9.81, 0}, z{0, 0, 1};
constexpr double pi = std::numbers::pi, not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A bar along its x axis, from its origin.
RigidBody bar(double mass, double length) {
    const double moment = mass * length * length / 12.0;
    return RigidBody(mass, {moment / 2, moment, moment}, {.com = {length / 2, 0, 0}});
}

void expect_refused(const Scene& scene, const std::string& why, double until = 1.0) {
    const std::string message = refusal([&] { simulate(scene, {.until = until}); });
    EXPECT_NE(message.find(why), std::string::npos) << message;
}

/// How a run of a scene ends that is broken off: its message and the run.
struct Ended {
    std::string message = "went on";
    double end = 0.0;
};
Ended ended(const Scene& scene, double until) {
    try {
        simulate(scene, {.until = until});
    } catch (const IntegrationError& error) {
        return {error.what(), error.run.end()};
    }
    return {};
}
void expect_ended(const Scene& scene, double until, const std::string& why, double at, double within) {
    const Ended e = ended(scene, until);
    EXPECT_NE(e.message.find(why), std::string::npos) << e.message;
    EXPECT_NEAR(e.end, at, within);
}

/// Two bars of length 1 on pivots 2 apart, joined by one of length 2.
struct Parallelogram {
    Scene scene;
    BodyHandle left, coupler, right;
    ConstraintHandle pin;

    Parallelogram(const Vector3& gravity, double angle, double rate) : scene(gravity) {
        left = scene.add(bar(1, 1), Revolute{.axis = z}, {.angle = angle, .rate = rate});
        coupler = scene.add(bar(1, 2), Revolute{.axis = z, .at = {1, 0, 0}},
                            {.angle = -angle, .rate = -rate, .parent = left});
        right = scene.add(bar(1, 1), Revolute{.axis = z, .at = {2, 0, 0}}, {.angle = angle, .rate = rate});
        pin = scene.constrain(Ball{}, coupler.point({2, 0, 0}), right.point({1, 0, 0}));
    }
};

// --- rank lost where a scene starts ---

TEST(Singular, a_particle_between_two_rods_in_one_line_is_refused) {
    Scene scene(down);
    const auto p = scene.add(Particle{1.0}, {.position = {1, 0, 0}});
    scene.constrain(Rod{1.0}, p, Vector3(0, 0, 0));
    scene.constrain(Rod{1.0}, p, Vector3(2, 0, 0));
    expect_refused(scene, "constraint 2: where the scene starts the constraints lose rank");
}

TEST(Singular, a_rod_that_touches_a_plane_is_refused) {
    Scene scene(down);
    const auto p = scene.add(Particle{1.0}, {.position = {1, 0, 0}});
    scene.constrain(Rod{1.0}, p, Vector3(0, 0, 0));
    scene.constrain(PointOnPlane{{{1, 0, 0}, {1, 0, 0}}}, p);
    expect_refused(scene, "lose rank");
}

TEST(Singular, a_parallelogram_that_starts_flat_is_refused_at_rest_and_moving) {
    for (const double rate : {0.0, 1.0}) expect_refused(Parallelogram(down, 0.0, rate).scene, "lose rank");
}

TEST(Singular, two_bars_in_one_line_pinned_at_both_ends_are_refused) {
    Scene scene(down);
    const auto first = scene.add(bar(1, 1), Revolute{.axis = z});
    const auto second = scene.add(bar(1, 1), Revolute{.axis = z, .at = {1, 0, 0}}, {.parent = first});
    scene.constrain(Ball{}, second.point({1, 0, 0}), Vector3(2, 0, 0));
    expect_refused(scene, "lose rank");
}

TEST(Singular, a_bead_held_by_a_rod_across_its_rail_is_refused) {
    Scene scene(down);
    const auto bead = scene.add(Particle{1.0}, Rail(Line{{0, 1, 0}}));
    scene.constrain(Rod{1.0}, bead, Vector3(1, 0, 0));
    expect_refused(scene, "lose rank");
}

TEST(Singular, what_is_redundant_for_good_goes_on_with_its_gaps_closed) {
    // a third bar halfway, and a rod beside it: two rows too many
    Parallelogram p(down, -1.5, 0.5);
    const auto middle = p.scene.add(bar(1, 1), Revolute{.axis = z, .at = {1, 0, 0}}, {.angle = -1.5, .rate = 0.5});
    const auto pin = p.scene.constrain(Ball{}, p.coupler.point({1, 0, 0}), middle.point({1, 0, 0}));
    const auto rod = p.scene.constrain(Rod{1.0}, p.coupler.point({0.5, 0, 0}), Vector3(0.5, 0, 0));
    const Trajectory run = simulate(p.scene, {.until = 1.0, .error = 1e-9});
    for (const double t : {0.25, 0.5, 0.75, 1.0})
        for (const auto c : {p.pin, pin, rod}) EXPECT_LE(run[c].gap(t), 1e-12);
    EXPECT_EQ(run.plan().freedom(), 1);
}

// --- rank lost while moving ---

TEST(Singular, a_parallelogram_tells_where_it_passes_through_flat) {
    // without gravity all turn at the rate they have: angle 1 + t
    const Parallelogram p(Vector3::Zero(), 1.0, 1.0);
    const Trajectory run = simulate(p.scene, {.until = 5.0, .error = 1e-6});
    const auto times = run.events().times("singular");
    ASSERT_EQ(times.size(), 1u);
    EXPECT_NEAR(times[0], pi - 1.0, 1e-6 * (pi - 1.0));
    EXPECT_EQ(run.events()[0].name, "constraint 1");
    for (const double t : {1.0, 2.0, 3.0, 5.0}) EXPECT_NEAR(run[p.right].angle(t), 1.0 + t, 1e-6 * 5.0);
}

TEST(Singular, no_digits_are_lost_beyond_flat) {
    const Parallelogram p(Vector3::Zero(), 1.0, 1.0);
    for (const double error : {1e-9, 1e-12}) {
        const Trajectory run = simulate(p.scene, {.until = 20.0, .error = error});
        EXPECT_EQ(run.events().times("singular").size(), 6u);
        for (const double t : {1.0, 2.0, 3.0, 5.0, 20.0}) EXPECT_NEAR(run[p.right].angle(t), 1.0 + t, error * 21.0);
    }
    // and with steps of any length
    for (const double rtol : {1e-12, 1e-14})
        EXPECT_NEAR(simulate(p.scene, {.until = 20.0, .rtol = rtol})[p.right].angle(20.0), 21.0, 1e-11);
}

/// A parallelogram under gravity moves as a pendulum: held to that, from anywhere, with bars of any size.
TEST(Singular, parallelograms_of_any_size_swing_through_flat_as_a_pendulum_does) {
    const bool table = std::getenv("RBDYN_TEST_TABLE") != nullptr;
    double worst = 0.0, most = 0.0;
    int refused = 0, count = 0;
    for (int seed = 0; seed < setting("RBDYN_TEST_SINGULAR", 12); ++seed)
        for (const double error : {1e-6, 1e-9, 1e-12}) {
            Random random(static_cast<std::uint64_t>(300 + seed));
            const double length = random.uniform(0.5, 1.5), width = random.uniform(0.5, 2.5),
                         angle = random.uniform(-2.5, -0.5), rate = random.uniform(4.0, 9.0),
                         mass[] = {random.uniform(0.5, 2.0), random.uniform(0.5, 2.0), random.uniform(0.5, 2.0)};
            const double x = random.chance(0.5) ? 0.0 : random.uniform(-1.0, 1.0);
            Scene scene(down), one(down);
            const auto left = scene.add(bar(mass[0], length), Revolute{.axis = z, .at = {x, 0, 0}},
                                        {.angle = angle, .rate = rate}),
                       top = scene.add(bar(mass[1], width), Revolute{.axis = z, .at = {length, 0, 0}},
                                       {.angle = -angle, .rate = -rate, .parent = left}),
                       right = scene.add(bar(mass[2], length), Revolute{.axis = z, .at = {x + width, 0, 0}},
                                         {.angle = angle, .rate = rate});
            scene.constrain(Ball{}, top.point({width, 0, 0}), right.point({length, 0, 0}));
            // the coupler as a mass at the end of a bar
            const double moment = (mass[0] + mass[2]) * length * length / 3.0 + mass[1] * length * length,
                         whole = mass[0] + mass[1] + mass[2], arm = (0.5 * (mass[0] + mass[2]) + mass[1]) / whole,
                         own = moment - whole * std::pow(arm * length, 2);
            const auto same = one.add(RigidBody(whole, {0.5 * own, own, own}, {.com = {arm * length, 0, 0}}),
                                      Revolute{.axis = z}, {.angle = angle, .rate = rate});
            const Trajectory truth = simulate(one, {.until = 4.0, .error = 1e-14});
            ++count;
            SCOPED_TRACE("seed " + std::to_string(300 + seed) + " error " + std::to_string(error));
            try {
                const Trajectory run = simulate(scene, {.until = 4.0, .error = error});
                double off = 0.0;
                for (int k = 0; k <= 40; ++k)
                    for (const auto body : {left, right})
                        off = std::max(off, std::abs(run[body].angle(0.1 * k) - truth[same].angle(0.1 * k)));
                const double turned = std::abs(truth[same].angle(4.0)) + pi;
                worst = std::max(worst, off / turned / error);
                most = std::max(most, off / turned / *run.error());
                EXPECT_LE(off, error * turned);
            } catch (const std::exception& e) {
                ++refused;
                if (table) std::cout << "seed " << 300 + seed << " error " << error << ": " << e.what() << "\n";
            }
        }
    if (table)
        std::cout << count << " parallelograms, " << refused << " refused: of what was asked " << worst
                  << ", of what is told " << most << "\n";
    EXPECT_EQ(refused, 0);
}

/// Bars that differ by a millionth do not pass through flat as a parallelogram: they fold the other way.
TEST(Singular, what_is_nearly_a_parallelogram_turns_into_the_other_linkage_or_is_refused) {
    const auto nearly = [](double more) {
        Scene scene;
        const auto left = scene.add(bar(1, 1), Revolute{.axis = z}, {.angle = 1.0, .rate = 1.0}),
                   top = scene.add(bar(1, 2), Revolute{.axis = z, .at = {1, 0, 0}},
                                   {.angle = -1.0, .rate = -1.0, .parent = left}),
                   right =
                       scene.add(bar(1, 1.0 + more), Revolute{.axis = z, .at = {2, 0, 0}}, {.angle = 1.0, .rate = 1.0});
        scene.constrain(Ball{}, top.point({2, 0, 0}), right.point({1.0 + more, 0, 0}));
        scene.assemble({left});
        return std::tuple(scene, left, right);
    };
    for (const double more : {1e-6, -1e-6}) {
        const auto [scene, left, right] = nearly(more);
        double last = 0.0;
        for (const double error : {1e-6, 1e-9}) {
            const Trajectory run = simulate(scene, {.until = 4.0, .error = error});
            const double apart = run[right].angle(4.0) - run[left].angle(4.0);
            EXPECT_GT(std::abs(apart), 3.0);
            EXPECT_NEAR(apart, last == 0.0 ? apart : last, 1e-5);
            last = apart;
        }
    }
    // told as that, or refused where two runs do not agree on it: never as the parallelogram it is not
    int told = 0;
    for (const double more : {1e-8, 1e-10, -1e-10, 1e-12}) {
        const auto [scene, left, right] = nearly(more);
        try {
            const Trajectory run = simulate(scene, {.until = 4.0, .error = 1e-6});
            // of bars that are alike angles a and b of the other linkage have tan(a/2) = -3 tan(b/2) beyond pi, of
            // (2 + 1) / (2 - 1); of the parallelogram they are the same
            const double a = std::tan(0.5 * run[left].angle(4.0)), b = std::tan(0.5 * run[right].angle(4.0));
            EXPECT_LE(std::min(std::abs(a / b + 3.0), std::abs(b / a + 3.0)), 1e-3) << more << " " << a / b;
            ++told;
        } catch (const AccuracyError&) {
        }
    }
    EXPECT_GT(told, 0);
}

TEST(Singular, steps_that_creep_up_to_it_end_there_by_name) {
    // the smaller the steps the nearer to flat one begins: there the branch is anyone's guess
    const Parallelogram p(Vector3::Zero(), 1.0, 1.0);
    try {
        simulate(p.scene, {.until = 5.0, .rtol = 1e-12, .engine = "dop853"});
        ADD_FAILURE() << "went on";
    } catch (const IntegrationError& error) {
        EXPECT_NE(std::string(error.what()).find("constraints lose rank there"), std::string::npos) << error.what();
        EXPECT_NEAR(error.run.end(), pi - 1.0, 1e-3);
        EXPECT_NEAR(error.run[p.right].angle(2.0), 3.0, 1e-12);
    }
}

TEST(Singular, is_told_with_steps_of_any_length_and_every_engine) {
    const Parallelogram p(Vector3::Zero(), 1.0, 1.0);
    for (const char* engine : {"taylor", "dop853"})
        for (const double rtol : {1e-3, 1e-6, 1e-9}) {
            const Trajectory run = simulate(p.scene, {.until = 5.0, .rtol = rtol, .engine = engine});
            ASSERT_EQ(run.events().size(), 1u) << engine << rtol;
            EXPECT_EQ(run.events()[0].kind, EventKind::singular);
            EXPECT_NEAR(run.events()[0].time, pi - 1.0, 100.0 * rtol);
        }
}

TEST(Singular, what_turns_far_from_flat_tells_nothing) {
    const Parallelogram p(down, -1.5, 0.5);
    const Trajectory run = simulate(p.scene, {.until = 3.0});
    EXPECT_EQ(run.events().size(), 0u);
    EXPECT_LE(run[p.pin].gap(3.0), 1e-12);
}

// --- driven joints against constraints ---

TEST(Driven, what_a_drive_pulls_from_its_constraint_at_once_is_refused) {
    Scene scene;
    const auto h = scene.add(bar(1, 1), Revolute{.axis = z, .motion = TimeFunction([](const auto& t) { return t; })});
    scene.constrain(Ball{}, h.point({1, 0, 0}));
    expect_refused(scene, "constraint 1: rate of its gap is 1", 0.1);
    Scene two;
    const auto a = two.add(bar(1, 1), Revolute{.axis = z, .motion = TimeFunction([](const auto& t) { return t; })});
    const auto b =
        two.add(bar(1, 1), Revolute{.axis = z, .motion = TimeFunction([](const auto& t) { return pi / 3 + 2.0 * t; })});
    two.constrain(Rod{1.0}, a.point({1, 0, 0}), b.point({1, 0, 0}));
    expect_refused(two, "constraint 1: rate of its gap is");
}

TEST(Driven, what_a_drive_pulls_from_its_constraint_later_ends_where_that_opens) {
    Scene scene;
    const auto h = scene.add(bar(1, 1), Revolute{.axis = z, .motion = TimeFunction([](const auto& t) { return t; })});
    const auto k = scene.add(bar(1, 1), Revolute{.axis = z, .at = {3, 0, 0}}, {.rate = -0.5});
    scene.constrain(Ball{}, h.point({1, 0, 0}), k.point({-2, 0, 0}));
    expect_ended(scene, 1.0, "constraint 1 opens", 0.0, 1e-3);
    // both turn alike until one stays behind: by cubes of what is beyond 0.5
    Scene two;
    const auto rate = [](double more) {
        return TimeFunction([more](const auto& t) {
            const auto late = 0.5 * (t - 0.5 + sqrt((t - 0.5) * (t - 0.5)));
            return t + more * late * late * late;
        });
    };
    const auto a = two.add(bar(1, 1), Revolute{.axis = z, .motion = rate(0.0)});
    const auto b = two.add(bar(1, 1), Revolute{.axis = z, .motion = rate(1.0)});
    two.constrain(Rod{0.5}, a.point({1, 0, 0}), b.point({0.5, 0, 0}));
    const Ended e = ended(two, 1.0);
    EXPECT_NE(e.message.find("constraint 1 opens"), std::string::npos) << e.message;
    // the rod is 0.5 long at 1.25 - cos(more) of its square, and has opened at 1e-9 of the scene's size, 1
    const double more = 2.0 * std::asin(std::sqrt(0.5e-9 + 0.5e-18));
    EXPECT_NEAR(e.end, 0.5 + std::cbrt(more), 1e-8);
}

TEST(Driven, drives_that_agree_with_a_constraint_go_on) {
    Scene scene;
    const auto turn = [](const auto& t) { return sin(t); };
    const auto a = scene.add(bar(1, 1), Revolute{.axis = z, .motion = TimeFunction(turn)});
    const auto b = scene.add(bar(1, 1), Revolute{.axis = z, .at = {2, 0, 0}, .motion = TimeFunction(turn)});
    const auto rod = scene.constrain(Rod{2.0}, a.point({1, 0, 0}), b.point({1, 0, 0}));
    const Trajectory run = simulate(scene, {.until = 3.0});
    EXPECT_LE(run[rod].gap(2.0), 1e-14);
    EXPECT_EQ(run.end(), 3.0);
}

TEST(Driven, a_linkage_ends_where_its_drive_locks_it) {
    // the crank of 1 would pull a coupler of 1 and a rocker of 1.2 straight: beyond, there is no motion
    Scene scene;
    const auto crank =
        scene.add(bar(1, 1), Revolute{.axis = z, .motion = TimeFunction([](const auto& t) { return 1.0 + t; })});
    const auto coupler = scene.add(bar(1, 1), Revolute{.axis = z, .at = {1, 0, 0}}, {.angle = -0.9, .parent = crank});
    const auto rocker = scene.add(bar(1, 1.2), Revolute{.axis = z, .at = {2.4, 0, 0}}, {.angle = 2.2});
    scene.constrain(Ball{}, coupler.point({1, 0, 0}), rocker.point({1.2, 0, 0}));
    scene.assemble();
    // (cos a - 2.4)^2 + sin^2 a = 2.2^2
    const double at = std::acos((1.0 + 2.4 * 2.4 - 2.2 * 2.2) / 4.8) - 1.0;
    expect_ended(scene, 3.0, "constraint 1", at, 1e-6);
}

// --- motions that are no motions ---

template <class F>
Scene driven_by(F f, bool carries) {
    Scene scene;
    const auto h = scene.add(bar(1, 1), Revolute{.axis = z, .motion = TimeFunction(f)});
    if (carries) scene.add(bar(1, 1), Revolute{.axis = z, .at = {1, 0, 0}}, {.parent = h});
    return scene;
}

TEST(Driven, a_motion_that_jumps_or_has_a_corner_ends_there) {
    for (const bool carries : {true, false}) {
        expect_ended(driven_by([](const auto& t) { return abs(t - 0.5); }, carries), 1.0,
                     "the rate of the driven joint of body 1 jumps from -1 to 1 rad/s", 0.5, 1e-15);
        expect_ended(driven_by([](const auto& t) { return locked_sign(t - 0.5) * t; }, carries), 1.0,
                     "the coordinate of the driven joint of body 1 jumps from -0.5 to 0.5 rad", 0.5, 1e-15);
        expect_ended(driven_by([](const auto& t) { return floor(3.0 * t); }, carries), 1.0, "jumps from 0 to 1 rad",
                     1.0 / 3.0, 1e-15);
    }
}

TEST(Driven, a_motion_whose_rate_has_a_corner_goes_on) {
    for (const bool carries : {true, false})
        EXPECT_EQ(simulate(driven_by([](const auto& t) { return (t - 0.5) * abs(t - 0.5); }, carries), {.until = 1.0})
                      .status(),
                  Status::reached_end);
}

TEST(Driven, a_motion_that_is_no_number_is_refused_or_ends_where_it_becomes_none) {
    for (const bool carries : {true, false}) {
        expect_refused(driven_by([](const auto& t) { return log(t - 0.5); }, carries),
                       "body 1: the motion of its joint, or a rate of it, is nan at t = 0 s");
        expect_ended(driven_by([](const auto& t) { return sqrt(0.5 - t); }, carries), 1.0, "the motion of the joint of",
                     0.5, 1e-6);
    }
}

TEST(Driven, a_driven_joint_takes_no_start) {
    Scene scene;
    const Revolute joint{.axis = z, .motion = TimeFunction([](const auto& t) { return t; })};
    EXPECT_NE(refusal([&] { scene.add(bar(1, 1), joint, {.angle = 1.0}); }).find("angle is 1"), std::string::npos);
    EXPECT_NE(refusal([&] { scene.add(bar(1, 1), joint, {.rate = 77.0}); }).find("rate is 77"), std::string::npos);
}

// --- starts and numbers ---

TEST(Starts, velocities_that_violate_constraints_are_refused_with_their_size) {
    Scene scene;
    const auto p = scene.add(Particle{1.0}, {.position = {1, 0, 0}, .velocity = {5, 1, 0}});
    scene.constrain(PointOnPlane{{{1, 0, 0}, {1, 0, 0}}}, p);
    expect_refused(scene, "constraint 1: rate of its gap is 5");
    Scene near;
    const auto q = near.add(Particle{1.0}, {.position = {1, 0, 0}, .velocity = {1e-7, 1, 0}});
    near.constrain(PointOnPlane{{{1, 0, 0}, {1, 0, 0}}}, q);
    EXPECT_EQ(simulate(near, {.until = 1.0})[q].velocity(0.0)[0], 0.0);
}

TEST(Starts, forces_that_are_zero_but_for_rounding_are_no_reason_to_refuse) {
    const Parallelogram p(Vector3::Zero(), 1.0, 1.0);
    const Trajectory run = simulate(p.scene, {.until = 0.5, .error = 1e-11});
    EXPECT_NEAR(run[p.left].angle(0.5), 1.5, 1e-11);
}

TEST(Starts, a_rod_that_turns_about_its_own_line_carries_a_box) {
    Scene scene;
    const auto stick = scene.add(shapes::rod(1.0, 1.0, z), Revolute{.axis = z}, {.rate = 2.0}, "stick");
    EXPECT_NE(refusal([&] { simulate(scene, {.until = 1.0}); }).find("stick: moment of inertia about its axis is 0"),
              std::string::npos);
    scene.add(shapes::box(1.0, {1, 1, 1}), Fixed{}, {.parent = stick});
    EXPECT_NEAR(simulate(scene, {.until = 1.0})[stick].angle(1.0), 2.0, 1e-12);
}

TEST(Starts, what_lacks_inertia_is_named_also_where_others_carry_it) {
    Scene scene;
    const auto first = scene.add(bar(1, 1), Revolute{.axis = z}, {}, "first");
    scene.add(shapes::rod(1.0, 1.0, {1, 0, 0}), Cylindrical{.axis = {1, 0, 0}, .at = {1, 0, 0}}, {.parent = first},
              "stick");
    expect_refused(scene, "stick: inertia along velocity 1 of 2 of its joint is 0");
}

TEST(Numbers, a_joint_load_that_is_no_number_is_refused) {
    Scene scene;
    const auto h = scene.add(bar(1, 1), Revolute{.axis = z});
    const auto s = scene.add(bar(1, 1), Prismatic{.axis = z});
    for (const double x : {not_a_number, std::numeric_limits<double>::infinity()}) {
        EXPECT_NE(refusal([&] { scene.apply(JointTorque(x), h); }).find("JointTorque: its number is"),
                  std::string::npos);
        EXPECT_NE(refusal([&] { scene.apply(JointForce(x), s); }).find("JointForce: its number is"), std::string::npos);
    }
}

TEST(Numbers, constants_that_are_no_numbers_are_one_node_each) {
    Recorder r;
    const Expression a(not_a_number);
    EXPECT_EQ(r.node_of(a), r.node_of(a));
    EXPECT_EQ(r.node_of(a), r.node_of(Expression(not_a_number)));
    const Expression x = r.input(0);
    const std::vector<Expression> outputs{a, x + a, a};
    const Program program(r, outputs, 1);
    Evaluator<double> values(program);
    values(0.0, std::vector<double>{1.0});
    EXPECT_TRUE(std::isnan(values.output(0)) && std::isnan(values.output(1)));
}

}  // namespace singular
}  // namespace rbdyn::test
