// The generalized forces of point masses and single bodies at rest, and how they change with their places.
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
#include "rbdyn/statics/forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

class PointForces : public Forces {
public:
    explicit PointForces(const Scene& scene);
    const PointLaws& laws() const { return model_.laws(); }
    int freedoms() const override { return freedoms_; }
    int bodies() const override { return static_cast<int>(first_.size()); }
    /// Where the freedoms of a body begin, and how many of them are displacements: turns follow.
    int first(int body) const override { return first_[at(body)]; }
    int displacements(int body) const override;
    bool turns(int body) const override { return turns(laws().body(body)); }

    std::vector<double> start() const override;
    std::vector<double> place(const std::vector<double>& coordinates) const override;
    std::vector<double> coordinates(const std::vector<double>& q) const override;

    Quaternion attitude(const std::vector<double>& q, int body) const override;
    Vector3 center(const std::vector<double>& q, int body) const override;
    Vector3 turn_in_world(const std::vector<double>& q, int body, const Vector3& turn) const override;
    std::vector<double> turned(std::vector<double> q, int body, const Vector3& axis, const Vector3& point,
                               double angle) const override;
    std::vector<double> moved(std::vector<double> q, const std::vector<double>& step) const override;
    double largest_turn(const std::vector<double>& step) const override;
    std::vector<double> difference(const std::vector<double>& to, const std::vector<double>& from) const override;
    State at_rest(const std::vector<double>& q) override;
    std::string not_finite(const std::vector<double>& q) const override;
    /// The Jacobian and the metric in 32 digits.
    struct WideJacobian {
        WideMatrix entries;
        bool is_constant = true;  // the same in all places
    };
    WideJacobian wide_jacobian(const std::vector<double>& q) const;
    std::vector<DoubleDouble> wide_metric(const std::vector<double>& q) const;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    static bool turns(const PointLaws::Body& b) { return b.rigid && b.rigid->turns_freely(); }
    static int freedoms_of(const PointLaws::Body& b) { return b.rigid ? b.rigid->velocities() : b.curve ? 1 : 3; }

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
