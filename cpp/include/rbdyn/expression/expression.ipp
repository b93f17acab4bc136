// Definitions of rbdyn/expression/expression.hpp.
#pragma once

#include "rbdyn/expression/expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM::recording {

RBDYN_INLINE Recorder* common(const Expression& a, const Expression& b) {
    Recorder* recorder = a.is_constant() ? b.recorder() : a.recorder();
    if (!a.is_constant() && !b.is_constant() && a.recorder() != b.recorder())
        throw Error("an expression of one recorded function was used in another");
    return recorder;
}

RBDYN_INLINE Expression as_expression(const Constant& c, bool from_doubles) {
    return c.is_wide && !(from_doubles && c.number.lo == 0.0) ? Expression(c.number) : Expression(c.number.hi);
}

RBDYN_INLINE Expression angle(const Expression& y, const Expression& x) {
    if (x.is_constant() && y.is_constant())
        return folded(Operation::angle, y, x, [](const auto& a, const auto& b) {
            using std::atan2;
            return atan2(a, b);
        });
    Recorder* r = common(x, y);
    return r->record(Operation::angle, r->node_of(y), r->node_of(x));
}

}  // namespace rbdyn::inline RBDYN_FORM::recording

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Expression operator+(const Expression& a, const Expression& b) {
    if (a.is_constant() && b.is_constant())
        return recording::folded(Operation::add, a, b, [](const auto& x, const auto& y) { return x + y; });
    if (a.is_zero()) return b;
    if (b.is_zero()) return a;
    Recorder* r = recording::common(a, b);
    std::int32_t i = r->node_of(a), j = r->node_of(b);
    return r->record(Operation::add, std::min(i, j), std::max(i, j));
}

RBDYN_INLINE Expression operator*(const Expression& a, const Expression& b) {
    if (a.is_constant() && b.is_constant())
        return recording::folded(Operation::multiply, a, b, [](const auto& x, const auto& y) { return x * y; });
    if (a.is_zero() || b.is_zero()) return 0.0;
    if (a.is_one()) return b;
    if (b.is_one()) return a;
    Recorder* r = recording::common(a, b);
    std::int32_t i = r->node_of(a), j = r->node_of(b);
    return r->record(Operation::multiply, std::min(i, j), std::max(i, j));
}

RBDYN_INLINE Expression operator-(const Expression& a, const Expression& b) {
    if (!a.is_constant() && !b.is_constant() && a.node() == b.node()) return 0.0;
    return a + (-b);
}

RBDYN_INLINE Expression operator/(const Expression& a, const Expression& b) {
    if (a.is_constant() && b.is_constant())
        return recording::folded(Operation::divide, a, b, [](const auto& x, const auto& y) { return x / y; });
    if (a.is_zero()) return 0.0;
    if (b.is_constant()) return a * (Expression(1.0) / b);
    Recorder* r = recording::common(a, b);
    if (const auto rest = r->over_multiple(a, b)) return *rest;
    return r->record(Operation::divide, r->node_of(a), r->node_of(b));
}

RBDYN_INLINE Expression& Expression::operator+=(const Expression& other) { return *this = *this + other; }

RBDYN_INLINE Expression& Expression::operator-=(const Expression& other) { return *this = *this - other; }

RBDYN_INLINE Expression& Expression::operator*=(const Expression& other) { return *this = *this * other; }

RBDYN_INLINE Expression& Expression::operator/=(const Expression& other) { return *this = *this / other; }

RBDYN_INLINE std::uint64_t Recorder::identity(std::int32_t index) {
    // operands come before what uses them
    while (static_cast<std::int32_t>(identities_.size()) <= index) {
        const Node& n = node(static_cast<std::int32_t>(identities_.size()));
        std::uint64_t h = 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(n.operation);
        const auto mix = [&](std::uint64_t x) {
            h = (h ^ (x + 0x9e3779b97f4a7c15u + (h << 6) + (h >> 2))) * 0xff51afd7ed558ccdu;
        };
        const auto operands = n.operands();
        if (n.operation == Operation::add || n.operation == Operation::multiply) {
            // written in any order
            const std::uint64_t x = identities_[at(n.a)], y = identities_[at(n.b)];
            mix(std::min(x, y));
            mix(std::max(x, y));
        } else if (n.operation == Operation::call) {
            mix(static_cast<std::uint64_t>(n.d));
            for (const std::int32_t argument : calls_[at(n.a)].arguments) mix(identities_[at(argument)]);
        } else if (operands[0] < 0) {
            const std::int32_t number = number_of(n);
            if (number < 0) mix(static_cast<std::uint64_t>(n.a + 1));
            // the sign of a switch goes by its argument, a number of the user's by its formula, not by the order of
            // recording
            if (n.operation == Operation::parameter)
                if (const Switch* s = switch_of(n.a)) h = s->id;
            if (number >= 0) h = Numbers::active()->identity(number);
        } else {
            for (const std::int32_t operand : operands)
                if (operand >= 0) mix(identities_[at(operand)]);
        }
        mix(std::hash<double>{}(n.value));
        identities_.push_back(h);
    }
    return identities_[at(index)];
}

RBDYN_INLINE double Recorder::value_of(const Node& n) const {
    const auto value = [&](std::int32_t index) { return values_[at(index)]; };
    switch (n.operation) {
        case Operation::constant: return n.value;
        case Operation::input: return inputs_[at(n.a)];
        case Operation::time: return time_;
        case Operation::parameter: return at(n.a) < parameter_values_.size() ? parameter_values_[at(n.a)] : 0.0;
        case Operation::add: return value(n.a) + value(n.b);
        case Operation::multiply: return value(n.a) * value(n.b);
        case Operation::divide: return value(n.a) / value(n.b);
        case Operation::square_root:
            return is_locked_positive(n.a) ? locked_power(value(n.a), 0.5) : std::sqrt(value(n.a));
        case Operation::norm: return std::hypot(value(n.a), value(n.b), value(n.c));
        case Operation::sine: return std::sin(value(n.a));
        case Operation::cosine: return std::cos(value(n.a));
        case Operation::hyperbolic_sine: return std::sinh(value(n.a));
        case Operation::hyperbolic_cosine: return std::cosh(value(n.a));
        case Operation::hyperbolic_tangent: return std::tanh(value(n.a));
        case Operation::exponential: return std::exp(value(n.a));
        case Operation::logarithm: return std::log(value(n.a));
        case Operation::expm1: return std::expm1(value(n.a));
        case Operation::log1p: return std::log1p(value(n.a));
        case Operation::arsinh: return std::asinh(value(n.a));
        case Operation::artanh: return std::atanh(value(n.a));
        case Operation::raise: return std::pow(value(n.a), value(n.b));
        case Operation::power:
            return is_locked_positive(n.a) ? locked_power(value(n.a), n.value) : std::pow(value(n.a), n.value);
        case Operation::angle: return std::atan2(value(n.a), value(n.b));
        case Operation::call:
            // not before a choice depends on it
            return results_[at(n.a)].empty() ? std::numeric_limits<double>::quiet_NaN() : results_[at(n.a)][at(n.d)];
        default: return std::numeric_limits<double>::quiet_NaN();
    }
}

RBDYN_INLINE double Recorder::followed(std::int32_t index) {
    if (std::isnan(values_[at(index)]))
        for (std::int32_t i = 0; i <= index; ++i) {
            const Node& n = node(i);
            if (n.operation == Operation::call && results_[at(n.a)].empty()) {
                const Call& c = calls_[at(n.a)];
                std::vector<double> x, y(at(c.function->outputs));
                for (const std::int32_t argument : c.arguments) x.push_back(values_[at(argument)]);
                (*c.function)(x.data(), y.data());
                results_[at(n.a)] = std::move(y);
            }
            values_[at(i)] = value_of(n);
        }
    return values_[at(index)];
}

RBDYN_INLINE std::pair<std::int32_t, int> Recorder::surface(std::int32_t index) const {
    int orientation = 1;
    const auto is_fixed = [&](std::int32_t factor) {
        return node(factor).operation == Operation::constant || number_of(node(factor)) >= 0;
    };
    while (node(index).operation == Operation::multiply) {
        const Node& n = node(index);
        const bool first = is_fixed(n.a);
        if (!first && !is_fixed(n.b)) break;
        const Node& factor = node(first ? n.a : n.b);
        const std::int32_t number = number_of(factor);
        if (number >= 0) Numbers::active()->keep_sign(number);
        if ((number >= 0 ? parameter_values_[at(factor.a)] : factor.value) < 0.0) orientation = -orientation;
        index = first ? n.b : n.a;
    }
    return {index, orientation};
}

RBDYN_INLINE std::optional<Expression> Recorder::weight(const Expression& x, const std::string& name) {
    if (blends_.empty() || x.is_constant()) return std::nullopt;
    const auto [argument, orientation] = surface(x.node());
    const auto found = blends_.find(identity(argument));
    if (found == blends_.end()) return std::nullopt;
    Blend& blend = found->second;
    if (blend.argument < 0) {
        blend.argument = argument;
        blend.name = name;
        blend.subject = subject_;
    }
    return orientation > 0 ? blend.weight : 1.0 - blend.weight;
}

RBDYN_INLINE Expression Recorder::sign(const Expression& x, const std::string& name, int tag) {
    if (x.is_constant()) return x.is_negative() ? -1.0 : 1.0;
    if (purpose_ == Purpose::function) return record({Operation::sign, x.node(), -1, -1, name_index(name)});
    if (const auto above = weight(x, name)) return 2.0 * *above - 1.0;
    if (const auto known = sign_of_node_.find(x.node()); known != sign_of_node_.end())
        return parameter(switches_[at(known->second)].parameter);
    const int index = new_parameter();
    if (follows_) {
        parameter_values_.resize(at(index) + 1, 0.0);
        parameter_values_[at(index)] = followed(x.node()) < 0.0 ? -1.0 : 1.0;
    }
    const auto [argument, orientation] = surface(x.node());
    sign_of_node_.emplace(x.node(), static_cast<int>(switches_.size()));
    add({x.node(), index, false, name, tag, subject_, identity(x.node()), identity(argument), orientation});
    return parameter(index);
}

RBDYN_INLINE Expression Recorder::norm(const Expression& x, const Expression& y, const Expression& z,
                                       const std::string& name, int tag) {
    const Expression* part[3] = {&x, &y, &z};
    const Expression* alone = nullptr;
    int present = 0;
    bool constant = true;
    for (const Expression* p : part) {
        if (!p->is_zero()) {
            ++present;
            alone = p;
        }
        constant = constant && p->is_constant();
    }
    if (present == 0) return 0.0;
    if (present == 1) return sign(*alone, name, tag) * *alone;
    if (constant)
        return recording::folded(x * x + y * y + z * z, [](const auto& square) {
            using std::sqrt;
            return sqrt(square);
        });
    Node node{Operation::norm, node_of(x), node_of(y), node_of(z)};
    if (purpose_ == Purpose::function) return record(node);
    const std::array<std::int32_t, 3> key{node.a, node.b, node.c};
    if (const auto known = norms_.find(key); known != norms_.end()) return {this, known->second};
    node.d = new_parameter();
    const Expression result(this, intern(node));
    const std::uint64_t id = identity(result.node());
    norms_.emplace(key, result.node());
    add({result.node(), node.d, true, name, tag, subject_, id, id, 1});
    return result;
}

RBDYN_INLINE void Recorder::add(const Switch& one) {
    if (at(one.parameter) >= switch_of_parameter_.size()) switch_of_parameter_.resize(at(one.parameter) + 1, -1);
    switch_of_parameter_[at(one.parameter)] = static_cast<std::int32_t>(switches_.size());
    switches_.push_back(one);
}

RBDYN_INLINE const Switch* Recorder::switch_of(std::int32_t parameter) const {
    const std::int32_t index = at(parameter) < switch_of_parameter_.size() ? switch_of_parameter_[at(parameter)] : -1;
    return index < 0 ? nullptr : &switches_[at(index)];
}

RBDYN_INLINE bool Recorder::is_locked_positive(std::int32_t index) const {
    if (purpose_ != Purpose::model) return false;
    const Node& n = node(index);
    if (n.operation == Operation::multiply)
        for (const auto& [a, b] : {std::pair{n.a, n.b}, std::pair{n.b, n.a}})
            if (node(b).operation == Operation::parameter)
                if (const Switch* s = switch_of(node(b).a); s != nullptr && !s->is_norm && a == s->argument)
                    return true;
    if (branches_.empty()) return false;
    const auto [argument, orientation] = surface(index);
    for (const Branch& b : branches_)
        if (b.is_select && surface(b.argument).first == argument)
            return (b.choice > 0 ? 1 : -1) * b.orientation * orientation > 0;
    return false;
}

RBDYN_INLINE std::optional<Expression> Recorder::without(std::int32_t product, std::int32_t factor) {
    // products of products, the first factor of each first; one that several are made of is looked through once
    struct Step {
        std::int32_t product;
        bool is_second;
    };
    std::vector<Step> way;
    std::set<std::int32_t> seen;
    for (std::int32_t here = product; here != factor;) {
        if (node(here).operation == Operation::multiply && seen.insert(here).second) {
            way.push_back({here, false});
            here = node(here).a;
            continue;
        }
        while (!way.empty() && way.back().is_second) way.pop_back();
        if (way.empty()) return std::nullopt;
        way.back().is_second = true;
        here = node(way.back().product).b;
    }
    Expression rest = 1.0;
    for (; !way.empty(); way.pop_back()) {
        const Node n = node(way.back().product);
        rest = way.back().is_second ? Expression(this, n.a) * rest : rest * Expression(this, n.b);
    }
    return rest;
}

RBDYN_INLINE std::optional<Expression> Recorder::over_multiple(const Expression& a, const Expression& b) {
    if (purpose_ != Purpose::model || a.is_constant() || b.is_constant()) return std::nullopt;
    const Node n = node(b.node());
    if (n.operation != Operation::multiply) return std::nullopt;
    for (const auto& [x, factor] : {std::pair{n.a, n.b}, std::pair{n.b, n.a}}) {
        const Node& f = node(factor);
        const Switch* known = f.operation == Operation::parameter ? switch_of(f.a) : nullptr;
        const bool is_sign = known != nullptr && !known->is_norm;
        if (!is_sign && f.operation != Operation::constant) continue;
        if (const auto rest = without(a.node(), x)) return *rest / Expression(this, factor);
    }
    return std::nullopt;
}

RBDYN_INLINE long Recorder::choose(Branch branch, long by_state) {
    branch.id = identity(branch.argument) + (branch.is_select ? 1 : 2);
    for (const Branch& known : branches_)
        if (known.id == branch.id && known.argument == branch.argument && known.is_select == branch.is_select)
            return known.choice;
    if (branch.is_select) {
        const auto [argument, orientation] = surface(branch.argument);
        branch.surface = identity(argument);
        branch.orientation = orientation;
    }
    const auto forced = forced_.find(branch.id);
    branch.choice = forced != forced_.end() ? forced->second : by_state;
    if (const auto side = sides_.find(branch.surface); branch.is_select && side != sides_.end())
        branch.choice = side->second * branch.orientation > 0 ? 1 : 0;
    branches_.push_back(std::move(branch));
    return branches_.back().choice;
}

RBDYN_INLINE long Recorder::side(const Expression& x, const std::string& name) {
    if (x.is_constant()) return x.is_positive() ? 1 : 0;
    if (!follows_) throw Error("a choice between formulas was recorded where no state says which");
    return choose({x.node(), 0, true, 0, 1, name, subject_}, followed(x.node()) > 0.0 ? 1 : 0);
}

RBDYN_INLINE long Recorder::whole(const Expression& x, long lowest, long highest, const std::string& name) {
    const auto below = [&](double value) {
        const double least = static_cast<double>(lowest), most = static_cast<double>(highest);
        return value > least ? static_cast<long>(std::min(std::floor(value), most)) : lowest;
    };
    if (x.is_constant()) return below(x.value());
    if (!follows_) throw Error("a choice between formulas was recorded where no state says which");
    return choose({x.node(), 0, false, lowest, highest, name, subject_}, below(followed(x.node())));
}

RBDYN_INLINE std::vector<Expression> Recorder::call(const std::shared_ptr<const Callback>& function,
                                                    std::span<const Expression> arguments) {
    (void)callable(function, "a force, coupling or equation");
    Call call{function, {}};
    for (const Expression& x : arguments) call.arguments.push_back(node_of(x));
    const auto same = [&](const Call& c) { return c.function == function && c.arguments == call.arguments; };
    const auto known = std::find_if(calls_.begin(), calls_.end(), same);
    const auto index = static_cast<std::int32_t>(known - calls_.begin());
    if (known == calls_.end()) {
        calls_.push_back(std::move(call));
        results_.emplace_back();
    }
    std::vector<Expression> result;
    for (int i = 0; i < function->outputs; ++i) result.push_back(record({Operation::call, index, -1, -1, i}));
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
