// What goes wrong, said once: every message names the object, the number, the rule and the fix.
#pragma once

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rbdyn {

/// Base of every error of this library.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A value that breaks a rule of the interface. Also a ValueError in Python.
struct InvalidInput : Error {
    using Error::Error;
};

/// A double as text that reads back as the same double, short where that is possible.
[[gnu::noinline]] inline std::string text(double value) {
    if (std::isnan(value)) return "nan";
    char digits[32];
    double back = 0.0;
    char* end = digits;
    // 17 digits are enough for every double
    for (int count = 6; count <= 17 && !(back == value && end != digits); ++count) {
        end = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, count).ptr;
        std::from_chars(digits, end, back);
    }
    return std::string(digits, end);
}

/// Throws InvalidInput("<object>: <what> is <value>; <rule>").
[[noreturn, gnu::cold, gnu::noinline]] inline void refuse(std::string_view object, std::string_view what, double value,
                                                          std::string_view rule) {
    std::string message(object);
    message.append(": ").append(what).append(" is ").append(text(value)).append("; ").append(rule);
    throw InvalidInput(message);
}

/// The same unless the condition holds.
inline void require(bool condition, std::string_view object, std::string_view what, double value,
                    std::string_view rule) {
    if (!condition) refuse(object, what, value, rule);
}

}  // namespace rbdyn
