// Contacts as effects: one that is taken away leaves no trace in the equations, one that never closes only its gap
// guard.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proof.hpp"
#include "rbdyn/body/shapes.hpp"
#include "rbdyn/effects.hpp"
#include "rbdyn/file/scene_file.hpp"
#include "rbdyn/scene/effects.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "refusal.hpp"

namespace rbdyn::test {
namespace touch {

/// A rod on a spring, in a plane, that swings above a floor.
struct Swing {
    Scene scene{Vector3{0, 0, -9.8125}};
    BodyHandle rod;
    ContactHandle floor;
    explicit Swing(const std::optional<ContactOptions>& options, double height = 60.0) {
        rod = scene.add(shapes::rod(1.0, 1.0, {1, 0, 0}), Planar{.x = {1, 0, 0}, .y = {0, 0, 1}},
                        PlanarStart{.position = {0.25, height}, .velocity = {1.0, 0.0}, .angle = 0.5, .rate = 1.0});
        scene.connect(Spring{.stiffness = 2.0}, rod.point({0.5, 0, 0}), Vector3{0, 0, height + 1.0});
        if (options) floor = scene.contact(rod.point({-0.5, 0, 0}), Plane{{0, 0, 1}}, *options);
    }
};
std::shared_ptr<const SceneModel> model_of(const Scene& scene) { return make_plan(scene.frozen()).model; }
Record motion_of(const SceneModel& model, double until) { return proof::integrated(model, model.start(), until); }
Record motion_of(const Scene& scene, double until) { return motion_of(*model_of(scene), until); }
std::vector<double> digits(const Record& record) {
    std::vector<double> all;
    for (std::size_t i = 0; i < record.entries().size(); ++i) {
        const Piece piece = record.piece(i);
        for (int v = 0; v < piece.variables; ++v)
            all.insert(all.end(), piece.variable(v), piece.variable(v) + piece.order + 1);
        all.insert(all.end(), {piece.start.hi, piece.start.lo, piece.unit, record.entries()[i].length});
    }
    return all;
}
bool same_motion(const Record& a, const Record& b) {
    const std::vector<double> x = digits(a), y = digits(b);
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) == 0;
}
const std::vector<ContactOptions> laws = {{},
                                          {.restitution = 0.5},
                                          {.friction = Coulomb{0.5, 0.25}},
                                          {.friction = Coulomb{0.5, 0.25, 0.01, 0.02}, .restitution = 1.0}};

TEST(Touch, that_never_happens_costs_its_gap_guard_and_nothing_else) {
    const Swing bare({});
    const Record alone = motion_of(bare.scene, 2.0);
    const Plan without = make_plan(bare.scene.frozen());
    for (const ContactOptions& law : laws) {
        const Swing far(law);
        const Plan with = make_plan(far.scene.frozen());
        EXPECT_TRUE(with.has("contact"));
        EXPECT_EQ(with.has("impact"), law.restitution > 0.0);
        EXPECT_EQ(with.guards.size(), without.guards.size() + 1);
        EXPECT_EQ(with.size().variables, without.size().variables);
        EXPECT_EQ(with.size().instructions, without.size().instructions + 1);
        const Record flies = motion_of(far.scene, 2.0);
        EXPECT_TRUE(same_motion(alone, flies));
        EXPECT_EQ(flies.work.right_hand_sides, alone.work.right_hand_sides);
        EXPECT_EQ(flies.work.guard_evaluations, alone.work.guard_evaluations + flies.work.steps);
        EXPECT_TRUE(flies.modes.front().parameters.empty());
    }
}

TEST(Touch, that_is_taken_away_leaves_the_equations_of_a_scene_that_never_had_it) {
    const Swing bare({}, 1.0);
    const auto never = model_of(bare.scene);
    const Record alone = motion_of(*never, 4.0);
    for (const ContactOptions& law : laws) {
        Swing low(law, 1.0);
        EXPECT_FALSE(same_motion(alone, motion_of(low.scene, 4.0)));  // here it does close
        const Scene by_handle = low.scene.without({low.floor}), by_name = low.scene.without({"contact"});
        EXPECT_EQ(by_handle, by_name);
        EXPECT_NE(by_handle, low.scene);
        const auto left = model_of(by_name);
        const Record gone = motion_of(*left, 4.0);
        EXPECT_TRUE(same_motion(alone, gone));
        EXPECT_EQ(gone.modes.front().equations->program.text(), alone.modes.front().equations->program.text());
        EXPECT_EQ(gone.work.guard_evaluations, alone.work.guard_evaluations);
        EXPECT_EQ(make_plan(by_name.frozen()).effects, make_plan(bare.scene.frozen()).effects);
        // its handle stays good, and the rod passes through
        const Trajectory run = simulate(by_name, {.until = 4.0});
        EXPECT_EQ(run[low.floor].state(4.0), "open");
        EXPECT_EQ(run[low.floor].force(4.0).norm(), 0.0);
        double least = 0.0;
        for (int i = 0; i <= 100; ++i) least = std::min(least, run[low.floor].gap(0.04 * i));
        EXPECT_LT(least, -0.1);
    }
}

TEST(Touch, without_impacts_lands_and_stays) {
    Scene scene(Vector3{0, 0, -9.8125});
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}});
    const ContactHandle floor = scene.contact(ball, Plane{{0, 0, 1}}, {.restitution = 0.5});
    const Scene soft = scene.without({"impact"});
    EXPECT_FALSE(make_plan(soft.frozen()).has("impact"));
    const Trajectory run = simulate(soft, {.until = 2.0});
    EXPECT_EQ(run.events().times("land", floor).size(), 1u);
    EXPECT_EQ(run.events().times("impact", floor).size(), 0u);
    EXPECT_NEAR(run[floor].force(2.0)[2], 9.8125, 1e-12);
    EXPECT_EQ(refusal([&] { soft.without({"impact"}); }), "without: this scene has no impact; it has gravity, contact");
}

TEST(Touch, that_starts_inside_its_surface_is_no_start_unless_it_is_taken_away) {
    Scene scene(Vector3{0, 0, -9.8125});
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, -1}});
    const ContactHandle floor = scene.contact(ball, Plane{{0, 0, 1}});
    EXPECT_THROW(simulate(scene, {.until = 1.0}), InvalidInput);
    const Trajectory run = simulate(scene.without({floor}), {.until = 1.0});
    EXPECT_NEAR(run[floor].gap(1.0), -1.0 - 0.5 * 9.8125, 1e-12);
    EXPECT_NE(refusal([&] { scene.without({ContactHandle{1}}); }).find("the same scene, which has 1"),
              std::string::npos);
}

TEST(Touch, that_was_taken_away_is_so_in_a_file_too) {
    Swing low(laws[3], 1.0);
    const Scene without = low.scene.without({low.floor});
    const std::string path = (std::filesystem::temp_directory_path() / "rbdyn_test_touch.json").string();
    save(without, path);
    EXPECT_EQ(load_scene(path), without);
    std::filesystem::remove(path);
}

TEST(Touch, is_a_row_of_the_table_of_effects) {
    Scene scene(Vector3{0, 0, -9.8125});
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}});
    scene.contact(ball, Plane{{0, 0, 1}}, {.restitution = 0.5}, "floor");
    const EffectTable table = effects(scene, {.until = 0.5});
    EXPECT_EQ(table["contact"].gained, 1);  // the one bounce, at sqrt(2/g) = 0.45 s
    EXPECT_GT(table["contact"].difference, 0.01);
    EXPECT_EQ(table["impact"].gained, 1);
    EXPECT_EQ(table["impact"].lost, 2);  // it lands instead, and rests
}

}  // namespace touch
}  // namespace rbdyn::test
