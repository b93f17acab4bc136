// The law of a rigid body on a hinge: I_33 psi'' = M_3 (7.60), e3 the axis, I_33 about it.
// Coordinates: psi | psi'. The frame at psi = 0 has e1 towards the centre of mass.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
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

class HingeLaw : public RigidLawOf<HingeLaw, AxisLaw> {
public:
    /// Of a body of a scene. Throws InvalidInput for one without a moment of inertia about the axis.
    [[gnu::cold]] HingeLaw(const Scene& scene, int place, const Revolute& joint);

    int first_turn() const override { return 0; }
    std::vector<VariableGroup> groups(bool of_positions) const override;
    std::array<bool, 3> holds_turns() const override { return {true, true, false}; }
    void observe(const LawsNow& now, std::vector<Observed>& out) const override;
    std::vector<std::string> words() const override { return {"angle", "rate"}; }
    std::optional<double> coordinate_of(const StateChange& c) const override { return c.angle; }
    std::unique_ptr<const Projection> projection(std::span<const double> x, std::span<const double> low) const override;
    /// A compound pendulum under constant acceleration, or a torsion pendulum, not both.
    std::unique_ptr<const BodyForm> closed_form(const Scene& scene, const Vector3Of<DoubleDouble>& a) const override;
    std::string coordinates(const StateMap& /*map*/) const override { return "angle of its hinge"; }

    template <class T>
    RigidState<T> place(const T* q, const T* v) const {
        using std::cos, std::sin;
        RigidState<T> s = still<T>(q, v);
        const T c = cos(q[0]), n = sin(q[0]);
        const Vector3Of<T> x = exactly<T>(Vector3Of<DoubleDouble>(exact.frame.col(0))),
                           y = exactly<T>(Vector3Of<DoubleDouble>(exact.frame.col(1)));
        s.axes = {x * c + y * n, y * c - x * n, exactly<T>(Vector3Of<DoubleDouble>(exact.frame.col(2)))};
        s.omega[2] = s.turning[2] = v[0];
        return s;
    }
    template <class T>
    void change_by(const RigidState<T>& s, const T* /*q*/, const Wrench<T>& w, T* q_rate, T* v_rate) const {
        *q_rate = s.rate;
        *v_rate = w.moment[2] / exactly<T>(exact.moments[2]);
    }
    template <class T>
    Accelerations<T> accelerated(const RigidState<T>& /*s*/, const T* v_rate) const {
        return {Vector3Of<T>(T(0.0), T(0.0), v_rate[0]), Vector3Of<T>(T(0.0), T(0.0), T(0.0))};
    }
    template <class T>
    QuaternionOf<T> turn(const RigidState<T>& s) const {
        using std::cos, std::sin;
        const T half = s.coordinate * T(0.5), n = sin(half);
        const Vector3Of<T> e = exactly<T>(Vector3Of<DoubleDouble>(exact.frame.col(2)));
        return {cos(half), n * e[0], n * e[1], n * e[2]};
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
