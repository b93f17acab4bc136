// One smooth piece of motion: polynomials in time, whatever engine made them.
#pragma once

#include <span>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// State variables on [start, start + length * unit]: x_i = sum_k c[i][k] tau^k with tau = (t - start) / unit.
struct Piece {
    Instant start;
    double unit = 1.0;    // s
    double length = 0.0;  // in units
    int variables = 0, order = 0;
    const double* coefficients = nullptr;  // variables rows of order + 1
    int stride = 0;                        // between rows; 0: order + 1

    const double* variable(int i) const;
    double tau(double t) const { return (t - start) / unit; }
    Instant at(double tau_) const { return start + tau_ * unit; }
    double duration() const { return length * unit; }

    void state(double tau_, std::span<double> x) const;
};

}  // namespace rbdyn::inline RBDYN_FORM
