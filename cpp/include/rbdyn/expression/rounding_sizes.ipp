// Definitions of rbdyn/expression/rounding_sizes.hpp.
#pragma once

#include "rbdyn/expression/rounding_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RoundingSizes::RoundingSizes(const Program& program)
    : Evaluator<double>(program), sizes_(static_cast<std::size_t>(program.slots()), 0.0) {}

RBDYN_INLINE void RoundingSizes::operator()(double t, std::span<const double> x, std::span<const double> known) {
    Evaluator<double>::operator()(t, x);
    const double* s = slots_.data();
    const double* w = scalars_.data();
    for (int i = 0; i <= program_->time_slot(); ++i) of(i) = std::abs(s[i]);
    for (std::size_t i = 0; i < known.size(); ++i) sizes_[i] = std::max(sizes_[i], known[i]);
    for (const Instruction& i : program_->instructions()) {
        const auto own = [&](int slot) { return std::abs(s[slot]); };
        const auto passed = [&](int slot, double slope) {
            return std::isfinite(slope) ? std::abs(slope) * of(slot) : 0.0;
        };
        switch (i.code) {
            case Code::combine: {
                double sum = i.weight >= 0 ? std::abs(w[i.weight]) : 0.0;
                for (int k = 0; k < i.terms; ++k) {
                    const Term& term = program_->terms(i)[k];
                    sum += passed(term.slot, w[term.weight]);
                }
                for (int k = 0; k < i.products; ++k) {
                    const ProductTerm& p = program_->products(i)[k];
                    sum += passed(p.a, w[p.weight] * s[p.b]) + passed(p.b, w[p.weight] * s[p.a]);
                }
                of(i.out) = sum;
                break;
            }
            case Code::divide:
                of(i.out) = own(i.out) + passed(i.a, 1.0 / s[i.b]) + passed(i.b, s[i.out] / s[i.b]);
                break;
            case Code::square_root: of(i.out) = own(i.out) + passed(i.a, 0.5 / s[i.out]); break;
            case Code::norm:
                // no part of a length counts more than by itself
                of(i.out) = own(i.out) + of(i.a) + of(i.b) + of(i.c);
                break;
            case Code::sine_cosine:
            case Code::hyperbolic:
                of(i.out) = own(i.out) + passed(i.a, s[i.out2]);
                of(i.out2) = own(i.out2) + passed(i.a, s[i.out]);
                break;
            case Code::tangent: of(i.out) = own(i.out) + passed(i.a, 1.0 - s[i.out] * s[i.out]); break;
            case Code::exponential: of(i.out) = own(i.out) + passed(i.a, s[i.out]); break;
            case Code::logarithm: of(i.out) = own(i.out) + passed(i.a, 1.0 / s[i.a]); break;
            case Code::expm1: of(i.out) = own(i.out) + passed(i.a, std::exp(s[i.a])); break;
            case Code::log1p:
            case Code::arsinh:
            case Code::artanh: of(i.out) = own(i.out) + passed(i.a, 1.0 / inverse_divisor(i.code, s[i.a])); break;
            case Code::power: of(i.out) = own(i.out) + passed(i.a, i.value * s[i.out] / s[i.a]); break;
            case Code::angle: {
                const double square = s[i.a] * s[i.a] + s[i.b] * s[i.b];
                of(i.out) = own(i.out) + passed(i.a, s[i.b] / square) + passed(i.b, s[i.a] / square);
                break;
            }
            case Code::call:
                // of an opaque function nothing more is known
                for (const int result : program_->calls()[static_cast<std::size_t>(i.extra)].results)
                    of(result) = own(result);
                break;
        }
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
