// What acts in a mode and how it accelerates everything, from the equations of the mode itself.
//
// Where a force jumps, the state alone does not say which side it is on: at the surface of a case distinction its mode
// does, and where motion slides along the surface both sides act, each with its weight. So reports take forces, moments
// and the rates of the variables from the program of their mode, as guards and watched functions do; where nothing is
// distinguished the laws at the state give the same.
//
// Layout of the values behind the rates of the state: of each body the active force [N], what is along its rail (r'.F),
// the moment about o [N m, in the frame of rigid_state.hpp]; of each coupling the force on its first end [N]; of each
// load of the scene its power [W], zero of one that no distinction can be in. Forces are seen from the view.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Acting {
    static constexpr int per_body = 7, per_coupling = 3;

    int variables = 0, bodies = 0, couplings = 0;
    std::vector<double> values;

    double rate(int place) const { return at(place); }
    Vector3 force(int body) const { return vector(of_body(body)); }
    double along(int body) const { return at(of_body(body) + 3); }
    Vector3 moment(int body) const { return vector(of_body(body) + 4); }
    Vector3 coupling_force(int coupling) const { return vector(of_body(bodies) + per_coupling * coupling); }
    double power(int load) const { return at(of_body(bodies) + per_coupling * couplings + load); }

private:
    int of_body(int body) const { return variables + per_body * body; }
    double at(int i) const { return values[static_cast<std::size_t>(i)]; }
    Vector3 vector(int i) const { return {at(i), at(i + 1), at(i + 2)}; }
};

/// At a state of a mode; none where the laws at the state say it all.
std::optional<Acting> acting_in(const Mode& mode, int bodies, int couplings, double t, std::span<const double> x);

/// The same of a state of 32 digits, in as many, where no side or sign is to be chosen.
[[gnu::cold]] std::optional<Acting> acting_widely(const Mode& mode, double t, std::span<const DoubleDouble> x);

}  // namespace rbdyn::inline RBDYN_FORM
