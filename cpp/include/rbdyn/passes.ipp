// Definitions of rbdyn/passes.hpp.
#pragma once

#include "rbdyn/passes.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "rbdyn/engine/stiff_taylor.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/options.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

RBDYN_INLINE Pass first_pass(const HybridModel& model, const SimulateOptions& options, const std::string& engine) {
    // at a tolerance a little below the error asked for
    const double tolerance = options.rtol ? *options.rtol : first_tolerance(engine, options.error);
    return {tolerance,
            {.gives_way = gives_way(model, options, engine, tolerance)},
            options.rtol ? options.keep : compared_pieces(options)};
}

RBDYN_INLINE Pass judging_pass(const SimulateOptions& options, const std::string& engine, bool is_judge,
                               const Pass& first, const Record& record, bool amplifies) {
    using Rounding = Program::Rounding;
    const bool at_floor = first.tolerance <= least_tolerance(engine);
    const Manner& manner = first.manner;
    Pass pass;
    pass.tolerance = is_judge ? judging_tolerance(engine, first.tolerance)
                              : std::clamp(std::min(options.error, 10.0 * first.tolerance) * 1e-3, 1e-17, 1e-13);
    pass.manner.rounding = manner.rounding == Rounding::nearest ? Rounding::other : Rounding::nearest;
    pass.manner.is_refined = amplifies;
    if (is_judge) {
        pass.manner.order = at_floor ? other_order : 0;
        pass.manner.stride = other_stride * manner.stride;
        pass.manner.is_refined = manner.is_refined || amplifies;
        pass.manner.gives_way = manner.gives_way;
    } else if (const double least = StiffTaylorEngine::least_tolerance;
               engine == "cvode-bdf" && first.tolerance >= 20.0 * least) {
        // where it is stiff series alone would take as many steps as stability asks for
        pass.tolerance = std::max(1e-3 * first.tolerance, least);
        pass.manner.gives_way = true;
    }
    pass.keep = held_against(record);
    return pass;
}

RBDYN_INLINE void Ahead::add(Pass pass, Timed timed) {
    seconds_ += timed.seconds;
    made_.emplace_back(std::move(pass), std::move(timed));
}

RBDYN_INLINE std::optional<Timed> Ahead::take(const Pass& pass) {
    const auto found = std::find_if(made_.begin(), made_.end(), [&](const auto& made) {
        return made.first.tolerance == pass.tolerance && made.first.manner == pass.manner;
    });
    if (found == made_.end()) return std::nullopt;
    Timed timed = std::move(found->second);
    made_.erase(found);
    return timed;
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating
