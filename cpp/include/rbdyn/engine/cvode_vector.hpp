// What CVODE is given to work with: a silent context, owned handles, and vectors that suit the few variables of a
// motion.
//
// CVODE spends most of a step in its vectors. Its own serial vectors look at the special cases of every operation first
// (coefficients 1 and -1, results in place); for 2 to 20 variables that costs more than the arithmetic.
#pragma once

#ifndef RBDYN_WITH_SUNDIALS
#error "rbdyn/engine/cvode.hpp needs SUNDIALS: link rbdyn::rbdyn, or define RBDYN_WITH_SUNDIALS and link CVODE yourself"
#endif

#include <cvode/cvode.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <sunnonlinsol/sunnonlinsol_newton.h>

#include <memory>
#include <new>
#include <type_traits>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::cvode {

struct Free {
    void operator()(SUNContext context) const { SUNContext_Free(&context); }
    void operator()(N_Vector v) const { N_VDestroy(v); }
    void operator()(SUNNonlinearSolver solver) const { SUNNonlinSolFree(solver); }
    void operator()(SUNLinearSolver solver) const { SUNLinSolFreeEmpty(solver); }
    void operator()(SUNMatrix matrix) const { SUNMatFreeEmpty(matrix); }
    void operator()(void* memory) const { CVodeFree(&memory); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Free>;

template <class Handle>
Owned<Handle> owned(Handle handle) {
    if (handle == nullptr) throw std::bad_alloc();
    return Owned<Handle>(handle);
}

/// A context that keeps its messages to itself: failures are told by return values.
Owned<SUNContext> make_context();

struct Vector : _generic_N_Vector {
    int size = 0;
    std::unique_ptr<double[]> storage;
};

inline double* values(N_Vector v) { return static_cast<double*>(v->content); }
inline int size(N_Vector v) { return static_cast<Vector*>(v)->size; }

/// Null if memory is short: exceptions must not pass through C.
N_Vector create(int size, N_Vector_Ops operations, SUNContext context) noexcept;

inline void destroy(N_Vector v) { delete static_cast<Vector*>(v); }

/// z_i = f(i); z may be one of the operands.
template <class F>
void each(N_Vector z, F f) {
    double* out = values(z);
    const int n = size(z);
    for (int i = 0; i < n; ++i) out[i] = f(i);
}

/// sum_i f(i)
template <class F>
double sum(N_Vector x, F f) {
    double total = 0.0;
    const int n = size(x);
    for (int i = 0; i < n; ++i) total += f(i);
    return total;
}

double weighted_squares(N_Vector x, N_Vector w);

/// All that CVODE asks of a vector, and the sums over several vectors that its steps are made of.
_generic_N_Vector_Ops make_operations();

N_Vector new_vector(int size, SUNContext context);

}  // namespace rbdyn::inline RBDYN_FORM::cvode
