// Scenes as files and runs that go on, from C++: the file that Python writes, the motion that was not interrupted.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>

#include "rbdyn/file/values.hpp"
#include "rbdyn/rbdyn.hpp"
#include "rbdyn/scene/recorded_action.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_files {
namespace {

Scene rough_hoop(const Parameter& mass) {
    Scene scene({0.0, -0.0, -9.81});
    const Circle circle{.radius = 1.0 / 3.0, .start = {0, 0, -1}, .toward = {1, 0, 0}};
    const Rail hoop(circle, Coulomb{.mu_static = 0.4, .mu_dynamic = 0.1});
    const BodyHandle bead = scene.add(Particle{.mass = mass}, hoop, {.parameter = 0.1 + 0.2, .speed = 7.0}, "bead");
    // parameters, cases and names in the middle of the operations
    scene.apply(Force([=](const auto& t, const auto& r, const auto& v) {
                    using std::abs, std::sin;
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{sin(t) * mass, -1e-3 * v[1] * mass, 1e-3 * abs(r[0])};
                }),
                bead);
    scene.watch("side", [=](const Now& now) { return now[bead].position()[0] - 0.1; });
    return scene;
}

TEST(SceneFile, comes_back_equal_and_shares_its_numbers) {
    const Parameter mass(0.5, "m");
    const Scene scene = rough_hoop(mass);
    const std::string text = text_of(scene);
    const Scene again = scene_from(text);
    EXPECT_TRUE(again == scene);
    EXPECT_EQ(text_of(again), text);
    EXPECT_TRUE(std::signbit(again.gravity()[1]));
    EXPECT_FALSE(scene_from(text, "scene", {Parameter(0.75, "m")}) == scene);
    EXPECT_TRUE(rough_hoop(Parameter(0.5, "m")) == scene);
    EXPECT_FALSE(rough_hoop(Parameter(0.5, "n")) == scene);
}

TEST(SceneFile, is_written_and_read_and_moves_alike) {
    const Scene scene = rough_hoop(Parameter(0.5, "m"));
    const std::string path = (std::filesystem::temp_directory_path() / "rbdyn_test_scene.json").string();
    save(scene, path);
    const Trajectory here = simulate(scene, {.until = 2.0}), there = simulate(load_scene(path), {.until = 2.0});
    std::filesystem::remove(path);
    ASSERT_EQ(here.events().size(), there.events().size());
    for (std::size_t i = 0; i < here.events().size(); ++i) EXPECT_EQ(here.events()[i].time, there.events()[i].time);
    EXPECT_EQ(here[BodyHandle{0}].position(2.0), there[BodyHandle{0}].position(2.0));
    EXPECT_NE(refusal([&] { load_scene(path); }).find("there is no file"), std::string::npos);
    EXPECT_NE(refusal([&] { save(scene, "/no/such/folder/x.json"); }).find("cannot be written"), std::string::npos);
}

TEST(SceneFile, refuses_names_that_are_no_text) {
    // "Strasse" as Latin-1 has it, which was saved as another name
    const std::string latin =
        "Stra\xdf"
        "e";
    Scene body, watch, number;
    body.add(Particle{.mass = 1.0}, FreeStart{}, "first");
    body.add(Particle{.mass = 1.0}, FreeStart{}, latin);
    const BodyHandle bob = watch.add(Particle{.mass = 1.0});
    watch.watch(latin, [=](const Now& now) { return now[bob].position()[0]; });
    number.add(Particle{.mass = Parameter(1.0, latin)});
    EXPECT_NE(refusal([&] { text_of(body); }).find("bodies[1].name is \"Stra"), std::string::npos);
    EXPECT_NE(refusal([&] { text_of(watch); }).find("watches[0].name"), std::string::npos);
    EXPECT_NE(refusal([&] { save(number, "never.json"); }).find("no UTF-8"), std::string::npos);
    Scene utf8;
    utf8.add(Particle{.mass = 1.0}, FreeStart{},
             "Stra\xc3\x9f"
             "e");
    EXPECT_EQ(scene_from(text_of(utf8)).bodies()[0].name,
              "Stra\xc3\x9f"
              "e");
}

TEST(SceneFile, has_the_actions_that_are_recorded) {
    Scene scene({0.0, 0.0, -10.0});
    const auto ball = scene.add(Particle{.mass = 1.0}, {.position = {0.0, 0.0, 1.25}}, "ball");
    const Parameter kept(0.5, "kept");
    const RecordedAction bounce(Function::record(1,
                                                 [&](const std::vector<Expression>& x) {
                                                     return std::vector<Expression>{0.0, 0.0, -kept * x[0]};
                                                 }),
                                {{Quantity::velocity, ball.index, 2}}, {{ball.index, "velocity"}});
    scene.watch("floor", [=](const Now& now) { return now[ball].position()[2]; },
                {.direction = Direction::falling, .action = {WatchAction::Kind::change, bounce}});
    const Scene again = scene_from(text_of(scene));
    EXPECT_EQ(text_of(again), text_of(scene));
    // it falls for 0.5 s, then flies for 0.5 s, and 0.25 s
    const std::vector<double> times = simulate(again, {.until = 1.3}).events().times("floor");
    const std::vector<double> expected = {0.5, 1.0, 1.25};
    ASSERT_EQ(times.size(), expected.size());
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], expected[i], 1e-9);
    EXPECT_THROW(RecordedAction(bounce.function(), {}, bounce.words()), InvalidInput);
    EXPECT_THROW(RecordedAction(bounce.function(), bounce.asked(), {{ball.index, "colour"}}), InvalidInput);
}

TEST(SceneFile, doubles_come_back_as_they_were) {
    file::Writing writing;
    file::Reading reading{"numbers"};
    for (const double x : {0.1, -0.0, 5e-324, std::numeric_limits<double>::max(), 1.0 / 3.0, 1e22, -1e-300,
                           std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
        const file::Json json = file::parsed(file::printed(file::Json::array({file::put(x, writing)})), "numbers");
        const double back = file::Place(json[0], "x", reading).number();
        EXPECT_EQ(std::memcmp(&back, &x, sizeof x), 0) << x;
    }
}

TEST(GoingOn, is_the_motion_that_was_not_interrupted) {
    const Scene scene = rough_hoop(Parameter(0.5));
    const Trajectory whole = simulate(scene, {.until = 4.0, .error = 1e-10});
    ASSERT_GT(whole.events().size(), 3U);
    for (const double cut : {0.5, whole.events()[0].time, whole.events()[2].time}) {
        const Trajectory first = simulate(scene, {.until = cut, .error = 1e-10});
        const Trajectory on = simulate(first, {.until = 4.0});
        EXPECT_EQ(on.start(), first.end());
        ASSERT_EQ(first.events().size() + on.events().size(), whole.events().size());
        for (std::size_t i = 0; i < on.events().size(); ++i)
            EXPECT_NEAR(on.events()[i].time, whole.events()[first.events().size() + i].time, 4e-10);
        EXPECT_LE(*on.error(), 1e-10);
        EXPECT_LT((on[BodyHandle{0}].position(4.0) - whole[BodyHandle{0}].position(4.0)).norm(), 1e-10);
    }
    const Trajectory cheap = simulate(simulate(scene, {.until = 1.0, .rtol = 1e-9}), {.until = 2.0});
    EXPECT_FALSE(cheap.error().has_value());
    const std::string said = refusal([&] { simulate(whole, {.until = 3.0}); });
    EXPECT_NE(said.find("a run ends after its start, which is 4 s"), std::string::npos) << said;
}

TEST(GoingOn, has_the_same_bits_after_a_step) {
    const Scene scene = rough_hoop(Parameter(0.5));
    const Trajectory whole = simulate(scene, {.until = 4.0, .rtol = 1e-11});
    for (const std::int64_t steps : {std::int64_t{20}, whole.statistics().steps - 2}) {
        const Trajectory first = simulate(scene, {.until = 4.0, .rtol = 1e-11, .max_steps = steps});
        ASSERT_EQ(first.status(), Status::step_limit);
        const Trajectory on = simulate(first, {.until = 4.0, .max_steps = 100000});
        EXPECT_EQ(on[BodyHandle{0}].position(4.0), whole[BodyHandle{0}].position(4.0));
        EXPECT_EQ(on.events().back().time, whole.events().back().time);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_files
