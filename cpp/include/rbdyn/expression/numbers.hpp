// Numbers of the user's in equations that are recorded while they have certain values.
//
// While equations are recorded, a number of the user's (Parameter) is a constant that knows where it comes from. What
// is folded with it is recorded here, too, and is such a constant itself; a program takes it as a parameter. So
// equations hold for other values as well, as long as what was decided by them stays so: what was zero stays zero and
// nothing else becomes zero, what was chosen by a sign keeps the sign, and what went into the equations as a double
// keeps its value. What is made of them has 32 digits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The numbers of the user's that something depends on, and what they are.
struct GivenNumbers {
    std::vector<Parameter> cells;
    std::vector<double> values;

    /// Adds one, unless it is there.
    void add(const Parameter& cell, double value);
};

/// Where equations take numbers of the user's from while they are recorded, and what was decided by them.
class Numbers {
public:
    explicit Numbers(const GivenNumbers& given);
    Numbers(const Numbers&) = delete;
    Numbers& operator=(const Numbers&) = delete;

    /// Those that what is being recorded in this thread takes its numbers from; none: they are plain constants.
    static Numbers*& active();
    /// Makes them the active ones for as long as this lives.
    class Active {
    public:
        explicit Active(Numbers* numbers) : before_(active()) { active() = numbers; }
        ~Active() { active() = before_; }
        Active(const Active&) = delete;
        Active& operator=(const Active&) = delete;

    private:
        Numbers* before_;
    };

    /// One of the user's, which has a value where it is none of the given ones.
    Expression number(const Parameter& cell, double value);
    /// What an operation makes of constants, some of them numbers.
    Expression record(Operation operation, const Expression& a) { return record(operation, a, 0.0, {}); }
    Expression record(Operation operation, const Expression& a, const Expression& b);
    Expression power(const Expression& a, double exponent) { return record(Operation::power, a, exponent, {}); }

    /// That something depends on the sign of a node, or on its value.
    void keep_sign(std::int32_t node) { keep(node, Kept::sign); }
    void keep_value(std::int32_t node) { keep(node, Kept::value); }
    /// That something depends on what was decided elsewhere.
    void keep(std::shared_ptr<const Numbers> others) { others_.push_back(std::move(others)); }

    /// The same for the same formula in all such numbers with the same given ones.
    std::uint64_t identity(std::int32_t node) { return tape_.identity(node); }

    /// Whether all that was decided stays so for other values of the given numbers.
    bool holds(std::span<const double> given) const;
    /// The parameters that nodes are, from the given numbers: of each the node and the index. What they are short of
    /// 32 digits follows them (program.hpp), if they are short of any.
    void set(std::span<const std::pair<std::int32_t, int>> nodes, std::span<const double> given,
             std::vector<double>& parameters) const;

private:
    enum class Kept : std::uint8_t { zero, sign, value };

    static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

    Expression record(Operation operation, const Expression& a, double exponent, std::optional<std::int32_t> b);
    /// Constants of the tape are constants, its own numbers are where they are.
    std::int32_t node_of(const Expression& x) { return x.is_number() ? x.node() : tape_.node_of(x); }
    /// A zero is a constant: that it is one is kept.
    Expression at_node(std::int32_t node);
    void keep(std::int32_t node, Kept what);

    /// The values of all nodes, where they are not yet there.
    void extend(std::vector<Constant>& values, std::span<const double> given) const;
    static Constant value_of(const Node& n, const std::vector<Constant>& values, std::span<const double> given);

    Recorder tape_{Recorder::Purpose::function};
    std::vector<double> given_;
    std::vector<Constant> values_;  // of the nodes, with the given numbers
    std::vector<Kept> kept_;
    std::vector<std::shared_ptr<const Numbers>> others_;
};

}  // namespace rbdyn::inline RBDYN_FORM
