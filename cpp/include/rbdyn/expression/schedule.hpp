// In which order a program's instructions are computed in series, and which of their products go side by side.
//
// Instructions that need nothing from each other at the same order make a stage. The products of up to four of its
// combinations share the four lanes of a sum (series/product_sums.hpp): each combination has a lane or more, and each
// lane one product after another. Where a factor is common to all lanes it comes second, so that it is laid out once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "rbdyn/expression/program.hpp"

namespace rbdyn {

class Schedule {
public:
    static constexpr std::size_t lanes = 4;

    struct Range {
        std::size_t first = 0, last = 0;
    };
    static constexpr int one = -1, zero = -2;
    /// A slot times a scalar, by its index, or one, or zero.
    struct Weighted {
        int slot, scalar;
        auto operator<=>(const Weighted&) const = default;
    };
    using Series = std::array<Weighted, lanes>;
    /// Indices of two series.
    struct Product {
        std::size_t x, y;
    };
    /// A combination with products, and the lanes of the sum that are theirs.
    struct Combination {
        const Instruction* instruction;
        std::size_t sum;
        int first_lane, lanes;
    };
    struct Stage {
        Range series, sums, combinations, others;
    };

    explicit Schedule(const Program& program) : program_(program) {
        const std::vector<std::size_t> when = stages_of_instructions();
        for (std::size_t s = 0, seen = 0; seen < when.size(); ++s) {
            Stage stage{{series.size(), 0}, {sums.size(), 0}, {combinations.size(), 0}, {others.size(), 0}};
            std::vector<const Instruction*> group;
            for (std::size_t i = 0; i < when.size(); ++i) {
                if (when[i] != s) continue;
                ++seen;
                const Instruction& instruction = program.instructions()[i];
                if (instruction.products == 0) {
                    others.push_back(&instruction);
                    continue;
                }
                group.push_back(&instruction);
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

    std::vector<Stage> stages;
    std::vector<Series> series;
    std::vector<Product> products;
    std::vector<Range> sums;  // of products
    std::vector<Combination> combinations;
    std::vector<const Instruction*> others;

private:
    std::vector<std::size_t> stages_of_instructions() const {
        std::vector<std::size_t> known(static_cast<std::size_t>(program_.slots()), 0), result;
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

    /// Lays out the products of the group, which is empty then.
    void share_lanes(std::vector<const Instruction*>& group) {
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
        group.clear();
    }

    /// Takes a product from each lane that has one; one without any has another one's, times zero.
    Product next_product(std::array<std::vector<ProductTerm>, lanes>& waiting) {
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
                auto chosen =
                    std::find_if(lane.begin(), lane.end(), [&](const ProductTerm& q) { return has(q, common); });
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

    std::size_t index_of(const Series& s) {
        const auto [found, is_new] = known_.try_emplace(s, series.size());
        if (is_new) series.push_back(s);
        return found->second;
    }

    const Program& program_;
    std::map<Series, std::size_t> known_;
};

}  // namespace rbdyn
