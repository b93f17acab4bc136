// Numbers of the user's that recorded functions use by reference.
#pragma once

#include <memory>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A number of the user's, used in recorded functions by reference: it may be changed between runs.
class Parameter {
public:
    explicit Parameter(double value, std::string name = {});
    double value() const { return cell_->value; }
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
        double value;
        std::string name;
    };
    std::shared_ptr<Cell> cell_;
};

}  // namespace rbdyn::inline RBDYN_FORM
