// The rows of constraints as programs of the state: what a projection asks for after every step (closure.hpp).
//
// Gaps, their rates, and what forces along the rows do, as the tree computes them (constraint.hpp, accelerate.hpp), but
// without what is zero, one or constant in this scene for good: of a linkage in a plane a twentieth of the operations
// is left. Recorded once for each set of equations, when they are first asked for.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/tree.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// Of rows of constraints of a tree whose gaps and rates are smooth functions of the state alone.
class RecordedRows {
public:
    [[gnu::cold]] RecordedRows(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows, double t,
                               std::span<const double> x);

    /// Whether they could be: no function or curve of the user's is in them, no distinction that a state decides, and
    /// they are not so many that their answers, one for each row and velocity, would be long.
    bool is_there() const { return is_there_; }

    /// Of each row, from time and state.
    Program gaps, rates;
    /// The lower half of J M^-1 J^T, row by row, then for each row what a unit of force along it changes the velocity
    /// variables by.
    Program answers;

private:
    bool is_there_ = false;
};

/// The same, recorded when somebody asks; from any thread.
class LazyRows {
public:
    /// None where they could not be recorded.
    const RecordedRows* operator()(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
                                   double t, std::span<const double> x) const;

private:
    mutable std::once_flag once_;
    mutable std::unique_ptr<const RecordedRows> rows_;
};

/// Evaluates them; gaps and rates in more digits than doubles have.
class RowValues {
public:
    using Real = long double;

    RowValues(const RecordedRows& rows, int count, int velocities);

    /// What closes each gap, and ends its rate: minus these, as doubles.
    std::vector<double> against_gaps(double t, const std::vector<Real>& x) { return against(gaps_, t, x); }
    std::vector<double> against_rates(double t, const std::vector<Real>& x) { return against(rates_, t, x); }
    /// Where the answers are from now on.
    void look(double t, std::span<const double> x);
    /// The change of the velocity variables that changes each row by what is asked.
    std::vector<double> changes(const std::vector<double>& asked) const;

private:
    std::vector<double> against(Evaluator<Real>& values, double t, const std::vector<Real>& x) const;

    Evaluator<Real> gaps_, rates_;
    Evaluator<double> answers_;
    std::vector<std::vector<double>> matrix_;
    int velocities_;
};

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
