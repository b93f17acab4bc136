// What goes wrong, said once: every message names the object, the number, the rule and the fix.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Base of every error of this library.
struct Error : std::runtime_error {
    /// A zero in the message, of a name that was given, say, is written \x00: what() would end there.
    explicit Error(std::string message);
};

/// A value that breaks a rule of the interface. Also a ValueError in Python.
struct InvalidInput : Error {
    using Error::Error;
};

/// A double as text that reads back as the same double, short where that is possible.
std::string text(double value);

/// Throws InvalidInput("<object>: <what> is <value>; <rule>").
[[noreturn, gnu::cold]] void refuse(std::string_view object, std::string_view what, double value,
                                    std::string_view rule);

/// The same unless the condition holds.
void require(bool condition, std::string_view object, std::string_view what, double value, std::string_view rule);

/// Throws InvalidInput where a zero is in a name: files and other programs would end the name there.
void require_no_zero(std::string_view object, std::string_view name);

}  // namespace rbdyn::inline RBDYN_FORM
