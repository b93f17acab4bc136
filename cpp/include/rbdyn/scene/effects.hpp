// Effects: what acts in a scene, by the names of a closed list, and the same scene with less of it.
//
// What is taken away stays in its place as a load, coupling or joint that does nothing, so that every handle of the
// scene is good for the one without it. Some of the names need a word:
//   static friction   beside dynamic friction there is as much of it: what goes is what it has more. Alone, all goes.
//   rotation          a free body becomes a particle at its centre of mass; forces on points of it act there, torques
//                     go. A body that a joint leaves nothing but rotation has no motion without it, and is refused.
//   contact           it neither closes nor pushes, and its friction goes with it: bodies pass through each other.
//   impact            restitution: what lands stays closed.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace acting {

/// All names there are, in the order in which they are told.
inline constexpr std::array<std::string_view, 15> names = {
    "gravity",     "rotation",         "spring",          "damper",      "drag",
    "gravitation", "central force",    "user force",      "user torque", "drive",
    "moving rail", "dynamic friction", "static friction", "contact",     "impact"};

template <class Words>
std::string listed(const Words& words) {
    std::string list;
    for (const std::string_view w : words) list += (list.empty() ? "" : ", ") + std::string(w);
    return list.empty() ? "none" : list;
}

/// Whether a body turns where it goes.
inline bool turns(const Scene::Body& b) { return b.rigid() != nullptr && !std::holds_alternative<Prismatic>(b.joint); }

/// Whether a load is a torque of the user's.
bool turns(const Load& load);

/// A load of the same kind that does nothing.
Load nothing_of(const Load& load);

}  // namespace acting

/// The effects of a scene, of the closed list and in its order. A function of numbers of the user's counts as present
/// until they are frozen().
[[gnu::cold]] std::vector<std::string> effects_of(const Scene& scene);

}  // namespace rbdyn::inline RBDYN_FORM
