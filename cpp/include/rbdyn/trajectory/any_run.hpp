// What every run says of itself, be it of a scene or of a model of the user's own.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/event.hpp"

namespace rbdyn::inline RBDYN_FORM {

class AnyRun {
public:
    Status status() const { return status_; }
    double start() const { return start_; }
    double end() const { return end_; }
    /// The time up to which the motion is as accurate as asked for [s].
    double certain_until() const { return certain_until_; }
    const std::string& engine() const { return engine_; }
    /// Estimated global error, each quantity relative to its own scale in this motion; none with rtol.
    std::optional<double> error() const { return error_; }

protected:
    AnyRun(Status status, double start, double end, double certain_until, std::string engine,
           std::optional<double> error)
        : status_(status),
          start_(start),
          end_(end),
          certain_until_(certain_until),
          engine_(std::move(engine)),
          error_(error) {}

private:
    Status status_;
    double start_, end_, certain_until_;  // s
    std::string engine_;
    std::optional<double> error_;
};

/// What a run says of its error.
std::string error_in_words(const AnyRun& run);

}  // namespace rbdyn::inline RBDYN_FORM
