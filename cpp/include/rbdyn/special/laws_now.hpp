// A state of a scene in a mode: where all bodies are, and the forces between them, found once for all of them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/single_state.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The forces of all couplings at a state on their first ends, each found when it is first asked for: both ends take it
/// from here. Keeps the laws and the states it is given by reference.
template <class S>
class CouplingForces {
public:
    CouplingForces(const SingleLaws& laws, const S& t, const SingleStates<S>& states)
        : laws_(laws), t_(t), states_(states), forces_(laws.couplings().size()) {}

    const S& time() const { return t_; }
    const SingleStates<S>& states() const { return states_; }
    const SingleLaws::Connected& coupling(int k) const { return laws_.coupling(k); }
    const Vector3Of<S>& operator[](int coupling) const {
        const auto k = static_cast<std::size_t>(coupling);
        if (!forces_[k]) forces_[k] = laws_.coupling_force<S>(laws_.couplings()[k], t_, states_);
        return *forces_[k];
    }

private:
    const SingleLaws& laws_;
    S t_;
    const SingleStates<S>& states_;
    mutable std::vector<std::optional<Vector3Of<S>>> forces_;
};

/// A state in a mode, with what its bodies have in common: where they are, and the forces between them. Keeps what it
/// is given by reference. `acting`: what acts in the mode, where the state alone does not say.
struct LawsNow {
    LawsNow(const SingleLaws& laws, std::span<const signed char> slip, double t, std::span<const double> x,
            const Acting* acting = nullptr);
    LawsNow(const LawsNow&) = delete;
    LawsNow& operator=(const LawsNow&) = delete;

    const SingleState<double>& state(int body) const { return states[static_cast<std::size_t>(body)]; }
    /// The rate of a variable, where what acts is known; zero of what stays as it starts.
    double rate_of(int variable) const;
    /// The force of a coupling on its first end, seen from the view.
    Vector3 coupling_force(int coupling) const;
    /// The same on a particle that it acts on.
    Vector3 force_on(int body, int coupling) const;
    /// What a watched function asks for.
    double observed(const Observable& o) const;
    /// Which of some couplings is not finite, in words; empty: none.
    std::string coupling_not_finite(const std::vector<int>& which) const;
    /// A body for the theorems of systems.
    BodyReport body(int index, Asked asked) const;

    const SingleLaws& laws;
    std::span<const signed char> slip;
    double t;
    std::span<const double> x;
    const Acting* acting;
    SingleStates<double> states;
    CouplingForces<double> couplings;
};

}  // namespace rbdyn::inline RBDYN_FORM
