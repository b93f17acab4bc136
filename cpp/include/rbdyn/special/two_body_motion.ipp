// Definitions of rbdyn/special/two_body_motion.hpp.
#pragma once

#include "rbdyn/special/two_body_motion.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/kepler_motion.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/own_function.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/pair_laws.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE TwoBodyMotion::TwoBodyMotion(StateMap map, const Center& center, const KeplerMotion& between,
                                          std::vector<Share> bodies)
    : map_(std::move(map)), center_(center), between_(between), bodies_(std::move(bodies)) {}

RBDYN_INLINE void TwoBodyMotion::state(Instant since, std::span<double> x) const {
    const KeplerMotion::State d = between_.at(since);
    const DoubleDouble t(since);
    std::vector<double> all(static_cast<std::size_t>(map_.variables()));
    for (const Share& b : bodies_)
        for (int k = 0; k < 3; ++k) {
            const DoubleDouble place = center_.place[k] + t * (center_.velocity[k] + 0.5 * t * center_.acceleration[k]);
            const DoubleDouble velocity = center_.velocity[k] + t * center_.acceleration[k];
            all[static_cast<std::size_t>(b.first + k)] = double(place + b.share * d.place[k]);
            all[static_cast<std::size_t>(b.first_rate + k)] = double(velocity + b.share * d.velocity[k]);
        }
    map_.gather(all, x);
}

RBDYN_INLINE double TwoBodyMotion::error(double since, double /*wanted*/) const { return between_.error(since); }

RBDYN_INLINE double TwoBodyMotion::pace() const { return between_.period(); }

RBDYN_INLINE std::string TwoBodyMotion::name() const { return "motion of two bodies"; }

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE std::optional<DoubleDouble> inverse_square(const Coupling& coupling, const DoubleDouble& masses) {
    if (const Gravitation* gravitation = std::get_if<Gravitation>(&coupling))
        return -DoubleDouble(gravitation->constant.now()) * masses;
    const Central* central = std::get_if<Central>(&coupling);
    if (central == nullptr || !central->law().function()) return std::nullopt;
    const Function& law = central->law().function();
    if (!law.parameters().empty() || law.distinctions().outputs() > 0) return std::nullopt;
    // a formula without cases that has one value of f(r) r^2 in 30 digits at seven distances of no pattern
    constexpr std::array<double, 7> distances = {1.0, 0.37, 2.9, 0.0113, 41.7, 7.31e-5, 8.03e4};
    std::optional<DoubleDouble> first;
    for (const double distance : distances) {
        const DoubleDouble r = distance, value = law(std::span<const DoubleDouble>(&r, 1))[0] * r * r;
        if (!std::isfinite(value.hi)) return std::nullopt;
        if (!first) first = value;
        if (!(std::abs((value - *first).hi) <= 1e-29 * std::abs(first->hi))) return std::nullopt;
    }
    return first;
}

RBDYN_INLINE FoundForm two_body_motion(const Scene& scene, const SingleLaws& laws) {
    const std::size_t count = scene.bodies().size();
    if (count > 2 || laws.takes_numbers()) return {};
    for (const Scene::Body& b : scene.bodies())
        if (b.rigid() != nullptr || b.rail() != nullptr) return {};
    for (const Scene::AppliedLoad& l : scene.loads())
        if (is_present(l.load)) return {};
    const Scene::Connection* joins = nullptr;
    for (const Scene::Connection& c : scene.connections()) {
        if (!is_present(c.coupling)) continue;
        if (joins != nullptr) return {};
        joins = &c;
    }
    for (const Scene::Watch& w : scene.watches())
        if (w.options.action.kind == WatchAction::Kind::change) return {};
    if (joins == nullptr) return {};

    const auto state = [&](int i) {
        const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(i)];
        return KeplerMotion::State{widened(b.position), widened(b.velocity)};
    };
    const auto index = [](const End& end) {
        const BodyHandle* handle = std::get_if<BodyHandle>(&end);
        return handle != nullptr ? handle->index : -1;
    };
    const auto share = [&](int i, const DoubleDouble& of) {
        const SingleLaw& b = laws.body(i);
        return TwoBodyMotion::Share{b.first, b.first_rate, of};
    };
    KeplerMotion::State d;
    TwoBodyMotion::Center center;
    std::vector<TwoBodyMotion::Share> bodies;
    DoubleDouble mu;
    const int a = index(joins->a), b = index(joins->b);
    if (count == 2) {
        if (a < 0 || b < 0 || a == b) return {};
        const KeplerMotion::State of_a = state(a), of_b = state(b);
        const DoubleDouble mass_a = scene.bodies()[static_cast<std::size_t>(a)].mass(),
                           mass_b = scene.bodies()[static_cast<std::size_t>(b)].mass(), whole = mass_a + mass_b;
        const std::optional<DoubleDouble> c = inverse_square(joins->coupling, mass_a * mass_b);
        if (!c) return {};
        mu = -*c * whole / (mass_a * mass_b);
        d = {of_a.place - of_b.place, of_a.velocity - of_b.velocity};
        const DoubleDouble part_a = mass_a / whole, part_b = mass_b / whole;
        center = {of_a.place * part_a + of_b.place * part_b, of_a.velocity * part_a + of_b.velocity * part_b,
                  widened(scene.gravity())};
        bodies = {share(a, part_b), share(b, -part_a)};
    } else {
        const Vector3* fixed = std::get_if<Vector3>(a >= 0 ? &joins->b : &joins->a);
        if (fixed == nullptr || !scene.gravity().isZero(0.0)) return {};
        const std::optional<DoubleDouble> c = inverse_square(joins->coupling, 0.0);
        if (!c) return {};
        mu = -*c / scene.bodies()[0].mass();
        d = state(0);
        center.place = widened(*fixed);
        d.place -= center.place;
        bodies = {share(0, 1.0)};
    }
    if (KeplerMotion::is_radial(d.place, d.velocity)) return {nullptr, "the two move along one line"};
    return {std::make_shared<const TwoBodyMotion>(laws.map(), center, KeplerMotion(mu, d.place, d.velocity),
                                                  std::move(bodies))};
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
