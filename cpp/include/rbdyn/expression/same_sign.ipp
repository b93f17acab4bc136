// Definitions of rbdyn/expression/same_sign.hpp.
#pragma once

#include "rbdyn/expression/same_sign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/recording.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace same_sign {

inline bool is_same(const Expression& a, const Expression& b) {
    if (a.is_constant() || b.is_constant()) return a.is_constant() && b.is_constant() && a.value() == b.value();
    return a.node() == b.node();
}

inline Product of_constant(int sign) {
    Product result;
    result.sign = sign;
    return result;
}

RBDYN_INLINE bool Product::never_negative() const {
    return sign >= 0 &&
           std::ranges::all_of(factors, [](const Factor& f) { return f.count % 2 == 0 || f.never_negative; });
}

RBDYN_INLINE bool Product::never_zero() const {
    return sign != 0 && std::ranges::all_of(factors, [](const Factor& f) { return f.never_zero; });
}

RBDYN_INLINE void Product::multiply(const Product& other) {
    sign *= other.sign;
    is_simpler = is_simpler || other.is_simpler;
    is_number = is_number && other.is_number;
    has_poles = has_poles || other.has_poles;
    for (const Factor& f : other.factors) {
        const auto known = std::ranges::find_if(factors, [&](const Factor& g) { return is_same(g.base, f.base); });
        known != factors.end() ? void(known->count += f.count) : factors.push_back(f);
    }
    if (sign == 0) factors.clear();
}

RBDYN_INLINE bool Product::has_bases_of(const Product& other) const {
    return std::ranges::all_of(other.factors, [&](const Factor& f) {
        return std::ranges::any_of(factors, [&](const Factor& g) { return is_same(g.base, f.base); });
    });
}

RBDYN_INLINE void Product::reduce() {
    for (Factor& f : factors) {
        const int least = f.never_negative || f.count % 2 == 1 ? 1 : 2;
        is_simpler = is_simpler || f.count > least;
        f.count = least;
    }
}

RBDYN_INLINE Expression Product::expression() const {
    Expression result = 1.0;
    for (const Expression& factor : apart()) result *= factor;
    return result;
}

RBDYN_INLINE std::vector<Expression> Product::apart() const {
    if (factors.empty()) return {static_cast<double>(sign)};
    std::vector<Expression> result;
    for (const Factor& f : factors) {
        result.push_back(f.base);
        for (int k = 1; k < f.count; ++k) result.back() *= f.base;
    }
    if (sign < 0) result[0] = -result[0];
    return result;
}

RBDYN_INLINE Writer::Writer(const Function& function, std::span<const Expression> x) : function_(function) {
    for (std::int32_t n = 0; n < function.size(); ++n) {
        const Node& node = function.node(n);
        const auto operands = node.operands();
        conditions_.push_back(std::ranges::any_of(
            operands, [&](std::int32_t operand) { return operand >= 0 && conditions_[at(operand)] != 0; }));
        if (node.operation == Operation::select && (product(node.a).is_simpler || extreme(node.a) != 0))
            conditions_.back() = 1;
        copies_.push_back(copied(n, x));
        products_.push_back(found(n));
        products_.back().reduce();
        const auto [low, high] = bounds(n);
        products_.back().low = products_.back().never_negative() ? std::max(low, 0.0) : low;
        products_.back().high = high;
        // a product of this many is no one's writing
        constexpr std::size_t many = 64;
        if (products_.back().factors.size() > many) products_.back() = of_base(n);
    }
}

RBDYN_INLINE Expression Writer::result(std::int32_t node) const {
    const Product& p = product(node);
    return p.is_simpler ? p.expression() : copies_[at(node)];
}

RBDYN_INLINE Expression Writer::copied(std::int32_t n, std::span<const Expression> x) const {
    const Node& node = function_.node(n);
    if (node.operation == Operation::select) return chosen(node.a, copies_[at(node.b)], copies_[at(node.c)], node.d);
    return function_.again(n, x, copies_);
}

RBDYN_INLINE Product Writer::of_base(std::int32_t n, bool never_negative, bool never_zero) const {
    const Expression& base = copies_[at(n)];
    Product result;
    if (base.is_constant()) {
        const double value = base.value();
        result.sign = value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
        if (!std::isnan(value)) return result;
        result.sign = 1;
        result.is_number = false;
    }
    for (const std::int32_t operand : function_.node(n).operands()) {
        if (operand < 0) continue;
        result.is_number = result.is_number && product(operand).is_number;
        result.has_poles = result.has_poles || product(operand).has_poles;
    }
    result.factors.push_back({base, 1, never_negative, never_zero});
    return result;
}

RBDYN_INLINE std::array<double, 2> Writer::bounds(std::int32_t n) const {
    constexpr double infinity = std::numeric_limits<double>::infinity(), pi = std::numbers::pi;
    const Node& node = function_.node(n);
    const auto of = [&](std::int32_t i) -> const Product& { return product(i); };
    switch (node.operation) {
        case Operation::constant:
            if (std::isnan(node.value)) return {-infinity, infinity};
            return {node.value, node.value};
        case Operation::sine:
        case Operation::cosine:
        case Operation::hyperbolic_tangent:
        case Operation::sign: return {-1.0, 1.0};
        case Operation::angle: return {-pi, pi};
        case Operation::exponential:
        case Operation::raise: return {0.0, infinity};
        case Operation::expm1: return {-1.0, infinity};
        case Operation::hyperbolic_cosine: return {1.0, infinity};
        case Operation::add: return {of(node.a).low + of(node.b).low, of(node.a).high + of(node.b).high};
        case Operation::select:
            return {std::min(of(node.b).low, of(node.c).low), std::max(of(node.b).high, of(node.c).high)};
        case Operation::multiply: {
            std::array<double, 2> result{infinity, -infinity};
            for (const double a : {of(node.a).low, of(node.a).high})
                for (const double b : {of(node.b).low, of(node.b).high}) {
                    const double ends = a == 0.0 || b == 0.0 ? 0.0 : a * b;
                    result = {std::min(result[0], ends), std::max(result[1], ends)};
                }
            return result;
        }
        default: return {-infinity, infinity};
    }
}

RBDYN_INLINE Product Writer::found(std::int32_t n) const {
    const Node& node = function_.node(n);
    const auto like = [&](std::int32_t operand) {
        Product result = product(operand);
        result.is_simpler = true;
        return result;
    };
    // may be left out
    const auto positive = [&](Product of_all) {
        if (!of_all.is_finite()) return of_all;
        of_all.factors.clear();
        of_all.is_simpler = true;
        return of_all;
    };
    // where they are bounded, a pole is a jump
    const auto odd = [&](std::int32_t operand) { return product(operand).has_poles ? of_base(n) : like(operand); };
    switch (node.operation) {
        case Operation::hyperbolic_sine:
        case Operation::arsinh: return like(node.a);
        case Operation::expm1:
        case Operation::hyperbolic_tangent: return odd(node.a);
        case Operation::log1p:
        case Operation::artanh: {
            const Product& argument = product(node.a);
            const bool has_end = node.operation == Operation::artanh;
            if (argument.low > -1.0 && !(has_end && argument.high >= 1.0)) return like(node.a);
            // the function ends there, or has a pole where that is but touched
            Product result = of_base(n);
            result.is_number = false;
            result.has_poles = result.has_poles || (argument.low >= -1.0 && !(has_end && argument.high > 1.0));
            return result;
        }
        case Operation::hyperbolic_cosine:
        case Operation::exponential: return positive(of_base(n, true, true));
        case Operation::raise: {
            const Product& base = product(node.a);
            const bool is_safe = base.is_positive() && base.is_finite();
            Product result = of_base(n, true, true);
            result.is_number = result.is_number && is_safe;
            result.has_poles = result.has_poles || (!is_safe && base.never_negative());
            return positive(result);
        }
        case Operation::sign: return of_base(n, false, true);
        case Operation::multiply: return of_multiply(n);
        case Operation::divide: return of_quotient(n);
        case Operation::square_root: {
            if (product(node.a).never_negative()) return like(node.a);
            Product result = of_base(n, true);
            result.is_number = false;
            return result;
        }
        case Operation::angle: {
            if (product(node.b).is_positive() && product(node.b).is_finite()) return odd(node.a);
            Product result = of_base(n);
            result.is_number = false;
            return result;
        }
        case Operation::add: {
            Product result = of_sum(n);
            return result.is_positive() ? positive(result) : result;
        }
        case Operation::norm: return of_norm(node);
        case Operation::logarithm: return of_logarithm(n);
        case Operation::power: return of_power(n);
        case Operation::select: {
            Product result = of_select(n);
            return result.is_positive() ? positive(result) : result;
        }
        default: return of_base(n);
    }
}

RBDYN_INLINE Product Writer::of_quotient(std::int32_t n) const {
    const Node& node = function_.node(n);
    const Product &above = product(node.a), &under = product(node.b);
    if (under.is_finite() && under.never_zero()) {
        Product result = above;
        result.multiply(under);
        return result;
    }
    Product result = of_base(n, above.never_negative() && under.never_negative());
    result.has_poles = true;
    return result;
}

RBDYN_INLINE Product Writer::of_multiply(std::int32_t n) const {
    const Node& node = function_.node(n);
    // a sign beside what it is the sign of
    for (const auto& [a, b] : {std::pair(node.a, node.b), std::pair(node.b, node.a)}) {
        if (function_.node(a).operation != Operation::sign) continue;
        const Product& argument = product(function_.node(a).a);
        if (argument.sign == 0 || !product(b).has_bases_of(argument)) continue;
        Product result = product(b);
        result.multiply(argument);
        result.is_simpler = true;
        return result;
    }
    Product result = product(node.a);
    result.multiply(product(node.b));
    // what is zero of second order, beside a pole, may be a root there, and no zero
    const bool may_cancel = result.has_poles && std::ranges::any_of(result.factors, [](const Factor& f) {
                                return !f.never_zero && (f.never_negative || f.count % 2 == 0);
                            });
    if (!may_cancel || result.never_negative()) return result;
    return of_base(n);
}

RBDYN_INLINE Product Writer::of_sum(std::int32_t n) const {
    const Node& node = function_.node(n);
    const Product &a = product(node.a), &b = product(node.b);
    // not by so little that rounding could be more
    constexpr double little = 1e-9;
    if (const auto [low, high] = bounds(n); low > little || high < -little) {
        Product result = of_base(n, low > 0.0, true);
        if (high < 0.0 && result.is_finite()) {
            result = of_constant(-1);
            result.is_simpler = true;
        }
        return result;
    }
    if (!a.never_negative() || !b.never_negative()) return of_base(n);
    const bool never_zero = a.never_zero() || b.never_zero();
    Product result = of_base(n, true, never_zero);
    if (result.factors.empty() || (!a.is_simpler && !b.is_simpler)) return result;
    result.factors[0].base = a.expression() + b.expression();
    result.is_simpler = true;
    return result;
}

RBDYN_INLINE Product Writer::of_norm(const Node& node) const {
    Product result;
    Expression sum = 0.0;
    bool never_zero = false;
    for (const std::int32_t i : {node.a, node.b, node.c}) {
        sum += copies_[at(i)] * copies_[at(i)];
        never_zero = never_zero || product(i).never_zero();
        result.is_number = result.is_number && product(i).is_number;
        result.has_poles = result.has_poles || product(i).has_poles;
    }
    result.is_simpler = true;
    if (sum.is_constant())
        result.sign = sum.value() > 0.0 ? 1 : 0;
    else if (!(never_zero && result.is_finite()))
        result.factors.push_back({sum, 1, true, never_zero});
    return result;
}

RBDYN_INLINE Product Writer::of_logarithm(std::int32_t n) const {
    const Node& node = function_.node(n);
    Product result = of_base(n);
    const bool is_safe = product(node.a).is_positive() && product(node.a).is_finite();
    result.is_number = result.is_number && is_safe;
    // of what is zero and not negative on both sides; else the function ends there
    result.has_poles = result.has_poles || (!is_safe && product(node.a).never_negative());
    const auto squared = product(node.a).never_negative() ? square(node.a) : std::nullopt;
    if (!squared || result.factors.empty()) return result;
    // positive where its argument is more than one
    result.factors[0].base = *squared - 1.0;
    result.is_simpler = true;
    return result;
}

RBDYN_INLINE std::optional<Expression> Writer::square(std::int32_t n) const {
    const Node& node = function_.node(n);
    const auto& x = copies_;
    switch (node.operation) {
        case Operation::square_root: return x[at(node.a)];
        case Operation::norm:
            return x[at(node.a)] * x[at(node.a)] + x[at(node.b)] * x[at(node.b)] + x[at(node.c)] * x[at(node.c)];
        case Operation::multiply:
            for (const auto& [a, b] : {std::pair(node.a, node.b), std::pair(node.b, node.a)})
                if (function_.node(a).operation == Operation::sign) return x[at(b)] * x[at(b)];
            return std::nullopt;
        default: return std::nullopt;
    }
}

RBDYN_INLINE Product Writer::of_power(std::int32_t n) const {
    const Node& node = function_.node(n);
    const double exponent = node.value;
    const Product& base = product(node.a);
    const bool is_odd = std::fmod(exponent, 2.0) != 0.0, is_whole = exponent == std::floor(exponent);
    const bool is_known = base.never_negative() || is_whole;
    if (is_known && (exponent > 0.0 || (base.is_finite() && base.never_zero()))) {
        Product result = base;
        if (is_whole && !is_odd) result.multiply(base);
        result.is_simpler = true;
        return result;
    }
    Product result = of_base(n, !is_whole || !is_odd);
    result.is_number = result.is_number && is_known;
    result.has_poles = result.has_poles || exponent < 0.0;
    return result;
}

RBDYN_INLINE Product Writer::of_select(std::int32_t n) const {
    const Node& node = function_.node(n);
    const Product &b = product(node.b), &c = product(node.c);
    // 1 where it is positive, -1 where it is negative, 0 where it is zero
    if (const Node& inner = function_.node(node.c);
        inner.operation == Operation::select && b.is_positive() && b.factors.empty() && product(inner.c).sign == 0) {
        const Product& below = product(inner.b);
        if (below.sign < 0 && below.factors.empty() && is_same(copies_[at(inner.a)], -copies_[at(node.a)])) {
            Product result = product(node.a);
            result.is_simpler = true;
            return result;
        }
    }
    const bool never_negative = b.never_negative() && c.never_negative();
    Product result = of_base(n, never_negative, b.never_zero() && c.never_zero());
    if (result.factors.empty() || (!b.is_simpler && !c.is_simpler)) return result;
    const Expression base = chosen(node.a, this->result(node.b), this->result(node.c), node.d);
    if (base.is_constant()) return of_constant(base.value() > 0.0 ? 1 : base.value() < 0.0 ? -1 : 0);
    result.factors[0].base = base;
    result.is_simpler = true;
    return result;
}

RBDYN_INLINE int Writer::extreme(std::int32_t n) const {
    const Node& select = function_.node(n);
    if (select.operation != Operation::select) return 0;
    const Expression &margin = copies_[at(select.a)], &first = copies_[at(select.b)], &other = copies_[at(select.c)];
    return is_same(margin, first - other) ? 1 : is_same(margin, other - first) ? -1 : 0;
}

RBDYN_INLINE Expression Writer::chosen(std::int32_t condition, const Expression& b, const Expression& c,
                                       std::int32_t name, int depth) const {
    constexpr int deepest = 8;
    const Node& node = function_.node(condition);
    const int side = depth < deepest ? extreme(condition) : 0;
    if (side == 0)
        return select(
            result(condition), [&] { return b; }, [&] { return c; }, function_.names()[at(name)]);
    // the larger is positive where either is, the smaller where both are
    const Expression inner = chosen(node.c, b, c, name, depth + 1);
    return side > 0 ? chosen(node.b, b, inner, name, depth + 1) : chosen(node.b, inner, c, name, depth + 1);
}

}  // namespace same_sign

RBDYN_INLINE SignFactors sign_factors(const Function& function) {
    const auto may_change = [](Operation operation) {
        return operation >= Operation::square_root && operation != Operation::sine && operation != Operation::cosine &&
               operation != Operation::call && operation != Operation::whole;
    };
    const std::int32_t result = function.output_nodes()[0];
    const Operation last = function.node(result).operation;
    bool changes = last == Operation::multiply || last == Operation::divide;
    for (std::int32_t n = 0; n < function.size() && !changes; ++n) changes = may_change(function.node(n).operation);
    if (!changes) return {function, true};
    bool is_itself = false;
    Function factors = Function::record(function.inputs(), [&](const std::vector<Expression>& x) {
        for (const Parameter& p : function.parameters()) recording::active()->cell(p);
        const same_sign::Writer writer(function, x);
        const same_sign::Product& product = writer.product(result);
        // what is never negative passes nothing
        if (product.never_negative() && product.is_number) return std::vector<Expression>{1.0};
        std::vector<Expression> results = product.apart();
        is_itself = results.size() == 1 && !writer.is_simpler(result);
        return results;
    });
    if (is_itself) return {function, true};
    factors = factors.trimmed();
    factors.values_ = function.values_;
    return {std::move(factors), false};
}

}  // namespace rbdyn::inline RBDYN_FORM
