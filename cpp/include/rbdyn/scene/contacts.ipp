// Definitions of rbdyn/scene/contacts.hpp.
#pragma once

#include "rbdyn/scene/contacts.hpp"

#include <cmath>
#include <type_traits>
#include <variant>

#include "rbdyn/basics/error.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void ContactOptions::validate() const {
    if (friction) friction->validate();
    require(std::isfinite(restitution) && restitution >= 0.0 && restitution <= 1.0, "contact", "restitution",
            restitution, "a coefficient of restitution is 0 to 1");
}

RBDYN_INLINE int body_of(const ContactPart& part) {
    return std::visit(
        [](const auto& p) {
            if constexpr (std::is_same_v<std::decay_t<decltype(p)>, BodyHandle>)
                return p.index;
            else
                return p.body;
        },
        part);
}

RBDYN_INLINE int body_of(const ContactSurface& surface) {
    if (const BodyPlane* plane = std::get_if<BodyPlane>(&surface)) return plane->body;
    if (const BodySphere* sphere = std::get_if<BodySphere>(&surface)) return sphere->body;
    return -1;
}

}  // namespace rbdyn::inline RBDYN_FORM
