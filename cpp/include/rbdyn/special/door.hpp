// The laws that a plan takes for scenes of single bodies because they are shorter: the way in to this room.
//
// A scene whose bodies hang on the world, none on another one, nothing held to anything and nothing touching, is one
// for these laws: a bead has its parameter, a symmetric body axes that follow it, what stays as it starts is left out,
// and many motions are known in closed form. Everything else is a tree (mechanics/), and so could these scenes be: the
// two agree (tests/python/test_special_laws.py). Beside this file and lone_body.hpp nothing of this room is seen from
// outside (tests/python/test_rooms.py).
#pragma once

#include <memory>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace planning {

/// A form, or why there is none.
struct FoundForm {
    std::shared_ptr<const ClosedForm> form;
    std::string why_not = {};
};

/// The axes in which most of a scene vanishes: those of the only curve, turned about a line so that the forces lie in
/// one plane with it; else the world's.
Placement view_of(const Scene& scene);

/// The model of a scene, with its equations written in the axes of `view`; what stays as it starts is left out.
[[gnu::cold]] std::shared_ptr<const SceneModel> special_model(const Scene& scene, const Placement& view,
                                                              const GivenNumbers& numbers);

/// The closed form of a scene, or why there is none: that of its bodies one by one, that of linear equations, or that
/// of two bodies that attract each other. `any_rigid`: whether there are rigid bodies, in other parts of it too.
[[gnu::cold]] FoundForm closed_form(const Scene& scene, const SceneModel& model, bool any_rigid);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
