// Definitions of rbdyn/expression/program.hpp.
#pragma once

#include "rbdyn/expression/program.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/operands.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE const Instruction* Program::norm(int index) const {
    const Instruction* i = maker(output(index));
    return i != nullptr && i->code == Code::norm ? i : nullptr;
}

RBDYN_INLINE double Program::constant(int scalar) const {
    const DoubleDouble& c = constants_[static_cast<std::size_t>(scalar)];
    const bool is_fixed =
        c.lo == 0.0 && std::ranges::none_of(scalar_steps_, [&](const ScalarStep& s) { return s.out == scalar; });
    return is_fixed ? c.hi : std::numeric_limits<double>::quiet_NaN();
}

RBDYN_INLINE Lowering::Lowering(Recorder& recorder, Program& program, int inputs) : r_(recorder), p_(program) {
    p_.inputs_ = inputs;
    p_.slots_ = inputs + 1;  // the last of them is time
}

RBDYN_INLINE void Lowering::run(std::span<const Expression> outputs) {
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
    p_.maker_.assign(static_cast<std::size_t>(p_.slots_), -1);
    for (std::size_t k = 0; k < p_.instructions_.size(); ++k)
        p_.maker_[static_cast<std::size_t>(p_.instructions_[k].out)] = static_cast<int>(k);
    if (p_.uses_time_) mark_times();
}

RBDYN_INLINE void Lowering::mark_times() {
    p_.of_time_.assign(static_cast<std::size_t>(p_.slots_), false);
    p_.of_time_[static_cast<std::size_t>(p_.time_slot())] = true;
    for (const Instruction& i : p_.instructions_) {
        bool is_of_time = true;
        operands::reads(p_, i, [&](int slot) { is_of_time = is_of_time && p_.is_of_time(slot); });
        operands::writes(p_, i, [&](int slot) { p_.of_time_[static_cast<std::size_t>(slot)] = is_of_time; });
    }
}

RBDYN_INLINE int Lowering::ByNode::operator[](std::int32_t n) const {
    return static_cast<std::size_t>(n) < known_.size() ? known_[static_cast<std::size_t>(n)] : -1;
}

RBDYN_INLINE int Lowering::ByNode::set(std::int32_t n, int value) {
    if (static_cast<std::size_t>(n) >= known_.size()) known_.resize(2 * static_cast<std::size_t>(n) + 16, -1);
    return known_[static_cast<std::size_t>(n)] = value;
}

RBDYN_INLINE bool Lowering::parametric(std::int32_t n) {
    // operands come before what is made of them
    for (auto m = static_cast<std::int32_t>(parametric_.size()); m <= n; ++m) {
        const Node& node = r_.node(m);
        const auto operands = node.operands();
        const bool varies = node.operation == Operation::input || node.operation == Operation::time ||
                            node.operation == Operation::call ||
                            std::any_of(operands.begin(), operands.end(), [&](std::int32_t operand) {
                                return operand >= 0 && !parametric_[static_cast<std::size_t>(operand)];
                            });
        parametric_.push_back(!varies);
    }
    return parametric_[static_cast<std::size_t>(n)];
}

RBDYN_INLINE bool Lowering::parameter_used(int index) const {
    return index < static_cast<int>(parameter_used_.size()) && parameter_used_[static_cast<std::size_t>(index)];
}

RBDYN_INLINE bool Lowering::scaled(std::int32_t n) {
    const Node& node = r_.node(n);
    return node.operation == Operation::multiply && !parametric(n) && (parametric(node.a) || parametric(node.b));
}

RBDYN_INLINE void Lowering::mark(const std::vector<Expression>& outputs) {
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

RBDYN_INLINE int Lowering::uses(std::int32_t n) const {
    return n < static_cast<std::int32_t>(uses_.size()) ? uses_[static_cast<std::size_t>(n)] : 1;
}

template <class F>
void Lowering::each_part(std::int32_t root, const F& part) {
    std::vector<std::pair<std::int32_t, Expression>> left{{root, Expression(1.0)}};
    for (bool is_root = true; !left.empty(); is_root = false) {
        auto [n, weight] = left.back();
        left.pop_back();
        if (parametric(n)) {
            part({n, -1}, weight);
            continue;
        }
        const std::int32_t base = base_of(n, weight);
        const Node node = r_.node(base);
        const bool inlined = (is_root && base == n) || uses(base) <= 1;
        if (inlined && node.operation == Operation::add) {
            left.emplace_back(node.b, weight);
            left.emplace_back(node.a, weight);
        } else if (inlined && node.operation == Operation::multiply) {
            const std::int32_t a = base_of(node.a, weight), b = base_of(node.b, weight);
            part({a, b}, weight);
        } else {
            part({base, -1}, weight);
        }
    }
}

RBDYN_INLINE int Lowering::slot_of(std::int32_t n) {
    const Node node = r_.node(n);
    if (node.operation == Operation::input) return node.a;
    if (node.operation == Operation::time) {
        p_.uses_time_ = true;
        return p_.inputs_;
    }
    if (slots_[n] >= 0) return slots_[n];
    if (depth_ == deepest) make_operands(n);
    ++depth_;
    int slot = -1;
    switch (parametric(n) ? Operation::constant : node.operation) {
        case Operation::constant:
        case Operation::parameter:
        case Operation::add:
        case Operation::multiply: slot = append(combination(n)); break;
        case Operation::divide: slot = append({Code::divide, new_slot(), -1, slot_of(node.a), slot_of(node.b)}); break;
        case Operation::square_root:
            if (!r_.is_locked_positive(node.a)) {
                slot = append({Code::square_root, new_slot(), -1, slot_of(node.a)});
                break;
            }
            slot = append_power(slot_of(node.a), 0.5, true);
            break;
        case Operation::norm: {
            Instruction i{Code::norm, new_slot(), -1, slot_of(node.a), slot_of(node.b), slot_of(node.c)};
            i.weight = scalar_of(r_.parameter(node.d));
            i.extra = p_.states_++;
            slot = append(i);
            break;
        }
        case Operation::sine:
        case Operation::cosine: {
            Instruction i{Code::sine_cosine, new_slot(), new_slot(), slot_of(node.a)};
            i.extra = new_slot();
            append(i);
            slots_.set(r_.record(Operation::sine, node.a).node(), i.out);
            slots_.set(r_.record(Operation::cosine, node.a).node(), i.out2);
            slot = node.operation == Operation::sine ? i.out : i.out2;
            break;
        }
        case Operation::hyperbolic_sine:
        case Operation::hyperbolic_cosine: {
            Instruction i{Code::hyperbolic, new_slot(), new_slot(), slot_of(node.a)};
            i.extra = new_slot();
            append(i);
            slots_.set(r_.record(Operation::hyperbolic_sine, node.a).node(), i.out);
            slots_.set(r_.record(Operation::hyperbolic_cosine, node.a).node(), i.out2);
            slot = node.operation == Operation::hyperbolic_sine ? i.out : i.out2;
            break;
        }
        case Operation::hyperbolic_tangent: {
            Instruction i{Code::tangent, new_slot(), new_slot(), slot_of(node.a)};
            i.extra = new_slot();
            slot = append(i);
            break;
        }
        case Operation::angle: {
            // the square of the distance from the origin is its derivative's denominator
            const Expression y(&r_, node.a), x(&r_, node.b);
            const std::int32_t square = r_.node_of(x * x + y * y);
            Instruction i{Code::angle, new_slot(), -1, slot_of(node.a), slot_of(node.b), slot_of(square)};
            i.extra = new_slot();
            slot = append(i);
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
            append(i);
            break;
        }
        case Operation::exponential:
        case Operation::logarithm: {
            Instruction i{node.operation == Operation::exponential ? Code::exponential : Code::logarithm, new_slot(),
                          -1, slot_of(node.a)};
            i.extra = new_slot();
            slot = append(i);
            break;
        }
        case Operation::expm1:
        case Operation::log1p:
        case Operation::arsinh:
        case Operation::artanh: {
            const Code code = node.operation == Operation::expm1    ? Code::expm1
                              : node.operation == Operation::log1p  ? Code::log1p
                              : node.operation == Operation::arsinh ? Code::arsinh
                                                                    : Code::artanh;
            Instruction i{code, new_slot(), new_slot(), slot_of(node.a)};
            i.extra = new_slot();
            slot = append(i);
            break;
        }
        case Operation::raise: {
            // its series is that of an exponential function, its value has more digits
            const std::int32_t argument = r_.node_of(value_of(node.b) * log(value_of(node.a)));
            Instruction i{Code::exponential, new_slot(), -1, slot_of(argument), slot_of(node.a), slot_of(node.b)};
            i.extra = new_slot();
            slot = append(i);
            break;
        }
        case Operation::power:
            slot = append_power(slot_of(node.a), node.value, node.value > 0.0 && r_.is_locked_positive(node.a));
            break;
        default: break;
    }
    --depth_;
    return slots_.set(n, slot);
}

RBDYN_INLINE void Lowering::make_operands(std::int32_t n) {
    const int depth = std::exchange(depth_, 0);
    std::vector<std::int32_t> open{n};
    while (!open.empty()) {
        const std::int32_t m = open.back();
        const auto before = static_cast<std::ptrdiff_t>(open.size());
        if (slots_[m] < 0)
            for (const std::int32_t operand : needed(m))
                if (slots_[operand] < 0) open.push_back(operand);
        std::reverse(open.begin() + before, open.end());
        if (static_cast<std::ptrdiff_t>(open.size()) > before) continue;
        open.pop_back();
        if (m != n) slot_of(m);
    }
    depth_ = depth;
}

RBDYN_INLINE std::vector<std::int32_t> Lowering::needed(std::int32_t n) {
    std::vector<std::int32_t> result;
    const auto add = [&](std::int32_t operand) {
        const Operation operation = r_.node(operand).operation;
        if (operation != Operation::input && operation != Operation::time) result.push_back(operand);
    };
    const Node node = r_.node(n);
    if (parametric(n) || node.operation == Operation::input || node.operation == Operation::time) return result;
    if (node.operation == Operation::call) {
        for (const std::int32_t argument : r_.calls()[static_cast<std::size_t>(node.a)].arguments) add(argument);
        return result;
    }
    if (node.operation != Operation::add && node.operation != Operation::multiply) {
        for (const std::int32_t operand : node.operands())
            if (operand >= 0) add(operand);
        return result;
    }
    each_part(n, [&](std::pair<std::int32_t, std::int32_t> of, const Expression&) {
        if (parametric(of.first)) return;
        add(of.first);
        if (of.second >= 0) add(of.second);
    });
    return result;
}

RBDYN_INLINE int Lowering::append(const Instruction& i) {
    if (p_.instructions_.size() % 64 == 0) Interruption::point();
    p_.instructions_.push_back(i);
    return i.out;
}

RBDYN_INLINE int Lowering::append_power(int base, double exponent, bool is_locked) {
    Instruction i{Code::power, new_slot(), -1, base};
    i.extra = new_slot();
    i.value = exponent;
    i.is_locked = is_locked;
    return append(i);
}

RBDYN_INLINE int Lowering::append(const Combination& sum) {
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
    return append(i);
}

RBDYN_INLINE std::int32_t Lowering::base_of(std::int32_t n, Expression& weight) {
    while (scaled(n)) {
        const Node node = r_.node(n);
        const bool first = parametric(node.a);
        weight = weight * value_of(first ? node.a : node.b);
        n = first ? node.b : node.a;
    }
    return n;
}

RBDYN_INLINE Expression Lowering::value_of(std::int32_t n) {
    const Node& node = r_.node(n);
    return node.operation == Operation::constant ? node.constant() : Expression(&r_, n);
}

RBDYN_INLINE Lowering::Combination Lowering::combination(std::int32_t n) {
    Combination sum;
    each_part(n, [&](std::pair<std::int32_t, std::int32_t> of, const Expression& weight) {
        if (parametric(of.first)) {
            sum.constant = sum.constant + weight * value_of(of.first);
            return;
        }
        const int i = slot_of(of.first), j = of.second < 0 ? -1 : slot_of(of.second);
        Expression& w = j < 0 ? sum.terms[i] : sum.products[{std::min(i, j), std::max(i, j)}];
        w = w + weight;
    });
    return sum;
}

RBDYN_INLINE int Lowering::scalar_of(const Expression& x) {
    const std::int32_t root = r_.node_of(x);
    std::vector<std::int32_t> open{root};
    while (!open.empty()) {
        const std::int32_t n = open.back();
        const Node node = r_.node(n);
        const auto before = static_cast<std::ptrdiff_t>(open.size());
        const bool is_made = node.operation != Operation::parameter && node.operation != Operation::constant;
        if (is_made && scalars_[n] < 0)
            for (const std::int32_t operand : {node.c, node.b, node.a})
                if (operand >= 0 && scalars_[operand] < 0) open.push_back(operand);
        if (static_cast<std::ptrdiff_t>(open.size()) > before) continue;
        open.pop_back();
        if (scalars_[n] >= 0) continue;
        const int out = scalars_.set(n, static_cast<int>(p_.constants_.size()));
        p_.constants_.push_back({node.value, node.rest});
        const auto scalar = [&](std::int32_t operand) { return operand >= 0 ? scalars_[operand] : -1; };
        if (node.operation == Operation::parameter)
            p_.scalar_steps_.push_back({node.operation, out, node.a, -1, -1, 0.0});
        else if (is_made)
            p_.scalar_steps_.push_back(
                {node.operation, out, scalar(node.a), scalar(node.b), scalar(node.c), node.value});
    }
    return scalars_[root];
}

RBDYN_INLINE Program::Program(Recorder& recorder, std::span<const Expression> outputs, int inputs) {
    Lowering(recorder, *this, inputs).run(outputs);
}

RBDYN_INLINE std::string Program::text() const {
    static const char* names[] = {"combine", "divide", "sqrt",  "norm",   "sincos", "sinhcosh", "tanh",  "exp",
                                  "log",     "expm1",  "log1p", "arsinh", "artanh", "pow",      "angle", "call"};
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

}  // namespace rbdyn::inline RBDYN_FORM
