// Where a motion starts, keyword by keyword: what add() takes, replace() and initial= change, and a sweep varies.
#pragma once

#include <optional>
#include <rbdyn/scene/scene.hpp>
#include <string>
#include <variant>

#include "handles.hpp"

namespace binding {

using AnyBody = std::variant<rbdyn::Particle, rbdyn::RigidBody>;

/// The words of a start as they were given. Numbers that break a rule are an InvalidInput that names `object`; a word
/// that the joint does not have is one of `verb`: a TypeError where the words are keywords.
struct StartWords {
    py::dict given;
    std::string object, verb;
    bool are_keywords = true;
};

/// The start of a body that is added: words that are not given are zero. None: the joint cannot hold the body.
std::optional<rbdyn::Start> start_of(const AnyBody& body, const rbdyn::Joint& joint, const StartWords& words);

/// Lets a body start elsewhere: words that are not given stay as they are, an angular velocity in the axes it was given
/// in.
void restart(rbdyn::Scene& scene, rbdyn::BodyHandle body, const StartWords& words);

/// The same with the words of a mapping from (handle, word) to values, for the bodies that it names.
void restart(rbdyn::Scene& scene, const Handles& handles, const py::dict& initial, const std::string& verb);

/// The handle and the word of a key. Throws InvalidInput for anything else.
std::pair<rbdyn::BodyHandle, std::string> word_of(const Handles& handles, const py::handle& key,
                                                  const std::string& verb);

}  // namespace binding
