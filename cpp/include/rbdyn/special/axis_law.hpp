// What hinges and slides have in common: one coordinate along or about an axis e3 of the world.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/rigid_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

class AxisLaw : public RigidLaw {
public:
    int positions() const override { return 1; }
    void start_in(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const override;
    const char* mover() const override { return "a load along its joint or a rate"; }
    void leave_out(const StateMap& map, std::vector<Omission>& omissions) const override;

protected:
    AxisLaw(const Scene& scene, int place, const Vector3& axis, const Vector3& at, const Vector3& point);

    /// A body that does not move, with its coordinate.
    template <class T>
    RigidState<T> still(const T* q, const T* v) const {
        RigidState<T> s;
        s.r = Vector3Of<T>(at_);
        s.v = s.omega = s.turning = Vector3Of<T>(T(0.0), T(0.0), T(0.0));
        s.coordinate = q[0];
        s.rate = v[0];
        return s;
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
