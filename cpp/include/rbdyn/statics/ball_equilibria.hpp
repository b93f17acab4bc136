// The states of rest of one body on a ball joint.
#pragma once

#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace statics {

/// The states of rest of one body on a ball joint: stable ones first, then in the order in which they are found, from q
/// and from attitudes spread over all. Of a family that a turn leads through there is one; of any other, what is found
/// from q alone.
class BallEquilibria {
public:
    BallEquilibria(const Scene& scene, std::vector<double> q) : forces_(scene), start_(std::move(q)) {}

    std::vector<Equilibrium> find();

private:
    Quaternion attitude(const std::vector<double>& q) const { return forces_.attitude(q, 0); }
    std::vector<double> turned(const std::vector<double>& q, const Vector3& axis, double angle) const;
    void look_from(std::vector<double> q);

    TreeForces forces_;
    std::vector<double> start_;
    std::vector<Equilibrium> found_;
    std::vector<std::vector<double>> places_;
};

}  // namespace statics

}  // namespace rbdyn::inline RBDYN_FORM
