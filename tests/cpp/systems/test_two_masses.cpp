// Two masses on one smooth rail, springs to the origin and between them (the chapter's first example), and the normal
// modes of this and other scenes against closed forms.
#include <gtest/gtest.h>

#include <numbers>

#include "rbdyn/statics/normal_modes.hpp"
#include "refusal.hpp"
#include "scenes.hpp"
#include "support.hpp"

namespace rbdyn::test::test_two_masses {
namespace {

using nlohmann::json;

struct TwoMasses {
    json file;
    Scene scene;
    BodyHandle one, two;

    explicit TwoMasses(const std::string& name) : file(reference(name)), scene({0.0, 0.0, -parameter(file, "g")}) {
        const auto p = [&](const char* key) { return parameter(file, key); };
        const Rail rail(Line{.direction = {1, 0, 0}});
        one = scene.add(Particle{p("m1")}, rail, {.parameter = p("x1_0"), .speed = p("v1_0")});
        two = scene.add(Particle{p("m2")}, rail, {.parameter = p("x2_0"), .speed = p("v2_0")});
        scene.connect(Spring{.stiffness = p("k1")}, one, Vector3(0, 0, 0));
        scene.connect(Spring{.stiffness = p("k2")}, two, Vector3(0, 0, 0));
        scene.connect(Spring{.stiffness = p("k")}, one, two);
    }
};

const char* const cases[] = {"i_generic", "i_decoupled_xG", "i_stiff", "i_large_m1_weak_k2"};

TEST(TwoMasses, move_as_the_reference_digits_say) {
    for (const char* name : cases)
        for (const double error : {1e-6, 1e-9, 1e-12}) {
            const TwoMasses made(name);
            const json& samples = made.file["values"]["samples"];
            const double until = static_cast<double>(digits(samples.back()["t"]));
            const Attempt found = attempt(made.scene, {.until = until, .error = error});
            const Trajectory& run = found.run;
            EXPECT_EQ(run.engine(), "closed form") << name;
            // doubles hold of a phase of 4e6 rad what they hold: the library says so
            const bool is_beyond = error < 1e-9 && *run.error() > error;
            EXPECT_EQ(found.outcome, is_beyond ? simulating::Outcome::inaccurate : simulating::Outcome::good)
                << found.message;
            EXPECT_LE(*run.error(), std::max(error, 1e-11)) << name;
            const Scales first = scales(run, made.one), second = scales(run, made.two);
            for (const json& s : samples) {
                const double t = static_cast<double>(digits(s["t"]));
                const std::string what = std::string(name) + " at t = " + text(t);
                const double told = *run.error();
                const auto near = [&](double value, const json& exact, double size) {
                    EXPECT_NEAR(value, static_cast<double>(digits(exact)), (told + 4.0 * epsilon) * size) << what;
                };
                near(run[made.one].position(t)[0], s["x1"], first.extent);
                near(run[made.two].position(t)[0], s["x2"], second.extent);
                near(run[made.one].velocity(t)[0], s["v1"], first.speed);
                near(run[made.two].velocity(t)[0], s["v2"], second.speed);
                near(run[made.one].reaction(t)[2], s["Phi1_vertical"], first.reaction);
                near(run[made.two].reaction(t)[2], s["Phi2_vertical"], second.reaction);
                near(run.center_of_mass(t)[0], s["x_G"], first.extent + second.extent);
                near(run.energy(t), s["E"], 8.0 * run.kinetic_energy(t) + 8.0 * std::abs(run.potential(t)));
                const double m = parameter(made.file, "m1") + parameter(made.file, "m2");
                const double pull = parameter(made.file, "k1") * first.extent +
                                    parameter(made.file, "k2") * second.extent +
                                    2.0 * parameter(made.file, "k") * (first.extent + second.extent);
                near(m * run.center_of_mass_acceleration(t)[0], s["m_xG_ddot"], 8.0 * pull);
                near(run.external_force(t)[0], s["minus_k1x1_minus_k2x2"], 8.0 * pull);
            }
        }
}

TEST(TwoMasses, have_the_modes_of_their_pencil) {
    for (const char* name : cases) {
        const TwoMasses made(name);
        const NormalModes modes = normal_modes(made.scene, {{0.0, 0.0}});
        if (std::string(name) != "i_stiff") {
            const auto rest = equilibria(made.scene, {0.1, 0.1});
            ASSERT_EQ(rest.size(), 1U) << name;
            EXPECT_EQ(normal_modes(made.scene, rest[0]).squares, modes.squares) << name;
        }
        const json& values = made.file["values"];
        for (std::size_t k = 0; k < 2; ++k) {
            const double exact = static_cast<double>(digits(values[k == 0 ? "omega_1" : "omega_2"]));
            EXPECT_NEAR(modes.frequencies[k], exact, 2.0 * epsilon * exact) << name;
            const json& shape = values["modes_mass_normalised"][k];
            const double sign =
                modes.shapes(0, static_cast<int>(k)) * static_cast<double>(digits(shape[0])) < 0.0 ? -1.0 : 1.0;
            for (int i = 0; i < 2; ++i)
                EXPECT_NEAR(sign * modes.shapes(i, static_cast<int>(k)),
                            static_cast<double>(digits(shape[static_cast<std::size_t>(i)])),
                            4.0 * epsilon * std::abs(modes.shapes(i, static_cast<int>(k))))
                    << name;
        }
    }
}

TEST(NormalModes, of_a_chain_are_its_sines) {
    // 2 sqrt(k/m) sin(j pi / (2 (n + 1))) along and across a chain under tension
    constexpr int n = 7;
    const double k = 3.0, m = 0.5, apart = 1.0, natural = 0.75;
    Scene scene;
    std::vector<BodyHandle> chain;
    for (int i = 1; i <= n; ++i) chain.push_back(scene.add(Particle{m}, {.position = {apart * i, 0, 0}}));
    const Spring spring{.stiffness = k, .rest_length = natural};
    scene.connect(spring, chain.front(), Vector3(0, 0, 0));
    for (std::size_t i = 1; i < n; ++i) scene.connect(spring, chain[i], chain[i - 1]);
    scene.connect(spring, chain.back(), Vector3(apart * (n + 1), 0, 0));
    const auto rest = equilibria(scene);
    ASSERT_EQ(rest.size(), 1U);
    const NormalModes modes = normal_modes(scene, rest[0]);
    std::vector<double> expected;
    for (int j = 1; j <= n; ++j) {
        const double s = std::sin(j * std::numbers::pi / (2 * (n + 1)));
        expected.push_back(2.0 * std::sqrt(k / m) * s);
        for (int across = 0; across < 2; ++across)
            expected.push_back(2.0 * std::sqrt(k * (apart - natural) / apart / m) * s);
    }
    std::sort(expected.begin(), expected.end());
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(modes.frequencies[i], expected[i], 1e-13 * expected[i]);
    // of unit length in the metric, at right angles
    for (int a = 0; a < 3 * n; ++a)
        for (int b = 0; b < 3 * n; ++b) {
            double sum = 0.0;
            for (int i = 0; i < 3 * n; ++i) sum += m * modes.shapes(i, a) * modes.shapes(i, b);
            EXPECT_NEAR(sum, a == b ? 1.0 : 0.0, 1e-14);
        }
}

TEST(NormalModes, of_bodies_on_joints_are_those_of_their_closed_forms) {
    const RigidBody box = shapes::box(2.0, {0.4, 0.6, 1.0});
    const double arm = 0.7, inertia = box.inertia()(1, 1) + 2.0 * arm * arm;
    Scene hinge(down);
    hinge.add(box, Revolute{.axis = {0, 1, 0}, .point = {0, 0, arm}}, {.angle = 0.3});
    double slow = 0.0, fast = 0.0;
    for (const Equilibrium& e : equilibria(hinge)) {
        const NormalModes modes = normal_modes(hinge, e);
        const double square = 2.0 * gravity * arm / inertia;
        if (e.stable) {
            EXPECT_NEAR(modes.frequencies[0], std::sqrt(square), 4.0 * epsilon * std::sqrt(square));
            EXPECT_NEAR(modes.shapes(0, 0), 1.0 / std::sqrt(inertia), 4.0 * epsilon);
            slow = modes.frequencies[0];
        } else {
            // it falls: the square says how fast, the frequency is none
            EXPECT_NEAR(modes.squares[0], -square, 4.0 * epsilon * square);
            EXPECT_TRUE(std::isnan(modes.frequencies[0]));
            fast = std::sqrt(-modes.squares[0]);
        }
    }
    EXPECT_NEAR(slow, fast, 1e-14);

    // on a ball joint: one mode about each horizontal axis of the body, and a free turn
    Scene ball(down);
    ball.add(box, Spherical{.point = {0, 0, arm}});
    const auto rest = equilibria(ball);
    const NormalModes hanging = normal_modes(ball, rest[0]);
    const double about_x = std::sqrt(2.0 * gravity * arm / (box.inertia()(0, 0) + 2.0 * arm * arm));
    EXPECT_EQ(hanging.frequencies[0], 0.0);
    EXPECT_NEAR(hanging.frequencies[1], std::min(about_x, slow), 1e-13);
    EXPECT_NEAR(hanging.frequencies[2], std::max(about_x, slow), 1e-13);
    // the free turn is about the body's third axis
    EXPECT_NEAR(std::abs(hanging.shapes(2, 0)), 1.0 / std::sqrt(box.inertia()(2, 2)), 1e-13);

    // a free body on a spring at its centre: three times the same, and three free turns
    Scene held;
    const auto body = held.add(box);
    held.connect(Spring{.stiffness = 8.0}, body, Vector3(0, 0, 0));
    const NormalModes six = normal_modes(held, equilibria(held)[0]);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(six.frequencies[i], i < 3 ? 0.0 : 2.0, 1e-14);
}

TEST(NormalModes, are_the_frequencies_of_the_motion_nearby) {
    // beads on a circle and a parabola, joined
    Scene scene(down);
    const auto a = scene.add(Particle{1.0}, Rail(vertical_circle(1.0))),
               b = scene.add(Particle{2.0},
                             Rail(Parabola{.a = 0.5, .x = {1, 0, 0}, .y = {0, 0, 1}, .vertex = {2, 0, -1}}));
    scene.connect(Spring{.stiffness = 5.0, .rest_length = 1.0}, a, b);
    const auto rest = equilibria(scene);
    ASSERT_EQ(rest.size(), 1U);
    const NormalModes modes = normal_modes(scene, rest[0]);
    for (int k = 0; k < 2; ++k) {
        const double small = 1e-5;
        Scene moved(down);
        const auto start = [&](int i) {
            return rest[0].coordinates[static_cast<std::size_t>(i)] + small * modes.shapes(i, k);
        };
        const auto c = moved.add(Particle{1.0}, Rail(vertical_circle(1.0)), {.parameter = start(0)}),
                   d = moved.add(Particle{2.0},
                                 Rail(Parabola{.a = 0.5, .x = {1, 0, 0}, .y = {0, 0, 1}, .vertex = {2, 0, -1}}),
                                 {.parameter = start(1)});
        moved.connect(Spring{.stiffness = 5.0, .rest_length = 1.0}, c, d);
        const double period = 2.0 * std::numbers::pi / modes.frequencies[static_cast<std::size_t>(k)];
        const Trajectory run = simulate(moved, {.until = period, .error = 1e-8});
        // back where it was, and on the other side in the middle, but for what is of second order
        for (int i = 0; i < 2; ++i) {
            const BodyHandle bead = i == 0 ? c : d;
            EXPECT_NEAR(run[bead].parameter(period), start(i), 10.0 * small * small);
            EXPECT_NEAR(run[bead].parameter(0.5 * period) - rest[0].coordinates[static_cast<std::size_t>(i)],
                        -small * modes.shapes(i, k), 10.0 * small * small);
        }
    }
}

TEST(NormalModes, that_do_not_exist_are_refused) {
    Scene scene(down);
    const auto a = scene.add(Particle{1.0}, {.position = {0, 0, 0}});
    scene.connect(Spring{.stiffness = 2.0}, a, Vector3(0, 0, 0));
    const Equilibrium rest = equilibria(scene)[0];
    EXPECT_NE(refusal([&] {
                  normal_modes(scene, {{0.0, 0.0, 1.0}});
              }).find("generalized force of freedom 2"),
              std::string::npos);
    EXPECT_NE(refusal([&] { normal_modes(scene, {{0.0}}); }).find("number of coordinates"), std::string::npos);
    Scene whirled = scene;
    const auto b = whirled.add(Particle{1.0}, {.position = {1, 0, 0}});
    whirled.set_gravity({0, 0, 0});
    whirled.connect(Spring{.stiffness = 2.0}, b, Vector3(1, 0, 0));
    whirled.connect(PairForce([](const auto&, const auto& ra, const auto& rb, const auto&, const auto&) {
                        using T = std::decay_t<decltype(ra[0])>;
                        return Vector3Of<T>{rb[1] - ra[1], T(0.0), T(0.0)};
                    }),
                    a, b);
    EXPECT_NE(refusal([&] { normal_modes(whirled, {{0, 0, 0, 1, 0, 0}}); }).find("no potential"), std::string::npos);
    Scene rough(down);
    rough.add(Particle{1.0}, Rail(vertical_circle(1.0), Coulomb{0.5, 0.4}));
    EXPECT_NE(refusal([&] { normal_modes(rough, {{0.0}}); }).find("friction holds"), std::string::npos);
    EXPECT_EQ(rest.coordinates.size(), 3U);
}

TEST(NormalModes, of_two_free_particles_on_a_spring_are_one_and_five_of_no_frequency) {
    for (const Vector3& way : {Vector3(0.3, 0.7, -0.4), Vector3(-1.1, 0.1, 0.35), Vector3(0.9, 1.3, 0.77)}) {
        Scene scene;
        const BodyHandle a = scene.add(Particle{0.3}, FreeStart{{0.1, 0.2, 0.3}, {0, 0, 0}}),
                         b = scene.add(Particle{0.7}, FreeStart{Vector3(0.1, 0.2, 0.3) + way, {0, 0, 0}});
        scene.connect(Spring{.stiffness = 1.9, .rest_length = way.norm()}, a, b);
        const Vector3 end = Vector3(0.1, 0.2, 0.3) + way;
        const NormalModes modes = normal_modes(scene, {{0.1, 0.2, 0.3, end[0], end[1], end[2]}});
        ASSERT_EQ(modes.squares.size(), 6u);
        for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(modes.squares[k], 0.0) << k;
        EXPECT_NEAR(modes.squares[5], 1.9 / 0.3 + 1.9 / 0.7, 1e-13);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_two_masses
