// Writes the equations of one structure: rates, guards, and what the recorder itself adds to them.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Equations of one structure. `still`: nothing can move or happen in it.
struct Structure {
    Equations equations;
    bool still = false;
};

namespace recording {

/// Whether an expression stays what it is during smooth motion.
bool is_constant(const Recorder& r, const Expression& x);

/// Whether forces recorded may be others at the same state in another mode: on the other side of a case distinction,
/// with another sign, or weighed where motion slides along a surface.
bool distinguishes(const Recorder& r);

/// Whether anything recorded has another formula or sign elsewhere.
bool chooses(const Recorder& r);

}  // namespace recording

class EquationsWriter {
public:
    EquationsWriter(Recorder& recorder, int variables);

    /// x' of a variable; zero if it is not set.
    Expression& rate(int variable) { return rates_[static_cast<std::size_t>(variable)]; }
    std::vector<Expression>& rates() { return rates_; }

    /// A guard, unless its value cannot change: in this structure, and with no other choice that could have been made.
    void guard(Guard g, const Expression& value);
    /// A guard that says what a mode is followed by as soon as the mode begins: also where its value cannot change,
    /// unless that is known to be positive whatever is chosen.
    void decide(Guard g, const Expression& value);
    /// A guard whose value is looked at even if it cannot change: it may between structures.
    void watch(Guard g, const Expression& value);
    /// Guards for where a function of x changes its sign.
    void watch(const Guard& g, const Function& function, std::span<const Expression> x);
    /// A value that is asked for and guards nothing. Returns its index among the outputs.
    int output(const Expression& value);
    /// A guard that is none of the program's outputs. `moves`: whether it may fire by what happens outside of it.
    void outside(Guard g, bool moves = true);

    /// What acts in this structure, for reports: none of it is integrated.
    void acting(std::span<const Expression> values) { acting_.assign(values.begin(), values.end()); }

    /// The structure, with the guards of the recorder's choices and switches.
    std::unique_ptr<Structure> finish(std::vector<VariableGroup> groups);

private:
    void add(Guard g);

    Recorder& r_;
    std::vector<Expression> rates_, watched_, acting_;
    std::vector<Guard> guards_;
    int parts_ = 0;
    bool moves_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM
