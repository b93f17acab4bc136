// What an instruction of a program reads and writes.
#pragma once

#include <algorithm>
#include <cstddef>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM::operands {

/// Inputs whose derivatives are outputs.
inline int moving(const Program& program) { return std::min(program.inputs(), program.outputs()); }

/// Calls take(slot) for all that an instruction reads.
template <class Take>
void reads(const Program& program, const Instruction& i, const Take& take) {
    for (const int slot : {i.a, i.b, i.c})
        if (slot >= 0) take(slot);
    for (int t = 0; t < i.terms; ++t) take(program.terms(i)[t].slot);
    for (int p = 0; p < i.products; ++p) {
        take(program.products(i)[p].a);
        take(program.products(i)[p].b);
    }
    if (i.code != Code::call) return;
    for (const int slot : program.calls()[static_cast<std::size_t>(i.extra)].arguments) take(slot);
}

/// The same for all that it writes, scratch of its own among it.
template <class Take>
void writes(const Program& program, const Instruction& i, const Take& take) {
    for (const int slot : {i.out, i.out2})
        if (slot >= 0) take(slot);
    if (i.code == Code::call) {
        for (const int slot : program.calls()[static_cast<std::size_t>(i.extra)].results) take(slot);
    } else if (i.code != Code::norm && i.extra >= 0) {
        take(i.extra);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::operands
