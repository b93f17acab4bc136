// The exact Jacobian of the outputs by the state, by rows: entries that can be other than zero where these are few, all
// where not.
//
// Derivatives are carried forwards through the program, as JacobianEvaluator does it. Of a chain each slot depends on a
// few variables: the derivatives by these alone are kept, so that time and memory are those of the entries, not of
// their square. The same sums in the same order: the same bits.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Which variables the slots of a program depend on.
class Dependence {
public:
    /// Gives up where there are more than `most` in all.
    Dependence(const Program& program, std::size_t most);

    bool is_known() const { return !first_.empty(); }
    /// Those of a slot, ascending; their places in a list of those of all slots begin at first().
    std::span<const int> operator[](int slot) const {
        return {variables_.data() + first(slot), variables_.data() + first(slot + 1)};
    }
    std::size_t first(int slot) const { return first_[static_cast<std::size_t>(slot)]; }
    std::size_t size() const { return variables_.size(); }

private:
    std::vector<std::size_t> first_;
    std::vector<int> variables_;
};

/// Values and derivatives of a program whose output i is the rate of variable i.
class StateJacobian {
public:
    explicit StateJacobian(const Program& program);
    ~StateJacobian();

    void set_parameters(std::span<const double> parameters, Program::Rounding rounding);

    /// At (t, x).
    void differentiate(double t, std::span<const double> x);

    int size() const { return n_; }
    bool is_sparse() const { return dense_ == nullptr; }
    /// The columns of a row, ascending, and its entries.
    std::span<const int> columns(int row) const {
        return {columns_.data() + first(row), columns_.data() + first(row + 1)};
    }
    std::span<const double> entries(int row) const {
        return {entries_.data() + first(row), entries_.data() + first(row + 1)};
    }
    std::span<const double> entries() const { return entries_; }
    /// Where the rows begin in a list of all columns.
    std::span<const std::size_t> rows() const { return first_; }
    std::span<const int> columns() const { return columns_; }

private:
    class Sparse;
    std::size_t first(int row) const { return first_[static_cast<std::size_t>(row)]; }

    int n_;
    std::unique_ptr<JacobianEvaluator> dense_;
    std::unique_ptr<Sparse> sparse_;
    std::vector<std::size_t> first_;
    std::vector<int> columns_;
    std::vector<double> entries_;
};

}  // namespace rbdyn::inline RBDYN_FORM
