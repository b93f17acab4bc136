// Forces that push, hold or slide together: what their laws ask for, and what rounding is.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "rbdyn/mechanics/complementarity.hpp"
#include "rbdyn/mechanics/cone_choice.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "support.hpp"

namespace rbdyn::test::test_cones {
namespace {

using mechanics::solve_complementary;
TEST(Complementarity, what_pushes_has_no_rate_and_what_has_one_does_not_push) {
    Random random(3);
    for (int trial = 0; trial < 300; ++trial) {
        const std::size_t n = static_cast<std::size_t>(random.whole(1, 5)),
                          rank = static_cast<std::size_t>(random.whole(1, 4));
        // A = J J^T; with fewer columns than rows they depend on each other
        std::vector<std::vector<double>> j(n), a(n, std::vector<double>(n));
        for (auto& row : j)
            for (std::size_t k = 0; k < rank; ++k) row.push_back(random.uniform(-1.0, 1.0));
        std::vector<double> drive, b(n, 0.0), noise(n, 1e-14);
        for (std::size_t k = 0; k < rank; ++k) drive.push_back(random.uniform(-1.0, 1.0));
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = 0; k < rank; ++k) {
                b[i] += j[i][k] * drive[k];
                for (std::size_t l = 0; l < n; ++l) a[i][l] += j[i][k] * j[l][k];
            }
        const auto [z, w] = solve_complementary(a, b, noise);
        for (std::size_t i = 0; i < n; ++i) {
            double rate = b[i], size = std::abs(b[i]);
            for (std::size_t l = 0; l < n; ++l) rate += a[i][l] * z[l], size += std::abs(a[i][l] * z[l]);
            EXPECT_GE(z[i], 0.0);
            EXPECT_NEAR(w[i], rate, 1e-12 * size) << trial;
            EXPECT_GE(rate, -1e-12 * size - 1e-13) << trial;
            if (z[i] > 0.0) {
                EXPECT_EQ(w[i], 0.0) << trial;
            }
        }
    }
}
TEST(Complementarity, a_table_on_four_legs_stands) {
    // heights of its legs by three motions: any four of them depend on each other
    const double j[4][3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
    std::vector<std::vector<double>> a(4, std::vector<double>(4));
    std::vector<double> b(4), noise(4, 1e-14);
    for (std::size_t i = 0; i < 4; ++i) {
        b[i] = -j[i][0] * 9.81 + 0.3 * j[i][1] - 0.7 * j[i][2];
        for (std::size_t l = 0; l < 4; ++l)
            a[i][l] = 0.3 * j[i][0] * j[l][0] + 0.7 * j[i][1] * j[l][1] + 1.1 * j[i][2] * j[l][2];
    }
    const auto [z, w] = solve_complementary(a, b, noise);
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_GE(z[i], 0.0);
        EXPECT_NEAR(w[i], 0.0, 1e-12);
        sum += z[i];
        EXPECT_LT(z[i], 40.0);
    }
    EXPECT_NEAR(0.3 * sum, 9.81, 1e-12);
}
TEST(Complementarity, rounding_pushes_nothing) {
    const auto [z, w] = solve_complementary({{2.0, 0.5}, {0.5, 1.0}}, {-1e-16, -0.7e-16}, {1e-15, 1e-15});
    EXPECT_EQ(z, (std::vector<double>{0.0, 0.0}));
    EXPECT_EQ(w, (std::vector<double>{-1e-16, -0.7e-16}));
}

TEST(Complementarity, what_depends_on_each_other_and_is_driven_apart_is_still_complementary) {
    Random random(5);
    for (int trial = 0; trial < 500; ++trial) {
        const std::size_t n = static_cast<std::size_t>(random.whole(2, 6)),
                          rank = static_cast<std::size_t>(random.whole(1, static_cast<int>(n) - 1));
        std::vector<std::vector<double>> j(n), a(n, std::vector<double>(n));
        for (auto& row : j) {
            row.push_back(random.uniform(0.5, 1.0));
            for (std::size_t k = 1; k < rank; ++k) row.push_back(random.whole(-2, 2));
        }
        std::vector<double> b, noise(n, 1e-14);
        for (std::size_t i = 0; i < n; ++i) {
            b.push_back(-1.0 + 0.3 * random.uniform(-1.0, 1.0));
            for (std::size_t l = 0; l < n; ++l)
                for (std::size_t k = 0; k < rank; ++k) a[i][l] += j[i][k] * j[l][k];
        }
        const auto [z, w] = solve_complementary(a, b, noise);
        for (std::size_t i = 0; i < n; ++i) {
            double rate = b[i], size = 1.0;
            for (std::size_t l = 0; l < n; ++l) rate += a[i][l] * z[l], size += std::abs(a[i][l] * z[l]);
            EXPECT_GE(z[i], 0.0);
            EXPECT_GE(rate, -1e-11 * size) << trial;
            EXPECT_NEAR(z[i] * rate, 0.0, 1e-10 * size * (1.0 + z[i])) << trial;
        }
    }
}

TEST(FrictionCones, have_their_edge_within_them_and_nothing_beyond_it) {
    const std::vector<mechanics::Cone> cone{{0, false, 0.5}};
    EXPECT_TRUE(mechanics::are_inside({2.0, 0.6, 0.8}, cone));
    EXPECT_TRUE(mechanics::are_inside({2.0, 0.6 * (1.0 + 2 * epsilon), 0.8}, cone));
    EXPECT_FALSE(mechanics::are_inside({2.0, 0.6 * (1.0 + 1e-10), 0.8}, cone));
    EXPECT_FALSE(mechanics::are_inside({-1e-20, 0.0, 0.0}, cone));
}
TEST(FrictionCones, what_no_force_can_hold_is_not_held) {
    // nothing moves along the third row, and yet it is driven
    const mechanics::Square a{{1.0, 0.0, 0.0}, {0.0, 0.5, 0.0}, {0.0, 0.0, 0.0}};
    const std::vector<mechanics::Cone> cone{{0, false, 0.5}};
    EXPECT_TRUE(mechanics::held_by(a, {-1.0, 0.1, 0.0}, {1e-14, 1e-14, 1e-14}, cone).is_solved);
    EXPECT_FALSE(mechanics::held_by(a, {-1.0, 0.1, 0.1}, {1e-14, 1e-14, 1e-14}, cone).is_solved);
}

TEST(OtherForces, a_contact_that_slides_where_its_friction_takes_what_it_presses_has_any_force) {
    // N changes its own rate by N, and its friction by -c mu N: nothing at c mu = 1, and something beside it
    const double c = 0.5, force = 3.0;
    for (const double mu : {2.0, 1.9, 2.1}) {
        const mechanics::Square a{{1.0, c, 0.0}, {c, 1.0, 0.0}, {0.0, 0.0, 1.0}};
        const std::vector<mechanics::Cone> cone{{0, false, mu}};
        const mechanics::ConeForces found{
            {force, -mu * force, 0.0}, {0.0, 0.7, 0.0}, {mechanics::ConeState::slides}, true};
        const auto others = mechanics::other_forces(a, {1e-14, 1e-14, 1e-14}, cone, found);
        if (mu != 2.0) {
            EXPECT_TRUE(others.empty()) << mu;
            continue;
        }
        ASSERT_FALSE(others.empty());
        for (const mechanics::OtherForces& other : others) {
            EXPECT_NEAR(other.change[1], -mu * other.change[0], 1e-12 * std::abs(other.change[0]));
            EXPECT_NEAR(other.change[2], 0.0, 1e-12 * std::abs(other.change[0]));
            EXPECT_TRUE(other.changes_normals(cone));
            EXPECT_TRUE(other.makes_difference(a, 1.0));
        }
    }
}
TEST(OtherForces, two_that_hold_the_same_point_share_it_and_make_no_difference) {
    // the same rows twice: what one pushes less the other does more
    const mechanics::Square one{{1.0, 0.2, 0.0}, {0.2, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    mechanics::Square a(6, std::vector<double>(6));
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < 6; ++k) a[i][k] = one[i % 3][k % 3];
    const std::vector<mechanics::Cone> cones{{0, false, 0.5}, {3, false, 0.5}};
    const mechanics::ConeForces found{{1.0, 0.1, 0.0, 2.0, 0.2, 0.0},
                                      std::vector<double>(6, 0.0),
                                      {mechanics::ConeState::held, mechanics::ConeState::held},
                                      true};
    const auto others = mechanics::other_forces(a, std::vector<double>(6, 1e-14), cones, found);
    ASSERT_FALSE(others.empty());
    bool shares = false;
    for (const mechanics::OtherForces& other : others) {
        EXPECT_FALSE(other.makes_difference(a, 1.0));
        shares = shares || other.changes_normals(cones);
    }
    EXPECT_TRUE(shares);
}

}  // namespace
}  // namespace rbdyn::test::test_cones
