// Definitions of rbdyn/scene/couplings.hpp.
#pragma once

#include "rbdyn/scene/couplings.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/own_function.hpp"
#include "rbdyn/scene/pair_laws.hpp"
#include "rbdyn/scene/spring.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE double effort_of(const Coupling& coupling, const PairState<double>& p, double force) {
    const double places = p.ra.norm() + p.rb.norm();
    if (const Spring* spring = std::get_if<Spring>(&coupling))
        return spring->stiffness.now() * (places + spring->rest_length.now()) +
               spring->damping.now() * (p.va.norm() + p.vb.norm());
    // of a power of the distance, as most are
    const double length = (p.ra - p.rb).norm();
    return length > 0.0 ? 2.0 * force * places / length : 0.0;
}

RBDYN_INLINE std::optional<double> potential_of(const Coupling& coupling, double length, double reference,
                                                double masses) {
    if (!is_present(coupling)) return 0.0;
    if (const Spring* spring = std::get_if<Spring>(&coupling)) return spring->potential(length);
    if (const Gravitation* gravitation = std::get_if<Gravitation>(&coupling))
        return gravitation->potential(length, masses);
    if (const Central* central = std::get_if<Central>(&coupling)) return central->gain(reference, length);
    return std::nullopt;
}

RBDYN_INLINE bool is_present(const Coupling& coupling) {
    return std::visit([](const auto& c) { return c.present(); }, coupling);
}

RBDYN_INLINE std::string without_direction(const Coupling& coupling, const PairState<double>& p) {
    const Vector3 d = p.ra - p.rb, v = p.va - p.vb;
    if (couplings::direction(d, v, p.ra.norm() + p.rb.norm()) != Vector3(0, 0, 0)) return {};
    double force = 0.0;
    if (const Spring* spring = std::get_if<Spring>(&coupling))
        force = spring->stiffness.now() * spring->rest_length.now();
    if (const Central* central = std::get_if<Central>(&coupling)) force = std::abs(central->magnitude(0.0));
    if (!(force > 0.0)) return {};
    return "whose ends are at one place and at rest to each other, so that its force of " + text(force) +
           " N has no direction: let them be a little apart, or part with a velocity, in the direction they are to "
           "take";
}

RBDYN_INLINE bool keeps_energy(const Coupling& coupling) {
    if (const Spring* spring = std::get_if<Spring>(&coupling)) return spring->damping.is_zero();
    return !std::holds_alternative<PairForce>(coupling);
}

RBDYN_INLINE bool is_along_its_line(const Coupling& coupling) { return !std::holds_alternative<PairForce>(coupling); }

RBDYN_INLINE const OwnFunction* own_function(const Coupling& coupling) {
    if (const Central* central = std::get_if<Central>(&coupling)) return &central->law();
    if (const PairForce* pair = std::get_if<PairForce>(&coupling)) return &pair->law();
    return nullptr;
}

RBDYN_INLINE std::string_view kind_of(const Coupling& coupling) {
    constexpr std::string_view kinds[] = {"spring", "gravitation", "central force", "pair force"};
    static_assert(std::size(kinds) == std::variant_size_v<Coupling>);
    return kinds[coupling.index()];
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::couplings {

RBDYN_INLINE std::vector<std::string_view> effects_of(const Coupling& coupling) {
    std::vector<std::string_view> effects;
    if (const Spring* spring = std::get_if<Spring>(&coupling)) {
        if (!spring->stiffness.is_zero()) effects.push_back("spring");
        if (!spring->damping.is_zero()) effects.push_back("damper");
    } else if (is_present(coupling)) {
        effects.push_back(std::holds_alternative<PairForce>(coupling) ? "user force" : kind_of(coupling));
    }
    return effects;
}

RBDYN_INLINE Coupling nothing_of(const Coupling& coupling) {
    return std::visit([](const auto& c) -> Coupling { return std::decay_t<decltype(c)>{}; }, coupling);
}

}  // namespace rbdyn::inline RBDYN_FORM::couplings
