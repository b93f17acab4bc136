// Definitions of rbdyn/special/linear_pieces.hpp.
#pragma once

#include "rbdyn/special/linear_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/closed_form/linear_block.hpp"
#include "rbdyn/closed_form/linear_system.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/program_weights.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/special/forced_system.hpp"
#include "rbdyn/special/linear_motion.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE LinearPieces::LinearPieces(std::shared_ptr<const ClosedForm> first) : first_(std::move(first)) {}

RBDYN_INLINE std::shared_ptr<const ClosedForm> LinearPieces::in_mode(const Equations& equations,
                                                                     std::span<const double> parameters, Instant t,
                                                                     std::span<const double> x,
                                                                     std::span<const double> low) const {
    return planning::linear_in_mode(equations, parameters, t, x, low);
}

RBDYN_INLINE void LinearPieces::state(Instant since, std::span<double> x) const { first_->state(since, x); }

RBDYN_INLINE double LinearPieces::error(double since, double wanted) const { return first_->error(since, wanted); }

RBDYN_INLINE double LinearPieces::pace() const { return first_->pace(); }

RBDYN_INLINE std::string LinearPieces::name() const { return first_->name(); }

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::planning {

/// The weights that a program has for its parameters, with all their digits.
inline std::vector<DoubleDouble> exact_weights(const Program& program, std::span<const double> parameters) {
    const std::vector<DoubleDouble> wide(parameters.begin(), parameters.end());
    std::vector<DoubleDouble> result;
    program.set_parameters<DoubleDouble>(wide, result);
    return result;
}

RBDYN_INLINE std::shared_ptr<const LinearMotion> linear_in_mode(const Equations& equations,
                                                                std::span<const double> parameters, Instant t,
                                                                std::span<const double> x,
                                                                std::span<const double> low) {
    // what holds for a first step alone changes the formula after it
    if (!equations.start_flags.empty() || equations.program.uses_time()) return nullptr;
    const std::vector<DoubleDouble> weights = exact_weights(equations.program, parameters);
    std::vector<DoubleDouble> wide(x.begin(), x.end());
    for (std::size_t i = 0; i < low.size(); ++i) wide[i] += low[i];
    const auto system = forced_system(equations.program, weights, std::move(wide));
    if (!system) return nullptr;
    const LinearSystem whole = system->begun(DoubleDouble(t));
    if (!whole.is_finite() || whole.is_polynomial()) return nullptr;
    LinearBlocks solution = solve(whole);
    if (solution.too_large > 0) return nullptr;
    return std::make_shared<const LinearMotion>(std::nullopt, std::move(solution),
                                                std::vector<double>(x.begin(), x.end()), equations.groups);
}

RBDYN_INLINE bool keeps_its_mode(const LinearMotion& motion, const Mode& mode) {
    const Equations& e = *mode.equations;
    const auto outputs = linear_outputs(e.program, exact_weights(e.program, mode.parameters));
    // what is nearer than that may be rounding
    constexpr double apart = 1e-6;
    return std::ranges::all_of(e.guards, [&](const Guard& g) {
        if (g.role != GuardRole::mode) return true;
        if (g.output < 0 || g.least < 0.0 || !outputs[static_cast<std::size_t>(g.output)]) return false;
        const LinearOutput& value = *outputs[static_cast<std::size_t>(g.output)];
        const LinearBlock::Range range = motion.range(value.factors);
        return std::abs(range.middle + value.constant) > (1.0 + apart) * range.radius;
    });
}

RBDYN_INLINE std::shared_ptr<const ClosedForm> linear_pieces(const SpecialModel& model) {
    std::vector<double> x = model.start();
    const std::vector<double> rest = model.start_rest();
    const Mode mode = model.begin(0.0, x);
    if (mode.equations == nullptr || mode.still) return nullptr;
    auto first = linear_in_mode(*mode.equations, mode.parameters, {0.0, 0.0}, x, rest);
    if (!first || keeps_its_mode(*first, mode)) return first;
    return std::make_shared<const LinearPieces>(std::move(first));
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
