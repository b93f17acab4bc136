// A rail that beads of several runs are on at the same time, in threads: what is looked for in one run is not changed
// by another.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "rbdyn/curve/circle.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/cycloid.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/model/rail_landing.hpp"
#include "rbdyn/model/rail_singular.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::test::test_shared_rails {
namespace {

/// A straight flight in the plane of x and z: the parameter where the bead left, its place and its velocity.
struct Flight {
    Vector3 from, velocity;
    double left_at = 0.0;
    std::vector<double> coefficients{};

    Piece piece() {
        coefficients = {left_at, 0.0};
        for (int i = 0; i < 3; ++i) coefficients.insert(coefficients.end(), {from[i], velocity[i]});
        for (int i = 0; i < 3; ++i) coefficients.insert(coefficients.end(), {velocity[i], 0.0});
        return {.start = {}, .length = 1.0, .variables = 7, .order = 1, .coefficients = coefficients.data()};
    }
    Vector3 at(double tau) const { return from + velocity * tau; }
};

// runs of one plan in several threads have one rail between them, and find their landings in any order
TEST(SharedRails, have_the_landing_of_each_bead_where_it_came_down_whichever_was_found_last) {
    const Curve circle(Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 0, 1}});
    const double top = 1.5;
    const RailLanding landing(circle, curves::one_side(circle, top, Vector3(0, 0, 1), "bead"), Placement{}, 0, 1, 4);
    const double turn = circle.period();
    for (const double left_at : {0.5, 0.5 + 3.0 * turn, 0.5 - 2.0 * turn}) {
        Flight onto_the_top{{0.3, 0, 2}, {0, 0, -2}, left_at}, from_below{{0.2, 0, -2}, {0, 0, 2}, left_at},
            from_the_left{{-2, 0, -0.1}, {2, 0, 0}, left_at};
        std::vector<std::optional<double>> found;
        std::vector<Flight*> flights{&onto_the_top, &from_below, &from_the_left};
        for (Flight* const flight : flights) found.push_back(landing.first(flight->piece(), false));
        // x = cos u, z = sin u
        const std::vector<double> parameters{std::acos(0.3), turn - std::acos(0.2), 0.5 * turn + std::asin(0.1)};
        for (std::size_t k = 0; k < flights.size(); ++k) {
            ASSERT_TRUE(found[k]) << k;
            const double u = landing.place(flights[k]->at(*found[k]), left_at);
            EXPECT_NEAR(u, parameters[k] + std::floor(left_at / turn) * turn, 4e-15 * (1.0 + std::abs(left_at))) << k;
        }
    }
}

/// A step on which a parameter goes evenly from one value to another.
struct Step {
    std::vector<double> coefficients;

    Step(double from, double to) : coefficients{from, to - from, to - from, 0.0} {}
    Piece piece() const {
        return {.start = {}, .length = 1.0, .variables = 2, .order = 1, .coefficients = coefficients.data()};
    }
};

// cusps at pi, 3 pi, ...; one run goes on in its arch after another has begun in its own
TEST(SharedRails, have_the_cusp_ahead_of_each_bead_whichever_was_looked_at_last) {
    const Curve cycloid(Cycloid{.radius = 0.5, .x = {1, 0, 0}, .y = {0, 0, 1}});
    const double pi = std::acos(-1.0);
    for (const double arch : {-2.0, -1.0, 1.0, 2.0}) {
        const RailSingularity singular(cycloid, 0.1, 0, 1);
        const double other = 2.0 * pi * arch;
        ASSERT_FALSE(singular.first(Step(0.1, 0.5).piece(), true));
        ASSERT_FALSE(singular.first(Step(other, other + 0.5).piece(), true));
        // away from all cusps, then over the one above, and the one below
        EXPECT_FALSE(singular.first(Step(0.5, 0.25).piece(), false)) << arch;
        ASSERT_FALSE(singular.first(Step(other + 0.5, other - 0.5).piece(), false)) << arch;
        const auto above = singular.first(Step(2.5, 3.5).piece(), false);
        ASSERT_TRUE(above) << arch;
        EXPECT_NEAR(*above, pi - 2.5, 1e-13) << arch;
        ASSERT_FALSE(singular.first(Step(other - 0.5, other).piece(), false)) << arch;
        const auto below = singular.first(Step(-2.5, -3.5).piece(), false);
        ASSERT_TRUE(below) << arch;
        EXPECT_NEAR(*below, pi - 2.5, 1e-13) << arch;
    }
}

}  // namespace
}  // namespace rbdyn::test::test_shared_rails
