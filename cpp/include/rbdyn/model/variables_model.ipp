// Definitions of rbdyn/model/variables_model.hpp.
#pragma once

#include "rbdyn/model/variables_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/gradient.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string VariablesModel::not_finite(const Mode& mode, double t, std::span<const double> x) const {
    for (int i = 0; i < variables(); ++i)
        if (const double value = x[static_cast<std::size_t>(i)]; !std::isfinite(value))
            return variable_name(i) + " itself, which is " + text(value);
    const std::vector<double> rates = rate(mode, t, x);
    for (int i = 0; i < variables(); ++i)
        if (const double value = rates[static_cast<std::size_t>(i)]; !std::isfinite(value))
            return rate_name(i) + ", which is " + text(value) + " at t = " + text(t) + ", " +
                   valued(i, x[static_cast<std::size_t>(i)]);
    const Steepest s = steepest(mode, t, x);
    if (s.rate < 0 || std::isfinite(s.slope)) return {};
    return rate_name(s.rate) + ", whose slope by " + variable_name(s.variable) + " is " + text(s.slope) +
           " at t = " + text(t) + ", " + valued(s.variable, x[static_cast<std::size_t>(s.variable)]);
}

RBDYN_INLINE std::string VariablesModel::rate_name(int variable) const {
    return "the rate of " + variable_name(variable);
}

RBDYN_INLINE std::string VariablesModel::valued(int variable, double value) const {
    return variable_name(variable) + " = " + text(value);
}

RBDYN_INLINE VariablesModel::Steepest VariablesModel::steepest(const Mode& mode, double t,
                                                               std::span<const double> x) const {
    Steepest result;
    // nobody knows the derivatives of what is called back
    if (mode.equations == nullptr || mode.equations->program.has_calls()) return result;
    GradientEvaluator f(mode.equations->program);
    f.set_parameters(mode.parameters);
    f(t, x);
    for (int i = 0; i < variables(); ++i)
        for (const auto& [variable, slope] : f.gradient(i))
            if (variable < variables() && !(std::abs(slope) <= std::abs(result.slope))) {
                result = {i, variable, slope};
                if (std::isnan(slope)) return result;
            }
    return result;
}

RBDYN_INLINE std::string VariablesModel::grown(const Mode& before, double t0, std::span<const double> x0,
                                               const Mode& mode, double t, std::span<const double> x) const {
    // no motion that goes on comes to this
    constexpr double beyond = 1e5;
    const Steepest was = steepest(before, t0, x0), is = steepest(mode, t, x);
    if (is.rate >= 0 && std::abs(is.slope) > beyond * std::abs(was.slope))
        return rate_name(is.rate) + ", whose slope by " + variable_name(is.variable) + " has grown to " +
               text(is.slope) + " at " + valued(is.variable, x[static_cast<std::size_t>(is.variable)]);
    const std::vector<double> first = rate(before, t0, x0), last = rate(mode, t, x);
    for (int i = 0; i < variables(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (std::abs(last[k]) > beyond * std::abs(first[k]) && first[k] != 0.0)
            return rate_name(i) + ", which has grown from " + text(first[k]) + " to " + text(last[k]) + " at " +
                   valued(i, x[k]);
    }
    // steps came to nothing here, which has a reason in what moves fastest
    const auto fastest =
        std::max_element(last.begin(), last.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    const int i = static_cast<int>(fastest - last.begin());
    return "steps come to nothing there: " + rate_name(i) + " is " + text(*fastest) + " at " +
           valued(i, x[static_cast<std::size_t>(i)]);
}

RBDYN_INLINE std::string VariablesModel::variable_name(int variable) const {
    return "x[" + std::to_string(variable) + "]";
}

RBDYN_INLINE std::vector<double> VariablesModel::rate(const Mode& mode, double t, std::span<const double> x) const {
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    std::vector<double> result;
    for (int i = 0; i < variables(); ++i) result.push_back(values.output(i));
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
