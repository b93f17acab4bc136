// Linear equations and eigenvalues of small matrices: against what they are made from, and closed forms.
#include "rbdyn/basics/dense.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace rbdyn::test::test_dense {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// A full matrix without structure, entries between -1 and 1.
SquareMatrix scattered(int n) {
    SquareMatrix a(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) a(i, j) = std::sin(1.0 + 17.0 * i * i + 5.0 * j + 3.0 * i * j);
    return a;
}

/// A chain of n equal masses between walls: eigenvalues 2 - 2 cos(k pi/(n + 1)).
SquareMatrix chain(int n) {
    SquareMatrix a(n);
    for (int i = 0; i < n; ++i) {
        a(i, i) = 2.0;
        if (i > 0) a(i, i - 1) = a(i - 1, i) = -1.0;
    }
    return a;
}

}  // namespace

TEST(Dense, a_solution_satisfies_its_equations_to_rounding) {
    for (const int n : {1, 2, 3, 7, 30}) {
        const SquareMatrix a = scattered(n);
        std::vector<double> b;
        for (int i = 0; i < n; ++i) b.push_back(std::cos(3.0 * i));
        const rbdyn::LinearSolution s = rbdyn::solve(a, b);
        for (int i = 0; i < n; ++i) {
            double sum = -b[static_cast<std::size_t>(i)], size = 0.0;
            for (int j = 0; j < n; ++j) {
                sum += a(i, j) * s.x[static_cast<std::size_t>(j)];
                size += std::abs(s.x[static_cast<std::size_t>(j)]);
            }
            // backward stable: n roundings of what the terms may be
            EXPECT_LE(std::abs(sum), n * epsilon * (1.0 + size)) << n << " equations, row " << i;
        }
    }
}

TEST(Dense, equations_in_any_order_and_of_any_size_have_the_same_solution) {
    SquareMatrix a(3);
    a(0, 1) = 0x1p+200;
    a(1, 2) = 4.0;
    a(2, 0) = 0x1p-200;
    const rbdyn::LinearSolution s = rbdyn::solve(a, {0x1p+201, 2.0, 0x1p-202});
    EXPECT_EQ(s.x, (std::vector<double>{0.25, 2.0, 0.5}));
}

TEST(Dense, an_unknown_that_nothing_determines_is_zero_and_the_pivots_tell) {
    SquareMatrix a(3);
    a(0, 0) = 2.0;
    a(1, 2) = 4.0;
    const rbdyn::LinearSolution s = rbdyn::solve(a, {4.0, 8.0, 0.0});
    EXPECT_EQ(s.x, (std::vector<double>{2.0, 0.0, 2.0}));
    EXPECT_EQ(s.pivots, 0.0);
    EXPECT_EQ(rbdyn::solve(chain(1), {2.0}).pivots, 1.0);
}

TEST(Dense, the_modes_of_a_chain_are_those_of_the_closed_form) {
    for (const int n : {1, 2, 5, 40}) {
        const std::vector<double> squares = rbdyn::symmetric_eigenvalues(chain(n));
        ASSERT_EQ(squares.size(), static_cast<std::size_t>(n));
        // rounding of the largest entry in each of the rotations an entry takes part in
        for (int k = 1; k <= n; ++k)
            EXPECT_NEAR(squares[static_cast<std::size_t>(k - 1)],
                        4.0 * std::pow(std::sin(0.5 * k * std::numbers::pi / (n + 1)), 2), 4.0 * n * epsilon)
                << "mode " << k << " of " << n;
    }
}

TEST(Dense, eigenvectors_are_orthonormal_and_only_stretched) {
    for (const int n : {1, 2, 5, 40}) {
        const SquareMatrix a = chain(n);
        const rbdyn::SymmetricEigen e = rbdyn::symmetric_eigen(a);
        for (int k = 0; k < n; ++k)
            for (int i = 0; i < n; ++i) {
                double stretched = 0.0, product = 0.0;
                for (int j = 0; j < n; ++j) {
                    stretched += a(i, j) * e.vectors(j, k);
                    product += e.vectors(j, i) * e.vectors(j, k);
                }
                EXPECT_NEAR(stretched, e.values[static_cast<std::size_t>(k)] * e.vectors(i, k), 8.0 * n * epsilon);
                EXPECT_NEAR(product, i == k ? 1.0 : 0.0, 8.0 * n * epsilon);
            }
    }
}

TEST(Dense, a_power_of_two_in_the_unit_changes_no_digit_of_an_eigenvalue) {
    SquareMatrix a = chain(6), scaled(6);
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) scaled(i, j) = 0x1p-300 * (a(i, j) += 1.0 / (1.0 + i + j));
    const std::vector<double> values = rbdyn::symmetric_eigenvalues(a), small = rbdyn::symmetric_eigenvalues(scaled);
    for (std::size_t k = 0; k < values.size(); ++k) EXPECT_EQ(small[k], 0x1p-300 * values[k]);
}

}  // namespace rbdyn::test::test_dense
