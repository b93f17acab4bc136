// Definitions of rbdyn/expression/gradient.hpp.
#pragma once

#include "rbdyn/expression/gradient.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE GradientEvaluator::GradientEvaluator(const Program& program)
    : Evaluator<double>(program),
      maker_(static_cast<std::size_t>(program.slots()), -1),
      adjoints_(static_cast<std::size_t>(program.slots()), 0.0),
      is_due_(program.instructions().size(), false) {
    int index = 0;
    for (const Instruction& i : program.instructions()) {
        const auto makes = [&](int slot) {
            if (slot >= 0) maker_[static_cast<std::size_t>(slot)] = index;
        };
        if (i.code == Code::call)
            for (const int result : program.calls()[static_cast<std::size_t>(i.extra)].results) makes(result);
        else
            makes(i.out);
        if (i.code == Code::sine_cosine || i.code == Code::hyperbolic) makes(i.out2);
        ++index;
    }
}

RBDYN_INLINE double GradientEvaluator::magnitude(int index) const {
    const int maker = maker_[static_cast<std::size_t>(program_->output(index))];
    if (maker >= 0)
        if (const Instruction& i = program_->instructions()[static_cast<std::size_t>(maker)]; i.code == Code::combine)
            return Evaluator<double>::magnitude(i);
    return std::abs(output(index));
}

RBDYN_INLINE void GradientEvaluator::add(int slot, double adjoint) {
    const auto at = static_cast<std::size_t>(slot);
    const int maker = maker_[at];
    if (maker < 0) {
        if (slot > program_->time_slot()) return;
        touched_.push_back(slot);
    } else if (!is_due_[static_cast<std::size_t>(maker)]) {
        is_due_[static_cast<std::size_t>(maker)] = true;
        due_.push_back(maker);
        std::push_heap(due_.begin(), due_.end());
    }
    adjoints_[at] += adjoint;
}

RBDYN_INLINE const std::vector<std::pair<int, double>>& GradientEvaluator::gradient(int output) {
    gradient_.clear();
    add(program_->output(output), 1.0);
    while (!due_.empty()) {
        std::pop_heap(due_.begin(), due_.end());
        const int index = due_.back();
        due_.pop_back();
        is_due_[static_cast<std::size_t>(index)] = false;
        go_back(program_->instructions()[static_cast<std::size_t>(index)]);
    }
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    for (const int slot : touched_) {
        double& adjoint = adjoints_[static_cast<std::size_t>(slot)];
        gradient_.emplace_back(slot == program_->time_slot() ? program_->inputs() : slot, adjoint);
        adjoint = 0.0;
    }
    touched_.clear();
    return gradient_;
}

RBDYN_INLINE void GradientEvaluator::go_back(const Instruction& i) {
    const double* s = slots_.data();
    const double* w = scalars_.data();
    const auto taken = [&](int slot) { return std::exchange(adjoints_[static_cast<std::size_t>(slot)], 0.0); };
    if (i.code == Code::call) {
        // of an opaque function there are differences only: one more call for each argument
        const Program::Call& c = program_->calls()[static_cast<std::size_t>(i.extra)];
        std::vector<double> x, adjoints, y, moved(c.results.size());
        for (const int argument : c.arguments) x.push_back(s[argument]);
        for (const int result : c.results) {
            y.push_back(s[result]);
            adjoints.push_back(taken(result));
        }
        double size = 0.0;
        for (const double value : x) size = std::max(size, std::abs(value));
        for (std::size_t k = 0; k < x.size(); ++k) {
            const double kept = x[k], h = 1.5e-8 * (kept != 0.0 ? std::abs(kept) : size > 0.0 ? size : 1.0);
            x[k] = kept + h;
            (*c.function)(x.data(), moved.data());
            double sum = 0.0;
            for (std::size_t r = 0; r < y.size(); ++r) sum += adjoints[r] * ((moved[r] - y[r]) / (x[k] - kept));
            x[k] = kept;
            add(c.arguments[k], sum);
        }
        return;
    }
    const double a = taken(i.out);
    switch (i.code) {
        case Code::combine:
            for (int k = 0; k < i.terms; ++k) {
                const Term& term = program_->terms(i)[k];
                add(term.slot, a * w[term.weight]);
            }
            for (int k = 0; k < i.products; ++k) {
                const ProductTerm& p = program_->products(i)[k];
                add(p.a, a * w[p.weight] * s[p.b]);
                add(p.b, a * w[p.weight] * s[p.a]);
            }
            break;
        case Code::divide:
            add(i.a, a / s[i.b]);
            add(i.b, -a * s[i.out] / s[i.b]);
            break;
        case Code::square_root: add(i.a, a * 0.5 / s[i.out]); break;
        case Code::norm:
            for (const int slot : {i.a, i.b, i.c}) add(slot, s[i.out] > 0.0 ? a * s[slot] / s[i.out] : 0.0);
            break;
        case Code::sine_cosine: add(i.a, a * s[i.out2] - taken(i.out2) * s[i.out]); break;
        case Code::hyperbolic: add(i.a, a * s[i.out2] + taken(i.out2) * s[i.out]); break;
        case Code::tangent: add(i.a, a * (1.0 - s[i.out] * s[i.out])); break;
        case Code::angle:
            add(i.a, a * s[i.b] / s[i.c]);
            add(i.b, -a * s[i.a] / s[i.c]);
            break;
        case Code::exponential: add(i.a, a * s[i.out]); break;
        case Code::logarithm: add(i.a, a / s[i.a]); break;
        case Code::expm1: add(i.a, a * std::exp(s[i.a])); break;
        case Code::log1p:
        case Code::arsinh:
        case Code::artanh: add(i.a, a / inverse_divisor(i.code, s[i.a])); break;
        case Code::power: {
            const double base = i.is_locked ? std::abs(s[i.a]) : s[i.a];
            add(i.a, a * i.value * std::pow(base, i.value - 1.0));
            break;
        }
        case Code::call: break;
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
