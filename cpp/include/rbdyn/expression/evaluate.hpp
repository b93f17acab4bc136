// Runs a program in plain numbers: values in any floating type, and the exact Jacobian in doubles.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "rbdyn/expression/program.hpp"

namespace rbdyn {

/// Evaluates a program at a point, in numbers of type T. Keeps its slots, so that a call allocates nothing.
template <class T>
class Evaluator {
public:
    explicit Evaluator(const Program& program) : program_(&program), slots_(static_cast<std::size_t>(program.slots())) {
        set_parameters(std::vector<T>(static_cast<std::size_t>(program.parameters()), T(0)));
    }

    void set_parameters(std::span<const T> parameters, Program::Rounding rounding = Program::Rounding::nearest) {
        program_->set_parameters(parameters, scalars_, rounding);
    }

    void operator()(T t, std::span<const T> x) {
        using std::atan2, std::cos, std::cosh, std::exp, std::log, std::pow, std::sin, std::sinh, std::sqrt, std::tanh;
        T* s = slots_.data();
        const T* w = scalars_.data();
        for (std::size_t i = 0; i < x.size(); ++i) s[i] = x[i];
        s[program_->time_slot()] = t;
        for (const Instruction& i : program_->instructions()) {
            switch (i.code) {
                case Code::combine: {
                    T sum = i.weight >= 0 ? w[i.weight] : T(0);
                    const Term* term = program_->terms(i);
                    for (int k = 0; k < i.terms; ++k) sum += w[term[k].weight] * s[term[k].slot];
                    const ProductTerm* product = program_->products(i);
                    for (int k = 0; k < i.products; ++k)
                        sum += w[product[k].weight] * (s[product[k].a] * s[product[k].b]);
                    s[i.out] = sum;
                    break;
                }
                case Code::divide: s[i.out] = s[i.a] / s[i.b]; break;
                case Code::square_root: s[i.out] = sqrt(s[i.a]); break;
                case Code::norm: s[i.out] = sqrt(s[i.a] * s[i.a] + s[i.b] * s[i.b] + s[i.c] * s[i.c]); break;
                case Code::sine_cosine: {
                    // of a copy: the compiler then sees that one call gives both
                    const T a = s[i.a];
                    s[i.out] = sin(a);
                    s[i.out2] = cos(a);
                    break;
                }
                case Code::hyperbolic:
                    s[i.out] = sinh(s[i.a]);
                    s[i.out2] = cosh(s[i.a]);
                    break;
                case Code::tangent: s[i.out] = tanh(s[i.a]); break;
                case Code::angle: s[i.out] = atan2(s[i.a], s[i.b]); break;
                case Code::call: call(program_->calls()[static_cast<std::size_t>(i.extra)]); break;
                case Code::exponential: s[i.out] = exp(s[i.a]); break;
                case Code::logarithm: s[i.out] = log(s[i.a]); break;
                case Code::power:
                    s[i.out] = i.is_locked ? locked_power(s[i.a], T(i.value)) : pow(s[i.a], T(i.value));
                    break;
            }
        }
    }

    T output(int index) const { return slots_[static_cast<std::size_t>(program_->output(index))]; }
    /// The sum of the sizes of the terms that make up an output: its rounding is epsilon times this, or a little more.
    T magnitude(int index) const {
        using std::abs;
        const int slot = program_->output(index);
        for (const Instruction& i : program_->instructions()) {
            if (i.out != slot || i.code != Code::combine) continue;
            T sum = i.weight >= 0 ? abs(scalars_[static_cast<std::size_t>(i.weight)]) : T(0);
            for (int k = 0; k < i.terms; ++k) {
                const Term& t = program_->terms(i)[k];
                sum += abs(scalars_[static_cast<std::size_t>(t.weight)] * slots_[static_cast<std::size_t>(t.slot)]);
            }
            for (int k = 0; k < i.products; ++k) {
                const ProductTerm& t = program_->products(i)[k];
                sum += abs(scalars_[static_cast<std::size_t>(t.weight)] * slots_[static_cast<std::size_t>(t.a)] *
                           slots_[static_cast<std::size_t>(t.b)]);
            }
            return sum;
        }
        return abs(output(index));
    }
    T switch_value(int index) const { return slots_[static_cast<std::size_t>(program_->switch_output(index))]; }
    /// What an instruction read or wrote.
    T slot(int index) const { return slots_[static_cast<std::size_t>(index)]; }

protected:
    /// A function of the user's, in doubles whatever T is.
    void call(const Program::Call& call) {
        arguments_.resize(call.arguments.size());
        results_.resize(call.results.size());
        for (std::size_t i = 0; i < call.arguments.size(); ++i)
            arguments_[i] = static_cast<double>(slots_[static_cast<std::size_t>(call.arguments[i])]);
        (*call.function)(arguments_.data(), results_.data());
        for (std::size_t i = 0; i < call.results.size(); ++i)
            slots_[static_cast<std::size_t>(call.results[i])] = T(results_[i]);
    }

    const Program* program_;
    std::vector<T> slots_;
    std::vector<T> scalars_;
    std::vector<double> arguments_, results_;  // of a call
};

/// Derivatives of the outputs with respect to the state, by forward propagation of all directions at once.
class JacobianEvaluator : public Evaluator<double> {
public:
    /// `with_time`: time is one more variable, the last.
    explicit JacobianEvaluator(const Program& program, bool with_time = false)
        : Evaluator<double>(program),
          n_(program.inputs() + (with_time ? 1 : 0)),
          tangents_(static_cast<std::size_t>(program.slots() * n_), 0.0) {
        for (int i = 0; i < program.inputs(); ++i) at(i)[i] = 1.0;
        if (with_time) at(program.time_slot())[program.inputs()] = 1.0;
    }

    /// Values and derivatives at (t, x).
    void differentiate(double t, std::span<const double> x) {
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
                case Code::power: {
                    const double base = i.is_locked ? std::abs(s[i.a]) : s[i.a];
                    chain(out, i.value * std::pow(base, i.value - 1.0), at(i.a));
                    break;
                }
            }
        }
    }

    /// d output / d x[variable]
    double derivative(int output, int variable) const {
        return tangents_[static_cast<std::size_t>(program_->output(output) * n_ + variable)];
    }

private:
    /// Of an opaque function there are differences only: one more call for each argument that varies.
    void differences(const Program::Call& c) {
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
            for (std::size_t i = 0; i < y.size(); ++i)
                add(at(c.results[i]), (moved[i] - y[i]) / (x[k] - kept), direction);
            x[k] = kept;
        }
    }
    double* at(int slot) { return tangents_.data() + static_cast<std::ptrdiff_t>(slot) * n_; }
    void add(double* out, double factor, const double* direction) const {
        for (int d = 0; d < n_; ++d) out[d] += factor * direction[d];
    }
    void chain(double* out, double fa, const double* a, double fb = 0.0, const double* b = nullptr) const {
        for (int d = 0; d < n_; ++d) out[d] = fa * a[d] + (b != nullptr ? fb * b[d] : 0.0);
    }

    int n_;
    std::vector<double> tangents_;
};

}  // namespace rbdyn
