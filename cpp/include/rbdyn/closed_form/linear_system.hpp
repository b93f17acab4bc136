// x' = A x + b with constants of 32 digits, and its motion: split into the blocks that A falls into, each by the way
// that is right for it.
//
//   a variable that changes evenly                                        x0 + b t
//   q'' = f - K q - D q', K symmetric in some scales, D = a + b K         normal modes (linear_modes.hpp)
//   the same, forced in time, if it is large                              modes that are forced (forced_modes.hpp)
//   anything else                                                         exp(A t) (linear_flow.hpp)
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/linear_block.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct LinearSystem {
    struct Entry {
        int column;
        DoubleDouble value;
    };
    std::vector<std::vector<Entry>> rows;        // of A, what is not zero
    std::vector<DoubleDouble> constants, start;  // b, x(0)

    int size() const { return static_cast<int>(rows.size()); }

    /// Whether x is a polynomial in time: no variable depends on itself, by however many others.
    bool is_polynomial() const;

    /// Whether all its numbers are.
    bool is_finite() const;

    /// x' at the start.
    std::vector<DoubleDouble> rates() const;
};

namespace linear {

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// A variable that changes evenly.
class EvenChange : public LinearBlock {
public:
    EvenChange(int place, const DoubleDouble& start, const DoubleDouble& rate);
    void state(Instant since, std::span<double> x) const override;
    void add_errors(double, std::span<double>) const override;
    double fastest() const override;

private:
    int place_;
    DoubleDouble start_, rate_;
};

/// The blocks that A falls into: their variables, in order.
std::vector<std::vector<int>> blocks(const LinearSystem& system);

/// A block as q'' = f + B z - K q - D q': the variables z from `own` on force it.
struct SecondOrder {
    std::vector<int> positions, velocities, drivers;
    WideMatrix stiffness, damping;
};
/// None if not every one of its own variables is a position or the velocity of one.
[[gnu::cold]] std::optional<SecondOrder> second_order(const LinearSystem& system, const std::vector<int>& block,
                                                      int own);

template <class Of>
std::vector<DoubleDouble> gathered(const std::vector<DoubleDouble>& all, const Of& places) {
    std::vector<DoubleDouble> result;
    for (const int i : places) result.push_back(all[at(i)]);
    return result;
}

}  // namespace linear

/// The motion of a linear system, block by block.
struct LinearBlocks {
    std::vector<std::unique_ptr<const LinearBlock>> blocks;
    bool by_modes = true;  // all of it
    int too_large = 0;     // of a block that set-up does not pay for: its variables; then there is no solution
};

// set-up costs the third power of a size: beyond these a run of a period takes longer than by integration, or twice as
// long
inline constexpr int most_modes = 64, most_in_flow = 16;
/// Variables that depend on each other beyond this are neither: no matrix of them is made.
inline constexpr int most_in_block = 2 * most_modes + most_in_flow;

/// Variables from `own` on are those of what forces the others in time, and depend on none of these.
[[gnu::cold]] LinearBlocks solve(const LinearSystem& system, int own);
[[gnu::cold]] inline LinearBlocks solve(const LinearSystem& system) { return solve(system, system.size()); }

}  // namespace rbdyn::inline RBDYN_FORM
