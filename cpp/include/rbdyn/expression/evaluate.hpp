// Runs a program in plain numbers: values in any floating type, and the exact Jacobian in doubles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/program_weights.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Evaluates a program at a point, in numbers of type T. Keeps its slots, so that a call allocates nothing.
template <class T>
class Evaluator {
public:
    explicit Evaluator(const Program& program)
        : Evaluator(program, std::vector<T>(static_cast<std::size_t>(program.parameters()), T(0))) {}
    Evaluator(const Program& program, std::span<const T> parameters)
        : program_(&program), slots_(static_cast<std::size_t>(program.slots())) {
        set_parameters(parameters);
    }

    void set_parameters(std::span<const T> parameters, Program::Rounding rounding = Program::Rounding::nearest) {
        program_->set_parameters(parameters, scalars_, rounding);
    }

    void operator()(T t, std::span<const T> x) {
        using std::atan2, std::cos, std::cosh, std::exp, std::expm1, std::log, std::pow, std::sin, std::sinh, std::sqrt,
            std::tanh;
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
                case Code::norm: s[i.out] = length(s[i.a], s[i.b], s[i.c]); break;
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
                case Code::exponential: s[i.out] = i.b >= 0 ? pow(s[i.b], s[i.c]) : exp(s[i.a]); break;
                case Code::logarithm: s[i.out] = log(s[i.a]); break;
                case Code::expm1: s[i.out] = expm1(s[i.a]); break;
                case Code::log1p:
                case Code::arsinh:
                case Code::artanh: s[i.out] = inverse(i.code, s[i.a]); break;
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
        const Instruction* i = program_->maker(program_->output(index));
        return i != nullptr && i->code == Code::combine ? magnitude(*i) : abs(output(index));
    }
    T switch_value(int index) const { return slots_[static_cast<std::size_t>(program_->switch_output(index))]; }
    /// What an instruction read or wrote.
    T slot(int index) const { return slots_[static_cast<std::size_t>(index)]; }

protected:
    /// The same of what a combination makes.
    T magnitude(const Instruction& i) const {
        using std::abs;
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

    static T length(const T& x, const T& y, const T& z) {
        using std::abs, std::sqrt;
        const T square = x * x + y * y + z * z;
        // squares may leave the numbers where lengths do not
        if (square > T(0x1p-960) && square < T(0x1p1000)) return sqrt(square);
        const T most = std::max({abs(x), abs(y), abs(z)});
        if (!(most > T(0.0)) || !(most < T(std::numeric_limits<double>::max()))) return sqrt(square);
        const T a = x / most, b = y / most, c = z / most;
        return most * sqrt(a * a + b * b + c * c);
    }

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
    explicit JacobianEvaluator(const Program& program, bool with_time = false);

    /// Values and derivatives at (t, x).
    void differentiate(double t, std::span<const double> x);

    /// d output / d x[variable]
    double derivative(int output, int variable) const;

private:
    /// Of an opaque function there are differences only: one more call for each argument that varies.
    void differences(const Program::Call& c);
    double* at(int slot) { return tangents_.data() + static_cast<std::ptrdiff_t>(slot) * n_; }
    void add(double* out, double factor, const double* direction) const;
    void chain(double* out, double fa, const double* a, double fb = 0.0, const double* b = nullptr) const;

    int n_;
    std::vector<double> tangents_;
};

}  // namespace rbdyn::inline RBDYN_FORM
