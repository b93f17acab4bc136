// Which variables of a scene are simulated, and what the others stay at.
//
// Conventions: a variable goes by its index among all of the scene's, those simulated by their place in the state too;
// their order is the same.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

class StateMap {
public:
    StateMap() = default;
    /// `start`: what all variables start with; `stays`: which of them stay so and are left out; `rest`: what `start` is
    /// short of 32 digits, if of any.
    StateMap(std::vector<double> start, const std::vector<bool>& stays, std::vector<double> rest = {});

    /// How many variables are simulated, and how many there are.
    int size() const { return size_; }
    int variables() const { return static_cast<int>(all_.size()); }
    bool has_all() const { return size() == variables(); }

    /// Where a variable is in the state; -1: nowhere, it stays as it starts.
    int place(int variable) const { return place_[static_cast<std::size_t>(variable)]; }
    bool is_simulated(int variable) const { return place(variable) >= 0; }
    /// What a variable starts with.
    double start(int variable) const { return all_[static_cast<std::size_t>(variable)]; }
    /// The same in 32 digits.
    DoubleDouble exact_start(int variable) const;
    double value(int variable, std::span<const double> x) const;

    /// All variables at a state.
    void spread(std::span<const double> x, std::span<double> all) const;
    /// The same of something that what stays has none of.
    void spread_zero(std::span<const double> x, std::span<double> all) const;
    /// What belongs to the state, of something for each variable.
    void gather(std::span<const double> all, std::span<double> x) const;

private:
    int size_ = 0;
    std::vector<int> place_;
    std::vector<double> all_, rest_;
};

}  // namespace rbdyn::inline RBDYN_FORM
