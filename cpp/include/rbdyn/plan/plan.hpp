// The plan: what a scene calls for, decided once, and what is left out and why.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/plan/linear_motion.hpp"
#include "rbdyn/plan/simulated.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The decisions made from a scene before anything is computed.
struct Plan {
    using Omission = rbdyn::Omission;

    std::vector<std::string> coordinates;  // one line a body
    std::vector<std::string> effects;      // of the closed list
    std::vector<std::string> guards;       // what is watched for
    std::vector<std::string> functions;    // the user's own: recorded, or called back and why
    std::string engine, reason;            // the automatic choice; of several parts each one's, once
    std::string integrator;                // the automatic choice among those that integrate
    std::vector<Omission> omissions;
    std::vector<std::string> integrals;        // first integrals of the scene
    Vector3 pole = Vector3::Zero();            // what those of angular momentum are about
    Vector3 up{0, 0, 1};                       // against gravity
    Placement view;                            // the axes the equations are written in
    std::shared_ptr<const PointsModel> model;  // the equations of motion, of one part
    std::shared_ptr<const ClosedForm> closed;  // the motion of one part in closed form, if there is one
    std::vector<Plan> parts;                   // of bodies that nothing joins; none if there is one only
    std::shared_ptr<const SceneParts> apart;   // the scenes of these parts, and what is where in them
    bool calls_back = false;                   // a force of it has values only, no series
    std::vector<std::shared_ptr<const Callback>> callbacks;

    /// What equations are asked for, of a plan that has none: one that came as data.
    struct Told {
        Size size;
        std::pair<int, int> variables;
    };
    std::optional<Told> told = std::nullopt;

    /// Calls of functions in Python so far.
    std::int64_t python_calls() const;
    /// Whether all of it is known in closed form.
    bool is_closed() const;
    /// How many variables are simulated, and how many there are.
    std::pair<int, int> variables() const;
    /// Of the equations that a motion from the scene's state at time 0 begins with; of several parts the sum.
    Size size() const;
    bool has(const std::string& effect) const;
};

namespace planning {

/// The axes in which most of a scene vanishes: those of the only curve, turned about a line so that the forces lie in
/// one plane with it; else the world's.
Placement view_of(const Scene& scene);

/// What the recorded equations watch for, with nothing that sticks and with all that can.
[[gnu::cold]] std::vector<std::string> guards_of(const PointsModel& model);

/// The first names of a list, and how many there are beside them.
std::string first_of(const std::vector<std::string>& names, std::size_t most, const std::string& between);

/// The names of the bodies of a part.
std::string names_of(const Scene& part);

inline Plan plan_of(const Scene& scene, bool beside_rigid, const GivenNumbers& numbers);

/// Plans the parts of a scene, each by itself: guards, engines and the reason for them are theirs together.
[[gnu::cold]] void plan_parts(const Scene& scene, SceneParts&& apart, bool any_rigid, const GivenNumbers& numbers,
                              Plan& plan, Simulated& simulated);

/// The closed form of a scene, or why there is none: that of its bodies one by one, or that of linear equations.
[[gnu::cold]] FoundForm closed_form(const Scene& scene, const PointsModel& model, bool any_rigid);

std::string reason_of(const ClosedForm& form);

/// Plans a scene, or a part of one with rigid bodies, while numbers of the user's are what they are.
[[gnu::cold]] Plan plan_of(const Scene& scene, bool beside_rigid, const GivenNumbers& numbers);

}  // namespace planning

std::ostream& operator<<(std::ostream& out, const Plan& plan);

}  // namespace rbdyn::inline RBDYN_FORM
