// The JSON schema of scenes' files, made from what reads and writes them (described.hpp): editors check and complete
// files by it, and other programs write them by it.
//
// Convention: JSON Schema, draft 2020-12 (json-schema.org). What it allows is more than what is read: rules between
// numbers, and names that must be there, are rules of the classes, which are checked as what a program says is.
#pragma once

#include <string>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The schema, as a text.
[[gnu::cold]] std::string scene_schema();

}  // namespace rbdyn::inline RBDYN_FORM
