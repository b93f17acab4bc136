// The equilibria of a scene: all of them for one body with one coordinate, those of a body on a ball joint, and for
// more freedoms one (search.hpp). On rough rails that is one of the states of rest, and the others
// about it are not given.
#pragma once

#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/forces.hpp"

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

    Forces forces_;
    std::vector<double> start_;
    std::vector<Equilibrium> found_;
    std::vector<std::vector<double>> places_;
};

}  // namespace statics

/// The states of rest of a scene, velocities zero (eqs. 7.16, 7.60).
///
/// One bead on a rail, one rigid body on a hinge or a slide: all there are, in order of the coordinate
/// (path_equilibria.hpp); `near`, its coordinate, says where a path without ends is searched, the body's start
/// otherwise. One body on a ball joint: those found from `near`, or from its start, and from attitudes spread over all,
/// stable ones first. More freedoms: at most one, that in which a slow and damped motion from the start of the scene
/// ends, or where that leads to none, the nearest; given `near`, the one nearest to that, stable or not. An empty list:
/// none was found. Coordinates are those of Equilibrium, all in order of addition. Throws InvalidInput for a scene
/// without bodies, with forces or torques that depend on time or are called back, or with rails that move.
std::vector<Equilibrium> equilibria(const Scene& scene, const std::vector<double>& near = {});

}  // namespace rbdyn::inline RBDYN_FORM
