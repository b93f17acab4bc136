// Definitions of rbdyn/expression/recording.hpp.
#pragma once

#include "rbdyn/expression/recording.hpp"

#include <string>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM::recording {

RBDYN_INLINE Recorder*& active() {
    static thread_local Recorder* recorder = nullptr;
    return recorder;
}

}  // namespace rbdyn::inline RBDYN_FORM::recording

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Parameter::operator Expression() const {
    Recorder* recorder = recording::active();
    if (recorder == nullptr)
        throw InvalidInput("parameter" + (name().empty() ? std::string() : " " + name()) +
                           ": it is part of a function while that is recorded; elsewhere ask for its value");
    return recorder->cell(*this);
}

}  // namespace rbdyn::inline RBDYN_FORM
