// Couplings: forces between two points, as values that say what they exert and what they keep.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/own_function.hpp"
#include "rbdyn/scene/pair_laws.hpp"
#include "rbdyn/scene/spring.hpp"

namespace rbdyn::inline RBDYN_FORM {

using Coupling = std::variant<Spring, Gravitation, Central, PairForce>;

/// Places and velocities of the two ends of a coupling at a time, and the product of the masses of their bodies.
template <class S>
struct PairState {
    S t;
    Vector3Of<S> ra, rb, va, vb;
    S masses;
};

/// The force of a coupling on its first end; places as it is given them, those of a PairForce in the world's axes.
template <class S>
Vector3Of<S> force_of(const Coupling& coupling, const PairState<S>& p) {
    if (const PairForce* pair = std::get_if<PairForce>(&coupling)) return (*pair)(p.t, p.ra, p.rb, p.va, p.vb);
    const Vector3Of<S> d = p.ra - p.rb, v = p.va - p.vb;
    if (const Gravitation* gravitation = std::get_if<Gravitation>(&coupling))
        return gravitation->template operator()<S>(d, p.masses);
    if constexpr (std::is_same_v<S, double>) {
        const double size = p.ra.norm() + p.rb.norm();
        if (const Central* central = std::get_if<Central>(&coupling)) return (*central)(d, v, size);
        return std::get<Spring>(coupling)(d, v, size);
    } else {
        if (const Central* central = std::get_if<Central>(&coupling)) return (*central)(d);
        return std::get<Spring>(coupling)(d, v);
    }
}

/// Sizes of the terms of that force, some epsilon of which is its rounding, beside its own length [N].
double effort_of(const Coupling& coupling, const PairState<double>& p, double force);

/// What is to be said of a force along the line of the ends where there is no such line: they are at one place, and
/// their velocities do not say where to. Empty if there is one, or no force.
std::string without_direction(const Coupling& coupling, const PairState<double>& p);

/// U of a coupling whose ends are a distance apart, with F = +grad U (the chapter's sign) [J]; none of a PairForce.
/// `reference`: the distance at which that of a Central is zero.
std::optional<double> potential_of(const Coupling& coupling, double length, double reference, double masses);

/// Whether a coupling does anything.
bool is_present(const Coupling& coupling);

/// Whether it keeps energy: whether its force is all that of its potential.
bool keeps_energy(const Coupling& coupling);

/// Whether its force is along the line of its ends, and so keeps angular momentum.
bool is_along_its_line(const Coupling& coupling);

/// What of a coupling is a function of the user's; nullptr if nothing.
const OwnFunction* own_function(const Coupling& coupling);

/// "spring", "gravitation", "central force", "pair force": what messages call it.
std::string_view kind_of(const Coupling& coupling);

namespace couplings {

/// The names of its effects.
std::vector<std::string_view> effects_of(const Coupling& coupling);

/// One of its kind that does nothing.
Coupling nothing_of(const Coupling& coupling);

}  // namespace couplings

}  // namespace rbdyn::inline RBDYN_FORM
