// Definitions of rbdyn/engine/cvode_vector.hpp.
#pragma once

#include "rbdyn/engine/cvode_vector.hpp"

#include <cvode/cvode.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <sunnonlinsol/sunnonlinsol_newton.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>

namespace rbdyn::inline RBDYN_FORM::cvode {

RBDYN_INLINE Owned<SUNContext> make_context() {
    SUNContext context = nullptr;
#if SUNDIALS_VERSION_MAJOR >= 7
    SUNContext_Create(SUN_COMM_NULL, &context);
    auto result = owned(context);
    SUNContext_ClearErrHandlers(context);
    SUNContext_PushErrHandler(
        context, [](int, const char*, const char*, const char*, SUNErrCode, void*, SUNContext) {}, nullptr);
    return result;
#else
    SUNContext_Create(nullptr, &context);
    return owned(context);
#endif
}

RBDYN_INLINE N_Vector create(int size, N_Vector_Ops operations, SUNContext context) noexcept {
    auto* v = new (std::nothrow) Vector;
    if (v == nullptr) return nullptr;
    v->storage.reset(new (std::nothrow) double[static_cast<std::size_t>(size)]());
    if (v->storage == nullptr) {
        delete v;
        return nullptr;
    }
    v->content = v->storage.get();
    v->ops = operations;
    v->sunctx = context;
    v->size = size;
    return v;
}

RBDYN_INLINE double weighted_squares(N_Vector x, N_Vector w) {
    const double *a = values(x), *b = values(w);
    return sum(x, [=](int i) { return (a[i] * b[i]) * (a[i] * b[i]); });
}

RBDYN_INLINE _generic_N_Vector_Ops make_operations() {
    _generic_N_Vector_Ops o{};
    o.nvgetvectorid = [](N_Vector) { return SUNDIALS_NVEC_CUSTOM; };
    o.nvclone = [](N_Vector v) { return create(size(v), v->ops, v->sunctx); };
    o.nvdestroy = destroy;
    o.nvgetarraypointer = values;
    o.nvgetlength = [](N_Vector v) { return static_cast<sunindextype>(size(v)); };

    o.nvlinearsum = [](double a, N_Vector x, double b, N_Vector y, N_Vector z) {
        const double *u = values(x), *v = values(y);
        each(z, [=](int i) { return a * u[i] + b * v[i]; });
    };
    o.nvconst = [](double c, N_Vector z) { each(z, [=](int) { return c; }); };
    o.nvprod = [](N_Vector x, N_Vector y, N_Vector z) {
        const double *u = values(x), *v = values(y);
        each(z, [=](int i) { return u[i] * v[i]; });
    };
    o.nvdiv = [](N_Vector x, N_Vector y, N_Vector z) {
        const double *u = values(x), *v = values(y);
        each(z, [=](int i) { return u[i] / v[i]; });
    };
    o.nvscale = [](double c, N_Vector x, N_Vector z) {
        const double* u = values(x);
        each(z, [=](int i) { return c * u[i]; });
    };
    o.nvabs = [](N_Vector x, N_Vector z) {
        const double* u = values(x);
        each(z, [=](int i) { return std::abs(u[i]); });
    };
    o.nvinv = [](N_Vector x, N_Vector z) {
        const double* u = values(x);
        each(z, [=](int i) { return 1.0 / u[i]; });
    };
    o.nvaddconst = [](N_Vector x, double b, N_Vector z) {
        const double* u = values(x);
        each(z, [=](int i) { return u[i] + b; });
    };
    o.nvdotprod = [](N_Vector x, N_Vector y) {
        const double *u = values(x), *v = values(y);
        return sum(x, [=](int i) { return u[i] * v[i]; });
    };
    o.nvmaxnorm = [](N_Vector x) {
        double largest = 0.0;
        for (int i = 0; i < size(x); ++i) largest = std::max(largest, std::abs(values(x)[i]));
        return largest;
    };
    o.nvmin = [](N_Vector x) { return *std::min_element(values(x), values(x) + size(x)); };
    o.nvl1norm = [](N_Vector x) {
        const double* u = values(x);
        return sum(x, [=](int i) { return std::abs(u[i]); });
    };
    o.nvwrmsnorm = [](N_Vector x, N_Vector w) { return std::sqrt(weighted_squares(x, w) / size(x)); };
    o.nvwl2norm = [](N_Vector x, N_Vector w) { return std::sqrt(weighted_squares(x, w)); };

    o.nvlinearcombination = [](int count, double* c, N_Vector* x, N_Vector z) {
        // most factors of a derivative at the end of a step are zero
        int first = 0;
        while (first < count - 1 && c[first] == 0.0) ++first;
        each(z, [=](int i) {
            double total = c[first] * values(x[first])[i];
            for (int j = first + 1; j < count; ++j) total += c[j] * values(x[j])[i];
            return total;
        });
        return 0;
    };
    o.nvscaleaddmulti = [](int count, double* a, N_Vector x, N_Vector* y, N_Vector* z) {
        const double* u = values(x);
        for (int j = 0; j < count; ++j) {
            const double *v = values(y[j]), c = a[j];
            each(z[j], [=](int i) { return c * u[i] + v[i]; });
        }
        return 0;
    };
    o.nvscalevectorarray = [](int count, double* c, N_Vector* x, N_Vector* z) {
        for (int j = 0; j < count; ++j) {
            const double *u = values(x[j]), factor = c[j];
            each(z[j], [=](int i) { return factor * u[i]; });
        }
        return 0;
    };
    return o;
}

RBDYN_INLINE N_Vector new_vector(int size, SUNContext context) {
    static _generic_N_Vector_Ops operations = make_operations();
    return create(size, &operations, context);
}

}  // namespace rbdyn::inline RBDYN_FORM::cvode
