// Sliding along surfaces at which the right-hand side jumps and to which it points from both sides.
//
// Source: A. F. Filippov, Differential Equations with Discontinuous Righthand Sides (Kluwer, 1988), chapter 2. On a
// surface g(t, x) = 0 with the rates f- where g < 0 and f+ where g > 0 the motion follows their convex combination that
// stays on it,
//     x' = (1 - a) f- + a f+,   a = -g'- / (g'+ - g'-),   g'(f) = dg/dt + grad g . f,
// until a leaves [0, 1], which is where one of the two fields points away (L. Dieci and L. Lopez, SIAM J. Numer. Anal.
// 47, 2009, 2023-2051). Along several surfaces at once x' = f + sum a_k (f_k - f), where f is on the negative side of
// all and f_k on the positive side of surface k, and the a_k solve the linear system that all g_k' = 0 make. That holds
// only if what the surfaces switch adds up; where it does not, this is no model of the motion, and there is none here.
//
// Conventions: a surface is known by the id of its argument (expression.hpp); its guards are a >= 0 (left to the
// negative side) and 1 - a >= 0. Watched functions see the equations with each distinction replaced by the weighed mean
// of its two sides. Where g depends on one variable alone, that variable does not change, exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/derivative.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace sliding {

/// The one variable that an expression depends on; none if there are more, or time is among them.
std::optional<int> only_variable(const Recorder& r, std::int32_t node);

/// The solution of m a = b by elimination, the pivots those that are not known to be zero; none if there are too few.
std::optional<std::vector<Expression>> solved(std::vector<std::vector<Expression>> m, std::vector<Expression> b);

}  // namespace sliding

/// The structure that is recorded in two turns with a recorder; sliding along surfaces, by id, as far as anything lies
/// on them. None if it cannot slide along them. `laws()` gives what the surfaces switch: the rates of the variables
/// first, then whatever else depends on their sides, forces say. `write(EquationsWriter&, values)` gets these as they
/// are in the motion, each distinction weighed once, sets the rates, adds guards, and returns the groups of variables.
template <class Laws, class Write>
std::unique_ptr<Structure> written(Recorder& r, int variables, const std::set<std::uint64_t>& surfaces, Laws&& laws,
                                   Write&& write) {
    using Values = std::vector<Expression>;
    const auto blend_all = [&](const auto& weight) {
        for (const std::uint64_t s : surfaces) r.blend(s, weight(s));
    };
    EquationsWriter final(r, variables);
    if (surfaces.empty()) {
        const Values values = laws();
        auto groups = write(final, std::span<const Expression>(values));
        return final.finish(std::move(groups));
    }
    // on the negative side of all surfaces, and on the positive side of one
    blend_all([](std::uint64_t) { return Expression(0.0); });
    const Values below = laws();
    std::vector<std::uint64_t> ids;
    std::vector<Values> jumps;
    for (const std::uint64_t one : surfaces) {
        blend_all([&](std::uint64_t s) { return Expression(s == one ? 1.0 : 0.0); });
        Values jump = laws();
        for (std::size_t i = 0; i < jump.size(); ++i) jump[i] -= below[i];
        if (r.blends().at(one).argument < 0) continue;
        ids.push_back(one);
        jumps.push_back(std::move(jump));
    }
    // whether what they switch adds up: no rate depends on the product of two weights, which are parameters for once
    if (ids.size() > 1) {
        std::vector<int> weights;
        blend_all([&](std::uint64_t) { return r.parameter(weights.emplace_back(r.new_parameter())); });
        Values mixed = laws();
        mixed.resize(static_cast<std::size_t>(variables));
        for (const int first : weights) {
            const auto along = [](int one) {
                return [one](const Node& n) { return n.operation == Operation::parameter && n.a == one ? 1.0 : 0.0; };
            };
            const auto slope = recording::derivatives(r, mixed, along(first));
            for (const int second : weights) {
                if (second == first) continue;
                const auto bend = slope ? recording::derivatives(r, *slope, along(second)) : std::nullopt;
                if (!bend) return nullptr;
                for (const Expression& e : *bend)
                    if (!e.is_zero()) return nullptr;
            }
        }
    }
    // the weights that stay on the surfaces
    const auto rate_of = [&](std::int32_t argument, const std::vector<Expression>& f, double time) {
        const Expression g(&r, argument);
        return recording::derivatives(r, std::span(&g, 1), [&](const Node& n) -> Expression {
            return n.operation == Operation::input  ? f[static_cast<std::size_t>(n.a)]
                   : n.operation == Operation::time ? Expression(time)
                                                    : Expression(0.0);
        });
    };
    const std::size_t count = ids.size();
    std::vector<std::vector<Expression>> m(count, std::vector<Expression>(count));
    std::vector<Expression> b(count);
    for (std::size_t j = 0; j < count; ++j) {
        const std::int32_t g = r.blends().at(ids[j]).argument;
        const auto own = rate_of(g, below, 1.0);
        if (!own) return nullptr;
        b[j] = -own->front();
        for (std::size_t k = 0; k < count; ++k) {
            const auto jump = rate_of(g, jumps[k], 0.0);
            if (!jump) return nullptr;
            m[j][k] = jump->front();
        }
    }
    const auto weights = sliding::solved(std::move(m), std::move(b));
    if (!weights) return nullptr;
    for (std::size_t k = 0; k < count; ++k) r.blend(ids[k], (*weights)[k]);
    Values values = below;
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t i = 0; i < below.size(); ++i) values[i] += (*weights)[k] * jumps[k][i];
    for (const std::uint64_t id : ids)
        if (const auto variable = sliding::only_variable(r, r.blends().at(id).argument))
            values[static_cast<std::size_t>(*variable)] = 0.0;
    auto groups = write(final, std::span<const Expression>(values));
    for (std::size_t k = 0; k < count; ++k) {
        const Blend& blend = r.blends().at(ids[k]);
        Guard guard{.kind = EventKind::switching, .subject = blend.subject, .name = blend.name};
        guard.sliding = static_cast<int>(k);
        guard.step = -1;
        final.watch(guard, (*weights)[k]);
        guard.step = 1;
        final.watch(guard, 1.0 - (*weights)[k]);
    }
    auto result = final.finish(std::move(groups));
    result->equations.sliding = std::move(ids);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
