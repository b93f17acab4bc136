// A recorded function as a list of native instructions: plain data, immutable, shared between runs.
//
// Linear parts are gathered: one `combine` instruction is a weighted sum of slots and of products of slots, with
// weights that depend on parameters alone and are computed once when the parameters are set, not once an evaluation.
// Slots hold numbers when the program is run in doubles, whole series when it is run in Taylor coefficients.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/kept_series.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/value_code.hpp"

namespace rbdyn::inline RBDYN_FORM {

enum class Code : std::uint8_t {
    combine,
    divide,
    square_root,
    norm,
    sine_cosine,
    hyperbolic,   // sinh and cosh
    tangent,      // tanh
    exponential,  // of a; its value is b ^ c, if there are such
    logarithm,
    expm1,  // out2: exp
    log1p,  // out2 of this one and the next two: what the slope of a is divided by
    arsinh,
    artanh,
    power,
    angle,
    call
};

/// Of log1p, arsinh and artanh: the value.
template <class T>
T inverse(Code code, const T& a) {
    using std::asinh, std::atanh, std::log1p;
    return code == Code::log1p ? log1p(a) : code == Code::arsinh ? asinh(a) : atanh(a);
}

/// What a slope is divided by to be theirs.
template <class T>
T inverse_divisor(Code code, const T& a) {
    using std::abs, std::sqrt;
    if (code == Code::log1p) return T(1.0) + a;
    if (code == Code::artanh) return (T(1.0) - a) * (T(1.0) + a);
    // where a square would leave the numbers one more is nothing to it
    return abs(a) > T(0x1p500) ? abs(a) : sqrt(T(1.0) + a * a);
}

/// weight * slot
struct Term {
    int slot, weight;
};
/// weight * a * b
struct ProductTerm {
    int a, b, weight;
};

struct Instruction {
    Code code;
    int out = -1, out2 = -1;        // slots written (out2: cosine; 1 - tanh^2)
    int a = -1, b = -1, c = -1;     // operand slots
    int first_term = 0, terms = 0;  // combine
    int first_product = 0, products = 0;
    int weight = -1;         // combine: constant part; norm: its "starts at zero" flag; -1: none
    int extra = -1;          // scratch slot (slopes), index of the instruction's integer state, or of its call
    double value = 0.0;      // exponent of power
    bool is_locked = false;  // power: of what is not negative in its mode (locked_power)
};

/// A function of (t, x, parameters) with several outputs.
class Program {
public:
    Program() = default;
    /// Compiles `outputs`, recorded with `recorder`, of `inputs` state variables; switches become further outputs.
    Program(Recorder& recorder, std::span<const Expression> outputs, int inputs);

    int inputs() const { return inputs_; }
    int outputs() const { return outputs_; }  // without those of the switches
    int parameters() const { return parameters_; }
    /// Takes as many, those that only other programs of its recording use among them.
    void take_parameters(int count) { parameters_ = count; }
    int slots() const { return slots_; }
    int scalars() const { return static_cast<int>(constants_.size()); }
    int states() const { return states_; }  // integers an evaluation keeps (valuations of norms)
    bool uses_time() const { return uses_time_; }
    int time_slot() const { return inputs_; }
    /// Whether a slot is a function of time alone.
    bool is_of_time(int slot) const { return uses_time_ && of_time_[static_cast<std::size_t>(slot)]; }
    int output(int index) const { return output_slots_[static_cast<std::size_t>(index)]; }
    const std::vector<Switch>& switches() const { return switches_; }
    int switch_output(int index) const { return output(outputs_ + index); }
    /// The norm that an output, also of a switch, is; none if it is something else.
    const Instruction* norm(int index) const;
    const std::vector<Instruction>& instructions() const { return instructions_; }
    /// The one whose first result a slot is; none of inputs and time.
    const Instruction* maker(int slot) const {
        const int index = maker_[static_cast<std::size_t>(slot)];
        return index < 0 ? nullptr : &instructions_[static_cast<std::size_t>(index)];
    }
    const Term* terms(const Instruction& i) const { return terms_.data() + i.first_term; }
    const ProductTerm* products(const Instruction& i) const { return products_.data() + i.first_product; }

    /// A function that is called back: where its arguments are and where its results go.
    struct Call {
        std::shared_ptr<const Callback> function;
        std::vector<int> arguments, results;
    };
    const std::vector<Call>& calls() const { return calls_; }
    /// Whether part of it is opaque: there are values, but no series and no exact derivatives.
    bool has_calls() const { return !calls_.empty(); }

    /// How constants of 32 digits become numbers of the machine: the nearest one, or the one on the other side.
    enum class Rounding { nearest, other };
    /// The weights for given parameters, in the number type of the evaluation. `parameters`: their values, then what
    /// these are short of 32 digits, if anything.
    template <class T>
    void set_parameters(std::span<const T> parameters, std::vector<T>& scalars,
                        Rounding rounding = Rounding::nearest) const;

    /// The weights with all their digits; none if they depend on parameters.
    const std::vector<DoubleDouble>* exact_weights() const { return scalar_steps_.empty() ? &constants_ : nullptr; }

    /// A weight that no parameter changes, however it is rounded; NaN of others.
    double constant(int scalar) const;

    /// What runs it in series, free to be borrowed.
    const KeptSeries& kept_series() const { return kept_series_; }
    /// What computes its values where they are asked for often.
    const KeptValueCode& kept_code() const { return kept_code_; }

    /// The program's instructions, one a line.
    std::string text() const;

private:
    struct ScalarStep {
        Operation operation;
        int out, a, b, c;
        double value;
    };
    friend class Lowering;

    int inputs_ = 0, outputs_ = 0, parameters_ = 0, slots_ = 0, states_ = 0;
    bool uses_time_ = false;
    std::vector<Instruction> instructions_;
    std::vector<int> maker_;     // by slot
    std::vector<bool> of_time_;  // by slot; none where no time is used
    std::vector<Term> terms_;
    std::vector<ProductTerm> products_;
    std::vector<int> output_slots_;
    std::vector<Switch> switches_;
    std::vector<Call> calls_;
    std::vector<DoubleDouble> constants_;  // initial contents of the scalars
    std::vector<ScalarStep> scalar_steps_;
    KeptSeries kept_series_;
    KeptValueCode kept_code_;
};

/// Turns a recorded graph into a Program. One use, one object.
class Lowering {
public:
    Lowering(Recorder& recorder, Program& program, int inputs);

    void run(std::span<const Expression> outputs);

private:
    struct Combination {
        Expression constant = 0.0;
        std::map<int, Expression> terms;                     // slot -> weight
        std::map<std::pair<int, int>, Expression> products;  // slots -> weight
    };

    /// What is known of nodes: a number that is not negative, or -1.
    class ByNode {
    public:
        int operator[](std::int32_t n) const;
        int set(std::int32_t n, int value);

    private:
        std::vector<int> known_;
    };

    bool parametric(std::int32_t n);

    bool parameter_used(int index) const;

    /// A multiple of another node by a parametric factor.
    bool scaled(std::int32_t n);

    /// Counts the uses of every node that the outputs reach; multiples count as uses of what they multiply.
    void mark(const std::vector<Expression>& outputs);

    int uses(std::int32_t n) const;

    /// Tells which slots are functions of time alone.
    void mark_times();

    int new_slot() { return p_.slots_++; }

    /// The slot that holds a node's value, computed if it is not yet.
    int slot_of(std::int32_t n);

    /// Computes what a node needs, however deep it lies: the call stack is only so large.
    void make_operands(std::int32_t n);

    /// The nodes whose slots a node's own instruction needs, those of variables and time left out.
    std::vector<std::int32_t> needed(std::int32_t n);

    int append(const Instruction& i);
    int append_power(int base, double exponent, bool is_locked);

    int append(const Combination& sum);

    Combination combination(std::int32_t n);

    /// Strips parametric factors: n = weight * base.
    std::int32_t base_of(std::int32_t n, Expression& weight);

    Expression value_of(std::int32_t n);

    /// Calls part(of, weight) for each term of a sum that is one instruction, in order: weight times a parametric node,
    /// or another one, or the product of two (else the second is -1).
    template <class F>
    void each_part(std::int32_t root, const F& part);

    /// The scalar that holds a parametric expression.
    int scalar_of(const Expression& x);

    Recorder& r_;
    Program& p_;
    std::vector<int> uses_;
    std::vector<bool> parameter_used_;
    std::vector<bool> parametric_;
    ByNode slots_, scalars_;
    static constexpr int deepest = 200;  // calls of slot_of within each other
    int depth_ = 0;
};

}  // namespace rbdyn::inline RBDYN_FORM
