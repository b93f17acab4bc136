// What a value that breaks a rule is refused with.
#pragma once

#include <string>

#include "rbdyn/basics/error.hpp"

namespace rbdyn::test {

/// The message of the InvalidInput that `make` throws, or "accepted".
template <class Make>
std::string refusal(const Make& make) {
    try {
        make();
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace rbdyn::test
