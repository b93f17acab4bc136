// Definitions of rbdyn/statics/rail_potential.hpp.
#pragma once

#include "rbdyn/statics/rail_potential.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/quadrature.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/path_pieces.hpp"
#include "rbdyn/statics/path_zero.hpp"
#include "rbdyn/statics/rail_work.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What acts on the bead.
struct RailPotential::Forces {
    PathForces path;
    RailWork work;
    double origin = arc_length_origin(path.curve());
};

namespace statics {

/// The integral of Q over a way from a.
inline double gained(PathForces::Values& q, double a, double way, double effort) {
    return curves::integral([&](double d) { return q(a + d); }, 0.0, way,
                            std::numeric_limits<double>::epsilon() * std::abs(way) * effort);
}

/// Whether a polynomial force along the whole way pushes on from the end of a piece for ever.
inline bool pushes_on(const PathPiece& p, double way) {
    if (!p.endless) return false;
    std::array<double, order + 1> q = p.output[PathForces::along];
    series::shift(q.data(), order, way);
    double size = 0.0, sign = way;
    for (const double c : q) size += std::abs(c);
    for (const double c : q) {
        if (sign * c < -64.0 * std::numeric_limits<double>::epsilon() * size) return false;
        sign *= way;
    }
    return true;
}

}  // namespace statics

RBDYN_INLINE RailPotential::RailPotential(const Scene& scene, BodyHandle bead)
    : forces_(std::make_shared<const Forces>(
          Forces{.path = PathForces(checked(scene.frozen(), bead)), .work = RailWork(scene.frozen(), bead)})) {}

RBDYN_INLINE const Curve& RailPotential::curve() const { return forces_->path.curve(); }

RBDYN_INLINE const std::string& RailPotential::name() const { return forces_->path.name(); }

RBDYN_INLINE double RailPotential::mass() const { return forces_->path.mass(); }

RBDYN_INLINE double RailPotential::value(double u) const { return closed_form(u).first + forces_->work(on_rail(u)); }

RBDYN_INLINE double RailPotential::work_of_forces(double u) const { return forces_->work(on_rail(u)); }

RBDYN_INLINE double RailPotential::tangential_force(double u) const {
    curve().require_regular(on_rail(u));
    return forces_->path.along_path(u) / curves::norm(curve().first(u));
}

RBDYN_INLINE double RailPotential::energy(double u, double speed) const {
    require(std::isfinite(speed), user(), "speed", speed, "it is finite, in m/s");
    return 0.5 * mass() * speed * speed - value(u);
}

RBDYN_INLINE double RailPotential::speed(double u, double energy) const {
    return std::sqrt(2.0 * kinetic(energy, u) / mass());
}

RBDYN_INLINE TurningPoints RailPotential::turning_points(double energy, double start) const {
    const double k = kinetic(energy, start);
    return {turn(energy, start, k, -1.0), turn(energy, start, k, 1.0)};
}

RBDYN_INLINE double RailPotential::period(double energy, double start) const {
    const TurningPoints t = turning_points(energy, start);
    if (t.below && t.above) {
        if (*t.below < *t.above) return 2.0 * duration(*t.below, *t.above, 0.0, 0.0);
        PathPieces pieces(forces_->path);
        const statics::PathPiece& p = pieces.about(start, pieces.natural(start));
        const double slope = p.output[PathForces::along][1] / p.half;
        return slope < 0.0 ? 2.0 * std::numbers::pi * std::sqrt(-mass() * curve().first(start).squaredNorm() / slope)
                           : std::numeric_limits<double>::infinity();
    }
    if (!t.above && curve().period() > 0.0) {
        const double k = kinetic(energy, start), end = start + curve().period();
        return duration(start, end, k, k + gained(start, end));
    }
    throw InvalidInput(user() + ": the motion with energy " + text(energy) + " J that passes parameter " + text(start) +
                       " does not turn round " +
                       (t.above   ? "below"
                        : t.below ? "above"
                                  : "either way") +
                       ", so it has no period");
}

RBDYN_INLINE double RailPotential::time(double energy, double u0, double u1) const {
    if (u1 < u0) return -time(energy, u1, u0);
    if (u0 == on_rail(u1)) return 0.0;
    const double k0 = kinetic(energy, u0), k1 = kinetic(energy, u1), way = u1 - u0;
    const std::optional<double> turn_above = turn(energy, u0, k0, 1.0);
    const double slack = 1e-12 * way;
    // not past an equilibrium that it only comes near
    if (turn_above && *turn_above < u1 - slack &&
        std::abs(forces_->path.along_path(*turn_above)) <= 16.0 * epsilon * forces_->path.effort(*turn_above))
        return std::numeric_limits<double>::infinity();
    if (turn_above && *turn_above < u1 - slack)
        throw InvalidInput(user() + ": the motion with energy " + text(energy) + " J turns round at parameter " +
                           text(*turn_above) + ", before it comes from " + text(u0) + " to " + text(u1));
    return duration(u0, u1, k0, k1);
}

RBDYN_INLINE Scene RailPotential::checked(const Scene& scene, BodyHandle bead) {
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
        if (!keeps_energy(c.coupling))
            refuse(std::holds_alternative<Spring>(c.coupling)
                       ? "a damper acts on"
                       : "a pair force, of which no potential is known, acts on");
    return one;
}

RBDYN_INLINE std::string RailPotential::user() const { return "rail potential of " + name(); }

RBDYN_INLINE double RailPotential::on_rail(double u) const {
    const Domain d = curve().domain();
    require(std::isfinite(u), user(), "parameter", u, "it is finite");
    require(u >= d.begin && u <= d.end, user(), "parameter", u,
            "it lies in the domain of the curve, " + text(d.begin) + " to " + text(d.end));
    return u;
}

RBDYN_INLINE Vector3 RailPotential::place(double u) const { return curve().at<double>(u, Placement{}).position; }

RBDYN_INLINE std::pair<double, double> RailPotential::closed_form(double u) const {
    const Scene& scene = forces_->path.scene();
    const Vector3 r = place(on_rail(u)), r0 = place(forces_->origin);
    Vector3Of<DoubleDouble> constant = scaled(widened(scene.gravity()), DoubleDouble(mass()));
    double sum = 0.0, size = 0.0;
    for (const Scene::AppliedLoad& load : scene.loads()) {
        const Force* force = std::get_if<Force>(&load.load);
        if (force != nullptr && force->is_constant()) constant += widened(force->settled());
        const Potential* potential = std::get_if<Potential>(&load.load);
        if (potential == nullptr) continue;
        const double here = potential->value<double>(r), there = potential->value<double>(r0);
        sum += here - there;
        size += std::abs(here) + std::abs(there);
    }
    const Vector3 force = rounded(constant);
    for (int i = 0; i < 3; ++i) {
        sum += force[i] * (r[i] - r0[i]);
        size += std::abs(force[i]) * (std::abs(r[i]) + std::abs(r0[i]));
    }
    for (const Scene::Connection& c : scene.connections()) {
        if (!is_present(c.coupling)) continue;
        const Vector3* fixed = std::get_if<Vector3>(&c.a);
        const Vector3 point = fixed != nullptr ? *fixed : std::get<Vector3>(c.b);
        const double l = (r - point).norm(), l0 = (r0 - point).norm();
        if (const Central* central = std::get_if<Central>(&c.coupling)) {
            const double gain = central->gain(l0, l);
            sum += gain;
            size += std::abs(gain) + std::abs(central->magnitude<double>(l)) * (r.norm() + point.norm());
            continue;
        }
        const Spring& spring = std::get<Spring>(c.coupling);
        const double k = spring.stiffness;
        // l^2 - l0^2 by the places, which may be near each other
        const double squares = (r - r0).dot(r + r0 - 2.0 * point);
        sum -= 0.5 * k * squares;
        if (l + l0 > 0.0) sum += k * spring.rest_length * squares / (l + l0);
        size += k * (l + l0) * (l + l0 + spring.rest_length);
    }
    return {sum, size};
}

RBDYN_INLINE double RailPotential::kinetic(double energy, double u) const {
    require(std::isfinite(energy), user(), "energy", energy, "it is finite, in J");
    const auto [k, rounding] = balance(energy, u);
    require(k >= -rounding, user(), "kinetic energy at parameter " + text(u), k,
            "it is not negative: a motion of energy " + text(energy) + " J does not come there");
    return std::max(k, 0.0);
}

RBDYN_INLINE std::pair<double, double> RailPotential::balance(double energy, double u) const {
    const auto [closed, size] = closed_form(u);
    const double potential = closed + forces_->work(u);
    return {energy + potential, 16.0 * epsilon * (std::abs(energy) + size + std::abs(potential))};
}

RBDYN_INLINE double RailPotential::gained(double a, double b) const {
    PathForces::Values q(forces_->path);
    return statics::gained(q, a, b - a, forces_->path.effort(a));
}

RBDYN_INLINE std::optional<double> RailPotential::turn(double energy, double start, double k, double way) const {
    const double q0 = way * forces_->path.along_path(start);
    const double noise = 16.0 * epsilon * forces_->path.effort(start);
    if (k == 0.0 && q0 <= noise) return start;
    const Domain d = curve().domain();
    const double end = way > 0.0 ? d.end : d.begin;
    const double round = curve().period();
    PathPieces pieces(forces_->path), further(forces_->path);
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
        if (now > 0.0 && statics::pushes_on(p, way)) return false;
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

RBDYN_INLINE double RailPotential::polished(double start, double k, double u, double half) const {
    PathForces::Values q(forces_->path);
    const Domain d = curve().domain();
    const double effort = forces_->path.effort(start);
    double best = std::numeric_limits<double>::infinity(), place = u;
    for (int iteration = 0; iteration < 6; ++iteration) {
        const double now = k + statics::gained(q, start, place - start, effort);
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

RBDYN_INLINE double RailPotential::duration(double a, double b, double at_a, double at_b) const {
    const double first = 0.5 * (b - a);
    return half_duration(a, first, at_a) + half_duration(b, -(b - (a + first)), at_b);
}

RBDYN_INLINE double RailPotential::half_duration(double u, double way, double k) const {
    PathForces::Values q(forces_->path);
    const double sign = way > 0.0 ? 1.0 : -1.0, reach = std::sqrt(std::abs(way));
    const double force = std::abs(q(u)), effort = forces_->path.effort(u);
    double noise = 0.0;
    const auto rate = [&](double x) {
        const double gone = x * x;
        const double r = forces_->path.speed(u + sign * gone);
        if (x == 0.0) return k > 0.0 ? 0.0 : 2.0 * r / std::sqrt(2.0 * force / mass());
        const double kinetic = k + statics::gained(q, u, sign * gone, effort);
        noise = std::max(noise, 4.0 * epsilon * (k + effort * gone) / std::abs(kinetic));
        return 2.0 * x * r / std::sqrt(2.0 * kinetic / mass());
    };
    if (k == 0.0 && force <= 16.0 * epsilon * effort) return std::numeric_limits<double>::infinity();
    const double t = curves::integral(rate, 0.0, reach, 0.0, noise);
    if (std::isnan(t))
        throw Error(user() + ": the kinetic energy vanishes within rounding on the way from parameter " + text(u) +
                    " to " + text(u + way) + ": the energy is that of a separatrix");
    return t;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const RailPotential& u) {
    return out << "potential of " << u.name() << " along its " << u.curve().name();
}

}  // namespace rbdyn::inline RBDYN_FORM
