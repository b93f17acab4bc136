// What a watched function does to the state, recorded: data as other functions of the user's are, so that scenes with
// it are compared, saved and pickled.
#pragma once

#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A functor for WatchAction::change: new values of words of bodies, a function of what it asks for.
class RecordedAction {
public:
    /// A word of a body's joint, as StateChange::words() has it.
    struct Word {
        int body = -1;
        std::string word;
        bool operator==(const Word&) const = default;
    };

    /// Throws InvalidInput unless the function has an input for each thing asked for, and results for all words.
    RecordedAction(Function function, std::vector<Observable> asked, std::vector<Word> words);

    std::vector<StateChange> operator()(const Observe& observe) const;

    const Function& function() const { return function_; }
    const std::vector<Observable>& asked() const { return asked_; }
    const std::vector<Word>& words() const { return words_; }
    /// With the numbers of the user's as they are now.
    RecordedAction frozen() const;
    bool operator==(const RecordedAction&) const = default;

    /// How many numbers a word has: of an attitude a quaternion's four. 0 for a word that there is not.
    static int numbers(const std::string& word);

private:
    Function function_;
    std::vector<Observable> asked_;
    std::vector<Word> words_;
};

/// The recorded one that an action is, or nullptr.
const RecordedAction* recorded(const WatchAction& action);

}  // namespace rbdyn::inline RBDYN_FORM
