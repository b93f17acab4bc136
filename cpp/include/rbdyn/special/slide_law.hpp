// The law of a rigid body on a slide: m d'' = F.e3, e3 the direction.
// Coordinates: d | d'.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/axis_law.hpp"
#include "rbdyn/special/rigid_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SlideLaw : public RigidLawOf<SlideLaw, AxisLaw> {
public:
    /// Of a body of a scene.
    [[gnu::cold]] SlideLaw(const Scene& scene, int place, const Prismatic& joint)
        : RigidLawOf(scene, place, joint.axis, joint.at, joint.point) {}

    std::vector<VariableGroup> groups(bool of_positions) const override;
    std::array<bool, 3> holds_turns() const override { return {true, true, true}; }
    void observe(const LawsNow& now, std::vector<Observed>& out) const override;
    std::vector<std::string> words() const override { return {"displacement", "rate"}; }
    std::optional<double> coordinate_of(const StateChange& c) const override { return c.displacement; }
    /// It has no first integral that steps would lose.
    bool is_conservative() const override { return false; }
    std::unique_ptr<const BodyForm> closed_form(const Scene& scene, const Vector3Of<DoubleDouble>& a) const override;
    std::string coordinates(const StateMap& /*map*/) const override { return "displacement of its slide"; }

    template <class T>
    RigidState<T> place(const T* q, const T* v) const {
        RigidState<T> s = still<T>(q, v);
        const auto axis = [&](int i) { return exactly<T>(Vector3Of<DoubleDouble>(exact.frame.col(i))); };
        s.axes = {axis(0), axis(1), axis(2)};
        s.r += s.axes.e3 * q[0];
        s.v = s.axes.e3 * v[0];
        return s;
    }
    template <class T>
    void change_by(const RigidState<T>& s, const T* /*q*/, const Wrench<T>& w, T* q_rate, T* v_rate) const {
        *q_rate = s.rate;
        *v_rate = dot<T>(s.axes.e3, w.force) / exactly<T>(exact.mass);
    }
    template <class T>
    Accelerations<T> accelerated(const RigidState<T>& s, const T* v_rate) const {
        return {Vector3Of<T>(T(0.0), T(0.0), T(0.0)), Vector3Of<T>(s.axes.e3 * v_rate[0])};
    }
    // its axes are those of the world
    template <class T>
    QuaternionOf<T> turn(const RigidState<T>& /*s*/) const {
        return {T(1.0), T(0.0), T(0.0), T(0.0)};
    }
    template <class T>
    AxesOf<T> axes_of(const RigidState<T>& /*s*/) const {
        const auto axis = [](int i) { return Vector3Of<T>(Vector3(Vector3::Unit(i))); };
        return {axis(0), axis(1), axis(2)};
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
