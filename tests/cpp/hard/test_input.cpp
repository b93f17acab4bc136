// Bad input is refused with a sentence that names the object, the number and the rule.
#include <gtest/gtest.h>

#include "support.hpp"

namespace rbdyn::test::test_input {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

/// Runs f, which must throw InvalidInput with a message that holds all the words.
template <class F>
void expect_refused(F&& f, std::initializer_list<std::string> words) {
    try {
        f();
        FAIL() << "not refused; expected a message with \"" << *words.begin() << '"';
    } catch (const InvalidInput& e) {
        const std::string message = e.what();
        for (const std::string& word : words)
            EXPECT_NE(message.find(word), std::string::npos) << "\"" << word << "\" is not in: " << message;
    }
}

Scene sliding() {
    Scene scene(down);
    scene.add(Particle{1.0}, Rail(along_x, Coulomb{0.5, 0.25}), {.parameter = 0.0, .speed = 1.0}, "slider");
    return scene;
}

TEST(Input, masses_are_positive_and_finite) {
    Scene scene;
    expect_refused([&] { scene.add(Particle{-1.5}); }, {"Particle", "mass", "-1.5", "positive"});
    expect_refused([&] { scene.add(Particle{0.0}, Rail(along_x)); }, {"Particle", "mass", "0", "positive"});
    expect_refused([&] { scene.add(Particle{nan}); }, {"Particle", "mass", "nan"});
    expect_refused([&] { scene.add(Particle{infinity}); }, {"Particle", "mass", "inf"});
    EXPECT_TRUE(scene.bodies().empty());
}

TEST(Input, friction_coefficients_are_not_negative_and_the_dynamic_one_is_not_above_the_static_one) {
    expect_refused([] { Rail(along_x, Coulomb{0.25, 0.375}); }, {"Coulomb", "mu_dynamic", "0.375", "0.25"});
    expect_refused([] { Rail(along_x, Coulomb{-0.25}); }, {"Coulomb", "mu_static", "-0.25"});
    expect_refused([] { Rail(along_x, Coulomb{0.25, -0.125}); }, {"Coulomb", "mu_dynamic", "-0.125"});
    expect_refused([] { Rail(along_x, Coulomb{nan}); }, {"Coulomb", "mu_static", "nan"});
    expect_refused([] { Rail(along_x, Coulomb{0.5, nan}); }, {"Coulomb", "mu_dynamic", "nan"});
    expect_refused([] { Rail(along_x, Coulomb{infinity}); }, {"Coulomb", "mu_static", "inf"});
}

TEST(Input, gravity_drives_positions_and_speeds_are_finite) {
    expect_refused([] { Scene(Vector3(0, nan, 0)); }, {"gravity", "1", "nan"});
    expect_refused([] { Rail(along_x, Coulomb{0.5}, {.drive = infinity}); }, {"Rail", "drive", "inf"});
    Scene scene;
    expect_refused(
        [&] {
            scene.add(Particle{1.0}, {.position = {0, 0, nan}}, "stone");
        },
        {"stone", "position", "2", "nan"});
    expect_refused(
        [&] {
            scene.add(Particle{1.0}, {.velocity = {infinity, 0, 0}}, "stone");
        },
        {"stone", "velocity", "0", "inf"});
    expect_refused([&] { scene.add(Particle{1.0}, Rail(along_x), {.speed = nan}, "slider"); },
                   {"slider", "speed", "nan"});
    expect_refused([&] { scene.add(Particle{1.0}, Rail(along_x), {.parameter = nan}, "slider"); },
                   {"slider", "parameter", "nan"});
    expect_refused([&] { scene.add(Particle{1.0}, Rail(along_x), {.arc_length = infinity}, "slider"); },
                   {"slider", "arc_length", "inf"});
    expect_refused([&] { scene.add(Particle{1.0}, Rail(along_x), {.parameter = 1.5, .arc_length = 2.5}, "slider"); },
                   {"slider", "parameter", "1.5", "arc_length", "2.5"});
}

TEST(Input, a_bead_starts_on_its_curve_where_the_curve_has_a_tangent) {
    const Polynomial arc{.coefficients = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, .domain = {-1.0, 2.0}};
    Scene scene(down);
    expect_refused([&] { scene.add(Particle{1.0}, Rail(arc), {.parameter = 2.5}, "slider"); },
                   {"slider", "parameter", "2.5", "-1", "2"});
    expect_refused([&] { scene.add(Particle{1.0}, Rail(arc), {.parameter = -1.25}, "slider"); },
                   {"slider", "parameter", "-1.25", "-1", "2"});
    // r = (u^2, 0, u^3) has a cusp at u = 0
    const Polynomial cusp{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}};
    expect_refused([&] { scene.add(Particle{1.0}, Rail(cusp), {.parameter = 0.0}); },
                   {"polynomial", "parameter", "0", "cusp"});
    EXPECT_NO_THROW(scene.add(Particle{1.0}, Rail(cusp), {.parameter = 0.5}));
}

TEST(Input, loads_and_couplings_are_physical_and_join_what_is_there) {
    Scene scene = sliding();
    const BodyHandle slider{0};
    expect_refused([&] { scene.apply(Drag{.linear = -0.5}, slider); }, {"Drag", "linear", "-0.5"});
    expect_refused([&] { scene.apply(Drag{.quadratic = nan}, slider); }, {"Drag", "quadratic", "nan"});
    expect_refused([] { Force(Vector3(0, infinity, 0)); }, {"Force", "1", "inf"});
    expect_refused([&] { scene.connect(Spring{.stiffness = -2.0}, slider, Vector3(0, 0, 0)); },
                   {"Spring", "stiffness", "-2"});
    expect_refused([&] { scene.connect(Spring{.stiffness = 1.0, .damping = nan}, slider, Vector3(0, 0, 0)); },
                   {"Spring", "damping", "nan"});
    expect_refused([&] { scene.connect(Spring{.stiffness = 1.0}, slider, slider); }, {"same body"});
    expect_refused([&] { scene.connect(Spring{.stiffness = 1.0}, Vector3(0, 0, 0), Vector3(1, 0, 0)); },
                   {"points of the world"});
    expect_refused([&] { scene.connect(Spring{.stiffness = 1.0}, slider, Vector3(0, nan, 0)); }, {"point", "nan"});
    expect_refused([&] { scene.apply(Drag{.linear = 1.0}, BodyHandle{1}); }, {"apply", "body", "1", "handle"});
    expect_refused([&] { scene.apply(Drag{.linear = 1.0}, BodyHandle{}); }, {"apply", "body", "-1", "handle"});
    expect_refused([&] { scene.connect(Spring{.stiffness = 1.0}, slider, BodyHandle{7}); },
                   {"connect", "body", "7", "handle"});
    EXPECT_TRUE(scene.loads().empty());
    EXPECT_TRUE(scene.connections().empty());
}

TEST(Input, a_run_ends_after_it_starts_and_asks_for_what_double_precision_can_give) {
    const Scene scene = sliding();
    expect_refused([&] { simulate(scene, {.until = 0.0}); }, {"simulate", "until", "0"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .start = 1.0}); }, {"simulate", "until", "1"});
    expect_refused([&] { simulate(scene, {.until = -2.5}); }, {"simulate", "until", "-2.5"});
    expect_refused([&] { simulate(scene, {.until = nan}); }, {"simulate", "until", "nan"});
    expect_refused([&] { simulate(scene, {.until = infinity}); }, {"simulate", "until", "inf"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .start = nan}); }, {"simulate", "start", "nan"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .error = 1e-15}); }, {"simulate", "error", "1e-15", "4e-15"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .error = 3.9e-15}); },
                   {"simulate", "error", "3.9e-15", "4e-15"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .error = 0.5}); }, {"simulate", "error", "0.5"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .error = nan}); }, {"simulate", "error", "nan"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .rtol = 1e-17}); }, {"simulate", "rtol", "1e-17"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .engine = "euler"}); },
                   {"simulate", "engine", "euler", "taylor"});
    expect_refused([&] { simulate(scene, {.until = 1.0, .max_steps = 0}); }, {"simulate", "max_steps", "0"});
    expect_refused(
        [&] {
            simulate(scene, {.until = 1.0, .keep = {Keep::What::times, {0.5, 2.0}}});
        },
        {"simulate", "keep", "2"});
    expect_refused([] { simulate(Scene(down), {.until = 1.0}); }, {"Scene", "0 bodies"});
    EXPECT_NO_THROW(simulate(scene, {.until = 1.0, .error = 4e-15}));
}

TEST(Input, a_run_answers_for_its_own_times_and_bodies_alone) {
    Scene scene = sliding();
    const BodyHandle free = scene.add(Particle{1.0}, FreeStart{}, "stone");
    const Trajectory run = simulate(scene, {.until = 2.0});
    expect_refused([&] { run[BodyHandle{0}].position(2.5); }, {"Trajectory", "time", "2.5", "0", "2"});
    expect_refused([&] { run[BodyHandle{0}].position(-0.5); }, {"Trajectory", "time", "-0.5"});
    expect_refused([&] { run[BodyHandle{0}].position(nan); }, {"Trajectory", "time", "nan"});
    expect_refused([&] { run[BodyHandle{2}]; }, {"Trajectory", "body", "2"});
    expect_refused([&] { run[CouplingHandle{0}]; }, {"Trajectory", "coupling", "0"});
    expect_refused([&] { run[free].speed(1.0); }, {"stone", "rail"});
    expect_refused([&] { run[free].reaction(1.0); }, {"stone", "rail"});
}

TEST(Input, a_force_that_is_not_finite_ends_the_run_with_advice_and_what_there_is) {
    // 1/(1 - t) is infinite at t = 1; sqrt(1 - t) has no value beyond
    Scene scene;
    const BodyHandle stone = scene.add(Particle{1.0});
    scene.apply(Force([](const auto& t, const auto&, const auto&) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>(sqrt(S(1.0) - t), S(0.0), S(0.0));
                }),
                stone);
    try {
        simulate(scene, {.until = 3.0});
        FAIL() << "sqrt(1 - t) was integrated beyond t = 1";
    } catch (const IntegrationError& e) {
        EXPECT_NE(std::string(e.what()).find("not finite"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("look there"), std::string::npos) << e.what();
        EXPECT_EQ(e.run.status(), Status::not_finite);
        EXPECT_GT(e.run.end(), 0.99);
        // so near the end that what is left, (1 - t)^(3/2), is less than the error asked for
        EXPECT_LE(e.run.end(), 1.0 + 1e-6);
        EXPECT_TRUE(e.run[stone].position(e.run.end()).allFinite());
    }
}

}  // namespace
}  // namespace rbdyn::test::test_input
