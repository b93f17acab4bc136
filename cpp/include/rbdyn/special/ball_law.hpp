// The law of a rigid body on a ball joint: its rotation about the point that is held (turning_law.hpp).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/turning_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

class BallLaw : public RigidLawOf<BallLaw, TurningLaw> {
public:
    /// Of a body of a scene.
    [[gnu::cold]] BallLaw(const Scene& scene, int place, const Spherical& joint);

    int first_turn() const override { return 0; }
    void start_in(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const override { start_turned(b, q, v); }
    void observe(const LawsNow& now, std::vector<Observed>& out) const override;
    std::optional<planning::LoneBody> alone() const override;
    std::unique_ptr<const BodyForm> closed_form(const Scene& scene, const Vector3Of<DoubleDouble>& a) const override;
    std::string coordinates(const StateMap& map) const override;
    void leave_out(const StateMap& map, std::vector<Omission>& omissions) const override;

    template <class T>
    RigidState<T> place(const T* q, const T* v) const {
        RigidState<T> s;
        s.r = Vector3Of<T>(at_);
        s.v = Vector3Of<T>(T(0.0), T(0.0), T(0.0));
        place_turned<T>(s, q, v);
        return s;
    }
    template <class T>
    void change_by(const RigidState<T>& s, const T* q, const Wrench<T>& w, T* q_rate, T* v_rate) const {
        turn_by<T>(s, q, w, q_rate, v_rate);
    }
    template <class T>
    Accelerations<T> accelerated(const RigidState<T>& s, const T* v_rate) const {
        return {angular_acceleration<T>(s, v_rate), Vector3Of<T>(T(0.0), T(0.0), T(0.0))};
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
