// In which order a program's instructions are computed in series, and which of their products go side by side.
//
// Instructions that need nothing from each other at the same order make a stage. The products of up to four of its
// combinations share the four lanes of a sum (series/product_sums.hpp): each combination has a lane or more, and each
// lane one product after another. Where a factor is common to all lanes it comes second, so that it is laid out once.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

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
    /// What comes with a sum: the series it lays out, those of them that no sum before it has, and its combinations.
    struct Part {
        Range series, combinations;
    };

    explicit Schedule(const Program& program);

    std::vector<Stage> stages;
    std::vector<Series> series;
    std::vector<Product> products;
    std::vector<Range> sums;  // of products
    std::vector<Part> parts;  // one for each
    std::vector<Combination> combinations;
    std::vector<const Instruction*> others;

private:
    std::vector<std::size_t> stages_of_instructions() const;

    /// Lays out the products of the group, which is empty then.
    void share_lanes(std::vector<const Instruction*>& group);

    /// Takes a product from each lane that has one; one without any has another one's, times zero.
    Product next_product(std::array<std::vector<ProductTerm>, lanes>& waiting);

    std::size_t index_of(const Series& s);

    struct Hash {
        std::size_t operator()(const Series& s) const {
            std::uint64_t all = 0;
            for (const Weighted& w : s) {
                const std::uint64_t both =
                    static_cast<std::uint64_t>(w.slot) << 32U | static_cast<std::uint32_t>(w.scalar);
                all = (all ^ both) * 0x9e3779b97f4a7c15U;
                all ^= all >> 29U;
            }
            return static_cast<std::size_t>(all);
        }
    };

    const Program& program_;
    std::unordered_map<Series, std::size_t, Hash> known_;
};

}  // namespace rbdyn::inline RBDYN_FORM
