// The generalized forces of the bodies of a scene at rest, loops included, and how they change with their places.
//
// Freedoms: the velocities of all joints (mechanics/tree.hpp), Q = sum of the powers of all that acts with a unit of
// each. Where constraints J v = 0 hold, some of the velocities follow from the others, J_d v_d = -J_i v_i, and what is
// left is Q_i - J_i^T J_d^-T Q_d: the constraints do no work. Which ones follow is chosen by pivots where the bodies
// are. The Jacobian is that of the recorded forces; what the constraints add as they turn is of central differences in
// 32 digits over a 1e-10th of the scene's size, good to doubles. Places are the positions of the tree, in doubles, and
// satisfy the constraints to their rounding.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/rest_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

class TreeForces : public Forces {
public:
    /// Throws InvalidInput where the scene's start does not satisfy its constraints, nor a place near it.
    explicit TreeForces(const Scene& scene);
    int freedoms() const override { return tree().velocities() - static_cast<int>(rows_.size()); }
    int bodies() const override { return tree().size(); }
    /// Of bodies in loops nothing is said of turns of their own.
    bool turns(int body) const override { return rows_.empty() && tree().node(body).joint.attitude() >= 0; }
    int first(int body) const override { return tree().node(body).v; }
    int displacements(int body) const override { return tree().node(body).joint.attitude(); }
    bool has_constraints() const { return !rows_.empty(); }

    std::vector<double> start() const override { return start_; }
    std::vector<double> place(const std::vector<double>& coordinates) const override;
    std::vector<double> coordinates(const std::vector<double>& q) const override;

    Quaternion attitude(const std::vector<double>& q, int body) const override;
    Vector3 center(const std::vector<double>& q, int body) const override;
    Vector3 turn_in_world(const std::vector<double>&, int, const Vector3& turn) const override { return turn; }
    std::vector<double> turned(std::vector<double> q, int body, const Vector3& axis, const Vector3& point,
                               double angle) const override;
    /// Not a number where the constraints cannot be closed there.
    std::vector<double> moved(std::vector<double> q, const std::vector<double>& step) const override;
    double largest_turn(const std::vector<double>& step) const override;
    std::vector<double> difference(const std::vector<double>& to, const std::vector<double>& from) const override;
    /// The root of the sum of squares of displacements [m], parameters and angles [rad] between two places.
    double distance(const std::vector<double>& to, const std::vector<double>& from) const;
    State at_rest(const std::vector<double>& q) override;
    std::string not_finite(const std::vector<double>& q) const override;

    /// The Jacobian and the masses of the freedoms, in 32 digits, of a place that at_rest() was asked for last.
    struct WideJacobian {
        WideMatrix entries;
        bool is_constant = false;  // the same in all places
    };
    WideJacobian wide_jacobian() const;
    WideMatrix wide_mass() const;

    /// Places of 32 digits: positions on the constraints, empty where these cannot be closed.
    using Wide = std::vector<DoubleDouble>;
    Wide wide(const std::vector<double>& q) const { return closed(Wide(q.begin(), q.end())); }
    std::vector<double> nearest(const Wide& place) const;
    /// A small step from a place that look_at() was asked for last, or from near it.
    Wide stepped(const Wide& place, const std::vector<double>& step) const;
    /// Q near that place, and what it is a sum of.
    Wide force_at(const Wide& place);
    std::vector<double> force_sizes(const Wide& place);
    /// Makes a place the one that the Jacobian and the masses are of.
    void look_at(const Wide& place);
    /// What the entries of the Jacobian there are sums of: their rounding in doubles is a few epsilon times that.
    /// Along constraints nothing is said of it.
    std::optional<SquareMatrix> jacobian_sizes() const;
    /// The most that a step moves the point of a body that its joint holds [m], where look_at() was asked for last.
    double largest_move(const std::vector<double>& step) const;
    /// The extent of the scene where it starts [m]; of one in a single point the length that its forces have of their
    /// own there, or the unit if they are linear: nothing then depends on it.
    double extent() const { return extent_; }
    /// What freedoms, and positions, are measured in: extents, turns of one radian, or the parameter for such a way.
    std::vector<double> units() const;
    std::vector<double> units_of_positions() const;
    /// Positions that leave their body where it is when a turn is added, or a round of a closed rail, and how much
    /// that is: only torques that count turns know it.
    struct Round {
        int position;
        double period;
    };
    std::vector<Round> rounds() const;
    /// A motion in the freedoms in terms of all velocities, in the order of bodies; turns of what turns freely about
    /// the axes of the body.
    std::vector<double> in_bodies(const std::vector<double>& q, const std::vector<double>& motion) const;

private:
    using Bodies = std::vector<mechanics::Moving<DoubleDouble>>;
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    const mechanics::Tree& tree() const { return acting_.tree(); }
    double unit_of(const mechanics::Node& n, int velocity) const;

    /// Positions on the constraints, in 32 digits, and zero velocities behind them; empty if they are not to be closed.
    Wide closed(Wide positions) const;
    Bodies moving(const Wide& x) const;
    /// The rows of the constraints by velocity.
    std::vector<Wide> rows(const Bodies& all) const;
    /// Chooses which velocities follow from the others at a place.
    void choose(const Bodies& all);
    /// Of which size each velocity's position is known to the rounding: its own; where constraints hold that of all
    /// whose rounding moves it along them.
    std::vector<double> known() const;
    /// All velocities of a motion in the freedoms, where at_rest() was asked for last.
    std::vector<double> in_all(const std::vector<double>& motion) const;
    /// Velocities that follow from a motion in the freedoms.
    Wide velocities(const std::vector<Wide>& rows, const Wide& motion) const;
    /// The forces of the constraints that balance Q of what follows.
    Wide holding(const std::vector<Wide>& rows, const Wide& q) const;
    /// Q of the freedoms.
    Wide reduced(const std::vector<Wide>& rows, const Wide& q) const;
    Wide forces(const Wide& x) const;

    /// What moves with a unit of a freedom where at_rest() was asked for last, and how.
    struct Carried {
        int body;
        mechanics::Twist<DoubleDouble> twist;
    };
    std::vector<Carried> carried(int freedom) const;
    /// What a body's motion adds to the masses: the velocity of its centre of mass, and I omega, world axes.
    struct Momentum {
        Vector3Of<DoubleDouble> speed, spin;
    };
    Momentum momentum(const Carried& c) const;

    /// How the positions change with a velocity.
    template <class N>
    struct Change {
        int velocity, position;
        N rate;
    };
    template <class N>
    std::vector<Change<N>> changes(const std::vector<N>& q) const;
    /// Of Q of all velocities.
    WideJacobian exact_jacobian() const;
    WideMatrix constrained_jacobian() const;
    void record(const std::vector<double>& q);
    const Function& slope(int position) const;
    /// Runs a program for what its values are sums of; `known` as RoundingSizes takes it.
    static RoundingSizes sizes_of(const Program& program, const std::vector<double>& q,
                                  const std::vector<double>& known);

    RestForces acting_;
    mechanics::Conditions conditions_;
    std::vector<int> rows_;  // of the constraints, those that are used, the first pivot first
    std::vector<int> following_,
        leading_;                // velocities that follow from the others, in order of pivots, and the others
    std::vector<bool> carries_;  // other bodies
    std::vector<double> start_;
    double extent_ = 1.0;
    Wide place_;               // where at_rest() was asked last, on the constraints,
    Bodies bodies_;            // the bodies there,
    std::vector<Wide> basis_;  // and of each freedom all velocities there, where constraints hold
    mutable std::vector<double> known_;
    std::optional<Function> function_;  // Q of all velocities
    mutable std::map<int, Function> slopes_;
    Program program_;
    std::unique_ptr<JacobianEvaluator> values_;
    std::vector<double> parameters_;
    bool distinguishes_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM::statics
