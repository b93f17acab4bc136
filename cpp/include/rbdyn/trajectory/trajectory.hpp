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
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/trajectory/any_run.hpp"
#include "rbdyn/trajectory/body_motion.hpp"
#include "rbdyn/trajectory/events.hpp"
#include "rbdyn/trajectory/pole.hpp"
#include "rbdyn/trajectory/statistics.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct RunData;  // trajectory/run_data.hpp

/// The result of simulate(): motion, events, error estimate, price.
class Trajectory : public AnyRun {
public:
    explicit Trajectory(RunData data);
    // a move copies: what was moved from stays what it was
    Trajectory(const Trajectory&) = default;
    Trajectory& operator=(const Trajectory&) = default;

    const Statistics& statistics() const;
    const Events& events() const&;
    Events events() &&;  // of a run that ends with the expression, they outlive it
    const Plan& plan() const;
    const Scene& scene() const;
    std::shared_ptr<const RunData> data() const;

    /// The ends of the integrator's pieces [s], of all parts.
    std::vector<double> t() const;

    BodyMotion operator[](BodyHandle body) const;
    BodyPointMotion operator[](const BodyPoint& point) const;
    CouplingMotion operator[](CouplingHandle coupling) const;
    ConstraintMotion operator[](ConstraintHandle constraint) const;
    ContactMotion operator[](ContactHandle contact) const;

    // --- of the whole system, or of some bodies (`of`; empty: all) ---
    using Bodies = std::vector<BodyHandle>;

    double kinetic_energy(double t, const Bodies& of = {}, Side side = Side::after) const;
    /// The same of the motion relative to axes that do not turn and move with a pole; without one with the centre of
    /// mass of the bodies asked for, T^(G) of Koenig's theorem (7.37).
    double relative_kinetic_energy(double t, const std::optional<Pole>& pole = std::nullopt, const Bodies& of = {},
                                   Side side = Side::after) const;
    /// V = -U of gravity, constant forces, potentials and couplings [J], zero at the origin, at rest length, at
    /// infinity for gravitation, at the distance of the start for a central force; and of forces that have a potential
    /// along a smooth rail at rest, zero where its arc length is. Of some bodies: with the couplings among them and to
    /// the world.
    double potential_energy(double t, const Bodies& of = {}, Side side = Side::after) const;
    double potential_energy(double t, Side side) const { return potential_energy(t, {}, side); }
    /// U, with F = +grad U (the chapter's sign).
    double potential(double t, const Bodies& of = {}, Side side = Side::after) const;
    double potential(double t, Side side) const { return potential(t, {}, side); }
    /// T + V = T - U [J].
    double energy(double t, const Bodies& of = {}, Side side = Side::after) const;
    double energy(double t, Side side) const { return energy(t, {}, side); }

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
    Vector3 angular_momentum(double t, const Pole& pole = {}, const Bodies& of = {}, Side side = Side::after) const;
    Vector3 center_of_mass(double t, const Bodies& of = {}, Side side = Side::after) const;
    Vector3 center_of_mass_velocity(double t, const Bodies& of = {}, Side side = Side::after) const;
    Vector3 center_of_mass_acceleration(double t, const Bodies& of = {}, Side side = Side::after) const;

    /// Resultant and moment of what acts on the bodies from outside them [N, N m]: loads, gravity, rails and joints,
    /// and couplings to the world and to other bodies (theorems.hpp).
    Vector3 external_force(double t, const Bodies& of = {}, Side side = Side::after) const;
    Vector3 external_moment(double t, const Pole& pole = {}, const Bodies& of = {}, Side side = Side::after) const;
    /// R - dQ/dt (7.38) and M - dK/dt - v x Q (7.39), v the velocity of the pole [N, N m]: rounding, but for the moment
    /// of forces between the bodies that are not along their lines.
    std::pair<Vector3, Vector3> cardinal_residuals(double t, const Pole& pole = {}, const Bodies& of = {},
                                                   Side side = Side::after) const;

    /// The value of a watched function, by the handle of its watch, at a time.
    double watched(WatchHandle watch, double t, Side side = Side::after) const;

    /// A first integral of the scene, by name, at a time.
    double integral(const std::string& name, double t, Side side = Side::after) const;

    /// The largest departure of every first integral of the scene from its value at the start, relative to the
    /// largest size of its terms.
    std::map<std::string, double> drift() const;

private:
    static constexpr int closed_times = 128;

    /// All bodies and couplings at a time, of all parts.
    SystemReport system_at(double t, Side side, Asked asked) const;
    /// A first integral by name, and the size of what it is a sum of.
    std::pair<double, double> integral_of(const std::string& name, const SystemReport& system, double t,
                                          Side side) const;
    double potential_in(const SystemReport& system, const Bodies& of) const;
    /// The lengths at which potentials of central forces are zero: those the scene starts with.
    const std::vector<double>& start_lengths() const;
    const Scene::AppliedLoad& applied(LoadHandle load) const;
    /// f of what can be observed at a time.
    template <class F>
    double now(double t, Side side, F&& f) const;
    /// What can be observed of a run in parts at a time.
    Observe observing_parts(double t, Side side) const;
    double observed(const WatchFunction& function, const Observe& observe, const std::string& user) const;
    /// U of a load on a body; none of one that has none by itself, damping included.
    static std::optional<double> potential_of(const Scene::AppliedLoad& load, const BodyReport& body);
    double potential_of(const CouplingReport& coupling, int index) const;
    /// Work from t0 to t1 by one that takes it from an earlier to a later time.
    template <class F>
    double work_between(double t0, double t1, F&& forwards) const;
    std::shared_ptr<const RunData> data_;
    struct BodyWork;
    std::shared_ptr<const std::vector<BodyWork>> works_;  // of forces that have a potential along a rail
    struct Lengths;
    std::shared_ptr<Lengths> start_lengths_;
};

std::ostream& operator<<(std::ostream& out, const Trajectory& run);

}  // namespace rbdyn::inline RBDYN_FORM
