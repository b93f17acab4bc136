// The generalized forces of a whole scene at rest, and how they change with the place of its bodies.
//
// Freedoms, in order of addition: of a bead its parameter u, Q = F.r' (eq. 7.15); of a free particle x, y, z, Q = F; of
// a hinge its angle, Q = M_3 (eq. 7.60); of a slide its displacement, Q = F.e3; of a body that turns freely a small
// turn d, p -> p exp(d/2), about each axis of its frame (rigid_law.hpp), Q = M about the point its equations are about,
// after those of its centre of mass if it is free. The metric of the kinetic energy is diagonal in them.
// Places are kept as the positions of point_laws.hpp; users give and get them as `coordinates` (equilibrium.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/point_laws.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/model/rigid_law.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

class Forces {
public:
    explicit Forces(const Scene& scene);
    const PointLaws& laws() const { return model_.laws(); }
    int freedoms() const { return freedoms_; }
    int bodies() const { return static_cast<int>(first_.size()); }
    /// Where the freedoms of a body begin, and how many of them are displacements: turns follow.
    int first(int body) const { return first_[at(body)]; }
    int displacements(int body) const;
    bool turns(int body) const { return turns(laws().body(body)); }

    /// How many coordinates a body has.
    static int coordinates_of(const Scene::Body& b);
    /// The place a scene starts in.
    std::vector<double> start() const;
    /// The place of given coordinates. Throws InvalidInput for a quaternion that is not of unit length.
    std::vector<double> place(const std::vector<double>& coordinates) const;
    /// The coordinates of a place; quaternions with w positive.
    std::vector<double> coordinates(const std::vector<double>& q) const;

    /// The attitude of the frame of a body that turns freely.
    Quaternion attitude(const std::vector<double>& q, int body) const;
    /// The place a body has after a turn of it alone about an axis of the world through a point, of unit length [rad].
    std::vector<double> turned(std::vector<double> q, int body, const Vector3& axis, const Vector3& point,
                               double angle) const;
    /// The place that a step in every freedom leads to from q; beads stay on their rails.
    std::vector<double> moved(std::vector<double> q, const std::vector<double>& step) const;
    /// The largest angle by which a step turns a body [rad].
    double largest_turn(const std::vector<double>& step) const;
    /// How far apart two places are in every freedom; of turns, as long as they are small.
    std::vector<double> difference(const std::vector<double>& to, const std::vector<double>& from) const;

    /// What a place says: Q, its Jacobian, the metric, the sizes of the terms of Q, and of the coordinates.
    struct State {
        std::vector<double> force, metric, effort, size;
        SquareMatrix jacobian;
        bool pushed = true;  // rails that only push do so
        bool is_finite() const;
        /// Q^T M^-1 Q
        double misfit() const;
    };
    State at_rest(const std::vector<double>& q);
    /// The Jacobian and the metric in 32 digits.
    struct WideJacobian {
        WideMatrix entries;
        bool is_constant = true;  // the same in all places
    };
    WideJacobian wide_jacobian(const std::vector<double>& q) const;
    std::vector<DoubleDouble> wide_metric(const std::vector<double>& q) const;
    /// What is not finite in a place, in words.
    std::string not_finite(const std::vector<double>& q) const;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    static bool turns(const PointLaws::Body& b) { return b.rigid && b.rigid->turns_freely(); }
    static int freedoms_of(const PointLaws::Body& b) { return b.rigid ? b.rigid->velocities() : b.curve ? 1 : 3; }
    static void write(double* to, const Quaternion& p);

    /// The derivatives by the freedoms of a body: dp = p (0, d)/2 of an attitude.
    void add_columns(int body, const std::vector<double>& q, SquareMatrix& jacobian) const;

    /// The formula that is right in a place.
    void choose(const std::vector<double>& q);
    void record(const std::vector<double>& q);
    /// Q of positions that are recorded.
    std::vector<Expression> recorded(const std::vector<Expression>& q) const;
    /// The rates of a quaternion p with small turns about the axes of its frame, twice.
    static std::array<std::array<double, 4>, 3> turning(const Quaternion& p);

    PointsModel model_;
    std::vector<int> first_;
    int freedoms_ = 0;
    Program program_;
    std::vector<double> parameters_;
    std::unique_ptr<JacobianEvaluator> values_;
    bool distinguishes_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM::statics
