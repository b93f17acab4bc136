// The recording that is under way: what a parameter of the user's becomes part of when it is used.
#pragma once

#include "rbdyn/expression/expression.hpp"

namespace rbdyn {

namespace recording {

/// The recorder of the innermost recording under way in this thread, if any.
inline Recorder*& active() {
    static thread_local Recorder* recorder = nullptr;
    return recorder;
}

/// Makes a recorder the active one for as long as this lives.
class Active {
public:
    explicit Active(Recorder& recorder) : before_(active()) { active() = &recorder; }
    ~Active() { active() = before_; }
    Active(const Active&) = delete;
    Active& operator=(const Active&) = delete;

private:
    Recorder* before_;
};

}  // namespace recording

inline Parameter::operator Expression() const {
    Recorder* recorder = recording::active();
    if (recorder == nullptr)
        throw InvalidInput("parameter" + (name().empty() ? std::string() : " " + name()) +
                           ": it is part of a function while that is recorded; elsewhere ask for its value");
    return recorder->cell(*this);
}

}  // namespace rbdyn
