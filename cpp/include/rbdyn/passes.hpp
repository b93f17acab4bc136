// The integrations that a solution is made of: a first one, and one that it is held against.
//
// They may be made before the solution asks for them, side by side with those of other members (members_abreast.hpp).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/course.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/options.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

struct Timed {
    Record record;
    double seconds = 0.0;
};

/// How an integration is made, and what of it is kept.
struct Pass {
    double tolerance = 0.0;
    Manner manner = {};
    Keep keep = {};
};

/// The first one of a motion: the only one if a local tolerance is asked for.
Pass first_pass(const HybridModel& model, const SimulateOptions& options, const std::string& engine);
/// The one that it is held against. `is_judge`: by the same engine. `amplifies`: rounding may have grown alike in both.
Pass judging_pass(const SimulateOptions& options, const std::string& engine, bool is_judge, const Pass& first,
                  const Record& record, bool amplifies);

/// Integrations of a motion that are made already. What is asked for is looked for by how it is made; what is kept of
/// it is the same then.
class Ahead {
public:
    void add(Pass pass, Timed timed);
    /// What they took.
    double seconds() const { return seconds_; }
    /// None if there is no such one.
    std::optional<Timed> take(const Pass& pass);

private:
    std::vector<std::pair<Pass, Timed>> made_;
    double seconds_ = 0.0;
};

}  // namespace rbdyn::inline RBDYN_FORM::simulating
