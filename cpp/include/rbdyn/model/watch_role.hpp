// What the guard of a watched function stands for.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

inline GuardRole role_of(WatchAction::Kind action) {
    switch (action) {
        case WatchAction::Kind::record: return GuardRole::record;
        case WatchAction::Kind::stop: return GuardRole::stop;
        case WatchAction::Kind::change: break;
    }
    return GuardRole::mode;
}

}  // namespace rbdyn::inline RBDYN_FORM
