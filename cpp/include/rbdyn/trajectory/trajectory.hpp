// A run: pieces of motion with their modes, events, and everything that can be computed from them when asked for.
//
// Conventions: times in s, world axes. At a jump a value is the one after it, unless side = before is asked for.
// Accelerations and reactions come from the model at the state, never from differentiating a piece.
// A trajectory owns all it needs and outlives its scene.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/trajectory/any_run.hpp"
#include "rbdyn/trajectory/body_motion.hpp"
#include "rbdyn/trajectory/events.hpp"
#include "rbdyn/trajectory/statistics.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct RunData;  // trajectory/run_data.hpp

/// The result of simulate(): motion, events, error estimate, price.
class Trajectory : public AnyRun {
public:
    explicit Trajectory(RunData data);

    const Statistics& statistics() const;
    const Events& events() const&;
    Events events() &&;  // of a run that ends with the expression, they outlive it
    const Plan& plan() const;
    const Scene& scene() const;
    std::shared_ptr<const RunData> data() const;

    /// The ends of the integrator's pieces [s], of all parts.
    std::vector<double> t() const;

    BodyMotion operator[](BodyHandle body) const;
    SpringMotion operator[](CouplingHandle coupling) const;
    ConstraintMotion operator[](ConstraintHandle constraint) const;
    ContactMotion operator[](ContactHandle contact) const;

    // --- of the whole system, or of some bodies (`of`; empty: all) ---
    using Bodies = std::vector<BodyHandle>;

    double kinetic_energy(double t, const Bodies& of = {}, Side side = Side::after) const;
    /// V = -U of gravity, constant forces, potentials and springs [J], zero at the origin and at rest length; and of
    /// forces that have a potential along a smooth rail at rest, zero where its arc length is.
    double potential_energy(double t, Side side = Side::after) const;
    /// U, with F = +grad U (the chapter's sign).
    double potential(double t, Side side = Side::after) const;
    /// T + V = T - U [J].
    double energy(double t, Side side = Side::after) const;

    /// Power of all forces on the bodies, reactions included: dT/dt (Thm 7.6) [W].
    double power(double t, const Bodies& of = {}, Side side = Side::after) const;
    /// Power of one load, of one coupling on both its ends [W].
    double power(double t, LoadHandle load, Side side = Side::after) const;
    double power(double t, CouplingHandle coupling, Side side = Side::after) const;

    /// Work of the same forces from t0 to t1 (Thm 7.9) [J] (work.hpp). Throws InvalidInput for times outside the run
    /// and where it takes a motion that was not kept.
    double work(double t0, double t1, const Bodies& of = {}) const;
    double work(double t0, double t1, LoadHandle load) const;
    double work(double t0, double t1, CouplingHandle coupling) const;

    Vector3 momentum(double t, const Bodies& of = {}, Side side = Side::after) const;
    Vector3 angular_momentum(double t, const Vector3& pole = Vector3::Zero(), const Bodies& of = {},
                             Side side = Side::after) const;
    Vector3 center_of_mass(double t, const Bodies& of = {}, Side side = Side::after) const;
    Vector3 center_of_mass_velocity(double t, const Bodies& of = {}, Side side = Side::after) const;
    Vector3 center_of_mass_acceleration(double t, const Bodies& of = {}, Side side = Side::after) const;

    /// The value of a watched function, by the handle of its watch, at a time.
    double watched(WatchHandle watch, double t, Side side = Side::after) const;

    /// A first integral of the scene, by name, at a time.
    double integral(const std::string& name, double t, Side side = Side::after) const;

    /// The largest departure of every first integral of the scene from its value at the start, relative to the
    /// largest size of its terms.
    std::map<std::string, double> drift() const;

private:
    static constexpr int closed_times = 128;

    /// What a first integral is a sum of, in size.
    double size_of_terms(const std::string& name, double time) const;
    const Scene::AppliedLoad& applied(LoadHandle load) const;
    /// Position and velocity of the point where a load acts.
    std::pair<Vector3, Vector3> place_of(const Scene::AppliedLoad& load, double t, Side side) const;
    /// f of what can be observed at a time.
    template <class F>
    double now(double t, Side side, F&& f) const;
    /// What can be observed of a run in parts at a time.
    Observe observing_parts(double t, Side side) const;
    /// U of a load; none of one that has none by itself, damping included.
    std::optional<double> potential_of(const Scene::AppliedLoad& load, double t, Side side) const;
    double potential_of(CouplingHandle coupling, double t, Side side) const;
    /// Work from t0 to t1 by one that takes it from an earlier to a later time.
    template <class F>
    double work_between(double t0, double t1, F&& forwards) const;
    template <class F>
    void each(const Bodies& of, double t, Side side, F&& f) const;
    template <class F>
    Vector3 mean(const Bodies& of, double t, Side side, F&& f) const;

    std::shared_ptr<const RunData> data_;
    struct BodyWork;
    std::shared_ptr<const std::vector<BodyWork>> works_;  // of forces that have a potential along a rail
};

std::ostream& operator<<(std::ostream& out, const Trajectory& run);

}  // namespace rbdyn::inline RBDYN_FORM
