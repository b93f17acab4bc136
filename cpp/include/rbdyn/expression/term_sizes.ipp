// Definitions of rbdyn/expression/term_sizes.hpp.
#pragma once

#include "rbdyn/expression/term_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE TermSizes::TermSizes(const SeriesEvaluator& series, int order, int depth)
    : series_(series), program_(series.program()), order_(order), depth_(depth) {
    constexpr std::size_t usual = 16;
    known_.reserve(usual);
}

RBDYN_INLINE TermSizes::Sizes TermSizes::own(int slot) const {
    Sizes s{};
    const double* c = series_.coefficients(slot);
    for (int k = 0; k <= order_; ++k) s[at(k)] = std::abs(c[k]);
    return s;
}

RBDYN_INLINE void TermSizes::allow_for_time(int slot, Sizes& s) const {
    if (!program_.is_of_time(slot)) return;
    const double late = std::abs(first(program_.time_slot())) / series_.unit();
    const double* c = series_.coefficients(slot);
    for (int k = 0; k < order_; ++k) s[at(k)] = std::max(s[at(k)], late * (k + 1) * std::abs(c[k + 1]));
}

RBDYN_INLINE void TermSizes::add_product(Sizes& sum, double weight, const Sizes& a, const Sizes& b) const {
    for (int k = 0; k <= order_; ++k)
        for (int j = 0; j <= k; ++j) sum[at(k)] += weight * a[at(j)] * b[at(k - j)];
}

RBDYN_INLINE TermSizes::Sizes TermSizes::sizes(int slot, int deep) {
    for (const auto& [done, s] : known_)
        if (done == slot) return s;
    Sizes s = own(slot);
    if (deep == 0) {
        allow_for_time(slot, s);
        return s;
    }
    // what a rate depends on by itself is as large as it is
    const std::size_t place = known_.size();
    known_.emplace_back(slot, s);
    if (slot < program_.inputs()) {
        if (slot >= program_.outputs()) return s;
        const Sizes rate = sizes(program_.output(slot), deep - 1);
        for (int k = 0; k < order_; ++k) s[at(k + 1)] = std::max(s[at(k + 1)], rate[at(k)] * series_.unit() / (k + 1));
    } else {
        for (const Instruction& i : program_.instructions())
            if (i.out == slot || (i.out2 == slot && (i.code == Code::sine_cosine || i.code == Code::hyperbolic))) {
                pass_on(i, slot, deep - 1, s);
                break;
            }
    }
    allow_for_time(slot, s);
    known_[place].second = s;
    return s;
}

RBDYN_INLINE void TermSizes::pass_on(const Instruction& i, int slot, int deep, Sizes& s) {
    switch (i.code) {
        case Code::combine: {
            s.fill(0.0);
            if (i.weight >= 0) s[0] = std::abs(series_.weight(i.weight));
            for (int k = 0; k < i.terms; ++k) {
                const Term& t = program_.terms(i)[k];
                const Sizes a = sizes(t.slot, deep);
                const double weight = std::abs(series_.weight(t.weight));
                for (int j = 0; j <= order_; ++j) s[at(j)] += weight * a[at(j)];
            }
            for (int k = 0; k < i.products; ++k) {
                const ProductTerm& t = program_.products(i)[k];
                const double weight = std::abs(series_.weight(t.weight));
                add_product(s, weight, sizes(t.a, deep), own(t.b));
                add_product(s, weight, own(t.a), sizes(t.b, deep));
            }
            break;
        }
        case Code::divide: {
            Sizes sum = sizes(i.a, deep);
            add_product(sum, 1.0, own(slot), sizes(i.b, deep));
            add(s, sum, 1.0 / first(i.b));
            break;
        }
        case Code::square_root: add(s, sizes(i.a, deep), 0.5 / first(slot)); break;
        case Code::sine_cosine:
        case Code::hyperbolic: add_product(s, 1.0, sizes(i.a, deep), own(slot == i.out ? i.out2 : i.out)); break;
        case Code::exponential: add_product(s, 1.0, sizes(i.a, deep), own(slot)); break;
        case Code::expm1:
        case Code::tangent: add_product(s, 1.0, sizes(i.a, deep), own(i.out2)); break;
        case Code::logarithm: add(s, sizes(i.a, deep), 1.0 / first(i.a)); break;
        case Code::log1p:
        case Code::arsinh:
        case Code::artanh: add(s, sizes(i.a, deep), 1.0 / first(i.out2)); break;
        case Code::power: add(s, sizes(i.a, deep), i.value * first(slot) / first(i.a)); break;
        case Code::angle: {
            const double square = first(i.a) * first(i.a) + first(i.b) * first(i.b);
            add(s, sizes(i.a, deep), first(i.b) / square);
            add(s, sizes(i.b, deep), first(i.a) / square);
            break;
        }
        case Code::norm:
        case Code::call: break;
    }
}

RBDYN_INLINE void TermSizes::add(Sizes& s, const Sizes& other, double factor) const {
    if (!std::isfinite(factor)) return;
    for (int k = 0; k <= order_; ++k) s[at(k)] += std::abs(factor) * other[at(k)];
}

}  // namespace rbdyn::inline RBDYN_FORM
