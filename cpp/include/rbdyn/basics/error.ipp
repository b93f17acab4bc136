// Definitions of rbdyn/basics/error.hpp.
#pragma once

#include "rbdyn/basics/error.hpp"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace rbdyn::inline RBDYN_FORM {

namespace errors {

RBDYN_INLINE std::string without_zeros(std::string message) {
    for (std::size_t at = 0; (at = message.find('\0', at)) != std::string::npos;) message.replace(at, 1, "\\x00");
    return message;
}

}  // namespace errors

RBDYN_INLINE Error::Error(std::string message) : std::runtime_error(errors::without_zeros(std::move(message))) {}

RBDYN_INLINE std::string text(double value) {
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

RBDYN_INLINE void refuse(std::string_view object, std::string_view what, double value, std::string_view rule) {
    std::string message(object);
    message.append(": ").append(what).append(" is ").append(text(value)).append("; ").append(rule);
    throw InvalidInput(message);
}

RBDYN_INLINE void require(bool condition, std::string_view object, std::string_view what, double value,
                          std::string_view rule) {
    if (!condition) refuse(object, what, value, rule);
}

RBDYN_INLINE void require_no_zero(std::string_view object, std::string_view name) {
    if (name.find('\0') == std::string_view::npos) return;
    std::string message(object);
    message.append(": name is \"").append(name).append("\"; no name has a zero in it, give another");
    throw InvalidInput(message);
}

}  // namespace rbdyn::inline RBDYN_FORM
