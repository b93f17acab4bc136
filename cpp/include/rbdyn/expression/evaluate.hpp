// Runs a program in plain numbers: values in any floating type, and the exact Jacobian in doubles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/program_weights.hpp"
#include "rbdyn/expression/value_code.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Of a vector; its squares may leave the numbers where it does not.
template <class T>
T length_of(const T& x, const T& y, const T& z) {
    using std::abs, std::sqrt;
    const T square = x * x + y * y + z * z;
    if (square > T(0x1p-960) && square < T(0x1p1000)) return sqrt(square);
    const T most = std::max({abs(x), abs(y), abs(z)});
    if (!(most > T(0.0)) || !(most < T(std::numeric_limits<double>::max()))) return sqrt(square);
    const T a = x / most, b = y / most, c = z / most;
    return most * sqrt(a * a + b * b + c * c);
}

/// What an instruction that is no combination and no call makes of its slots.
template <class T>
inline void compute(Code code, const Instruction& i, T* s) {
    using std::atan2, std::cos, std::cosh, std::exp, std::expm1, std::log, std::pow, std::sin, std::sinh, std::sqrt,
        std::tanh;
    switch (code) {
        case Code::divide: s[i.out] = s[i.a] / s[i.b]; break;
        case Code::square_root: s[i.out] = sqrt(s[i.a]); break;
        case Code::norm: s[i.out] = length_of(s[i.a], s[i.b], s[i.c]); break;
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
        case Code::exponential: s[i.out] = i.b >= 0 ? pow(s[i.b], s[i.c]) : exp(s[i.a]); break;
        case Code::logarithm: s[i.out] = log(s[i.a]); break;
        case Code::expm1: s[i.out] = expm1(s[i.a]); break;
        case Code::log1p:
        case Code::arsinh:
        case Code::artanh: s[i.out] = inverse(code, s[i.a]); break;
        case Code::power: s[i.out] = i.is_locked ? locked_power(s[i.a], T(i.value)) : pow(s[i.a], T(i.value)); break;
        case Code::combine:
        case Code::call: break;
    }
}

/// The same for machine code (value_code.hpp): by the same functions of the C library, and so the same bits.
template <Code code>
void compute_by(const Instruction& i, double* slots) {
    compute(code, i, slots);
}

/// Evaluates a program at a point, in numbers of type T. Keeps its slots, so that a call allocates nothing.
template <class T>
class Evaluator {
public:
    explicit Evaluator(const Program& program)
        : Evaluator(program, std::vector<T>(static_cast<std::size_t>(program.parameters()), T(0))) {}
    Evaluator(const Program& program, std::span<const T> parameters)
        : program_(&program), slots_(static_cast<std::size_t>(program.slots())) {
        set_parameters(parameters);
        if constexpr (std::is_same_v<T, double>) {
            code_ = program.kept_code().get();
            if (code_ != nullptr) rates_.resize(ValueCode::padded(static_cast<std::size_t>(program.inputs())));
        }
    }

    void set_parameters(std::span<const T> parameters, Program::Rounding rounding = Program::Rounding::nearest) {
        program_->set_parameters(parameters, scalars_, rounding);
    }

    void operator()(T t, std::span<const T> x) {
        if (!by_code(t, x, nullptr)) by_lists(t, x);
    }
    /// And the first outputs, of a program with as many of them as inputs, or more; then zeros up to
    /// ValueCode::padded().
    void rates(T t, std::span<const T> x, T* out) {
        if (by_code(t, x, out)) return;
        by_lists(t, x);
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = output(static_cast<int>(i));
        for (std::size_t i = x.size(); i < ValueCode::padded(x.size()); ++i) out[i] = T(0);
    }
    /// From now on by machine code (value_code.hpp) at once, or not at all; else from when it pays. The same bits.
    void use_machine_code(bool is_used) {
        code_ = is_used ? program_->kept_code().after(*program_, ValueCode::evaluations) : nullptr;
        until_asked_ = std::numeric_limits<int>::max();
        rates_.resize(ValueCode::padded(static_cast<std::size_t>(program_->inputs())));
    }
    bool has_machine_code() const { return code_ != nullptr; }

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
    void by_lists(T t, std::span<const T> x) {
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
                case Code::call: call(program_->calls()[static_cast<std::size_t>(i.extra)]); break;
                default: compute(i.code, i, s);
            }
        }
    }

    /// Whether there is code, which has then computed all.
    bool by_code(T t, std::span<const T> x, T* rates) {
        if constexpr (std::is_same_v<T, double>) {
            if (x.size() != static_cast<std::size_t>(program_->inputs())) return false;
            if (code_ == nullptr) {
                if (--until_asked_ > 0) return false;
                until_asked_ = ask_after;
                code_ = program_->kept_code().after(*program_, ask_after);
                if (code_ == nullptr) return false;
                rates_.resize(ValueCode::padded(x.size()));
            }
            code_->run(program_->instructions().data(), scalars_.data(), t, x.data(), slots_.data(),
                       rates != nullptr ? rates : rates_.data());
            return true;
        }
        return false;
    }

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

private:
    // evaluations that are counted together, for programs count those of all evaluators
    static constexpr int ask_after = 64;

    const ValueCode* code_ = nullptr;  // the program's
    int until_asked_ = ask_after;
    std::vector<T> rates_;  // that nobody asked for
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
