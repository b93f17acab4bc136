// Definitions of rbdyn/model/acting.hpp.
#pragma once

#include "rbdyn/model/acting.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::optional<Acting> acting_in(const Mode& mode, int bodies, int couplings, double t,
                                             std::span<const double> x) {
    if (mode.equations == nullptr || mode.equations->acting == nullptr) return std::nullopt;
    const Program& program = *mode.equations->acting;
    Evaluator<double> values(program, mode.parameters);
    values(t, x);
    // the sign of what the motion itself does not depend on is that of the state
    std::vector<double> parameters;
    const std::vector<Switch>& known = mode.equations->program.switches();
    for (std::size_t k = 0; k < program.switches().size(); ++k) {
        const Switch& s = program.switches()[k];
        if (s.is_norm) continue;
        bool is_known = false;
        for (const Switch& other : known) is_known = is_known || other.parameter == s.parameter;
        if (is_known) continue;
        if (parameters.empty()) parameters = mode.parameters;
        parameters[static_cast<std::size_t>(s.parameter)] = values.switch_value(static_cast<int>(k)) < 0.0 ? -1.0 : 1.0;
    }
    if (!parameters.empty()) {
        values.set_parameters(parameters);
        values(t, x);
    }
    Acting result{static_cast<int>(x.size()), bodies, couplings, {}};
    result.values.reserve(static_cast<std::size_t>(program.outputs()));
    for (int i = 0; i < program.outputs(); ++i) result.values.push_back(values.output(i));
    return result;
}

RBDYN_INLINE std::optional<Acting> acting_widely(const Mode& mode, double t, std::span<const DoubleDouble> x) {
    if (mode.equations == nullptr || mode.equations->acting == nullptr) return std::nullopt;
    const Program& program = *mode.equations->acting;
    if (program.has_calls() || !program.switches().empty()) return std::nullopt;
    const std::vector<DoubleDouble> parameters(mode.parameters.begin(), mode.parameters.end());
    Evaluator<DoubleDouble> values(program, parameters);
    values(t, x);
    Acting result{static_cast<int>(x.size()), 0, 0, {}};
    for (int i = 0; i < program.outputs(); ++i) {
        result.values.push_back(static_cast<double>(values.output(i)));
        if (!std::isfinite(result.values.back())) return std::nullopt;
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
