// A recorded function as a list of native instructions: plain data, immutable, shared between runs.
//
// Linear parts are gathered: one `combine` instruction is a weighted sum of slots and of products of slots, with
// weights that depend on parameters alone and are computed once when the parameters are set, not once an evaluation.
// Slots hold numbers when the program is run in doubles, whole series when it is run in Taylor coefficients.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "rbdyn/expression/elementary.hpp"

namespace rbdyn {

enum class Code : std::uint8_t {
    combine,
    divide,
    square_root,
    norm,
    sine_cosine,
    hyperbolic,  // sinh and cosh
    tangent,     // tanh
    exponential,
    logarithm,
    power,
    angle,
    call
};

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
    int slots() const { return slots_; }
    int scalars() const { return static_cast<int>(constants_.size()); }
    int states() const { return states_; }  // integers an evaluation keeps (valuations of norms)
    bool uses_time() const { return uses_time_; }
    int time_slot() const { return inputs_; }
    int output(int index) const { return output_slots_[static_cast<std::size_t>(index)]; }
    const std::vector<Switch>& switches() const { return switches_; }
    int switch_output(int index) const { return output(outputs_ + index); }
    /// The norm that an output, also of a switch, is; none if it is something else.
    const Instruction* norm(int index) const {
        for (const Instruction& i : instructions_)
            if (i.code == Code::norm && i.out == output(index)) return &i;
        return nullptr;
    }
    const std::vector<Instruction>& instructions() const { return instructions_; }
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
    std::vector<Term> terms_;
    std::vector<ProductTerm> products_;
    std::vector<int> output_slots_;
    std::vector<Switch> switches_;
    std::vector<Call> calls_;
    std::vector<DoubleDouble> constants_;  // initial contents of the scalars
    std::vector<ScalarStep> scalar_steps_;
};

/// Turns a recorded graph into a Program. One use, one object.
class Lowering {
public:
    Lowering(Recorder& recorder, Program& program, int inputs) : r_(recorder), p_(program) {
        p_.inputs_ = inputs;
        p_.slots_ = inputs + 1;  // the last of them is time
    }

    void run(std::span<const Expression> outputs) {
        std::vector<Expression> all(outputs.begin(), outputs.end());
        p_.outputs_ = static_cast<int>(all.size());
        mark(all);
        // switches of functions that are not used by any output are not guarded
        for (const Switch& s : r_.switches())
            if (uses_[static_cast<std::size_t>(s.argument)] > 0 || parameter_used(s.parameter)) {
                p_.switches_.push_back(s);
                all.push_back({&r_, s.argument});
            }
        mark(all);
        for (const Expression& out : all) p_.output_slots_.push_back(slot_of(r_.node_of(out)));
        p_.parameters_ = r_.parameters();
    }

private:
    struct Combination {
        Expression constant = 0.0;
        std::map<int, Expression> terms;                     // slot -> weight
        std::map<std::pair<int, int>, Expression> products;  // slots -> weight
    };

    /// What is known of nodes: a number that is not negative, or -1.
    class ByNode {
    public:
        int operator[](std::int32_t n) const {
            return static_cast<std::size_t>(n) < known_.size() ? known_[static_cast<std::size_t>(n)] : -1;
        }
        int set(std::int32_t n, int value) {
            if (static_cast<std::size_t>(n) >= known_.size()) known_.resize(2 * static_cast<std::size_t>(n) + 16, -1);
            return known_[static_cast<std::size_t>(n)] = value;
        }

    private:
        std::vector<int> known_;
    };

    bool parametric(std::int32_t n) {
        const Node& node = r_.node(n);
        switch (node.operation) {
            case Operation::constant:
            case Operation::parameter: return true;
            case Operation::input:
            case Operation::time:
            case Operation::call: return false;
            default: break;
        }
        if (const int known = parametric_[n]; known >= 0) return known == 1;
        const bool result =
            parametric(node.a) && (node.b < 0 || parametric(node.b)) && (node.c < 0 || parametric(node.c));
        return parametric_.set(n, result ? 1 : 0) == 1;
    }

    bool parameter_used(int index) const {
        return index < static_cast<int>(parameter_used_.size()) && parameter_used_[static_cast<std::size_t>(index)];
    }

    /// A multiple of another node by a parametric factor.
    bool scaled(std::int32_t n) {
        const Node& node = r_.node(n);
        return node.operation == Operation::multiply && !parametric(n) && (parametric(node.a) || parametric(node.b));
    }

    /// Counts the uses of every node that the outputs reach; multiples count as uses of what they multiply.
    void mark(const std::vector<Expression>& outputs) {
        for (const Expression& out : outputs) r_.node_of(out);  // constants become nodes
        uses_.assign(static_cast<std::size_t>(r_.size()), 0);
        parameter_used_.assign(static_cast<std::size_t>(r_.parameters()), false);
        for (const Expression& out : outputs) uses_[static_cast<std::size_t>(r_.node_of(out))]++;
        for (auto n = static_cast<std::int32_t>(uses_.size()) - 1; n >= 0; --n) {
            const int count = uses_[static_cast<std::size_t>(n)];
            if (count == 0) continue;
            const Node& node = r_.node(n);
            if (node.operation == Operation::parameter) parameter_used_[static_cast<std::size_t>(node.a)] = true;
            if (node.operation == Operation::call)
                for (const std::int32_t argument : r_.calls()[static_cast<std::size_t>(node.a)].arguments)
                    uses_[static_cast<std::size_t>(argument)]++;
            const bool is_multiple = scaled(n);
            for (std::int32_t operand : node.operands())
                if (operand >= 0)
                    uses_[static_cast<std::size_t>(operand)] += is_multiple && !parametric(operand) ? count : 1;
        }
    }

    int uses(std::int32_t n) const {
        return n < static_cast<std::int32_t>(uses_.size()) ? uses_[static_cast<std::size_t>(n)] : 1;
    }

    int new_slot() { return p_.slots_++; }

    /// The slot that holds a node's value, computed if it is not yet.
    int slot_of(std::int32_t n) {
        const Node node = r_.node(n);
        if (node.operation == Operation::input) return node.a;
        if (node.operation == Operation::time) {
            p_.uses_time_ = true;
            return p_.inputs_;
        }
        if (slots_[n] >= 0) return slots_[n];
        int slot = -1;
        switch (parametric(n) ? Operation::constant : node.operation) {
            case Operation::constant:
            case Operation::parameter:
            case Operation::add:
            case Operation::multiply: slot = emit(combination(n)); break;
            case Operation::divide:
                slot = emit({Code::divide, new_slot(), -1, slot_of(node.a), slot_of(node.b)});
                break;
            case Operation::square_root:
                if (!r_.is_locked_positive(node.a)) {
                    slot = emit({Code::square_root, new_slot(), -1, slot_of(node.a)});
                    break;
                }
                slot = emit_power(slot_of(node.a), 0.5, true);
                break;
            case Operation::norm: {
                Instruction i{Code::norm, new_slot(), -1, slot_of(node.a), slot_of(node.b), slot_of(node.c)};
                i.weight = scalar_of(r_.parameter(node.d));
                i.extra = p_.states_++;
                slot = emit(i);
                break;
            }
            case Operation::sine:
            case Operation::cosine: {
                Instruction i{Code::sine_cosine, new_slot(), new_slot(), slot_of(node.a)};
                i.extra = new_slot();
                emit(i);
                slots_.set(r_.record(Operation::sine, node.a).node(), i.out);
                slots_.set(r_.record(Operation::cosine, node.a).node(), i.out2);
                slot = node.operation == Operation::sine ? i.out : i.out2;
                break;
            }
            case Operation::hyperbolic_sine:
            case Operation::hyperbolic_cosine: {
                Instruction i{Code::hyperbolic, new_slot(), new_slot(), slot_of(node.a)};
                i.extra = new_slot();
                emit(i);
                slots_.set(r_.record(Operation::hyperbolic_sine, node.a).node(), i.out);
                slots_.set(r_.record(Operation::hyperbolic_cosine, node.a).node(), i.out2);
                slot = node.operation == Operation::hyperbolic_sine ? i.out : i.out2;
                break;
            }
            case Operation::hyperbolic_tangent: {
                Instruction i{Code::tangent, new_slot(), new_slot(), slot_of(node.a)};
                i.extra = new_slot();
                slot = emit(i);
                break;
            }
            case Operation::angle: {
                // the square of the distance from the origin is its derivative's denominator
                const Expression y(&r_, node.a), x(&r_, node.b);
                const std::int32_t square = r_.node_of(x * x + y * y);
                Instruction i{Code::angle, new_slot(), -1, slot_of(node.a), slot_of(node.b), slot_of(square)};
                i.extra = new_slot();
                slot = emit(i);
                break;
            }
            case Operation::call: {
                const Recorder::Call& recorded = r_.calls()[static_cast<std::size_t>(node.a)];
                Program::Call call{recorded.function, {}, {}};
                for (const std::int32_t argument : recorded.arguments) call.arguments.push_back(slot_of(argument));
                for (int i = 0; i < call.function->outputs; ++i) {
                    call.results.push_back(new_slot());
                    slots_.set(r_.record({Operation::call, node.a, -1, -1, i}).node(), call.results.back());
                }
                slot = call.results[static_cast<std::size_t>(node.d)];
                Instruction i{Code::call, slot};
                i.extra = static_cast<int>(p_.calls_.size());
                p_.calls_.push_back(std::move(call));
                emit(i);
                break;
            }
            case Operation::exponential:
            case Operation::logarithm: {
                Instruction i{node.operation == Operation::exponential ? Code::exponential : Code::logarithm,
                              new_slot(), -1, slot_of(node.a)};
                i.extra = new_slot();
                slot = emit(i);
                break;
            }
            case Operation::power:
                slot = emit_power(slot_of(node.a), node.value, node.value > 0.0 && r_.is_locked_positive(node.a));
                break;
            default: break;
        }
        return slots_.set(n, slot);
    }

    int emit(const Instruction& i) {
        p_.instructions_.push_back(i);
        return i.out;
    }
    int emit_power(int base, double exponent, bool is_locked) {
        Instruction i{Code::power, new_slot(), -1, base};
        i.extra = new_slot();
        i.value = exponent;
        i.is_locked = is_locked;
        return emit(i);
    }

    int emit(const Combination& sum) {
        if (sum.products.empty() && sum.constant.is_zero() && sum.terms.size() == 1) {
            const auto& [slot, weight] = *sum.terms.begin();
            if (weight.is_one()) return slot;
        }
        Instruction i{Code::combine};
        i.first_term = static_cast<int>(p_.terms_.size());
        i.first_product = static_cast<int>(p_.products_.size());
        for (const auto& [slot, weight] : sum.terms)
            if (!weight.is_zero()) p_.terms_.push_back({slot, scalar_of(weight)});
        for (const auto& [pair, weight] : sum.products)
            if (!weight.is_zero()) p_.products_.push_back({pair.first, pair.second, scalar_of(weight)});
        i.terms = static_cast<int>(p_.terms_.size()) - i.first_term;
        i.products = static_cast<int>(p_.products_.size()) - i.first_product;
        if (!sum.constant.is_zero()) i.weight = scalar_of(sum.constant);
        i.out = new_slot();
        return emit(i);
    }

    Combination combination(std::int32_t n) {
        Combination sum;
        gather(n, 1.0, sum, true);
        return sum;
    }

    /// Strips parametric factors: n = weight * base.
    std::int32_t base_of(std::int32_t n, Expression& weight) {
        while (scaled(n)) {
            const Node node = r_.node(n);
            const bool first = parametric(node.a);
            weight = weight * value_of(first ? node.a : node.b);
            n = first ? node.b : node.a;
        }
        return n;
    }

    Expression value_of(std::int32_t n) {
        const Node& node = r_.node(n);
        return node.operation == Operation::constant ? node.constant() : Expression(&r_, n);
    }

    void gather(std::int32_t n, Expression weight, Combination& sum, bool is_root) {
        if (parametric(n)) {
            sum.constant = sum.constant + weight * value_of(n);
            return;
        }
        const std::int32_t base = base_of(n, weight);
        const Node node = r_.node(base);
        const bool inlined = (is_root && base == n) || uses(base) <= 1;
        if (inlined && node.operation == Operation::add) {
            gather(node.a, weight, sum, false);
            gather(node.b, weight, sum, false);
        } else if (inlined && node.operation == Operation::multiply) {
            const std::int32_t a = base_of(node.a, weight), b = base_of(node.b, weight);
            const int i = slot_of(a), j = slot_of(b);
            Expression& w = sum.products[{std::min(i, j), std::max(i, j)}];
            w = w + weight;
        } else {
            Expression& w = sum.terms[slot_of(base)];
            w = w + weight;
        }
    }

    /// The scalar that holds a parametric expression.
    int scalar_of(const Expression& x) {
        const std::int32_t n = r_.node_of(x);
        if (scalars_[n] >= 0) return scalars_[n];
        const Node node = r_.node(n);
        const int out = static_cast<int>(p_.constants_.size());
        p_.constants_.push_back({node.value, node.rest});
        scalars_.set(n, out);
        if (node.operation == Operation::parameter) {
            p_.scalar_steps_.push_back({node.operation, out, node.a, -1, -1, 0.0});
        } else if (node.operation != Operation::constant) {
            const int a = scalar_of({&r_, node.a});
            const int b = node.b >= 0 ? scalar_of({&r_, node.b}) : -1;
            const int c = node.c >= 0 ? scalar_of({&r_, node.c}) : -1;
            p_.scalar_steps_.push_back({node.operation, out, a, b, c, node.value});
        }
        return out;
    }

    Recorder& r_;
    Program& p_;
    std::vector<int> uses_;
    std::vector<bool> parameter_used_;
    ByNode parametric_, slots_, scalars_;
};

inline Program::Program(Recorder& recorder, std::span<const Expression> outputs, int inputs) {
    Lowering(recorder, *this, inputs).run(outputs);
}

template <class T>
void Program::set_parameters(std::span<const T> parameters, std::vector<T>& scalars, Rounding rounding) const {
    using std::atan2, std::cos, std::cosh, std::exp, std::log, std::pow, std::sin, std::sinh, std::sqrt, std::tanh;
    scalars.clear();
    const auto rounded = [rounding](T hi, T lo) {
        const T nearest = hi + lo, rest = lo - (nearest - hi);
        if (rounding == Rounding::nearest || rest == T(0)) return nearest;
        const T beyond = std::numeric_limits<T>::infinity();
        return std::nextafter(nearest, rest > T(0) ? beyond : -beyond);
    };
    for (const DoubleDouble& c : constants_) scalars.push_back(rounded(static_cast<T>(c.hi), static_cast<T>(c.lo)));
    const auto count = static_cast<std::size_t>(parameters_);
    for (const ScalarStep& s : scalar_steps_) {
        T& out = scalars[static_cast<std::size_t>(s.out)];
        if (s.operation == Operation::parameter) {
            const auto index = static_cast<std::size_t>(s.a);
            out = parameters.size() > count ? rounded(parameters[index], parameters[count + index]) : parameters[index];
            continue;
        }
        const T a = scalars[static_cast<std::size_t>(s.a)];
        const T b = s.b >= 0 ? scalars[static_cast<std::size_t>(s.b)] : T(0);
        switch (s.operation) {
            case Operation::add: out = a + b; break;
            case Operation::multiply: out = a * b; break;
            case Operation::divide: out = a / b; break;
            case Operation::square_root: out = sqrt(a); break;
            case Operation::norm: {
                const T c = scalars[static_cast<std::size_t>(s.c)];
                out = sqrt(a * a + b * b + c * c);
                break;
            }
            case Operation::sine: out = sin(a); break;
            case Operation::cosine: out = cos(a); break;
            case Operation::hyperbolic_sine: out = sinh(a); break;
            case Operation::hyperbolic_cosine: out = cosh(a); break;
            case Operation::hyperbolic_tangent: out = tanh(a); break;
            case Operation::angle: out = atan2(a, b); break;
            case Operation::exponential: out = exp(a); break;
            case Operation::logarithm: out = log(a); break;
            case Operation::power: out = pow(a, T(s.value)); break;
            default: break;
        }
    }
}

inline std::string Program::text() const {
    static const char* names[] = {"combine", "divide", "sqrt", "norm", "sincos", "sinhcosh",
                                  "tanh",    "exp",    "log",  "pow",  "angle",  "call"};
    std::ostringstream out;
    out << inputs_ << " state variables, " << parameters_ << " parameters, " << slots_ << " slots\n";
    for (const Instruction& i : instructions_) {
        out << "  s" << i.out << (i.out2 >= 0 ? ", s" + std::to_string(i.out2) : std::string()) << " = "
            << names[static_cast<int>(i.code)];
        for (int slot : {i.a, i.b, i.c})
            if (slot >= 0) out << " s" << slot;
        if (i.code == Code::power) out << " ^ " << i.value;
        if (i.code == Code::call) {
            out << " back " << calls_[static_cast<std::size_t>(i.extra)].function->name << " with";
            for (const int slot : calls_[static_cast<std::size_t>(i.extra)].arguments) out << " s" << slot;
        }
        if (i.code == Code::combine) {
            if (i.weight >= 0) out << " w" << i.weight;
            for (int k = 0; k < i.terms; ++k) out << " + w" << terms(i)[k].weight << " s" << terms(i)[k].slot;
            for (int k = 0; k < i.products; ++k)
                out << " + w" << products(i)[k].weight << " s" << products(i)[k].a << " s" << products(i)[k].b;
        }
        out << '\n';
    }
    for (std::size_t k = 0; k < output_slots_.size(); ++k)
        out << (static_cast<int>(k) < outputs_ ? "  output " : "  switch ") << k << " = s" << output_slots_[k] << '\n';
    return out.str();
}

}  // namespace rbdyn
