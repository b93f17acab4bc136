// The equations of a scene of single bodies as recorded programs, one for each structure: which bodies stick, slip or
// fly, and on which side of every case distinction they are.
//
// What does not move is not in the equations: a bead that sticks to a rail at rest is a parameter, not a variable; what
// stays as it starts is a number (what_stays.hpp).
// Guards: those of each law (of beads their slip, their static limit, what their rails do), watched functions, the case
// distinctions of recorded functions and their switches (normal reactions, speeds under quadratic drag).
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/single_state.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What every body does, sticks, slips or flies, as expressions: recorded in two turns (sliding.hpp), first the laws,
/// then the guards. `map`: which variables are simulated.
class SpecialWriter {
public:
    using S = Expression;

    SpecialWriter(Recorder& r, const SingleLaws& laws, const StateMap& map, const std::vector<signed char>& slip);

    /// The rates of all variables, and with them what acts.
    const std::vector<S>& lay_down();

    /// What the sides of case distinctions change: the rates of the simulated variables, then what acts, in the layout
    /// of acting.hpp.
    std::vector<S> switched();

    /// Whether anything that acts lies on one side of a case distinction.
    bool distinguishes() const { return distinguishes_; }

    /// Takes what the sides change as it is in the motion, each distinction weighed once.
    void take(std::span<const S> values);

    /// The guards of what every body does.
    void guard(EquationsWriter& write) const;

    /// The guards of watched functions.
    void watch(EquationsWriter& write, const std::vector<Scene::Watch>& watches) const;

    /// The speeds of the surfaces of rough rails, by body, also of what a rail carries, for a drive may jump; none if
    /// no drive changes in time.
    std::vector<S> drives() const;

    /// The tangential reactions that rest needs, |r'| Phi_t, by body; none if nothing sticks.
    std::vector<S> pulls() const;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    /// What a watched function asks for.
    S observed(const Observable& o) const;

    Recorder& r_;
    const SingleLaws& laws_;
    const StateMap& map_;
    const std::vector<signed char>& slip_;
    int count_;
    bool distinguishes_ = false;
    std::vector<S> q_, v_, rates_;
    SingleStates<S> states_;
    std::vector<RecordedBody> present_;
};

/// The variables that share a scale, of those that are simulated.
std::vector<VariableGroup> groups_of(const SingleLaws& laws);

/// Equations for what every body does: sticks, slips or flies. None if it cannot slide as decided.
std::unique_ptr<Structure> record_special(const std::shared_ptr<const SingleLaws>& of,
                                          const std::vector<Scene::Watch>& watches,
                                          const std::vector<signed char>& slip, const RecordedFor& at_state);

}  // namespace rbdyn::inline RBDYN_FORM
