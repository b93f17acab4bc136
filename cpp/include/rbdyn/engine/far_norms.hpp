// Lengths that stay away from zero all along a piece of motion, as told by its polynomials alone.
//
// A spring of rest length has no direction where its ends meet, so its length is a guard; of a chain each spring has
// one, and series of them all take longer than a step. Where |d(0)| exceeds what d, which is linear in the variables,
// changes by along the piece, there is no zero, and no series is needed to say so: |d(tau)| >= |d(0)| - |d(tau) -
// d(0)|.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class FarNorms {
public:
    /// `guards`: those among the equations' that are looked at.
    FarNorms(const Equations& equations, const std::vector<int>& guards);

    /// Looks along a piece, with the weights that `series` has for the program's parameters. Returns whether all of the
    /// guards stay away from zero.
    bool look(const Piece& piece, const SeriesEvaluator& series);

    /// Whether a guard stays away from zero there.
    bool is_far(int guard) const { return !is_far_.empty() && is_far_[static_cast<std::size_t>(guard)] != 0; }

private:
    struct Multiple {
        int variable, weight;
    };
    /// A constant (weight -1: none) and multiples of variables, [first, last) of all.
    struct Component {
        int weight;
        std::size_t first, last;
    };
    struct Norm {
        int guard;
        std::size_t first, last;  // components
    };
    /// Takes a slot if it is linear in the variables.
    bool take(const Program& program, int slot);
    bool is_far(const Norm& norm, const Piece& piece, const SeriesEvaluator& series) const;

    static constexpr int itself = -1;  // the weight of a variable that is a component
    std::vector<Multiple> multiples_;
    std::vector<Component> components_;
    std::vector<Norm> norms_;
    std::vector<signed char> is_far_;  // by guard; empty: there are no norms
    bool are_all_ = false;             // guards are norms
};

}  // namespace rbdyn::inline RBDYN_FORM
