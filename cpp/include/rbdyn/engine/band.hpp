// Linear equations whose matrix has its entries near the diagonal, once the variables are in an order for that.
//
// The order is that of Cuthill and McKee, reversed (Proceedings of the 24th ACM National Conference, 1969, 157-172;
// George and Liu, "Computer Solution of Large Sparse Positive Definite Systems", 1981, 4.3): from an end of each
// connected part, neighbour after neighbour. LU by rows with the largest pivot of its column, inside the band (Golub
// and Van Loan, "Matrix Computations", 4.3.5): with bandwidth b it has at most 2 b entries right of the diagonal, so
// that it costs n b^2.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// An order of variables, and how far from the diagonal entries then are.
struct BandOrder {
    std::vector<int> place;  // of each variable
    int width = 0;

    /// Of a matrix whose row i has entries in columns[first[i]] .. columns[first[i + 1]].
    static BandOrder of(std::span<const std::size_t> first, std::span<const int> columns);
};

/// A matrix and its LU, in place.
class BandMatrix {
public:
    BandMatrix(int n, int width);

    void clear();
    /// The entry of two places, which are not further apart than the width.
    double& operator()(int i, int j) { return entries_[static_cast<std::size_t>(i) * row_ + at(j - i + width_)]; }

    /// False if a pivot is zero or no number.
    bool factorise();
    /// Of what was factorised; x has the right-hand side.
    void solve(std::span<double> x);

    /// Whether it is solved in less time than one that is full.
    static bool pays(int n, int width) { return 4 * width < n; }
    /// Entries, those that pivoting may fill among them.
    static std::size_t size(int n, int width) { return static_cast<std::size_t>(n) * at(3 * width + 1); }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    int n_, width_;
    std::size_t row_;
    std::vector<double> entries_;
    std::vector<int> pivots_;
};

}  // namespace rbdyn::inline RBDYN_FORM
