// Guards along a piece as polynomials through their values (series/fit.hpp): for equations without a series.
//
// The piece's polynomial stands for the motion; the fit is held against the guards themselves between the points.
//
// A length that passes zero goes on below it, as its series does: at each point it has the sign that makes its vector
// turn by less than a right angle from the one before. Where the vector turns round, it must pass zero, or the fit does
// not hold.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class GuardFit {
public:
    using Fit = series::Fit;
    static constexpr int order = Fit::degree;

    explicit GuardFit(const Equations& equations);

    /// A mode begins: what is known of the sides of lengths is what its parameters say.
    void enter(std::span<const double> parameters);
    /// The last fit is kept, and what is fitted next goes on from its end.
    void go_on();

    void set_parameters(std::span<const double> parameters, Program::Rounding constants);

    /// How far a fit is from the guards: by the largest error over what is allowed, and over the guard's largest value.
    /// What is not a number anywhere is as far as can be.
    struct Miss {
        double allowed = 0.0, value = 0.0;
        bool holds() const { return allowed <= 1.0; }
    };

    /// Fits all guards but those that are variables on [0, length] of the piece, in its unit of time. Allowed is
    /// `tolerance` times the largest value there, or the rounding of its terms; one that is not finite at the start is
    /// not weighed.
    Miss operator()(const Piece& piece, double length, double tolerance);

    /// Coefficients 0 .. order of a guard.
    const double* coefficients(int guard) const;

    /// Makes the sizes of a guard's coefficients those of the terms they are made of, as far as values tell: where the
    /// piece begins, and for a variable the first of its rate.
    void widen_at_start(const Piece& piece, int output, double* sizes);

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static constexpr double rounding = 64.0 * epsilon;

    /// A guard that is the length of a vector.
    struct Length {
        std::size_t guard;
        int flag;      // the parameter that says that it starts at zero
        int parts[3];  // the slots of the vector's components
        std::array<Vector3, Fit::points> at = {};
        Vector3 before = Vector3::Zero();  // at the end of what was fitted before
        double size = 0.0;                 // the largest so far: rounding of that is no direction
        bool is_known = false, starts_at_zero = false;
    };
    Vector3 vector(const Length& l) const;

    /// Gives the values of a length the signs it has on [0, length] of the piece. Returns whether it is zero wherever
    /// these change.
    bool follow(Length& l, const Piece& piece, double length, double tolerance);

    /// Whether a vector that turns round between two places of the piece, before them along `last`, is zero on the way.
    bool passes_zero(const Length& l, const Piece& piece, const Vector3& last, double from, double to, double allowed);

    void evaluate(const Piece& piece, double tau);

    Miss miss(const Piece& piece, double length);

    const Equations* equations_;
    Evaluator<double> evaluator_;
    std::vector<double> state_, values_, coefficients_, allowed_, largest_, rounding_;
    std::vector<std::size_t> fitted_;
    std::vector<Length> lengths_;
};

}  // namespace rbdyn::inline RBDYN_FORM
