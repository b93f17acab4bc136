// Definitions of rbdyn/scene/handles.hpp.
#pragma once

#include "rbdyn/scene/handles.hpp"

#include <variant>

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE int body_of(const End& end) {
    if (const BodyHandle* body = std::get_if<BodyHandle>(&end)) return body->index;
    if (const BodyPoint* point = std::get_if<BodyPoint>(&end)) return point->body;
    return -1;
}

}  // namespace rbdyn::inline RBDYN_FORM
