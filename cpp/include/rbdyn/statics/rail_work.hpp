// The work of forces along a rail at rest that have a potential there, whether or not they have one in space.
#pragma once

#include <optional>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/path_forces.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The work of a bead's recorded `Force` functions along its rail, of those that have a potential there
/// (planning::has_potential_along_rail).
class RailWork {
public:
    RailWork(const Scene& scene, BodyHandle bead);

    /// The integral of their F_t from the origin of arc length to u [J].
    double operator()(double u) const;

private:
    std::optional<PathForces> forces_;
    double origin_ = 0.0;
};

}  // namespace rbdyn::inline RBDYN_FORM
