// The equations of a scene and what can be asked of its motion: what plans, runs and their results see of a model.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct PointReport;  // model/body_report.hpp
struct RigidReport;  // model/body_report.hpp

/// What a joint's own coordinates are, and their rates, in its own order.
struct JointReport {
    std::vector<double> coordinates, rates;
};

/// What a constraint does at a time, world axes: the force and the torque on its first end, and how far its points and
/// axes are from where they should be.
struct ConstraintReport {
    Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
    double gap = 0.0;
};

/// What a contact does at a time, world axes.
struct ContactReport {
    double gap = 0.0;  // [m]
    Vector3 force = Vector3::Zero(),
            slip = Vector3::Zero();  // on its first side [N]; of it relative to the other [m/s]
    Vector3 place = Vector3::Zero(), normal = Vector3::Zero();  // where they touch, or are nearest
    const char* state = "open";                                 // or "sticks", "slides"
};

class SceneModel : public RecordedModel {
public:
    using RecordedModel::RecordedModel;

    virtual int bodies() const = 0;
    virtual bool on_rail(int body) const = 0;
    /// Which of all variables are simulated.
    virtual const StateMap& map() const = 0;
    /// Why all variables are simulated, also what stays as it starts; empty if that is left out.
    virtual const std::string& why_all() const = 0;
    virtual const std::string& name(int body) const = 0;
    /// The coordinates of a body that are simulated, in words.
    virtual std::string coordinates(int body) const = 0;
    /// What of a body is left out, and what would bring it in.
    virtual std::vector<Omission> left_out(int /*body*/) const { return {}; }
    /// What the equations watch for, in words, each once.
    virtual std::vector<std::string> guards() const = 0;
    /// Whether that may be called otherwise where motion starts elsewhere.
    virtual bool guards_depend_on_start() const { return true; }
    /// Whether a body may turn.
    virtual bool turns(int body) const = 0;
    /// Degrees of freedom left by joints and constraints.
    virtual int freedom() const = 0;
    /// The same model with other numbers of the user's.
    virtual std::shared_ptr<const SceneModel> with_numbers(const Scene& scene, const GivenNumbers& numbers) const = 0;
    /// The same for a scene that starts elsewhere; none if its equations would be others.
    virtual std::shared_ptr<const SceneModel> started_elsewhere(const Scene& scene,
                                                                const GivenNumbers& numbers) const = 0;
    /// The constraints whose forces the motion does not determine.
    virtual std::vector<std::string> not_unique() const { return {}; }

    /// The time at which what moves by functions of time is where the scene starts.
    virtual double origin() const { return 0.0; }
    /// The state the scene starts in.
    virtual std::vector<double> start(double t = 0.0) const = 0;

    /// All bodies and couplings in a mode.
    virtual SystemReport system_report(const Mode& mode, double t, std::span<const double> x, Asked asked) const = 0;
    /// Motion and reaction of a body in a mode.
    virtual PointReport report(const Mode& mode, int body, double t, std::span<const double> x) const = 0;
    virtual RigidReport rigid_report(const Mode& mode, int body, double t, std::span<const double> x) const = 0;
    virtual JointReport joint(const Mode& mode, int body, double t, std::span<const double> x) const = 0;
    virtual ConstraintReport constraint(const Mode&, int, double, std::span<const double>) const { return {}; }
    virtual ContactReport contact(const Mode&, int, double, std::span<const double>) const { return {}; }
    /// The force of a coupling on its first end in a mode, world axes.
    virtual Vector3 coupling_force(const Mode& mode, int coupling, double t, std::span<const double> x) const = 0;
    /// Power of a load of the scene in a mode.
    virtual double power(const Mode& mode, const Scene::AppliedLoad& load, int index, double t,
                         std::span<const double> x) const = 0;
    /// The value of a watched function in a mode.
    virtual double watched(const Mode& mode, int watch, double t, std::span<const double> x) const = 0;
    /// What watched functions may ask for, at a state.
    virtual Observe observing(const Mode& mode, double t, std::span<const double> x) const = 0;

    /// Attitude and angular velocity of a rigid body.
    virtual Turning turning(int body, double t, std::span<const double> x) const = 0;
    /// Where a body's angles are in what winding() gives, by three; -1: it does not turn freely.
    virtual int place_of_angles(int body) const = 0;
    /// The angles of a body somewhere on a piece, from those before its start.
    virtual EulerAngles wound(int body, const Piece& piece, const EulerAngles& before, double tau) const = 0;

    /// Where a particle or a body's centre of mass is in a mode, and where a body's origin is; no force is asked for.
    virtual Vector3 center(const Mode& mode, int body, double t, std::span<const double> x) const = 0;
    virtual Vector3 position(const Mode& mode, int body, double t, std::span<const double> x) const = 0;
    /// How the rail of a body has turned from where its curve is placed, world axes.
    virtual Matrix3 rail_turn(int body, double t, std::span<const double> x) const = 0;
};

}  // namespace rbdyn::inline RBDYN_FORM
