// Chains of masses of which the first is kicked: what has hardly come to the last of them asks for no digits of its
// own.
#include <gtest/gtest.h>

#include "support.hpp"

namespace rbdyn::test::test_chains {
namespace {

using Real = long double;
constexpr int masses = 25;
constexpr double stiffness = 1.3, kick = 0.1, spacing = 1.0, until = 2.0;
constexpr Real mass = 0.7L;

/// Displacements and velocities at the end, by the power series of m x_i'' = k (x_(i-1) - 2 x_i + x_(i+1)) in short
/// steps; the last mass is free, the first held to a wall.
std::vector<std::pair<Real, Real>> truth() {
    const Real ratio = static_cast<Real>(stiffness) / static_cast<Real>(static_cast<double>(mass));
    std::vector<std::pair<Real, Real>> now(masses);
    now[0].second = kick;
    const int steps = 40;
    const Real h = static_cast<Real>(until) / steps;
    for (int s = 0; s < steps; ++s) {
        std::vector<Real> x(masses), v(masses);
        for (std::size_t i = 0; i < masses; ++i) std::tie(x[i], v[i]) = now[i];
        auto sum = now;
        for (int n = 1; n < 30; ++n) {
            std::vector<Real> dx(masses), dv(masses);
            for (std::size_t i = 0; i < masses; ++i) {
                const Real before = i > 0 ? x[i - 1] : 0, pull = i + 1 < masses ? x[i + 1] - x[i] : 0;
                dx[i] = h / n * v[i];
                dv[i] = h / n * ratio * (before - x[i] + pull);
            }
            x = dx;
            v = dv;
            for (std::size_t i = 0; i < masses; ++i) {
                sum[i].first += x[i];
                sum[i].second += v[i];
            }
        }
        now = sum;
    }
    return now;
}

enum class Kind { springs_of_a_length, springs_of_none, beads };

TEST(Chains, of_which_the_first_mass_is_kicked_are_as_accurate_as_asked_for) {
    const auto expected = truth();
    const Curve way = Line{.direction = {1, 0, 0}};
    for (const Kind kind : {Kind::springs_of_a_length, Kind::springs_of_none, Kind::beads})
        for (const double error : {1e-6, 1e-9, 1e-12}) {
            const double rest = kind == Kind::springs_of_none ? 0.0 : spacing;
            Scene scene;
            std::vector<BodyHandle> chain;
            const Spring spring{.stiffness = stiffness, .rest_length = rest};
            const Particle particle{static_cast<double>(mass)};
            for (int i = 0; i < masses; ++i) {
                const double x = rest * (i + 1), v = i == 0 ? kick : 0.0;
                if (kind == Kind::beads)
                    chain.push_back(scene.add(particle, Rail(way), {.parameter = x, .speed = v}));
                else
                    chain.push_back(scene.add(particle, {.position = {x, 0, 0}, .velocity = {v, 0, 0}}));
                if (i == 0)
                    scene.connect(spring, chain[0], Vector3(0, 0, 0));
                else
                    scene.connect(spring, chain[static_cast<std::size_t>(i)], chain[static_cast<std::size_t>(i - 1)]);
            }
            const Attempt made = attempt(scene, {.until = until, .error = error});
            const std::string what = std::to_string(static_cast<int>(kind)) + " at " + text(error);
            ASSERT_EQ(made.outcome, simulating::Outcome::good) << what << ": " << made.message;
            const double told = *made.run.error();
            EXPECT_LE(told, error) << what;
            double whole = 0.0;
            for (const BodyHandle b : chain) whole = std::max(whole, scales(made.run, b, 100).extent);
            for (std::size_t i = 0; i < masses; ++i) {
                const Vector3 place = made.run[chain[i]].position(until), speed = made.run[chain[i]].velocity(until);
                const Real moved = static_cast<Real>(place.x()) - static_cast<Real>(rest) * (static_cast<Real>(i) + 1);
                const double off = static_cast<double>(std::abs(moved - expected[i].first)),
                             late = static_cast<double>(std::abs(speed.x() - expected[i].second));
                // where a mass is its distance rounds; else what it has of its own counts, down to the share there is
                const double rounding = 2.0 * epsilon * place.norm();
                const double own = std::max(static_cast<double>(std::abs(expected[i].first)),
                                            least_share(error, masses * rest / whole) * whole);
                EXPECT_LE(off, told * own + rounding) << what << ", mass " << i;
                EXPECT_LE(late, told * std::max(static_cast<double>(std::abs(expected[i].second)),
                                                least_share(error, masses * rest / whole) * kick))
                    << what << ", mass " << i;
            }
        }
}

}  // namespace
}  // namespace rbdyn::test::test_chains
