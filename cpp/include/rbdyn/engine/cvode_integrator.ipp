// Definitions of rbdyn/engine/cvode_integrator.hpp.
#pragma once

#include "rbdyn/engine/cvode_integrator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <new>
#include <span>
#include <utility>

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

namespace rbdyn::inline RBDYN_FORM::cvode {

RBDYN_INLINE Integrator::Integrator(const Equations& equations, bool stiff, int series_order, double guard_tolerance,
                                    SUNContext context, Work& work)
    : evaluator(equations.program),
      series(equations.program, series_order),
      ahead(equations.program),
      guards(equations, series_are_known(equations) ? &series : nullptr, series_order, guard_tolerance),
      n(equations.variables()),
      weights(static_cast<std::size_t>(n), 0.0),
      y(owned(new_vector(n, context))),
      derivative(owned(new_vector(n, context))),
      memory(owned(CVodeCreate(stiff ? CV_BDF : CV_ADAMS, context))),
      work_(work) {
    void* m = memory.get();
#if SUNDIALS_VERSION_MAJOR < 7
    CVodeSetErrHandlerFn(
        m, [](int, const char*, const char*, char*, void*) {}, nullptr);
#endif
    CVodeSetMaxHnilWarns(m, -1);
    // a step that is far too long, as the first may be, is shortened until it is not
    CVodeSetMaxErrTestFails(m, 40);
    CVodeSetMaxConvFails(m, 40);
    if (CVodeInit(m, right_hand_side, 0.0, y.get()) != CV_SUCCESS) throw std::bad_alloc();
    CVodeSetUserData(m, this);
    CVodeWFtolerances(m, error_weights);
    if (stiff) {
        nonlinear_ = owned(SUNNonlinSol_Newton(y.get(), context));
        CVodeSetNonlinearSolver(m, nonlinear_.get());
        prepare_linear_algebra(equations.program);
        // CVODE asks for a Jacobian every 50 steps or so and for 1.1 right-hand sides a step; a matrix-embedded
        // solver with a new Jacobian each step asks for 1.7 and is 15 percent slower on a pendulum already
        matrix_ = owned(SUNMatNewEmpty(context));
        linear_ = owned(SUNLinSolNewEmpty(context));
        linear_->content = this;
        linear_->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
        linear_->ops->setup = [](SUNLinearSolver solver, SUNMatrix) {
            return static_cast<Integrator*>(solver->content)->factorise() ? 0 : SUNLS_LUFACT_FAIL;
        };
        linear_->ops->solve = [](SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, sunrealtype) {
            static_cast<Integrator*>(solver->content)->substitute(values(b), values(x));
            return 0;
        };
        CVodeSetLinearSolver(m, linear_.get(), matrix_.get());
        CVodeSetLinSysFn(m, linear_system);
    } else {
        nonlinear_ = owned(SUNNonlinSol_FixedPoint(y.get(), 0, context));
        CVodeSetNonlinearSolver(m, nonlinear_.get());
    }
}

RBDYN_INLINE void Integrator::set_parameters(std::span<const double> parameters, Program::Rounding rounding) {
    evaluator.set_parameters(parameters, rounding);
    if (jacobian_) jacobian_->set_parameters(parameters, rounding);
    series.set_parameters(parameters, rounding);
    ahead.set_parameters(parameters, rounding);
    guards.set_parameters(parameters, rounding);
}

RBDYN_INLINE void Integrator::restart(Instant t, double first_step) {
    origin = t;
    CVodeReInit(memory.get(), 0.0, y.get());
    CVodeSetInitStep(memory.get(), first_step);
}

RBDYN_INLINE int Integrator::right_hand_side(sunrealtype t, N_Vector y, N_Vector dy, void* data) {
    auto& self = *static_cast<Integrator*>(data);
    try {
        ++self.work_.right_hand_sides;
        self.evaluator((self.origin + t).hi, self.span_of(y));
    } catch (...) {
        self.thrown = std::current_exception();
        return -1;
    }
    double* out = values(dy);
    double check = 0.0;
    for (int i = 0; i < self.n; ++i) {
        out[i] = self.evaluator.output(i);
        check += 0.0 * out[i];
    }
    return check == 0.0 ? 0 : 1;  // 1: not finite, try a shorter step
}

RBDYN_INLINE int Integrator::error_weights(N_Vector, N_Vector weights, void* data) {
    const auto& self = *static_cast<Integrator*>(data);
    std::copy(self.weights.begin(), self.weights.end(), values(weights));
    return 0;
}

RBDYN_INLINE int Integrator::linear_system(sunrealtype t, N_Vector y, N_Vector, SUNMatrix, sunbooleantype is_good,
                                           sunbooleantype* is_new, sunrealtype gamma, void* data, N_Vector, N_Vector,
                                           N_Vector) {
    auto& self = *static_cast<Integrator*>(data);
    *is_new = is_good ? SUNFALSE : SUNTRUE;
    double check = 0.0;
    if (!is_good) {
        try {
            ++self.work_.jacobians;
            self.jacobian_->differentiate((self.origin + t).hi, self.span_of(y));
        } catch (...) {
            self.thrown = std::current_exception();
            return -1;
        }
        for (const double entry : self.jacobian_->entries()) check += 0.0 * entry;
    }
    self.choose_units();
    const auto& units = self.units_;
    if (self.band_) {
        self.band_->clear();
        for (int i = 0; i < self.n; ++i) {
            const int row = self.place_[static_cast<std::size_t>(i)];
            const std::span<const int> columns = self.jacobian_->columns(i);
            const std::span<const double> entries = self.jacobian_->entries(i);
            for (std::size_t k = 0; k < columns.size(); ++k)
                (*self.band_)(row, self.place_[static_cast<std::size_t>(columns[k])]) =
                    -gamma * entries[k] *
                    (units[static_cast<std::size_t>(i)] / units[static_cast<std::size_t>(columns[k])]);
            (*self.band_)(row, row) += 1.0;
        }
        return check == 0.0 ? 0 : 1;
    }
    std::fill(self.lu_.begin(), self.lu_.end(), 0.0);
    for (int i = 0; i < self.n; ++i) {
        const std::span<const int> columns = self.jacobian_->columns(i);
        const std::span<const double> entries = self.jacobian_->entries(i);
        for (std::size_t k = 0; k < columns.size(); ++k)
            self.lu(i, columns[k]) = -gamma * entries[k] *
                                     (units[static_cast<std::size_t>(i)] / units[static_cast<std::size_t>(columns[k])]);
        self.lu(i, i) += 1.0;
    }
    return check == 0.0 ? 0 : 1;
}

RBDYN_INLINE void Integrator::prepare_linear_algebra(const Program& program) {
    jacobian_.emplace(program);
    const auto size = static_cast<std::size_t>(n);
    units_.assign(size, 1.0);
    if (jacobian_->is_sparse()) {
        BandOrder order = BandOrder::of(jacobian_->rows(), jacobian_->columns());
        if (BandMatrix::pays(n, order.width)) {
            band_.emplace(n, order.width);
            place_ = std::move(order.place);
            in_band_.resize(size);
            return;
        }
    }
    lu_.resize(size * size);
    pivots_.resize(size);
}

RBDYN_INLINE bool Integrator::factorise_all() {
    for (int k = 0; k < n; ++k) {
        int pivot = k;
        for (int i = k + 1; i < n; ++i)
            if (std::abs(lu(i, k)) > std::abs(lu(pivot, k))) pivot = i;
        pivots_[static_cast<std::size_t>(k)] = pivot;
        if (pivot != k) std::swap_ranges(&lu(k, 0), &lu(k, 0) + n, &lu(pivot, 0));
        const double inverse = 1.0 / lu(k, k);
        if (!std::isfinite(inverse) || inverse == 0.0) return false;
        for (int i = k + 1; i < n; ++i) {
            const double factor = lu(i, k) *= inverse;
            for (int j = k + 1; j < n; ++j) lu(i, j) -= factor * lu(k, j);
        }
    }
    return true;
}

RBDYN_INLINE void Integrator::choose_units() {
    for (std::size_t i = 0; i < units_.size(); ++i) {
        // none where nothing watches over an error
        const bool is_known = std::isfinite(weights[i]) && weights[i] > 0.0;
        units_[i] = is_known ? std::scalbn(1.0, std::ilogb(weights[i])) : 1.0;
    }
}

RBDYN_INLINE void Integrator::substitute(const double* b, double* x) {
    if (!band_) {
        for (std::size_t i = 0; i < units_.size(); ++i) x[i] = b[i] * units_[i];
        substitute_all(x);
        for (std::size_t i = 0; i < units_.size(); ++i) x[i] /= units_[i];
        return;
    }
    for (std::size_t i = 0; i < place_.size(); ++i) in_band_[static_cast<std::size_t>(place_[i])] = b[i] * units_[i];
    band_->solve(in_band_);
    for (std::size_t i = 0; i < place_.size(); ++i) x[i] = in_band_[static_cast<std::size_t>(place_[i])] / units_[i];
}

RBDYN_INLINE void Integrator::substitute_all(double* x) {
    for (int k = 0; k < n; ++k) std::swap(x[k], x[pivots_[static_cast<std::size_t>(k)]]);
    for (int i = 1; i < n; ++i)
        for (int j = 0; j < i; ++j) x[i] -= lu(i, j) * x[j];
    for (int i = n - 1; i >= 0; --i) {
        for (int j = i + 1; j < n; ++j) x[i] -= lu(i, j) * x[j];
        x[i] /= lu(i, i);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::cvode
