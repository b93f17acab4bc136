// The active forces along the one coordinate of a scene, at rest, as functions of it: a bead on a rail at rest and the
// rail's parameter, a rigid body on a hinge or a slide, with all that is fixed to it, and its angle or displacement.
//
// Notation: r(u) the rail's curve, r' = dr/du, F the active force at r(u) with velocity zero:
//     Q = F.r' = |r'| F_t                                                     (eq. 7.15, in the curve's own parameter)
//     hold = mu_s^2 |r' x F|^2 - Q^2, not negative where friction holds the bead   (eqs. 7.16, 7.25 at rest)
//     push = -b.(r' x F), not negative where a rail that only pushes does so
// On a hinge Q is the moment about the axis (eq. 7.60); on a slide the force along it.
// Invariant: one body of the scene moves in its joint, and there are no constraints; nothing depends on time.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/rest_forces.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace statics {

/// Throws InvalidInput unless what acts on a body is the same at all times; `user` is who asks.
void require_timeless(const Scene& scene, int body, const std::string& user);

/// A bead of a scene by itself, with the loads on it and the springs that hold it to the world. Throws InvalidInput if
/// it is no bead, or if a spring joins it with another body.
Scene alone(const Scene& scene, BodyHandle bead, const std::string& user);

/// Chooses the signs of a program's switches by the state x.
void set_signs(const Program& program, std::vector<double>& parameters, std::span<const double> x);

}  // namespace statics

/// The forces on the only body of a scene that moves in its joint, along its one coordinate, and across its rail.
class PathForces {
public:
    /// The outputs of its programs, in this order; hold on a rough rail, push on one that only pushes.
    enum Output { along = 0, hold = 1, push = 2 };

    /// One smooth formula of the forces: a program of u, and the case distinctions made for it.
    struct Formula {
        Program program;
        std::vector<double> parameters;  // signs of its switches
        int outputs = 0;                 // hold and push included where there are any
        int guards = 0;                  // outputs after those: not negative where its choices are right
        bool is_smooth = false;          // everywhere: it distinguishes nothing
    };

    explicit PathForces(const Scene& scene);

    /// Of a bead.
    const Curve& curve() const { return rail_->curve(); }
    double mass() const { return mass_; }

    /// What its coordinate is, in a word.
    std::string coordinate() const { return rail_ ? "parameter" : is_on_hinge() ? "angle" : "displacement"; }
    bool is_on_hinge() const { return std::holds_alternative<Revolute>(body().joint); }
    Domain domain() const { return rail_ ? curve().domain() : Domain{}; }
    /// After which all is the same again; 0 if nothing is.
    double period() const;
    /// The torsion springs of a hinge together.
    TorsionSpring torsion() const;
    /// Whether a function of the angle acts along a hinge, which may count turns.
    bool may_count_turns() const;
    /// |r'|; 1 for a hinge and a slide.
    double speed(double u) const { return rail_ ? curve().first(u).norm() : 1.0; }
    /// Twice the kinetic energy over the squared rate of the coordinate.
    double inertia(double u) const { return rail_ ? mass() * speed(u) * speed(u) : inertia_; }
    double start() const { return body().parameter; }
    bool rough() const { return rail_ && rail_->friction(); }
    /// mu_s of a rough rail.
    double static_friction() const { return rough() ? static_cast<double>(rail_->friction()->mu_static) : 0.0; }
    bool one_sided() const { return !acting_->one_sided().empty(); }
    const std::string& name() const { return body().name; }
    const Scene& scene() const { return acting_->scene(); }

    /// The formula that is right about u.
    Formula formula(double u) const;
    /// The formula at the bead's start.
    const Formula& first_formula() const { return smooth_; }

    /// Q at places, in doubles; an evaluation of its own, not to be shared by threads.
    class Values {
    public:
        explicit Values(const PathForces& forces);
        double operator()(double u);

    private:
        void choose(double u);

        const PathForces* forces_;
        Formula own_;  // where the forces distinguish cases
        std::optional<Evaluator<double>> quick_;
    };

    /// Q, with every case distinction made at u.
    double along_path(double u) const;
    /// |r'| times the sum of the sizes of the forces, or that of their moments: Q of its rounding is none.
    double effort(double u) const;
    /// What is not finite at u, in words.
    std::string not_finite(double u) const;

private:
    const Scene::Body& body() const { return scene().bodies()[at(mover_)]; }
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    /// How all bodies move with a unit velocity of the coordinate, in order of addition.
    template <class N>
    std::vector<mechanics::Twist<N>> ways(const std::vector<mechanics::Moving<N>>& all) const;

    std::shared_ptr<const statics::RestForces> acting_;
    int mover_ = 0;  // the body whose joint has the coordinate
    std::optional<Rail> rail_;
    double mass_ = 0.0, inertia_ = 0.0;  // of all that moves along a slide, or about the axis of a hinge
    Formula smooth_;                     // about the start
};

}  // namespace rbdyn::inline RBDYN_FORM
