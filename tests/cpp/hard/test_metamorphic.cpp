// Checks that need no answer: the same motion told differently is the same motion.
#include <gtest/gtest.h>

#include <functional>

#include "support.hpp"

namespace rbdyn::test::test_metamorphic {
namespace {

/// Lengths, times and masses of a telling, and how its world is turned.
struct Telling {
    double m = 1.0, s = 1.0, kg = 1.0;
    Matrix3 turn = Matrix3::Identity();
    bool mirrored = false;  // the curve's parameter runs the other way

    Vector3 place(double x, double y, double z) const { return turn * Vector3(x * m, y * m, z * m); }
    Vector3 axis(double x, double y, double z) const { return turn * Vector3(x, y, z); }
    Vector3 field(double x, double y, double z) const { return place(x, y, z) / (s * s); }
    double speed(double v) const { return (mirrored ? -v : v) * m / s; }
    double sense() const { return mirrored ? -1.0 : 1.0; }
    double stiffness(double k) const { return k * kg / (s * s); }
};

struct Motion {
    std::string name;
    std::function<Scene(const Telling&)> tell;
    double until;
    bool is_u_a_length;
};

/// Beads with most of the effects, and a good number of events.
std::vector<Motion> motions() {
    std::vector<Motion> all;
    all.push_back({"circle",
                   [](const Telling& w) {
                       Scene scene(w.field(0, 0, -gravity));
                       const Circle c{.radius = w.m, .start = w.axis(0, 0, -1), .toward = w.axis(w.sense(), 0, 0)};
                       scene.add(Particle{0.75 * w.kg}, Rail(c, Coulomb{0.25, 0.125}), {.parameter = w.sense() * 2.5});
                       return scene;
                   },
                   6.0, false});
    all.push_back({"belt",
                   [](const Telling& w) {
                       Scene scene(w.field(0, 0, -gravity));
                       const Line line{.direction = w.axis(w.sense(), 0, 0)};
                       const BodyHandle b =
                           scene.add(Particle{w.kg}, Rail(line, Coulomb{0.5, 0.25}, {.drive = w.speed(0.25)}),
                                     {.parameter = w.sense() * 0.125 * w.m, .speed = w.speed(2.0)});
                       scene.connect(Spring{.stiffness = w.stiffness(16.0)}, b, Vector3(w.place(0, 0, 0)));
                       return scene;
                   },
                   11.0, true});
    all.push_back(
        {"helix with spring and drag",
         [](const Telling& w) {
             Scene scene(w.field(0.5, 0.25, -gravity));
             // mirrored: the same helix, climbed the other way
             const Helix h{
                 .radius = 0.5 * w.m, .pitch = 0.75 * w.m, .start = w.axis(1, 0, 0), .toward = w.axis(0, w.sense(), 0)};
             const BodyHandle b = scene.add(Particle{2.0 * w.kg}, Rail(h, Coulomb{0.375, 0.25}),
                                            {.parameter = w.sense() * 0.25, .speed = w.speed(4.0)});
             scene.connect(Spring{.stiffness = w.stiffness(30.0), .rest_length = 0.5 * w.m}, b,
                           Vector3(w.place(0.25, 0.5, 0.75)));
             scene.apply(Drag{.linear = 0.0625 * w.kg / w.s, .quadratic = 0.125 * w.kg / w.m}, b);
             return scene;
         },
         8.0, false});
    all.push_back({"bend in space",
                   [](const Telling& w) {
                       Scene scene(w.field(0, 0, -gravity));
                       const double o = w.sense();
                       const Polynomial p{.coefficients = {w.place(0, 0, 0), w.place(o, 0, 0), w.place(0, 0, 0.75),
                                                           w.place(0, 0.25 * o, 0), w.place(0, 0, 0.125)}};
                       scene.add(Particle{w.kg}, Rail(p, Coulomb{0.1875, 0.125}),
                                 {.parameter = -1.25 * o, .speed = w.speed(1.0)});
                       return scene;
                   },
                   10.0, false});
    return all;
}

void expect_same_events(const Trajectory& a, const Trajectory& b, double seconds, double tolerance,
                        const std::string& what) {
    ASSERT_EQ(kinds(a), kinds(b)) << what;
    for (std::size_t k = 0; k < a.events().size(); ++k)
        EXPECT_NEAR(a.events()[k].time * seconds, b.events()[k].time, tolerance * b.events()[k].time)
            << what << ", event " << k;
}

TEST(Metamorphic, motion_does_not_know_how_the_world_is_turned) {
    Random random(7);
    for (const Motion& motion : motions()) {
        const SimulateOptions options{.until = motion.until, .error = 2e-13};
        const Trajectory upright = simulate(motion.tell({}), options);
        ASSERT_GE(upright.events().size(), 2u) << motion.name;
        for (int k = 0; k < 5; ++k) {
            const Matrix3 turn = Eigen::AngleAxisd(random.uniform(0.1, 3.0), random.direction()).toRotationMatrix();
            const Trajectory turned = simulate(motion.tell({.turn = turn}), options);
            expect_same_events(upright, turned, 1.0, 1e-12, motion.name);
            const Scales scale = scales(upright, {0});
            const double t = 0.75 * motion.until;
            const PointReport p = upright[BodyHandle{0}].report(t), q = turned[BodyHandle{0}].report(t);
            EXPECT_LE((turn * p.position - q.position).norm(), 1e-12 * scale.extent) << motion.name;
            EXPECT_LE((turn * p.velocity - q.velocity).norm(), 1e-12 * scale.speed) << motion.name;
            EXPECT_LE((turn * p.reaction - q.reaction).norm(), 1e-12 * scale.reaction) << motion.name;
        }
    }
}

TEST(Metamorphic, motion_does_not_know_its_units) {
    const int powers[][3] = {{1, 0, 0},  {0, 1, 0},   {0, 0, 1},  {30, 0, 0},  {-30, 0, 0},
                             {0, 30, 0}, {0, -30, 0}, {0, 0, 30}, {0, 0, -30}, {10, -7, 13}};
    for (const Motion& motion : motions()) {
        const Trajectory in_si = simulate(motion.tell({}), {.until = motion.until, .error = 1e-10});
        for (const auto& [metre, second, kilogram] : powers) {
            const Telling units{
                .m = std::ldexp(1.0, metre), .s = std::ldexp(1.0, second), .kg = std::ldexp(1.0, kilogram)};
            const Trajectory run = simulate(motion.tell(units), {.until = motion.until * units.s, .error = 1e-10});
            const std::string what = motion.name + " 2^" + std::to_string(metre) + " m, 2^" + std::to_string(second) +
                                     " s, 2^" + std::to_string(kilogram) + " kg";
            ASSERT_EQ(kinds(run), kinds(in_si)) << what;
            EXPECT_EQ(run.error(), in_si.error()) << what;
            EXPECT_EQ(run.statistics().steps, in_si.statistics().steps) << what;
            for (std::size_t k = 0; k < run.events().size(); ++k)
                EXPECT_EQ(run.events()[k].time, in_si.events()[k].time * units.s) << what << ", event " << k;
            for (double t : {0.3, 0.5, 0.9}) {
                const PointReport a = run[BodyHandle{0}].report(t * motion.until * units.s);
                const PointReport b = in_si[BodyHandle{0}].report(t * motion.until);
                EXPECT_EQ(a.u, motion.is_u_a_length ? b.u * units.m : b.u) << what;
                EXPECT_EQ(a.position, Vector3(b.position * units.m)) << what;
                EXPECT_EQ(a.velocity, Vector3(b.velocity * (units.m / units.s))) << what;
                EXPECT_EQ(a.reaction, Vector3(b.reaction * (units.kg * units.m / units.s / units.s))) << what;
            }
        }
    }
}

TEST(Metamorphic, motion_does_not_know_which_way_the_parameter_of_its_curve_runs) {
    for (const Motion& motion : motions()) {
        if (motion.name.starts_with("helix")) continue;  // its mirror image is another curve
        const SimulateOptions options{.until = motion.until, .error = 2e-13};
        const Trajectory one = simulate(motion.tell({}), options),
                         other = simulate(motion.tell({.mirrored = true}), options);
        expect_same_events(one, other, 1.0, 1e-12, motion.name);
        for (std::size_t k = 0; k < one.events().size(); ++k) {
            if (one.events()[k].kind == EventKind::normal_zero) continue;
            EXPECT_NE(one.events()[k].direction, other.events()[k].direction) << motion.name << k;
        }
        const double t = 0.7 * motion.until;
        const Scales scale = scales(one, {0});
        EXPECT_LE((one[BodyHandle{0}].position(t) - other[BodyHandle{0}].position(t)).norm(), 1e-12 * scale.extent)
            << motion.name;
    }
}

TEST(Metamorphic, independent_beads_do_not_know_of_each_other_nor_of_their_order) {
    const auto circle = [](Scene& scene) {
        return scene.add(Particle{1.0}, Rail(vertical_circle(1.0), Coulomb{0.25, 0.125}), {.parameter = 2.5}, "circle");
    };
    const auto belt = [](Scene& scene) {
        const BodyHandle b = scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5, 0.25}, {.drive = 0.25}),
                                       {.parameter = 0.125, .speed = 2.0}, "belt");
        scene.connect(Spring{.stiffness = 16.0}, b, Vector3(0, 0, 0));
        return b;
    };
    const SimulateOptions options{.until = 6.0, .error = 1e-12};
    Scene only_circle(down), only_belt(down), first(down), second(down);
    circle(only_circle);
    belt(only_belt);
    circle(first);
    belt(first);
    belt(second);
    circle(second);
    const Trajectory a = simulate(first, options), b = simulate(second, options);
    expect_same_events(a, b, 1.0, 2e-12, "permuted");
    for (const auto& [subject, scene] : {std::pair{0, only_circle}, std::pair{1, only_belt}}) {
        const auto alone = simulate(scene, options).events();
        std::vector<Event> together;
        for (const Event& e : a.events())
            if (e.subject == subject) together.push_back(e);
        ASSERT_EQ(alone.size(), together.size()) << subject;
        for (std::size_t k = 0; k < alone.size(); ++k) {
            EXPECT_EQ(alone[k].kind, together[k].kind);
            EXPECT_NEAR(alone[k].time, together[k].time, 2e-12 * alone[k].time) << subject;
        }
    }
}

TEST(Metamorphic, a_run_taken_up_again_at_an_event_neither_repeats_nor_loses_one) {
    for (const Motion& motion : motions()) {
        const Scene scene = motion.tell({});
        const Trajectory whole = simulate(scene, {.until = motion.until, .error = 1e-12});
        for (std::size_t k = 0; k < whole.events().size(); ++k) {
            const Event& e = whole.events()[k];
            const PointReport state = whole[BodyHandle{0}].report(e.time);
            Scene again(scene.gravity());
            const Scene::Body& body = scene.bodies()[0];
            again.add(std::get<Particle>(body.body), *body.rail(), {.parameter = state.u, .speed = state.speed});
            for (const auto& load : scene.loads()) again.apply(load.load, {0});
            for (const auto& c : scene.connections()) again.connect(c.coupling, c.a, c.b);
            const Trajectory rest = simulate(again, {.until = motion.until, .start = e.time, .error = 1e-10});
            ASSERT_EQ(rest.events().size(), whole.events().size() - k - 1)
                << motion.name << " taken up at event " << k << " of " << kinds(whole) << ": " << kinds(rest);
            for (std::size_t j = 0; j < rest.events().size(); ++j) {
                EXPECT_EQ(rest.events()[j].kind, whole.events()[k + 1 + j].kind) << motion.name;
                EXPECT_NEAR(rest.events()[j].time, whole.events()[k + 1 + j].time, 1e-10 * motion.until) << motion.name;
            }
        }
    }
}

TEST(Metamorphic, a_run_that_ends_at_an_event_has_it_once_and_one_that_ends_just_before_has_it_not) {
    for (const Motion& motion : motions()) {
        const Scene scene = motion.tell({});
        // the same tolerance of every run: its steps up to the event are then the same
        const auto run_to = [&](double until) { return simulate(scene, {.until = until, .rtol = 1e-13}); };
        const Trajectory whole = run_to(motion.until);
        for (std::size_t k = 0; k < whole.events().size(); ++k) {
            const double time = whole.events()[k].time;
            const Trajectory at = run_to(time), before = run_to(time * (1.0 - 1e-9));
            EXPECT_EQ(at.events().size(), k + 1) << motion.name << ", event " << k << ' ' << kinds(at);
            EXPECT_EQ(before.events().size(), k) << motion.name << ", event " << k << ' ' << kinds(before);
            if (at.events().size() != k + 1) continue;
            EXPECT_NEAR(at.events().back().time, time, 1e-12 * time) << motion.name << ", event " << k;
        }
    }
}

TEST(Metamorphic, the_end_of_a_rail_at_the_end_of_a_run_is_met_once) {
    // uniform speed 1 along one metre: the end is reached at t = 1 exactly
    Scene scene;
    scene.add(Particle{1.0}, Rail(Polynomial{.coefficients = {{0, 0, 0}, {1, 0, 0}}, .domain = {0.0, 1.0}}),
              {.parameter = 0.0, .speed = 1.0});
    const Trajectory at = simulate(scene, {.until = 1.0});
    EXPECT_EQ(kinds(at), "rail-end");
    EXPECT_EQ(at.end(), 1.0);
    EXPECT_EQ(kinds(simulate(scene, {.until = 1.0 - 1e-9})), "");
    const Trajectory beyond = simulate(scene, {.until = 7.0});
    EXPECT_EQ(kinds(beyond), "rail-end");
    EXPECT_EQ(beyond.status(), Status::stopped_by_event);
    EXPECT_NEAR(beyond.end(), 1.0, 1e-15);
}

TEST(Metamorphic, an_effect_that_is_there_with_coefficient_zero_changes_no_bit) {
    const auto tell = [](bool with_nothing, bool is_rough) {
        Scene scene(down);
        std::optional<Coulomb> friction;
        if (is_rough) friction = Coulomb{0.25, 0.125};
        if (!is_rough && with_nothing) friction = Coulomb{0.0, 0.0};
        const BodyHandle b =
            scene.add(Particle{1.0}, Rail(vertical_circle(1.0), friction), {.parameter = 2.5, .speed = 0.5});
        if (with_nothing) {
            scene.apply(Drag{0.0, 0.0}, b);
            scene.apply(Force(Vector3(0, 0, 0)), b);
            scene.connect(Spring{.stiffness = 0.0, .rest_length = 1.0}, b, Vector3(1, 2, 3));
        }
        return scene;
    };
    for (bool is_rough : {false, true}) {
        const Trajectory with = simulate(tell(true, is_rough), {.until = 5.0, .error = 1e-10});
        const Trajectory without = simulate(tell(false, is_rough), {.until = 5.0, .error = 1e-10});
        ASSERT_EQ(kinds(with), kinds(without));
        for (std::size_t k = 0; k < with.events().size(); ++k)
            EXPECT_EQ(with.events()[k].time, without.events()[k].time);
        for (double t = 0.0; t <= 5.0; t += 0.125) {
            const PointReport a = with[BodyHandle{0}].report(t), b = without[BodyHandle{0}].report(t);
            EXPECT_EQ(a.u, b.u);
            EXPECT_EQ(a.w, b.w);
            EXPECT_EQ(a.reaction, b.reaction);
        }
        EXPECT_EQ(with.plan().effects, without.plan().effects);
    }
    // a rail that is asked to move with speed zero
    for (double u : {0.1, 2.5}) {
        Scene still(down), driven(down);
        still.add(Particle{1.0}, Rail(vertical_circle(1.0), Coulomb{0.25, 0.125}), {.parameter = u});
        driven.add(Particle{1.0},
                   Rail(vertical_circle(1.0), Coulomb{0.25, 0.125}, {.drive = [](const auto& t) { return 0.0 * t; }}),
                   {.parameter = u});
        EXPECT_EQ(simulate(still, {.until = 5.0})[BodyHandle{0}].parameter(5.0),
                  simulate(driven, {.until = 5.0})[BodyHandle{0}].parameter(5.0));
    }
}

}  // namespace
}  // namespace rbdyn::test::test_metamorphic
