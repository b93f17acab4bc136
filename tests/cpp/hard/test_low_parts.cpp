// Digits beyond doubles: sums of many steps, states that events leave alone, long runs far from where they began.
#include <gtest/gtest.h>

#include "support.hpp"

namespace rbdyn::test::test_low_parts {
namespace {

/// A charge in crossed fields: x = t + sin(t) / 2, y = (cos(t) - 1) / 2. Nothing depends on where it is, so that what
/// sums lose shows and is not made up for.
struct Drift {
    Scene scene;
    BodyHandle charge = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1.5, 0, 0}});

    Drift() {
        scene.apply(Lorentz{1.0, {0, 0, 1}}, charge);
        scene.apply(Force({0, 1, 0}), charge);
    }
    double error(const std::string& engine, double rtol, double until) const {
        const Trajectory run =
            simulate(scene, {.until = until, .rtol = rtol, .engine = engine, .keep = {.what = Keep::What::end}});
        const long double x = run[charge].position(until)[0], t = until;
        return static_cast<double>(std::abs(x - (t + 0.5L * std::sin(t))));
    }
};

// one rounding of x, 2e5, is 1.5e-11 there; a hundred thousand of them would be 1e-9
TEST(LowParts, of_a_drift_are_added_over_a_hundred_thousand_steps) {
    EXPECT_LT(Drift().error("taylor", 1e-16, 2e5), 1e-10);
}

TEST(LowParts, of_a_drift_are_added_by_a_runge_kutta_method_too) {
    EXPECT_LT(Drift().error("dop853", 1e-15, 4e4), 2e-11);
}

}  // namespace
}  // namespace rbdyn::test::test_low_parts
