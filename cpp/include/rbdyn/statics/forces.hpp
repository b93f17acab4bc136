// What a search for states of rest asks of a scene: the generalized forces at rest in freedoms of its own, and how they
// change with the place of its bodies.
//
// Of a scene: tree_forces.hpp. Users give and get places as `coordinates` (equilibrium.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

class Forces {
public:
    Forces() = default;
    Forces(const Forces&) = delete;
    Forces& operator=(const Forces&) = delete;
    virtual ~Forces() = default;

    virtual int freedoms() const = 0;
    virtual int bodies() const = 0;
    /// Whether a body turns freely, three of the freedoms its own: first() says where its own begin, displacements()
    /// how many of them there are before its turns.
    virtual bool turns(int body) const = 0;
    virtual int first(int body) const = 0;
    virtual int displacements(int body) const = 0;

    /// The place a scene starts in.
    virtual std::vector<double> start() const = 0;
    /// The place of given coordinates. Throws InvalidInput for a quaternion that is not of unit length.
    virtual std::vector<double> place(const std::vector<double>& coordinates) const = 0;
    /// The coordinates of a place; quaternions with w positive.
    virtual std::vector<double> coordinates(const std::vector<double>& q) const = 0;

    /// The attitude of the frame that a body that turns freely turns in, and the point its displacements are of.
    virtual Quaternion attitude(const std::vector<double>& q, int body) const = 0;
    virtual Vector3 center(const std::vector<double>& q, int body) const = 0;
    /// A turn of a body that turns freely, by its three freedoms, in the world.
    virtual Vector3 turn_in_world(const std::vector<double>& q, int body, const Vector3& turn) const = 0;
    /// The place a body has after a turn of it alone about an axis of the world through a point, of unit length [rad].
    virtual std::vector<double> turned(std::vector<double> q, int body, const Vector3& axis, const Vector3& point,
                                       double angle) const = 0;
    /// The place that a step in every freedom leads to from q; beads stay on their rails.
    virtual std::vector<double> moved(std::vector<double> q, const std::vector<double>& step) const = 0;
    /// The largest angle by which a step turns a body [rad].
    virtual double largest_turn(const std::vector<double>& step) const = 0;
    /// How far apart two places are in every freedom; of turns, as long as they are small.
    virtual std::vector<double> difference(const std::vector<double>& to, const std::vector<double>& from) const = 0;

    /// What a place says: Q, its Jacobian, the metric, the sizes of the terms of Q, and of the coordinates.
    struct State {
        std::vector<double> force, metric, effort, size;
        SquareMatrix jacobian;
        bool pushed = true;  // rails that only push do so
        bool idle = false;   // one of them does with nothing, within rounding: off it all may be otherwise
        bool is_finite() const {
            const auto all_finite = [](const std::vector<double>& v) {
                return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
            };
            return all_finite(force) && all_finite(jacobian.entries());
        }
        /// Q^T M^-1 Q
        double misfit() const {
            double sum = 0.0;
            for (std::size_t i = 0; i < force.size(); ++i) sum += force[i] * force[i] / metric[i];
            return sum;
        }
    };
    virtual State at_rest(const std::vector<double>& q) = 0;
    /// What is not finite in a place, in words.
    virtual std::string not_finite(const std::vector<double>& q) const = 0;

protected:
    /// An attitude among the positions of a place.
    static void write(double* to, const Quaternion& p) {
        for (const double x : {p.w, p.x, p.y, p.z}) *to++ = x;
    }
    /// An attitude among coordinates, w positive; what is below the last digit of one is rounding.
    static void tell(Quaternion p, std::vector<double>& coordinates) {
        if (p.w < 0.0) p = {-p.w, -p.x, -p.y, -p.z};
        for (const double x : {p.w, p.x, p.y, p.z})
            coordinates.push_back(std::abs(x) < 0.5 * std::numeric_limits<double>::epsilon() ? 0.0 : x);
    }
};

/// How many coordinates a body has.
int coordinates_of(const Scene::Body& b);

}  // namespace rbdyn::inline RBDYN_FORM::statics
