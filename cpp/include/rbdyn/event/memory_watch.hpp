// Whether what a run keeps will fit into memory: said before it is full.
//
// What is kept is looked at after 256 steps, 512, 1024 and so on. If in two such rows of steps, one after the other, it
// grew with them, and so fast that at the end of the run, or by max_steps, it takes more than half of the memory that
// is available, whoever runs is warned, once. Short runs and small ones cost a comparison a step.
#pragma once

#include <cstdint>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/event/record.hpp"

namespace rbdyn::inline RBDYN_FORM {

class MemoryWatch {
public:
    /// `copies`: how often there will be each event, in runs that are compared and in lists of them.
    MemoryWatch(Warn warn, double copies);

    /// After so many steps of a run that has come to time t.
    void after(std::int64_t steps, const Record& record, double t, double until, std::int64_t max_steps) {
        if (steps >= next_) look(steps, record, t, until, max_steps);
    }

private:
    void look(std::int64_t steps, const Record& record, double t, double until, std::int64_t max_steps);

    static constexpr std::int64_t first = 256;
    // bytes that are worth asking how many there are
    static constexpr double little = 5e7;
    static constexpr double share = 0.5;
    // of what is kept, in a row of steps as long as all before: what grows with them grows by half
    static constexpr double steadily = 0.3;

    Warn warn_;
    double copies_;
    std::int64_t next_, steps_ = 0;
    double bytes_ = 0.0, events_ = 0.0, t_ = 0.0;  // at the last look
    bool was_much_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM
