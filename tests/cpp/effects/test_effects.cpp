// Scenes with and without their effects: what is absent or zero is not paid for, what is taken away leaves everything
// else as it was, and what each effect does is told.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

#include "proof.hpp"
#include "rbdyn/effects.hpp"
#include "rbdyn/scene/effects.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "refusal.hpp"
#include "support.hpp"

namespace rbdyn::test::test_effects {
namespace {

using proof::Motions, proof::motions_of, proof::Row, proof::rows;

std::string told(const Row& row) { return row.motion + ", " + row.effect; }

/// The coefficients of all pieces of motions, and their work.
std::vector<double> digits(const std::vector<Record>& records) {
    std::vector<double> all;
    for (const Record& record : records) {
        for (std::size_t i = 0; i < record.entries().size(); ++i) {
            const Piece piece = record.piece(i);
            for (int v = 0; v < piece.variables; ++v)
                all.insert(all.end(), piece.variable(v), piece.variable(v) + piece.order + 1);
            all.insert(all.end(), {piece.start.hi, piece.start.lo, piece.unit, record.entries()[i].length});
        }
        const Work& w = record.work;
        for (const std::int64_t n : {w.steps, w.rejected, w.right_hand_sides, w.guard_evaluations})
            all.push_back(static_cast<double>(n));
    }
    return all;
}
/// Bit for bit: a zero with the other sign is another number.
bool same(const std::vector<Record>& a, const std::vector<Record>& b) {
    const std::vector<double> x = digits(a), y = digits(b);
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) == 0;
}
std::vector<Record> motion_of(const Scene& scene, double until) { return proof::integrated(motions_of(scene), until); }

/// The same equations to the last instruction, with as many numbers of their mode, and as much beside them.
void expect_same_equations(const Motions& a, const std::vector<Record>& of_a, const Motions& b,
                           const std::vector<Record>& of_b) {
    ASSERT_EQ(a.models.size(), b.models.size());
    for (std::size_t i = 0; i < of_a.size(); ++i) {
        const Mode &x = of_a[i].modes.front(), &y = of_b[i].modes.front();
        EXPECT_EQ(x.equations->program.text(), y.equations->program.text());
        EXPECT_EQ(x.parameters, y.parameters);
        EXPECT_EQ(x.equations->groups.size(), y.equations->groups.size());
        EXPECT_EQ(bool(x.equations->projection), bool(y.equations->projection));
    }
}

TEST(Effects, that_are_zero_change_no_bit_of_a_motion_and_no_count_of_its_work) {
    for (const Row& row : rows()) {
        SCOPED_TRACE(told(row));
        const Motions without = motions_of(row.without), zero = motions_of(row.zero);
        const std::vector<Record> a = proof::integrated(without, row.until), b = proof::integrated(zero, row.until);
        for (const Record& r : a) EXPECT_EQ(r.status, Status::reached_end);
        EXPECT_TRUE(same(a, b));
        expect_same_equations(without, a, zero, b);
        EXPECT_EQ(same(a, motion_of(row.on, row.until)), !row.is_noticed);
    }
}

TEST(Effects, cost_what_equations_written_by_hand_cost) {
    for (const Row& row : rows()) {
        SCOPED_TRACE(told(row));
        const Motions without = motions_of(row.without);
        const std::vector<Record> a = proof::integrated(without, row.until),
                                  b = proof::integrated(row.by_hand, row.until);
        EXPECT_TRUE(same(a, b));
        expect_same_equations(without, a, row.by_hand, b);
    }
}

TEST(Effects, that_are_zero_are_none_of_the_plan) {
    for (const Row& row : rows()) {
        SCOPED_TRACE(told(row));
        const Plan without = make_plan(row.without.frozen()), zero = make_plan(row.zero.frozen()),
                   on = make_plan(row.on.frozen());
        EXPECT_EQ(without.effects, zero.effects);
        EXPECT_EQ(without.size(), zero.size());
        EXPECT_EQ(without.guards.size(), zero.guards.size());
        EXPECT_EQ(without.parts.size(), zero.parts.size());
        if (!row.is_named) continue;
        EXPECT_FALSE(zero.has(row.effect));
        EXPECT_TRUE(on.has(row.effect));
    }
}

TEST(Effects, written_as_functors_cost_what_built_in_ones_do) {
    for (const proof::OwnLaw& law : proof::own_laws()) {
        SCOPED_TRACE(law.law);
        const std::vector<Record> a = proof::integrated(law.built_in, law.until);
        EXPECT_TRUE(same(a, proof::integrated(law.functor, law.until)));
        EXPECT_TRUE(same(a, proof::integrated(law.by_hand, law.until)));
    }
}

TEST(Effects, of_friction_bring_modes_and_guards_and_nothing_else_does) {
    int rough = 0;
    for (const Row& row : rows()) {
        if (row.motion != "rail" && row.motion != "moving rail") continue;
        SCOPED_TRACE(told(row));
        EXPECT_TRUE(make_plan(row.without.frozen()).guards.empty());
        const Record smooth = motion_of(row.without, row.until).front();
        EXPECT_EQ(smooth.modes.size(), 1u);
        EXPECT_EQ(smooth.work.guard_evaluations, 0);
        EXPECT_TRUE(smooth.modes.front().parameters.empty());
        if (row.effect != "dynamic friction") continue;
        ++rough;
        const Record slides = motion_of(row.on, row.until).front();
        EXPECT_GT(slides.modes.size(), 1u);
        EXPECT_GT(slides.work.guard_evaluations, 0);
    }
    EXPECT_EQ(rough, 2);
}

TEST(Effects, of_a_body_without_spin_are_those_of_a_particle_at_its_centre_of_mass) {
    int bodies = 0;
    for (const Row& row : rows()) {
        if (row.effect != "rotation") continue;
        SCOPED_TRACE(told(row));
        ++bodies;
        const SimulateOptions options{.until = row.until, .rtol = 1e-12, .engine = "taylor"};
        const Trajectory particle = simulate(row.without, options), body = simulate(row.zero, options),
                         turning = simulate(row.on, options);
        const BodyHandle it{0};
        EXPECT_EQ(body[it].center_of_mass(row.until), particle[it].position(row.until));
        EXPECT_EQ(body[it].center_of_mass_velocity(row.until), particle[it].velocity(row.until));
        EXPECT_EQ(body[it].angular_velocity(row.until).norm(), 0.0);
        EXPECT_EQ(body.statistics().size, particle.statistics().size);
        EXPECT_GE(turning.statistics().size.variables, particle.statistics().size.variables + 7);
    }
    EXPECT_EQ(bodies, 5);
}

TEST(Plans, announce_what_the_statistics_count) {
    for (const Row& row : rows())
        for (const Scene& scene : {row.without, row.on}) {
            SCOPED_TRACE(told(row));
            const Plan plan = make_plan(scene.frozen());
            const Trajectory run = simulate(scene, {.until = row.until, .rtol = 1e-9, .engine = "taylor"});
            const Statistics& s = run.statistics();
            EXPECT_EQ(plan.size(), s.size);
            EXPECT_EQ(s.python_calls, 0);
            EXPECT_EQ(s.jacobians, 0);
            // each guard is looked at once a step
            if (run.events().empty() && run.data()->record.modes.size() == 1) {
                EXPECT_EQ(s.guard_evaluations, plan.size().guards * s.steps);
            }
        }
}

TEST(Reports, are_computed_when_they_are_asked_for) {
    // a force that is called back tells how often it is asked for
    const auto callback = std::make_shared<Callback>();
    callback->name = "wind";
    callback->inputs = 7;
    callback->outputs = 3;
    callback->function = [](const double* x, double* f) {
        f[0] = -0.25 * x[4];
        f[1] = f[2] = 0.0;
    };
    Scene scene(down);
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(vertical_circle(1.0)), {.parameter = 2.0, .speed = 6.0});
    const LoadHandle wind = scene.apply(Force(std::shared_ptr<const Callback>(callback)), bead);
    const auto asked = [&] { return callback->calls.exchange(0); };
    for (const double until : {1.0, 10.0}) {
        asked();
        const Trajectory run = simulate(scene, {.until = until, .rtol = 1e-9});
        // nothing is evaluated but the right-hand sides of the engine
        EXPECT_EQ(asked(), run.statistics().right_hand_sides);
        (void)run[bead].position(until);
        EXPECT_EQ(asked(), 0);
        (void)run[bead].reaction(until);
        EXPECT_EQ(asked(), 1);
        // places and velocities take no force
        (void)run.momentum(until);
        (void)run.kinetic_energy(until);
        EXPECT_EQ(asked(), 0);
        (void)run.center_of_mass_acceleration(until);
        EXPECT_EQ(asked(), 1);
        (void)run.power(until, wind);
        EXPECT_GT(asked(), 0);
    }
}

/// A thrown ball with drag.
BodyHandle add_ball(Scene& scene) {
    const BodyHandle ball = scene.add(Particle{0.5}, FreeStart{{0, 0, 0}, {1, 0, 4}});
    scene.apply(Drag{.linear = 0.25}, ball);
    return ball;
}
/// A bead that slides on a rough hoop.
BodyHandle add_bead(Scene& scene) {
    return scene.add(Particle{1.0}, Rail(vertical_circle(1.0), Coulomb{0.15, 0.1}), {.parameter = 2.0, .speed = 6.0});
}

TEST(Plans, of_several_parts_have_the_size_of_all) {
    Scene ball(down), bead(down), both(down);
    add_ball(ball);
    add_bead(bead);
    add_ball(both);
    add_bead(both);
    const Plan plan = make_plan(both);
    ASSERT_EQ(plan.parts.size(), 2u);
    Size sum = make_plan(ball).size();
    EXPECT_EQ(sum.variables, 4);
    sum += make_plan(bead).size();
    EXPECT_EQ(plan.size(), sum);
    EXPECT_EQ(simulate(both, {.until = 1.0}).statistics().size, sum);
    EXPECT_EQ(plan.variables(), std::pair(6, 8));
    std::ostringstream out;
    out << plan;
    EXPECT_NE(out.str().find("6 of 8 variables are simulated"), std::string::npos);
    EXPECT_NE(out.str().find("size        6 variables, 2 guards, "), std::string::npos);
    std::ostringstream ones;
    Size one;
    one.variables = one.guards = one.instructions = 1;
    ones << one;
    EXPECT_EQ(ones.str(), "1 variable, 1 guard, 1 instruction");
}

// --- without() ---

TEST(Scenes, without_an_effect_move_as_if_they_had_never_had_it) {
    for (const Row& row : rows()) {
        if (!row.can_go) continue;
        SCOPED_TRACE(told(row));
        // where a rail has both kinds of friction, static friction goes with what is dynamic
        const std::vector<std::string> present = effects_of(row.on);
        const bool goes_along = row.effect == "dynamic friction" &&
                                std::find(present.begin(), present.end(), "static friction") != present.end();
        const Scene rest = goes_along ? row.on.without(row.effect, "static friction") : row.on.without(row.effect);
        EXPECT_TRUE(same(motion_of(rest, row.until), motion_of(row.without, row.until)));
    }
}

Scene several(BodyHandle& ball, LoadHandle& drag, LoadHandle& push, CouplingHandle& first, CouplingHandle& second) {
    Scene scene(down);
    ball = scene.add(Particle{0.5}, FreeStart{{1, 0, 0}, {0, 1, 0}});
    drag = scene.apply(Drag{.linear = 0.25}, ball);
    push = scene.apply(Force(Vector3(1.0, 0.0, 0.0)), ball);
    first = scene.connect(Spring{.stiffness = 2.0, .damping = 0.5}, ball, Vector3(0, 0, 1));
    second = scene.connect(Spring{.stiffness = 4.0, .rest_length = 0.5}, ball, Vector3(0, 1, 0));
    return scene;
}

TEST(Scenes, keep_their_handles_good_without_some_of_what_they_have) {
    BodyHandle ball;
    LoadHandle drag, push;
    CouplingHandle first, second;
    const Scene scene = several(ball, drag, push, first, second);
    const Scene rest = scene.without(drag, first);
    EXPECT_EQ(effects_of(rest), (std::vector<std::string>{"gravity", "spring", "user force"}));
    const Trajectory run = simulate(rest, {.until = 1.0});
    EXPECT_EQ(run.power(1.0, drag), 0.0);
    EXPECT_NEAR(run.power(1.0, push), run[ball].velocity(1.0)[0], 1e-12);
    EXPECT_EQ(run[first].force(1.0).norm(), 0.0);
    const double length = (run[ball].position(1.0) - Vector3(0, 1, 0)).norm();
    EXPECT_NEAR(run[second].length(1.0), length, 1e-12);
    EXPECT_NEAR(run[second].force(1.0).norm(), 4.0 * std::abs(length - 0.5), 1e-12);
    EXPECT_EQ(scene.without(), scene);
}

TEST(Scenes, lose_the_spring_of_a_damped_one_and_keep_its_damper) {
    BodyHandle ball;
    LoadHandle drag, push;
    CouplingHandle first, second;
    const Scene scene = several(ball, drag, push, first, second);
    EXPECT_EQ(effects_of(scene.without("spring", "drag")),
              (std::vector<std::string>{"gravity", "damper", "user force"}));
    EXPECT_EQ(effects_of(scene.without("damper", "user force", "gravity")),
              (std::vector<std::string>{"spring", "drag"}));
}

TEST(Scenes, refuse_to_lose_what_they_do_not_have) {
    BodyHandle ball;
    LoadHandle drag, push;
    CouplingHandle first, second;
    const Scene scene = several(ball, drag, push, first, second);
    EXPECT_EQ(refusal([&] { (void)scene.without("drive"); }),
              "without: this scene has no drive; it has gravity, spring, damper, drag, user force");
    EXPECT_NE(refusal([&] { (void)scene.without("contact"); }).find("has no contact; it has"), std::string::npos);
    EXPECT_NE(refusal([&] { (void)scene.without("wind"); }).find("\"wind\" is no effect; the effects are gravity"),
              std::string::npos);
    EXPECT_NE(refusal([&] { (void)scene.without(LoadHandle{7}); }).find("load is 7"), std::string::npos);
    EXPECT_NE(refusal([&] { (void)scene.without(CouplingHandle{-1}); }).find("coupling is -1"), std::string::npos);
}

TEST(Scenes, without_static_friction_hold_as_much_as_slides) {
    Scene scene(down);
    scene.add(Particle{1.0}, Rail(vertical_circle(1.0), Coulomb{0.5, 0.25}), {.parameter = 1.0});
    const auto friction = [](const Scene& s) { return *s.bodies()[0].rail()->friction(); };
    EXPECT_EQ(friction(scene.without("static friction")), (Coulomb{0.25, 0.25}));
    EXPECT_EQ(friction(scene.without("dynamic friction")), (Coulomb{0.5, 0.0}));
    EXPECT_FALSE(scene.without("dynamic friction", "static friction").bodies()[0].rail()->friction());
    EXPECT_NE(refusal([&] {
                  (void)scene.without("static friction").without("static friction");
              }).find("take \"dynamic friction\" away too"),
              std::string::npos);
}

TEST(Scenes, without_rotation_have_particles_at_the_centres_of_mass) {
    Scene scene(down);
    const Attitude tilted(EulerAngles{0.5, 0.25, 0.125});
    const BodyHandle body = scene.add(
        RigidBody(0.5, Vector3(0.5, 0.75, 1.0), {.com = {0.25, 0.5, 0.0}}),
        BodyStart{
            .position = {1, 2, 3}, .velocity = {1, 0, 4}, .attitude = tilted, .angular_velocity = Vector3(1, 2, 3)});
    scene.apply(Force(Vector3(0.0, 0.0, 1.0), Frame::body), body, Vector3(1, 0, 0));
    scene.apply(Torque(Vector3(1, 0, 0)), body);
    scene.connect(Spring{.stiffness = 2.0}, body.point({0, 0, 1}), Vector3(0, 0, 0));
    const Trajectory whole = simulate(scene, {.until = 0.5});
    const Trajectory run = simulate(scene.without("rotation"), {.until = 0.5});
    EXPECT_FALSE(run.plan().has("rotation"));
    EXPECT_FALSE(run.plan().has("user torque"));
    EXPECT_LT((run[body].position(0.0) - whole[body].center_of_mass(0.0)).norm(), 1e-15);
    EXPECT_LT((run[body].velocity(0.0) - whole[body].center_of_mass_velocity(0.0)).norm(), 4e-15);
    const Vector3 push = to_world<double>(tilted.quaternion(), Vector3(0, 0, 1));
    EXPECT_LT((run[body].force(0.0) - (0.5 * down + push - 2.0 * run[body].position(0.0))).norm(), 1e-14);

    scene.apply(Force([](const auto&, const auto& r, const auto&) { return r; }, Frame::body), body);
    EXPECT_NE(refusal([&] { (void)scene.without("rotation"); }).find("give it in world axes"), std::string::npos);
    Scene hinge(down);
    hinge.add(RigidBody(0.5, Vector3(0.5, 0.75, 1.0)), Revolute{.point = {1, 0, 0}}, {}, "door");
    EXPECT_NE(refusal([&] { (void)hinge.without("rotation"); }).find("all the motion that its joint leaves door"),
              std::string::npos);
}

// --- effects() ---

TEST(TablesOfEffects, tell_the_difference_that_closed_forms_have) {
    // thrown, with a push along x: x = v t + t^2, z = 4 t - g t^2 / 2
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{0.5}, FreeStart{{0, 0, 0}, {1, 0, 4}});
    scene.apply(Force(Vector3(1.0, 0.0, 0.0)), ball);
    const EffectTable table = effects(scene, {.until = 1.0});
    ASSERT_EQ(table.rows.size(), 2u);
    // without the push: x is 1 m less of an extent of 2 m by sqrt(...), vx 2 m/s less of the largest speed
    const double top = 16.0 / (2.0 * gravity), end = 4.0 - 0.5 * gravity;
    const double extent = Vector3(2.0, 0.0, top - std::min(end, 0.0)).norm(),
                 speed = std::max(Vector3(3.0, 0.0, 4.0 - gravity).norm(), Vector3(1.0, 0.0, 4.0).norm());
    const double by_place = 1.0 / extent, by_velocity = 2.0 / speed;
    // the extent is that seen at 257 times
    EXPECT_NEAR(table["user force"].difference, std::max(by_place, by_velocity), 1e-4);
    EXPECT_EQ(table["user force"].time, 1.0);
    EXPECT_GT(table["gravity"].seconds, 0.0);
    EXPECT_NE(refusal([&] { (void)table["drag"]; }).find("the scene has gravity, user force"), std::string::npos);
}

TEST(TablesOfEffects, tell_the_events_that_friction_brings) {
    Scene scene(down);
    scene.add(Particle{1.0}, Rail(vertical_circle(1.0), Coulomb{0.15, 0.1}), {.parameter = 2.0, .speed = 6.0});
    const EffectTable table = effects(scene, {.until = 30.0});
    const int all = static_cast<int>(simulate(scene, {.until = 30.0}).events().size());
    EXPECT_EQ(table.events, all);
    EXPECT_EQ(table["dynamic friction"].gained + table["dynamic friction"].lost > 0, true);
    EXPECT_EQ(table["gravity"].note, "");
    // it comes to rest where even less would hold it
    EXPECT_EQ(table["static friction"].difference, 0.0);
    EXPECT_EQ(table["static friction"].gained, 0);
}

TEST(TablesOfEffects, keep_the_rows_beside_one_that_fails) {
    Scene scene(down);
    const BodyHandle top = scene.add(RigidBody(0.5, Vector3(0.5, 0.75, 1.0)), Spherical{.point = {0, 0, -1}},
                                     {.angular_velocity = Vector3(0, 0, 3)});
    scene.apply(Drag{.linear = 0.5}, top, Vector3(0.5, 0, 0));
    const EffectTable table = effects(scene, {.until = 1.0});
    ASSERT_EQ(table.rows.size(), 3u);
    EXPECT_NE(table["rotation"].note.find("all the motion that its joint leaves"), std::string::npos);
    EXPECT_TRUE(std::isnan(table["rotation"].difference));
    EXPECT_GT(table["drag"].difference, 0.0);
    std::ostringstream out;
    out << table;
    EXPECT_NE(out.str().find("rotation"), std::string::npos);
    EXPECT_EQ(out.str().find("nan"), std::string::npos);
}

TEST(TablesOfEffects, of_several_parts_tell_what_an_effect_does_to_its_own) {
    Scene ball(down), bead(down), both(down);
    add_ball(ball);
    add_bead(bead);
    add_ball(both);
    add_bead(both);
    const SimulateOptions options{.until = 2.0};
    const EffectTable table = effects(both, options), of_ball = effects(ball, options),
                      of_bead = effects(bead, options);
    ASSERT_EQ(table.rows.size(), 4u);
    EXPECT_EQ(table.events, of_ball.events + of_bead.events);
    EXPECT_EQ(table.steps, of_ball.steps + of_bead.steps);
    EXPECT_EQ(table["drag"].difference, of_ball["drag"].difference);
    EXPECT_EQ(table["dynamic friction"].difference, of_bead["dynamic friction"].difference);
    EXPECT_EQ(table["dynamic friction"].gained, of_bead["dynamic friction"].gained);
    EXPECT_EQ(table["gravity"].difference, std::max(of_ball["gravity"].difference, of_bead["gravity"].difference));
    for (const EffectRow& row : table.rows) EXPECT_EQ(row.note, "");
}

TEST(TablesOfEffects, tell_what_joins_two_bodies) {
    // at rest on a spring that is stretched by 1/2 m: x = (1 - cos(2 t)) / 4; without it, two parts that stay
    Scene scene;
    const BodyHandle a = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}});
    const BodyHandle b = scene.add(Particle{1.0}, FreeStart{{1.5, 0, 0}});
    const CouplingHandle spring = scene.connect(Spring{.stiffness = 2.0, .rest_length = 1.0}, a, b);
    EXPECT_TRUE(make_plan(scene).parts.empty());
    const Trajectory apart = simulate(scene.without(spring), {.until = 1.0});
    EXPECT_EQ(apart.plan().parts.size(), 2u);
    EXPECT_EQ(apart[spring].force(1.0).norm(), 0.0);
    EXPECT_EQ(apart.statistics().size.variables, 0);
    const EffectTable table = effects(scene, {.until = 0.875 * std::numbers::pi});
    ASSERT_EQ(table.rows.size(), 1u);
    // by the velocity; scales are those seen at 257 times
    EXPECT_NEAR(table["spring"].difference, std::sqrt(0.5), 1e-4);
}

// --- sweeps ---

TEST(Sweeps, bring_an_effect_where_a_parameter_leaves_zero_and_take_it_where_it_comes_back) {
    Parameter k(0.0, "k");
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{0.5}, FreeStart{{1, 0, 0}, {0, 1, 2}});
    scene.apply(Force([&](const auto&, const auto& r, const auto&) {
                    using T = std::decay_t<decltype(r[0])>;
                    const T stiffness = k;
                    return Vector3Of<T>{-stiffness * r[0], -stiffness * r[1], -stiffness * r[2]};
                }),
                ball);
    Scene bare(down);
    bare.add(Particle{0.5}, FreeStart{{1, 0, 0}, {0, 1, 2}});
    const SimulateOptions options{.until = 1.0, .rtol = 1e-12, .engine = "taylor"};
    const Trajectory never = simulate(bare, options);
    for (const double value : {0.0, 2.0, 4.0, 0.0}) {
        k.set(value);
        const Trajectory run = simulate(scene, options);
        EXPECT_EQ(run.plan().has("user force"), value != 0.0);
        EXPECT_EQ(run.statistics().size == never.statistics().size, value == 0.0);
        EXPECT_EQ(same({run.data()->record}, {never.data()->record}), value == 0.0);
        const double w = std::sqrt(value / 0.5);
        EXPECT_NEAR(run[ball].position(1.0)[0], std::cos(w), 1e-12);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_effects
