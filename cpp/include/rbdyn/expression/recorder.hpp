// Holds the nodes of one recorded function (expression.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/parameter.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Where a recorded function is not smooth: an absolute value or a norm at its zero.
/// The sign is a parameter of the program, +1 or -1 times what is inside; `argument` is the guard.
struct Switch {
    std::int32_t argument;   // node whose zero is the switching point
    std::int32_t parameter;  // index of the sign (absolute value) or of the "starts at zero" flag (norm)
    bool is_norm;
    std::string name;
    int tag;                // what the writer of the model makes of it; -1: nothing
    int subject;            // the body it was recorded for; -1: none
    std::uint64_t id;       // the same for the same argument in every recording
    std::uint64_t surface;  // on which it lies, as its id
    int orientation;        // +1: its argument is positive where that of the surface is; -1: where it is negative
};

/// A choice between formulas, made for one smooth mode: valid while lower <= argument <= upper.
struct Branch {
    std::int32_t argument;
    long choice;           // of two: 1 where the argument is positive, else 0; of many: the whole number below it
    bool is_select;        // of two formulas, at zero
    long lowest, highest;  // choices there are; nothing lies beyond them
    std::string name;      // of the event where it changes; empty: silent
    int subject;
    std::uint64_t id = 0;       // the same for the same argument in every recording
    std::uint64_t surface = 0;  // on which it lies, as its id
    int orientation = 1;        // +1: its argument is positive where that of the surface is; -1: where it is negative

    double lower() const { return is_select ? 0.0 : static_cast<double>(choice); }
    double upper() const { return is_select ? 0.0 : static_cast<double>(choice) + 1.0; }
    bool has_lower() const { return choice > lowest; }
    bool has_upper() const { return choice < highest; }
};

/// A surface on which no case distinction is made: both sides are written, each with its weight.
struct Blend {
    Expression weight;           // of the side where the argument is positive; the other has the rest of 1
    std::int32_t argument = -1;  // node whose zero is the surface; -1: nothing lies on it so far
    std::string name = {};       // of the first that lies on it
    int subject = -1;
};

/// Holds the nodes of one recorded function.
class Recorder {
public:
    /// A function of the user's being kept whole, or the model of one smooth mode.
    enum class Purpose { function, model };

    explicit Recorder(Purpose purpose = Purpose::model) : purpose_(purpose) {}
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    Purpose purpose() const { return purpose_; }

    /// A model whose choices follow from a state: the numbers of time, inputs and parameters from here on. Choices in
    /// `forced`, by id, are made so whatever the state; those on the surfaces in `sides` are on that side, +1 or -1.
    void follow(double t, std::span<const double> inputs, std::span<const double> parameters,
                std::map<std::uint64_t, long> forced = {}, std::map<std::uint64_t, long> sides = {});

    /// The number a node stands for in the state that is followed; not a number where cases are kept, or before a call.
    double value(std::int32_t index) const { return values_[at(index)]; }

    /// From here on, what lies on a surface is blended with this weight instead of distinguished.
    void blend(std::uint64_t surface, const Expression& weight) { blends_[surface].weight = weight; }
    const std::map<std::uint64_t, Blend>& blends() const { return blends_; }
    /// The weight of the side where x > 0, if what x distinguishes is blended.
    std::optional<Expression> weight(const Expression& x, const std::string& name);

    Expression input(int index) { return {this, intern({Operation::input, index})}; }
    Expression time() { return {this, intern({Operation::time})}; }
    Expression parameter(int index);
    /// The body that what is recorded from now on belongs to.
    void set_subject(int body) { subject_ = body; }

    /// A parameter that nothing else uses.
    int new_parameter() { return parameters_++; }

    Expression constant(double value) { return {this, intern({Operation::constant, -1, -1, -1, -1, value})}; }

    /// What a node stands for, whatever its index: the same in every recording that writes it so.
    std::uint64_t identity(std::int32_t index);

    const Node& node(std::int32_t index) const { return nodes_[static_cast<std::size_t>(index)]; }
    std::int32_t size() const { return static_cast<std::int32_t>(nodes_.size()); }
    int parameters() const { return parameters_; }

    /// The node of an expression, constants included.
    std::int32_t node_of(const Expression& x);

    Expression record(Operation operation, std::int32_t a, std::int32_t b = -1, double value = 0.0);
    /// A node as another recording has it.
    Expression record(const Node& node) { return {this, intern(node)}; }

    /// The sign of x, locked in a model: a parameter, +1 or -1, chosen by whoever runs the program; zeros of x are
    /// switches.
    Expression sign(const Expression& x, const std::string& name, int tag = -1);
    /// sqrt(x^2 + y^2 + z^2), smooth up to and beyond a zero; zeros are switches. One component alone: sign(x) x.
    Expression norm(const Expression& x, const Expression& y, const Expression& z, const std::string& name,
                    int tag = -1);
    /// Whether x > 0 (1) or not (0), in a model that follows a state.
    long side(const Expression& x, const std::string& name);
    /// The whole number below x, kept within [lowest, highest], in a model that follows a state.
    long whole(const Expression& x, long lowest, long highest, const std::string& name);
    /// Whether the mode that is recorded keeps a node from being negative: |y|, or what a choice between formulas says.
    bool is_locked_positive(std::int32_t index) const;
    /// a / b in a model, if b is x times a sign or a constant and x is a factor of a: x / |x| is no quotient of two
    /// zeros where x is zero.
    std::optional<Expression> over_multiple(const Expression& a, const Expression& b);
    /// What a function of the user's that is called back gives for these arguments.
    std::vector<Expression> call(const std::shared_ptr<const Callback>& function,
                                 std::span<const Expression> arguments);
    /// A number of the user's.
    Expression cell(const Parameter& parameter);
    const std::vector<Parameter>& cells() const { return cells_; }

    /// A name kept with nodes of a function.
    std::int32_t name_index(const std::string& name);
    const std::vector<std::string>& names() const { return names_; }

    struct Call {
        std::shared_ptr<const Callback> function;
        std::vector<std::int32_t> arguments;
    };
    const std::vector<Call>& calls() const { return calls_; }
    /// The parameters that numbers of the user's are: of each the number, by its node among those, and the index.
    const std::vector<std::pair<std::int32_t, int>>& numbers() const { return numbers_; }
    const std::vector<Switch>& switches() const { return switches_; }
    const std::vector<Branch>& branches() const { return branches_; }

private:
    /// Where to begin to look for a node among 2^bits places.
    static std::size_t place_of(const Node& n, int bits);
    std::int32_t intern(const Node& node);
    /// The place in the index that holds a node, or where it goes.
    std::size_t free_place(const Node& node) const;
    static std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

    /// Numbers of the user's are parameters.
    std::int32_t node_of_number(const Expression& x);
    /// Whether a node is a number of the user's: the node among those; -1: no.
    std::int32_t number_of(const Node& n) const;

    /// The number a new node stands for in the state that is followed.
    double value_of(const Node& n) const;
    /// The number a node stands for, what is called back included.
    double followed(std::int32_t index);
    /// The node whose zeros are those of another, which is a multiple of it, and the sign of the factor.
    std::pair<std::int32_t, int> surface(std::int32_t index) const;
    long choose(Branch branch, long by_state);
    void add(const Switch& one);
    /// The switch that a parameter is the sign or the start flag of; none: null.
    const Switch* switch_of(std::int32_t parameter) const;
    /// A product without one of its factors; none if it has no such factor.
    std::optional<Expression> without(std::int32_t product, std::int32_t factor);

    Purpose purpose_;
    std::vector<Node> nodes_;
    std::vector<std::uint64_t> identities_;
    std::vector<std::int32_t> index_;  // nodes by what they are: 2^bits places, at least half of them empty (-1)
    int bits_ = 0;
    std::vector<Switch> switches_;
    std::vector<std::int32_t> switch_of_parameter_;              // -1: none
    std::map<std::array<std::int32_t, 3>, std::int32_t> norms_;  // by what they are of
    std::map<std::int32_t, int> sign_of_node_;                   // its switch
    std::vector<Branch> branches_;
    std::vector<Call> calls_;
    std::vector<Parameter> cells_;
    std::vector<std::pair<std::int32_t, int>> numbers_;
    std::vector<std::string> names_;
    int parameters_ = 0;
    int subject_ = -1;

    // the state a model follows
    bool follows_ = false;
    double time_ = 0.0;
    std::vector<double> inputs_, parameter_values_, values_;
    std::vector<std::vector<double>> results_;  // of calls
    std::map<std::uint64_t, long> forced_;
    std::map<std::uint64_t, long> sides_;
    std::map<std::uint64_t, Blend> blends_;
};

}  // namespace rbdyn::inline RBDYN_FORM
