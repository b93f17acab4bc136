// Definitions of rbdyn/engine/engine.hpp.
#pragma once

#include "rbdyn/engine/engine.hpp"

#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Engine::carry(std::span<const double> /*rest*/) {}

RBDYN_INLINE double Engine::natural_length() const { return piece_.length; }

RBDYN_INLINE void Engine::state(double tau, std::span<double> x) const { piece_.state(tau, x); }

RBDYN_INLINE void Engine::rest(double /*tau*/, std::span<const double> /*x*/, std::span<double> low) const {
    for (double& digit : low) digit = 0.0;
}

RBDYN_INLINE void Engine::standing(std::span<double> x, std::span<double> low) const {
    state(piece_.length, x);
    rest(piece_.length, x, low);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Instant sum = exact_sum(x[i], low[i]);
        x[i] = sum.hi;
        low[i] = sum.lo;
    }
}

RBDYN_INLINE std::vector<double> Engine::memory() const { return {}; }

RBDYN_INLINE void Engine::recall(std::span<const double> /*memory*/) {}

RBDYN_INLINE bool Engine::refines() const { return false; }

RBDYN_INLINE bool Engine::is_rough(int /*guard*/) const { return false; }

RBDYN_INLINE bool Engine::is_far(int /*guard*/) const { return false; }

RBDYN_INLINE bool Engine::fits_guards() const { return false; }

RBDYN_INLINE std::vector<EngineChange> Engine::changes() const { return {}; }

RBDYN_INLINE bool Engine::drop_start_flags(const Equations& equations, std::vector<double>& parameters) {
    bool changed = false;
    for (int flag : equations.start_flags) {
        double& parameter = parameters[static_cast<std::size_t>(flag)];
        changed = changed || parameter != 0.0;
        parameter = 0.0;
    }
    return changed;
}

}  // namespace rbdyn::inline RBDYN_FORM
