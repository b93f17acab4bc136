// What a run is made of, and what it cost.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/course.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/trajectory/error_scales.hpp"
#include "rbdyn/trajectory/euler_track.hpp"
#include "rbdyn/trajectory/events.hpp"
#include "rbdyn/trajectory/statistics.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What a trajectory is made of.
struct RunData {
    Scene scene;
    Plan plan;
    std::vector<RunData> parts;               // those of the plan, which then have the motion and this has none
    std::shared_ptr<const SceneModel> model;  // none if there are parts
    Record record;
    Events events;
    std::string engine;
    std::optional<double> error;  // estimated global error, relative to the motion's scales
    double certain_until = 0.0;
    Statistics statistics;
    SimulateOptions asked;  // for it, but whom it told how far it was
    double origin = 0.0;    // s: where the motion began that it goes on with; its own start if it goes on with none
    // what goes on from its end (integrate.hpp): the run, the better one it was held against, the scales of the motion
    std::optional<simulating::Course> course, judge;
    ErrorScales scales;
    std::vector<std::optional<EulerAngles>> first_angles;  // by body, of a run that goes on with another
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
