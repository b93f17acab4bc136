// Numbers of the user's that recorded functions use by reference.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A number of the user's, used in recorded functions by reference: it may be changed between runs.
class Parameter {
public:
    explicit Parameter(double value, std::string name = {});
    // a move copies: what was moved from stays what it was
    Parameter(const Parameter&) = default;
    Parameter& operator=(const Parameter&) = default;
    double value() const;
    const std::string& name() const { return cell_->name; }
    void set(double value);
    /// "parameter k", for messages.
    std::string description() const { return name().empty() ? "a parameter" : "parameter " + name(); }
    /// In the function that is being recorded. Throws Error if none is.
    operator Expression() const;

    /// Whether they are one parameter.
    bool is(const Parameter& other) const { return cell_ == other.cell_; }

private:
    struct Cell {
        std::atomic<double> value;  // runs may start while another thread sets it
        std::string name;
        Cell(double v, std::string n) : value(v), name(std::move(n)) {}
    };
    void require_finite(double value) const;

    std::shared_ptr<Cell> cell_;
    friend class BoundParameters;
};

/// Gives parameters other values in this thread, for as long as it lives: runs that start meanwhile take these, and so
/// do functions that are called back. Other threads see nothing of it. Of one that is given twice the last counts.
class BoundParameters {
public:
    using Values = std::vector<std::pair<Parameter, double>>;

    /// `values` outlive it. Throws InvalidInput for a value that is not finite.
    explicit BoundParameters(const Values& values);
    ~BoundParameters() { active() = before_; }
    BoundParameters(const BoundParameters&) = delete;
    BoundParameters& operator=(const BoundParameters&) = delete;

    /// The innermost in this thread.
    static const BoundParameters*& active();
    /// What it gives a parameter, if anything.
    const double* find(const Parameter& parameter) const;

private:
    const Values& values_;
    const BoundParameters* before_;
};

}  // namespace rbdyn::inline RBDYN_FORM
