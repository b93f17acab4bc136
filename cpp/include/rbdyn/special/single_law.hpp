// The law of one body that hangs on the world alone: its variables, its equations, and what it says of itself.
//
// There is one for each way a body can move, a file each: a particle (particle_law.hpp), a bead on a rail
// (bead_law.hpp), and a rigid body that is free (free_law.hpp), on a ball joint (ball_law.hpp), on a hinge
// (hinge_law.hpp) or on a slide (slide_law.hpp). Whoever asks anything of a body asks its law; nobody asks which it is.
// Invariant: a law is immutable once its scene's laws are made (single_laws.hpp). Its variables are positions() of the
// positions of all bodies, from `first` on, and velocities() of the velocities, from `first_rate` on.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/model/body_report.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/observed.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/body_form.hpp"
#include "rbdyn/special/lone_body.hpp"
#include "rbdyn/special/single_state.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Recorder;  // expression/recorder.hpp
template <class S>
class CouplingForces;  // laws_now.hpp
struct LawsNow;        // laws_now.hpp

/// A body while its equations are recorded: its variables and state, and what acts, in the layout of acting.hpp.
struct RecordedBody {
    using S = Expression;

    const SingleState<S>* state = nullptr;
    const S *q = nullptr, *rates = nullptr;  // its positions, and the rates of its velocities
    Vector3Of<S> force{S(0.0), S(0.0), S(0.0)};
    S along = 0.0;  // r' . (forces along a rail)
    Vector3Of<S> moment{S(0.0), S(0.0), S(0.0)};
    signed char phase = 1;         // what it does in the mode: sticks, slips or flies
    Recorder* recorder = nullptr;  // of which parameter `index` is its own number of the mode
};

class SingleLaw {
public:
    using S = Expression;

    std::string name;
    double mass = 0.0;
    int index = 0;                  // among the bodies
    int first = 0, first_rate = 0;  // its first position, its first velocity among all variables
    std::vector<int> couplings;     // with an end on it, in their order

    SingleLaw& operator=(const SingleLaw&) = delete;
    virtual ~SingleLaw() = default;
    virtual std::unique_ptr<SingleLaw> copy() const = 0;

    // --- what a scene says of it ---

    virtual void take_start(const Scene::Body& b) = 0;
    /// `own`: the loads on it, by their places among those of the scene. What moves its rail may depend on numbers too.
    virtual void take_loads(const Scene& scene, const std::vector<int>& own) = 0;
    /// Which variables are simulated, known at last.
    virtual void take_map(const StateMap& /*map*/) {}
    /// A point of it, body axes (none: its centre of mass), as its law has points.
    virtual Vector3Of<DoubleDouble> point(const std::optional<Vector3>& given) const;

    // --- its variables ---

    virtual int positions() const = 0;
    virtual int velocities() const { return positions(); }
    virtual int freedom() const { return velocities(); }
    virtual bool on_rail() const { return false; }
    /// The first of its positions that turn it, and the first of a quaternion; none: positions(), -1.
    virtual int first_turn() const { return positions(); }
    virtual int first_of_attitude() const { return -1; }
    /// The velocity that motion does not change, a number of the mode; -1: none.
    virtual int fixed_velocity() const { return -1; }
    /// The variable that is a number of the mode where it cannot change.
    int fixed_variable() const { return fixed_velocity() >= 0 ? first_rate + fixed_velocity() : first; }
    /// Whether its equations take numbers of the mode.
    virtual bool takes_numbers(const StateMap& map) const;
    /// The positions, or the velocities, that share a scale, counted from its first.
    virtual std::vector<VariableGroup> groups(bool of_positions) const = 0;
    virtual void start(double t, DoubleDouble* q, DoubleDouble* v) const = 0;
    /// What of it is simulated whatever its equations say: takes it from `stays`.
    virtual void keep_in(std::vector<bool>& /*stays*/) const {}
    /// Whether any of its variables is simulated, and any that turns it.
    bool moves(const StateMap& map) const;
    bool turns(const StateMap& map) const;

    // --- its motion ---

    /// Adds its state to those of the scene.
    virtual void add_state(SingleStates<double>& states, double t, const double* q, const double* v,
                           signed char phase) const = 0;
    virtual void add_state(SingleStates<S>& states, const S& t, const S* q, const S* v, signed char phase) const = 0;

    /// What equations depend on beside numbers: phases of one kind share them; and the one that leaves it most free.
    virtual signed char kind(signed char /*phase*/) const { return 1; }
    virtual signed char freest() const { return 1; }
    /// Whether it does not move at all in a phase: its position is a number of the mode.
    virtual bool is_held(signed char /*phase*/) const { return false; }

    // --- its equations ---

    /// Records what acts, into `present`, and the rates of its variables.
    virtual void lay_down(RecordedBody& present, const CouplingForces<S>& couplings, S* q_rate, S* v_rate) const = 0;
    virtual void guard(EquationsWriter& /*write*/, const RecordedBody& /*present*/, const S& /*t*/) const {}
    /// The power of each load on it that a case distinction can be in, by load of the scene.
    virtual void powers(const RecordedBody& present, const S& t, std::span<S> power) const = 0;
    /// Whether a load of the scene is one of these.
    virtual bool is_function(const Scene::AppliedLoad& load, int of_scene) const = 0;

    // --- what is asked of it: as expressions, and in numbers ---

    virtual S observed(const RecordedBody& present, const Observable& o) const = 0;
    virtual double observed(const LawsNow& now, const Observable& o) const = 0;
    virtual PointReport report(const LawsNow& now) const = 0;
    /// Adds to mass, place and velocity what theorems of systems are made of.
    virtual void report(const LawsNow& now, Asked asked, BodyReport& r) const = 0;
    /// The derivatives of its variables.
    virtual void slope(const LawsNow& now, std::span<double> dq, std::span<double> dv) const = 0;
    /// Positions, velocities and reactions, each judged by a scale of its own.
    virtual void observe(const LawsNow& now, std::vector<Observed>& out) const = 0;
    virtual double power(const Scene::AppliedLoad& load, double t, const SingleState<double>& state) const = 0;
    /// Where the origin of its axes is; of a particle itself.
    virtual Vector3 origin(const SingleState<double>& state) const = 0;
    /// How its rail has turned from where its curve is placed, world axes.
    virtual Matrix3 rail_turn(double t) const;

    // --- changes ---

    /// Whether static friction holds it where it touches for a moment.
    virtual bool holds_what_touches() const { return false; }
    /// Puts what an action of the user's says into the state x. Returns the speed along a rail by which friction has to
    /// decide what comes next. Throws InvalidInput for words that are not its own, and for numbers that are no state.
    virtual std::optional<double> change(const StateChange& c, const LawsNow& now, const std::string& user,
                                         std::span<double> x) const = 0;

    // --- what is known without integration ---

    /// Whether nothing acts on it but its weight, so that it has first integrals; and what holds them, from a state.
    virtual bool is_conservative() const { return false; }
    virtual std::unique_ptr<const Projection> projection(std::span<const double> x, std::span<const double> low) const;
    /// Its motion under a constant acceleration and what else its joint may bear; none if it has none in closed form.
    virtual std::unique_ptr<const BodyForm> closed_form(const Scene& scene, const Vector3Of<DoubleDouble>& a) const = 0;
    /// Why its equations are not linear whatever acts, as a sentence; empty if they may be.
    virtual std::string why_not_linear() const { return {}; }
    /// What it conserves where it is alone; none of what cannot turn.
    virtual std::optional<planning::LoneBody> alone() const { return std::nullopt; }

    // --- words ---

    /// Its coordinates that are simulated, of which there are some.
    virtual std::string coordinates(const StateMap& map) const = 0;
    /// What would move it if nothing does, and what of it is left out else.
    virtual const char* mover() const = 0;
    virtual void leave_out(const StateMap& map, std::vector<Omission>& omissions) const = 0;
    /// What is not finite at a state, but for couplings; empty: nothing.
    virtual std::string not_finite(const LawsNow& now) const = 0;
    /// A force on it that has grown beyond all measure; empty: none.
    virtual std::string grown(const LawsNow& /*was*/, const LawsNow& /*is*/, double /*beyond*/) const { return {}; }

protected:
    SingleLaw(const Scene::Body& b, int place) : name(b.name), mass(b.mass()), index(place) {}
    SingleLaw(const SingleLaw&) = default;

    /// Its own state, which its law has made.
    template <class State, class Base>
    static const State& own(const Base& state) {
        return static_cast<const State&>(state);
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
