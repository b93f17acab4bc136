// Definitions of rbdyn/statics/normal_modes.hpp.
#pragma once

#include "rbdyn/statics/normal_modes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace statics {

/// The lower triangle L of M = L L^T.
RBDYN_INLINE WideMatrix cholesky(const WideMatrix& m) {
    const int n = m.size();
    WideMatrix l(n);
    for (int j = 0; j < n; ++j) {
        Interruption::point();
        for (int i = j; i < n; ++i) {
            DoubleDouble sum = m(i, j);
            for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
            if (i == j && !(sum.hi > 0.0))
                throw InvalidInput("normal_modes: the mass matrix has pivot " + text(sum.hi) + " in row " +
                                   std::to_string(j) + "; a kinetic energy is positive for every motion");
            l(i, j) = i == j ? sqrt(sum) : sum / l(j, j);
        }
    }
    return l;
}

/// The place of an equilibrium. Throws InvalidInput where it is none.
inline std::vector<double> place_of_rest(TreeForces& forces, const std::vector<double>& coordinates,
                                         const std::string& user) {
    std::vector<double> q = forces.place(coordinates);
    const Forces::State s = forces.at_rest(q);
    if (!s.is_finite()) throw InvalidInput(user + ": at the equilibrium " + forces.not_finite(q) + " is not finite");
    // places are known to rounding, and users write some digits of them
    constexpr double near = 1e-6;
    const std::vector<double> sizes = forces.force_sizes(forces.wide(q)), units = forces.units();
    for (std::size_t i = 0; i < s.force.size(); ++i) {
        // and nothing is what is rounding
        double slack = s.effort[i] + 64.0 * std::numeric_limits<double>::epsilon() / near * sizes[i];
        for (std::size_t j = 0; j < s.size.size(); ++j)
            slack += std::abs(s.jacobian(static_cast<int>(i), static_cast<int>(j))) *
                     (s.size[j] + std::numeric_limits<double>::epsilon() / near * units[j]);
        require(std::abs(s.force[i]) <= near * slack, user, "generalized force of freedom " + std::to_string(i),
                s.force[i], "at an equilibrium there is none; take one of equilibria(scene)");
    }
    return q;
}

}  // namespace statics

RBDYN_INLINE SmallModes small_modes(const SmallMotion& motion) {
    const int n = motion.mass.size();
    const WideMatrix l = statics::cholesky(motion.mass);
    // L^-1 K L^-T: first all columns of K, then all rows of that
    WideMatrix a = motion.stiffness;
    for (int column = 0; column < n; ++column) {
        Interruption::point();
        for (int i = 0; i < n; ++i) {
            for (int k = 0; k < i; ++k) a(i, column) -= l(i, k) * a(k, column);
            a(i, column) /= l(i, i);
        }
    }
    for (int row = 0; row < n; ++row) {
        Interruption::point();
        for (int i = 0; i < n; ++i) {
            for (int k = 0; k < i; ++k) a(row, i) -= l(i, k) * a(row, k);
            a(row, i) /= l(i, i);
        }
    }
    // that of 32 digits, or of a place in doubles
    const double rounding = (motion.is_even ? 64.0 * 0x1p-104 : 64.0 * 0x1p-52) * n * a.largest();
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) {
            const double twist = std::abs((a(i, j) - a(j, i)).hi);
            if (twist > 0x1p-40 * a.largest() + rounding)
                throw InvalidInput("normal_modes: the stiffness differs by " + text(twist) +
                                   " 1/s^2 from its transpose (freedoms " + std::to_string(j) + " and " +
                                   std::to_string(i) +
                                   "): the forces have no potential, and only those that have one have normal modes; "
                                   "leave out what has none");
            a(i, j) = a(j, i) = 0.5 * (a(i, j) + a(j, i));
        }
    const SymmetricModes e = symmetric_modes(a);
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    const auto value = [&](int mode) { return e.values[static_cast<std::size_t>(mode)]; };
    std::sort(order.begin(), order.end(), [&](int i, int j) { return value(i) - value(j) < 0.0; });
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    SmallModes result{{}, {}, SquareMatrix(n)};
    for (int k = 0; k < n; ++k) {
        Interruption::point();
        const int mode = order[static_cast<std::size_t>(k)];
        // L^-T y
        std::vector<DoubleDouble> shape(static_cast<std::size_t>(n));
        for (int i = n - 1; i >= 0; --i) {
            DoubleDouble x = e.vectors(i, mode);
            for (int j = i + 1; j < n; ++j) x -= l(j, i) * shape[static_cast<std::size_t>(j)];
            x /= l(i, i);
            shape[static_cast<std::size_t>(i)] = x;
            result.shapes(i, k) = x.hi;
        }
        result.squares.push_back(value(mode).hi);
        // a slow mode does not know the rounding of the stiffness of others that it does not strain
        double own = rounding;
        if (motion.sizes && !motion.is_even) {
            own = e.error;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j)
                    own += 16.0 * epsilon * std::abs(result.shapes(i, k) * result.shapes(j, k)) * (*motion.sizes)(i, j);
        }
        result.rounding.push_back(own);
    }
    return result;
}

RBDYN_INLINE NormalModes normal_modes(const SmallMotion& motion) {
    const SmallModes modes = small_modes(motion);
    const int n = modes.shapes.size();
    NormalModes result{{}, {}, Matrix(n, n)};
    for (int k = 0; k < n; ++k) {
        const auto mode = static_cast<std::size_t>(k);
        const double square = std::abs(modes.squares[mode]) <= modes.rounding[mode] ? 0.0 : modes.squares[mode];
        result.squares.push_back(square);
        result.frequencies.push_back(square < 0.0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(square));
        double largest = 0.0;
        for (int i = 0; i < n; ++i)
            if (std::abs(modes.shapes(i, k)) >= std::abs(largest)) largest = modes.shapes(i, k);
        for (int i = 0; i < n; ++i) result.shapes(i, k) = std::copysign(1.0, largest) * modes.shapes(i, k);
    }
    return result;
}

RBDYN_INLINE NormalModes normal_modes(const Scene& scene, const Equilibrium& at) {
    const std::string user = "normal_modes";
    if (scene.bodies().empty()) throw InvalidInput("Scene: it has 0 bodies; add() at least one before it is asked");
    const Scene now = scene.frozen();
    int coordinates = 0;
    for (int i = 0; i < static_cast<int>(now.bodies().size()); ++i) {
        const Scene::Body& body = now.bodies()[static_cast<std::size_t>(i)];
        statics::require_timeless(now, i, user);
        if (body.rail() != nullptr && body.rail()->friction())
            throw InvalidInput(user + ": friction holds " + body.name +
                               ", and what sticks does not oscillate; take it away with without(\"static friction\", "
                               "\"dynamic friction\")");
        coordinates += statics::coordinates_of(body);
    }
    require(static_cast<int>(at.coordinates.size()) == coordinates, user, "number of coordinates of the equilibrium",
            static_cast<double>(at.coordinates.size()), "this scene has " + std::to_string(coordinates));
    statics::TreeForces forces(now);
    require(forces.freedoms() > 0, user, "number of freedoms", forces.freedoms(), "something can move");
    const std::vector<double> q = statics::place_of_rest(forces, at.coordinates, user);
    NormalModes modes = normal_modes(statics::small_motion(forces));
    // all bodies are told, also those that follow from others
    Matrix shapes;
    for (int mode = 0; mode < forces.freedoms(); ++mode) {
        std::vector<double> motion;
        for (int i = 0; i < forces.freedoms(); ++i) motion.push_back(modes.shapes(i, mode));
        std::vector<double> all = forces.in_bodies(q, motion);
        double largest = 0.0;
        for (const double x : all)
            if (std::abs(x) > std::abs(largest)) largest = x;
        if (mode == 0) shapes = Matrix(static_cast<int>(all.size()), forces.freedoms());
        for (std::size_t k = 0; k < all.size(); ++k)
            shapes(static_cast<int>(k), mode) = std::copysign(1.0, largest) * all[k];
    }
    modes.shapes = std::move(shapes);
    return modes;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const NormalModes& modes) {
    out << "Normal modes:\n";
    for (std::size_t k = 0; k < modes.squares.size(); ++k) {
        out << "  " << k + 1 << ": ";
        if (modes.squares[k] < 0.0)
            out << "unstable, grows as exp(" << text(std::sqrt(-modes.squares[k])) << " t)\n";
        else
            out << text(modes.frequencies[k]) << " rad/s\n";
    }
    return out;
}

}  // namespace rbdyn::inline RBDYN_FORM
