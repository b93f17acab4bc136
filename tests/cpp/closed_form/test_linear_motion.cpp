// Scenes with linear equations: which are, and their motion against digits from elsewhere.
#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/closed_form/linear_flow.hpp"
#include "rbdyn/closed_form/linear_modes.hpp"
#include "rbdyn/closed_form/linear_system.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"
#include "rbdyn/engine/closed_form.hpp"
#include "support.hpp"

namespace rbdyn::test::test_linear_motion {
namespace {

using Build = std::function<void(Scene&)>;

/// A force that is linear in position and velocity.
template <class F>
Force traced(F f) {
    return Force([f](const auto&, const auto& r, const auto& v) { return f(r, v); });
}
BodyHandle particle(Scene& s, double mass, const Vector3& position, const Vector3& velocity = Vector3::Zero()) {
    return s.add(Particle{mass}, FreeStart{.position = position, .velocity = velocity});
}

// --- numbers of 32 digits ---

TEST(SymmetricModes, have_32_digits_whatever_their_values) {
    Random random(1);
    // apart, equal, and equal for all of the digits of doubles, or half of them
    for (const double apart : {1.0, 0.0, 1e-20, 1e-12})
        for (int n = 1; n <= 12; n += 1 + n / 3) {
            // A = B diag B^T, B a product of mirrors, exact but for rounding of 32 digits
            WideMatrix a(n);
            for (int i = 0; i < n; ++i)
                a(i, i) = DoubleDouble(i / 3 + 1.0) + DoubleDouble(apart) * random.uniform(0.5, 1.0);
            for (int k = 0; k < 3; ++k) {
                std::vector<DoubleDouble> v;
                DoubleDouble square = 0.0;
                for (int i = 0; i < n; ++i) {
                    v.emplace_back(random.uniform(-1.0, 1.0));
                    square += v.back() * v.back();
                }
                WideMatrix mirror(n);
                for (int i = 0; i < n; ++i)
                    for (int j = 0; j < n; ++j)
                        mirror(i, j) = (i == j ? 1.0 : 0.0) -
                                       2.0 * v[static_cast<std::size_t>(i)] * v[static_cast<std::size_t>(j)] / square;
                a = product(product(mirror, a), mirror);
                for (int i = 0; i < n; ++i)
                    for (int j = 0; j < i; ++j) a(i, j) = a(j, i);
            }
            const SymmetricModes modes = symmetric_modes(a);
            const WideMatrix ax = product(a, modes.vectors);
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    DoubleDouble overlap = i == j ? -1.0 : 0.0;
                    for (int k = 0; k < n; ++k) overlap += modes.vectors(k, i) * modes.vectors(k, j);
                    EXPECT_LE(std::abs(overlap.hi), 1e-28) << n << " " << apart;
                    const DoubleDouble rest =
                        ax(i, j) - modes.values[static_cast<std::size_t>(j)] * modes.vectors(i, j);
                    EXPECT_LE(std::abs(rest.hi), 1e-28 * a.largest()) << n << " " << apart;
                }
        }
}

// --- what the blocks of a motion know beyond doubles ---

/// y'' = -k y from a start, k known to `error`.
LinearModes one_mode(DoubleDouble stiffness, double error, DoubleDouble start, double rate) {
    WideMatrix matrix(1), shape(1);
    matrix(0, 0) = stiffness;
    shape(0, 0) = 1.0;
    return {{0},
            {1},
            {{1.0}, matrix},
            std::make_shared<const SymmetricModes>(SymmetricModes{{stiffness}, shape, error}),
            {0.0, 0.0},
            {-stiffness * start},
            {start},
            {rate}};
}

TEST(LinearModes, add_what_moves_to_all_digits_of_the_start) {
    // a free particle that starts 0.4 units in the last place beyond 1, and has moved by 0.3 of them
    constexpr double unit = 0x1p-52;
    const LinearModes modes = one_mode(0.0, 0.0, DoubleDouble(1.0) + 0.4 * unit, 1.0);
    std::vector<double> x(2);
    modes.state({0.3 * unit, 0.0}, x);
    EXPECT_EQ(x[0], 1.0 + unit);
    modes.state({0.05 * unit, 0.0}, x);
    EXPECT_EQ(x[0], 1.0);
}

TEST(LinearModes, estimate_what_the_error_of_their_values_makes_of_the_motion) {
    constexpr double off = 1e-20;
    const LinearModes modes = one_mode(4.0, off, 1.0, 0.5), other = one_mode(DoubleDouble(4.0) + off, off, 1.0, 0.5);
    double most = 0.0;
    for (int k = 0; k < 40; ++k) {
        const double t = 1e10 + 0.1 * k;
        std::vector<double> x(2), y(2), errors(2, 0.0);
        modes.state({t, 0.0}, x);
        other.state({t, 0.0}, y);
        modes.add_errors(t, errors);
        for (std::size_t i = 0; i < 2; ++i) {
            EXPECT_LE(std::abs(x[i] - y[i]), 1.1 * errors[i]) << t << ' ' << i;
            most = std::max(most, std::abs(x[i] - y[i]) / errors[i]);
        }
    }
    EXPECT_GT(most, 0.1);
}

TEST(LinearFlow, knows_the_time_beyond_doubles) {
    // x' = y, y' = -x: a turn by late more
    WideMatrix a(2);
    a(0, 1) = 1.0;
    a(1, 0) = -1.0;
    const LinearFlow flow({0, 1}, a, {DoubleDouble(0.25), DoubleDouble(-1.0)}, {DoubleDouble(1.0), DoubleDouble(0.25)});
    for (const double t : {1.0, 1e3, 1e6, 1e9}) {
        const double late = 0.3 * epsilon * t;
        std::vector<double> x(2), later(2);
        flow.state({t, 0.0}, x);
        flow.state({t, late}, later);
        EXPECT_NEAR(later[0], std::cos(late) * x[0] + std::sin(late) * x[1], 2 * epsilon) << t;
        EXPECT_NEAR(later[1], std::cos(late) * x[1] - std::sin(late) * x[0], 2 * epsilon) << t;
    }
}

// --- which scenes are linear ---

TEST(LinearScenes, are_known_by_their_equations) {
    const Rail rail(incline(0.5));
    const auto pulled = [](Scene& s, BodyHandle b) { s.connect(Spring{.stiffness = 4.0}, b, Vector3(1, 0, 0)); };
    const auto pushed = [&](Scene& s, auto f) {
        const BodyHandle b = particle(s, 1.0, {0, 1, 2});
        pulled(s, b);
        s.apply(Force([f](const auto& t, const auto&, const auto&) {
                    return Vector3Of<std::decay_t<decltype(t)>>{f(t), 0.0 * t, 0.0 * t};
                }),
                b);
    };
    const struct {
        const char* name;
        Build build;
        const char* says;  // of the form, or why there is none
    } cases[] = {
        {"a spring in space",
         [&](Scene& s) {
             pulled(s, particle(s, 1.0, {0, 1, 2}, {1, 1, 1}));
         },
         "modes of"},
        {"two springs and a weight between",
         [&](Scene& s) {
             const BodyHandle a = particle(s, 1.0, {0, 1, 2}), b = particle(s, 2.0, {3, 1, 2});
             s.connect(Spring{.stiffness = 2.0}, a, b);
             pulled(s, a);
         },
         "modes of"},
        {"a bead on an incline", [&](Scene& s) { pulled(s, s.add(Particle{1.0}, rail, {.parameter = 0.5})); },
         "modes of"},
        {"linear drag",
         [&](Scene& s) {
             s.apply(Drag{.linear = 0.5}, particle(s, 1.0, {0, 0, 0}, {1, 0, 1}));
         },
         "modes of"},
        {"a damper along a line",
         [&](Scene& s) {
             s.connect(Spring{.stiffness = 3.0, .damping = 1.0},
                       s.add(Particle{1.0}, Rail(along_x), {.parameter = 0.5}), Vector3(0, 0, 0));
         },
         "modes of"},
        {"a quadratic potential",
         [&](Scene& s) {
             s.apply(Potential([](const auto& r) { return r[0] * r[1] - r[2] * r[2]; }), particle(s, 1.0, {1, 0, 0}));
         },
         "modes of"},
        {"a magnetic field",
         [&](Scene& s) {
             s.apply(Lorentz{2.0, {0, 1, 1}}, particle(s, 1.0, {0, 0, 0}, {1, 0, 0}));
         },
         "exponential of"},
        {"a traced force without symmetry",
         [&](Scene& s) {
             s.apply(traced([](const auto& r, const auto& v) {
                         return Vector3Of<std::decay_t<decltype(r[0])>>{r[1] - r[0], -r[1], -2.0 * v[0]};
                     }),
                     particle(s, 1.0, {1, 1, 0}));
         },
         "exponential of"},
        {"a body on a slide",
         [&](Scene& s) {
             const BodyHandle b =
                 s.add(RigidBody(2.0, {1, 1, 1}), Prismatic{.axis = {1, 0, 0}}, PrismaticStart{.displacement = 0.5});
             s.connect(Spring{.stiffness = 4.0}, b, Vector3(0, 0, 0));
         },
         "modes of"},
        {"free fall",
         [&](Scene& s) {
             particle(s, 1.0, {0, 0, 0}, {1, 0, 1});
         },
         "polynomial"},
        {"a rest length",
         [&](Scene& s) {
             s.connect(Spring{.stiffness = 4.0, .rest_length = 1.0}, particle(s, 1.0, {0, 1, 2}), Vector3(0, 0, 0));
         },
         "particle 1 are not linear"},
        {"quadratic drag",
         [&](Scene& s) {
             s.apply(Drag{.quadratic = 0.5}, particle(s, 1.0, {0, 0, 0}, {1, 0, 1}));
         },
         "not linear"},
        {"a hoop", [&](Scene& s) { s.add(Particle{1.0}, Rail(vertical_circle(1.0)), {.parameter = 0.5}); },
         "not linear"},
        {"friction",
         [&](Scene& s) {
             pulled(s, s.add(Particle{1.0}, Rail(incline(0.5), Coulomb{0.5, 0.25})));
         },
         "friction"},
        {"a force that changes in time", [&](Scene& s) { pushed(s, [](const auto& t) { return t; }); },
         "forced motion of a linear scene"},
        {"a force that changes in time as nothing linear does",
         [&](Scene& s) { pushed(s, [](const auto& t) { return tanh(t); }); }, "what forces them varies in time"},
        {"a side of a case distinction",
         [&](Scene& s) {
             s.apply(traced([](const auto& r, const auto&) {
                         using S = std::decay_t<decltype(r[0])>;
                         return Vector3Of<S>{S(-1.0) * abs(r[0]), S(0.0), S(0.0)};
                     }),
                     particle(s, 1.0, {1, 0, 0}));
         },
         "change from one formula to the next"},
        {"an action",
         [&](Scene& s) {
             const BodyHandle b = particle(s, 1.0, {0, 1, 2});
             pulled(s, b);
             s.watch(
                 "x", [b](const Now& now) { return now[b].position()[0]; },
                 {.action = {WatchAction::Kind::change, [](const Observe&) { return std::vector<StateChange>{}; }}});
         },
         "changes the state"},
        {"a sphere that is watched",
         [&](Scene& s) {
             const BodyHandle b = particle(s, 1.0, {0, 1, 2});
             pulled(s, b);
             s.watch("r", [b](const Now& now) {
                 const auto r = now[b].position();
                 return dot<Expression>(r, r) - 1.0;
             });
         },
         "modes of"},
    };
    for (const auto& c : cases) {
        Scene scene(down);
        c.build(scene);
        const Plan plan = make_plan(scene);
        std::string said = plan.reason;
        if (plan.engine != "closed form")
            for (const Omission& o : plan.omissions)
                if (o.what == "closed form") said = o.why;
        EXPECT_NE(said.find(c.says), std::string::npos) << c.name << ": " << said;
        // those whose formula changes have one after the other, and are integrated
        EXPECT_EQ(plan.engine, is_one_form(plan.closed) ? "closed form" : "taylor") << c.name;
        if (!plan.closed) {
            EXPECT_THROW((void)simulate(scene, {.until = 1.0, .engine = "closed form"}), InvalidInput) << c.name;
        }
    }
}

// --- against digits of 100 ---

struct At {
    double time;
    std::vector<double> state;  // positions of all bodies, then velocities
};

/// The largest error of places to their extents, and of velocities to the largest, after a run to a time.
double error_of(const Scene& scene, int axes, const At& exact) {
    const Trajectory run = simulate(scene, {.until = exact.time, .error = 1e-12});
    EXPECT_EQ(run.engine(), "closed form");
    const int count = static_cast<int>(scene.bodies().size());
    double worst = 0.0;
    for (int i = 0; i < count; ++i) {
        const BodyHandle body{i};
        Vector3 x = Vector3::Zero(), v = x;
        for (int k = 0; k < axes; ++k) {
            x[k] = exact.state[static_cast<std::size_t>(i * axes + k)];
            v[k] = exact.state[static_cast<std::size_t>((count + i) * axes + k)];
        }
        // also what was there before it died away
        Scales s = scales(run, body, 500);
        if (exact.time > 10.0) s.speed = std::max(s.speed, scales(simulate(scene, {.until = 10.0}), body, 500).speed);
        worst = std::max({worst, relative((run[body].position(exact.time) - x).norm(), s.extent),
                          relative((run[body].velocity(exact.time) - v).norm(), s.speed)});
    }
    EXPECT_LE(worst, *run.error());
    EXPECT_LE(*run.error(), 2e-14);
    return worst;
}

TEST(LinearScenes, keep_their_digits_for_a_million_seconds) {
    Scene line;
    const BodyHandle a = particle(line, 1.0, {0.25, 0, 0}, {1, 0, 0}),
                     b = particle(line, 2.0, {0.75, 0, 0}, {-0.5, 0, 0});
    line.connect(Spring{.stiffness = 3.0}, a, Vector3(-1, 0, 0));
    line.connect(Spring{.stiffness = 5.0}, a, b);
    line.connect(Spring{.stiffness = 4.0}, b, Vector3(2, 0, 0));
    for (const At& exact :
         {At{1e2, {-0.07308330679634367759, 1.004505259061103414, 1.141234453939210754, -0.1369955281053304803}},
          At{1e4, {0.04489352473507598082, 1.309284801741327945, 0.7045292681083524891, 0.08353032086993066368}},
          At{1e6, {-0.001849625183018187544, 0.9228574772720623048, 1.277456708179123482, -0.2741638768666809229}}})
        EXPECT_LE(error_of(line, 1, exact), 2e-15) << exact.time;

    // one mode of three the drag does not reach
    Scene three;
    const BodyHandle p = particle(three, 1.0, {0.5, 0, 0}), q = particle(three, 1.0, {0.25, 0, 0}),
                     r = particle(three, 1.0, {-0.25, 0, 0});
    three.connect(Spring{.stiffness = 2.0}, p, q);
    three.connect(Spring{.stiffness = 2.0}, q, r);
    for (const BodyHandle end : {p, r}) three.connect(Spring{.stiffness = 3.0}, end, Vector3(0, 0, 0));
    three.apply(Drag{.linear = 0.25}, q);
    for (const At& exact :
         {At{1e2,
             {-0.3190310808112544106, 8.130950903676599535e-6, 0.3188998509276717408, 0.4410249074652093118,
              -4.220944206076795463e-4, -0.4408597968207464921}},
          At{1e4,
             {0.143978714704792643, 0.0, -0.143978714704792643, 0.7742581278616193085, 0.0, -0.7742581278616193085}},
          At{1e6,
             {-0.05099120006594627471, 0.0, 0.05099120006594627471, -0.8307373156294191671, 0.0,
              0.8307373156294191671}}})
        EXPECT_LE(error_of(three, 1, exact), 2e-15) << exact.time;
}

TEST(LinearScenes, keep_their_digits_among_equal_frequencies_and_in_translation) {
    Scene scene;
    const BodyHandle a = particle(scene, 1.0, {0, 0, 0}, {0.5, 0, 0}),
                     b = particle(scene, 1.0, {1, 0, 0.5}, {0, 0.25, 0}),
                     c = particle(scene, 1.0, {0.25, 1, 0}, {0, 0, -0.125});
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) scene.connect(Spring{.stiffness = 2.0}, from, to);
    EXPECT_LE(error_of(scene, 3,
                       {1e6,
                        {166667.5009305676157, 83333.91720629402016, -41666.35484014821078, 166666.570301342543,
                         83333.97687640835757, -41666.76048464640973, 166667.1787680898414, 83333.10591729762227,
                         -41666.38467520537949, 0.4929381445747154595, 0.6283016643990347731, 0.1632100824996930043,
                         -0.5335001013239694195, 0.4254794152995616263, -0.552831289549122582, 0.54056195674925396,
                         -0.8037810796985963994, 0.2646212070494295777}}),
              1e-15);
}

TEST(LinearScenes, keep_their_digits_in_growth_and_decay) {
    // a hill instead of a well
    Scene hill;
    const BodyHandle top = particle(hill, 1.0, {0.5, 0, 0}), tied = particle(hill, 1.0, {0.25, 0, 0}, {0.125, 0, 0});
    hill.apply(Potential([](const auto& r) { return 2.0 * r[0] * r[0]; }), top);
    hill.connect(Spring{.stiffness = 1.0}, top, tied);
    for (const At& exact :
         {At{1.0, {1.653781860980464158, 0.5496680161580553952, 2.903091017492293068, 0.6091780828781264678}},
          At{10.0,
             {1.769942060096922314e+7, 4.178266328694077244e+6, 3.183961932746586627e+7, 7.516314699867991171e+6}},
          At{40.0,
             {4.848710871889313274e+30, 1.144625369008152087e+30, 8.722382061597795981e+30, 2.059075092261837768e+30}}})
        EXPECT_LE(error_of(hill, 1, exact), 2e-15) << exact.time;

    // drag in proportion to the masses, and on one of them alone
    for (const bool on_both : {true, false}) {
        Scene damped;
        const BodyHandle a = particle(damped, 1.0, {1, 0, 0}), b = particle(damped, 2.0, {2, 0, 0});
        damped.connect(Spring{.stiffness = 4.0}, a, b);
        damped.connect(Spring{.stiffness = 3.0}, a, Vector3(0, 0, 0));
        damped.apply(Drag{.linear = on_both ? 0.0625 : 0.25}, a);
        if (on_both) damped.apply(Drag{.linear = 0.125}, b);
        EXPECT_EQ(make_plan(damped).closed->name(),
                  on_both ? "modes of a linear scene" : "exponential of a linear scene");
        EXPECT_LE(error_of(damped, 1,
                           {1.0, on_both ? std::vector{1.030965814388221554, 1.215101901627834337,
                                                       -0.5959150068394680748, -1.249946058353345514}
                                         : std::vector{1.022411961854611831, 1.197301996221956894,
                                                       -0.5931021323844155188, -1.296815309034793739}}),
                  2e-15);
        EXPECT_LE(error_of(damped, 1,
                           {1e2, on_both ? std::vector{-0.05430911140567985647, -0.08184115308315351233,
                                                       -0.01603627705298069446, 0.02838556813993423869}
                                         : std::vector{-0.1414383487033623737, -0.2196644705592501392,
                                                       0.04208982154268488826, 0.07129660000430168914}}),
                  2e-15);
        EXPECT_LE(error_of(damped, 1, {1e4, {0, 0, 0, 0}}), 2e-15);
    }

    // (1 + 3 t) e^{-t}
    Scene critical;
    const BodyHandle a = particle(critical, 2.0, {1, 0, 0}, {2, 0, 0});
    critical.connect(Spring{.stiffness = 2.0}, a, Vector3(0, 0, 0));
    critical.apply(Drag{.linear = 4.0}, a);
    for (double t : {0.5, 5.0, 50.0})
        EXPECT_LE(error_of(critical, 1, {t, {(1 + 3 * t) * std::exp(-t), (2 - 3 * t) * std::exp(-t)}}), 2e-15);
}

TEST(LinearScenes, keep_their_digits_in_a_magnetic_field_and_in_resonance) {
    Scene field(down);
    field.apply(Lorentz{2.0, {0.25, -1, 0.5}}, particle(field, 0.5, {1, 0, 0}, {0, 1, 0.25}));
    EXPECT_LE(error_of(field, 3,
                       {1e2,
                        {-4875.353667376509649, 18710.33213807459176, -9378.658890162561658, -93.97128450106311594,
                         375.0484445904576407, -185.9174685685531607}}),
              2e-15);
    EXPECT_LE(error_of(field, 3,
                       {1e6,
                        {-4.67263940475034668e+11, 1.86904781845198808e+12, -9.345241428580065069e+11,
                         -934528.0498683714234, 3.738095062829176547e+6, -1.869047599407461195e+6}}),
              2e-15);

    // x'' = y - x, y'' = -y from (0, 1): x = t sin(t)/2, a matrix without a full set of eigenvectors
    Scene resonance;
    resonance.apply(traced([](const auto& r, const auto&) {
                        return Vector3Of<std::decay_t<decltype(r[0])>>{r[1] - r[0], -r[1], 0.0 * r[2]};
                    }),
                    particle(resonance, 1.0, {0, 1, 0}));
    for (double t : {1.0, 1e3, 1e6})
        EXPECT_LE(
            error_of(resonance, 2,
                     {t, {0.5 * t * std::sin(t), std::cos(t), 0.5 * (std::sin(t) + t * std::cos(t)), -std::sin(t)}}),
            2e-15)
            << t;
}

// --- against each other ---

/// Particles on a line, every two of them joined or not, masses and stiffnesses of very different sizes.
LinearSystem chain(Random& random, int n) {
    LinearSystem system;
    system.rows.resize(static_cast<std::size_t>(2 * n));
    system.constants.resize(system.rows.size());
    std::vector<DoubleDouble> masses;
    for (int i = 0; i < n; ++i) {
        masses.emplace_back(random.logarithmic(0.01, 100.0));
        system.rows[static_cast<std::size_t>(i)] = {{n + i, 1.0}};
        system.constants[static_cast<std::size_t>(n + i)] = random.uniform(-1.0, 1.0);
    }
    WideMatrix k(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
            if (j + 1 < i && random.chance(0.5)) continue;
            const DoubleDouble stiffness = random.logarithmic(0.01, 100.0);
            k(i, i) += stiffness;
            if (i == j) continue;
            k(j, j) += stiffness;
            k(i, j) -= stiffness;
            k(j, i) -= stiffness;
        }
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            if (k(i, j).hi != 0.0)
                system.rows[static_cast<std::size_t>(n + i)].push_back(
                    {j, -k(i, j) / masses[static_cast<std::size_t>(i)]});
    for (int i = 0; i < 2 * n; ++i) system.start.emplace_back(random.uniform(-1.0, 1.0));
    return system;
}

TEST(LinearScenes, by_modes_and_by_the_exponential_are_the_same) {
    Random random(2);
    for (int draw = 0; draw < 30; ++draw) {
        const int n = random.whole(1, 5);
        LinearSystem system = chain(random, n);
        // damping by the mass, by the stiffness, by both or by none
        const double by_mass = random.chance(0.5) ? random.logarithmic(1e-8, 1.0) : 0.0,
                     by_stiffness = random.chance(0.5) ? random.logarithmic(1e-8, 0.1) : 0.0;
        for (int i = 0; i < n; ++i) {
            auto& row = system.rows[static_cast<std::size_t>(n + i)];
            for (std::size_t e = 0, count = row.size(); e < count; ++e)
                if (const DoubleDouble d = row[e].value * by_stiffness - (row[e].column == i ? by_mass : 0.0);
                    d.hi != 0.0)
                    row.push_back({n + row[e].column, d});
        }
        const LinearBlocks modes = solve(system);
        EXPECT_TRUE(modes.by_modes);
        std::vector<int> all(static_cast<std::size_t>(2 * n));
        std::iota(all.begin(), all.end(), 0);
        WideMatrix a(2 * n);
        for (int i = 0; i < 2 * n; ++i)
            for (const auto& e : system.rows[static_cast<std::size_t>(i)]) a(i, e.column) = e.value;
        const LinearFlow flow(all, a, system.rates(), system.start);
        for (const double t : {1e-3, 1.0, 1e2, 1e4, 1e6}) {
            std::vector<double> x(all.size()), y(x), errors(x), sizes(x);
            for (const auto& block : modes.blocks) {
                block->state({t, 0.0}, x);
                block->add_errors(t, errors);
            }
            flow.state({t, 0.0}, y);
            flow.add_errors(t, errors);
            for (std::size_t i = 0; i < x.size(); ++i)
                EXPECT_LE(std::abs(x[i] - y[i]), 2.0 * (errors[i] + epsilon * std::abs(y[i])))
                    << draw << " " << t << " " << i;
        }
    }
}

TEST(LinearScenes, of_any_kind_move_as_they_are_integrated) {
    Random random(3);
    for (int draw = 0; draw < 20; ++draw) {
        // forces without any symmetry, that do not make it grow by more than the comparison bears
        SquareMatrix k(3), d(3);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                k(i, j) = random.uniform(-1.0, 1.0) + (i == j ? 4.0 : 0.0);
                d(i, j) = random.uniform(-1.0, 1.0) + (i == j ? 1.0 : 0.0);
            }
        Scene scene(down);
        const BodyHandle body = particle(scene, random.uniform(0.5, 2.0), {1, 0, 0}, 2.0 * random.direction());
        scene.apply(traced([=](const auto& r, const auto& v) {
                        std::decay_t<decltype(v)> f = 0.0 * r;
                        for (int i = 0; i < 3; ++i)
                            for (int j = 0; j < 3; ++j) f[i] = f[i] - k(i, j) * r[j] - d(i, j) * v[j];
                        return f;
                    }),
                    body);
        const Trajectory exact = simulate(scene, {.until = 10.0}),
                         other = simulate(scene, {.until = 10.0, .rtol = 1e-16, .engine = "taylor"});
        EXPECT_EQ(exact.engine(), "closed form");
        const Scales s = scales(exact, body, 100);
        for (double t : {0.001, 0.5, 3.0, 10.0}) {
            EXPECT_LE((exact[body].position(t) - other[body].position(t)).norm(), 1e-13 * s.extent) << draw;
            EXPECT_LE((exact[body].velocity(t) - other[body].velocity(t)).norm(), 1e-13 * s.speed) << draw;
            EXPECT_LE((exact[body].acceleration(t) - other[body].acceleration(t)).norm(), 1e-12 * s.speed) << draw;
        }
    }
}

// --- what a run is asked for besides ---

TEST(LinearScenes, have_events_at_any_time) {
    // x = cos 2t
    Scene scene;
    const BodyHandle body = particle(scene, 1.0, {1, 0, 0});
    scene.connect(Spring{.stiffness = 4.0}, body, Vector3(0, 0, 0));
    scene.watch("middle", [body](const Now& now) { return now[body].position()[0]; });
    const Trajectory run = simulate(scene, {.until = 300.0, .error = 1e-12});
    EXPECT_EQ(run.engine(), "closed form");
    ASSERT_EQ(run.events().size(), 191u);
    for (std::size_t i = 0; i < run.events().size(); ++i)
        EXPECT_NEAR(run.events()[i].time, (2.0 * static_cast<double>(i) + 1.0) * std::numbers::pi / 4.0,
                    4e-15 * (run.events()[i].time + 1.0));
    EXPECT_LE(*run.error(), 1e-14);

    scene.watch("far out", [body](const Now& now) { return now[body].position()[0] + 0.5; },
                {.direction = Direction::falling, .action = {WatchAction::Kind::stop}});
    const Trajectory stopped = simulate(scene, {.until = 300.0});
    EXPECT_EQ(stopped.status(), Status::stopped_by_event);
    EXPECT_NEAR(stopped.end(), std::numbers::pi / 3.0, 4e-15);
    EXPECT_NEAR(stopped[body].position(stopped.end())[0], -0.5, 4e-15);
}

TEST(LinearScenes, end_where_their_rails_end) {
    // x = 1 - cos t to the end at 1.5
    Scene scene;
    const Polynomial rail{.coefficients = {{0, 0, 0}, {1, 0, 0}}, .domain = {0.0, 1.5}};
    const BodyHandle bead = scene.add(Particle{2.0}, Rail(rail), {.parameter = 0.0, .speed = 0.0});
    scene.connect(Spring{.stiffness = 2.0}, bead, Vector3(1, 0, 0));
    const Trajectory run = simulate(scene, {.until = 10.0, .error = 1e-12});
    EXPECT_EQ(run.engine(), "closed form");
    EXPECT_EQ(kinds(run), "rail-end");
    EXPECT_NEAR(run.end(), 2.0 * std::numbers::pi / 3.0, 4e-15);
}

TEST(LinearScenes, have_the_work_of_their_forces_over_many_periods) {
    Scene scene(down);
    const BodyHandle bead = scene.add(Particle{0.5}, Rail(incline(0.75)), {.parameter = 0.25, .speed = 1.0});
    scene.connect(Spring{.stiffness = 50.0}, bead, Vector3(1, 0.5, 0));
    const LoadHandle drag = scene.apply(Drag{.linear = 0.005}, bead);
    const Trajectory run = simulate(scene, {.until = 400.0});
    EXPECT_EQ(run.engine(), "closed form");
    const double lost = run.energy(0.0) - run.energy(400.0);
    EXPECT_NEAR(run.work(0.0, 400.0, drag), -lost, 1e-12 * lost);
    // m a = F + Phi, and the rail does not pull along itself
    const PointReport r = run[bead].report(123.0);
    EXPECT_NEAR((0.5 * r.acceleration - r.force - r.reaction).norm(), 0.0, 1e-13);
    EXPECT_NEAR(r.reaction.dot(r.velocity), 0.0, 1e-12);
}

TEST(LinearScenes, are_asked_by_many_at_once) {
    Scene field(down);
    field.apply(Lorentz{2.0, {0.25, -1, 0.5}}, particle(field, 0.5, {1, 0, 0}, {0, 1, 0.25}));
    const Plan one = make_plan(field), many = make_plan(field);
    std::vector<double> alone(6);
    one.closed->state({1e5, 0.0}, alone);
    std::vector<std::vector<double>> seen(4, std::vector<double>(6));
    std::vector<std::thread> threads;
    for (auto& x : seen) threads.emplace_back([&] { many.closed->state({1e5, 0.0}, x); });
    for (std::thread& t : threads) t.join();
    for (const auto& x : seen) EXPECT_EQ(x, alone);
}

}  // namespace
}  // namespace rbdyn::test::test_linear_motion
