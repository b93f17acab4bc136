// Numbers of the user's that recorded functions use by reference.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/node.hpp"

namespace rbdyn {

/// A number of the user's, used in recorded functions by reference: it may be changed between runs.
class Parameter {
public:
    explicit Parameter(double value, std::string name = {})
        : cell_(std::make_shared<Cell>(Cell{value, std::move(name)})) {
        require(std::isfinite(value), "parameter", cell_->name.empty() ? "its value" : cell_->name, value,
                "it is finite");
    }
    double value() const { return cell_->value; }
    const std::string& name() const { return cell_->name; }
    void set(double value) {
        require(std::isfinite(value), "parameter", name().empty() ? "its value" : name(), value, "it is finite");
        cell_->value = value;
    }
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

}  // namespace rbdyn
