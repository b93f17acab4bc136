// The plan: what a scene calls for, decided once, and what is left out and why.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/model/size.hpp"

namespace rbdyn::inline RBDYN_FORM {

class ClosedForm;   // closed_form/closed_form.hpp
class Scene;        // scene/scene.hpp
class SceneModel;   // model/scene_model.hpp
struct Callback;    // expression/callback.hpp
struct SceneParts;  // scene/parts.hpp

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
    std::vector<std::string> not_unique;       // constraints and contacts with forces that the motion leaves open
    std::vector<std::string> integrals;        // first integrals of the scene
    Vector3 pole = Vector3::Zero();            // what those of angular momentum are about
    Vector3 up{0, 0, 1};                       // against gravity
    Vector3 axis{0, 0, 1};                     // of the axial angular momentum
    Placement view;                            // the axes the equations are written in
    std::shared_ptr<const SceneModel> model;   // the equations of motion, of one part
    std::shared_ptr<const ClosedForm> closed;  // the motion of one part in closed form, if there is one
    std::vector<Plan> parts;                   // of bodies that nothing joins; none if there is one only
    std::shared_ptr<const SceneParts> apart;   // the scenes of these parts, and what is where in them
    bool calls_back = false;                   // a force of it has values only, no series
    std::vector<std::shared_ptr<const Callback>> callbacks;

    /// What equations are asked for, of a plan that has none: one that came as data.
    struct Told {
        Size size;
        std::pair<int, int> variables;
        int freedom = 0;
    };
    std::optional<Told> told = std::nullopt;

    /// Calls of functions in Python so far.
    std::int64_t python_calls() const;
    /// Whether all of it is known in closed form.
    bool is_closed() const;
    /// Degrees of freedom: those that joints and constraints leave.
    int freedom() const;
    /// How many variables are simulated, and how many there are.
    std::pair<int, int> variables() const;
    /// Of the equations that a motion from the scene's state at time 0 begins with; of several parts the sum.
    Size size() const;
    bool has(const std::string& effect) const;
};

/// Reads a scene and decides. Throws InvalidInput on a scene without bodies.
Plan make_plan(const Scene& scene);

std::ostream& operator<<(std::ostream& out, const Plan& plan);

}  // namespace rbdyn::inline RBDYN_FORM
