// The potential of a bead on a rail at rest, one-dimensional: what its motion obeys without being integrated.
//
//   U(s) = integral of F_t ds, F_t = dU/ds                (eq. 7.18, also where F itself has no potential)
//   m s'^2/2 - U = E                                      (eqs. 7.19, 7.20)
//   t = integral of ds / sqrt(2 (E + U)/m)                (eq. 7.22)
//
// Conventions: the chapter's sign, F_t = +dU/ds. s and U are zero at the beginning of the curve, or at u = 0 where it
// has none. Gravity, constant forces, potentials and springs enter in closed form, `Force` functions by quadrature.
// Between turning points the time is taken in x with u = u_turn +- x^2, which makes its integrand smooth, and E + U as
// the integral of F_t from the turning point, which keeps its digits there.
// Accuracy: U to rounding of its terms; times to about 1e-15, times the growth of rounding of E and u near a
// separatrix.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Where a motion along a rail turns round, as parameters, on either side; none where it passes on, or the rail ends.
/// Also the equilibrium that it only comes nearer to, for ever.
struct TurningPoints {
    std::optional<double> below, above;
    bool operator==(const TurningPoints&) const = default;
};

/// The potential of one bead of a scene along its rail. Immutable.
class RailPotential {
public:
    /// Throws InvalidInput, naming what stands against it, unless the tangential force depends on the place alone.
    RailPotential(const Scene& scene, BodyHandle bead);

    const Curve& curve() const;
    const std::string& name() const;
    double mass() const;

    /// U(u) [J].
    double value(double u) const;
    /// The part of U that is the work of `Force` functions [J].
    double work_of_forces(double u) const;
    /// F_t = dU/ds [N]. Throws InvalidInput at a cusp.
    double tangential_force(double u) const;
    /// E = m s'^2/2 - U [J].
    double energy(double u, double speed) const;
    /// |s'| at u of the motion with an energy [m/s]. Throws InvalidInput where it does not come.
    double speed(double u, double energy) const;

    /// Where the motion with an energy that passes `start` turns round next, either way. On a curve without end that is
    /// looked for on 1000 stretches of Taylor series. At rest in equilibrium both are the start.
    TurningPoints turning_points(double energy, double start) const;

    /// The time there and back between the turning points [s]; of a small oscillation where the bead rests in stable
    /// equilibrium, infinite at other equilibria. On a closed curve round which it passes on: the time of the next
    /// round from `start`, the parameter growing. Throws InvalidInput for a motion that does not come back.
    double period(double energy, double start) const;

    /// The time of the motion with an energy straight from u0 to u1 [s], negative if u1 < u0; infinite if it only
    /// comes near an equilibrium. Throws InvalidInput if it turns round before.
    double time(double energy, double u0, double u1) const;

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    static Scene checked(const Scene& scene, BodyHandle bead);

    std::string user() const;
    double on_rail(double u) const;

    /// r(u), world.
    Vector3 place(double u) const;
    /// What has a closed form of U(u), and the sizes of its terms together.
    std::pair<double, double> closed_form(double u) const;

    /// m s'^2/2 at u. Throws InvalidInput if it is negative beyond rounding.
    double kinetic(double energy, double u) const;

    /// E + U at u, and its rounding.
    std::pair<double, double> balance(double energy, double u) const;

    /// The integral of Q from a to b.
    double gained(double a, double b) const;

    /// The first turning point from `start`, where the kinetic energy is k, in one direction; or the equilibrium that
    /// it does not come past.
    std::optional<double> turn(double energy, double start, double k, double way) const;
    /// The zero of the kinetic energy near u, by Newton's method with the work from the start.
    double polished(double start, double k, double u, double half) const;

    /// The time from a to b > a, kinetic energies at the ends given, zero at turning points.
    double duration(double a, double b, double at_a, double at_b) const;
    /// The time over a way from u, with x^2 the way gone.
    double half_duration(double u, double way, double k) const;

    // a bead thrown up an endless helix turns within so many, or is not waited for
    static constexpr int most_stretches = 1000;

    struct Forces;
    std::shared_ptr<const Forces> forces_;
};

std::ostream& operator<<(std::ostream& out, const RailPotential& u);

}  // namespace rbdyn::inline RBDYN_FORM
