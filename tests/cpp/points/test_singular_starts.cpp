// Where a motion begins at a point without a finite slope: what is passed there, and how far.
#include <gtest/gtest.h>

#include "refusal.hpp"
#include "support.hpp"

namespace rbdyn::test::test_singular_starts {
namespace {

// F = 2 + sqrt(x) has no Taylor series at x = 0: the first piece is a parabola, r = t^2
TEST(SingularStarts, from_rest_begin_as_the_acceleration_there_says) {
    Scene scene;
    const BodyHandle point = scene.add(Particle{1.0});
    scene.apply(Force([](const auto& t, const auto& r, const auto&) {
                    using std::sqrt;
                    using S = std::decay_t<decltype(t)>;
                    return Vector3Of<S>{2.0 + sqrt(r[0]), S(0.0), S(0.0)};
                }),
                point);
    const Trajectory run = simulate(scene, {.until = 1.0, .error = 1e-9, .engine = "taylor"});
    const std::vector<double> t = run.t();
    ASSERT_GT(t.size(), 4U);
    for (std::size_t k = 1; k < 4; ++k) {
        ASSERT_LT(t[k], 1e-6);
        EXPECT_NEAR(run[point].position(t[k])[0] / (t[k] * t[k]), 1.0, 1e-6);
    }
}

TEST(SingularStarts, on_rails_too_steep_for_doubles_are_refused) {
    Scene scene;
    const auto refused = [&](double a) {
        return refusal([&] {
            scene.add(Particle{1.0}, Rail(Parabola{.a = a, .x = {1, 0, 0}, .y = {0, 0, 1}}), {.parameter = 3.0});
        });
    };
    EXPECT_NE(refused(1e300).find("parameter is 3; |r'|^2"), std::string::npos);
    EXPECT_EQ(refused(1e150), "accepted");
}

}  // namespace
}  // namespace rbdyn::test::test_singular_starts
