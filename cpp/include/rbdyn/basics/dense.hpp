// Square matrices of any size: linear equations and eigenvalues, for what is asked once and not in every step.
//
// Eigen would do as well, at the price of a third of what the library takes to compile.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/interruption.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A matrix of n rows and n columns, zero to begin with.
template <class T>
class SquareMatrixOf {
public:
    explicit SquareMatrixOf(int size = 0) : n_(at(size)), a_(n_ * n_) {}
    int size() const { return static_cast<int>(n_); }
    T& operator()(int i, int j) { return a_[at(i) * n_ + at(j)]; }
    const T& operator()(int i, int j) const { return a_[at(i) * n_ + at(j)]; }
    /// All entries, row by row.
    const std::vector<T>& entries() const { return a_; }
    /// The largest size of an entry.
    double largest() const {
        double size = 0.0;
        for (const T& x : a_) size = std::max(size, std::abs(static_cast<double>(x)));
        return size;
    }
    bool operator==(const SquareMatrixOf&) const = default;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    std::size_t n_;
    std::vector<T> a_;
};
using SquareMatrix = SquareMatrixOf<double>;

/// A matrix of any shape, zero to begin with.
class Matrix {
public:
    explicit Matrix(int rows = 0, int columns = 0)
        : rows_(rows), columns_(columns), a_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns)) {}
    int rows() const { return rows_; }
    int columns() const { return columns_; }
    double& operator()(int i, int j) { return a_[place(i, j)]; }
    const double& operator()(int i, int j) const { return a_[place(i, j)]; }
    /// All entries, row by row.
    const std::vector<double>& entries() const { return a_; }
    bool operator==(const Matrix&) const = default;

private:
    std::size_t place(int i, int j) const {
        return static_cast<std::size_t>(i) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(j);
    }

    int rows_, columns_;
    std::vector<double> a_;
};

/// a b, in the number type of both.
template <class T>
SquareMatrixOf<T> product(const SquareMatrixOf<T>& a, const SquareMatrixOf<T>& b) {
    const int n = a.size();
    SquareMatrixOf<T> result(n);
    for (int i = 0; i < n; ++i) {
        Interruption::point();
        for (int k = 0; k < n; ++k) {
            const T factor = a(i, k);
            if (factor == T(0.0)) continue;
            for (int j = 0; j < n; ++j) result(i, j) += factor * b(k, j);
        }
    }
    return result;
}

/// The solution of linear equations; unknowns that no equation determines are zero.
struct LinearSolution {
    std::vector<double> x;
    double pivots = 1.0;  // the least pivot over the largest: 0 if the matrix is singular, about rounding if nearly so
};

/// x of a x = b, by Gaussian elimination with complete pivoting (Golub and Van Loan, "Matrix Computations", 4th ed.,
/// sec. 3.4.8). `nothing`: pivots that are at most that part of the largest are none.
inline LinearSolution solve(SquareMatrix a, std::vector<double> b, double nothing = 0.0) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = a.size();
    std::vector<int> unknown(at(n));
    std::iota(unknown.begin(), unknown.end(), 0);
    double largest = 0.0;
    LinearSolution result{std::vector<double>(at(n))};
    int rank = 0;
    for (; rank < n; ++rank) {
        Interruption::point();
        const int k = rank;
        int row = k, column = k;
        for (int i = k; i < n; ++i)
            for (int j = k; j < n; ++j)
                if (std::abs(a(i, j)) > std::abs(a(row, column))) {
                    row = i;
                    column = j;
                }
        const double pivot = std::abs(a(row, column));
        largest = std::max(largest, pivot);
        result.pivots = pivot == 0.0 ? 0.0 : pivot / largest;
        if (pivot <= nothing * largest) break;
        for (int j = 0; j < n; ++j) std::swap(a(k, j), a(row, j));
        for (int i = 0; i < n; ++i) std::swap(a(i, k), a(i, column));
        std::swap(b[at(k)], b[at(row)]);
        std::swap(unknown[at(k)], unknown[at(column)]);
        for (int i = k + 1; i < n; ++i) {
            const double factor = a(i, k) / a(k, k);
            for (int j = k + 1; j < n; ++j) a(i, j) -= factor * a(k, j);
            b[at(i)] -= factor * b[at(k)];
        }
    }
    for (int k = rank - 1; k >= 0; --k) {
        for (int j = k + 1; j < rank; ++j) b[at(k)] -= a(k, j) * b[at(j)];
        b[at(k)] /= a(k, k);
        result.x[at(unknown[at(k)])] = b[at(k)];
    }
    return result;
}

/// The eigenvalues of a symmetric matrix in ascending order, and its eigenvectors, columns of unit length.
struct SymmetricEigen {
    std::vector<double> values;
    SquareMatrix vectors;
};

/// By Jacobi's rotations (Golub and Van Loan, sec. 8.5): within rounding of the largest entry.
inline SymmetricEigen symmetric_eigen(SquareMatrix a) {
    const int n = a.size();
    // convergence is quadratic: ten sweeps are more than large matrices take
    constexpr int most_sweeps = 30;
    const double rounding = 0x1p-4 * std::numeric_limits<double>::epsilon() * a.largest();
    SquareMatrix turned(n);
    for (int i = 0; i < n; ++i) turned(i, i) = 1.0;
    bool diagonal = false;
    for (int sweep = 0; sweep < most_sweeps && !diagonal; ++sweep) {
        diagonal = true;
        for (int p = 0; p < n; ++p) {
            Interruption::point();
            for (int q = p + 1; q < n; ++q) {
                if (!(std::abs(a(p, q)) > rounding)) continue;
                diagonal = false;
                const double ratio = 0.5 * (a(q, q) - a(p, p)) / a(p, q);
                const double t = std::copysign(1.0, ratio) / (std::abs(ratio) + std::hypot(ratio, 1.0));
                const double c = 1.0 / std::hypot(t, 1.0), s = t * c, change = t * a(p, q);
                for (int i = 0; i < n; ++i) {
                    const double v = turned(i, p), w = turned(i, q);
                    turned(i, p) = c * v - s * w;
                    turned(i, q) = s * v + c * w;
                    if (i == p || i == q) continue;
                    const double x = a(i, p), y = a(i, q);
                    a(i, p) = a(p, i) = c * x - s * y;
                    a(i, q) = a(q, i) = s * x + c * y;
                }
                a(p, p) -= change;
                a(q, q) += change;
                a(p, q) = a(q, p) = 0.0;
            }
        }
    }
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int i, int j) { return a(i, i) < a(j, j); });
    SymmetricEigen result{{}, SquareMatrix(n)};
    for (int k = 0; k < n; ++k) {
        const int from = order[static_cast<std::size_t>(k)];
        result.values.push_back(a(from, from));
        for (int i = 0; i < n; ++i) result.vectors(i, k) = turned(i, from);
    }
    return result;
}

inline std::vector<double> symmetric_eigenvalues(const SquareMatrix& a) { return symmetric_eigen(a).values; }

}  // namespace rbdyn::inline RBDYN_FORM
