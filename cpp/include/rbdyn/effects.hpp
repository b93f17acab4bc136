// effects(): what each effect does to the motion of a scene, and to its price.
//
// The scene is run as it is, and once without each of its effects (scene/effects.hpp). The difference of two runs is
// that of their states at the end, measured by the scales of the motion as errors are: of each body the place of its
// centre of mass to the extent of the motion, velocity and angular velocity to their largest size, the attitude as an
// angle in radians; the largest of these. Extents and sizes are those of whichever of the two runs has more, so that a
// motion that an effect prevents has a scale too. Without rotation a body keeps the attitude it starts with, and does
// not turn.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What one effect does.
struct EffectRow {
    std::string effect;
    double difference = std::numeric_limits<double>::quiet_NaN();  // of the states at the end, in the motion's scales
    double time = std::numeric_limits<double>::quiet_NaN();        // s, where they are compared: the earlier end
    int gained = 0, lost = 0;                                      // events that it brings, and that it prevents
    double seconds = std::numeric_limits<double>::quiet_NaN();     // of simulate() without it
    std::int64_t steps = 0;                                        // without it
    std::string note = {};                                         // why there are no numbers, or not all
};

/// The table: one row an effect.
struct EffectTable {
    std::vector<EffectRow> rows;
    double seconds = 0.0;  // of simulate() with all of them
    std::int64_t steps = 0;
    int events = 0;

    /// The row of an effect; throws InvalidInput if there is none.
    const EffectRow& operator[](const std::string& effect) const;
};

namespace comparing {

/// What is compared of a body at a time.
struct Kinematics {
    Vector3 place, velocity, turning = Vector3::Zero();
    Quaternion attitude = {};

    Kinematics(const Trajectory& run, int body, const Attitude& held, double t);
};

/// The scales of a body's motion in one or more runs.
struct KinematicScales {
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    double size = 0.0, speed = 0.0, turning = 0.0;

    void take(const Trajectory& run, int body, double end);
};

/// The angle between two attitudes.
double angle_between(const Quaternion& p, const Quaternion& q);

/// The largest difference of the states of two runs at a time, in the scales of their motions until then. `whole`: the
/// scene of which they are runs, with all of it or less.
double difference(const Trajectory& a, const Trajectory& b, const Scene& whole, double time);

/// How many events of each kind, subject and name there are until a time.
std::map<std::tuple<EventKind, int, std::string>, int> counted(const Trajectory& run, double until);

}  // namespace comparing

/// Runs a scene as it is and without each of its effects, each as simulate(scene, options) would. Throws what that
/// throws for the scene as it is; what goes wrong without an effect is noted in its row.
EffectTable effects(const Scene& scene, const SimulateOptions& options);

std::ostream& operator<<(std::ostream& out, const EffectTable& table);

}  // namespace rbdyn::inline RBDYN_FORM
