// The law of a free rigid body: m a_G = F, and its rotation about G (turning_law.hpp).
// Coordinates: G, those of its attitude | G', its angular velocity.
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
#include "rbdyn/special/turning_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

class FreeLaw : public RigidLawOf<FreeLaw, TurningLaw> {
public:
    /// Of a body of a scene.
    [[gnu::cold]] FreeLaw(const Scene& scene, int place);

    int first_turn() const override { return 3; }
    bool holds_point() const override { return false; }
    void start_in(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const override;
    void observe(const LawsNow& now, std::vector<Observed>& out) const override;
    std::unique_ptr<const BodyForm> closed_form(const Scene& scene, const Vector3Of<DoubleDouble>& a) const override;
    std::vector<std::string> words() const override;
    std::string coordinates(const StateMap& map) const override;
    void leave_out(const StateMap& map, std::vector<Omission>& omissions) const override;

    template <class T>
    RigidState<T> place(const T* q, const T* v) const {
        RigidState<T> s;
        s.r = {q[0], q[1], q[2]};
        s.v = {v[0], v[1], v[2]};
        place_turned<T>(s, q + 3, v + 3);
        return s;
    }
    template <class T>
    void change_by(const RigidState<T>& s, const T* q, const Wrench<T>& w, T* q_rate, T* v_rate) const {
        for (int i = 0; i < 3; ++i) {
            q_rate[i] = s.v[i];
            v_rate[i] = w.force[i] / exactly<T>(exact.mass);
        }
        turn_by<T>(s, q + 3, w, q_rate + 3, v_rate + 3);
    }
    template <class T>
    Accelerations<T> accelerated(const RigidState<T>& s, const T* v_rate) const {
        return {angular_acceleration<T>(s, v_rate + 3), Vector3Of<T>(v_rate[0], v_rate[1], v_rate[2])};
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
