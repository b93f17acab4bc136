// A state of a scene in a mode: where all bodies are, and the forces between them, found once for all of them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/point_state.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The forces of all couplings at a state on their first ends, each found when it is first asked for: both ends take it
/// from here. Keeps the laws and the states it is given by reference.
template <class S>
class CouplingForces {
public:
    CouplingForces(const PointLaws& laws, const S& t, const std::vector<PointState<S>>& states)
        : laws_(laws), t_(t), states_(states), forces_(laws.couplings().size()) {}

    const S& time() const { return t_; }
    const std::vector<PointState<S>>& states() const { return states_; }
    const Vector3Of<S>& operator[](int coupling) const {
        const auto k = static_cast<std::size_t>(coupling);
        if (!forces_[k]) forces_[k] = laws_.coupling_force<S>(laws_.couplings()[k], t_, states_);
        return *forces_[k];
    }

private:
    const PointLaws& laws_;
    S t_;
    const std::vector<PointState<S>>& states_;
    mutable std::vector<std::optional<Vector3Of<S>>> forces_;
};

/// A state in a mode, with what its bodies have in common: where they are, and the forces between them. Keeps what it
/// is given by reference. `acting`: what acts in the mode, where the state alone does not say.
struct PointsNow {
    PointsNow(const PointLaws& laws, std::span<const signed char> slip, double t, std::span<const double> x,
              const Acting* acting = nullptr);
    PointsNow(const PointsNow&) = delete;
    PointsNow& operator=(const PointsNow&) = delete;

    /// The force of a coupling on its first end, seen from the view.
    Vector3 coupling_force(int coupling) const;
    /// The same on a particle that it acts on.
    Vector3 force_on(int body, int coupling) const;
    /// A body for the theorems of systems.
    BodyReport body(int index, Asked asked) const;

    const PointLaws& laws;
    std::span<const signed char> slip;
    double t;
    std::span<const double> x;
    const Acting* acting;
    std::vector<PointState<double>> states;
    CouplingForces<double> couplings;
};

}  // namespace rbdyn::inline RBDYN_FORM
