// Definitions of rbdyn/special/forced_system.hpp.
#pragma once

#include "rbdyn/special/forced_system.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/closed_form/linear_system.hpp"
#include "rbdyn/closed_form/waves.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

/// What a slot is: a sum of variables with factors, and of waves; not known if it is something else.
struct ForcedSlot {
    bool is_known = false;
    std::vector<LinearSystem::Entry> row;
    Waves time;

    void add(const ForcedSlot& other, const DoubleDouble& factor) {
        is_known = is_known && other.is_known;
        for (const LinearSystem::Entry& e : other.row) {
            const auto known =
                std::find_if(row.begin(), row.end(), [&](const auto& o) { return o.column == e.column; });
            if (known == row.end())
                row.push_back({e.column, e.value * factor});
            else
                known->value += e.value * factor;
        }
        time.add(other.time, factor);
    }
    /// Its value, if it has but one.
    std::optional<DoubleDouble> constant() const { return row.empty() ? time.constant() : std::nullopt; }

    static ForcedSlot known(std::optional<Waves> waves) {
        ForcedSlot result;
        result.is_known = waves.has_value();
        if (waves) result.time = *std::move(waves);
        return result;
    }
    static ForcedSlot product(const ForcedSlot& a, const ForcedSlot& b) {
        ForcedSlot result;
        if (!a.is_known || !b.is_known) return result;
        if (a.row.empty() && b.row.empty()) return known(Waves::product(a.time, b.time));
        result.is_known = true;
        if (const auto factor = a.constant())
            result.add(b, *factor);
        else if (const auto other = b.constant())
            result.add(a, *other);
        else
            result.is_known = false;
        return result;
    }
    /// A whole power.
    static ForcedSlot power(const ForcedSlot& of, double exponent) {
        constexpr double most = 8.0;
        if (exponent != std::floor(exponent) || exponent < 1.0 || exponent > most) return {};
        ForcedSlot result = of;
        for (int k = 1; k < static_cast<int>(exponent); ++k) result = product(result, of);
        return result;
    }
};

RBDYN_INLINE std::optional<ForcedSystem> forced_system(const Program& program, std::vector<DoubleDouble> start) {
    const std::vector<DoubleDouble>* weights = program.exact_weights();
    if (weights == nullptr) return std::nullopt;
    return forced_system(program, *weights, std::move(start));
}

/// All slots of a program with these weights.
RBDYN_INLINE std::vector<ForcedSlot> slots_of(const Program& program, std::span<const DoubleDouble> weights) {
    const auto weight = [&](int i) -> const DoubleDouble& { return weights[static_cast<std::size_t>(i)]; };
    std::vector<ForcedSlot> all(static_cast<std::size_t>(program.slots()));
    const auto at = [&](int i) -> ForcedSlot& { return all[static_cast<std::size_t>(i)]; };
    for (int i = 0; i < program.inputs(); ++i) {
        at(i).is_known = true;
        at(i).row = {{i, 1.0}};
    }
    at(program.time_slot()) = ForcedSlot::known(Waves::time());
    for (const Instruction& i : program.instructions()) {
        ForcedSlot out, second;
        switch (i.code) {
            case Code::combine:
                out.is_known = true;
                if (i.weight >= 0) out.time = Waves(weight(i.weight));
                for (int k = 0; k < i.terms; ++k)
                    out.add(at(program.terms(i)[k].slot), weight(program.terms(i)[k].weight));
                for (int k = 0; k < i.products; ++k) {
                    const ProductTerm& p = program.products(i)[k];
                    out.add(ForcedSlot::product(at(p.a), at(p.b)), weight(p.weight));
                }
                break;
            case Code::divide:
                if (const auto by = at(i.b).is_known ? at(i.b).constant() : std::nullopt; by && by->hi != 0.0) {
                    out.is_known = true;
                    out.add(at(i.a), 1.0 / *by);
                }
                break;
            case Code::sine_cosine:
                if (!at(i.a).is_known || !at(i.a).row.empty()) break;
                out = ForcedSlot::known(Waves::sine(at(i.a).time));
                second = ForcedSlot::known(Waves::cosine(at(i.a).time));
                break;
            case Code::exponential:
                if (at(i.a).is_known && at(i.a).row.empty()) out = ForcedSlot::known(Waves::exponential(at(i.a).time));
                break;
            case Code::power:
                if (at(i.a).is_known) out = ForcedSlot::power(at(i.a), i.value);
                break;
            default: break;
        }
        at(i.out) = std::move(out);
        if (i.out2 >= 0) at(i.out2) = std::move(second);
    }
    return all;
}

RBDYN_INLINE std::optional<ForcedSystem> forced_system(const Program& program, std::span<const DoubleDouble> weights,
                                                       std::vector<DoubleDouble> start) {
    if (program.has_calls()) return std::nullopt;
    std::vector<ForcedSlot> all = slots_of(program, weights);
    const auto at = [&](int i) -> ForcedSlot& { return all[static_cast<std::size_t>(i)]; };
    LinearSystem system;
    std::vector<Waves> forcing;
    for (int i = 0; i < program.inputs(); ++i) {
        ForcedSlot& rate = at(program.output(i));
        if (!rate.is_known) return std::nullopt;
        std::erase_if(rate.row, [](const auto& e) { return e.value.hi == 0.0; });
        system.rows.push_back(std::move(rate.row));
        forcing.push_back(std::move(rate.time));
    }
    system.constants.resize(system.rows.size());
    system.start = std::move(start);
    return ForcedSystem(std::move(system), forcing);
}

RBDYN_INLINE std::vector<std::optional<LinearOutput>> linear_outputs(const Program& program,
                                                                     std::span<const DoubleDouble> weights) {
    const std::size_t count = static_cast<std::size_t>(program.outputs()) + program.switches().size();
    std::vector<std::optional<LinearOutput>> result(count);
    if (program.has_calls()) return result;
    const std::vector<ForcedSlot> all = slots_of(program, weights);
    for (int i = 0; i < static_cast<int>(count); ++i) {
        const ForcedSlot& slot = all[static_cast<std::size_t>(program.output(i))];
        const auto constant = slot.time.constant();
        if (!slot.is_known || !constant) continue;
        LinearOutput& out = result[static_cast<std::size_t>(i)].emplace();
        out.constant = constant->hi;
        out.factors.resize(static_cast<std::size_t>(program.inputs()));
        for (const LinearSystem::Entry& e : slot.row) out.factors[static_cast<std::size_t>(e.column)] += e.value.hi;
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
