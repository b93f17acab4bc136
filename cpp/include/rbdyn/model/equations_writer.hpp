// Writes the equations of one structure: rates, guards, and what the recorder itself adds to them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/model/equations.hpp"

namespace rbdyn {

/// Equations of one structure. `still`: nothing can move or happen in it.
struct Structure {
    Equations equations;
    bool still = false;
};

namespace recording {

/// Whether an expression stays what it is during smooth motion.
inline bool is_constant(const Recorder& r, const Expression& x) {
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

/// Whether forces recorded may be others at the same state in another mode: on the other side of a case distinction,
/// with another sign, or weighed where motion slides along a surface.
inline bool distinguishes(const Recorder& r) {
    if (!r.blends().empty()) return true;
    for (const Branch& b : r.branches())
        if (!b.name.empty()) return true;
    for (const Switch& s : r.switches())
        if (s.tag < 0 && !s.is_norm) return true;
    return false;
}

/// Whether anything recorded has another formula or sign elsewhere.
inline bool chooses(const Recorder& r) {
    if (!r.branches().empty()) return true;
    for (std::int32_t n = 0; n < r.size(); ++n)
        if (r.node(n).operation == Operation::sign) return true;
    return false;
}

}  // namespace recording

class EquationsWriter {
public:
    EquationsWriter(Recorder& recorder, int variables)
        : r_(recorder), rates_(static_cast<std::size_t>(variables), Expression(0.0)) {}

    /// x' of a variable; zero if it is not set.
    Expression& rate(int variable) { return rates_[static_cast<std::size_t>(variable)]; }
    std::vector<Expression>& rates() { return rates_; }

    /// A guard, unless its value cannot change: in this structure, and with no other choice that could have been made.
    void guard(Guard g, const Expression& value) {
        const bool is_constant = recording::is_constant(r_, value);
        if (is_constant && (g.branch >= 0 || !recording::chooses(r_))) return;
        moves_ = moves_ || !is_constant;
        watch(std::move(g), value);
    }
    /// A guard that says what a mode is followed by as soon as the mode begins: also where its value cannot change,
    /// unless that is known to be positive whatever is chosen.
    void decide(Guard g, const Expression& value) {
        if (value.is_constant() && value.value() > 0.0 && !recording::chooses(r_)) return;
        watch(std::move(g), value);
    }
    /// A guard whose value is looked at even if it cannot change: it may between structures.
    void watch(Guard g, const Expression& value) {
        g.output = static_cast<int>(rates_.size() + watched_.size());
        moves_ = moves_ || !recording::is_constant(r_, value);
        guards_.push_back(std::move(g));
        watched_.push_back(value);
    }
    /// A value that is asked for and guards nothing. Returns its index among the outputs.
    int output(const Expression& value) {
        watched_.push_back(value);
        return static_cast<int>(rates_.size() + watched_.size()) - 1;
    }
    /// A guard that is none of the program's outputs. `moves`: whether it may fire by what happens outside of it.
    void outside(Guard g, bool moves = true) {
        moves_ = moves_ || moves;
        guards_.push_back(std::move(g));
    }

    /// What acts in this structure, for reports: none of it is integrated.
    void acting(std::span<const Expression> values) { acting_.assign(values.begin(), values.end()); }

    /// The structure, with the guards of the recorder's choices and switches.
    std::unique_ptr<Structure> finish(std::vector<VariableGroup> groups) {
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
        e.program = Program(r_, outputs, static_cast<int>(rates_.size()));
        if (!acting_.empty()) {
            std::vector<Expression> all = rates_;
            all.insert(all.end(), acting_.begin(), acting_.end());
            e.acting = std::make_shared<const Program>(r_, all, static_cast<int>(rates_.size()));
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

private:
    Recorder& r_;
    std::vector<Expression> rates_, watched_, acting_;
    std::vector<Guard> guards_;
    bool moves_ = false;
};

}  // namespace rbdyn
