// Definitions of rbdyn/expression/numbers.hpp.
#pragma once

#include "rbdyn/expression/numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void GivenNumbers::add(const Parameter& cell, double value) {
    for (const Parameter& known : cells)
        if (known.is(cell)) return;
    cells.push_back(cell);
    values.push_back(value);
}

RBDYN_INLINE Numbers::Numbers(const GivenNumbers& given) : given_(given.values) {
    for (const Parameter& cell : given.cells) tape_.cell(cell);
    extend(values_, given_);
}

RBDYN_INLINE Numbers*& Numbers::active() {
    static thread_local Numbers* numbers = nullptr;
    return numbers;
}

RBDYN_INLINE Expression Numbers::number(const Parameter& cell, double value) {
    for (const Parameter& known : tape_.cells())
        if (known.is(cell)) return at_node(tape_.cell(cell).node());
    return value;
}

RBDYN_INLINE Expression Numbers::record(Operation operation, const Expression& a, const Expression& b) {
    return record(operation, a, 0.0, node_of(b));
}

RBDYN_INLINE bool Numbers::holds(std::span<const double> given) const {
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

RBDYN_INLINE void Numbers::set(std::span<const std::pair<std::int32_t, int>> nodes, std::span<const double> given,
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

RBDYN_INLINE Expression Numbers::record(Operation operation, const Expression& a, double exponent,
                                        std::optional<std::int32_t> b) {
    std::int32_t first = node_of(a), second = b.value_or(-1);
    if ((operation == Operation::add || operation == Operation::multiply) && second < first) std::swap(first, second);
    return at_node(tape_.record(operation, first, second, exponent).node());
}

RBDYN_INLINE Expression Numbers::at_node(std::int32_t node) {
    extend(values_, given_);
    const Constant& v = values_[at(node)];
    return v.number.hi == 0.0 ? Expression(0.0) : Expression::number(node, v);
}

RBDYN_INLINE void Numbers::keep(std::int32_t node, Kept what) {
    extend(values_, given_);
    kept_.resize(values_.size(), Kept::zero);
    kept_[at(node)] = std::max(kept_[at(node)], what);
}

RBDYN_INLINE void Numbers::extend(std::vector<Constant>& values, std::span<const double> given) const {
    values.reserve(at(tape_.size()));
    for (auto n = static_cast<std::int32_t>(values.size()); n < tape_.size(); ++n)
        values.push_back(value_of(tape_.node(n), values, given));
}

RBDYN_INLINE Constant Numbers::value_of(const Node& n, const std::vector<Constant>& values,
                                        std::span<const double> given) {
    using std::asinh, std::atan2, std::atanh, std::cos, std::cosh, std::exp, std::expm1, std::log, std::log1p, std::pow,
        std::sin, std::sinh, std::sqrt, std::tanh;
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
        case Operation::expm1: return of_one([](const auto& x) { return expm1(x); });
        case Operation::log1p: return of_one([](const auto& x) { return log1p(x); });
        case Operation::arsinh: return of_one([](const auto& x) { return asinh(x); });
        case Operation::artanh: return of_one([](const auto& x) { return atanh(x); });
        case Operation::raise: return of_two([](const auto& x, const auto& y) { return pow(x, y); });
        case Operation::power: return of_one([&](const auto& x) { return pow(x, n.value); });
        case Operation::angle: return of_two([](const auto& y, const auto& x) { return atan2(y, x); });
        default: throw Error("an operation that numbers of the user's are not folded by");
    }
}

RBDYN_INLINE double Expression::value() const {
    if (is_number()) Numbers::active()->keep_value(node_);
    return value_;
}

RBDYN_INLINE bool Expression::is_positive() const {
    if (is_number()) Numbers::active()->keep_sign(node_);
    return value_ > 0.0;
}

RBDYN_INLINE bool Expression::is_negative() const {
    if (is_number()) Numbers::active()->keep_sign(node_);
    return value_ < 0.0;
}

}  // namespace rbdyn::inline RBDYN_FORM
