// Coupled oscillators that are forced in time, by their normal modes: q'' = f + B z - K q - D q', z' = C z + d, with K
// symmetric in coordinates q_i s_i and D = a + b K.
//
// With the modes of linear_modes.hpp each y = V^T s (q - q(0)) is an oscillator of its own that z forces,
// y'' = V^T s (f - K q(0) + B z) - k y - (a + b k) y': a flow (linear_flow.hpp) of y, y' and z, which is exact beside
// and at resonance alike. So set-up grows with the number of modes, where one flow of them all grows with its cube.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/linear_block.hpp"
#include "rbdyn/closed_form/linear_flow.hpp"
#include "rbdyn/closed_form/linear_modes.hpp"
#include "rbdyn/closed_form/linear_system.hpp"

namespace rbdyn::inline RBDYN_FORM {

class ForcedModes : public LinearBlock {
public:
    /// Of a block of a system whose stiffness and damping are `s` and a + b K.
    [[gnu::cold]] ForcedModes(const LinearSystem& system, const linear::SecondOrder& block,
                              const LinearModes::Symmetric& s, const SymmetricModes& modes,
                              const std::pair<DoubleDouble, DoubleDouble>& damping);

    void state(Instant since, std::span<double> x) const override;

    void add_errors(double since, std::span<double> errors) const override;

    double fastest() const override;

private:
    std::vector<int> positions_, velocities_;
    std::vector<DoubleDouble> start_;
    std::vector<double> shapes_;  // mode by mode
    std::vector<std::unique_ptr<const LinearFlow>> modes_;
    std::size_t of_mode_;  // variables
    double value_error_;
};

}  // namespace rbdyn::inline RBDYN_FORM
