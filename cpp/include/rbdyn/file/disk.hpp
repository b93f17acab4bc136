// Files read and written whole.
//
// What is written takes the place of a regular file at once, when all of it is there; that file's mode and owner stay,
// and a symbolic link goes on naming it. What is no regular file (a pipe, a device) is written straight into.
#pragma once

#include <string>
#include <string_view>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

/// The text of a file. Throws InvalidInput where the system refuses.
[[gnu::cold]] std::string read_file(const std::string& path);
/// Writes it. Throws InvalidInput where the system refuses.
[[gnu::cold]] void write_file(const std::string& path, std::string_view text);
/// Writes it, and returns why that failed; empty if it did not.
[[gnu::cold]] std::string trouble_writing(const std::string& path, std::string_view text);

}  // namespace rbdyn::inline RBDYN_FORM::file
