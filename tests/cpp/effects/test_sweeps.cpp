// Sweeps: of a scene whose numbers change between runs the plan is kept, and every run is what it would be with a plan
// of its own.
#include <gtest/gtest.h>

#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "effects/random_formula.hpp"
#include "rbdyn/rbdyn.hpp"

namespace rbdyn::test::test_sweeps {
namespace {

using Number = Expression;
using Vector = Vector3Of<Expression>;

const Vector3 down(0.0, 0.0, -9.81);
const Circle hoop{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}};

Scene thrown(const std::function<Vector(const Number& t, const Vector& r, const Vector& v)>& force) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{2.0}, FreeStart{{0, 0, 10}, {20, 0, 15}});
    scene.apply(Force([=](const Number& t, const Vector& r, const Vector& v) { return force(t, r, v); }), ball);
    return scene;
}

Scene on_rough_hoop(const RailOptions& options, double speed = 1.0) {
    Scene scene(down);
    scene.add(Particle{1.0}, Rail(hoop, Coulomb{0.3, 0.2}, options), RailStart{.parameter = 0.3, .speed = speed});
    return scene;
}

Scene spinning_box(const Load& load) {
    Scene scene(down);
    const BodyHandle box =
        scene.add(shapes::box(1.0, {0.1, 0.2, 0.3}),
                  BodyStart{.position = {0, 0, 1}, .velocity = {1, 0, 0}, .angular_velocity = Vector3(1, 2, 3)});
    scene.apply(load, box);
    return scene;
}

Attempt ran(const Scene& scene, double until = 2.0) {
    SimulateOptions options;
    options.until = until;
    options.rtol = 1e-10;
    return attempt(scene, options);
}

/// The same scene, which nobody has planned.
Scene unplanned(const Scene& scene) {
    Scene copy = scene;
    copy.set_gravity(scene.gravity());
    return copy;
}

std::string printed(const Plan& plan) {
    std::ostringstream out;
    out << plan;
    return out.str();
}

/// That a run is, bit for bit, that of the same scene planned anew.
void expect_same_as_planned_anew(const Scene& scene, const Attempt& run) {
    const Attempt anew = ran(unplanned(scene), run.run.end());
    ASSERT_TRUE(anew.run.statistics().planned);
    EXPECT_EQ(run.run.engine(), anew.run.engine());
    EXPECT_EQ(run.run.statistics().steps, anew.run.statistics().steps);
    EXPECT_EQ(run.run.statistics().size, anew.run.statistics().size);
    EXPECT_EQ(printed(run.run.plan()), printed(anew.run.plan()));
    ASSERT_EQ(run.run.events().size(), anew.run.events().size());
    for (std::size_t i = 0; i < run.run.events().size(); ++i)
        EXPECT_EQ(run.run.events()[i].time, anew.run.events()[i].time);
    for (std::size_t i = 0; i < scene.bodies().size(); ++i)
        for (const double part : {0.0, 0.3, 0.7, 1.0}) {
            const BodyHandle body{static_cast<int>(i)};
            const double t = part * run.run.end();
            EXPECT_EQ(run.run[body].position(t), anew.run[body].position(t));
            EXPECT_EQ(run.run[body].force(t), anew.run[body].force(t));
        }
}

struct Sweep {
    const char* name;
    std::function<Scene(const Parameter&)> scene;
};

std::vector<Sweep> sweeps() {
    using P = Parameter;
    return {
        {"a force towards the origin",
         [](const P& k) {
             return thrown([k](const auto&, const Vector& r, const auto&) { return Vector(r * -Number(k)); });
         }},
        {"a force that is the number",
         [](const P& k) {
             return thrown([k](const auto&, const auto&, const auto&) { return Vector(Number(k), 0.0, 0.0); });
         }},
        {"a drive that is the number",
         [](const P& k) { return on_rough_hoop({.drive = TimeFunction([k](const Number&) { return Number(k); })}); }},
        {"a drive that swings",
         [](const P& k) {
             return on_rough_hoop({.drive = TimeFunction([k](const Number& t) { return Number(k) * sin(3.0 * t); })});
         }},
        {"a hoop that moves",
         [](const P& k) {
             return on_rough_hoop({.motion = RigidMotion::translation(
                                       [k](const Number& t) { return Vector(Number(k) * sin(2.0 * t), 0.0, 0.0); })});
         }},
        {"a torque that the box damps",
         [](const P& k) {
             return spinning_box(Torque([k](const auto&, const auto&, const Vector& w) {
                 return Vector(0.01 * Number(k), 0.0, -0.001 * Number(k) * w[2]);
             }));
         }},
        {"a box in closed form",
         [](const P& k) {
             return spinning_box(
                 Force([k](const auto&, const auto&, const auto&) { return Vector(Number(k), 0.0, 0.0); }));
         }},
        {"a potential and a watch",
         [](const P& k) {
             Scene scene(down);
             const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{1, 0, 1}, {1, 0, 0}});
             scene.apply(Potential([k](const Vector& r) { return -0.5 * Number(k) * dot<Number>(r, r); }), ball);
             scene.watch("x", WatchFunction([=](const Now& now) { return now[ball].position()[0] - 0.1 * Number(k); }));
             return scene;
         }},
        {"the stiffness of a spring",
         [](const P& k) {
             Scene scene(down);
             const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{1, 0.5, 0}, {0, 1, 0}});
             scene.connect(Spring{.stiffness = k, .rest_length = 0.5}, ball, Vector3(0, 0, 0.25));
             return scene;
         }},
        {"a drag",
         [](const P& k) {
             Scene scene(down);
             scene.apply(Drag{.linear = k, .quadratic = k}, scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 2}}));
             return scene;
         }},
        {"the drag of a bead",
         [](const P& k) {
             Scene scene = on_rough_hoop({});
             scene.apply(Drag{.quadratic = k}, BodyHandle{0});
             return scene;
         }},
        {"a charge",
         [](const P& k) {
             Scene scene;
             scene.apply(Lorentz{k, {0, 1, 0.5}}, scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 2}}));
             return scene;
         }},
        {"a spring about a hinge",
         [](const P& k) {
             Scene scene(down);
             const RigidBody bar(1.0, Inertia{0.5, 0.5, 0.25}, {.com = {0, 0, -0.5}});
             const BodyHandle body = scene.add(bar, Revolute{{0, 1, 0}}, RevoluteStart{0.75, 0.0});
             scene.apply(TorsionSpring{.stiffness = k, .rest_angle = 0.25}, body);
             return scene;
         }},
        {"parts",
         [](const P& k) {
             Scene scene = on_rough_hoop({});
             const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}, {1, 0, 0}});
             scene.apply(Force([k](const auto&, const Vector& r, const auto&) { return Vector(r * -Number(k)); }),
                         ball);
             return scene;
         }},
    };
}

TEST(Sweeps, plan_once_for_all_numbers_that_vanish_nowhere) {
    for (const Sweep& sweep : sweeps()) {
        SCOPED_TRACE(sweep.name);
        Parameter k(0.5, "k");
        const Scene scene = sweep.scene(k);
        for (const double value : {0.5, 0.7, 1.3, 0.2, 2.5}) {
            SCOPED_TRACE(value);
            k.set(value);
            const Attempt run = ran(scene);
            EXPECT_EQ(run.run.statistics().planned, value == 0.5);
            expect_same_as_planned_anew(scene, run);
        }
    }
}

TEST(Sweeps, plan_anew_where_an_effect_vanishes_and_not_where_it_comes_back) {
    for (const Sweep& sweep : sweeps()) {
        SCOPED_TRACE(sweep.name);
        Parameter k(0.5, "k");
        const Scene scene = sweep.scene(k);
        std::vector<std::size_t> effects;
        for (const double value : {0.5, 0.0, 0.7, 0.9}) {
            SCOPED_TRACE(value);
            k.set(value);
            const Attempt run = ran(scene);
            // the plan with the effect is still there where it comes back
            EXPECT_EQ(run.run.statistics().planned, value == 0.5 || value == 0.0);
            expect_same_as_planned_anew(scene, run);
            effects.push_back(run.run.plan().effects.size());
        }
        EXPECT_EQ(effects[1], effects[0] - 1);
        EXPECT_EQ(effects[2], effects[0]);
    }
}

TEST(Sweeps, open_and_close_a_plane_where_numbers_cancel) {
    Parameter a(1.0, "a"), b(2.0, "b");
    const Scene scene =
        thrown([=](const auto&, const auto&, const auto&) { return Vector(0.0, Number(a) - Number(b), 1.0); });
    const auto variables = [&](double value) {
        b.set(value);
        return ran(scene).run.statistics().size.variables;
    };
    EXPECT_EQ(variables(2.0), 5);  // the velocity along x stays
    EXPECT_EQ(variables(1.5), 5);
    EXPECT_EQ(variables(1.0), 3);
    EXPECT_EQ(variables(0.5), 5);
}

TEST(Sweeps, choose_anew_what_a_number_chooses) {
    Parameter k(0.5, "k");
    const Scene scene = thrown([=](const Number& t, const Vector& r, const Vector& v) {
        const Number n = k;
        return Vector(where(n > 1.0, -r[0], 0.5 * r[0]), 0.0, floor(n) * v[2] + abs(n - 0.6) * t);
    });
    for (const double value : {0.5, 0.55, 0.8, 1.5, 2.5, 2.7, 0.3}) {
        SCOPED_TRACE(value);
        k.set(value);
        expect_same_as_planned_anew(scene, ran(scene));
    }
}

TEST(Sweeps, take_equations_of_later_modes_only_for_numbers_they_hold_for) {
    // the first run sticks, the second one does not; in the third one the bead meets a force where it sticks
    Parameter k(0.0, "k"), wind(0.0, "wind");
    Scene scene = on_rough_hoop({}, 0.5);
    scene.apply(Force([=](const Number& t, const auto&, const auto&) {
                    return Vector(Number(k) + Number(wind) * t, 0.0, 0.0);
                }),
                BodyHandle{0});
    for (const auto& [first, second] :
         {std::pair{1e-3, 0.0}, {30.0, 0.0}, {1e-3, 20.0}, {2e-3, 25.0}, {40.0, 5.0}, {3e-3, 0.0}}) {
        SCOPED_TRACE(first);
        k.set(first);
        wind.set(second);
        expect_same_as_planned_anew(scene, ran(scene, 4.0));
    }
}

TEST(Sweeps, know_a_number_from_a_constant_that_it_happens_to_equal) {
    Parameter k(0.5, "k");
    Scene scene;
    const BodyHandle bead =
        scene.add(Particle{1.0}, Rail(Line{.direction = {1, 0, 0}}), RailStart{.parameter = -0.5, .speed = 1.0});
    scene.apply(Force([=](const Number&, const Vector& r, const Vector&) {
                    return Vector(where(r[0] > 0.0, Number(k), 1.5), 0.0, 0.0);
                }),
                bead);
    for (const double value : {0.5, 1.5, 2.0}) {
        k.set(value);
        expect_same_as_planned_anew(scene, ran(scene));
    }
}

TEST(Sweeps, take_masses_and_coefficients_of_friction_as_they_are_when_a_run_starts) {
    Parameter m(0.5, "m"), mu(0.5, "mu");
    Scene scene(down);
    const Line incline{.direction = {1, 0, -0.3}};
    const BodyHandle bead = scene.add(Particle{m}, Rail(incline, Coulomb{mu, 0.125}), RailStart{.speed = 1.0});
    scene.apply(Drag{.quadratic = 0.25}, bead);
    for (const auto& [mass, friction] : {std::pair{0.5, 0.5}, {0.5, 0.75}, {2.0, 0.75}, {0.25, 0.125}}) {
        m.set(mass);
        mu.set(friction);
        expect_same_as_planned_anew(scene, ran(scene, 4.0));
        Scene plain(down);
        plain.add(Particle{mass}, Rail(incline, Coulomb{friction, 0.125}), RailStart{.speed = 1.0});
        plain.apply(Drag{.quadratic = 0.25}, bead);
        EXPECT_EQ(ran(scene, 4.0).run[bead].position(2.0), ran(plain, 4.0).run[bead].position(2.0));
    }
    m.set(-1.0);
    EXPECT_THROW((void)ran(scene), InvalidInput);
}

TEST(Sweeps, leave_every_run_its_numbers) {
    Parameter k(1.0, "k");
    const Scene scene = thrown([=](const auto&, const Vector& r, const auto&) { return Vector(r * -Number(k)); });
    const Attempt first = ran(scene);
    k.set(2.0);
    const Attempt second = ran(scene);
    ASSERT_FALSE(second.run.statistics().planned);
    const BodyHandle ball{0};
    EXPECT_EQ(first.run[ball].force(0.0), Vector3(0, 0, -10 - 2 * 9.81));
    EXPECT_EQ(second.run[ball].force(0.0), Vector3(0, 0, -20 - 2 * 9.81));
}

TEST(Sweeps, forget_the_plan_of_a_scene_that_changes_and_not_of_its_copies) {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}, {1, 0, 0}});
    const Scene copy = scene;
    EXPECT_TRUE(ran(scene).run.statistics().planned);
    EXPECT_FALSE(ran(scene).run.statistics().planned);
    EXPECT_FALSE(ran(copy).run.statistics().planned);
    scene.apply(Drag{0.1, 0.0}, ball);
    const Attempt with_drag = ran(scene);
    EXPECT_TRUE(with_drag.run.statistics().planned);
    EXPECT_TRUE(with_drag.run.plan().has("drag"));
    EXPECT_FALSE(ran(copy).run.statistics().planned);
    EXPECT_FALSE(ran(copy).run.plan().has("drag"));
    EXPECT_TRUE(ran(scene.without("drag")).run.statistics().planned);
    EXPECT_FALSE(ran(scene).run.statistics().planned);
    EXPECT_EQ(scene.without("drag"), scene.without("drag"));
}

TEST(Sweeps, plan_anew_for_a_force_that_the_view_along_a_line_follows) {
    Parameter k(1.0, "k");
    Scene scene(down);
    const Line incline{.direction = {1, 0, -0.3}};
    const BodyHandle bead = scene.add(Particle{1.0}, Rail(incline, Coulomb{0.3, 0.2}), RailStart{.speed = 1.0});
    scene.apply(Force([=](const auto&, const auto&, const auto&) { return Vector(Number(k), 0.5 * Number(k), 0.0); }),
                bead);
    for (const double value : {1.0, 2.0, -1.0}) {
        k.set(value);
        const Attempt run = ran(scene);
        EXPECT_TRUE(run.run.statistics().planned);
        expect_same_as_planned_anew(scene, run);
    }
}

TEST(Sweeps, run_side_by_side_with_one_plan) {
    Parameter k(0.5, "k");
    const Scene scene = sweeps()[3].scene(k);
    const Attempt alone = ran(scene);
    std::vector<std::thread> threads;
    std::vector<Vector3> ends(4);
    for (Vector3& end : ends)
        threads.emplace_back([&] {
            for (int i = 0; i < 20; ++i) end = ran(scene).run[BodyHandle{0}].position(2.0);
        });
    for (std::thread& t : threads) t.join();
    for (const Vector3& end : ends) EXPECT_EQ(end, alone.run[BodyHandle{0}].position(2.0));
}

TEST(Sweeps, take_a_force_that_is_a_number_where_bodies_touch) {
    // what acts beside the equations takes more numbers than they do
    Parameter k(0.1, "k"), m(0.2, "m");
    Scene scene(down);
    const BodyHandle box = scene.add(shapes::box(1.0, {1, 1, 1}), BodyStart{.position = {0, 0, 1}});
    scene.contact(box.point({0.5, 0.5, -0.5}), Plane{.normal = {0, 0, 1}});
    for (const Parameter& n : {k, m})
        scene.apply(Force([n](const auto&, const auto&, const auto&) { return Vector(Number(n), 0.0, 0.0); }), box);
    for (const double value : {0.1, 0.3, 0.7}) {
        k.set(value);
        const Attempt run = ran(scene, 0.25);
        EXPECT_NEAR(run.run[box].force(0.1)[0], value + 0.2, 1e-15);
        expect_same_as_planned_anew(scene, run);
    }
}

TEST(Sweeps, run_random_formulas_as_if_planned_anew) {
    int kept = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        Parameter a(0.5, "a"), b(0.7, "b");
        const auto force = [=](const Number& t, const Vector& r, const Vector& v) {
            RandomFormula formula(seed);
            const std::vector<Number> x{a, b, t, r[0], r[1], r[2], v[0], v[1], v[2]};
            Vector f;
            for (int i = 0; i < 3; ++i) f[i] = formula.draw(2) == 0 ? Number(0.0) : 0.3 * formula(3, x);
            return f;
        };
        Scene scene = seed % 3 == 0 ? on_rough_hoop({}) : Scene(down);
        if (seed % 3 != 0) scene.add(Particle{1.0}, FreeStart{{0.1, 0, 1}, {0.5, 0, 0.5}});
        scene.apply(Force(force), BodyHandle{0});
        RandomFormula values(seed + 1000);
        for (int i = 0; i < 5; ++i) {
            static constexpr double some[] = {0.5, 0.7, 0.0, 1.0, -1.0, 0.3};
            a.set(some[values.draw(6)]);
            b.set(some[values.draw(6)]);
            SCOPED_TRACE(a.value());
            SCOPED_TRACE(b.value());
            const Attempt run = ran(scene, 0.5);
            kept += run.run.statistics().planned ? 0 : 1;
            expect_same_as_planned_anew(scene, run);
        }
    }
    EXPECT_GT(kept, 60);
}

}  // namespace
}  // namespace rbdyn::test::test_sweeps
