// Definitions of rbdyn/expression/evaluate.hpp.
#pragma once

#include "rbdyn/expression/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE JacobianEvaluator::JacobianEvaluator(const Program& program, bool with_time)
    : Evaluator<double>(program),
      n_(program.inputs() + (with_time ? 1 : 0)),
      tangents_(static_cast<std::size_t>(program.slots() * n_), 0.0) {
    for (int i = 0; i < program.inputs(); ++i) at(i)[i] = 1.0;
    if (with_time) at(program.time_slot())[program.inputs()] = 1.0;
}

RBDYN_INLINE void JacobianEvaluator::differentiate(double t, std::span<const double> x) {
    (*this)(t, x);
    const double* s = slots_.data();
    const double* w = scalars_.data();
    for (const Instruction& i : program_->instructions()) {
        double* out = at(i.out);
        switch (i.code) {
            case Code::combine: {
                for (int d = 0; d < n_; ++d) out[d] = 0.0;
                const Term* term = program_->terms(i);
                for (int k = 0; k < i.terms; ++k) add(out, w[term[k].weight], at(term[k].slot));
                const ProductTerm* product = program_->products(i);
                for (int k = 0; k < i.products; ++k) {
                    const double weight = w[product[k].weight];
                    add(out, weight * s[product[k].b], at(product[k].a));
                    add(out, weight * s[product[k].a], at(product[k].b));
                }
                break;
            }
            case Code::divide: chain(out, 1.0 / s[i.b], at(i.a), -s[i.out] / s[i.b], at(i.b)); break;
            case Code::square_root: chain(out, 0.5 / s[i.out], at(i.a)); break;
            case Code::norm:
                for (int d = 0; d < n_; ++d)
                    out[d] = s[i.out] > 0.0
                                 ? (s[i.a] * at(i.a)[d] + s[i.b] * at(i.b)[d] + s[i.c] * at(i.c)[d]) / s[i.out]
                                 : 0.0;
                break;
            case Code::sine_cosine:
                chain(out, s[i.out2], at(i.a));
                chain(at(i.out2), -s[i.out], at(i.a));
                break;
            case Code::hyperbolic:
                chain(out, s[i.out2], at(i.a));
                chain(at(i.out2), s[i.out], at(i.a));
                break;
            case Code::tangent: chain(out, 1.0 - s[i.out] * s[i.out], at(i.a)); break;
            case Code::angle: chain(out, s[i.b] / s[i.c], at(i.a), -s[i.a] / s[i.c], at(i.b)); break;
            case Code::call: differences(program_->calls()[static_cast<std::size_t>(i.extra)]); break;
            case Code::exponential: chain(out, s[i.out], at(i.a)); break;
            case Code::logarithm: chain(out, 1.0 / s[i.a], at(i.a)); break;
            case Code::expm1: chain(out, std::exp(s[i.a]), at(i.a)); break;
            case Code::log1p:
            case Code::arsinh:
            case Code::artanh: chain(out, 1.0 / inverse_divisor(i.code, s[i.a]), at(i.a)); break;
            case Code::power: {
                const double base = i.is_locked ? std::abs(s[i.a]) : s[i.a];
                chain(out, i.value * std::pow(base, i.value - 1.0), at(i.a));
                break;
            }
        }
    }
}

RBDYN_INLINE double JacobianEvaluator::derivative(int output, int variable) const {
    return tangents_[static_cast<std::size_t>(program_->output(output) * n_ + variable)];
}

RBDYN_INLINE void JacobianEvaluator::differences(const Program::Call& c) {
    for (const int result : c.results)
        for (int d = 0; d < n_; ++d) at(result)[d] = 0.0;
    std::vector<double> x, y(c.results.size()), moved(c.results.size());
    for (const int argument : c.arguments) x.push_back(slots_[static_cast<std::size_t>(argument)]);
    for (std::size_t i = 0; i < c.results.size(); ++i) y[i] = slots_[static_cast<std::size_t>(c.results[i])];
    double size = 0.0;
    for (const double value : x) size = std::max(size, std::abs(value));
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double* direction = at(c.arguments[k]);
        bool varies = false;
        for (int d = 0; d < n_; ++d) varies = varies || direction[d] != 0.0;
        if (!varies) continue;
        // half the digits: sqrt(epsilon) of the argument, or of the others where it is zero
        const double kept = x[k], h = 1.5e-8 * (kept != 0.0 ? std::abs(kept) : size > 0.0 ? size : 1.0);
        x[k] = kept + h;
        (*c.function)(x.data(), moved.data());
        for (std::size_t i = 0; i < y.size(); ++i) add(at(c.results[i]), (moved[i] - y[i]) / (x[k] - kept), direction);
        x[k] = kept;
    }
}

RBDYN_INLINE void JacobianEvaluator::add(double* out, double factor, const double* direction) const {
    for (int d = 0; d < n_; ++d) out[d] += factor * direction[d];
}

RBDYN_INLINE void JacobianEvaluator::chain(double* out, double fa, const double* a, double fb, const double* b) const {
    for (int d = 0; d < n_; ++d) out[d] = fa * a[d] + (b != nullptr ? fb * b[d] : 0.0);
}

}  // namespace rbdyn::inline RBDYN_FORM
