// Definitions of rbdyn/expression/schedule.hpp.
#pragma once

#include "rbdyn/expression/schedule.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Schedule::Schedule(const Program& program) : program_(program) {
    const std::vector<std::size_t> when = stages_of_instructions();
    std::vector<std::vector<const Instruction*>> of_stage;
    for (std::size_t i = 0; i < when.size(); ++i) {
        if (when[i] >= of_stage.size()) of_stage.resize(when[i] + 1);
        of_stage[when[i]].push_back(&program.instructions()[i]);
    }
    for (const std::vector<const Instruction*>& instructions : of_stage) {
        Interruption::point();
        Stage stage{{series.size(), 0}, {sums.size(), 0}, {combinations.size(), 0}, {others.size(), 0}};
        std::vector<const Instruction*> group;
        for (const Instruction* instruction : instructions) {
            if (instruction->products == 0) {
                others.push_back(instruction);
                continue;
            }
            group.push_back(instruction);
            if (group.size() == lanes) share_lanes(group);
        }
        if (!group.empty()) share_lanes(group);
        stage.series.last = series.size();
        stage.sums.last = sums.size();
        stage.combinations.last = combinations.size();
        stage.others.last = others.size();
        stages.push_back(stage);
    }
}

RBDYN_INLINE std::vector<std::size_t> Schedule::stages_of_instructions() const {
    std::vector<std::size_t> known(static_cast<std::size_t>(program_.slots()), 0), result;
    result.reserve(program_.instructions().size());
    for (const Instruction& i : program_.instructions()) {
        std::size_t stage = 0;
        const auto needs = [&](int slot) {
            if (slot >= 0) stage = std::max(stage, known[static_cast<std::size_t>(slot)]);
        };
        needs(i.a);
        needs(i.b);
        needs(i.c);
        for (int t = 0; t < i.terms; ++t) needs(program_.terms(i)[t].slot);
        for (int p = 0; p < i.products; ++p) {
            needs(program_.products(i)[p].a);
            needs(program_.products(i)[p].b);
        }
        const auto gives = [&](int slot) {
            if (slot >= 0) known[static_cast<std::size_t>(slot)] = stage + 1;
        };
        if (i.code == Code::call) {
            const Program::Call& call = program_.calls()[static_cast<std::size_t>(i.extra)];
            for (const int slot : call.arguments) needs(slot);
            for (const int slot : call.results) gives(slot);
        }
        gives(i.out);
        gives(i.out2);
        result.push_back(stage);
    }
    return result;
}

RBDYN_INLINE void Schedule::share_lanes(std::vector<const Instruction*>& group) {
    // lanes to spare go where most products wait
    std::array<int, lanes> width{};
    std::fill_n(width.begin(), group.size(), 1);
    const auto load = [&](std::size_t i) { return (group[i]->products + width[i] - 1) / width[i]; };
    for (std::size_t spare = lanes - group.size(); spare > 0; --spare) {
        std::size_t most = 0;
        for (std::size_t i = 1; i < group.size(); ++i)
            if (load(i) > load(most)) most = i;
        if (load(most) > 1) ++width[most];
    }
    std::array<std::vector<ProductTerm>, lanes> waiting;
    Part part{{series.size(), 0}, {combinations.size(), 0}};
    std::size_t lane = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
        combinations.push_back({group[i], sums.size(), static_cast<int>(lane), width[i]});
        for (int p = 0; p < group[i]->products; ++p)
            waiting[lane + static_cast<std::size_t>(p % width[i])].push_back(program_.products(*group[i])[p]);
        lane += static_cast<std::size_t>(width[i]);
    }
    const std::size_t first = products.size();
    while (std::any_of(waiting.begin(), waiting.end(), [](const auto& w) { return !w.empty(); }))
        products.push_back(next_product(waiting));
    sums.push_back({first, products.size()});
    part.series.last = series.size();
    part.combinations.last = combinations.size();
    parts.push_back(part);
    group.clear();
}

RBDYN_INLINE Schedule::Product Schedule::next_product(std::array<std::vector<ProductTerm>, lanes>& waiting) {
    const auto has = [](const ProductTerm& p, int slot) { return p.a == slot || p.b == slot; };
    const auto& some = *std::find_if(waiting.begin(), waiting.end(), [](const auto& w) { return !w.empty(); });
    const ProductTerm model = some.front();
    const auto shares = [&](int slot) {
        return std::count_if(waiting.begin(), waiting.end(), [&](const auto& lane) {
            return std::any_of(lane.begin(), lane.end(), [&](const ProductTerm& p) { return has(p, slot); });
        });
    };
    const int common = shares(model.a) > shares(model.b) ? model.a : model.b;
    Series x, y;
    for (std::size_t l = 0; l < lanes; ++l) {
        auto& lane = waiting[l];
        const bool is_spare = lane.empty();
        ProductTerm p = model;
        if (!is_spare) {
            auto chosen = std::find_if(lane.begin(), lane.end(), [&](const ProductTerm& q) { return has(q, common); });
            if (chosen == lane.end()) chosen = lane.begin();
            p = *chosen;
            lane.erase(chosen);
        }
        if (p.a == common) std::swap(p.a, p.b);
        x[l] = {p.a, is_spare ? zero : p.weight};
        y[l] = {p.b, one};
    }
    return {index_of(x), index_of(y)};
}

RBDYN_INLINE std::size_t Schedule::index_of(const Series& s) {
    const auto [found, is_new] = known_.try_emplace(s, series.size());
    if (is_new) series.push_back(s);
    return found->second;
}

}  // namespace rbdyn::inline RBDYN_FORM
