// Numbers of the user's in equations that are recorded while they have certain values.
//
// While equations are recorded, a number of the user's (Parameter) is a constant that knows where it comes from. What
// is folded with it is recorded here, too, and is such a constant itself; a program takes it as a parameter. So
// equations hold for other values as well, as long as what was decided by them stays so: what was zero stays zero and
// nothing else becomes zero, what was chosen by a sign keeps the sign, and what went into the equations as a double
// keeps its value. What is made of them has 32 digits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/recorder.hpp"

namespace rbdyn {

/// The numbers of the user's that something depends on, and what they are.
struct GivenNumbers {
    std::vector<Parameter> cells;
    std::vector<double> values;

    /// Adds one, unless it is there.
    void add(const Parameter& cell, double value) {
        for (const Parameter& known : cells)
            if (known.is(cell)) return;
        cells.push_back(cell);
        values.push_back(value);
    }
};

/// Where equations take numbers of the user's from while they are recorded, and what was decided by them.
class Numbers {
public:
    explicit Numbers(const GivenNumbers& given) : given_(given.values) {
        for (const Parameter& cell : given.cells) tape_.cell(cell);
        extend(values_, given_);
    }
    Numbers(const Numbers&) = delete;
    Numbers& operator=(const Numbers&) = delete;

    /// Those that what is being recorded in this thread takes its numbers from; none: they are plain constants.
    static Numbers*& active() {
        static thread_local Numbers* numbers = nullptr;
        return numbers;
    }
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
    Expression number(const Parameter& cell, double value) {
        for (const Parameter& known : tape_.cells())
            if (known.is(cell)) return at_node(tape_.cell(cell).node());
        return value;
    }
    /// What an operation makes of constants, some of them numbers.
    Expression record(Operation operation, const Expression& a) { return record(operation, a, 0.0, {}); }
    Expression record(Operation operation, const Expression& a, const Expression& b) {
        return record(operation, a, 0.0, node_of(b));
    }
    Expression power(const Expression& a, double exponent) { return record(Operation::power, a, exponent, {}); }

    /// That something depends on the sign of a node, or on its value.
    void keep_sign(std::int32_t node) { keep(node, Kept::sign); }
    void keep_value(std::int32_t node) { keep(node, Kept::value); }
    /// That something depends on what was decided elsewhere.
    void keep(std::shared_ptr<const Numbers> others) { others_.push_back(std::move(others)); }

    /// The same for the same formula in all such numbers with the same given ones.
    std::uint64_t identity(std::int32_t node) { return tape_.identity(node); }

    /// Whether all that was decided stays so for other values of the given numbers.
    bool holds(std::span<const double> given) const {
        if (!std::equal(given.begin(), given.end(), given_.begin(), given_.end())) {
            std::vector<Constant> values;
            extend(values, given);
            for (std::size_t n = 0; n < values.size(); ++n) {
                const double before = values_[n].number.hi, now = values[n].number.hi;
                if ((before == 0.0) != (now == 0.0)) return false;
                const Kept kept = n < kept_.size() ? kept_[n] : Kept::zero;
                if (kept == Kept::sign && (before < 0.0) != (now < 0.0)) return false;
                if (kept == Kept::value && before != now) return false;
            }
        }
        for (const auto& others : others_)
            if (!others->holds(given)) return false;
        return true;
    }
    /// The parameters that nodes are, from the given numbers: of each the node and the index. What they are short of
    /// 32 digits follows them (program.hpp), if they are short of any.
    void set(std::span<const std::pair<std::int32_t, int>> nodes, std::span<const double> given,
             std::vector<double>& parameters) const {
        std::vector<Constant> values;
        extend(values, given);
        const std::size_t count = parameters.size();
        for (const auto& [node, index] : nodes) {
            const DoubleDouble& value = values[static_cast<std::size_t>(node)].number;
            parameters[static_cast<std::size_t>(index)] = value.hi;
            if (value.lo == 0.0) continue;
            parameters.resize(2 * count, 0.0);
            parameters[count + static_cast<std::size_t>(index)] = value.lo;
        }
    }

private:
    enum class Kept : std::uint8_t { zero, sign, value };

    static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

    Expression record(Operation operation, const Expression& a, double exponent, std::optional<std::int32_t> b) {
        std::int32_t first = node_of(a), second = b.value_or(-1);
        if ((operation == Operation::add || operation == Operation::multiply) && second < first)
            std::swap(first, second);
        return at_node(tape_.record(operation, first, second, exponent).node());
    }
    /// Constants of the tape are constants, its own numbers are where they are.
    std::int32_t node_of(const Expression& x) { return x.is_number() ? x.node() : tape_.node_of(x); }
    /// A zero is a constant: that it is one is kept.
    Expression at_node(std::int32_t node) {
        extend(values_, given_);
        const Constant& v = values_[at(node)];
        return v.number.hi == 0.0 ? Expression(0.0) : Expression::number(node, v);
    }
    void keep(std::int32_t node, Kept what) {
        extend(values_, given_);
        kept_.resize(values_.size(), Kept::zero);
        kept_[at(node)] = std::max(kept_[at(node)], what);
    }

    /// The values of all nodes, where they are not yet there.
    void extend(std::vector<Constant>& values, std::span<const double> given) const {
        values.reserve(at(tape_.size()));
        for (auto n = static_cast<std::int32_t>(values.size()); n < tape_.size(); ++n)
            values.push_back(value_of(tape_.node(n), values, given));
    }
    static Constant value_of(const Node& n, const std::vector<Constant>& values, std::span<const double> given) {
        using std::atan2, std::cos, std::cosh, std::exp, std::log, std::pow, std::sin, std::sinh, std::sqrt, std::tanh;
        const auto of_two = [&](auto f) { return folded(values[at(n.a)], values[at(n.b)], f); };
        const auto of_one = [&](auto f) { return folded(values[at(n.a)], f); };
        switch (n.operation) {
            case Operation::constant: return {{n.value, n.rest}, n.is_wide};
            case Operation::cell: return {given[at(n.a)], true};
            case Operation::add: return of_two([](const auto& x, const auto& y) { return x + y; });
            case Operation::multiply: return of_two([](const auto& x, const auto& y) { return x * y; });
            case Operation::divide: return of_two([](const auto& x, const auto& y) { return x / y; });
            case Operation::square_root: return of_one([](const auto& x) { return sqrt(x); });
            case Operation::sine: return of_one([](const auto& x) { return sin(x); });
            case Operation::cosine: return of_one([](const auto& x) { return cos(x); });
            case Operation::hyperbolic_sine: return of_one([](const auto& x) { return sinh(x); });
            case Operation::hyperbolic_cosine: return of_one([](const auto& x) { return cosh(x); });
            case Operation::hyperbolic_tangent: return of_one([](const auto& x) { return tanh(x); });
            case Operation::exponential: return of_one([](const auto& x) { return exp(x); });
            case Operation::logarithm: return of_one([](const auto& x) { return log(x); });
            case Operation::power: return of_one([&](const auto& x) { return pow(x, n.value); });
            case Operation::angle: return of_two([](const auto& y, const auto& x) { return atan2(y, x); });
            default: throw Error("an operation that numbers of the user's are not folded by");
        }
    }

    Recorder tape_{Recorder::Purpose::function};
    std::vector<double> given_;
    std::vector<Constant> values_;  // of the nodes, with the given numbers
    std::vector<Kept> kept_;
    std::vector<std::shared_ptr<const Numbers>> others_;
};

inline double Expression::value() const {
    if (is_number()) Numbers::active()->keep_value(node_);
    return value_;
}
inline bool Expression::is_positive() const {
    if (is_number()) Numbers::active()->keep_sign(node_);
    return value_ > 0.0;
}
inline bool Expression::is_negative() const {
    if (is_number()) Numbers::active()->keep_sign(node_);
    return value_ < 0.0;
}

}  // namespace rbdyn
