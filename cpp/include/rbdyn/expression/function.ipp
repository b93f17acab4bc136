// Definitions of rbdyn/expression/function.hpp.
#pragma once

#include "rbdyn/expression/function.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/derivative.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Function::give(GivenNumbers& numbers) const {
    if (!recorder_) return;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(parameters().size()); ++i)
        numbers.add(recorder_->cells()[at(i)], cell(i));
}

RBDYN_INLINE void Function::settle() const {
    Numbers* numbers = Numbers::active();
    for (std::int32_t i = 0; numbers != nullptr && i < static_cast<std::int32_t>(parameters().size()); ++i)
        (void)numbers->number(recorder_->cells()[at(i)], cell(i)).value();
}

RBDYN_INLINE Function Function::frozen() const {
    Function result = *this;
    if (!recorder_ || values_ || recorder_->cells().empty()) return result;
    auto values = std::make_shared<std::vector<double>>();
    for (const Parameter& p : recorder_->cells()) values->push_back(p.value());
    result.values_ = std::move(values);
    return result;
}

RBDYN_INLINE std::optional<std::vector<double>> Function::constants() const {
    std::vector<double> result;
    for (const std::int32_t out : outputs_)
        if (const Node& node = recorder_->node(out); node.operation == Operation::constant)
            result.push_back(node.value);
    if (result.size() == outputs_.size()) return result;
    if (recorder_->cells().empty()) return std::nullopt;
    // as where equations are recorded: a number that happens to be one of the constants is none
    GivenNumbers given;
    give(given);
    Numbers own(given);
    const Numbers::Active active(Numbers::active() != nullptr ? Numbers::active() : &own);
    Recorder scratch(Recorder::Purpose::function);
    std::vector<Expression> x;
    for (int i = 0; i < inputs_; ++i) x.push_back(scratch.input(i));
    result.clear();
    for (const Expression& y : (*this)(std::span<const Expression>(x))) {
        if (!y.is_constant()) return std::nullopt;
        result.push_back(y.constant().number.hi);
    }
    return result;
}

RBDYN_INLINE bool Function::depends_on(int input) const {
    std::vector<bool> depends(static_cast<std::size_t>(recorder_->size()), false);
    for (std::int32_t n = 0; n < recorder_->size(); ++n) {
        const Node& node = recorder_->node(n);
        bool d = node.operation == Operation::input && node.a == input;
        for (std::int32_t operand : node.operands())
            if (operand >= 0) d = d || depends[static_cast<std::size_t>(operand)];
        depends[static_cast<std::size_t>(n)] = d;
    }
    for (std::int32_t out : outputs_)
        if (depends[static_cast<std::size_t>(out)]) return true;
    return false;
}

RBDYN_INLINE Expression Function::again(std::int32_t n, std::span<const Expression> x,
                                        const std::vector<Expression>& y) const {
    const Node& node = recorder_->node(n);
    if (node.operation == Operation::cell) return recording::active()->cell(recorder_->cells()[at(node.a)]);
    return applied<Expression>(n, x, y);
}

RBDYN_INLINE Function Function::rewritten(
    const std::function<std::optional<Expression>(std::int32_t n, const std::vector<Expression>& y)>& instead) const {
    Function result = record(inputs_, [&](const std::vector<Expression>& x) {
        // in the same order: so are the values of what is frozen
        for (const Parameter& p : parameters()) (void)recording::active()->cell(p);
        std::vector<Expression> y;
        for (std::int32_t n = 0; n < size(); ++n) {
            const std::optional<Expression> other = instead(n, y);
            y.push_back(other ? *other : again(n, x, y));
        }
        std::vector<Expression> results;
        for (const std::int32_t out : outputs_) results.push_back(y[at(out)]);
        return results;
    });
    result.values_ = values_;
    return result;
}

RBDYN_INLINE Function Function::trimmed() const {
    std::vector<char> is_used(static_cast<std::size_t>(size()), 0);
    for (const std::int32_t out : outputs_) is_used[at(out)] = 1;
    for (std::int32_t n = size(); n-- > 0;)
        for (const std::int32_t operand : node(n).operands())
            if (is_used[at(n)] && operand >= 0) is_used[at(operand)] = 1;
    std::vector<Node> nodes;
    std::vector<std::int32_t> moved(is_used.size(), -1), outputs;
    for (std::int32_t n = 0; n < size(); ++n) {
        if (!is_used[at(n)]) continue;
        Node copy = node(n);
        const auto used = copy.operands();
        for (std::size_t i = 0; i < 3; ++i)
            if (used[i] >= 0) (i == 0 ? copy.a : i == 1 ? copy.b : copy.c) = moved[at(used[i])];
        moved[at(n)] = static_cast<std::int32_t>(nodes.size());
        nodes.push_back(copy);
    }
    for (const std::int32_t out : outputs_) outputs.push_back(moved[at(out)]);
    return from_data(inputs_, nodes, outputs, names(), parameters());
}

RBDYN_INLINE Function Function::derivative(int input) const {
    const recording::WideFolding all_digits;
    return record(inputs_, [&](const std::vector<Expression>& x) { return differentiated(x, input); });
}

RBDYN_INLINE Function Function::distinctions() const {
    Function result = *this;
    result.outputs_.clear();
    for (std::int32_t n = 0; n < size(); ++n)
        if (node(n).operation == Operation::sign || node(n).operation == Operation::select)
            result.outputs_.push_back(node(n).a);
    return result;
}

RBDYN_INLINE Function Function::canonical() const {
    if (!recorder_ || (parameters().empty() && names().empty())) return *this;
    std::vector<Node> nodes;
    std::vector<std::string> used_names;
    std::vector<Parameter> used;
    for (std::int32_t n = 0; n < size(); ++n) {
        Node& copy = nodes.emplace_back(node(n));
        if (copy.operation == Operation::cell) {
            const Parameter& p = parameters()[at(copy.a)];
            const auto found = std::find_if(used.begin(), used.end(), [&](const Parameter& q) { return q.is(p); });
            copy.a = static_cast<std::int32_t>(found - used.begin());
            if (found == used.end()) used.push_back(p);
        }
        if (copy.operation == Operation::sign || copy.operation == Operation::select ||
            copy.operation == Operation::whole) {
            const auto found = std::find(used_names.begin(), used_names.end(), name(copy.d));
            const auto index = static_cast<std::int32_t>(found - used_names.begin());
            if (found == used_names.end()) used_names.push_back(name(copy.d));
            copy.d = index;
        }
    }
    return from_data(inputs_, nodes, outputs_, used_names, used);
}

RBDYN_INLINE bool Function::operator==(const Function& other) const {
    if (recorder_ == other.recorder_) return true;
    if (!recorder_ || !other.recorder_) return false;
    return is_same(other) || (!parameters().empty() && canonical().is_same(other.canonical()));
}

RBDYN_INLINE bool Function::is_same(const Function& other) const {
    if (inputs_ != other.inputs_ || outputs_ != other.outputs_ || size() != other.size() || names() != other.names() ||
        parameters().size() != other.parameters().size())
        return false;
    for (std::int32_t n = 0; n < size(); ++n)
        if (!(node(n) == other.node(n))) return false;
    for (std::size_t i = 0; i < parameters().size(); ++i) {
        const Parameter &a = parameters()[i], &b = other.parameters()[i];
        if (!a.is(b) && (a.value() != b.value() || a.name() != b.name())) return false;
    }
    return true;
}

RBDYN_INLINE void Function::refuse_empty() {
    throw InvalidInput("Function: it is empty, and is called; record() makes one");
}

RBDYN_INLINE void Function::prepare() {
    for (std::int32_t n = 0; n < recorder_->size(); ++n) {
        const Operation o = recorder_->node(n).operation;
        distinguishes_ = distinguishes_ || o == Operation::select || o == Operation::whole;
    }
}

RBDYN_INLINE double Function::cell(std::int32_t index) const {
    return values_ ? (*values_)[at(index)] : recorder_->cells()[at(index)].value();
}

RBDYN_INLINE std::optional<Expression> Function::weight_of(const Expression& x, const std::string& name) {
    return x.is_constant() ? std::nullopt : x.recorder()->weight(x, name);
}

RBDYN_INLINE std::vector<Expression> Function::differentiated(const std::vector<Expression>& x, int input) const {
    const auto size = static_cast<std::size_t>(recorder_->size());
    std::vector<Expression> y(size), d(size);
    for (std::int32_t n = 0; n < recorder_->size(); ++n) {
        const Node& node = recorder_->node(n);
        std::array<Expression, 3> operands, slopes;
        for (std::size_t i = 0; i < 3; ++i)
            if (const std::int32_t operand = node.operands()[i]; operand >= 0) {
                operands[i] = y[at(operand)];
                slopes[i] = d[at(operand)];
            }
        Expression &v = y[at(n)], &dv = d[at(n)];
        dv = 0.0;
        v = node.operation == Operation::cell && values_ ? Expression(cell(node.a)) : again(n, x, y);
        if (node.operation == Operation::input)
            dv = node.a == input ? 1.0 : 0.0;
        else if (node.operation == Operation::select)
            dv = select(
                operands[0], [&] { return slopes[1]; }, [&] { return slopes[2]; }, name(node.d));
        else
            dv = recording::derivative(node, v, operands, slopes);
    }
    std::vector<Expression> result;
    for (std::int32_t out : outputs_) result.push_back(d[at(out)]);
    return result;
}

/// How many nodes an operation computes with.
RBDYN_INLINE int operands_of(Operation operation) {
    switch (operation) {
        case Operation::constant:
        case Operation::input:
        case Operation::time:
        case Operation::parameter:
        case Operation::cell:
        case Operation::call: return 0;
        case Operation::add:
        case Operation::multiply:
        case Operation::divide:
        case Operation::raise:
        case Operation::angle: return 2;
        case Operation::norm:
        case Operation::select: return 3;
        default: return 1;
    }
}

RBDYN_INLINE Function Function::from_data(int inputs, const std::vector<Node>& nodes,
                                          const std::vector<std::int32_t>& outputs,
                                          const std::vector<std::string>& names,
                                          const std::vector<Parameter>& parameters) {
    const auto check = [&](bool good, double number) {
        require(good, "Function", "index in its data", number,
                "a node uses earlier nodes, inputs, names and parameters");
    };
    require(inputs >= 0, "Function", "count of inputs in its data", inputs, "it is not negative");
    auto recorder = std::make_shared<Recorder>(Recorder::Purpose::function);
    // of each where it is in the new recording, which has none twice
    std::vector<std::int32_t> named, cells;
    for (const std::string& name : names) named.push_back(recorder->name_index(name));
    for (const Parameter& p : parameters) cells.push_back(recorder->node(recorder->cell(p).node()).a);
    // nodes of cells come first in the new recording, so that the others move
    std::vector<std::int32_t> moved;
    for (const Node& given : nodes) {
        check(given.operation <= Operation::whole, static_cast<double>(given.operation));
        // what its operation does not use is as in a recording, whatever the data have there
        Node node{given.operation};
        switch (given.operation) {
            case Operation::constant:
                node.value = given.value;
                node.is_wide = given.is_wide;
                if (given.is_wide) node.rest = given.rest;
                break;
            case Operation::input:
                check(given.a >= 0 && given.a < inputs, given.a);
                node.a = given.a;
                break;
            case Operation::cell:
                check(given.a >= 0 && at(given.a) < cells.size(), given.a);
                node.a = cells[at(given.a)];
                break;
            case Operation::time:
            case Operation::parameter:
            case Operation::call: check(false, static_cast<double>(moved.size())); break;
            case Operation::power: node.value = given.value; break;
            case Operation::sign:
            case Operation::select:
            case Operation::whole:
                check(given.d >= 0 && at(given.d) < named.size(), given.d);
                node.d = named[at(given.d)];
                break;
            default: break;
        }
        const auto used = given.operands();
        for (std::size_t i = 0; i < 3; ++i) {
            if (static_cast<int>(i) >= operands_of(given.operation)) {
                check(used[i] < 0, used[i]);
                continue;
            }
            check(used[i] >= 0 && at(used[i]) < moved.size(), used[i]);
            (i == 0 ? node.a : i == 1 ? node.b : node.c) = moved[at(used[i])];
        }
        moved.push_back(recorder->record(node).node());
    }
    Function result;
    result.inputs_ = inputs;
    for (const std::int32_t out : outputs) {
        check(out >= 0 && at(out) < moved.size(), out);
        result.outputs_.push_back(moved[at(out)]);
    }
    result.recorder_ = std::move(recorder);
    result.prepare();
    return result;
}

RBDYN_INLINE std::string Function::text() const {
    static const char* words[] = {"",     "input", "time",    "parameter", "",      "+",       "*",
                                  "/",    "sqrt",  "norm",    "sin",       "cos",   "sinh",    "cosh",
                                  "tanh", "exp",   "log",     "expm1",     "log1p", "arcsinh", "arctanh",
                                  "^",    "^",     "arctan2", "call",      "sign",  "where",   "floor"};
    std::string out = std::to_string(inputs_) + " inputs, " + std::to_string(outputs()) + " results\n";
    for (std::int32_t n = 0; n < size(); ++n) {
        const Node& i = node(n);
        out += "  n" + std::to_string(n) + " = ";
        const auto operand = [](std::int32_t k) { return "n" + std::to_string(k); };
        switch (i.operation) {
            case Operation::constant: out += rbdyn::text(i.value); break;
            case Operation::input: out += "input " + std::to_string(i.a); break;
            case Operation::cell:
                out += "parameter " + recorder_->cells()[at(i.a)].name() + " = " + rbdyn::text(cell(i.a));
                break;
            case Operation::add:
            case Operation::multiply:
            case Operation::divide:
            case Operation::raise:
                out += operand(i.a) + " " + words[static_cast<int>(i.operation)] + " " + operand(i.b);
                break;
            case Operation::power: out += operand(i.a) + " ^ " + rbdyn::text(i.value); break;
            case Operation::select:
                out += operand(i.b) + " where " + operand(i.a) + " > 0, else " + operand(i.c);
                break;
            default:
                out += words[static_cast<int>(i.operation)];
                for (const std::int32_t k : i.operands())
                    if (k >= 0) out += " " + operand(k);
                break;
        }
        // the event where it changes
        const bool switches =
            i.operation == Operation::sign || i.operation == Operation::select || i.operation == Operation::whole;
        if (switches && !name(i.d).empty()) out += "  (" + name(i.d) + ")";
        out += '\n';
    }
    for (std::size_t k = 0; k < outputs_.size(); ++k)
        out += "  result " + std::to_string(k) + " = n" + std::to_string(outputs_[k]) + '\n';
    return out;
}

}  // namespace rbdyn::inline RBDYN_FORM
