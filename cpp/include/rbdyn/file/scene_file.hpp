// Scenes as files: JSON that people can read and change (docs/files.md says what there is), and as the same text.
//
// A scene that was written and read is equal to what it was, to the last bit of every number. What is read is checked
// as what a program says is, and more: complaints name the place in the file. Functions that are called back are no
// data and are refused.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A scene as the text of a file. Throws InvalidInput if a function in it is called back.
[[gnu::cold]] std::string text_of(const Scene& scene);
/// The same with the numbers of the user's that it uses, in the order in which the text has them.
[[gnu::cold]] std::pair<std::string, std::vector<Parameter>> text_and_parameters(const Scene& scene);
/// The same where actions that change the state may be called back, without these: what scenes are known by, and
/// nothing to be read.
[[gnu::cold]] std::string text_without_actions(const Scene& scene);
/// And back. `document`: what complaints call it. `parameters`: take the place of those of the text, if there are any.
[[gnu::cold]] Scene scene_from(std::string_view text, const std::string& document = "scene",
                               const std::vector<Parameter>& parameters = {});

/// Writes a scene to a file. Throws InvalidInput if a function in it is called back, or the system refuses.
[[gnu::cold]] void save(const Scene& scene, const std::string& path);
/// Reads it. Throws InvalidInput, with the place in the file, for what is no scene.
[[gnu::cold]] Scene load_scene(const std::string& path);

}  // namespace rbdyn::inline RBDYN_FORM
