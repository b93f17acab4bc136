// Definitions of rbdyn/expression/recorder.hpp.
#pragma once

#include "rbdyn/expression/recorder.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/parameter.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Recorder::follow(double t, std::span<const double> inputs, std::span<const double> parameters,
                                   std::map<std::uint64_t, long> forced, std::map<std::uint64_t, long> sides) {
    follows_ = true;
    time_ = t;
    inputs_.assign(inputs.begin(), inputs.end());
    parameter_values_.assign(parameters.begin(), parameters.end());
    forced_ = std::move(forced);
    sides_ = std::move(sides);
    values_.clear();
    for (const Node& n : nodes_) values_.push_back(value_of(n));
}

RBDYN_INLINE Expression Recorder::parameter(int index) {
    if (index >= parameters_) parameters_ = index + 1;
    return {this, intern({Operation::parameter, index})};
}

RBDYN_INLINE std::int32_t Recorder::node_of(const Expression& x) {
    if (!x.is_constant()) return x.node();
    if (x.is_number()) return node_of_number(x);
    const auto [value, is_wide] = x.constant();
    // zero has no further digits: one node, however it came about
    if (value.hi == 0.0) return intern({Operation::constant, -1, -1, -1, -1, value.hi});
    return intern({Operation::constant, -1, -1, -1, -1, value.hi, value.lo, is_wide});
}

RBDYN_INLINE Expression Recorder::record(Operation operation, std::int32_t a, std::int32_t b, double value) {
    return {this, intern({operation, a, b, -1, -1, value})};
}

RBDYN_INLINE Expression Recorder::cell(const Parameter& parameter) {
    std::int32_t index = 0;
    while (index < static_cast<std::int32_t>(cells_.size()) && !cells_[static_cast<std::size_t>(index)].is(parameter))
        ++index;
    if (index == static_cast<std::int32_t>(cells_.size())) cells_.push_back(parameter);
    return {this, intern({Operation::cell, index})};
}

RBDYN_INLINE std::int32_t Recorder::name_index(const std::string& name) {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found != names_.end()) return static_cast<std::int32_t>(found - names_.begin());
    names_.push_back(name);
    return static_cast<std::int32_t>(names_.size()) - 1;
}

RBDYN_INLINE std::size_t Recorder::place_of(const Node& n, int bits) {
    std::uint64_t h = static_cast<std::uint64_t>(n.operation);
    for (std::int32_t x : {n.a, n.b, n.c, n.d}) h = h * 1000003u ^ static_cast<std::uint64_t>(x + 7);
    // zeros of both signs are one number
    h = h * 1000003u ^ (n.value == 0.0 ? 0 : std::bit_cast<std::uint64_t>(n.value));
    // the high bits of a product with 2^64 over the golden section depend on all of h
    return static_cast<std::size_t>((h ^ h >> 32) * 0x9e3779b97f4a7c15u >> (64 - bits));
}

RBDYN_INLINE std::int32_t Recorder::intern(const Node& node) {
    if (2 * nodes_.size() >= index_.size()) {
        bits_ = bits_ == 0 ? 6 : bits_ + 1;
        index_.assign(std::size_t{1} << bits_, -1);
        for (std::size_t n = 0; n < nodes_.size(); ++n) index_[free_place(nodes_[n])] = static_cast<std::int32_t>(n);
    }
    std::int32_t& found = index_[free_place(node)];
    if (found < 0) {
        found = static_cast<std::int32_t>(nodes_.size());
        if (found % 64 == 0) Interruption::point();
        nodes_.push_back(node);
        if (follows_) values_.push_back(value_of(node));
    }
    return found;
}

RBDYN_INLINE std::size_t Recorder::free_place(const Node& node) const {
    std::size_t place = place_of(node, bits_);
    while (index_[place] >= 0 && !(nodes_[at(index_[place])] == node)) place = (place + 1) & (index_.size() - 1);
    return place;
}

RBDYN_INLINE std::int32_t Recorder::node_of_number(const Expression& x) {
    for (const auto& [number, index] : numbers_)
        if (number == x.node()) return intern({Operation::parameter, index});
    const int index = new_parameter();
    if (follows_) {
        parameter_values_.resize(at(index) + 1, 0.0);
        parameter_values_[at(index)] = x.constant().number.hi;
    }
    numbers_.emplace_back(x.node(), index);
    return intern({Operation::parameter, index});
}

RBDYN_INLINE std::int32_t Recorder::number_of(const Node& n) const {
    if (n.operation == Operation::parameter)
        for (const auto& [number, index] : numbers_)
            if (index == n.a) return number;
    return -1;
}

}  // namespace rbdyn::inline RBDYN_FORM
