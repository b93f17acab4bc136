// Bodies that stand flat on planes at rest, and slide.
//
// Three points of a body on one plane leave it a turn about the normal, and two of a body in a plane none; so they do
// wherever they slide, and what stands flat on a plane of such a body parallel to its own does as well. So the normal
// stays what it is: what rounded forces leave of accelerations along it, and of turns about other axes, is taken away.
// Left there a tilt would grow as the square of the time, and what its own weight then makes of it as the fourth power.
// A particle keeps to the planes it touches: to the line of two, and in the corner of three it does not move.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/contact.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/joint/free.hpp"
#include "rbdyn/mechanics/joint/planar.hpp"
#include "rbdyn/mechanics/tree.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// The plane that a body stands flat on, or a particle touches, in the world.
struct Level {
    Vector3 own;                          // its normal, or against it, axes of the body
    Vector3Of<DoubleDouble> normal;       // unit
    Vector3Of<DoubleDouble> tangents[2];  // the first of them are the ways it may go
    std::size_t ways;                     // how many: of a body in a plane one
    bool turns;                           // about the normal
    int on = -1;                          // of planes of the world: the first contact with them

    /// What of an acceleration goes along the plane.
    Vector3Of<Expression> along(const Vector3Of<Expression>& a) const {
        Vector3Of<Expression> result = none<Expression>();
        for (std::size_t k = 0; k < ways; ++k) {
            const Vector3Of<Expression> way = exactly<Expression>(tangents[k]);
            result += Vector3Of<Expression>(way * dot<Expression>(way, a));
        }
        return result;
    }
    /// What of an angular acceleration is about the normal.
    Vector3Of<Expression> about(const Vector3Of<Expression>& a) const {
        if (!turns) return none<Expression>();
        const Vector3Of<Expression> n = exactly<Expression>(normal);
        return n * dot<Expression>(n, a);
    }
};

namespace leveling {

inline constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();

inline bool are_parallel(const Vector3& a, const Vector3& b) {
    return a.cross(b).norm() <= rounding * a.norm() * b.norm();
}

/// Contacts whose centres of balls as large as each other lie in one plane of the world or of a body.
inline bool are_level(const ContactLaw& one, const ContactLaw& other) {
    if (one.b.body != other.b.body || one.radius != other.radius) return false;
    const Vector3 n = rounded(one.normal), apart = rounded(Vector3Of<DoubleDouble>(one.b.point - other.b.point));
    return n.dot(rounded(other.normal)) > 0.0 && are_parallel(n, rounded(other.normal)) &&
           std::abs(n.dot(apart)) <= rounding * (rounded(one.b.point).norm() + rounded(other.b.point).norm());
}

/// The normal of a plane through points, if they are far from one line; nothing else.
inline std::optional<Vector3> normal_through(const std::vector<Vector3>& points) {
    constexpr double least = 1e-3;
    double size = 0.0;
    Vector3 along = Vector3::Zero(), normal = Vector3::Zero();
    for (const Vector3& p : points) {
        size = std::max(size, p.norm());
        if (const Vector3 way = p - points.front(); way.norm() > along.norm()) along = way;
    }
    for (const Vector3& p : points)
        if (const Vector3 n = along.cross(Vector3(p - points.front())); n.norm() > normal.norm()) normal = n;
    if (!(normal.norm() > least * size * size)) return std::nullopt;
    return Vector3(normal / normal.norm());
}

/// How a body stands on those of its contacts that touch the plane of a first one, which lies in the world as said.
inline std::optional<Level> standing(const Node& node, const std::vector<const ContactLaw*>& on,
                                     const Vector3Of<DoubleDouble>& normal, const Vector3Of<DoubleDouble>* tangents) {
    std::vector<Vector3> points;
    for (const ContactLaw* c : on) points.push_back(rounded(c->a.point));
    if (node.joint.as<FreeBodyLaw>() != nullptr) {
        const auto own = normal_through(points);
        if (!own) return std::nullopt;
        return Level{*own, normal, {tangents[0], tangents[1]}, 2, true};
    }
    const PlanarLaw* law = node.joint.as<PlanarLaw>();
    if (law == nullptr) return std::nullopt;
    const Vector3 axis = rounded(law->normal);
    if (std::abs(axis.dot(rounded(normal))) > rounding) return std::nullopt;
    // a body in a plane has the axes of that plane as it starts: the points it stands on, seen along its axis
    const auto own = normal_through([&] {
        std::vector<Vector3> seen;
        double size = 0.0;
        for (const Vector3& p : points) {
            seen.push_back(p - axis * axis.dot(p));
            size = std::max(size, seen.back().norm());
        }
        seen.push_back(seen.front() + axis * size);
        return seen;
    }());
    if (!own) return std::nullopt;
    Vector3Of<DoubleDouble> way = cross<DoubleDouble>(law->normal, normal);
    // what stands on it, and is kept in no plane, may go across that, too
    return Level{*own, normal, {way, law->normal}, 1, false};
}

/// How a particle goes on along the planes of the world that it touches.
inline Level touching(const std::vector<const ContactLaw*>& on) {
    constexpr double least = 1e-3;
    const ContactLaw& first = *on.front();
    Level level{Vector3::Zero(), first.normal, {first.tangents[0], first.tangents[1]}, 2, false};
    for (const ContactLaw* c : on) {
        if (level.ways == 2) {
            const Vector3Of<DoubleDouble> line = cross<DoubleDouble>(level.normal, c->normal);
            const DoubleDouble length = sqrt(dot<DoubleDouble>(line, line));
            if (!(static_cast<double>(length) > least)) continue;
            level.tangents[0] = line * (DoubleDouble(1.0) / length);
            level.ways = 1;
        } else if (level.ways == 1 && std::abs(rounded(level.tangents[0]).dot(rounded(c->normal))) > least) {
            level.ways = 0;
        }
    }
    return level;
}

}  // namespace leveling

/// The bodies of a tree that stand flat, and particles that touch planes, where contacts do what their states say.
inline std::vector<std::optional<Level>> levels(const Tree& tree, const Conditions& conditions,
                                                std::span<const signed char> states) {
    const auto place = [](int body) { return static_cast<std::size_t>(body); };
    std::vector<std::optional<Level>> found(place(tree.size()));
    std::vector<std::vector<const ContactLaw*>> feet(found.size());
    for (std::size_t k = 0; k < conditions.contacts().size(); ++k) {
        const ContactLaw& c = conditions.contacts()[k];
        const bool is_flat = c.part == ContactLaw::Part::ball && c.surface == ContactLaw::Surface::plane;
        if (states[k] != flies && is_flat && tree.node(c.a.body).parent < 0) feet[place(c.a.body)].push_back(&c);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (tree.node(static_cast<int>(i)).joint.as<FreePointLaw>() == nullptr) continue;
        std::vector<const ContactLaw*> on;
        std::ranges::copy_if(feet[i], std::back_inserter(on), [](const ContactLaw* c) { return c->b.body < 0; });
        if (!on.empty()) found[i] = leveling::touching(on);
    }
    // what stands on what stands
    for (bool goes_on = true; goes_on;) {
        goes_on = false;
        for (std::size_t i = 0; i < found.size(); ++i)
            for (const ContactLaw* c : feet[i]) {
                if (found[i] || tree.node(static_cast<int>(i)).is_point) break;
                const std::optional<Level>* below = c->b.body < 0 ? nullptr : &found[place(c->b.body)];
                if (below != nullptr && !(*below && leveling::are_parallel((*below)->own, rounded(c->normal))))
                    continue;
                std::vector<const ContactLaw*> on;
                std::ranges::copy_if(feet[i], std::back_inserter(on),
                                     [&](const ContactLaw* other) { return leveling::are_level(*c, *other); });
                found[i] = leveling::standing(tree.node(static_cast<int>(i)), on,
                                              below == nullptr ? c->normal : (*below)->normal,
                                              below == nullptr ? c->tangents : (*below)->tangents);
                if (found[i] && below == nullptr) found[i]->on = static_cast<int>(c - conditions.contacts().data());
                goes_on = goes_on || found[i].has_value();
            }
    }
    return found;
}

/// Takes from rates of variables, and from the accelerations of bodies behind them, in the layout of tree_state.hpp,
/// what these do not have. `turns`: of a contact the factor of how what stands on it turns.
template <class Turns>
void keep_level(const Tree& tree, const std::vector<std::optional<Level>>& levels, const Turns& turns,
                std::vector<Expression>& values) {
    const auto replace = [](Expression* to, const Vector3Of<Expression>& v) { std::copy_n(v.data(), 3, to); };
    const auto vector = [](const Expression* from) { return Vector3Of<Expression>(from[0], from[1], from[2]); };
    for (int i = 0; i < tree.size(); ++i) {
        if (!levels[static_cast<std::size_t>(i)]) continue;
        const Level& level = *levels[static_cast<std::size_t>(i)];
        Expression* const rates = values.data() + tree.positions() + tree.node(i).v;
        Expression* const acts = values.data() + tree.variables() + 12 * i + 6;
        replace(acts + 3, level.along(vector(acts + 3)));
        if (tree.node(i).is_point) {
            replace(rates, level.along(vector(rates)));
            continue;
        }
        const Expression turning = level.on < 0 ? Expression(1.0) : Expression(turns(level.on));
        replace(acts, Vector3Of<Expression>(level.about(vector(acts)) * turning));
        if (const auto* law = tree.node(i).joint.as<PlanarLaw>()) {
            const Vector3Of<Expression> x = exactly<Expression>(law->x), y = exactly<Expression>(law->y),
                                        a = level.along(Vector3Of<Expression>(x * rates[0] + y * rates[1]));
            rates[0] = dot<Expression>(x, a);
            rates[1] = dot<Expression>(y, a);
            rates[2] = Expression(0.0);
        } else {
            replace(rates, level.along(vector(rates)));
            replace(rates + 3, Vector3Of<Expression>(level.about(vector(rates + 3)) * turning));
        }
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
