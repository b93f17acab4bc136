// The recording that is under way: what a parameter of the user's becomes part of when it is used.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace recording {

/// The recorder of the innermost recording under way in this thread, if any.
Recorder*& active();

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

}  // namespace rbdyn::inline RBDYN_FORM
