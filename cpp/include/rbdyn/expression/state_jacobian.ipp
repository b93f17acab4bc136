// Definitions of rbdyn/expression/state_jacobian.hpp.
#pragma once

#include "rbdyn/expression/state_jacobian.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Dependence::Dependence(const Program& program, std::size_t most) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<std::vector<int>> of(at(program.slots()));
    std::size_t size = 0;
    const auto take = [&](int slot, std::vector<int>& all) {
        if (slot >= 0) all.insert(all.end(), of[at(slot)].begin(), of[at(slot)].end());
    };
    const auto give = [&](int slot, const std::vector<int>& all) {
        if (slot < 0) return;
        of[at(slot)] = all;
        size += all.size();
    };
    for (int i = 0; i < program.inputs(); ++i) give(i, {i});
    std::vector<int> all;
    for (const Instruction& i : program.instructions()) {
        all.clear();
        // of an angle the square of the distance is no operand of its own
        for (const int slot : {i.a, i.b, i.code == Code::angle ? -1 : i.c}) take(slot, all);
        for (int t = 0; t < i.terms; ++t) take(program.terms(i)[t].slot, all);
        for (int p = 0; p < i.products; ++p) {
            take(program.products(i)[p].a, all);
            take(program.products(i)[p].b, all);
        }
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        give(i.out, all);
        give(i.out2, all);
        if (size > most) return;
    }
    first_.assign(1, 0);
    variables_.reserve(size);
    for (const std::vector<int>& own : of) {
        variables_.insert(variables_.end(), own.begin(), own.end());
        first_.push_back(variables_.size());
    }
}

/// Derivatives of each slot by the variables it depends on.
class StateJacobian::Sparse : public Evaluator<double> {
public:
    Sparse(const Program& program, Dependence known)
        : Evaluator<double>(program),
          known_(std::move(known)),
          tangents_(known_.size(), 1.0),
          sums_(static_cast<std::size_t>(program.inputs()), 0.0) {}

    const Program& program() const { return *program_; }
    const Dependence& known() const { return known_; }
    const double* tangents(int slot) const { return tangents_.data() + known_.first(slot); }

    void differentiate(double t, std::span<const double> x) {
        (*this)(t, x);
        const double* w = scalars_.data();
        for (const Instruction& i : program_->instructions()) {
            const double a = i.a >= 0 ? slot(i.a) : 0.0, b = i.b >= 0 ? slot(i.b) : 0.0, out = slot(i.out),
                         out2 = i.out2 >= 0 ? slot(i.out2) : 0.0;
            switch (i.code) {
                case Code::combine: {
                    const Term* term = program_->terms(i);
                    for (int k = 0; k < i.terms; ++k) add(w[term[k].weight], term[k].slot);
                    const ProductTerm* product = program_->products(i);
                    for (int k = 0; k < i.products; ++k) {
                        const double weight = w[product[k].weight];
                        add(weight * slot(product[k].b), product[k].a);
                        add(weight * slot(product[k].a), product[k].b);
                    }
                    break;
                }
                case Code::divide:
                    add(1.0 / b, i.a);
                    add(-out / b, i.b);
                    break;
                case Code::square_root: add(0.5 / out, i.a); break;
                case Code::norm:
                    if (!(out > 0.0)) break;
                    for (const int part : {i.a, i.b, i.c}) add(slot(part), part);
                    for (const int d : known_[i.out]) sums_[at(d)] /= out;
                    break;
                case Code::sine_cosine:
                case Code::hyperbolic:
                    add(i.code == Code::hyperbolic ? out : -out, i.a);
                    settle(i.out2);
                    add(out2, i.a);
                    break;
                case Code::tangent: add(1.0 - out * out, i.a); break;
                case Code::angle:
                    add(b / slot(i.c), i.a);
                    add(-a / slot(i.c), i.b);
                    break;
                case Code::exponential: add(out, i.a); break;
                case Code::logarithm: add(1.0 / a, i.a); break;
                case Code::expm1: add(std::exp(a), i.a); break;
                case Code::log1p:
                case Code::arsinh:
                case Code::artanh: add(1.0 / inverse_divisor(i.code, a), i.a); break;
                case Code::power: add(i.value * std::pow(i.is_locked ? std::abs(a) : a, i.value - 1.0), i.a); break;
                case Code::call: break;  // of what is called back nothing is known: all is dense
            }
            settle(i.out);
        }
    }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    void add(double factor, int slot_index) {
        const std::span<const int> own = known_[slot_index];
        const double* direction = tangents(slot_index);
        for (std::size_t k = 0; k < own.size(); ++k) sums_[at(own[k])] += factor * direction[k];
    }
    /// The sums are the derivatives of a slot.
    void settle(int slot_index) {
        double* to = tangents_.data() + known_.first(slot_index);
        for (const int d : known_[slot_index]) *to++ = std::exchange(sums_[at(d)], 0.0);
    }

    Dependence known_;
    std::vector<double> tangents_, sums_;
};

RBDYN_INLINE StateJacobian::StateJacobian(const Program& program) : n_(program.inputs()) {
    const auto n = static_cast<std::size_t>(n_);
    // where derivatives by all are carried through all slots, each costs a quarter of one that has to be looked up
    constexpr std::size_t cheaper = 4, few = 32;
    first_.assign(1, 0);
    if (n >= few && !program.has_calls()) {
        Dependence known(program, static_cast<std::size_t>(program.slots()) * n / cheaper);
        if (known.is_known()) sparse_ = std::make_unique<Sparse>(program, std::move(known));
    }
    if (sparse_ == nullptr) dense_ = std::make_unique<JacobianEvaluator>(program);
    std::vector<int> all(n);
    std::iota(all.begin(), all.end(), 0);
    for (int i = 0; i < n_; ++i) {
        const std::span<const int> own = sparse_ ? sparse_->known()[program.output(i)] : std::span<const int>(all);
        columns_.insert(columns_.end(), own.begin(), own.end());
        first_.push_back(columns_.size());
    }
    entries_.resize(columns_.size());
}

RBDYN_INLINE StateJacobian::~StateJacobian() = default;

RBDYN_INLINE void StateJacobian::set_parameters(std::span<const double> parameters, Program::Rounding rounding) {
    dense_ ? dense_->set_parameters(parameters, rounding) : sparse_->set_parameters(parameters, rounding);
}

RBDYN_INLINE void StateJacobian::differentiate(double t, std::span<const double> x) {
    double* entry = entries_.data();
    if (dense_) {
        dense_->differentiate(t, x);
        for (int i = 0; i < n_; ++i)
            for (int j = 0; j < n_; ++j) *entry++ = dense_->derivative(i, j);
        return;
    }
    sparse_->differentiate(t, x);
    for (int i = 0; i < n_; ++i)
        entry = std::copy_n(sparse_->tangents(sparse_->program().output(i)), columns(i).size(), entry);
}

}  // namespace rbdyn::inline RBDYN_FORM
