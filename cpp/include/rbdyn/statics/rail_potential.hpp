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

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <ostream>
#include <string>

#include "rbdyn/statics/path_zero.hpp"
#include "rbdyn/statics/quadrature.hpp"

namespace rbdyn {

/// Where a motion along a rail turns round, as parameters, on either side; none where it passes on, or the rail ends.
/// Also the equilibrium that it only comes nearer to, for ever.
struct TurningPoints {
    std::optional<double> below, above;
    bool operator==(const TurningPoints&) const = default;
};

/// The work of a bead's recorded `Force` functions along its rail, of those that have a potential there
/// (planning::has_potential_along_rail).
class RailWork {
public:
    RailWork(const Scene& scene, BodyHandle bead) {
        const Scene::Body& body = scene.bodies()[static_cast<std::size_t>(bead.index)];
        Scene functions;
        const BodyHandle one =
            functions.add(std::get<Particle>(body.body), *body.rail(), {.parameter = body.parameter}, body.name);
        for (const Scene::AppliedLoad& load : scene.loads())
            if (load.body == bead.index && planning::has_potential_along_rail(scene, load))
                functions.apply(load.load, one);
        if (functions.loads().empty()) return;
        forces_.emplace(functions);
        origin_ = arc_length_origin(forces_->curve());
    }

    /// The integral of their F_t from the origin of arc length to u [J].
    double operator()(double u) const {
        if (!forces_) return 0.0;
        PathForces::Values q(*forces_);
        const double floor = 2.0 * std::numeric_limits<double>::epsilon() * std::abs(u - origin_) *
                             std::max(forces_->effort(u), forces_->effort(origin_));
        return statics::integral([&](double place) { return q(place); }, origin_, u, floor);
    }

private:
    std::optional<PathForces> forces_;
    double origin_ = 0.0;
};

/// The potential of one bead of a scene along its rail. Immutable.
class RailPotential {
public:
    /// Throws InvalidInput, naming what stands against it, unless the tangential force depends on the place alone.
    RailPotential(const Scene& scene, BodyHandle bead)
        : forces_(checked(scene.frozen(), bead)), work_(scene.frozen(), bead) {
        origin_ = arc_length_origin(curve());
    }

    const Curve& curve() const { return forces_.curve(); }
    const std::string& name() const { return forces_.name(); }
    double mass() const { return forces_.mass(); }

    /// U(u) [J].
    double value(double u) const { return closed_form(u).first + work_(on_rail(u)); }
    /// The part of U that is the work of `Force` functions [J].
    double work_of_forces(double u) const { return work_(on_rail(u)); }
    /// F_t = dU/ds [N]. Throws InvalidInput at a cusp.
    double tangential_force(double u) const {
        curve().require_regular(on_rail(u));
        return forces_.along_path(u) / curves::norm(curve().first(u));
    }
    /// E = m s'^2/2 - U [J].
    double energy(double u, double speed) const { return 0.5 * mass() * speed * speed - value(u); }
    /// |s'| at u of the motion with an energy [m/s]. Throws InvalidInput where it does not come.
    double speed(double u, double energy) const { return std::sqrt(2.0 * kinetic(energy, u) / mass()); }

    /// Where the motion with an energy that passes `start` turns round next, either way. On a curve without end that is
    /// looked for on 1000 stretches of Taylor series. At rest in equilibrium both are the start.
    TurningPoints turning_points(double energy, double start) const {
        const double k = kinetic(energy, start);
        return {turn(energy, start, k, -1.0), turn(energy, start, k, 1.0)};
    }

    /// The time there and back between the turning points [s]; of a small oscillation where the bead rests in stable
    /// equilibrium, infinite at other equilibria. On a closed curve round which it passes on: the time of the next
    /// round from `start`, the parameter growing. Throws InvalidInput for a motion that does not come back.
    double period(double energy, double start) const {
        const TurningPoints t = turning_points(energy, start);
        if (t.below && t.above) {
            if (*t.below < *t.above) return 2.0 * duration(*t.below, *t.above, 0.0, 0.0);
            PathPieces pieces(forces_);
            const statics::PathPiece& p = pieces.about(start, pieces.natural(start));
            const double slope = p.output[PathForces::along][1] / p.half;
            return slope < 0.0
                       ? 2.0 * std::numbers::pi * std::sqrt(-mass() * curve().first(start).squaredNorm() / slope)
                       : std::numeric_limits<double>::infinity();
        }
        if (!t.above && curve().period() > 0.0) {
            const double k = kinetic(energy, start), end = start + curve().period();
            return duration(start, end, k, k + gained(start, end));
        }
        throw InvalidInput(user() + ": the motion with energy " + text(energy) + " J that passes parameter " +
                           text(start) + " does not turn round " +
                           (t.above   ? "below"
                            : t.below ? "above"
                                      : "either way") +
                           ", so it has no period");
    }

    /// The time of the motion with an energy straight from u0 to u1 [s], negative if u1 < u0; infinite if it only
    /// comes near an equilibrium. Throws InvalidInput if it turns round before.
    double time(double energy, double u0, double u1) const {
        if (u1 < u0) return -time(energy, u1, u0);
        if (u0 == on_rail(u1)) return 0.0;
        const double k0 = kinetic(energy, u0), k1 = kinetic(energy, u1), way = u1 - u0;
        const std::optional<double> turn_above = turn(energy, u0, k0, 1.0);
        const double slack = 1e-12 * way;
        // not past an equilibrium that it only comes near
        if (turn_above && *turn_above < u1 - slack &&
            std::abs(forces_.along_path(*turn_above)) <= 16.0 * epsilon * forces_.effort(*turn_above))
            return std::numeric_limits<double>::infinity();
        if (turn_above && *turn_above < u1 - slack)
            throw InvalidInput(user() + ": the motion with energy " + text(energy) + " J turns round at parameter " +
                               text(*turn_above) + ", before it comes from " + text(u0) + " to " + text(u1));
        return duration(u0, u1, k0, k1);
    }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    static Scene checked(const Scene& scene, BodyHandle bead) {
        const std::string user = "rail potential";
        const Scene one = statics::alone(scene, bead, user);
        const std::string& name = one.bodies()[0].name;
        statics::require_timeless(one, 0, user);
        const auto refuse = [&](const std::string& what) {
            throw InvalidInput(user + ": " + what + " " + name +
                               "; the tangential force must depend on the place alone: leave it out");
        };
        if (one.bodies()[0].rail()->friction()) refuse("friction acts on");
        for (const Scene::AppliedLoad& load : one.loads()) {
            if (const Drag* drag = std::get_if<Drag>(&load.load); drag != nullptr && drag->present())
                refuse("drag acts on");
            if (const Force* force = std::get_if<Force>(&load.load);
                force != nullptr && !force->is_constant() && force->depends_on_velocity())
                refuse("force \"" + force->name() + "\", which depends on velocity, acts on");
        }
        for (const Scene::Connection& c : one.connections())
            if (std::get<Spring>(c.coupling).damping != 0.0) refuse("a damper acts on");
        return one;
    }

    std::string user() const { return "rail potential of " + name(); }
    double on_rail(double u) const {
        const Domain d = curve().domain();
        require(std::isfinite(u), user(), "parameter", u, "it is finite");
        require(u >= d.begin && u <= d.end, user(), "parameter", u,
                "it lies in the domain of the curve, " + text(d.begin) + " to " + text(d.end));
        return u;
    }

    /// What has a closed form of U(u), and the sizes of its terms together.
    std::pair<double, double> closed_form(double u) const {
        const PointLaws& laws = forces_.laws();
        const PointLaws::Body& b = forces_.body();
        const Vector3 r = laws.curve_point(b, on_rail(u)).position, r0 = laws.curve_point(b, origin_).position;
        const Vector3 force = rounded(b.force);
        double sum = 0.0, size = 0.0;
        for (int i = 0; i < 3; ++i) {
            sum += force[i] * (r[i] - r0[i]);
            size += std::abs(force[i]) * (std::abs(r[i]) + std::abs(r0[i]));
        }
        for (const auto& function : b.functions)
            if (const Potential* potential = std::get_if<Potential>(&function)) {
                const double here = potential->value<double>(laws.in_world<double>(r)),
                             there = potential->value<double>(laws.in_world<double>(r0));
                sum += here - there;
                size += std::abs(here) + std::abs(there);
            }
        for (const auto& c : laws.springs()) {
            const Vector3 point = rounded(c.a.body >= 0 ? c.b.point : c.a.point);
            const double l = (r - point).norm(), l0 = (r0 - point).norm(), k = c.spring.stiffness;
            // l^2 - l0^2 by the places, which may be near each other
            const double squares = (r - r0).dot(r + r0 - 2.0 * point);
            sum -= 0.5 * k * squares;
            if (l + l0 > 0.0) sum += k * c.spring.rest_length * squares / (l + l0);
            size += k * (l + l0) * (l + l0 + c.spring.rest_length);
        }
        return {sum, size};
    }

    /// m s'^2/2 at u. Throws InvalidInput if it is negative beyond rounding.
    double kinetic(double energy, double u) const {
        require(std::isfinite(energy), user(), "energy", energy, "it is finite, in J");
        const auto [k, rounding] = balance(energy, u);
        require(k >= -rounding, user(), "kinetic energy at parameter " + text(u), k,
                "it is not negative: a motion of energy " + text(energy) + " J does not come there");
        return std::max(k, 0.0);
    }

    /// E + U at u, and its rounding.
    std::pair<double, double> balance(double energy, double u) const {
        const auto [closed, size] = closed_form(u);
        const double potential = closed + work_(u);
        return {energy + potential, 16.0 * epsilon * (std::abs(energy) + size + std::abs(potential))};
    }

    /// The integral of Q from a to b.
    double gained(double a, double b) const {
        PathForces::Values q(forces_);
        return gained(q, a, b - a, forces_.effort(a));
    }
    static double gained(PathForces::Values& q, double a, double way, double effort) {
        return statics::integral([&](double d) { return q(a + d); }, 0.0, way, epsilon * std::abs(way) * effort);
    }

    /// Whether a polynomial force along the whole way pushes on from the end of a piece for ever.
    static bool pushes_on(const statics::PathPiece& p, double way) {
        if (!p.endless) return false;
        std::array<double, statics::order + 1> q = p.output[PathForces::along];
        series::shift(q.data(), statics::order, way);
        double size = 0.0, sign = way;
        for (const double c : q) size += std::abs(c);
        for (const double c : q) {
            if (sign * c < -64.0 * epsilon * size) return false;
            sign *= way;
        }
        return true;
    }

    /// The first turning point from `start`, where the kinetic energy is k, in one direction; or the equilibrium that
    /// it does not come past.
    std::optional<double> turn(double energy, double start, double k, double way) const {
        const double q0 = way * forces_.along_path(start);
        const double noise = 16.0 * epsilon * forces_.effort(start);
        if (k == 0.0 && q0 <= noise) return start;
        const Domain d = curve().domain();
        const double end = way > 0.0 ? d.end : d.begin;
        const double round = curve().period();
        PathPieces pieces(forces_), further(forces_);
        std::optional<double> found, nearest;
        bool grown = false;
        double now = k, size = k, turn_over = round;
        const auto visit = [&](const statics::PathPiece& p) {
            // the kinetic energy about the middle, from what it is at the near end
            std::array<double, statics::order + 2> c{};
            double near = 0.0, far = 0.0, power = way;
            for (int i = 0; i <= statics::order; ++i) {
                const auto at = static_cast<std::size_t>(i);
                c[at + 1] = p.half * p.output[PathForces::along][at] / (i + 1);
                near += c[at + 1] * (i % 2 == 0 ? -way : 1.0);
                far += c[at + 1] * power;
                power *= way;
            }
            c[0] = now - near;
            for (const double term : c) size = std::max(size, std::abs(term));
            std::vector<double> roots = statics::roots_about_middle(c.data(), statics::order + 1);
            if (way < 0.0) std::reverse(roots.begin(), roots.end());
            // where it is least, between slowing down and speeding up: within rounding of zero on a separatrix
            std::vector<double> least = statics::roots_about_middle(p.output[PathForces::along].data(), statics::order);
            if (way < 0.0) std::reverse(least.begin(), least.end());
            for (const double x : least) {
                const double aside = 1e-6, u = p.place(x);
                if (way * (u - start) <= 0.0 || way * p.value(PathForces::along, x + way * aside) <= 0.0) continue;
                const auto [rest, rounding] = balance(energy, u);
                if (rest > rounding) continue;
                if (rest >= -rounding) {
                    statics::PathZeros zeros(further);
                    const auto zero = zeros.near(u, p.half);
                    nearest = zero ? zero->place : u;
                }
                break;
            }
            for (const double x : roots) {
                if (way * p.value(PathForces::along, x) >= 0.0) continue;
                if (nearest && way * (p.place(x) - *nearest) > -0x1p-20 * p.half) break;
                found = polished(start, k, p.place(x), p.half);
                return false;
            }
            if (nearest) {
                found = nearest;
                return false;
            }
            now = c[0] + far;
            // at the very end of the piece, within rounding
            if (now <= 64.0 * epsilon * size && way * p.value(PathForces::along, way) < 0.0) {
                found = polished(start, k, p.place(way), p.half);
                return false;
            }
            // never
            if (now > 0.0 && pushes_on(p, way)) return false;
            grown = way * p.value(PathForces::along, way) > 0.0 && now > 0x1p200 * k;
            // round a closed curve without loss, it goes on for ever
            const double gone = way * ((way > 0.0 ? p.end() : p.begin()) - start);
            if (round > 0.0 && gone >= turn_over) {
                if (gained(start, start + way * round) >= -64.0 * epsilon * size) return false;
                turn_over = std::numeric_limits<double>::infinity();
            }
            return true;
        };
        try {
            pieces.march(start, end, most_stretches, visit);
        } catch (const InvalidInput&) {
            // where forces overflow that have pushed it on for long it does not turn
            if (!grown) throw;
        }
        return found;
    }
    /// The zero of the kinetic energy near u, by Newton's method with the work from the start.
    double polished(double start, double k, double u, double half) const {
        PathForces::Values q(forces_);
        const Domain d = curve().domain();
        const double effort = forces_.effort(start);
        double best = std::numeric_limits<double>::infinity(), place = u;
        for (int iteration = 0; iteration < 6; ++iteration) {
            const double now = k + gained(q, start, place - start, effort);
            if (!(std::abs(now) < best)) break;
            best = std::abs(now);
            u = place;
            const double step = now / q(u);
            if (!(std::abs(step) <= 0.5 * half)) break;
            place = std::clamp(u - step, d.begin, d.end);
            if (place == u) break;
        }
        return u;
    }

    /// The time from a to b > a, kinetic energies at the ends given, zero at turning points.
    double duration(double a, double b, double at_a, double at_b) const {
        const double first = 0.5 * (b - a);
        return half_duration(a, first, at_a) + half_duration(b, -(b - (a + first)), at_b);
    }
    /// The time over a way from u, with x^2 the way gone.
    double half_duration(double u, double way, double k) const {
        PathForces::Values q(forces_);
        const double sign = way > 0.0 ? 1.0 : -1.0, reach = std::sqrt(std::abs(way));
        const double force = std::abs(q(u)), effort = forces_.effort(u);
        double noise = 0.0;
        const PointLaws& laws = forces_.laws();
        const auto rate = [&](double x) {
            const double gone = x * x;
            const double r = std::sqrt(laws.curve_point(forces_.body(), u + sign * gone).speed_squared);
            if (x == 0.0) return k > 0.0 ? 0.0 : 2.0 * r / std::sqrt(2.0 * force / mass());
            const double kinetic = k + gained(q, u, sign * gone, effort);
            noise = std::max(noise, 4.0 * epsilon * (k + effort * gone) / std::abs(kinetic));
            return 2.0 * x * r / std::sqrt(2.0 * kinetic / mass());
        };
        if (k == 0.0 && force <= 16.0 * epsilon * effort) return std::numeric_limits<double>::infinity();
        const double t = statics::integral(rate, 0.0, reach, 0.0, noise);
        if (std::isnan(t))
            throw Error(user() + ": the kinetic energy vanishes within rounding on the way from parameter " + text(u) +
                        " to " + text(u + way) + ": the energy is that of a separatrix");
        return t;
    }

    // a bead thrown up an endless helix turns within so many, or is not waited for
    static constexpr int most_stretches = 1000;

    PathForces forces_;
    RailWork work_;
    double origin_ = 0.0;
};

inline std::ostream& operator<<(std::ostream& out, const RailPotential& u) {
    return out << "potential of " << u.name() << " along its " << u.curve().name();
}

}  // namespace rbdyn
