// Definitions of rbdyn/special/linear_motion.hpp.
#pragma once

#include "rbdyn/special/linear_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/linear_block.hpp"
#include "rbdyn/closed_form/linear_system.hpp"
#include "rbdyn/closed_form/waves.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/forced_system.hpp"
#include "rbdyn/special/linear_pieces.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/special_model.hpp"
#include "rbdyn/special/special_writer.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE LinearMotion::LinearMotion(std::optional<ForcedSystem> forced, LinearBlocks solution,
                                        std::vector<double> start, std::vector<VariableGroup> groups)
    : forced_(std::move(forced)),
      solution_(std::move(solution)),
      behind_(forced_ ? static_cast<std::size_t>(forced_->size() - forced_->own()) : 0),
      start_(std::move(start)),
      groups_(std::move(groups)) {}

RBDYN_INLINE void LinearMotion::state(Instant since, std::span<double> x) const {
    if (since.hi == 0.0 && since.lo == 0.0) {
        std::copy(start_.begin(), start_.end(), x.begin());
        return;
    }
    if (behind_ == 0) {
        for (const auto& block : solution_.blocks) block->state(since, x);
        return;
    }
    std::vector<double> all(start_.size() + behind_);
    for (const auto& block : solution_.blocks) block->state(since, all);
    std::copy_n(all.begin(), start_.size(), x.begin());
}

RBDYN_INLINE double LinearMotion::error(double since, double wanted) const {
    constexpr double epsilon = std::numeric_limits<double>::epsilon(), nothing = 1e3 * epsilon;
    // enough to meet most of the extent of a motion, and what it was before it died away; more would make the error
    // less
    constexpr int even = 3, growing = 5;
    std::vector<double> errors(start_.size() + behind_), x(start_), low(x), high(x);
    for (const auto& block : solution_.blocks) block->add_errors(since, errors);
    const double ratio = std::pow(std::max(since / pace(), 1.0), 1.0 / growing);
    double later = since;
    for (int i = 0; i < even + growing; ++i) {
        state({i < even ? since * (1.0 - 0.6180339887498949 * i / even) : later /= ratio, 0.0}, x);
        for (std::size_t k = 0; k < x.size(); ++k) {
            if (!std::isfinite(x[k])) return std::numeric_limits<double>::infinity();
            low[k] = std::min(low[k], x[k]);
            high[k] = std::max(high[k], x[k]);
        }
    }
    // of every group: how far it is off, its scale, and its size
    struct Found {
        double off, scale, size;
    };
    std::vector<Found> found;
    std::array<double, 5> largest{}, farthest{};
    std::array<int, 5> count{};
    for (const VariableGroup& group : groups_) {
        double off = 0.0, extent = 0.0, size = group.steady * group.steady;
        for (int i = group.first; i < group.first + group.count; ++i) {
            const auto k = static_cast<std::size_t>(i);
            const double most = std::max(std::abs(low[k]), std::abs(high[k])), error = errors[k] + 0.5 * epsilon * most;
            off += error * error;
            extent += (high[k] - low[k]) * (high[k] - low[k]);
            size += most * most;
        }
        found.push_back({std::sqrt(off), std::sqrt(group.is_position ? extent : size), std::sqrt(size)});
        if (group.alike == Alike::nothing) continue;
        const auto kind = static_cast<std::size_t>(group.alike);
        ++count[kind];
        largest[kind] = std::max(largest[kind], group.measure * found.back().scale);
        farthest[kind] = std::max(farthest[kind], group.measure * found.back().size);
    }
    const double share = least_share(wanted, largest[0] > 0.0 ? farthest[0] / largest[0] : 1.0);
    double worst = epsilon;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const Found& f = found[g];
        const auto kind = static_cast<std::size_t>(groups_[g].alike);
        const bool is_joined = groups_[g].alike != Alike::nothing && count[kind] > 1;
        const double floor = is_joined ? share * largest[kind] / groups_[g].measure : 0.0;
        // what is no number is kept
        if (const double off_by = f.off / std::max(f.scale, floor); f.scale > nothing * f.size && !(off_by <= worst))
            worst = off_by;
    }
    return std::isfinite(worst) ? worst : std::numeric_limits<double>::infinity();
}

RBDYN_INLINE double LinearMotion::pace() const {
    double fastest = 0.0;
    for (const auto& block : solution_.blocks) fastest = std::max(fastest, block->fastest());
    return 1.0 / fastest;
}

RBDYN_INLINE LinearBlock::Range LinearMotion::range(std::span<const double> factors) const {
    LinearBlock::Range result;
    std::vector<double> weights(factors.begin(), factors.end());
    weights.resize(start_.size() + behind_);
    for (const auto& block : solution_.blocks) {
        const LinearBlock::Range own = block->range(weights);
        result.middle += own.middle;
        result.radius += own.radius;
    }
    return result;
}

RBDYN_INLINE std::shared_ptr<const ClosedForm> LinearMotion::begun(double time) const {
    if (!forced_ || time == 0.0) return nullptr;
    return std::make_shared<const LinearMotion>(forced_, solve(forced_->begun(time), forced_->own()), start_, groups_);
}

RBDYN_INLINE std::string LinearMotion::name() const {
    if (forced_) return "forced motion of a linear scene";
    return solution_.by_modes ? "modes of a linear scene" : "exponential of a linear scene";
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE std::vector<Dependence> dependences(const Program& program) {
    std::vector<Dependence> all(static_cast<std::size_t>(program.slots()), Dependence::other);
    std::fill_n(all.begin(), program.inputs(), Dependence::linear);
    for (const Instruction& i : program.instructions()) {
        if (i.code != Code::combine || i.products > 0) continue;
        Dependence& out = all[static_cast<std::size_t>(i.out)];
        out = Dependence::constant;
        for (int k = 0; k < i.terms; ++k) out = std::min(out, all[static_cast<std::size_t>(program.terms(i)[k].slot)]);
    }
    return all;
}

RBDYN_INLINE Degree Degree::sum(const Degree& a, const Degree& b) {
    return {std::max(a.variables, b.variables), a.part_varies || b.part_varies, a.factors_vary || b.factors_vary};
}

RBDYN_INLINE Degree Degree::product(const Degree& a, const Degree& b) {
    const bool varies = (a.variables == 0 && a.part_varies) || (b.variables == 0 && b.part_varies);
    const int variables = std::min(a.variables + b.variables, 2);
    return {variables, a.part_varies || b.part_varies, a.factors_vary || b.factors_vary || (variables > 0 && varies)};
}

RBDYN_INLINE std::string why_not_linear(const Program& program, int slot) {
    std::vector<Degree> all(static_cast<std::size_t>(program.slots()));
    const auto at = [&](int i) -> Degree& { return all[static_cast<std::size_t>(i)]; };
    for (int i = 0; i < program.inputs(); ++i) at(i) = {.variables = 1};
    at(program.time_slot()) = {.part_varies = true};
    for (const Instruction& i : program.instructions()) {
        Degree out;
        if (i.code == Code::combine) {
            for (int k = 0; k < i.terms; ++k) out = Degree::sum(out, at(program.terms(i)[k].slot));
            for (int k = 0; k < i.products; ++k)
                out = Degree::sum(out, Degree::product(at(program.products(i)[k].a), at(program.products(i)[k].b)));
        } else if (i.code == Code::divide) {
            out = Degree::product(at(i.a), Degree::of_any(at(i.b)));
        } else if (i.code == Code::call) {
            for (const int result : program.calls()[static_cast<std::size_t>(i.extra)].results)
                at(result) = {.variables = 2};
            continue;
        } else {
            for (const int operand : {i.a, i.b, i.c})
                if (operand >= 0) out = Degree::sum(out, Degree::of_any(at(operand)));
        }
        at(i.out) = out;
        if (i.out2 >= 0) at(i.out2) = out;
    }
    const Degree& rate = at(slot);
    if (rate.variables > 1) return "are not linear";
    if (rate.factors_vary) return "are linear, but their coefficients vary in time";
    return "are linear, but what forces them varies in time otherwise than sines, exponentials and powers of it";
}

RBDYN_INLINE Program wide_rates(const SpecialModel& model, const std::vector<double>& start,
                                const std::vector<signed char>& slip) {
    const Numbers::Active plain(nullptr);
    const StateMap& map = model.laws().map();
    Recorder r;
    r.follow(0.0, start, {});
    const std::vector<Expression> all = SpecialWriter(r, model.laws(), map, slip).lay_down();
    std::vector<Expression> rates;
    for (int i = 0; i < map.variables(); ++i)
        if (map.is_simulated(i)) rates.push_back(all[static_cast<std::size_t>(i)]);
    return Program(r, rates, map.size());
}

RBDYN_INLINE FoundForm linear_motion(const Scene& scene, const SpecialModel& model) {
    const SingleLaws& laws = model.laws();
    for (const auto& law : laws.bodies())
        if (std::string why = law->why_not_linear(); !why.empty()) return {nullptr, std::move(why)};
    for (const Scene::Watch& w : scene.watches())
        if (w.options.action.kind == WatchAction::Kind::change)
            return {nullptr, "\"" + w.name + "\" changes the state on the way"};
    const std::vector<signed char> slip(laws.bodies().size(), 1);
    const Equations& e = model.equations(slip);
    constexpr const char* changing = "its equations change from one formula to the next";
    if (!e.branches.empty()) return {nullptr, changing};
    const Program& program = e.program;
    const std::vector<Dependence> known = dependences(program);
    bool is_even = true, is_forced = false;
    std::optional<std::pair<std::string, int>> varying;  // the body and the output of a velocity that time changes
    for (const auto& law : laws.bodies())
        for (int k = 0; k < law->positions() + law->velocities(); ++k) {
            const SingleLaw& b = *law;
            const int i = laws.map().place(k < b.positions() ? b.first + k : b.first_rate + k - b.positions());
            if (i < 0) continue;
            const Dependence rate = known[static_cast<std::size_t>(program.output(i))];
            if (rate == Dependence::other && program.uses_time()) {
                is_forced = true;
                if (!varying && k >= b.positions()) varying.emplace(b.name, program.output(i));
                continue;
            }
            if (rate == Dependence::other)
                return {nullptr, "the equations of " + b.name + " " + why_not_linear(program, program.output(i))};
            is_even = is_even && (k < b.positions() || rate == Dependence::constant);
        }
    constexpr const char* polynomial = "a polynomial in time, of which one step of a Taylor series is exact";
    if (is_even && !is_forced) return {nullptr, polynomial};
    const auto changes = [](const Guard& g) { return g.role == GuardRole::mode; };
    if (laws.takes_numbers()) return {nullptr, changing};
    if (std::any_of(e.guards.begin(), e.guards.end(), changes)) {
        // one direction of space at least depends on more of itself than modes or flows are made of
        if (laws.map().size() > 3 * most_in_block) return {nullptr, changing};
        auto pieces = linear_pieces(model);
        return {pieces, pieces ? "" : changing};
    }
    std::vector<double> start = model.start();
    std::vector<DoubleDouble> wide(start.begin(), start.end());
    const std::vector<double> rest = model.start_rest();
    for (std::size_t i = 0; i < rest.size(); ++i) wide[i] += rest[i];
    std::optional<ForcedSystem> system = forced_system(wide_rates(model, start, slip), std::move(wide));
    if (!system && varying)
        return {nullptr, "the equations of " + varying->first + " " + why_not_linear(program, varying->second)};
    if (!system) return {nullptr, "the equations depend on time"};
    const LinearSystem whole = system->begun(0.0);
    if (!whole.is_finite()) return {nullptr, "its equations have numbers that are not finite"};
    if (whole.is_polynomial()) return {nullptr, polynomial};
    LinearBlocks solution = solve(whole, system->own());
    if (solution.too_large > 0)
        return {nullptr, "linear, but " + std::to_string(solution.too_large) +
                             (is_forced ? " variables, those of what forces them among them, depend on each other: "
                                          "their motion costs more than integration"
                                        : " variables depend on each other: their modes cost more than integration")};
    if (!is_forced) system.reset();
    return {std::make_shared<const LinearMotion>(std::move(system), std::move(solution), std::move(start), e.groups)};
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
