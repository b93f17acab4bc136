// Definitions of rbdyn/scene/recorded_action.hpp.
#pragma once

#include "rbdyn/scene/recorded_action.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace actions {

using Pair = std::array<double, 2>;
using Set = void (*)(StateChange&, const double*);

struct Known {
    std::string_view word;
    int numbers;
    Set set;
};

template <auto member>
constexpr Set number = [](StateChange& c, const double* x) { c.*member = x[0]; };
template <auto member>
constexpr Set pair = [](StateChange& c, const double* x) {
    c.*member = Pair{x[0], x[1]};
};
template <auto member>
constexpr Set vector = [](StateChange& c, const double* x) { c.*member = Vector3(x[0], x[1], x[2]); };

inline constexpr std::array<Known, 15> known = {
    {{"position", 3, vector<&StateChange::position>},
     {"velocity", 3, vector<&StateChange::velocity>},
     {"position (2)", 2, pair<&StateChange::position_in_plane>},
     {"velocity (2)", 2, pair<&StateChange::velocity_in_plane>},
     {"parameter", 1, number<&StateChange::parameter>},
     {"speed", 1, number<&StateChange::speed>},
     {"attitude", 4,
      [](StateChange& c, const double* x) {
          c.attitude = Attitude(Quaternion{x[0], x[1], x[2], x[3]});
      }},
     {"angular_velocity", 3, vector<&StateChange::angular_velocity>},
     {"angular_velocity_world", 3, vector<&StateChange::angular_velocity_world>},
     {"angle", 1, number<&StateChange::angle>},
     {"angles", 2, pair<&StateChange::angles>},
     {"displacement", 1, number<&StateChange::displacement>},
     {"rate", 1, number<&StateChange::rate>},
     {"rates", 2, pair<&StateChange::rates>},
     {"displacement_rate", 1, number<&StateChange::displacement_rate>}}};

RBDYN_INLINE const Known* find(const std::string& word) {
    const auto* const found = std::find_if(known.begin(), known.end(), [&](const Known& k) { return k.word == word; });
    return found == known.end() ? nullptr : found;
}

}  // namespace actions

RBDYN_INLINE int RecordedAction::numbers(const std::string& word) {
    const actions::Known* const found = actions::find(word);
    return found == nullptr ? 0 : found->numbers;
}

RBDYN_INLINE RecordedAction::RecordedAction(Function function, std::vector<Observable> asked, std::vector<Word> words)
    : function_(std::move(function)), asked_(std::move(asked)), words_(std::move(words)) {
    int results = 0;
    for (const Word& w : words_) {
        if (numbers(w.word) == 0) throw InvalidInput("an action changes \"" + w.word + "\", which no joint has");
        results += numbers(w.word);
    }
    if (function_.inputs() != static_cast<int>(asked_.size()) || function_.outputs() != results)
        throw InvalidInput("the function of an action has " + std::to_string(function_.inputs()) + " inputs and " +
                           std::to_string(function_.outputs()) + " results; it has one input for each of the " +
                           std::to_string(asked_.size()) + " it asks for, and " + std::to_string(results) +
                           " results for what it changes");
}

RBDYN_INLINE std::vector<StateChange> RecordedAction::operator()(const Observe& observe) const {
    std::vector<double> x;
    for (const Observable& o : asked_) x.push_back(observe(o));
    const std::vector<double> y = function_(std::span<const double>(x));
    std::vector<StateChange> changes;
    const double* next = y.data();
    for (const Word& w : words_) {
        auto found =
            std::find_if(changes.begin(), changes.end(), [&](const StateChange& c) { return c.body.index == w.body; });
        if (found == changes.end()) found = changes.insert(changes.end(), StateChange{BodyHandle{w.body}});
        const actions::Known& word = *actions::find(w.word);
        word.set(*found, next);
        next += word.numbers;
    }
    return changes;
}

RBDYN_INLINE RecordedAction RecordedAction::frozen() const {
    RecordedAction result = *this;
    result.function_ = function_.frozen();
    return result;
}

RBDYN_INLINE const RecordedAction* recorded(const WatchAction& action) {
    return action.change ? action.change.target<RecordedAction>() : nullptr;
}

}  // namespace rbdyn::inline RBDYN_FORM
