// A run as bytes beside its scene, and back.
#include <gtest/gtest.h>

#include "rbdyn/model/euler_top.hpp"
#include "rbdyn/own_motion.hpp"
#include "rbdyn/trajectory/run_bytes.hpp"
#include "support.hpp"

namespace rbdyn::test::test_run_bytes {
namespace {

void expect_read_back(const Trajectory& run, BodyHandle body, const std::string& what) {
    const Trajectory other(run_from(run.scene(), bytes_of(*run.data())));
    ASSERT_EQ(other.events().size(), run.events().size()) << what;
    for (const double t : {0.0, 0.1, 0.3, 1.0}) {
        EXPECT_EQ(other[body].position(t), run[body].position(t)) << what;
        EXPECT_EQ(other[body].force(t), run[body].force(t)) << what;
    }
}

// products of theirs are no doubles: 3 times 0.2
TEST(RunBytes, are_read_back_whatever_the_users_numbers_are_multiplied_with) {
    const Parameter k(3.0, "k"), l(0.7, "l");
    const std::vector<std::pair<std::string, Spring>> springs{{"k, 0.2", {k, 0.2}},  {"3, l", {3.0, l}},
                                                              {"k, l", {k, l}},      {"k, l, damped", {k, l, l}},
                                                              {"k alone", {k, 0.0}}, {"k, k", {k, k}}};
    for (const auto& [what, spring] : springs)
        for (const std::string engine : {"auto", "dop853"}) {
            Scene free, bead, rough;
            const BodyHandle a = free.add(Particle{1.0}, FreeStart{{1, 0.1, 0}, {0, 0.5, 0}});
            const BodyHandle b = bead.add(Particle{1.0}, Rail(along_x), {.parameter = 1.0});
            const BodyHandle c = rough.add(Particle{1.0}, Rail(along_x, Coulomb{0.2, 0.1}), {.parameter = 1.0});
            free.connect(spring, a, Vector3(0, 0, 0));
            bead.connect(spring, b, Vector3(0, 1, 0));
            rough.connect(spring, c, Vector3(0, 1, 0));
            const SimulateOptions options{.until = 1.0, .engine = engine};
            expect_read_back(simulate(free, options), a, what + ", free, " + engine);
            expect_read_back(simulate(bead, options), b, what + ", bead, " + engine);
            expect_read_back(simulate(rough, options), c, what + ", rough, " + engine);
        }
    Scene scene;
    const BodyHandle body = scene.add(Particle{l}, FreeStart{{1, 0, 0}, {0, 0, 0}});
    scene.apply(Force([&](const auto& t, const auto& r, const auto&) {
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{-(0.1 * k) * r[0], where(t < 0.3 * l, S(0.2 * l), S(0.0)), S(0.0)};
                }),
                body);
    scene.apply(Drag{.linear = k, .quadratic = l}, body);
    expect_read_back(simulate(scene, {.until = 1.0}), body, "force");
}

// what is written says nothing of the model, which ended with the call
TEST(RunBytes, of_a_model_of_the_users_own_are_those_of_the_run_that_is_read_from_them) {
    const EulerTop top(RigidBody(1.0, Vector3(1, 1, 0.5)), 9.81, Vector3(0, 0, -0.5));
    const StateRun run = simulate(top, {0.1, 1.0, 0.2, 0.0, 0.3, 5.0}, {.until = 1.0});
    const std::string bytes = bytes_of(run);
    const StateRun other = state_run_from(bytes);
    EXPECT_EQ(other.state(0.7), run.state(0.7));
    EXPECT_EQ(other.error(), run.error());
    EXPECT_EQ(other.engine(), run.engine());
    EXPECT_EQ(bytes_of(other), bytes);
}

}  // namespace
}  // namespace rbdyn::test::test_run_bytes
