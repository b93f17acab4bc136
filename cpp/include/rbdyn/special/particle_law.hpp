// The law of a free particle: m a = F (eq. 7.7), in coordinates x, y, z of the view.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/point_law.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/view.hpp"

namespace rbdyn::inline RBDYN_FORM {

class ParticleLaw : public PointLaw {
public:
    ParticleLaw(const Scene::Body& b, int place, const SceneView& view) : PointLaw(b, place, view) {}
    std::unique_ptr<SingleLaw> copy() const override;

    void take_start(const Scene::Body& b) override;
    int positions() const override { return 3; }
    std::vector<VariableGroup> groups(bool of_positions) const override;
    void start(double t, DoubleDouble* q, DoubleDouble* v) const override;
    void add_state(SingleStates<double>& states, double t, const double* q, const double* v,
                   signed char phase) const override;
    void add_state(SingleStates<S>& states, const S& t, const S* q, const S* v, signed char phase) const override;

    void lay_down(RecordedBody& present, const CouplingForces<S>& couplings, S* q_rate, S* v_rate) const override;
    S observed(const RecordedBody& present, const Observable& o) const override {
        return observed_in_space(present, o);
    }
    PointReport report(const LawsNow& now) const override;
    void slope(const LawsNow& now, std::span<double> dq, std::span<double> dv) const override;
    std::optional<double> change(const StateChange& c, const LawsNow& now, const std::string& user,
                                 std::span<double> x) const override;
    std::unique_ptr<const BodyForm> closed_form(const Scene& scene, const Vector3Of<DoubleDouble>& a) const override;
    using PointLaw::observed, PointLaw::report;

    std::string coordinates(const StateMap& map) const override;
    const char* mover() const override { return "a force or a velocity"; }
    void leave_out(const StateMap& map, std::vector<Omission>& omissions) const override;
    std::string not_finite(const LawsNow& now) const override;

private:
    Vector3 start_position_ = Vector3::Zero(), start_velocity_ = Vector3::Zero();
};

}  // namespace rbdyn::inline RBDYN_FORM
