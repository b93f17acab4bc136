// Guards along the pieces of an engine whose steps know nothing of them: their coefficients, and how far these hold.
//
// Where the equations have series, a guard is the series of its function along the polynomial of the piece; else a
// polynomial through its values. A step on which these would be cut off too soon is handed out in parts. Where values
// do not become a polynomial (a corner, a jump, a function that is rough by itself) there is no end to that: a step is
// given so many fits as its polynomials have coefficients, a few times, and then the last one holds as far as it goes.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/engine/far_norms.hpp"
#include "rbdyn/engine/guard_fit.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Whether every instruction of the equations has a series.
inline bool series_are_known(const Equations& equations) { return !equations.program.has_calls(); }

class PieceGuards {
public:
    /// `tolerance`: what may be cut off of a guard, relative to its size. Orders of series: 0 .. order. The series
    /// evaluator is shared with the engine; none: values are fitted.
    PieceGuards(const Equations& equations, SeriesEvaluator* series, int order, double tolerance);

    /// Whether values are fitted.
    bool fits() const { return fit_ != nullptr; }
    /// Of what coefficients() gives.
    int order() const { return order_; }

    void set_parameters(std::span<const double> parameters, Program::Rounding rounding = Program::Rounding::nearest);

    /// A mode begins, with these parameters.
    void enter(std::span<const double> parameters);

    /// Looks at another piece; `is_rest`: what was left of the last one. Returns its length, or less: how far the
    /// guards' coefficients hold.
    double begin(const Piece& piece, bool is_rest = false);

    /// Whether these say nothing of a guard all along.
    bool is_rough(int guard) const { return !rough_.empty() && rough_[static_cast<std::size_t>(guard)] != 0; }

    /// Whether a guard is known to keep its sign on the whole piece, without its coefficients.
    bool is_far(int guard) const { return far_.is_far(guard); }

    const double* coefficients(int guard);

    /// Sizes of the terms that these are made of.
    void sizes(int guard, double* s);

private:
    // a guard is halved at most so often: one that is not finite ahead is the driver's to judge
    static constexpr int most_halvings = 10;
    // of one step: a corner in it takes two for each halving, and there is room for some
    static constexpr int most_fits = 8 * (GuardFit::order + 1);
    // values that are this near to a polynomial and come no nearer on shorter intervals are rough by themselves
    static constexpr double rough = 1e-6;

    /// Not a variable itself, nor found otherwise than by its value.
    static bool is_computed(const Equations& equations, const Guard& guard) {
        return guard.output >= 0 && !equations.is_variable(guard);
    }
    /// Such guards, and their outputs.
    static std::vector<int> computed_guards(const Equations& equations);
    static std::vector<int> outputs(const Equations& equations);

    void expand();

    double series_length();

    void mark_rough(std::size_t guard);

    /// From a length on that may hold, halves until the fit does. What follows a part may be twice as long.
    double fitted_length();

    const Equations* equations_;
    SeriesEvaluator* series_;
    std::unique_ptr<GuardFit> fit_;
    HiddenTerms hidden_;  // of series
    FarNorms far_;
    bool is_expanded_ = false;
    int order_;
    double tolerance_, log_tolerance_;
    std::vector<signed char> rough_;        // by guard; empty: none is
    int fits_left_ = 0;                     // on this step
    double first_try_ = 0.0, least_ = 0.0;  // lengths of its parts
    bool goes_on_ = false;                  // there was a piece of this mode
    bool need_more_ = false;                // than the variables themselves
    Piece piece_;
    std::array<double, 32> row_{};
};

}  // namespace rbdyn::inline RBDYN_FORM
