// Definitions of rbdyn/model/equations_writer.hpp.
#pragma once

#include "rbdyn/model/equations_writer.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/same_sign.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM::recording {

RBDYN_INLINE bool is_constant(const Recorder& r, const Expression& x) {
    if (x.is_constant()) return true;
    std::vector<std::int32_t> todo{x.node()};
    std::vector<bool> seen(static_cast<std::size_t>(r.size()), false);
    while (!todo.empty()) {
        const std::int32_t n = todo.back();
        todo.pop_back();
        if (seen[static_cast<std::size_t>(n)]) continue;
        seen[static_cast<std::size_t>(n)] = true;
        const Node& node = r.node(n);
        if (node.operation == Operation::input || node.operation == Operation::time ||
            node.operation == Operation::call)
            return false;
        for (std::int32_t operand : node.operands())
            if (operand >= 0) todo.push_back(operand);
    }
    return true;
}

RBDYN_INLINE bool distinguishes(const Recorder& r) {
    if (!r.blends().empty()) return true;
    for (const Branch& b : r.branches())
        if (!b.name.empty()) return true;
    for (const Switch& s : r.switches())
        if (s.tag < 0 && !s.is_norm) return true;
    return false;
}

RBDYN_INLINE bool chooses(const Recorder& r) {
    if (!r.branches().empty()) return true;
    for (std::int32_t n = 0; n < r.size(); ++n)
        if (r.node(n).operation == Operation::sign) return true;
    return false;
}

}  // namespace rbdyn::inline RBDYN_FORM::recording

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE EquationsWriter::EquationsWriter(Recorder& recorder, int variables)
    : r_(recorder), rates_(static_cast<std::size_t>(variables), Expression(0.0)) {}

RBDYN_INLINE void EquationsWriter::guard(Guard g, const Expression& value) {
    const bool is_constant = recording::is_constant(r_, value);
    if (is_constant && (g.branch >= 0 || !recording::chooses(r_))) return;
    moves_ = moves_ || !is_constant;
    watch(std::move(g), value);
}

RBDYN_INLINE void EquationsWriter::decide(Guard g, const Expression& value) {
    if (value.is_constant() && value.value() > 0.0 && !recording::chooses(r_)) return;
    watch(std::move(g), value);
}

RBDYN_INLINE void EquationsWriter::watch(Guard g, const Expression& value) {
    g.output = static_cast<int>(rates_.size() + watched_.size());
    moves_ = moves_ || !recording::is_constant(r_, value);
    add(std::move(g));
    watched_.push_back(value);
}

RBDYN_INLINE void EquationsWriter::watch(const Guard& g, const Function& function, std::span<const Expression> x) {
    const SignFactors signs = sign_factors(function);
    for (const Expression& value : signs.factors(x)) {
        Guard factor = g;
        factor.is_itself = signs.is_itself;
        watch(std::move(factor), value);
    }
}

RBDYN_INLINE int EquationsWriter::output(const Expression& value) {
    watched_.push_back(value);
    return static_cast<int>(rates_.size() + watched_.size()) - 1;
}

RBDYN_INLINE void EquationsWriter::outside(Guard g, bool moves) {
    moves_ = moves_ || moves;
    add(std::move(g));
}

RBDYN_INLINE void EquationsWriter::add(Guard g) {
    if (g.watch >= 0) g.part = parts_++;
    guards_.push_back(std::move(g));
}

RBDYN_INLINE std::unique_ptr<Structure> EquationsWriter::finish(std::vector<VariableGroup> groups) {
    for (std::size_t k = 0; k < r_.branches().size(); ++k) {
        const Branch b = r_.branches()[k];
        const Expression argument(&r_, b.argument);
        Guard g{.kind = EventKind::switching, .subject = b.subject, .name = b.name, .branch = static_cast<int>(k)};
        if (b.has_lower()) {
            g.step = -1;
            guard(g, argument - b.lower());
        }
        if (b.has_upper()) {
            g.step = 1;
            guard(g, b.upper() - argument);
        }
    }
    for (const Expression& rate : rates_) moves_ = moves_ || !rate.is_zero();
    auto result = std::make_unique<Structure>();
    result->still = !moves_;
    std::vector<Expression> outputs = rates_;
    outputs.insert(outputs.end(), watched_.begin(), watched_.end());
    Equations& e = result->equations;
    // numbers of the user's that are all of what acts become parameters of both programs
    for (const Expression& x : acting_)
        if (x.is_number()) (void)r_.node_of(x);
    e.program = Program(r_, outputs, static_cast<int>(rates_.size()));
    if (!acting_.empty()) {
        std::vector<Expression> all = rates_;
        all.insert(all.end(), acting_.begin(), acting_.end());
        const auto acting = std::make_shared<Program>(r_, all, static_cast<int>(rates_.size()));
        // numbers of the user's that only what acts depends on: both take the same parameters
        e.program.take_parameters(r_.parameters());
        acting->take_parameters(r_.parameters());
        e.acting = acting;
    }
    e.guards = std::move(guards_);
    e.branches = r_.branches();
    e.number_parameters = r_.numbers();
    e.groups = std::move(groups);
    for (std::size_t k = 0; k < e.program.switches().size(); ++k) {
        const Switch& s = e.program.switches()[k];
        e.guards.push_back({.kind = s.tag >= 0 ? EventKind::normal_zero : EventKind::switching,
                            .subject = s.subject,
                            .output = e.program.outputs() + static_cast<int>(k),
                            .sign_parameter = s.is_norm ? -1 : s.parameter,
                            .name = s.name});
        if (s.is_norm) e.start_flags.push_back(s.parameter);
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
