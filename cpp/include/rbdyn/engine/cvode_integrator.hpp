// One CVODE object set up for one set of equations: right-hand side, error weights, linear algebra.
//
// Part of engine/cvode.hpp, which says what it is for. Exceptions stop at CVODE's C frames; nothing prints.
#pragma once

#include <cstddef>
#include <exception>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/band.hpp"
#include "rbdyn/engine/cvode_vector.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/piece_guards.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/state_jacobian.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace cvode {

/// CVODE set up for one set of equations; stays where it is, for CVODE holds its address.
class Integrator {
public:
    [[gnu::cold]] Integrator(const Equations& equations, bool stiff, int series_order, double guard_tolerance,
                             SUNContext context, Work& work);
    Integrator(const Integrator&) = delete;
    Integrator& operator=(const Integrator&) = delete;

    void set_parameters(std::span<const double> parameters, Program::Rounding rounding);

    double* state() { return values(y.get()); }
    std::span<const double> span_of(N_Vector v) const { return {values(v), static_cast<std::size_t>(n)}; }

    /// Begins anew from y; the clock at zero.
    void restart(Instant t, double first_step);

    Evaluator<double> evaluator;
    std::exception_ptr thrown;  // by a function of the user's, kept while CVODE's own frames are left
    SeriesEvaluator series;
    HiddenAhead ahead;
    PieceGuards guards;
    int n;
    std::vector<double> weights;
    Instant origin;
    Owned<N_Vector> y, derivative;

private:
    // freed from the last to the first
    Owned<SUNNonlinearSolver> nonlinear_;
    Owned<SUNMatrix> matrix_;  // empty: the solver keeps its own numbers
    Owned<SUNLinearSolver> linear_;

public:
    Owned<void*> memory;

private:
    static int right_hand_side(sunrealtype t, N_Vector y, N_Vector dy, void* data);

    static int error_weights(N_Vector, N_Vector weights, void* data);

    /// I - gamma J for Newton's method, with the last Jacobian if CVODE finds it good enough.
    static int linear_system(sunrealtype t, N_Vector y, N_Vector, SUNMatrix, sunbooleantype is_good,
                             sunbooleantype* is_new, sunrealtype gamma, void* data, N_Vector, N_Vector, N_Vector);

    /// What BDF needs: the Jacobian, and room for I - gamma J, in a band if that is narrow.
    void prepare_linear_algebra(const Program& program);

    /// LU in place with row exchanges; false if singular.
    bool factorise() { return band_ ? band_->factorise() : factorise_all(); }
    bool factorise_all();

    /// Variables are measured in powers of two near their tolerances there: which rows are exchanged, and so every bit,
    /// is the same in other units.
    void choose_units();

    void substitute(const double* b, double* x);
    void substitute_all(double* x);

    double& lu(int i, int j) { return lu_[static_cast<std::size_t>(i * n + j)]; }

    Work& work_;
    std::optional<StateJacobian> jacobian_;  // of BDF
    std::vector<double> lu_;                 // by rows
    std::vector<int> pivots_;
    std::vector<double> units_;  // of what is factorised: 1 over the unit of each variable
    std::optional<BandMatrix> band_;
    std::vector<int> place_;  // of variables in the band
    std::vector<double> in_band_;
};

}  // namespace cvode

}  // namespace rbdyn::inline RBDYN_FORM
