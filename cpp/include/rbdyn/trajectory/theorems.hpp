// The theorems of systems at a moment: momenta, energies, external forces, and both cardinal equations.
//
// Notation: Q momentum, K_O angular momentum about a pole O, R and M_O resultant and moment of the external forces,
// those that come from outside the part of the system that is asked for: loads, gravity, rails and joints, couplings to
// the world and to bodies that are not of the part. Couplings within it are internal.
//     Q = m v_G                              (7.29)      K_O = sum (r - O) x m v + K_G of every body       (7.31)
//     R = dQ/dt = m a_G                      (7.38, 7.43)     M_O = dK_O/dt + v_O x Q                      (7.39)
// The last holds where internal forces are along the lines of their ends; where they are not it is off by their moment.
// Rates come from accelerations of the model: dK_O/dt = sum (r - O) x m a + dK_G/dt - v_O x Q.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/trajectory/pole.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Some bodies of a system at a moment; all of them if none is named. Keeps the system by reference.
class SystemPart {
public:
    /// Throws InvalidInput for a handle that is none of the system's.
    explicit SystemPart(const SystemReport& system, std::vector<BodyHandle> of = {});

    double mass() const;
    Vector3 center_of_mass() const;
    Vector3 center_of_mass_velocity() const;
    Vector3 center_of_mass_acceleration() const;
    /// T of the motion relative to axes that do not turn and move with a velocity.
    double kinetic_energy(const Vector3& axes = Vector3::Zero()) const;
    /// dT/dt: the power of all forces, reactions and internal ones included (Thm 7.6).
    double power() const;
    Vector3 momentum() const;
    Vector3 angular_momentum(const Vector3& pole) const;
    Vector3 external_force() const;
    Vector3 external_moment(const Vector3& pole) const;
    /// R - dQ/dt and M - dK/dt - v x Q.
    std::pair<Vector3, Vector3> cardinal_residuals(const Pole::Now& pole) const;
    /// Sizes of the terms of momentum and of angular momentum, added.
    double size_of_momentum() const;
    double size_of_angular_momentum(const Vector3& pole) const;

    /// f(body, its index) for all bodies of the part.
    template <class F>
    void each(F&& f) const {
        if (of_.empty())
            for (std::size_t i = 0; i < system_.bodies.size(); ++i) f(system_.bodies[i], static_cast<int>(i));
        for (const BodyHandle b : of_) f(system_.bodies[static_cast<std::size_t>(b.index)], b.index);
    }
    /// Whether a coupling is within the part, and whether it acts on it from outside.
    bool has(const CouplingReport& c) const { return has(c.a) && has(c.b); }
    bool is_within_or_to_world(const CouplingReport& c) const;

private:
    bool has(int body) const { return body >= 0 && (of_.empty() || is_in_[static_cast<std::size_t>(body)]); }
    template <class F>
    Vector3 mean(F&& f) const;
    /// f(place, force) for every coupling that acts from outside.
    template <class F>
    void each_external(F&& f) const;

    const SystemReport& system_;
    std::vector<BodyHandle> of_;
    std::vector<bool> is_in_;
};

}  // namespace rbdyn::inline RBDYN_FORM
