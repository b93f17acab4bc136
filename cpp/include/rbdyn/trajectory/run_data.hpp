// What a run is made of, and what it cost.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/trajectory/euler_track.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The price of a run.
struct Statistics {
    double seconds = 0.0;              // the whole call, estimate of the error included
    double integration_seconds = 0.0;  // the returned motion alone
    std::int64_t steps = 0, rejected = 0, right_hand_sides = 0, jacobians = 0, guard_evaluations = 0, events = 0;
    std::int64_t python_calls = 0;
    int runs = 1;         // integrations, those for the estimate counted
    Size size;            // of the equations the motion began with; of several parts the sum
    bool planned = true;  // anew, and not as an earlier run was
};

std::ostream& operator<<(std::ostream& out, const Statistics& s);

/// The events of a run, in order of time.
class Events : public std::vector<Event> {
public:
    using std::vector<Event>::vector;
    explicit Events(std::vector<Event> events) : std::vector<Event>(std::move(events)) {}

    /// Times of the events of a kind or name, of one body if given.
    std::vector<double> times(const std::string& kind_or_name, std::optional<BodyHandle> subject = std::nullopt) const;
};

/// What a trajectory is made of.
struct RunData {
    Scene scene;
    Plan plan;
    std::vector<RunData> parts;                // those of the plan, which then have the motion and this has none
    std::shared_ptr<const PointsModel> model;  // none if there are parts
    Record record;
    Events events;
    std::string engine;
    std::optional<double> error;  // estimated global error, relative to the motion's scales
    double certain_until = 0.0;
    Statistics statistics;
    std::shared_ptr<EulerTrack> angles = std::make_shared<EulerTrack>();
};

/// The run of the part that something of a scene is in, which keeps the whole, and its index there; of what is in no
/// part those of the whole.
std::pair<std::shared_ptr<const RunData>, int> part_of(const std::shared_ptr<const RunData>& run,
                                                       std::vector<SceneParts::Place> SceneParts::*things, int index);

/// The state of a run of one part at a time. Throws InvalidInput for a time it does not hold.
struct Moment {
    const Mode& mode;
    std::vector<double> x;

    Moment(const RunData& data, double t, Side side);

private:
    static const Mode& mode_at(const Record& record, double t, Side side);
};

}  // namespace rbdyn::inline RBDYN_FORM
