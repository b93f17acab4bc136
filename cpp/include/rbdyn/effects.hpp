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
#include <ostream>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/scene/scene.hpp"

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

/// Runs a scene as it is and without each of its effects, each as simulate(scene, options) would. Throws what that
/// throws for the scene as it is; what goes wrong without an effect is noted in its row.
EffectTable effects(const Scene& scene, const SimulateOptions& options);

std::ostream& operator<<(std::ostream& out, const EffectTable& table);

}  // namespace rbdyn::inline RBDYN_FORM
